//! Distances that do not fit into memory are kept in a file, and results are the same bit for bit.

use canonform::Budget;
use canonform::embed::{EmbedMethod, EmbedOptions, FormOptions, Samples, StressChoice, StressOptions, embed};
use datasets::Family;
use geodesics::{FirstSample, Sampler, Sampling};
use linalg::ColumnStore;

use crate::support::{body, facts, marching, surface};

#[test]
fn a_form_does_not_depend_on_memory() {
    let folder = tempfile::tempdir().unwrap();
    let surface = surface(&body(Family::Cat));
    let stress = StressOptions { choice: StressChoice::Estimate, ..StressOptions::default() };
    for (method, samples, sampling) in [
        (EmbedMethod::Landmark, Samples::Count(150), Sampling::Farthest),
        (EmbedMethod::default(), Samples::Count(150), Sampling::Random),
        (EmbedMethod::default(), Samples::Auto, Sampling::Farthest),
    ] {
        let options = FormOptions { method, samples, sampling, ..FormOptions::default() };
        let measured = EmbedOptions::from(&options).stress(stress);
        let usual = embed(&surface, measured.clone(), &()).unwrap();
        // Enough for all but the distances.
        let bytes = if samples == Samples::Auto { 28_000_000 } else { 2_600_000 };
        let budget = Budget::unlimited().with_memory(bytes).with_spill(folder.path().to_owned());
        let (intrinsic, map) = surface.clone().into_parts();
        let lean = embed((intrinsic, &map), measured, &budget).unwrap();
        assert!(lean.distances.is_in_file() && !usual.distances.is_in_file());
        assert!(lean.report.stress.is_some() && facts(&lean) == facts(&usual), "{options:?}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn samplers_take_the_same_samples_into_a_file() {
    let surface = surface(&body(Family::Centaur));
    let solver = marching().prepare(surface.intrinsic(), &()).unwrap();
    for sampling in Sampling::ALL {
        let start = || sampling.start(solver.as_ref(), FirstSample::default(), 3).unwrap();
        let take = |mut sampler: Sampler<'_>| {
            sampler.extend_to(7).unwrap();
            sampler.extend_to(30).unwrap();
            sampler.into_distances(25).unwrap()
        };
        let in_memory = take(start());
        let mut sampler = start();
        sampler.move_to(ColumnStore::in_file(solver.n_vertices(), tempfile::tempfile().unwrap())).unwrap();
        let in_file = take(sampler);
        assert_eq!(in_file.landmarks(), in_memory.landmarks(), "{sampling:?}");
        assert_eq!(in_file.to_matrix().unwrap(), in_memory.to_matrix().unwrap(), "{sampling:?}");
        assert_eq!((in_file.max(), in_file.sq_block()), (in_memory.max(), in_memory.sq_block()));
    }
}
