//! Edge collapses on any mesh.

use ::surface::{NearestFirst, VertexId};
use base::{Budget, Exceeded};
use nalgebra::{Matrix3, Point3, Vector3};

use crate::remap::{Remap, Remapped};
use crate::tri_mesh::TriMesh;

/// Weight of the planes that hold boundaries in place, relative to those of faces.
const BOUNDARY: f64 = 10.0;

/// Smallest cosine between the normals of a face before and after a collapse.
const MIN_COSINE: f64 = 0.2;

/// Operations that a collapse counts for in the meter of a budget.
const OPERATIONS: usize = 256;

/// A sum of weighted squared distances from planes, `x' A x + 2 b' x + c`.
#[derive(Debug, Clone, Copy, Default)]
struct Quadric {
    a: Matrix3<f64>,
    b: Vector3<f64>,
    c: f64,
}

impl Quadric {
    /// The plane through `at` with the given unit normal.
    fn plane(normal: Vector3<f64>, at: Point3<f64>, weight: f64) -> Self {
        let d = -normal.dot(&at.coords);
        Self { a: normal * normal.transpose() * weight, b: normal * (d * weight), c: d * d * weight }
    }

    fn plus(self, other: Self) -> Self {
        Self { a: self.a + other.a, b: self.b + other.b, c: self.c + other.c }
    }

    fn error(&self, p: Point3<f64>) -> f64 {
        (p.coords.dot(&(self.a * p.coords)) + 2.0 * self.b.dot(&p.coords) + self.c).max(0.0)
    }

    /// The point of least error, if the planes determine it and it is near the edge from `p` to `q`; otherwise the best
    /// of the ends and the middle.
    fn best(&self, p: Point3<f64>, q: Point3<f64>) -> Point3<f64> {
        let middle = nalgebra::center(&p, &q);
        let near = (p - q).norm_squared();
        let scale = self.a.trace() / 3.0;
        let solved = (self.a.determinant() > 1e-6 * scale * scale * scale)
            .then(|| self.a.try_inverse())
            .flatten()
            .map(|inverse| Point3::from(-(inverse * self.b)))
            .filter(|found| (found - middle).norm_squared() <= near);
        solved.unwrap_or_else(|| {
            let by_error = |a: &Point3<f64>, b: &Point3<f64>| self.error(*a).total_cmp(&self.error(*b));
            [middle, p, q].into_iter().min_by(by_error).unwrap_or(middle)
        })
    }
}

/// A mesh under collapse. Dead faces have no vertices in `faces_at`.
struct Collapse<'a> {
    positions: Vec<Point3<f64>>,
    faces: Vec<[VertexId; 3]>,
    /// The living faces at every vertex; empty at a dead one.
    faces_at: Vec<Vec<u32>>,
    quadrics: Vec<Quadric>,
    /// The vertex that each one was merged into; itself for those that are left.
    merged_into: Vec<u32>,
    /// How often a vertex has changed; older entries of the queue are void.
    changes: Vec<u32>,
    /// Edges by their cost: their ends, and how often these had changed.
    queue: NearestFirst<[[u32; 2]; 2]>,
    cost: &'a dyn Fn(f64, f64, [usize; 2]) -> f64,
}

/// Collapses edges, those of least `cost` first, until `n_vertices` vertices are left or no edge can be collapsed.
///
/// The cost is a function of the quadric error (Garland and Heckbert 1997, `garland1997` in `REFERENCES.bib`), in mesh units to
/// the fourth power, the squared length and the ends. The merged vertex lies where the quadric error is least. Edges stay if
/// their collapse would pinch the surface or invert a face, and so do edges of more than two faces. `O(n log n)`.
///
/// ```
/// use canonform_mesh::{collapse_edges, shapes};
/// use base::Budget;
///
/// let fine = shapes::icosphere(4);
/// let coarse = collapse_edges(&fine, 500, &|error, _, _| error, &Budget::unlimited())?;
/// assert_eq!(coarse.mesh.n_vertices(), 500);
/// assert!((coarse.mesh.area() / fine.area() - 1.0).abs() < 0.01);
/// # Ok::<(), base::Exceeded>(())
/// ```
///
/// # Errors
/// [`Exceeded`].
pub fn collapse_edges(
    mesh: &TriMesh,
    n_vertices: usize,
    cost: &dyn Fn(f64, f64, [usize; 2]) -> f64,
    budget: &Budget,
) -> Result<Remapped, Exceeded> {
    let mut meter = budget.meter();
    let mut work = Collapse::new(mesh.clone(), cost);
    let mut n_left = work.faces_at.iter().filter(|faces| !faces.is_empty()).count();
    while n_left > n_vertices.max(4)
        && let Some((_, [[a, b], changes])) = work.queue.pop()
    {
        meter.count(OPERATIONS)?;
        let ends = [a as usize, b as usize];
        if ends.map(|v| work.changes[v]) == changes && work.collapse(ends) {
            n_left -= 1;
        }
    }
    Ok(work.finished())
}

impl<'a> Collapse<'a> {
    fn new(mesh: TriMesh, cost: &'a dyn Fn(f64, f64, [usize; 2]) -> f64) -> Self {
        let n = mesh.n_vertices();
        let mut faces_at = vec![Vec::new(); n];
        for (f, face) in mesh.faces.iter().enumerate() {
            face.iter().for_each(|v| faces_at[v.index()].push(f as u32));
        }
        let mut work = Self {
            positions: mesh.positions,
            faces: mesh.faces,
            faces_at,
            quadrics: vec![Quadric::default(); n],
            merged_into: (0..n as u32).collect(),
            changes: vec![0; n],
            queue: NearestFirst::default(),
            cost,
        };
        for f in 0..work.faces.len() {
            work.add_planes(f);
        }
        for v in 0..n {
            work.enqueue(v, |w| v < w);
        }
        work
    }

    fn finished(self) -> Remapped {
        let mut is_alive = vec![false; self.faces.len()];
        self.faces_at.iter().flatten().for_each(|&f| is_alive[f as usize] = true);
        let faces =
            self.faces.into_iter().zip(is_alive).filter_map(|(face, is_alive)| is_alive.then_some(face));
        let (mesh, number) = TriMesh { positions: self.positions, faces: faces.collect() }.compacted();
        let last = |mut v: u32| {
            while self.merged_into[v as usize] != v {
                v = self.merged_into[v as usize];
            }
            v as usize
        };
        let to_new = (0..number.len() as u32).map(|v| number[last(v)]).collect();
        Remapped { remap: Remap::new(to_new, mesh.n_vertices()), mesh }
    }

    /// Adds the plane of a face to its vertices, and upright planes along its boundary edges.
    fn add_planes(&mut self, f: usize) {
        let face = self.faces[f].map(|v| v.index());
        let [a, b, c] = face.map(|v| self.positions[v]);
        let vector = (b - a).cross(&(c - a));
        let twice_area = vector.norm();
        if twice_area <= 0.0 {
            return;
        }
        let normal = vector / twice_area;
        let plane = Quadric::plane(normal, a, 0.5 * twice_area);
        face.iter().for_each(|&v| self.quadrics[v] = self.quadrics[v].plus(plane));
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let (v, w) = (face[i], face[j]);
            let edge = self.positions[w] - self.positions[v];
            let length = edge.norm();
            if self.faces_of_edge(v, w) == 1 && length > 0.0 {
                let upright = edge.cross(&normal) / length;
                let plane = Quadric::plane(upright, self.positions[v], BOUNDARY * length * length);
                for v in [v, w] {
                    self.quadrics[v] = self.quadrics[v].plus(plane);
                }
            }
        }
    }

    fn neighbors(&self, v: usize) -> Vec<usize> {
        let faces = self.faces_at[v].iter().flat_map(|&f| self.faces[f as usize]);
        let mut found: Vec<usize> = faces.map(VertexId::index).filter(|&w| w != v).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    fn faces_of_edge(&self, v: usize, w: usize) -> usize {
        self.faces_at[v].iter().filter(|&&f| self.faces[f as usize].iter().any(|x| x.index() == w)).count()
    }

    /// Queues the edges from `v` to the chosen neighbors.
    fn enqueue(&mut self, v: usize, chosen: impl Fn(usize) -> bool) {
        for w in self.neighbors(v).into_iter().filter(|&w| chosen(w)) {
            let (p, q) = (self.positions[v], self.positions[w]);
            let sum = self.quadrics[v].plus(self.quadrics[w]);
            let cost = (self.cost)(sum.error(sum.best(p, q)), (p - q).norm_squared(), [v, w]);
            let changes = [v, w].map(|v| self.changes[v]);
            self.queue.push(cost, [[v as u32, w as u32], changes]);
        }
    }

    /// Merges the second end into the first, at the point of least error; returns whether that was possible.
    fn collapse(&mut self, [v, w]: [usize; 2]) -> bool {
        let of_edge = self.faces_of_edge(v, w);
        let (near_v, near_w) = (self.neighbors(v), self.neighbors(w));
        let common = near_v.iter().filter(|x| near_w.binary_search(x).is_ok()).count();
        let on_boundary = |v: usize, near: &[usize]| near.iter().any(|&x| self.faces_of_edge(v, x) != 2);
        let pinches = of_edge == 2 && on_boundary(v, &near_v) && on_boundary(w, &near_w);
        // A vertex with fewer than three neighbors would leave a face without area.
        let small = near_v.len() + near_w.len() - common < 5 && of_edge == 2;
        if common != of_edge || of_edge > 2 || pinches || small {
            return false;
        }
        let sum = self.quadrics[v].plus(self.quadrics[w]);
        let target = sum.best(self.positions[v], self.positions[w]);
        if !(self.stays_unfolded(v, w, target) && self.stays_unfolded(w, v, target)) {
            return false;
        }
        let moved = std::mem::take(&mut self.faces_at[w]);
        for f in moved {
            let face = &mut self.faces[f as usize];
            if face.iter().any(|x| x.index() == v) {
                for x in *face {
                    self.faces_at[x.index()].retain(|&g| g != f);
                }
            } else {
                face.iter_mut().filter(|x| x.index() == w).for_each(|x| *x = VertexId::from(v));
                self.faces_at[v].push(f);
            }
        }
        self.merged_into[w] = v as u32;
        self.positions[v] = target;
        self.quadrics[v] = sum;
        self.changes[v] += 1;
        self.changes[w] += 1;
        self.enqueue(v, |_| true);
        true
    }

    /// Whether no face at `v` but those of the edge to `w` is inverted when `v` moves to `target`.
    fn stays_unfolded(&self, v: usize, w: usize, target: Point3<f64>) -> bool {
        self.faces_at[v].iter().all(|&f| {
            let face = self.faces[f as usize].map(VertexId::index);
            if face.contains(&w) {
                return true;
            }
            let normal = |[a, b, c]: [Point3<f64>; 3]| (b - a).cross(&(c - a));
            let old = normal(face.map(|x| self.positions[x]));
            let new = normal(face.map(|x| if x == v { target } else { self.positions[x] }));
            old.dot(&new) > MIN_COSINE * (old.norm_squared() * new.norm_squared()).sqrt()
        })
    }
}
