//! Flat surfaces: rounding of coordinates changes no description.

use base::SplitMix;
use canonform::descriptors::{ShapeMetric, ShapePair, SignatureKind};
use canonform::embed::signature;
use canonform::mesh::{TriMesh, shapes};
use canonform::surface::VertexId;
use canonform::{DescribeOptions, Surface, describe};
use nalgebra::{Point3, Rotation3, Vector3};
use testkit::moved;

/// Uniform in an interval.
fn between(random: &mut SplitMix, low: f64, high: f64) -> f64 {
    low + (high - low) * (0.5 + 0.5 * random.uniform())
}

/// A sheet of n x m squares.
fn sheet(n: usize, m: usize, [width, height]: [f64; 2]) -> TriMesh {
    let step = [width / n as f64, height / m as f64];
    moved(&shapes::grid(n + 1, m + 1, 1.0), |p| Point3::new(step[0] * p.x, step[1] * p.y, 0.0))
}

fn disc(n_rings: usize, n_around: usize) -> TriMesh {
    let at = |ring: usize, k: usize| VertexId::from(1 + (ring - 1) * n_around + k % n_around);
    let mut mesh = TriMesh { positions: vec![Point3::origin()], faces: Vec::new() };
    for ring in 1..=n_rings {
        for k in 0..n_around {
            let (sine, cosine) = (std::f64::consts::TAU * k as f64 / n_around as f64).sin_cos();
            mesh.positions.push(Point3::new(cosine, sine, 0.0) * (ring as f64 / n_rings as f64));
            match ring {
                1 => mesh.faces.push([VertexId(0), at(1, k), at(1, k + 1)]),
                _ => mesh.faces.extend([
                    [at(ring - 1, k), at(ring, k), at(ring, k + 1)],
                    [at(ring - 1, k), at(ring, k + 1), at(ring - 1, k + 1)],
                ]),
            }
        }
    }
    mesh
}

/// Surfaces that are flat up to bending, and mats and rods that nearly are.
fn flat(random: &mut SplitMix) -> Vec<(String, TriMesh)> {
    let mut found = Vec::new();
    for i in 0..12 {
        let [n, m] = [0; 2].map(|_| between(random, 8.0, 40.0) as usize);
        let height = [10.0, 10.0, 5.0, 20.0][i % 4];
        let plate = sheet(n, m, [10.0, height]);
        found.push((format!("plate {n} x {m}, {height} high"), plate));
    }
    found.push(("square".into(), sheet(20, 20, [10.0, 10.0])));
    found.push(("strip".into(), sheet(60, 2, [10.0, 0.3])));
    found.push(("disc".into(), disc(12, 36)));
    found.push(("bent plate".into(), shapes::fold(&shapes::grid(21, 17, 0.1), 0.8, 1.2)));
    for period in [2.5, 8.0] {
        let wave = |x: f64| (std::f64::consts::TAU * x / period).sin();
        let mat = moved(&sheet(40, 40, [40.0, 40.0]), |p| Point3::new(p.x, p.y, 0.3 * wave(p.x) * wave(p.y)));
        found.push((format!("mat of period {period}"), mat));
    }
    for (n_around, radius) in [(6, 0.02), (12, 0.1), (8, 0.005)] {
        found.push((format!("rod of radius {radius}"), shapes::cylinder(n_around, 40, radius, 10.0)));
    }
    found
}

/// The surface elsewhere, as a file of 32 bits has it.
fn rounded(mesh: &TriMesh, random: &mut SplitMix) -> TriMesh {
    let turn = Rotation3::from_euler_angles(
        between(random, 0.0, 6.0),
        between(random, 0.0, 3.0),
        between(random, 0.0, 6.0),
    );
    let scale = [1.0, 25.4, 0.001][between(random, 0.0, 3.0) as usize];
    let far = [0.0, 10.0, 100.0][between(random, 0.0, 3.0) as usize];
    let shift = Vector3::from_fn(|_, _| between(random, -far, far)) * scale;
    moved(mesh, |p| (turn * (p * scale) + shift).map(|x| f64::from(x as f32)))
}

/// The surface with errors of 1e-7 of its size.
fn noisy(mesh: &TriMesh, random: &mut SplitMix) -> TriMesh {
    let size = 1e-7 * mesh.positions.iter().fold(0.0f64, |size, p| size.max(p.coords.norm()));
    let mut changed = mesh.clone();
    changed.positions.iter_mut().flat_map(|p| p.iter_mut()).for_each(|x| *x += size * random.uniform());
    changed
}

#[test]
#[ignore = "slow: make test-all"]
fn rounding_and_noise_change_no_description_of_a_flat_surface() {
    let mut random = SplitMix(7);
    let mut largest = 0.0f64;
    for (name, mesh) in flat(&mut random) {
        let described = |mesh: &TriMesh| {
            let surface = Surface::new(mesh, &Default::default(), &()).unwrap();
            describe(&surface, &DescribeOptions::default(), &()).unwrap()
        };
        let base = described(&mesh);
        let copies = [("rounded", rounded(&mesh, &mut random)), ("noisy", noisy(&mesh, &mut random))];
        for (change, copy) in copies {
            let copy = described(&copy);
            let shapes = [&base, &copy].map(|shape| DescribeOptions::default().prepare(shape).unwrap());
            let distance = ShapePair::new([&shapes[0], &shapes[1]]).distance();
            let kind = SignatureKind::FormSpectrum;
            let [a, b] = [&base, &copy].map(|described| signature(described, kind).unwrap());
            let spectrum = a.distance(&b) / ShapeMetric::unit(kind);
            println!("{name}, {change}: {:.3}, spectrum of the form {spectrum:.3}", distance.combined);
            largest = largest.max(distance.combined);
        }
    }
    assert!(largest < 0.3, "{largest}");
}
