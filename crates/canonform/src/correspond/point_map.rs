//! Points inside faces, and what they carry from one surface to another.

use std::borrow::Borrow;
use std::cmp::Reverse;
use std::collections::HashMap;

use descriptors::Side;
use linalg::Matrix;
use maps::{MapElements, SurfaceMap, mapped_points};
use mesh::{InputPoint, Surface};
use surface::{CornerId, FaceId, SurfacePoint, Topology, VertexId};

use super::mapped_surface::MappedSurface;

/// A point inside a face, in the numbers of the input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacePoint {
    /// The face.
    pub face: FaceId,
    /// Its vertices.
    pub corners: [VertexId; 3],
    /// Their weights: not negative, with sum 1.
    pub weights: [f64; 3],
}

impl FacePoint {
    /// The point as it is written.
    pub fn point(&self) -> InputPoint {
        InputPoint::Face { face: self.face, weights: self.weights }
    }

    /// The corner of the largest weight, the first in case of a tie.
    pub fn nearest_corner(&self) -> VertexId {
        let [a, b, c] = self.weights;
        self.corners[if a >= b && a >= c { 0 } else { usize::from(b < c) + 1 }]
    }
}

/// What takes points of one surface to points of another.
#[derive(Debug, Clone, Copy)]
pub struct Mapping<'a, S = Surface> {
    /// The first and the second surface.
    pub shapes: [&'a MappedSurface<S>; 2],
    /// The functional map, as in [`SurfaceMap::functional`].
    pub functional: &'a Matrix,
    /// Pairs that stay as they are, in the numbers of the inputs.
    pub landmarks: &'a [[VertexId; 2]],
    /// Of a part and a whole, which correspond vertex by vertex: the partners of the vertices of both inputs, where they have one.
    pub partners: Option<&'a [Vec<Option<VertexId>>; 2]>,
}

/// Where a map takes the elements of one surface: points inside the faces of the other one. By them, functions, labels and texture
/// coordinates of that other surface are carried to this one.
///
/// ```
/// use canonform::linalg::Matrix;
/// use canonform::descriptors::Side;
/// use canonform::Surface;
/// use canonform::maps::{CorrespondOptions, MappedSurface, Mapping, correspond};
/// use canonform::mesh::shapes;
///
/// let flat = shapes::grid(21, 17, 0.1);
/// let options = CorrespondOptions::default();
/// let surfaces = [flat.clone(), shapes::fold(&flat, 0.8, 1.2)].map(|mesh| {
///     let surface = Surface::new(&mesh, &options.form.repair, &()).unwrap();
///     MappedSurface::new(surface, &options, &()).unwrap()
/// });
/// let [a, b] = &surfaces;
/// let map = &correspond(a, b, &options, &())?.maps[0];
///
/// // From the first surface to the second: for every vertex of the second its place on the first.
/// let places = Mapping::new(map, [a, b]).vertices(Side::Second);
/// let constant = places.values(&Matrix::from_element(21 * 17, 1, 7.0));
/// assert!(constant.iter().all(|value| (value - 7.0).abs() < 1e-12));
/// # Ok::<(), canonform::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PointMap {
    /// For every element of the input, its point on the other surface; `None` for those that the repair dropped.
    pub points: Vec<Option<FacePoint>>,
}

impl PointMap {
    /// Functions of the other surface, carried to these elements: interpolated inside faces. `values` has a row for every vertex
    /// of the other input, and a column for every function; the result has a row for every element, NaN where it has no point.
    ///
    /// Texture coordinates are two functions. The corners are those of the input's face, so a seam along which the input
    /// doubles its vertices stays sharp on the other surface; here, a face across the seam has corners on both sides of it, unless
    /// coordinates are given and carried [by corner](Mapping::corners).
    ///
    /// # Panics
    /// If `values` has fewer rows than the other input has vertices.
    pub fn values(&self, values: &Matrix) -> Matrix {
        self.interpolated(values, |point| point.corners.map(VertexId::index))
    }

    /// Values at the corners of the faces of the other surface, three rows a face, carried to these elements.
    ///
    /// # Panics
    /// If `values` has fewer rows than the other input has corners.
    pub fn corner_values(&self, values: &Matrix) -> Matrix {
        self.interpolated(values, |point| point.face.corners().map(CornerId::index))
    }

    fn interpolated(&self, values: &Matrix, rows: impl Fn(&FacePoint) -> [usize; 3]) -> Matrix {
        Matrix::from_fn(self.points.len(), values.ncols(), |i, j| {
            self.points[i].map_or(f64::NAN, |point| {
                let part = |(row, weight): (usize, f64)| match weight {
                    // Not a number times zero is not a number.
                    0.0 => 0.0,
                    weight => weight * values[(row, j)],
                };
                rows(&point).into_iter().zip(point.weights).map(part).sum()
            })
        })
    }

    /// Labels of the vertices of the other surface, carried to these elements: the one of the largest weight.
    ///
    /// # Panics
    /// If there are fewer labels than the other input has vertices.
    pub fn vertex_labels<L: Clone + PartialEq>(&self, labels: &[L]) -> Vec<Option<L>> {
        let label = |point: &FacePoint| {
            let of = point.corners.map(|corner| &labels[corner.index()]);
            let weight = |label: &L| -> f64 {
                of.iter().zip(point.weights).filter(|(other, _)| **other == label).map(|(_, w)| w).sum()
            };
            let weights = of.map(weight);
            let most = weights.iter().copied().fold(0.0, f64::max);
            weights.iter().position(|w| *w == most).map(|i| of[i].clone())
        };
        self.points.iter().map(|point| point.as_ref().and_then(label)).collect()
    }

    /// Labels of the faces of the other surface, carried to these elements: that of the face of their point.
    ///
    /// # Panics
    /// If there are fewer labels than the other input has faces.
    pub fn face_labels<L: Clone>(&self, labels: &[L]) -> Vec<Option<L>> {
        self.points.iter().map(|point| point.map(|point| labels[point.face.index()].clone())).collect()
    }
}

impl<'a, S: Borrow<Surface>> Mapping<'a, S> {
    /// A map between the surfaces that it was found for.
    pub fn new(map: &'a SurfaceMap, shapes: [&'a MappedSurface<S>; 2]) -> Self {
        let partners = map.part.as_ref().map(|part| &part.partners);
        Self { shapes, functional: &map.functional, landmarks: &map.landmarks, partners }
    }

    /// For every vertex of one side, its point on the other surface: of the first side, where the map takes it; of the second, what
    /// is taken to it.
    pub fn vertices(&self, of: Side) -> PointMap {
        let surfaces = self.shapes.map(|shape| shape.surface());
        let [own, other] = of.ordered(surfaces);
        if let Some(partners) = self.partners {
            let [partners, _] = of.ordered(partners.each_ref());
            let point = |v: &Option<VertexId>| Some(SurfacePoint::Vertex(other.repaired_vertex((*v)?).ok()?));
            return PointMap { points: in_faces(partners.iter().map(point), other) };
        }
        let mut found = self.mapped(of, MapElements::Vertices);
        for [x, y] in self.landmarks {
            let pair = [surfaces[0].repaired_vertex(*x), surfaces[1].repaired_vertex(*y)];
            if let [Ok(x), Ok(y)] = of.ordered(pair) {
                found[x.index()] = SurfacePoint::Vertex(y);
            }
        }
        let points = in_faces(found.into_iter().map(Some), other);
        PointMap { points: own.in_input_order(&points, None) }
    }

    /// The same for the centroid of every face of one side.
    pub fn faces(&self, of: Side) -> PointMap {
        let [own, other] = of.ordered(self.shapes.map(|shape| shape.surface()));
        if let Some(partners) = self.partners {
            let [partners, _] = of.ordered(partners.each_ref());
            let partner = |v: VertexId| other.repaired_vertex(partners[v.index()]?).ok();
            let topology = other.intrinsic().topology();
            let point =
                |[a, b, c]: &[VertexId; 3]| face_among([partner(*a)?, partner(*b)?, partner(*c)?], topology);
            return PointMap { points: in_faces(own.input.faces.iter().map(point), other) };
        }
        self.of_faces(of, 1, |faces| self.mapped(of, MapElements::Faces(faces)))
    }

    /// The points of the faces of one side, `n` for each, from those of the faces that the repair kept.
    fn of_faces(
        &self,
        of: Side,
        n: usize,
        mapped: impl FnOnce(&[[VertexId; 3]]) -> Vec<SurfacePoint>,
    ) -> PointMap {
        let [own, other] = of.ordered(self.shapes.map(|shape| shape.surface()));
        let repaired = |face: &[VertexId; 3]| {
            let [a, b, c] = face.map(|v| own.repaired_vertex(v).ok());
            Some([a?, b?, c?])
        };
        let faces: Vec<Option<[VertexId; 3]>> = own.input.faces.iter().map(repaired).collect();
        let kept: Vec<_> = faces.iter().flatten().copied().collect();
        let mut found = in_faces(mapped(&kept).into_iter().map(Some), other).into_iter();
        let all = faces.iter().flat_map(|face| std::iter::repeat_n(face.is_some(), n));
        PointMap { points: all.map(|is_kept| if is_kept { found.next().flatten() } else { None }).collect() }
    }

    /// The same for the corners of the faces of one side, three for each face, in order to carry values at the corners of the other
    /// side, such as texture coordinates: `values` has three rows for each of its faces. No face here takes its values from both
    /// sides of a seam, across which those of neighboring faces differ. `None` between a part and a whole.
    pub fn corners(&self, of: Side, values: &Matrix) -> Option<PointMap> {
        if self.partners.is_some() {
            return None;
        }
        let [_, other] = of.ordered(self.shapes.map(|shape| shape.surface()));
        let joined = &joined(other, values);
        Some(self.of_faces(of, 3, |faces| self.mapped(of, MapElements::Corners { faces, joined })))
    }

    fn mapped(&self, of: Side, elements: MapElements<'_>) -> Vec<SurfacePoint> {
        let [_, target] = of.ordered(self.shapes.map(|shape| shape.surface()));
        let topology = target.intrinsic().topology();
        mapped_points(self.shapes.map(|shape| &shape.shape), self.functional, of, elements, topology)
    }
}

/// For every corner of the repaired mesh, whether values at the corners of the input are the same on both sides of the edge
/// opposite it.
fn joined(surface: &Surface, values: &Matrix) -> Vec<bool> {
    let topology = surface.intrinsic().topology();
    let mut rows = vec![None; 3 * topology.n_faces()];
    let faces = input_faces(surface);
    for (face, vertices) in topology.faces().iter().enumerate() {
        let Some(&input) = faces.get(&VertexId::sorted(*vertices)) else { continue };
        let corners = surface.input.faces[input].map(|v| surface.input.remap.to_new(v));
        for (slot, v) in vertices.iter().enumerate() {
            let at = corners.iter().position(|corner| *corner == Some(*v));
            rows[3 * face + slot] = at.map(|at| 3 * input + at);
        }
    }
    let row = |face: FaceId, v: VertexId| rows[topology.corner_at(face, v)?.index()];
    let same = |corner: CornerId| {
        let other = topology.opposite(corner)?.face();
        let one = |v: VertexId| Some(values.row(row(corner.face(), v)?) == values.row(row(other, v)?));
        let [a, b] = topology.edge_ends(corner);
        Some(one(a)? && one(b)?)
    };
    (0..rows.len()).map(|corner| same(CornerId::from(corner)).unwrap_or(false)).collect()
}

/// The faces of the input by the vertices of the repaired mesh, in ascending order.
fn input_faces(surface: &Surface) -> HashMap<[VertexId; 3], usize> {
    let mut faces = HashMap::new();
    for (i, face) in surface.input.faces.iter().enumerate() {
        if let [Some(a), Some(b), Some(c)] = face.map(|v| surface.input.remap.to_new(v)) {
            faces.entry(VertexId::sorted([a, b, c])).or_insert(i);
        }
    }
    faces
}

/// The centroid of a face with as many of three vertices as possible.
fn face_among(vertices: [VertexId; 3], topology: &Topology) -> Option<SurfacePoint> {
    let faces = vertices.into_iter().flat_map(|v| topology.vertex_corners(v)).map(|corner| corner.face());
    let shared = |face: &FaceId| {
        let corners = topology.faces()[face.index()];
        (vertices.iter().filter(|v| corners.contains(v)).count(), Reverse(*face))
    };
    let face = faces.max_by_key(shared)?;
    Some(SurfacePoint::Face { face, barycentric: [1.0 / 3.0; 3] })
}

/// Points of a repaired mesh in faces of its input. A face that the repair added, as a bridge, has none: its points go to the
/// nearest corner.
fn in_faces(
    points: impl IntoIterator<Item = Option<SurfacePoint>>,
    surface: &Surface,
) -> Vec<Option<FacePoint>> {
    let topology = surface.intrinsic().topology();
    let to_repaired = |v: VertexId| surface.input.remap.to_new(v);
    let faces = input_faces(surface);
    let mut around: Vec<Option<usize>> = vec![None; topology.n_vertices()];
    for (i, face) in surface.input.faces.iter().enumerate() {
        let [Some(a), Some(b), Some(c)] = face.map(to_repaired) else { continue };
        [a, b, c].iter().for_each(|v| around[v.index()] = around[v.index()].or(Some(i)));
    }
    let in_face = |i: usize, weight: &dyn Fn(VertexId) -> f64| {
        let corners = surface.input.faces[i];
        let weights = corners.map(|v| to_repaired(v).map_or(0.0, weight));
        FacePoint { face: FaceId::from(i), corners, weights }
    };
    let at_vertex = |v: VertexId| {
        let one = |w: VertexId| f64::from(u8::from(w == v));
        around[v.index()].map(|i| in_face(i, &one))
    };
    let place = |point: SurfacePoint| match point {
        SurfacePoint::Vertex(v) => at_vertex(v),
        SurfacePoint::Edge { edge, t } => {
            let [a, b] = topology.edges()[edge.index()];
            at_vertex(if t < 0.5 { a } else { b })
        }
        SurfacePoint::Face { face, barycentric } => {
            let vertices = topology.faces()[face.index()];
            let weight = |v: VertexId| vertices.iter().position(|w| *w == v).map_or(0.0, |i| barycentric[i]);
            match faces.get(&VertexId::sorted(vertices)) {
                Some(i) => Some(in_face(*i, &weight)),
                None => {
                    let most = vertices.into_iter().max_by(|v, w| weight(*v).total_cmp(&weight(*w)));
                    most.and_then(at_vertex)
                }
            }
        }
    };
    points.into_iter().map(|point| point.and_then(place)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(weights: [f64; 3]) -> Option<FacePoint> {
        Some(FacePoint { face: FaceId(0), corners: [0, 1, 2].map(VertexId), weights })
    }

    #[test]
    fn labels_go_by_majority_and_values_by_weight() {
        let map = PointMap { points: vec![point([0.4, 0.3, 0.3]), point([1.0, 0.0, 0.0]), None] };
        assert_eq!(map.vertex_labels(&["ear", "leg", "leg"]), [Some("leg"), Some("ear"), None]);
        assert_eq!(map.face_labels(&[7]), [Some(7), Some(7), None]);
        let values = map.values(&Matrix::from_row_slice(3, 2, &[1.0, 10.0, 2.0, f64::NAN, 3.0, f64::NAN]));
        assert!((values[(0, 0)] - 1.9).abs() < 1e-12 && values[(0, 1)].is_nan());
        assert_eq!((values[(1, 0)], values[(1, 1)]), (1.0, 10.0));
        assert!(values[(2, 0)].is_nan());
        assert_eq!(point([0.2, 0.3, 0.5]).map(|p| p.nearest_corner()), Some(VertexId(2)));
        assert_eq!(point([0.4, 0.4, 0.2]).map(|p| p.nearest_corner()), Some(VertexId(0)));
    }
}
