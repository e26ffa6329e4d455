//! Which of several copies of one surface is the original.

use descriptors::Side;
use nalgebra::Vector3;

use super::geometry::{Exactness, MeshGeometry, ROUNDING};
use super::mesh_change::{ABOUT, Displacements};
use super::{Relation, RelationKind};

/// Normals that differ by less than this (sine) are one: the rounding of files turns small faces by as much. A tolerance.
const ONE_NORMAL: f64 = 1e-3;

/// A body with noise bends by this share more. A convention: decimated copies of smooth surfaces bend less than a tenth less.
const ROUGH: f64 = 0.2;

/// A part bends by this share more if its triangles were replaced by as many, since new ones reach over edges: by 4.4 to 39 % on four of five
/// parts.
const STRAIGHT: f64 = 0.04;

/// Noise takes neighbors from the surface independently of each other: their correlation along edges is below this and two standard
/// errors. With noise of .03 to .2 % of the size on 20 generated bodies and parts, subdivided or not, it is at most .09.
const CORRELATION: f64 = 0.1;

/// The fourth moment of what noise does, in squares of the second: 3 if it is normal, at most 3.5 on the same bodies and parts.
const NORMAL_TAILS: f64 = 4.0;

/// A copy has lost something if the vertices of the other one are farther from it than its own are from that, root mean square, by the
/// first factor and mostly at few vertices, with a fourth moment above the limit, or by the second factor. The remeshed copies of those
/// bodies and parts have lost tips and edges, finer ones too: nine of ten have 1.29 to 17. Decimated ones have at most 1.58 the other way
/// round, or they have few of the vertices.
const LOST: [f64; 2] = [1.25, 2.0];
const HEAVY_TAILS: f64 = 6.0;

/// The distances that rounding of files makes, whose coordinates are up to 2 at unit area, along three axes.
const FILE_ROUNDING: f64 = 3.0 * ROUNDING;

/// What has more vertices than another copy by this factor is no remeshed copy of it.
const FINER: usize = 3;

/// Why one copy of a surface is more exact than another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Merit {
    /// It has less noise, and no edges that new triangles reach over.
    Smooth,
    /// It is closed, and the other one is not.
    Closed,
    /// It has details that the other one has lost.
    Detailed,
    /// It states the same with fewer vertices.
    Plain,
}

impl Merit {
    /// As the end of a sentence on a file that is kept.
    pub fn words(self) -> &'static str {
        match self {
            Self::Smooth => "it is the smoothest",
            Self::Closed => "its surface is closed",
            Self::Detailed => "it has the most detail",
            Self::Plain => "it has all detail with the fewest vertices",
        }
    }
}

impl Displacements {
    fn is_noise(&self) -> bool {
        let limit = CORRELATION + 2.0 / self.n_edges.sqrt();
        self.correlation.abs() < limit && self.kurtosis < NORMAL_TAILS
    }

    /// Whether these vertices have something that the other surface, whose gaps are given, has lost.
    fn has_more(&self, other: &Self) -> bool {
        let factor = LOST[usize::from(self.kurtosis < HEAVY_TAILS)];
        self.rms > FILE_ROUNDING && self.rms > factor * other.rms && !self.is_noise()
    }
}

impl Relation {
    /// Which of two copies of one surface, for which this relation was found, is more exact, and why; `None` if nothing tells.
    ///
    /// ```
    /// use canonform_relations::{Merit, MeshGeometry, Relation};
    /// use descriptors::{ShapeDistance, Side};
    /// use mesh::shapes;
    /// use rigid::Handedness;
    ///
    /// let [ball, coarse] = [3, 2].map(|n| MeshGeometry::new(&shapes::icosphere(n), None).unwrap());
    /// let found = Relation::by_distance(ShapeDistance::default(), 1.0, Handedness::Unknown).by_meshes([&ball, &coarse]);
    /// assert_eq!(found.more_exact([&ball, &coarse]), Some((Side::First, Merit::Detailed)));
    /// ```
    pub fn more_exact(&self, [a, b]: [&MeshGeometry; 2]) -> Option<(Side, Merit)> {
        let map = self.map.filter(|_| !self.kind.is_one_geometry());
        let gaps = map.map(|map| {
            [Displacements::from_surface(a, b, &map), Displacements::from_surface(b, a, &map.inverse())]
        });
        let n_about = (a.n_vertices() as f64 / b.n_vertices() as f64).ln().abs();
        let is_new = n_about < ABOUT && (a.is_mechanical() || b.is_mechanical());
        let differ = gaps.iter().flatten().any(|gap| gap.rms > ROUNDING);
        let is_worse = |own: usize| {
            let [mesh, other] = [[a, b][own], [a, b][1 - own]];
            let [needed, needed_by_other] = [mesh, other].map(|mesh| mesh.exactness().n_needed);
            let gaps = gaps.as_ref().map(|gaps| [&gaps[own], &gaps[1 - own]]);
            let has_noise = self.kind == RelationKind::Noisy || gaps.is_some_and(|[own, _]| own.is_noise());
            let has_lost = gaps.is_some_and(|[own, other]| other.has_more(own));
            [
                (
                    Merit::Smooth,
                    has_noise && mesh.is_rougher(other) || is_new && mesh.bends_more(STRAIGHT, other),
                ),
                (Merit::Closed, mesh.closed().is_none()),
                (Merit::Detailed, has_lost && needed < FINER * needed_by_other),
                // Triangles across a cylinder bend where those along it do not.
                (
                    Merit::Detailed,
                    differ && mesh.n_vertices() < other.n_vertices() && needed > needed_by_other,
                ),
            ]
        };
        let decided =
            is_worse(0).into_iter().zip(is_worse(1)).find(|((_, first), (_, second))| first != second);
        match decided {
            Some(((merit, true), _)) => Some((Side::Second, merit)),
            Some(((merit, false), _)) => Some((Side::First, merit)),
            None => {
                let first = a.merit_over(b).map(|merit| (Side::First, merit));
                first.or_else(|| b.merit_over(a).map(|merit| (Side::Second, merit)))
            }
        }
    }
}

impl MeshGeometry {
    /// Why this copy of a surface is more exact than another one, by either mesh alone; `None` if it is not.
    /// [`Relation::more_exact`] knows how they lie, too, and tells noise from detail.
    ///
    /// ```
    /// use canonform_relations::{Merit, MeshGeometry};
    /// use mesh::shapes;
    ///
    /// let [cube, finer] = [1, 3].map(|n| MeshGeometry::new(&shapes::cube(n), None).unwrap());
    /// assert_eq!((cube.merit_over(&finer), finer.merit_over(&cube)), (Some(Merit::Plain), None));
    /// ```
    pub fn merit_over(&self, other: &Self) -> Option<Merit> {
        let [own, others] = [self.exactness(), other.exactness()];
        let needs_more = |a: usize, b: usize| a as f64 > (1.0 + ABOUT) * b as f64;
        let [is_closed, is_other_closed] = [self, other].map(|mesh| mesh.closed().is_some());
        if is_closed != is_other_closed {
            is_closed.then_some(Merit::Closed)
        } else if needs_more(own.n_needed, others.n_needed) {
            Some(Merit::Detailed)
        } else {
            let is_plainer = self.n_vertices() < other.n_vertices();
            (is_plainer && !needs_more(others.n_needed, own.n_needed)).then_some(Merit::Plain)
        }
    }

    /// Whether this copy of a surface bends so much more than another one that it may have noise.
    fn is_rougher(&self, other: &Self) -> bool {
        let same_counts = self.n_vertices() == other.n_vertices() && self.n_faces() == other.n_faces();
        let is_by_planes = || {
            let [more, less] = [self, other].map(|mesh| mesh.noise().unwrap_or_default());
            (self.is_mechanical() || other.is_mechanical()) && more > less + ROUNDING && more > 2.0 * less
        };
        self.bends_more(ROUGH, other) || self.bends_more(ONE_NORMAL, other) && (same_counts || is_by_planes())
    }

    fn bends_more(&self, by: f64, other: &Self) -> bool {
        self.exactness().bending > (1.0 + by) * other.exactness().bending
    }

    pub(super) fn exactness(&self) -> &Exactness {
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
                n_needed: around.iter().filter(|known| known.len() == 3).count(),
                bending: turns.sum(),
            }
        })
    }
}
