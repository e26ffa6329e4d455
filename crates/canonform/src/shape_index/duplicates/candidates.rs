//! Which shapes of an index may be one: by vectors, then by what all triangulations of a surface have in common.

use std::collections::{BTreeMap, HashMap};

use base::Observer;
use base::files::FileId;
use descriptors::ShapeMetric;
use index::Entry;
use rayon::prelude::*;
use relations::{MeshGeometry, SurfaceInvariants};
use surface::DisjointSets;

use super::options::DuplicateOptions;
use crate::error::Error;
use crate::shape_index::place::mesh_path;
use crate::shape_index::search::ShapeSearch;

/// Nearest shapes of each shape whose meshes are compared. A shape with more copies is still found by theirs.
const NEIGHBORS: usize = 16;

/// Copies have vectors that are nearer than this: noise, decimation and arcs move them. Two classes are farther apart
/// on most pairs of the built-in families. A safety limit: the meshes decide.
const NEAR: f64 = 4.0;

/// A content with its numbers, and the files that have it.
pub(super) struct Candidate {
    /// Different files, each with the names of links to it.
    pub(super) files: Vec<(Entry, Vec<String>)>,
    fused: Vec<f32>,
    /// Of its mesh, if that was read: it is near another shape, and unchanged.
    invariants: Option<SurfaceInvariants>,
}

/// Shapes of an index by number, and which of them may be one.
pub(super) struct Clusters {
    pub(super) candidates: Vec<Candidate>,
    /// Their numbers, together with those of the shapes that they may be.
    pub(super) clusters: Vec<Vec<usize>>,
    /// The names of those that are near others, and whose files cannot be read.
    pub(super) unread: Vec<String>,
}

impl Clusters {
    pub(super) fn new(
        search: &ShapeSearch,
        options: &DuplicateOptions,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        let mut candidates = candidates(search)?;
        let near = connected(candidates.len(), near_pairs(&candidates, observer)?);
        let to_read: Vec<usize> =
            near.iter().filter(|cluster| cluster.len() > 1).flatten().copied().collect();
        read_invariants(search, &mut candidates, &to_read, observer)?;
        let unread = to_read.into_iter().filter(|&i| candidates[i].invariants.is_none());
        let mut unread: Vec<String> =
            unread.flat_map(|i| candidates[i].files.iter().map(|(entry, _)| entry.id.clone())).collect();
        unread.sort();
        // Copies of copies need not be near themselves.
        let pairs = near.iter().flat_map(|cluster| pairs_of(cluster));
        let pairs = pairs.filter(|&(i, j)| candidates[i].may_be(&candidates[j], options));
        let mut clusters = connected(candidates.len(), pairs);
        clusters.retain(|cluster| cluster.iter().map(|&i| candidates[i].files.len()).sum::<usize>() > 1);
        Ok(Self { candidates, clusters, unread })
    }
}

/// Two shapes by their numbers.
type Pair = (usize, usize);

/// The contents of an index, with the files that have each.
fn candidates(search: &ShapeSearch) -> Result<Vec<Candidate>, Error> {
    let (entries, vectors) = (search.index().entries()?, search.index().vector_table()?);
    let mut candidates: Vec<Candidate> = Vec::new();
    let (mut of_content, mut of_file) = (HashMap::new(), HashMap::new());
    for (i, entry) in entries.into_iter().enumerate() {
        let number = *of_content.entry(entry.content).or_insert(candidates.len());
        if number == candidates.len() {
            let fused = vectors.vector(i).to_vec();
            candidates.push(Candidate { files: Vec::new(), fused, invariants: None });
        }
        let files = &mut candidates[number].files;
        let place = match FileId::of(&mesh_path(&search.index().path, &entry.path)) {
            Ok(file) => *of_file.entry((number, file)).or_insert(files.len()),
            Err(_) => files.len(),
        };
        match files.get_mut(place) {
            Some((_, links)) => links.push(entry.id),
            None => files.push((entry, Vec::new())),
        }
    }
    Ok(candidates)
}

/// Reads the meshes of some shapes for their invariants, and does not keep them.
fn read_invariants(
    search: &ShapeSearch,
    candidates: &mut [Candidate],
    numbers: &[usize],
    observer: &dyn Observer,
) -> Result<(), Error> {
    let budget = observer.budget();
    observer.begin("reading", numbers.len());
    let read = |&i: &usize| {
        budget.check()?;
        let geometry = candidates[i].geometry(search);
        observer.step();
        Ok(geometry.map(|geometry| geometry.invariants()))
    };
    let found = numbers.par_iter().map(read).collect::<Result<Vec<_>, Error>>()?;
    numbers.iter().zip(found).for_each(|(&i, invariants)| candidates[i].invariants = invariants);
    Ok(())
}

fn pairs_of(cluster: &[usize]) -> impl Iterator<Item = Pair> {
    cluster.iter().enumerate().flat_map(|(n, &i)| cluster[n + 1..].iter().map(move |&j| (i, j)))
}

impl Candidate {
    pub(super) fn distance(&self, other: &Self) -> f64 {
        ShapeMetric::robust(&self.fused, &other.fused)
    }

    /// The mesh of the first of its files that can be read.
    pub(super) fn geometry(&self, search: &ShapeSearch) -> Option<MeshGeometry> {
        self.files.iter().find_map(|(entry, _)| search.geometry(entry))
    }

    /// Whether their meshes may be one.
    pub(super) fn may_be(&self, other: &Self, options: &DuplicateOptions) -> bool {
        // Parts and variants have other invariants than what they are compared with.
        match (&self.invariants, &other.invariants) {
            (Some(a), Some(b)) => !options.asks_surfaces_only() || a.may_be_copy_of(b),
            _ => false,
        }
    }
}

/// Pairs of shapes whose vectors are near.
fn near_pairs(candidates: &[Candidate], observer: &dyn Observer) -> Result<Vec<Pair>, Error> {
    let budget = observer.budget();
    observer.begin("searching", candidates.len());
    let near = |i: usize| {
        budget.check()?;
        let others = (0..candidates.len()).filter(|j| *j != i);
        let mut near: Vec<(f64, usize)> = others
            .map(|j| (candidates[i].distance(&candidates[j]), j))
            .filter(|(distance, _)| *distance < NEAR)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        observer.step();
        Ok::<_, Error>(near.into_iter().take(NEIGHBORS).map(|(_, j)| (i, j)).collect::<Vec<_>>())
    };
    Ok((0..candidates.len()).into_par_iter().map(near).collect::<Result<Vec<_>, Error>>()?.concat())
}

/// Shapes that pairs connect, also single ones.
fn connected(n: usize, pairs: impl IntoIterator<Item = Pair>) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(n);
    pairs.into_iter().for_each(|(i, j)| {
        sets.union(i as u32, j as u32);
    });
    let mut members: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    (0..n).for_each(|i| members.entry(sets.find(i as u32)).or_default().push(i));
    members.into_values().collect()
}
