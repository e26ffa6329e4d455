//! Laws of shortest paths.

mod closed_forms;
mod degenerate;
mod laws;
mod reference;

use mesh::{FaceId, IntrinsicMesh, VertexId};

use super::edges::faces_around;
use super::plane::segment;
use super::{GeodesicPath, PathTracer};
use crate::{DistanceSolver, Exact, Source, SurfacePoint};

/// Whether a face holds a point.
fn holds(mesh: &IntrinsicMesh, face: FaceId, point: SurfacePoint) -> bool {
    let vertices = mesh.topology().faces()[face.index()];
    match point {
        SurfacePoint::Vertex(vertex) => vertices.contains(&vertex),
        SurfacePoint::Edge { edge, .. } => {
            mesh.topology().edges()[edge.index()].iter().all(|end| vertices.contains(end))
        }
        SurfacePoint::Face { face: other, .. } => face == other,
    }
}

/// Length of the step from one point of a path to the next, which must be one.
fn step(mesh: &IntrinsicMesh, p: SurfacePoint, q: SurfacePoint) -> f64 {
    let over_faces = faces_around(mesh, p).into_iter().filter(|f| holds(mesh, *f, p) && holds(mesh, *f, q));
    let over_links = mesh.links().iter().filter(|link| {
        let ends = link.ends.map(SurfacePoint::Vertex);
        ends == [p, q] || ends == [q, p]
    });
    let lengths = over_faces.map(|f| segment(mesh, f, p, q)).chain(over_links.map(|link| link.length));
    lengths.reduce(f64::min).unwrap_or_else(|| panic!("no step from {p} to {q}"))
}

/// A path must be one, and as long as it says.
fn assert_path(mesh: &IntrinsicMesh, path: &GeodesicPath, source: SurfacePoint, target: SurfacePoint) {
    assert_eq!(path.points.first(), Some(&source));
    assert_eq!(path.points.last(), Some(&target));
    for point in &path.points {
        Source::new(mesh, *point).unwrap();
    }
    let length: f64 = path.points.windows(2).map(|pair| step(mesh, pair[0], pair[1])).sum();
    assert!((path.length - length).abs() <= 1e-12 * length + f64::MIN_POSITIVE, "{} {length}", path.length);
}

/// The shortest path between two points, by exact distances from the first.
fn shortest(mesh: &IntrinsicMesh, source: SurfacePoint, target: SurfacePoint) -> GeodesicPath {
    let sources = [Source::new(mesh, source).unwrap()];
    let mut distances = vec![0.0; mesh.n_vertices()];
    Exact::new(mesh).solve_into(&sources, f64::INFINITY, &mut distances);
    let path = PathTracer::new(mesh, &sources, &distances).path_to(target).unwrap();
    assert_path(mesh, &path, source, target);
    path
}

fn vertex(index: usize) -> SurfacePoint {
    SurfacePoint::Vertex(VertexId::from(index))
}
