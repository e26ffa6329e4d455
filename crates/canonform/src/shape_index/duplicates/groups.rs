//! Groups around the file that is kept: the others are proved to be it by their meshes.

use std::collections::{HashSet, VecDeque};

use base::Observer;
use descriptors::{ShapeDistance, Side};
use index::Entry;
use rayon::prelude::*;
use relations::{Merit, MeshGeometry, Relation, RelationKind};
use rigid::Handedness;

use super::candidates::Candidate;
use super::options::DuplicateOptions;
use super::places::{Order, Places, WANTED};
use super::report::{DuplicateFile, DuplicateGroup, DuplicateMember};
use crate::error::Error;

/// A content that may be that of others, with its mesh.
pub(super) struct ClusterShape<'a> {
    candidate: &'a Candidate,
    geometry: Option<MeshGeometry>,
    /// The first to keep first.
    files: Vec<DuplicateFile>,
    /// Of the first file.
    order: Order,
}

impl<'a> ClusterShape<'a> {
    pub(super) fn read(candidate: &'a Candidate, places: &Places<'_>) -> Self {
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
    number: usize,
    shape: &'a ClusterShape<'a>,
    told: Relation,
    /// Which of the two is rather kept, the keeper being the first, and why.
    exact: Option<(Side, Merit)>,
}

/// How far aligned surfaces are apart, root mean square, relative to the size; 0 for what was not aligned.
fn gap(told: &Relation) -> f64 {
    told.evidence.surface_gap.map_or(0.0, |gap| gap.rms)
}

/// The shapes of a cluster, named by their numbers, until each is in a group.
struct Cluster<'a> {
    shapes: &'a [ClusterShape<'a>],
    options: &'a DuplicateOptions,
    observer: &'a dyn Observer,
    /// In no group yet.
    left: Vec<usize>,
    /// Whether another shape is preferred to a shape that was to be kept.
    is_rough: Vec<bool>,
    n_compared: usize,
}

impl<'a> Cluster<'a> {
    /// The shape to keep of those that are left, as far as the meshes tell one by one.
    fn keeper(&self) -> Option<usize> {
        let mut fine = self.left.iter().copied().filter(|i| !self.is_rough[*i]).peekable();
        let first = fine.peek().or(self.left.first()).copied()?;
        let better = |best: usize, next: usize| match self.shapes[next].is_before(&self.shapes[best]) {
            true => next,
            false => best,
        };
        Some(fine.fold(first, better))
    }

    /// Those that are left and proved to be the keeper, by kind, and the numbers of those that are not.
    fn proved(&mut self, keeper: usize) -> Result<(Vec<Proved<'a>>, Vec<usize>), Error> {
        let Self { shapes, options, observer, .. } = *self;
        let by = if options.asks_surfaces_only() { Relation::by_surfaces } else { Relation::by_meshes };
        let (budget, kept) = (observer.budget(), &shapes[keeper]);
        let prove = |&number: &usize| {
            budget.check()?;
            let shape = &shapes[number];
            let told = related(kept, shape, by, options);
            let was_compared = told.is_some();
            let Some(told) = told.filter(|told| options.accept(told)) else {
                return Ok((was_compared, Err(number)));
            };
            let exact = kept.meshes(shape).and_then(|meshes| told.more_exact(meshes));
            Ok((was_compared, Ok(Proved { number, shape, told, exact })))
        };
        let others: Vec<usize> = self.left.iter().copied().filter(|i| *i != keeper).collect();
        let found = others.par_iter().map(prove).collect::<Result<Vec<_>, Error>>()?;
        let (mut same, mut rest) = (Vec::new(), Vec::new());
        for (was_compared, found) in found {
            self.n_compared += usize::from(was_compared);
            match found {
                Ok(proved) => same.push(proved),
                Err(number) => rest.push(number),
            }
        }
        let place = |kind| RelationKind::ALL.iter().position(|known| *known == kind);
        same.sort_by(|a, b| {
            let by_kind = place(a.told.kind).cmp(&place(b.told.kind));
            by_kind.then_with(|| a.shape.files[0].id.cmp(&b.shape.files[0].id))
        });
        Ok((same, rest))
    }

    /// Whether one of the others is preferred to a keeper, and notes it. Merits over one shape and of another one over that need not
    /// add up.
    fn prefers_another(&mut self, keeper: usize, same: &[Proved<'_>]) -> bool {
        let is_better = |other: &Proved<'_>| {
            !self.is_rough[other.number] && matches!(other.exact, Some((Side::Second, _)))
        };
        let found = !self.is_rough[keeper] && same.iter().any(is_better);
        self.is_rough[keeper] |= found;
        found
    }

    /// Leaves what fits one of the `rest` better than the keeper to the group of that.
    fn leave_to_others(&self, same: &mut Vec<Proved<'_>>, rest: &[usize]) -> Result<(), Error> {
        let (options, budget) = (self.options, self.observer.budget());
        let fits_better = |Proved { shape, told, .. }: &Proved<'_>| {
            if !told.kind.is_one_surface() || gap(told) == 0.0 {
                return Ok(false);
            }
            for &i in rest {
                budget.check()?;
                let found = related(&self.shapes[i], shape, Relation::by_surfaces, options);
                let found = found.filter(|found| found.kind.is_one_surface() && options.accept(found));
                if found.is_some_and(|found| gap(&found) < gap(told)) {
                    return Ok(true);
                }
            }
            Ok(false)
        };
        let mut leaves = same.par_iter().map(fits_better).collect::<Result<Vec<bool>, Error>>()?.into_iter();
        same.retain(|_| leaves.next() == Some(false));
        Ok(())
    }
}

/// Takes the shape to keep of those that are left, and what is proved to be the same, until none is left. Returns the number of
/// meshes that were compared, too.
pub(super) fn groups(
    mut shapes: Vec<ClusterShape<'_>>,
    places: &Places<'_>,
    options: &DuplicateOptions,
    observer: &dyn Observer,
) -> Result<(Vec<DuplicateGroup>, usize), Error> {
    shapes.sort_by(|a, b| a.order.cmp(&b.order).then_with(|| a.files[0].id.cmp(&b.files[0].id)));
    let (left, is_rough) = ((0..shapes.len()).collect(), vec![false; shapes.len()]);
    let mut cluster = Cluster { shapes: &shapes, options, observer, left, is_rough, n_compared: 0 };
    let mut groups = Vec::new();
    while let Some(keeper) = cluster.keeper() {
        let (mut same, rest) = cluster.proved(keeper)?;
        if cluster.prefers_another(keeper, &same) {
            continue;
        }
        cluster.leave_to_others(&mut same, &rest)?;
        (0..=same.len()).for_each(|_| observer.step());
        cluster.left.retain(|i| *i != keeper && same.iter().all(|other| other.number != *i));
        groups.extend(group(&shapes[keeper], same, places, options));
    }
    Ok((groups, cluster.n_compared))
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
