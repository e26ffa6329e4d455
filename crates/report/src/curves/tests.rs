use super::*;
use crate::fixtures::{assert_balanced, curves_record};

#[test]
fn pictures_are_well_formed_repeatable_and_labelled() {
    let record = curves_record();
    let folder = tempfile::tempdir().unwrap();
    let draw = |stem: &str| {
        let files = curves(&record, folder.path().join(stem)).unwrap();
        assert_eq!(files[0], folder.path().join(format!("{stem}-curves.png")));
        (std::fs::read(&files[0]).unwrap(), std::fs::read_to_string(&files[1]).unwrap())
    };
    let (png, svg) = draw("a");
    assert_eq!((png, svg.clone()), draw("b"));
    assert_balanced(&svg);
    for text in ["NMDS", "a &amp; b", "samples n", "error (m⁴)", "recommended", "david0", "cat0", "100"] {
        assert!(svg.contains(text), "{text}");
    }
}

#[test]
fn one_panel_takes_the_width_and_what_is_not_positive_is_left_out() {
    let mut record = curves_record();
    record.panels.truncate(1);
    record.panels[0].series[0].points[0].low = 0.0;
    record.panels[0].series[0].points[1].median = -1.0;
    let folder = tempfile::tempdir().unwrap();
    curves(&record, folder.path().join("x")).unwrap();
}

#[test]
fn records_without_a_point_or_with_one_that_is_not_a_number_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let fault = |record: &CurvesRecord| curves(record, folder.path().join("x")).unwrap_err().to_string();
    assert!(fault(&CurvesRecord::default()).contains("nothing to draw"));
    let mut record = curves_record();
    record.panels[1].series[0].points[0].high = f64::NAN;
    assert!(fault(&record).contains("NMDS in cat0"));
    record = curves_record();
    record.panels[0].marks[0].x = f64::INFINITY;
    assert!(fault(&record).contains("the mark recommended"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
