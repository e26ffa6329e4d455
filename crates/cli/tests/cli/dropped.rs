//! Surfaces that a repair drops: what is said, and the exit code.

use canonform::mesh::shapes;

use crate::support::{Workplace, one_object, ring};

#[test]
fn a_lost_surface_gives_exit_code_1_and_is_named_with_its_remedies() {
    let place = Workplace::new();
    // Two sheets side by side with a gap of a fifth of an edge, the second half as large as the first.
    let mut right = shapes::grid(6, 11, 1.0);
    right.positions.iter_mut().for_each(|p| p.x += 10.2);
    place.add("set/halves1.off", &shapes::disjoint(&[shapes::grid(11, 11, 1.0), right]));
    place.add("set/ring1.off", &ring());
    for command in [
        "info set/halves1.off",
        "geodesic set/halves1.off --source 0 -o d.npy",
        "embed set/halves1.off -n 20 -o f.npy",
        "methods set/halves1.off -n 20",
        "compare set/ring1.off set/halves1.off -n 20",
        "embed set -n 20 -o forms --format npy",
    ] {
        let outcome = place.run(format!("{command} --json"));
        assert_eq!(outcome.code, 1, "{command}: {}", outcome.err);
        one_object(&outcome.out);
        for word in ["halves1", "33.3 % of the surface", "--components bridge", "--weld TOL", "--max-dropped"]
        {
            assert!(outcome.err.contains(word), "{command}: no `{word}` in {}", outcome.err);
        }
    }
    // Results are written all the same.
    for path in ["f.npy", "d.npy", "forms/halves1.npy"] {
        assert!(place.path(path).exists(), "{path}");
    }
    for accepted in ["--max-dropped 0.4", "--components bridge", "--weld 0.25"] {
        place.json(format!("embed set/halves1.off -n 20 -o f.npy {accepted}"));
    }
    // An index lists the shapes that lost a part, also those that it has described already.
    for run in 0..2 {
        let outcome = place.run("index build set -o s.canonform --json");
        assert_eq!(outcome.code, 1, "run {run}: {}", outcome.err);
        let json = one_object(&outcome.out);
        let dropped = json["dropped"].as_array().unwrap();
        assert!(dropped.len() == 1 && dropped[0]["id"] == "halves1", "{json}");
        assert!((dropped[0]["dropped_area_share"].as_f64().unwrap() - 1.0 / 3.0).abs() < 1e-12);
        assert!(outcome.err.contains("halves1: 33.3 % of the surface was dropped"), "{}", outcome.err);
    }
}
