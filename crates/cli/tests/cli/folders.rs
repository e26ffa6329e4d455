//! Embedding a folder of meshes.

use std::fs;

use canonform::mesh::{io, shapes};

use crate::support::{Workplace, one_object, ring};

fn animals() -> Workplace {
    let place = Workplace::new();
    place.add("animals/cat0.off", &ring());
    place.add("animals/cat1.ply", &shapes::icosphere(2));
    place.add("animals/dogs/rex.obj", &shapes::cube(2));
    place
}

#[test]
fn every_mesh_of_a_folder_becomes_a_form() {
    let place = animals();
    let json = place.json("embed animals -n 20 --format off -o forms");
    let shapes = json["shapes"].as_array().unwrap();
    let facts: Vec<_> =
        shapes.iter().map(|s| [&s["name"], &s["label"]].map(|v| v.as_str().unwrap())).collect();
    assert_eq!(facts, [["cat0", "cat"], ["cat1", "cat"], ["dogs/rex", "dogs"]]);
    assert!(json["failed"].as_array().unwrap().is_empty());
    assert_eq!(io::read(&place.path("forms/cat0.off")).unwrap().faces, ring().faces);
    assert!(io::read(&place.path("forms/dogs/rex.off")).is_ok());
    // A folder gives the same bytes as a single mesh.
    place.done("embed animals/cat0.off -n 20 -o alone.off");
    assert_eq!(fs::read(place.path("alone.off")).unwrap(), fs::read(place.path("forms/cat0.off")).unwrap());
}

#[test]
fn a_bad_file_is_listed_and_does_not_stop_the_others() {
    let place = animals();
    fs::write(place.path("animals/cat9.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 zero\n3 0 1 2\n").unwrap();
    for options in [&[][..], &["--json"]] {
        let outcome = place.run(&[&["embed", "animals", "-n", "20", "-o", "forms"], options].concat());
        assert_eq!(outcome.code, 2);
        assert!(outcome.err.contains("cat9.off") && outcome.err.contains("line 5"), "{}", outcome.err);
        for name in ["cat0", "cat1", "dogs/rex"] {
            assert!(io::read(&place.path(&format!("forms/{name}.ply"))).is_ok(), "{name}");
        }
        assert!(!place.path("forms/cat9.ply").exists());
        if !options.is_empty() {
            let json = one_object(&outcome.out);
            assert_eq!(json["shapes"].as_array().unwrap().len(), 3);
            assert_eq!(json["failed"][0]["name"], "cat9");
        }
    }
}

#[test]
fn forms_never_overwrite_each_other_or_the_meshes() {
    let place = animals();
    place.add("animals/cat0.ply", &shapes::tetrahedron(3));
    place.refused("embed animals -n 20 -o forms", &["cat0.off", "cat0.ply", "rename one"]);
    assert!(!place.path("forms").exists());

    let place = animals();
    let cat = fs::read(place.path("animals/cat1.ply")).unwrap();
    place.refused("embed animals -n 20 -o animals", &["animals", "choose another folder"]);
    assert_eq!(fs::read(place.path("animals/cat1.ply")).unwrap(), cat);
    assert!(!place.path("animals/cat0.ply").exists());
}

#[test]
fn errors_name_a_folder_without_meshes() {
    let place = Workplace::new();
    fs::create_dir(place.path("void")).unwrap();
    place.refused("embed void -o forms", &["void", "no mesh found"]);
    place.refused("info void", &["void", "no mesh found"]);
    assert_eq!(place.names(), ["void"]);
}
