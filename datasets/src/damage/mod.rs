//! Damage: what happens to the mesh of a shape between one program and the next.
//!
//! A retrieval system should find a shape again after each of them. All work on any mesh, not only on generated ones.

mod cut_off;
mod holes;
mod noise;
mod remesh;
mod slice;
mod weld;

use std::fmt;

use mesh::{TriMesh, shapes};
use nalgebra::Matrix3;

use self::remesh::{collapsed, remeshed};
use crate::stream::{Purpose, Stream};

pub use weld::WeldPair;

/// A change of a mesh that leaves the shape recognizable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Damage {
    /// Every face is split into four at the midpoints of its edges, this many times. The surface is the same.
    Subdivide(u32),
    /// Edges are collapsed by quadric error (Garland and Heckbert 1997, `garland1997` in `REFERENCES.bib`) until this
    /// share of the vertices is left.
    Decimate(f64),
    /// The surface gets new vertices, as many as before and evenly spread, and new triangles.
    Remesh,
    /// The surface gets this share of the number of vertices, evenly spread, and new triangles.
    Sample(f64),
    /// This many pairs of points become one vertex each.
    Weld(WeldPair, u32),
    /// This many pairs of points that are near in space are pushed together and joined by a narrow handle.
    Contact(u32),
    /// The end of a limb with this share of the area is cut off.
    CutOff(f64),
    /// The end of a limb is longer by this share.
    Lengthen(f64),
    /// A plane in a random direction cuts the shape, so that this share of the area stays.
    Slice(f64),
    /// This share of the vertices, and at least one, is displaced by 4 % of the diagonal of the bounding box.
    ShotNoise(f64),
    /// Every coordinate of every vertex gets normal noise. Its standard deviation is this share of the diagonal of the
    /// bounding box.
    Noise(f64),
    /// Three discs with this share of the area in total are cut out. The rest stays in one piece if a place for them can
    /// be found.
    Holes(f64),
    /// A random rotation and a shift by the diagonal of the bounding box.
    Move,
    /// A random scale from 1/10 to 10.
    Scale,
    /// This scale.
    Resize(f64),
    /// A mirror image, with faces still oriented outwards.
    Mirror,
}

impl Damage {
    /// Kinds of damage by name, each in five strengths: those of the SHREC'10 benchmark on robustness, and welds drawn in two
    /// ways. Strength 3 is damage that scans really have, and 5 is hard.
    ///
    /// ```
    /// use canonform_datasets::Damage;
    ///
    /// let (name, strengths) = Damage::graded()[3];
    /// assert_eq!((name, strengths[2].to_string().as_str()), ("holes", "holes 3 %"));
    /// ```
    pub fn graded() -> [(&'static str, [Self; 5]); 11] {
        let counts = [1, 2, 3, 4, 5];
        [
            ("weld, near points", counts.map(|n| Self::Weld(WeldPair::Near, n))),
            ("weld, random points", counts.map(|n| Self::Weld(WeldPair::Random, n))),
            ("handle, near points", counts.map(Self::Contact)),
            ("holes", [0.01, 0.02, 0.03, 0.05, 0.08].map(Self::Holes)),
            ("cut off", [0.02, 0.04, 0.07, 0.11, 0.16].map(Self::CutOff)),
            ("noise", [0.001, 0.002, 0.003, 0.005, 0.008].map(Self::Noise)),
            ("shot noise", [0.002, 0.005, 0.01, 0.02, 0.04].map(Self::ShotNoise)),
            ("decimation", [0.7, 0.5, 0.35, 0.2, 0.1].map(Self::Decimate)),
            ("sampling", [1.0, 0.7, 0.5, 0.35, 0.2].map(Self::Sample)),
            ("scale", [1.25, 2.0, 4.0, 10.0, 25.4].map(Self::Resize)),
            ("mirror", [Self::Mirror; 5]),
        ]
    }

    /// Applies the damage. The same mesh and seed give the same bytes on any machine.
    pub fn apply(self, mesh: &TriMesh, seed: u64) -> TriMesh {
        let mut stream = Stream::new(seed, 0, 0, Purpose::Damage);
        match self {
            Self::Subdivide(times) => (0..times).fold(mesh.clone(), |mesh, _| shapes::subdivide(&mesh)),
            Self::Decimate(share) => {
                collapsed(mesh, (share * mesh.n_vertices() as f64) as usize, &|error, _, _| error)
            }
            Self::Remesh => remeshed(mesh, 1.0, &mut stream),
            Self::Sample(share) => remeshed(mesh, share, &mut stream),
            Self::Weld(pair, n) => weld::weld(mesh, pair, n, &mut stream),
            Self::Contact(n) => weld::contact(mesh, n, &mut stream),
            Self::CutOff(share) => cut_off::cut_off(mesh, share, &mut stream),
            Self::Lengthen(share) => cut_off::lengthen(mesh, share, &mut stream),
            Self::Slice(share) => slice::slice(mesh, share, &mut stream),
            Self::ShotNoise(share) => noise::shot_noise(mesh, share, diagonal(mesh), &mut stream),
            Self::Noise(share) => noise::noise(mesh, share * diagonal(mesh), &mut stream),
            Self::Holes(share) => holes::holes(mesh, share, &mut stream),
            Self::Move => {
                let (turn, shift) = (stream.rotation(), diagonal(mesh));
                mesh.moved(|p| turn * p + nalgebra::Vector3::new(shift, -shift, shift))
            }
            Self::Scale => {
                // Evenly spread in powers of two and fractions between them.
                let factor = f64::powi(2.0, stream.below(6) as i32 - 3) * stream.uniform(0.8, 1.25);
                mesh.moved(|p| p * factor)
            }
            Self::Resize(factor) => mesh.moved(|p| p * factor),
            Self::Mirror => {
                let flip = Matrix3::from_diagonal(&[-1.0, 1.0, 1.0].into());
                let mut mirrored = mesh.moved(|p| flip * p);
                mirrored.faces.iter_mut().for_each(|face| face.swap(0, 1));
                mirrored
            }
        }
    }

    /// Whether the surface is the same up to a motion, a reflection and scale.
    pub fn keeps_surface(self) -> bool {
        matches!(self, Self::Subdivide(_) | Self::Move | Self::Scale | Self::Resize(_) | Self::Mirror)
    }
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Subdivide(1) => f.write_str("subdivided"),
            Self::Subdivide(times) => write!(f, "subdivided {times} times"),
            Self::Decimate(share) => write!(f, "decimated to {} %", percent(*share)),
            Self::Remesh => f.write_str("remeshed"),
            Self::Sample(share) => write!(f, "remeshed with {} %", percent(*share)),
            Self::Weld(pair, n) => {
                let pair = if *pair == WeldPair::Near { "near" } else { "random" };
                write!(f, "{n} {pair} {} welded", if *n == 1 { "pair" } else { "pairs" })
            }
            Self::Contact(1) => f.write_str("a handle"),
            Self::Contact(n) => write!(f, "{n} handles"),
            Self::CutOff(share) => write!(f, "{} % cut off", percent(*share)),
            Self::Lengthen(share) => write!(f, "a limb longer by {} %", percent(*share)),
            Self::Slice(share) => write!(f, "{} % behind a plane", percent(*share)),
            Self::ShotNoise(share) => write!(f, "shot noise {} %", percent(*share)),
            Self::Noise(share) => write!(f, "noise {} %", percent(*share)),
            Self::Holes(share) => write!(f, "holes {} %", percent(*share)),
            Self::Move => f.write_str("moved"),
            Self::Scale => f.write_str("scaled"),
            Self::Resize(factor) => write!(f, "scaled by {factor}"),
            Self::Mirror => f.write_str("mirrored"),
        }
    }
}

/// In percent, without rounding errors.
fn percent(share: f64) -> f64 {
    (share * 1e6).round() / 1e4
}

/// The diagonal of the bounding box.
fn diagonal(mesh: &TriMesh) -> f64 {
    mesh.bounds().map_or(0.0, |[lo, hi]| (hi - lo).norm())
}

#[cfg(test)]
mod tests {
    use mesh::{RepairOptions, repair, validate};

    use super::*;
    use crate::{ArticulatedOptions, Family, articulated_shape};

    /// One strength of every kind, and what is not graded.
    fn all() -> impl Iterator<Item = Damage> {
        let others = [Damage::Slice(0.7), Damage::Subdivide(1), Damage::Subdivide(2), Damage::Remesh];
        let others = others.into_iter().chain([Damage::Lengthen(0.1)]);
        let graded = Damage::graded().into_iter().map(|(_, strengths)| strengths[1]);
        graded.chain(others).chain([Damage::Decimate(0.2), Damage::Move, Damage::Scale])
    }

    fn cat() -> TriMesh {
        let options = ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() };
        articulated_shape(Family::Cat, 1, &options).unwrap().mesh
    }

    #[test]
    fn damage_is_reproducible_changes_the_mesh_and_leaves_a_manifold() {
        let mesh = cat();
        for damage in all() {
            let found = damage.apply(&mesh, 4);
            assert_eq!(found, damage.apply(&mesh, 4), "{damage}");
            assert_ne!(found, mesh, "{damage}");
            let drawn = !matches!(
                damage,
                Damage::Subdivide(_) | Damage::Decimate(_) | Damage::Resize(_) | Damage::Mirror
            );
            assert_eq!(found != damage.apply(&mesh, 5), drawn, "{damage}");
            let found = validate(&found);
            let holes = matches!(damage, Damage::Holes(_) | Damage::CutOff(_) | Damage::Slice(_));
            let defects = [found.non_manifold_edges, found.inconsistent_edges, found.unreferenced_vertices];
            assert_eq!((found.n_components, defects), (1, [0; 3]), "{damage}");
            assert_eq!(found.n_boundary_loops > 0, holes, "{damage}: {found:?}");
        }
    }

    #[test]
    fn counts_and_areas_are_those_that_were_asked_for() {
        let mesh = cat();
        let of = |damage: Damage| damage.apply(&mesh, 4);
        let area = |damage| of(damage).area() / mesh.area();
        assert_eq!(of(Damage::Decimate(0.2)).n_vertices(), 200);
        assert_eq!(of(Damage::Remesh).n_vertices(), 1000);
        for damage in [Damage::Subdivide(2), Damage::Move, Damage::Mirror] {
            assert!((area(damage) - 1.0).abs() < 1e-12 && damage.keeps_surface(), "{damage}");
        }
        assert!((area(Damage::Decimate(0.5)) - 1.0).abs() < 0.02, "{}", area(Damage::Decimate(0.5)));
        assert!((area(Damage::Remesh) - 1.0).abs() < 0.03, "{}", area(Damage::Remesh));
        for share in [0.01, 0.03] {
            for damage in [Damage::Holes(share), Damage::CutOff(share)] {
                let cut = 1.0 - area(damage);
                assert!((share..1.6 * share).contains(&cut), "{damage}: {cut}");
            }
        }
        assert!((area(Damage::Slice(0.7)) - 0.7).abs() < 0.03, "{}", area(Damage::Slice(0.7)));
        let moved = of(Damage::ShotNoise(0.01));
        let n_moved = moved.positions.iter().zip(&mesh.positions).filter(|(p, q)| p != q).count();
        assert_eq!((n_moved, moved.faces == mesh.faces), (10, true));
    }

    #[test]
    fn welds_join_distant_points_of_a_surface_that_stays_in_one_piece() {
        let mesh = cat();
        for seed in 0..8 {
            for pair in [WeldPair::Near, WeldPair::Random] {
                let found = validate(&Damage::Weld(pair, 2).apply(&mesh, seed));
                assert_eq!((found.non_manifold_vertices, found.n_components), (2, 1), "{pair:?}, {seed}");
                assert_eq!((found.n_vertices, found.n_faces), (mesh.n_vertices() - 2, mesh.n_faces()));
            }
            let found = validate(&Damage::Contact(1).apply(&mesh, seed));
            assert!(found.volume.is_some() && found.genus == Some(1), "{seed}: {found:?}");
        }
    }

    #[test]
    fn any_mesh_can_be_damaged() {
        let mut fans = shapes::disjoint(&[shapes::grid(9, 9, 0.3), shapes::cube(2)]);
        fans.positions.push([0.4, 0.4, 1.0].into());
        let first = fans.faces[0];
        fans.faces.push([first[0], first[1], surface::VertexId(fans.positions.len() as u32 - 1)]);
        for mesh in [TriMesh::default(), shapes::tetrahedron(0), fans] {
            for damage in all() {
                let found = damage.apply(&mesh, 1);
                assert!(
                    mesh.faces.is_empty() || repair(&found, &RepairOptions::default(), &()).is_ok(),
                    "{damage}"
                );
            }
        }
    }
}
