//! Mending what algorithms cannot take.

mod bridge;
mod options;
mod report;
mod weld;

pub use options::{ComponentPolicy, Orient, RepairOptions, Weld};
pub use report::RepairReport;

use crate::face_set::{check_input, names_twice, repeats};
use crate::orientation::orient_consistently;
use crate::{MeshError, TriMesh};
use surface::{Components, DisjointSets, IntrinsicMesh, Link, VertexId, components_of_faces};

/// A mended mesh, and what became of the input.
#[derive(Debug, Clone, PartialEq)]
pub struct Repaired {
    /// The mesh that is left: its vertices are in the input's order, and each face has its three
    /// corners in three different places.
    pub mesh: TriMesh,
    /// Straight connections between components, in vertices of `mesh`; only with
    /// [`ComponentPolicy::Bridge`].
    pub links: Vec<Link>,
    /// For every input vertex the one it became in `mesh`, which merged vertices share; `None` for
    /// one that was dropped.
    pub input_to_repaired: Vec<Option<VertexId>>,
    /// Everything that was changed.
    pub report: RepairReport,
}

impl Repaired {
    /// The intrinsic geometry of the mesh, with the links.
    #[must_use]
    pub fn intrinsic(&self) -> IntrinsicMesh {
        self.mesh.intrinsic().with_links(self.links.clone())
    }
}

/// Diagonal of the bounding box from which on areas come near the end of the numbers, in mesh units.
const MAX_DIAGONAL: f64 = 1e150;

/// Passes of merging vertices: merging may make faces equal, and taking them out a new boundary with
/// more to weld. Real meshes need two; the limit keeps a contrived one from taking one pass a vertex.
const MAX_PASSES: usize = 16;

/// Makes any mesh fit for algorithms: proper faces, and one surface or a said reason why not.
///
/// Always done: faces that name a vertex twice and repeated faces are removed, edges of length zero
/// are collapsed together with the faces on them, vertices that no face names are dropped. On
/// request: welding, orientation and the treatment of components, see [`RepairOptions`]. Faces
/// without area but with their corners in three places stay, as do non-manifold edges and vertices.
/// The input is not touched, every change is in the report, and a mesh with nothing to mend comes
/// back as it is.
///
/// Linear time, but for sorting the vertices that are welded, and for bridges about
/// `O(n log n)` in the number of vertices for each doubling of the number of components.
///
/// # Errors
/// [`MeshError::FaceOutOfRange`], [`MeshError::NonFinitePosition`] and [`MeshError::TooWide`] for a
/// mesh no algorithm can use, [`MeshError::NoUsableFace`] when nothing is left, and
/// [`MeshError::Disconnected`] when [`ComponentPolicy::Error`] says so.
pub fn repair(mesh: &TriMesh, options: &RepairOptions) -> Result<Repaired, MeshError> {
    check_input(mesh)?;
    let diagonal = mesh.bounds().map_or(0.0, |[lo, hi]| (hi - lo).norm());
    if diagonal > MAX_DIAGONAL || !diagonal.is_finite() {
        return Err(MeshError::TooWide { diagonal, limit: MAX_DIAGONAL });
    }
    let n_input = mesh.n_vertices();
    let mut report =
        RepairReport { input_vertices: n_input, input_faces: mesh.n_faces(), ..RepairReport::default() };

    let mut faces = mesh.faces.clone();
    report.degenerate_faces = remove_degenerate(&mut faces);
    report.duplicate_faces = remove_repeated(n_input, &mut faces);
    let mut merged = DisjointSets::new(n_input);
    for _ in 0..MAX_PASSES {
        let welded = weld::weld(&mesh.positions, &faces, options.weld, &mut merged);
        let collapsed = weld::collapse_zero_edges(&mesh.positions, &faces, &mut merged);
        if welded + collapsed == 0 {
            break;
        }
        faces.iter_mut().flatten().for_each(|v| *v = VertexId(merged.find(v.0)));
        report.welded_vertices += welded;
        report.collapsed_vertices += collapsed;
        report.zero_length_faces += remove_degenerate(&mut faces);
        report.duplicate_faces += remove_repeated(n_input, &mut faces);
    }
    if faces.is_empty() {
        let degenerate = report.degenerate_faces + report.zero_length_faces;
        return Err(MeshError::NoUsableFace { n_faces: mesh.n_faces(), degenerate });
    }

    let components = components_of_faces(n_input, &faces);
    report.components = components.count;
    let kept = match options.components {
        ComponentPolicy::Error if components.count > 1 => return Err(disconnected(&components)),
        ComponentPolicy::Largest if components.count > 1 => {
            Some(keep_largest(&mesh.positions, &mut faces, &components, &mut report))
        }
        _ => None,
    };

    let compact = Compact::of(mesh, &mut merged, &components, kept);
    for v in faces.iter_mut().flatten() {
        *v = compact.input_to_repaired[v.index()].unwrap_or(*v);
    }
    compact.report_dropped(&mut merged, &components, &mut report);
    let mut links = Vec::new();
    if options.components == ComponentPolicy::Bridge && components.count > 1 {
        links = bridge::shortest_links(&compact.positions, &compact.labels);
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
    Ok(Repaired { mesh: repaired, links, input_to_repaired: compact.input_to_repaired, report })
}

/// Removes faces that name a vertex twice; returns how many.
fn remove_degenerate(faces: &mut Vec<[VertexId; 3]>) -> usize {
    let before = faces.len();
    faces.retain(|&face| !names_twice(face));
    before - faces.len()
}

/// Removes faces with the vertices of an earlier one; returns how many.
fn remove_repeated(n_vertices: usize, faces: &mut Vec<[VertexId; 3]>) -> usize {
    let before = faces.len();
    let mut repeated = repeats(n_vertices, faces).into_iter();
    faces.retain(|_| !repeated.next().unwrap_or(false));
    before - faces.len()
}

fn disconnected(components: &Components) -> MeshError {
    let mut sizes = vec![0; components.count];
    components.labels.iter().flatten().for_each(|&label| sizes[label as usize] += 1);
    let n_vertices: usize = sizes.iter().sum();
    let largest = sizes.into_iter().max().unwrap_or(0);
    MeshError::Disconnected { unreached: n_vertices - largest, n_vertices }
}

/// Removes the faces of all components but the one of the largest area, the first of equals;
/// returns its number.
fn keep_largest(
    positions: &[nalgebra::Point3<f64>],
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

/// The vertices that are left, numbered anew in the input's order.
struct Compact {
    positions: Vec<nalgebra::Point3<f64>>,
    /// The component of each.
    labels: Vec<u32>,
    /// The input vertex that each is.
    sources: Vec<VertexId>,
    input_to_repaired: Vec<Option<VertexId>>,
}

impl Compact {
    /// Keeps what a face names, of the component `kept` only if there is one.
    fn of(mesh: &TriMesh, merged: &mut DisjointSets, components: &Components, kept: Option<u32>) -> Self {
        let mut compact = Self {
            positions: Vec::new(),
            labels: Vec::new(),
            sources: Vec::new(),
            input_to_repaired: vec![None; mesh.n_vertices()],
        };
        for v in 0..mesh.n_vertices() {
            // The lowest vertex of a merged set stands for it, so it has been here first.
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

    /// Lists the dropped vertices, by reason.
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
