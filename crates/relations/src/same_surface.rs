//! Whether two surfaces are one, by their distance in space.
//!
//! Two triangulations of one surface differ by the error of flat triangles: at most the height of the arcs that stand over
//! them. What else differs is a difference of the surfaces, and one that is measured anywhere is enough.

use std::collections::BTreeMap;

use nalgebra::Point3;
use rigid::{Alignment, NearestPoints, Similarity};
use surface::VertexId;

use super::Change;
use super::calibration::{
    ALLOWED, ARCS, CHORDS, EXACT, FARTHEST, LOST_FACES, MAX_NOISE, NOISE, OUTSIDE, PARTS, SAME_SURFACE,
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

/// Organic surfaces: the root mean square decides, and what sticks out of one of them, such as a longer limb.
fn body_ratio(aligned: &Alignment, [a, b]: [&MeshGeometry; 2], change: Change) -> f64 {
    if change == Change::Noisy {
        // What vertices have in common with their neighbors counts as it does without noise.
        return f64::max(systematic_displacement([a, b]) / ALLOWED, aligned.gap.rms / MAX_NOISE);
    }
    let is_noisy = a.is_noisy() || b.is_noisy();
    let mean = aligned.gap.rms / allowed_in_bodies(rms_chord_error(a) + rms_chord_error(b), is_noisy);
    let ratio = f64::max(outside([a, b], &aligned.map), outside([b, a], &aligned.map.inverse()));
    mean.max(ratio / OUTSIDE)
}

/// How far one body is from the other, in multiples of what is allowed, on more of its surface than may be lost, such as the tip of a
/// finger. Holes are no difference.
fn outside([a, b]: [&MeshGeometry; 2], map: &Similarity) -> f64 {
    let mut probes = distances([a, b], map);
    let total: f64 = probes.iter().map(|probe| probe.area).sum();
    let mut may_be_lost = LOST_FACES * total / a.n_faces().min(b.n_faces()) as f64;
    probes.retain(|probe| !b.mesh().faces[probe.nearest].iter().any(|v| b.rim().contains(v)));
    probes.sort_by(|x, y| y.ratio.total_cmp(&x.ratio));
    let first_kept = probes.into_iter().find(|probe| {
        may_be_lost -= probe.area;
        may_be_lost <= 0.0
    });
    first_kept.map_or(0.0, |probe| probe.ratio)
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
    let [there, back] = [distances([a, b], &aligned.map), distances([b, a], &aligned.map.inverse())];
    let ratios = there.into_iter().chain(back).map(|probe| probe.ratio);
    let worst = ratios.chain(displaced(aligned, [a, b])).fold(0.0, f64::max) / PARTS;
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
    let noise = match noise_of_parts(meshes) {
        Some([a, b]) => a + b,
        None if meshes.iter().any(|mesh| mesh.is_noisy()) => NOISE,
        None => 0.0,
    };
    EXACT + meshes.iter().map(|mesh| mesh.rounding()).sum::<f64>() + FARTHEST * noise
}

/// A point of one surface beside the other.
struct Probe {
    /// The distance, in multiples of what is allowed.
    ratio: f64,
    /// Around it.
    area: f64,
    /// The nearest face.
    nearest: usize,
}

/// The distances of one surface from the other.
fn distances([a, b]: [&MeshGeometry; 2], map: &Similarity) -> Vec<Probe> {
    let [errors_a, errors_b] = [a, b].map(|mesh| &mesh.surface.regions().chord_errors);
    let rounding = allowed([a, b]);
    // Probes are near the ones before them, as a rule.
    let mut known = None;
    let probe = |(p, error, area): (Point3<f64>, f64, f64)| {
        let near = b.surface.tree().nearest_from(&map.apply(&p), known.as_ref())?;
        known = Some(near.point);
        let allowed = rounding + ARCS * (error * map.scale + errors_b[near.face]);
        Some(Probe { ratio: near.sq_distance.sqrt() / allowed, area, nearest: near.face })
    };
    points(a, errors_a).into_iter().filter_map(probe).collect()
}

/// Corners, middles of edges and centers of faces, with the least error of a face that each lies in, and the area around: small features
/// have them too, where points at random may miss them.
fn points(geometry: &MeshGeometry, errors: &[f64]) -> Vec<(Point3<f64>, f64, f64)> {
    let (mesh, chosen) = (geometry.mesh(), geometry.some_faces());
    // Each face has seven.
    let area = |f: usize| mesh.area_vector(f).norm() / 14.0;
    let mut shared: BTreeMap<[VertexId; 2], (f64, f64)> = BTreeMap::new();
    for f in chosen.clone() {
        let ([a, b, c], area) = (mesh.faces[f], area(f));
        for [v, w] in [[a, a], [b, b], [c, c], [a, b], [b, c], [c, a]] {
            let (error, sum) = shared.entry([v.min(w), v.max(w)]).or_insert((f64::INFINITY, 0.0));
            (*error, *sum) = (error.min(errors[f]), *sum + area);
        }
    }
    let center = |f: usize| {
        let [a, b, c] = mesh.triangle(f);
        (nalgebra::center(&nalgebra::center(&a, &b), &c), errors[f], area(f))
    };
    let middle = |(ends, (error, area)): ([VertexId; 2], (f64, f64))| {
        let [p, q] = ends.map(|v| mesh.positions[v.index()]);
        (nalgebra::center(&p, &q), error, area)
    };
    shared.into_iter().map(middle).chain(chosen.map(center)).collect()
}
