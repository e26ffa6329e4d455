//! Every command on an intact mesh, and where its output goes.

use std::process::Stdio;

use canonform::mesh::shapes;
use serde_json::Value;

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
    let mut welded = canonform::mesh::shapes::icosphere(3);
    let highest = (0..welded.n_vertices())
        .max_by(|a, b| (welded.positions[*a].z).total_cmp(&welded.positions[*b].z))
        .map(canonform::surface::VertexId::from);
    let lowest = (0..welded.n_vertices())
        .min_by(|a, b| (welded.positions[*a].z).total_cmp(&welded.positions[*b].z))
        .map(canonform::surface::VertexId::from);
    let (top, bottom) = highest.zip(lowest).unwrap();
    welded.faces.iter_mut().flatten().filter(|v| **v == bottom).for_each(|v| *v = top);
    place.add("welded.off", &welded);
    let text = place.done("info welded.off").out;
    assert!(text.contains("probable shortcut") && text.contains(&format!("vertex {}", top.0)), "{text}");
    let json = place.json("info welded.off");
    let shortcuts = json["meshes"][0]["shortcuts"].as_array().unwrap();
    assert_eq!((shortcuts.len(), shortcuts[0]["kind"].as_str()), (1, Some("pinch")));
    assert!(shortcuts[0]["detour"].as_f64().unwrap() > 2.5, "{shortcuts:?}");
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

    let text = place.done("embed ring.off -n 20 -o form.ply").out;
    assert!(text.contains("stress") && text.contains("form.ply"), "{text}");
}

#[test]
fn the_stress_of_a_large_mesh_comes_from_a_few_rows() {
    let place = Workplace::new();
    place.add("ball.off", &shapes::icosphere(4));
    for (options, kind, rows) in [
        ("exact", "exact", 2562..=2562),
        ("auto --seed 7", "estimated", 1..=4),
        ("estimate", "estimated", 5..=100),
    ] {
        let found = place.json(format!("embed ball.off -n 20 -o form.npy --stress {options}"));
        let stress = &found["stress"];
        assert!(stress["kind"] == kind && rows.contains(&stress["rows"].as_u64().unwrap()), "{stress}");
    }
    let text = place.done("embed ball.off -n 20 -o form.npy --details").out;
    assert!(text.contains("95 %") && text.contains("rows)"), "{text}");
}

#[test]
fn embed_accepts_all_options() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let embed = |options: &str| place.json(format!("embed ring.off -o form.npy {options}"));
    for (options, key, value) in [
        ("--method mds", "/n_samples", Value::from(160)),
        ("--method kpca -n 30", "/method", "kpca".into()),
        ("--geodesic dijkstra -n 30", "/geodesic", "dijkstra".into()),
        ("--first-sample 11 -n 30", "/samples/0", 11.into()),
        ("--dim 5 -n 30", "/dim", 5.into()),
        ("--stress estimate -n 30 --seed 4", "/stress/kind", "estimated".into()),
        ("--stress skip -n 30", "/stress", Value::Null),
        ("-n 30", "/auto", Value::Null),
        ("-n auto --rank 12", "/rank", 12.into()),
    ] {
        assert_eq!(embed(options).pointer(key), Some(&value), "{options}");
    }
    let [own, marched] = ["", " --stress-against fast-marching"]
        .map(|against| embed(&format!("--geodesic bfs -n 30{against}"))["stress"].clone());
    assert_eq!((&own["geodesic"], &marched["geodesic"]), (&"bfs".into(), &"fast-marching".into()));
    assert!(own["value"] != marched["value"]);
    let found = embed("-n auto");
    assert_eq!(found["auto"]["stop"], "settled");
    assert!(2 * found["auto"]["sufficient"].as_u64().unwrap() <= found["n_samples"].as_u64().unwrap());
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
fn embed_accepts_all_methods_and_samplings() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let embed = |options: &str| place.json(format!("embed ring.off -n 30 -o form.npy {options}"));
    for (options, expected) in [
        ("--method nmds --regularization low-rank --rank 9", ["nmds", "low-rank", "9"]),
        ("--method nmds --regularization rpi --alpha paper", ["nmds", "rpi", ""]),
        ("--method nmds --regularization none", ["nmds", "none", ""]),
        ("--method nmds --regularization cur --rank 9", ["nmds", "cur", ""]),
        ("--method landmark", ["landmark", "", "3"]),
        ("--method spectral --eigenvectors 60 --mu inf", ["spectral", "", "30"]),
        ("--method mds", ["mds", "", ""]),
        ("--method smacof --rank 9 --iterations 4 --tolerance 0", ["smacof", "low-rank", "9"]),
    ] {
        let json = embed(options);
        let text = |key: &str| json[key].as_str().map_or_else(|| json[key].to_string(), str::to_owned);
        for (key, expected) in ["method", "regularization", "rank"].into_iter().zip(expected) {
            assert!(expected.is_empty() || text(key) == expected, "{options}: {key}: {}", text(key));
        }
        if let Some(descent) = json["descent"].as_object() {
            assert_eq!((&descent["iterations"], &descent["stop"]), (&4.into(), &"iteration-limit".into()));
        }
    }
    let eigenvalue = |sigma: &str| embed(&format!("--method kpca --sigma {sigma}"))["eigenvalues"][0].clone();
    let [mean, median, max, value] = ["mean", "median", "max", "0.7"].map(eigenvalue);
    assert!(mean != median && median != max && max != value);
    for sampling in ["farthest", "random", "min-variance"] {
        let [one, same, other] = ["1", "1", "2"].map(|seed| {
            let json = embed(&format!("--sampling {sampling} --seed {seed}"));
            assert_eq!(json["sampling"], sampling);
            json["samples"].clone()
        });
        assert!(one == same && (one == other) == (sampling == "farthest"), "{sampling}");
        let from = embed(&format!("--sampling {sampling} --first-sample 11"))["samples"].clone();
        assert_eq!((&from[0], from.as_array().unwrap().len()), (&11.into(), 30), "{sampling}");
    }
}

#[test]
fn compare_reports_a_relation_and_checks_a_threshold() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place.add("ball.off", &canonform::mesh::shapes::icosphere(3));
    let same = place.json("compare ring.off ring.off");
    assert_keys(
        &same,
        "relation distance normalized_distance rotation translation reflected same_below scale combined_distance fused_distance triangulation residual",
    );
    assert_eq!(same["relation"]["kind"], "identical-file");
    assert!(same["normalized_distance"].as_f64().unwrap() < 1e-9);
    let apart = place.json("compare ring.off ball.off");
    assert_eq!(apart["relation"]["kind"], "different");
    // The relation does not depend on the options.
    for options in [["-n", "20"], ["--method", "kpca"], ["--geodesic", "bfs"]] {
        let again = place.json(&[&["compare", "ring.off", "ball.off"], &options[..]].concat());
        assert_eq!(again["combined_distance"], apart["combined_distance"], "{options:?}");
        assert_eq!(again["relation"]["kind"], apart["relation"]["kind"], "{options:?}");
    }

    assert_eq!(place.run("compare ring.off ring.off --threshold 0.01").code, 0);
    let apart = place.run("compare ring.off ball.off --threshold 0.01");
    assert_eq!(apart.code, 1);
    assert!(apart.out.contains("exceeded"), "{}", apart.out);
    let apart = place.run("compare ring.off ball.off --threshold 0.01 --json");
    let json = one_object(&apart.out);
    assert_eq!((apart.code, &json["threshold"], &json["failed"]), (1, &0.01.into(), &true.into()));
}

#[test]
fn text_json_and_exit_code_of_a_comparison_agree() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place.add("ball.off", &canonform::mesh::shapes::icosphere(3));
    for (other, alike) in [("ring.off", true), ("ball.off", false)] {
        // The forms are always nearer than this: only the relation can fail.
        for option in [&["--threshold", "99"][..], &["--exit-code"], &["--exit-code=same-class"], &[]] {
            let asked = [&["compare", "ring.off", other], option].concat();
            let [text, json] =
                [&asked[..], &[&asked[..], &["--json"]].concat()].map(|asked| place.run(asked));
            let expected = i32::from(!alike && !option.is_empty());
            assert_eq!((text.code, json.code), (expected, expected), "{asked:?}: {}", text.out);
            let json = one_object(&json.out);
            let relation = &json["relation"];
            assert_eq!(relation["kind"], if alike { "identical-file" } else { "different" });
            assert_eq!(relation["because"]["combined_distance"], json["combined_distance"]);
            assert!(
                text.out.starts_with(&format!("{}.\n", relation["text"].as_str().unwrap())),
                "{}",
                text.out
            );
            assert_eq!(text.out.trim_end().lines().count(), 5, "{}", text.out);
            let details = place.run(&[&asked[..], &["--details"]].concat()).out;
            assert!(details.contains(relation["because"]["text"].as_str().unwrap()), "{details}");
            match option.first() {
                Some(&"--threshold") => {
                    assert_eq!(json["failed"], !alike);
                    assert_eq!(text.out.contains("not exceeded, but the shapes are different"), !alike);
                }
                _ => assert!(json["failed"].is_null()),
            }
        }
        let [there, back] =
            [["compare", "ring.off", other], ["compare", other, "ring.off"]].map(|asked| place.json(&asked));
        assert_eq!(there["relation"]["kind"], back["relation"]["kind"]);
        let distance = |json: &serde_json::Value| json["combined_distance"].as_f64().unwrap();
        assert!((distance(&there) - distance(&back)).abs() <= 0.01 * distance(&there));
    }
    place.refused("compare ring.off ring.off --exit-code=maybe", &["same-shape", "same-class"]);
}

#[test]
fn copies_are_told_from_other_shapes_and_named_by_their_files() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place.add("copy.off", &ring());
    let mut inches = ring();
    inches.positions.iter_mut().for_each(|p| *p = nalgebra::Point3::new(p.y, -p.x, p.z) / 25.4);
    place.add("inches.ply", &inches);
    place.add("fine.off", &canonform::mesh::shapes::subdivide(&ring()));
    let mut plate = [ring(), canonform::mesh::shapes::icosphere(3), ring(), ring()];
    for (i, mesh) in plate.iter_mut().enumerate() {
        mesh.positions.iter_mut().for_each(|p| p.x += 40.0 * i as f64);
    }
    place.add("plate.stl", &canonform::mesh::shapes::disjoint(&plate));
    place.add("ball.off", &canonform::mesh::shapes::icosphere(3));
    for (a, b, kind, text) in [
        ("ring.off", "copy.off", "identical-file", "copy.off is the same file as ring.off"),
        ("inches.ply", "ring.off", "scaled", "scaled by 25.4 (inches to millimetres)"),
        ("ring.off", "fine.off", "remeshed", "fine.off is ring.off subdivided to 4.0 times the vertices"),
        ("fine.off", "ring.off", "remeshed", "ring.off is fine.off decimated to 25 % of the vertices"),
        (
            "ring.off",
            "plate.stl",
            "part-of",
            "plate.stl has three copies of ring.off among its four components",
        ),
        ("ring.off", "ball.off", "different", "ball.off is not the same shape as ring.off"),
    ] {
        let asked = ["compare", a, b, "--max-dropped", "1"];
        let found = place.json(&asked)["relation"].clone();
        assert_eq!(found["kind"], kind, "{found}");
        assert!(found["text"].as_str().unwrap().contains(text), "{found}");
        let told = place.done(&[&asked[..], &["--details"]].concat()).out;
        for words in [&found["text"], &found["because"]["text"]] {
            assert!(told.contains(words.as_str().unwrap()), "{told}");
        }
    }
    let changed = place.json("compare ring.off inches.ply")["relation"]["because"].clone();
    assert_eq!(changed["units"], "millimetres to inches");
    std::fs::create_dir(place.path("other")).unwrap();
    std::fs::copy(place.path("ring.off"), place.path("other/ring.off")).unwrap();
    let found = place.json("compare ring.off other/ring.off")["relation"].clone();
    assert_eq!(found["text"], "other/ring.off is the same file as ring.off");
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
        let [brief, usual] = ["-h", "--help"].map(|flag| place.done(format!("{command} {flag}")).out);
        assert_eq!(brief, usual);
        assert!(n_lines(&usual) < 60, "{command} --help has {} lines: {usual}", n_lines(&usual));
        assert!(usual.contains("--help-all"), "{usual}");
    }
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
fn methods_compares_every_method() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let json = place.json("methods ring.off -n 20");
    assert_keys(&json, "n_vertices n_embedded dim geodesic methods best repair");
    let methods = json["methods"].as_array().unwrap();
    let name = |m: &serde_json::Value| m["method"].as_str().unwrap().to_owned();
    for wanted in ["nmds", "landmark", "spectral", "kpca", "mds", "smacof"] {
        assert!(methods.iter().any(|m| name(m) == wanted), "{wanted}");
    }
    for method in methods.iter().filter(|m| m["error"].is_null()) {
        assert_keys(method, "options negative_mass n_samples seconds peak_bytes");
        assert!(method["peak_bytes"].as_u64().unwrap() > 160 * 20 * 8, "{method}");
        assert_eq!(method["stress"].is_null(), name(method) == "kpca", "{method}");
    }
    let stress = |m: &serde_json::Value| m["stress"]["value"].as_f64();
    let best = json["best"].as_u64().unwrap() as usize;
    assert!(methods.iter().filter_map(stress).all(|s| stress(&methods[best]).unwrap() <= s));
    // Classical scaling has the least strain of all.
    let least = stress(methods.iter().find(|m| name(m) == "mds").unwrap()).unwrap();
    assert!(methods.iter().filter_map(stress).all(|s| s >= least * (1.0 - 1e-9)));
}

#[test]
fn methods_marks_the_best_and_continues_after_a_failure() {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    let text = place.done("methods ring.off -n 3 --stress estimate").out;
    assert!(text.contains("landmark  ") && text.contains("landmark  failed: cannot embed"), "{text}");
    assert!(text.contains(" *") && text.contains("mds") && text.contains("estimated"), "{text}");
    place.refused("methods absent.off", &["absent.off"]);
}
