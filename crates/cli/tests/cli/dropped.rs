//! Surfaces that a repair drops: what is said, and the exit code.

use canonform::mesh::{TriMesh, shapes};
use serde_json::Value;

use crate::support::{Workplace, one_object, ring};

/// Two sheets side by side with a gap of a fifth of an edge, the second half as large as the first.
fn halves() -> TriMesh {
    let mut right = shapes::grid(6, 11, 1.0);
    right.positions.iter_mut().for_each(|p| p.x += 10.2);
    shapes::disjoint(&[shapes::grid(11, 11, 1.0), right])
}

fn place() -> Workplace {
    let place = Workplace::new();
    place.add("set/halves1.off", &halves());
    place.add("set/ring1.off", &ring());
    place
}

fn share(json: &Value) -> f64 {
    json["dropped_area_share"].as_f64().unwrap()
}

#[test]
fn a_lost_surface_gives_exit_code_1_and_is_named_with_its_remedies() {
    let place = place();
    let embed = ["embed", "set/halves1.off", "-n", "20", "-o", "f.npy"];
    for arguments in [
        &["info", "set/halves1.off"][..],
        &["geodesic", "set/halves1.off", "--source", "0", "-o", "d.npy"],
        &embed,
        &["methods", "set/halves1.off", "-n", "20"],
        &["compare", "set/ring1.off", "set/halves1.off", "-n", "20"],
        &["embed", "set", "-n", "20", "-o", "forms", "--format", "npy"],
    ] {
        let outcome = place.run(&[arguments, &["--json"]].concat());
        assert_eq!(outcome.code, 1, "{arguments:?}: {}", outcome.err);
        one_object(&outcome.out);
        for word in ["33.3 % of the surface", "--components bridge", "--weld TOL", "--max-dropped"] {
            assert!(outcome.err.contains(word), "{arguments:?}: no `{word}` in {}", outcome.err);
        }
        assert!(outcome.err.contains("halves1"), "{}", outcome.err);
    }
    // Results are written all the same.
    assert!(place.path("f.npy").exists() && place.path("d.npy").exists());
    assert!(place.path("forms/halves1.npy").exists());

    for accepted in [&["--max-dropped", "0.4"][..], &["--components", "bridge"], &["--weld", "0.25"]] {
        place.json(&[&embed[..], accepted].concat());
    }
    place.refused(&[&embed[..], &["--max-dropped", "40"]].concat(), &["40", "0 to 1"]);
    place.refused(&[&embed[..], &["--weld", "glue"]].concat(), &["glue", "seams", "mesh units"]);
}

#[test]
fn an_index_build_lists_the_shapes_that_lost_a_part() {
    let place = place();
    for run in 0..2 {
        let outcome = place.run("index build set -o s.canonform --json");
        assert_eq!(outcome.code, 1, "run {run}: {}", outcome.err);
        let json = one_object(&outcome.out);
        let dropped = json["dropped"].as_array().unwrap();
        assert_eq!((dropped.len(), &dropped[0]["id"]), (1, &Value::from("halves1")));
        assert!((share(&dropped[0]) - 1.0 / 3.0).abs() < 1e-12);
        assert!(outcome.err.contains("halves1: 33.3 % of the surface was dropped"), "{}", outcome.err);
    }
    let table = place.run("index build set -o t.canonform -q");
    assert!(table.out.contains("incomplete") && table.code == 1, "{}", table.out);
    place.json("index build set -o u.canonform --components bridge");
}
