//! The probabilities of relations in space, by logistic regression on copies of built-in shapes and on pairs of different ones, and
//! how often they are right about families that were held out.

use std::io::Write;
use std::process::ExitCode;

use anyhow::Result;
use base::terminal::Bars;
use canonform::Observer;
use canonform::relations::{MeshGeometry, Relation, RelationKind};
use canonform::rigid::Handedness;
use datasets::{Damage, MechanicalPart, PartMesh, creature_plans, mechanical_parts};
use descriptors::{Boundary, Sample, ShapeDistance};
use mesh::TriMesh;
use rayon::prelude::*;
use surface::VertexId;

use super::{creature, held_out, print_reliability, rounded};
use crate::parts::copies;
use crate::sweep;

/// Vertices of the bodies of a family, in turn.
const VERTICES: [usize; 3] = [300, 1000, 3400];

/// Mechanical parts of which all pairs are compared, and those that are also compared with copies of themselves.
const PARTS: usize = 110;
const TREATED: usize = 55;

/// Shares of a model that are left of it.
pub(crate) const LEFT: [f64; 6] = [0.25, 0.4, 0.5, 0.6, 0.75, 0.9];

/// What happens to bodies.
const DAMAGES: [&[Damage]; 11] = [
    &[Damage::Decimate(0.5)],
    &[Damage::Decimate(0.2), Damage::Move],
    &[Damage::Subdivide(1)],
    &[Damage::Subdivide(2)],
    &[Damage::Remesh],
    &[Damage::Remesh, Damage::Mirror],
    &[Damage::Noise(0.002)],
    &[Damage::Noise(0.005), Damage::Move],
    &[Damage::Holes(0.01)],
    &[Damage::Decimate(0.5), Damage::Noise(0.002)],
    &[Damage::Decimate(0.5), Damage::Mirror, Damage::Scale, Damage::Move],
];

/// Two shapes, what is true of them, and what is said.
pub(crate) struct RelatedPair {
    families: [String; 2],
    pub(crate) truth: Truth,
    pub(crate) said: Relation,
}

impl RelatedPair {
    pub(crate) fn is_right(&self) -> bool {
        self.truth.agrees(&self.said)
    }

    fn is_one(&self) -> bool {
        self.truth == Truth::Same
    }
}

/// What is true of two shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Truth {
    /// One surface, at any size or mirrored.
    Same,
    /// Parts of one family that differ in one parameter.
    OneChange,
    /// Parts of one family.
    Family,
    /// The second is a piece of the first.
    Piece,
    Other,
}

impl Truth {
    fn of(a: &MechanicalPart, b: &MechanicalPart) -> Self {
        let Some(differences) = a.differences(b) else { return Self::Other };
        let values =
            || a.parameters().into_iter().zip(b.parameters()).map(|((name, x), (_, y))| (name, (x, y)));
        let lengths = || values().filter(|(name, _)| !is_count(name)).map(|(_, (x, y))| y / x);
        let is_one_size = lengths().all(|x| lengths().all(|y| (x / y - 1.0).abs() < 1e-9));
        let is_one_count = values().filter(|(name, _)| is_count(name)).all(|(_, (x, y))| x == y);
        // The other hand of a thread is its mirror image.
        let is_other_hand = differences.iter().all(|(name, _)| *name == "thread hand");
        match differences.len() {
            _ if (is_one_size && is_one_count) || is_other_hand => Self::Same,
            1 => Self::OneChange,
            _ => Self::Family,
        }
    }

    /// Whether what is said of a pair is right. Parts of one family are variants if they are near, and
    /// else of one class.
    fn agrees(self, told: &Relation) -> bool {
        match self {
            Self::Same => told.kind.is_one_surface(),
            Self::OneChange => told.kind == RelationKind::Variant,
            Self::Family => told.kind == RelationKind::Variant || told.kind.is_by_distance(),
            Self::Piece => told.kind == RelationKind::PartOf,
            Self::Other => told.kind.is_by_distance(),
        }
    }
}

/// Parameters that are numbers of things or angles, which stay as they are at another size.
fn is_count(name: &str) -> bool {
    ["holes", "teeth", "angle", "hand"].iter().any(|word| name.contains(word))
}

/// The relation by the meshes of two shapes whose signatures are alike, the hardest case.
pub(crate) fn related(a: &MeshGeometry, b: &MeshGeometry) -> Relation {
    let near = ShapeDistance { fused: 0.5, combined: 0.5 };
    Relation::by_distance(near, 1.0, Handedness::Unknown).by_meshes([a, b])
}

/// A mesh in space, if it has an area.
pub(crate) fn geometry(mesh: &TriMesh) -> Option<MeshGeometry> {
    MeshGeometry::new(mesh, None)
}

/// All pairs of mechanical parts, and the first of them with copies of themselves.
pub(crate) fn of_parts(seed: u64, n: usize, treated: usize, observer: &dyn Observer) -> Vec<RelatedPair> {
    let parts = mechanical_parts(seed, n);
    let own: Vec<_> = parts.par_iter().map(|part| geometry(&part.mesh(&PartMesh::default()))).collect();
    let own: Vec<MeshGeometry> = own.into_iter().flatten().collect();
    let pair = |[i, j]: [usize; 2], truth: Truth, other: &MeshGeometry| RelatedPair {
        families: [i, j].map(|k| parts[k].family().name().to_owned()),
        truth,
        said: related(&own[i], other),
    };
    let of_part = |i: usize| {
        observer.step();
        let others = (0..i).map(|j| pair([j, i], Truth::of(&parts[j], &parts[i]), &own[i]));
        let copies = if i < treated { copies(&parts[i]) } else { Vec::new() };
        let copies = copies.iter().filter_map(|copy| Some(pair([i, i], Truth::Same, &geometry(copy)?)));
        others.chain(copies).collect::<Vec<_>>()
    };
    (0..own.len()).into_par_iter().flat_map_iter(of_part).collect()
}

/// Bodies of one family: two poses of one and two others, with copies of the first and pieces of it.
fn of_bodies(family: usize, observer: &dyn Observer) -> Result<Vec<RelatedPair>> {
    observer.step();
    let n_vertices = VERTICES[family % VERTICES.len()];
    let name = creature_plans()[family].to_owned();
    let generated = |[body, pose]: [usize; 2]| creature(3, [family, body, pose], n_vertices);
    let meshes: Vec<TriMesh> =
        [[0, 0], [0, 1], [1, 0], [2, 0]].into_iter().map(generated).collect::<Result<_>>()?;
    let damaged =
        |damages: &&[Damage]| damages.iter().fold(meshes[0].clone(), |mesh, damage| damage.apply(&mesh, 7));
    let pieces = LEFT.map(|left| Damage::Move.apply(&beyond_a_plane(&meshes[0], left), 7));
    let copies: Vec<TriMesh> = DAMAGES.iter().map(damaged).collect();
    let [own, copies, pieces] =
        [&meshes[..], &copies, &pieces].map(|all| all.iter().filter_map(geometry).collect::<Vec<_>>());
    let pair = |truth: Truth, a: &MeshGeometry, b: &MeshGeometry| RelatedPair {
        families: [name.clone(), name.clone()],
        truth,
        said: related(a, b),
    };
    // A copy differs from another body in its triangles too.
    let others =
        sweep::pairs(&own).chain(own[1..].iter().flat_map(|a| copies[..6].iter().map(move |b| (a, b))));
    let others = others.map(|(a, b)| pair(Truth::Other, a, b));
    let copies = copies.iter().map(|copy| pair(Truth::Same, &own[0], copy));
    let pieces = pieces.iter().map(|piece| pair(Truth::Piece, &own[0], piece));
    Ok(others.chain(copies).chain(pieces).collect())
}

/// Shares by which a limb is longer.
const LONGER: [f64; 3] = [0.02, 0.05, 0.1];

/// A body of a family beside triangulations of it with one limb longer: the vertices, the share, and how surely both are called one
/// surface.
fn longer_limbs(family: usize, observer: &dyn Observer) -> Result<Vec<(usize, f64, f64)>> {
    observer.step();
    let n_vertices = VERTICES[family % VERTICES.len()];
    let mesh = creature(3, [family, 0, 0], n_vertices)?;
    let Some(own) = geometry(&mesh) else { return Ok(Vec::new()) };
    let surely = |longer: f64, damage: Damage| {
        let other = damage.apply(&Damage::Lengthen(longer).apply(&mesh, 7), 7);
        let said = related(&own, &geometry(&other)?);
        Some((n_vertices, longer, if said.kind.is_one_surface() { said.confidence } else { 0.0 }))
    };
    let damages = [Damage::Decimate(0.5), Damage::Subdivide(1), Damage::Remesh];
    Ok(LONGER.iter().flat_map(|longer| damages.map(|damage| surely(*longer, damage))).flatten().collect())
}

/// The distance of a pair that was laid over each other, in multiples of what is allowed.
fn ratio(pair: &RelatedPair) -> Option<f64> {
    pair.said.evidence.gap_ratio.filter(|ratio| ratio.is_finite() && *ratio > 0.0)
}

/// The numbers of such pairs, others and copies.
fn counts(pairs: &[&RelatedPair]) -> [f64; 2] {
    let laid = || pairs.iter().filter(|pair| ratio(pair).is_some());
    [false, true].map(|is_one| laid().filter(|pair| pair.is_one() == is_one).count() as f64)
}

/// The weights that make others and copies equally frequent.
fn weights(counts: [f64; 2]) -> [f64; 2] {
    counts.map(|n| 0.5 * (counts[0] + counts[1]) / n)
}

/// One surface or two, both being equally frequent. Of each, one pair more is counted of which the distance says nothing, which
/// keeps the fit finite (Platt 1999, `platt1999` in `REFERENCES.bib`).
fn boundary(pairs: &[&RelatedPair]) -> Boundary {
    let counts = counts(pairs);
    let (weights, known) = (weights(counts), counts.map(|n| (n + 1.0) / (n + 2.0)));
    let laid = pairs.iter().filter_map(|pair| Some((ratio(pair)?, pair.is_one())));
    let samples = laid.flat_map(|(ratio, is_one)| {
        let (weight, known) = (weights[usize::from(is_one)], known[usize::from(is_one)]);
        [(ratio, is_one, weight * known), (ratio, !is_one, weight * (1.0 - known))]
    });
    Boundary { range: [0.0, known[1]], ..Boundary::fitted(&samples.collect::<Vec<Sample>>(), [0.0, 1.0]) }
}

/// The kinds that have a score: the share of relations of the kind that are right; one more is right and one wrong.
const SCORED: [(&str, RelationKind); 2] = [("VARIANT", RelationKind::Variant), ("CUT", RelationKind::PartOf)];

fn scores(pairs: &[&RelatedPair]) -> [f64; 2] {
    SCORED.map(|(_, kind)| {
        let of_kind = || pairs.iter().filter(|pair| pair.said.kind == kind);
        let right = of_kind().filter(|pair| pair.is_right()).count();
        (right as f64 + 1.0) / (of_kind().count() as f64 + 2.0)
    })
}

/// The faces beyond a plane across an oblique direction.
pub(crate) fn beyond_a_plane(mesh: &TriMesh, left: f64) -> TriMesh {
    let height = |face: &[VertexId; 3]| -> f64 {
        face.iter().map(|v| mesh.positions[v.index()]).map(|p| p.x + 0.3 * p.y + 0.1 * p.z).sum()
    };
    let mut faces = mesh.faces.clone();
    faces.sort_by(|a, b| height(b).total_cmp(&height(a)));
    faces.truncate((left * faces.len() as f64) as usize);
    TriMesh { positions: mesh.positions.clone(), faces }.without_unused_vertices()
}

/// `experiments relations`: the rows of `crates/relations/src/calibration.rs`, and how often confidence is right about
/// families that were held out.
pub(crate) fn relations() -> Result<ExitCode> {
    let bars = Bars::new(false);
    bars.begin("comparing parts", PARTS);
    let mut pairs = of_parts(0, PARTS, TREATED, &bars);
    let n_families = creature_plans().len();
    bars.begin("comparing bodies", n_families);
    let bodies = (0..n_families).into_par_iter().map(|family| of_bodies(family, &bars));
    pairs.extend(bodies.collect::<Result<Vec<_>>>()?.into_iter().flatten());
    let all: Vec<&RelatedPair> = pairs.iter().collect();
    let counts = counts(&all);
    let weights = weights(counts);
    // That both are one surface if they were laid over each other, and that they have the same vertices, are variants, or a
    // piece and a whole, if that is said.
    let stated = |(boundary, scores): &(Boundary, [f64; 2]), pair: &RelatedPair| -> Vec<Sample> {
        let is_one = pair.is_one();
        let laid =
            ratio(pair).map(|ratio| (boundary.probability(ratio), is_one, weights[usize::from(is_one)]));
        let said = match pair.said.kind {
            RelationKind::Variant => Some(scores[0]),
            RelationKind::PartOf => Some(scores[1]),
            kind if kind.is_one_surface() && pair.said.evidence.gap_ratio.is_none() => {
                Some(pair.said.confidence)
            }
            _ => None,
        };
        laid.into_iter().chain(said.map(|score| (score, pair.is_right(), 1.0))).collect()
    };
    let fit = |known: &[&RelatedPair]| (boundary(known), scores(known));
    let stated = held_out(&pairs, |pair| &pair.families, fit, stated, &bars).concat();
    bars.begin("lengthening limbs", n_families);
    let longer = (0..n_families).into_par_iter().map(|family| longer_limbs(family, &bars));
    let longer = longer.collect::<Result<Vec<_>>>()?.concat();
    bars.finish();
    let mut out = std::io::stdout().lock();
    let [n_others, n_copies] = counts;
    let found = rounded(boundary(&all));
    writeln!(out, "SAME_SURFACE: {found:?} of {n_copies} copies, {n_others} others")?;
    for ((name, kind), score) in SCORED.into_iter().zip(scores(&all)) {
        let n = pairs.iter().filter(|pair| pair.said.kind == kind).count();
        writeln!(out, "{name}: {score:.3} of {n}")?;
    }
    print_reliability(&mut out, "relation", &stated)?;
    writeln!(
        out,
        "\n| vertices | a limb is longer by | pairs | one surface | at .9 |\n|---|---|---|---|---|"
    )?;
    for [n_vertices, i] in (0..9).map(|i| [VERTICES[i / 3], i % 3]) {
        let told = || longer.iter().filter(|(n, by, _)| *n == n_vertices && *by == LONGER[i]);
        let at = |least: f64| told().filter(|(.., surely)| *surely >= least).count();
        writeln!(out, "| {n_vertices} | {} | {} | {} | {} |", LONGER[i], told().count(), at(0.5), at(0.9))?;
    }
    Ok(ExitCode::SUCCESS)
}
