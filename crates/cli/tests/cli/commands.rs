//! Every command on an intact mesh, and where its output goes.

use std::process::Stdio;

use canonform::mesh::shapes;
use serde_json::{Value, json};

use crate::index::{BUILD, collection};
use crate::support::{Workplace, broken_ring, one_object, read_npy, ring};

#[test]
fn info_reports_what_a_mesh_contains() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place.add("broken.ply", &broken_ring());
    let text = place.done("info ring.off --details").out;
    for words in ["160, 480, 320", "genus", "nothing", "size", "volume"] {
        assert!(text.contains(words), "no {words} in {text}");
    }
    assert!(place.done("info ring.off ring.off -q").out.ends_with("2 meshes: 2 off\n"));
    // A folder means all meshes in it.
    let json = place.json("info .");
    let [broken, ring] = [0, 1].map(|i| &json["meshes"][i]);
    assert_eq!((&ring["mesh"]["genus"], &broken["mesh"]["n_components"]), (&1.into(), &2.into()));
    assert_eq!(broken["repair"]["dropped_components"], 1);
}

/// The keys that never change their meaning; the guide, whose commands are tests, lists them all.
#[test]
fn json_keeps_its_contract() {
    let place = collection(2);
    place.add("broken.off", &broken_ring());
    std::fs::copy(place.path("meshes/ring0.off"), place.path("meshes/ring3.off")).unwrap();
    place.done(BUILD);
    place.done("field build meshes/ring0.off --landmarks 10 -o x.field");
    for (command, keys) in [
        (
            "geodesic broken.off --source 0,7 -o d.npy",
            "method n_vertices sources seconds/load seconds/setup seconds/per_source/1 unreached repair",
        ),
        (
            "embed broken.off -n 20 --rank 9 -o form.ply",
            "method n_vertices n_faces n_samples rank dim samples/19 eigenvalues negative_mass stress/value stress/kind \
             stress/interval/1 seconds/geodesics seconds/embedding seconds/total repair/dropped_area_share",
        ),
        (
            "compare broken.off meshes/ball0.off",
            "relation distance normalized_distance rotation translation reflected same_below scale combined_distance \
             fused_distance triangulation residual",
        ),
        ("info broken.off", "meshes/0/repair/dropped_area_share"),
        (
            "field query x.field --source 3 --nearest 2",
            "pairs/1/a pairs/1/b pairs/1/distance pairs/1/lower pairs/1/upper",
        ),
        (
            "search all.canonform meshes/ring0.off",
            "queries/0/query queries/0/results/0/rank queries/0/results/0/id queries/0/results/0/label \
             queries/0/results/0/path queries/0/results/0/distance queries/0/results/0/relation \
             queries/0/predicted/label queries/0/predicted/votes failed",
        ),
        (
            "duplicates all.canonform",
            "groups/0/keeper groups/0/members/0/id groups/0/members/0/path groups/0/members/0/relation",
        ),
        ("evaluate all.canonform", "n classes nn ft st e dcg map knn_accuracy confusion silhouette"),
    ] {
        let json = place.json(command);
        for key in keys.split(' ') {
            assert!(json.pointer(&format!("/{key}")).is_some(), "{command}: no `{key}` in {json}");
        }
    }
    let json = place.json("geodesic broken.off --source 0,7 -o d.npy");
    assert_eq!((&json["n_vertices"], &json["sources"]), (&170.into(), &json!([0, 7])));
    assert_eq!(json["unreached"], json!((160..170).collect::<Vec<_>>()));
    assert_eq!(json["unreached"], json["repair"]["dropped_vertices"]);
    let text = place.done("embed meshes/ring0.off -n 20 -o form.ply --details").out;
    assert!(["stress", "form.ply", "95 %", "rows)"].iter().all(|word| text.contains(word)), "{text}");
}

#[test]
fn embed_says_what_it_chose_and_compared() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    for (options, key, value) in [
        ("--method mds", "/n_samples", Value::from(160)),
        ("--method smacof --rank 9 --iterations 4 --tolerance 0 -n 30", "/descent/iterations", 4.into()),
        ("--first-sample 11 -n 30", "/samples/0", 11.into()),
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
    let coarse = place.json("embed coarse.off -o coarse.npy --at 7,f8@2:1:1");
    let (_, rows) = read_npy(&place.path("coarse.npy"));
    let [at, other] = [0, 1].map(|i| &coarse["points"][i]);
    assert_eq!((&at["at"], &other["at"]), (&7.into(), &"f8@2:1:1".into()));
    assert!((0..3).all(|i| (at["coordinates"][i].as_f64().unwrap() - rows[21 + i]).abs() < 1e-9), "{at}");
    let fine = place.json("embed fine.off --extend coarse.off -o fine.npy");
    let (shape, finer) = read_npy(&place.path("fine.npy"));
    assert_eq!((shape, &fine["n_samples"]), (vec![642, 3], &coarse["n_samples"]));
    assert!(rows.iter().zip(&finer).all(|(a, b)| (a - b).abs() < 0.1));
}

#[test]
fn a_comparison_tells_the_relation_as_text_as_json_and_by_its_exit_code() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place.add("ball.off", &shapes::icosphere(2));
    std::fs::create_dir(place.path("other")).unwrap();
    std::fs::copy(place.path("ring.off"), place.path("other/ring.off")).unwrap();
    let mut inches = ring();
    inches.positions.iter_mut().for_each(|p| *p = nalgebra::Point3::new(p.y, -p.x, p.z) / 25.4);
    place.add("inches.ply", &inches);
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
    assert!(place.done("--version").out.starts_with("canonform "));
    for shell in ["bash", "zsh", "fish"] {
        let script = place.done(format!("completions {shell}")).out;
        assert!(["canonform", "geodesic", "render"].iter().all(|word| script.contains(word)), "{script}");
    }
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    for command in [
        "info ring.off ring.off ring.off",
        "info ring.off --json",
        "embed ring.off -n 20 -o form.npy",
        "completions bash",
        "--help",
    ] {
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
    for wanted in ["nmds", "landmark", "spectral", "kpca", "mds", "smacof"] {
        assert!(methods.iter().any(|m| m["method"] == wanted), "{wanted}");
    }
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
