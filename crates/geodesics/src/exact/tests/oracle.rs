//! Beside a slow way that shares nothing with the windows: the straight lines between all pairs of
//! vertices through all strips of faces, and shortest paths in their graph.

use mesh::{CornerId, IntrinsicMesh, Link, Topology, VertexId};
use proptest::prelude::*;

use super::super::Exact;
use super::{all_pairs, assert_close, spatial};
use crate::{DistanceSolver, Source, SurfacePoint};

type Point = [f64; 2];

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// What a vertex sees through the edge from `p` to `q`, laid out with the vertex in the origin and
/// `q` to the left of `p`, between the directions `right` and `left`.
struct View {
    p: (VertexId, Point),
    q: (VertexId, Point),
    right: Point,
    left: Point,
}

struct Oracle<'a> {
    mesh: &'a IntrinsicMesh,
    /// Shortest straight lines found from one vertex.
    lines: Vec<f64>,
    visited: Vec<bool>,
}

impl Oracle<'_> {
    fn length(&self, a: VertexId, b: VertexId) -> f64 {
        self.mesh.length(self.mesh.topology().edge_between(a, b).unwrap())
    }

    /// The corner between two points on the far side of the line from `p` to `q`.
    fn place(&self, apex: VertexId, (p, at_p): (VertexId, Point), (q, at_q): (VertexId, Point)) -> Point {
        let (base, from_p, from_q) = (self.length(p, q), self.length(p, apex), self.length(q, apex));
        let along = (base * base + from_p * from_p - from_q * from_q) / (2.0 * base);
        let away = (from_p * from_p - along * along).max(0.0).sqrt();
        let [x, y] = sub(at_q, at_p).map(|d| d / base);
        [at_p[0] + along * x + away * y, at_p[1] + along * y - away * x]
    }

    fn look_through(&mut self, edge_of: CornerId, view: &View) {
        let edge = self.mesh.topology().opposite_edge(edge_of);
        for corner in self.mesh.topology().edge_corners(edge).to_vec() {
            let face = corner.face().index();
            // A shortest path crosses no face twice.
            if corner == edge_of || std::mem::replace(&mut self.visited[face], true) {
                continue;
            }
            let apex = self.mesh.topology().corner_vertex(corner);
            let at = self.place(apex, view.p, view.q);
            if cross(view.right, at) >= 0.0 && cross(at, view.left) >= 0.0 {
                let line = &mut self.lines[apex.index()];
                *line = line.min(at[0].hypot(at[1]));
            }
            let other = |v: VertexId| {
                let slot = (0..3).find(|s| self.mesh.topology().faces()[face][*s] == v).unwrap();
                CornerId::from(3 * face + slot)
            };
            let (facing_p, facing_q) = (other(view.p.0), other(view.q.0));
            let left = if cross(at, view.left) > 0.0 { at } else { view.left };
            if cross(view.right, left) > 0.0 {
                self.look_through(facing_q, &View { p: view.p, q: (apex, at), right: view.right, left });
            }
            let right = if cross(view.right, at) > 0.0 { at } else { view.right };
            if cross(right, view.left) > 0.0 {
                self.look_through(facing_p, &View { p: (apex, at), q: view.q, right, left: view.left });
            }
            self.visited[face] = false;
        }
    }
}

/// All distances, by the lines of sight between vertices.
fn by_sight(mesh: &IntrinsicMesh) -> Vec<Vec<f64>> {
    let topology = mesh.topology();
    let n = mesh.n_vertices();
    let mut found = Vec::new();
    for vertex in (0..n).map(VertexId::from) {
        let visited = vec![false; topology.n_faces()];
        let mut oracle = Oracle { mesh, lines: vec![f64::INFINITY; n], visited };
        oracle.lines[vertex.index()] = 0.0;
        for corner in topology.vertex_corners(vertex) {
            let face = topology.faces()[corner.face().index()];
            let (a, b) = (face[(corner.slot() + 1) % 3], face[(corner.slot() + 2) % 3]);
            let at_a = [oracle.length(vertex, a), 0.0];
            // Seen from `a` on the way to the vertex, the other end lies on the left.
            let at_b = oracle.place(b, (a, at_a), (vertex, [0.0, 0.0]));
            for (end, at) in [(a, at_a), (b, at_b)] {
                let line = &mut oracle.lines[end.index()];
                *line = line.min(at[0].hypot(at[1]));
            }
            oracle.visited[corner.face().index()] = true;
            oracle.look_through(*corner, &View { p: (a, at_a), q: (b, at_b), right: at_a, left: at_b });
            oracle.visited[corner.face().index()] = false;
        }
        found.push(oracle.lines);
    }
    for link in mesh.links() {
        let [a, b] = link.ends.map(VertexId::index);
        found[a][b] = found[a][b].min(link.length);
        found[b][a] = found[b][a].min(link.length);
    }
    for via in 0..n {
        for from in 0..n {
            for to in 0..n {
                found[from][to] = found[from][to].min(found[from][via] + found[via][to]);
            }
        }
    }
    found
}

fn assert_same(mesh: &IntrinsicMesh) {
    for (found, expected) in all_pairs(mesh).iter().flatten().zip(by_sight(mesh).iter().flatten()) {
        assert_close(*found, *expected, 1e-9);
    }
}

#[test]
fn the_slow_way_is_right_on_a_cube() {
    let found = by_sight(&IntrinsicMesh::from_mesh(&mesh::shapes::cube(0)));
    // Corners by their coordinates in binary: across a face, and across the cube.
    assert_close(found[0][3], 2f64.sqrt(), 1e-14);
    assert_close(found[0][7], 5f64.sqrt(), 1e-14);
}

#[test]
fn polyhedra_have_the_distances_of_their_lines_of_sight() {
    for shape in [mesh::shapes::tetrahedron(1), mesh::shapes::cube(0), mesh::shapes::icosphere(0)] {
        assert_same(&IntrinsicMesh::from_mesh(&shape));
    }
}

/// Any faces over a few points in space, with their corners in any order.
fn soup(n: u32, n_faces: usize) -> impl Strategy<Value = IntrinsicMesh> {
    let points = prop::collection::vec([-1.0..1.0, -1.0..1.0, -1.0..1.0f64], n as usize);
    let face = (0..n, 1..n, 0..n)
        .prop_map(move |(a, b, c)| [a, (a + b) % n, c])
        .prop_filter("three different vertices", |[a, b, c]| a != c && b != c);
    let faces = prop::collection::vec(face, 1..=n_faces);
    (points, faces).prop_map(|(points, faces)| spatial(&points, &faces))
}

/// A fan of faces over points in space, two rings around a vertex: a manifold with a saddle or a peak.
fn star(n: u32) -> impl Strategy<Value = IntrinsicMesh> {
    prop::collection::vec([0.4..1.6, -1.0..1.0f64], 2 * n as usize).prop_map(move |raw| {
        let mut points = vec![[0.0; 3]];
        for (i, [radius, z]) in raw.iter().enumerate() {
            let (ring, angle) =
                (i as u32 / n, f64::from(i as u32 % n) * std::f64::consts::TAU / f64::from(n));
            let radius = radius + 1.5 * f64::from(ring);
            points.push([radius * angle.cos(), radius * angle.sin(), *z * f64::from(1 + ring)]);
        }
        let mut faces = Vec::new();
        for i in 0..n {
            let (a, b) = (1 + i, 1 + (i + 1) % n);
            faces.extend([[0, a, b], [a, a + n, b + n], [a, b, b + n]]);
        }
        spatial(&points, &faces)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn soups_of_faces_have_the_distances_of_their_lines_of_sight(mesh in soup(7, 9)) {
        assert_same(&mesh);
    }

    #[test]
    fn soups_with_links_too(mesh in soup(8, 7), a in 0..8u32, b in 1..8u32, length in 0.1..2.0f64) {
        let ends = [a, (a + b) % 8].map(VertexId);
        assert_same(&mesh.with_links(vec![Link { ends, length }]));
    }

    #[test]
    fn stars_have_the_distances_of_their_lines_of_sight(mesh in star(6)) {
        assert_same(&mesh);
    }

    #[test]
    fn points_of_soups_are_like_vertices_put_there(
        mesh in soup(6, 8), face in 0..8usize, s in 0.05..0.95f64, t in 0.05..0.95f64,
    ) {
        let face = mesh::FaceId::from(face % mesh.topology().n_faces());
        let barycentric = [s, (1.0 - s) * t, (1.0 - s) * (1.0 - t)];
        let source = Source::new(&mesh, SurfacePoint::Face { face, barycentric }).unwrap();
        let mut faces = mesh.topology().faces().to_vec();
        let (n, [a, b, c]) = (mesh.n_vertices(), faces[face.index()]);
        let new = VertexId::from(n);
        faces[face.index()] = [a, b, new];
        faces.extend([[b, c, new], [c, a, new]]);
        let topology = Topology::new(n + 1, faces);
        let length = |[p, q]: &[VertexId; 2]| match mesh.topology().edge_between(*p, *q) {
            Some(edge) => mesh.length(edge),
            None => source.reach().iter().find(|(v, _)| v == p).unwrap().1,
        };
        let lengths = topology.edges().iter().map(length).collect();
        let with_vertex = IntrinsicMesh::new(topology, lengths);

        let mut out = vec![0.0; n];
        Exact::new(&mesh).solve_into(&[source], f64::INFINITY, &mut out);
        let expected = Exact::new(&with_vertex).distances(new);
        for (found, expected) in out.iter().zip(&expected) {
            assert_close(*found, *expected, 1e-9);
        }
    }
}
