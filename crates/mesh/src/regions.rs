//! The smooth pieces of a surface, which CAD programs call faces: planes, cylinders and others, apart at sharp edges.
//!
//! ```text
//! triangles -> flats (triangles in one plane) -> regions (flats that meet at blunt edges) -> plane, cylinder or curved
//!                                             -> chord errors (how far flats are from the curved surface they stand for)
//! ```

use nalgebra::{Matrix2, Matrix3, Point3, Unit, Vector2, Vector3};
use surface::{DisjointSets, EdgeId, Topology};

use crate::orientation::has_same_direction;
use crate::tri_mesh::TriMesh;

/// Triangles with vertices this near to a plane, relative to the square root of the area, lie in it. A tolerance: the rounding of coordinates in files.
const IN_PLANE: f64 = 2e-5;

/// Flats that meet at more than this angle have a sharp edge between them. A convention: arcs in CAD exports have twelve
/// segments and more, which turn by 30° each.
const SHARP: f64 = 40.0;

/// The same for organic surfaces, on which few triangles turn by more at fingers and ears. A convention.
const ORGANIC_SHARP: f64 = 60.0;

/// Vertices of a flat beyond which its width is not measured; such a flat is wide. A safety limit on time.
const MAX_CORNERS: usize = 64;

/// Normals of a cylinder are this near to a plane, in the mean square, relative to how they turn in it. A tolerance.
const ACROSS: f64 = 1e-3;

/// Points of a circle have the same distance from its center but for this share. A tolerance of rounding.
const ON_CIRCLE: f64 = 0.01;

/// Points are on a line if the product of their moments is less than this share of the square of the sum, as on an arc of 4°, whose
/// radius is not known. A tolerance.
const ON_LINE: f64 = 1e-4;

/// A surface is mechanical if planes and cylinders between sharp edges have at least this share of its area. All
/// generated parts have it, and no creature (`cargo test -p canonform-datasets parts_are_mechanical`).
const MECHANICAL: f64 = 0.15;

/// A surface with this many planes of at least [`WIDE`] triangles is mechanical, too, such as a bent pipe with its two ends.
/// A convention: one plane may be the base of a bust.
const MIN_WIDE: usize = 2;
const WIDE: usize = 6;

/// A flat whose area differs by less than this share from that of a triangle is one. A tolerance of rounding.
const OUTLINE: f64 = 1e-3;

/// Area vectors of a body add up to zero, those of a sheet to its area. Below this share a surface is a body. A convention: a
/// box without a lid has a fifth, half of a cylinder .6.
const MAX_OPEN: f64 = 0.4;

/// A flat is a plane by itself if it is so many times larger than all those that it meets at blunt edges, which are those of a fillet.
/// A convention: the flats of a smooth surface are about as large as their neighbors.
const PLANE: f64 = 6.0;

/// Least share of the area of a plane that counts for [`MECHANICAL`]. A convention.
const LARGE: f64 = 0.0025;

/// What a smooth piece of a surface is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RegionShape {
    /// Triangles in one plane.
    Plane {
        /// Unit normal.
        normal: Vector3<f64>,
        /// Distance of the plane from the origin along it.
        offset: f64,
    },
    /// Flats around an axis.
    Cylinder {
        /// Unit direction of the axis.
        axis: Vector3<f64>,
        /// The largest distance of an edge along the axis from it.
        radius: f64,
        /// Whether the normals point to the axis.
        is_hole: bool,
    },
    /// Anything else.
    Curved,
}

/// A smooth piece between sharp edges.
#[derive(Debug, Clone, PartialEq)]
pub struct SmoothRegion {
    /// What it is.
    pub shape: RegionShape,
    /// Share of the area.
    pub area: f64,
}

/// The smooth pieces of a surface.
///
/// ```
/// use canonform_mesh::{SmoothRegions, shapes};
///
/// let cube = SmoothRegions::of(&shapes::cube(4));
/// assert!(cube.is_mechanical && cube.all.len() == 6);
/// assert!(!SmoothRegions::of(&shapes::icosphere(3)).is_mechanical);
/// assert!(!SmoothRegions::of(&shapes::grid(4, 4, 1.0)).is_mechanical, "a sheet bends");
/// ```
#[derive(Debug)]
pub struct SmoothRegions {
    /// The pieces.
    pub all: Vec<SmoothRegion>,
    /// For every face, the number of its piece.
    pub of_face: Vec<usize>,
    /// For every face, how far the curved surface may be from it.
    pub chord_errors: Vec<f64>,
    /// Whether planes and cylinders with sharp edges between them make up the surface, as in parts of machines.
    pub is_mechanical: bool,
}

/// Triangles in one plane.
#[derive(Debug, Clone)]
struct Flat {
    normal: Vector3<f64>,
    faces: Vec<usize>,
    area: f64,
}

impl Flat {
    /// Whether its outline is a triangle: the one between the three vertices that are farthest out. `total` is the area of the
    /// mesh.
    fn is_triangle(&self, mesh: &TriMesh, total: f64) -> bool {
        let corners = || self.faces.iter().flat_map(|&f| mesh.triangle(f));
        let farthest = |sq: &dyn Fn(Point3<f64>) -> f64| corners().max_by(|p, q| sq(*p).total_cmp(&sq(*q)));
        let Some(start) = corners().next() else { return true };
        let Some(a) = farthest(&|p| (p - start).norm_squared()) else { return true };
        let Some(b) = farthest(&|p| (p - a).norm_squared()) else { return true };
        let Some(c) = farthest(&|p| (p - a).cross(&(b - a)).norm_squared()) else { return true };
        let hull = 0.5 * (b - a).cross(&(c - a)).norm() / total;
        (hull - self.area).abs() < OUTLINE * self.area
    }
}

/// An edge between two flats.
struct Crease {
    flats: [usize; 2],
    ends: [Point3<f64>; 2],
    /// The angle by which the normal turns.
    turn: f64,
}

impl SmoothRegions {
    /// Directions nearer to each other than this are one (cosine). A tolerance of rounding and of arcs.
    pub const PARALLEL: f64 = 0.999;

    /// Distances from the axis of a cylinder differ by less than this share: the middles of twelve chords are at cos 15° of the
    /// radius. A tolerance.
    pub const ROUND: f64 = 0.05;

    /// Finds the pieces.
    ///
    /// # Panics
    /// If a face has a repeated vertex or one that does not exist, see [`surface::Topology::new`].
    pub fn of(mesh: &TriMesh) -> Self {
        // Products of lengths neither overflow nor vanish near the unit.
        let unit = mesh.unit();
        let mut found = Self::near_unit(&mesh.moved(|p| p / unit));
        found.chord_errors.iter_mut().for_each(|error| *error *= unit);
        for region in &mut found.all {
            match &mut region.shape {
                RegionShape::Plane { offset, .. } => *offset *= unit,
                RegionShape::Cylinder { radius, .. } => *radius *= unit,
                RegionShape::Curved => {}
            }
        }
        found
    }

    fn near_unit(mesh: &TriMesh) -> Self {
        let topology = mesh.topology();
        let (flats, of_face) = flats(mesh, &topology);
        let creases = creases(mesh, &topology, &flats, &of_face);
        let total = mesh.area();
        let blunt = || creases.iter().filter(|crease| crease.turn < SHARP.to_radians());
        // A triangle is a plane by itself, divided or not; organic meshes of few triangles have many.
        let is_large: Vec<bool> =
            flats.iter().map(|flat| flat.area > LARGE && !flat.is_triangle(mesh, total)).collect();
        // A plane that goes over into rounded edges is none of their flats.
        let mut is_plane = is_large.clone();
        for [a, b] in blunt().flat_map(|crease| [crease.flats, [crease.flats[1], crease.flats[0]]]) {
            is_plane[a] &= flats[a].area > PLANE * flats[b].area;
        }
        let mut sets = DisjointSets::new(flats.len());
        for [a, b] in
            blunt().map(|crease| crease.flats).filter(|pair| pair.iter().all(|flat| !is_plane[*flat]))
        {
            sets.union(a as u32, b as u32);
        }
        let mut members = vec![Vec::new(); flats.len()];
        (0..flats.len()).for_each(|flat| members[sets.find(flat as u32) as usize].push(flat));
        members.retain(|members| !members.is_empty());
        let mut of_flat = vec![0; flats.len()];
        members.iter().enumerate().for_each(|(i, flats)| flats.iter().for_each(|&flat| of_flat[flat] = i));
        let mut corners = vec![Vec::new(); members.len()];
        for crease in blunt() {
            let regions = crease.flats.map(|flat| of_flat[flat]);
            let is_inside = regions[0] == regions[1];
            regions.iter().for_each(|&region| corners[region].extend(crease.ends.map(|p| (p, is_inside))));
        }
        let (mut plain, mut wide) = (0.0, 0);
        let all: Vec<SmoothRegion> = members
            .iter()
            .zip(&corners)
            .map(|(members, corners)| {
                let region = region(mesh, &flats, members, corners);
                let is_plane = matches!(region.shape, RegionShape::Plane { .. }) && is_large[members[0]];
                if is_plane || (matches!(region.shape, RegionShape::Cylinder { .. }) && region.area > LARGE) {
                    plain += region.area;
                    let n_faces = flats[members[0]].faces.len();
                    wide += usize::from(is_plane && corners.is_empty() && n_faces >= WIDE);
                }
                region
            })
            .collect();
        let is_mechanical = (plain >= MECHANICAL || wide >= MIN_WIDE) && is_body(mesh);
        let sharp = if is_mechanical { SHARP } else { ORGANIC_SHARP }.to_radians();
        let blunt = creases.iter().filter(|crease| crease.turn < sharp);
        let chord_errors = chord_errors(mesh, &flats, &of_face, blunt);
        let of_face = of_face.into_iter().map(|flat| of_flat[flat]).collect();
        Self { all, of_face, chord_errors, is_mechanical }
    }

    /// Directions of planes and axes with the share of the area across or around them, the largest first.
    pub fn directions(&self) -> Vec<(Vector3<f64>, f64)> {
        let mut all: Vec<(Vector3<f64>, f64)> = Vec::new();
        for region in self.all.iter().filter(|region| region.area > LARGE) {
            let direction = match region.shape {
                RegionShape::Plane { normal, .. } => normal,
                RegionShape::Cylinder { axis, .. } => axis,
                RegionShape::Curved => continue,
            };
            match all.iter_mut().find(|(known, _)| known.dot(&direction).abs() > Self::PARALLEL) {
                Some((_, area)) => *area += region.area,
                None => all.push((direction, region.area)),
            }
        }
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all
    }
}

/// Whether a surface encloses a volume, at least in part. Sheets bend.
fn is_body(mesh: &TriMesh) -> bool {
    let sum: Vector3<f64> = (0..mesh.n_faces()).map(|f| mesh.area_vector(f)).sum();
    sum.norm() < MAX_OPEN * 2.0 * mesh.area()
}

/// Grows flats from the largest triangles, and tells the flat of every face.
fn flats(mesh: &TriMesh, topology: &Topology) -> (Vec<Flat>, Vec<usize>) {
    const NONE: usize = usize::MAX;
    let vectors: Vec<Vector3<f64>> = (0..mesh.n_faces()).map(|f| mesh.area_vector(f)).collect();
    let (total, unit) = (mesh.area(), mesh.root_of_area());
    let [near, sliver] = [IN_PLANE * unit, IN_PLANE * total];
    let mut order: Vec<usize> = (0..mesh.n_faces()).collect();
    let sq_area = |f: usize| vectors[f].norm_squared();
    order.sort_unstable_by(|&f, &g| sq_area(g).total_cmp(&sq_area(f)).then(f.cmp(&g)));
    let mut of_face = vec![NONE; mesh.n_faces()];
    let (mut flats, mut pending) = (Vec::new(), Vec::new());
    for seed in order {
        if of_face[seed] != NONE {
            continue;
        }
        let normal = vectors[seed].try_normalize(0.0).unwrap_or_default();
        let origin = mesh.triangle(seed)[0];
        let in_plane = |f: usize| {
            let is_near = mesh.triangle(f).iter().all(|p| normal.dot(&(p - origin)).abs() < near);
            // The normal of a sliver is rounding.
            is_near && vectors[f].dot(&normal) > -sliver
        };
        let mut flat = Flat { normal, faces: Vec::new(), area: 0.0 };
        pending.push(seed);
        of_face[seed] = flats.len();
        while let Some(f) = pending.pop() {
            flat.faces.push(f);
            flat.area += 0.5 * vectors[f].norm() / total;
            for corner in surface::FaceId::from(f).corners() {
                for &other in topology.edge_corners(topology.opposite_edge(corner)) {
                    let g = other.face().index();
                    if of_face[g] == NONE && in_plane(g) {
                        of_face[g] = flats.len();
                        pending.push(g);
                    }
                }
            }
        }
        flats.push(flat);
    }
    (flats, of_face)
}

fn creases(mesh: &TriMesh, topology: &Topology, flats: &[Flat], of_face: &[usize]) -> Vec<Crease> {
    let edges = (0..topology.n_edges()).filter_map(|e| {
        let edge = EdgeId::from(e);
        let &[a, b] = topology.edge_corners(edge) else { return None };
        let flats_of = [a, b].map(|corner| of_face[corner.face().index()]);
        let [f, g] = flats_of.map(|flat| &flats[flat]);
        // Both may be oriented alike or not.
        let sign = if has_same_direction(topology, a, b) { -1.0 } else { 1.0 };
        let turn = f.normal.cross(&g.normal).norm().atan2(sign * f.normal.dot(&g.normal));
        let ends = topology.edges()[e].map(|v| mesh.positions[v.index()]);
        (flats_of[0] != flats_of[1]).then_some(Crease { flats: flats_of, ends, turn })
    });
    edges.collect()
}

/// How far a curved surface may be from every face: the height of the arcs over the flats whose normals turn at their
/// edges. Of the flats at an edge, the narrower one tells how wide the chords are.
fn chord_errors<'c>(
    mesh: &TriMesh,
    flats: &[Flat],
    of_face: &[usize],
    creases: impl Iterator<Item = &'c Crease>,
) -> Vec<f64> {
    let mut of_flat = vec![0.0f64; flats.len()];
    for crease in creases {
        let width = crease.flats.map(|flat| width(mesh, &flats[flat], crease.ends));
        let error = 0.5 * f64::min(width[0], width[1]) * (crease.turn / 4.0).tan();
        if error.is_finite() {
            crease.flats.iter().for_each(|&flat| of_flat[flat] = of_flat[flat].max(error));
        }
    }
    let mut of_vertex = vec![0.0f64; mesh.n_vertices()];
    for (f, face) in mesh.faces.iter().enumerate() {
        face.iter().for_each(|v| of_vertex[v.index()] = of_vertex[v.index()].max(of_flat[of_face[f]]));
    }
    mesh.faces.iter().map(|face| face.iter().map(|v| of_vertex[v.index()]).fold(0.0, f64::max)).collect()
}

/// How far a flat reaches from one of its edges.
fn width(mesh: &TriMesh, flat: &Flat, [start, end]: [Point3<f64>; 2]) -> f64 {
    if flat.faces.len() > MAX_CORNERS {
        return f64::INFINITY;
    }
    let Some(along) = (end - start).try_normalize(0.0) else { return 0.0 };
    let corners = flat.faces.iter().flat_map(|&f| mesh.triangle(f));
    corners.map(|p| (p - start).cross(&along).norm()).fold(0.0, f64::max)
}

/// The region of some flats. `corners` are the ends of their blunt edges, and whether these are inside the region.
fn region(
    mesh: &TriMesh,
    flats: &[Flat],
    members: &[usize],
    corners: &[(Point3<f64>, bool)],
) -> SmoothRegion {
    let area = members.iter().map(|&flat| flats[flat].area).sum();
    let shape = match members {
        [flat] => {
            let flat = &flats[*flat];
            RegionShape::Plane {
                normal: flat.normal,
                offset: flat.normal.dot(&mesh.triangle(flat.faces[0])[0].coords),
            }
        }
        _ => cylinder(mesh, flats, members, corners).unwrap_or(RegionShape::Curved),
    };
    SmoothRegion { shape, area }
}

/// The cylinder through flats, if there is one. Its circle has the corners between them: others may be on chords.
fn cylinder(
    mesh: &TriMesh,
    flats: &[Flat],
    members: &[usize],
    corners: &[(Point3<f64>, bool)],
) -> Option<RegionShape> {
    let covariance: Matrix3<f64> = members
        .iter()
        .map(|&flat| flats[flat].normal * flats[flat].normal.transpose() * flats[flat].area)
        .sum();
    let eigen = covariance.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    // Normals of a shallow cone are near to a plane as well, and to a line.
    if eigen.eigenvalues[least] > ACROSS * (eigen.eigenvalues.sum() - eigen.eigenvalues.max()) {
        return None;
    }
    let axis = Unit::new_normalize(eigen.eigenvectors.column(least).into_owned());
    let u = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
    let v = axis.cross(&u);
    let flat = |p: &Point3<f64>| Vector2::new(u.dot(&p.coords), v.dot(&p.coords));
    let faces = || members.iter().flat_map(|&flat| flats[flat].faces.iter().copied());
    // A fillet of three flats has two edges inside; planes that touch it begin on the circle, too, and others on a chord.
    let (center, radius) = [true, false].into_iter().find_map(|only_inside| {
        let counted = corners.iter().filter(|(_, is_inside)| *is_inside || !only_inside);
        circle_through(&counted.map(|(p, _)| flat(p)).collect::<Vec<_>>())
    })?;
    // The corners of a rectangle are on a circle, too, but not what is between them.
    let middles = faces().flat_map(|f| {
        let [a, b, c] = mesh.triangle(f).map(|p| flat(&p));
        [a + b, b + c, c + a].map(|sum| 0.5 * sum)
    });
    let least = middles.map(|p| (p - center).norm()).fold(f64::INFINITY, f64::min);
    if least < (1.0 - SmoothRegions::ROUND) * radius {
        return None;
    }
    let outward: f64 = faces()
        .map(|f| {
            let middle = mesh.triangle(f).iter().map(&flat).sum::<Vector2<f64>>() / 3.0 - center;
            let normal = mesh.area_vector(f);
            middle.dot(&Vector2::new(u.dot(&normal), v.dot(&normal)))
        })
        .sum();
    Some(RegionShape::Cylinder { axis: axis.into_inner(), radius, is_hole: outward < 0.0 })
}

/// The center and the radius of the circle through points, if there is one.
pub fn circle_through(points: &[Vector2<f64>]) -> Option<(Vector2<f64>, f64)> {
    let center = center_of_circle(points)?;
    let radii = points.iter().map(|p| (p - center).norm());
    let (radius, least) = (radii.clone().fold(0.0, f64::max), radii.fold(f64::INFINITY, f64::min));
    (least > (1.0 - ON_CIRCLE) * radius).then_some((center, radius))
}

/// The center of the circle nearest to points, in algebraic least squares (Kåsa 1976); `None` for points on a line.
fn center_of_circle(points: &[Vector2<f64>]) -> Option<Vector2<f64>> {
    let mean = points.iter().sum::<Vector2<f64>>() / points.len().max(1) as f64;
    let (mut matrix, mut right) = (Matrix2::zeros(), Vector2::zeros());
    let mean_square =
        points.iter().map(|p| (p - mean).norm_squared()).sum::<f64>() / points.len().max(1) as f64;
    for d in points.iter().map(|p| p - mean) {
        matrix += d * d.transpose();
        right += d * (0.5 * (d.norm_squared() - mean_square));
    }
    let is_line = matrix.determinant() < ON_LINE * matrix.trace().powi(2);
    Some(mean + matrix.try_inverse().filter(|_| !is_line)? * right)
}
