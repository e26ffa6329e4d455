//! A search says of every result what a comparison of the two meshes says.

use canonform::compare::{ComparedMesh, compare_meshes};
use canonform::embed::FormOptions;
use canonform::library::{BuildOptions, build_index};
use canonform::mesh::{TriMesh, shapes};
use canonform::search::{SearchOptions, ShapeSearch};
use canonform::{DescribeOptions, Surface};
use nalgebra::Vector3;
use testkit::moved;

#[test]
fn relations_of_a_search_are_those_of_a_comparison() {
    let folder = tempfile::tempdir().unwrap();
    let (plate, ring) = (shapes::grid(21, 17, 0.5), shapes::torus(24, 12, 2.0, 0.6));
    let wave = |x: f64| (1.3 * x).sin();
    let mat = moved(&plate, |p| nalgebra::Point3::new(p.x, p.y, 0.2 * wave(p.x) * wave(p.y)));
    let far = Vector3::repeat(1234.567);
    let rounded = |mesh: &TriMesh| moved(mesh, |p| (p + far).map(|x| f64::from(x as f32)));
    // Its triangles are those of the ring, which it is far from by descriptions.
    let mut arc = ring.clone();
    arc.faces.truncate(ring.faces.len() / 3);
    let meshes = [
        ("plate", plate.clone()),
        ("plate-rounded", rounded(&plate)),
        ("mat", mat.clone()),
        ("mat-moved", rounded(&mat)),
        ("ring", ring.clone()),
        ("arc", arc),
        ("ring-large", moved(&ring, |p| p * 25.4)),
        ("ball", shapes::icosphere(3)),
        ("both", shapes::disjoint(&[moved(&ring, |p| p + far), shapes::icosphere(3)])),
    ];
    for (name, mesh) in &meshes {
        canonform::mesh::io::write(&folder.path().join(format!("{name}.off")), mesh).unwrap();
    }
    let path = folder.path().join("all.canonform");
    build_index(folder.path(), &path, &BuildOptions::new(&DescribeOptions::default()), &()).unwrap();
    let search = ShapeSearch::open(&path).unwrap();
    let compared = |(name, _): &(&str, TriMesh)| {
        let mesh = search.mesh(name).unwrap();
        let surface = Surface::new(&mesh, &Default::default(), &()).unwrap();
        ComparedMesh::new(&mesh, None, surface, &FormOptions::default(), &()).unwrap()
    };
    let sides: Vec<_> = meshes.iter().map(compared).collect();
    let options = SearchOptions { k: meshes.len(), explain: true, ..SearchOptions::default() };
    let mut n_pairs = 0;
    for (query, a) in meshes.iter().zip(&sides) {
        let mesh = search.mesh(query.0).unwrap();
        let asked = search.query(&mesh, ("the query", None), &options, &()).unwrap();
        for found in search.search(&asked, &options, &()).unwrap().results {
            let b = meshes.iter().position(|(name, _)| *name == found.id).unwrap();
            let expected = compare_meshes([a.compared(), sides[b].compared()]).unwrap().relation;
            let [found, expected] =
                [found.relation, expected].map(|relation| (relation.kind, relation.changes));
            assert_eq!(found, expected, "{} and {}", query.0, meshes[b].0);
            n_pairs += 1;
        }
    }
    assert_eq!(n_pairs, meshes.len() * meshes.len());
}
