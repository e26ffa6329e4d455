//! Refinement of coarse triangles.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};
use surface::{CornerId, EdgeId, FaceId, IntrinsicMesh, Loops, Topology, Triangulation, VertexId};

use crate::remap::Remapped;
use crate::tri_mesh::TriMesh;

/// A vertex is in the plane of a face if it is nearer to it than this, relative to the root of the area: files round
/// coordinates to six digits.
const FLAT: f64 = 1e-5;

/// Splits edges longer than `longest` at their midpoints, in rounds, until there are none or the next round would give
/// more than `most` vertices. New vertices come from an end of the edge that was split. The surface stays the same; any mesh with usable faces will do, including edges of more
/// than two faces.
///
/// Before every round, edges inside of a plane are flipped until triangles with long edges are Delaunay, and of midpoints inside of
/// planes only those are taken that are half of `longest` apart. So needles, which make up the planes of parts of machines,
/// become well-shaped triangles, and new vertices are spread evenly.
///
/// A face with one split edge becomes two, with two split edges three, with three split edges four.
///
/// # Panics
/// If a face has a repeated vertex or one that does not exist, see [`Topology::new`].
pub fn refine(mesh: &TriMesh, longest: f64, most: usize) -> Remapped {
    // Coordinates in this unit, a power of two, are exact, and their products do not overflow.
    let unit = mesh.unit();
    let mut splits = Splits::new(mesh.moved(|p| p / unit));
    splits.split_longer_than(longest / unit, most);
    let mut refined = splits.mesh.moved(|p| p * unit);
    refined.positions[..mesh.n_vertices()].clone_from_slice(&mesh.positions);
    Remapped::extended(refined, splits.origins)
}

/// A mesh in the making, and an old vertex near each of the new ones behind the old ones.
pub(crate) struct Splits {
    pub(crate) mesh: TriMesh,
    n_old: usize,
    origins: Vec<VertexId>,
}

impl Splits {
    pub(crate) fn new(mesh: TriMesh) -> Self {
        Self { n_old: mesh.n_vertices(), mesh, origins: Vec::new() }
    }

    fn split_longer_than(&mut self, longest: f64, most: usize) {
        let height = FLAT * self.mesh.root_of_area();
        let length = |mesh: &TriMesh, [a, b]: [VertexId; 2]| {
            (mesh.positions[a.index()] - mesh.positions[b.index()]).norm()
        };
        loop {
            let is_long = |[a, b, c]: &[VertexId; 3]| {
                [[*a, *b], [*b, *c], [*c, *a]].into_iter().any(|side| length(&self.mesh, side) > longest)
            };
            let long: Vec<bool> = self.mesh.faces.iter().map(is_long).collect();
            if !long.contains(&true) {
                break;
            }
            let (intrinsic, is_inside) = flip_in_planes(&mut self.mesh, height, &long);
            let topology = intrinsic.topology();
            let edges = topology.edges().iter().enumerate();
            let mut long: Vec<(f64, usize)> =
                edges.map(|(e, ends)| (length(&self.mesh, *ends), e)).filter(|(x, _)| *x > longest).collect();
            long.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            let mut taken = Taken::new(0.5 * longest);
            long.retain(|(_, e)| {
                let [a, b] = topology.edges()[*e].map(|v| self.mesh.positions[v.index()]);
                let is_free = taken.is_free(&nalgebra::center(&a, &b));
                is_free || !is_inside[*e]
            });
            if long.is_empty() || self.mesh.n_vertices() + long.len() > most {
                break;
            }
            let mut edges: Vec<usize> = long.into_iter().map(|(_, e)| e).collect();
            edges.sort_unstable();
            self.split(topology, &edges);
        }
    }

    /// Splits some edges at their midpoints, in their order.
    pub(crate) fn split(&mut self, topology: &Topology, edges: &[usize]) {
        let TriMesh { positions, faces } = &mut self.mesh;
        let mut middle = vec![None; topology.n_edges()];
        for &e in edges {
            let [a, b] = topology.edges()[e];
            middle[e] = Some(VertexId::from(positions.len()));
            positions.push(nalgebra::center(&positions[a.index()], &positions[b.index()]));
            self.origins.push(a.index().checked_sub(self.n_old).map_or(a, |i| self.origins[i]));
        }
        let mut finer = Vec::with_capacity(2 * faces.len());
        for (f, face) in faces.iter().enumerate() {
            let middles =
                FaceId::from(f).corners().map(|corner| middle[topology.opposite_edge(corner).index()]);
            split(*face, middles, positions, &mut finer);
        }
        *faces = finer;
    }
}

/// Flips edges between faces of one plane, one of them with a `long` edge, until they are Delaunay. Vertices may be as far as
/// `height` from it. Returns the lengths, and which edges are inside of a plane.
fn flip_in_planes(mesh: &mut TriMesh, height: f64, long: &[bool]) -> (IntrinsicMesh, Vec<bool>) {
    let is_flat = |mesh: &TriMesh, topology: &Topology, [a, b]: [CornerId; 2]| {
        let normal = |corner: CornerId| mesh.area_vector(corner.face().index()).normalize();
        let apex = |corner: CornerId| mesh.positions[topology.corner_vertex(corner).index()];
        let (normals, across) = ([normal(a), normal(b)], apex(b) - apex(a));
        let start = mesh.positions[topology.edge_ends(a)[0].index()];
        let is_near = |normal: &Vector3<f64>, p: Point3<f64>| normal.dot(&(p - start)).abs() <= height;
        normals[0].dot(&normals[1]) > 0.0
            && across.norm() > 0.0
            && is_near(&normals[0], apex(b))
            && is_near(&normals[1], apex(a))
    };
    let before = mesh.intrinsic();
    let mut planes = Triangulation::glued_where(&before, |a, b| {
        [a, b].iter().any(|corner| long[corner.face().index()]) && is_flat(mesh, before.topology(), [a, b])
    });
    let mut after = before;
    if !planes.flip_to_delaunay(Loops::Forbidden).is_empty() {
        let faces = planes.triangles().iter().map(|triangle| triangle.vertices).collect();
        let flipped = TriMesh { positions: mesh.positions.clone(), faces };
        let intrinsic = flipped.intrinsic();
        // The two sides of a sheet must not become one where they are flipped to the same edge.
        if intrinsic.topology().n_edges() == after.topology().n_edges() {
            (*mesh, after) = (flipped, intrinsic);
        }
    }
    let topology = after.topology();
    let is_inside = |e: usize| match topology.edge_corners(EdgeId::from(e)) {
        [a, b] => is_flat(mesh, topology, [*a, *b]),
        _ => false,
    };
    let is_inside = (0..topology.n_edges()).map(is_inside).collect();
    (after, is_inside)
}

/// Points that keep others away, in cells of a grid.
struct Taken {
    distance: f64,
    cells: HashMap<[i64; 3], Vec<Point3<f64>>>,
}

impl Taken {
    fn new(distance: f64) -> Self {
        Self { distance, cells: HashMap::new() }
    }

    /// Whether no point is nearer than the distance. Then this one is one of them.
    fn is_free(&mut self, p: &Point3<f64>) -> bool {
        let cell = [p.x, p.y, p.z].map(|x| (x / self.distance).floor() as i64);
        let around = (0..27).filter_map(|i| {
            self.cells.get(&[
                cell[0].wrapping_add(i / 9 - 1),
                cell[1].wrapping_add(i / 3 % 3 - 1),
                cell[2].wrapping_add(i % 3 - 1),
            ])
        });
        let is_free = around.flatten().all(|q| (p - q).norm() >= self.distance);
        if is_free {
            self.cells.entry(cell).or_default().push(*p);
        }
        is_free
    }
}

/// Splits a face at the given midpoints of the edges opposite its corners.
fn split(
    face: [VertexId; 3],
    middles: [Option<VertexId>; 3],
    positions: &[nalgebra::Point3<f64>],
    faces: &mut Vec<[VertexId; 3]>,
) {
    // Turned so that the split edges are opposite the first corners.
    let turn = match middles.map(|middle| middle.is_some()) {
        [false, false, true] | [true, false, true] => 2,
        [false, true, false] | [false, true, true] => 1,
        _ => 0,
    };
    let [a, b, c] = [0, 1, 2].map(|i| face[(i + turn) % 3]);
    match [0, 1, 2].map(|i| middles[(i + turn) % 3]) {
        [Some(bc), Some(ca), Some(ab)] => {
            faces.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        [Some(bc), Some(ca), None] => {
            faces.push([ca, bc, c]);
            let length = |[v, w]: [VertexId; 2]| (positions[v.index()] - positions[w.index()]).norm_squared();
            match length([a, bc]) <= length([b, ca]) {
                true => faces.extend([[a, b, bc], [a, bc, ca]]),
                false => faces.extend([[a, b, ca], [b, bc, ca]]),
            }
        }
        [Some(bc), ..] => faces.extend([[a, b, bc], [a, bc, c]]),
        _ => faces.push(face),
    }
}
