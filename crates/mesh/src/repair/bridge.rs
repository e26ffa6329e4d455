//! The shortest links that join the components of a mesh: a minimum spanning tree, where the distance of two
//! components is that of their nearest vertices.
//!
//! This is Boruvka's algorithm. In each round, every group of joined components finds its nearest vertex
//! outside, and all these links are added, so that the number of groups at least halves. The search visits
//! pairs of nodes of one box tree and prunes pairs within one group and pairs farther apart than the best
//! link so far. Nested and interwoven components therefore cost no more than separate ones. (kiddo cannot
//! skip the points of the query's own component.)

use nalgebra::Point3;
use surface::{DisjointSets, Link, VertexId};

/// The most points in a leaf of the tree.
const LEAF: usize = 8;
/// The group of a node with points of several groups.
const MIXED: u32 = u32::MAX;

/// The links of least total length that join the components of a set of points, ordered by their ends. `labels` are
/// the components, numbered from zero. Of equally long links, the one with the lowest vertices is used.
pub(super) fn shortest_links(positions: &[Point3<f64>], labels: &[u32]) -> Vec<Link> {
    let mut tree = BoxTree::build(positions, labels);
    let n_components = labels.iter().max().map_or(0, |&most| most as usize + 1);
    let mut groups = DisjointSets::new(n_components);
    let mut links = Vec::with_capacity(n_components.saturating_sub(1));
    while links.len() + 1 < n_components {
        tree.assign_groups(&mut groups);
        let mut nearest = vec![Candidate::NONE; n_components];
        tree.search_all(&mut nearest);
        nearest.retain(|candidate| candidate.sq_length.is_finite());
        nearest.sort_unstable_by(Candidate::order);
        let before = links.len();
        for Candidate { ends, .. } in nearest {
            let [a, b] = ends.map(|v| labels[v as usize]);
            if groups.union(a, b) {
                let [p, q] = ends.map(|v| positions[v as usize]);
                links.push(Link { ends: ends.map(VertexId), length: (q - p).norm() });
            }
        }
        if links.len() == before {
            break;
        }
    }
    links.sort_unstable_by_key(|link| link.ends);
    links
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

/// A point in the tree.
#[derive(Debug, Clone, Copy)]
struct Item {
    position: [f64; 3],
    vertex: u32,
    label: u32,
    group: u32,
}

/// A tree of bounding boxes in one array, parents before their children.
struct BoxTree {
    items: Vec<Item>,
    nodes: Vec<Node>,
}

#[derive(Debug, Clone)]
struct Node {
    low: [f64; 3],
    high: [f64; 3],
    items: std::ops::Range<usize>,
    /// The two children; `None` for a leaf.
    children: Option<[usize; 2]>,
    /// The group of all its points, or [`MIXED`].
    group: u32,
}

impl BoxTree {
    fn build(positions: &[Point3<f64>], labels: &[u32]) -> Self {
        let items = (0u32..).zip(positions).zip(labels);
        let items = items.map(|((vertex, p), &label)| Item {
            position: [p.x, p.y, p.z],
            vertex,
            label,
            group: label,
        });
        let mut tree = Self { items: items.collect(), nodes: Vec::new() };
        tree.grow(0..positions.len());
        tree
    }

    /// Adds the node over a range of items and all below it; returns its index.
    fn grow(&mut self, range: std::ops::Range<usize>) -> usize {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for item in &self.items[range.clone()] {
            for axis in 0..3 {
                low[axis] = low[axis].min(item.position[axis]);
                high[axis] = high[axis].max(item.position[axis]);
            }
        }
        let index = self.nodes.len();
        self.nodes.push(Node { low, high, items: range.clone(), children: None, group: MIXED });
        if range.len() > LEAF {
            let width = |axis: &usize| high[*axis] - low[*axis];
            let widest = (0..3).max_by(|a, b| width(a).total_cmp(&width(b))).unwrap_or(0);
            let half = range.len() / 2;
            self.items[range.clone()]
                .select_nth_unstable_by(half, |a, b| a.position[widest].total_cmp(&b.position[widest]));
            let middle = range.start + half;
            let children = [self.grow(range.start..middle), self.grow(middle..range.end)];
            self.nodes[index].children = Some(children);
        }
        index
    }

    /// Updates the groups of points and nodes.
    fn assign_groups(&mut self, groups: &mut DisjointSets) {
        for item in &mut self.items {
            item.group = groups.find(item.label);
        }
        for index in (0..self.nodes.len()).rev() {
            let node = &self.nodes[index];
            let group = match node.children {
                Some([a, b]) if self.nodes[a].group == self.nodes[b].group => self.nodes[a].group,
                Some(_) => MIXED,
                None => {
                    let items = &self.items[node.items.clone()];
                    let first = items.first().map_or(MIXED, |item| item.group);
                    if items.iter().all(|item| item.group == first) { first } else { MIXED }
                }
            };
            self.nodes[index].group = group;
        }
    }

    /// Finds the shortest link from every group to another.
    fn search_all(&self, nearest: &mut [Candidate]) {
        let mut pending = vec![0];
        while let Some(index) = pending.pop() {
            match (&self.nodes[index], self.nodes[index].children) {
                (Node { group: MIXED, .. }, Some(children)) => pending.extend(children),
                _ => self.search(index, 0, nearest),
            }
        }
    }

    /// Searches the points of node `there` for neighbours of the points of node `here`, which has a single
    /// group or is a leaf.
    fn search(&self, here: usize, there: usize, nearest: &mut [Candidate]) {
        let (h, t) = (&self.nodes[here], &self.nodes[there]);
        let is_own = h.group != MIXED && h.group == t.group;
        if is_own || sq_gap(h, t) > self.bound(h, nearest) {
            return;
        }
        let width = |node: &Node| (0..3).map(|i| node.high[i] - node.low[i]).fold(0.0, f64::max);
        match (h.children, t.children) {
            (None, None) => self.compare(h, t, nearest),
            (Some(children), None) => children.iter().for_each(|&c| self.search(c, there, nearest)),
            (Some(children), Some(_)) if width(h) > width(t) => {
                children.iter().for_each(|&c| self.search(c, there, nearest));
            }
            (_, Some([a, b])) => {
                let a_first = sq_gap(h, &self.nodes[a]) <= sq_gap(h, &self.nodes[b]);
                for child in if a_first { [a, b] } else { [b, a] } {
                    self.search(here, child, nearest);
                }
            }
        }
    }

    /// The largest squared length that can improve the link of a point of `node`, which has a single group or
    /// is a leaf.
    fn bound(&self, node: &Node, nearest: &[Candidate]) -> f64 {
        if node.group != MIXED {
            return nearest[node.group as usize].sq_length;
        }
        let items = &self.items[node.items.clone()];
        items.iter().map(|item| nearest[item.group as usize].sq_length).fold(0.0, f64::max)
    }

    /// Compares all points of two leaves.
    fn compare(&self, here: &Node, there: &Node, nearest: &mut [Candidate]) {
        for p in &self.items[here.items.clone()] {
            for q in self.items[there.items.clone()].iter().filter(|q| q.group != p.group) {
                let gap = [0, 1, 2].map(|axis| p.position[axis] - q.position[axis]);
                let ends = [p.vertex.min(q.vertex), p.vertex.max(q.vertex)];
                let candidate = Candidate { sq_length: sq_norm(gap), ends };
                nearest[p.group as usize].improve(candidate);
                nearest[q.group as usize].improve(candidate);
            }
        }
    }
}

/// Squared distance between two boxes. Never larger than that of two points in them, even with rounding,
/// since every step is monotonic.
fn sq_gap(a: &Node, b: &Node) -> f64 {
    let gap = [0, 1, 2].map(|axis| (a.low[axis] - b.high[axis]).max(b.low[axis] - a.high[axis]).max(0.0));
    sq_norm(gap)
}

fn sq_norm([x, y, z]: [f64; 3]) -> f64 {
    x * x + y * y + z * z
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
    fn one_component_or_none_needs_no_link() {
        assert_eq!(shortest_links(&[], &[]), []);
        assert_eq!(shortest_links(&[Point3::origin(); 3], &[0; 3]), []);
    }
}
