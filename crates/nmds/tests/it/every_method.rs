//! Laws of every embedding. A new embedding adds a line to [`METHODS`].

use canonform_nmds::*;
use linalg::{DistanceMatrix, LandmarkDistances, Matrix, SparseSymmetric, leading_sign, smallest_eigenpairs};

use crate::support::{Cloud, all_pairs, pairwise};

/// Special laws that a method obeys.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    /// Reproduces Euclidean distances.
    Exact,
    /// Equals classical scaling if all points are samples.
    Classical,
    /// Coordinates have the unit of the distances; otherwise they have none.
    Length,
    /// Does not depend on the order of the samples.
    Unordered,
    /// Does not amplify errors of distances between flat points.
    Stable,
}
use Law::{Classical, Exact, Length, Stable, Unordered};

type Method = (&'static str, fn(&Problem, usize) -> Result<Embedding, NmdsError>, &'static [Law]);

const METHODS: [Method; 14] = [
    ("classical", |p, k| classical(&p.all, k, &()), &[Exact, Classical, Length, Unordered, Stable]),
    ("full", |p, k| classical_full(&p.all, k), &[Exact, Classical, Length, Unordered, Stable]),
    ("SMACOF", smacof_from_classical, &[Exact, Length, Unordered, Stable]),
    ("NMDS", |p, k| nmds(p, k, Regularization::LowRank { rank: None }), &[Exact, Length, Unordered, Stable]),
    ("NMDS, all pairs", |p, k| nmds(p, k, Regularization::None), &[Exact, Classical, Length, Unordered]),
    ("NMDS, RPI 1e-8", |p, k| nmds(p, k, rpi(1e-8)), &[Length, Unordered, Stable]),
    ("NMDS, RPI 1e-10", |p, k| nmds(p, k, rpi(1e-10)), &[Length, Unordered, Stable]),
    ("NMDS, RPI 1e-30", |p, k| nmds(p, k, rpi(1e-30)), &[Classical, Length, Unordered]),
    ("NMDS, CUR", |p, k| nmds(p, k, Regularization::Cur { rank: None }), &[Exact, Length]),
    ("NMDS, full CUR", full_cur, &[Exact, Classical, Length, Unordered]),
    ("landmark", |p, k| landmark_mds(&p.samples, k), &[Exact, Classical, Length, Unordered, Stable]),
    ("kernel PCA", |p, dim| kernel_pca(&p.samples, Bandwidth::default(), None, dim), &[Unordered, Stable]),
    ("spectral", |p, k| with_weight(p, k, f64::INFINITY), &[Classical, Length, Unordered, Stable]),
    ("spectral, mu 10", |p, k| with_weight(p, k, 10.0), &[Length, Unordered, Stable]),
];

fn nmds(problem: &Problem, dim: usize, regularization: Regularization) -> Result<Embedding, NmdsError> {
    nystrom(&problem.samples, regularization, dim)
}

fn rpi(c: f64) -> Regularization {
    Regularization::Rpi { alpha: RpiAlpha::Relative(c) }
}

fn full_cur(problem: &Problem, dim: usize) -> Result<Embedding, NmdsError> {
    nmds(problem, dim, Regularization::Cur { rank: Some(problem.samples.n_landmarks()) })
}

fn with_weight(problem: &Problem, dim: usize, mu: f64) -> Result<Embedding, NmdsError> {
    let basis = smallest_eigenpairs(
        &problem.stiffness,
        &problem.masses,
        problem.masses.len(),
        linalg::SymmetricEigen::ACCURATE,
        &(),
    )?;
    let basis = SpectralBasis { values: &basis.values, vectors: &basis.vectors, masses: &problem.masses };
    spectral(&problem.samples, &basis, mu, dim)
}

fn smacof_from_classical(problem: &Problem, dim: usize) -> Result<Embedding, NmdsError> {
    let options = SmacofOptions { max_iterations: 10, tolerance: 0.0 };
    let start = classical(&problem.all, dim, &())?.coords;
    Ok(all_pairs(&problem.all, |pairs| smacof(&start, pairs, &options, &()))?.0)
}

/// Distances between p points and from some of them, and the Laplacian of a ring of springs through all points.
struct Problem {
    all: DistanceMatrix,
    samples: LandmarkDistances,
    stiffness: SparseSymmetric,
    masses: Vec<f64>,
}

impl Problem {
    /// Points are numbered in the order `order`; samples are given by their original numbers. Lengths are multiplied
    /// by `scale`.
    fn ordered(
        order: &[usize],
        samples: &[usize],
        scale: f64,
        distance: &(dyn Fn(usize, usize) -> f64 + Sync),
    ) -> Self {
        let p = order.len();
        let mut number = vec![0; p];
        order.iter().enumerate().for_each(|(i, original)| number[*original] = i);
        let distance = |i: usize, j: usize| scale * distance(order[i], order[j]);
        let samples: Vec<usize> = samples.iter().map(|original| number[*original]).collect();
        let columns = Matrix::from_fn(p, samples.len(), |i, j| distance(i, samples[j]));
        let spring = |i: usize| {
            let (a, b, weight) = (number[i], number[(i + 1) % p], 1.5 + (i as f64).sin());
            [(a, a, weight), (b, b, weight), (a, b, -weight)]
        };
        Self {
            all: DistanceMatrix::from_pairs(p, distance).unwrap(),
            samples: LandmarkDistances::new(samples, columns).unwrap(),
            stiffness: SparseSymmetric::from_entries(p, (0..p).flat_map(spring)),
            masses: order.iter().map(|i| scale * scale * (1.2 + (2.0 * *i as f64).cos())).collect(),
        }
    }

    /// Points in their own order, the first `n` as samples.
    fn new(p: usize, n: usize, distance: &(dyn Fn(usize, usize) -> f64 + Sync)) -> Self {
        Self::ordered(&range(p), &range(n), 1.0, distance)
    }
}

fn range(n: usize) -> Vec<usize> {
    (0..n).collect()
}

/// A power of Euclidean distances in space: with 0.8 still Euclidean, but of high dimension; with 1.2 not.
fn power(cloud: &Cloud, exponent: f64) -> impl Fn(usize, usize) -> f64 {
    move |i, j| cloud.distance(i, j).powf(exponent)
}

/// Distances between embedded points, by their original numbers.
fn embedded(embedding: &Embedding, order: &[usize]) -> Matrix {
    let mut coords = embedding.coords.clone();
    let rows = order.iter().zip(embedding.coords.row_iter());
    rows.for_each(|(&original, row)| coords.row_mut(original).copy_from(&row));
    pairwise(&coords)
}

/// The largest difference, relative to the largest entry of `b`.
fn gap(a: &Matrix, b: &Matrix) -> f64 {
    (a - b).amax() / b.amax()
}

#[test]
fn columns_are_orthogonal_centered_and_of_reproducible_sign() {
    let cloud = Cloud::new(60, 4, 61);
    for exponent in [0.8, 1.0, 1.2] {
        let problem = Problem::new(60, 20, &power(&cloud, exponent));
        for (name, embed, _) in METHODS {
            let Embedding { coords, eigenvalues, negative_mass, rank } = embed(&problem, 3).unwrap();
            assert_eq!(coords.shape(), (60, 3), "{name}");
            assert!(eigenvalues.is_sorted_by(|a, b| a >= b) && eigenvalues.len() >= 3, "{name}");
            assert!((0.0..=1.0).contains(&negative_mass) && rank >= 3, "{name}");
            let gram = Matrix::from_diagonal(&eigenvalues[..3].to_vec().into());
            assert!(gap(&coords.tr_mul(&coords), &gram) < 1e-9, "{name}");
            for column in coords.column_iter() {
                assert!(column.mean().abs() < 1e-9 * column.amax(), "{name}");
                assert_eq!(leading_sign(column.as_slice()), 1.0, "{name}");
            }
        }
    }
}

#[test]
fn exact_methods_reproduce_euclidean_distances() {
    for (p, n, dim) in [(60, 20, 3), (40, 9, 2), (12, 7, 1), (2, 2, 1)] {
        let cloud = Cloud::new(p, dim, 62);
        let problem = Problem::new(p, n, &power(&cloud, 1.0));
        for (name, embed, _) in METHODS.into_iter().filter(|(_, _, laws)| laws.contains(&Exact)) {
            let found = embedded(&embed(&problem, dim).unwrap(), &range(p));
            let gap = gap(&found, &Matrix::from_row_slice(p, p, problem.all.as_slice()));
            assert!(gap < 1e-8, "{name}, {p} points: {gap:e}");
        }
    }
}

#[test]
fn with_all_points_as_samples_methods_equal_classical_scaling() {
    let cloud = Cloud::new(50, 5, 63);
    for exponent in [0.8, 1.2] {
        let problem = Problem::new(50, 50, &power(&cloud, exponent));
        let full = classical_full(&problem.all, 3).unwrap();
        for (name, embed, _) in METHODS.into_iter().filter(|(_, _, laws)| laws.contains(&Classical)) {
            let found = embed(&problem, 3).unwrap();
            let gap = gap(&found.coords, &full.coords);
            assert!(gap < 1e-7, "{name}: {gap:e}");
            // Classical scaling computes only the eigenvalues of its columns.
            let same_mass = (found.negative_mass - full.negative_mass).abs() < 1e-8;
            assert!(same_mass || name == "classical", "{name}");
        }
    }
}

#[test]
fn the_unit_of_length_and_the_order_of_points_and_samples_change_nothing_else() {
    let cloud = Cloud::new(60, 4, 65);
    let shuffled: Vec<usize> = (0..60).map(|i| (i * 37 + 11) % 60).collect();
    let (points, samples) = (range(60), range(15));
    let backwards: Vec<usize> = (0..15).rev().collect();
    for (name, embed, laws) in METHODS {
        let found = |order: &[usize], samples: &[usize], scale: f64| {
            let problem = Problem::ordered(order, samples, scale, &power(&cloud, 0.9));
            let found = embed(&problem, 3).unwrap();
            let unit = if laws.contains(&Length) { scale } else { 1.0 };
            (embedded(&found, order) / unit, found.negative_mass)
        };
        let (lengths, negative_mass) = found(&points, &samples, 1.0);
        let mut others = vec![
            found(&points, &samples, 1e-3),
            found(&points, &samples, 1e3),
            found(&shuffled, &samples, 1.0),
        ];
        others.extend(laws.contains(&Unordered).then(|| found(&points, &backwards, 1.0)));
        for (i, other) in others.into_iter().enumerate() {
            let gap = gap(&other.0, &lengths);
            assert!(gap < 1e-9 && (other.1 - negative_mass).abs() < 1e-9, "{name}, {i}: {gap:e}");
        }
    }
}

#[test]
fn points_on_a_line_have_empty_dimensions_and_finite_coordinates() {
    let problem = Problem::ordered(&range(30), &[0, 6, 12, 18, 24], 1.0, &|i, j| (i as f64 - j as f64).abs());
    for (name, embed, laws) in METHODS {
        let embedding = embed(&problem, 3).unwrap();
        assert_eq!(embedding.coords.shape(), (30, 3), "{name}");
        assert!(embedding.coords.iter().all(|x| x.is_finite()), "{name}");
        if laws.contains(&Exact) {
            assert!(embedding.coords.columns(1, 2).amax() < 1e-6, "{name}");
            assert!((embedding.coords.column(0).max() - 14.5).abs() < 1e-9, "{name}");
        }
    }
}

/// n x m points of a rectangle as those of a mesh: the first ones, far from each other, are samples.
fn flat_points([n, m]: [usize; 2], size: [f64; 2]) -> Vec<[f64; 2]> {
    let at = |i: usize, n: usize| i as f64 / (n - 1) as f64;
    let shuffled = (0..n * m).map(|k| (k * 37) % (n * m));
    shuffled.map(|k| [size[0] * at(k / m, n), size[1] * at(k % m, m)]).collect()
}

#[test]
fn errors_of_distances_between_flat_points_are_not_amplified() {
    let [square, plate, strip] = [([12, 12], [1.0, 1.0]), ([18, 11], [2.0, 1.0]), ([50, 2], [1.0, 1e-6])];
    let mut disc = flat_points([15, 15], [1.0, 1.0]);
    disc.retain(|[x, y]| (x - 0.5).hypot(y - 0.5) <= 0.5);
    let rectangles = [square, plate, strip].map(|(n, size)| flat_points(n, size));
    for points in rectangles.into_iter().chain([disc]) {
        let p = points.len();
        let exact = |i: usize, j: usize| {
            let ([a, b], [c, d]) = (points[i], points[j]);
            (a - c).hypot(b - d)
        };
        // Alike between all points, or smaller between samples, which are far from each other.
        for (size, among_samples) in [(1e-13, 1.0), (1e-10, 1.0), (1e-7, 1.0), (1e-9, 1e-4), (1e-7, 1e-4)] {
            let noisy = |i: usize, j: usize| {
                let (i, j) = (i.min(j), i.max(j));
                let error = ((1 + i) as f64 * 12.9898 + (1 + j) as f64 * 78.233).sin() * 43758.5453;
                let share = if j < 30 { among_samples } else { 1.0 };
                exact(i, j) * (1.0 + size * share * (2.0 * (error - error.floor()) - 1.0))
            };
            let [base, changed] = [Problem::new(p, 30, &exact), Problem::new(p, 30, &noisy)];
            let lengths = Matrix::from_row_slice(p, p, base.all.as_slice());
            for (name, embed, laws) in METHODS.into_iter().filter(|(_, _, laws)| laws.contains(&Stable)) {
                let lengths_of = |problem: &Problem| embedded(&embed(problem, 3).unwrap(), &range(p));
                let expected = if laws.contains(&Exact) { lengths.clone() } else { lengths_of(&base) };
                let gap = gap(&lengths_of(&changed), &expected);
                // A height of the root of the error is within it.
                assert!(gap < 3e-3, "{name}, {p} points, {size:e}, {among_samples:e} at samples: {gap:e}");
            }
        }
    }
}

#[test]
fn impossible_dimensions_and_points_without_extent_are_rejected() {
    let cloud = Cloud::new(9, 3, 67);
    let problem = Problem::new(9, 9, &power(&cloud, 1.0));
    let coinciding = Problem::new(6, 6, &|_, _| 0.0);
    for (name, embed, _) in METHODS {
        for dim in [0, 10] {
            match embed(&problem, dim) {
                Err(NmdsError::BadDimension { dim: found, limit }) => {
                    assert_eq!((found, (3..=9).contains(&limit)), (dim, true), "{name}");
                }
                other => panic!("{name}: {other:?}"),
            }
        }
        assert_eq!(embed(&coinciding, 2), Err(NmdsError::NoExtent(6)), "{name}");
    }
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let cloud = Cloud::new(300, 4, 68);
    let problem = Problem::new(300, 12, &power(&cloud, 0.9));
    for (name, embed, _) in METHODS {
        let [one, four] = [1, 4].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| embed(&problem, 3).unwrap())
        });
        assert_eq!(one, four, "{name}");
    }
}
