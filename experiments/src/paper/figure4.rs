//! Figure 4: distances between the canonical forms of 30 shapes, and their maps.
//!
//! Measures, for `METHOD` in `NMDS`, `KPCA-Nystrom` and `SCALE` in `raw`, `normalized`, and for these and `Sammon` in 16
//! dimensions with the scale `spectrum`: `METHOD SCALE nn|ft|st|e|dcg|mAP|knn|silhouette|2D silhouette`, and `SCALE SCORE gap`,
//! the score of NMDS minus that of KPCA-Nystrom.

use anyhow::Result;
use canonform::compare::{embedded_distances, form_alignments};
use canonform::embed::{EmbedMethod, FormOptions, embed};
use descriptors::{CanonicalForm, Normalization};
use linalg::DistanceMatrix;
use nmds::{Bandwidth, classical_full, stress};
use rayon::prelude::*;
use report::record::{Axis, AxisScale, Figure, FigurePanels, Heat, Plot, PlotPoint, Series, SeriesKind};
use report::{Record, Table};
use retrieval::{Labels, RankBy, evaluate, silhouette};

use crate::collection::map;
use crate::context::Context;
use crate::specimen::{describing, low_rank};
use crate::studies::forms::in_many_dimensions;
use crate::sweep::{MeasuredNumbers, SCORES, best_e, named, plot};

const NMDS: &str = "NMDS";
const BASELINE: &str = "KPCA-Nystrom";

/// The scales: the name, the title, the caption and the unit of distances.
const SCALES: [[&str; 4]; 3] = [
    [
        "raw",
        "original size",
        "forms of original size (in mesh units; those of kernel PCA have their own units)",
        "form units",
    ],
    ["normalized", "normalized size", "forms scaled to the same size", "form size = 1"],
    [
        "spectrum",
        "16 dimensions",
        "forms of 16 dimensions, by their spectra of straight distances, size ignored",
        "logarithms",
    ],
];

pub(crate) fn figure4(context: &Context<'_>) -> Result<Record> {
    let (samples, rank) = (context.options.samples, context.options.rank);
    let nmds = low_rank(samples, rank, context.seed);
    let method = EmbedMethod::KernelPca { rank: Some(rank), bandwidth: Bandwidth::Mean };
    let methods = [(NMDS, nmds.clone()), (BASELINE, FormOptions { method, ..nmds })];
    let shapes = context.collection.all();
    let mut found: Vec<(usize, &str, DistanceMatrix)> = Vec::new();
    let mut sampled = Vec::new();
    for (name, options) in &methods {
        let made = map(&shapes, options.method.name(), context.observer, |shape| {
            let embedded = embed(&shape.surface, options, &())?;
            Ok((embedded.form(&shape.surface)?, embedded.distances))
        })?;
        let (forms, distances): (Vec<CanonicalForm>, Vec<_>) = made.into_iter().unzip();
        // Those of both methods are the same.
        sampled = distances;
        for (scale, normalization) in [Normalization::Raw, Normalization::UnitArea].into_iter().enumerate() {
            found.push((scale, name, form_alignments(&forms, normalization, context.observer)?));
        }
    }
    for (name, method) in in_many_dimensions() {
        let spectra = shapes.par_iter().zip(&sampled).map(|(shape, distances)| {
            let (form, unit) = method.sampled(distances, shape.surface.mesh())?;
            Ok(form.spectrum(unit)?)
        });
        let spectra = spectra.collect::<Result<Vec<_>>>()?;
        let between = |i: usize, j: usize| spectra[i].distance(&spectra[j]);
        found.push((2, name, DistanceMatrix::from_pairs(spectra.len(), between)?));
    }
    found.sort_by_key(|(scale, ..)| *scale);
    let labels = Labels::new(&context.collection.labels());
    let (mut measured, mut rows, mut figures) = (MeasuredNumbers::new(), Vec::new(), Vec::new());
    let n = shapes.len();
    for group in found.chunk_by(|a, b| a.0 == b.0) {
        let [scale, title, forms, unit] = SCALES[group[0].0];
        let (mut maps, mut matrices) = (Vec::new(), Vec::new());
        for (_, method, distances) in group {
            let plane = classical_full(distances, 2)?;
            let scores = evaluate(distances, &labels, context.options.voters, RankBy::Plain)?;
            let flat = silhouette(&embedded_distances(&plane.coords)?, &labels);
            let own = [
                ("knn", scores.plain.knn_accuracy),
                ("silhouette", scores.silhouette),
                ("2D silhouette", flat),
            ];
            let sign = f64::from(*method == NMDS) - f64::from(*method == BASELINE);
            for (score, value) in named(&scores.plain.mean).into_iter().chain(own) {
                measured.insert(format!("{method} {scale} {score}"), value);
                *measured.entry(format!("{scale} {score} gap")).or_default() += sign * value;
            }
            let plane_only = [stress(&plane.coords, distances)?.normalized, plane.negative_mass];
            let numbers =
                scores.plain.mean.to_array().into_iter().chain(own.map(|(_, value)| value)).chain(plane_only);
            rows.push([*method, scale].map(Into::into).into_iter().chain(numbers.map(Into::into)).collect());
            let title = format!("{method}, {title}");
            let at = |i: usize| [plane.coords[(i, 0)], plane.coords[(i, 1)]];
            maps.push(map_of(context, &title, unit, at));
            let values = (0..n).map(|i| distances.row(i).to_vec()).collect();
            let quantity = Axis { unit: unit.to_owned(), ..Axis::linear("distance") };
            let classes = context.collection.labels();
            matrices.push(Heat { title, names: classes, values, quantity });
        }
        let map = format!(
            "Multidimensional scaling of the distances between the canonical forms of {n} shapes, {forms}. Both axes of a 2D \
             map have the same scale, so nearby points are similar forms."
        );
        let matrix = format!(
            "The {n} × {n} distances between {forms}, grouped by class. Dark colors are small distances."
        );
        let figure =
            |kind: &str, caption, panels| Figure { part: format!("{kind}-{scale}"), caption, panels };
        figures.push(figure("maps", map, FigurePanels::Plots(maps)));
        figures.push(figure("matrices", matrix, FigurePanels::Heats(matrices)));
    }
    measured.insert("best e".to_owned(), best_e(&labels)?);
    let own = ["k-NN", "silhouette", "2D silhouette", "2D stress", "neg. mass"];
    let headings = ["method", "scale"].into_iter().chain(SCORES).chain(own);
    let [nmds, baseline] = methods.map(|(_, options)| describing(options));
    let tables = vec![Table::new("", headings, rows)];
    Ok(Record { tables, figures, ..context.record(&[(NMDS, &nmds), (BASELINE, &baseline)], measured) })
}

/// The shapes in the plane, a series for each class.
fn map_of(context: &Context<'_>, title: &str, unit: &str, at: impl Fn(usize) -> [f64; 2]) -> Plot {
    let shapes = &context.collection.shapes;
    let series = context.collection.classes.iter().map(|class| {
        let members = shapes.iter().enumerate().filter(|(_, shape)| shape.label == *class);
        let point = |(i, shape): (usize, &crate::collection::LabeledSurface)| {
            let [x, y] = at(i);
            PlotPoint::new(x, y, &shape.name)
        };
        Series { name: class.clone(), kind: SeriesKind::Filled, points: members.map(point).collect() }
    });
    let axis = |name: &str| Axis { unit: unit.to_owned(), scale: AxisScale::Map, ..Axis::linear(name) };
    plot(title, axis("MDS axis 1"), axis("MDS axis 2"), series.collect())
}
