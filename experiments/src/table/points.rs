//! Points: surfaces of some shapes of every class are scanned, with and without noise, and triangulated. Distances are
//! compared with those on the mesh, and the shape is searched for in the collection of meshes without itself.
//!
//! Noise moves points along the surface, too, which changes distances on the mesh itself. What it leaves of them is measured
//! between the points of the mesh that are nearest to the noisy ones.
//!
//! Measures `NOISE, N points, error|bias|moved|own|nn`: the mean relative error of the distances, the same with its sign; the
//! mean error of the distances on the mesh between the nearest points of noisy ones; the error beside distances on the
//! mesh between the points nearest to those of the surface; and the share of queries whose nearest has their class. Also
//! `least nn`.

use std::fmt;

use anyhow::{Context as _, Result};
use canonform::{DescribeOptions, ShapeDescription, Surface, describe};
use datasets::{ScannedPoint, scan};
use descriptors::{NearestPoints, ShapeMetric};
use geodesics::{Method, Source, SurfacePoint};
use mesh::TriMesh;
use nalgebra::Point3;
use report::results::{CurvesPanel, CurvesResults, Series};
use retrieval::{Labels, rank_row};
use surface::VertexId;

use crate::collection::{Shape, map};
use crate::context::Context;
use crate::sweep::{Measured, linear, panel, point};

const COUNTS: [usize; 2] = [10_000, 50_000];

/// Most queries of a class with more than the fewest points; describing them takes longest.
const QUERIES_OF_MANY: usize = 1;

/// Points from which distances are measured.
const SOURCES: usize = 5;

/// Points of the mesh among which the nearest ones are looked for. They are 0.25 % of the root of the area apart.
const ON_MESH: usize = 160_000;

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

    /// Numbers of points. Noise of a share of the diagonal is several spacings of many points, and slow to smooth.
    fn counts(self) -> &'static [usize] {
        match self {
            Self::OfArea(_) => &COUNTS,
            Self::OfDiagonal(_) => &COUNTS[..1],
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
    errors: Errors,
    is_top1: bool,
}

/// Mean relative errors of distances.
#[derive(Default)]
struct Errors {
    error: f64,
    /// The same with its sign.
    bias: f64,
    /// Of the mesh, between its points that are nearest to the noisy ones.
    moved: f64,
    /// Beside the mesh between its points that are nearest to those of the surface.
    own: f64,
}

pub(crate) fn run(context: &Context<'_>) -> Result<()> {
    let options = DescribeOptions::default();
    let all = context.collection.all();
    let described =
        map(&all, "describing", context.observer, |shape| Ok(describe(&shape.surface, &options)?))?;
    let labels = Labels::new(&context.collection.labels());
    let mut measured = Measured::new();
    let mut least = f64::INFINITY;
    let mut rows = Vec::new();
    for noise in NOISES {
        for n in noise.counts() {
            let name = format!("{noise}, {} points", thousands(*n));
            let most = if *n > COUNTS[0] { QUERIES_OF_MANY } else { usize::MAX };
            let queries = context.collection.first_of_each_class(context.config.queries.min(most));
            let found = map(&queries, &name, context.observer, |shape| {
                let own = all.iter().position(|other| other.name == shape.name);
                let own = own.context("a shape of the collection")?;
                let cloud = Cloud::new(shape, *n, noise, context.seed + own as u64)?;
                let errors = cloud.errors()?;
                let query = describe(&cloud.surface, &options)?;
                let is_top1 = is_top1(&described, &query, own, &labels);
                Ok(Found { errors, is_top1 })
            })?;
            let mean = |value: &dyn Fn(&Found) -> f64| {
                found.iter().map(value).sum::<f64>() / found.len().max(1) as f64
            };
            let nn = mean(&|found| f64::from(u8::from(found.is_top1)));
            let error = mean(&|found| found.errors.error);
            measured.insert(format!("{name}, error"), error);
            measured.insert(format!("{name}, bias"), mean(&|found| found.errors.bias));
            measured.insert(format!("{name}, moved"), mean(&|found| found.errors.moved));
            measured.insert(format!("{name}, own"), mean(&|found| found.errors.own));
            measured.insert(format!("{name}, nn"), nn);
            least = least.min(nn);
            rows.push((noise, *n, error, nn));
        }
    }
    measured.insert("least nn".to_owned(), least);
    let caption = format!(
        "Distances between points of up to {} scanned shapes of each class, beside those on their meshes, and their nearest of \
         the {} other meshes, by noise as a share of the square root of the area.",
        context.config.queries,
        all.len() - 1
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
    scanned: Vec<ScannedPoint>,
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

    /// The mean errors of distances between points. Points that were left out are not counted, nor are those of the
    /// face of the source.
    fn errors(&self) -> Result<Errors> {
        let mesh = self.shape.surface.mesh();
        let reference = Method::Exact.prepare(&self.shape.surface.intrinsic)?;
        let solver = Method::default().prepare(&self.surface.intrinsic)?;
        let exact = |from: &ScannedPoint| -> Result<Vec<f64>> {
            let mut distances = vec![f64::INFINITY; reference.n_vertices()];
            let at = SurfacePoint::Face { face: from.face, barycentric: from.barycentric };
            let start = Source::new(&self.shape.surface.intrinsic, at)?;
            reference.solve_into(&[start], f64::INFINITY, &mut distances)?;
            Ok(distances)
        };
        let to = |distances: &[f64], at: &ScannedPoint| -> f64 {
            let corners = mesh.faces[at.face.index()];
            corners.iter().zip(at.barycentric).map(|(v, b)| b * distances[v.index()]).sum()
        };
        let points: Vec<Triple> = self.triples()?;
        let (mut sum, mut count) = (Errors::default(), 0.0);
        for from in points.iter().step_by((points.len() / SOURCES).max(1)).take(SOURCES) {
            let distances = [exact(&from.scanned)?, exact(&from.noisy)?, exact(&from.smooth)?];
            let found = solver.distances(from.vertex)?;
            for point in points.iter().filter(|point| point.scanned.face != from.scanned.face) {
                let expected = to(&distances[0], &point.scanned);
                let relative = found[point.vertex.index()] / expected - 1.0;
                sum.error += relative.abs();
                sum.bias += relative;
                sum.moved += (to(&distances[1], &point.noisy) / expected - 1.0).abs();
                let own = to(&distances[2], &point.smooth);
                sum.own += (found[point.vertex.index()] - own).abs() / expected;
                count += 1.0;
            }
        }
        let Errors { error, bias, moved, own } = sum;
        Ok(Errors { error: error / count, bias: bias / count, moved: moved / count, own: own / count })
    }

    /// All points that were not left out.
    fn triples(&self) -> Result<Vec<Triple>> {
        let on_mesh = scan(self.shape.surface.mesh(), ON_MESH, 0.0, 0);
        let tree = NearestPoints::new(on_mesh.iter().map(|point| point.position).collect())?;
        let nearest = |p: &Point3<f64>| on_mesh[tree.nearest(p).0];
        let triple = |(i, scanned): (usize, &ScannedPoint)| {
            let vertex = self.surface.repaired_vertex(VertexId::from(i)).ok()?;
            let smooth = nearest(&self.surface.mesh().positions[vertex.index()]);
            Some(Triple { scanned: *scanned, noisy: nearest(&scanned.position), smooth, vertex })
        };
        Ok(self.scanned.iter().enumerate().filter_map(triple).collect())
    }
}

/// A point of a mesh, the points of the mesh nearest to it with noise and after smoothing, and the vertex that stands for it.
struct Triple {
    scanned: ScannedPoint,
    noisy: ScannedPoint,
    smooth: ScannedPoint,
    vertex: VertexId,
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
