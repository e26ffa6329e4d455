//! Laws of distances and paths across faces that have next to no area.

use surface::{IntrinsicMesh, VertexId};

use super::{longest_edge, methods, spatial};
use crate::{Method, PathTracer, Source, SurfacePoint};

/// A flat sheet some of whose edges are slits: polygons without area between vertices on the edge, cut into triangles.
struct Slivers {
    points: Vec<[f64; 3]>,
    faces: Vec<[usize; 3]>,
    random: u64,
}

impl Slivers {
    fn sheet(nx: usize, ny: usize, seed: u64) -> Self {
        let points = (0..nx * ny).map(|v| [(v % nx) as f64, (v / nx) as f64, 0.0]).collect();
        let cell = |v: usize| [[v, v + 1, v + nx], [v + 1, v + nx + 1, v + nx]];
        let faces = (0..nx * (ny - 1)).filter(|v| v % nx + 1 < nx).flat_map(cell).collect();
        Self { points, faces, random: seed }
    }

    fn below(&mut self, n: usize) -> usize {
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.random >> 33) as usize % n
    }

    /// Splits the faces at a random edge inside at so many vertices on either side, which are `thickness` away from the
    /// edge, and fills the slit.
    fn slit(&mut self, on_each_side: [usize; 2], thickness: f64, close_to_the_end: bool) {
        let [a, b, sides] = loop {
            let face = self.below(self.faces.len());
            let face = self.faces[face];
            let start = self.below(3);
            let [a, b] = [face[start], face[(start + 1) % 3]];
            let has = |f: &usize| self.faces[*f].contains(&a) && self.faces[*f].contains(&b);
            let both: Vec<usize> = (0..self.faces.len()).filter(has).collect();
            // Not along an earlier slit, and not where vertices are close together.
            let length = self.distance(a, b);
            let apex = |f: usize| self.faces[f].into_iter().find(|v| *v != a && *v != b).unwrap();
            if let [f, g] = both[..]
                && length > 0.3
                && [f, g].iter().all(|f| self.height(apex(*f), a, b) > 0.1)
            {
                break [a, b, f * 65_536 + g];
            }
        };
        let (mut left, mut right) = (vec![a], vec![a]);
        for (side, face) in [sides / 65_536, sides % 65_536].into_iter().enumerate() {
            let n = on_each_side[side];
            let chain = if side == 0 { &mut left } else { &mut right };
            let apex = self.faces[face].into_iter().find(|v| *v != a && *v != b).unwrap();
            let [p, q, r] = [a, b, apex].map(|v| self.points[v]);
            let along = [q[0] - p[0], q[1] - p[1]];
            let length = along[0].hypot(along[1]);
            let normal = [-along[1] / length, along[0] / length];
            let up = (normal[0] * (r[0] - p[0]) + normal[1] * (r[1] - p[1])).signum() * thickness;
            for i in 0..n {
                let share = (i + 1) as f64 / (n + 1) as f64 + 0.02 * side as f64;
                let t = if close_to_the_end { 1e-4 * share } else { share };
                chain.push(self.points.len());
                self.points.push([
                    p[0] + t * along[0] + up * normal[0],
                    p[1] + t * along[1] + up * normal[1],
                    0.0,
                ]);
            }
            chain.push(b);
            if n > 0 {
                self.faces[face] = [chain[0], chain[1], apex];
                self.faces.extend(chain[1..].windows(2).map(|pair| [pair[0], pair[1], apex]));
            }
        }
        right.reverse();
        let mut polygon = [&left[..], &right[1..right.len() - 1]].concat();
        while polygon.len() > 2 {
            let n = polygon.len();
            let ear = self.below(n);
            self.faces.push([polygon[(ear + n - 1) % n], polygon[ear], polygon[(ear + 1) % n]]);
            polygon.remove(ear);
        }
    }

    fn distance(&self, a: usize, b: usize) -> f64 {
        let [p, q] = [a, b].map(|v| self.points[v]);
        (p[0] - q[0]).hypot(p[1] - q[1])
    }

    fn height(&self, apex: usize, a: usize, b: usize) -> f64 {
        let [p, q, r] = [a, b, apex].map(|v| self.points[v]);
        let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        area.abs() / self.distance(a, b)
    }

    fn intrinsic(&self) -> IntrinsicMesh {
        let faces: Vec<_> = self.faces.iter().map(|face| face.map(|v| v as u32)).collect();
        spatial(&self.points, &faces)
    }
}

/// Sheets with caps, needles, fans of caps on one edge and caps that share their long sides, of any thickness.
fn sheets() -> Vec<(String, f64, Slivers)> {
    let mut found = Vec::new();
    for thickness in [0.0, 1e-15, 1e-12, 1e-10, 1e-9, 1e-8, 3e-8, 1e-7, 1e-6] {
        for (kind, on_each_side, close) in [
            ("caps", [1, 0], false),
            ("fans", [4, 0], false),
            ("pairs", [1, 1], false),
            ("chains", [3, 2], false),
            ("needles", [1, 0], true),
        ] {
            for seed in 0..2 {
                let mut sheet = Slivers::sheet(7, 6, 77 + seed);
                (0..12).for_each(|_| sheet.slit(on_each_side, thickness, close));
                found.push((format!("{kind} of {thickness:e}, seed {seed}"), thickness, sheet));
            }
        }
    }
    found
}

/// The share of the longest edge by which distances in a plane may be off, for methods that measure along the surface. Fast
/// marching goes straight past a single vertex on an edge; rows of them bend its paths a little.
fn error_in_a_plane(method: Method, is_single: bool) -> Option<f64> {
    match method {
        Method::FastMarching(options) if options == Default::default() => {
            Some(if is_single { 5e-3 } else { 0.2 })
        }
        Method::Exact => Some(1e-9),
        Method::Heat(_) => Some(1.0),
        Method::FastMarching(_) | Method::Dijkstra | Method::BreadthFirst => None,
    }
}

/// The square root of rounding: the height that edge lengths leave open.
const HEIGHT: f64 = 3e-8;

#[test]
fn slivers_of_any_shape_and_thickness_change_no_distance_and_no_exact_path() {
    let mut wrong = Vec::new();
    for (name, thickness, sheet) in sheets() {
        let mesh = sheet.intrinsic();
        let is_single = name.starts_with("caps");
        let rounding = 20.0 * thickness + 4.0 * HEIGHT;
        for (method_name, method) in methods() {
            let Some(error) = error_in_a_plane(method, is_single) else { continue };
            let solver = method.prepare(&mesh, &()).unwrap();
            let mut worst = 0.0f64;
            for source in (0..sheet.points.len()).step_by(3) {
                let found = solver.distances(VertexId::from(source)).unwrap();
                let errors = found.iter().enumerate().map(|(v, d)| (d - sheet.distance(source, v)).abs());
                worst = errors.fold(worst, f64::max);
                // Where flat faces share their long sides, some paths are longer, and the program says so.
                if method == Method::Exact && is_single {
                    let sources = [Source::vertex(VertexId::from(source))];
                    let tracer = PathTracer::new(&mesh, &sources, &found, &());
                    for (v, distance) in found.iter().enumerate().filter(|(v, _)| *v != source) {
                        let path = tracer.path_to(SurfacePoint::Vertex(VertexId::from(v))).unwrap();
                        assert!(path.length - distance <= 1e-9 + rounding, "{name}: {source} to {v}");
                    }
                }
            }
            if worst > error * longest_edge(&mesh) + rounding {
                wrong.push(format!("{method_name}, {name}: {worst:e}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn a_flat_face_on_an_edge_of_three_is_crossed_from_its_apex() {
    // Vertex 1 is in the middle of the edge from 0 to 2, which has a page on either side.
    let points = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [2.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [1.0, 0.0, 1.0],
        [1.0, -1.0, 0.0],
    ];
    let book = spatial(&points, &[[0, 1, 2], [0, 2, 3], [2, 0, 4], [0, 5, 1], [1, 5, 2]]);
    for (name, method) in methods().into_iter().filter(|(name, _)| ["fast-marching", "exact"].contains(name))
    {
        let found = method.prepare(&book, &()).unwrap().distances(VertexId(1)).unwrap();
        for (d, expected) in found.iter().zip([1.0, 0.0, 1.0, 1.0, 1.0, 1.0]) {
            assert!((d - expected).abs() < 1e-9, "{name}: {found:?}");
        }
    }
}
