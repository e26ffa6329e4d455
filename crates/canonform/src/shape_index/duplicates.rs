//! Groups of shapes of an index that are one: copies of a file, and the same surface in another place, size or
//! triangulation.
//!
//! ```text
//! equal bytes -> fused vectors -> near pairs -> invariants -> clusters -> meshes -> keeper, and what is proved to be the keeper
//! ```

use std::collections::{BTreeMap, HashMap, HashSet, VecDeque};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Instant;

use base::Observer;
use base::files::FileId;
use collection::Storage;
use descriptors::{ShapeDistance, ShapeMetric, Side};
use index::Entry;
use rayon::prelude::*;
use relations::{Change, Merit, MeshGeometry, Relation, RelationKind, SurfaceInvariants};
use rigid::Handedness;
use serde::Serialize;
use surface::DisjointSets;

use super::place::{Home, absolute, canonical, mesh_path};
use super::search::ShapeSearch;
use crate::error::Error;

/// Nearest shapes of each shape whose meshes are compared. A shape with more copies is still found by theirs.
const NEIGHBORS: usize = 16;

/// Copies have vectors that are nearer than this: noise, decimation and arcs move them. Two classes are farther apart
/// on most pairs of the built-in families. A safety limit: the meshes decide.
const NEAR: f64 = 4.0;

/// The kinds that make two files duplicates.
const KINDS: [RelationKind; 6] = [
    RelationKind::IdenticalFile,
    RelationKind::IdenticalGeometry,
    RelationKind::Scaled,
    RelationKind::Mirrored,
    RelationKind::Noisy,
    RelationKind::Remeshed,
];

/// Which file of a group is suggested to be kept. Between equal ones, references come first, then files before links and
/// members of archives, formats that lose nothing, the folders in the order of [`folders`](DuplicateOptions::folders), the oldest, the
/// shortest path.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Keep {
    /// The most [exact](Relation::more_exact): without noise, with all detail, in the fewest vertices.
    #[default]
    Exact,
    /// That with the most vertices, then bytes.
    Largest,
    /// That with the fewest.
    Smallest,
    /// The one that was changed first.
    Oldest,
    /// The one that was changed last.
    Newest,
    /// One in this folder, then the most exact.
    In(PathBuf),
}

impl FromStr for Keep {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        Ok(match text {
            "exact" => Self::Exact,
            "largest" => Self::Largest,
            "smallest" => Self::Smallest,
            "oldest" => Self::Oldest,
            "newest" => Self::Newest,
            folder if Path::new(folder).is_dir() => Self::In(folder.into()),
            _ => return Err("use `exact`, `largest`, `smallest`, `oldest`, `newest`, or a folder".to_owned()),
        })
    }
}

/// What counts as a duplicate, and what is kept.
#[derive(Debug, Clone, PartialEq)]
pub struct DuplicateOptions {
    /// Kinds of relation. Default: one file, one geometry, scaled, mirrored, noisy, remeshed.
    pub kinds: Vec<RelationKind>,
    /// The least confidence. Default: 0.9.
    pub min_confidence: f64,
    /// Which file of a group is kept. Default: the most exact.
    pub keep: Keep,
    /// Folders and archives from which nothing is to be removed. Default: none.
    pub reference: Vec<PathBuf>,
    /// Folders and archives in the order in which their files are kept. Default: none goes first.
    pub folders: Vec<PathBuf>,
}

impl Default for DuplicateOptions {
    fn default() -> Self {
        let (keep, reference, folders) = Default::default();
        Self { kinds: KINDS.to_vec(), min_confidence: 0.9, keep, reference, folders }
    }
}

impl DuplicateOptions {
    fn asks_surfaces_only(&self) -> bool {
        self.kinds.iter().all(|kind| kind.is_one_surface())
    }
}

/// A file of a group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateFile {
    /// The shape.
    pub id: String,
    /// Its file.
    pub path: PathBuf,
    /// Size of the file in bytes, also of a member of an archive, which need less.
    pub bytes: Option<u64>,
    /// When it was last changed, in seconds since 1970.
    pub modified: Option<u64>,
    /// Lengths of the bounding box, in units of the file; unknown for a file that cannot be read.
    pub size: Option<[f64; 3]>,
    /// Number of vertices in different positions.
    pub vertices: Option<usize>,
    /// Other shapes of the index that are this file: links and hard links.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub links: Vec<String>,
    /// Whether it is in a folder from which nothing is to be removed.
    pub reference: bool,
    /// Whether nothing is spared without it: it is found through a link, has several names (hard links), or is in an archive.
    #[serde(skip)]
    pub is_linked: bool,
}

/// A file that is the shape of the keeper of its group.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DuplicateMember {
    /// The file.
    #[serde(flatten)]
    pub file: DuplicateFile,
    /// The file that it is compared with: the keeper, or a member that it is an exact copy of.
    pub of: String,
    /// How it is related to that file.
    pub relation: Relation,
}

impl DuplicateMember {
    /// Whether it can be spared: it is the surface of a file that is kept, is no reference, and its bytes would be free. Parts of other
    /// sizes, unless the unit changed, and left and right ones are not spared.
    pub fn is_spare(&self) -> bool {
        let told = &self.relation;
        let is_other =
            told.has(Change::Mirrored) || told.has(Change::Scaled) && told.evidence.units.is_none();
        told.kind.is_one_surface() && !(is_other || self.file.reference || self.file.is_linked)
    }
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
    /// Every file of every group.
    pub fn files_mut(&mut self) -> impl Iterator<Item = &mut DuplicateFile> {
        self.groups.iter_mut().flat_map(|DuplicateGroup { keeper, members, .. }| {
            members.iter_mut().map(|member| &mut member.file).chain([keeper])
        })
    }

    /// The files that [can be spared](DuplicateMember::is_spare).
    pub fn spare(&self) -> impl Iterator<Item = &DuplicateFile> {
        let members = self.groups.iter().flat_map(|group| &group.members);
        members.filter(|member| member.is_spare()).map(|member| &member.file)
    }

    /// Bytes of all files that can be spared.
    pub fn spare_bytes(&self) -> u64 {
        self.spare().filter_map(|file| file.bytes).sum()
    }
}

/// Whether a path is a file that is no link of either kind.
pub(super) fn has_one_name(path: &Path) -> bool {
    std::fs::symlink_metadata(path).is_ok_and(|about| about.is_file())
        && std::fs::File::open(path).is_ok_and(|file| !base::files::has_other_names(&file))
}

/// A content with its numbers, and the files that have it.
struct Candidate {
    /// Different files, each with the names of links to it.
    files: Vec<(Entry, Vec<String>)>,
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
    let (mut candidates, places) = (candidates(search)?, Places::new(search, options)?);
    let near = clusters(candidates.len(), near_pairs(&candidates, observer)?);
    let to_read: Vec<usize> = near.iter().filter(|cluster| cluster.len() > 1).flatten().copied().collect();
    read_invariants(search, &mut candidates, &to_read, observer)?;
    let unread = to_read.into_iter().filter(|&i| candidates[i].invariants.is_none());
    let mut unread: Vec<String> =
        unread.flat_map(|i| candidates[i].files.iter().map(|(entry, _)| entry.id.clone())).collect();
    unread.sort();
    // Copies of copies need not be near themselves.
    let pairs = near.iter().flat_map(|cluster| pairs_of(cluster));
    let pairs = pairs.filter(|&(i, j)| candidates[i].may_be(&candidates[j], options));
    let mut clusters = clusters(candidates.len(), pairs);
    clusters.retain(|cluster| cluster.iter().map(|&i| candidates[i].files.len()).sum::<usize>() > 1);
    observer.begin("comparing", clusters.iter().map(Vec::len).sum());
    let found = clusters
        .par_iter()
        .map(|cluster| {
            let read = |&number: &usize| ClusterShape::read(&candidates[number], &places);
            groups(cluster.par_iter().map(read).collect(), &places, options, observer)
        })
        .collect::<Result<Vec<_>, Error>>()?;
    let n_compared = found.iter().map(|(_, n_compared)| n_compared).sum();
    let mut groups: Vec<DuplicateGroup> = found.into_iter().flat_map(|(groups, _)| groups).collect();
    // Nothing is suggested about files in references alone.
    groups
        .retain(|group| !group.keeper.reference || group.members.iter().any(|member| !member.file.reference));
    groups.sort_by(|a, b| b.members.len().cmp(&a.members.len()).then(a.keeper.id.cmp(&b.keeper.id)));
    let (n_shapes, seconds) = (search.index().len(), start.elapsed().as_secs_f64());
    Ok(DuplicateReport { n_shapes, n_compared, groups, unread, seconds })
}

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
    fn distance(&self, other: &Self) -> f64 {
        ShapeMetric::robust(&self.fused, &other.fused)
    }

    /// The mesh of the first of its files that can be read.
    fn geometry(&self, search: &ShapeSearch) -> Option<MeshGeometry> {
        self.files.iter().find_map(|(entry, _)| search.geometry(entry))
    }

    /// Whether their meshes may be one.
    fn may_be(&self, other: &Self, options: &DuplicateOptions) -> bool {
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
fn clusters(n: usize, pairs: impl IntoIterator<Item = Pair>) -> Vec<Vec<usize>> {
    let mut sets = DisjointSets::new(n);
    pairs.into_iter().for_each(|(i, j)| {
        sets.union(i as u32, j as u32);
    });
    let mut members: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    (0..n).for_each(|i| members.entry(sets.find(i as u32)).or_default().push(i));
    members.into_values().collect()
}

/// Where files are, and what that says about keeping them.
struct Places<'a> {
    search: &'a ShapeSearch,
    home: Home,
    keep: &'a Keep,
    /// Without links: the folder to keep, that of [`Keep::In`].
    folder: Option<PathBuf>,
    reference: Vec<PathBuf>,
    folders: Vec<PathBuf>,
}

impl<'a> Places<'a> {
    fn new(search: &'a ShapeSearch, options: &'a DuplicateOptions) -> Result<Self, Error> {
        let all =
            |paths: &[PathBuf]| paths.iter().map(|path| canonical(path)).collect::<Result<Vec<_>, Error>>();
        let DuplicateOptions { keep, reference, folders, .. } = options;
        let folder = if let Keep::In(folder) = keep { Some(canonical(folder)?) } else { None };
        let (reference, folders) = (all(reference)?, all(folders)?);
        Ok(Self { search, home: Home::new(&search.index().path)?, keep, folder, reference, folders })
    }

    fn file(&self, entry: &Entry, links: &[String], geometry: Option<&MeshGeometry>) -> DuplicateFile {
        let path = mesh_path(&self.search.index().path, &entry.path);
        let modified = std::fs::metadata(&path).ok().and_then(|facts| facts.modified().ok());
        let since_1970 = modified.and_then(|time| time.duration_since(std::time::UNIX_EPOCH).ok());
        let place = absolute(&path).unwrap_or_else(|_| path.clone());
        DuplicateFile {
            id: entry.id.clone(),
            // The folders of a file have no links if its path without them is the one that is known.
            is_linked: !(has_one_name(&path) && self.home.file_text(&path) == entry.path),
            bytes: Storage.n_bytes(&path).ok(),
            modified: since_1970.map(|time| time.as_secs()),
            size: geometry.and_then(|geometry| {
                let [low, high] = geometry.to_mesh().bounds()?;
                Some((high - low).into())
            }),
            vertices: geometry.map(MeshGeometry::n_vertices),
            links: links.to_vec(),
            reference: self.reference.iter().any(|folder| place.starts_with(folder)),
            path,
        }
    }

    /// Files in the order of these are kept: as far as the user [says](WANTED), and where neither is more exact. Triangles of STL
    /// have no vertices in common, and coordinates of 32 bits.
    fn order(&self, file: &DuplicateFile) -> Order {
        let place = absolute(&file.path).unwrap_or_else(|_| file.path.clone());
        let is_elsewhere = self.folder.as_ref().is_some_and(|folder| !place.starts_with(folder));
        let folder = self.folders.iter().position(|folder| place.starts_with(folder));
        let vertices = file.vertices.unwrap_or_default() as i64;
        let bytes = file.bytes.unwrap_or_default() as i64;
        let age = file.modified.map_or(i64::MAX, |seconds| seconds as i64);
        let (first, second, why) = match self.keep {
            Keep::Exact | Keep::In(_) => (0, 0, ""),
            Keep::Largest => (-vertices, -bytes, "it is the largest"),
            Keep::Smallest => (vertices, bytes, "it is the smallest"),
            Keep::Oldest => (age, 0, "it is the oldest"),
            Keep::Newest => (-age, 0, "it is the newest"),
        };
        [
            (i64::from(is_elsewhere), "it is in the folder to keep"),
            (first, why),
            (second, why),
            (i64::from(!file.reference), "it is in a reference folder"),
            (i64::from(file.is_linked), "it is neither a link nor in an archive"),
            (i64::from(mesh_io::extension(&file.path) == "stl"), "its format keeps what triangles share"),
            (folder.unwrap_or(self.folders.len()) as i64, "its folder comes first"),
            (file.modified.unwrap_or_default() as i64, "it is the oldest"),
            (file.path.as_os_str().len() as i64, "it has the shortest path"),
        ]
    }
}

/// Numbers in descending order of weight, and why the file with the least one is kept.
type Order = [(i64, &'static str); 9];

/// So many of them go before exactness.
const WANTED: usize = 3;

/// A content that may be that of others, with its mesh.
struct ClusterShape<'a> {
    candidate: &'a Candidate,
    geometry: Option<MeshGeometry>,
    /// The first to keep first.
    files: Vec<DuplicateFile>,
    /// Of the first file.
    order: Order,
}

impl<'a> ClusterShape<'a> {
    fn read(candidate: &'a Candidate, places: &Places<'_>) -> Self {
        let geometry = candidate.geometry(places.search);
        let file = |(entry, links): &(Entry, Vec<String>)| places.file(entry, links, geometry.as_ref());
        let mut files: Vec<DuplicateFile> = candidate.files.iter().map(file).collect();
        files.sort_by_cached_key(|file| (places.order(file), file.id.clone()));
        let order = places.order(&files[0]);
        Self { candidate, geometry, files, order }
    }

    /// Both meshes, if neither shape is wanted more.
    fn meshes<'b>(&'b self, other: &'b Self) -> Option<[&'b MeshGeometry; 2]> {
        let meshes = [self.geometry.as_ref()?, other.geometry.as_ref()?];
        (self.order[..WANTED] == other.order[..WANTED]).then_some(meshes)
    }

    /// Whether it is rather kept than another one, by their meshes alone.
    fn is_before(&self, other: &Self) -> bool {
        self.meshes(other).is_some_and(|[own, others]| own.merit_over(others).is_some())
    }

    /// Its files but the first, which have the bytes of that.
    fn copies(&self) -> impl Iterator<Item = DuplicateMember> {
        let of = &self.files[0].id;
        self.files[1..].iter().map(move |file| {
            let (same, content) = (ShapeDistance::default(), Some(self.candidate.files[0].0.content));
            let relation = Relation::by_distance(same, 1.0, Handedness::Unknown).named(of, &file.id);
            let relation = relation.by_files([content, content]);
            DuplicateMember { file: file.clone(), of: of.clone(), relation }
        })
    }

    /// Its files, of which the first has this relation to another file. If that is an exact one, so have all.
    fn members(&self, of: &str, relation: &Relation) -> Vec<DuplicateMember> {
        let member = |file: &DuplicateFile| {
            let relation = relation.clone().named(of, &file.id);
            DuplicateMember { file: file.clone(), of: of.to_owned(), relation }
        };
        match relation.kind.is_one_geometry() {
            true => self.files.iter().map(member).collect(),
            false => self.files[..1].iter().map(member).chain(self.copies()).collect(),
        }
    }
}

/// A shape that is proved to be the keeper of a group.
struct Proved<'a> {
    shape: &'a ClusterShape<'a>,
    told: Relation,
    /// Which of the two is rather kept, the keeper being the first, and why.
    exact: Option<(Side, Merit)>,
}

impl<'a> Proved<'a> {
    fn new(keeper: &ClusterShape<'_>, shape: &'a ClusterShape<'a>, told: Relation) -> Self {
        let exact = keeper.meshes(shape).and_then(|meshes| told.more_exact(meshes));
        Self { shape, told, exact }
    }
}

/// Takes the shape to keep of those that are left, and what is proved to be the same, until none is left. Returns the number of
/// meshes that were compared, too.
fn groups(
    mut shapes: Vec<ClusterShape<'_>>,
    places: &Places<'_>,
    options: &DuplicateOptions,
    observer: &dyn Observer,
) -> Result<(Vec<DuplicateGroup>, usize), Error> {
    let budget = observer.budget();
    let by = if options.asks_surfaces_only() { Relation::by_surfaces } else { Relation::by_meshes };
    let (mut groups, mut n_compared) = (Vec::new(), 0);
    shapes.sort_by(|a, b| a.order.cmp(&b.order).then_with(|| a.files[0].id.cmp(&b.files[0].id)));
    let mut left: Vec<&ClusterShape<'_>> = shapes.iter().collect();
    // Shapes to which another one of their group is preferred.
    let mut rough: Vec<&ClusterShape<'_>> = Vec::new();
    let is_in = |all: &[&ClusterShape<'_>], shape: &ClusterShape<'_>| {
        all.iter().any(|other| std::ptr::eq(*other, shape))
    };
    while let Some(&first) = left.iter().find(|shape| !is_in(&rough, shape)).or(left.first()) {
        let keeper = left
            .iter()
            .filter(|shape| !is_in(&rough, shape))
            .fold(first, |best, next| if next.is_before(best) { next } else { best });
        let others: Vec<_> = left.iter().copied().filter(|shape| !std::ptr::eq(*shape, keeper)).collect();
        let relate = |other: &&ClusterShape<'_>| {
            budget.check()?;
            Ok(related(keeper, other, by, options))
        };
        let relations = others.par_iter().map(relate).collect::<Result<Vec<_>, Error>>()?;
        n_compared += relations.iter().flatten().count();
        let is_one =
            |told: &Relation| options.kinds.contains(&told.kind) && told.confidence >= options.min_confidence;
        let (mut rest, mut proved) = (Vec::new(), Vec::new());
        for (other, relation) in others.into_iter().zip(relations) {
            match relation.filter(is_one) {
                Some(relation) => proved.push((other, relation)),
                None => rest.push(other),
            }
        }
        let mut same: Vec<Proved<'_>> =
            proved.into_par_iter().map(|(other, told)| Proved::new(keeper, other, told)).collect();
        // Merits over one shape and of another one over that need not add up.
        let is_better = |other: &Proved<'_>| {
            !is_in(&rough, other.shape) && matches!(other.exact, Some((Side::Second, _)))
        };
        if !is_in(&rough, keeper) && same.iter().any(is_better) {
            rough.push(keeper);
            continue;
        }
        // What fits a shape better that is not the keeper's goes to the group of that.
        let gap = |told: &Relation| told.evidence.surface_gap.map_or(0.0, |gap| gap.rms);
        let fits_better = |Proved { shape: other, told, .. }: &Proved<'_>| {
            if !told.kind.is_one_surface() || gap(told) == 0.0 {
                return Ok(false);
            }
            let is_nearer = |shape: &&ClusterShape<'_>| {
                budget.check()?;
                let found = related(shape, other, Relation::by_surfaces, options);
                let found = found.filter(|found| found.kind.is_one_surface() && is_one(found));
                Ok(found.is_some_and(|found| gap(&found) < gap(told)))
            };
            rest.iter().map(is_nearer).find(|found| !matches!(found, Ok(false))).unwrap_or(Ok(false))
        };
        let elsewhere = same.par_iter().map(fits_better).collect::<Result<Vec<bool>, Error>>()?;
        let mut goes = elsewhere.iter();
        same.retain(|_| goes.next() == Some(&false));
        (0..=same.len()).for_each(|_| observer.step());
        let place = |kind| RelationKind::ALL.iter().position(|known| *known == kind);
        same.sort_by(|a, b| {
            let by_kind = place(a.told.kind).cmp(&place(b.told.kind));
            by_kind.then_with(|| a.shape.files[0].id.cmp(&b.shape.files[0].id))
        });
        left.retain(|shape| {
            !std::ptr::eq(*shape, keeper) && same.iter().all(|other| !std::ptr::eq(other.shape, *shape))
        });
        groups.extend(group(keeper, same, places, options));
    }
    Ok((groups, n_compared))
}

/// The files of a shape to keep and of others that are proved to be it; `None` if there is one only.
fn group(
    keeper: &ClusterShape<'_>,
    same: Vec<Proved<'_>>,
    places: &Places<'_>,
    options: &DuplicateOptions,
) -> Option<DuplicateGroup> {
    let why = why(keeper, &same, places);
    let mut members: Vec<DuplicateMember> = keeper.copies().collect();
    let mut left = VecDeque::from(same);
    while let Some(Proved { shape, told: relation, .. }) = left.pop_front() {
        members.extend(shape.members(&keeper.files[0].id, &relation));
        // What is no exact copy of the keeper may have exact copies itself.
        let may_have = |other: &ClusterShape<'_>| {
            !relation.kind.is_one_geometry() && shape.files[0].vertices == other.files[0].vertices
        };
        left.retain(|Proved { shape: other, .. }| {
            let related = || related(shape, other, Relation::by_vertices, options);
            let found = may_have(other).then(related).flatten().filter(|told| told.kind.is_one_geometry());
            members.extend(found.iter().flat_map(|told| other.members(&shape.files[0].id, told)));
            found.is_none()
        });
    }
    members.retain(|member| options.kinds.contains(&member.relation.kind));
    let keeper = keeper.files[0].clone();
    (!members.is_empty()).then_some(DuplicateGroup { keeper, why, members })
}

/// How a shape is related to a keeper, told by their meshes; `None` if one cannot be read, or both cannot be one.
fn related(
    keeper: &ClusterShape<'_>,
    other: &ClusterShape<'_>,
    by: fn(Relation, [&MeshGeometry; 2]) -> Relation,
    options: &DuplicateOptions,
) -> Option<Relation> {
    let meshes = [keeper.geometry.as_ref()?, other.geometry.as_ref()?];
    if !keeper.candidate.may_be(other.candidate, options) {
        return None;
    }
    let contents = [keeper, other].map(|shape| Some(shape.candidate.files[0].0.content));
    let fused = keeper.candidate.distance(other.candidate);
    let distance = ShapeDistance { fused, combined: fused };
    let by_distance = Relation::by_distance(distance, 1.0, Handedness::Unknown)
        .named(&keeper.files[0].id, &other.files[0].id)
        .by_files(contents);
    Some(by(by_distance, meshes))
}

/// Why a shape is kept: what the user wants, its merits, and without any what comes first.
fn why(keeper: &ClusterShape<'_>, same: &[Proved<'_>], places: &Places<'_>) -> String {
    // Which number decides, and its words.
    let decides = |other: &Order| {
        let first = keeper.order.iter().zip(other).position(|(own, other)| own.0 != other.0);
        first.map_or((other.len(), "its name comes first"), |first| (first, keeper.order[first].1))
    };
    let copies = keeper.files[1..].iter().map(|file| decides(&places.order(file)));
    let order: Vec<_> = same.iter().map(|other| decides(&other.shape.order)).chain(copies).collect();
    let merit = |other: &Proved<'_>| match other.exact {
        Some((Side::First, merit)) => Some(merit.words()),
        _ => None,
    };
    let wanted = order.iter().filter(|(first, _)| *first < WANTED).map(|(_, words)| *words);
    let mut reasons: Vec<&str> = wanted.chain(same.iter().filter_map(merit)).collect();
    if reasons.is_empty() {
        reasons = order.iter().map(|(_, words)| *words).collect();
    }
    let mut seen = HashSet::new();
    reasons.retain(|reason| seen.insert(*reason));
    reasons.join("; ")
}
