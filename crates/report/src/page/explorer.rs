//! Figure 4 to turn and to ask.

use std::fmt::Write;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use mesh::TriMesh;
use nalgebra::Point3;
use serde_json::{Value, json};
use surface::VertexId;

use super::chart::framed;
use super::html::escape;
use super::scripts::island;
use view::ViewError;

use crate::ReportError;
use crate::classes::Classes;
use crate::results::{Figure1Record, Figure4Record, SHAPES_FILE, Scale, SeenShape, ShapesRecord, read};
use view::color::class_clay;
use view::interactive::base64::encode;
use view::interactive::hex;
use view::render::{Background, RenderOptions, Surface, render};

/// Width and height of a thumbnail, in pixels: twice what the card shows.
const THUMBNAIL: [u32; 2] = [224, 192];

/// The map and the matrix, and the shapes and forms behind them where the folder has them; `still` in their place.
pub(super) fn explorer(
    record: &Figure4Record,
    shapes: Option<&ShapesRecord>,
    still: &str,
) -> Result<String, ReportError> {
    if record.names.is_empty() || record.panels.is_empty() {
        return Ok(still.to_owned());
    }
    let live = live(record, shapes);
    let mut html = framed("figure4", &live, still);
    html.push_str(&island("figure4-data", &data(record, shapes)?));
    for (i, shape) in shapes.iter().flat_map(|shapes| &shapes.shapes).enumerate() {
        let SeenShape { n_vertices, surface, forms, .. } = shape;
        let shape = json!({"n_vertices": n_vertices, "surface": surface, "forms": forms});
        html.push_str(&island(&format!("figure4-shape-{i}"), &shape));
    }
    Ok(html)
}

/// The record of the shapes of Figure 4, where the folder has both and they belong together.
pub(super) fn shapes(folder: &Path) -> Result<Option<ShapesRecord>, ReportError> {
    let (figure, shapes) = (folder.join("figure4.json"), folder.join(SHAPES_FILE));
    if !(figure.exists() && shapes.exists()) {
        return Ok(None);
    }
    let figure: Figure4Record = read(figure)?;
    let shapes: ShapesRecord = read(shapes)?;
    shapes.validate()?;
    Ok(Some(shapes).filter(|shapes| shapes.belongs_to(&figure)))
}

/// The shapes of Figure 1 to turn, those that Figure 4 has; empty when it has none.
pub(super) fn gallery(record: &Figure1Record, shapes: Option<&ShapesRecord>) -> String {
    let Some(shapes) = shapes else { return String::new() };
    let place = |name: &String| shapes.shapes.iter().position(|shape| shape.name == *name);
    let options: Vec<_> = record
        .shapes
        .iter()
        .filter_map(|s| Some((place(&s.name)?.to_string(), s.name.clone(), false)))
        .collect();
    let Some(method) = shapes.methods.first().filter(|_| !options.is_empty()) else { return String::new() };
    let controls = select("figure1-shape", "Shape", options.into_iter()) + &color_select("figure1-color");
    let scenes =
        ["shape", "form"].map(|name| format!("<div class=\"view\" id=\"figure1-view-{name}\"></div>\n"));
    format!(
        "<div class=\"live\" id=\"figure1-explorer\" data-method=\"{}\">\n<form class=\"controls\" autocomplete=\"off\">\n{controls}</form>\n\
         <div class=\"views two\">\n{}</div>\n<p class=\"pale\">Drag to turn both; the colours are explained at \
         <a href=\"#figure4-explorer\">Figure 4</a>, which has all shapes.</p>\n</div>\n",
        escape(method),
        scenes.concat()
    )
}

fn color_select(id: &str) -> String {
    let colors =
        [("class", "class"), ("distance", "distance from a sample"), ("residual", "residual of the form")];
    select(id, "Colours", colors.into_iter().map(|(value, text)| (value.to_owned(), text.to_owned(), false)))
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
        let background = Background::Transparent;
        let options = RenderOptions { width, height, surface, background, ..RenderOptions::default() };
        let png = render(&mesh, &options)
            .to_png()
            .map_err(|e| ViewError::Draw { figure: "a picture".into(), reason: e.to_string() })?;
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
    let mut controls = select("figure4-method", "Method", methods.iter().map(|m| plain(m, m)));
    controls += &select("figure4-scale", "Size", scales.map(|(scale, text)| plain(scale.name(), text)));
    controls += &select("figure4-first", "Shape 1", numbered(0).into_iter());
    controls += &select("figure4-second", "Shape 2", numbered(1.min(record.names.len() - 1)).into_iter());
    if shapes.is_some() {
        controls += &color_select("figure4-color");
    }
    let mut html = format!(
        "<div id=\"figure4-explorer\">\n<form class=\"controls\" autocomplete=\"off\">\n{controls}</form>\n<div class=\"plots\">\n\
         <div class=\"anchor\"><div class=\"plot square\" id=\"figure4-map\" data-plot=\"map\" role=\"img\" \
         aria-label=\"Map of the shapes; choose a shape above or by a click\"></div>\n\
         <div class=\"card\" id=\"figure4-card\" hidden><div><img class=\"shape\" alt=\"\" width=\"112\" height=\"96\">\
         <img class=\"form\" alt=\"\" width=\"112\" height=\"96\"></div><p><b class=\"name\"></b> <span class=\"class\"></span></p></div></div>\n\
         <div class=\"plot square\" id=\"figure4-matrix\" data-plot=\"matrix\" role=\"img\" \
         aria-label=\"Distances of all pairs; choose a pair above or by a click\"></div>\n</div>\n\
         <p class=\"pale\">Left: the shapes as points of the plane, by multidimensional scaling of the distances between their forms; near points \
         are similar forms. Right: these distances, grouped by class; dark is near. A click on a point chooses shape 1, on a cell a pair.</p>\n\
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

fn select(id: &str, label: &str, options: impl Iterator<Item = (String, String, bool)>) -> String {
    let mut html = format!("<label>{label} <select id=\"{id}\">");
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
