//! How well an index, or a matrix of distances, separates classes.

use std::path::Path;
use std::str::FromStr;

use descriptors::{ShapeMetric, SignatureKind};
use index::{Index, Shape};
use linalg::DistanceMatrix;
use retrieval::{Evaluation, Labels, RankBy, evaluate};

use serde::Serialize;

use super::agreement::Agreement;
use super::record::{missing, options_of};
use crate::error::{Error, Remedy};
use base::Observer;
use collection::{CollectionError, LabelSource, Row, TextTable, label_of};

/// Most shapes evaluated at once, unless the budget says how much memory there is: their matrix takes 800 MB.
const MAX_SHAPES: usize = 10_000;

/// The vectors that distances are measured between.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    /// Fused signatures, which bound the distance that an index is searched by.
    #[default]
    Fused,
    /// Signatures of one kind.
    Signature(SignatureKind),
}

impl FromStr for Measure {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let kind = SignatureKind::ALL.into_iter().find(|kind| kind.name() == text);
        match (text, kind) {
            ("fused", _) => Ok(Self::Fused),
            (_, Some(kind)) => Ok(Self::Signature(kind)),
            (_, None) => {
                Err(format!("use `fused`, `{}`", SignatureKind::ALL.map(SignatureKind::name).join("`, `")))
            }
        }
    }
}

/// How a collection is scored.
#[derive(Debug, Clone, Copy)]
pub struct EvaluateOptions<'a> {
    /// The vectors of an index that distances are measured between. Default: [`Measure::Fused`].
    pub measure: Measure,
    /// Where classes come from. Default: those of the index, or from the names of a matrix.
    pub labels: Option<&'a LabelSource>,
    /// Number of neighbors that vote. Default: 1.
    pub knn_k: usize,
    /// Whether the ranking on the neighbor graph is scored beside that by distance. Default: [`RankBy::Plain`], that by
    /// distance alone.
    pub rank_by: RankBy,
}

impl Default for EvaluateOptions<'_> {
    fn default() -> Self {
        Self { measure: Measure::default(), labels: None, knn_k: 1, rank_by: RankBy::default() }
    }
}

/// The scores of an index.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IndexEvaluation {
    /// By the distances between all pairs.
    #[serde(flatten)]
    pub scores: Evaluation,
    /// How well classes and combined distances agree; `None` if there are too few pairs of one class.
    pub agreement: Option<Agreement>,
}

/// Scores an index by the distances between all pairs of its shapes. Shapes without a class are left out.
///
/// # Errors
/// [`Error::TooLarge`], [`Error::Index`], [`Error::Retrieval`].
pub fn evaluate_index(
    path: &Path,
    options: &EvaluateOptions<'_>,
    observer: &dyn Observer,
) -> Result<IndexEvaluation, Error> {
    let EvaluateOptions { measure, labels, knn_k, rank_by } = *options;
    let index = Index::open(path)?;
    let n = index.len();
    let limit = observer.budget().memory().map_or(MAX_SHAPES, |bytes| (bytes / size_of::<f64>()).isqrt());
    if n > limit {
        let what =
            format!("{n} shapes are too many for the distances between all pairs; the limit is {limit}");
        return Err(Error::TooLarge { what, remedy: Remedy::EvaluateShard });
    }
    let (mut rows, mut shapes) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let mut unlabelled = None;
    index.each(|shape| {
        let Shape { mut entry, fused, mut signatures, .. } = shape;
        if let Some(source) = labels {
            entry.label = source.label(&entry.id, Some(Path::new(&entry.path)));
        }
        if entry.label.is_empty() {
            unlabelled.get_or_insert(entry.id);
            return Ok(());
        }
        let vector = match measure {
            Measure::Fused => fused,
            Measure::Signature(kind) => match signatures.remove(kind.name()) {
                Some(signature) => signature,
                // Nothing can be said by the rigid signature about shapes that may bend.
                None if kind == SignatureKind::Rigid => return Ok(()),
                None => {
                    return Err(missing(path, &entry.id, format_args!("{} signature", kind.name())).into());
                }
            },
        };
        rows.push(vector);
        shapes.push(entry);
        Ok::<(), Error>(())
    })?;
    let n = shapes.len();
    if let (0, Some(LabelSource::File(file)), Some(id)) = (n, labels, unlabelled) {
        return Err(file.fits_none(&id).into());
    }
    observer.begin("distances", n * n.saturating_sub(1) / 2);
    let distance = |i: usize, j: usize| {
        observer.step();
        ShapeMetric::fused(&rows[i], &rows[j])
    };
    let distances = DistanceMatrix::from_pairs(n, distance)?;
    let names: Vec<&str> = shapes.iter().map(|entry| entry.label.as_str()).collect();
    let scores = evaluate(&distances, &Labels::new(&names), knn_k, rank_by)?;
    let agreement = Agreement::of(shapes, &options_of(&index)?, |id| index.shape(id), observer)?;
    Ok(IndexEvaluation { scores, agreement })
}

/// Scores a matrix of distances: a [`TextTable`] of numbers, optionally below a line of names.
///
/// Classes come from the labels of the options, by name or, if the matrix has no names, by the order of its lines; without
/// labels they come from the names. Both directions of a pair are averaged.
///
/// ```
/// use canonform::library::{EvaluateOptions, evaluate_matrix};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("distances.csv");
/// let rows = ["cat1,cat2,cat3,dog1,dog2,dog3", "0,1,2,9,9,9", "1,0,1,9,9,9", "2,1,0,9,9,9", "9,9,9,0,1,2",
///     "9,9,9,1,0,1", "9,9,9,2,1,0"];
/// std::fs::write(&path, rows.join("\n"))?;
/// let scores = evaluate_matrix(&path, &EvaluateOptions::default())?;
/// assert_eq!((scores.plain.mean.nn, scores.plain.mean.map), (1.0, 1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::Collection`], [`Error::Refused`] for a matrix without classes, [`Error::Retrieval`].
pub fn evaluate_matrix(path: &Path, options: &EvaluateOptions<'_>) -> Result<Evaluation, Error> {
    let EvaluateOptions { labels, knn_k, rank_by, .. } = *options;
    let (rows, names) = square_matrix(&TextTable::read(path)?)?;
    let classes: Vec<String> = match (labels, names) {
        (None, Some(names)) => names.iter().map(|name| label_of(name)).collect(),
        (Some(source), Some(names)) => {
            let classes: Vec<String> = names.iter().map(|name| source.label(name, None)).collect();
            match (source.file(), names.first()) {
                (Some(file), Some(first)) if classes.iter().all(String::is_empty) => {
                    return Err(file.fits_none(first).into());
                }
                _ => classes,
            }
        }
        (Some(LabelSource::File(file)), None) => file.in_order.clone(),
        (_, None) => {
            let what = "the first line has no names, so the classes of the rows are unknown";
            let what = format!("{}: {what}", path.display());
            return Err(Error::Refused { what, remedy: Some(Remedy::GiveLabels) });
        }
    };
    // Rows that a label file does not name are left out; missing lines of a file without names are an error.
    let is_kept = |i: &usize| classes.get(*i).is_none_or(|class| !class.is_empty());
    let kept: Vec<usize> = (0..rows.len()).filter(is_kept).collect();
    let classes: Vec<&String> = classes.iter().filter(|class| !class.is_empty()).collect();
    let mean = |i: usize, j: usize| 0.5 * (rows[kept[i]][kept[j]] + rows[kept[j]][kept[i]]);
    let distances = DistanceMatrix::from_pairs(kept.len(), mean)?;
    Ok(evaluate(&distances, &Labels::new(&classes), knn_k, rank_by)?)
}

/// The rows of a square matrix, and their names.
type NamedRows = (Vec<Vec<f64>>, Option<Vec<String>>);

fn square_matrix(table: &TextTable) -> Result<NamedRows, CollectionError> {
    let mut lines = table.rows().peekable();
    let is_head = |row: &Row<'_>| !row.cells().skip(1).all(|cell| row.number(cell).is_some());
    let head = lines.next_if(is_head);
    let (mut rows, mut firsts, mut places) = (Vec::<Vec<f64>>::new(), Vec::new(), Vec::new());
    for row in lines {
        let mut cells = row.cells().peekable();
        firsts.extend(cells.next_if(|first| row.number(first).is_none()).map(str::to_owned));
        let distance = |cell: &str| match row.number(cell) {
            Some(distance) if distance.is_finite() && distance >= 0.0 => Ok(distance),
            _ => Err(row.fault(format!("`{cell}` is not a distance; write a nonnegative number"))),
        };
        rows.push(cells.map(distance).collect::<Result<_, _>>()?);
        places.push(row.line);
    }
    let n = rows.len();
    if n == 0 {
        return Err(table.fault(1, "no numbers; write one line of distances per shape"));
    }
    if let Some(i) = rows.iter().position(|row| row.len() != n) {
        let what = format!("row {} of {n} has {} distances, not {n}", i + 1, rows[i].len());
        return Err(table.fault(places[i], what));
    }
    let names = match (head, firsts.len()) {
        // Row names have a corner field above them.
        (Some(head), _) if [n, n + 1].contains(&head.n_cells()) => {
            Some(head.cells().skip(head.n_cells() - n).map(str::to_owned).collect())
        }
        (Some(head), _) => {
            return Err(head.fault(format!("{} names for {n} rows of distances", head.n_cells())));
        }
        (None, count) if count == n => Some(firsts),
        (None, _) => None,
    };
    Ok((rows, names))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<NamedRows, String> {
        let table = TextTable::parse(text.into(), Path::new("m.csv"));
        table.and_then(|table| square_matrix(&table)).map_err(|fault| fault.to_string())
    }

    #[test]
    fn matrices_are_read_with_and_without_names() {
        let rows = [[0.0, 1.5], [2.5, 0.0]];
        for (text, names) in [
            ("0,1.5\n2.5,0\n", None),
            ("a1,b1\n0,1.5\n2.5,0\n", Some(["a1", "b1"])),
            (",a1,b1\na1,0,1.5\nb1,2.5,0\n", Some(["a1", "b1"])),
            ("a1,0,1.5\nb1,2.5,0\n", Some(["a1", "b1"])),
        ] {
            let found = parse(text).unwrap_or_else(|fault| panic!("{text}: {fault}"));
            let names = names.map(|names| names.map(str::to_owned).to_vec());
            assert_eq!(found, (rows.map(Vec::from).to_vec(), names), "{text}");
        }
    }

    #[test]
    fn malformed_matrices_are_refused() {
        for (text, words) in [
            ("a,b\n", "no numbers"),
            ("0,1\n1,0,2\n", "row 2 of 2 has 3"),
            ("a,b,c,d\n0,1\n1,0\n", "4 names for 2"),
            ("0,1\n-1,0\n", "line 2: `-1`"),
            ("0,1\n1,nan\n", "`nan`"),
            ("0,1\n1,x\n", "`x`"),
        ] {
            let fault = parse(text).err().unwrap_or_default();
            assert!(fault.contains(words) && fault.contains("m.csv"), "{text}: {fault}");
        }
    }
}
