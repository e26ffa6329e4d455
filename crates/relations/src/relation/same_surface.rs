//! Whether two surfaces are one, by their distance in space.
//!
//! Two triangulations of one surface differ by the error of flat triangles: at most the height of the arcs that stand over
//! them. What else differs is a difference of the surfaces, and one that is measured anywhere is enough.

use descriptors::Boundary;
use nalgebra::Point3;
use rigid::{Alignment, NearestPoints, Similarity};
use surface::Topology;

use super::Change;
use super::exact::{Fitted, SameVertices};
use super::geometry::MeshGeometry;

/// What is allowed in copies of one organic surface besides the error of flat triangles, root mean square, relative to the
/// size. Measured on the built-in families with 200 to 10,000 vertices (`cargo test -p tests --test laws -- matches
/// --nocapture`). Two bodies of one family in one pose are at least 0.0045 apart there, two poses 0.037.
const ALLOWED: f64 = 0.0015;

/// Decimated copies are at most this far apart, root mean square, in multiples of the error of flat triangles in both. Chosen
/// so that all copies measured as [`ALLOWED`] and of 64 generated parts are told.
const CHORDS: f64 = 1.3;

/// The same, times the number of vertices of the coarser copy. Measured as [`ALLOWED`], where decimation to a fifth brings
/// the largest, 0.7. On limbs of few triangles the heights of arcs are overestimated, and on flat surfaces this is.
const FLATNESS: f64 = 1.4;

/// What noise adds: 0.5 % of the diagonal is 0.0054, measured as [`ALLOWED`].
const ALLOWED_NOISE: f64 = 0.006;

/// How far vertices may be apart on which independent noise is the only change, which needs no small distance to be told.
/// A safety limit.
const MOST_NOISE: f64 = 0.02;

/// The odds of one surface are `(limit / distance)^STEEPNESS`. The distances measured as [`ALLOWED`] are then told with 90 %
/// and more.
const STEEPNESS: f64 = 6.0;

/// The largest distance of copies, in multiples of the limit of their root mean square. Chosen as [`CHORDS`].
const LARGEST: f64 = 20.0;

/// What is allowed everywhere in copies of a mechanical surface besides the error of flat triangles, relative to the size.
/// Chosen on 64 generated parts of seed 0 and checked on others (`experiments run evidence`).
const EXACT: f64 = 4e-4;

/// The error of flat triangles that counts in copies of a mechanical surface, in multiples of the height of the arcs. Chosen as
/// [`EXACT`].
const ARCS: f64 = 1.5;

/// Odds of a mechanical surface by its largest distance, in multiples of what is allowed. Chosen as [`EXACT`].
const SAME_PART: Boundary = Boundary::new(1.6, 8.0);

/// Most probes of either surface.
const MOST_PROBES: usize = 12_000;

/// What is measured is never certain: only equal files and vertices are.
const MOST_CERTAIN: f64 = 0.99;

/// The probability that surfaces this far apart are one surface.
pub(super) fn same_surface(aligned: &Alignment, meshes: [&MeshGeometry; 2], change: Change) -> f64 {
    let probability = match meshes.map(MeshGeometry::is_mechanical) {
        [true, true] => same_part(aligned, meshes),
        _ => same_body(aligned, meshes, change),
    };
    probability.min(MOST_CERTAIN)
}

/// Organic surfaces: the root mean square decides, unless the largest distance is out of proportion.
fn same_body(aligned: &Alignment, meshes: [&MeshGeometry; 2], change: Change) -> f64 {
    let fewest = meshes.map(MeshGeometry::n_vertices).into_iter().min().unwrap_or(1).max(1);
    let chords: f64 = meshes.map(rms_chord_error).iter().sum();
    let flatness = f64::min(CHORDS * chords, FLATNESS / fewest as f64);
    let at = match change {
        Change::Noisy => MOST_NOISE,
        _ if meshes.iter().any(|mesh| mesh.is_noisy()) => ALLOWED + ALLOWED_NOISE + flatness,
        _ => ALLOWED + flatness,
    };
    let gap = aligned.gap;
    Boundary::new(at, STEEPNESS).probability(gap.rms.max(gap.max / LARGEST))
}

/// Whether the faces between the same vertices make up one surface.
pub(super) fn is_one_surface(same: &SameVertices, meshes: [&MeshGeometry; 2]) -> bool {
    let [a, b] = meshes;
    Alignment::by_map(&a.surface, &b.surface, same.map)
        .is_some_and(|aligned| same_surface(&aligned, meshes, Change::Remeshed) > 0.5)
}

pub(super) fn rms_chord_error(mesh: &MeshGeometry) -> f64 {
    let errors = mesh.regions().chord_errors.iter();
    mesh.mesh().face_areas().zip(errors).map(|(area, error)| area * error * error).sum::<f64>().sqrt()
}

/// Mechanical surfaces: no point of either may be farther from the other than arcs and rounding explain, and closed ones
/// have equally many handles.
fn same_part(aligned: &Alignment, [a, b]: [&MeshGeometry; 2]) -> f64 {
    let handles = [a, b].map(euler_characteristic_if_closed);
    if matches!(handles, [Some(x), Some(y)] if x != y) {
        return 0.0;
    }
    let worst = worst([a, b], &aligned.map).max(worst([b, a], &aligned.map.inverse()));
    SAME_PART.probability(worst.max(displaced(aligned, [a, b]).unwrap_or(0.0)))
}

/// How far the vertices of one triangulation are apart, in multiples of what is allowed: they lie on the surface, so arcs do not
/// explain it. `None` unless every vertex has a nearest one of its own, as in two triangulations of one kind.
fn displaced(aligned: &Alignment, [a, b]: [&MeshGeometry; 2]) -> Option<f64> {
    if a.n_vertices() != b.n_vertices() || a.n_faces() != b.n_faces() {
        return None;
    }
    let nearest = NearestPoints::new(b.mesh().positions.clone()).ok()?;
    // A part that is round may be aligned at another angle than its vertices.
    let Fitted { gap, .. } = Fitted::new(&a.mesh().positions, &nearest, &aligned.map, f64::INFINITY)?;
    Some(gap / (EXACT + a.rounding() + b.rounding()))
}

/// The largest distance from points of one surface to the other, in multiples of what is allowed there.
fn worst([a, b]: [&MeshGeometry; 2], map: &Similarity) -> f64 {
    let [errors_a, errors_b] = [a, b].map(|mesh| &mesh.regions().chord_errors);
    let probe = |(p, face): (Point3<f64>, usize)| {
        let near = b.tree().nearest(&map.apply(&p))?;
        let allowed =
            EXACT + a.rounding() + b.rounding() + ARCS * (errors_a[face] * map.scale + errors_b[near.face]);
        Some(near.sq_distance.sqrt() / allowed)
    };
    probes(a).into_iter().filter_map(probe).fold(0.0, f64::max)
}

/// Corners, middles of edges and centres of faces, with the face that each lies in: small features have them too, where
/// points at random may miss them.
fn probes(geometry: &MeshGeometry) -> Vec<(Point3<f64>, usize)> {
    let step = (7 * geometry.n_faces()).div_ceil(MOST_PROBES);
    let of_face = |f: usize| {
        let [a, b, c] = geometry.mesh().triangle(f);
        let centre = nalgebra::center(&nalgebra::center(&a, &b), &c);
        [a, b, c, nalgebra::center(&a, &b), nalgebra::center(&b, &c), nalgebra::center(&c, &a), centre]
            .map(|p| (p, f))
    };
    (0..geometry.n_faces()).step_by(step.max(1)).flat_map(of_face).collect()
}

/// Vertices less edges plus faces, if every edge has two faces.
pub(super) fn euler_characteristic_if_closed(geometry: &MeshGeometry) -> Option<isize> {
    let topology = Topology::new(geometry.n_vertices(), geometry.mesh().faces.clone());
    let edges = 0..topology.n_edges();
    let is_closed = edges.map(surface::EdgeId::from).all(|edge| topology.edge_corners(edge).len() == 2);
    is_closed
        .then(|| geometry.n_vertices() as isize - topology.n_edges() as isize + geometry.n_faces() as isize)
}
