//! `canonform embed`.

mod words;

pub(super) use self::words::estimated;

use std::path::Path;
use std::process::ExitCode;

use anyhow::{Context, Result, bail};
use base::object;
use base::terminal::Bars;
use canonform::collection::ShapeFile;
use canonform::embed::{EmbedMethod, EmbedOptions, Embedded, StressOptions, embed as embed_surface};
use canonform::linalg::Matrix;
use canonform::mesh::InputMap;
use canonform::mesh::io::{extension, or_list};
use canonform::settings::MarchingSettings;
use canonform::surface::VertexId;
use canonform::{Budget, Surface};

use self::words::{EmbedJson, PointJson, answer, stresses, warn};
use crate::args::{Common, EmbedArgs, FORM_FORMATS, LimitArgs};
use crate::batch::Results;
use crate::input::{check_there, is_single, is_stream, named, print_repair, read_both, read_surface};
use crate::output::{Output, exit_code, report, row_of, shown, table_of};
use crate::table::write_npy;

/// Embeds one mesh, or each of several.
pub(crate) fn embed(args: &EmbedArgs, common: &Common) -> Result<ExitCode> {
    let options = args.form.options(&args.method, common)?;
    // Options of fast marching may be those of the form alone.
    let marching = [&args.form.marching, &MarchingSettings::default()];
    let against = args.stress_against.and_then(|method| marching.iter().find_map(|m| m.method(method).ok()));
    let choice = args.stress.stress.unwrap_or_default();
    let stress = StressOptions { choice, against, seed: common.seed };
    if args.form.form.n_landmarks.is_some() && options.method == EmbedMethod::Classical {
        base::terminal::note(
            "note: -n has no effect with --method mds, which measures all pairs of vertices",
        );
    }
    if args.features && options.dim != 3 {
        bail!("--features bends the mesh in 3 dimensions; leave out --dim");
    }
    let options = EmbedOptions::from(&options).stress(stress);
    match &args.meshes[..] {
        [mesh] if is_single(&args.meshes, &args.output) => one(mesh, args, &options, common),
        _ if args.extend.is_some() || !args.at.is_empty() => {
            bail!("--at and --extend are about one mesh; give one")
        }
        _ => batch(args, &options, common),
    }
}

fn one(mesh: &Path, args: &EmbedArgs, options: &EmbedOptions<'_>, common: &Common) -> Result<ExitCode> {
    check_there(mesh)?;
    let formats = FORM_FORMATS.map(|(extension, _)| extension);
    let output = Output::new(&args.output, "a form", &formats, Some(output_format(args, common)?), common)?;
    check_dim(&output.name, &output.format, options.form.dim)?;
    let surface = read_surface(mesh, &args.form.repair, common)?;
    let coarser =
        args.extend.as_ref().map(|path| read_surface(path, &args.form.repair, common)).transpose()?;
    let bars = Bars::with_budget(common.quiet, budget(args, &output.path, 1));
    let json = embed_and_write(mesh, (surface, coarser), &output.path, args, options, &bars)?;
    drop(bars);
    warn(&mesh.display().to_string(), &json.report);
    let json = EmbedJson { output: output.name.clone(), ..json };
    output.report(common, &json, |json| answer(json).text(common))
}

/// The limits of an embedding, one of `n_at_once`. Distances that do not fit into memory are kept in a file beside the form.
///
/// Under `ulimit -v` they have their share of three quarters of that memory; the rest is for the program itself.
fn budget(args: &EmbedArgs, output: &Path, n_at_once: usize) -> Budget {
    let share = || Some(base::terminal::memory_limit()? / 4 * 3 / n_at_once);
    let limits = LimitArgs { memory: args.limits.memory.or_else(share), ..args.limits };
    let folder = output.ancestors().skip(1).find(|folder| folder.is_dir()).unwrap_or(Path::new("."));
    limits.budget().with_spill(folder.to_owned())
}

/// Embeds a surface and writes its form.
fn embed_and_write(
    mesh: &Path,
    (surface, coarser): (Surface, Option<Surface>),
    output: &Path,
    args: &EmbedArgs,
    options: &EmbedOptions<'_>,
    bars: &Bars,
) -> Result<EmbedJson> {
    let (mut points, features) = (Vec::new(), args.features);
    let embedded = || -> Result<_, canonform::Error> {
        if !features && coarser.is_none() && args.at.is_empty() {
            // Without keeping the mesh in memory; only meshes need faces.
            let (intrinsic, mut map) = surface.into_parts();
            if extension(output) == "npy" {
                map.faces = Vec::new();
            }
            let Embedded { embedding, report, .. } = embed_surface((intrinsic, &map), options.clone(), bars)?;
            return Ok((embedding.coords, map, report));
        }
        let form = coarser.as_ref().map(|coarser| embed_surface(coarser, options.form, bars)).transpose()?;
        let options = match coarser.as_ref().zip(form.as_ref()) {
            Some((coarser, form)) => EmbedOptions::finer(&surface, coarser, form)?.stress(options.stress),
            None => options.clone(),
        };
        let embedded = embed_surface(&surface, options, bars)?;
        if !args.at.is_empty() {
            let placed = embedded.place(&surface, &args.at)?;
            let coordinates = placed.row_iter().map(|row| row.iter().copied().collect());
            let placed = args.at.iter().zip(coordinates);
            points.extend(placed.map(|(&at, coordinates)| PointJson { at, coordinates }));
        }
        let coords = if features {
            let form = embedded.form(&surface)?.with_features(surface.mesh(), bars)?;
            Matrix::from_fn(form.points().len(), 3, |i, axis| form.points()[i][axis])
        } else {
            embedded.embedding.coords
        };
        Ok((coords, surface.into_parts().1, embedded.report))
    };
    let (coords, map, report) = embedded().map_err(|fault| named(mesh, fault))?;
    write(output, &map, &coords)?;
    Ok(EmbedJson { report, points, features, output: output.to_owned() })
}

/// The format of forms in a folder or on standard output.
fn output_format(args: &EmbedArgs, common: &Common) -> Result<&'static str> {
    // Of a mesh from standard input, `--format` is the format, unless that is stated otherwise.
    let is_of_input = common.input_format.is_none() && args.meshes.iter().any(|mesh| is_stream(mesh));
    let Some(stated) = common.format.as_deref().filter(|_| !is_of_input) else {
        return Ok(args.output_format.unwrap_or("ply"));
    };
    let known = FORM_FORMATS.map(|(extension, _)| extension);
    let given = args.output_format.or_else(|| known.into_iter().find(|extension| *extension == stated));
    given.with_context(|| format!("forms cannot be written as {stated}; use {}", or_list(known)))
}

/// Embeds meshes in parallel. Failures are listed at the end and do not stop the rest.
fn batch(args: &EmbedArgs, options: &EmbedOptions<'_>, common: &Common) -> Result<ExitCode> {
    let extension = output_format(args, common)?;
    check_dim(&args.output, extension, options.form.dim)?;
    let (arguments, folder) = (&args.meshes, &args.output);
    let results = Results { what: "forms", arguments, folder, extension, in_parallel: true };
    let n_threads = rayon::current_num_threads();
    let (done, failed) = results.make(common, |shape, output| {
        let (_, surface) = read_both(&shape.path, &args.form.repair, common)?;
        let bars = Bars::with_budget(true, budget(args, output, n_threads));
        embed_and_write(&shape.path, (surface, None), output, args, options, &bars)
    })?;
    let shapes = done.into_iter().map(|(ShapeFile { name, label, path }, result)| {
        print_repair(&name, &result.report.repair, &args.form.repair);
        warn(&name, &result.report);
        object! {
            name,
            label,
            path,
            #[serde(flatten)]
            result,
        }
    });
    let json = object! { shapes: shapes.collect::<Vec<_>>(), failed };
    report(common, &json, |json| {
        let header = ["shape", "class", "vertices", "samples", "stress", "normalized stress", "seconds"];
        let mut table = table_of(header);
        for shape in &json.shapes {
            let r = &shape.result.report;
            let [n, samples] = [r.n_embedded, r.n_samples].map(|n| n.to_string());
            let ([stress, normalized], seconds) = (stresses(r), format!("{:.3}", r.seconds.total));
            table.add_row(row_of([&shape.name, &shape.label, &n, &samples, &stress, &normalized, &seconds]));
        }
        format!("{table}\n{}", results.counts(json.shapes.len(), &json.failed))
    })?;
    Ok(exit_code(json.failed.is_empty()))
}

/// Refuses a form whose file cannot hold this many dimensions, before any work is done.
fn check_dim(output: &Path, format: &str, dim: usize) -> Result<()> {
    if format != "npy" && dim != 3 {
        bail!("{}: a mesh has 3 dimensions, not {dim}; write .npy or leave out --dim", shown(output));
    }
    Ok(())
}

/// Writes the form: an array with one row per input vertex, or a mesh with the faces of the repaired input.
fn write(output: &Path, map: &InputMap, coords: &Matrix) -> Result<()> {
    if extension(output) == "npy" {
        let k = coords.ncols();
        let row = |vertex: Option<VertexId>| {
            (0..k).map(move |axis| vertex.map_or(f64::NAN, |v| coords[(v.index(), axis)]))
        };
        return write_npy(output, &[map.remap.n_old(), k], map.remap.all_to_new().flat_map(row));
    }
    let position = |v: VertexId| [0, 1, 2].map(|axis| coords[(v.index(), axis)]).into();
    Ok(canonform::mesh::io::write(output, &map.with_positions(position))?)
}
