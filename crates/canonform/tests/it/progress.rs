//! Progress reaches the total of every stage.

use std::sync::Mutex;

use canonform::embed::{EmbedMethod, EmbedOptions, FormOptions, Samples, StressOptions, embed};
use canonform::mesh::shapes;
use canonform::{Observer, Surface};

/// The stages: their names, totals and steps.
#[derive(Default)]
pub(crate) struct Stages(pub(crate) Mutex<Vec<(String, usize, usize)>>);

impl Observer for Stages {
    fn begin(&self, stage: &str, total: usize) {
        self.0.lock().unwrap().push((stage.to_owned(), total, 0));
    }

    fn step(&self) {
        self.0.lock().unwrap().last_mut().unwrap().2 += 1;
    }
}

#[test]
fn every_stage_of_an_embedding_ends_at_its_total() {
    let surface = Surface::new(&shapes::torus(24, 12, 2.0, 0.7), &Default::default(), &()).unwrap();
    let all = EmbedMethod::all().into_iter().flat_map(|method| {
        [Samples::Count(30), Samples::Auto].map(|samples| FormOptions {
            method: method.clone(),
            samples,
            ..Default::default()
        })
    });
    for options in all.filter(|options| options.samples != Samples::Auto || options.method.has_unit()) {
        let stages = Stages::default();
        embed(&surface, EmbedOptions::from(&options).stress(StressOptions::default()), &stages).unwrap();
        for (stage, total, steps) in stages.0.into_inner().unwrap() {
            // A search for the number of samples may end early, and finding the first sample takes a step, too.
            let expected = match (stage.as_str(), options.samples) {
                ("distances", Samples::Auto) => 0..=total,
                ("distances", _) => total..=total + 1,
                _ => total..=total,
            };
            assert!(expected.contains(&steps), "{}, {stage}: {steps} of {total}", options.method.name());
        }
    }
}
