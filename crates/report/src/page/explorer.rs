//! Figure 4 to turn and to ask.

use std::fmt::Write;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mesh::{TriMesh, VertexId};
use nalgebra::Point3;
use serde_json::{Value, json};

use super::chart::framed;
use super::html::escape;
use super::scripts::island;
use crate::ReportError;
use crate::classes::Classes;
use crate::color::class_clay;
use crate::interactive::base64::encode;
use crate::interactive::hex;
use crate::render::{RenderOptions, Surface, View, render};
use crate::results::{Figure4Record, SHAPES_FILE, Scale, SeenShape, ShapesRecord, read};

/// Width and height of a thumbnail, in pixels: twice what the card shows.
const THUMBNAIL: [u32; 2] = [224, 192];

/// The map and the matrix, and the shapes and forms behind them where the folder has them; `still` in their place.
pub(super) fn explorer(folder: &Path, record: &Figure4Record, still: &str) -> Result<String, ReportError> {
    if record.names.is_empty() || record.panels.is_empty() {
        return Ok(still.to_owned());
    }
    let shapes = shapes(folder, record)?;
    let live = live(record, shapes.as_ref());
    let mut html = framed("figure4", &live, still);
    html.push_str(&island("figure4-data", &data(record, shapes.as_ref())?));
    for (i, shape) in shapes.iter().flat_map(|record| &record.shapes).enumerate() {
        let SeenShape { n_vertices, surface, forms, .. } = shape;
        let shape = json!({"n_vertices": n_vertices, "surface": surface, "forms": forms});
        html.push_str(&island(&format!("figure4-shape-{i}"), &shape));
    }
    Ok(html)
}

/// The record of shapes, where there is one of this very figure.
fn shapes(folder: &Path, figure: &Figure4Record) -> Result<Option<ShapesRecord>, ReportError> {
    let path = folder.join(SHAPES_FILE);
    if !path.exists() {
        return Ok(None);
    }
    let record: ShapesRecord = read(path)?;
    record.validate()?;
    Ok(Some(record).filter(|record| record.belongs_to(figure)))
}

fn data(record: &Figure4Record, shapes: Option<&ShapesRecord>) -> Result<Value, ReportError> {
    let classes = Classes::of(record.labels.iter().map(String::as_str));
    let panels: Vec<Value> = record
        .panels
        .iter()
        .map(|panel| {
            let matrix = encode(panel.matrix.iter().flatten().map(|&distance| distance as f32));
            let unit = panel.scale.unit();
            json!({"method": panel.method, "scale": panel.scale, "unit": unit, "map": panel.map, "matrix": matrix})
        })
        .collect();
    let thumbnails = shapes.map_or(Ok(Vec::new()), |shapes| thumbnails(shapes, &classes))?;
    Ok(json!({
        "names": record.names,
        "labels": record.labels,
        "clay": (0..classes.len()).map(|class| hex(class_clay(class))).collect::<Vec<_>>(),
        "panels": panels,
        "methods": shapes.map_or(&[][..], |shapes| &shapes.methods),
        "motions": shapes.map_or(&[][..], |shapes| &shapes.motions),
        "thumbnails": thumbnails,
    }))
}

/// Pictures of all shapes and their forms, as addresses of data.
fn thumbnails(record: &ShapesRecord, classes: &Classes<'_>) -> Result<Vec<Value>, ReportError> {
    let picture = |shape: &SeenShape, positions: &[[f32; 3]]| -> Result<String, ReportError> {
        let mesh = TriMesh {
            positions: positions.iter().map(|p| Point3::from(p.map(f64::from))).collect(),
            faces: shape.surface.faces.iter().map(|face| face.map(VertexId)).collect(),
        };
        let surface = Surface::Plain(class_clay(classes.index(&shape.label)));
        let [width, height] = THUMBNAIL;
        let options =
            RenderOptions { width, height, view: View::default(), surface, ..RenderOptions::default() };
        let png = render(&mesh, &options).png()?;
        Ok(format!("data:image/png;base64,{}", STANDARD.encode(png)))
    };
    let of_shape = |shape: &SeenShape| {
        let forms: Result<Vec<String>, ReportError> =
            shape.forms.iter().map(|form| picture(shape, &form.positions)).collect();
        Ok(json!({"shape": picture(shape, &shape.surface.positions)?, "forms": forms?}))
    };
    record.shapes.iter().map(of_shape).collect()
}

/// Controls, plots and views.
fn live(record: &Figure4Record, shapes: Option<&ShapesRecord>) -> String {
    let numbered = |chosen: usize| -> Vec<(String, String, bool)> {
        let option = |(i, name): (usize, &String)| (i.to_string(), name.clone(), i == chosen);
        record.names.iter().enumerate().map(option).collect()
    };
    let mut methods: Vec<&str> = record.panels.iter().map(|panel| panel.method.as_str()).collect();
    methods.sort_by_key(|method| record.panels.iter().position(|panel| panel.method == *method));
    methods.dedup();
    let scales = [(Scale::Raw, "original"), (Scale::Normalized, "ignored")];
    let scales = scales.into_iter().filter(|(scale, _)| record.panels_at(*scale).next().is_some());
    let plain = |value: &str, text: &str| (value.to_owned(), text.to_owned(), false);
    let mut controls = select("method", "Method", methods.iter().map(|m| plain(m, m)));
    controls += &select("scale", "Size", scales.map(|(scale, text)| plain(scale.name(), text)));
    controls += &select("first", "Shape 1", numbered(0).into_iter());
    controls += &select("second", "Shape 2", numbered(1.min(record.names.len() - 1)).into_iter());
    if shapes.is_some() {
        let colors = [
            plain("class", "class"),
            plain("distance", "distance from a sample"),
            plain("residual", "residual of the form"),
        ];
        controls += &select("color", "Colours", colors.into_iter());
    }
    let mut html = format!(
        "<div id=\"figure4-explorer\">\n<form class=\"controls\" autocomplete=\"off\">\n{controls}</form>\n<div class=\"plots\">\n\
         <div class=\"anchor\"><div class=\"plot square\" id=\"figure4-map\" data-plot=\"map\" role=\"img\" \
         aria-label=\"Map of the shapes; choose a shape above or by a click\"></div>\n\
         <div class=\"card\" id=\"figure4-card\" hidden><div><img class=\"shape\" alt=\"\" width=\"112\" height=\"96\">\
         <img class=\"form\" alt=\"\" width=\"112\" height=\"96\"></div><p><b class=\"name\"></b> <span class=\"class\"></span></p></div></div>\n\
         <div class=\"plot square\" id=\"figure4-matrix\" data-plot=\"matrix\" role=\"img\" \
         aria-label=\"Distances of all pairs; choose a pair above or by a click\"></div>\n</div>\n\
         <p id=\"figure4-facts\" role=\"status\"></p>\n"
    );
    html.push_str(&match shapes {
        Some(_) => views(),
        None => format!(
            "<div class=\"missing\"><p>Shapes and forms to turn are not in this folder (<code>{SHAPES_FILE}</code> of this \
             very run): <code>{}</code> adds them.</p></div>\n",
            escape(&record.provenance.command)
        ),
    });
    html.push_str("</div>\n");
    html
}

fn select(name: &str, label: &str, options: impl Iterator<Item = (String, String, bool)>) -> String {
    let mut html = format!("<label>{label} <select id=\"figure4-{name}\">");
    for (value, text, chosen) in options {
        let chosen = if chosen { " selected" } else { "" };
        let _ = write!(html, "<option value=\"{}\"{chosen}>{}</option>", escape(&value), escape(&text));
    }
    html.push_str("</select></label>\n");
    html
}

/// The scenes, and what their colours mean.
fn views() -> String {
    let names = ["first-shape", "first-form", "second-shape", "second-form", "overlay"];
    let scenes =
        names.map(|name| format!("<div class=\"view {name}\" id=\"figure4-{name}\"></div>\n")).concat();
    format!(
        "<div class=\"views\">\n{scenes}</div>\n<p class=\"pale\">Drag to turn: all pictures turn together. A click makes the wheel \
         zoom. Forms are turned, and where needed mirrored, so that vertices lie as near as they can to where they are on the shape. \
         Distance: over the surface from the first sample, in mesh units, the same colours on shape and form. \
         Residual: for each vertex the root mean square, over the samples, of straight line in the form less distance over the surface. \
         In the picture of both forms the first is coloured by the distance of its vertices to the nearest vertex of the second, which is \
         pale; these distances are worked out by the page from the aligned forms, at the chosen size.</p>\n"
    )
}
