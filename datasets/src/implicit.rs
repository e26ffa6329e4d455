//! The rest-pose body as an implicit function: negative inside, positive outside.
//!
//! A body is a list of parts, and a part is a list of blobs (round cones). Unions are smooth; every blob and
//! part has its own blending radius, so that a toe blends into its foot but not into the other foot. The
//! function has the Lipschitz constant 1, which the search for the surface needs.

use nalgebra::{Point3, Vector3};

/// Value and gradient of an implicit function at a point.
pub(crate) type ImplicitSample = (f64, Vector3<f64>);

/// A round cone: the convex hull of two balls, possibly flattened along one direction.
#[derive(Debug, Clone)]
pub(crate) struct Blob {
    ends: [Point3<f64>; 2],
    radii: [f64; 2],
    /// Unit direction, and the factor below one by which the thickness along it is multiplied.
    flattening: Option<(Vector3<f64>, f64)>,
    /// Blending radius of the union with the blobs before it; see [`smooth_min`].
    blend: f64,
    axis: ConeAxis,
}

/// Precomputed values for the distance to a round cone.
#[derive(Debug, Clone)]
struct ConeAxis {
    start: Vector3<f64>,
    direction: Vector3<f64>,
    length: f64,
    /// Loss of radius per unit of length, the sine of the cone's half angle.
    taper: f64,
    /// Its tangent.
    slope: f64,
    scale: f64,
}

impl Blob {
    /// The hull of two balls, given by center and radius, and the blending radius of its union with the blobs before it in the part.
    /// Flattening squeezes it to a factor below one of its thickness along a direction.
    pub(crate) fn new(balls: [[f64; 4]; 2], flattening: Option<([f64; 3], f64)>, blend: f64) -> Self {
        let flattening = flattening.map(|(direction, factor)| (Vector3::from(direction).normalize(), factor));
        let (ends, [ra, rb]) = (balls.map(|[x, y, z, _]| Point3::new(x, y, z)), balls.map(|ball| ball[3]));
        let [a, b] = ends.map(|p| stretched(p.coords, flattening));
        let length = (b - a).norm();
        // If one ball contains the other, only the larger one counts.
        let (start, direction, length, taper, radii) = if length <= (ra - rb).abs() {
            (if ra >= rb { a } else { b }, Vector3::zeros(), 0.0, 0.0, [ra.max(rb); 2])
        } else {
            (a, (b - a) / length, length, (ra - rb) / length, [ra, rb])
        };
        let slope = taper / (1.0 - taper * taper).sqrt();
        let scale = flattening.map_or(1.0, |(_, factor)| factor);
        let axis = ConeAxis { start, direction, length, taper, slope, scale };
        Self { ends, radii, flattening, blend, axis }
    }

    /// The value, a lower bound of the distance to the blob that is exact unless the blob is flattened, and its gradient.
    ///
    /// The foot is the point where the surface normal through `p` meets the axis. A cone that loses `sin(a)`
    /// of its radius per unit of length has normals tilted by `a`, so the foot lies `rho tan(a)` before the
    /// projection of `p`, where `rho` is the distance of `p` from the axis.
    fn sample(&self, p: Point3<f64>) -> ImplicitSample {
        let axis = &self.axis;
        let q = stretched(p.coords, self.flattening) - axis.start;
        let along = q.dot(&axis.direction);
        let rho = (q.norm_squared() - along * along).max(0.0).sqrt();
        let foot = (along - rho * axis.slope).clamp(0.0, axis.length);
        let away = q - axis.direction * foot;
        let distance = away.norm();
        let value = axis.scale * (distance - (self.radii[0] - foot * axis.taper));
        if distance == 0.0 {
            return (value, Vector3::zeros());
        }
        // The stretch is symmetric: the chain rule needs no transpose.
        (value, stretched(away / distance, self.flattening) * axis.scale)
    }
}

/// Stretches space such that a flattened blob becomes a true round cone.
fn stretched(p: Vector3<f64>, flattening: Option<(Vector3<f64>, f64)>) -> Vector3<f64> {
    match flattening {
        None => p,
        Some((direction, factor)) => p + direction * ((1.0 / factor - 1.0) * direction.dot(&p)),
    }
}

/// Blobs that belong together: an arm, a head.
#[derive(Debug, Clone)]
pub(crate) struct BodyPart {
    blobs: Vec<Blob>,
    /// Whether it is subtracted from the body so far, not added.
    carves: bool,
    /// Blending radius of the union with the parts before it.
    blend: f64,
    center: Point3<f64>,
    radius: f64,
    /// Smallest flattening factor.
    scale: f64,
    /// The most by which blending lowers the value below that of the nearest blob.
    slack: f64,
}

impl BodyPart {
    /// A part that is added, or that `carves`: it is subtracted from the body so far; and the blending radius of that.
    pub(crate) fn new(carves: bool, blobs: Vec<Blob>, blend: f64) -> Self {
        let ends = || blobs.iter().flat_map(|b| b.ends);
        let n = (2 * blobs.len()).max(1) as f64;
        let center = Point3::from(ends().fold(Vector3::zeros(), |sum, p| sum + p.coords) / n);
        let reach = |b: &Blob| (0..2).map(|i| (b.ends[i] - center).norm() + b.radii[i]).fold(0.0, f64::max);
        let radius = blobs.iter().map(reach).fold(0.0, f64::max);
        let scale = blobs.iter().map(|b| b.axis.scale).fold(1.0, f64::min);
        let slack = blobs.iter().map(|b| 0.25 * b.blend).sum();
        Self { blobs, carves, blend, center, radius, scale, slack }
    }

    fn sample(&self, p: Point3<f64>) -> ImplicitSample {
        self.blobs
            .iter()
            .fold((f64::INFINITY, Vector3::zeros()), |sum, blob| smooth_min(sum, blob.sample(p), blob.blend))
    }

    /// Whether the part can change the value `so_far` at `p`. Skipping it otherwise is exact: beyond its
    /// blending radius a smooth union returns the smaller operand.
    fn may_change(&self, p: Point3<f64>, so_far: f64) -> bool {
        let operand = if self.carves { -so_far } else { so_far };
        // A lower bound of the part's value that costs one square root.
        let lowest = self.scale * ((p - self.center).norm() - self.radius) - self.slack;
        lowest < operand + self.blend
    }
}

/// The smaller of two values, smoothed where they differ by less than `reach`.
///
/// `min(a, b) - (reach - |a - b|)^2 / (4 reach)` is continuously differentiable, equals the smaller value
/// where they differ by more, and its gradient is a convex combination of the two.
fn smooth_min(a: ImplicitSample, b: ImplicitSample, reach: f64) -> ImplicitSample {
    let (near, far) = if a.0 <= b.0 { (a, b) } else { (b, a) };
    let overlap = reach - (far.0 - near.0);
    if overlap <= 0.0 {
        return near;
    }
    let weight = 0.5 * overlap / reach;
    (near.0 - 0.25 * overlap * overlap / reach, near.1 * (1.0 - weight) + far.1 * weight)
}

fn negated(s: ImplicitSample) -> ImplicitSample {
    (-s.0, -s.1)
}

/// A whole body.
#[derive(Debug, Clone)]
pub(crate) struct ImplicitBody {
    pub(crate) parts: Vec<BodyPart>,
    /// Whether the body is symmetric under `x -> -x`. Its parts then describe the half `x >= 0`.
    pub(crate) is_symmetric: bool,
}

impl ImplicitBody {
    /// Value and gradient at `p`. The value is 1-Lipschitz.
    pub(crate) fn sample(&self, p: Point3<f64>) -> ImplicitSample {
        // The point of the described half that has the same value.
        let folded = if self.is_symmetric { Point3::new(p.x.abs(), p.y, p.z) } else { p };
        let mut sum = (f64::INFINITY, Vector3::zeros());
        for part in &self.parts {
            if part.may_change(folded, sum.0) {
                sum = match part.carves {
                    false => smooth_min(sum, part.sample(folded), part.blend),
                    true => negated(smooth_min(negated(sum), part.sample(folded), part.blend)),
                };
            }
        }
        if self.is_symmetric && p.x < 0.0 {
            sum.1.x = -sum.1.x;
        }
        sum
    }

    /// The value alone at `p`.
    pub(crate) fn value(&self, p: Point3<f64>) -> f64 {
        self.sample(p).0
    }

    /// Center, in the plane of symmetry if there is one, and radius of a ball around the body.
    pub(crate) fn bounding_ball(&self) -> (Point3<f64>, f64) {
        let added = || self.parts.iter().filter(|part| !part.carves);
        let n = added().count().max(1) as f64;
        let mut center = Point3::from(added().fold(Vector3::zeros(), |sum, p| sum + p.center.coords) / n);
        if self.is_symmetric {
            center.x = 0.0;
        }
        let slack: f64 = added().map(|p| p.slack + 0.25 * p.blend).sum();
        let radius = added().map(|p| (p.center - center).norm() + p.radius).fold(0.0, f64::max);
        (center, radius + slack)
    }

    /// A point of the surface near `p`, by Newton steps along the gradient.
    pub(crate) fn project(&self, mut p: Point3<f64>, n_steps: usize, longest: f64) -> Point3<f64> {
        for _ in 0..n_steps {
            let (value, gradient) = self.sample(p);
            let squared = gradient.norm_squared();
            if squared > 1e-6 {
                let step = (value / squared).clamp(-longest / squared.sqrt(), longest / squared.sqrt());
                p -= gradient * step;
            }
        }
        p
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_is_the_derivative_and_at_most_one() {
        let ball = |x, y, z, r| [[x, y, z, r]; 2];
        let head = vec![
            Blob::new(ball(4.0, 0.0, 0.0, 2.0), Some(([0.0, 1.0, 1.0], 0.4)), 0.0),
            Blob::new([[5.0, 0.0, 0.0, 1.0], [9.0, 0.0, 1.0, 0.5]], None, 0.7),
        ];
        let trunk = vec![Blob::new([[0.0, 0.0, 0.0, 3.0], [0.0, 1.0, 9.0, 1.5]], None, 0.0)];
        let mouth = vec![Blob::new(ball(0.0, -3.0, 3.0, 1.5), None, 0.0)];
        let parts = [(false, trunk, 0.0), (false, head, 1.0), (true, mouth, 0.5)];
        let parts = parts.map(|(carves, blobs, blend)| BodyPart::new(carves, blobs, blend)).into();
        let body = ImplicitBody { parts, is_symmetric: true };
        let h = 1e-6;
        for i in 0..1000 {
            let p = Point3::from([1, 10, 100].map(|place| f64::from(i / place % 10) * 2.3 - 10.1));
            let (_, gradient) = body.sample(p);
            assert!(gradient.norm() <= 1.0 + 1e-9);
            let slope = Vector3::from_fn(|i, _| {
                let mut step = Vector3::zeros();
                step[i] = h;
                (body.value(p + step) - body.value(p - step)) / (2.0 * h)
            });
            assert!((slope - gradient).norm() < 1e-4, "{p}: {slope} {gradient}");
        }
    }
}
