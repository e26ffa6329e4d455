//! The best map of its kind.

use descriptors::{Boundary, DescriptorError};
use linalg::Matrix;
use rayon::prelude::*;
use surface::VertexId;

use crate::curvature::mismatch;
use crate::error::MapError;
use crate::known::KnownMap;
use crate::local::{between, vertex_confidence};
use crate::params::MapParams;
use crate::score::Scored;
use crate::search::{MapSearch, Stage};
use crate::shape::MapShape;
use crate::start::Start;
use crate::surface_map::{DOUBTED, MapKind, SurfaceMap, codistortion};

/// Maps of each kind that are refined and judged. A limit of effort.
const FINALISTS: usize = 3;

/// A map that was refined on all samples and eigenfunctions, with how likely it is the right one.
pub(crate) struct Refined {
    found: Scored,
    confidence: f64,
    /// The next best, unless this one is beyond doubt.
    rival: Option<Scored>,
}

/// A refined sketch.
struct Finalist {
    kind: MapKind,
    coset: usize,
    is_mixture: bool,
    sketched: f64,
    refined: Scored,
    /// One less the correlation of the fine curvatures of corresponding points, if both surfaces have an inside.
    mismatch: Option<f64>,
}

/// A map that is given, as it is, beside the best one that a search finds; `None` if too few vertices have a partner.
pub(crate) fn scored_as_given(
    search: &MapSearch<'_>,
    given: &KnownMap,
) -> Result<Option<SurfaceMap>, MapError> {
    let MapSearch { params, shapes, .. } = *search;
    let pair = search.samples(usize::MAX);
    let Some(start) = given.start(&pair, shapes, params.eigenfunctions) else { return Ok(None) };
    // No functions are taken in that the given pairs do not determine.
    let stage = Stage { last: start.first, pair };
    let Some(scored) = search.scored(&stage, vec![start])?.pop() else { return Ok(None) };
    let cost = |one: &Scored| one.cost() * one.fine_mismatch(shapes).unwrap_or(1.0).powi(2);
    // Those of the same kind first, and the better ones of others.
    let mut found = best_of_each_kind(search, search.sketches()?)?;
    let is_other = |best: &Refined| best.found.kind() != scored.kind();
    found.sort_by(|x, y| is_other(x).cmp(&is_other(y)).then(cost(&x.found).total_cmp(&cost(&y.found))));
    let (confidence, rival) = match found.into_iter().next() {
        Some(best) if best.found.is_same(&scored, params) => (best.confidence, best.rival),
        Some(best) => (params.odds(cost(&scored), Some(cost(&best.found))), Some(best.found)),
        None => (1.0, None),
    };
    let rival = rival.filter(|_| confidence < Boundary::CERTAIN);
    let mut map = Refined { found: scored, confidence, rival }.on_all_vertices(shapes)?;
    for [x, y] in given.initial_pairs() {
        map.vertices[x.index()] = Some(y);
    }
    let [a, b] = shapes;
    let images: Vec<usize> = map.vertices.iter().flatten().map(|y| y.index()).collect();
    map.vertex_confidence = vertex_confidence(shapes, [1.0; 2], &images)?;
    // A map that is only given in one direction changes the distances of the landmarks from each other.
    let of_landmarks: Vec<usize> = a.landmarks().iter().map(|&x| images[x]).collect();
    let to_images = b.distances_to(&of_landmarks)?;
    map.distortion = codistortion(&a.distances_to(a.landmarks())?, &between(&to_images, &to_images));
    Ok(Some(map))
}

/// The best map of each orientation; without one if no map has any.
pub(crate) fn best_of_each_kind(
    search: &MapSearch<'_>,
    mut sketches: Vec<Scored>,
) -> Result<Vec<Refined>, DescriptorError> {
    let mut chosen = Vec::new();
    let mut others = MapKind::ALL.map(|_| None);
    for kind in MapKind::ALL {
        if kind == MapKind::Unoriented && !chosen.is_empty() {
            break;
        }
        let (of_kind, rest): (Vec<_>, Vec<_>) = sketches.into_iter().partition(|one| one.kind() == kind);
        sketches = rest;
        let least = search.params.least_agreement(&of_kind);
        let (kept, next) = shortlist(of_kind, search.params);
        others[kind as usize] = next;
        chosen.extend(kept.into_iter().map(|one| (kind, one.is_mixture(least), one)));
    }
    let refine = |(kind, is_mixture, sketch): (MapKind, bool, Scored)| -> Result<_, DescriptorError> {
        let refined = refined(search, &sketch)?;
        let mismatch = refined.fine_mismatch(search.shapes);
        let (coset, sketched) = (sketch.coset, sketch.cost());
        Ok(Finalist { kind, coset, is_mixture, sketched, refined, mismatch })
    };
    let finalists: Vec<Finalist> = chosen.into_par_iter().map(refine).collect::<Result<_, _>>()?;
    Ok(MapKind::ALL
        .into_iter()
        .filter_map(|kind| judged(search, kind, &finalists, others[kind as usize]))
        .collect())
}

/// The best different sketches of one kind, and the cost of the best one that is not among them.
fn shortlist(mut of_kind: Vec<Scored>, params: &MapParams) -> (Vec<Scored>, Option<f64>) {
    let is_mixture = |one: &Scored| one.is_mixture(params.pure - params.lost);
    of_kind.sort_by(|x, y| is_mixture(x).cmp(&is_mixture(y)).then(x.cost().total_cmp(&y.cost())));
    let Some(best) = of_kind.first() else { return (of_kind, None) };
    // A rival of a higher cost is right less than once in a hundred times.
    let (only_pure, most) = (!is_mixture(best), 99f64.powf(1.0 / params.steepness) * best.cost());
    let mut kept: Vec<Scored> = Vec::new();
    for one in of_kind {
        if only_pure && is_mixture(&one) || kept.iter().any(|other| other.is_same(&one, params)) {
            continue;
        }
        if kept.len() == FINALISTS || one.cost() > most {
            return (kept, Some(one.cost()));
        }
        kept.push(one);
    }
    (kept, None)
}

/// The best finalist of a kind, with its odds against the next one, or against the cost of the next sketch if there is none.
fn judged(
    search: &MapSearch<'_>,
    kind: MapKind,
    finalists: &[Finalist],
    next_sketch: Option<f64>,
) -> Option<Refined> {
    let params = search.params;
    // Squared, so that the odds are the same power of its ratio as of that of sketches, nearly.
    let cost = |one: &Finalist| one.sketched * mismatch_of_coset(one.coset, finalists).unwrap_or(1.0).powi(2);
    let mut of_kind: Vec<&Finalist> = finalists.iter().filter(|one| one.kind == kind).collect();
    of_kind.sort_by(|x, y| cost(x).total_cmp(&cost(y)));
    let (mut best, mut rival) = (*of_kind.first()?, of_kind.get(1).copied());
    let mut confidence = match rival {
        Some(rival) => params.odds(cost(best), Some(cost(rival))),
        None => params.odds(best.sketched, next_sketch),
    };
    // Without an inside, refinement is the judge. An initial map stands unless another one is clearly better, which the sketches
    // tell.
    if let Some(second) = &mut rival
        && best.mismatch.is_none()
        && search.known.initial.is_empty()
        && second.refined.cost() < best.refined.cost()
    {
        std::mem::swap(&mut best, second);
        confidence = confidence.min(DOUBTED);
    }
    if best.refined.is_mixture(params.pure) || params.misses_one(&best.refined.misses) {
        confidence = confidence.min(DOUBTED);
    }
    let rival = rival.filter(|_| confidence < Boundary::CERTAIN);
    Some(Refined { found: best.refined.clone(), confidence, rival: rival.map(|one| one.refined.clone()) })
}

/// The geometric mean of the mismatches of the maps that differ by left and right, but for what may be a mixture, unless all is.
fn mismatch_of_coset(coset: usize, finalists: &[Finalist]) -> Option<f64> {
    let members = || finalists.iter().filter(|one| one.coset == coset);
    let only_pure = members().any(|one| !one.is_mixture);
    let counted = members().filter(|one| !(only_pure && one.is_mixture));
    let logs: Vec<f64> = counted.filter_map(|one| one.mismatch).map(f64::ln).collect();
    (!logs.is_empty()).then(|| (logs.iter().sum::<f64>() / logs.len() as f64).exp())
}

impl Scored {
    /// One less the correlation of the fine curvatures of the samples and their images, both ways.
    fn fine_mismatch(&self, [a, b]: [&MapShape; 2]) -> Option<f64> {
        let (of_a, of_b) = (a.fine_curvature.as_ref()?, b.fine_curvature.as_ref()?);
        let [on_a, on_b] = self.functional.placed([&a.spectrum.vectors, &b.spectrum.vectors]);
        let one = |from: (&MapShape, &Matrix, &[f64]), to: (&MapShape, &Matrix, &[f64])| {
            let images = to.0.nearest_vertices(to.1, &from.1.select_rows(&from.0.samples));
            let own: Vec<f64> = from.0.samples.iter().map(|&v| from.2[v]).collect();
            mismatch(&own, to.2, &images)
        };
        Some(0.5 * (one((a, &on_a, of_a), (b, &on_b, of_b)) + one((b, &on_b, of_b), (a, &on_a, of_a))))
    }
}

impl Refined {
    /// The map of all vertices, with its alternative.
    pub(crate) fn on_all_vertices(&self, shapes: [&MapShape; 2]) -> Result<SurfaceMap, DescriptorError> {
        let mut map = on_all_vertices(&self.found, shapes, self.confidence)?;
        if let Some(rival) = &self.rival {
            map.alternative = Some(Box::new(on_all_vertices(rival, shapes, 1.0 - self.confidence)?));
        }
        Ok(map)
    }
}

/// A sketch on all samples and eigenfunctions.
fn refined(search: &MapSearch<'_>, sketch: &Scored) -> Result<Scored, DescriptorError> {
    let params = search.params;
    let pair = search.known.and_landmarks(search.samples(usize::MAX), search.shapes);
    let start = Start { maps: sketch.functional.sample_maps(&pair), first: params.functions };
    let refined = search.scored(&Stage { pair, last: params.eigenfunctions }, vec![start])?;
    // Refinement may mix two maps, where the sketch is right.
    let agrees = |found: &Scored| match (sketch.agreement, found.agreement) {
        (Some(before), Some(after)) => after * before.signum() > before.abs() - params.lost,
        _ => true,
    };
    Ok(refined.into_iter().find(agrees).unwrap_or_else(|| sketch.clone()))
}

fn on_all_vertices(
    found: &Scored,
    [a, b]: [&MapShape; 2],
    confidence: f64,
) -> Result<SurfaceMap, DescriptorError> {
    let [on_a, on_b] = found.functional.placed([&a.spectrum.vectors, &b.spectrum.vectors]);
    let vertices = b.nearest_vertices(&on_b, &on_a);
    let back = a.nearest_vertices(&on_a, &on_b.select_rows(b.landmarks()));
    let to_images = b.distances_to(&a.landmarks().iter().map(|&x| vertices[x]).collect::<Vec<_>>())?;
    Ok(SurfaceMap {
        kind: found.kind(),
        distortion: codistortion(&a.distances_to(&back)?, &to_images),
        agreement: found.agreement,
        confidence,
        vertex_confidence: vertex_confidence([a, b], [1.0; 2], &vertices)?,
        vertices: vertices.into_iter().map(|y| Some(VertexId::from(y))).collect(),
        functional: found.functional.to_first().clone(),
        landmarks: Vec::new(),
        alternative: None,
        part: None,
    })
}
