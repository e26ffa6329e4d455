//! Figure 4: how well distances between canonical forms tell classes apart.
//!
//! For each scale one picture of the two-dimensional maps with their scores, one of the distance
//! matrices; methods side by side in the record's order.

mod maps;
mod matrices;

use std::path::{Path, PathBuf};

use plotters::prelude::DrawingBackend;

use crate::ReportError;
use crate::classes::Classes;
use crate::results::{Figure4Panel, Figure4Record, Scale};
use maps::Maps;
use matrices::Matrices;
use view::canvas::{Anchor, Canvas, DrawError, TITLE, Type, save};

/// The pictures of Figure 4: what is appended to the stem before `.png` and `.svg`, and what is seen.
pub const PARTS: [(&str, Scale, Content); 4] = [
    ("-maps-raw", Scale::Raw, Content::Maps),
    ("-matrices-raw", Scale::Raw, Content::Matrices),
    ("-maps-normalized", Scale::Normalized, Content::Maps),
    ("-matrices-normalized", Scale::Normalized, Content::Matrices),
];

/// What one picture of Figure 4 shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Content {
    /// Two-dimensional embeddings of the distances.
    Maps,
    /// The distances themselves.
    Matrices,
}

/// Draws every scale that the record has panels for and returns the paths of the files, as `STEM` and a
/// suffix of [`PARTS`].
///
/// # Errors
/// [`ReportError::Empty`] without shapes or panels; [`ReportError::Shape`] and [`ReportError::NotFinite`]
/// when the record contradicts itself; [`ReportError::View`].
pub fn figure4(record: &Figure4Record, stem: impl AsRef<Path>) -> Result<Vec<PathBuf>, ReportError> {
    record.validate()?;
    if record.names.is_empty() {
        return Err(ReportError::Empty { figure: "figure 4", unit: "shape" });
    }
    if record.panels.is_empty() {
        return Err(ReportError::Empty { figure: "figure 4", unit: "panel" });
    }
    let classes = Classes::of(record.labels.iter().map(String::as_str));
    let mut files = Vec::new();
    for (suffix, scale, content) in PARTS {
        let panels: Vec<&Figure4Panel> = record.panels_at(scale).collect();
        if panels.is_empty() {
            continue;
        }
        let mut path = stem.as_ref().as_os_str().to_owned();
        path.push(suffix);
        let path = Path::new(&path);
        files.extend(match content {
            Content::Maps => save(&Maps { panels, labels: &record.labels, classes: &classes }, path)?,
            Content::Matrices => save(&Matrices::new(panels, &record.labels, &classes), path)?,
        });
    }
    Ok(files)
}

/// Width of a figure and of one of its two columns of panels, in units.
const WIDTH: f64 = 1000.0;
const COLUMN: f64 = WIDTH / 2.0;

/// Top left corner of panel number `index`, the panels being `height` high and starting at `top`.
fn corner(index: usize, top: f64, height: f64) -> (f64, f64) {
    ((index % 2) as f64 * COLUMN, top + (index / 2) as f64 * height)
}

/// Rows of panels.
fn rows(panels: usize) -> f64 {
    panels.div_ceil(2) as f64
}

/// Writes a panel's title centred on `at`.
fn title<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    panel: &Figure4Panel,
    at: (f64, f64),
) -> Result<(), DrawError> {
    let scale = match panel.scale {
        Scale::Raw => "original size",
        Scale::Normalized => "normalised size",
    };
    canvas.text(&format!("{}, {scale}", panel.method), at, Type::new(TITLE, Anchor::Center).bold())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{assert_balanced, figure4_record};

    /// The SVG texts and PNG bytes of a record's figures.
    fn drawn(record: &Figure4Record) -> (Vec<String>, Vec<Vec<u8>>) {
        let folder = tempfile::tempdir().unwrap();
        let files = figure4(record, folder.path().join("figure4")).unwrap();
        assert_eq!(files.len(), 2 * record.panels.len());
        let (svg, png): (Vec<_>, Vec<_>) =
            files.iter().partition(|f| f.extension().is_some_and(|e| e == "svg"));
        let read = |f: &&PathBuf| std::fs::read(f).unwrap();
        (svg.iter().map(|f| String::from_utf8(read(f)).unwrap()).collect(), png.iter().map(read).collect())
    }

    #[test]
    fn pictures_are_well_formed_repeatable_and_fully_labelled() {
        let record = figure4_record(&[("cat", 4), ("a & <b>", 5), ("david", 7)]);
        let (svg, png) = drawn(&record);
        for text in &svg {
            assert_balanced(text);
            for label in ["cat", "a &amp; &lt;b&gt;", "david", "NMDS", "KPCA-Nyström"] {
                assert!(text.contains(label), "{label}");
            }
        }
        for text in
            ["MDS axis 1 (form units)", "MDS axis 2 (form units)", "0.910", "0.875", "map silh.", "0.052"]
        {
            assert!(svg[0].contains(text), "{text}");
        }
        assert!(svg[1].contains("distance (form units)") && svg[1].contains("data:image/png;base64,"));
        assert!(svg[2].contains("form size = 1") && svg[3].contains("form size = 1"));
        assert_eq!((svg, png), drawn(&record));
    }

    #[test]
    fn many_classes_and_single_shapes_fit_without_repeating_a_label_in_one_place() {
        let names: Vec<String> = (0..14).map(|i| format!("class number {i}")).collect();
        let classes: Vec<(&str, usize)> =
            names.iter().enumerate().map(|(i, n)| (n.as_str(), 1 + 3 * i % 20)).collect();
        let (svg, _) = drawn(&figure4_record(&classes));
        assert!(names.iter().all(|name| svg[0].contains(name.as_str())), "the legend names every class");
        drawn(&figure4_record(&[("only", 1)]));
        drawn(&figure4_record(&[("alike", 3)]));
    }

    #[test]
    fn nothing_to_draw_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let stem = folder.path().join("figure4");
        let mut record = figure4_record(&[("cat", 2)]);
        record.panels.clear();
        assert!(matches!(figure4(&record, &stem), Err(ReportError::Empty { unit: "panel", .. })));
        let error = figure4(&Figure4Record::default(), &stem).unwrap_err();
        assert!(matches!(error, ReportError::Empty { unit: "shape", .. }), "{error}");
        record = figure4_record(&[("cat", 2)]);
        record.panels[0].map[0][0] = f64::NAN;
        assert!(matches!(figure4(&record, &stem), Err(ReportError::NotFinite { .. })));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn panels_stand_two_in_a_row() {
        assert_eq!(
            [corner(0, 9.0, 50.0), corner(1, 9.0, 50.0), corner(2, 9.0, 50.0)],
            [(0.0, 9.0), (500.0, 9.0), (0.0, 59.0)]
        );
        assert_eq!([rows(1), rows(2), rows(3)], [1.0, 1.0, 2.0]);
    }
}
