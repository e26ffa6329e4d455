//! `canonform match`.

use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use base::terminal::Bars;
use canonform::mesh::TriMesh;
use canonform::mesh::io::VertexField;
use canonform::relations::{PartOfWhole, Side};
use canonform::surface::VertexId;
use canonform::{CorrespondOptions, MappedSurface, Surface, VertexMap, correspond};
use npyz::WriterBuilder;
use report::color::{Rgb, perceptual, place_colors};
use report::render::{Coloring, RenderOptions, render};
use serde::Serialize;

use crate::args::{Common, MAP_FORMATS, MatchArgs};
use crate::input::read_pair;
use crate::output::{check_folder, check_format, facts, report};

#[derive(Serialize)]
struct MatchJson {
    a: PathBuf,
    b: PathBuf,
    n_vertices: [usize; 2],
    maps: Vec<MapJson>,
    /// The second mesh in the colours that the map carries to the first.
    target: Option<PathBuf>,
    seconds: SecondsJson,
}

#[derive(Serialize)]
struct MapJson {
    #[serde(flatten)]
    map: VertexMap,
    /// Vertices of the first mesh that have a partner.
    matched: usize,
    path: Option<PathBuf>,
    /// The file of the alternative.
    alternative_path: Option<PathBuf>,
}

#[derive(Serialize)]
struct SecondsJson {
    load: f64,
    prepare: f64,
    matching: f64,
    total: f64,
}

/// A mesh as it was read, and prepared.
struct MappedFile {
    mesh: TriMesh,
    mapped: MappedSurface,
}

/// Maps the vertices of one mesh to those of another.
pub(crate) fn match_meshes(args: &MatchArgs, common: &Common) -> Result<ExitCode> {
    let format = match &args.output {
        Some(path) => {
            check_folder(path)?;
            Some(check_format(path, "a map", &MAP_FORMATS)?)
        }
        None => None,
    };
    let mut options = CorrespondOptions { form: args.form.options(common)?, ..CorrespondOptions::default() };
    if let Some(most) = args.form.settings.given.get("eigenfunctions") {
        options.mapping.eigenfunctions = most;
    }
    let [a, b] = read_pair(&args.pair, &args.form.repair, &args.limits, common, |_, mesh, surface, bars| {
        Ok(MappedFile { mesh, mapped: MappedSurface::new(surface, &options, bars)? })
    })?;
    let bars = Bars::with_budget(common.quiet, args.limits.budget());
    let found = correspond(&a.mapped, &b.mapped, &options, &bars)?;
    let mut maps = Vec::new();
    let mut target = None;
    let colors = colors_of(&b.mapped);
    for (i, map) in found.maps.into_iter().enumerate() {
        let path = args.output.as_ref().map(|path| match i {
            0 => path.clone(),
            _ => beside(path, map.kind.name()),
        });
        let other = map.alternative.as_deref();
        let alternative_path =
            path.as_ref().filter(|_| other.is_some()).map(|path| beside(path, "alternative"));
        for (path, map) in [(&path, Some(&map)), (&alternative_path, other)] {
            if let (Some(path), Some(map), Some(format)) = (path, map, format.as_deref()) {
                write(path, format, map, [&a, &b], &colors)?;
            }
        }
        maps.push(MapJson { matched: map.vertices.iter().flatten().count(), map, path, alternative_path });
    }
    if let (Some(path), Some("ply")) = (&args.output, format.as_deref()) {
        let path = beside(path, "target");
        let numbers: Vec<f64> = (0..b.mesh.n_vertices()).map(|v| v as f64).collect();
        canonform::mesh::io::write_scalar_field(&path, &b.mesh, &field(&numbers, &colors))?;
        target = Some(path);
    }
    let surfaces = [a.mapped.surface(), b.mapped.surface()];
    let load = surfaces.map(|surface| surface.load_seconds + surface.repair_seconds).iter().sum();
    let prepare = a.mapped.seconds + b.mapped.seconds;
    let json = MatchJson {
        a: args.pair.a.clone(),
        b: args.pair.b.clone(),
        n_vertices: [a.mesh.n_vertices(), b.mesh.n_vertices()],
        maps,
        target,
        seconds: SecondsJson {
            load,
            prepare,
            matching: found.seconds,
            total: load + prepare + found.seconds,
        },
    };
    report(common, &json, table)
}

/// The path of a further file: `map-mirrored.npy` beside `map.npy`.
fn beside(path: &Path, what: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{what}.{extension}"))
}

/// A colour for each vertex of the input, by its place in the canonical form; grey for dropped vertices.
fn colors_of(side: &MappedSurface) -> Vec<Rgb> {
    let surface: &Surface = side.surface();
    surface.in_input_order(&place_colors(side.shape.form_points()), perceptual(f64::NAN))
}

fn field<'a>(values: &'a [f64], colors: &'a [Rgb]) -> VertexField<'a> {
    VertexField { name: "match", values, colors }
}

/// Writes one map. `colors` are those of the vertices of the second mesh.
fn write(path: &Path, format: &str, map: &VertexMap, [a, b]: [&MappedFile; 2], colors: &[Rgb]) -> Result<()> {
    let number = |v: &Option<VertexId>| v.map_or(-1, |v| i64::from(v.0));
    let carried = || -> Vec<Rgb> {
        let color = |v: &Option<VertexId>| v.map_or(perceptual(f64::NAN), |v| colors[v.index()]);
        map.vertices.iter().map(color).collect()
    };
    match format {
        "csv" => base::files::write_atomically(path, |out| {
            writeln!(out, "vertex,match")?;
            map.vertices.iter().enumerate().try_for_each(|(x, y)| writeln!(out, "{x},{}", number(y)))
        })?,
        "ply" => {
            let values: Vec<f64> = map.vertices.iter().map(|v| number(v) as f64).collect();
            canonform::mesh::io::write_scalar_field(path, &a.mesh, &field(&values, &carried()))?;
        }
        "png" => {
            let drawn = |mesh: &TriMesh, colors: Vec<Rgb>| {
                let coloring = Coloring::Colors(colors);
                render(mesh, &RenderOptions { coloring, ..RenderOptions::default() }, &())
            };
            drawn(&a.mesh, carried())?.beside(&drawn(&b.mesh, colors.to_vec())?).write_png(path)?;
        }
        _ => {
            let numbers: Vec<i64> = map.vertices.iter().map(number).collect();
            base::files::write_atomically(path, |out| {
                let shape = [numbers.len() as u64];
                let out = BufWriter::new(out);
                let mut array =
                    npyz::WriteOptions::new().default_dtype().shape(&shape).writer(out).begin_nd()?;
                array.extend(&numbers)?;
                array.finish()
            })?;
        }
    }
    Ok(())
}

fn table(json: &MatchJson) -> String {
    let mut rows = Vec::new();
    for MapJson { map, matched, path, alternative_path } in &json.maps {
        let file = path.as_ref().map_or(String::new(), |path| format!(", in {}", path.display()));
        let agreement = map.agreement.map_or("cannot be told".to_owned(), |value| format!("{value:.2}"));
        rows.push((map.kind.name(), format!("{matched} vertices{file}")));
        if let Some(PartOfWhole { part, covered, .. }) = &map.part {
            let [part, whole] = if *part == Side::First { ["first", "second"] } else { ["second", "first"] };
            rows.push(("  part", format!("the {part} mesh, of {:.0} % of the {whole}", 100.0 * covered)));
        }
        rows.push(("  distortion", format!("{:.4}", map.distortion)));
        rows.push(("  agreement", agreement));
        let other =
            alternative_path.as_ref().map_or(String::new(), |path| format!(", in {}", path.display()));
        rows.push(match &map.alternative {
            None => ("  confidence", format!("{:.2}", map.confidence)),
            Some(_) => (
                "  confidence",
                format!(
                    "{:.2}: uncertain, front and back may be exchanged; another map is nearly as good{other}",
                    map.confidence
                ),
            ),
        });
    }
    if let Some(path) = &json.target {
        rows.push(("target", path.display().to_string()));
    }
    facts(&rows)
}
