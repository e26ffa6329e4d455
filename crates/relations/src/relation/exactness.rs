//! Which of several copies of one surface is the original.

use nalgebra::Vector3;

use super::geometry::{Exactness, MeshGeometry, ROUNDING};
use super::mesh_change::ABOUT;
use super::same_surface::euler_characteristic_if_closed;

/// Normals that differ by less than this (sine) are one: the rounding of files turns small faces by as much. A tolerance.
const ONE_NORMAL: f64 = 1e-3;

/// Detail that bends a surface by this share more may be noise. A convention: decimated copies of smooth surfaces bend less than a
/// tenth less.
const ROUGH: f64 = 0.2;

/// Why one copy of a surface is more exact than another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Merit {
    /// It has less noise.
    Clean,
    /// It is closed, and the other one is not.
    Closed,
    /// It has details that the other one has lost.
    Detailed,
    /// It states the same with fewer vertices.
    Plain,
}

/// Whether the first of two copies is better in some way.
type Better<'a> = &'a dyn Fn(&MeshGeometry, &MeshGeometry) -> bool;

impl Merit {
    /// As the end of a sentence on a file that is kept.
    pub fn words(self) -> &'static str {
        match self {
            Self::Clean => "it has the least noise",
            Self::Closed => "its surface is closed",
            Self::Detailed => "it has the most detail",
            Self::Plain => "it has all detail with the fewest vertices",
        }
    }
}

impl MeshGeometry {
    /// Why this copy of a surface is more exact than another one; `None` if it is not.
    ///
    /// ```
    /// use canonform_relations::{Merit, MeshGeometry};
    /// use mesh::shapes;
    ///
    /// let of = |mesh| MeshGeometry::new(&mesh, None).unwrap();
    /// let [cube, finer] = [of(shapes::cube(1)), of(shapes::cube(3))];
    /// assert_eq!((cube.merit_over(&finer), finer.merit_over(&cube)), (Some(Merit::Plain), None));
    /// let [ball, coarse] = [of(shapes::icosphere(3)), of(shapes::icosphere(2))];
    /// assert_eq!(ball.merit_over(&coarse), Some(Merit::Detailed));
    /// ```
    pub fn merit_over(&self, other: &Self) -> Option<Merit> {
        let same_counts = self.n_vertices() == other.n_vertices() && self.n_faces() == other.n_faces();
        let is_rougher = |a: &Self, b: &Self| {
            // Triangles of other sizes may look noisy, but bend no more.
            let bends = |by: f64| a.exactness().bending > (1.0 + by) * b.exactness().bending;
            let has_noise = || {
                let [more, less] = [a, b].map(|mesh| mesh.noise().unwrap_or_default());
                more > less + ROUNDING && more > 2.0 * less
            };
            let by_planes = || (a.is_mechanical() || b.is_mechanical()) && has_noise();
            bends(ONE_NORMAL) && (same_counts || by_planes()) || bends(ABOUT) && a.is_noisy() && !b.is_noisy()
        };
        let n_needed = |mesh: &Self| mesh.exactness().n_needed as f64;
        let merits: [(Merit, Better<'_>); 4] = [
            (Merit::Clean, &|a, b| is_rougher(b, a)),
            (Merit::Closed, &|a, b| a.exactness().is_closed && !b.exactness().is_closed),
            (Merit::Detailed, &|a, b| n_needed(a) > (1.0 + ABOUT) * n_needed(b)),
            (Merit::Plain, &|a, b| a.n_vertices() < b.n_vertices()),
        ];
        // The first in which they differ decides.
        let (merit, is_better) =
            merits.into_iter().find(|(_, is_better)| is_better(self, other) || is_better(other, self))?;
        is_better(self, other).then_some(merit)
    }

    /// Whether what it has beyond another copy may be noise, which then [an overlay](super::MeshOverlay::is_noise) tells.
    pub fn may_be_noise_of(&self, other: &Self) -> bool {
        self.exactness().bending > (1.0 + ROUGH) * other.exactness().bending
    }

    fn exactness(&self) -> &Exactness {
        self.exactness.get_or_init(|| {
            let mesh = self.mesh();
            let normals: Vec<Vector3<f64>> = (0..mesh.n_faces())
                .map(|f| mesh.area_vector(f).try_normalize(0.0).unwrap_or_default())
                .collect();
            let mut around: Vec<Vec<Vector3<f64>>> = vec![Vec::new(); mesh.n_vertices()];
            for (face, normal) in mesh.faces.iter().zip(&normals) {
                for v in face {
                    let known = &mut around[v.index()];
                    if known.len() < 3 && known.iter().all(|other| other.cross(normal).norm() > ONE_NORMAL) {
                        known.push(*normal);
                    }
                }
            }
            let topology = mesh.topology();
            let turns = topology.edges().iter().enumerate().map(|(e, ends)| {
                let &[a, b] = topology.edge_corners(surface::EdgeId::from(e)) else { return 0.0 };
                let [a, b] = [a, b].map(|corner| normals[corner.face().index()]);
                let [p, q] = ends.map(|v| mesh.positions[v.index()]);
                a.cross(&b).norm().atan2(a.dot(&b)) * (p - q).norm()
            });
            Exactness {
                is_closed: euler_characteristic_if_closed(&topology).is_some(),
                n_needed: around.iter().filter(|known| known.len() == 3).count(),
                bending: turns.sum(),
            }
        })
    }
}
