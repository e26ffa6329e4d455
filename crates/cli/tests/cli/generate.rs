//! `canonform generate`.

use std::fs;

use canonform::mesh::io::read;
use datasets::{ArticulatedOptions, CreatureOptions, Family, articulated_shape, creatures};

use crate::support::Workplace;

#[test]
fn built_in_shapes_are_written_as_they_are() {
    let place = Workplace::new();
    let json = place.json("generate --family cat --poses 2 --vertices 1000 -o cats");
    let options = ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() };
    for (pose, shape) in json["shapes"].as_array().unwrap().iter().enumerate() {
        let expected = articulated_shape(Family::Cat, pose, &options).unwrap();
        assert_eq!([&shape["name"], &shape["label"]], [&*expected.name, "cat"]);
        assert_eq!(read(&place.path(shape["path"].as_str().unwrap())).unwrap(), expected.mesh);
    }
    place.done("generate --family cat --poses 1 --vertices 1000 --seed 7 -o other");
    let bytes = |folder: &str| fs::read(place.path(folder).join("cat0.off")).unwrap();
    assert_ne!(bytes("other"), bytes("cats"), "another seed");
    // Creatures are written into a folder for each class.
    place
        .done("generate -o all --family creatures --classes 2 --poses 2 --vertices 1000 --output-format ply");
    let options =
        CreatureOptions { n_families: 2, n_poses: 2, n_vertices: 1000, ..CreatureOptions::default() };
    for shape in creatures(&options).unwrap() {
        let path = place.path("all").join(&shape.label).join(format!("{}.ply", shape.name));
        assert_eq!(read(&path).unwrap(), shape.mesh, "{}", path.display());
    }
}
