//! Retrieval: precision over recall, and what is taken for what.

mod confusion;

use std::path::{Path, PathBuf};

use crate::ReportError;
use crate::curves::curves;
use crate::results::{
    Axis, AxisScale, CurvesPanel, CurvesRecord, RetrievalRecord, Scale, Series, SeriesPoint,
};
use confusion::ConfusionPlot;
use view::canvas::save;

/// What is appended to the stem of the confusion matrix; the curves have [`crate::curves::PART`].
pub const CONFUSION_PART: &str = "-confusion";

/// Draws the curves of precision over recall and the confusion matrix; returns the paths of `STEM-curves` and
/// `STEM-confusion`, as PNG and SVG each.
///
/// # Errors
/// Those of [`RetrievalRecord::validate`], [`ReportError::View`].
pub fn retrieval(record: &RetrievalRecord, stem: impl AsRef<Path>) -> Result<Vec<PathBuf>, ReportError> {
    record.validate()?;
    let mut files = curves(&precision_curves(record), &stem)?;
    let mut path = stem.as_ref().as_os_str().to_owned();
    path.push(CONFUSION_PART);
    files.extend(save(&ConfusionPlot(&record.classification), Path::new(&path))?);
    Ok(files)
}

/// The curves of a record, one panel for each scale.
fn precision_curves(record: &RetrievalRecord) -> CurvesRecord {
    let axis = |name: &str| Axis { name: name.to_owned(), unit: String::new(), scale: AxisScale::Linear };
    let panel = |(scale, title): (Scale, &str)| {
        let series: Vec<Series> = record
            .rows
            .iter()
            .filter(|row| row.scale == scale)
            .map(|row| {
                let last = row.precision.len().saturating_sub(1).max(1) as f64;
                let point = |(i, &p): (usize, &f64)| SeriesPoint {
                    x: i as f64 / last,
                    median: p,
                    low: p,
                    high: p,
                    runs: 1,
                };
                Series {
                    name: row.method.clone(),
                    points: row.precision.iter().enumerate().map(point).collect(),
                }
            })
            .collect();
        let panel = CurvesPanel {
            title: title.to_owned(),
            x: axis("recall"),
            y: axis("precision"),
            series,
            marks: vec![],
        };
        Some(panel).filter(|panel| !panel.series.is_empty())
    };
    let scales = [(Scale::Normalized, "size ignored"), (Scale::Raw, "size counts")];
    CurvesRecord { panels: scales.into_iter().filter_map(panel).collect(), ..CurvesRecord::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{assert_balanced, retrieval_record};

    #[test]
    fn pictures_are_well_formed_repeatable_and_labelled() {
        let record = retrieval_record();
        let folder = tempfile::tempdir().unwrap();
        let draw = |stem: &str| -> Vec<String> {
            let files = retrieval(&record, folder.path().join(stem)).unwrap();
            assert_eq!(files.len(), 4);
            let svg = files.iter().filter(|f| f.extension().is_some_and(|e| e == "svg"));
            svg.map(|f| std::fs::read_to_string(f).unwrap()).collect()
        };
        let svg = draw("a");
        assert_eq!(svg, draw("b"));
        svg.iter().for_each(|text| assert_balanced(text));
        for text in ["precision", "recall", "wave-kernel", "size ignored", "size counts"] {
            assert!(svg[0].contains(text), "{text}");
        }
        for text in ["cat", "a &amp; b", "unknown", "true class"] {
            assert!(svg[1].contains(text), "{text}");
        }
    }

    #[test]
    fn records_that_contradict_themselves_are_told_so() {
        let folder = tempfile::tempdir().unwrap();
        let fault = |change: &dyn Fn(&mut RetrievalRecord)| {
            let mut record = retrieval_record();
            change(&mut record);
            retrieval(&record, folder.path().join("x")).unwrap_err().to_string()
        };
        assert!(fault(&|r| r.rows.clear()).contains("class and curve"));
        assert!(fault(&|r| r.rows[0].precision[1] = f64::NAN).contains("precision of wave-kernel"));
        assert!(
            fault(&|r| r.classification.confusion[0].truncate(1)).contains("row of the confusion matrix")
        );
        assert!(fault(&|r| r.classification.confusion.truncate(1)).contains("the confusion matrix"));
    }
}
