//! Whether two surfaces are one, by their distance in space.
//!
//! Two triangulations of one surface differ by the error of flat triangles: at most the height of the arcs that stand over
//! them. What else differs is a difference of the surfaces, and one that is measured anywhere is enough.

use nalgebra::Point3;
use rigid::{Alignment, NearestPoints, Similarity};
use surface::VertexId;

use super::Change;
use super::calibration::{
    ALLOWED, ARCS, CHORDS, EXACT, FARTHEST, LARGEST, MAX_NOISE, NOISE, PARTS, SAME_SURFACE,
};
use super::exact::{Fitted, SameVertices};
use super::geometry::MeshGeometry;
use super::mesh_change::systematic_displacement;
use super::noise::noise_of_parts;
use super::offsets::systematic_offset;

/// How far two surfaces are apart, in multiples of what copies of one may be, and the probability that they are one.
pub(super) fn same_surface(aligned: &Alignment, meshes: [&MeshGeometry; 2], change: Change) -> [f64; 2] {
    let ratio = match noise_of_parts(meshes) {
        Some(noise) => part_ratio(aligned, meshes, noise),
        None => body_ratio(aligned, meshes, change),
    };
    [ratio, SAME_SURFACE.probability(ratio)]
}

/// Organic surfaces: the root mean square decides, unless the largest distance is out of proportion.
fn body_ratio(aligned: &Alignment, meshes: [&MeshGeometry; 2], change: Change) -> f64 {
    let allowed = match change {
        Change::Noisy => MAX_NOISE,
        _ => allowed_in_bodies(
            meshes.map(rms_chord_error).iter().sum(),
            meshes.iter().any(|mesh| mesh.is_noisy()),
        ),
    };
    // What vertices have in common with their neighbors counts as it does without noise.
    let systematic = if change == Change::Noisy { systematic_displacement(meshes) / ALLOWED } else { 0.0 };
    systematic.max(aligned.gap.rms.max(aligned.gap.max / LARGEST) / allowed)
}

/// How far copies of a body with other triangles may be apart, root mean square; `chords` is the error of flat triangles in both.
pub(super) fn allowed_in_bodies(chords: f64, is_noisy: bool) -> f64 {
    ALLOWED + CHORDS * chords + if is_noisy { NOISE } else { 0.0 }
}

/// Whether the faces between the same vertices make up one surface.
pub(super) fn is_one_surface(same: &SameVertices, meshes: [&MeshGeometry; 2]) -> bool {
    let [a, b] = meshes;
    Alignment::by_map(&a.surface, &b.surface, same.map)
        .is_some_and(|aligned| same_surface(&aligned, meshes, Change::Remeshed)[1] > 0.5)
}

pub(super) fn rms_chord_error(mesh: &MeshGeometry) -> f64 {
    let errors = mesh.surface.regions().chord_errors.iter();
    mesh.mesh().face_areas().zip(errors).map(|(area, error)| area * error * error).sum::<f64>().sqrt()
}

/// Mechanical surfaces: no point of either may be farther from the other than arcs, rounding and noise explain, no region where noise
/// averages out, and closed ones have equally many handles.
fn part_ratio(aligned: &Alignment, [a, b]: [&MeshGeometry; 2], noise: [f64; 2]) -> f64 {
    if matches!([a, b].map(MeshGeometry::closed), [Some((_, x)), Some((_, y))] if x != y) {
        return f64::INFINITY;
    }
    let worst = worst([a, b], &aligned.map).max(worst([b, a], &aligned.map.inverse()));
    let worst = worst.max(displaced(aligned, [a, b]).unwrap_or(0.0)) / PARTS;
    worst.max(systematic_offset([a, b], noise, &aligned.map).unwrap_or(0.0))
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
    Some(gap / allowed([a, b]))
}

/// How far points of one surface may be from those of the other: by rounding, other diagonals and noise.
fn allowed(meshes: [&MeshGeometry; 2]) -> f64 {
    let noise: f64 = noise_of_parts(meshes).unwrap_or_default().iter().sum();
    EXACT + meshes.iter().map(|mesh| mesh.rounding()).sum::<f64>() + FARTHEST * noise
}

/// The largest distance from points of one surface to the other, in multiples of what is allowed there.
fn worst([a, b]: [&MeshGeometry; 2], map: &Similarity) -> f64 {
    let [errors_a, errors_b] = [a, b].map(|mesh| &mesh.surface.regions().chord_errors);
    let rounding = allowed([a, b]);
    // Probes are near the ones before them, as a rule.
    let mut known = None;
    let probe = |(p, error): (Point3<f64>, f64)| {
        let near = b.surface.tree().nearest_from(&map.apply(&p), known.as_ref())?;
        known = Some(near.point);
        let allowed = rounding + ARCS * (error * map.scale + errors_b[near.face]);
        Some(near.sq_distance.sqrt() / allowed)
    };
    probes(a, errors_a).into_iter().filter_map(probe).fold(0.0, f64::max)
}

/// Corners, middles of edges and centers of faces, with the least error of a face that each lies in: small features have
/// them too, where points at random may miss them.
fn probes(geometry: &MeshGeometry, errors: &[f64]) -> Vec<(Point3<f64>, f64)> {
    let (mesh, chosen) = (geometry.mesh(), geometry.some_faces());
    let of_face = |f: usize| {
        let [a, b, c] = mesh.faces[f];
        [[a, a], [b, b], [c, c], [a, b], [b, c], [c, a]].map(|[v, w]| ([v.min(w), v.max(w)], errors[f]))
    };
    let mut shared: Vec<_> = chosen.clone().flat_map(of_face).collect();
    shared.sort_unstable_by(|(v, x), (w, y)| v.cmp(w).then(x.total_cmp(y)));
    shared.dedup_by_key(|(ends, _)| *ends);
    let center = |f: usize| {
        let [a, b, c] = mesh.triangle(f);
        (nalgebra::center(&nalgebra::center(&a, &b), &c), errors[f])
    };
    let middle = |(ends, error): ([VertexId; 2], f64)| {
        let [p, q] = ends.map(|v| mesh.positions[v.index()]);
        (nalgebra::center(&p, &q), error)
    };
    shared.into_iter().map(middle).chain(chosen.map(center)).collect()
}
