//! The choice of built-in families on the command line.

use std::fmt;
use std::str::FromStr;

use datasets::{ArticulatedOptions, CreatureOptions, DatasetError, LabeledShape, articulated, creatures};

use crate::parts::parts;

/// Built-in families.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Families {
    /// The thirty shapes of three families.
    Articulated,
    /// Creatures: the number of families, and of shapes of each.
    Creatures(usize, usize),
    /// Mechanical parts: the number of parts, and of copies of each. Their meshes are as fine as they need to be.
    Parts(usize, usize),
}

impl Families {
    /// Generates the shapes.
    pub(crate) fn generate(self, seed: u64, n_vertices: usize) -> Result<Vec<LabeledShape>, DatasetError> {
        match self {
            Self::Articulated => articulated(&ArticulatedOptions { seed, n_vertices }),
            Self::Creatures(n_families, n_poses) => {
                creatures(&CreatureOptions { seed, n_families, n_poses, n_vertices })
            }
            Self::Parts(n_parts, n_copies) => Ok(parts(seed, n_parts, n_copies)),
        }
    }
}

impl FromStr for Families {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let counts = || {
            let (name, counts) = text.split_once(':')?;
            let (classes, shapes) = counts.split_once('x')?;
            let [classes, shapes] = [classes, shapes].map(|n| n.parse().ok().filter(|n| *n > 0));
            match name {
                "creatures" => Some(Self::Creatures(classes?, shapes?)),
                "parts" => Some(Self::Parts(classes?, shapes?)),
                _ => None,
            }
        };
        let found = if text == "articulated" { Some(Self::Articulated) } else { counts() };
        found.ok_or_else(|| {
            "use `articulated`, `creatures:40x8` for 40 families of 8 shapes each, or `parts:56x4` for 4 copies each of 56 \
             mechanical parts; separate several by commas"
                .to_owned()
        })
    }
}

impl fmt::Display for Families {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Articulated => f.write_str("articulated"),
            Self::Creatures(families, poses) => write!(f, "creatures:{families}x{poses}"),
            Self::Parts(parts, copies) => write!(f, "parts:{parts}x{copies}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn families_are_written_as_they_are_read() {
        for text in ["articulated", "creatures:40x8", "parts:56x4"] {
            assert_eq!(text.parse::<Families>().unwrap().to_string(), text);
        }
        for text in ["", "cats", "creatures", "creatures:40", "creatures:0x8", "creatures:4x-1", "gears:4x4"]
        {
            assert!(text.parse::<Families>().unwrap_err().contains("creatures:40x8"), "{text}");
        }
    }
}
