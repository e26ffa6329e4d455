//! Small invented records and meshes for the tests.

use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use crate::results::{
    CurvesResults, Expectation, Figure1Results, Figure3Results, Figure4Panel, Figure4Results, Figure9Results,
    Motions, Record, RetrievalResults, ShapesRecord, ShownForm, ShownShape,
};
use crate::viewer::Geometry;

/// The record of results, as its file holds them. It has no expectations.
fn recorded<T: DeserializeOwned>(mut results: Value, analysis: &str) -> Record<T> {
    results["provenance"] = json!({
        "program": "experiments", "version": "0.1.0", "commit": "abc1234", "date": "2026-01-31 12:00",
        "machine": "a processor, 2 threads, linux", "arguments": " --dataset 'a & b' --output results",
        "command": "experiments run all --dataset 'a & b'", "dataset": "a & b", "classes": ["cat", "dog"],
        "seed": 7, "options": {"embedding": {"rank": 5, "note": "<b>"}}, "seconds": {"embedding": 0.25},
    });
    results["expectations"] = json!([]);
    results["analysis"] = analysis.into();
    serde_json::from_value(results).unwrap()
}

pub(crate) fn figure1_record() -> Record<Figure1Results> {
    let shape = |name: &str, label: &str| {
        json!({
            "name": name, "label": label, "n_vertices": 3400, "n_faces": 6796, "stress": 262.05,
            "repair": ["2 duplicate faces removed"],
        })
    };
    let shapes = [shape("cat0", "cat"), shape("dog<3>", "dog")];
    recorded(json!({"shapes": shapes}), "Forms of one class agree.\n\nSecond paragraph.")
}

/// Two shapes with two forms each, and one stress.
pub(crate) fn figure3_record() -> Record<Figure3Results> {
    let forms = json!([
        {"method": "MDS", "stress": 262.05, "paper": 394.41},
        {"method": "NMDS", "stress": 300.0, "paper": null},
    ]);
    let results = json!({
        "shapes": [
            {"name": "david<0>", "label": "david", "n_vertices": 3400, "forms": forms},
            {"name": "cat0", "label": "cat", "n_vertices": 3400, "forms": forms},
        ],
        "stresses": [{
            "shape": "david<0>", "distances": "default", "method": "MDS", "median": 386.25, "low": 386.0,
            "high": 387.0, "runs": 3, "paper": 394.41,
        }],
    });
    recorded(results, "Order as printed.")
}

/// Two panels of two curves with a logarithmic vertical axis.
pub(crate) fn curves_record() -> Record<CurvesResults> {
    let points = |factor: f64| {
        [10.0, 50.0, 100.0].map(|x| {
            let y = factor * 1e5 / x;
            json!({"x": x, "median": y, "low": 0.7 * y, "high": 1.5 * y, "runs": 5})
        })
    };
    let panel = |title: &str| {
        json!({
            "title": title,
            "x": {"name": "samples n", "unit": "", "scale": "linear"},
            "y": {"name": "error", "unit": "m⁴", "scale": "log"},
            "series": [{"name": "NMDS", "points": points(1.0)}, {"name": "a & b", "points": points(30.0)}],
            "marks": [{"x": 70.0, "name": "recommended"}],
        })
    };
    recorded(json!({"caption": "Errors.", "panels": [panel("david0"), panel("cat0")]}), "Falls.")
}

/// A method that was run and one that was not.
pub(crate) fn figure9_record() -> Record<Figure9Results> {
    let measured = json!({"geodesics": 0.02, "embedding": 0.005, "runs": 3, "peak_bytes": 3 << 20});
    let row = |method: &str, measured: Value, paper_seconds: Value, note: &str| {
        json!({
            "shape": "david0", "n_vertices": 3400, "method": method, "measured": measured,
            "paper_seconds": paper_seconds, "note": note,
        })
    };
    let absent = row("MDS", Value::Null, Value::Null, "all pairs need <5.8> GiB");
    recorded(json!({"threads": 2, "rows": [row("NMDS", measured, json!(0.24), ""), absent]}), "")
}

/// One signature at both scales, for two classes.
pub(crate) fn retrieval_record() -> Record<RetrievalResults> {
    let scores = json!({"nn": 1.0, "ft": 0.75, "st": 0.9, "e": 0.5, "dcg": 0.95, "map": 0.875});
    let row = |scale: &str| {
        json!({
            "method": "wave-kernel", "scale": scale, "micro": scores, "macro_average": scores,
            "knn_accuracy": 0.9, "held_out_map": 0.625, "precision": [1.0, 0.9, 0.6],
        })
    };
    let results = json!({
        "names": ["cat0", "cat1", "a0", "a1"],
        "labels": ["cat", "cat", "a & b", "a & b"],
        "rows": [row("normalized"), row("raw")],
        "best_e": 0.512,
        "classification": {
            "method": "wave-kernel", "voters": 3, "classes": ["a & b", "cat"],
            "confusion": [[1, 0, 1], [0, 2, 0]],
            "misclassified": [
                {"name": "a1", "label": "a & b", "predicted": null, "nearest": "cat0", "distance": 0.75},
            ],
            "threshold": 0.5, "missed": 0.25, "mistaken": 0.0,
        },
    });
    recorded(results, "Near is alike.")
}

/// The shapes of [`figure4_record`]: balls of growing size.
pub(crate) fn shapes_record(classes: &[(&str, usize)]) -> ShapesRecord {
    let figure = figure4_record(classes).results;
    let shape = |(i, (name, label)): (usize, (&String, &String))| {
        let mut ball = mesh::shapes::icosphere(2);
        ball.positions.iter_mut().for_each(|p| *p *= 1.0 + i as f64);
        let heights: Vec<f64> = ball.positions.iter().map(|p| p.z).collect();
        let surface = Geometry::new(&ball).with_values("distance", &heights);
        let residual = heights.iter().map(|z| z.abs() as f32).collect();
        let form = ShownForm { positions: surface.positions.clone(), size: 2.0, residual: Some(residual) };
        let other = ShownForm { residual: None, ..form.clone() };
        let (name, label, n_vertices) = (name.clone(), label.clone(), ball.n_vertices());
        ShownShape { name, label, n_vertices, surface, forms: vec![form, other] }
    };
    let shapes: Vec<ShownShape> = figure.names.iter().zip(&figure.labels).enumerate().map(shape).collect();
    let still = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]];
    let motions = still.repeat(shapes.len() * shapes.len().saturating_sub(1) / 2);
    let panel = |panel: &Figure4Panel| Motions {
        method: panel.method.clone(),
        scale: panel.scale,
        motions: motions.clone(),
    };
    let mut methods: Vec<String> = figure.panels.iter().map(|panel| panel.method.clone()).collect();
    methods.dedup();
    methods.truncate(2);
    ShapesRecord { methods, motions: figure.panels.iter().map(panel).collect(), shapes }
}

/// Points in one cluster per class, at both scales and for two methods.
pub(crate) fn figure4_record(classes: &[(&str, usize)]) -> Record<Figure4Results> {
    let labels: Vec<&str> = classes.iter().flat_map(|(name, n)| std::iter::repeat_n(*name, *n)).collect();
    let place = |shape: usize| {
        let class = classes.iter().position(|(name, _)| *name == labels[shape]).unwrap() as f64;
        [10.0 * class + (shape as f64 * 0.7).sin(), (shape as f64 * 1.3).cos()]
    };
    let map: Vec<[f64; 2]> = (0..labels.len()).map(place).collect();
    let distance = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let matrix: Vec<Vec<f64>> = map.iter().map(|a| map.iter().map(|b| distance(a, b)).collect()).collect();
    let panel = |(scale, method): (&str, &str)| {
        json!({
            "method": method, "scale": scale, "matrix": matrix, "map": map, "map_stress": 0.0521,
            "negative_mass": 0.01, "map_silhouette": 0.875,
            "scores": {
                "n": 5, "classes": ["cat", "dog"], "nn": 1.0, "ft": 0.91, "st": 0.92, "e": 0.5, "dcg": 0.93,
                "map": 0.94, "knn_accuracy": 0.95, "knn_k": 3, "confusion": [[3, 0], [0, 2]],
                "silhouette": -0.125,
            },
        })
    };
    let (nmds, kpca) = ("NMDS", "KPCA-Nyström");
    let panels = [("raw", nmds), ("raw", kpca), ("normalized", nmds), ("normalized", kpca)].map(panel);
    let names: Vec<String> = labels.iter().enumerate().map(|(i, label)| format!("{label}{i}")).collect();
    let results = json!({"names": names, "labels": labels, "panels": panels});
    let expectation = |what: &str, measured: &str, held| Expectation {
        what: what.into(),
        expected: "at least 0.9".into(),
        measured: measured.into(),
        held,
        goal: false,
    };
    let expectations = vec![
        expectation("NMDS, raw: first tier", "0.910", true),
        expectation("NMDS, raw: silhouette", "-0.125", false),
    ];
    Record { expectations, ..recorded(results, "Two clusters.") }
}

/// Panics unless a text holds all parts.
pub(crate) fn assert_holds(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part} in {text}");
    }
}

/// A page without the contents of its scripts and islands of data.
pub(crate) fn without_scripts(html: &str) -> String {
    let mut parts = html.split("<script");
    let mut kept = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (_, rest) = part.split_once("</script>").expect("a script ends");
        kept.push_str(rest);
    }
    kept
}

/// Panics unless all elements of an XML or HTML text are closed in order.
pub(crate) fn assert_balanced(markup: &str) {
    let mut open: Vec<&str> = Vec::new();
    let plain = without_scripts(markup);
    let mut rest = plain.as_str();
    while let Some(start) = rest.find('<') {
        let end = start + rest[start..].find('>').expect("a tag ends");
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        let name = tag.trim_start_matches('/').split([' ', '\n']).next().unwrap_or_default();
        let void = tag.ends_with('/') || tag.starts_with(['!', '?']) || ["meta", "img"].contains(&name);
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name), "closed out of order");
        } else if !void {
            assert_eq!(tag.matches('"').count() % 2, 0, "quotes in <{tag}>");
            open.push(name);
        }
    }
    assert!(open.is_empty(), "left open: {open:?}");
}
