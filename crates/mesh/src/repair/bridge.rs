//! Links between the components of a mesh.
//!
//! * [`shortest_links`] joins all components: a minimum spanning tree, where the distance of two components is that of
//!   their nearest vertices. This is Boruvka's algorithm. In each round, every group of joined components finds its
//!   nearest vertex outside, and all these links are added, so that the number of groups at least halves. The search
//!   prunes the parts of a tree of boxes that are of the same group or farther away than the best link so far. Nested
//!   and interwoven components therefore cost no more than separate ones.
//! * [`near_links`] joins the boundary of every component to the others all along a narrow gap, so that distances
//!   across it are right.

use base::{Budget, Exceeded};
use nalgebra::Point3;
use surface::{DisjointSets, Link, Topology, VertexId};

use crate::box_tree::BoxTree;
use crate::coincidence::coincident_pairs;

/// The group of a node with points of several groups.
const MIXED: u32 = u32::MAX;

/// A boundary vertex is linked across a gap no wider than this share of the mean length of its boundary edges. Below 1,
/// so that where the sides of a gap match, only opposite vertices are linked.
const REACH: f64 = 0.8;

/// Searches between two checks of the budget.
const BATCH: usize = 1024;

/// A spanning tree of the components, and links all along narrow gaps, ordered by their ends.
pub(super) fn links(
    positions: &[Point3<f64>],
    topology: &Topology,
    labels: &[u32],
    budget: &Budget,
) -> Result<Vec<Link>, Exceeded> {
    let mut links = shortest_links(positions, labels, budget)?;
    links.extend(near_links(positions, topology, labels, budget)?);
    links.sort_unstable_by_key(|link| link.ends);
    links.dedup_by_key(|link| link.ends);
    Ok(links)
}

/// The links of least total length that join the components of a set of points. `labels` are
/// the components, numbered from zero. Of equally long links, the one with the lowest vertices is used.
fn shortest_links(positions: &[Point3<f64>], labels: &[u32], budget: &Budget) -> Result<Vec<Link>, Exceeded> {
    let mut tree = GroupTree::new(0..positions.len() as u32, positions);
    let n_components = labels.iter().max().map_or(0, |&most| most as usize + 1);
    let mut groups = DisjointSets::new(n_components);
    let mut links = Vec::with_capacity(n_components.saturating_sub(1));
    // Components that touch: many points in one place would make the search quadratic.
    let mut touching = coincident_pairs(positions, 0..positions.len() as u32);
    touching.sort_unstable();
    for ends in touching {
        let [a, b] = ends.map(|v| labels[v as usize]);
        if groups.union(a, b) {
            links.push(link(positions, ends));
        }
    }
    while links.len() + 1 < n_components {
        budget.check()?;
        tree.assign_groups(|v| groups.find(labels[v as usize]));
        let mut nearest = tree.nearest_of_groups(n_components, budget)?;
        nearest.sort_unstable();
        let before = links.len();
        for (_, ends) in nearest.into_iter().filter(|candidate| *candidate != NONE) {
            let [a, b] = ends.map(|v| labels[v as usize]);
            if groups.union(a, b) {
                links.push(link(positions, ends));
            }
        }
        if links.len() == before {
            break;
        }
    }
    Ok(links)
}

/// Links from every boundary vertex to the nearest boundary vertex of another component, if that is within [`REACH`]. About `O(n log n)`.
fn near_links(
    positions: &[Point3<f64>],
    topology: &Topology,
    labels: &[u32],
    budget: &Budget,
) -> Result<Vec<Link>, Exceeded> {
    let mut edges = vec![(0.0, 0u32); positions.len()];
    for edge in topology.boundary_edges() {
        let [a, b] = topology.edges()[edge.index()].map(VertexId::index);
        let length = (positions[b] - positions[a]).norm();
        for end in [a, b] {
            edges[end].0 += length;
            edges[end].1 += 1;
        }
    }
    let boundary: Vec<u32> = (0..positions.len() as u32).filter(|&v| edges[v as usize].1 > 0).collect();
    let mut tree = GroupTree::new(boundary.iter().copied(), positions);
    tree.assign_groups(|v| labels[v as usize]);
    let mut links = Vec::new();
    for (i, &v) in boundary.iter().enumerate() {
        if i % BATCH == 0 {
            budget.check()?;
        }
        let (sum, count) = edges[v as usize];
        let radius = REACH * sum / f64::from(count);
        let found = tree.nearest_outside(&positions[v as usize], labels[v as usize], radius * radius);
        links.extend(found.map(|(_, other)| link(positions, [v.min(other), v.max(other)])));
    }
    Ok(links)
}

fn link(positions: &[Point3<f64>], ends: [u32; 2]) -> Link {
    let [p, q] = ends.map(|v| positions[v as usize]);
    Link { ends: ends.map(VertexId), length: (q - p).norm() }
}

/// A possible link: the bits of its squared length, which are ordered as nonnegative numbers are, and its ends, the lower
/// first. Shorter links come first, then those with lower ends. In a total order, equal lengths cannot create a cycle.
type Candidate = (u64, [u32; 2]);

/// No link, behind all others.
const NONE: Candidate = (f64::INFINITY.to_bits(), [u32::MAX; 2]);

/// A tree whose points belong to groups of components.
struct GroupTree {
    boxes: BoxTree,
    /// The group of every vertex of the mesh.
    groups: Vec<u32>,
    /// The group of all points of a node, or [`MIXED`].
    node_groups: Vec<u32>,
}

impl GroupTree {
    fn new(vertices: impl Iterator<Item = u32>, positions: &[Point3<f64>]) -> Self {
        let boxes = BoxTree::new(vertices.map(|v| (positions[v as usize], v)));
        let node_groups = vec![MIXED; boxes.nodes.len()];
        Self { boxes, groups: vec![MIXED; positions.len()], node_groups }
    }

    /// Updates the groups of points and nodes.
    fn assign_groups(&mut self, group_of: impl FnMut(u32) -> u32) {
        self.groups = (0..self.groups.len() as u32).map(group_of).collect();
        let common = |a: u32, b: u32| if a == b { a } else { MIXED };
        for (index, node) in self.boxes.nodes.iter().enumerate().rev() {
            let items = &self.boxes.items[node.items.clone()];
            self.node_groups[index] = match node.children {
                Some([a, b]) => common(self.node_groups[a], self.node_groups[b]),
                None => items.iter().map(|(_, id)| self.groups[*id as usize]).reduce(common).unwrap_or(MIXED),
            };
        }
    }

    /// The nearest vertex of another group than `own` within a radius, and its squared distance.
    fn nearest_outside(&self, at: &Point3<f64>, own: u32, sq_radius: f64) -> Option<(f64, u32)> {
        let skips = |other: u32| self.groups[other as usize] == own;
        let prunes = |node: usize| self.node_groups[node] == own;
        self.boxes.nearest_within(at, sq_radius, 1, skips, prunes).pop()
    }

    /// The shortest link from every group to another.
    fn nearest_of_groups(&self, n_groups: usize, budget: &Budget) -> Result<Vec<Candidate>, Exceeded> {
        let mut nearest = vec![NONE; n_groups];
        for (i, (position, id)) in self.boxes.items.iter().enumerate() {
            if i % BATCH == 0 {
                budget.check()?;
            }
            let own = self.groups[*id as usize];
            let sq_radius = f64::from_bits(nearest[own as usize].0);
            if let Some((sq_length, other)) = self.nearest_outside(position, own, sq_radius) {
                let candidate = (sq_length.to_bits(), [other.min(*id), other.max(*id)]);
                for group in [own, self.groups[other as usize]] {
                    nearest[group as usize] = nearest[group as usize].min(candidate);
                }
            }
        }
        Ok(nearest)
    }
}
