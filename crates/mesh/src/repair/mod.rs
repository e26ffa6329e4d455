//! Repair of defects that algorithms cannot handle.

mod box_tree;
mod bridge;
mod options;
mod report;
mod weld;

pub use options::{ComponentPolicy, Orient, RepairOptions, Weld};
pub use report::RepairReport;

use budget::{Budget, Exceeded};
use nalgebra::Point3;
use surface::{Components, DisjointSets, FaceId, IntrinsicMesh, Link, Topology, VertexId, components_of};

use crate::error::MeshError;
use crate::face_set::{check_input, remove_degenerate, remove_duplicates};
use crate::orientation::orient_consistently;
use crate::points::triangulate_points;
use crate::tri_mesh::TriMesh;

/// A repaired mesh and its relation to the input.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// The repaired mesh. Its vertices are in the order of the input, and the three corners of each face are
    /// in three different positions.
    pub mesh: TriMesh,
    /// Straight connections between components, in vertices of `mesh`; only with [`ComponentPolicy::Bridge`].
    pub links: Vec<Link>,
    /// For each input vertex, its vertex in `mesh`, which merged vertices share; `None` if it was dropped.
    pub input_to_repaired: Vec<Option<VertexId>>,
    /// All changes.
    pub report: RepairReport,
}

impl Repaired {
    /// The intrinsic geometry of the mesh, with the links.
    #[must_use]
    pub fn intrinsic(&self) -> IntrinsicMesh {
        self.mesh.intrinsic().with_links(self.links.clone())
    }
}

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
/// [`MeshError::FaceOutOfRange`], [`MeshError::NonFinitePosition`] and [`MeshError::OutOfRange`] for a mesh that
/// no algorithm can use, [`MeshError::NoUsableFace`] if no face is left, [`MeshError::TooFewPoints`] and
/// [`MeshError::NoSurface`] for points without a surface, and [`MeshError::Disconnected`] if
/// there are several components and the policy is [`ComponentPolicy::Error`].
///
/// ```
/// use canonform_mesh::{RepairOptions, repair, shapes};
///
/// let two_components = shapes::disjoint(&[shapes::icosphere(3), shapes::cube(0)]);
/// let repaired = repair(&two_components, &RepairOptions::default())?;
/// assert_eq!(repaired.mesh, shapes::icosphere(3));
/// assert_eq!(repaired.report.dropped_component_vertices, 8);
/// assert_eq!(repaired.input_to_repaired.last(), Some(&None));
/// # Ok::<(), canonform_mesh::MeshError>(())
/// ```
pub fn repair(mesh: &TriMesh, options: &RepairOptions) -> Result<Repaired, MeshError> {
    repair_within(mesh, options, &Budget::unlimited())
}

/// Repairs as [`repair()`] does, within a budget.
///
/// # Errors
/// Those of [`repair()`], and [`MeshError::Exceeded`].
pub fn repair_within(
    mesh: &TriMesh,
    options: &RepairOptions,
    budget: &Budget,
) -> Result<Repaired, MeshError> {
    Ok(repair_and_measure(mesh, options, budget)?.0)
}

/// Repairs as [`repair_within()`] does, and returns the [intrinsic geometry](Repaired::intrinsic) as well, whose
/// connectivity is built once for both where nothing has to be repaired.
///
/// # Errors
/// Those of [`repair_within()`].
pub fn repair_and_measure(
    mesh: &TriMesh,
    options: &RepairOptions,
    budget: &Budget,
) -> Result<(Repaired, IntrinsicMesh), MeshError> {
    check_input(mesh)?;
    let unit = checked_unit(mesh)?;
    if mesh.faces.is_empty() && mesh.n_vertices() > 0 {
        return surface_of_points(mesh, options, budget);
    }
    let scaled: Vec<Point3<f64>> = mesh.positions.iter().map(|p| p / unit).collect();
    let n_input = mesh.n_vertices();
    let mut report =
        RepairReport { input_vertices: n_input, input_faces: mesh.n_faces(), ..RepairReport::default() };

    let mut faces = mesh.faces.clone();
    report.degenerate_faces = remove_degenerate(&mut faces);
    let mut surface = without_duplicates(mesh, faces, &mut report);
    let mut merged = DisjointSets::new(n_input);
    let policy = match options.weld {
        Weld::Within(tolerance) => Weld::Within(tolerance / unit),
        other => other,
    };
    for _ in 0..MAX_PASSES {
        budget.check()?;
        let welded = weld::weld(&mesh.positions, &scaled, surface.topology(), policy, &mut merged);
        let collapsed = weld::collapse_zero_edges(&surface, unit, &mut merged);
        if welded.coincident + welded.near + collapsed == 0 {
            break;
        }
        let mut faces = surface.into_topology().into_faces();
        faces.iter_mut().flatten().for_each(|v| *v = VertexId(merged.find(v.0)));
        report.welded_vertices += welded.coincident;
        report.near_welded_vertices += welded.near;
        if unit * welded.gap > report.weld_gap {
            (report.weld_gap, report.weld_tolerance) = (unit * welded.gap, unit * welded.tolerance);
        }
        report.collapsed_vertices += collapsed;
        report.zero_length_faces += remove_degenerate(&mut faces);
        surface = without_duplicates(mesh, faces, &mut report);
    }
    if surface.topology().n_faces() == 0 {
        let degenerate = report.degenerate_faces + report.zero_length_faces;
        return Err(MeshError::NoUsableFace { n_faces: mesh.n_faces(), degenerate });
    }

    budget.check()?;
    report.coordinate_rounding = coordinate_rounding(&scaled, &surface, unit);
    let components = components_of(surface.topology());
    report.components = components.count;
    // The faces, if some of their vertices have to be dropped or renumbered.
    let (mut changed, mut kept) = (None, None);
    if components.count > 1 && options.components == ComponentPolicy::Error {
        return Err(disconnected(&components));
    }
    if components.count > 1 && options.components == ComponentPolicy::Largest {
        let mut faces = surface.topology().faces().to_vec();
        kept = Some(keep_largest(&scaled, &mut faces, &components, &mut report));
        changed = Some(faces);
    } else if components.labels.iter().any(Option::is_none) {
        changed = Some(surface.topology().faces().to_vec());
    }

    let compact = Compact::of(mesh, &mut merged, &components, kept);
    compact.report_dropped(&mut merged, &components, &mut report);
    let is_changed = changed.is_some();
    let mut faces = changed.unwrap_or_else(|| surface.topology().faces().to_vec());
    if is_changed {
        for v in faces.iter_mut().flatten() {
            *v = compact.input_to_repaired[v.index()].unwrap_or(*v);
        }
    }
    let mut links = Vec::new();
    if options.components == ComponentPolicy::Bridge && components.count > 1 {
        links = links_between(&scaled, &compact, &faces, budget)?;
        links.iter_mut().for_each(|link| link.length *= unit);
        let in_input = |link: &Link| Link { ends: link.ends.map(|v| compact.sources[v.index()]), ..*link };
        report.bridges = links.iter().map(in_input).collect();
        report.bridge_length = links.iter().map(|link| link.length).sum();
    }
    let mut repaired = TriMesh { positions: compact.positions, faces };
    if options.orient == Orient::Consistent {
        report.flipped_faces = orient_consistently(&mut repaired);
    }
    report.output_vertices = repaired.n_vertices();
    report.output_faces = repaired.n_faces();
    let surface = match is_changed || report.flipped_faces > 0 {
        true => repaired.intrinsic(),
        false => surface,
    };
    let surface = surface.with_links(links.clone());
    Ok((Repaired { mesh: repaired, links, input_to_repaired: compact.input_to_repaired, report }, surface))
}

/// The surface through the vertices of a mesh without faces, repaired. The vertex that stands for a point is its vertex.
fn surface_of_points(
    cloud: &TriMesh,
    options: &RepairOptions,
    budget: &Budget,
) -> Result<(Repaired, IntrinsicMesh), MeshError> {
    let found = triangulate_points(&cloud.positions, budget)?;
    let (mut repaired, surface) = repair_and_measure(&found.mesh, options, budget)?;
    let (to_repaired, report) = (&mut repaired.input_to_repaired, &mut repaired.report);
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
    Ok((repaired, surface))
}

/// The surface of faces that are not degenerate, over the vertices of a mesh, without duplicate faces.
fn without_duplicates(mesh: &TriMesh, faces: Vec<[VertexId; 3]>, report: &mut RepairReport) -> IntrinsicMesh {
    let mut topology = Topology::new(mesh.n_vertices(), faces);
    if topology.has_duplicate_faces() {
        let mut faces = topology.into_faces();
        report.duplicate_faces += remove_duplicates(mesh.n_vertices(), &mut faces);
        topology = Topology::new(mesh.n_vertices(), faces);
    }
    mesh.measured(topology)
}

/// The unit of length of a mesh whose size is in the supported range.
fn checked_unit(mesh: &TriMesh) -> Result<f64, MeshError> {
    let size = mesh.size();
    match size {
        // All positions are the same, and no face is usable.
        0.0 => Ok(1.0),
        _ if SIZES.contains(&size) => Ok(mesh.unit()),
        _ => Err(MeshError::OutOfRange { size, smallest: *SIZES.start(), largest: *SIZES.end() }),
    }
}

/// The spacing of numbers at the farthest coordinate of any face, relative to the mean side of the faces. Positions are
/// in units of length.
fn coordinate_rounding(positions: &[Point3<f64>], surface: &IntrinsicMesh, unit: f64) -> f64 {
    let (mut farthest, mut sides) = (0.0, 0.0);
    let faces = surface.topology().faces();
    for (f, [first, ..]) in faces.iter().enumerate() {
        farthest = f64::max(farthest, positions[first.index()].coords.amax());
        let [bc, ca, ab] = FaceId(f as u32).corners().map(|corner| surface.opposite_length(corner) / unit);
        sides += ab + bc + ca;
    }
    f64::EPSILON * farthest * 3.0 * faces.len() as f64 / sides
}

/// A spanning tree of the components, and links all along narrow gaps; lengths in units of `scaled`.
fn links_between(
    scaled: &[Point3<f64>],
    compact: &Compact,
    faces: &[[VertexId; 3]],
    budget: &Budget,
) -> Result<Vec<Link>, Exceeded> {
    let positions: Vec<Point3<f64>> = compact.sources.iter().map(|v| scaled[v.index()]).collect();
    let topology = Topology::new(positions.len(), faces.to_vec());
    let mut links = bridge::shortest_links(&positions, &compact.labels, budget)?;
    links.extend(bridge::near_links(&positions, &topology, &compact.labels, budget)?);
    links.sort_unstable_by_key(|link| link.ends);
    links.dedup_by_key(|link| link.ends);
    Ok(links)
}

fn disconnected(components: &Components) -> MeshError {
    let mut sizes = vec![0; components.count];
    components.labels.iter().flatten().for_each(|&label| sizes[label as usize] += 1);
    let n_vertices: usize = sizes.iter().sum();
    let largest = sizes.into_iter().max().unwrap_or(0);
    MeshError::Disconnected { unreached: n_vertices - largest, n_vertices }
}

/// Removes all components but the one with the largest area, the first in case of a tie; returns its number.
fn keep_largest(
    positions: &[Point3<f64>],
    faces: &mut Vec<[VertexId; 3]>,
    components: &Components,
    report: &mut RepairReport,
) -> u32 {
    let mut areas = vec![0.0; components.count];
    for face in faces.iter() {
        let [a, b, c] = face.map(|v| positions[v.index()]);
        areas[components.of(face[0])] += (b - a).cross(&(c - a)).norm() / 2.0;
    }
    let largest = (1..areas.len()).fold(0, |best, i| if areas[i] > areas[best] { i } else { best });
    let total: f64 = areas.iter().sum();
    let before = faces.len();
    faces.retain(|face| components.of(face[0]) == largest);
    report.dropped_components = components.count - 1;
    report.dropped_component_faces = before - faces.len();
    report.dropped_area_share = if total > 0.0 { 1.0 - areas[largest] / total } else { 0.0 };
    largest as u32
}

/// The remaining vertices, renumbered in the order of the input.
struct Compact {
    positions: Vec<Point3<f64>>,
    /// The component of each.
    labels: Vec<u32>,
    /// The input vertex of each.
    sources: Vec<VertexId>,
    input_to_repaired: Vec<Option<VertexId>>,
}

impl Compact {
    /// Keeps the vertices with a face; if `kept` is given, only those of that component.
    fn of(mesh: &TriMesh, merged: &mut DisjointSets, components: &Components, kept: Option<u32>) -> Self {
        let n = mesh.n_vertices();
        let mut compact = Self {
            positions: Vec::with_capacity(n),
            labels: Vec::with_capacity(n),
            sources: Vec::with_capacity(n),
            input_to_repaired: vec![None; mesh.n_vertices()],
        };
        for v in 0..mesh.n_vertices() {
            // The lowest vertex of a merged set represents it, so it was visited before.
            let source = merged.find(v as u32) as usize;
            if source != v {
                compact.input_to_repaired[v] = compact.input_to_repaired[source];
                continue;
            }
            if let Some(label) = components.labels[v].filter(|label| kept.is_none_or(|k| k == *label)) {
                compact.input_to_repaired[v] = Some(VertexId::from(compact.positions.len()));
                compact.positions.push(mesh.positions[v]);
                compact.labels.push(label);
                compact.sources.push(VertexId::from(v));
            }
        }
        compact
    }

    /// Adds the dropped vertices to the report.
    fn report_dropped(&self, merged: &mut DisjointSets, components: &Components, report: &mut RepairReport) {
        for v in (0..self.input_to_repaired.len()).filter(|&v| self.input_to_repaired[v].is_none()) {
            report.dropped_vertices.push(VertexId::from(v));
            match components.labels[merged.find(v as u32) as usize] {
                Some(_) => report.dropped_component_vertices += 1,
                None => report.unreferenced_vertices += 1,
            }
        }
    }
}
