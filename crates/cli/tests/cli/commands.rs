//! Every command on an intact mesh, and where its output goes.

use std::process::Stdio;

use canonform::mesh::shapes;
use canonform::surface::VertexId;
use serde_json::{Value, json};

use crate::support::{Workplace, assert_keys, broken_ring, one_object, program, read_npy, ring};

#[test]
fn info_reports_what_a_mesh_contains() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place.add("broken.ply", &broken_ring());
    let text = place.done("info ring.off --details").out;
    assert!(text.contains("160, 480, 320") && text.contains("genus") && text.contains("nothing"), "{text}");
    assert!(text.contains("size") && text.contains("volume"), "{text}");
    assert!(place.done("info ring.off ring.off -q").out.ends_with("2 meshes: 2 off\n"));
    place.refused("search . ring.off", &["this is a folder", "index build"]);

    let json = place.json("info ring.off broken.ply");
    let meshes = json["meshes"].as_array().unwrap();
    assert_eq!(meshes.len(), 2);
    assert_eq!(meshes[0]["mesh"]["genus"], 1);
    assert_eq!(meshes[1]["mesh"]["n_components"], 2);
    assert_eq!(meshes[1]["repair"]["dropped_components"], 1);
    // A folder means all meshes in it.
    assert_eq!(place.json("info .")["meshes"].as_array().unwrap().len(), 2);
}

#[test]
fn info_names_places_where_distant_parts_are_joined() {
    let place = Workplace::new();
    let mut welded = shapes::icosphere(3);
    let highest = |sign: f64| {
        let z = |v: &usize| sign * welded.positions[*v].z;
        VertexId::from((0..welded.n_vertices()).max_by(|a, b| z(a).total_cmp(&z(b))).unwrap())
    };
    let (top, bottom) = (highest(1.0), highest(-1.0));
    welded.faces.iter_mut().flatten().filter(|v| **v == bottom).for_each(|v| *v = top);
    place.add("welded.off", &welded);
    let text = place.done("info welded.off").out;
    assert!(text.contains("probable shortcut") && text.contains(&format!("vertex {}", top.0)), "{text}");
    let json = place.json("info welded.off");
    let shortcuts = json["meshes"][0]["shortcuts"].as_array().unwrap();
    assert_eq!((shortcuts.len(), shortcuts[0]["kind"].as_str()), (1, Some("pinch")));
    assert_eq!(shortcuts[0]["vertex"], top.0);
}

#[test]
fn geodesic_keeps_the_contract_of_its_json() {
    let place = Workplace::new();
    place.add("broken.off", &broken_ring());
    let json = place.json("geodesic broken.off --source 0,7 -o d.npy");
    assert_keys(&json, "method n_vertices sources seconds unreached repair");
    assert_keys(&json["seconds"], "load setup per_source");
    assert_eq!(json["method"], "fast-marching");
    assert_eq!(json["n_vertices"], 170);
    assert_eq!(json["sources"], serde_json::json!([0, 7]));
    assert_eq!(json["seconds"]["per_source"].as_array().unwrap().len(), 2);
    assert_eq!(json["unreached"], serde_json::json!((160..170).collect::<Vec<_>>()));
    assert_eq!(json["unreached"], json["repair"]["dropped_vertices"]);
}

#[test]
fn embed_keeps_the_contract_of_its_json() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let json = place.json("embed ring.off -n 20 --rank 9 -o form.ply");
    assert_keys(
        &json,
        "method n_vertices n_faces n_samples rank dim samples eigenvalues negative_mass stress seconds repair",
    );
    assert_keys(&json["stress"], "value kind interval");
    assert_keys(&json["seconds"], "geodesics embedding total");
    assert_eq!((&json["method"], &json["stress"]["kind"]), (&"nmds".into(), &"estimated".into()));
    assert_eq!((&json["n_vertices"], &json["n_faces"]), (&160.into(), &320.into()));
    assert_eq!((&json["n_samples"], &json["rank"], &json["dim"]), (&20.into(), &9.into(), &3.into()));
    assert_eq!(json["samples"].as_array().unwrap().len(), 20);
    let [low, high] = [0, 1].map(|i| json["stress"]["interval"][i].as_f64().unwrap());
    let value = json["stress"]["value"].as_f64().unwrap();
    assert!(low <= value && value <= high);

    let text = place.done("embed ring.off -n 20 -o form.ply --details").out;
    assert!(["stress", "form.ply", "95 %", "rows)"].iter().all(|word| text.contains(word)), "{text}");
}

#[test]
fn embed_accepts_all_options_methods_and_samplings() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    for (options, key, value) in [
        ("--method mds", "/n_samples", Value::from(160)),
        ("--method kpca --sigma mean -n 30", "/method", "kpca".into()),
        ("--method kpca --sigma 0.7 -n 30", "/method", "kpca".into()),
        ("--method nmds --regularization low-rank --rank 9 -n 30", "/rank", 9.into()),
        ("--method nmds --regularization rpi --alpha paper -n 30", "/regularization", "rpi".into()),
        ("--method nmds --regularization none -n 30", "/regularization", "none".into()),
        ("--method nmds --regularization cur --rank 9 -n 30", "/regularization", "cur".into()),
        ("--method landmark -n 30", "/rank", 3.into()),
        ("--method spectral --eigenvectors 60 --mu inf -n 30", "/rank", 30.into()),
        (
            "--method smacof --rank 9 --iterations 4 --tolerance 0 -n 30",
            "/descent",
            json!({"iterations": 4, "stop": "iteration-limit"}),
        ),
        ("--geodesic dijkstra -n 30", "/geodesic", "dijkstra".into()),
        ("--first-sample 11 -n 30", "/samples/0", 11.into()),
        ("--sampling random --seed 4 -n 30", "/sampling", "random".into()),
        ("--sampling min-variance --first-sample 11 -n 30", "/samples/0", 11.into()),
        ("--dim 5 -n 30", "/dim", 5.into()),
        ("--stress exact -n 30", "/stress/kind", "exact".into()),
        ("--stress estimate -n 30 --seed 4", "/stress/kind", "estimated".into()),
        ("--stress skip -n 30", "/stress", Value::Null),
        ("--geodesic bfs -n 30", "/stress/geodesic", "bfs".into()),
        ("--geodesic bfs --stress-against fast-marching -n 30", "/stress/geodesic", "fast-marching".into()),
        ("-n 30", "/auto", Value::Null),
        ("-n auto --rank 12", "/rank", 12.into()),
        ("-n auto", "/auto/stop", "settled".into()),
    ] {
        let found = place.json(format!("embed ring.off -o form.npy {options}"));
        match (found.pointer(key), value.as_object()) {
            (Some(found), Some(fields)) => {
                assert!(fields.iter().all(|(key, value)| found[key] == *value), "{options}: {found}");
            }
            (found, _) => assert_eq!(found, Some(&value), "{options}"),
        }
    }
    place.refused("embed ring.off -o f.npy -n auto --method kpca", &["kpca", "give --samples"]);
}

#[test]
fn points_and_finer_meshes_are_placed_in_a_form() {
    let place = Workplace::new();
    for (name, level) in [("coarse.off", 2), ("fine.off", 3)] {
        place.add(name, &shapes::icosphere(level));
    }
    let coarse = place.json("embed coarse.off -o coarse.npy --at 7,f8@2:1:1");
    let (_, rows) = read_npy(&place.path("coarse.npy"));
    let at: Vec<f64> =
        coarse["points"][0]["coordinates"].as_array().unwrap().iter().flat_map(Value::as_f64).collect();
    assert_eq!((&coarse["points"][0]["at"], &coarse["points"][1]["at"]), (&7.into(), &"f8@2:1:1".into()));
    assert!(at.iter().zip(&rows[21..24]).all(|(a, b)| (a - b).abs() < 1e-9), "{at:?}");
    let fine = place.json("embed fine.off --extend coarse.off -o fine.npy");
    let (shape, finer) = read_npy(&place.path("fine.npy"));
    assert_eq!((shape, &fine["n_samples"]), (vec![642, 3], &coarse["n_samples"]));
    let gap = rows.iter().zip(&finer).fold(0.0f64, |gap, (a, b)| gap.max((a - b).abs()));
    assert!(gap < 0.1, "{gap}");
    place.refused("embed coarse.off -o f.npy --at 9000", &["vertex 9000", "162 vertices"]);
    place.refused("embed coarse.off fine.off -o forms --at 1", &["--at", "one mesh"]);
    place.refused("embed fine.off --extend coarse.off --method landmark -o f.npy", &["landmark", "nmds can"]);
}

#[test]
fn a_comparison_tells_the_relation_as_text_as_json_and_by_its_exit_code() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place.add("ball.off", &shapes::icosphere(3));
    std::fs::create_dir(place.path("other")).unwrap();
    std::fs::copy(place.path("ring.off"), place.path("other/ring.off")).unwrap();
    let mut inches = ring();
    inches.positions.iter_mut().for_each(|p| *p = nalgebra::Point3::new(p.y, -p.x, p.z) / 25.4);
    place.add("inches.ply", &inches);
    for (other, option, kind, code, words) in [
        (
            "other/ring.off",
            "--threshold 0.01",
            "identical-file",
            0,
            "other/ring.off is the same file as ring.off",
        ),
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
    let apart = place.json("compare ring.off ball.off");
    assert_keys(
        &apart,
        "relation distance normalized_distance rotation translation reflected same_below scale combined_distance fused_distance triangulation residual",
    );
    assert_eq!(place.done("compare ring.off ball.off").out.trim_end().lines().count(), 5);
    // The relation does not depend on the options.
    let again = place.json("compare ring.off ball.off --method kpca --geodesic bfs -n 20");
    for key in ["/combined_distance", "/relation/kind"] {
        assert_eq!(again.pointer(key), apart.pointer(key), "{key}");
    }
    place.refused("compare ring.off ring.off --exit-code=maybe", &["same-shape", "same-class"]);
}

#[test]
fn completions_cover_every_shell() {
    let place = Workplace::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = place.done(&["completions", shell]).out;
        assert!(
            script.contains("canonform") && script.contains("geodesic") && script.contains("render"),
            "{shell}: {script}"
        );
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
}

#[test]
fn only_json_goes_to_standard_output_and_notes_go_to_standard_error() {
    let place = Workplace::new();
    place.add("broken.off", &broken_ring());
    for arguments in [
        vec!["embed", "broken.off", "-n", "20", "-o", "form.npy", "--json"],
        vec!["geodesic", "broken.off", "--source", "0", "-o", "d.npy", "--json"],
        vec!["compare", "broken.off", "broken.off", "-n", "20", "--json"],
    ] {
        let outcome = place.done(&arguments);
        one_object(&outcome.out);
        assert!(outcome.err.contains("broken.off: 1 vertex without a face dropped"), "{}", outcome.err);
        assert!(outcome.err.contains("1 of 2 components dropped"), "{}", outcome.err);
    }
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let ring = place.path("ring.off");
    let form = place.path("form.npy");
    let [ring, form] = [&ring, &form].map(|path| path.to_str().unwrap());
    for arguments in [
        vec!["info", ring, ring, ring],
        vec!["info", ring, "--json"],
        vec!["embed", ring, "-n", "20", "-o", form],
        vec!["completions", "bash"],
        vec!["--help"],
    ] {
        let mut child = std::process::Command::new(program())
            .args(&arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let message = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{arguments:?}: {message}");
        assert!(!message.contains("panicked") && !message.contains("error"), "{arguments:?}: {message}");
    }
}

#[test]
fn methods_compares_every_method_marks_the_best_and_continues_after_a_failure() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let json = place.json("methods ring.off -n 20");
    assert_keys(&json, "n_vertices n_embedded dim geodesic methods best repair");
    let methods = json["methods"].as_array().unwrap();
    for wanted in ["nmds", "landmark", "spectral", "kpca", "mds", "smacof"] {
        assert!(methods.iter().any(|m| m["method"] == wanted), "{wanted}");
    }
    for method in methods.iter().filter(|m| m["error"].is_null()) {
        assert_keys(method, "options negative_mass n_samples seconds peak_bytes");
        assert!(method["peak_bytes"].as_u64().unwrap() > 160 * 20 * 8, "{method}");
        assert_eq!(method["stress"].is_null(), method["method"] == "kpca", "{method}");
    }
    let stress = |m: &Value| m["stress"]["value"].as_f64();
    let best = stress(&methods[json["best"].as_u64().unwrap() as usize]).unwrap();
    assert!(methods.iter().filter_map(stress).all(|s| best <= s));
    let text = place.done("methods ring.off -n 3 --stress estimate").out;
    assert!(text.contains("landmark  failed: cannot embed") && text.contains(" *"), "{text}");
    place.refused("methods absent.off", &["absent.off"]);
}
