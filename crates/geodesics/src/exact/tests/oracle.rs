//! Comparison with a slow algorithm that shares no code with the windows: the straight lines between all pairs of
//! vertices through all strips of faces, and shortest paths in their graph.

use proptest::prelude::*;
use surface::{CornerId, IntrinsicMesh, Link, Topology, VertexId};

use super::{all_pairs, assert_close, bumpy, faces, spatial};

type Point = [f64; 2];

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// What a vertex sees through the edge from `p` to `q`, laid out with the vertex in the origin and `q` to the left of
/// `p`, between the directions `right` and `left`.
struct View {
    p: (VertexId, Point),
    q: (VertexId, Point),
    right: Point,
    left: Point,
}

/// Narrower views, in radians, may be rounding; paths through them also exist past a vertex.
const MIN_VIEW: f64 = 1e-9;

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
        let (r, l) = (view.right, view.left);
        if cross(r, l).atan2(r[0] * l[0] + r[1] * l[1]) <= MIN_VIEW {
            return;
        }
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
            self.look_through(facing_q, &View { p: view.p, q: (apex, at), right: view.right, left });
            let right = if cross(view.right, at) > 0.0 { at } else { view.right };
            self.look_through(facing_p, &View { p: (apex, at), q: view.q, right, left: view.left });
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
fn exact_distances_equal_those_of_the_oracle() {
    for shape in [mesh::shapes::tetrahedron(1), mesh::shapes::cube(0), mesh::shapes::icosphere(0)] {
        assert_same(&shape.intrinsic());
    }
}

#[test]
fn paths_of_equal_length_do_not_hide_each_other() {
    // Found among the soups below: two windows with a common point at a vertex, where one of the two points of equal
    // distance is no change of the nearer source, and two sources in a line.
    let cases: [(&[[u32; 3]], &[f64]); 2] = [
        (
            &[[1, 6, 2], [3, 4, 5], [2, 1, 7], [6, 0, 1], [3, 1, 2], [4, 7, 1]],
            &[
                2.236067977500607,
                2.23606797749979,
                3.0000000000005493,
                1.000000000001685,
                2.0000000000013074,
                2.0,
                2.828427124746857,
                2.44948974278326,
                2.2360679774998427,
                1.0000000000004219,
                0.9999999999996221,
                2.2360679775001557,
                2.4494897427833386,
                2.000000000000515,
            ],
        ),
        (
            &[[1, 0, 2], [0, 7, 2], [2, 4, 7], [0, 3, 2]],
            &[
                0.9999996120389114,
                2.000000627507593,
                1.414213322281007,
                0.9999985985815869,
                2.236068116685629,
                2.449490185505493,
                0.9999992620147626,
                2.2360682814689614,
                2.4494894913450374,
            ],
        ),
    ];
    for (faces, lengths) in cases {
        let topology = Topology::new(8, faces.iter().map(|f| f.map(VertexId)).collect());
        assert_same(&IntrinsicMesh::new(topology, lengths.to_vec()));
    }
}

/// Faces over `n` vertices, with their corners in any order.
fn any_faces(n: u32, n_faces: usize) -> impl Strategy<Value = Vec<[u32; 3]>> {
    let face = (0..n, 1..n, 2..n).prop_map(move |(a, b, c)| {
        // The second differs from the first, the third from both.
        let third = if c > b { c } else { c - 1 };
        [a, (a + b) % n, (a + third) % n]
    });
    prop::collection::vec(face, 1..=n_faces)
}

/// Any faces over a few points in space.
fn soup(n: u32, n_faces: usize) -> impl Strategy<Value = IntrinsicMesh> {
    let points = prop::collection::vec([-1.0..1.0, -1.0..1.0, -1.0..1.0f64], n as usize);
    (points, any_faces(n, n_faces)).prop_map(|(points, faces)| spatial(&points, &faces))
}

/// The same over different points of a lattice, which are often in one plane, hardly moved: paths meet vertices, and
/// several have the same length. The oracle cannot handle faces without area.
fn lattice_soup(n: usize, n_faces: usize) -> impl Strategy<Value = IntrinsicMesh> {
    let points = prop::sample::subsequence((0..18u32).collect::<Vec<_>>(), n).prop_shuffle();
    let moves = prop::collection::vec([-1.0..1.0, -1.0..1.0, -1.0..1.0f64], n);
    let scale = prop_oneof![Just(0.0), Just(1e-15), Just(1e-12), Just(1e-6), Just(1e-3)];
    (points, any_faces(n as u32, n_faces), moves, scale).prop_map(|(points, faces, moves, scale)| {
        let at = |(p, by): (&u32, &[f64; 3])| {
            let lattice = [p % 3, p / 3 % 3, p / 9].map(f64::from);
            [0, 1, 2].map(|i| lattice[i] + scale * by[i])
        };
        let points: Vec<[f64; 3]> = points.iter().zip(&moves).map(at).collect();
        let has_area = |face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| points[v as usize]);
            let ([p, q, r], [s, t, u]) = ([0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i]));
            (q * u - r * t).abs() + (r * s - p * u).abs() + (p * t - q * s).abs() > 0.5
        };
        let faces: Vec<[u32; 3]> = faces.into_iter().filter(has_area).collect();
        spatial(&points, &faces)
    })
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

/// Steps between squares, with vertices hardly moved.
fn stairs() -> impl Strategy<Value = IntrinsicMesh> {
    let steps = prop::collection::vec((0..3u8, -1.0..1.0f64), 16);
    let scale = prop_oneof![Just(0.0), Just(1e-15), Just(1e-12), Just(1e-9), Just(1e-6)];
    (steps, scale).prop_map(|(steps, scale)| {
        let at = |(v, (height, by)): (usize, &(u8, f64))| {
            [(v % 4) as f64, (v / 4) as f64, f64::from(*height) + scale * by]
        };
        let at: Vec<[f64; 3]> = steps.iter().enumerate().map(at).collect();
        spatial(&at, &faces(&mesh::shapes::grid(4, 4, 1.0)))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1536))]

    #[test]
    fn surfaces_have_the_distances_of_their_lines_of_sight(mesh in prop_oneof![
        soup(8, 12),
        lattice_soup(8, 12),
        (0.1..3.0f64, any::<u32>()).prop_map(|(height, seed)| bumpy(4, height, seed.into())),
        stairs(),
        star(8),
        (soup(8, 7), 0..8u32, 1..8u32, 0.1..2.0f64).prop_map(|(mesh, a, b, length)| {
            mesh.with_links(vec![Link { ends: [a, (a + b) % 8].map(VertexId), length }])
        }),
    ]) {
        assert_same(&mesh);
    }
}
