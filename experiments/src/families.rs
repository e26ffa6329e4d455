//! The choice of built-in families on the command line.

use std::fmt;
use std::str::FromStr;

use datasets::{ArticulatedOptions, CreatureOptions, DatasetError, LabeledShape, articulated, creatures};

/// Built-in families.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Families {
    /// The thirty shapes of three families.
    Articulated,
    /// Creatures: the number of families, and of shapes of each.
    Creatures(usize, usize),
}

impl Families {
    /// Generates the shapes.
    pub(crate) fn generate(self, seed: u64, n_vertices: usize) -> Result<Vec<LabeledShape>, DatasetError> {
        match self {
            Self::Articulated => articulated(&ArticulatedOptions { seed, n_vertices }),
            Self::Creatures(n_families, n_poses) => {
                creatures(&CreatureOptions { seed, n_families, n_poses, n_vertices })
            }
        }
    }
}

impl FromStr for Families {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let counts = || {
            let (families, poses) = text.strip_prefix("creatures:")?.split_once('x')?;
            let [families, poses] = [families, poses].map(|n| n.parse().ok().filter(|n| *n > 0));
            Some(Self::Creatures(families?, poses?))
        };
        let found = if text == "articulated" { Some(Self::Articulated) } else { counts() };
        found.ok_or_else(|| {
            "use `articulated`, or `creatures:40x8` for 40 families of 8 shapes each; separate several by commas"
                .to_owned()
        })
    }
}

impl fmt::Display for Families {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Articulated => f.write_str("articulated"),
            Self::Creatures(families, poses) => write!(f, "creatures:{families}x{poses}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_written_as_they_are_read() {
        for text in ["articulated", "creatures:40x8"] {
            assert_eq!(text.parse::<Families>().unwrap().to_string(), text);
        }
        for text in ["", "cats", "creatures", "creatures:40", "creatures:0x8", "creatures:4x-1"] {
            assert!(text.parse::<Families>().unwrap_err().contains("creatures:40x8"), "{text}");
        }
    }
}
