//! A mesh whose triangles are some of those of another mesh: cut out of it.

use std::collections::HashSet;

use descriptors::Side;
use nalgebra::Point3;
use rigid::{NearestPoints, Similarity};
use serde::Serialize;
use surface::VertexId;

use super::calibration::FEW;
use super::exact::LEVERAGE;
use super::geometry::MeshGeometry;
use super::units::UnitChange;

/// The least share of the faces of a piece that are faces of the whole: cutting makes new ones along the cut only. With .3, other
/// bodies are called pieces; with 1, nothing is.
const MIN_SHARED: f64 = 0.6;

/// The largest share of the whole that a piece has; with more it is another triangulation. Pieces of 90 % must be found, and a
/// surface with small holes is no piece.
const MAX_LEFT: f64 = 0.98;

/// The least share that is looked for in another unit of length. It saves time and changes no answer.
const MIN_LEFT: f64 = 0.1;

/// A piece of a surface that was cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CutPiece {
    /// The mesh that the other one was cut out of.
    pub whole: Side,
    /// The share of its area that is left.
    pub left: f64,
}

/// What is left of `whole` if `piece` was cut out of it and perhaps moved or written in another unit of length, and lengths of
/// the piece over those of the whole. It is asked only of meshes that are not one surface and of which neither has the other as
/// a component.
pub(super) fn piece_of(side: Side, whole: &MeshGeometry, piece: &MeshGeometry) -> Option<(CutPiece, f64)> {
    #[cfg(test)]
    tests::SEARCHES.set(tests::SEARCHES.get() + 1);
    if piece.n_faces() < FEW.get() || piece.n_faces() > whole.n_faces() {
        return None;
    }
    let left = |factor: f64| (piece.size() / (factor * whole.size())).powi(2);
    let is_possible =
        |factor: &f64| left(*factor) <= MAX_LEFT && (*factor == 1.0 || left(*factor) >= MIN_LEFT);
    let units = UnitChange::all().map(|(_, factor)| factor);
    let mut factors = std::iter::once(1.0).chain(units).filter(is_possible).peekable();
    factors.peek()?;
    let search = PieceSearch::new(whole, piece)?;
    let factor = factors.find(|factor| search.finds(*factor))?;
    Some((CutPiece { whole: side, left: left(factor) }, factor))
}

struct PieceSearch<'a> {
    whole: &'a MeshGeometry,
    piece: &'a MeshGeometry,
    vertices: NearestPoints,
    /// The corners of all faces of the whole by the lengths of the opposite sides, and these lengths.
    corners: Vec<[usize; 3]>,
    sides: NearestPoints,
    /// Some of the largest faces of the piece: they say most precisely how it lies.
    tried: Vec<[VertexId; 3]>,
}

impl<'a> PieceSearch<'a> {
    fn new(whole: &'a MeshGeometry, piece: &'a MeshGeometry) -> Option<Self> {
        let positions = &whole.mesh().positions;
        let corners: Vec<[usize; 3]> =
            whole.mesh().faces.iter().map(|face| by_sides(*face, positions)).collect();
        let sides = NearestPoints::new(corners.iter().map(|face| sides(*face, positions)).collect()).ok()?;
        let areas: Vec<f64> = piece.mesh().face_areas().collect();
        let mut order: Vec<usize> = (0..areas.len()).collect();
        order.sort_by(|&f, &g| areas[g].total_cmp(&areas[f]).then(f.cmp(&g)));
        let step = (order.len() / (2 * FEW.get())).max(1);
        let tried = order.into_iter().step_by(step).take(FEW.get()).map(|f| piece.mesh().faces[f]).collect();
        Some(Self {
            whole,
            piece,
            vertices: NearestPoints::new(positions.clone()).ok()?,
            corners,
            sides,
            tried,
        })
    }

    /// Whether the piece lies in the whole if its lengths are multiplied by this factor.
    fn finds(&self, factor: f64) -> bool {
        let (whole, piece) = (self.whole, self.piece);
        let scale = piece.size() / (factor * whole.size());
        // Vertices and the centroids are rounded.
        let tolerance = 2.0 * (whole.rounding() + piece.rounding() * scale);
        let points: Vec<Point3<f64>> = piece.mesh().positions.iter().map(|p| p * scale).collect();
        // A piece that stayed in place has its own center.
        let shift = (piece.surface.center.coords / factor - whole.surface.center.coords) / whole.size();
        let in_place = Similarity { translation: shift, ..Similarity::identity() };
        // Motions that take a face of the piece to one of the whole with the same sides.
        let by_faces = self.tried.iter().flat_map(|face| {
            let own = by_sides(*face, &points);
            // Both ends of a side are off.
            let near = self.sides.near(&sides(own, &points), 2.0 * tolerance, FEW);
            let pairs =
                |g: usize| [0, 1, 2].map(|i| (points[own[i]], whole.mesh().positions[self.corners[g][i]]));
            near.into_iter().filter_map(|g| Similarity::fit_motion(&pairs(g), false)).collect::<Vec<_>>()
        });
        std::iter::once(in_place).chain(by_faces).any(|motion| self.shares_faces(&points, tolerance, &motion))
    }

    /// Whether enough faces of the piece are faces of the whole, once the motion is made precise.
    fn shares_faces(&self, points: &[Point3<f64>], tolerance: f64, motion: &Similarity) -> bool {
        let off = LEVERAGE * tolerance;
        let is_near = |p: &Point3<f64>| self.vertices.nearest(&motion.apply(p)).1 <= off * off;
        let probes = || points.iter().step_by((points.len() / FEW).max(1));
        if (probes().filter(|p| is_near(p)).count() as f64) < MIN_SHARED * probes().count() as f64 {
            return false;
        }
        let partner =
            |p: &Point3<f64>| self.whole.mesh().positions[self.vertices.nearest(&motion.apply(p)).0];
        let pairs: Vec<_> = points.iter().filter(|p| is_near(p)).map(|p| (*p, partner(p))).collect();
        let Some(precise) = Similarity::fit_motion(&pairs, false) else { return false };
        let partner = |p: &Point3<f64>| {
            let (i, sq) = self.vertices.nearest(&precise.apply(p));
            (sq <= tolerance * tolerance).then(|| VertexId::from(i))
        };
        let partners: Vec<Option<VertexId>> = points.iter().map(partner).collect();
        let known: HashSet<[VertexId; 3]> =
            self.whole.mesh().faces.iter().map(|face| VertexId::sorted(*face)).collect();
        let is_shared = |face: &&[VertexId; 3]| match face.map(|v| partners[v.index()]) {
            [Some(a), Some(b), Some(c)] => known.contains(&VertexId::sorted([a, b, c])),
            _ => false,
        };
        let n_shared = self.piece.mesh().faces.iter().filter(is_shared).count();
        n_shared >= FEW.get() && n_shared as f64 >= MIN_SHARED * self.piece.n_faces() as f64
    }
}

/// The corners of a face, each opposite a side, the shortest side first.
fn by_sides(face: [VertexId; 3], positions: &[Point3<f64>]) -> [usize; 3] {
    let face = face.map(VertexId::index);
    let lengths = sides(face, positions);
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| lengths[i].total_cmp(&lengths[j]));
    order.map(|i| face[i])
}

/// The lengths of the sides opposite its corners.
fn sides([a, b, c]: [usize; 3], positions: &[Point3<f64>]) -> Point3<f64> {
    let length = |p: usize, q: usize| (positions[p] - positions[q]).norm();
    Point3::new(length(b, c), length(c, a), length(a, b))
}

#[cfg(test)]
mod tests {
    use mesh::TriMesh;
    use mesh::shapes::{cube, disjoint, icosphere, lopsided_torus, subdivide};
    use nalgebra::{Rotation3, Vector3};

    use super::*;
    use crate::RelationKind;
    use crate::tests::related;

    thread_local! {
        pub(super) static SEARCHES: std::cell::Cell<usize> = const { std::cell::Cell::new(0) };
    }

    #[test]
    fn no_piece_is_looked_for_where_something_whole_fits() {
        let (ring, ball) = (lopsided_torus(), icosphere(2));
        let mut inches = ring.clone();
        inches.positions.iter_mut().for_each(|p| *p /= 25.4);
        let mut beside = ring.clone();
        beside.positions.iter_mut().for_each(|p| p.x += 9.0);
        let plate = disjoint(&[beside, ball.clone()]);
        let searched = |a: &TriMesh, b: &TriMesh| {
            let [a, b] = [a, b].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
            SEARCHES.set(0);
            (related(&a, &b).kind, SEARCHES.get())
        };
        for (other, kind) in [
            (&ring, RelationKind::IdenticalGeometry),
            (&inches, RelationKind::Scaled),
            (&subdivide(&inches), RelationKind::Remeshed),
            (&plate, RelationKind::PartOf),
        ] {
            assert_eq!(searched(&ring, other), (kind, 0));
        }
        assert_eq!(searched(&ball, &subdivide(&cube(3))).1, 2);
    }

    #[test]
    fn a_piece_is_found_in_the_whole_wherever_it_lies() {
        let whole = lopsided_torus();
        let turn = Rotation3::from_euler_angles(0.3, 2.0, -1.0);
        for height in [-0.5, 0.2, 0.6] {
            let above = |face: &&[VertexId; 3]| face.iter().all(|v| whole.positions[v.index()].x > height);
            let faces = whole.faces.iter().filter(above).copied().collect();
            let mut piece = TriMesh { faces, ..whole.clone() }.without_unused_vertices();
            let share = piece.area() / whole.area();
            piece.positions.iter_mut().for_each(|p| *p = turn * *p + Vector3::new(4.0, 1.0, 2.0));
            for factor in [1.0, 25.4] {
                let piece = testkit::moved(&piece, |p| p * factor);
                let [a, b] = [&whole, &piece].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
                let (cut, by) = piece_of(Side::First, &a, &b).unwrap();
                assert!((cut.left - share).abs() < 1e-9 && by == factor, "{cut:?}, {share}");
                assert!(piece_of(Side::First, &b, &a).is_none());
            }
        }
        let [a, b] = [&whole, &icosphere(2)].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
        assert!(piece_of(Side::First, &a, &b).is_none());
    }
}
