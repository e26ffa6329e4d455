//! The surface in one cube of the lattice, for each of the 256 sign patterns.
//!
//! The cases are computed, not tabulated. On every face of the cube, directed segments separate the inside corners
//! from the others, and the segments form loops around the cube. Two cubes that share a face have the same signs and
//! hence the same segments on it, so that the loops of all cubes form one closed oriented surface.

/// Corner `c` of a cube: `(c & 1, c >> 1 & 1, c >> 2 & 1)`.
pub(crate) const fn corner(c: usize) -> [usize; 3] {
    [c & 1, c >> 1 & 1, c >> 2 & 1]
}

/// Lower corner and direction of the twelve edges.
#[rustfmt::skip]
pub(crate) const EDGES: [(usize, usize); 12] = [
    (0, 0), (2, 0), (4, 0), (6, 0), // along x
    (0, 1), (1, 1), (4, 1), (5, 1), // along y
    (0, 2), (1, 2), (2, 2), (3, 2), // along z
];

/// The corners of each face, counter-clockwise as seen from outside.
const FACES: [[usize; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// A closed polygon of the surface in a cube: the cube edges that it crosses, counter-clockwise as seen from
/// outside the body.
pub(crate) type Loop = Vec<u8>;

/// The loops of every sign pattern; bit `c` of the pattern is set if corner `c` is inside.
pub(crate) fn all_loops() -> Vec<Vec<Loop>> {
    (0..256).map(loops).collect()
}

fn edge_between(a: usize, b: usize) -> usize {
    let (low, axis) = (a.min(b), (a ^ b).trailing_zeros() as usize);
    EDGES.iter().position(|&e| e == (low, axis)).unwrap_or(EDGES.len())
}

fn loops(pattern: usize) -> Vec<Loop> {
    let inside = |c: usize| pattern >> c & 1 == 1;
    let mut next = [None; 12];
    for face in FACES {
        for i in 0..4 {
            let (before, first) = (face[(i + 3) % 4], face[i]);
            if inside(before) || !inside(first) {
                continue;
            }
            // A run of inside corners starts here; walk to its end. Diagonal runs stay separate.
            let last = (0..4).take_while(|k| inside(face[(i + k) % 4])).last().unwrap_or(0);
            let (end, after) = (face[(i + last) % 4], face[(i + last + 1) % 4]);
            next[edge_between(before, first)] = Some(edge_between(end, after));
        }
    }
    let mut found = Vec::new();
    for start in 0..12 {
        let mut polygon = Loop::new();
        let mut edge = start;
        while let Some(following) = next[edge].take() {
            polygon.push(edge as u8);
            edge = following;
        }
        if !polygon.is_empty() {
            found.push(polygon);
        }
    }
    found
}
