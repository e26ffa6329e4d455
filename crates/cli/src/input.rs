//! Reading meshes, and naming them in messages.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use anyhow::{Context, Result, bail};
use base::terminal::Bars;
use canonform::collection::{Dataset, ShapeFile, Storage, is_dataset, mesh_at, read_mesh_file};
use canonform::mesh::io::{
    FORMATS, FileSource, Format, MeshFile, ReadLimits, files_in, is_mesh_path, mesh_files, or_list,
    without_extension,
};
use canonform::mesh::{RepairReport, TriMesh};
use canonform::{Remedy, Surface, side_by_side};

use crate::args::{Common, LimitArgs, PairArgs, RepairArgs};
use crate::remedy::with_remedy;

/// The name of standard input in messages.
const STREAM: &str = "standard input";

/// Whether a mesh lost more of its surface than allowed.
static LOST_TOO_MUCH: AtomicBool = AtomicBool::new(false);

/// Reports repairs on standard error; no repair is silent.
pub(crate) fn print_repair(name: &str, report: &RepairReport, args: &RepairArgs) {
    for line in report.summary() {
        base::terminal::note(&format!("{name}: {line}"));
    }
    check_dropped(name, report.dropped_area_share, args.max_dropped);
}

/// Warns if more of the surface of a shape was dropped than allowed, and then makes the program
/// [exit with code 1](exit_code_of).
pub(crate) fn check_dropped(name: &str, share: f64, allowed: f64) {
    if share > allowed {
        LOST_TOO_MUCH.store(true, Ordering::Relaxed);
        let message = format!(
            "{name}: {:.1} % of the surface was dropped, since it is not connected to the rest; --max-dropped allows {:.1} %",
            100.0 * share,
            100.0 * allowed
        );
        base::terminal::note(&format!("warning: {}", with_remedy(message, Some(Remedy::BridgeOrWeld))));
    }
}

/// The exit code of a command that ended with this one.
pub(crate) fn exit_code_of(code: ExitCode) -> ExitCode {
    let lost = LOST_TOO_MUCH.load(Ordering::Relaxed);
    if lost && code == ExitCode::SUCCESS { ExitCode::from(1) } else { code }
}

/// The name of a file in messages.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Whether an argument stands for standard input or output.
pub(crate) fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Reads a mesh from a file, or from standard input, with what else the file says.
pub(crate) fn read_file(path: &Path, common: &Common) -> Result<MeshFile> {
    if !is_stream(path) {
        return Ok(read_mesh_file(path, &ReadLimits::default()).map_err(canonform::Error::from)?);
    }
    let Some(format) = common.input_format.as_deref().or(common.format.as_deref()) else {
        bail!("standard input has no file name: pass its format, such as --format ply");
    };
    let format = Format::named(format).with_context(|| {
        let single = FORMATS.iter().filter(|format| format.extensions.len() == 1);
        let known = or_list(single.map(|format| format.extensions[0]));
        format!("`{format}` is not the format of a mesh; use one of {known}, without the dot")
    })?;
    let mut stream = std::io::stdin().lock();
    Ok(canonform::mesh::io::read_from(Path::new(STREAM), &mut stream, format, &ReadLimits::default())?)
}

/// Whether there is a file of this name, or such a member of an archive.
pub(crate) fn is_there(path: &Path) -> bool {
    is_stream(path) || Storage.holds(path)
}

/// Refuses a mesh that is missing, before anything else is wrong.
pub(crate) fn check_there(path: &Path) -> Result<()> {
    if !is_there(path) {
        Storage.open(path).map_err(canonform::Error::from)?;
    }
    Ok(())
}

/// Reads and repairs a mesh, and reports repairs.
pub(crate) fn read_surface(path: &Path, repair: &RepairArgs, common: &Common) -> Result<Surface> {
    Ok(read_reported(path, repair, common)?.1)
}

/// As [`read_surface`], with the mesh as [`read_both`] returns it.
pub(crate) fn read_reported(path: &Path, repair: &RepairArgs, common: &Common) -> Result<(TriMesh, Surface)> {
    let (mesh, surface) = read_both(path, repair, common)?;
    print_repair(&file_name(path), &surface.input.report, repair);
    Ok((mesh, surface))
}

/// Reads and repairs two meshes, reports repairs, and prepares them side by side within the limits.
pub(crate) fn read_pair<T: Send>(
    pair: &PairArgs,
    repair: &RepairArgs,
    limits: &LimitArgs,
    common: &Common,
    prepare: impl Fn(&Path, TriMesh, Surface, &Bars) -> Result<T, canonform::Error> + Sync,
) -> Result<[T; 2]> {
    let paths = [&pair.a, &pair.b];
    read_stream_once(paths)?;
    let [a, b] = paths.map(|path| read_reported(path, repair, common).map(|read| (path, read)));
    let prepared = side_by_side(vec![a?, b?], |(path, (mesh, surface))| {
        let bars = Bars::with_budget(common.quiet, limits.budget());
        prepare(path, mesh, surface, &bars).map_err(|fault| named(path, fault))
    })?;
    Ok(prepared.try_into().unwrap_or_else(|_| unreachable!("every item has a result")))
}

fn read_stream_once<'a>(arguments: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
    if arguments.into_iter().filter(|path| is_stream(path)).count() > 1 {
        bail!("standard input can be read only once; give `-` for one mesh");
    }
    Ok(())
}

/// Reads a mesh, and repairs it as a surface. Points without faces come with those of the surface through them.
pub(crate) fn read_both(path: &Path, repair: &RepairArgs, common: &Common) -> Result<(TriMesh, Surface)> {
    let start = Instant::now();
    let mesh = read_file(path, common)?.mesh;
    let load_seconds = start.elapsed().as_secs_f64();
    let mut surface =
        Surface::new(&mesh, &repair.options(), &()).map_err(|fault| named(path, fault.into()))?;
    surface.input.load_seconds = load_seconds;
    Ok((surface.shown(mesh), surface))
}

/// The meshes that arguments name, in their order: files, standard input, datasets, and patterns such as `scans/*.ply` that
/// no shell has expanded.
pub(crate) fn expand(arguments: &[PathBuf]) -> Result<Vec<ShapeFile>> {
    read_stream_once(arguments)?;
    let mut shapes = Vec::new();
    for argument in arguments {
        match argument.to_str().filter(|text| text.contains(['*', '?', '['])) {
            _ if is_dataset(argument) => shapes.extend(shapes_of(argument)?),
            Some(pattern) if !is_there(argument) => {
                // As in shells, `*` stands for no leading dot.
                let options = glob::MatchOptions { require_literal_leading_dot: true, ..Default::default() };
                let found = glob::glob_with(pattern, options)
                    .with_context(|| format!("`{pattern}` is not a valid pattern"))?
                    .collect::<Result<Vec<_>, _>>()
                    .with_context(|| format!("cannot look for {pattern}"))?;
                let found: Vec<PathBuf> = found.into_iter().filter(|path| is_mesh_path(path)).collect();
                if found.is_empty() {
                    bail!("{pattern}: no mesh matches this pattern; a mesh is {}", mesh_files());
                }
                shapes.extend(found.into_iter().map(single));
            }
            _ => shapes.push(single(argument.clone())),
        }
    }
    Ok(shapes)
}

/// The meshes of a dataset. What was skipped although it may hold some is noted.
pub(crate) fn shapes_of(dataset: &Path) -> Result<Vec<ShapeFile>> {
    let Dataset { shapes, skipped, .. } = Dataset::read(dataset, None)?;
    for it in skipped.iter().filter(|it| !it.kind.is_expected()) {
        base::terminal::note(&format!("warning: skipped {}: {}", it.path.display(), it.kind));
    }
    Ok(shapes)
}

/// Whether arguments name exactly one mesh, whose result is the file `output` and not part of a list.
pub(crate) fn is_single(arguments: &[PathBuf], output: &Path) -> bool {
    let [path] = arguments else { return false };
    match is_dataset(path) {
        // The result of an archive of one mesh may also go to a folder.
        true => {
            let is_file = is_stream(output) || output.extension().is_some() && !output.is_dir();
            is_file && mesh_at(path).is_ok_and(|mesh| mesh != *path)
        }
        false => is_there(path) || !path.to_string_lossy().contains(['*', '?', '[']),
    }
}

fn single(path: PathBuf) -> ShapeFile {
    let stem = without_extension(&path);
    let stem = stem.file_name().unwrap_or_default().to_string_lossy();
    let name = if is_stream(&path) { "stdin".to_owned() } else { stem.into_owned() };
    ShapeFile { label: canonform::collection::label_of(&name), name, path }
}

/// An error that names the file exactly once.
pub(crate) fn named(path: &Path, fault: canonform::Error) -> anyhow::Error {
    let is_named = is_named(path, &fault.to_string());
    let error = anyhow::Error::from(fault);
    if is_named { error } else { error.context(input_name(path)) }
}

/// An input in messages.
pub(crate) fn input_name(path: &Path) -> String {
    if is_stream(path) { STREAM.to_owned() } else { path.display().to_string() }
}

/// Whether a message names a mesh, by any of its files.
pub(crate) fn is_named(path: &Path, text: &str) -> bool {
    if is_stream(path) {
        return text.contains(STREAM);
    }
    let mut files = files_in(path, &Storage).into_iter().chain([path.to_owned()]);
    files.any(|file| text.contains(&file.display().to_string()))
}
