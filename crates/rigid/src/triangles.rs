//! The point of a surface that is nearest to another point.

use mesh::TriMesh;
use nalgebra::{Point3, Vector3};

/// Most triangles in a leaf of the tree.
const LEAF: usize = 4;

/// Squared distances are rounded by less than this share.
const ROUNDING: f64 = 1e-9;

/// A tree of bounding boxes over the triangles of a mesh, parents before their children.
#[derive(Debug)]
pub struct TriangleTree {
    triangles: Vec<Placed>,
    nodes: Vec<Node>,
}

#[derive(Debug)]
struct Node {
    low: Point3<f64>,
    high: Point3<f64>,
    triangles: std::ops::Range<usize>,
    /// The second child; the first follows its parent. 0 of a leaf.
    second: usize,
}

/// A triangle, and the face of the mesh that it is.
#[derive(Debug, Clone, Copy)]
struct Placed {
    corners: [Point3<f64>; 3],
    normal: Vector3<f64>,
    /// Unit normals of the sides in the plane, from each corner to the next.
    outwards: [Vector3<f64>; 3],
    face: u32,
}

/// The nearest point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NearestOnSurface {
    /// The point.
    pub point: Point3<f64>,
    /// Unit normal of its triangle.
    pub normal: Vector3<f64>,
    /// Squared distance to it.
    pub sq_distance: f64,
    /// Its face.
    pub face: usize,
}

impl TriangleTree {
    /// The tree over the triangles that have an area. `O(n log n)`.
    pub fn new(mesh: &TriMesh) -> Self {
        let placed = |f: usize| {
            let corners = mesh.triangle(f);
            let normal = mesh.area_vector(f).try_normalize(0.0)?;
            let outwards = [0, 1, 2].map(|i| (corners[(i + 1) % 3] - corners[i]).cross(&normal).normalize());
            Some(Placed { corners, normal, outwards, face: f as u32 })
        };
        let triangles: Vec<_> = (0..mesh.n_faces()).filter_map(placed).collect();
        let mut tree = Self { nodes: Vec::with_capacity(triangles.len() / 2 + 1), triangles };
        if !tree.triangles.is_empty() {
            tree.grow(0..tree.triangles.len());
        }
        tree
    }

    fn grow(&mut self, range: std::ops::Range<usize>) -> usize {
        let infinite = Point3::from([f64::INFINITY; 3]);
        let corners = self.triangles[range.clone()].iter().flat_map(|t| t.corners);
        let (low, high) = corners.fold((infinite, -infinite), |(low, high), p| (low.inf(&p), high.sup(&p)));
        let index = self.nodes.len();
        self.nodes.push(Node { low, high, triangles: range.clone(), second: 0 });
        if range.len() > LEAF {
            let axis = (high - low).imax();
            let middle = range.len() / 2;
            let center = |t: &Placed| t.corners.iter().map(|p| p[axis]).sum::<f64>();
            self.triangles[range.clone()]
                .select_nth_unstable_by(middle, |a, b| center(a).total_cmp(&center(b)));
            let middle = range.start + middle;
            self.grow(range.start..middle);
            self.nodes[index].second = self.grow(middle..range.end);
        }
        index
    }

    /// The point of the surface that is nearest to `query`; `None` for a surface without area.
    pub fn nearest(&self, query: &Point3<f64>) -> Option<NearestOnSurface> {
        self.nearest_from(query, None)
    }

    /// The same, found sooner if a point of the surface is known that is near.
    pub fn nearest_from(&self, query: &Point3<f64>, known: Option<&Point3<f64>>) -> Option<NearestOnSurface> {
        // The known point is off the surface by rounding.
        let limit = known.map_or(f64::INFINITY, |known| {
            (known - query).norm_squared() * (1.0 + ROUNDING) + ROUNDING * ROUNDING
        });
        let found = self.nearest_within(query, limit);
        let Best { sq_distance, point, triangle } =
            found.or_else(|| self.nearest_within(query, f64::INFINITY))?;
        let Placed { normal, face, .. } = self.triangles[triangle];
        Some(NearestOnSurface { point, normal, sq_distance, face: face as usize })
    }

    fn nearest_within(&self, query: &Point3<f64>, sq_distance: f64) -> Option<Best> {
        let mut best = Best { sq_distance, point: Point3::origin(), triangle: usize::MAX };
        self.nodes.first()?;
        self.search(0, query, &mut best);
        (best.triangle != usize::MAX).then_some(best)
    }

    fn search(&self, node: usize, query: &Point3<f64>, best: &mut Best) {
        let Node { triangles, second, .. } = &self.nodes[node];
        if *second > 0 {
            let [a, b] = [node + 1, *second].map(|child| (child, self.nodes[child].sq_distance(query)));
            // The nearer one is searched first.
            for (child, bound) in if a.1 < b.1 { [a, b] } else { [b, a] } {
                if bound < best.sq_distance {
                    self.search(child, query, best);
                }
            }
            return;
        }
        for triangle in triangles.clone() {
            let Placed { corners, normal, outwards, .. } = &self.triangles[triangle];
            // A triangle is no nearer than its plane, and in this no nearer than the lines along its sides.
            let height = normal.dot(&(query - corners[0]));
            let beyond = |i: usize| outwards[i].dot(&(query - corners[i]));
            let aside = larger(larger(beyond(0), beyond(1)), larger(beyond(2), 0.0));
            if height * height + aside * aside > best.sq_distance * (1.0 + ROUNDING) {
                continue;
            }
            let sides = corners.each_ref().map(|corner| corner.coords.as_slice());
            let [a, b, c] = OnTriangle::nearest(query.coords.as_slice(), sides).weights;
            let point = Point3::from(corners[0].coords * a + corners[1].coords * b + corners[2].coords * c);
            let sq_distance = (point - query).norm_squared();
            if sq_distance < best.sq_distance {
                *best = Best { sq_distance, point, triangle };
            }
        }
    }
}

/// The nearest point so far.
struct Best {
    sq_distance: f64,
    point: Point3<f64>,
    triangle: usize,
}

/// The larger number in one instruction, which `f64::max` is not.
fn larger(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

impl Node {
    fn sq_distance(&self, p: &Point3<f64>) -> f64 {
        let beyond = |i: usize| larger(larger(self.low[i] - p[i], p[i] - self.high[i]), 0.0);
        (0..3).map(|i| beyond(i).powi(2)).sum()
    }
}

/// The point of a triangle that is nearest to another point, in any number of dimensions.
#[derive(Debug, Clone, Copy)]
pub struct OnTriangle {
    /// The weights of the corners: not negative, with sum 1.
    pub weights: [f64; 3],
    /// Squared distance to it.
    pub sq_distance: f64,
}

impl OnTriangle {
    /// The point nearest to `query`.
    #[inline]
    pub fn nearest(query: &[f64], [p, q, r]: [&[f64]; 3]) -> Self {
        // All that matters are products of the sides from `p` and of the way from `p` to the query.
        let mut sums = [0.0; 6];
        for (((x, p), q), r) in query.iter().zip(p).zip(q).zip(r) {
            let (u, v, w) = (q - p, r - p, x - p);
            for (sum, product) in sums.iter_mut().zip([u * u, u * v, v * v, u * w, v * w, w * w]) {
                *sum += product;
            }
        }
        let [uu, uv, vv, uw, vw, ww] = sums;
        let at = |s: f64, t: f64| Self {
            weights: [f64::max(1.0 - s - t, 0.0), s, t],
            sq_distance: ww - 2.0 * (s * uw + t * vw) + s * s * uu + 2.0 * s * t * uv + t * t * vv,
        };
        let area = uu * vv - uv * uv;
        let (s, t) = ((vv * uw - uv * vw) / area, (uu * vw - uv * uw) / area);
        let is_inside = s >= 0.0 && t >= 0.0 && s + t <= 1.0;
        // Of a thin triangle, a point of a side may be nearer than what rounding leaves of the one inside. A side without length is
        // its first end.
        let share = |along: f64, sq: f64| if sq > 0.0 { (along / sq).clamp(0.0, 1.0) } else { 0.0 };
        let opposite = share(uu - uv + vw - uw, uu - 2.0 * uv + vv);
        let sides = [at(share(uw, uu), 0.0), at(0.0, share(vw, vv)), at(1.0 - opposite, opposite)];
        let start = if is_inside { at(s, t) } else { sides[0] };
        sides
            .into_iter()
            .fold(start, |best, side| if side.sq_distance < best.sq_distance { side } else { best })
    }
}
