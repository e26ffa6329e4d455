//! Laws of searches: single precision decides nothing.

use base::SplitMix;
use retrieval::Neighbor;

use super::VectorTable;
use super::kernels::{least_loss, losses_into};

/// `n` vectors of `dim` numbers, uniform in -1..1.
fn noise(n: usize, dim: usize, seed: u64) -> Vec<f32> {
    let mut random = SplitMix(seed);
    (0..n * dim).map(|_| random.uniform() as f32).collect()
}

/// The root of the sum of Huber's losses, in double precision.
fn huber(a: &[f32], b: &[f32], limits: &[f32]) -> f64 {
    let limits = limits.iter().copied().chain(std::iter::repeat(f32::INFINITY));
    let loss = |((x, y), limit): ((&f32, &f32), f32)| {
        let gap = (f64::from(*x) - f64::from(*y)).abs();
        let inside = gap.min(f64::from(limit));
        inside * (2.0 * gap - inside)
    };
    a.iter().zip(b).zip(limits).map(loss).sum::<f64>().sqrt()
}

#[test]
fn losses_are_hardly_above_their_least_value_and_that_is_below_the_sum_in_double_precision() {
    for (dim, n) in [(16, 1), (32, 7), (160, 13), (128, 64)] {
        for width in [1e-25, 1e-10, 1.0, 1e12] {
            let scaled = |seed, n| noise(n, dim, seed).into_iter().map(|x| x * width).collect::<Vec<_>>();
            let (query, rows) = (scaled(3, 1), scaled(4, n));
            let some: Vec<f32> = scaled(5, 1).iter().map(|x| x.abs()).collect();
            for limits in [some, vec![f32::INFINITY; dim]] {
                let mut found = vec![0.0; n];
                losses_into(&query, &limits, &rows, &mut found);
                for (row, found) in rows.chunks(dim).zip(found) {
                    let (loss, least) = (huber(&query, row, &limits).powi(2), least_loss(found, dim));
                    assert!(least <= loss, "{least} {loss}");
                    assert!(least >= (1.0 - 3e-5) * loss || loss < 1e-32, "{least} {loss}");
                }
            }
        }
    }
    assert_eq!([f32::INFINITY, f32::NAN].map(|sum| least_loss(sum, 16)), [0.0; 2]);
}

#[test]
fn vectors_come_in_the_order_of_their_distances_for_ties_and_outliers_too() {
    const DIM: usize = 21;
    let (mut rows, limits) = (noise(1500, DIM, 7), [0.1; DIM - 1]);
    // Equal rows, in other blocks, and rows that differ by the last bits.
    for i in (0..600).step_by(3) {
        let copy = (1490 - 2 * i) * DIM;
        rows.copy_within(i * DIM..(i + 1) * DIM, copy);
        rows[copy] += f32::EPSILON * (i % 2) as f32;
    }
    for (i, outlier) in [1e12, -1e20, f32::MAX, -f32::MAX, 1e-42].into_iter().enumerate() {
        (0..20).for_each(|n| rows[(67 * n + i) * DIM + n] = outlier);
    }
    let mut all = VectorTable::default();
    rows.chunks(DIM).for_each(|row| all.push("", row));
    for query in [0, 2, 3, 900].map(|i| all.vector(i)) {
        for limits in [&limits[..], &[]] {
            let distance = |vector: &[f32]| huber(query, vector, limits);
            let neighbor = |index| Neighbor { index, distance: distance(all.vector(index)) };
            let mut expected: Vec<_> = (0..all.len()).map(neighbor).collect();
            expected.sort_by(Neighbor::by_distance);
            assert!(all.nearest_first(query, limits, distance).eq(expected.iter().copied()));
            if limits.is_empty() {
                assert_eq!(all.nearest(query, 40), expected[..40]);
            }
        }
    }
    assert_eq!(VectorTable::default().nearest(&[], 3), []);
}
