//! Figure 4 for exploration: map, matrix, and the surfaces and canonical forms of two shapes in 3D.

use std::path::Path;

use mesh::TriMesh;
use nalgebra::Point3;
use serde_json::{Value, json};
use surface::VertexId;

use super::chart::framed;
use super::html::{escape, fill};
use super::scripts::island;
use crate::classes::Classes;
use crate::color::{class_clay, hex};
use crate::error::ReportError;
use crate::figure4::shown;
use crate::render::{Background, Coloring, RenderOptions, render};
use crate::results::{
    Figure1Results, Figure4Panel, Figure4Results, Record, SHAPES_FILE, Scale, ShapesRecord, ShownShape, read,
};

/// Width and height of a thumbnail in pixels, twice those on the card.
const THUMBNAIL: [u32; 2] = [224, 192];

/// The record of the surfaces of Figure 4, if the folder has it and it belongs to the record of Figure 4.
pub(super) fn shapes(folder: &Path) -> Result<Option<ShapesRecord>, ReportError> {
    let (figure, shapes) = (folder.join("figure4.json"), folder.join(SHAPES_FILE));
    if !(figure.exists() && shapes.exists()) {
        return Ok(None);
    }
    let figure: Record<Figure4Results> = read(figure)?;
    let shapes: ShapesRecord = read(shapes)?;
    shapes.validate()?;
    Ok(Some(shapes).filter(|shapes| shapes.belongs_to(&figure.results)))
}

/// Map and matrix, with surfaces and forms if the folder has them, and `still` as the static figure.
pub(super) fn explorer(
    record: &Record<Figure4Results>,
    shapes: Option<&ShapesRecord>,
    still: &str,
) -> Result<String, ReportError> {
    let mut html = framed("figure4", &live(record, shapes), still);
    html.push_str(&island("figure4-data", &data(&record.results, shapes)?));
    for (i, shape) in shapes.iter().flat_map(|shapes| &shapes.shapes).enumerate() {
        let ShownShape { n_vertices, surface, forms, .. } = shape;
        let shape = json!({"n_vertices": n_vertices, "surface": surface, "forms": forms});
        html.push_str(&island(&format!("figure4-shape-{i}"), &shape));
    }
    Ok(html)
}

/// The shapes of Figure 1 that Figure 4 has, in 3D; empty if there are none.
pub(super) fn gallery(record: &Figure1Results, shapes: Option<&ShapesRecord>) -> String {
    let Some(shapes) = shapes else { return String::new() };
    let place = |name: &String| shapes.shapes.iter().position(|shape| shape.name == *name);
    let options: Vec<(String, &str)> =
        record.shapes.iter().filter_map(|s| Some((place(&s.name)?.to_string(), s.name.as_str()))).collect();
    let Some(method) = shapes.methods.first().filter(|_| !options.is_empty()) else { return String::new() };
    let controls = select("figure1-shape", "Shape", &options, 0) + &color_select("figure1-color");
    fill(include_str!("gallery.html"), &[("method", &escape(method)), ("controls", &controls)])
}

fn data(record: &Figure4Results, shapes: Option<&ShapesRecord>) -> Result<Value, ReportError> {
    let classes = Classes::of(record.labels.iter().map(String::as_str));
    let panels = aligned(record).map(|panel| {
        let shown = shown(record, panel);
        json!({
            "method": panel.method,
            "scale": panel.scale,
            "unit": panel.scale.unit(),
            "map": shown.map,
            "matrix": shown.matrix,
            "order": shown.order,
        })
    });
    let thumbnails = shapes.map_or(Ok(Vec::new()), |shapes| thumbnails(shapes, &classes))?;
    let clay = (0..classes.names().len()).map(|class| hex(class_clay(class)));
    Ok(json!({
        "names": record.names,
        "labels": record.labels,
        "clay": clay.collect::<Vec<_>>(),
        "panels": panels.collect::<Vec<_>>(),
        "methods": shapes.map_or(&[][..], |shapes| &shapes.methods),
        "motions": shapes.map_or(&[][..], |shapes| &shapes.motions),
        "thumbnails": thumbnails,
    }))
}

/// The panels whose forms have three dimensions.
fn aligned(record: &Figure4Results) -> impl Iterator<Item = &Figure4Panel> {
    record.panels.iter().filter(|panel| panel.scale != Scale::Spectrum)
}

/// Images of all shapes and their forms, as data URLs.
fn thumbnails(record: &ShapesRecord, classes: &Classes<'_>) -> Result<Vec<Value>, ReportError> {
    let image = |shape: &ShownShape, positions: &[[f32; 3]]| -> Result<String, ReportError> {
        let mesh = TriMesh {
            positions: positions.iter().map(|p| Point3::from(p.map(f64::from))).collect(),
            faces: shape.surface.faces.iter().map(|face| face.map(VertexId)).collect(),
        };
        let coloring = Coloring::Plain(class_clay(classes.index(&shape.label)));
        let [width, height] = THUMBNAIL;
        let background = Background::Transparent;
        let options = RenderOptions { width, height, coloring, background, ..RenderOptions::default() };
        render(&mesh, &options, &())?.to_data_url().map_err(|e| ReportError::draw("a thumbnail", e))
    };
    let of_shape = |shape: &ShownShape| {
        let forms: Result<Vec<String>, ReportError> =
            shape.forms.iter().map(|form| image(shape, &form.positions)).collect();
        Ok(json!({"shape": image(shape, &shape.surface.positions)?, "forms": forms?}))
    };
    record.shapes.iter().map(of_shape).collect()
}

/// Controls, plots and views.
fn live(record: &Record<Figure4Results>, shapes: Option<&ShapesRecord>) -> String {
    let Record { provenance, results: record, .. } = record;
    let names: Vec<(String, &str)> =
        record.names.iter().enumerate().map(|(i, name)| (i.to_string(), name.as_str())).collect();
    let methods = Classes::of(aligned(record).map(|panel| panel.method.as_str()));
    let methods: Vec<(&str, &str)> = methods.names().iter().map(|method| (*method, *method)).collect();
    let has = |scale: Scale| record.panels.iter().any(|panel| panel.scale == scale);
    let mut scales = vec![(Scale::Raw, "original"), (Scale::Normalized, "ignored")];
    scales.retain(|(scale, _)| has(*scale));
    let scales: Vec<_> = scales.into_iter().map(|(scale, text)| (scale.name(), text)).collect();
    let mut controls = select("figure4-scale", "Size", &scales, 0)
        + &select("figure4-first", "Shape 1", &names, 0)
        + &select("figure4-second", "Shape 2", &names, 1);
    if shapes.is_some() {
        controls += &select("figure4-method", "Forms in 3D", &methods, 0);
        controls += &color_select("figure4-color");
    }
    let views = match shapes {
        Some(_) => include_str!("views.html").to_owned(),
        None => format!(
            "<div class=\"missing\"><p>The surfaces are missing: this folder has no <code>{SHAPES_FILE}</code> from the same \
             run. To create it, run <code>{}</code>.</p></div>\n",
            escape(&provenance.command)
        ),
    };
    let [maps, matrices] = [
        ("map", "Map of the shapes", "a shape"),
        ("matrix", "Distances of all pairs", "a pair"),
    ]
    .map(|(kind, what, choice)| {
        let plot = |(i, (method, _)): (usize, &(&str, &str))| {
            format!(
                "<div class=\"plot square\" id=\"figure4-{kind}-{i}\" data-plot=\"{kind}\" data-method=\"{method}\" \
                 role=\"img\" aria-label=\"{what} by {method}; choose {choice} in the form above or with a click\"></div>\n",
                method = escape(method)
            )
        };
        methods.iter().enumerate().map(plot).collect::<String>()
    });
    let values = [("controls", &controls), ("maps", &maps), ("matrices", &matrices), ("views", &views)];
    fill(include_str!("explorer.html"), &values.map(|(name, value)| (name, value.as_str())))
}

fn color_select(id: &str) -> String {
    fill(include_str!("colors.html"), &[("id", id)])
}

/// A labelled choice between values and their texts.
fn select<S: AsRef<str>>(id: &str, label: &str, options: &[(S, &str)], chosen: usize) -> String {
    let option = |(i, (value, text)): (usize, &(S, &str))| {
        let selected = if i == chosen { " selected" } else { "" };
        format!("<option value=\"{}\"{selected}>{}</option>", escape(value.as_ref()), escape(text))
    };
    let options: String = options.iter().enumerate().map(option).collect();
    format!("<label>{label} <select id=\"{id}\">{options}</select></label>\n")
}
