//! Points inside faces that maps take points to.

use linalg::Matrix;
use rayon::prelude::*;
use rigid::OnTriangle;
use surface::{CornerId, FaceId, SurfacePoint, Topology, VertexId};

use crate::functional::FunctionalMaps;
use crate::shape::MapShape;
use descriptors::Side;

/// What is mapped of a surface.
#[derive(Debug, Clone, Copy)]
pub enum MapElements<'a> {
    /// All vertices.
    Vertices,
    /// The centroids of some faces.
    Faces(&'a [[VertexId; 3]]),
    /// The corners of some faces, three for each. The points of a face lie in faces that are joined around that of its centroid:
    /// `joined` tells for every corner of the other surface whether the edge opposite it may be crossed, which a seam may not.
    Corners {
        /// The vertices of the faces.
        faces: &'a [[VertexId; 3]],
        /// One for every corner of the other surface.
        joined: &'a [bool],
    },
}

/// For elements of one surface, their points inside the faces of the other one (the precise map of `ezuz2017` in
/// `REFERENCES.bib`).
///
/// A map of functions `C` places both surfaces in the space of the eigenfunctions of both, `[Φ, Φ C]` and `[Ψ C', Ψ]`, where
/// triangles stay flat. The point of an element is the nearest one on the faces around the nearest vertex, or around those of its
/// corners, and on from there from face to face as long as it gets nearer.
///
/// * `shapes` are the first and the second surface, and `functional` is `C` as in
///   [`SurfaceMap::functional`](super::SurfaceMap::functional);
/// * the elements are those of the side `of`, and `target` is the connectivity of the other one.
///
/// The same map serves both directions: what it takes from the second surface to the first is found by nearest points, too.
/// Parallel, and independent of the number of threads.
///
/// # Panics
/// If `functional` is not square, as that of a part.
pub fn mapped_points(
    shapes: [&MapShape; 2],
    functional: &Matrix,
    of: Side,
    elements: MapElements<'_>,
    target: &Topology,
) -> Vec<SurfacePoint> {
    let placed = FunctionalMaps::from(functional.clone()).placed(shapes.map(|shape| &shape.spectrum.vectors));
    let ([own, other], [_, shape]) = (of.ordered(placed), of.ordered(shapes));
    let nearest = shape.nearest_vertices(&other, &own);
    // Rows next to each other in memory.
    let (own, rows) = (own.transpose(), other.transpose());
    let around = |face: FaceId| faces_around(&target.faces()[face.index()], target);
    let at = |query: &[f64], starts: &[VertexId]| match nearest_point(
        query,
        &rows,
        target,
        faces_around(starts, target),
        around,
    ) {
        Some((face, found)) => SurfacePoint::Face { face, barycentric: found.weights },
        None => SurfacePoint::Vertex(starts[0]),
    };
    let start = |v: usize| VertexId::from(nearest[v]);
    let centroid = |face: &[VertexId; 3]| {
        let places = face.map(|v| column(&own, v));
        let mean: Vec<f64> =
            (0..own.nrows()).map(|j| places.iter().map(|p| p[j]).sum::<f64>() / 3.0).collect();
        at(&mean, &face.map(|v| start(v.index())))
    };
    match elements {
        MapElements::Vertices => {
            let vertices = (0..nearest.len()).into_par_iter();
            vertices.map(|v| at(column(&own, VertexId::from(v)), &[start(v)])).collect()
        }
        MapElements::Faces(faces) => faces.par_iter().map(centroid).collect(),
        MapElements::Corners { faces, joined } => {
            let corners = |face: &[VertexId; 3]| match centroid(face) {
                SurfacePoint::Face { face: first, .. } => face.map(|v| {
                    let around = |face| joined_around(face, target, joined);
                    let found = nearest_point(column(&own, v), &rows, target, around(first), around);
                    let (face, OnTriangle { weights: barycentric, .. }) =
                        found.expect("the first face is one");
                    SurfacePoint::Face { face, barycentric }
                }),
                nowhere => [nowhere; 3],
            };
            faces.par_iter().map(corners).collect::<Vec<_>>().into_flattened()
        }
    }
}

/// The faces around some vertices.
fn faces_around(vertices: &[VertexId], target: &Topology) -> Vec<FaceId> {
    vertices.iter().flat_map(|v| target.vertex_corners(*v)).map(|corner| corner.face()).collect()
}

/// A face and those around its vertices that can be reached from it across joined edges.
fn joined_around(face: FaceId, target: &Topology, joined: &[bool]) -> Vec<FaceId> {
    let faces = target.faces();
    let mut found = vec![face];
    let mut next = 0;
    while let Some(at) = found.get(next).copied() {
        let open = at.corners().into_iter().filter(|corner| joined[corner.index()]);
        for other in open.filter_map(|corner| target.opposite(corner)).map(CornerId::face) {
            let is_near = faces[other.index()].iter().any(|v| faces[face.index()].contains(v));
            if is_near && !found.contains(&other) {
                found.push(other);
            }
        }
        next += 1;
    }
    found
}

/// The nearest point of some faces, and on from there through those `around` the nearest one; `None` without a face. `rows` has a
/// column for each vertex.
fn nearest_point(
    query: &[f64],
    rows: &Matrix,
    target: &Topology,
    mut next: Vec<FaceId>,
    around: impl Fn(FaceId) -> Vec<FaceId>,
) -> Option<(FaceId, OnTriangle)> {
    let mut best: Option<(FaceId, OnTriangle)> = None;
    let mut seen: Vec<FaceId> = Vec::new();
    loop {
        let before = best.map(|(face, _)| face);
        for face in next {
            if seen.contains(&face) {
                continue;
            }
            seen.push(face);
            let corners = target.faces()[face.index()].map(|v| column(rows, v));
            let found = OnTriangle::nearest(query, corners);
            if best.is_none_or(|(_, best)| found.sq_distance < best.sq_distance) {
                best = Some((face, found));
            }
        }
        match best {
            Some((face, _)) if before != Some(face) => next = around(face),
            _ => return best,
        }
    }
}

fn column(rows: &Matrix, vertex: VertexId) -> &[f64] {
    let n = rows.nrows();
    &rows.as_slice()[vertex.index() * n..][..n]
}
