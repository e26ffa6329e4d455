//! What the tests share, and laws of all figures.

pub(crate) mod fixtures;
pub(crate) mod meshes;

use std::path::Path;

use fixtures::{assert_balanced, curves_record, figure4_record, figure9_record, retrieval_record};

use crate::record::{Results, save};
use crate::results::Record;

/// Saves a record twice, and compares: the SVG texts of its figures.
fn drawn(record: &Record<impl Results>, folder: &Path) -> Vec<String> {
    let read = |name: &str, part: &str, end: &str| {
        std::fs::read(folder.join(format!("{name}{part}.{end}"))).unwrap()
    };
    save(record, folder, "a").unwrap();
    save(record, folder, "b").unwrap();
    let parts = record.results.figures().into_iter().map(|figure| figure.part);
    parts
        .map(|part| {
            for end in ["png", "svg", "pdf"] {
                assert!(read("a", part, end) == read("b", part, end), "{part}.{end} is the same every time");
            }
            let svg = String::from_utf8(read("a", part, "svg")).unwrap();
            assert_balanced(&svg);
            svg
        })
        .collect()
}

#[test]
fn files_of_figures_are_well_formed_deterministic_and_labelled() {
    let folder = tempfile::tempdir().unwrap();
    let classes = figure4_record(&[("cat", 4), ("a & <b>", 5), ("david", 7)]);
    let figures: [(Vec<String>, &[&[&str]]); 4] = [
        (
            drawn(&curves_record(), folder.path()),
            &[&["NMDS", "a &amp; b", "samples n", "error (m⁴)", "recommended", "david0", "cat0", "100"]],
        ),
        (
            drawn(&retrieval_record(), folder.path()),
            &[
                &["precision", "recall", "wave-kernel", "size ignored", "size counts"],
                &["cat", "a &amp; b", "unknown", "true class"],
            ],
        ),
        (
            drawn(&classes, folder.path()),
            &[
                &[
                    "MDS axis 1 (form units)",
                    "MDS axis 2 (form units)",
                    "0.910",
                    "0.875",
                    "2D silhouette",
                    "0.052",
                ],
                &["a &amp; &lt;b&gt;", "david", "distance (form units)", "data:image/png;base64,"],
                &["NMDS", "KPCA-Nyström", "form size = 1", "cat"],
                &["NMDS", "KPCA-Nyström", "form size = 1", "cat"],
            ],
        ),
        (
            drawn(&figure9_record(), folder.path()),
            &[&["NMDS, paper", "time (seconds)", "david0, 3400 vertices"]],
        ),
    ];
    for (svgs, expected) in figures {
        assert_eq!(svgs.len(), expected.len());
        for (svg, labels) in svgs.iter().zip(expected) {
            assert!(labels.iter().all(|label| svg.contains(label)), "{labels:?}");
        }
    }
}
