//! Distances that do not fit into memory are kept in a file, and results are the same bit for bit, on one thread too.

use canonform::Budget;
use canonform::embed::{EmbedMethod, EmbedOptions, FormOptions, Samples, StressChoice, StressOptions, embed};
use datasets::Family;
use geodesics::Sampling;

use crate::support::{body, facts, surface};

#[test]
fn a_form_does_not_depend_on_memory() {
    let folder = tempfile::tempdir().unwrap();
    let surface = surface(&body(Family::Cat));
    let stress = StressOptions { choice: StressChoice::Estimate, ..StressOptions::default() };
    for (method, samples, sampling) in [
        (EmbedMethod::Landmark, Samples::Count(150), Sampling::Farthest),
        (EmbedMethod::default(), Samples::Count(150), Sampling::Random),
        (EmbedMethod::default(), Samples::Count(150), Sampling::MinVariance),
        (EmbedMethod::default(), Samples::Auto, Sampling::Farthest),
    ] {
        let options = FormOptions { method, samples, sampling, ..FormOptions::default() };
        let measured = EmbedOptions::from(&options).stress(stress);
        let usual = embed(&surface, measured.clone(), &()).unwrap();
        // Enough for all but the distances.
        let bytes = if samples == Samples::Auto { 28_000_000 } else { 2_600_000 };
        let budget = Budget::unlimited().with_memory(bytes).with_spill(folder.path().to_owned());
        let (intrinsic, map) = surface.clone().into_parts();
        let lean = testkit::on_threads(1, || embed((intrinsic, &map), measured, &budget).unwrap());
        assert!(lean.distances.is_in_file() && !usual.distances.is_in_file());
        assert!(lean.report.stress.is_some() && facts(&lean) == facts(&usual), "{options:?}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
