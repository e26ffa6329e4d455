//! Measures the constants of the libraries, and how often probabilities are right about families that were held out.

mod boundaries;
mod relations;
mod units;

use std::collections::BTreeMap;
use std::io::Write;

use anyhow::Result;
use canonform::{DescribeOptions, Observer, Shape, Surface, describe};
use datasets::{CreatureOptions, creature_body};
use descriptors::{Boundary, PreparedShape, Sample};
use mesh::TriMesh;
use rayon::prelude::*;

use crate::families::coarse;

pub(crate) use relations::{LEFT, Truth, beyond_a_plane, geometry, of_parts, related, relations};
pub(crate) use units::units;

/// A body of a family of creatures in a pose, with about so many vertices.
fn creature(seed: u64, [family, body, pose]: [usize; 3], n_vertices: usize) -> Result<TriMesh> {
    let options = CreatureOptions { seed, n_vertices: n_vertices.max(1000), ..Default::default() };
    let mesh = creature_body(family, body, pose, &options, &())?.mesh;
    Ok(if n_vertices < mesh.n_vertices() { coarse(&mesh, n_vertices) } else { mesh })
}

/// A mesh with its default description, as it is stored and ready for comparisons.
fn described(mesh: &TriMesh) -> Result<(Shape, PreparedShape)> {
    let options = DescribeOptions::default();
    let description = describe(&Surface::new(mesh, &options.form.repair, &())?, &options, &())?;
    let shape = options.prepare(&description)?;
    Ok((description, shape))
}

/// As it is printed and used.
fn rounded(Boundary { at, steepness, range }: Boundary) -> Boundary {
    let [at, far, near] = [at, range[0], range[1]].map(|value| (1000.0 * value).round() / 1000.0);
    Boundary { at, steepness: (100.0 * steepness).round() / 100.0, range: [far, near] }
}

/// What is stated of every pair by a fit to the pairs of other families: the pairs without its own two.
fn held_out<T: Sync, K: Ord + Sync, F, S: Send>(
    pairs: &[T],
    families: impl Fn(&T) -> &[K; 2] + Sync,
    fit: impl Fn(&[&T]) -> F + Sync,
    stated: impl Fn(&F, &T) -> S + Sync,
    observer: &dyn Observer,
) -> Vec<S> {
    let mut groups: BTreeMap<&[K; 2], Vec<&T>> = BTreeMap::new();
    pairs.iter().for_each(|pair| groups.entry(families(pair)).or_default().push(pair));
    observer.begin("holding out families", groups.len());
    let of = |(own, members): (&&[K; 2], &Vec<&T>)| {
        observer.step();
        let known = pairs.iter().filter(|pair| families(pair).iter().all(|family| !own.contains(family)));
        let fitted = fit(&known.collect::<Vec<_>>());
        members.iter().map(|pair| stated(&fitted, pair)).collect::<Vec<S>>()
    };
    groups.par_iter().flat_map_iter(of).collect()
}

/// In ten bins of the stated probabilities: the number of pairs, the mean of what is stated, and the share that is true.
pub(crate) fn reliability(stated: &[Sample]) -> Vec<[f64; 3]> {
    let bin = |i: usize| {
        let inside = |p: f64| ((10.0 * p) as usize).min(9) == i;
        let (mut n, mut sums) = (0.0, [0.0; 3]);
        for (p, is_true, weight) in stated.iter().filter(|(p, ..)| inside(*p)) {
            n += 1.0;
            let truth = f64::from(u8::from(*is_true));
            sums = [sums[0] + weight, sums[1] + weight * p, sums[2] + weight * truth];
        }
        [n, sums[1] / sums[0], sums[2] / sums[0]]
    };
    (0..10).map(bin).collect()
}

/// Prints [`reliability`] as a table.
fn print_reliability(out: &mut impl Write, what: &str, stated: &[Sample]) -> Result<()> {
    writeln!(out, "\n| {what}: stated | pairs | mean | true |\n|---|---|---|---|")?;
    for (i, [n, stated, truth]) in reliability(stated).into_iter().enumerate() {
        writeln!(out, "| .{i} to {:.1} | {n} | {stated:.3} | {truth:.3} |", (i + 1) as f64 / 10.0)?;
    }
    Ok(())
}
