//! Every result in any unit of length from 1e-150 to 1e150: distances and forms have the same bits for powers of two;
//! everything else is the same to rounding.

use canonform::embed::{EmbedMethod, Embedded, FormOptions, Samples, StressChoice, signature};
use canonform::geodesics::{FirstSample, Method, Sampling};
use canonform::{DescribeOptions, describe};
use descriptors::SignatureKind;
use mesh::{TriMesh, shapes};
use surface::VertexId;

use crate::support::{gap, measured, surface};

/// Powers of two, and other factors with the gap that rounding of the coordinates may cause.
fn factors() -> Vec<f64> {
    let powers = [-498, 257, 498].map(|exponent| 2f64.powi(exponent));
    powers.into_iter().chain([1e-150, 1e150]).collect()
}

fn is_power_of_two(factor: f64) -> bool {
    factor.to_bits().trailing_zeros() >= 52
}

fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
    testkit::moved(mesh, |p| p * factor)
}

/// Requires `found` to be `expected` times `factor`: exactly, or within `tolerance` of the largest number.
fn assert_scaled(found: &[f64], expected: &[f64], factor: f64, is_exact: bool, tolerance: f64, what: &str) {
    let scaled: Vec<f64> = expected.iter().map(|x| x * factor).collect();
    let is_near = !is_exact && gap(found, &scaled) <= tolerance;
    assert!(found == scaled || is_near, "{what}: {found:?} is not {expected:?} x {factor}");
}

/// A sheet and a closed surface, both without symmetry and with obtuse angles.
fn meshes() -> [TriMesh; 2] {
    let mut blob = shapes::torus(18, 11, 2.0, 0.7);
    for (i, p) in blob.positions.iter_mut().enumerate() {
        let wave = (i as f64 * 0.7).sin();
        p.coords *= 1.0 + 0.05 * wave + 0.1 * p.y;
    }
    [shapes::jittered_grid(14, 11, 1.0, 0.3, 7), blob]
}

#[test]
fn every_solver_measures_in_any_unit() {
    for mesh in meshes() {
        for method in Method::all() {
            let solve = |mesh: &TriMesh| {
                let surface = surface(mesh);
                let solver = method.prepare(surface.intrinsic(), &()).unwrap();
                let mut sampler =
                    Sampling::Farthest.start(solver.as_ref(), FirstSample::default(), 0).unwrap();
                sampler.extend_to(12).unwrap();
                let samples = sampler.distances(12).unwrap();
                let columns: Vec<f64> = (0..12).flat_map(|i| samples.column(i).unwrap().to_vec()).collect();
                (solver.distances(VertexId(3)).unwrap(), samples.landmarks().to_vec(), columns)
            };
            let expected = solve(&mesh);
            for factor in factors() {
                let (distances, samples, columns) = solve(&scaled(&mesh, factor));
                let (is_exact, name) = (is_power_of_two(factor), method.name());
                assert_scaled(&distances, &expected.0, factor, is_exact, 1e-12, name);
                // The corners of a sheet are equally far apart, so that rounding may swap samples.
                if is_exact || samples == expected.1 {
                    assert_eq!(samples, expected.1, "{name} x {factor}");
                    assert_scaled(&columns, &expected.2, factor, is_exact, 1e-12, name);
                }
            }
        }
    }
}

#[test]
fn every_embedding_and_its_stress_scale() {
    let [_, mesh] = meshes();
    let methods = EmbedMethod::all().map(|method| FormOptions { method, ..FormOptions::default() });
    let samplings = [Sampling::Random, Sampling::MinVariance]
        .map(|sampling| FormOptions { sampling, ..FormOptions::default() });
    for options in methods.into_iter().chain(samplings) {
        let options = FormOptions { samples: Samples::Count(30), ..options };
        let measured = |mesh: &TriMesh| measured(&surface(mesh), &options, StressChoice::Exact);
        let value = |embedded: &Embedded| embedded.report.stress.as_ref().map_or(0.0, |stress| stress.value);
        let expected = measured(&mesh);
        for factor in factors() {
            let found = measured(&scaled(&mesh, factor));
            let (is_exact, name) = (is_power_of_two(factor), options.method.name());
            assert_eq!(found.report.rank, expected.report.rank, "{name} x {factor}");
            assert_eq!(found.report.samples, expected.report.samples, "{name} x {factor}");
            // An iteration that stops at a small change amplifies rounding.
            let tolerance = if options.method.name() == "smacof" { 1e-3 } else { 1e-9 };
            let [length, square] =
                if options.method.has_unit() { [factor, factor * factor] } else { [1.0; 2] };
            let coords = [&found, &expected].map(|embedded| embedded.embedding.coords.as_slice());
            assert_scaled(coords[0], coords[1], length, is_exact, tolerance, name);
            let eigenvalues = [&found, &expected].map(|embedded| &embedded.embedding.eigenvalues);
            assert_scaled(eigenvalues[0], eigenvalues[1], square, is_exact, tolerance, name);
            assert_scaled(&[value(&found)], &[value(&expected)], square, is_exact, tolerance, name);
        }
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn signatures_have_no_scale() {
    for mesh in meshes() {
        let describe = |mesh: &TriMesh| describe(&surface(mesh), &DescribeOptions::default(), &()).unwrap();
        let expected = describe(&mesh);
        for factor in factors() {
            let found = describe(&scaled(&mesh, factor));
            let is_exact = is_power_of_two(factor);
            // Roots of odd powers of two round. Rounding may swap samples that are equally far.
            let tolerance = if is_exact { 1e-12 } else { 0.02 };
            for kind in SignatureKind::INTRINSIC {
                let [a, b] = [&found, &expected].map(|shape| signature(shape, kind).unwrap().values);
                assert_scaled(&a, &b, 1.0, false, tolerance, kind.name());
            }
            let [found, expected] = [&found, &expected].map(|shape| shape.entry.facts);
            assert_scaled(&[found.area], &[expected.area], factor * factor, is_exact, 1e-12, "area");
            assert_scaled(&[found.diameter], &[expected.diameter], factor, is_exact, 1e-12, "diameter");
        }
    }
}
