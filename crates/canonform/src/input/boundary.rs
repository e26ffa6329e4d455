//! The boundary of a surface.

use surface::IntrinsicMesh;

/// Length of the longest boundary of a surface, in mesh units; 0 for a closed one. Boundaries that touch count as one.
pub(super) fn longest_boundary(mesh: &IntrinsicMesh) -> f64 {
    let topology = mesh.topology();
    let mut root: Vec<usize> = (0..mesh.n_vertices()).collect();
    fn find(root: &mut [usize], mut v: usize) -> usize {
        while root[v] != v {
            root[v] = root[root[v]];
            v = root[v];
        }
        v
    }
    let boundary: Vec<_> = topology
        .edges()
        .iter()
        .zip(mesh.edge_lengths())
        .enumerate()
        .filter(|(edge, _)| topology.edge_corners((*edge).into()).len() == 1)
        .map(|(_, (ends, length))| (ends.map(|v| v.index()), *length))
        .collect();
    for ([a, b], _) in &boundary {
        let (a, b) = (find(&mut root, *a), find(&mut root, *b));
        root[a] = b;
    }
    let mut lengths = vec![0.0f64; mesh.n_vertices()];
    for ([a, _], length) in &boundary {
        lengths[find(&mut root, *a)] += length;
    }
    lengths.into_iter().fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use mesh::shapes;

    use super::*;
    use crate::input::Surface;

    #[test]
    fn boundaries_are_measured_one_by_one() {
        let length = |mesh| longest_boundary(&Surface::new(&mesh, &Default::default()).unwrap().intrinsic);
        assert_eq!(length(shapes::icosphere(2)), 0.0);
        let (large, small) = (shapes::grid(11, 6, 0.1), shapes::grid(3, 3, 0.1));
        assert!((length(large.clone()) - 3.0).abs() < 1e-9);
        let bridged = mesh::RepairOptions { components: mesh::ComponentPolicy::Bridge, ..Default::default() };
        let two = Surface::new(&shapes::disjoint(&[large, small]), &bridged).unwrap();
        assert!((longest_boundary(&two.intrinsic) - 3.0).abs() < 1e-9);
    }
}
