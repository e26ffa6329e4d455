//! Short loops that do not separate the surface: they run around handles or through tunnels.
//!
//! A spanning tree of the vertices and one of the faces that crosses no edge of the first leave two edges for each handle
//! (Eppstein 2003, `eppstein2003`). Each of these edges closes a loop of faces; two loops of edges are homologous over the
//! integers modulo two if they cross the same loops of faces equally often, up to even numbers. So every edge gets a random
//! word for each loop of faces that crosses it, and the words of a loop add up to zero exactly if it separates.

use std::collections::{BTreeMap, BTreeSet};

use base::{Budget, Exceeded, SplitMix};

use crate::disjoint_sets::DisjointSets;
use crate::edge_graph::{EdgeGraph, Way};
use crate::frontier::Frontier;
use crate::ids::{EdgeId, VertexId};
use crate::intrinsic::Link;
use crate::topology::Topology;

/// Most edges that two spanning trees may leave: surfaces with more handles have them by design, and they would cost much time.
const MAX_LEFT: usize = 128;

/// A closed loop of edges that does not separate the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceLoop {
    /// The vertices, each once, in order.
    pub vertices: Vec<VertexId>,
    /// Sum of the lengths of the edges.
    pub length: f64,
}

/// The shortest loop of each homology class that is at most `longest` long, from the shortest to the longest.
///
/// Loops around the same part of a handle are of one class, those around it and those through it are not. Boundaries
/// count as filled. There are none on a surface with edges of more than two faces, and on one with more than 64 handles.
///
/// `lengths` are those of the edges, in the order of the topology. Linear time on a surface without handles; otherwise a
/// search within `longest / 2` from every vertex of the loops of faces.
///
/// ```
/// use canonform_surface::{Topology, VertexId, short_loops};
///
/// // A torus of 6 x 12 vertices with edges along the short way round of length 1, and 2 the long way.
/// let at = |i: u32, j: u32| VertexId(i % 6 + 6 * (j % 12));
/// let quads = (0..12).flat_map(|j| (0..6).map(move |i| (i, j)));
/// let faces: Vec<_> = quads
///     .flat_map(|(i, j)| {
///         let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
///         [[a, b, c], [a, c, d]]
///     })
///     .collect();
/// let topology = Topology::new(72, faces);
/// let length = |[a, b]: &[VertexId; 2]| if a.0 / 6 == b.0 / 6 { 1.0 } else { 2.0 };
/// let lengths: Vec<f64> = topology.edges().iter().map(length).collect();
/// let loops = short_loops(&topology, &lengths, 10.0, &base::Budget::unlimited())?;
/// assert_eq!((loops.len(), loops[0].length), (1, 6.0));
/// # Ok::<(), base::Exceeded>(())
/// ```
///
/// # Errors
/// [`Exceeded`] if the time of the budget is over or it was cancelled.
///
/// # Panics
/// If there is not one length for every edge.
pub fn short_loops(
    topology: &Topology,
    lengths: &[f64],
    longest: f64,
    budget: &Budget,
) -> Result<Vec<SurfaceLoop>, Exceeded> {
    assert_eq!(lengths.len(), topology.n_edges(), "one length for every edge");
    let Some(words) = homology_signatures(topology) else { return Ok(Vec::new()) };
    let marked = topology.edges().iter().zip(&words).filter(|(_, word)| **word != 0);
    let sources: BTreeSet<VertexId> = marked.flat_map(|(ends, _)| *ends).collect();
    let mut search = Search::new(topology, lengths, &words);
    let mut shortest: BTreeMap<u64, SurfaceLoop> = BTreeMap::new();
    for source in sources {
        budget.check()?;
        search.run(source, 0.5 * longest);
        for (word, length, edge) in search.closing(longest) {
            if shortest.get(&word).is_none_or(|known| length < known.length)
                && let Some(vertices) = search.closed(edge)
            {
                shortest.insert(word, SurfaceLoop { vertices, length });
            }
        }
    }
    let mut loops: Vec<SurfaceLoop> = shortest.into_values().collect();
    loops.sort_by(|a, b| a.length.total_cmp(&b.length).then_with(|| a.vertices.cmp(&b.vertices)));
    Ok(loops)
}

/// The word of every edge; `None` if no loop can be found.
fn homology_signatures(topology: &Topology) -> Option<Vec<u64>> {
    let edges = || (0..topology.n_edges()).map(EdgeId::from);
    if edges().any(|edge| topology.edge_corners(edge).len() > 2) {
        return None;
    }
    let (sides, n_nodes) = (beside_edges(topology), topology.n_faces() + topology.n_vertices());
    // How many edges are left does not depend on the trees.
    let mut dual = DisjointSets::new(n_nodes);
    let is_joined = |edge: EdgeId| {
        let [f, g] = sides[edge.index()].map(|node| node.0);
        dual.union(f, g)
    };
    if !(1..=MAX_LEFT).contains(&left_by_trees(topology, is_joined).len()) {
        return None;
    }
    // A tree of the faces by breadth keeps the loops of faces short, from which paths are searched.
    let (order, above) = breadth_first_tree(&sides, n_nodes);
    let mut is_crossed = vec![false; topology.n_edges()];
    above.iter().flatten().for_each(|(_, edge)| is_crossed[edge.index()] = true);
    let (mut words, mut at_node, mut random) = (vec![0; is_crossed.len()], vec![0u64; n_nodes], SplitMix(0));
    for edge in left_by_trees(topology, |edge| is_crossed[edge.index()]) {
        let word = random.bits();
        words[edge.index()] = word;
        sides[edge.index()].into_iter().for_each(|node| at_node[node.index()] ^= word);
    }
    // Each edge between faces of the tree is crossed by the loops with one end below it.
    for node in order.iter().rev() {
        if let Some((from, edge)) = above[node.index()] {
            words[edge.index()] ^= at_node[node.index()];
            at_node[from.index()] ^= at_node[node.index()];
        }
    }
    Some(words)
}

/// The faces on both sides of every edge, as nodes of a graph. Every boundary is one more face.
fn beside_edges(topology: &Topology) -> Vec<[VertexId; 2]> {
    let mut rims = DisjointSets::new(topology.n_vertices());
    for edge in topology.boundary_edges() {
        let [a, b] = topology.edges()[edge.index()];
        rims.union(a.0, b.0);
    }
    let sides = (0..topology.n_edges()).map(EdgeId::from).map(|edge| match topology.edge_corners(edge) {
        [a, b] => [a.face().0, b.face().0],
        corners => {
            let rim = topology.n_faces() as u32 + rims.find(topology.edges()[edge.index()][0].0);
            [corners.first().map_or(rim, |corner| corner.face().0), rim]
        }
    });
    sides.map(|nodes| nodes.map(VertexId)).collect()
}

/// The edges that are left by a spanning tree of the faces, whose edges `joins_faces`, and one of the vertices over the others.
fn left_by_trees(topology: &Topology, mut joins_faces: impl FnMut(EdgeId) -> bool) -> Vec<EdgeId> {
    let mut tree = DisjointSets::new(topology.n_vertices());
    let mut is_left = |edge: &EdgeId| {
        let [a, b] = topology.edges()[edge.index()];
        !joins_faces(*edge) && !tree.union(a.0, b.0)
    };
    (0..topology.n_edges()).map(EdgeId::from).filter(|edge| is_left(edge)).collect()
}

/// The node above a node in a tree, and the edge between them; `None` for a root.
type Above = Option<(VertexId, EdgeId)>;

/// Trees of the faces by breadth: all nodes that have edges, in order, and what is above each.
fn breadth_first_tree(sides: &[[VertexId; 2]], n_nodes: usize) -> (Vec<VertexId>, Vec<Above>) {
    let graph = EdgeGraph::new(n_nodes, sides.iter().map(|ends| Link { ends: *ends, length: 1.0 }));
    let (mut front, mut order, mut above) = (Frontier::default(), Vec::new(), vec![None; n_nodes]);
    front.reset(n_nodes);
    for root in (0..n_nodes).map(VertexId::from).filter(|node| !graph.ways(*node).is_empty()) {
        if front.distance(root) == f64::INFINITY {
            front.relax(root, 0.0);
            let visit = |node, _| {
                order.push(node);
                true
            };
            let note = |node, way: &Way| above[way.to.index()] = Some((node, EdgeId(way.number)));
            graph.search(&mut front, f64::INFINITY, visit, note);
        }
    }
    (order, above)
}

/// Shortest paths along edges from one vertex, with the words along them.
struct Search<'a> {
    topology: &'a Topology,
    words: &'a [u64],
    graph: EdgeGraph,
    front: Frontier,
    word: Vec<u64>,
    /// The vertex before each on its path.
    before: Vec<Option<VertexId>>,
}

impl<'a> Search<'a> {
    fn new(topology: &'a Topology, lengths: &[f64], words: &'a [u64]) -> Self {
        let n = topology.n_vertices();
        let edges = topology.edges().iter().zip(lengths);
        let edges = edges.map(|(ends, length)| Link { ends: *ends, length: *length });
        let (graph, front) = (EdgeGraph::new(n, edges), Frontier::default());
        Self { topology, words, graph, front, word: vec![0; n], before: vec![None; n] }
    }

    fn run(&mut self, source: VertexId, radius: f64) {
        self.front.reset(self.word.len());
        self.front.relax(source, 0.0);
        (self.word[source.index()], self.before[source.index()]) = (0, None);
        self.graph.search(
            &mut self.front,
            radius,
            |_, _| true,
            |v, way| {
                self.word[way.to.index()] = self.word[v.index()] ^ self.words[way.number as usize];
                self.before[way.to.index()] = Some(v);
            },
        );
    }

    /// The edges that close a loop with the paths to their ends that does not separate, with its word and its length.
    fn closing(&self, longest: f64) -> Vec<(u64, f64, EdgeId)> {
        let mut found = Vec::new();
        for &v in self.front.visited() {
            for &Way { to: w, number, length } in self.graph.ways(v) {
                let word = self.word[v.index()] ^ self.word[w.index()] ^ self.words[number as usize];
                let length = self.front.distance(v) + self.front.distance(w) + length;
                // Infinite if `w` was not reached.
                if v < w && length <= longest && word != 0 {
                    found.push((word, length, EdgeId(number)));
                }
            }
        }
        found
    }

    /// The loop that an edge closes; `None` if its two paths share more than the source.
    fn closed(&self, edge: EdgeId) -> Option<Vec<VertexId>> {
        let path = |v: VertexId| std::iter::successors(Some(v), |v| self.before[v.index()]);
        let [a, b] = self.topology.edges()[edge.index()];
        let (mut around, other): (Vec<VertexId>, Vec<VertexId>) = (path(a).collect(), path(b).collect());
        let shared = around.iter().filter(|v| other.contains(v)).count();
        around.extend(other.iter().rev().skip(1));
        (shared == 1).then_some(around)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A torus of m x n quadrilaterals, split along one diagonal.
    fn torus(m: usize, n: usize) -> Vec<[VertexId; 3]> {
        mesh::shapes::torus(m, n, 2.0, 0.5).faces.iter().map(|face| face.map(|v| VertexId(v.0))).collect()
    }

    fn loops(faces: Vec<[VertexId; 3]>, longest: f64) -> Vec<SurfaceLoop> {
        let n = 1 + faces.iter().flatten().map(|v| v.index()).max().unwrap();
        let topology = Topology::new(n, faces);
        short_loops(&topology, &vec![1.0; topology.n_edges()], longest, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn the_loops_of_a_torus_run_around_and_along_it() {
        let found = loops(torus(5, 9), 9.0);
        let lengths: Vec<f64> = found.iter().map(|found| found.length).collect();
        assert_eq!(&lengths[..2], &[5.0, 9.0], "{lengths:?}");
        assert_eq!(found[0].vertices.len(), 5);
        let row = found[0].vertices[0].0 / 5;
        assert!(found[0].vertices.iter().all(|v| v.0 / 5 == row));
        assert!(loops(torus(5, 9), 4.9).is_empty());
    }

    #[test]
    fn a_pierced_torus_has_the_same_loops_and_a_sphere_has_none() {
        let mut pierced = torus(6, 12);
        pierced.remove(30);
        let found = loops(pierced, 6.0);
        assert_eq!((found.len(), found[0].length), (1, 6.0));
        let octahedron =
            [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1], [5, 2, 1], [5, 3, 2], [5, 4, 3], [5, 1, 4]];
        assert!(loops(octahedron.map(|f| f.map(VertexId)).to_vec(), 100.0).is_empty());
        let open = octahedron[1..].iter().map(|f| f.map(VertexId)).collect();
        assert!(loops(open, 100.0).is_empty());
    }

    #[test]
    fn a_sheet_with_two_boundaries_has_no_handle() {
        let mut tube = torus(6, 12);
        tube.retain(|face| face.iter().all(|v| v.0 / 6 != 4));
        assert!(loops(tube, 100.0).is_empty());
    }

    #[test]
    fn edges_of_three_faces_leave_no_loops() {
        let mut fin = torus(6, 12);
        let [a, b, _] = fin[0];
        fin.push([a, b, VertexId(72)]);
        assert!(loops(fin, 100.0).is_empty());
    }
}
