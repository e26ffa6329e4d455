//! In what two mechanical parts of one build differ: holes, bosses, lengths and steps.

use mesh::{RegionShape, SmoothRegion, SmoothRegions};
use nalgebra::Vector3;
use serde::Serialize;

use super::calibration::EXACT;
use super::extents::extents;
use super::geometry::MeshGeometry;
use super::numbers::in_four_digits;

/// Dimensions that differ by less than this share are equal: arcs of few segments are measured a little too small. Half and twice
/// as much change no answer.
const EQUAL: f64 = 2e-3;

/// No dimension of a variant differs by more than this factor: what differs more is another part.
const MAX_CHANGE: f64 = 2.5;

/// Surfaces this near to each other are variants even where their dimensions cannot be compared one by one: root mean
/// square, relative to the size. A convention.
const NEAR: f64 = 0.012;

/// What is measured of a part.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Dimension {
    /// Number of cylindrical holes.
    Holes,
    /// Diameter of a hole.
    HoleDiameter,
    /// Diameter of a cylinder that is not a hole.
    Diameter,
    /// The largest overall dimension.
    Length,
    /// The second overall dimension.
    Width,
    /// The smallest overall dimension.
    Height,
    /// The distance between two parallel planes.
    Step,
    /// The enclosed volume.
    Volume,
}

impl Dimension {
    fn words(self) -> &'static str {
        match self {
            Self::Holes => "number of holes",
            Self::HoleDiameter => "hole diameter",
            Self::Diameter => "diameter",
            Self::Length => "length",
            Self::Width => "width",
            Self::Height => "height",
            Self::Step => "step",
            Self::Volume => "volume",
        }
    }
}

/// A dimension in which two parts differ.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Difference {
    /// What differs.
    pub what: Dimension,
    /// In the first part, in units of its file.
    pub first: f64,
    /// In the second part.
    pub second: f64,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [first, second] = [self.first, self.second].map(in_four_digits);
        write!(f, "{} {first} → {second}", self.what.words())
    }
}

/// The dimensions of a part, in units of its file.
#[derive(Debug, Default)]
struct Dimensions {
    /// Regions that are planes, cylinders outside, and others.
    n_regions: [usize; 3],
    /// Diameters, ascending.
    holes: Vec<f64>,
    bosses: Vec<f64>,
    /// Overall, descending; none if nothing is flat or round.
    extents: Vec<f64>,
    /// Distances between neighboring planes in all directions, ascending.
    steps: Vec<f64>,
    /// The volume and the Euler characteristic.
    closed: Option<(f64, isize)>,
    size: f64,
}

impl Dimensions {
    fn new(part: &MeshGeometry) -> Self {
        let regions = &part.surface.regions().all;
        let mut found = Self {
            closed: part.closed().map(|(volume, euler)| (volume * part.size().powi(3), euler)),
            size: part.size(),
            ..Self::default()
        };
        for region in regions {
            match region.shape {
                RegionShape::Plane { .. } => found.n_regions[0] += 1,
                RegionShape::Cylinder { radius, is_hole: true, .. } => {
                    found.holes.push(2.0 * radius * part.size())
                }
                RegionShape::Cylinder { radius, .. } => {
                    found.n_regions[1] += 1;
                    found.bosses.push(2.0 * radius * part.size());
                }
                RegionShape::Curved => found.n_regions[2] += 1,
            }
        }
        [&mut found.holes, &mut found.bosses].into_iter().for_each(|all| all.sort_by(f64::total_cmp));
        let directions: Vec<Vector3<f64>> =
            part.surface.regions().directions().into_iter().map(|(d, _)| d).collect();
        found.steps = directions.iter().flat_map(|d| steps(regions, d)).map(|x| x * part.size()).collect();
        found.steps.sort_by(f64::total_cmp);
        let extents = directions.first().map(|main| extents(&part.mesh().positions, main));
        found.extents = extents.into_iter().flatten().map(|x| x * part.size()).collect();
        found
    }
}

/// Distances between neighboring planes across a direction.
fn steps(regions: &[SmoothRegion], direction: &Vector3<f64>) -> Vec<f64> {
    let offset = |region: &SmoothRegion| match region.shape {
        RegionShape::Plane { normal, offset } if normal.dot(direction).abs() > SmoothRegions::PARALLEL => {
            Some(offset * normal.dot(direction).signum())
        }
        _ => None,
    };
    let mut offsets: Vec<f64> = regions.iter().filter_map(offset).collect();
    offsets.sort_by(f64::total_cmp);
    offsets.dedup_by(|a, b| (*a - *b).abs() < EXACT);
    offsets.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

/// In what two mechanical parts differ, if they are variants of one part. `rms` is how far their surfaces are apart, if
/// they can be laid over each other at one size.
pub(super) fn differences([a, b]: [&MeshGeometry; 2], rms: Option<f64>) -> Option<Vec<Difference>> {
    if !(a.is_exact_part() && b.is_exact_part()) {
        return None;
    }
    let [a, b] = [a, b].map(Dimensions::new);
    let tolerance = EXACT * f64::max(a.size, b.size);
    let differs = |x: f64, y: f64| (x - y).abs() > tolerance + EQUAL * f64::max(x, y);
    let mut found = Vec::new();
    // Of as many on either side.
    let mut compare = |what: Dimension, x: &[f64], y: &[f64]| {
        if x.len() == y.len() {
            let pairs = x.iter().copied().zip(y.iter().copied()).filter(|(x, y)| differs(*x, *y));
            found.extend(pairs.map(|(first, second)| Difference { what, first, second }));
        }
    };
    compare(Dimension::HoleDiameter, &a.holes, &b.holes);
    compare(Dimension::Diameter, &a.bosses, &b.bosses);
    for (i, what) in [Dimension::Length, Dimension::Width, Dimension::Height].into_iter().enumerate() {
        let [x, y] = [&a, &b].map(|part| part.extents.get(i..=i).unwrap_or_default());
        compare(what, x, y);
    }
    compare(Dimension::Step, &a.steps, &b.steps);
    let is_extent = |x: f64| a.extents.iter().chain(&b.extents).any(|y| !differs(x, *y));
    found.retain(|d| d.what != Dimension::Step || !(is_extent(d.first) || is_extent(d.second)));
    let same_holes = a.holes.len() == b.holes.len();
    let same_build = a.n_regions == b.n_regions;
    let is_near = found.iter().all(|d| f64::max(d.first / d.second, d.second / d.first) <= MAX_CHANGE);
    if !same_holes {
        let [first, second] = [a.holes.len() as f64, b.holes.len() as f64];
        found.insert(0, Difference { what: Dimension::Holes, first, second });
    }
    if found.is_empty()
        && let (Some((first, _)), Some((second, _))) = (a.closed, b.closed)
        && (first - second).abs() > EQUAL * f64::max(first, second)
    {
        found.push(Difference { what: Dimension::Volume, first, second });
    }
    // Holes of one size are one difference.
    found.dedup_by(|x, y| x.what == y.what && !differs(x.first, y.first) && !differs(x.second, y.second));
    let same_parts = same_build && (same_holes || a.closed.map(|x| x.1) != b.closed.map(|x| x.1));
    let is_variant = (same_parts || rms.is_some_and(|rms| rms < NEAR)) && is_near && !found.is_empty();
    is_variant.then_some(found)
}
