//! Stringing the triangles at a vertex together.

use std::f64::consts::PI;

use super::spokes::{Spoke, Ways};
use crate::corner::Corner;

/// A way from a vertex: where it ends, and whether the front may go along it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Arm {
    end: u32,
    length: f64,
    is_way: bool,
}

impl Arm {
    /// A straight way inside the surface.
    pub(super) fn edge(end: u32, length: f64) -> Self {
        Self { end, length, is_way: true }
    }

    /// A side of a triangle that may leave the surface.
    pub(super) fn side(end: u32, length: f64) -> Self {
        Self { end, length, is_way: false }
    }

    fn ways(&self) -> Ways {
        if self.is_way { Ways::ALONG } else { Ways::NONE }
    }
}

/// Something that the front may do at a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Part {
    /// Cross a triangle.
    Triangle {
        arms: [Arm; 2],
        /// Scalar product of the arms.
        dot: f64,
        /// Twice the area.
        cross: f64,
        reaches: Reaches,
    },
    /// Go along a way between no triangles.
    Bare(Arm),
}

/// Which ends of its arms a triangle gives distances to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Reaches {
    Both,
    First,
}

impl Part {
    /// The triangle between two arms, with the length of its third side.
    pub(super) fn triangle(arms: [Arm; 2], third: f64, reaches: Reaches) -> Self {
        let corner = Corner::from_lengths(arms[0].length, arms[1].length, third);
        let (dot, cross) = (corner.x * arms[0].length, corner.y * arms[0].length);
        Self::Triangle { arms, dot, cross, reaches }
    }

    /// A straight way between two vertices, as a part of either.
    pub(super) fn segment([a, b]: [u32; 2], length: f64) -> [(u32, Self); 2] {
        [(a, Self::Bare(Arm::edge(b, length))), (b, Self::Bare(Arm::edge(a, length)))]
    }

    pub(super) fn is_triangle(&self) -> bool {
        matches!(self, Self::Triangle { .. })
    }

    fn has(&self, arm: &Arm) -> bool {
        matches!(self, Self::Triangle { arms, .. } if arms.contains(arm))
    }
}

/// The sum of the angles of the triangles at a vertex.
///
/// A direction is turned by one after the other and half turns are counted, so that one arc tangent is enough.
pub(super) fn total_angle(parts: &[Part]) -> f64 {
    let (mut x, mut y, mut half_turns) = (1.0, 0.0, 0.0);
    for part in parts {
        let Part::Triangle { dot, cross, .. } = part else { continue };
        if *dot == 0.0 && *cross == 0.0 {
            continue;
        }
        (x, y) = (x * dot - y * cross, x * cross + y * dot);
        let size = f64::max(x.abs(), y.abs());
        (x, y) = (x / size, y / size);
        if y < 0.0 || (y == 0.0 && x < 0.0) {
            (x, y, half_turns) = (-x, -y, half_turns + 1.0);
        }
    }
    half_turns * PI + y.atan2(x)
}

/// Whether the triangles at a vertex leave a gap between them.
pub(super) fn is_cut(parts: &[Part]) -> bool {
    let is_odd = |arm: &Arm| parts.iter().filter(|part| part.has(arm)).count() % 2 == 1;
    parts.iter().any(|part| matches!(part, Part::Triangle { arms, .. } if arms.iter().any(is_odd)))
}

/// How the triangles at a vertex hang together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Strung {
    /// In one ring.
    Ring,
    /// In open chains, in several rings, or there are none.
    Otherwise,
}

/// Makes spokes of parts.
#[derive(Debug, Default)]
pub(super) struct Chains {
    /// Parts that have become spokes.
    used: Vec<bool>,
}

impl Chains {
    /// Appends the spokes of a vertex with the given parts.
    ///
    /// A ring that is all that there is begins with the spoke that closes it: the spoke before the first is the
    /// last then. Everything else begins with a spoke that has no triangle behind it.
    pub(super) fn append(&mut self, parts: &[Part], spokes: &mut Vec<Spoke>) -> Strung {
        let first = spokes.len();
        let strung = self.ring(parts, spokes);
        if strung == Strung::Otherwise {
            spokes.truncate(first);
            self.strings(parts, spokes);
        }
        let n_strung = spokes.len();
        for part in parts {
            let Part::Bare(arm) = part else { continue };
            let is_shorter = |spoke: &Spoke| {
                spoke.end == arm.end && spoke.ways.allow(Ways::ALONG) && spoke.length <= arm.length
            };
            if !spokes[first..].iter().any(is_shorter) {
                spokes.push(start(arm));
            }
        }
        if strung == Strung::Ring && spokes.len() == n_strung {
            spokes.swap_remove(first);
        }
        strung
    }

    /// Tries whether the triangles are one ring, as they are at nearly all vertices.
    fn ring(&mut self, parts: &[Part], spokes: &mut Vec<Spoke>) -> Strung {
        self.used.clear();
        self.used.resize(parts.len(), false);
        let mut triangles = parts.iter().filter(|part| part.is_triangle());
        let Some(Part::Triangle { arms: [begin, _], .. }) = triangles.next() else {
            return Strung::Otherwise;
        };
        let end = self.chain(parts, *begin, spokes);
        let n_used = self.used.iter().filter(|used| **used).count();
        if end == *begin && n_used == 1 + triangles.count() { Strung::Ring } else { Strung::Otherwise }
    }

    /// Strings the triangles together in as few chains as there can be.
    fn strings(&mut self, parts: &[Part], spokes: &mut Vec<Spoke>) {
        self.used.fill(false);
        // Arms of an odd number of triangles are where chains must begin or end; what is left are rings.
        for begins in [Self::is_loose, |_: &Self, _: &[Part], _: &Arm| true] {
            for i in 0..parts.len() {
                while let Part::Triangle { arms, .. } = &parts[i]
                    && !self.used[i]
                    && let Some(arm) = arms.iter().find(|arm| begins(self, parts, arm))
                {
                    self.chain(parts, *arm, spokes);
                }
            }
        }
    }

    /// A chain from an arm on through unused triangles; its last arm.
    fn chain(&mut self, parts: &[Part], mut arm: Arm, spokes: &mut Vec<Spoke>) -> Arm {
        spokes.push(start(&arm));
        while let Some(i) = (0..parts.len()).find(|&i| !self.used[i] && parts[i].has(&arm)) {
            let Part::Triangle { arms, dot, cross, reaches } = parts[i] else { break };
            self.used[i] = true;
            let is_first = arms[1] == arm;
            arm = if is_first { arms[0] } else { arms[1] };
            let through = match (reaches, is_first) {
                (Reaches::Both, _) => Ways::ONWARD.and(Ways::BACK),
                (Reaches::First, true) => Ways::ONWARD,
                (Reaches::First, false) => Ways::BACK,
            };
            let ways = through.and(arm.ways());
            spokes.push(Spoke { end: arm.end, ways, length: arm.length, dot, cross });
        }
        arm
    }

    /// Whether an arm belongs to an odd number of unused triangles.
    fn is_loose(&self, parts: &[Part], arm: &Arm) -> bool {
        let unused = self.used.iter().zip(parts).filter(|(used, part)| !**used && part.has(arm));
        unused.count() % 2 == 1
    }
}

/// A spoke without a triangle behind it.
fn start(arm: &Arm) -> Spoke {
    Spoke { end: arm.end, ways: arm.ways(), length: arm.length, dot: 0.0, cross: 0.0 }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

    use super::*;

    /// Equilateral triangles between the given pairs of arms.
    fn triangles(pairs: &[[u32; 2]]) -> Vec<Part> {
        let arms = |ends: &[u32; 2]| ends.map(|end| Arm::edge(end, 1.0));
        pairs.iter().map(|ends| Part::triangle(arms(ends), 1.0, Reaches::Both)).collect()
    }

    fn ends(parts: &[Part]) -> Vec<u32> {
        let mut spokes = Vec::new();
        let strung = Chains::default().append(parts, &mut spokes);
        assert!(!(strung == Strung::Ring && is_cut(parts)));
        spokes.iter().map(|spoke| spoke.end).collect()
    }

    #[test]
    fn a_ring_is_closed_by_its_first_spoke() {
        let ring = triangles(&[[1, 2], [3, 4], [2, 3], [1, 4]]);
        assert_eq!(ends(&ring), [1, 2, 3, 4]);
        assert!(!is_cut(&ring));
        assert!((total_angle(&ring) - 4.0 * std::f64::consts::FRAC_PI_3).abs() < 1e-14);
    }

    #[test]
    fn angles_add_up_beyond_any_number_of_turns() {
        let corner = |dot, cross| {
            let arms = [1, 2].map(|end| Arm::edge(end, 1.0));
            Part::Triangle { arms, dot, cross, reaches: Reaches::Both }
        };
        for angle in [0.0, 1e-9, 1.0, FRAC_PI_2, 2.5, 3.0, PI] {
            for n in [1, 2, 3, 4, 7, 40] {
                // Of sizes whose product no number holds.
                let parts: Vec<Part> = (0..n)
                    .map(|i| [1e200, 1e-200][i % 2])
                    .map(|size: f64| corner(size * angle.cos(), size * angle.sin()))
                    .collect();
                let expected = n as f64 * angle;
                assert!(
                    (total_angle(&parts) - expected).abs() < 1e-13 * (1.0 + expected),
                    "{n} times {angle}"
                );
            }
        }
        let point = corner(0.0, 0.0);
        assert_eq!(total_angle(&[point, corner(1.0, 1.0), point, Part::Bare(Arm::edge(1, 1.0))]), FRAC_PI_4);
    }

    #[test]
    fn an_open_chain_goes_from_end_to_end() {
        let chain = triangles(&[[1, 2], [3, 4], [2, 3]]);
        assert_eq!(ends(&chain), [1, 2, 3, 4]);
        assert!(is_cut(&chain));
    }

    #[test]
    fn every_triangle_of_a_fan_over_one_edge_is_met_once() {
        let fan = triangles(&[[1, 2], [1, 3], [1, 4]]);
        let ends = ends(&fan);
        assert_eq!(ends.len(), 5, "three triangles in two chains: {ends:?}");
    }

    #[test]
    fn a_bare_way_is_kept_unless_a_shorter_one_is_there() {
        let mut parts = triangles(&[[1, 2]]);
        parts.extend([Part::Bare(Arm::edge(2, 3.0)), Part::Bare(Arm::edge(5, 3.0))]);
        assert_eq!(ends(&parts), [1, 2, 5]);
    }
}
