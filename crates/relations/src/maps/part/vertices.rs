//! From the places of samples to all vertices.

use linalg::Matrix;
use rayon::prelude::*;

use super::sides::{Sides, between};
use descriptors::DescriptorError;

/// Cells of the whole in which a vertex is sought, around the place of its sample.
const PROBED: usize = 8;

/// A vertex of the whole has a partner if the image of one is at most so many times as far as the images are from each other
/// on average. A convention.
const REACH: f64 = 2.0;

/// The part, seen from the whole.
pub(super) struct Coverage {
    /// The share of the area of the whole that has partners.
    pub(super) covered: f64,
    /// For each vertex of the whole, the vertex of the part whose image is nearest.
    pub(super) partners: Vec<usize>,
    /// Whether that is near.
    pub(super) matched: Vec<bool>,
}

/// For each sample of the whole, the nearest ones, itself first.
fn neighbors(sides: &Sides<'_>) -> Vec<Vec<usize>> {
    let nearest = |y: usize| {
        let gaps = sides.in_whole.column(y);
        let mut order: Vec<usize> = (0..gaps.len()).collect();
        let by_gap = |a: &usize, b: &usize| gaps[*a].total_cmp(&gaps[*b]).then(a.cmp(b));
        if order.len() > PROBED {
            order.select_nth_unstable_by(PROBED - 1, by_gap);
            order.truncate(PROBED);
        }
        order.sort_unstable_by(by_gap);
        order
    };
    (0..sides.ys.len()).into_par_iter().map(nearest).collect()
}

/// The vertex of the whole for each vertex of the part: near the place of its sample, the one whose distances from the images
/// of the landmarks fit best.
pub(super) fn all_vertices(sides: &Sides<'_>, places: &[usize]) -> Result<Vec<usize>, DescriptorError> {
    let (part, whole) = (sides.part, sides.whole);
    let near = neighbors(sides);
    let all: Vec<usize> = (0..whole.n_vertices()).collect();
    let n = sides.n_landmarks()[0];
    let images: Vec<usize> = (0..n).map(|l| sides.ys[places[l]]).collect();
    // A row for each image, a column for each vertex of the whole.
    let from_images = between(&whole.distances_to(&images)?, &whole.distances_to(&all)?);
    let vertices: Vec<usize> = (0..part.n_vertices()).collect();
    let in_part = part.distances_to(&vertices)? * sides.scale();
    let sample_of = part.sample_of_vertices();
    let one = |v: usize| {
        let place = places[sample_of[v].min(places.len() - 1)];
        let members = near[place].iter().flat_map(|y| &whole.cells[*y]).map(|w| *w as usize);
        let loss = |w: usize| -> f64 {
            let of = |l: usize| Sides::loss(sides.known_of(l, v, in_part[(l, v)]), from_images[(l, w)]);
            (0..n).map(of).sum()
        };
        let best = members.map(|w| (loss(w), w)).min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(sides.ys[place], |(_, w)| w)
    };
    Ok(vertices.par_iter().map(|v| one(*v)).collect())
}

/// The vertex of the part nearest to each vertex of the whole, with the images of all vertices of the part.
pub(super) fn onto_part(sides: &Sides<'_>, images: &[usize]) -> Result<Coverage, DescriptorError> {
    let whole = sides.whole;
    let near = neighbors(sides);
    let all: Vec<usize> = (0..whole.n_vertices()).collect();
    let distances: Matrix = whole.distances_to(&all)?;
    let sample_of = whole.sample_of_vertices();
    let mut in_cell = vec![Vec::new(); sides.ys.len()];
    images.iter().enumerate().for_each(|(v, w)| in_cell[sample_of[*w]].push(v));
    let gap = |w: usize, z: usize| {
        distances
            .column(w)
            .iter()
            .zip(distances.column(z).iter())
            .map(|(p, q)| (p - q).abs())
            .fold(0.0, f64::max)
    };
    let one = |w: usize| {
        let candidates = near[sample_of[w]].iter().flat_map(|y| &in_cell[*y]);
        let best = candidates.map(|v| (gap(w, images[*v]), *v)).min_by(|a, b| a.0.total_cmp(&b.0));
        best.unwrap_or((f64::INFINITY, 0))
    };
    let found: Vec<(f64, usize)> = all.par_iter().map(|w| one(*w)).collect();
    let spacing = sides.scale() / (images.len().max(1) as f64).sqrt();
    let matched: Vec<bool> = found.iter().map(|(gap, _)| *gap <= REACH * spacing).collect();
    let covered = whole
        .spectrum
        .masses
        .iter()
        .zip(&matched)
        .filter(|(_, matched)| **matched)
        .map(|(mass, _)| mass)
        .sum();
    Ok(Coverage { covered, partners: found.into_iter().map(|(_, v)| v).collect(), matched })
}
