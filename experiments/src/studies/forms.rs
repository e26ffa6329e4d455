//! Forms: retrieval by canonical forms alone, with size ignored, for every method that makes forms and every way to compare them.
//!
//! Measures `METHOD COMPARISON nn|ft|st|e|dcg|mAP|silhouette|2D silhouette`, with the names of [`METHODS`] and
//! [`COMPARISONS`].

use anyhow::{Context as _, Result};
use canonform::compare::embedded_distances;
use canonform::embed::{FormOptions, Samples, embed};
use descriptors::{CanonicalForm, LaplaceSpectrum, SampledForm, Signature, shape_dna};
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};
use mesh::TriMesh;
use nmds::{
    Bandwidth, Embedding, LandmarkPairs, Regularization, SmacofOptions, classical_full, kernel_pca, nystrom,
    smacof,
};
use rayon::prelude::*;
use report::{Cell, Record, Table};
use retrieval::{Labels, RankBy, evaluate, silhouette};

use crate::collection::map;
use crate::context::Context;
use crate::specimen::DIM;
use crate::sweep::{MeasuredNumbers, SCORES, named, note};

/// The spread of a form of unit area: the median of built-in creatures. It scales forms without a unit of length.
const USUAL_SPREAD: f64 = 0.43;

/// How a form is made from the distances of samples.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Fit {
    /// The paper's method.
    Nystrom,
    /// Least squares of the distances from the samples, with Sammon's weights: the inverse distances.
    Sammon,
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

/// Those in 16 dimensions rank forms in an index.
const METHODS: [(&str, FormMethod); 7] = [
    ("NMDS", method(Fit::Nystrom, DIM)),
    ("NMDS with features", FormMethod { is_bent: true, ..method(Fit::Nystrom, DIM) }),
    ("NMDS, 16 dimensions", method(Fit::Nystrom, SampledForm::DIM)),
    ("Sammon", method(Fit::Sammon, DIM)),
    ("Sammon, 16 dimensions", method(Fit::Sammon, SampledForm::DIM)),
    ("KPCA-Nystrom", method(Fit::KernelPca, DIM)),
    ("KPCA-Nystrom, 16 dimensions", method(Fit::KernelPca, SampledForm::DIM)),
];

/// The methods in 16 dimensions, by the names that they share with those in three.
pub(crate) fn in_many_dimensions() -> impl Iterator<Item = (&'static str, FormMethod)> {
    METHODS.into_iter().filter_map(|(name, method)| Some((name.strip_suffix(", 16 dimensions")?, method)))
}

/// The spectrum of straight distances, and that of the Laplacian of the surface of a form in three dimensions.
const COMPARISONS: [&str; 2] = ["spectrum", "surface"];

/// A form by one of the methods.
struct MadeForm {
    sampled: SampledForm,
    /// The unit of length that gives the surface unit area.
    unit: f64,
    /// In three dimensions: with the triangles of the shape.
    surface: Option<TriMesh>,
}

pub(crate) fn forms(context: &Context<'_>) -> Result<Record> {
    let shapes = context.collection.all();
    let labels = Labels::new(&context.collection.labels());
    let options = FormOptions { samples: Samples::Count(context.options.samples), ..FormOptions::default() };
    let measured_shapes = map(&shapes, "measuring", context.observer, |shape| {
        let surface = shape.surface.for_description(&())?;
        Ok((surface.mesh().clone(), embed(&surface, &options, &())?.distances))
    })?;
    let (mut measured, mut rows) = (MeasuredNumbers::new(), Vec::new());
    for (name, method) in METHODS {
        context.observer.begin(name, shapes.len());
        let made = measured_shapes.par_iter().map(|(mesh, distances)| {
            context.observer.step();
            method.form(mesh, distances)
        });
        let made = made.collect::<Result<Vec<MadeForm>>>()?;
        let n_comparisons = if method.dim > DIM { 1 } else { COMPARISONS.len() };
        for comparison in COMPARISONS.into_iter().take(n_comparisons) {
            let signature = |made: &MadeForm| made.signature(comparison);
            let signatures = made.par_iter().map(signature).collect::<Result<Vec<_>>>()?;
            let between = |i: usize, j: usize| signatures[i].distance(&signatures[j]);
            let distances = DistanceMatrix::from_pairs(signatures.len(), between)?;
            let scores = evaluate(&distances, &labels, 1, RankBy::Plain)?;
            let (mean, intervals) = (scores.plain.mean, scores.plain.intervals);
            let plane = embedded_distances(&classical_full(&distances, 2)?.coords)?;
            let own = [("silhouette", scores.silhouette), ("2D silhouette", silhouette(&plane, &labels))];
            note(&mut measured, &format!("{name} {comparison}"), named(&mean).into_iter().chain(own));
            let ends = intervals.low.to_array().into_iter().zip(intervals.high.to_array());
            let scores = mean.to_array().into_iter().zip(ends);
            let scores = scores.map(|(score, (low, high))| format!("{score:.3} ({low:.2}-{high:.2})").into());
            let mut row: Vec<Cell> = [name, comparison].into_iter().map(Cell::from).chain(scores).collect();
            row.extend(own.map(|(_, value)| Cell::from(value)));
            rows.push(row);
        }
    }
    let headings = ["form", "compared by"].into_iter().chain(SCORES).chain(["silhouette", "2D silhouette"]);
    let tables = vec![Table::new("", headings, rows)];
    Ok(Record { tables, ..context.record(&[], measured) })
}

impl MadeForm {
    fn signature(&self, comparison: &str) -> Result<Signature> {
        if comparison == "spectrum" {
            return Ok(self.sampled.spectrum(self.unit)?);
        }
        let surface = self.surface.as_ref().context("a form of three dimensions")?;
        Ok(shape_dna(&LaplaceSpectrum::describing(&surface.intrinsic(), &())?))
    }
}

impl FormMethod {
    fn form(self, mesh: &TriMesh, distances: &LandmarkDistances) -> Result<MadeForm> {
        if self.dim > DIM {
            let (sampled, unit) = self.sampled(distances, mesh)?;
            return Ok(MadeForm { sampled, unit, surface: None });
        }
        let masses = mesh.vertex_areas();
        let whole = CanonicalForm::new(&self.embedding(distances, &masses)?, mesh)?;
        let whole = if self.fit == Fit::KernelPca { whole.without_unit() } else { whole };
        let whole = if self.is_bent { whole.with_features(mesh, &())? } else { whole };
        let coords = Matrix::from_fn(masses.len(), DIM, |i, k| whole.points()[i][k]);
        let unit = whole.area().map_or_else(|| self.unit(&coords, mesh), f64::sqrt);
        let sampled = SampledForm::new(&coords, &masses)?;
        Ok(MadeForm { sampled, unit, surface: Some(whole.to_mesh(mesh)) })
    }

    /// A form of many dimensions, and the unit of length that gives the surface unit area.
    pub(crate) fn sampled(self, distances: &LandmarkDistances, mesh: &TriMesh) -> Result<(SampledForm, f64)> {
        let masses = mesh.vertex_areas();
        if self.fit == Fit::Sammon {
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
            Fit::Sammon => {
                let pairs =
                    LandmarkPairs { landmarks: distances.landmarks(), rows: distances, masses, power: 1.0 };
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
