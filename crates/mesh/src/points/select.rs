//! The triangles that points agree on.

use std::collections::{HashMap, HashSet};
use std::f64::consts::{PI, TAU};

use super::star::{Proposal, Stars};

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
    let mut counted: Vec<(usize, Proposal)> = Vec::with_capacity(proposals.len() / 3);
    for group in proposals.chunk_by(|a, b| a.0 == b.0) {
        counted.push((group.len(), group[0]));
    }
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
        for (_, ear) in ears {
            if sectors.take(ear) {
                faces.push(ear);
            }
        }
        if faces.len() == before {
            break;
        }
    }
}

/// The corners of small gaps: a corner of the boundary with its two neighbors, and the length of the edge between these.
fn ears(faces: &[[u32; 3]], stars: &Stars) -> Vec<(f64, [u32; 3])> {
    let mut n_faces: HashMap<[u32; 2], u32> = HashMap::with_capacity(2 * faces.len());
    for &[a, b, c] in faces {
        // Corners ascend.
        [[a, b], [b, c], [a, c]].into_iter().for_each(|edge| *n_faces.entry(edge).or_default() += 1);
    }
    let mut next: HashMap<u32, Vec<u32>> = HashMap::new();
    for (&[a, b], _) in n_faces.iter().filter(|(_, n)| **n == 1) {
        next.entry(a).or_default().push(b);
        next.entry(b).or_default().push(a);
    }
    let length = |a: u32, b: u32| (stars.points[a as usize] - stars.points[b as usize]).norm();
    let (mut ears, mut known) = (Vec::new(), HashSet::new());
    for gap in gaps(&next) {
        for i in 0..gap.len() {
            let [a, b, c] = [gap[i], gap[(i + 1) % gap.len()], gap[(i + 2) % gap.len()]];
            let mut ear = [a, b, c];
            ear.sort_unstable();
            if known.insert(ear) {
                ears.push((length(a, c), ear));
            }
        }
    }
    ears
}

/// Closed boundaries with few sides, through vertices with two boundary edges.
fn gaps(next: &HashMap<u32, Vec<u32>>) -> Vec<Vec<u32>> {
    let mut starts: Vec<u32> = next.keys().copied().collect();
    starts.sort_unstable();
    let mut gaps = Vec::new();
    for start in starts {
        let mut gap = vec![start];
        let (mut before, mut at) = (start, start);
        while gap.len() <= MAX_GAP {
            let ends = &next[&at];
            let [a, b] = ends[..] else { break };
            let step = if at == start {
                a.min(b)
            } else if a == before {
                b
            } else {
                a
            };
            if step == start {
                // Every gap is found from its lowest vertex only.
                if gap.iter().all(|v| *v >= start) && gap.len() >= 3 {
                    gaps.push(gap);
                }
                break;
            }
            gap.push(step);
            (before, at) = (at, step);
        }
    }
    gaps
}
