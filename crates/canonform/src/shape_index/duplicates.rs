//! Groups of shapes of an index that are one: copies of a file, and the same surface in another place, size or
//! triangulation.
//!
//! ```text
//! fused vectors -> near pairs -> invariants -> clusters -> meshes -> keeper, and what is proved to be the keeper
//! ```

use std::cmp::Reverse;
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::time::Instant;

use base::Observer;
use descriptors::{ShapeDistance, ShapeMetric};
use index::Entry;
use rayon::prelude::*;
use relations::{MeshGeometry, Relation, RelationKind, SurfaceInvariants};
use rigid::Handedness;
use serde::Serialize;
use surface::DisjointSets;

use super::place::{Home, mesh_path};
use super::search::ShapeSearch;
use crate::error::Error;

/// Nearest shapes of each shape whose meshes are compared. A shape with more copies is still found by theirs.
const NEIGHBOURS: usize = 16;

/// Copies have vectors that are nearer than this: noise, decimation and arcs move them. Two classes are farther apart
/// on most pairs of the built-in families. A safety limit: the meshes decide.
const NEAR: f64 = 4.0;

/// Sizes of files in one unit differ by less than this (logarithm). A tolerance of decimation.
const SAME_SIZE: f64 = 0.01;

/// The kinds that make two files duplicates.
const KINDS: [RelationKind; 6] = [
    RelationKind::IdenticalFile,
    RelationKind::IdenticalGeometry,
    RelationKind::Scaled,
    RelationKind::Mirrored,
    RelationKind::Noisy,
    RelationKind::Remeshed,
];

/// What counts as a duplicate.
#[derive(Debug, Clone, PartialEq)]
pub struct DuplicateOptions {
    /// Kinds of relation. Default: one file, one geometry, scaled, mirrored, noisy, remeshed.
    pub kinds: Vec<RelationKind>,
    /// The least confidence. Default: 0.9.
    pub min_confidence: f64,
}

impl Default for DuplicateOptions {
    fn default() -> Self {
        Self { kinds: KINDS.to_vec(), min_confidence: 0.9 }
    }
}

/// A file of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateFile {
    /// The shape.
    pub id: String,
    /// Its file.
    pub path: PathBuf,
    /// Size of the file in bytes; unknown for members of archives.
    pub bytes: Option<u64>,
    /// When it was last changed, in seconds since 1970.
    pub modified: Option<u64>,
    /// Lengths of the bounding box, in units of the file; unknown for a file that cannot be read.
    pub size: Option<[f64; 3]>,
    /// Number of vertices in different positions.
    pub vertices: Option<usize>,
    /// Whether it is found through a link, or has several names (hard links): nothing is spared without it.
    #[serde(skip)]
    pub is_linked: bool,
}

/// A file that is the shape of the keeper of its group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateMember {
    /// The file.
    #[serde(flatten)]
    pub file: DuplicateFile,
    /// How it is related to the keeper.
    pub relation: Relation,
}

/// Files of one shape.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateGroup {
    /// The file that is suggested to be kept.
    pub keeper: DuplicateFile,
    /// Why it is suggested.
    pub why: String,
    /// The others, by what they have in common with it.
    pub members: Vec<DuplicateMember>,
}

/// The duplicates of an index.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateReport {
    /// Shapes of the index.
    pub n_shapes: usize,
    /// Pairs of meshes that were compared.
    pub n_compared: usize,
    /// Groups, those with the most files first.
    pub groups: Vec<DuplicateGroup>,
    /// Shapes whose file is gone or has changed since it was indexed; only equal contents are known of them.
    pub unread: Vec<String>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

impl DuplicateReport {
    /// Bytes of all files but the keepers. Links do not count: their files have other names.
    #[must_use]
    pub fn spare_bytes(&self) -> u64 {
        let members = self.groups.iter().flat_map(|group| &group.members);
        members.filter(|member| !member.file.is_linked).filter_map(|member| member.file.bytes).sum()
    }
}

/// Whether a path is a file that is no link of either kind.
pub(super) fn has_one_name(path: &Path) -> bool {
    std::fs::symlink_metadata(path).is_ok_and(|about| about.is_file())
        && std::fs::File::open(path).is_ok_and(|file| !base::files::has_other_names(&file))
}

/// A shape with its numbers.
struct Candidate {
    entry: Entry,
    fused: Vec<f32>,
    /// Of its mesh, if that was read: it is near another shape, and unchanged.
    invariants: Option<SurfaceInvariants>,
}

/// Two shapes by their numbers.
type Pair = (usize, usize);

/// Finds the duplicates of an index. Signatures choose which meshes are compared, and their geometry decides: every member
/// of a group is proved against its keeper. Nothing is changed.
///
/// ```
/// use canonform::{DescribeOptions, mesh};
/// use canonform::library::{BuildOptions, DuplicateOptions, build_index, find_duplicates};
/// use canonform::relations::RelationKind;
/// use canonform::search::ShapeSearch;
///
/// let folder = tempfile::tempdir()?;
/// let mut ring = mesh::shapes::torus(24, 12, 2.0, 0.7);
/// mesh::io::write(&folder.path().join("ring.off"), &ring)?;
/// mesh::io::write(&folder.path().join("ball.off"), &mesh::shapes::icosphere(2))?;
/// ring.positions.iter_mut().for_each(|p| *p *= 25.4);
/// mesh::io::write(&folder.path().join("ring-mm.ply"), &ring)?;
/// let index = folder.path().join("shapes.canonform");
/// let describe = DescribeOptions::default();
/// build_index(folder.path(), &index, &BuildOptions::new(&describe), &())?;
///
/// let found = find_duplicates(&ShapeSearch::open(&index)?, &DuplicateOptions::default(), &())?;
/// assert_eq!((found.groups.len(), found.groups[0].members[0].relation.kind), (1, RelationKind::Scaled));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Error::Index`], [`Error::Exceeded`].
pub fn find_duplicates(
    search: &ShapeSearch,
    options: &DuplicateOptions,
    observer: &dyn Observer,
) -> Result<DuplicateReport, Error> {
    let start = Instant::now();
    let mut candidates = candidates(search)?;
    let near = clusters(candidates.len(), near_pairs(&candidates, observer)?);
    let to_read: Vec<usize> = near.concat();
    read_invariants(search, &mut candidates, &to_read, observer)?;
    let unread = to_read.into_iter().filter(|&i| candidates[i].invariants.is_none());
    let mut unread: Vec<String> = unread.map(|i| candidates[i].entry.id.clone()).collect();
    unread.sort();
    // Copies of copies need not be near themselves.
    let pairs = near.iter().flat_map(|cluster| pairs_of(cluster));
    let pairs = pairs.filter(|&(i, j)| candidates[i].may_be(&candidates[j], options));
    let clusters = clusters(candidates.len(), pairs);
    observer.begin("comparing", clusters.iter().map(Vec::len).sum());
    let found = clusters
        .par_iter()
        .map(|cluster| groups(&kept_first(search, &candidates, cluster), options, observer))
        .collect::<Result<Vec<_>, Error>>()?;
    let n_compared = found.iter().map(|(_, n_compared)| n_compared).sum();
    let mut groups: Vec<DuplicateGroup> = found.into_iter().flat_map(|(groups, _)| groups).collect();
    groups.sort_by(|a, b| b.members.len().cmp(&a.members.len()).then(a.keeper.id.cmp(&b.keeper.id)));
    let (n_shapes, seconds) = (candidates.len(), start.elapsed().as_secs_f64());
    Ok(DuplicateReport { n_shapes, n_compared, groups, unread, seconds })
}

fn candidates(search: &ShapeSearch) -> Result<Vec<Candidate>, Error> {
    let (entries, vectors) = (search.index().entries()?, search.index().vector_table()?);
    let shapes = entries.into_iter().enumerate();
    let candidate = |(i, entry)| Candidate { entry, fused: vectors.vector(i).to_vec(), invariants: None };
    Ok(shapes.map(candidate).collect())
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
        let geometry = search.geometry(&candidates[i].entry);
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
    fn distance(&self, other: &Self) -> f64 {
        ShapeMetric::robust(&self.fused, &other.fused)
    }

    /// Whether their meshes, or their files, may be one.
    fn may_be(&self, other: &Self, options: &DuplicateOptions) -> bool {
        // Parts and variants have other invariants than what they are compared with.
        let surfaces_only = options.kinds.iter().all(|kind| kind.is_one_surface());
        self.entry.content == other.entry.content
            || match (&self.invariants, &other.invariants) {
                (Some(a), Some(b)) => !surfaces_only || a.may_be_copy_of(b),
                _ => false,
            }
    }
}

/// Pairs of equal content, and of shapes whose vectors are near.
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
        Ok::<_, Error>(near.into_iter().take(NEIGHBOURS).map(|(_, j)| (i, j)).collect::<Vec<_>>())
    };
    let found = (0..candidates.len()).into_par_iter().map(near).collect::<Result<Vec<_>, Error>>()?;
    let mut pairs = found.concat();
    let mut first: HashMap<_, usize> = HashMap::new();
    for (i, candidate) in candidates.iter().enumerate() {
        pairs.push((*first.entry(candidate.entry.content).or_insert(i), i));
    }
    Ok(pairs)
}

/// Shapes that pairs connect.
fn clusters(n: usize, pairs: impl IntoIterator<Item = Pair>) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(n);
    pairs.into_iter().for_each(|(i, j)| {
        sets.union(i as u32, j as u32);
    });
    let mut members: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    (0..n).for_each(|i| members.entry(sets.find(i as u32)).or_default().push(i));
    members.into_values().filter(|members| members.len() > 1).collect()
}

/// A shape that may be a copy of others, with its mesh.
struct ClusterShape<'a> {
    candidate: &'a Candidate,
    geometry: Option<MeshGeometry>,
    file: DuplicateFile,
}

impl<'a> ClusterShape<'a> {
    fn read(search: &ShapeSearch, candidate: &'a Candidate) -> Self {
        let geometry = search.geometry(&candidate.entry);
        let path = mesh_path(search.index().path(), &candidate.entry.path);
        let facts = std::fs::metadata(&path).ok();
        let modified = facts.as_ref().and_then(|facts| facts.modified().ok());
        let since_1970 = modified.and_then(|time| time.duration_since(std::time::UNIX_EPOCH).ok());
        // The folders of a file have no links if its path without them is the one that is known.
        let is_own = |home: Home| has_one_name(&path) && home.file_text(&path) == candidate.entry.path;
        let file = DuplicateFile {
            id: candidate.entry.id.clone(),
            is_linked: !Home::new(search.index().path()).is_ok_and(is_own),
            bytes: facts.map(|facts| facts.len()),
            modified: since_1970.map(|time| time.as_secs()),
            size: geometry.as_ref().and_then(|geometry| {
                let [low, high] = geometry.to_mesh().bounds()?;
                Some((high - low).into())
            }),
            vertices: geometry.as_ref().map(MeshGeometry::n_vertices),
            path,
        };
        Self { candidate, geometry, file }
    }
}

/// The shapes of a cluster in the order in which they are kept: the finest mesh, at the size of most, then a file before a
/// link, then the oldest file, then the shortest path.
fn kept_first<'a>(
    search: &ShapeSearch,
    candidates: &'a [Candidate],
    cluster: &[usize],
) -> Vec<ClusterShape<'a>> {
    let read = |&number: &usize| ClusterShape::read(search, &candidates[number]);
    let mut shapes: Vec<ClusterShape<'a>> = cluster.par_iter().map(read).collect();
    let sizes: Vec<f64> = shapes.iter().filter_map(|shape| Some(shape.geometry.as_ref()?.size())).collect();
    let n_alike = |shape: &ClusterShape<'_>| {
        let size = shape.geometry.as_ref().map_or(f64::NAN, MeshGeometry::size);
        sizes.iter().filter(|other| (size / **other).ln().abs() < SAME_SIZE).count()
    };
    shapes.sort_by_cached_key(|shape| {
        let file = &shape.file;
        let path = file.path.as_os_str().len();
        (
            Reverse(file.vertices),
            Reverse(n_alike(shape)),
            file.is_linked,
            file.modified,
            path,
            file.id.clone(),
        )
    });
    shapes
}

/// Takes the first shape that is left as a keeper, and what is proved to be the same, until none is left. Returns the number of
/// meshes that were compared, too.
fn groups(
    shapes: &[ClusterShape<'_>],
    options: &DuplicateOptions,
    observer: &dyn Observer,
) -> Result<(Vec<DuplicateGroup>, usize), Error> {
    let budget = observer.budget();
    let (mut groups, mut n_compared) = (Vec::new(), 0);
    let mut left: Vec<&ClusterShape<'_>> = shapes.iter().collect();
    while let Some((keeper, others)) = left.split_first() {
        let relate = |other: &&ClusterShape<'_>| {
            budget.check()?;
            let may_be = keeper.candidate.may_be(other.candidate, options);
            Ok(if may_be { related(keeper, other) } else { None })
        };
        let relations = others.par_iter().map(relate).collect::<Result<Vec<_>, Error>>()?;
        n_compared += relations.iter().flatten().count();
        let is_one =
            |told: &Relation| options.kinds.contains(&told.kind) && told.confidence >= options.min_confidence;
        let (mut rest, mut members) = (Vec::new(), Vec::new());
        for (&other, relation) in others.iter().zip(relations) {
            match relation.filter(is_one) {
                Some(relation) => members.push(DuplicateMember { file: other.file.clone(), relation }),
                None => rest.push(other),
            }
        }
        (0..=members.len()).for_each(|_| observer.step());
        if !members.is_empty() {
            let place = |kind| RelationKind::ALL.iter().position(|known| *known == kind);
            members.sort_by(|a, b| {
                place(a.relation.kind).cmp(&place(b.relation.kind)).then_with(|| a.file.id.cmp(&b.file.id))
            });
            let why = why(&keeper.file, &members);
            groups.push(DuplicateGroup { keeper: keeper.file.clone(), why, members });
        }
        left = rest;
    }
    Ok((groups, n_compared))
}

/// How a shape is related to a keeper; `None` if a mesh cannot be read.
fn related(keeper: &ClusterShape<'_>, other: &ClusterShape<'_>) -> Option<Relation> {
    let contents = [keeper, other].map(|shape| Some(shape.candidate.entry.content));
    let fused = keeper.candidate.distance(other.candidate);
    let distance = ShapeDistance { fused, combined: fused };
    let by_distance = Relation::by_distance(distance, 1.0, Handedness::Unknown)
        .named(&keeper.file.id, &other.file.id)
        .by_files(contents);
    if by_distance.kind == RelationKind::IdenticalFile {
        return Some(by_distance);
    }
    let (a, b) = (keeper.geometry.as_ref()?, other.geometry.as_ref()?);
    Some(by_distance.by_meshes([a, b]))
}

/// Why a file is kept.
fn why(keeper: &DuplicateFile, members: &[DuplicateMember]) -> String {
    let is_finest = members.iter().any(|member| member.file.vertices < keeper.vertices);
    let is_oldest = members.iter().any(|member| member.file.modified > keeper.modified);
    match (is_finest, is_oldest) {
        (true, _) => "it has the most vertices".to_owned(),
        (false, true) => "it is the oldest".to_owned(),
        (false, false) => "it has the size of most, or the shortest path".to_owned(),
    }
}
