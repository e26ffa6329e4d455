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

use anyhow::Result;
use canonform::{Surface, describe};
use datasets::{ScannedPoint, scan};
use descriptors::ShapeMetric;
use geodesics::{Method, Source, SurfacePoint};
use mesh::TriMesh;
use nalgebra::Point3;
use report::results::{CurvesPanel, Series};
use rigid::NearestPoints;
use serde::Deserialize;
use surface::VertexId;

use crate::collection::LabeledSurface;
use crate::context::Context;
use crate::experiment::Experiment;
use crate::gallery::Gallery;
use crate::sweep::{MeasuredNumbers, linear, mean, note, panel, point};

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

/// Mean relative errors of distances.
#[derive(Default)]
struct DistanceErrors {
    error: f64,
    /// The same with its sign.
    bias: f64,
    /// Of the mesh, between its points that are nearest to the noisy ones.
    moved: f64,
    /// Beside the mesh between its points that are nearest to those of the surface.
    own: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointsOptions {
    /// Shapes of each class that are scanned.
    queries: usize,
}

impl Experiment for PointsOptions {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let gallery = Gallery::new(context)?;
        let all = &gallery.described;
        let mut measured = MeasuredNumbers::new();
        let mut least = f64::INFINITY;
        let mut rows = Vec::new();
        for noise in NOISES {
            for &n in noise.counts() {
                let name = format!("{noise}, {} points", thousands(n));
                let most = if n > COUNTS[0] { QUERIES_OF_MANY } else { usize::MAX };
                let found = gallery.map(self.queries.min(most), &name, |query| {
                    let cloud = ScannedCloud::new(query.shape, n, noise, query.seed)?;
                    let errors = cloud.errors()?;
                    let fused = describe(&cloud.surface, &gallery.options, &())?.fused;
                    let scores = gallery.scores(query, |i| ShapeMetric::robust(&fused, &all[i].fused));
                    Ok((errors, scores.nn))
                })?;
                let nn = mean(found.iter().map(|(_, nn)| *nn));
                let over =
                    |value: fn(&DistanceErrors) -> f64| mean(found.iter().map(|(errors, _)| value(errors)));
                let error = over(|errors| errors.error);
                let numbers = [
                    ("error", error),
                    ("bias", over(|errors| errors.bias)),
                    ("moved", over(|errors| errors.moved)),
                    ("own", over(|errors| errors.own)),
                    ("nn", nn),
                ];
                note(&mut measured, &format!("{name},"), numbers);
                least = least.min(nn);
                rows.push((noise, n, [error, nn]));
            }
        }
        measured.insert("least nn".to_owned(), least);
        let provenance = context.provenance(&[("description", &gallery.options)]);
        context.publish_curves(panels(&rows), provenance, &measured)
    }
}

/// A scanned shape.
struct ScannedCloud<'a> {
    shape: &'a LabeledSurface,
    scanned: Vec<ScannedPoint>,
    surface: Surface,
}

impl<'a> ScannedCloud<'a> {
    fn new(shape: &'a LabeledSurface, n: usize, noise: Noise, seed: u64) -> Result<Self> {
        let mesh = shape.surface.mesh();
        let scanned = scan(mesh, n, noise.deviation(mesh), seed);
        let positions = scanned.iter().map(|point| point.position).collect();
        let points = TriMesh { positions, faces: Vec::new() };
        let surface = Surface::new(&points, &shape.surface.input.repair, &())?;
        Ok(Self { shape, scanned, surface })
    }

    /// The mean errors of distances between points. Points that were left out are not counted, nor are those of the
    /// face of the source.
    fn errors(&self) -> Result<DistanceErrors> {
        let mesh = self.shape.surface.mesh();
        let reference = Method::Exact.prepare(self.shape.surface.intrinsic(), &())?;
        let solver = Method::default().prepare(self.surface.intrinsic(), &())?;
        let exact = |from: &ScannedPoint| -> Result<Vec<f64>> {
            let mut distances = vec![f64::INFINITY; reference.n_vertices()];
            let at = SurfacePoint::Face { face: from.face, barycentric: from.barycentric };
            let start = Source::new(self.shape.surface.intrinsic(), at)?;
            reference.solve_into(&[start], f64::INFINITY, &mut distances)?;
            Ok(distances)
        };
        let to = |distances: &[f64], at: &ScannedPoint| -> f64 {
            let corners = mesh.faces[at.face.index()];
            corners.iter().zip(at.barycentric).map(|(v, b)| b * distances[v.index()]).sum()
        };
        let points: Vec<Triple> = self.triples()?;
        let (mut sum, mut count) = (DistanceErrors::default(), 0.0);
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
        let DistanceErrors { error, bias, moved, own } = sum;
        Ok(DistanceErrors {
            error: error / count,
            bias: bias / count,
            moved: moved / count,
            own: own / count,
        })
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

/// Noise, number of points; error of distances, and share of queries whose nearest has their class.
type CloudRow = (Noise, usize, [f64; 2]);

fn panels(rows: &[CloudRow]) -> Vec<CurvesPanel> {
    let of = |(i, title): (usize, &str)| {
        let series = COUNTS.map(|n| {
            let at = |row: &CloudRow| match row.0 {
                Noise::OfArea(share) if row.1 == n => Some(point(100.0 * share, &[row.2[i]])),
                _ => None,
            };
            Series { name: format!("{} points", thousands(n)), points: rows.iter().filter_map(at).collect() }
        });
        panel(title, linear("noise, % of sqrt(area)"), linear(title), series.into())
    };
    ["mean relative error", "NN"].into_iter().enumerate().map(of).collect()
}
