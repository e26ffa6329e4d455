//! Numbers of a surface that tell cheaply that two surfaces are not one.

use rigid::{MAX_DEVIATION, axis_deviation, rms_radius};

use super::calibration::{ARCS, EXACT, FARTHEST, MAX_NOISE, PARTS};
use super::geometry::MeshGeometry;
use super::same_surface::{allowed_in_bodies, rms_chord_error};

/// Spreads of closed bodies differ by less than this multiple of what copies may be apart, both as shares of the rms radius: each
/// of the two by once of it at most (Minkowski), and as much again for the area that decimation takes from thin limbs.
const SPREAD_BY_GAP: f64 = 4.0;

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
    /// Vertices without which a part would be another one: as many if triangles are divided. All of a body.
    pub n_needed: usize,
    /// Root mean square distance from the centroid along the principal axes, descending, at unit area.
    pub spreads: [f64; 3],
    /// The distance of the farthest vertex from the centroid, at unit area.
    pub reach: f64,
    /// The enclosed volume at unit area, and the Euler characteristic; `None` for surfaces that are not closed.
    pub closed: Option<(f64, isize)>,
    /// Root mean square of the error of flat triangles, at unit area.
    pub chords: f64,
    /// Whether it is a part of planes and cylinders, which does not bend.
    pub is_mechanical: bool,
    /// Whether vertices have noise that is independent of their neighbors'.
    pub is_noisy: bool,
    /// How far vertices of a part are from its planes, root mean square, at unit area.
    pub noise: f64,
}

impl SurfaceInvariants {
    /// Whether two surfaces may be one. If not, no alignment need be tried.
    pub fn may_be_copy_of(&self, other: &Self) -> bool {
        if !(self.is_mechanical && other.is_mechanical) {
            return axis_deviation(self.spreads, other.spreads) < self.most_of_bodies(other);
        }
        let noise = self.noise + other.noise;
        let is_exact = noise < EXACT / FARTHEST;
        let by_radius = rms_radius(self.spreads) / rms_radius(other.spreads);
        // Noise enlarges the area, so the unit of a noisy surface is another one.
        let unit = if is_exact { 1.0 } else { by_radius };
        let apart = self.spreads.iter().zip(&other.spreads).map(|(x, y)| (x - unit * y).abs());
        let spread = apart.fold(0.0, f64::max);
        // Divided triangles leave arcs as they are; with noise, every vertex is needed.
        let is_divided = self.n_needed == other.n_needed && is_exact;
        let are_same_arcs = self.n_vertices == other.n_vertices || is_divided;
        let flatness = if are_same_arcs { 0.0 } else { self.chords + other.chords };
        let most = EXACT + ARCS * flatness + noise;
        let is_same_solid = match (self.closed, other.closed) {
            (Some((x, handles)), Some((y, others))) => {
                handles == others && (x - unit.powi(3) * y).abs() < most
            }
            _ => true,
        };
        // Arcs change the area, and the length of a thin part at unit area with it.
        let reach = (self.reach - by_radius * other.reach).abs();
        reach < most + (PARTS * FARTHEST - 1.0) * noise && spread < most && is_same_solid
    }

    /// How much the spreads of copies of a body may differ, as a share of the rms radius.
    fn most_of_bodies(&self, other: &Self) -> f64 {
        // A hole takes what was there from the spreads.
        if self.closed.is_none() || other.closed.is_none() {
            return MAX_DEVIATION;
        }
        // Of the same faces, noise may be the only change.
        let allowed = match self.n_vertices == other.n_vertices {
            true => MAX_NOISE,
            false => allowed_in_bodies(self.chords + other.chords, self.is_noisy || other.is_noisy),
        };
        let radius = rms_radius(self.spreads).min(rms_radius(other.spreads));
        MAX_DEVIATION.min(SPREAD_BY_GAP * allowed / radius)
    }
}

impl MeshGeometry {
    /// Its invariants.
    pub fn invariants(&self) -> SurfaceInvariants {
        let is_mechanical = self.is_mechanical();
        SurfaceInvariants {
            n_vertices: self.n_vertices(),
            n_needed: if is_mechanical { self.exactness().n_needed } else { self.n_vertices() },
            spreads: self.surface.axis_std,
            reach: self.mesh().positions.iter().map(|p| p.coords.norm()).fold(0.0, f64::max),
            closed: self.closed(),
            chords: rms_chord_error(self),
            is_mechanical,
            is_noisy: self.is_noisy(),
            noise: if is_mechanical { self.noise().unwrap_or_default() } else { 0.0 },
        }
    }
}
