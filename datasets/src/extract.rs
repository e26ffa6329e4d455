//! From an implicit body to a closed triangle surface: marching cubes on a randomly placed lattice.

use std::collections::HashMap;

use base::{Budget, Exceeded};
use mesh::TriMesh;
use nalgebra::{Matrix3, Point3, Vector3};
use rayon::prelude::*;
use surface::VertexId;

use crate::cases::{EDGES, Loop, all_loops, corner};
use crate::implicit::ImplicitBody;

/// Cells along the side of a block. Blocks are searched, skipped and distributed to threads.
const BLOCK: usize = 8;
const SAMPLES: usize = BLOCK + 1;

/// Placement of the lattice; each gives another triangulation of the same surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    /// Columns are the lattice directions.
    pub(crate) rotation: Matrix3<f64>,
    /// Shift in units of the spacing.
    pub(crate) shift: Vector3<f64>,
    /// Edge length of a cell, in body units.
    pub(crate) spacing: f64,
}

/// The lower end of an edge of the lattice and its axis.
type LatticeEdge = ([i64; 3], usize);

/// The part of the surface inside one block.
struct Leaf {
    /// Lowest corner and sign pattern of each crossed cell.
    cells: Vec<([i64; 3], u8)>,
    /// The crossed edges that begin in the block.
    edges: Vec<LatticeEdge>,
    /// Crossings of these edges, then centers of loops with more than four corners.
    positions: Vec<Point3<f64>>,
}

/// Extracts the surface of `body`, oriented outwards, with badly shaped triangles.
///
/// Every crossed lattice edge has one vertex. Loops of three and four vertices become one or two triangles,
/// longer ones a fan around their center. No two triangles share more than an edge, so the result is a closed
/// manifold for any body. The search descends from a cube around the body and drops blocks that the surface
/// cannot reach: those where the value of the 1-Lipschitz function at the center exceeds half the diagonal.
/// Time and memory are `O(area / spacing^2)`.
pub(crate) fn extract(body: &ImplicitBody, lattice: Lattice, budget: &Budget) -> Result<TriMesh, Exceeded> {
    let loops = all_loops();
    let (center, radius) = body.bounding_ball();
    let leaves: Vec<Leaf> = crossed_blocks(body, lattice, center, radius)
        .into_par_iter()
        .map(|origin| budget.check().map(|()| leaf(body, lattice, center, origin, &loops)))
        .collect::<Result<_, _>>()?;
    let (mut starts, mut positions, mut on_edge) = (Vec::new(), Vec::new(), HashMap::new());
    for leaf in &leaves {
        on_edge.extend(leaf.edges.iter().copied().zip((positions.len()..).map(VertexId::from)));
        starts.push(positions.len() + leaf.edges.len());
        positions.extend_from_slice(&leaf.positions);
    }
    let faces = leaves.par_iter().zip(starts).map(|(leaf, middle)| triangles(leaf, middle, &on_edge, &loops));
    Ok(TriMesh { positions, faces: faces.collect::<Vec<_>>().concat() })
}

impl Lattice {
    fn point(&self, center: Point3<f64>, at: [f64; 3]) -> Point3<f64> {
        center + self.rotation * ((Vector3::from(at) + self.shift) * self.spacing)
    }
}

/// Origins of the blocks that the surface may cross, in cells, in a fixed order.
fn crossed_blocks(body: &ImplicitBody, lattice: Lattice, center: Point3<f64>, radius: f64) -> Vec<[i64; 3]> {
    // One extra block on each side leaves room for the shift.
    let needed = (radius / lattice.spacing + lattice.shift.amax() + 1.0).ceil() as i64;
    let mut half = BLOCK as i64;
    while half < needed {
        half *= 2;
    }
    let mut size = 2 * half;
    let mut blocks = vec![[-half; 3]];
    while size > BLOCK as i64 {
        size /= 2;
        let reach = 0.5 * 3f64.sqrt() * size as f64 * lattice.spacing * (1.0 + 1e-9);
        blocks = blocks
            .into_par_iter()
            .flat_map_iter(|origin| {
                (0..8).map(move |c| {
                    let step = corner(c);
                    [0, 1, 2].map(|i| origin[i] + size * step[i] as i64)
                })
            })
            .filter(|origin| {
                let middle = origin.map(|x| x as f64 + 0.5 * size as f64);
                body.value(lattice.point(center, middle)).abs() <= reach
            })
            .collect();
    }
    blocks
}

fn sample_index(at: [usize; 3]) -> usize {
    (at[2] * SAMPLES + at[1]) * SAMPLES + at[0]
}

fn add(a: [usize; 3], b: [usize; 3]) -> [usize; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The lattice point after `at` along an axis.
fn step(mut at: [usize; 3], axis: usize) -> [usize; 3] {
    at[axis] += 1;
    at
}

/// All points of a cube of `n` lattice points per side.
fn each(n: usize) -> impl Iterator<Item = [usize; 3]> {
    (0..n * n * n).map(move |i| [i % n, i / n % n, i / (n * n)])
}

/// Values at the lattice points of a block.
///
/// If the value at the center of 2 x 2 x 2 cells rules out that the surface passes, it is used for the
/// corners too: they have the same sign, and only the sign matters.
fn samples(body: &ImplicitBody, spacing: f64, point: &impl Fn([f64; 3]) -> Point3<f64>) -> Vec<f64> {
    let reach = 3f64.sqrt() * spacing * (1.0 + 1e-9);
    let mut values = vec![f64::NAN; SAMPLES * SAMPLES * SAMPLES];
    let mut crossed = Vec::new();
    for middle in each(BLOCK / 2) {
        let low = middle.map(|x| 2 * x);
        let value = body.value(point(low.map(|x| x as f64 + 1.0)));
        if value.abs() <= reach {
            crossed.push(low);
        } else {
            each(3).for_each(|offset| values[sample_index(add(low, offset))] = value);
        }
    }
    // In a second pass, so that true values replace those of centers at shared corners.
    let mut is_true = [false; SAMPLES * SAMPLES * SAMPLES];
    for low in crossed {
        for at in each(3).map(|offset| add(low, offset)) {
            if !std::mem::replace(&mut is_true[sample_index(at)], true) {
                values[sample_index(at)] = body.value(point(at.map(|x| x as f64)));
            }
        }
    }
    values
}

fn leaf(
    body: &ImplicitBody,
    lattice: Lattice,
    center: Point3<f64>,
    origin: [i64; 3],
    loops: &[Vec<Loop>],
) -> Leaf {
    let point = |at: [f64; 3]| lattice.point(center, [0, 1, 2].map(|i| origin[i] as f64 + at[i]));
    let values = samples(body, lattice.spacing, &point);
    let inside = |at: [usize; 3]| values[sample_index(at)] < 0.0;
    let crossing = |at: [usize; 3], axis: usize| {
        let to = step(at, axis);
        let (a, b) = (values[sample_index(at)], values[sample_index(to)]);
        // Not at the ends, where vertices of several edges would coincide.
        let t = (a / (a - b)).clamp(0.02, 0.98);
        let [p, q] = [at, to].map(|at| point(at.map(|x| x as f64)));
        p + (q - p) * t
    };
    let in_lattice = |at: [usize; 3]| [0, 1, 2].map(|i| origin[i] + at[i] as i64);
    let mut leaf = Leaf { cells: Vec::new(), edges: Vec::new(), positions: Vec::new() };
    for at in each(BLOCK) {
        for axis in (0..3).filter(|axis| inside(at) != inside(step(at, *axis))) {
            leaf.edges.push((in_lattice(at), axis));
            leaf.positions.push(crossing(at, axis));
        }
    }
    for at in each(BLOCK) {
        let pattern = (0..8).fold(0, |bits, c| bits | usize::from(inside(add(at, corner(c)))) << c);
        if pattern == 0 || pattern == 255 {
            continue;
        }
        leaf.cells.push((in_lattice(at), pattern as u8));
        for polygon in loops[pattern].iter().filter(|l| l.len() > 4) {
            let sum = polygon.iter().fold(Vector3::zeros(), |sum, &e| {
                let (low, axis) = EDGES[usize::from(e)];
                sum + crossing(add(at, corner(low)), axis).coords
            });
            leaf.positions.push(Point3::from(sum / polygon.len() as f64));
        }
    }
    leaf
}

/// The triangles of a block, whose first center of a loop is vertex `middle`.
fn triangles(
    leaf: &Leaf,
    mut middle: usize,
    on_edge: &HashMap<LatticeEdge, VertexId>,
    loops: &[Vec<Loop>],
) -> Vec<[VertexId; 3]> {
    let mut faces = Vec::new();
    for (at, pattern) in &leaf.cells {
        let vertex = |e: &u8| {
            let (low, axis) = EDGES[usize::from(*e)];
            let step = corner(low);
            on_edge[&([0, 1, 2].map(|i| at[i] + step[i] as i64), axis)]
        };
        for polygon in &loops[usize::from(*pattern)] {
            match polygon.iter().map(vertex).collect::<Vec<_>>()[..] {
                [a, b, c] => faces.push([a, b, c]),
                [a, b, c, d] => faces.extend([[a, b, c], [a, c, d]]),
                ref corners => {
                    let next = corners.iter().cycle().skip(1);
                    faces.extend(corners.iter().zip(next).map(|(a, b)| [*a, *b, VertexId::from(middle)]));
                    middle += 1;
                }
            }
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::implicit::{Blob, BodyPart};
    use crate::trig::rotation;

    fn lattice(spacing: f64) -> Lattice {
        Lattice { rotation: rotation(10.0, 20.0, 30.0), shift: Vector3::new(0.3, 0.1, -0.4), spacing }
    }

    /// Random balls cross the lattice in every way, ambiguous faces included.
    #[test]
    fn every_surface_is_closed_and_manifold() {
        let mut blobs = Vec::new();
        let mut random = base::SplitMix(1);
        for _ in 0..200 {
            let [x, y, z] = [(); 3].map(|()| 5.0 * random.uniform());
            blobs.push(Blob::new([[x, y, z, 0.7]; 2], None, 0.0));
        }
        let body = ImplicitBody { parts: vec![BodyPart::new(false, blobs, 0.0)], is_symmetric: true };
        let raw = extract(&body, lattice(0.6), &Budget::unlimited()).unwrap();
        assert!(raw.faces.len() > 1000);
        let report = mesh::validate(&raw);
        let defects = [report.n_boundary_edges, report.non_manifold_edges, report.non_manifold_vertices];
        assert_eq!((defects, report.inconsistent_edges, report.unreferenced_vertices), ([0; 3], 0, 0));
    }
}
