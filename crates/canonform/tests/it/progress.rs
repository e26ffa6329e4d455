//! Progress reaches the total of every stage.

use std::sync::Mutex;

use canonform::embed::{EmbedMethod, EmbedOptions, FormOptions, Samples, StressOptions, embed};
use canonform::mesh::shapes;
use canonform::{Observer, Surface};

/// The stages: their names, totals and steps.
#[derive(Default)]
struct Stages(Mutex<Vec<(String, usize, usize)>>);

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
    for method in EmbedMethod::all() {
        for samples in [Samples::Count(30), Samples::Auto] {
            if samples == Samples::Auto && !method.has_unit() {
                continue;
            }
            let options = FormOptions { method: method.clone(), samples, ..FormOptions::default() };
            let stages = Stages::default();
            embed(&surface, EmbedOptions::from(&options).stress(StressOptions::default()), &stages).unwrap();
            for (stage, total, steps) in stages.0.into_inner().unwrap() {
                println!("{} from {samples} samples, {stage}: {steps} of {total}", method.name());
                match (stage.as_str(), samples) {
                    // A search for the number of samples may end early.
                    ("distances", Samples::Auto) => assert!(steps <= total, "{steps} of {total}"),
                    // Finding the first sample takes a step, too.
                    ("distances", _) => assert!((total..=total + 1).contains(&steps), "{steps} of {total}"),
                    _ => assert_eq!(steps, total, "{stage}"),
                }
            }
        }
    }
}
