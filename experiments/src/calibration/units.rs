//! The units of distances between signatures: the variation that poses and triangulations cause.

use std::io::Write;
use std::process::ExitCode;

use anyhow::Result;
use base::terminal::Bars;
use canonform::embed::signature;
use canonform::index::Shape;
use canonform::{Observer, Surface};
use datasets::{ArticulatedOptions, Family, LabeledShape, articulated};
use descriptors::{PreparedShape, ShapeMetric, ShapePair, SignatureKind, rigid_signature};
use linalg::Matrix;
use rayon::prelude::*;
use report::{Cell, Table};

use super::{boundaries, described};
use crate::parts::parts;
use crate::sweep::{mean, pairs};

/// Vertices of the shapes of each seed, from 1 on, since collections mix resolutions.
const VERTICES: [usize; 5] = [3400, 1500, 8000, 2500, 5000];

/// Mechanical parts whose rigid signatures are measured, and copies of each.
const PARTS: usize = 110;
const COPIES: usize = 4;

/// A built-in shape with its description.
struct DescribedBody {
    label: String,
    seed: u64,
    description: Shape,
    shape: PreparedShape,
}

/// `experiments units`: for every signature and for aligned forms, the root mean square distance between two shapes of
/// one built-in family with poses and triangulations of their own, and the ratio of the mean squared distance between
/// families to its square, next to the values in use; then the boundaries of shapes and classes.
pub(crate) fn units() -> Result<ExitCode> {
    let bars = Bars::new(false);
    let mut shapes = Vec::new();
    bars.begin("describing", 0);
    for (seed, n_vertices) in (1..).zip(VERTICES) {
        let options = ArticulatedOptions { seed, n_vertices };
        let one = |LabeledShape { label, mesh, .. }: &LabeledShape| {
            let (description, shape) = described(mesh)?;
            Ok(DescribedBody { label: label.clone(), seed, description, shape })
        };
        shapes.extend(articulated(&options)?.par_iter().map(one).collect::<Result<Vec<_>>>()?);
    }
    let (within, between): (Vec<BodyPair<'_>>, Vec<BodyPair<'_>>) =
        pairs(&shapes).partition(|(a, b)| a.label == b.label);
    let mut parts = Vec::new();
    for kind in SignatureKind::INTRINSIC {
        let distance = |(a, b): &BodyPair<'_>| {
            let of = |shape: &DescribedBody| signature(&shape.description, kind);
            of(a).zip(of(b)).map_or(f64::NAN, |(a, b)| a.distance(&b))
        };
        let means = [&within, &between].map(|pairs| mean(pairs.iter().map(|pair| distance(pair).powi(2))));
        let in_use = [ShapeMetric::unit(kind), ShapeMetric::weight(kind)];
        parts.push((kind.name(), means, components(&shapes, kind), in_use));
    }
    let separation = |[within, between]: [f64; 2]| between / within;
    let weighted = parts.iter().filter(|(.., [_, weight])| *weight > 0.0);
    let total: f64 = weighted.map(|(_, means, components, _)| separation(*means) * components).sum();
    let means = [&within, &between].map(|pairs| {
        // Alignment takes long.
        let close: Vec<_> = pairs.iter().filter(|(a, b)| a.seed == 1 && b.seed == 1).collect();
        let rms = |(a, b): &&BodyPair<'_>| ShapePair::new([&a.shape, &b.shape]).best().gap.rms;
        mean(close.par_iter().map(|pair| rms(pair).powi(2)).collect::<Vec<f64>>())
    });
    parts.push(("aligned forms", means, 1.0, [ShapeMetric::FORM_UNIT, ShapeMetric::FORM_WEIGHT]));
    bars.finish();
    let mut out = std::io::stdout().lock();
    let row = |(name, means, components, in_use): &(&str, [f64; 2], f64, [f64; 2])| {
        let separation = separation(*means);
        let found = [means[0].sqrt(), separation, *components, separation * components / total];
        [Cell::from(*name)].into_iter().chain(found.into_iter().chain(*in_use).map(Cell::from)).collect()
    };
    let headings =
        ["signature", "unit", "separation", "components", "weight", "unit in use", "weight in use"];
    writeln!(out, "{}", Table::new("", headings, parts.iter().map(row).collect()).to_text())?;
    let [copies, family] = rigid()?;
    let [unit, weight] = [ShapeMetric::unit, ShapeMetric::weight].map(|of| of(SignatureKind::Rigid));
    let wanted = (ShapeMetric::SAME_SHAPE.at * copies / family).powi(2);
    writeln!(
        out,
        "rigid signature of parts: copies {copies:.4}, one family {family:.4}; weight {wanted:.5}; in use {unit}, {weight}\n"
    )?;
    boundaries::print(&bars, &mut out)?;
    Ok(ExitCode::SUCCESS)
}

/// The effective number of components, `tr(C)² / tr(C²)`, of the covariance `C` of a signature within families.
fn components(shapes: &[DescribedBody], kind: SignatureKind) -> f64 {
    let n_values = kind.n_values();
    let mut covariance = Matrix::zeros(n_values, n_values);
    for family in Family::all() {
        let members: Vec<Vec<f64>> = shapes
            .iter()
            .filter(|shape| shape.label == family.name())
            .filter_map(|shape| signature(&shape.description, kind).map(|s| s.values))
            .collect();
        let of = |i: usize| mean(members.iter().map(|values| values[i]));
        let means: Vec<f64> = (0..n_values).map(of).collect();
        let centered = Matrix::from_fn(members.len(), n_values, |row, i| members[row][i] - means[i]);
        covariance += centered.transpose() * centered;
    }
    covariance.trace().powi(2) / covariance.norm_squared()
}

/// Root mean square distances by the rigid signature: between copies of a mechanical part, and between parts of one family.
fn rigid() -> Result<[f64; 2]> {
    let described = |shape: &LabeledShape| -> Result<_> {
        let surface = Surface::new(&shape.mesh, &Default::default(), &())?.for_description(&())?;
        Ok(rigid_signature(surface.mesh()).map(|signature| (shape.label.clone(), signature)))
    };
    let shapes = parts(0, PARTS, COPIES);
    let found: Vec<_> =
        shapes.par_iter().map(described).collect::<Result<Vec<_>>>()?.into_iter().flatten().collect();
    // Names of parts begin with their family.
    let family = |label: &str| label.split('-').next().map(str::to_owned);
    let rms = |of: &dyn Fn(&str, &str) -> bool| {
        let chosen = pairs(&found).filter(|(a, b)| of(&a.0, &b.0));
        mean(chosen.map(|(a, b)| a.1.distance(&b.1).powi(2))).sqrt()
    };
    Ok([rms(&|a, b| a == b), rms(&|a, b| a != b && family(a) == family(b))])
}

type BodyPair<'a> = (&'a DescribedBody, &'a DescribedBody);
