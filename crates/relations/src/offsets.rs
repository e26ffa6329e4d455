//! Systematic offsets between two surfaces of parts: what is left of their distance where independent noise averages out.
//!
//! ```text
//! vertices of one mesh -> offsets from the faces of the other, along their normals -> without the best small motion and change of
//! size -> means over regions, beyond their standard errors -> in multiples of what triangles and rounding explain
//! ```

use std::collections::{BTreeMap, HashSet};

use mesh::RegionShape;
use nalgebra::{Point3, Vector3};
use rigid::{MIN_DAMPING, Similarity, fitted_step, moved_along};
use surface::VertexId;

use super::calibration::{FLUSH, STANDARD_ERRORS};
use super::geometry::{MAX_ROUNDING, MeshGeometry};
use super::noise::MIN_COSINE;

/// Where a vertex of one mesh is beside a region of the other. Of vertices with several faces there, sums over them.
struct Contact {
    n: f64,
    at: Point3<f64>,
    normal: Vector3<f64>,
    offset: f64,
    /// What triangles and rounding explain.
    allowed: f64,
    /// The vertices of the nearest faces.
    on: Vec<VertexId>,
}

/// Contacts of a region, or of those in it whose normals have one main direction.
type Patch = (usize, Option<(usize, bool)>);

/// The largest systematic offset between two parts, in multiples of what triangles and rounding explain, under a map of the first
/// onto the second; `noise` is that of each. `None` if the meshes have too few vertices.
pub(super) fn systematic_offset(
    [a, b]: [&MeshGeometry; 2],
    noise: [f64; 2],
    map: &Similarity,
) -> Option<f64> {
    let is_first = match noise[0] - noise[1] {
        more if more > MAX_ROUNDING => true,
        more if more < -MAX_ROUNDING => false,
        _ => a.n_faces() >= b.n_faces(),
    };
    // Normals and regions of the one with less noise.
    let (from, to, map, noise) =
        if is_first { (a, b, *map, noise) } else { (b, a, map.inverse(), [noise[1], noise[0]]) };
    let mut contacts = contacts(from, to, &map);
    without_motion(&mut contacts, noise)?;
    let mut patches: BTreeMap<Patch, Vec<&Contact>> = BTreeMap::new();
    let mut whole: BTreeMap<Patch, Vec<&Contact>> = BTreeMap::new();
    for (region, contact) in &contacts {
        let axis = contact.normal.iamax();
        patches.entry((*region, Some((axis, contact.normal[axis] > 0.0)))).or_default().push(contact);
        whole.entry((*region, None)).or_default().push(contact);
    }
    // Deviations from the means of patches are noise, and little of them curvature.
    let mean =
        |all: &[&Contact], of: fn(&Contact) -> f64| all.iter().map(|c| of(c)).sum::<f64>() / all.len() as f64;
    let square = |all: &Vec<&Contact>| {
        let middle = mean(all, |contact| contact.offset);
        all.iter().map(|contact| (contact.offset - middle).powi(2)).sum::<f64>()
    };
    let n_free = contacts.len().checked_sub(patches.len() + 7).filter(|n| *n > 0)?;
    let variance = patches.values().map(square).sum::<f64>() / n_free as f64;
    let beyond = |(_, all): (&Patch, &Vec<&Contact>)| {
        let n_on = all.iter().flat_map(|contact| &contact.on).collect::<HashSet<_>>().len();
        let error = (variance / all.len() as f64 + noise[1].powi(2) / n_on as f64).sqrt();
        let offset = mean(all, |contact| contact.offset).abs() - STANDARD_ERRORS * error;
        offset / mean(all, |contact| contact.allowed)
    };
    patches.iter().chain(&whole).map(beyond).reduce(f64::max)
}

/// Vertices of one mesh beside each region of the other that faces at them lie on.
fn contacts(from: &MeshGeometry, to: &MeshGeometry, map: &Similarity) -> Vec<(usize, Contact)> {
    let regions = to.surface.regions();
    let own_chords = &from.surface.regions().chord_errors;
    let rounding = FLUSH + from.rounding() + to.rounding();
    let mut found: BTreeMap<(usize, VertexId), Contact> = BTreeMap::new();
    for f in from.some_faces() {
        let corners = from.mesh().triangle(f).map(|p| map.apply(&p));
        let Some(own) = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).try_normalize(0.0) else {
            continue;
        };
        let center = Point3::from(corners.iter().map(|p| p.coords).sum::<Vector3<f64>>() / 3.0);
        for (v, p) in from.mesh().faces[f].into_iter().zip(corners) {
            // A vertex at a sharp edge belongs to the region where its face is.
            let Some(near) = to.surface.tree().nearest(&nalgebra::center(&p, &center)) else { continue };
            if near.normal.dot(&own).abs() < MIN_COSINE {
                continue;
            }
            let region = regions.of_face[near.face];
            let chords = match regions.all[region].shape {
                RegionShape::Plane { .. } => 0.0,
                _ => regions.chord_errors[near.face] + own_chords[f] * map.scale,
            };
            let contact = found.entry((region, v)).or_insert_with(|| Contact {
                n: 0.0,
                at: p,
                normal: Vector3::zeros(),
                offset: 0.0,
                allowed: 0.0,
                on: Vec::new(),
            });
            contact.n += 1.0;
            contact.normal += near.normal;
            contact.offset += near.normal.dot(&(p - near.point));
            contact.allowed += rounding + chords;
            contact.on.extend(to.mesh().faces[near.face]);
        }
    }
    let mean = |((region, _), contact): ((usize, VertexId), Contact)| {
        let Contact { n, normal, offset, allowed, .. } = contact;
        (region, Contact { normal: normal / n, offset: offset / n, allowed: allowed / n, ..contact })
    };
    found.into_iter().map(mean).collect()
}

/// Takes the small motion and change of size from offsets that explains most of them.
fn without_motion(contacts: &mut [(usize, Contact)], noise: [f64; 2]) -> Option<()> {
    let row = |contact: &Contact| moved_along(&contact.at, &contact.normal);
    let weighted = |(_, contact): &(usize, Contact)| {
        let variance = noise[0].powi(2) + noise[1].powi(2) + contact.allowed.powi(2);
        (row(contact), contact.offset, 1.0 / variance)
    };
    let step = fitted_step(contacts.iter().map(weighted), MIN_DAMPING)?;
    contacts.iter_mut().for_each(|(_, contact)| contact.offset -= row(contact).dot(&step));
    Some(())
}
