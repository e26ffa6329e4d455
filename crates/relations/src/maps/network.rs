//! Maps between several surfaces that agree with each other.

use base::Observer;
use linalg::{LinalgError, Matrix, pseudo_inverse, symmetric_eigen};
use rayon::prelude::*;
use serde::Serialize;

use super::functional_map::{FunctionalMaps, Placed, TwoWayMap, coefficients};
use super::local::mean_gap;
use super::shape::MapShape;
use super::surface_map::{MapKind, SurfaceMap};
use descriptors::DescriptorError;

/// Maps whose images are less than this apart on average agree, as a share of the square root of the area. A safety limit: maps
/// that turn a body round are farther apart, compositions of good ones are nearer.
const AGREE: f64 = 0.15;

/// Most rows of the matrix whose eigenvectors are the common functions: a second or so. A convention.
const MOST_ROWS: usize = 1500;

/// How well maps of several surfaces close to cycles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CycleReport {
    /// Cycles of three surfaces.
    pub n_cycles: usize,
    /// How far points are from where they started, after a cycle of the maps of pairs: the mean over all cycles, as a share of the
    /// square root of the area.
    pub before: f64,
    /// The same of the maps that agree.
    pub after: f64,
}

/// Maps between several surfaces that agree with each other.
#[derive(Debug, Clone, PartialEq)]
pub struct ConsistentMaps {
    /// A map for every [pair](all_pairs).
    pub maps: Vec<SurfaceMap>,
    /// For every pair, whether its first map agreed with those of the other pairs.
    pub agreed: Vec<bool>,
    /// How well they close to cycles.
    pub cycles: CycleReport,
}

/// All pairs of `n` surfaces, the lower number first: (0, 1), (0, 2), ..., (1, 2), ...
pub fn all_pairs(n: usize) -> Vec<[usize; 2]> {
    (0..n).flat_map(|i| (i + 1..n).map(move |j| [i, j])).collect()
}

/// Maps between several surfaces that agree with each other, from the maps of all pairs (functional map networks, `huang2014` in
/// `REFERENCES.bib`).
///
/// 1. The pairs whose maps close best to cycles and distort least are a tree that joins all surfaces.
/// 2. Every other pair takes the one of its maps, mirrored and alternative ones among them, that is nearest to the way along the
///    tree. If none is near, the pair has no say.
/// 3. The functions that all these maps of functions take to each other best, `Σ |C_ij Y_j - Y_i|²` least with
///    `Σ Y_i' Y_i = I`, place all surfaces in one space (`wang2013`), in which every vertex is mapped to the nearest one.
///
/// `found` has the maps of every [pair](all_pairs) as [wholes](super::map_wholes), the best first.
///
/// # Errors
/// [`DescriptorError::Linalg`], also if the budget of the observer is exceeded.
///
/// # Panics
/// If there are fewer than three surfaces, a pair without a map, or the map of a part.
pub fn consistent_maps(
    shapes: &[&MapShape],
    found: &[Vec<SurfaceMap>],
    observer: &dyn Observer,
) -> Result<ConsistentMaps, DescriptorError> {
    let budget = observer.budget();
    let check = || budget.check().map_err(LinalgError::from);
    let pairs = all_pairs(shapes.len());
    assert!(shapes.len() > 2 && found.len() == pairs.len(), "maps of all pairs of at least three surfaces");
    assert!(found.iter().all(|maps| !maps.is_empty()), "every pair has a map");
    assert!(found.iter().flatten().all(|map| map.part.is_none()), "maps of wholes");
    let network = Network { shapes, pairs: &pairs };
    let first: Vec<TwoWayMap> = network.both(|pair| &found[pair][0]);
    check()?;
    let before = network.cycles(&first)?;
    let costs: Vec<f64> = (0..pairs.len()).map(|p| before.least(pairs[p]) + found[p][0].distortion).collect();
    let tree = Tree::new(shapes.len(), &pairs, &costs);
    let chosen: Vec<Choice<'_>> =
        (0..pairs.len()).map(|p| network.choose(&tree, &first, &found[p], p)).collect::<Result<_, _>>()?;
    let links = network.both(|pair| chosen[pair].map);
    check()?;
    let common = network.common_functions(&links, &chosen)?;
    check()?;
    let placed = |(shape, y): (&&MapShape, &Matrix)| shape.spectrum.vectors.columns(0, y.nrows()) * y;
    let placed: Vec<Matrix> = shapes.iter().zip(&common).map(placed).collect();
    let coarse: Vec<usize> = (0..placed[0].ncols()).collect();
    let nearest = |i: usize, j: usize| shapes[j].nearest_vertices(&placed[j], &coarse, &placed[i]);
    let joined: Vec<TwoWayMap> =
        pairs.par_iter().map(|&[i, j]| TwoWayMap { forth: nearest(i, j), back: nearest(j, i) }).collect();
    let after = network.cycles(&joined)?;
    let kinds = tree.kinds(|pair| found[pair][0].kind);
    let map = |p: usize| network.map(p, &joined[p], &chosen[p], &common, &kinds);
    Ok(ConsistentMaps {
        maps: (0..pairs.len()).map(map).collect::<Result<_, _>>()?,
        agreed: chosen.iter().map(|choice| choice.is_first && choice.agrees).collect(),
        cycles: CycleReport { n_cycles: before.errors.len(), before: before.mean(), after: after.mean() },
    })
}

/// The map that a pair takes.
struct Choice<'a> {
    map: &'a SurfaceMap,
    is_first: bool,
    /// Whether it is near the way along the tree.
    agrees: bool,
}

/// The errors of all cycles of three surfaces, the lowest number first.
struct Cycles {
    errors: Vec<([usize; 3], f64)>,
}

impl Cycles {
    fn mean(&self) -> f64 {
        self.errors.iter().map(|(_, error)| error).sum::<f64>() / self.errors.len().max(1) as f64
    }

    /// The least error of the cycles through a pair: one wrong map spoils all of its own cycles, and one cycle of each other pair
    /// for every other surface.
    fn least(&self, pair: [usize; 2]) -> f64 {
        let through = self.errors.iter().filter(|(cycle, _)| pair.iter().all(|i| cycle.contains(i)));
        through.map(|(_, error)| *error).fold(f64::INFINITY, f64::min)
    }
}

struct Network<'a> {
    shapes: &'a [&'a MapShape],
    pairs: &'a [[usize; 2]],
}

impl<'a> Network<'a> {
    fn both(&self, map: impl Sync + Fn(usize) -> &'a SurfaceMap) -> Vec<TwoWayMap> {
        let one = |(p, &[i, j]): (usize, &[usize; 2])| {
            let (a, b, found) = (self.shapes[i], self.shapes[j], map(p));
            let Placed { on_a, on_b, coarse } =
                FunctionalMaps::of_one(&found.functional).placed([&a.spectrum.vectors, &b.spectrum.vectors]);
            let forth = found.vertices.iter().map(|v| v.index()).collect();
            TwoWayMap { forth, back: a.nearest_vertices(&on_a, &coarse, &on_b) }
        };
        self.pairs.par_iter().enumerate().map(one).collect()
    }

    /// The map from one surface to another.
    fn hop<'b>(&self, maps: &'b [TwoWayMap], from: usize, to: usize) -> &'b [usize] {
        let pair = [from.min(to), from.max(to)];
        let at = self.pairs.iter().position(|other| *other == pair).unwrap_or_default();
        if from < to { &maps[at].forth } else { &maps[at].back }
    }

    /// Where the landmarks of the first surface of a way end.
    fn images(&self, maps: &[TwoWayMap], way: &[usize]) -> Vec<usize> {
        let mut at = self.shapes[way[0]].landmarks().to_vec();
        for step in way.windows(2) {
            let map = self.hop(maps, step[0], step[1]);
            at.iter_mut().for_each(|v| *v = map[*v]);
        }
        at
    }

    fn cycles(&self, maps: &[TwoWayMap]) -> Result<Cycles, DescriptorError> {
        let n = self.shapes.len();
        let all = (0..n).flat_map(|i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| [i, j, k])));
        let error = |cycle: [usize; 3]| {
            let [i, j, k] = cycle;
            let gaps = self.shapes[i].distances_to(&self.images(maps, &[i, j, k, i]))?;
            Ok((cycle, gaps.diagonal().mean()))
        };
        Ok(Cycles { errors: all.map(error).collect::<Result<_, DescriptorError>>()? })
    }

    /// The one of the maps of a pair that is nearest to the way along the tree.
    fn choose<'b>(
        &self,
        tree: &Tree,
        first: &[TwoWayMap],
        maps: &'b [SurfaceMap],
        pair: usize,
    ) -> Result<Choice<'b>, DescriptorError> {
        let [i, j] = self.pairs[pair];
        let (a, b) = (self.shapes[i], self.shapes[j]);
        let expected = b.distances_to(&self.images(first, &tree.way(i, j)))?;
        let mut best = (f64::INFINITY, &maps[0]);
        for map in maps.iter().flat_map(|map| std::iter::once(map).chain(map.alternative.as_deref())) {
            let images: Vec<usize> = a.landmarks().iter().map(|&x| map.vertices[x].index()).collect();
            let gap = mean_gap(&b.distances_to(&images)?, &expected);
            if gap < best.0 {
                best = (gap, map);
            }
        }
        let (gap, map) = best;
        Ok(Choice { map, is_first: std::ptr::eq(map, &maps[0]), agrees: gap < AGREE })
    }

    /// The coefficients, for each surface, of functions that all maps take to each other as well as possible.
    fn common_functions(
        &self,
        links: &[TwoWayMap],
        chosen: &[Choice<'_>],
    ) -> Result<Vec<Matrix>, DescriptorError> {
        let n = self.shapes.len();
        let of_maps = chosen.iter().map(|choice| choice.map.functional.ncols());
        let k = of_maps.min().unwrap_or(0).min((MOST_ROWS / n).max(1));
        let one = |from: usize, to: usize| {
            let (own, other) = (self.shapes[from], self.shapes[to]);
            let map = self.hop(links, from, to);
            let images: Vec<usize> = own.samples.iter().map(|&x| map[x]).collect();
            coefficients(&own.at_samples, &other.spectrum.vectors.columns(0, k).select_rows(&images))
        };
        let maps: Vec<[Matrix; 2]> = self.pairs.par_iter().map(|&[i, j]| [one(i, j), one(j, i)]).collect();
        let mut sum = Matrix::zeros(n * k, n * k);
        let identity = Matrix::identity(k, k);
        for ((&[i, j], both), choice) in self.pairs.iter().zip(&maps).zip(chosen) {
            if !choice.agrees {
                continue;
            }
            for ([to, from], map) in [([i, j], &both[0]), ([j, i], &both[1])] {
                let mut add = |row: usize, column: usize, block: &Matrix| {
                    let mut view = sum.view_mut((row * k, column * k), (k, k));
                    view += block;
                };
                add(to, to, &identity);
                add(from, from, &map.tr_mul(map));
                add(to, from, &-map);
                add(from, to, &-map.transpose());
            }
        }
        let eigen = symmetric_eigen(&sum)?;
        let vectors = eigen.vectors.columns(n * k - k, k).into_owned();
        Ok((0..n).map(|i| vectors.rows(i * k, k).into_owned()).collect())
    }

    /// The map of a pair that agrees with the others.
    fn map(
        &self,
        pair: usize,
        both: &TwoWayMap,
        choice: &Choice<'_>,
        common: &[Matrix],
        kinds: &[MapKind],
    ) -> Result<SurfaceMap, DescriptorError> {
        let [i, j] = self.pairs[pair];
        let (a, b) = (self.shapes[i], self.shapes[j]);
        Ok(SurfaceMap {
            kind: composed(kinds[i], kinds[j]),
            agreement: choice.map.agreement.filter(|_| choice.agrees),
            confidence: choice.map.confidence,
            functional: &common[i] * pseudo_inverse(&common[j])?,
            ..SurfaceMap::of_vertices([a, b], &both.forth, &b.landmark_images(&both.back))?
        })
    }
}

/// The kind of a map that follows another one.
fn composed(one: MapKind, other: MapKind) -> MapKind {
    match (one, other) {
        (MapKind::Unoriented, _) | (_, MapKind::Unoriented) => MapKind::Unoriented,
        _ if one == other => MapKind::Direct,
        _ => MapKind::Mirrored,
    }
}

/// The cheapest pairs that join all surfaces, from surface 0 on.
struct Tree {
    /// The pairs, each with the end that was joined before, and the other one.
    joined: Vec<(usize, [usize; 2])>,
}

impl Tree {
    /// By the algorithm of Prim.
    fn new(n: usize, pairs: &[[usize; 2]], costs: &[f64]) -> Self {
        let mut is_in = vec![false; n];
        is_in[0] = true;
        let mut joined = Vec::new();
        for _ in 1..n {
            let border = (0..pairs.len()).filter(|p| is_in[pairs[*p][0]] != is_in[pairs[*p][1]]);
            let Some(next) = border.min_by(|p, q| costs[*p].total_cmp(&costs[*q])) else { break };
            let [i, j] = pairs[next];
            let edge = if is_in[i] { [i, j] } else { [j, i] };
            is_in[edge[1]] = true;
            joined.push((next, edge));
        }
        Self { joined }
    }

    /// The surfaces on the way from one to another.
    fn way(&self, from: usize, to: usize) -> Vec<usize> {
        let edge = |at: &usize| self.joined.iter().find(|(_, [_, after])| after == at);
        let before = |at: &usize| edge(at).map(|(_, [before, _])| *before);
        let up = |at: usize| std::iter::successors(Some(at), before).collect::<Vec<_>>();
        let (mut there, mut back) = (up(from), up(to));
        let mut last = None;
        while there.last().is_some() && there.last() == back.last() {
            last = there.pop();
            back.pop();
        }
        there.into_iter().chain(last).chain(back.into_iter().rev()).collect()
    }

    /// The kind of the maps from surface 0 to every surface.
    fn kinds(&self, kind: impl Fn(usize) -> MapKind) -> Vec<MapKind> {
        let mut kinds = vec![MapKind::Direct; self.joined.len() + 1];
        for (pair, [before, after]) in &self.joined {
            kinds[*after] = composed(kinds[*before], kind(*pair));
        }
        kinds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tree_takes_the_cheapest_pairs() {
        // 0-3-1 and 3-2; the map of 0 and 3 is mirrored.
        let pairs = all_pairs(4);
        assert_eq!(pairs, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]);
        let tree = Tree::new(4, &pairs, &[9.0, 9.0, 1.0, 9.0, 2.0, 3.0]);
        assert_eq!(tree.way(0, 1), [0, 3, 1]);
        assert_eq!(tree.way(1, 2), [1, 3, 2]);
        assert_eq!(tree.way(2, 3), [2, 3]);
        assert_eq!(tree.way(2, 2), [2]);
        let kind = |pair: usize| if pair == 2 { MapKind::Mirrored } else { MapKind::Direct };
        let kinds = tree.kinds(kind);
        assert_eq!(kinds[1..], [MapKind::Mirrored; 3]);
        assert_eq!(composed(kinds[1], kinds[2]), MapKind::Direct);
        assert_eq!(composed(MapKind::Direct, MapKind::Unoriented), MapKind::Unoriented);
    }
}
