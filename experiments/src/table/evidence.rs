//! Evidence: what is said of pairs of generated mechanical parts, of copies of them, and of pieces that were cut off.
//!
//! Measures `different called one surface` and `... above .9`, shares of the `pairs` of different parts; `true pairs denied`
//! of the `true pairs`; `variants named` of the `single changes`; `cuts recognised` of the `cuts`; and `largest error of
//! confidence`, over bins of at least [`FEWEST`] relations.

use anyhow::Result;
use canonform::relations::{MeshGeometry, Relation, RelationKind};
use canonform::rigid::Handedness;
use datasets::{Damage, MechanicalPart, PartMesh, mechanical_parts};
use descriptors::ShapeDistance;
use mesh::TriMesh;
use rayon::prelude::*;
use report::results::Series;
use serde::Deserialize;
use surface::VertexId;

use crate::context::Context;
use crate::experiment::Experiment;
use crate::parts::copies;
use crate::sweep::{linear, mean, numbers, panel, point, share};

/// Bins of confidence, by their lower ends.
const BINS: [f64; 6] = [0.0, 0.6, 0.8, 0.9, 0.95, 0.985];

/// Relations of a bin from which its share counts.
const FEWEST: usize = 20;

/// Shares of a model that are left of it.
const LEFT: [f64; 6] = [0.25, 0.4, 0.5, 0.6, 0.75, 0.9];

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct EvidenceOptions {
    /// Number of parts, of which all pairs are compared.
    parts: usize,
    /// Number of parts that are compared with copies of themselves.
    treated: usize,
}

/// What was said with a confidence, and whether it is right.
type Said = (f64, bool);

impl Experiment for EvidenceOptions {
    fn run(&self, context: &Context<'_>) -> Result<()> {
        let parts = mechanical_parts(context.seed, self.parts);
        let geometries: Vec<MeshGeometry> =
            parts.par_iter().filter_map(|part| geometry(&part.mesh(&PartMesh::default()))).collect();
        let pairs: Vec<(usize, usize)> = (0..parts.len()).flat_map(|i| (0..i).map(move |j| (j, i))).collect();
        let told: Vec<(Truth, Relation)> = pairs
            .par_iter()
            .map(|&(i, j)| (Truth::of(&parts[i], &parts[j]), related(&geometries[i], &geometries[j])))
            .collect();
        let (same, told): (Vec<_>, Vec<_>) = told.into_iter().partition(|(truth, _)| *truth == Truth::Same);
        let single: Vec<_> = told.iter().filter(|(truth, _)| *truth == Truth::OneChange).collect();
        let mut copies: Vec<Relation> = (0..self.treated.min(parts.len()))
            .into_par_iter()
            .flat_map_iter(|i| {
                let copies = copies(&parts[i]);
                copies
                    .into_iter()
                    .filter_map(|copy| Some(related(&geometries[i], &geometry(&copy)?)))
                    .collect::<Vec<_>>()
            })
            .collect();
        copies.extend(same.into_iter().map(|(_, relation)| relation));
        let cuts = cuts(context);
        let mut said: Vec<Said> =
            told.iter().map(|(truth, told)| (told.confidence, truth.agrees(told))).collect();
        said.extend(copies.iter().map(|told| (told.confidence, is_one_surface(told))));
        let (points, error) = calibration(&said);
        let measured = numbers([
            ("pairs", told.len() as f64),
            ("different called one surface", share(&told, |(_, told)| is_one_surface(told))),
            (
                "different called one surface above .9",
                share(&told, |(_, told)| is_one_surface(told) && told.confidence > 0.9),
            ),
            ("true pairs", copies.len() as f64),
            ("true pairs denied", share(&copies, |told| !is_one_surface(told))),
            ("single changes", single.len() as f64),
            ("variants named", share(&single, |(_, told)| told.kind == RelationKind::Variant)),
            ("cuts", cuts.len() as f64),
            ("cuts recognised", share(&cuts, |told| told.kind == RelationKind::PartOf)),
            ("largest error of confidence", error),
        ]);
        let diagonal = Series {
            name: "calibrated".to_owned(),
            points: points.points.iter().map(|p| point(p.x, &[p.x])).collect(),
        };
        let panel =
            panel("Calibration", linear("confidence"), linear("share that is right"), vec![points, diagonal]);
        context.publish_curves(vec![panel], context.provenance(&[]), &measured)
    }
}

/// What is true of two parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Truth {
    /// One part at two sizes, or its mirror image.
    Same,
    /// Parts of one family that differ in one parameter.
    OneChange,
    /// Parts of one family.
    Family,
    Other,
}

impl Truth {
    fn of(a: &MechanicalPart, b: &MechanicalPart) -> Self {
        let Some(differences) = a.differences(b) else { return Self::Other };
        let ratio = |(x, y): (f64, f64)| y / x;
        let values =
            || a.parameters().into_iter().zip(b.parameters()).map(|((name, x), (_, y))| (name, (x, y)));
        let lengths = || values().filter(|(name, _)| !is_count(name)).map(|(_, pair)| ratio(pair));
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

    /// Whether what is said of a pair of different parts is right. Parts of one family are variants if they are near, and
    /// else of one class.
    fn agrees(self, told: &Relation) -> bool {
        match self {
            Self::Same => is_one_surface(told),
            Self::OneChange => told.kind == RelationKind::Variant,
            Self::Family => told.kind == RelationKind::Variant || told.kind.is_by_distance(),
            Self::Other => told.kind.is_by_distance(),
        }
    }
}

/// Parameters that are numbers of things or angles, which stay as they are at another size.
fn is_count(name: &str) -> bool {
    ["holes", "teeth", "angle", "hand", "lobes", "flutes", "grips"].iter().any(|word| name.contains(word))
}

fn is_one_surface(told: &Relation) -> bool {
    told.kind.is_one_surface()
}

fn geometry(mesh: &TriMesh) -> Option<MeshGeometry> {
    MeshGeometry::new(mesh, None)
}

/// The relation by the meshes of two shapes whose signatures are alike, the hardest case.
fn related(a: &MeshGeometry, b: &MeshGeometry) -> Relation {
    let near = ShapeDistance { fused: 0.5, combined: 0.5 };
    Relation::by_distance(near, 1.0, Handedness::Unknown).by_meshes([a, b])
}

/// Shapes of the collection beside pieces of them, moved.
fn cuts(context: &Context<'_>) -> Vec<Relation> {
    let shapes = context.collection.first_of_each_class(1);
    let cases: Vec<_> =
        shapes.iter().flat_map(|shape| LEFT.map(|left| (shape.surface.mesh(), left))).collect();
    let told = cases.into_par_iter().filter_map(|(mesh, left)| {
        let piece = Damage::Move.apply(&beyond_a_plane(mesh, left), 7);
        Some(related(&geometry(mesh)?, &geometry(&piece)?))
    });
    told.collect()
}

/// The faces beyond a plane across an oblique direction.
fn beyond_a_plane(mesh: &TriMesh, left: f64) -> TriMesh {
    let height = |face: &[VertexId; 3]| -> f64 {
        face.iter().map(|v| mesh.positions[v.index()]).map(|p| p.x + 0.3 * p.y + 0.1 * p.z).sum()
    };
    let mut faces = mesh.faces.clone();
    faces.sort_by(|a, b| height(b).total_cmp(&height(a)));
    faces.truncate((left * faces.len() as f64) as usize);
    TriMesh { positions: mesh.positions.clone(), faces }.without_unused_vertices()
}

/// The share of relations that is right against the mean confidence, by bins, and the largest difference of both.
fn calibration(said: &[Said]) -> (Series, f64) {
    let mut points = Vec::new();
    let mut error = 0.0f64;
    for (i, &low) in BINS.iter().enumerate() {
        let high = BINS.get(i + 1).copied().unwrap_or(f64::INFINITY);
        let bin: Vec<&Said> =
            said.iter().filter(|(confidence, _)| (low..high).contains(confidence)).collect();
        if bin.len() < FEWEST {
            continue;
        }
        let confidence = mean(bin.iter().map(|(confidence, _)| *confidence));
        let right = share(&bin, |(_, right)| *right);
        error = error.max((confidence - right).abs());
        points.push(point(confidence, &[right]));
    }
    (Series { name: "measured".to_owned(), points }, error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_that_differ_are_told_apart_and_copies_are_not() {
        let parts = mechanical_parts(0, 16);
        for part in parts.iter().step_by(3) {
            let own = geometry(&part.mesh(&PartMesh::default())).unwrap();
            for copy in copies(part) {
                let told = related(&own, &geometry(&copy).unwrap());
                assert!(is_one_surface(&told), "{}: {told}", part.name());
            }
        }
    }

    #[test]
    fn arcs_do_not_explain_a_difference_of_vertices() {
        let pipes: Vec<MechanicalPart> = mechanical_parts(0, 400)
            .into_iter()
            .filter(|part| part.name().starts_with("bent-pipe-d20-t1.5-r3"))
            .collect();
        let geometries: Vec<MeshGeometry> =
            pipes.iter().map(|pipe| geometry(&pipe.mesh(&PartMesh::default())).unwrap()).collect();
        assert!(pipes.len() > 2);
        for (i, a) in pipes.iter().enumerate() {
            for (j, b) in pipes.iter().enumerate().take(i) {
                let told = related(&geometries[i], &geometries[j]);
                assert!(!is_one_surface(&told), "{}, {}: {told}", a.name(), b.name());
            }
        }
    }

    #[test]
    fn calibrated_answers_have_no_error() {
        let said: Vec<Said> = (0..1000).map(|i| (0.9, i % 10 != 0)).collect();
        assert!(calibration(&said).1 < 1e-9);
        assert!(calibration(&[(0.95, false); 40]).1 > 0.9);
    }
}
