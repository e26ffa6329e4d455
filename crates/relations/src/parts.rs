//! A mesh among the components of another.

use descriptors::Side;
use rigid::{Alignment, Gap, align_surfaces};
use serde::Serialize;

use super::SIZE_OF_SURFACES;
use super::calibration::FEW;
use super::exact::{SameVertices, same_vertices};
use super::geometry::MeshGeometry;
use super::mesh_change::mesh_change;
use super::same_surface::same_surface;

/// How often one mesh occurs among the components of the other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Parts {
    /// The mesh whose components were searched.
    pub whole: Side,
    /// Components that are the other mesh.
    pub found: usize,
    /// Components with at least a thousandth of the area.
    pub components: usize,
}

/// A component that is a copy of a mesh, or the worst of several.
#[derive(Debug, Clone, Copy)]
pub(super) struct PartCopy {
    /// Size of the copy over that of the mesh.
    pub(super) scale: f64,
    pub(super) mirrored: bool,
    /// How far the surfaces are apart, unless they have the same vertices.
    pub(super) gap: Option<Gap>,
    /// Probability that it is a copy.
    pub(super) confidence: f64,
}

/// The number of copies of a mesh with one large component, of one size, among the components of `whole`, and what is true of all of them.
/// `None` if there are none, or if `whole` has one component.
pub(super) fn occurrences(mesh: &MeshGeometry, whole: &MeshGeometry) -> Option<(usize, PartCopy)> {
    let parts = whole.parts();
    // Crumbs beside a surface are not compared.
    let mesh = match mesh.parts() {
        [] if mesh.n_components() == 1 => mesh,
        [only] => only,
        _ => return None,
    };
    if parts.is_empty() {
        return None;
    }
    // Equal components are compared once.
    let mut kinds: Vec<(&MeshGeometry, Option<PartCopy>)> = Vec::new();
    let mut copies: Vec<PartCopy> = Vec::new();
    for part in parts {
        let known = kinds.iter().find_map(|(kind, copy)| {
            let same = same_vertices(kind, part).filter(|same| same.same_faces)?;
            Some(copy.map(|copy| PartCopy {
                scale: copy.scale * part.size() / kind.size(),
                mirrored: copy.mirrored != same.map.reflected,
                ..copy
            }))
        });
        let copy = known.unwrap_or_else(|| {
            let copy = copy_of(mesh, part, kinds.len() < FEW.get());
            kinds.push((part, copy));
            copy
        });
        copies.extend(copy);
    }
    // The size of most, the larger size of equally many.
    let alike = |copy: &PartCopy| {
        copies
            .iter()
            .filter(|other| (other.scale / copy.scale).ln().abs() < SIZE_OF_SURFACES)
            .copied()
            .collect::<Vec<_>>()
    };
    let found = copies
        .iter()
        .map(alike)
        .max_by(|x, y| x.len().cmp(&y.len()).then(y[0].scale.total_cmp(&x[0].scale)))?;
    let gaps = found.iter().filter_map(|copy| copy.gap);
    let worst = PartCopy {
        scale: found[0].scale,
        mirrored: found.iter().all(|copy| copy.mirrored),
        gap: gaps.max_by(|x, y| x.rms.total_cmp(&y.rms)),
        confidence: found.iter().map(|copy| copy.confidence).fold(1.0, f64::min),
    };
    Some((found.len(), worst))
}

fn copy_of(mesh: &MeshGeometry, part: &MeshGeometry, align: bool) -> Option<PartCopy> {
    let sizes = part.size() / mesh.size();
    if let Some(SameVertices { map, .. }) = same_vertices(mesh, part) {
        let (scale, mirrored) = (map.scale * sizes, map.reflected);
        return Some(PartCopy { scale, mirrored, gap: None, confidence: 1.0 });
    }
    let aligned = if align { align_surfaces(&mesh.surface, &part.surface)? } else { return None };
    let Alignment { map, gap } = aligned;
    let [_, confidence] = same_surface(&aligned, [mesh, part], mesh_change([mesh, part], &map));
    let (scale, mirrored) = (map.scale * sizes, map.reflected);
    (confidence > 0.5).then_some(PartCopy { scale, mirrored, gap: Some(gap), confidence })
}

impl MeshGeometry {
    /// The components with at least a thousandth of the area, and how many copies there are of each, largest first; none if there
    /// is only one. Copies have the same vertices and faces.
    pub fn different_components(&self) -> Vec<(&Self, usize)> {
        let mut kinds: Vec<(&Self, usize)> = Vec::new();
        for part in self.parts() {
            let is_copy = |kind: &Self| {
                (part.size() / kind.size()).ln().abs() < SIZE_OF_SURFACES
                    && same_vertices(kind, part).is_some_and(|same| same.same_faces && !same.map.reflected)
            };
            match kinds.iter_mut().find(|(kind, _)| is_copy(kind)) {
                Some((_, copies)) => *copies += 1,
                None => kinds.push((part, 1)),
            }
        }
        kinds
    }
}
