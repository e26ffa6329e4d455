//! A mesh among the components of another.

use serde::Serialize;

use super::SIZE_OF_SURFACES;
use super::exact::{SameVertices, same_vertices};
use super::geometry::MeshGeometry;
use super::in_space::{Aligned, SurfaceGap, aligned};
use super::mesh_change::MeshChange;
use super::same_surface::same_surface;

/// Most different components that are aligned with a mesh.
const MOST_ALIGNED: usize = 20;

/// One of two meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The first mesh.
    First,
    /// The second mesh.
    Second,
}

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

/// The occurrences of a mesh among the components of another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Occurrences {
    pub(super) found: usize,
    pub(super) components: usize,
    /// Size of the copies over that of the mesh.
    pub(super) scale: f64,
    pub(super) mirrored: bool,
    /// How far the worst copy is apart, unless all have the same vertices.
    pub(super) gap: Option<SurfaceGap>,
    pub(super) same_vertices: bool,
    /// Probability that the least certain copy is one.
    pub(super) confidence: f64,
}

/// One component beside the mesh that it may be a copy of.
#[derive(Debug, Clone, Copy)]
struct PartCopy {
    scale: f64,
    mirrored: bool,
    gap: Option<SurfaceGap>,
    confidence: f64,
}

/// Searches the components of `whole` for copies of a connected mesh, of one size. `None` if there are none, or if `whole` has
/// one component.
pub(super) fn occurrences(mesh: &MeshGeometry, whole: &MeshGeometry) -> Option<Occurrences> {
    let parts = whole.parts();
    if mesh.n_components() > 1 || parts.is_empty() {
        return None;
    }
    // Equal components are compared once.
    let mut kinds: Vec<(&MeshGeometry, Option<PartCopy>)> = Vec::new();
    let mut copies: Vec<PartCopy> = Vec::new();
    for part in parts {
        let known = kinds.iter().find_map(|(kind, copy)| {
            let same = same_vertices(kind, part).filter(|same| same.same_faces)?;
            Some(copy.map(|copy| PartCopy {
                scale: copy.scale * part.size / kind.size,
                mirrored: copy.mirrored != same.mirrored,
                ..copy
            }))
        });
        let copy = known.unwrap_or_else(|| {
            let copy = copy_of(mesh, part, kinds.len() < MOST_ALIGNED);
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
    Some(Occurrences {
        found: found.len(),
        components: parts.len(),
        scale: found[0].scale,
        mirrored: found.iter().all(|copy| copy.mirrored),
        gap: gaps.max_by(|x, y| x.rms.total_cmp(&y.rms)),
        same_vertices: found.iter().all(|copy| copy.gap.is_none()),
        confidence: found.iter().map(|copy| copy.confidence).fold(1.0, f64::min),
    })
}

fn copy_of(mesh: &MeshGeometry, part: &MeshGeometry, align: bool) -> Option<PartCopy> {
    let sizes = part.size / mesh.size;
    if let Some(SameVertices { mirrored, scale, .. }) = same_vertices(mesh, part) {
        return Some(PartCopy { scale: scale * sizes, mirrored, gap: None, confidence: 1.0 });
    }
    let aligned = if align { aligned(mesh, part)? } else { return None };
    let Aligned { map, gap, mirrored } = aligned;
    let confidence = same_surface(&aligned, [mesh, part], MeshChange::of([mesh, part], &map));
    (confidence > 0.5).then_some(PartCopy { scale: map.scale * sizes, mirrored, gap: Some(gap), confidence })
}

impl MeshGeometry {
    /// The components with at least a thousandth of the area, and how many copies there are of each, largest first; none if there
    /// is only one. Copies have the same vertices and faces.
    #[must_use]
    pub fn different_components(&self) -> Vec<(&Self, usize)> {
        let mut kinds: Vec<(&Self, usize)> = Vec::new();
        for part in self.parts() {
            let is_copy = |kind: &Self| {
                (part.size / kind.size).ln().abs() < SIZE_OF_SURFACES
                    && same_vertices(kind, part).is_some_and(|same| same.same_faces && !same.mirrored)
            };
            match kinds.iter_mut().find(|(kind, _)| is_copy(kind)) {
                Some((_, copies)) => *copies += 1,
                None => kinds.push((part, 1)),
            }
        }
        kinds
    }
}
