//! Files of maps.

use std::path::{Path, PathBuf};

use anyhow::Result;
use base::object;
use canonform::descriptors::Side;
use canonform::linalg::Matrix;
use canonform::maps::{MappedSurface, Mapping, PointMap, SurfaceMap};
use canonform::mesh::TriMesh;
use canonform::mesh::io::without_extension;
use canonform::surface::VertexId;
use report::color::{Rgb, mix, perceptual, place_colors};
use report::render::{Coloring, RenderOptions, render};
use serde::Serialize;

use crate::output::beside;
use crate::table::{write_matrix, write_npy};

/// Below this confidence a vertex is counted as doubtful. In pictures, colors fade from half as much above it to gray at half of
/// it. A convention.
pub(super) const DOUBTFUL: f64 = 0.5;

/// A mesh as it was read, and prepared.
pub(super) struct MappedFile {
    pub(super) mesh: TriMesh,
    pub(super) mapped: MappedSurface,
}

/// The number of a partner.
pub(super) fn number(partner: &Option<VertexId>) -> i64 {
    partner.map_or(-1, |v| i64::from(v.0))
}

/// Writes a map as a table, `.npy` or `.csv`; with its points inside faces if they are given.
pub(super) fn write_table(
    path: &Path,
    format: &str,
    map: &SurfaceMap,
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
        (_, None) => write_npy(path, &[map.vertices.len()], map.vertices.iter().map(number)),
        (_, Some(points)) => {
            let row = |point: &Option<canonform::maps::FacePoint>| {
                point.map_or([-1.0, f64::NAN, f64::NAN, f64::NAN], |point| {
                    let [u, v, w] = point.weights;
                    [f64::from(point.face.0), u, v, w]
                })
            };
            write_npy(path, &[points.points.len(), 4], points.points.iter().flat_map(row))
        }
    }
}

/// Colors of the first mesh by its place in the canonical form, fading to gray where the map is doubtful; the same colors,
/// carried to the second mesh; and for every vertex of that, the vertex of the first whose color it has, or -1.
pub(super) fn corresponding(map: &SurfaceMap, [a, b]: [&MappedFile; 2]) -> ([Vec<Rgb>; 2], Vec<f64>) {
    let gray = perceptual(f64::NAN);
    let surface = a.mapped.surface();
    let colors = surface.in_input_order(&place_colors(a.mapped.shape.form_points()), gray);
    let faded =
        |(color, confidence): (&Rgb, &f64)| mix(*color, gray, (1.5 - confidence / DOUBTFUL).clamp(0.0, 1.0));
    let source: Vec<Rgb> = colors.iter().zip(&map.vertex_confidence).map(faded).collect();
    let places = Mapping::new(map, [&a.mapped, &b.mapped]).vertices(Side::Second);
    let (target, origins) = carried(&places, &source);
    ([source, target], origins)
}

/// Colors of the vertices of one mesh at the places of the other one's vertices, and the nearest vertices.
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

/// The picture beside a mesh in colors.
pub(super) fn beside_mesh(path: &Path) -> PathBuf {
    let mut name = without_extension(path).into_os_string();
    name.push(".png");
    name.into()
}

/// Writes a picture of two meshes in colors.
pub(super) fn picture(path: &Path, meshes: [&TriMesh; 2], colors: [Vec<Rgb>; 2]) -> Result<()> {
    let drawn = |mesh: &TriMesh, colors: Vec<Rgb>| {
        let coloring = Coloring::Colors(colors);
        render(mesh, &RenderOptions { coloring, ..RenderOptions::default() }, &())
    };
    let ([left, right], [a, b]) = (meshes, colors);
    Ok(drawn(left, a)?.beside(&drawn(right, b)?).write_png(path)?)
}

/// Writes the matrix of a functional map, and the eigenfunctions of both meshes, scaled to unit area, beside it as columns. What
/// was written, and the same in words.
pub(super) fn write_functional(
    path: &Path,
    map: &SurfaceMap,
    sides: [&MappedFile; 2],
) -> Result<(impl Serialize + use<>, String)> {
    let counts = [map.functional.nrows(), map.functional.ncols()];
    write_matrix(path, &map.functional)?;
    let eigenfunctions = ["a", "b"].map(|name| beside(path, name));
    let mut eigenvalues = Vec::new();
    for ((side, path), k) in sides.iter().zip(&eigenfunctions).zip(counts) {
        let spectrum = side.mapped.shape.spectrum();
        let vectors = spectrum.vectors.columns(0, k);
        let remap = &side.mapped.surface().input.remap;
        let rows = Matrix::from_fn(remap.n_old(), k, |i, j| {
            remap.to_new(i.into()).map_or(f64::NAN, |v| vectors[(v.index(), j)])
        });
        write_matrix(path, &rows)?;
        eigenvalues.push(spectrum.values[..k].to_vec());
    }
    let [rows, columns] = counts;
    let [a, b] = eigenfunctions.each_ref().map(|path| path.display());
    let words = format!("{rows} x {columns}, in {}; eigenfunctions in {a} and {b}", path.display());
    Ok((object! { path: path.to_owned(), eigenfunctions, eigenvalues }, words))
}
