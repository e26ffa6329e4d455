//! The choice of built-in families on the command line.

use std::str::FromStr;

use datasets::{
    ArticulatedOptions, CreatureOptions, Damage, DatasetError, Family, LabeledShape, articulated,
    articulated_body, creatures,
};
use mesh::TriMesh;
use rayon::prelude::*;

use crate::parts::parts;

/// A mesh with so many of its vertices.
pub(crate) fn coarse(mesh: &TriMesh, n_vertices: usize) -> TriMesh {
    Damage::Decimate(n_vertices as f64 / mesh.n_vertices() as f64).apply(mesh, 0)
}

/// Built-in families.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Families {
    /// The thirty shapes of three families.
    Articulated,
    /// Cats, centaurs and men, each body a class: the number of bodies of each family, and of poses of each. Bodies of one family
    /// differ as adults do.
    Bodies(usize, usize),
    /// Creatures: the number of families, and of shapes of each.
    Creatures(usize, usize),
    /// Mechanical parts: the number of parts, and of copies of each. Their meshes are as fine as they need to be.
    Parts(usize, usize),
}

impl Families {
    /// Generates the shapes; meshes with fewer vertices than the families are made of are simplified.
    pub(crate) fn generate(self, seed: u64, n_vertices: usize) -> Result<Vec<LabeledShape>, DatasetError> {
        let least = ArticulatedOptions::MIN_VERTICES;
        if n_vertices < least && !matches!(self, Self::Parts(..)) {
            let mut shapes = self.generate(seed, least)?;
            shapes.par_iter_mut().for_each(|shape| shape.mesh = coarse(&shape.mesh, n_vertices));
            return Ok(shapes);
        }
        match self {
            Self::Articulated => articulated(&ArticulatedOptions { seed, n_vertices }),
            Self::Bodies(n_bodies, n_poses) => {
                let options = ArticulatedOptions { seed, n_vertices };
                let one = |(family, body, pose)| {
                    let shape = articulated_body(family, body, pose, &options)?;
                    let label = format!("{}-{body}", family.name());
                    Ok(LabeledShape { name: format!("{label}-{pose}"), label, ..shape })
                };
                let of = |family| (0..n_bodies * n_poses).map(move |i| (family, i / n_poses, i % n_poses));
                let all: Vec<_> = Family::all().into_iter().chain([Family::Person]).flat_map(of).collect();
                all.into_par_iter().map(one).collect()
            }
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
                "bodies" => Some(Self::Bodies(classes?, shapes?)),
                "creatures" => Some(Self::Creatures(classes?, shapes?)),
                "parts" => Some(Self::Parts(classes?, shapes?)),
                _ => None,
            }
        };
        let found = if text == "articulated" { Some(Self::Articulated) } else { counts() };
        found.ok_or_else(|| {
            "use `articulated`, `bodies:6x5` for 6 bodies of each family in 5 poses, `creatures:40x8` for 40 families of 8 \
             shapes each, or `parts:56x4` for 4 copies each of 56 mechanical parts; separate several by commas"
                .to_owned()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_families_are_refused() {
        for text in ["cats", "creatures:40", "creatures:0x8", "creatures:4x-1", "gears:4x4"] {
            assert!(text.parse::<Families>().unwrap_err().contains("creatures:40x8"), "{text}");
        }
    }
}
