//! Small invented records and meshes for the tests.

use retrieval::{Evaluation, Scores};
use serde_json::json;

use crate::results::{
    Axis, AxisScale, Classification, CurvesPanel, CurvesResults, Expectation, Figure1Results, Figure1Shape,
    Figure3Form, Figure3Results, Figure3Shape, Figure3Stress, Figure4Panel, Figure4Results, Figure9Measured,
    Figure9Results, Figure9Row, Mark, Misclassified, Motions, Record, RetrievalResults, RetrievalRow,
    RunProvenance, Scale, Series, SeriesPoint, ShapesRecord, ShownForm, ShownShape,
};
use crate::viewer::Geometry;

fn provenance() -> RunProvenance {
    RunProvenance {
        program: "experiments".into(),
        version: "0.1.0".into(),
        commit: "abc1234".into(),
        date: "2026-01-31 12:00".into(),
        machine: "a processor, 2 threads, linux".into(),
        arguments: " --dataset 'a & b' --output results".into(),
        command: "experiments run all --dataset 'a & b'".into(),
        dataset: "a & b".into(),
        classes: vec!["cat".into(), "dog".into()],
        seed: 7,
        options: json!({"embedding": {"rank": 5, "note": "<b>"}}),
        seconds: [("embedding".to_string(), 0.25)].into(),
    }
}

/// A record without expectations.
fn recorded<T>(results: T, analysis: &str) -> Record<T> {
    let (measured, expectations) = Default::default();
    Record { provenance: provenance(), results, measured, expectations, analysis: analysis.into() }
}

pub(crate) fn evaluation() -> Evaluation {
    Evaluation {
        n: 5,
        classes: vec!["cat".into(), "dog".into()],
        mean: Scores { nn: 1.0, ft: 0.91, st: 0.92, e: 0.5, dcg: 0.93, map: 0.94 },
        knn_accuracy: 0.95,
        knn_k: 3,
        confusion: vec![vec![3, 0], vec![0, 2]],
        silhouette: -0.125,
        intervals: None,
        graph: None,
    }
}

pub(crate) fn figure1_record() -> Record<Figure1Results> {
    let shape = |name: &str, label: &str| Figure1Shape {
        name: name.into(),
        label: label.into(),
        n_vertices: 3400,
        n_faces: 6796,
        stress: 262.05,
        repair: vec!["2 duplicate faces removed".into()],
    };
    let results = Figure1Results { shapes: vec![shape("cat0", "cat"), shape("dog<3>", "dog")] };
    recorded(results, "Forms of one class agree.\n\nSecond paragraph.")
}

/// Two shapes with two forms each, and one stress.
pub(crate) fn figure3_record() -> Record<Figure3Results> {
    let form = |method: &str, stress, paper| Figure3Form { method: method.into(), stress, paper };
    let shape = |name: &str, label: &str| Figure3Shape {
        name: name.into(),
        label: label.into(),
        n_vertices: 3400,
        forms: vec![form("MDS", 262.05, Some(394.41)), form("NMDS", 300.0, None)],
    };
    let stress = Figure3Stress {
        shape: "david<0>".into(),
        distances: "default".into(),
        method: "MDS".into(),
        median: 386.25,
        low: 386.0,
        high: 387.0,
        runs: 3,
        paper: Some(394.41),
    };
    let results = Figure3Results {
        shapes: vec![shape("david<0>", "david"), shape("cat0", "cat")],
        stresses: vec![stress],
    };
    recorded(results, "Order as printed.")
}

/// Two panels of two curves with a logarithmic vertical axis.
pub(crate) fn curves_record() -> Record<CurvesResults> {
    let axis = |name: &str, unit: &str, scale| Axis { name: name.into(), unit: unit.into(), scale };
    let points = |factor: f64| -> Vec<SeriesPoint> {
        let at = |x: f64| factor * 1e5 / x;
        let point = |x| SeriesPoint { x, median: at(x), low: 0.7 * at(x), high: 1.5 * at(x), runs: 5 };
        [10.0, 50.0, 100.0].map(point).to_vec()
    };
    let panel = |title: &str| CurvesPanel {
        title: title.into(),
        x: axis("samples n", "", AxisScale::Linear),
        y: axis("error", "m⁴", AxisScale::Log),
        series: vec![
            Series { name: "NMDS".into(), points: points(1.0) },
            Series { name: "a & b".into(), points: points(30.0) },
        ],
        marks: vec![Mark { x: 70.0, name: "recommended".into() }],
    };
    let results = CurvesResults { caption: "Errors.".into(), panels: vec![panel("david0"), panel("cat0")] };
    recorded(results, "Falls.")
}

/// A method that was run and one that was not.
pub(crate) fn figure9_record() -> Record<Figure9Results> {
    let measured = Figure9Measured { geodesics: 0.02, embedding: 0.005, runs: 3, peak_bytes: 3 << 20 };
    let row = Figure9Row {
        shape: "david0".into(),
        n_vertices: 3400,
        method: "NMDS".into(),
        measured: Some(measured),
        paper_seconds: Some(0.24),
        note: String::new(),
    };
    let note = "all pairs need <5.8> GiB".to_string();
    let absent =
        Figure9Row { method: "MDS".into(), measured: None, paper_seconds: None, note, ..row.clone() };
    let results = Figure9Results { threads: 2, rows: vec![row, absent] };
    recorded(results, "")
}

/// One signature at both scales, for two classes.
pub(crate) fn retrieval_record() -> Record<RetrievalResults> {
    let scores = Scores { nn: 1.0, ft: 0.75, st: 0.9, e: 0.5, dcg: 0.95, map: 0.875 };
    let row = |scale| RetrievalRow {
        method: "wave-kernel".into(),
        scale,
        micro: scores,
        macro_average: scores,
        knn_accuracy: 0.9,
        held_out_map: 0.625,
        precision: vec![1.0, 0.9, 0.6],
        rankings: None,
    };
    let results = RetrievalResults {
        names: ["cat0", "cat1", "a0", "a1"].map(String::from).into(),
        labels: ["cat", "cat", "a & b", "a & b"].map(String::from).into(),
        rows: vec![row(Scale::Normalized), row(Scale::Raw)],
        best_e: Some(0.512),
        classification: Classification {
            method: "wave-kernel".into(),
            voters: 3,
            classes: vec!["a & b".into(), "cat".into()],
            confusion: vec![vec![1, 0, 1], vec![0, 2, 0]],
            misclassified: vec![Misclassified {
                name: "a1".into(),
                label: "a & b".into(),
                predicted: None,
                nearest: "cat0".into(),
                distance: 0.75,
            }],
            threshold: 0.5,
            missed: 0.25,
            mistaken: 0.0,
        },
        protocol: Vec::new(),
        published: None,
    };
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
    let labels: Vec<String> =
        classes.iter().flat_map(|(name, n)| std::iter::repeat_n(name.to_string(), *n)).collect();
    let place = |shape: usize| {
        let class = classes.iter().position(|(name, _)| *name == labels[shape]).unwrap() as f64;
        [10.0 * class + (shape as f64 * 0.7).sin(), (shape as f64 * 1.3).cos()]
    };
    let map: Vec<[f64; 2]> = (0..labels.len()).map(place).collect();
    let distance = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let matrix: Vec<Vec<f64>> = map.iter().map(|a| map.iter().map(|b| distance(a, b)).collect()).collect();
    let panel = |method: &str, scale| Figure4Panel {
        method: method.into(),
        scale,
        matrix: matrix.clone(),
        map: map.clone(),
        map_stress: 0.0521,
        negative_mass: 0.01,
        scores: evaluation(),
        map_silhouette: 0.875,
    };
    let results = Figure4Results {
        names: (0..labels.len()).map(|i| format!("{}{i}", labels[i])).collect(),
        best_e: None,
        panels: [Scale::Raw, Scale::Normalized]
            .into_iter()
            .flat_map(|scale| [panel("NMDS", scale), panel("KPCA-Nyström", scale)])
            .collect(),
        labels,
    };
    let expectations = vec![
        Expectation {
            what: "NMDS, raw: first tier".into(),
            expected: "at least 0.9".into(),
            measured: "0.910".into(),
            held: true,
            goal: false,
        },
        Expectation {
            what: "NMDS, raw: silhouette".into(),
            expected: "at least 0.9".into(),
            measured: "-0.125".into(),
            held: false,
            goal: false,
        },
    ];
    Record { expectations, ..recorded(results, "Two clusters.") }
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
