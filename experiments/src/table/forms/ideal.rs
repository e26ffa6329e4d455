//! What a perfect alignment of the forms of one body would give.

use anyhow::Result;
use canonform::maps::MapKind;
use descriptors::{CanonicalForm, Normalization};
use nalgebra::Point3;
use rayon::prelude::*;
use report::results::{RecordedTable, TableEntry};
use rigid::{PointSet, Reflections, Similarity, align_points};

use super::made::{FormMaker, MadeForm};
use crate::collection::LabeledSurface;
use crate::context::Context;
use crate::sweep::mean;
use crate::table::matching::shapes::{PlacedShape, built_in};

/// Pairs of either kind.
const PAIRS: usize = 100;

/// Every so many vertices, one counts.
const STRIDE: usize = 7;

/// Mean distances between forms at unit area.
pub(super) struct IdealAlignments {
    /// Root mean square of the distances between partners, for the alignment that makes it least.
    partners: f64,
    /// Root mean square of the distances to the nearest points, for that alignment.
    ideal: f64,
    /// The same for the alignment that is found without knowing the partners.
    aligned: f64,
    /// The same of forms of two classes.
    between: f64,
    /// The angle between the two alignments of a pair, in degrees; the mean over the pairs for which both have the same
    /// handedness.
    angle: f64,
}

impl IdealAlignments {
    /// Measures some pairs of every kind, evenly spread over the collection.
    pub(super) fn measure(
        shapes: &[&LabeledSurface],
        made: &[MadeForm],
        context: &Context<'_>,
    ) -> Result<Self> {
        let placed =
            shapes.par_iter().map(|shape| built_in(shape, context.seed)).collect::<Result<Vec<_>>>()?;
        let unit = |form: &CanonicalForm| form.normalized(Normalization::UnitArea);
        let wholes: Vec<CanonicalForm> =
            made.iter().map(|made| Ok(unit(&made.solid()?.whole))).collect::<Result<_>>()?;
        let forms: Vec<CanonicalForm> =
            made.iter().map(|made| Ok(unit(&made.solid()?.form))).collect::<Result<_>>()?;
        let prepared: Vec<PointSet> = forms.iter().map(CanonicalForm::prepared).collect::<Result<_, _>>()?;
        let n = shapes.len();
        let all = (0..n).flat_map(|i| (0..i).map(move |j| [i, j]));
        let (within, between): (Vec<_>, Vec<_>) =
            all.partition(|[i, j]| shapes[*i].label == shapes[*j].label);
        let some = |pairs: Vec<[usize; 2]>| -> Vec<[usize; 2]> {
            let step = pairs.len().div_ceil(PAIRS).max(1);
            pairs.into_iter().step_by(step).collect()
        };
        let found = |[i, j]: [usize; 2]| align_points(&prepared[i], &prepared[j], Reflections::Allow);
        let one = |&[i, j]: &[usize; 2]| {
            let n = shapes[i].surface.mesh().n_vertices();
            let pairs = partners(n, [&wholes[i], &wholes[j]], [&placed[i], &placed[j]]);
            let fits =
                [false, true].into_iter().filter_map(|reflected| Similarity::fit_motion(&pairs, reflected));
            let fits = fits.map(|fit| (misfit(&pairs, &fit), fit));
            let (partners, fit) = fits.min_by(|a, b| a.0.total_cmp(&b.0))?;
            let found = found([i, j]);
            let turn = fit.rotation.transpose() * found.map.rotation;
            let angle = (fit.reflected == found.map.reflected)
                .then(|| (0.5 * (turn.trace() - 1.0)).clamp(-1.0, 1.0).acos().to_degrees());
            Some((partners, nearest(&forms[i], &forms[j], &fit), found.gap.rms, angle))
        };
        let within: Vec<_> = some(within).par_iter().filter_map(one).collect();
        let between: Vec<f64> = some(between).par_iter().map(|pair| found(*pair).gap.rms).collect();
        Ok(Self {
            partners: mean(within.iter().map(|pair| pair.0)),
            ideal: mean(within.iter().map(|pair| pair.1)),
            aligned: mean(within.iter().map(|pair| pair.2)),
            between: mean(between),
            angle: mean(within.iter().filter_map(|pair| pair.3)),
        })
    }

    pub(super) fn numbers(&self) -> [(&'static str, f64); 5] {
        [
            ("partners", self.partners),
            ("ideal", self.ideal),
            ("aligned", self.aligned),
            ("between", self.between),
            ("angle", self.angle),
        ]
    }
}

/// Some of the first `n` points of the first form, the vertices of the shape, and their true partners on the second.
fn partners(
    n: usize,
    [a, b]: [&CanonicalForm; 2],
    placed: [&PlacedShape<'_>; 2],
) -> Vec<(Point3<f64>, Point3<f64>)> {
    let partner = |x: usize| {
        let y = placed[0].places.partner(x, &placed[1].places, MapKind::Direct)?;
        Some((*a.points().get(x)?, *b.points().get(y)?))
    };
    (0..n).step_by(STRIDE).filter_map(partner).collect()
}

fn misfit(pairs: &[(Point3<f64>, Point3<f64>)], fit: &Similarity) -> f64 {
    mean(pairs.iter().map(|(x, y)| (fit.apply(x) - y).norm_squared())).sqrt()
}

/// The distance of forms at unit area once aligned, in both directions.
fn nearest(a: &CanonicalForm, b: &CanonicalForm, fit: &Similarity) -> f64 {
    let moved: Vec<Point3<f64>> = a.points().iter().map(|p| fit.apply(p)).collect();
    let one_way = |from: &[Point3<f64>], to: &[Point3<f64>]| {
        let least = |p: &Point3<f64>| to.iter().map(|q| (p - q).norm_squared()).fold(f64::INFINITY, f64::min);
        mean(from.iter().map(least))
    };
    (0.5 * (one_way(&moved, b.points()) + one_way(b.points(), &moved))).sqrt()
}

/// A row for each method.
pub(super) fn table(found: &[(FormMaker, IdealAlignments)]) -> RecordedTable {
    let headings =
        ["form", "partners", "nearest points, ideal", "aligned", "of two classes", "angle, degrees"];
    let row = |(maker, ideal): &(FormMaker, IdealAlignments)| {
        let numbers = ideal.numbers().map(|(_, number)| TableEntry::from(number));
        [TableEntry::from(maker.name())].into_iter().chain(numbers).collect()
    };
    RecordedTable {
        caption: "Two poses of one body: root mean square distances between true partners, and to nearest points, under the \
                  alignment that brings partners closest; to nearest points under the alignment that is found; the same for \
                  forms of two classes; and the angle between the two alignments. The unit is the root of the area."
            .to_owned(),
        folded: None,
        headings: headings.map(str::to_owned).into(),
        rows: found.iter().map(row).collect(),
    }
}
