//! From a file to a form: every repair, distance method and embedding.

#![no_main]

use canonform::geodesics::Method;
use canonform::Surface;
use canonform::embed::{EmbedMethod, EmbedOptions, FormOptions, Samples, StressChoice, StressOptions, embed};
use canonform_fuzz::{Limited, first_byte, mesh_of, single_threaded};
use libfuzzer_sys::fuzz_target;
use mesh::{ComponentPolicy, RepairOptions, Weld};

fn pick<T: Clone>(all: &[T], byte: usize) -> T {
    all[byte % all.len()].clone()
}

fuzz_target!(init: single_threaded(), |data: &[u8]| {
    let (repair, rest) = first_byte(data);
    let (method, rest) = first_byte(rest);
    let Some(mesh) = mesh_of(rest, 200) else { return };
    let repair = RepairOptions {
        components: pick(&[ComponentPolicy::Largest, ComponentPolicy::Bridge, ComponentPolicy::Error], repair),
        weld: pick(&[Weld::Seams, Weld::All, Weld::None], repair / 3),
        ..RepairOptions::default()
    };
    let Ok(surface) = Surface::new(&mesh, &repair, &()) else { return };
    let options = FormOptions {
        repair,
        geodesic: pick(&Method::all(), method),
        method: pick(&EmbedMethod::all(), method / Method::all().len()),
        samples: Samples::Count(12),
        ..FormOptions::default()
    };
    let stress = StressOptions { choice: StressChoice::Exact, ..StressOptions::default() };
    if let Ok(embedded) = embed(&surface, EmbedOptions::from(&options).stress(stress), &Limited::start()) {
        assert_eq!(embedded.embedding.coords.nrows(), surface.mesh().n_vertices());
        assert!(embedded.embedding.coords.iter().all(|x| x.is_finite()), "a coordinate is not finite");
    }
});
