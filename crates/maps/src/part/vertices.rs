//! From the places of samples to all vertices.

use rayon::prelude::*;

use super::sides::Sides;
use crate::local::{between, least_distance};
use crate::nearest_rows::{PROBED, first_of};
use descriptors::DescriptorError;

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
fn neighbors(sides: &Sides<'_>) -> Vec<Vec<(f64, usize)>> {
    let gaps = |y: usize| sides.in_whole.column(y).iter().copied().zip(0..).collect();
    (0..sides.in_whole.nrows()).into_par_iter().map(|y| first_of(gaps(y), PROBED)).collect()
}

/// The vertex of the whole for each vertex of the part: near the place of its sample, the one whose distances from the images
/// of the landmarks fit best.
pub(super) fn all_vertices(sides: &Sides<'_>, places: &[usize]) -> Result<Vec<usize>, DescriptorError> {
    let (part, whole, near) = (sides.part, sides.whole, neighbors(sides));
    let n = sides.in_part.nrows();
    let images: Vec<usize> = (0..n).map(|l| sides.whole.samples[places[l]]).collect();
    // A row for each image, a column for each vertex of the whole.
    let from_images = between(&whole.distances_to(&images)?, &whole.all_distances()?);
    let in_part = part.all_distances()? * sides.scale;
    let one = |v: usize| {
        let place = places[part.nearest[v].min(places.len() - 1)];
        let members = near[place].iter().flat_map(|(_, y)| &whole.cells[*y]);
        let loss = |w: usize| -> f64 {
            let of = |l: usize| {
                sides.known_of(l, v, in_part[(l, v)]).loss(from_images[(l, w)], sides.max_change())
            };
            (0..n).map(of).sum()
        };
        let best = members.map(|w| (loss(*w), *w)).min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(sides.whole.samples[place], |(_, w)| w)
    };
    Ok((0..part.n_vertices()).into_par_iter().map(one).collect())
}

/// The vertex of the part nearest to each vertex of the whole, with the images of all vertices of the part.
pub(super) fn onto_part(sides: &Sides<'_>, images: &[usize]) -> Result<Coverage, DescriptorError> {
    let (whole, near) = (sides.whole, neighbors(sides));
    let distances = whole.all_distances()?;
    let mut in_cell = vec![Vec::new(); sides.in_whole.nrows()];
    images.iter().enumerate().for_each(|(v, w)| in_cell[whole.nearest[*w]].push(v));
    let one = |w: usize| {
        let candidates = near[whole.nearest[w]].iter().flat_map(|(_, y)| &in_cell[*y]);
        let gap = |v: usize| least_distance(distances.column(w), distances.column(images[v]));
        let best = candidates.map(|v| (gap(*v), *v)).min_by(|a, b| a.0.total_cmp(&b.0));
        best.unwrap_or((f64::INFINITY, 0))
    };
    let found: Vec<(f64, usize)> = (0..whole.n_vertices()).into_par_iter().map(one).collect();
    let spacing = sides.scale / (images.len().max(1) as f64).sqrt();
    let matched: Vec<bool> = found.iter().map(|(gap, _)| *gap <= REACH * spacing).collect();
    let masses = whole.spectrum.masses.iter().zip(&matched);
    let covered = masses.filter(|(_, matched)| **matched).map(|(mass, _)| mass).sum();
    Ok(Coverage { covered, partners: found.into_iter().map(|(_, v)| v).collect(), matched })
}
