//! The best map of its kind.

use descriptors::DescriptorError;
use surface::VertexId;

use crate::local::vertex_confidence;
use crate::score::Scored;
use crate::search::{MapSearch, Stage};
use crate::shape::MapShape;
use crate::start::Start;
use crate::surface_map::{DOUBTED, SurfaceMap, codistortion};

/// A map that was refined on all samples and eigenfunctions, with how likely it is the right one.
pub(crate) struct Refined {
    found: Scored,
    confidence: f64,
    /// The next best, unless this one is certain.
    rival: Option<Scored>,
}

impl Refined {
    /// The best of some sketches of one kind.
    pub(crate) fn best(
        search: &MapSearch<'_>,
        mut sketches: Vec<Scored>,
    ) -> Result<Option<Self>, DescriptorError> {
        let params = search.params;
        let least = params.least_agreement(&sketches);
        let is_mixture = |found: &Scored| found.is_mixture(least);
        sketches.sort_by(|x, y| is_mixture(x).cmp(&is_mixture(y)).then(x.cost().total_cmp(&y.cost())));
        let Some(best) = sketches.first() else { return Ok(None) };
        let mut rivals = sketches.iter().filter(|other| is_mixture(best) || !is_mixture(other));
        let rival = rivals.find(|other| !best.is_same(other, params));
        let mut confidence = params.odds(best.cost(), rival.map(Scored::cost));
        let mut found = refined(search, best)?;
        if is_mixture(best) || params.misses_one(&found.misses) {
            confidence = confidence.min(DOUBTED);
        }
        let rival = rival.filter(|_| confidence < SurfaceMap::CERTAIN);
        let mut rival = rival.map(|rival| refined(search, rival)).transpose()?;
        // An initial map stands unless another one is clearly better, which the sketches tell.
        let is_better =
            |second: &&mut Scored| search.known.initial.is_empty() && second.cost() < found.cost();
        if let Some(second) = rival.as_mut().filter(is_better) {
            std::mem::swap(&mut found, second);
            confidence = confidence.min(DOUBTED);
        }
        Ok(Some(Self { found, confidence, rival }))
    }

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
    let pair = search.known.and_landmarks(search.samples(usize::MAX), [search.a, search.b]);
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
        vertices: vertices.into_iter().map(VertexId::from).collect(),
        functional: found.functional.forth.clone(),
        alternative: None,
        part: None,
    })
}
