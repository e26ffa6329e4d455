//! Points: surfaces of some shapes of every class are scanned, with and without noise, and triangulated. Distances are
//! compared with those on the mesh, and the shape is searched for in the collection of meshes without itself.
//!
//! Noise moves points along the surface, too, which changes distances on the mesh itself. What it leaves of them is measured
//! between the points of the mesh that are nearest to the noisy ones.
//!
//! Measures `NOISE, N points, error|moved|own|nn`: the mean relative error of the distances; the mean error of the distances on
//! the mesh between the nearest points of noisy ones; the error beside distances on the mesh between the points nearest to those
//! of the surface; and the share of queries whose nearest has their class. Also `least nn`.

use anyhow::Result;
use canonform::{Surface, describe};
use datasets::{ScannedPoint, scan};
use descriptors::ShapeMetric;
use geodesics::{Method, Source, SurfacePoint};
use mesh::TriMesh;
use nalgebra::Point3;
use report::Record;
use report::record::{Axis, SeriesKind};
use rigid::NearestPoints;
use surface::VertexId;

use crate::collection::LabeledSurface;
use crate::context::Context;
use crate::gallery::Gallery;
use crate::sweep::{MeasuredNumbers, Panels, mean, note, plots, point};
use crate::text::grouped;

const COUNTS: [usize; 2] = [10_000, 50_000];

/// Most queries of a class with more than the fewest points; describing them takes longest.
const QUERIES_OF_MANY: usize = 1;

/// Points from which distances are measured.
const SOURCES: usize = 5;

/// Points of the mesh among which the nearest ones are looked for. They are 0.25 % of the root of the area apart.
const ON_MESH: usize = 160_000;

/// Standard deviations of the noise of a coordinate, as shares of the square root of the area.
const NOISES: [f64; 4] = [0.0, 0.0025, 0.005, 0.01];

/// The names of the mean relative errors of distances: of the distances between points; of the mesh, between its points that are
/// nearest to the noisy ones; beside the mesh between its points nearest to those of the surface.
const ERRORS: [&str; 3] = ["error", "moved", "own"];

pub(crate) fn points(context: &Context<'_>) -> Result<Record> {
    let gallery = Gallery::new(context)?;
    let all = &gallery.described;
    let (mut measured, mut least, mut panels) = (MeasuredNumbers::new(), f64::INFINITY, Panels::default());
    for noise in NOISES {
        for n in COUNTS {
            let name = format!("{} % of sqrt(area), {} points", 100.0 * noise, grouped(&n.to_string()));
            let most = if n > COUNTS[0] { QUERIES_OF_MANY } else { usize::MAX };
            let found = gallery.map(context.options.queries.min(most), &name, |query| {
                let cloud = ScannedCloud::new(query.shape, n, noise, query.seed)?;
                let fused = describe(&cloud.surface, &gallery.options, &())?.fused;
                let scores = gallery.scores(query, |i| ShapeMetric::robust(&fused, &all[i].fused));
                Ok((cloud.errors()?, scores.nn))
            })?;
            let nn = mean(found.iter().map(|(_, nn)| *nn));
            let errors = [0, 1, 2].map(|i| mean(found.iter().map(|(errors, _)| errors[i])));
            note(&mut measured, &format!("{name},"), ERRORS.into_iter().zip(errors).chain([("nn", nn)]));
            least = least.min(nn);
            for (title, value) in [("mean relative error", errors[0]), ("NN", nn)] {
                let axes = ["noise, % of sqrt(area)", title].map(Axis::linear);
                let name = format!("{} points", grouped(&n.to_string()));
                panels.add(title, axes, (&name, SeriesKind::Curve), point(100.0 * noise, &[value]));
            }
        }
    }
    measured.insert("least nn".to_owned(), least);
    let figures = vec![plots("curves", panels.0)];
    Ok(Record { figures, ..context.record(&[("description", &gallery.options)], measured) })
}

/// A scanned shape.
struct ScannedCloud<'a> {
    shape: &'a LabeledSurface,
    scanned: Vec<ScannedPoint>,
    surface: Surface,
}

impl<'a> ScannedCloud<'a> {
    fn new(shape: &'a LabeledSurface, n: usize, noise: f64, seed: u64) -> Result<Self> {
        let mesh = shape.surface.mesh();
        let scanned = scan(mesh, n, noise * mesh.root_of_area(), seed);
        let positions = scanned.iter().map(|point| point.position).collect();
        let points = TriMesh { positions, faces: Vec::new() };
        let surface = Surface::new(&points, &shape.surface.input.repair, &())?;
        Ok(Self { shape, scanned, surface })
    }

    /// The mean [`ERRORS`]. Points that were left out are not counted, nor are those of the face of the source.
    fn errors(&self) -> Result<[f64; 3]> {
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
        let (mut sums, mut count) = ([0.0; 3], 0.0);
        for from in points.iter().step_by((points.len() / SOURCES).max(1)).take(SOURCES) {
            let distances = [exact(&from.scanned)?, exact(&from.noisy)?, exact(&from.smooth)?];
            let found = solver.distances(from.vertex)?;
            for point in points.iter().filter(|point| point.scanned.face != from.scanned.face) {
                let expected = to(&distances[0], &point.scanned);
                let error = (found[point.vertex.index()] / expected - 1.0).abs();
                let moved = (to(&distances[1], &point.noisy) / expected - 1.0).abs();
                let own = (found[point.vertex.index()] - to(&distances[2], &point.smooth)).abs() / expected;
                sums.iter_mut().zip([error, moved, own]).for_each(|(sum, one)| *sum += one);
                count += 1.0;
            }
        }
        Ok(sums.map(|sum| sum / count))
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
