//! Repair of defects that algorithms cannot handle.

mod bridge;
mod options;
mod report;
mod t_junctions;
mod weld;

pub use options::{ComponentPolicy, Orient, RepairOptions, Weld};
pub use report::RepairReport;

use std::collections::HashMap;

use base::{Budget, Exceeded, Observer};
use nalgebra::Point3;
use surface::{
    Components, DisjointSets, EdgeId, IntrinsicMesh, Link, Topology, VertexId, components_of_faces,
};

use crate::error::MeshError;
use crate::face_set::{check_input, remove_degenerate, without_duplicates};
use crate::orientation::orient_consistently;
use crate::points::triangulate_points;
use crate::remap::Remap;
use crate::tri_mesh::TriMesh;

/// A repaired mesh and its relation to the input.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// The repaired mesh. Its vertices are in the order of the input, and the three corners of each face are
    /// in three different positions.
    pub mesh: TriMesh,
    /// Its intrinsic geometry. With [`ComponentPolicy::Bridge`] it has straight links between components.
    pub intrinsic: IntrinsicMesh,
    /// From the vertices of the input to those of `mesh`, which merged vertices share.
    pub remap: Remap,
    /// The faces that were split at T-junctions: every part, and the face of the input that it is a part of, by their
    /// vertices in `mesh`.
    pub parts: Vec<FacePart>,
    /// All changes.
    pub report: RepairReport,
}

/// A part of a face that was split, and the face.
pub type FacePart = [[VertexId; 3]; 2];

/// Supported sizes of a mesh, in mesh units: the squares of its edges must be neither zero nor infinite.
const SIZES: std::ops::RangeInclusive<f64> = 1e-151..=1e152;

/// Most passes of merging vertices. Merging can create duplicate faces, and removing these a new boundary
/// with more to weld. Real meshes need two passes; a contrived one could need one per vertex.
const MAX_PASSES: usize = 16;

/// Repairs defects that would break distance computation, and reports them.
///
/// Always removed: degenerate and duplicate faces, edges of length zero (or below 1e-153 of the size of the mesh)
/// together with their faces, and vertices without a face. [`RepairOptions`] select welding, orientation and the treatment of components.
/// Faces without area stay if their corners are in three different positions, and so do non-manifold edges
/// and vertices. A mesh without defects is returned unchanged. One without faces is a point cloud, whose surface is
/// [found](triangulate_points) first.
///
/// Measures in units of a power of two near the size of the mesh, so that scale changes nothing else. Linear time,
/// except for sorting the vertices to weld and for bridges, about `O(n log n)` in the number of vertices for each
/// doubling of the number of components.
///
/// # Errors
/// Those of [`check_input`]; [`MeshError::UnsupportedSize`]; [`MeshError::NoUsableFace`]; those of
/// [`triangulate_points`](crate::triangulate_points) for a mesh without faces; [`MeshError::Disconnected`] if there are several
/// components and the policy is [`ComponentPolicy::Error`]; [`MeshError::Exceeded`].
///
/// ```
/// use canonform_mesh::{RepairOptions, repair, shapes};
///
/// let two_components = shapes::disjoint(&[shapes::icosphere(3), shapes::cube(0)]);
/// let repaired = repair(&two_components, &RepairOptions::default(), &())?;
/// assert_eq!(repaired.mesh, shapes::icosphere(3));
/// assert_eq!(repaired.report.dropped_component_vertices, 8);
/// assert_eq!(repaired.remap.all_to_new().last(), Some(None));
/// # Ok::<(), canonform_mesh::MeshError>(())
/// ```
pub fn repair(
    mesh: &TriMesh,
    options: &RepairOptions,
    observer: &dyn Observer,
) -> Result<Repaired, MeshError> {
    check_input(mesh)?;
    let unit = checked_unit(mesh)?;
    if mesh.faces.is_empty() && mesh.n_vertices() > 0 {
        return surface_of_points(mesh, options, observer);
    }
    let report = RepairReport {
        input_vertices: mesh.n_vertices(),
        input_faces: mesh.n_faces(),
        ..RepairReport::default()
    };
    let mut work = Repair {
        mesh,
        scaled: mesh.positions.iter().map(|p| p / unit).collect(),
        unit,
        weld: options.weld,
        merged: DisjointSets::new(mesh.n_vertices()),
        parents: HashMap::new(),
        report,
        budget: observer.budget(),
    };
    let surface = work.without_t_junctions()?;
    if surface.topology().n_faces() == 0 {
        let degenerate = work.report.degenerate_faces + work.report.zero_length_faces;
        return Err(MeshError::NoUsableFace { n_faces: mesh.n_faces(), degenerate });
    }

    work.budget.check()?;
    (work.report.coordinate_rounding, work.report.is_single) =
        coordinate_rounding(&work.scaled, &surface, unit);
    let components = components_of_faces(mesh.n_vertices(), surface.topology().faces());
    work.report.components = components.count;
    let kept = match options.components {
        _ if components.count == 1 => None,
        ComponentPolicy::Bridge => None,
        ComponentPolicy::Largest => Some(work.largest(surface.topology(), &components)),
        ComponentPolicy::Error => return Err(disconnected(&components)),
    };
    let (sources, input_to_repaired) = work.renumbered(&components, kept);
    let Repair { scaled, parents, mut report, budget, .. } = work;
    let faces = surface.topology().faces();
    let kept = |face: &[VertexId; 3]| {
        let [a, b, c] = face.map(|v| input_to_repaired[v.index()]);
        Some([a?, b?, c?])
    };
    let parts = if parents.is_empty() { Vec::new() } else { face_parts(faces, &parents, kept) };
    let positions = sources.iter().map(|v| mesh.positions[v.index()]).collect();
    let mut repaired = TriMesh { faces: faces.iter().filter_map(kept).collect(), positions };
    report.dropped_component_faces = faces.len() - repaired.n_faces();

    let mut links = Vec::new();
    if options.components == ComponentPolicy::Bridge && components.count > 1 {
        let topology = Topology::new(sources.len(), repaired.faces.clone());
        let positions: Vec<Point3<f64>> = sources.iter().map(|v| scaled[v.index()]).collect();
        let labels: Vec<u32> = sources.iter().filter_map(|v| components.labels[v.index()]).collect();
        links = bridge::links(&positions, &topology, &labels, &budget)?;
        links.iter_mut().for_each(|link| link.length *= unit);
        let in_input = |link: &Link| Link { ends: link.ends.map(|v| sources[v.index()]), ..*link };
        report.bridges = links.iter().map(in_input).collect();
        report.bridge_length = links.iter().map(|link| link.length).sum();
    }
    if options.orient == Orient::Consistent {
        report.flipped_faces = orient_consistently(&mut repaired);
    }
    (report.output_vertices, report.output_faces) = (repaired.n_vertices(), repaired.n_faces());
    let is_unchanged = repaired.n_vertices() == mesh.n_vertices() && report.flipped_faces == 0;
    let intrinsic = if is_unchanged { surface } else { repaired.intrinsic() }.with_links(links);
    let remap = Remap::new(input_to_repaired, repaired.n_vertices());
    Ok(Repaired { mesh: repaired, intrinsic, remap, parts, report })
}

/// The faces that were cut at T-junctions, in ascending order, each with the face that it was a part of; `kept` gives the numbers after the
/// repair.
fn face_parts(
    faces: &[[VertexId; 3]],
    parents: &HashMap<[VertexId; 3], [VertexId; 3]>,
    kept: impl Fn(&[VertexId; 3]) -> Option<[VertexId; 3]>,
) -> Vec<FacePart> {
    let part = |face: &[VertexId; 3]| {
        let whole = parents.get(&VertexId::sorted(*face))?;
        Some([VertexId::sorted(kept(face)?), kept(whole)?])
    };
    let mut parts: Vec<FacePart> = faces.iter().filter_map(part).collect();
    parts.sort_unstable();
    parts
}

/// A mesh under repair.
struct Repair<'a> {
    mesh: &'a TriMesh,
    /// Its positions in a unit that is a power of two.
    scaled: Vec<Point3<f64>>,
    unit: f64,
    weld: Weld,
    merged: DisjointSets,
    /// For every part of a face that was split, with its vertices in order, the face that it was first a part of.
    parents: HashMap<[VertexId; 3], [VertexId; 3]>,
    report: RepairReport,
    budget: Budget,
}

impl Repair<'_> {
    /// The surface after welding, with faces split at the vertices that lie on their boundary edges.
    fn without_t_junctions(&mut self) -> Result<IntrinsicMesh, Exceeded> {
        let mut surface = self.welded()?;
        let n_passes = if self.weld == Weld::None { 0 } else { MAX_PASSES };
        for _ in 0..n_passes {
            self.budget.check()?;
            let Some(faces) = self.close_t_junctions(surface.topology()) else { break };
            surface = self.measured(faces);
        }
        Ok(surface)
    }

    /// The surface of the faces, without degenerate and duplicate ones, after welding.
    fn welded(&mut self) -> Result<IntrinsicMesh, Exceeded> {
        let mut faces = self.mesh.faces.clone();
        self.report.degenerate_faces = remove_degenerate(&mut faces);
        let mut surface = self.measured(faces);
        for _ in 0..MAX_PASSES {
            self.budget.check()?;
            let n_merged = self.weld(surface.topology());
            let collapsed = self.collapse_zero_edges(&surface);
            if n_merged + collapsed == 0 {
                break;
            }
            let mut faces = surface.into_topology().into_faces();
            faces.iter_mut().flatten().for_each(|v| *v = VertexId(self.merged.find(v.0)));
            self.report.collapsed_vertices += collapsed;
            self.report.zero_length_faces += remove_degenerate(&mut faces);
            surface = self.measured(faces);
        }
        Ok(surface)
    }

    /// The surface of faces that are not degenerate, without duplicate faces.
    fn measured(&mut self, faces: Vec<[VertexId; 3]>) -> IntrinsicMesh {
        let (topology, n_duplicates) = without_duplicates(self.mesh.n_vertices(), faces);
        self.report.duplicate_faces += n_duplicates;
        self.mesh.measured(topology)
    }

    /// The component with the largest area, the first in case of a tie.
    fn largest(&mut self, topology: &Topology, components: &Components) -> u32 {
        let mut areas = vec![0.0; components.count];
        for face in topology.faces() {
            let [a, b, c] = face.map(|v| self.scaled[v.index()]);
            if let Some(component) = components.of(face[0]) {
                areas[component] += (b - a).cross(&(c - a)).norm() / 2.0;
            }
        }
        let largest = (1..areas.len()).fold(0, |best, i| if areas[i] > areas[best] { i } else { best });
        let total: f64 = areas.iter().sum();
        self.report.dropped_components = components.count - 1;
        self.report.dropped_area_share = if total > 0.0 { 1.0 - areas[largest] / total } else { 0.0 };
        largest as u32
    }

    /// The vertices with a face, in the order of the input, if `kept` is given only those of that component; and for every input
    /// vertex its number among them. Reports those that are dropped.
    fn renumbered(
        &mut self,
        components: &Components,
        kept: Option<u32>,
    ) -> (Vec<VertexId>, Vec<Option<VertexId>>) {
        let Self { mesh, merged, report, .. } = self;
        let mut sources = Vec::with_capacity(mesh.n_vertices());
        let mut number = vec![None; mesh.n_vertices()];
        for v in 0..mesh.n_vertices() {
            // The lowest vertex of a merged set represents it, so it was visited before.
            let source = merged.find(v as u32) as usize;
            let label = components.labels[source];
            if source != v {
                number[v] = number[source];
            } else if label.is_some_and(|label| kept.is_none_or(|kept| kept == label)) {
                number[v] = Some(VertexId::from(sources.len()));
                sources.push(VertexId::from(v));
            }
            if number[v].is_none() {
                report.dropped_vertices.push(VertexId::from(v));
                report.dropped_component_vertices += usize::from(label.is_some());
                report.unreferenced_vertices += usize::from(label.is_none());
            }
        }
        (sources, number)
    }
}

/// The surface through the vertices of a mesh without faces, repaired. The vertex that stands for a point is its vertex.
fn surface_of_points(
    cloud: &TriMesh,
    options: &RepairOptions,
    observer: &dyn Observer,
) -> Result<Repaired, MeshError> {
    let found = triangulate_points(&cloud.positions, observer)?;
    let mut repaired = repair(&found.mesh, options, observer)?;
    let (mut to_repaired, report) = (repaired.remap.all_to_new().collect::<Vec<_>>(), &mut repaired.report);
    for (point, vertex) in found.vertex.iter().enumerate() {
        if let Some(vertex) = vertex.filter(|v| v.index() != point) {
            to_repaired[point] = to_repaired[vertex.index()];
            report.unreferenced_vertices -= 1;
            report.dropped_component_vertices += usize::from(to_repaired[point].is_none());
        }
    }
    report.dropped_vertices.retain(|v| to_repaired[v.index()].is_none());
    report.input_faces = 0;
    report.points = Some(found.report);
    repaired.remap = Remap::new(to_repaired, repaired.mesh.n_vertices());
    Ok(repaired)
}

/// The unit of length of a mesh whose size is in the supported range.
fn checked_unit(mesh: &TriMesh) -> Result<f64, MeshError> {
    let size = mesh.size();
    match size {
        // All positions are the same, and no face is usable.
        0.0 => Ok(1.0),
        _ if SIZES.contains(&size) => Ok(mesh.unit()),
        _ => Err(MeshError::UnsupportedSize { size, least: *SIZES.start(), most: *SIZES.end() }),
    }
}

/// Bits of a number of 64 bits that one of 32 bits lacks.
const MORE_BITS: u32 = f64::MANTISSA_DIGITS - f32::MANTISSA_DIGITS;

/// The spacing of numbers at the farthest coordinate, and whether that is the spacing of numbers of 32 bits.
///
/// Coordinates were rounded to 32 bits if all fit into these. Rounded ones use the last of the bits at every size; others, such as
/// whole numbers, are exact.
pub fn coordinate_spacing<'p>(positions: impl Iterator<Item = &'p Point3<f64>>) -> (f64, bool) {
    let (mut farthest, mut farthest_single, mut fits) = (0.0f64, 0.0f64, true);
    for x in positions.flat_map(|p| p.iter()) {
        let last_bit = x.to_bits().trailing_zeros();
        fits &= last_bit >= MORE_BITS;
        farthest = farthest.max(x.abs());
        if last_bit == MORE_BITS {
            farthest_single = farthest_single.max(x.abs());
        }
    }
    let is_single = fits && farthest_single > 0.0;
    let spacing = if is_single { f64::from(f32::EPSILON) * farthest_single } else { f64::EPSILON * farthest };
    (spacing, is_single)
}

/// The [spacing](coordinate_spacing) of the coordinates of all faces, relative to the mean side of the faces. Positions are in units
/// of length, powers of two.
fn coordinate_rounding(positions: &[Point3<f64>], surface: &IntrinsicMesh, unit: f64) -> (f64, bool) {
    let topology = surface.topology();
    let edges = (0..topology.n_edges()).map(EdgeId::from);
    let sides: f64 = edges.map(|e| topology.edge_corners(e).len() as f64 * (surface.length(e) / unit)).sum();
    let used = (0..).map(VertexId).zip(positions).filter(|(v, _)| !topology.vertex_corners(*v).is_empty());
    let (spacing, is_single) = coordinate_spacing(used.map(|(_, position)| position));
    (spacing * 3.0 * topology.n_faces() as f64 / sides, is_single)
}

fn disconnected(components: &Components) -> MeshError {
    let mut sizes = vec![0; components.count];
    components.labels.iter().flatten().for_each(|&label| sizes[label as usize] += 1);
    let n_vertices: usize = sizes.iter().sum();
    let largest = sizes.into_iter().max().unwrap_or(0);
    MeshError::Disconnected { unreached: n_vertices - largest, n_vertices }
}
