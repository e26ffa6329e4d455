//! From the polygons of a file to a triangle mesh.

use std::collections::{BTreeSet, HashMap};

use earcut::Earcut;
use mesh::{Fault, MIN_POINTS, TriMesh};
use nalgebra::{Matrix4, Point3, Vector3};
use surface::VertexId;

use crate::file::{MeshFile, ReadLimits};
use crate::located::{At, Located};

/// A polygon is flat if its corners are within this share `h` of its size from its plane. Across a square whose corners are
/// alternately `h` above and below, lengths depend on the diagonal by a share of `4 h^2`: less than a part in a thousand.
const FLAT: f64 = 0.01;
/// Areas in units of the square of the size of a polygon that rounding may make of nothing.
const ROUNDING: f64 = 1e-9;
/// Corners that [`Earcut`] can count with its 32-bit offsets.
const MAX_CORNERS: usize = 1 << 24;

/// The triangles of the polygons of a file.
#[derive(Default)]
pub(crate) struct Polygons {
    faces: Vec<[VertexId; 3]>,
    n_bent: usize,
    n_crossing: usize,
}

impl Polygons {
    /// Triangulates a polygon whose corners are in range. Every corner becomes a corner of a triangle, and no vertex is added.
    ///
    /// A quadrilateral is split along the diagonal that folds neither half over, else along the shorter one. Larger polygons
    /// are cut by ear clipping in their plane, and edges flipped until triangles are as even as can be (Delaunay).
    pub(crate) fn push(
        &mut self,
        positions: &[Point3<f64>],
        corners: &[VertexId],
        limits: &ReadLimits,
    ) -> Result<(), Fault> {
        limits.check(0, (self.faces.len() + corners.len().saturating_sub(2)) as u64)?;
        match *corners {
            [] | [_] | [_, _] => return Err(Fault::too_few_corners(corners.len())),
            [a, b, c] => self.faces.push([a, b, c]),
            _ => self.cut(positions, corners),
        }
        Ok(())
    }

    fn cut(&mut self, positions: &[Point3<f64>], corners: &[VertexId]) {
        let n = corners.len();
        let outline = Outline::of(corners.iter().map(|v| positions[v.index()]));
        let cut = match *corners {
            [a, b, c, d] if prefers_second_diagonal(positions, [a, b, c, d]) => vec![0, 1, 3, 1, 2, 3],
            [_, _, _, _] => vec![0, 1, 2, 0, 2, 3],
            _ => outline
                .as_ref()
                .and_then(Outline::cut)
                .unwrap_or_else(|| (1..n as u32 - 1).flat_map(|corner| [0, corner, corner + 1]).collect()),
        };
        if let Some(outline) = outline {
            self.n_bent += usize::from(outline.height > FLAT);
            self.n_crossing += usize::from(outline.crosses(&cut));
        }
        self.faces
            .extend(cut.as_chunks::<3>().0.iter().map(|face| face.map(|corner| corners[corner as usize])));
    }

    /// The file of the mesh, as [`finish`] makes it, with notes about polygons whose surface is not certain.
    pub(crate) fn finish(
        self,
        positions: Vec<Point3<f64>>,
        limits: &ReadLimits,
    ) -> Result<MeshFile, Located> {
        let mut file = finish(TriMesh { positions, faces: self.faces }, limits)?;
        let bent = "polygons that are not flat, whose surface depends on how they are split";
        let crossing = "polygons that cross themselves, which are covered in parts twice or not at all";
        let found = [(self.n_bent, bent), (self.n_crossing, crossing)].into_iter().filter(|(n, _)| *n > 0);
        file.facts.notes.extend(found.map(|(n, what)| format!("{what}: {n}")));
        Ok(file)
    }
}

/// Whether the quadrilateral a b c d is better split from b to d than from a to c.
fn prefers_second_diagonal(positions: &[Point3<f64>], quad: [VertexId; 4]) -> bool {
    let [a, b, c, d] = quad.map(|v| positions[v.index()]);
    let folds_over = |p: Point3<f64>, q: Point3<f64>, r: Point3<f64>, s: Point3<f64>| {
        let (first, second) = ((q - p).cross(&(r - p)), (r - p).cross(&(s - p)));
        first.dot(&second) <= 0.0
    };
    match (folds_over(a, b, c, d), folds_over(b, c, d, a)) {
        (true, false) => true,
        (false, true) => false,
        _ => (d - b).norm_squared() < (c - a).norm_squared(),
    }
}

/// A polygon seen along the normal of its plane, in units of its size.
struct Outline {
    points: Vec<[f64; 2]>,
    /// How far a corner is from the plane.
    height: f64,
}

impl Outline {
    /// `None` if all corners are in one line, or too far apart for numbers.
    fn of(corners: impl Iterator<Item = Point3<f64>> + Clone) -> Option<Self> {
        let first = corners.clone().next()?;
        let size = corners.clone().map(|p| (p - first).amax()).fold(0.0, f64::max);
        if size == 0.0 || !size.is_finite() {
            return None;
        }
        let points: Vec<Vector3<f64>> = corners.map(|p| (p - first) / size).collect();
        let normals = points.iter().zip(points.iter().cycle().skip(1)).map(|(p, q)| p.cross(q));
        // Newell's normal, whose length is twice the area; a polygon that crosses itself may have none.
        let newell = normals.clone().sum::<Vector3<f64>>().try_normalize(ROUNDING);
        let largest = || normals.max_by(|a, b| a.norm().total_cmp(&b.norm()))?.try_normalize(ROUNDING);
        let normal = newell.or_else(largest)?;
        let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
        let height = points.iter().map(|p| (p - mean).dot(&normal).abs()).fold(0.0, f64::max);
        let right = Vector3::ith(normal.iamin(), 1.0).cross(&normal).normalize();
        let up = normal.cross(&right);
        Some(Self { points: points.iter().map(|p| [p.dot(&right), p.dot(&up)]).collect(), height })
    }

    /// Triangles with all corners; `None` if ear clipping fails, as it may for polygons that cross themselves.
    fn cut(&self) -> Option<Vec<u32>> {
        let n = self.points.len();
        let mut cut: Vec<u32> = Vec::with_capacity(3 * n);
        if n > MAX_CORNERS {
            return None;
        }
        Earcut::new().earcut_slice(&self.points, &[], &mut cut);
        if self.twice_areas(&cut).sum::<f64>() < 0.0 {
            cut.as_chunks_mut::<3>().0.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        }
        // Ear clipping leaves out corners in a row with their neighbors. Triangles without area are missing there: loops of
        // edges with a triangle on one side only. Flipping edges gives them an area.
        if cut.len() < 3 * (n - 2) {
            let edges: BTreeSet<[u32; 2]> =
                cut.as_chunks().0.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            let outline = || (0..n as u32).map(|corner| [corner, (corner + 1) % n as u32]);
            let is_loose = |[a, b]: &[u32; 2]| !edges.contains(&[*b, *a]) && (a + 1) % n as u32 != *b;
            let mut missing: HashMap<u32, u32> =
                edges.iter().filter(|edge| is_loose(edge)).map(|&[a, b]| (b, a)).collect();
            missing.extend(outline().filter(|edge| !edges.contains(edge)).map(|[a, b]| (a, b)));
            for start in 0..n as u32 {
                let mut at = missing.remove(&start);
                while let Some(corner) = at {
                    at = missing.remove(&corner).filter(|next| *next != start);
                    cut.extend(at.into_iter().flat_map(|next| [start, corner, next]));
                }
            }
        }
        earcut::refine(&mut cut, &self.points);
        (cut.len() == 3 * (n - 2)).then_some(cut)
    }

    fn twice_areas(&self, triangles: &[u32]) -> impl Iterator<Item = f64> {
        triangles.as_chunks::<3>().0.iter().map(|triangle| {
            let [[a, b], [c, d], [e, f]] = triangle.map(|corner| self.points[corner as usize]);
            (c - a) * (f - b) - (d - b) * (e - a)
        })
    }

    /// Whether the triangles cover another area than the outline encloses, as they do if it crosses itself.
    fn crosses(&self, triangles: &[u32]) -> bool {
        let next = self.points.iter().cycle().skip(1);
        let enclosed: f64 = self.points.iter().zip(next).map(|([a, b], [c, d])| a * d - b * c).sum();
        (self.twice_areas(triangles).map(f64::abs).sum::<f64>() - enclosed.abs()).abs() > ROUNDING
    }
}

/// A position whose coordinates are numbers; `vertex` only appears in messages.
pub(crate) fn finite(position: impl Into<Point3<f64>>, vertex: usize) -> Result<Point3<f64>, Fault> {
    let position = position.into();
    match position.iter().find(|x| !x.is_finite()) {
        Some(value) => Err(Fault::Malformed(format!(
            "vertex {vertex} has the coordinate {value}; correct the coordinate or remove the vertex"
        ))),
        None => Ok(position),
    }
}

/// Vertices and faces that copies of meshes may always add up to.
const COPIES: u64 = 1 << 22;
/// Beyond, they may be this many times the bytes of the file.
const COPIES_RATIO: u64 = 64;

/// Refuses a small file in which copies of meshes add up to a huge one.
pub(crate) fn check_copies(items: u64, n_bytes: u64) -> Result<(), Fault> {
    match COPIES.max(n_bytes.saturating_mul(COPIES_RATIO)) {
        limit if items > limit => Err(Fault::unsupported(
            format!(
                "its copies of meshes add up to more than {limit} vertices and faces, out of proportion to the file"
            ),
            "the file is damaged or malicious: if it is neither, export a single copy",
        )),
        _ => Ok(()),
    }
}

/// Meshes that are put together, each where the file places it.
pub(crate) struct Assembly<'a> {
    pub(crate) whole: TriMesh,
    /// Number of meshes with vertices so far.
    pub(crate) instances: usize,
    /// Number of meshes, with those that have none.
    n_appended: u64,
    limits: &'a ReadLimits,
    /// Bytes of the file.
    n_bytes: u64,
}

impl<'a> Assembly<'a> {
    pub(crate) fn new(limits: &'a ReadLimits, n_bytes: u64) -> Self {
        Self { whole: TriMesh::default(), instances: 0, n_appended: 0, limits, n_bytes }
    }

    /// Appends a copy of a mesh, moved by an affine map. Where that mirrors it, corners change their order.
    pub(crate) fn append(&mut self, part: &TriMesh, place: &Matrix4<f64>) -> Result<(), Fault> {
        let n_vertices = (self.whole.n_vertices() + part.n_vertices()) as u64;
        let n_faces = (self.whole.n_faces() + part.n_faces()) as u64;
        self.limits.check(n_vertices, n_faces)?;
        self.n_appended += 1;
        // A single mesh is no copy, however large it is.
        let is_only = self.instances == 0 && part.n_vertices() > 0;
        if !is_only {
            check_copies(n_vertices + n_faces + self.n_appended, self.n_bytes)?;
        }
        self.instances += usize::from(part.n_vertices() > 0);
        let start = self.whole.n_vertices() as u32;
        let linear = place.fixed_view::<3, 3>(0, 0).into_owned();
        let shift = place.fixed_view::<3, 1>(0, 3).into_owned();
        if *place == Matrix4::identity() {
            self.whole.positions.extend_from_slice(&part.positions);
        } else {
            for (vertex, p) in part.positions.iter().enumerate() {
                self.whole.positions.push(finite(linear * p.coords + shift, vertex)?);
            }
        }
        let is_mirror = linear.determinant() < 0.0;
        self.whole.faces.extend(part.faces.iter().map(|&[a, b, c]| {
            let face = if is_mirror { [a, c, b] } else { [a, b, c] };
            face.map(|v| VertexId(v.0 + start))
        }));
        Ok(())
    }
}

/// The file of a mesh, if that has a face or enough vertices for a point cloud, and is within the limits.
pub(crate) fn finish(mesh: TriMesh, limits: &ReadLimits) -> Result<MeshFile, Located> {
    let (n_vertices, n_faces) = (mesh.n_vertices(), mesh.n_faces());
    if n_faces == 0 && n_vertices < MIN_POINTS {
        return Err(Fault::no_faces(n_vertices as u64).whole());
    }
    limits.check(n_vertices as u64, n_faces as u64).map_err(Fault::whole)?;
    Ok(MeshFile { mesh, ..MeshFile::default() })
}
