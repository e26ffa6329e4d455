//! Laws of shortest paths.

mod closed_forms;
mod degenerate;
mod laws;

use surface::{FaceId, IntrinsicMesh, VertexId};

use super::{GeodesicPath, PathTracer};
use crate::flat::{faces_around, segment};
use crate::tests::distances_from;
use crate::{Exact, Source, SurfacePoint};

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

/// The least and the greatest length of the step from one point of a path to the next, which must be one.
///
/// They differ where several faces hold both points, and lengths that belong to no triangle leave open where in a
/// face the points are.
fn step(mesh: &IntrinsicMesh, p: SurfacePoint, q: SurfacePoint) -> [f64; 2] {
    let over_faces = faces_around(mesh, p).into_iter().filter(|f| holds(mesh, *f, p) && holds(mesh, *f, q));
    let over_links = mesh.links().iter().filter(|link| {
        let ends = link.ends.map(SurfacePoint::Vertex);
        ends == [p, q] || ends == [q, p]
    });
    let lengths = over_faces.map(|f| segment(mesh, f, p, q)).chain(over_links.map(|link| link.length));
    let range = lengths.map(|length| [length; 2]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    range.unwrap_or_else(|| panic!("no step from {p} to {q}"))
}

/// A path must be one, and as long as it says.
fn assert_path(mesh: &IntrinsicMesh, path: &GeodesicPath, source: SurfacePoint, target: SurfacePoint) {
    assert_eq!(path.points.first(), Some(&source));
    assert_eq!(path.points.last(), Some(&target));
    for point in &path.points {
        Source::new(mesh, *point).unwrap();
    }
    let steps = path.points.windows(2).map(|pair| step(mesh, pair[0], pair[1]));
    let [least, greatest] = steps.fold([0.0, 0.0], |sum, step| [sum[0] + step[0], sum[1] + step[1]]);
    let rounding = |length: f64| 1e-12 * length + f64::MIN_POSITIVE;
    let range = least - rounding(least)..=greatest + rounding(greatest);
    assert!(range.contains(&path.length), "{} is not in {range:?}", path.length);
}

/// The shortest path between two points, by exact distances from the first.
fn shortest(mesh: &IntrinsicMesh, source: SurfacePoint, target: SurfacePoint) -> GeodesicPath {
    let sources = [Source::new(mesh, source).unwrap()];
    let distances = distances_from(&Exact::new(mesh, &()), &sources, f64::INFINITY);
    let path = PathTracer::new(mesh, &sources, &distances, &()).path_to(target).unwrap();
    assert_path(mesh, &path, source, target);
    path
}

fn vertex(index: usize) -> SurfacePoint {
    SurfacePoint::Vertex(VertexId::from(index))
}
