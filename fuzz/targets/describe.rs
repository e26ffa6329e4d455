//! From a file to the description that an index stores, and its distance from itself.

#![no_main]

use canonform::descriptors::ShapePair;
use canonform::{DescribeOptions, Surface, describe};
use canonform::compare::compare;
use canonform_fuzz::{Limited, mesh_of, single_threaded};
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: single_threaded(), |data: &[u8]| {
    let Some(mesh) = mesh_of(data, 200) else { return };
    let options = DescribeOptions::default();
    let Ok(surface) = Surface::new(&mesh, &options.form.repair, &()) else { return };
    let Ok(description) = describe(&surface, &options, &Limited::start()) else { return };
    assert!(description.fused.iter().all(|x| x.is_finite()), "a signature is not finite");
    let Ok(shape) = options.prepare(&description) else { return };
    let pair = ShapePair::new([&shape, &shape]);
    assert!(pair.distance().combined < 1e-3, "a shape differs from itself by {:?}", pair.distance());
    let _ = compare(&pair);
});
