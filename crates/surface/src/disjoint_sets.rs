//! Disjoint sets over `0..n`, the representative of a set being its lowest member.

/// A union-find forest whose answers do not depend on the order of the unions.
#[derive(Debug, Clone)]
pub struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    /// `n` sets of one member each; `n` fits into 32 bits.
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect() }
    }

    /// The lowest member of the set of `item`.
    pub fn find(&mut self, item: u32) -> u32 {
        let mut item = item;
        while self.parent[item as usize] != item {
            let grandparent = self.parent[self.parent[item as usize] as usize];
            self.parent[item as usize] = grandparent;
            item = grandparent;
        }
        item
    }

    /// Joins two sets; false when they were one already.
    pub fn union(&mut self, a: u32, b: u32) -> bool {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
        a != b
    }

    /// Number of members.
    pub fn len(&self) -> usize {
        self.parent.len()
    }
}
