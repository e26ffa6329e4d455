//! A mesh whose triangles are some of those of another mesh: cut out of it.

use std::collections::HashSet;
use std::num::NonZero;

use descriptors::Side;
use nalgebra::{Point3, Vector3};
use rigid::{NearestPoints, Similarity};
use serde::Serialize;
use surface::VertexId;

use super::geometry::{MeshGeometry, sorted};
use super::units::UnitChange;

/// The least share of the faces of a piece that are faces of the whole: cutting makes new ones along the cut only. A
/// safety limit.
const LEAST_SHARED: f64 = 0.6;

/// The largest share of the whole that a piece has; with more it is another triangulation. A convention.
const MOST_LEFT: f64 = 0.98;

/// The least share that is looked for in another unit of length. A convention, which saves time.
const LEAST_LEFT: f64 = 0.1;

/// Fewer faces in common may be chance.
const LEAST_FACES: usize = 12;

/// Faces of the piece that are looked for in the whole, and faces of the whole that are tried for each.
const TRIED: usize = 24;
const CANDIDATES: NonZero<usize> = NonZero::new(12).unwrap();

/// Vertices of the piece on which a motion is checked first.
const PROBES: usize = 40;

/// A piece of a surface that was cut.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CutPiece {
    /// The mesh that the other one was cut out of.
    pub whole: Side,
    /// The share of its area that is left.
    pub left: f64,
}

/// A piece of a whole.
pub(super) struct FoundPiece {
    /// The share of the area of the whole that is left.
    pub(super) left: f64,
    /// Lengths of the piece over those of the whole.
    pub(super) factor: f64,
}

/// What is left of `whole` if `piece` was cut out of it and perhaps moved or written in another unit of length.
pub(super) fn piece_of(whole: &MeshGeometry, piece: &MeshGeometry) -> Option<FoundPiece> {
    if piece.n_faces() < LEAST_FACES || piece.n_faces() > whole.n_faces() {
        return None;
    }
    let found = |factor: f64| {
        let scale = piece.size() / (factor * whole.size());
        let left = scale * scale;
        let is_possible = left <= MOST_LEFT && (factor == 1.0 || left >= LEAST_LEFT);
        let search = if is_possible { PieceSearch::new(whole, piece, scale, factor)? } else { return None };
        let is_found = search.candidates().iter().any(|motion| search.shares_faces(motion));
        is_found.then_some(FoundPiece { left, factor })
    };
    std::iter::once(1.0).chain(UnitChange::factors()).find_map(found)
}

struct PieceSearch<'a> {
    whole: &'a MeshGeometry,
    piece: &'a MeshGeometry,
    /// Vertices of the piece at the size of the whole.
    points: Vec<Point3<f64>>,
    vertices: NearestPoints,
    tolerance: f64,
    /// The translation of a piece that was not moved.
    in_place: Vector3<f64>,
}

impl<'a> PieceSearch<'a> {
    fn new(whole: &'a MeshGeometry, piece: &'a MeshGeometry, scale: f64, factor: f64) -> Option<Self> {
        let points = piece.mesh().positions.iter().map(|p| p * scale).collect();
        let vertices = NearestPoints::new(whole.mesh().positions.clone()).ok()?;
        let tolerance = 4.0 * (whole.rounding() + piece.rounding() * scale);
        // A piece that stayed in place has its own centre.
        let in_place =
            (piece.surface.center().coords / factor - whole.surface.center().coords) / whole.size();
        Some(Self { whole, piece, points, vertices, tolerance, in_place })
    }

    /// Motions that take a face of the piece to one of the whole with the same sides. The largest faces are tried: they say
    /// most precisely how the piece lies.
    fn candidates(&self) -> Vec<Similarity> {
        let positions = &self.whole.mesh().positions;
        let ordered = self.whole.mesh().faces.iter().map(|face| by_sides(*face, positions));
        let ordered: Vec<[usize; 3]> = ordered.collect();
        let all_sides: Vec<Point3<f64>> = ordered.iter().map(|face| sides(*face, positions)).collect();
        let Ok(near) = NearestPoints::new(all_sides) else { return Vec::new() };
        let areas: Vec<f64> = self.piece.mesh().face_areas().collect();
        let mut order: Vec<usize> = (0..areas.len()).collect();
        order.sort_by(|&f, &g| areas[g].total_cmp(&areas[f]).then(f.cmp(&g)));
        let step = (order.len() / (2 * TRIED)).max(1);
        let mut motions = vec![Similarity { translation: self.in_place, ..Similarity::identity() }];
        for f in order.into_iter().step_by(step).take(TRIED) {
            let own = by_sides(self.piece.mesh().faces[f], &self.points);
            let wanted = sides(own, &self.points);
            for g in near.near(&wanted, 3.0 * self.tolerance, CANDIDATES) {
                let pairs = [0, 1, 2].map(|i| (self.points[own[i]], positions[ordered[g][i]]));
                motions.extend(Similarity::fit_motion(&pairs, false));
            }
        }
        motions
    }

    /// Whether enough faces of the piece are faces of the whole, once the motion is made precise.
    fn shares_faces(&self, motion: &Similarity) -> bool {
        let off = 30.0 * self.tolerance;
        let is_near = |p: &Point3<f64>| self.vertices.nearest(&motion.apply(p)).1 <= off * off;
        let step = (self.points.len() / PROBES).max(1);
        let probes = || self.points.iter().step_by(step);
        if (probes().filter(|p| is_near(p)).count() as f64) < LEAST_SHARED * probes().count() as f64 {
            return false;
        }
        let pairs: Vec<_> = self
            .points
            .iter()
            .filter(|p| is_near(p))
            .map(|p| (*p, self.whole.mesh().positions[self.vertices.nearest(&motion.apply(p)).0]))
            .collect();
        let Some(precise) = Similarity::fit_motion(&pairs, false) else { return false };
        let partner = |p: &Point3<f64>| {
            let (i, sq) = self.vertices.nearest(&precise.apply(p));
            (sq <= self.tolerance * self.tolerance).then(|| VertexId::from(i))
        };
        let partners: Vec<Option<VertexId>> = self.points.iter().map(partner).collect();
        let known: HashSet<[VertexId; 3]> =
            self.whole.mesh().faces.iter().map(|face| sorted(*face)).collect();
        let is_shared = |face: &&[VertexId; 3]| match face.map(|v| partners[v.index()]) {
            [Some(a), Some(b), Some(c)] => known.contains(&sorted([a, b, c])),
            _ => false,
        };
        let n_shared = self.piece.mesh().faces.iter().filter(is_shared).count();
        n_shared >= LEAST_FACES && n_shared as f64 >= LEAST_SHARED * self.piece.n_faces() as f64
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
    use nalgebra::{Rotation3, Vector3};

    use super::*;
    use mesh::shapes::lopsided_torus;

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
                let piece = TriMesh {
                    positions: piece.positions.iter().map(|p| p * factor).collect(),
                    faces: piece.faces.clone(),
                };
                let [a, b] = [&whole, &piece].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
                let found = piece_of(&a, &b).unwrap();
                assert!(
                    (found.left - share).abs() < 1e-9 && found.factor == factor,
                    "{}, {share}",
                    found.left
                );
                assert!(piece_of(&b, &a).is_none());
            }
        }
        let [a, b] = [&whole, &mesh::shapes::icosphere(2)].map(|mesh| MeshGeometry::new(mesh, None).unwrap());
        assert!(piece_of(&a, &b).is_none());
    }
}
