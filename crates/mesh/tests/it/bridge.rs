//! Laws of the links between components.

use base::{Budget, SplitMix};
use canonform_mesh::{ComponentPolicy, MeshError, Orient, RepairOptions, TriMesh, Weld, repair, shapes};
use nalgebra::Point3;
use surface::{DisjointSets, VertexId, components_of_faces};

const BRIDGED: RepairOptions =
    RepairOptions { components: ComponentPolicy::Bridge, weld: Weld::None, orient: Orient::Keep };

/// The lengths of the shortest of these links that join all components, ascending (Kruskal).
fn shortest_tree(mut links: Vec<(f64, [usize; 2])>, n_components: usize) -> Vec<f64> {
    links.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sets = DisjointSets::new(n_components);
    let joins = |(_, ends): &(f64, [usize; 2])| sets.union(ends[0] as u32, ends[1] as u32);
    links.into_iter().filter(joins).map(|(length, _)| length).collect()
}

#[test]
fn the_shortest_links_between_all_pairs_are_among_the_links() {
    for seed in 0..20 {
        let mut random = SplitMix(seed);
        let mut next = || 0.5 + 0.5 * random.uniform();
        let n_components = 2 + (next() * 12.0) as usize;
        // Half of the runs use a coarse lattice with many equal distances.
        let round = |x: f64| if seed % 2 == 0 { x } else { (x * 4.0).floor() };
        let spread = if seed % 3 == 0 { 5.0 } else { 0.0 };
        let point = |i: usize| {
            let label = (i % n_components) as f64;
            Point3::new(round(next()) + spread * label, round(next()), round(next()))
        };
        // A strip of triangles for each component.
        let strip = |i: usize| [0, 1, 2].map(|k| VertexId::from(i + k * n_components));
        let faces = (0..120 - 2 * n_components).map(strip).collect();
        let mesh = TriMesh { positions: (0..120).map(point).collect(), faces };
        let found = repair(&mesh, &BRIDGED, &()).unwrap();
        let mesh = found.mesh;
        let components = components_of_faces(mesh.n_vertices(), &mesh.faces);
        let label = |v: usize| components.labels[v].unwrap() as usize;
        let length = |[a, b]: [usize; 2]| (mesh.positions[a] - mesh.positions[b]).norm();
        let pairs = (0..mesh.n_vertices()).flat_map(|a| (0..a).map(move |b| [a, b]));
        let pairs = pairs.filter(|[a, b]| label(*a) != label(*b));
        let all = pairs.map(|ends| (length(ends), ends.map(label))).collect();
        let links =
            found.intrinsic.links().iter().map(|link| (link.length, link.ends.map(|v| label(v.index()))));
        let tree = shortest_tree(links.collect(), components.count);
        assert_eq!(tree.len(), components.count - 1);
        let gap = |(a, b): (f64, f64)| (a - b).abs();
        let expected = shortest_tree(all, components.count);
        assert!(tree.into_iter().zip(expected).map(gap).all(|gap| gap < 1e-12), "seed {seed}");
    }
}

#[test]
fn a_cancelled_search_ends() {
    let budget = Budget::unlimited();
    budget.cancel();
    let apart = shapes::disjoint(&[shapes::cube(9), shapes::grid(50, 50, 1.0)]);
    assert!(matches!(repair(&apart, &BRIDGED, &budget), Err(MeshError::Exceeded(_))));
}
