//! Results are bitwise equal for any number of threads.

use canonform::compare::form_alignments;
use canonform::embed::{EmbedMethod, FormOptions, Samples, StressChoice};
use canonform::{DescribeOptions, describe};
use datasets::Family;
use descriptors::Normalization;

use crate::support::{bits, body, facts, measured, surface};

/// Runs work on pools of 1 and 3 threads.
fn on_each_pool<T: Send>(work: impl Fn() -> T + Sync) -> [T; 2] {
    [1, 3].map(|n| testkit::on_threads(n, &work))
}

#[test]
fn an_embedding_does_not_depend_on_threads() {
    let mesh = body(Family::Centaur);
    for (method, samples, stress) in [
        (EmbedMethod::default(), Samples::Count(100), StressChoice::Exact),
        (EmbedMethod::default(), Samples::Auto, StressChoice::Estimate),
        (EmbedMethod::Classical, Samples::Auto, StressChoice::Exact),
        (EmbedMethod::spectral(), Samples::Auto, StressChoice::Estimate),
    ] {
        let options = FormOptions { method, samples, ..FormOptions::default() };
        let [one, three] = on_each_pool(|| facts(&measured(&mesh, &options, stress)));
        assert!(one == three, "{options:?}");
    }
}

#[test]
fn a_description_does_not_depend_on_threads() {
    let surface = surface(&body(Family::Cat));
    let [one, three] = on_each_pool(|| describe(&surface, &DescribeOptions::default(), &()).unwrap());
    assert!(one == three);
}

#[test]
fn distances_between_forms_do_not_depend_on_threads() {
    let forms: Vec<_> = Family::all()
        .into_iter()
        .map(|family| {
            let surface = surface(&body(family));
            canonform::embed::embed(&surface, &FormOptions::default(), &()).unwrap().form(&surface).unwrap()
        })
        .collect();
    for normalization in [Normalization::Raw, Normalization::UnitArea] {
        let [one, three] =
            on_each_pool(|| bits(form_alignments(&forms, normalization, &()).unwrap().as_slice()));
        assert!(one == three, "{normalization:?}");
    }
}
