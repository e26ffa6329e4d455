//! Maps of two meshes.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use base::terminal::Bars;
use canonform::Error;
use canonform::descriptors::Side;
use canonform::maps::{MappedSurface, PartOfWhole, PointMap, VertexMap, correspond, score_map};
use canonform::mesh::InputPoint;
use canonform::settings::MethodSettings;
use serde::Serialize;

use super::files::{
    DOUBTFUL, FunctionalJson, MappedFile, Pictured, SecondsJson, beside, write_colored, write_functional,
    write_table,
};
use super::known;
use super::transfer::{Transferred, read_transfer};
use crate::args::{Common, MAP_FORMATS, MatchArgs};
use crate::input::{named, read_pair};
use crate::output::{check_format, check_output, facts, report};

#[derive(Serialize)]
struct MatchJson {
    a: PathBuf,
    b: PathBuf,
    n_vertices: [usize; 2],
    maps: Vec<MapJson>,
    /// The second mesh in the colours that the first map carries to it.
    target: Option<PathBuf>,
    /// The first mesh in its colours.
    source: Option<PathBuf>,
    /// What was carried to the second mesh.
    transfer: Option<Transferred>,
    functional: Option<FunctionalJson>,
    seconds: SecondsJson,
}

#[derive(Serialize)]
struct MapJson {
    #[serde(flatten)]
    map: VertexMap,
    /// Vertices of the first mesh that have a partner.
    matched: usize,
    /// The share of them with a confidence below one half.
    doubtful: f64,
    path: Option<PathBuf>,
    /// The picture beside a mesh in colours.
    picture: Option<PathBuf>,
    /// The file of the alternative.
    alternative_path: Option<PathBuf>,
    /// With `--points`, the point inside a face of every vertex.
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<Option<InputPoint>>>,
}

/// Maps the vertices of one mesh to those of another.
pub(crate) fn match_meshes(args: &MatchArgs, common: &Common) -> Result<ExitCode> {
    let mut options = args.maps.options(args.form.options(&MethodSettings::default(), common)?);
    let format = match &args.output {
        Some(path) => {
            for path in [
                path.clone(),
                beside(path, "source"),
                beside(path, "alternative"),
                path.with_extension("png"),
            ] {
                check_output(&path)?;
            }
            Some(check_format(path, "a map", &MAP_FORMATS)?)
        }
        None => None,
    };
    if let Some(path) = &args.functional {
        check_output(path)?;
        check_format(path, "a functional map", &["npy"])?;
    }
    let prepared = &options;
    let [a, b] = read_pair(&args.pair, &args.form.repair, &args.limits, common, |_, mesh, surface, bars| {
        Ok(MappedFile { mesh, mapped: MappedSurface::new(surface, prepared, bars)? })
    })?;
    options.known = known::read(args, [a.mapped.surface(), b.mapped.surface()])?;
    let carried = args.transfer.as_deref().map(|path| read_transfer(path, &a)).transpose()?;
    let bars = Bars::with_budget(common.quiet, args.limits.budget());
    let search = if args.score { score_map } else { correspond };
    let found = search(&a.mapped, &b.mapped, &options, &bars);
    let found = match (found, &args.landmarks) {
        (Err(fault @ Error::ContradictoryLandmarks { .. }), Some(path)) => return Err(named(path, fault)),
        (found, _) => found?,
    };
    let sides = [&a, &b];
    let functional = match (&args.functional, found.maps.first()) {
        (Some(path), Some(map)) => Some(write_functional(path, map, sides)?),
        _ => None,
    };
    let transfer = match (&carried, &args.output, found.maps.first()) {
        (Some(carried), Some(path), Some(map)) => Some(carried.write(path, map, sides)?),
        _ => None,
    };
    let is_ply = format.as_deref() == Some("ply") && transfer.is_none();
    let target = args.output.clone().filter(|_| is_ply);
    let source = target.as_deref().map(|path| beside(path, "source"));
    // What was transferred took the place of the maps.
    let output = args.output.as_deref().filter(|_| transfer.is_none()).zip(format.as_deref());
    let maps = found.maps.into_iter().enumerate();
    let maps = maps.map(|(i, map)| written(i, map, args.points, output, sides)).collect::<Result<_>>()?;
    let json = MatchJson {
        a: args.pair.a.clone(),
        b: args.pair.b.clone(),
        n_vertices: [a.mesh.n_vertices(), b.mesh.n_vertices()],
        maps,
        target,
        source,
        transfer,
        functional,
        seconds: SecondsJson::new(sides, found.seconds),
    };
    report(common, &json, table)
}

/// Writes one of the maps, and its alternative, unless there is no output.
fn written(
    i: usize,
    map: VertexMap,
    with_points: bool,
    output: Option<(&Path, &str)>,
    sides: [&MappedFile; 2],
) -> Result<MapJson> {
    let (path, format) = output.unzip();
    let path = path.map(|path| match i {
        0 => path.to_owned(),
        _ => beside(path, map.kind.name()),
    });
    let points_of = |map: &VertexMap| {
        with_points.then(|| map.between(sides.map(|side| &side.mapped)).vertices(Side::First))
    };
    let points = points_of(&map);
    let mut picture = None;
    let mut alternative_path = None;
    if let (Some(path), Some(format)) = (&path, format) {
        picture = write(path, format, &map, points.as_ref(), sides)?;
        if format == "ply" && i == 0 {
            let Pictured { source, .. } = Pictured::new(&map, sides);
            let path = beside(path, "source");
            write_colored(&path, &sides[0].mesh, "confidence", &map.vertex_confidence, &source)?;
        }
        if let Some(other) = &map.alternative {
            let path = beside(path, "alternative");
            write(&path, format, other, points_of(other).as_ref(), sides)?;
            alternative_path = Some(path);
        }
    }
    let matched = map.vertices.iter().flatten().count();
    let partners = map.vertices.iter().zip(&map.vertex_confidence);
    let doubtful = partners.filter(|(v, confidence)| v.is_some() && **confidence < DOUBTFUL).count();
    let points = points.map(|map| map.points.iter().map(|point| point.map(|p| p.point())).collect());
    let doubtful = doubtful as f64 / matched.max(1) as f64;
    Ok(MapJson { matched, doubtful, map, path, picture, alternative_path, points })
}

/// Writes one map; returns the picture beside a mesh in colours.
fn write(
    path: &Path,
    format: &str,
    map: &VertexMap,
    points: Option<&PointMap>,
    sides: [&MappedFile; 2],
) -> Result<Option<PathBuf>> {
    let meshes = sides.map(|side| &side.mesh);
    match format {
        "ply" => {
            let pictured = Pictured::new(map, sides);
            pictured.write_target(path, meshes[1])?;
            let picture = path.with_extension("png");
            pictured.write_picture(&picture, meshes)?;
            Ok(Some(picture))
        }
        "png" => Pictured::new(map, sides).write_picture(path, meshes).map(|()| None),
        _ => write_table(path, format, map, points).map(|()| None),
    }
}

fn table(json: &MatchJson) -> String {
    let mut rows = Vec::new();
    for MapJson { map, matched, doubtful, path, alternative_path, .. } in &json.maps {
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
        let mut confidence = format!("{:.2}", map.confidence);
        if map.alternative.is_some() {
            let how = if map.is_certain() { "likely" } else { "uncertain" };
            confidence += &format!(": {how}; the next best map may exchange front and back{other}");
        }
        rows.push(("  confidence", confidence));
        rows.push(("  doubtful", format!("{:.1} % of the vertices", 100.0 * doubtful)));
    }
    let files = [("target", &json.target), ("source", &json.source)];
    rows.extend(
        files.into_iter().filter_map(|(name, path)| Some((name, path.as_ref()?.display().to_string()))),
    );
    if let Some(picture) = json.maps.first().and_then(|map| map.picture.as_ref()) {
        rows.push(("picture", picture.display().to_string()));
    }
    if let Some(transfer) = &json.transfer {
        rows.push(("transfer", transfer.to_string()));
    }
    if let Some(functional) = &json.functional {
        rows.push(("functional map", functional.to_string()));
    }
    facts(&rows)
}
