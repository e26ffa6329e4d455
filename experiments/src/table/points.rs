//! Points: surfaces of some shapes of every class are scanned, with and without noise, and triangulated. Distances are
//! compared with those on the mesh, and the shape is searched for in the collection of meshes without itself.
//!
//! Measures `NOISE, N points, error|bias|nn`: the mean relative error of the distances, the same with its sign, and the share of
//! queries whose nearest has their class; `least nn`.

use std::fmt;

use anyhow::{Context as _, Result};
use canonform::{DescribeOptions, ShapeDescription, Surface, describe};
use datasets::scan;
use descriptors::ShapeMetric;
use geodesics::{Method, Source, SurfacePoint};
use mesh::TriMesh;
use report::results::{CurvesPanel, CurvesResults, Series};
use retrieval::{Labels, rank_row};
use surface::VertexId;

use crate::collection::{Shape, map};
use crate::context::Context;
use crate::sweep::{Measured, linear, panel, point};

const COUNTS: [usize; 2] = [10_000, 50_000];

/// Points from which distances are measured.
const SOURCES: usize = 10;

/// Standard deviation of the noise of a coordinate.
#[derive(Debug, Clone, Copy)]
enum Noise {
    /// As a share of the square root of the area.
    OfArea(f64),
    /// As a share of the diagonal of the bounding box.
    OfDiagonal(f64),
}

const NOISES: [Noise; 5] = [
    Noise::OfArea(0.0),
    Noise::OfArea(0.0025),
    Noise::OfArea(0.005),
    Noise::OfArea(0.01),
    Noise::OfDiagonal(0.01),
];

impl Noise {
    fn deviation(self, mesh: &TriMesh) -> f64 {
        match self {
            Self::OfArea(share) => share * mesh.root_of_area(),
            Self::OfDiagonal(share) => share * mesh.bounds().map_or(0.0, |[low, high]| (high - low).norm()),
        }
    }
}

impl fmt::Display for Noise {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OfArea(share) => write!(f, "{} % of sqrt(area)", 100.0 * share),
            Self::OfDiagonal(share) => write!(f, "{} % of the diagonal", 100.0 * share),
        }
    }
}

/// What was found for one cloud.
struct Found {
    error: f64,
    bias: f64,
    is_top1: bool,
}

pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let options = DescribeOptions::default();
    let all = context.collection.all();
    let described =
        map(&all, "describing", context.observer, |shape| Ok(describe(&shape.surface, &options)?))?;
    let labels = Labels::new(&context.collection.labels());
    let queries = context.collection.first_of_each_class(context.config.queries);
    let mut measured = Measured::new();
    let mut least = f64::INFINITY;
    let mut rows = Vec::new();
    for noise in NOISES {
        for n in COUNTS {
            let name = format!("{noise}, {} points", thousands(n));
            let found = map(&queries, &name, context.observer, |shape| {
                let own = all.iter().position(|other| other.name == shape.name);
                let own = own.context("a shape of the collection")?;
                let cloud = Cloud::new(shape, n, noise, context.seed + own as u64)?;
                let (error, bias) = cloud.errors()?;
                let query = describe(&cloud.surface, &options)?;
                let is_top1 = is_top1(&described, &query, own, &labels);
                Ok(Found { error, bias, is_top1 })
            })?;
            let mean = |value: &dyn Fn(&Found) -> f64| {
                found.iter().map(value).sum::<f64>() / found.len().max(1) as f64
            };
            let nn = mean(&|found| f64::from(u8::from(found.is_top1)));
            let error = mean(&|found| found.error);
            measured.insert(format!("{name}, error"), error);
            measured.insert(format!("{name}, bias"), mean(&|found| found.bias));
            measured.insert(format!("{name}, nn"), nn);
            least = least.min(nn);
            rows.push((noise, n, error, nn));
        }
    }
    measured.insert("least nn".to_owned(), least);
    let caption = format!(
        "Distances between points of {} scanned shapes, beside those on their meshes, and their nearest of the {} other meshes, \
         by noise as a share of the square root of the area.",
        queries.len(),
        all.len()
    );
    let provenance = context.provenance(serde_json::json!({ "description": options.text() }));
    context.publish(CurvesResults { caption, panels: panels(&rows) }, provenance, &measured)
}

/// Whether the nearest shape, itself left out, is of the same class.
fn is_top1(all: &[ShapeDescription], query: &ShapeDescription, own: usize, labels: &Labels) -> bool {
    let distances: Vec<f64> =
        all.iter().map(|shape| ShapeMetric::robust(&query.fused, &shape.fused)).collect();
    let first = rank_row(&distances, own).first().copied();
    first.is_some_and(|first| labels.class(first.index) == labels.class(own))
}

/// A scanned shape.
struct Cloud<'a> {
    shape: &'a Shape,
    scanned: Vec<datasets::ScannedPoint>,
    surface: Surface,
}

impl<'a> Cloud<'a> {
    fn new(shape: &'a Shape, n: usize, noise: Noise, seed: u64) -> Result<Self> {
        let mesh = shape.surface.mesh();
        let scanned = scan(mesh, n, noise.deviation(mesh), seed);
        let positions = scanned.iter().map(|point| point.position).collect();
        let points = TriMesh { positions, faces: Vec::new() };
        let surface = Surface::new(&points, &shape.surface.repair)?;
        Ok(Self { shape, scanned, surface })
    }

    /// The mean relative error of distances between points, and the same with its sign. Points that were left out are not
    /// counted.
    fn errors(&self) -> Result<(f64, f64)> {
        let reference = Method::Exact.prepare(&self.shape.surface.intrinsic)?;
        let solver = Method::default().prepare(&self.surface.intrinsic)?;
        let faces = &self.shape.surface.mesh().faces;
        let (mut error, mut bias, mut count) = (0.0, 0.0, 0.0);
        let step = self.scanned.len() / SOURCES;
        for i in (0..SOURCES).map(|i| i * step) {
            let Ok(source) = self.surface.repaired_vertex(VertexId::from(i)) else { continue };
            let on_mesh =
                SurfacePoint::Face { face: self.scanned[i].face, barycentric: self.scanned[i].barycentric };
            let mut exact = vec![f64::INFINITY; reference.n_vertices()];
            let start = Source::new(&self.shape.surface.intrinsic, on_mesh)?;
            reference.solve_into(&[start], f64::INFINITY, &mut exact)?;
            let found = solver.distances(source)?;
            for (j, point) in self.scanned.iter().enumerate() {
                let Ok(target) = self.surface.repaired_vertex(VertexId::from(j)) else { continue };
                if point.face == self.scanned[i].face {
                    continue;
                }
                let corners = faces[point.face.index()];
                let expected: f64 =
                    corners.iter().zip(point.barycentric).map(|(v, b)| b * exact[v.index()]).sum();
                let relative = found[target.index()] / expected - 1.0;
                error += relative.abs();
                bias += relative;
                count += 1.0;
            }
        }
        Ok((error / count, bias / count))
    }
}

/// `10,000`.
fn thousands(n: usize) -> String {
    format!("{},{:03}", n / 1000, n % 1000)
}

/// Noise, number of points, error of distances, and share of queries whose nearest has their class.
type Row = (Noise, usize, f64, f64);

fn panels(rows: &[Row]) -> Vec<CurvesPanel> {
    let of = |title: &str, value: &dyn Fn(&Row) -> f64| {
        let series = COUNTS.map(|n| {
            let at = |row: &Row| match row.0 {
                Noise::OfArea(share) if row.1 == n => Some(point(100.0 * share, &[value(row)])),
                _ => None,
            };
            Series { name: format!("{} points", thousands(n)), points: rows.iter().filter_map(at).collect() }
        });
        panel(title.to_owned(), linear("noise, % of sqrt(area)"), linear(title), series.into())
    };
    vec![of("mean relative error", &|row| row.2), of("NN", &|row| row.3)]
}
