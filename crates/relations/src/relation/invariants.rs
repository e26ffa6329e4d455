//! Numbers of a surface that tell cheaply that two surfaces are not one.

use super::calibration::{ARCS, EXACT};
use super::geometry::MeshGeometry;
use super::same_surface::{euler_characteristic_if_closed, rms_chord_error};

/// Spreads of organic copies, at unit area, differ by less than this, by decimation, noise and holes. A safety limit: it saves
/// time.
const MOST_OF_BODIES: f64 = 0.05;

/// What copies of one surface have in common, whatever their triangles, places and sizes.
///
/// ```
/// use canonform_relations::MeshGeometry;
/// use mesh::shapes;
///
/// let [cube, finer, rod] = [shapes::cube(2), shapes::cube(5), shapes::cylinder(24, 4, 1.0, 2.0)]
///     .map(|mesh| MeshGeometry::new(&mesh, None).unwrap().invariants());
/// assert!(cube.may_be_copy_of(&finer) && !cube.may_be_copy_of(&rod));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceInvariants {
    /// Number of vertices in different positions.
    pub n_vertices: usize,
    /// Root mean square distance from the centroid along the principal axes, descending, at unit area.
    pub spreads: [f64; 3],
    /// The enclosed volume at unit area, and the Euler characteristic; `None` for surfaces that are not closed.
    pub closed: Option<(f64, isize)>,
    /// Root mean square of the error of flat triangles, at unit area; `None` unless the surface is mechanical.
    pub chords: Option<f64>,
    /// How far vertices of a part are from its planes, root mean square, at unit area.
    pub noise: f64,
}

impl SurfaceInvariants {
    /// Whether two surfaces may be one. If not, no alignment need be tried.
    #[must_use]
    pub fn may_be_copy_of(&self, other: &Self) -> bool {
        let spread = self.spreads.iter().zip(&other.spreads).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        let (Some(a), Some(b)) = (self.chords, other.chords) else { return spread < MOST_OF_BODIES };
        let flatness = if self.n_vertices == other.n_vertices { 0.0 } else { a + b };
        let most = EXACT + ARCS * flatness + self.noise + other.noise;
        let is_same_solid = match (self.closed, other.closed) {
            (Some((x, handles)), Some((y, others))) => handles == others && (x - y).abs() < most,
            _ => true,
        };
        spread < most && is_same_solid
    }
}

impl MeshGeometry {
    /// Its invariants.
    #[must_use]
    pub fn invariants(&self) -> SurfaceInvariants {
        let volume = |euler| (self.mesh().signed_volume().abs(), euler);
        SurfaceInvariants {
            n_vertices: self.n_vertices(),
            spreads: self.surface.axis_std(),
            closed: euler_characteristic_if_closed(&self.mesh().topology()).map(volume),
            chords: self.is_mechanical().then(|| rms_chord_error(self)),
            noise: self.noise().unwrap_or_default(),
        }
    }
}
