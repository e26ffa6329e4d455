//! `canonform generate`.

use std::fs;

use canonform::mesh::io::read;
use datasets::{ArticulatedOptions, CreatureOptions, Family, articulated_shape, creatures};

use crate::support::Workplace;

#[test]
fn built_in_shapes_are_written_as_they_are() {
    let place = Workplace::new();
    let json = place.json("generate --family cat --poses 2 --vertices 1000 -o cats");
    let shapes = json["shapes"].as_array().unwrap();
    assert_eq!((shapes.len(), json["n_classes"].as_u64()), (2, Some(1)));
    let options = ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() };
    for (pose, shape) in shapes.iter().enumerate() {
        let expected = articulated_shape(Family::Cat, pose, &options).unwrap();
        assert_eq!((shape["name"].as_str(), shape["label"].as_str()), (Some(&*expected.name), Some("cat")));
        assert_eq!(read(&place.path(shape["path"].as_str().unwrap())).unwrap(), expected.mesh);
    }
    // Another seed gives another shape, on any number of threads the same.
    let other = "generate --family cat --poses 1 --vertices 1000 --seed 7";
    place.done(format!("{other} -o one --threads 1"));
    place.done(format!("{other} -o two --threads 2 --output-format off"));
    let bytes = |folder: &str| fs::read(place.path(folder).join("cat0.off")).unwrap();
    assert!(bytes("one") == bytes("two") && bytes("one") != bytes("cats"));
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
