//! Links between the components of a mesh.
//!
//! * [`shortest_links`] joins all components: a minimum spanning tree, where the distance of two components is that of
//!   their nearest vertices. This is Boruvka's algorithm. In each round, every group of joined components finds its
//!   nearest vertex outside, and all these links are added, so that the number of groups at least halves. The search
//!   visits pairs of nodes of one box tree and prunes pairs within one group and pairs farther apart than the best
//!   link so far. Nested and interwoven components therefore cost no more than separate ones.
//! * [`near_links`] joins the boundary of every component to the others all along a narrow gap, so that distances
//!   across it are right.

use budget::{Budget, Exceeded};
use nalgebra::Point3;
use surface::{DisjointSets, EdgeId, Link, Topology, VertexId};

use super::box_tree::{BoxTree, Node, sq_norm};
use crate::coincidence::coincident_pairs;

/// The group of a node with points of several groups.
const MIXED: u32 = u32::MAX;

/// A boundary vertex is linked across a gap no wider than this share of the mean length of its boundary edges. Below 1,
/// so that where the sides of a gap match, only opposite vertices are linked.
const REACH: f64 = 0.8;

/// Searches between two checks of the budget.
const BATCH: usize = 1024;

/// The links of least total length that join the components of a set of points, ordered by their ends. `labels` are
/// the components, numbered from zero. Of equally long links, the one with the lowest vertices is used.
pub(super) fn shortest_links(
    positions: &[Point3<f64>],
    labels: &[u32],
    budget: &Budget,
) -> Result<Vec<Link>, Exceeded> {
    let mut tree = GroupTree::new((0..positions.len() as u32).collect(), positions, labels);
    let n_components = labels.iter().max().map_or(0, |&most| most as usize + 1);
    let mut groups = DisjointSets::new(n_components);
    let mut links = Vec::with_capacity(n_components.saturating_sub(1));
    // Components that touch: many points in one place would make the search quadratic.
    for ends in coincident_stars(positions) {
        let [a, b] = ends.map(|v| labels[v as usize]);
        if groups.union(a, b) {
            links.push(link(positions, ends));
        }
    }
    while links.len() + 1 < n_components {
        budget.check()?;
        tree.assign_groups(labels, |label| groups.find(label));
        let mut nearest = vec![Candidate::NONE; n_components];
        tree.search_all(&mut nearest, budget)?;
        nearest.retain(|candidate| candidate.sq_length.is_finite());
        nearest.sort_unstable_by(Candidate::order);
        let before = links.len();
        for Candidate { ends, .. } in nearest {
            let [a, b] = ends.map(|v| labels[v as usize]);
            if groups.union(a, b) {
                links.push(link(positions, ends));
            }
        }
        if links.len() == before {
            break;
        }
    }
    links.sort_unstable_by_key(|link| link.ends);
    Ok(links)
}

/// Links from every boundary vertex to the nearest boundary vertex of another component, if that is within [`REACH`];
/// ordered by their ends. About `O(n log n)`.
pub(super) fn near_links(
    positions: &[Point3<f64>],
    topology: &Topology,
    labels: &[u32],
    budget: &Budget,
) -> Result<Vec<Link>, Exceeded> {
    let mut edges = vec![(0.0, 0u32); positions.len()];
    for (e, ends) in topology.edges().iter().enumerate() {
        if topology.edge_corners(EdgeId::from(e)).len() == 1 {
            let length = (positions[ends[1].index()] - positions[ends[0].index()]).norm();
            for end in ends {
                let (sum, count) = &mut edges[end.index()];
                (*sum, *count) = (*sum + length, *count + 1);
            }
        }
    }
    let boundary: Vec<u32> = (0..positions.len() as u32).filter(|&v| edges[v as usize].1 > 0).collect();
    let mut tree = GroupTree::new(boundary.clone(), positions, labels);
    tree.assign_groups(labels, |label| label);
    let mut links = Vec::new();
    let mut found = Vec::new();
    for (i, &v) in boundary.iter().enumerate() {
        if i % BATCH == 0 {
            budget.check()?;
        }
        let (sum, count) = edges[v as usize];
        let (own, radius) = (labels[v as usize], REACH * sum / f64::from(count));
        let skips = |other: u32| labels[other as usize] == own;
        let prunes = |node: usize| tree.node_groups[node] == own;
        tree.boxes.nearest(&positions[v as usize], radius, 1, skips, prunes, &mut found);
        links.extend(found.iter().map(|&(_, other)| link(positions, [v.min(other), v.max(other)])));
    }
    links.sort_unstable_by_key(|link| link.ends);
    links.dedup_by_key(|link| link.ends);
    Ok(links)
}

/// The lowest vertex at every position with each of the others there, in ascending order.
fn coincident_stars(positions: &[Point3<f64>]) -> Vec<[u32; 2]> {
    let mut stars = coincident_pairs(positions, 0..positions.len() as u32);
    // Consecutive pairs share a vertex.
    for i in 1..stars.len() {
        if stars[i][0] == stars[i - 1][1] {
            stars[i][0] = stars[i - 1][0];
        }
    }
    stars.sort_unstable();
    stars
}

fn link(positions: &[Point3<f64>], ends: [u32; 2]) -> Link {
    let [p, q] = ends.map(|v| positions[v as usize]);
    Link { ends: ends.map(VertexId), length: (q - p).norm() }
}

/// A possible link, its lower end first.
#[derive(Debug, Clone, Copy)]
struct Candidate {
    sq_length: f64,
    ends: [u32; 2],
}

impl Candidate {
    const NONE: Self = Self { sq_length: f64::INFINITY, ends: [u32::MAX; 2] };

    /// Shorter links first, then those with lower ends. In a total order, equal lengths cannot create a cycle.
    fn order(&self, other: &Self) -> std::cmp::Ordering {
        self.sq_length.total_cmp(&other.sq_length).then(self.ends.cmp(&other.ends))
    }

    fn improve(&mut self, other: Self) {
        if other.order(self).is_lt() {
            *self = other;
        }
    }
}

/// A tree whose points belong to groups of components.
struct GroupTree {
    boxes: BoxTree,
    /// The group of every point, in the order of the tree.
    groups: Vec<u32>,
    /// The group of all points of a node, or [`MIXED`].
    node_groups: Vec<u32>,
}

impl GroupTree {
    fn new(vertices: Vec<u32>, positions: &[Point3<f64>], labels: &[u32]) -> Self {
        let boxes = BoxTree::new(vertices.into_iter().map(|v| (positions[v as usize], v)));
        let groups = boxes.items.iter().map(|item| labels[item.id as usize]).collect();
        let node_groups = vec![MIXED; boxes.nodes.len()];
        Self { boxes, groups, node_groups }
    }

    /// Updates the groups of points and nodes.
    fn assign_groups(&mut self, labels: &[u32], mut group_of: impl FnMut(u32) -> u32) {
        for (group, item) in self.groups.iter_mut().zip(&self.boxes.items) {
            *group = group_of(labels[item.id as usize]);
        }
        for (index, node) in self.boxes.nodes.iter().enumerate().rev() {
            self.node_groups[index] = match node.children {
                Some([a, b]) if self.node_groups[a] == self.node_groups[b] => self.node_groups[a],
                Some(_) => MIXED,
                None => {
                    let groups = &self.groups[node.items.clone()];
                    let first = groups.first().copied().unwrap_or(MIXED);
                    if groups.iter().all(|group| *group == first) { first } else { MIXED }
                }
            };
        }
    }

    /// Finds the shortest link from every group to another.
    fn search_all(&self, nearest: &mut [Candidate], budget: &Budget) -> Result<(), Exceeded> {
        let mut pending = vec![0];
        let mut n_searched = 0usize;
        while let Some(index) = pending.pop() {
            n_searched += 1;
            if n_searched.is_multiple_of(BATCH) {
                budget.check()?;
            }
            match self.boxes.nodes[index].children {
                Some(children) if self.node_groups[index] == MIXED => pending.extend(children),
                _ => self.search(index, 0, nearest),
            }
        }
        Ok(())
    }

    /// Searches the points of node `there` for neighbours of the points of node `here`, which has a single
    /// group or is a leaf.
    fn search(&self, here: usize, there: usize, nearest: &mut [Candidate]) {
        let nodes = &self.boxes.nodes;
        let (h, t) = (&nodes[here], &nodes[there]);
        let is_own = self.node_groups[here] != MIXED && self.node_groups[here] == self.node_groups[there];
        if is_own || h.sq_gap(t) > self.bound(here, nearest) {
            return;
        }
        match (h.children, t.children) {
            (None, None) => self.compare(h, t, nearest),
            (Some(children), None) => children.iter().for_each(|&c| self.search(c, there, nearest)),
            (Some(children), Some(_)) if h.width() > t.width() => {
                children.iter().for_each(|&c| self.search(c, there, nearest));
            }
            (_, Some([a, b])) => {
                let a_first = h.sq_gap(&nodes[a]) <= h.sq_gap(&nodes[b]);
                for child in if a_first { [a, b] } else { [b, a] } {
                    self.search(here, child, nearest);
                }
            }
        }
    }

    /// The largest squared length that can improve the link of a point of a node, which has a single group or
    /// is a leaf.
    fn bound(&self, node: usize, nearest: &[Candidate]) -> f64 {
        if self.node_groups[node] != MIXED {
            return nearest[self.node_groups[node] as usize].sq_length;
        }
        let groups = &self.groups[self.boxes.nodes[node].items.clone()];
        groups.iter().map(|group| nearest[*group as usize].sq_length).fold(0.0, f64::max)
    }

    /// Compares all points of two leaves.
    fn compare(&self, here: &Node, there: &Node, nearest: &mut [Candidate]) {
        for i in here.items.clone() {
            for j in there.items.clone().filter(|&j| self.groups[j] != self.groups[i]) {
                let [p, q] = [i, j].map(|i| self.boxes.items[i]);
                let gap = [0, 1, 2].map(|axis| p.position[axis] - q.position[axis]);
                let candidate = Candidate { sq_length: sq_norm(gap), ends: [p.id.min(q.id), p.id.max(q.id)] };
                nearest[self.groups[i] as usize].improve(candidate);
                nearest[self.groups[j] as usize].improve(candidate);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pseudo-random numbers in [0, 1).
    fn stream(mut state: u64) -> impl FnMut() -> f64 {
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1u32 << 31)
        }
    }

    fn shortest_links(positions: &[Point3<f64>], labels: &[u32]) -> Vec<Link> {
        super::shortest_links(positions, labels, &Budget::unlimited()).unwrap()
    }

    /// Kruskal on all pairs of points.
    fn by_brute_force(positions: &[Point3<f64>], labels: &[u32]) -> Vec<Link> {
        let mut all = Vec::new();
        for a in 0..positions.len() {
            for b in (a + 1..positions.len()).filter(|&b| labels[a] != labels[b]) {
                let d = positions[b] - positions[a];
                all.push(Candidate { sq_length: sq_norm([d.x, d.y, d.z]), ends: [a as u32, b as u32] });
            }
        }
        all.sort_by(Candidate::order);
        let mut sets = DisjointSets::new(labels.len());
        let mut links: Vec<Link> = all
            .into_iter()
            .filter(|c| sets.union(labels[c.ends[0] as usize], labels[c.ends[1] as usize]))
            .map(|c| {
                let [p, q] = c.ends.map(|v| positions[v as usize]);
                Link { ends: c.ends.map(VertexId), length: (q - p).norm() }
            })
            .collect();
        links.sort_by_key(|link| link.ends);
        links
    }

    #[test]
    fn links_equal_those_of_kruskal_on_all_pairs() {
        for seed in 0..20 {
            let mut next = stream(seed);
            let n_components = 2 + (next() * 12.0) as usize;
            // Half of the runs use a coarse lattice with many equal distances.
            let round = |x: f64| if seed % 2 == 0 { x } else { (x * 4.0).floor() };
            let labels: Vec<u32> = (0..120).map(|i| (i % n_components) as u32).collect();
            let spread = if seed % 3 == 0 { 5.0 } else { 0.0 };
            let positions: Vec<_> = labels
                .iter()
                .map(|&l| Point3::new(round(next()) + spread * f64::from(l), round(next()), round(next())))
                .collect();
            let links = shortest_links(&positions, &labels);
            assert_eq!(links.len(), n_components - 1);
            assert_eq!(links, by_brute_force(&positions, &labels), "seed {seed}");
        }
    }

    #[test]
    fn a_thousand_nested_shells_are_linked() {
        let mut next = stream(7);
        let (shells, per_shell) = (1000, 40);
        let mut positions = Vec::new();
        let mut labels = Vec::new();
        for shell in 0..shells {
            for _ in 0..per_shell {
                let direction = nalgebra::Vector3::new(next() - 0.5, next() - 0.5, next() - 0.5);
                positions.push(Point3::from(direction.normalize() * (1.0 + f64::from(shell))));
                labels.push(shell as u32);
            }
        }
        let links = shortest_links(&positions, &labels);
        assert_eq!(links.len(), shells as usize - 1);
        assert!(links.iter().all(|link| link.length >= 1.0 - 1e-9));
    }

    #[test]
    fn a_cancelled_search_ends() {
        let budget = Budget::unlimited();
        budget.cancel();
        let positions: Vec<_> = (0..5000).map(|i| Point3::new(f64::from(i), 0.0, 0.0)).collect();
        let labels: Vec<u32> = (0..5000).map(|i| i % 2).collect();
        let found = super::shortest_links(&positions, &labels, &budget);
        assert_eq!(found, Err(Exceeded::Cancelled));
    }

    #[test]
    fn one_component_or_none_needs_no_link() {
        assert_eq!(shortest_links(&[], &[]), []);
        assert_eq!(shortest_links(&[Point3::origin(); 3], &[0; 3]), []);
    }
}
