//! `canonform render`.

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Result, bail};
use base::object;
use base::terminal::Bars;
use canonform::Surface;
use canonform::embed::{FormOptions, embed};
use canonform::geodesics::{Method, Source};
use canonform::mesh::TriMesh;
use canonform::mesh::io::{MeshFile, ScalarField};
use report::render::{Coloring, RenderOptions, View, annotated, render, value_range};
use serde::Serialize;

use crate::args::{Common, RenderArgs};
use crate::batch::Results;
use crate::input::{check_there, file_name, is_single, named, print_repair, read_file};
use crate::output::{Output, exit_code, facts, report};
use crate::table::read_field;

/// Draws one mesh, or each of several.
pub(crate) fn draw(args: &RenderArgs, common: &Common) -> Result<ExitCode> {
    let bars = |quiet| Bars::with_budget(quiet, args.limits.budget());
    if let ([mesh], true) = (&args.meshes[..], is_single(&args.meshes, &args.output)) {
        check_there(mesh)?;
        let output = Output::new(&args.output, "a picture", &["png"], None, common)?;
        let (drawn, text) = draw_one(mesh, [&output.path, &output.name], args, &bars(common.quiet), common)?;
        return output.report(common, &drawn, |_| text);
    }
    let (arguments, folder) = (&args.meshes, &args.output);
    let results = Results { what: "pictures", arguments, folder, extension: "png", in_parallel: false };
    let (done, failed) = results
        .make(common, |shape, output| draw_one(&shape.path, [output; 2], args, &bars(true), common))?;
    let json =
        object! { pictures: done.into_iter().map(|(_, (drawn, _))| drawn).collect::<Vec<_>>(), failed };
    report(common, &json, |json| results.counts(json.pictures.len(), &json.failed))?;
    Ok(exit_code(json.failed.is_empty()))
}

/// Draws a mesh, or its form, into a file. Returns what is said of it, with another name of the file, and in words.
fn draw_one(
    path: &Path,
    [output, name]: [&Path; 2],
    args: &RenderArgs,
    bars: &Bars,
    common: &Common,
) -> Result<(impl Serialize + use<>, String)> {
    let start = Instant::now();
    let MeshFile { mesh, field: carried, .. } = read_file(path, common)?;
    // Points without faces are drawn as the surface through them.
    let is_measured = args.form || !args.distance_from.is_empty() || mesh.faces.is_empty();
    let surface = is_measured.then(|| Surface::new(&mesh, &args.repair.options(), &())).transpose();
    let surface = surface.map_err(|fault| named(path, fault.into()))?;
    if let Some(surface) = &surface {
        print_repair(&file_name(path), &surface.input.report, &args.repair);
    }
    let field = field(path, args, &mesh, carried, surface.as_ref())?;
    let drawn = match &surface {
        Some(surface) if args.form => form(surface, bars, common).map_err(|fault| named(path, fault))?,
        Some(surface) => surface.shown(mesh),
        _ => mesh,
    };
    let options = options(args, field.as_ref());
    let budget = args.limits.budget();
    let image = match &field {
        Some(field) if !args.no_bar => annotated(&drawn, &options, Some(&field.name), &[], &budget)?,
        _ => render(&drawn, &options, &budget).map_err(|fault| named(path, fault.into()))?,
    };
    image.write_png(output)?;
    let field = field.map(|ScalarField { name, values }| {
        let ends = value_range(&values);
        let missing = values.iter().filter(|value| !value.is_finite()).count();
        object! { name, values: ends, range: args.range.or(ends), missing }
    });
    let json = object! {
        mesh: path.to_owned(),
        output: name.to_owned(),
        width: image.width(),
        height: image.height(),
        n_vertices: drawn.n_vertices(),
        n_faces: drawn.n_faces(),
        field,
        seconds: start.elapsed().as_secs_f64(),
        repair: surface.map(|surface| surface.input.report),
    };
    let mut lines = vec![("vertices, faces", format!("{}, {}", json.n_vertices, json.n_faces))];
    if let Some(field) = &json.field {
        let ends = |range: &Option<[f64; 2]>| match range {
            Some([low, high]) => format!("{low:.6} to {high:.6}"),
            None => "no finite value".to_owned(),
        };
        lines.push(("colored by", format!("{}, {}", field.name, ends(&field.values))));
        if field.range != field.values {
            lines.push(("colors", ends(&field.range)));
        }
        if field.missing > 0 {
            lines.push(("gray", format!("{} vertices without a finite value", field.missing)));
        }
    }
    lines.push(("picture", format!("{} x {} pixels, {:.2} s", json.width, json.height, json.seconds)));
    lines.push(("wrote", json.output.display().to_string()));
    let text = facts(&lines);
    Ok((json, text))
}

/// Refuses options that would have no effect on a mesh without values.
fn check_options(args: &RenderArgs) -> Result<()> {
    let given =
        [("--isolines", args.isolines > 0), ("--range", args.range.is_some()), ("--no-bar", args.no_bar)];
    if let Some((option, _)) = given.iter().find(|(_, is_given)| *is_given) {
        bail!(
            "{option} has no effect without values to draw; add --field or --distance-from, or leave it out"
        );
    }
    Ok(())
}

/// The values to draw: of a file, of distances, or those that the mesh file carries.
fn field(
    path: &Path,
    args: &RenderArgs,
    mesh: &TriMesh,
    carried: Option<ScalarField>,
    surface: Option<&Surface>,
) -> Result<Option<ScalarField>> {
    if let Some(path) = &args.field {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        return Ok(Some(ScalarField { name, values: read_field(path, args.row, mesh.n_vertices())? }));
    }
    match (surface, carried) {
        (Some(surface), _) if !args.distance_from.is_empty() => {
            let values = distances(args, surface).map_err(|fault| named(path, fault))?;
            Ok(Some(ScalarField { name: "distance".to_owned(), values }))
        }
        (_, Some(field)) if args.color.is_none() => Ok(Some(field)),
        _ => {
            check_options(args)?;
            Ok(None)
        }
    }
}

fn distances(args: &RenderArgs, surface: &Surface) -> Result<Vec<f64>, canonform::Error> {
    let source = |point| Ok(Source::new(surface.intrinsic(), surface.locate(point)?)?);
    let sources: Result<Vec<_>, canonform::Error> = args.distance_from.iter().map(source).collect();
    let solver = Method::default().prepare(surface.intrinsic(), &args.limits.budget())?;
    let mut distances = vec![0.0; solver.n_vertices()];
    solver.solve_into(&sources?, f64::INFINITY, &mut distances)?;
    Ok(surface.in_input_order(&distances, f64::INFINITY))
}

/// The canonical form with the faces of the input; vertices that the repair dropped have NaN positions.
fn form(surface: &Surface, bars: &Bars, common: &Common) -> Result<TriMesh, canonform::Error> {
    let options = FormOptions { seed: common.seed, ..FormOptions::default() };
    let embedded = embed(surface, &options, bars)?;
    let points: Vec<_> =
        embedded.embedding.coords.row_iter().map(|row| [row[0], row[1], row[2]].into()).collect();
    let positions = surface.in_input_order(&points, [f64::NAN; 3].into());
    Ok(TriMesh { positions, faces: surface.input.faces.clone() })
}

fn options(args: &RenderArgs, field: Option<&ScalarField>) -> RenderOptions {
    let usual = RenderOptions::default();
    let coloring = match (field, args.color) {
        (Some(field), _) => Coloring::Scalars {
            values: field.values.clone(),
            range: args.range,
            // N lines separate N + 1 steps.
            isolines: args.isolines + 1,
        },
        (None, Some(color)) => Coloring::Plain(color),
        (None, None) => usual.coloring,
    };
    let mut view = args.view.unwrap_or(if args.form { View::Principal } else { usual.view });
    if let View::Upright { up, .. } = &mut view {
        *up = args.up.into();
    }
    let [width, height] = args.size;
    // Nine samples per pixel of a large picture would take gigabytes; its pixels are small enough.
    let supersampling = if width * height > 2000 * 2000 { 2 } else { usual.supersampling };
    let (background, colors) = (args.background, args.colors);
    RenderOptions { width, height, view, background, coloring, colors, supersampling, ..usual }
}
