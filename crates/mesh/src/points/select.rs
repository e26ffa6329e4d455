//! The triangles that points agree on.

use std::f64::consts::{PI, TAU};

use surface::{Topology, VertexId};

use super::star::{Proposal, Stars};
use crate::boundary::simple_boundaries;

/// Fewest points that propose a face.
const FEWEST: usize = 2;

/// Corners of the largest gap that is closed.
const MAX_GAP: usize = 10;

/// Angles that overlap by less do not overlap.
const ROUNDING: f64 = 1e-9;

/// The faces on which most corners agree, without overlaps: of two that overlap, the one with more proposals, else the one
/// with the smaller circle.
pub(super) fn agreed(stars: &Stars) -> Vec<[u32; 3]> {
    let mut proposals = stars.proposals.clone();
    proposals.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let groups = proposals.chunk_by(|a, b| a.0 == b.0);
    let mut counted: Vec<(usize, Proposal)> = groups.map(|group| (group.len(), group[0])).collect();
    counted.sort_unstable_by(|(n, a), (m, b)| m.cmp(n).then(a.1.total_cmp(&b.1)).then(a.0.cmp(&b.0)));
    let mut sectors = Sectors { stars, taken: vec![Vec::new(); stars.points.len()] };
    let mut faces: Vec<[u32; 3]> = counted
        .iter()
        .take_while(|(n, _)| *n >= FEWEST)
        .map(|(_, (face, _))| *face)
        .filter(|face| sectors.take(*face))
        .collect();
    close_gaps(&mut faces, &mut sectors);
    faces.sort_unstable();
    faces
}

/// The sectors of the tangent plane of every point that faces cover: where they begin, and how wide they are.
struct Sectors<'a> {
    stars: &'a Stars,
    taken: Vec<Vec<[f64; 2]>>,
}

impl Sectors<'_> {
    /// Takes a face, unless it overlaps one.
    fn take(&mut self, face: [u32; 3]) -> bool {
        let [a, b, c] = face;
        let corners = [[a, b, c], [b, c, a], [c, a, b]].map(|[at, from, to]| (at, self.sector(at, from, to)));
        let is_free = |&(at, sector): &(u32, [f64; 2])| {
            self.taken[at as usize].iter().all(|other| !overlap(sector, *other))
        };
        let fits = corners.iter().all(is_free);
        if fits {
            corners.iter().for_each(|&(at, sector)| self.taken[at as usize].push(sector));
        }
        fits
    }

    /// The sector of a corner, counter-clockwise.
    fn sector(&self, at: u32, one: u32, other: u32) -> [f64; 2] {
        let [from, to] = [one, other].map(|v| self.stars.angle(at, v));
        let width = (to - from).rem_euclid(TAU);
        if width <= PI { [from, width] } else { [to, TAU - width] }
    }
}

fn overlap([a, wide]: [f64; 2], [b, other]: [f64; 2]) -> bool {
    let ahead = (b - a).rem_euclid(TAU);
    ahead < wide - ROUNDING || TAU - ahead < other - ROUNDING
}

/// Closes gaps of few sides with the faces that fit, short new edges first.
fn close_gaps(faces: &mut Vec<[u32; 3]>, sectors: &mut Sectors<'_>) {
    // A gap of n sides needs n - 2 faces. Each cuts off a corner of the boundary.
    for _ in 0..MAX_GAP {
        let mut ears = ears(faces, sectors.stars);
        ears.sort_unstable_by(|(a, f), (b, g)| a.total_cmp(b).then(f.cmp(g)));
        let before = faces.len();
        faces.extend(ears.into_iter().map(|(_, ear)| ear).filter(|ear| sectors.take(*ear)));
        if faces.len() == before {
            break;
        }
    }
}

/// The corners of small gaps: a corner of the boundary with its two neighbors, and the length of the edge between these.
fn ears(faces: &[[u32; 3]], stars: &Stars) -> Vec<(f64, [u32; 3])> {
    let faces = faces.iter().map(|face| face.map(VertexId)).collect();
    let gaps = simple_boundaries(&Topology::new(stars.points.len(), faces));
    let mut ears = Vec::new();
    for gap in gaps.into_iter().filter(|gap| gap.len() <= MAX_GAP) {
        // All corners of a triangle are the same ear.
        let n_ears = if gap.len() == 3 { 1 } else { gap.len() };
        for i in 0..n_ears {
            let mut ear = [0, 1, 2].map(|k| gap[(i + k) % gap.len()].0);
            let [a, _, c] = ear.map(|v| stars.points[v as usize]);
            ear.sort_unstable();
            ears.push(((a - c).norm(), ear));
        }
    }
    ears
}
