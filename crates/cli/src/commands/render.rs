//! `canonform render`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Result, bail};
use canonform::geodesics::{Method, Source};
use canonform::{FormOptions, Surface, embed};
use mesh::{RepairReport, TriMesh};
use serde::Serialize;
use terminal::Bars;
use view::render::{RenderOptions, Surface as Paint, render, render_with_bar, value_range};

use super::{file_name, named, say_repair};
use crate::args::{Common, Place, RenderArgs};
use crate::field::read_field;
use crate::output::{check_folder, extension, facts, print, print_json};

#[derive(Serialize)]
struct RenderJson {
    mesh: PathBuf,
    output: PathBuf,
    width: u32,
    height: u32,
    n_vertices: usize,
    n_faces: usize,
    /// What it is coloured by.
    field: Option<FieldJson>,
    seconds: f64,
    /// Where distances or a form were measured.
    repair: Option<RepairReport>,
}

#[derive(Serialize)]
struct FieldJson {
    name: String,
    /// Least and greatest finite value.
    values: Option<[f64; 2]>,
    /// What is drawn darkest and lightest.
    range: Option<[f64; 2]>,
    /// Vertices without a finite value.
    missing: usize,
}

/// Numbers to colour by, one a vertex of the input.
struct Field {
    name: String,
    values: Vec<f64>,
}

/// Draws a mesh, or its form, into a file.
pub(crate) fn picture(args: &RenderArgs, common: &Common) -> Result<ExitCode> {
    if extension(&args.output) != "png" {
        bail!("{}: pictures are written as .png; end the name so", args.output.display());
    }
    check_folder(&args.output)?;
    check_options(args)?;
    let start = Instant::now();
    let mesh = mesh::io::read(&args.mesh)?;
    if mesh.n_faces() == 0 {
        bail!("{}: there is no face to draw; give a mesh with faces", args.mesh.display());
    }
    let surface = if args.form || !args.distance_from.is_empty() {
        let surface =
            Surface::new(&mesh, &args.repair.options()).map_err(|fault| named(&args.mesh, fault))?;
        say_repair(&file_name(&args.mesh), &surface.repaired.report);
        Some(surface)
    } else {
        None
    };
    let field = field(args, &mesh, surface.as_ref())?;
    let drawn = match &surface {
        Some(surface) if args.form => form(args, surface, common)?,
        _ => mesh,
    };
    let options = options(args, field.as_ref());
    let image = match &field {
        Some(field) if !args.no_bar => render_with_bar(&drawn, &options, &field.name)?,
        _ => render(&drawn, &options),
    };
    image.write_png(&args.output)?;
    let json = RenderJson {
        mesh: args.mesh.clone(),
        output: args.output.clone(),
        width: image.width(),
        height: image.height(),
        n_vertices: drawn.n_vertices(),
        n_faces: drawn.n_faces(),
        field: field.map(|field| FieldJson {
            values: value_range(&field.values),
            range: args.range.map(|range| range.0).or_else(|| value_range(&field.values)),
            missing: field.values.iter().filter(|value| !value.is_finite()).count(),
            name: field.name,
        }),
        seconds: start.elapsed().as_secs_f64(),
        repair: surface.map(|surface| surface.repaired.report),
    };
    if common.json {
        print_json(&json)?
    } else {
        print(&table(&json))?
    }
    Ok(ExitCode::SUCCESS)
}

/// Refuses what would have no effect.
fn check_options(args: &RenderArgs) -> Result<()> {
    if args.field.is_some() || !args.distance_from.is_empty() {
        return Ok(());
    }
    let given =
        [("--isolines", args.isolines > 0), ("--range", args.range.is_some()), ("--no-bar", args.no_bar)];
    match given.iter().find(|(_, is_given)| *is_given) {
        Some((option, _)) => {
            bail!(
                "{option} has no effect without numbers to draw; add --field or --distance-from, or leave it out"
            )
        }
        None => Ok(()),
    }
}

fn field(args: &RenderArgs, mesh: &TriMesh, surface: Option<&Surface>) -> Result<Option<Field>> {
    if let Some(path) = &args.field {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        return Ok(Some(Field { name, values: read_field(path, args.row, mesh.n_vertices())? }));
    }
    match surface {
        Some(surface) if !args.distance_from.is_empty() => {
            let values = distances(args, surface).map_err(|fault| named(&args.mesh, fault))?;
            Ok(Some(Field { name: "distance".to_owned(), values }))
        }
        _ => Ok(None),
    }
}

fn distances(args: &RenderArgs, surface: &Surface) -> Result<Vec<f64>, canonform::Error> {
    let source = |point| Ok(Source::new(&surface.intrinsic, surface.locate(point)?)?);
    let sources: Result<Vec<_>, canonform::Error> = args.distance_from.iter().map(source).collect();
    let solver = Method::default().prepare(&surface.intrinsic)?;
    let mut distances = vec![0.0; solver.n_vertices()];
    solver.solve_into(&sources?, f64::INFINITY, &mut distances);
    Ok(surface.in_input_order(&distances, f64::INFINITY))
}

/// The canonical form over the input's vertices; those that the repair left out are nowhere.
fn form(args: &RenderArgs, surface: &Surface, common: &Common) -> Result<TriMesh> {
    let options = FormOptions { seed: common.seed, ..FormOptions::default() };
    let bars = Bars::new(common.quiet);
    let embedded = embed(surface, &options, &bars).map_err(|fault| named(&args.mesh, fault))?;
    bars.finish();
    let points: Vec<_> =
        embedded.embedding.coords.row_iter().map(|row| [row[0], row[1], row[2]].into()).collect();
    let positions = surface.in_input_order(&points, [f64::NAN; 3].into());
    Ok(TriMesh { positions, faces: surface.input_faces.clone() })
}

fn options(args: &RenderArgs, field: Option<&Field>) -> RenderOptions {
    let usual = RenderOptions::default();
    let surface = match (field, args.color) {
        (Some(field), _) => Paint::Scalars {
            values: field.values.clone(),
            range: args.range.map(|range| range.0),
            // Between so many lines there is one step more.
            isolines: args.isolines + 1,
        },
        (None, Some(color)) => Paint::Plain(color),
        (None, None) => usual.surface,
    };
    let place = args.view.unwrap_or(if args.form { Place::Principal } else { Place::Angles([30.0, 12.0]) });
    let (width, height) = (args.size.width, args.size.height);
    // Nine samples a pixel of the largest pictures would take gigabytes; their pixels are small enough.
    let supersampling = if width * height > 2000 * 2000 { 2 } else { usual.supersampling };
    let view = place.view(args.up);
    RenderOptions { width, height, view, background: args.background, surface, supersampling, ..usual }
}

fn table(json: &RenderJson) -> String {
    let mut lines = vec![("vertices, faces", format!("{}, {}", json.n_vertices, json.n_faces))];
    if let Some(field) = &json.field {
        let ends = |range: &Option<[f64; 2]>| match range {
            Some([low, high]) => format!("{low:.6} to {high:.6}"),
            None => "no finite value".to_owned(),
        };
        lines.push(("coloured by", format!("{}, {}", field.name, ends(&field.values))));
        if field.range != field.values {
            lines.push(("colours", ends(&field.range)));
        }
        if field.missing > 0 {
            lines.push(("grey", format!("{} vertices without a finite value", field.missing)));
        }
    }
    lines.push(("picture", format!("{} x {} pixels, {:.2} s", json.width, json.height, json.seconds)));
    lines.push(("wrote", Path::new(&json.output).display().to_string()));
    facts(&lines)
}
