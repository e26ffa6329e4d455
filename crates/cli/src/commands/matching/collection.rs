//! Maps between several meshes that agree with each other.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Result, bail};
use base::terminal::Bars;
use canonform::relations::CycleReport;
use canonform::{CorrespondOptions, MappedSurface, PairMap, ShapeFile, VertexMap, correspond_all};
use serde::Serialize;

use super::files::{SecondsJson, write_table};
use crate::args::{Common, MatchArgs};
use crate::input::{named, read_reported};
use crate::output::{report, row_of, table_of};

#[derive(Serialize)]
struct CollectionJson {
    meshes: Vec<MeshJson>,
    pairs: Vec<PairJson>,
    /// How well the maps close to cycles, before and after they were made to agree.
    cycles: CycleReport,
    seconds: SecondsJson,
}

#[derive(Serialize)]
struct MeshJson {
    name: String,
    path: PathBuf,
    n_vertices: usize,
}

#[derive(Serialize)]
struct PairJson {
    a: String,
    b: String,
    #[serde(flatten)]
    map: VertexMap,
    /// Whether the map of these two alone agrees with those of the others.
    agreed: bool,
    path: Option<PathBuf>,
}

/// Maps several meshes to each other.
pub(super) fn match_all(
    shapes: &[ShapeFile],
    args: &MatchArgs,
    common: &Common,
    options: &CorrespondOptions,
) -> Result<ExitCode> {
    check(shapes, args)?;
    if let Some(folder) = &args.output {
        std::fs::create_dir_all(folder)?;
    }
    let mut mapped = Vec::new();
    for ShapeFile { path, .. } in shapes {
        let (_, surface) = read_reported(path, &args.form.repair, common)?;
        let bars = Bars::with_budget(common.quiet, args.limits.budget());
        mapped.push(MappedSurface::new(surface, options, &bars).map_err(|fault| named(path, fault))?);
    }
    let bars = Bars::with_budget(common.quiet, args.limits.budget());
    let sides: Vec<&MappedSurface> = mapped.iter().collect();
    let found = correspond_all(&sides, options, &bars)?;
    let format = args.output_format.unwrap_or("npy");
    let pair = |PairMap { a, b, map, agreed }: PairMap| {
        let [a, b] = [a, b].map(|i| shapes[i].name.clone());
        let path = args.output.as_ref().map(|folder| folder.join(format!("{a}-{b}.{format}")));
        if let Some(path) = &path {
            write_table(path, format, &map, None)?;
        }
        Ok(PairJson { a, b, map, agreed, path })
    };
    let pairs = found.pairs.into_iter().map(pair).collect::<Result<_>>()?;
    let mesh = |(shape, side): (&ShapeFile, &MappedSurface)| MeshJson {
        name: shape.name.clone(),
        path: shape.path.clone(),
        n_vertices: side.surface().n_input_vertices(),
    };
    let json = CollectionJson {
        meshes: shapes.iter().zip(&mapped).map(mesh).collect(),
        pairs,
        cycles: found.cycles,
        seconds: SecondsJson::new(mapped.iter(), found.seconds),
    };
    report(common, &json, table)
}

/// Refuses what several meshes cannot have, before any work is done.
fn check(shapes: &[ShapeFile], args: &MatchArgs) -> Result<()> {
    let given = [
        ("--landmarks", args.landmarks.is_some()),
        ("--initial", args.initial.is_some()),
        ("--transfer", args.transfer.is_some()),
        ("--functional", args.functional.is_some()),
        ("--points", args.points),
    ];
    if let Some((flag, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
        bail!("{flag} is for two meshes, but there are {}; name two of them", shapes.len());
    }
    for (i, shape) in shapes.iter().enumerate() {
        if let Some(other) = shapes[..i].iter().find(|other| other.name == shape.name) {
            bail!(
                "{} and {} have the same name, which names their maps; rename one of them",
                other.path.display(),
                shape.path.display()
            );
        }
    }
    match &args.output {
        Some(folder) if folder.exists() && !folder.is_dir() => {
            bail!("{} is a file; with three or more meshes, -o names a folder", folder.display())
        }
        Some(folder) if folder.extension().is_some() && !folder.exists() => bail!(
            "{} looks like a file; with three or more meshes, -o names a folder, and --output-format the files in it",
            folder.display()
        ),
        _ => Ok(()),
    }
}

fn table(json: &CollectionJson) -> String {
    let mut table = table_of(["a", "b", "map", "distortion", "confidence", "alone"]);
    for PairJson { a, b, map, agreed, .. } in &json.pairs {
        let (distortion, confidence) = (format!("{:.4}", map.distortion), format!("{:.2}", map.confidence));
        let alone = if *agreed { "agreed" } else { "replaced" };
        table.add_row(row_of([a.as_str(), b, map.kind.name(), &distortion, &confidence, alone]));
    }
    let CycleReport { n_cycles, before, after } = json.cycles;
    format!(
        "{table}\ncycles of three: {n_cycles}, mean error {before:.4} before and {after:.4} after the maps agree"
    )
}
