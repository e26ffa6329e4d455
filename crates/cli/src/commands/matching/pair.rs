//! Maps of two meshes.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use base::object;
use base::terminal::Bars;
use canonform::Error;
use canonform::descriptors::Side;
use canonform::maps::{MappedSurface, Mapping, PartOfWhole, PointMap, SurfaceMap, correspond, score_map};
use canonform::mesh::InputPoint;
use canonform::mesh::io::{VertexField, write_scalar_field};
use canonform::settings::MethodSettings;
use serde::Serialize;

use super::files::{
    DOUBTFUL, MappedFile, beside_mesh, corresponding, picture, write_functional, write_table,
};
use super::known;
use super::transfer::read_transfer;
use crate::args::{Common, MAP_FORMATS, MatchArgs, VALUE_FORMATS};
use crate::input::{named, read_pair};
use crate::output::{Fact, beside, check_output, facts, report};

#[derive(Serialize)]
struct MapJson {
    #[serde(flatten)]
    map: SurfaceMap,
    /// Vertices of the first mesh that have a partner.
    matched: usize,
    /// The share of them with a confidence below one half.
    doubtful: f64,
    path: Option<PathBuf>,
    /// The picture beside a mesh in colors.
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
    let checked = |path: &PathBuf| {
        let others = [beside(path, "source"), beside(path, "alternative"), beside_mesh(path)];
        others.iter().try_for_each(|path| check_output(path, "a map", &[]).map(drop))?;
        match args.transfer {
            Some(_) => check_output(path, "values", &VALUE_FORMATS),
            None => check_output(path, "a map", &MAP_FORMATS),
        }
    };
    let format = args.output.as_ref().map(checked).transpose()?;
    if let Some(path) = &args.functional {
        check_output(path, "a functional map", &["npy"])?;
    }
    let prepared = &options;
    let [a, b] = read_pair(&args.pair, &args.form.repair, &args.limits, common, |_, mesh, surface, bars| {
        Ok(MappedFile { mesh, mapped: MappedSurface::new(surface, prepared, bars)? })
    })?;
    options.known = known::read(args, [a.mapped.surface(), b.mapped.surface()])?;
    let transfer = args.transfer.as_deref().zip(args.output.as_deref());
    let carried = transfer.map(|(path, output)| read_transfer(path, &a, output)).transpose()?;
    let bars = Bars::with_budget(common.quiet, args.limits.budget());
    let search = if args.score { score_map } else { correspond };
    let found = search(&a.mapped, &b.mapped, &options, &bars);
    let found = match (found, &args.landmarks) {
        (Err(fault @ Error::ContradictoryLandmarks { .. }), Some(path)) => return Err(named(path, fault)),
        (found, _) => found?,
    };
    let sides = [&a, &b];
    let first = found.maps.first();
    let functional = args.functional.as_deref().zip(first);
    let functional = functional.map(|(path, map)| write_functional(path, map, sides)).transpose()?;
    let (functional, functional_words) = functional.unzip();
    let transfer = carried.zip(args.output.as_deref()).zip(first);
    let transfer = transfer.map(|((carried, path), map)| carried.write(path, map, sides)).transpose()?;
    let (transfer, transfer_words) = transfer.unzip();
    // What was transferred took the place of the maps.
    let output = args.output.as_deref().filter(|_| transfer.is_none()).zip(format.as_deref());
    let target = output.filter(|(_, format)| *format == "ply").map(|(path, _)| path);
    let maps = found.maps.into_iter().enumerate();
    let maps = maps.map(|(i, map)| written(i, map, args.points, output, sides));
    let maps = maps.collect::<Result<Vec<MapJson>>>()?;
    let load = |side: &MappedFile| {
        let input = &side.mapped.surface().input;
        input.load_seconds + input.repair_seconds
    };
    let (load, prepare) = (load(&a) + load(&b), a.mapped.seconds + b.mapped.seconds);
    let json = object! {
        a: &args.pair.a,
        b: &args.pair.b,
        n_vertices: sides.map(|side| side.mesh.n_vertices()),
        maps,
        // The second mesh in the colors that the first map carries to it.
        target,
        // The first mesh in its colors.
        source: target.map(|path| beside(path, "source")),
        // What was carried to the second mesh.
        transfer,
        functional,
        seconds: object! { load, prepare, matching: found.seconds, total: load + prepare + found.seconds },
    };
    report(common, &json, |json| {
        let mut rows: Vec<Fact> = json.maps.iter().flat_map(in_words).collect();
        let files = [("target", json.target), ("source", json.source.as_deref())];
        let picture = json.maps.first().and_then(|map| map.picture.as_deref());
        let files = files.into_iter().chain([("picture", picture)]);
        rows.extend(files.filter_map(|(name, path)| Some((name, path?.display().to_string()))));
        rows.extend(transfer_words.map(|words| ("transfer", words)));
        rows.extend(functional_words.map(|words| ("functional map", words)));
        facts(&rows)
    })
}

/// Writes one of the maps, and its alternative, unless there is no output.
fn written(
    i: usize,
    map: SurfaceMap,
    with_points: bool,
    output: Option<(&Path, &str)>,
    sides: [&MappedFile; 2],
) -> Result<MapJson> {
    let points_of = |map: &SurfaceMap| {
        with_points.then(|| Mapping::new(map, sides.map(|side| &side.mapped)).vertices(Side::First))
    };
    let points = points_of(&map);
    let (mut path, mut picture, mut alternative_path) = (None, None, None);
    if let Some((given, format)) = output {
        let at = if i == 0 { given.to_owned() } else { beside(given, map.kind.name()) };
        picture = write(&at, format, &map, points.as_ref(), sides)?;
        if format == "ply" && i == 0 {
            let ([source, _], _) = corresponding(&map, sides);
            let field = VertexField { name: "confidence", values: &map.vertex_confidence, colors: &source };
            write_scalar_field(&beside(&at, "source"), &sides[0].mesh, &field)?;
        }
        if let Some(other) = &map.alternative {
            let at = beside(&at, "alternative");
            write(&at, format, other, points_of(other).as_ref(), sides)?;
            alternative_path = Some(at);
        }
        path = Some(at);
    }
    let matched = map.vertices.iter().flatten().count();
    let partners = map.vertices.iter().zip(&map.vertex_confidence);
    let doubtful = partners.filter(|(v, confidence)| v.is_some() && **confidence < DOUBTFUL).count();
    let points = points.map(|map| map.points.iter().map(|point| point.map(|p| p.point())).collect());
    let doubtful = doubtful as f64 / matched.max(1) as f64;
    Ok(MapJson { matched, doubtful, map, path, picture, alternative_path, points })
}

/// Writes one map; returns the picture beside a mesh in colors.
fn write(
    path: &Path,
    format: &str,
    map: &SurfaceMap,
    points: Option<&PointMap>,
    sides: [&MappedFile; 2],
) -> Result<Option<PathBuf>> {
    if !["ply", "png"].contains(&format) {
        return write_table(path, format, map, points).map(|()| None);
    }
    let meshes = sides.map(|side| &side.mesh);
    let (colors, origins) = corresponding(map, sides);
    if format == "png" {
        return picture(path, meshes, colors).map(|()| None);
    }
    let field = VertexField { name: "match", values: &origins, colors: &colors[1] };
    write_scalar_field(path, meshes[1], &field)?;
    let drawn = beside_mesh(path);
    picture(&drawn, meshes, colors)?;
    Ok(Some(drawn))
}

fn in_words(json: &MapJson) -> Vec<Fact> {
    let MapJson { map, matched, doubtful, path, alternative_path, .. } = json;
    let place = |path: &Option<PathBuf>| {
        path.as_ref().map_or_else(String::new, |path| format!(", in {}", path.display()))
    };
    let mut rows = vec![(map.kind.name(), format!("{matched} vertices{}", place(path)))];
    if let Some(PartOfWhole { part, covered, .. }) = &map.part {
        let [part, whole] = if *part == Side::First { ["first", "second"] } else { ["second", "first"] };
        rows.push(("  part", format!("the {part} mesh, of {:.0} % of the {whole}", 100.0 * covered)));
    }
    rows.push(("  distortion", format!("{:.4}", map.distortion)));
    let agreement = map.agreement.map_or("cannot be told".to_owned(), |value| format!("{value:.2}"));
    rows.push(("  agreement", agreement));
    let mut confidence = format!("{:.2}", map.confidence);
    if map.alternative.is_some() {
        let (how, other) = (if map.is_certain() { "likely" } else { "uncertain" }, place(alternative_path));
        confidence += &format!(": {how}; the next best map may exchange front and back{other}");
    }
    rows.push(("  confidence", confidence));
    rows.push(("  doubtful", format!("{:.1} % of the vertices", 100.0 * doubtful)));
    rows
}
