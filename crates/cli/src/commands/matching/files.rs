//! Files of maps.

use std::io::BufWriter;
use std::path::{Path, PathBuf};

use anyhow::Result;
use canonform::descriptors::Side;
use canonform::linalg::Matrix;
use canonform::maps::{MappedSurface, PointMap, VertexMap};
use canonform::mesh::TriMesh;
use canonform::mesh::io::VertexField;
use canonform::surface::VertexId;
use npyz::WriterBuilder;
use report::color::{Rgb, mix, perceptual, place_colors};
use report::render::{Coloring, RenderOptions, render};
use serde::Serialize;

use crate::output::write_npy;

/// Below this confidence a vertex is counted as doubtful. In pictures, colours fade from half as much above it to grey at half of
/// it. A convention.
pub(super) const DOUBTFUL: f64 = 0.5;

/// A mesh as it was read, and prepared.
pub(super) struct MappedFile {
    pub(super) mesh: TriMesh,
    pub(super) mapped: MappedSurface,
}

/// How long the parts of the work took.
#[derive(Serialize)]
pub(super) struct SecondsJson {
    load: f64,
    prepare: f64,
    matching: f64,
    total: f64,
}

impl SecondsJson {
    /// Of meshes that were read and prepared, and then mapped in `matching` seconds.
    pub(super) fn new(sides: [&MappedFile; 2], matching: f64) -> Self {
        let surfaces = sides.map(|side| side.mapped.surface());
        let load =
            surfaces.iter().map(|surface| surface.input.load_seconds + surface.input.repair_seconds).sum();
        let prepare = sides.iter().map(|side| side.mapped.seconds).sum();
        Self { load, prepare, matching, total: load + prepare + matching }
    }
}

/// The path of a further file: `map-mirrored.npy` beside `map.npy`.
pub(super) fn beside(path: &Path, what: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{what}.{extension}"))
}

/// The number of a partner.
pub(super) fn number(partner: &Option<VertexId>) -> i64 {
    partner.map_or(-1, |v| i64::from(v.0))
}

/// Writes whole numbers as a NumPy array.
pub(super) fn write_whole(path: &Path, numbers: &[i64]) -> Result<()> {
    Ok(base::files::write_atomically(path, |out| {
        let shape = [numbers.len() as u64];
        let out = BufWriter::new(out);
        let mut array = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(out).begin_nd()?;
        array.extend(numbers)?;
        array.finish()
    })?)
}

/// Writes a map as a table, `.npy` or `.csv`; with its points inside faces if they are given.
pub(super) fn write_table(
    path: &Path,
    format: &str,
    map: &VertexMap,
    points: Option<&PointMap>,
) -> Result<()> {
    match (format, points) {
        ("csv", _) => {
            let names = if points.is_some() { ",face,w0,w1,w2" } else { "" };
            Ok(base::files::write_atomically(path, |out| {
                writeln!(out, "vertex,match,confidence{names}")?;
                for (x, (y, confidence)) in map.vertices.iter().zip(&map.vertex_confidence).enumerate() {
                    write!(out, "{x},{},{confidence:.4}", number(y))?;
                    match points.map(|points| points.points[x]) {
                        None => writeln!(out)?,
                        Some(None) => writeln!(out, ",-1,,,")?,
                        Some(Some(point)) => {
                            let [u, v, w] = point.weights;
                            writeln!(out, ",{},{u},{v},{w}", point.face)?;
                        }
                    }
                }
                Ok(())
            })?)
        }
        (_, None) => write_whole(path, &map.vertices.iter().map(number).collect::<Vec<_>>()),
        (_, Some(points)) => {
            let row = |point: &Option<canonform::maps::FacePoint>| {
                point.map_or([-1.0, f64::NAN, f64::NAN, f64::NAN], |point| {
                    let [u, v, w] = point.weights;
                    [f64::from(point.face.0), u, v, w]
                })
            };
            let rows: Vec<[f64; 4]> = points.points.iter().map(row).collect();
            write_npy(path, 4, rows.iter().map(|row| &row[..]))
        }
    }
}

/// Two meshes in corresponding colours.
pub(super) struct Pictured {
    /// Colours of the first mesh by its place in the canonical form, fading to grey where the map is doubtful.
    pub(super) source: Vec<Rgb>,
    /// The same colours, carried to the second mesh.
    pub(super) target: Vec<Rgb>,
    /// For every vertex of the second mesh, the vertex of the first whose colour it has, or -1.
    pub(super) origins: Vec<f64>,
}

impl Pictured {
    pub(super) fn new(map: &VertexMap, [a, b]: [&MappedFile; 2]) -> Self {
        let grey = perceptual(f64::NAN);
        let surface = a.mapped.surface();
        let colors = surface.in_input_order(&place_colors(a.mapped.shape.form_points()), grey);
        let faded = |(color, confidence): (&Rgb, &f64)| {
            mix(*color, grey, (1.5 - confidence / DOUBTFUL).clamp(0.0, 1.0))
        };
        let source: Vec<Rgb> = colors.iter().zip(&map.vertex_confidence).map(faded).collect();
        let places = map.between([&a.mapped, &b.mapped]).vertices(Side::Second);
        let (target, origins) = carried(&places, &source);
        Self { source, target, origins }
    }

    /// Writes the second mesh in colours.
    pub(super) fn write_target(&self, path: &Path, mesh: &TriMesh) -> Result<()> {
        write_colored(path, mesh, "match", &self.origins, &self.target)
    }

    /// Writes a picture of both.
    pub(super) fn write_picture(&self, path: &Path, meshes: [&TriMesh; 2]) -> Result<()> {
        picture(path, meshes, [self.source.clone(), self.target.clone()])
    }
}

/// Colours of the vertices of one mesh at the places of the other one's vertices, and the nearest vertices.
fn carried(places: &PointMap, colors: &[Rgb]) -> (Vec<Rgb>, Vec<f64>) {
    let channels = Matrix::from_fn(colors.len(), 3, |i, j| f64::from(colors[i][j]));
    let found = places.values(&channels);
    let color = |i: usize| match places.points[i] {
        Some(_) => [0, 1, 2].map(|j| found[(i, j)].round() as u8),
        None => perceptual(f64::NAN),
    };
    let nearest = places.points.iter();
    let nearest = nearest.map(|point| point.map_or(-1.0, |point| f64::from(point.nearest_corner().0)));
    ((0..places.points.len()).map(color).collect(), nearest.collect())
}

/// Writes a mesh in colours.
pub(super) fn write_colored(
    path: &Path,
    mesh: &TriMesh,
    name: &str,
    values: &[f64],
    colors: &[Rgb],
) -> Result<()> {
    Ok(canonform::mesh::io::write_scalar_field(path, mesh, &VertexField { name, values, colors })?)
}

/// Writes a picture of two meshes in colours.
pub(super) fn picture(path: &Path, meshes: [&TriMesh; 2], colors: [Vec<Rgb>; 2]) -> Result<()> {
    let drawn = |mesh: &TriMesh, colors: Vec<Rgb>| {
        let coloring = Coloring::Colors(colors);
        render(mesh, &RenderOptions { coloring, ..RenderOptions::default() }, &())
    };
    let ([left, right], [a, b]) = (meshes, colors);
    Ok(drawn(left, a)?.beside(&drawn(right, b)?).write_png(path)?)
}

/// A functional map and the functions that it is written in.
#[derive(Serialize)]
pub(super) struct FunctionalJson {
    /// The matrix.
    path: PathBuf,
    /// Eigenfunctions at the vertices of both meshes, scaled to unit area, as columns.
    eigenfunctions: [PathBuf; 2],
    /// Their eigenvalues.
    eigenvalues: [Vec<f64>; 2],
}

impl std::fmt::Display for FunctionalJson {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [a, b] = self.eigenfunctions.each_ref().map(|path| path.display());
        let [rows, columns] = self.eigenvalues.each_ref().map(Vec::len);
        write!(f, "{rows} x {columns}, in {}; eigenfunctions in {a} and {b}", self.path.display())
    }
}

/// Writes the matrix of a functional map, and the eigenfunctions of both meshes beside it.
pub(super) fn write_functional(
    path: &Path,
    map: &VertexMap,
    sides: [&MappedFile; 2],
) -> Result<FunctionalJson> {
    let counts = [map.functional.nrows(), map.functional.ncols()];
    write_matrix(path, &map.functional)?;
    let mut values = Vec::new();
    for ((side, name), k) in sides.iter().zip(["a", "b"]).zip(counts) {
        let spectrum = side.mapped.shape.spectrum();
        let vectors = spectrum.vectors.columns(0, k);
        let remap = &side.mapped.surface().input.remap;
        let rows = Matrix::from_fn(remap.n_old(), k, |i, j| {
            remap.to_new(i.into()).map_or(f64::NAN, |v| vectors[(v.index(), j)])
        });
        write_matrix(&beside(path, name), &rows)?;
        values.push(spectrum.values[..k].to_vec());
    }
    Ok(FunctionalJson {
        path: path.to_owned(),
        eigenfunctions: ["a", "b"].map(|name| beside(path, name)),
        eigenvalues: [0, 1].map(|side| values[side].clone()),
    })
}

fn write_matrix(path: &Path, matrix: &Matrix) -> Result<()> {
    let transposed = matrix.transpose();
    write_npy(path, matrix.ncols(), transposed.as_slice().chunks_exact(matrix.ncols().max(1)))
}
