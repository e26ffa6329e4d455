//! Which vertices heat can reach from which.

use surface::IntrinsicMesh;

/// The component of every vertex along edges and links, and one vertex of each.
#[derive(Debug)]
pub(super) struct Components {
    /// Numbered in the order of their lowest vertices.
    pub(super) of: Vec<u32>,
    /// The lowest vertex of each component.
    pub(super) first: Vec<usize>,
}

impl Components {
    pub(super) fn new(mesh: &IntrinsicMesh) -> Self {
        // A forest in which the root of every tree is its lowest vertex.
        let mut parent: Vec<u32> = (0..mesh.n_vertices() as u32).collect();
        let links = mesh.links().iter().map(|link| &link.ends);
        for ends in mesh.topology().edges().iter().chain(links) {
            let [a, b] = ends.map(|v| root(&mut parent, v.0));
            parent[a.max(b) as usize] = a.min(b);
        }
        let mut result = Self { of: Vec::with_capacity(mesh.n_vertices()), first: Vec::new() };
        for v in 0..mesh.n_vertices() {
            let lowest = root(&mut parent, v as u32) as usize;
            if lowest == v {
                result.of.push(result.first.len() as u32);
                result.first.push(v);
            } else {
                result.of.push(result.of[lowest]);
            }
        }
        result
    }
}

/// The root of the tree that holds `v`, whose path to it is halved.
fn root(parent: &mut [u32], mut v: u32) -> u32 {
    while parent[v as usize] != v {
        parent[v as usize] = parent[parent[v as usize] as usize];
        v = parent[v as usize];
    }
    v
}
