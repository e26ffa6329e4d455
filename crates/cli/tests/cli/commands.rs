//! What commands choose, compare and print, and their exit codes.

use std::process::Stdio;

use canonform::mesh::shapes;
use serde_json::Value;

use crate::support::{Workplace, one_object, read_npy, ring};

#[test]
fn embed_says_what_it_chose_and_compared() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    for (options, key, value) in [
        ("--method smacof --rank 9 --iterations 4 --tolerance 0 -n 30", "/descent/iterations", 4.into()),
        ("--stress exact -n 30", "/stress/kind", "exact".into()),
        ("--stress skip -n 30", "/stress", Value::Null),
        ("--geodesic bfs -n 30", "/stress/geodesic", "bfs".into()),
        ("--geodesic bfs --stress-against fast-marching -n 30", "/stress/geodesic", "fast-marching".into()),
        ("-n 30", "/auto", Value::Null),
        ("-n auto --rank 12", "/rank", 12.into()),
        ("-n auto", "/auto/stop", "settled".into()),
    ] {
        let found = place.json(format!("embed ring.off -o form.npy {options}"));
        assert_eq!(found.pointer(key), Some(&value), "{options}");
    }
}

#[test]
fn points_and_finer_meshes_are_placed_in_a_form() {
    let place = Workplace::new();
    place.add("coarse.off", &shapes::icosphere(2));
    place.add("fine.off", &shapes::icosphere(3));
    let coarse = place.json("embed coarse.off -o coarse.npy --at f8@2:1:1,7");
    let (_, rows) = read_npy(&place.path("coarse.npy"));
    let [other, at] = [0, 1].map(|i| &coarse["points"][i]);
    assert!(other["at"] == "f8@2:1:1" && at["at"] == 7);
    assert!((0..3).all(|i| (at["coordinates"][i].as_f64().unwrap() - rows[21 + i]).abs() < 1e-9), "{at}");
    let fine = place.json("embed fine.off --extend coarse.off -o fine.npy");
    assert_eq!(fine["n_samples"], coarse["n_samples"]);
}

#[test]
fn a_comparison_tells_the_relation_as_text_as_json_and_by_its_exit_code() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place.add("ball.off", &shapes::icosphere(2));
    std::fs::create_dir(place.path("other")).unwrap();
    std::fs::copy(place.path("ring.off"), place.path("other/ring.off")).unwrap();
    place.add("inches.ply", &testkit::moved(&ring(), |p| nalgebra::Point3::new(p.y, -p.x, p.z) / 25.4));
    let same = "other/ring.off is the same file as ring.off";
    for (other, option, kind, code, words) in [
        ("other/ring.off", "--threshold 0.01", "identical-file", 0, same),
        ("inches.ply", "--exit-code=same-class", "scaled", 0, "scaled by"),
        ("ball.off", "--exit-code", "different", 1, "ball.off is not the same shape as ring.off"),
        ("ball.off", "--exit-code=same-class", "different", 1, ""),
        ("ball.off", "--threshold 0.01", "different", 1, "exceeded"),
        // The forms are always nearer than this: only the relation can fail.
        ("ball.off", "--threshold 99", "different", 1, "not exceeded, but the shapes are different"),
    ] {
        let asked = format!("compare ring.off {other} {option}");
        let [text, json] = ["--details", "--json"].map(|form| place.run(format!("{asked} {form}")));
        assert_eq!((text.code, json.code), (code, code), "{asked}: {}", text.out);
        let json = one_object(&json.out);
        let relation = &json["relation"];
        assert_eq!(relation["kind"], kind, "{asked}");
        assert_eq!(relation["because"]["combined_distance"], json["combined_distance"]);
        assert!(text.out.starts_with(&format!("{}.\n", relation["text"].as_str().unwrap())), "{}", text.out);
        for words in [words, relation["because"]["text"].as_str().unwrap()] {
            assert!(text.out.contains(words), "{asked}: no `{words}` in {}", text.out);
        }
        let failed = option.starts_with("--threshold").then_some(code == 1);
        assert_eq!(json["failed"].as_bool(), failed, "{asked}");
    }
    // The relation does not depend on the options.
    let apart = place.json("compare ring.off ball.off");
    let again = place.json("compare ring.off ball.off --method kpca --geodesic bfs -n 20");
    for key in ["/combined_distance", "/relation/kind"] {
        assert_eq!(again.pointer(key), apart.pointer(key), "{key}");
    }
}

#[test]
fn help_fits_two_screens_unless_all_is_asked_for() {
    let place = Workplace::new();
    // As many lines as a terminal of this width needs.
    let n_lines =
        |page: &str| page.lines().map(|line| line.chars().count().div_ceil(120).max(1)).sum::<usize>();
    for command in
        ["embed", "compare", "index build", "match", "methods", "search", "info", "geodesic", "render"]
    {
        let usual = place.done(format!("{command} --help")).out;
        assert!(n_lines(&usual) < 60, "{command} --help has {} lines: {usual}", n_lines(&usual));
        assert!(usual.contains("--help-all"), "{usual}");
    }
    assert_eq!(place.done("embed -h").out, place.done("embed --help").out);
    let embed = place.done("embed --help-all").out;
    assert!(embed.contains("||Z Z' + 1/2 J E J||_F / p") && embed.contains("--mu"), "{embed}");
    assert!(place.done("completions zsh").out.contains("geodesic"));
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    for command in
        ["info ring.off ring.off ring.off", "embed ring.off -n 20 -o form.npy", "completions bash", "--help"]
    {
        let mut child = place.command(command).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{command}: {message}");
        assert!(!message.contains("panicked") && !message.contains("error"), "{command}: {message}");
    }
}

#[test]
fn methods_compares_every_method_marks_the_best_and_continues_after_a_failure() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let json = place.json("methods ring.off -n 20");
    let methods = json["methods"].as_array().unwrap();
    for method in methods.iter().filter(|m| m["error"].is_null()) {
        assert!(method["peak_bytes"].as_u64().unwrap() > 160 * 20 * 8, "{method}");
        assert_eq!(method["stress"].is_null(), method["method"] == "kpca", "{method}");
    }
    let stress = |m: &Value| m["stress"]["value"].as_f64();
    let best = stress(&methods[json["best"].as_u64().unwrap() as usize]).unwrap();
    assert!(methods.iter().filter_map(stress).all(|s| best <= s));
    let text = place.done("methods ring.off -n 3 --stress estimate").out;
    assert!(text.contains("landmark  failed: cannot embed") && text.contains(" *"), "{text}");
}
