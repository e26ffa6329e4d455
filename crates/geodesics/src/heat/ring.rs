//! The vertices around each vertex.

use surface::laplacian::Element;

/// For each vertex the other corners of its triangles and the lengths of the sides that lead there,
/// stored back to back.
#[derive(Debug)]
pub(super) struct Ring {
    starts: Vec<u32>,
    spokes: Vec<(u32, f64)>,
}

impl Ring {
    /// The rings of `n` vertices.
    pub(super) fn new(n: usize, elements: &[Element]) -> Self {
        let sides = elements.iter().flat_map(|element| {
            let [a, b, c] = element.vertices;
            let [ab, bc, ca] = element.triangle.sides();
            [(a, b, ab), (b, c, bc), (c, a, ca)].into_iter().filter(|(v, w, _)| v != w)
        });
        let mut spokes: Vec<(u32, u32, f64)> =
            sides.flat_map(|(v, w, length)| [(v, w, length), (w, v, length)]).collect();
        spokes.sort_by(|a, b| (a.0, a.1).cmp(&(b.0, b.1)).then(a.2.total_cmp(&b.2)));
        // Of sides between the same vertices the shortest.
        spokes.dedup_by_key(|(v, w, _)| (*v, *w));
        let mut starts = vec![0; n + 1];
        for (v, _, _) in &spokes {
            starts[*v as usize + 1] += 1;
        }
        for v in 0..n {
            starts[v + 1] += starts[v];
        }
        Self { starts, spokes: spokes.into_iter().map(|(_, w, length)| (w, length)).collect() }
    }

    /// The vertices around `vertex` and how far they are, in units.
    pub(super) fn of(&self, vertex: surface::VertexId) -> &[(u32, f64)] {
        let v = vertex.index();
        &self.spokes[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}
