//! Surfaces prepared to be aligned in space.

use std::sync::OnceLock;

use mesh::{SmoothRegions, TriMesh};
use nalgebra::{Point3, Vector3};

use crate::icp::Body;
use crate::point_set::PointSet;
use crate::triangles::TriangleTree;

/// Points of a surface that look for their nearest points on another one. A limit of effort.
const SAMPLES: usize = 2000;

/// A surface at unit area, about its centroid. What an alignment needs of it is made when it is first asked for.
#[derive(Debug)]
pub struct RigidSurface {
    mesh: TriMesh,
    /// The square root of the area, in mesh units.
    pub size: f64,
    /// The centroid of the surface, in mesh units.
    pub center: Point3<f64>,
    /// Root mean square distance of the surface from its centroid along its principal axes, descending, at unit area.
    pub axis_std: [f64; 3],
    samples: OnceLock<Vec<Point3<f64>>>,
    tree: OnceLock<TriangleTree>,
    points: OnceLock<Option<PointSet>>,
    regions: OnceLock<SmoothRegions>,
}

impl RigidSurface {
    /// The surface of a mesh in any unit and place. `None` without a finite area.
    pub fn new(mut mesh: TriMesh) -> Option<Self> {
        let size = mesh.root_of_area();
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        let origin = mesh.bounds()?[0];
        mesh.positions.iter_mut().for_each(|p| *p = Point3::from((*p - origin) / size));
        let (centroid, covariance) = mesh.moments();
        mesh.positions.iter_mut().for_each(|p| *p -= centroid);
        let mut axis_std: [f64; 3] = covariance.symmetric_eigenvalues().map(|x| x.max(0.0).sqrt()).into();
        axis_std.sort_by(|a, b| b.total_cmp(a));
        Some(Self::from_parts(mesh, size, origin + centroid * size, axis_std))
    }

    /// A surface again, from its [mesh](Self::mesh), size, center and deviations along the axes.
    pub fn from_parts(mesh: TriMesh, size: f64, center: Point3<f64>, axis_std: [f64; 3]) -> Self {
        let (samples, tree, points, regions) = Default::default();
        Self { mesh, size, center, axis_std, samples, tree, points, regions }
    }

    /// The mesh at unit area, about its centroid.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Root mean square distance of the surface from its centroid, at unit area. Noise changes it less than the size.
    pub(crate) fn rms_radius(&self) -> f64 {
        rms_radius(self.axis_std)
    }

    /// The tree that finds nearest points.
    pub fn tree(&self) -> &TriangleTree {
        self.tree.get_or_init(|| TriangleTree::new(&self.mesh))
    }

    /// The samples at unit rms radius.
    pub(crate) fn points(&self) -> Option<&PointSet> {
        let prepare = || {
            let radius = self.rms_radius();
            let points: Vec<_> = self.samples().iter().map(|p| p / radius).collect();
            PointSet::new(&points, &vec![1.0 / points.len() as f64; points.len()]).ok()
        };
        self.points.get_or_init(prepare).as_ref()
    }

    /// The principal axes of the samples, in the order of their deviations.
    pub(crate) fn principal_axes(&self) -> Option<[Vector3<f64>; 3]> {
        let axes = self.points()?.to_principal.rotation;
        Some([0, 1, 2].map(|i| axes.row(i).transpose()))
    }

    /// The smooth pieces between sharp edges.
    pub fn regions(&self) -> &SmoothRegions {
        self.regions.get_or_init(|| SmoothRegions::of(&self.mesh))
    }

    /// Whether planes and cylinders with sharp edges between them make up the surface, as in parts of machines.
    pub fn is_mechanical(&self) -> bool {
        self.regions().is_mechanical
    }
}

/// The root mean square distance of a surface from its centroid, from those along its principal axes.
pub fn rms_radius(axis_std: [f64; 3]) -> f64 {
    axis_std.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl Body for RigidSurface {
    fn samples(&self) -> &[Point3<f64>] {
        self.samples.get_or_init(|| sampled(&self.mesh))
    }

    fn nearest(
        &self,
        query: &Point3<f64>,
        known: Option<&Point3<f64>>,
    ) -> Option<(Point3<f64>, Vector3<f64>)> {
        self.tree().nearest_from(query, known).map(|near| (near.point, near.normal))
    }
}

/// Points of a surface, one in each of [`SAMPLES`] pieces of equal area; any leading part of them is spread evenly, too.
fn sampled(mesh: &TriMesh) -> Vec<Point3<f64>> {
    // Steps of a sequence whose leading points fill a square evenly (Roberts' generalized golden ratio).
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    // The prime nearest to the golden ratio of the number of samples.
    const STRIDE: usize = 1237;
    let total: f64 = mesh.face_areas().sum();
    let mut points = Vec::with_capacity(SAMPLES);
    let mut sum = 0.0;
    for (f, area) in mesh.face_areas().enumerate() {
        sum += area / total;
        while points.len() < SAMPLES && (points.len() as f64 + 0.5) / (SAMPLES as f64) < sum {
            let [mut u, mut v] = STEPS.map(|step| (0.5 + step * points.len() as f64).fract());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            let [a, b, c] = mesh.triangle(f);
            points.push(a + (b - a) * u + (c - a) * v);
        }
    }
    (0..points.len()).map(|i| points[i * STRIDE % points.len()]).collect()
}
