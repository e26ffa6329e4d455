//! Iterative closest points.

use std::ops::Range;

use nalgebra::{Point3, Rotation3, SMatrix, SVector, Vector3};
use serde::Serialize;

use crate::similarity::Similarity;

/// A step that reduces the mean square distance by less than this share is the last. A tolerance.
const MIN_GAIN: f64 = 2e-3;

/// The damping of steps in shares of the trace (Levenberg and Marquardt): a step that is too long is made again, shorter. Limits
/// of effort; bodies that are round may turn.
pub const MIN_DAMPING: f64 = 1e-9;
const MAX_DAMPING: f64 = 1e-2;

/// How far two bodies are apart.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gap {
    /// Root mean square distance from points of either body to the other.
    pub rms: f64,
    /// The largest of these distances.
    pub max: f64,
}

/// Two bodies laid over each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// Takes the first body onto the second.
    pub map: Similarity,
    /// How far they stay apart, in the unit of the second.
    pub gap: Gap,
}

/// What is aligned: samples, which look for their nearest points on another body.
pub(crate) trait Body {
    /// Points of the body, of which any leading part is spread evenly.
    fn samples(&self) -> &[Point3<f64>];

    /// The nearest point of the body, and the unit normal there; no normal of a body of points. `known` is a point of it that may
    /// be near.
    fn nearest(
        &self,
        query: &Point3<f64>,
        known: Option<&Point3<f64>>,
    ) -> Option<(Point3<f64>, Vector3<f64>)>;
}

/// A point of the first body under a map, the point of the second that is as near as can be, and the normal there.
pub(crate) struct Contact {
    from: Point3<f64>,
    to: Point3<f64>,
    normal: Vector3<f64>,
    /// The nearest point where the body lies that has it.
    nearest: Point3<f64>,
}

impl Contact {
    pub(crate) fn sq_distance(&self) -> f64 {
        (self.from - self.to).norm_squared()
    }
}

/// Nearest points in both directions, so that neither body is favored, of some samples under a map. `known` are those of the first
/// samples under a map like it, or none.
pub(crate) fn contacts<'a, B: Body>(
    a: &'a B,
    b: &'a B,
    map: &'a Similarity,
    samples: Range<usize>,
    known: &'a [Contact],
) -> impl Iterator<Item = Contact> + 'a {
    let known = move |i: usize| known.get(i).map(|contact| &contact.nearest);
    let (skipped, n) = (samples.start, samples.end);
    let there = a.samples().iter().enumerate().take(n).skip(skipped).filter_map(move |(i, p)| {
        let from = map.apply(p);
        let (to, normal) = b.nearest(&from, known(i))?;
        Some(Contact { from, to, normal, nearest: to })
    });
    let (back, n_there) = (map.inverse(), a.samples().len().min(n));
    let here = b.samples().iter().enumerate().take(n).skip(skipped).filter_map(move |(i, q)| {
        let (nearest, normal) = a.nearest(&back.apply(q), known(n_there + i))?;
        Some(Contact { from: map.apply(&nearest), to: *q, normal: map.rotation * normal, nearest })
    });
    there.chain(here)
}

/// A map, and the contacts of the first samples of either body under it.
pub(crate) struct Refined {
    pub(crate) map: Similarity,
    pub(crate) near: Vec<Contact>,
    /// How many of the samples.
    pub(crate) samples: usize,
}

impl Refined {
    /// Root mean square distance of these samples.
    pub(crate) fn rms(&self) -> f64 {
        mean_square(&self.near).sqrt()
    }

    /// Measured at all samples. `None` of bodies without points, or that are farther apart than `limit`, root mean square.
    pub(crate) fn measured<B: Body>(self, a: &B, b: &B, limit: f64) -> Option<Alignment> {
        let Self { map, near, samples } = self;
        let most = limit.powi(2) * (a.samples().len() + b.samples().len()) as f64;
        let (mut n, mut sum, mut max) = (0, 0.0, 0.0);
        for contact in near.into_iter().chain(contacts(a, b, &map, samples..usize::MAX, &[])) {
            let sq = contact.sq_distance();
            (n, sum, max) = (n + 1, sum + sq, f64::max(max, sq));
            // The sum only grows.
            if sum > most {
                return None;
            }
        }
        let gap = Gap { rms: (sum / f64::from(n)).sqrt(), max: max.sqrt() };
        (n > 0).then_some(Alignment { map, gap })
    }
}

fn mean_square(contacts: &[Contact]) -> f64 {
    contacts.iter().map(Contact::sq_distance).sum::<f64>() / contacts.len().max(1) as f64
}

/// The effort of a refinement, and what it brings together.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// Samples of either body that look for their nearest points.
    pub(crate) samples: usize,
    /// Most steps.
    pub(crate) steps: usize,
    pub(crate) towards: Towards,
}

/// What a step of a refinement minimizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Towards {
    /// Distances from the nearest points, by a motion (Besl and McKay 1992, `besl1992` in `REFERENCES.bib`).
    Points,
    /// Distances from the tangent planes at the nearest points, by a motion and a change of size (Chen and Medioni 1992,
    /// `chen1992` in `REFERENCES.bib`).
    Planes,
}

/// Refines a map, which keeps its handedness.
pub(crate) fn refine<B: Body>(a: &B, b: &B, start: Similarity, effort: Effort) -> Refined {
    let Effort { samples, .. } = effort;
    let found =
        |map: &Similarity, known: &[Contact]| contacts(a, b, map, 0..samples, known).collect::<Vec<_>>();
    let (mut map, mut near) = (start, found(&start, &[]));
    let mut error = mean_square(&near);
    let mut damping = MIN_DAMPING;
    for _ in 0..effort.steps {
        let step = match effort.towards {
            Towards::Points => {
                let pairs: Vec<_> = near.iter().map(|contact| (contact.from, contact.to)).collect();
                Similarity::fit_motion(&pairs, false)
            }
            Towards::Planes => tangent_step(&near, damping),
        };
        let Some(next) = step.map(|step| step.after(&map)) else { break };
        let after = found(&next, &near);
        let reached = mean_square(&after);
        let is_last = reached >= error * (1.0 - MIN_GAIN);
        if reached < error {
            (map, near, error) = (next, after, reached);
            damping = f64::max(0.1 * damping, MIN_DAMPING);
        }
        match effort.towards {
            _ if !is_last => {}
            Towards::Planes if reached > error && damping < MAX_DAMPING => damping *= 100.0,
            Towards::Points | Towards::Planes => break,
        }
    }
    Refined { map, near, samples }
}

/// A small motion and change of size: angles, a translation, and the logarithm of a factor.
pub type SmallStep = SVector<f64, 7>;

/// How far a small step moves a point along a normal, for each of its numbers.
pub fn moved_along(at: &Point3<f64>, normal: &Vector3<f64>) -> SmallStep {
    let [turned, [x, y, z]]: [[f64; 3]; 2] = [at.coords.cross(normal).into(), (*normal).into()];
    SmallStep::from([turned[0], turned[1], turned[2], x, y, z, at.coords.dot(normal)])
}

/// The step that fits offsets along normals best, by weights; `damping` shortens it.
pub fn fitted_step(rows: impl Iterator<Item = (SmallStep, f64, f64)>, damping: f64) -> Option<SmallStep> {
    let (mut matrix, mut right) = (SMatrix::<f64, 7, 7>::zeros(), SmallStep::zeros());
    for (row, offset, weight) in rows {
        matrix += row * row.transpose() * weight;
        right += row * offset * weight;
    }
    matrix += SMatrix::identity() * (damping * matrix.trace()).max(f64::MIN_POSITIVE);
    Some(matrix.cholesky()?.solve(&right))
}

/// The small similarity that brings points nearest to the tangent planes of their partners; `damping` shortens it.
fn tangent_step(contacts: &[Contact], damping: f64) -> Option<Similarity> {
    let row = |Contact { from, to, normal, .. }: &Contact| {
        (moved_along(from, normal), (to - from).dot(normal), 1.0)
    };
    let step = fitted_step(contacts.iter().map(row), damping)?;
    let turn = Rotation3::new(step.fixed_rows::<3>(0).into_owned());
    // A linear step by more is no small one.
    let scale = step[6].clamp(-0.2, 0.2).exp();
    let translation = step.fixed_rows::<3>(3).into_owned();
    Some(Similarity { translation, scale, ..Similarity::about_origin(turn.into_inner()) })
}
