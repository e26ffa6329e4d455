//! The pieces that carry heat: triangles, and links as bars.

use mesh::Link;

use super::delaunay::Cover;
use super::triangle::Triangle;

/// Two triangles on the same vertices are one when their sides differ by no more than this share.
const SAME: f64 = 1e-9;

/// Largest cotangent that enters a matrix: beyond it there is only rounding.
const STEEPEST: f64 = 1e9;

/// A link longer than this, in units, transports heat as if it were this long: behind a bridge the
/// amount of heat is of no importance, but there has to be some.
pub(super) const LONGEST_BAR: f64 = 400.0;

/// The same in heat lengths, for short times: `exp(-DEEPEST)` is still a number.
const DEEPEST: f64 = 600.0;

/// A triangle with the number of sheets of the surface it stands for.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element {
    pub(super) vertices: [u32; 3],
    pub(super) triangle: Triangle,
    /// One for a face of the mesh, a half where front and back of the cover went different ways.
    pub(super) share: f64,
}

/// The triangles of a cover of which each counts half; a front and its back are merged into one
/// again wherever both were flipped alike, which is everywhere but next to boundaries and
/// non-manifold edges.
pub(super) fn elements(cover: &Cover) -> Vec<Element> {
    let mut sorted: Vec<([u32; 3], [f64; 3])> = cover
        .triangles()
        .map(|([a, b, c], [ab, bc, ca])| {
            let mut opposite = [(a, bc), (b, ca), (c, ab)];
            opposite.sort_by(|(v, l), (w, m)| v.cmp(w).then(l.total_cmp(m)));
            let [(a, bc), (b, ca), (c, ab)] = opposite;
            ([a, b, c], [ab, bc, ca])
        })
        .collect();
    let by_length = |a: &[f64; 3], b: &[f64; 3]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
    sorted.sort_by(|(v, a), (w, b)| v.cmp(w).then(by_length(a, b)));
    let mut elements: Vec<Element> = Vec::with_capacity(sorted.len() / 2 + 1);
    let mut previous = [0.0; 3];
    for (vertices, sides) in sorted {
        let same = sides.iter().zip(previous).all(|(a, b)| (a - b).abs() <= SAME * a);
        match elements.last_mut() {
            Some(last) if last.vertices == vertices && same => last.share += 0.5,
            _ => elements.push(Element { vertices, triangle: Triangle::from_sides(sides), share: 0.5 }),
        }
        previous = sides;
    }
    elements
}

/// The mean length of the sides of all triangles, in units, and their area; zeros without triangles.
pub(super) fn mean_side_and_area(elements: &[Element]) -> (f64, f64) {
    let [mut shares, mut perimeter, mut area] = [0.0; 3];
    for Element { triangle, share, .. } in elements {
        shares += share;
        perimeter += share * triangle.sides().iter().sum::<f64>();
        area += share * triangle.area();
    }
    if shares > 0.0 { (perimeter / (3.0 * shares), area) } else { (0.0, 0.0) }
}

impl Element {
    /// The cotangent weight of each pair of different vertices: `1/2 cot` of the angle opposite.
    pub(super) fn weights(&self) -> impl Iterator<Item = ([u32; 2], f64)> {
        let [a, b, c] = self.vertices;
        let [at_a, at_b, at_c] = self.triangle.cotangents();
        let share = 0.5 * self.share;
        [([b, c], at_a), ([c, a], at_b), ([a, b], at_c)]
            .into_iter()
            .filter(|([i, j], _)| i != j)
            .map(move |(ends, cot)| (ends, share * cot.clamp(-STEEPEST, STEEPEST)))
    }

    /// Adds to `b` the integral over the triangle of `X . grad` of the hat function of each corner,
    /// `X = -grad u / |grad u|`, lane by lane: its part of `-div X`.
    ///
    /// The gradient is found up to a positive factor, which is all its direction needs, from
    /// differences relative to the largest, so that no `u`, huge or tiny, over- or underflows.
    #[inline]
    pub(super) fn add_divergence<const K: usize>(&self, u: &[[f64; K]], b: &mut [[f64; K]]) {
        let Triangle { base, x, y } = self.triangle;
        let [i, j, k] = self.vertices.map(|v| v as usize);
        for lane in 0..K {
            let (to_j, to_k) = (u[j][lane] - u[i][lane], u[k][lane] - u[i][lane]);
            let largest = to_j.abs().max(to_k.abs());
            if largest == 0.0 {
                continue;
            }
            let (to_j, to_k) = (to_j / largest, to_k / largest);
            let (along, across) = (y * to_j, base * to_k - x * to_j);
            let length = (along * along + across * across).sqrt();
            if length == 0.0 {
                continue;
            }
            let scale = -0.5 * self.share / length;
            let at_k = scale * base * across;
            let at_j = scale * (y * along - x * across);
            b[k][lane] += at_k;
            b[j][lane] += at_j;
            b[i][lane] -= at_j + at_k;
        }
    }
}

/// A link as a thin bar whose ends are two vertices, a heat length wide.
///
/// In the heat equation it is exact for one dimension: heat on it is a sum of `exp(x)` and `exp(-x)`,
/// `x` in heat lengths, and falls along it as it does along the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bar {
    pub(super) ends: [u32; 2],
    length: f64,
    /// `sqrt(t)`.
    heat_length: f64,
    /// The length that heat sees, in heat lengths.
    depth: f64,
}

impl Bar {
    pub(super) fn new(link: &Link, heat_length: f64) -> Self {
        let depth = (link.length.min(LONGEST_BAR) / heat_length).min(DEEPEST);
        Self { ends: link.ends.map(|v| v.0), length: link.length, heat_length, depth }
    }

    /// What it adds to `M + t L`: to the diagonal at both ends, and between them.
    pub(super) fn heat(&self) -> [f64; 2] {
        let t = self.heat_length * self.heat_length;
        [t / self.depth.tanh(), -t / self.depth.sinh()]
    }

    /// Its weight in `L`.
    pub(super) fn weight(&self) -> f64 {
        self.heat_length / self.length
    }

    /// Adds to `b` the bar's part of `-div X`, lane by lane: its weight times how much farther one end
    /// is than the other, the integral of `-sign u'`.
    pub(super) fn add_divergence<const K: usize>(&self, u: &[[f64; K]], b: &mut [[f64; K]]) {
        let [i, j] = self.ends.map(|v| v as usize);
        let lost = (-self.depth).exp();
        for lane in 0..K {
            // Heat is least where the parts that came in at either end are equal.
            let (at_i, at_j) = (u[i][lane], u[j][lane]);
            let (from_i, from_j) = ((at_i - lost * at_j).max(0.0), (at_j - lost * at_i).max(0.0));
            if from_i == from_j {
                continue;
            }
            let rise = (self.length / self.depth * (from_i / from_j).ln()).clamp(-self.length, self.length);
            b[i][lane] -= self.weight() * rise;
            b[j][lane] += self.weight() * rise;
        }
    }
}

#[cfg(test)]
mod tests {
    use mesh::{IntrinsicMesh, TriMesh, shapes};

    use super::*;

    fn of(mesh: &TriMesh) -> Vec<Element> {
        let mesh = IntrinsicMesh::from_mesh(mesh);
        let mut cover = Cover::new(&mesh, mesh.edge_lengths());
        cover.flip_to_delaunay();
        elements(&cover)
    }

    #[test]
    fn front_and_back_are_one_wherever_they_were_flipped_alike() {
        for mesh in [shapes::icosphere(3), shapes::torus(24, 4, 2.0, 0.7)] {
            let found = of(&mesh);
            assert_eq!(found.len(), mesh.n_faces());
            assert!(found.iter().all(|element| element.share == 1.0));
        }
        // All sides of this sheet are flipped, those on its boundary against their own backs.
        let sheet = shapes::sheared_grid(9, 9, 1.0, 2.4);
        let found = of(&sheet);
        let shares: f64 = found.iter().map(|element| element.share).sum();
        assert_eq!(shares, sheet.n_faces() as f64);
        assert!(found.iter().any(|element| element.share == 0.5) && found.len() < 2 * sheet.n_faces());
        let (_, area) = mean_side_and_area(&found);
        assert!((area - 64.0).abs() < 1e-9);
    }

    #[test]
    fn delaunay_weights_are_not_negative_even_at_boundaries() {
        for mesh in [shapes::jittered_grid(12, 12, 1.0, 0.24, 1), shapes::sheared_grid(8, 8, 1.0, 3.2)] {
            let mut sums = std::collections::BTreeMap::new();
            for ([i, j], weight) in of(&mesh).iter().flat_map(Element::weights) {
                *sums.entry((i.min(j), i.max(j))).or_insert(0.0) += weight;
            }
            assert!(sums.values().all(|weight: &f64| *weight > -1e-9));
        }
    }

    #[test]
    fn a_linear_function_has_the_divergence_of_its_direction() {
        // u = 3 x + 4 y on the triangle (0, 0), (2, 0), (1, 1): X = -(0.6, 0.8).
        let triangle = Triangle { base: 2.0, x: 1.0, y: 1.0 };
        let element = Element { vertices: [0, 1, 2], triangle, share: 1.0 };
        for scale in [1.0, 1e300, 1e-300] {
            let mut b = [[0.0]; 3];
            element.add_divergence(&[[0.0], [6.0 * scale], [7.0 * scale]], &mut b);
            // Gradients of the hat functions: (-1/2, -1/2), (1/2, -1/2), (0, 1); the area is 1.
            let expected = [0.7, 0.1, -0.8];
            assert!(b.iter().zip(expected).all(|([b], e)| (b - e).abs() < 1e-15), "{b:?}");
        }
        let mut b = [[0.0]; 3];
        element.add_divergence(&[[5.0]; 3], &mut b);
        assert_eq!(b, [[0.0]; 3]);
    }

    #[test]
    fn a_bar_rises_by_its_length_or_to_where_heat_from_both_ends_meets() {
        let link = Link { ends: [0, 1].map(mesh::VertexId), length: 3.0 };
        let bar = Bar::new(&link, 0.5);
        let rise = |u: [f64; 2]| {
            let mut b = [[0.0]; 2];
            bar.add_divergence(&u.map(|u| [u]), &mut b);
            assert_eq!(b[0][0], -b[1][0]);
            b[1][0] / bar.weight()
        };
        let at = |x: f64| (x / 0.5).cosh();
        for (heat, expected) in [
            ([1.0, 0.0], 3.0),
            ([0.0, 1.0], -3.0),
            // Nothing leaves the far end.
            ([at(3.0), 1.0], 3.0),
            // Least heat after 2 of 3.
            ([at(2.0), at(1.0)], 1.0),
            ([7.0, 7.0], 0.0),
            ([0.0, 0.0], 0.0),
        ] {
            assert!((rise(heat) - expected).abs() < 1e-9, "{heat:?}: {}", rise(heat));
        }
    }
}
