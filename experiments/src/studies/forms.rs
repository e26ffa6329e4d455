//! Forms: retrieval by canonical forms alone, with size ignored, for every method that makes forms and every way to compare them.
//!
//! Measures `METHOD COMPARISON nn|ft|st|e|dcg|mAP|silhouette|2D silhouette|seconds` and `METHOD form seconds`, with the names of
//! [`METHODS`] and [`COMPARISONS`].

use anyhow::{Context as _, Result};
use canonform::compare::{embedded_distances, form_alignments};
use canonform::embed::{FormOptions, Samples, embed};
use descriptors::{CanonicalForm, LaplaceSpectrum, Normalization, SampledForm, Signature, shape_dna};
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};
use mesh::TriMesh;
use nmds::{
    Bandwidth, Embedding, LandmarkPairs, Regularization, SmacofOptions, classical_full, kernel_pca,
    landmark_mds, nystrom, smacof,
};
use rayon::prelude::*;
use report::record::{Axis, AxisScale, Mark, PlotPoint, SeriesKind};
use report::{Cell, Record, Table};
use retrieval::{Labels, RankBy, evaluate, silhouette};

use crate::collection::map;
use crate::context::Context;
use crate::specimen::DIM;
use crate::sweep::{MeasuredNumbers, Panels, SCORES, mean, named, note, plots, timed};

/// Points of a form that are compared, as many as an index stores.
const POINTS: usize = 1000;

/// The spread of a form of unit area: the median of built-in creatures. It scales forms without a unit of length.
const USUAL_SPREAD: f64 = 0.43;

/// How a form is made from the distances of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fit {
    /// The paper's method.
    Nystrom,
    /// Classical scaling of the samples.
    Landmark,
    /// Least squares of the distances from the samples, weighted by this power of the inverse distance.
    LeastSquares(f64),
    /// The paper's baseline.
    KernelPca,
}

/// A method that makes forms.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FormMethod {
    fit: Fit,
    dim: usize,
    /// Whether the surface is bent into the form.
    is_bent: bool,
}

const fn method(fit: Fit, dim: usize) -> FormMethod {
    FormMethod { fit, dim, is_bent: false }
}

/// Least squares with Sammon's weights; with many dimensions, by which an index ranks forms.
const SAMMON: Fit = Fit::LeastSquares(1.0);

const METHODS: [(&str, FormMethod); 9] = [
    ("NMDS", method(Fit::Nystrom, DIM)),
    ("NMDS with features", FormMethod { is_bent: true, ..method(Fit::Nystrom, DIM) }),
    ("NMDS, 16 dimensions", method(Fit::Nystrom, SampledForm::DIM)),
    ("landmark MDS", method(Fit::Landmark, DIM)),
    ("least squares", method(Fit::LeastSquares(0.0), DIM)),
    ("Sammon", method(SAMMON, DIM)),
    ("Sammon, 16 dimensions", method(SAMMON, SampledForm::DIM)),
    ("KPCA-Nystrom", method(Fit::KernelPca, DIM)),
    ("KPCA-Nystrom, 16 dimensions", method(Fit::KernelPca, SampledForm::DIM)),
];

/// The methods in many dimensions, with their names in Figure 4.
pub(crate) const MANY_DIMENSIONS: [(&str, FormMethod); 3] = [
    ("NMDS", method(Fit::Nystrom, SampledForm::DIM)),
    ("Sammon", method(SAMMON, SampledForm::DIM)),
    ("KPCA-Nystrom", method(Fit::KernelPca, SampledForm::DIM)),
];

/// The distance of aligned forms; the spectrum of straight distances; the spectrum of the surface of the form.
const COMPARISONS: [&str; 3] = ["alignment", "spectrum", "surface"];

/// A form by one of the methods.
struct MadeForm {
    sampled: SampledForm,
    /// The unit of length that gives the surface unit area.
    unit: f64,
    /// In three dimensions: at the points that are compared, and with the triangles of the surface.
    solid: Option<(CanonicalForm, TriMesh)>,
    /// Seconds from the surface to the form.
    seconds: f64,
}

pub(crate) fn forms(context: &Context<'_>) -> Result<Record> {
    let shapes = context.collection.all();
    let labels = Labels::new(&context.collection.labels());
    let options = FormOptions { samples: Samples::Count(context.options.samples), ..FormOptions::default() };
    let measured_shapes = map(&shapes, "measuring", context.observer, |shape| {
        let surface = shape.surface.for_description(&())?;
        let (embedded, seconds) = timed(|| embed(&surface, &options, &()))?;
        Ok((surface.mesh().clone(), embedded.distances, seconds))
    })?;
    let (mut measured, mut rows, mut panels) = (MeasuredNumbers::new(), Vec::new(), Panels::default());
    for (name, method) in METHODS {
        context.observer.begin(name, shapes.len());
        let made = measured_shapes.par_iter().map(|(mesh, distances, seconds)| {
            context.observer.step();
            method.form(mesh, distances, *seconds)
        });
        let made = made.collect::<Result<Vec<MadeForm>>>()?;
        let of_form = mean(made.iter().map(|made| made.seconds));
        note(&mut measured, name, [("form seconds", of_form)]);
        for (place, comparison) in COMPARISONS.into_iter().enumerate() {
            let is_slow = comparison == "alignment" && shapes.len() > context.options.aligned;
            if is_slow || (comparison != "spectrum" && method.dim > DIM) {
                continue;
            }
            let (distances, seconds) = compared(comparison, &made, context)?;
            let scores = evaluate(&distances, &labels, 1, RankBy::Plain)?;
            let (mean, intervals) = (scores.plain.mean, scores.plain.intervals);
            let plane = embedded_distances(&classical_full(&distances, 2)?.coords)?;
            let own = [("silhouette", scores.silhouette), ("2D silhouette", silhouette(&plane, &labels))];
            let numbers = named(&mean).into_iter().chain(own).chain([("seconds", seconds)]);
            note(&mut measured, &format!("{name} {comparison}"), numbers);
            let ends = intervals.low.to_array().into_iter().zip(intervals.high.to_array());
            let scores = mean.to_array().into_iter().zip(ends);
            let scores = scores.map(|(score, (low, high))| format!("{score:.3} ({low:.2}-{high:.2})").into());
            let mut row: Vec<Cell> = [name, comparison].into_iter().map(Cell::from).chain(scores).collect();
            row.extend(own.map(|(_, value)| Cell::from(value)));
            row.extend([of_form, seconds].map(|seconds| Cell::from(1000.0 * seconds)));
            rows.push(row);
            let (low, high) = (intervals.low.map, intervals.high.map);
            let point = PlotPoint { x: place as f64, y: mean.map, low, high, note: String::new() };
            let x = Axis { scale: AxisScale::Category, ..Axis::linear("compared by") };
            let axes = [x, Axis::linear("mAP")];
            panels.add("Mean average precision", axes, (name, SeriesKind::Filled), point);
        }
    }
    let headings = ["form", "compared by"].into_iter().chain(SCORES);
    let headings = headings.chain(["silhouette", "2D silhouette", "form, ms", "signature, ms"]);
    let caption = "Retrieval by forms alone, size ignored; intervals cover 95 % of the resampled queries.";
    let marks =
        COMPARISONS.iter().enumerate().map(|(i, name)| Mark { x: i as f64, name: (*name).to_owned() });
    panels.0.iter_mut().for_each(|plot| plot.marks = marks.clone().collect());
    Ok(Record {
        tables: vec![Table::new(caption, headings, rows)],
        figures: vec![plots("curves", panels.0)],
        ..context.record(&[], measured)
    })
}

/// The distances between all forms, and the mean seconds of a signature.
fn compared(comparison: &str, made: &[MadeForm], context: &Context<'_>) -> Result<(DistanceMatrix, f64)> {
    let solid = |made: &'_ MadeForm| made.solid.clone().context("a form of three dimensions");
    if comparison == "alignment" {
        let forms = made.iter().map(|made| Ok(solid(made)?.0)).collect::<Result<Vec<CanonicalForm>>>()?;
        let (_, seconds) = timed(|| forms.iter().try_for_each(|form| form.prepared().map(drop)))?;
        let distances = form_alignments(&forms, Normalization::UnitArea, context.observer)?;
        return Ok((distances, seconds / forms.len() as f64));
    }
    let one = |made: &MadeForm| {
        timed(|| -> Result<Signature> {
            Ok(match comparison {
                "spectrum" => made.sampled.spectrum(made.unit)?,
                _ => shape_dna(&LaplaceSpectrum::describing(&solid(made)?.1.intrinsic(), &())?),
            })
        })
    };
    let found = made.par_iter().map(one).collect::<Result<Vec<_>>>()?;
    let distance = |i: usize, j: usize| found[i].0.distance(&found[j].0);
    let seconds = mean(found.iter().map(|(_, seconds)| *seconds));
    Ok((DistanceMatrix::from_pairs(found.len(), distance)?, seconds))
}

impl FormMethod {
    fn form(self, mesh: &TriMesh, distances: &LandmarkDistances, measuring: f64) -> Result<MadeForm> {
        if self.dim > DIM {
            let ((sampled, unit), seconds) = timed(|| self.sampled(distances, mesh))?;
            return Ok(MadeForm { sampled, unit, solid: None, seconds: measuring + seconds });
        }
        let masses = mesh.vertex_areas();
        let (whole, seconds) = timed(|| -> Result<CanonicalForm> {
            let whole = CanonicalForm::new(&self.embedding(distances, &masses)?, mesh)?;
            let whole = if self.fit == Fit::KernelPca { whole.without_unit() } else { whole };
            Ok(if self.is_bent { whole.with_features(mesh, &())? } else { whole })
        })?;
        let coords = Matrix::from_fn(masses.len(), DIM, |i, k| whole.points()[i][k]);
        let unit = whole.area().map_or_else(|| self.unit(&coords, mesh), f64::sqrt);
        Ok(MadeForm {
            sampled: SampledForm::new(&coords, &masses)?,
            unit,
            seconds: measuring + seconds,
            solid: Some((whole.reduced(POINTS), whole.to_mesh(mesh))),
        })
    }

    /// A form of many dimensions, and the unit of length that gives the surface unit area.
    pub(crate) fn sampled(self, distances: &LandmarkDistances, mesh: &TriMesh) -> Result<(SampledForm, f64)> {
        let masses = mesh.vertex_areas();
        if self.fit == SAMMON {
            let form = SampledForm::by_least_squares(distances, &masses, &())?;
            return Ok((form, mesh.root_of_area()));
        }
        let coords = self.embedding(distances, &masses)?.coords;
        Ok((SampledForm::new(&coords, &masses)?, self.unit(&coords, mesh)))
    }

    /// The unit of length that gives the surface unit area; the components of a kernel have none.
    fn unit(self, coords: &Matrix, mesh: &TriMesh) -> f64 {
        match self.fit {
            Fit::KernelPca => spread(coords, &mesh.vertex_areas()) / USUAL_SPREAD,
            _ => mesh.root_of_area(),
        }
    }

    fn embedding(self, distances: &LandmarkDistances, masses: &[f64]) -> Result<Embedding> {
        let dim = self.dim;
        let usual = || nystrom(distances, Regularization::default(), dim);
        Ok(match self.fit {
            Fit::Nystrom => usual()?,
            Fit::Landmark => landmark_mds(distances, dim)?,
            Fit::LeastSquares(power) => {
                let pairs =
                    LandmarkPairs { landmarks: distances.landmarks(), rows: distances, masses, power };
                let options = SmacofOptions { max_iterations: 20, tolerance: 0.0 };
                smacof(&usual()?.coords, &pairs, &options, &())?.0
            }
            Fit::KernelPca => {
                let rank = Some(distances.n_landmarks().div_ceil(2));
                kernel_pca(distances, Bandwidth::Mean, rank, dim)?
            }
        })
    }
}

/// Root of the mean squared distance from the centroid.
fn spread(coords: &Matrix, masses: &[f64]) -> f64 {
    let total: f64 = masses.iter().sum();
    let of = |x: nalgebra::DVectorView<'_, f64>| {
        let weighted = || x.iter().zip(masses);
        let mean = weighted().map(|(x, m)| x * m).sum::<f64>() / total;
        weighted().map(|(x, m)| m * (x - mean).powi(2)).sum::<f64>() / total
    };
    coords.column_iter().map(of).sum::<f64>().sqrt()
}
