//! Whether two surfaces are one, by their distance in space.

use descriptors::Boundary;

use super::geometry::MeshGeometry;
use super::in_space::SurfaceGap;
use super::mesh_change::MeshChange;

/// Two triangulations of one surface are at most this far apart, root mean square and times the number of vertices of the
/// coarser one, relative to the size: the error of flat triangles. Measured on the built-in families with 200 to 10,000 vertices
/// (`cargo test -p tests --test laws -- matches --nocapture`), where decimation brings the largest.
const FLATNESS: f64 = 0.7;

/// What else is allowed in copies of one surface. Measured as [`FLATNESS`]. Two bodies of one family in one pose are at least 0.0045 apart there, two
/// poses 0.037.
const ALLOWED: f64 = 0.0015;

/// What noise adds: 0.5 % of the diagonal is 0.0054, measured as [`FLATNESS`].
const ALLOWED_NOISE: f64 = 0.006;

/// How far vertices may be apart on which independent noise is the only change, which needs no small distance to be told.
/// A safety limit.
const MOST_NOISE: f64 = 0.02;

/// The odds of one surface are `(limit / distance)^STEEPNESS`. The distances measured as [`FLATNESS`] are then told with 90 % and
/// more.
const STEEPNESS: f64 = 6.0;

/// The probability that surfaces this far apart are one surface.
pub(super) fn same_surface(gap: SurfaceGap, meshes: [&MeshGeometry; 2], change: MeshChange) -> f64 {
    let fewest = meshes.map(MeshGeometry::n_vertices).into_iter().min().unwrap_or(1).max(1);
    let at = match change {
        MeshChange::Noisy => MOST_NOISE,
        _ if meshes.iter().any(|mesh| mesh.is_noisy()) => {
            ALLOWED + ALLOWED_NOISE + 2.0 * FLATNESS / fewest as f64
        }
        _ => ALLOWED + 2.0 * FLATNESS / fewest as f64,
    };
    Boundary { at, steepness: STEEPNESS }.probability(gap.rms)
}
