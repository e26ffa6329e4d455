//! Searching several indexes as one: a packed query goes to each, and names and distances come back.
//!
//! ```text
//! PackedQuery -> nearest signatures of all shards -> for each shard: match_shapes -> merge_matches -> SearchReport
//! ```

use base::{Budget, Observer};
use descriptors::{CanonicalForm, PreparedShape};
use nalgebra::Point3;
use retrieval::UnknownThreshold;
use serde::{Deserialize, Serialize};

use super::found::ShardMatch;
use super::options::SearchRank;
use super::predict::{Completeness, predicted};
use super::record::AREA;
use super::search::{SearchReport, SearchSeconds, ShapeSearch, n_candidates, n_wanted};
use crate::error::Error;
use crate::form::ShapeDescription;

/// A described query that can be sent to other processes: what comparing it with other shapes needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PackedQuery {
    /// What it is called in words.
    pub name: String,
    /// Its fused vector.
    pub fused: Vec<f32>,
    /// The options it was described with, as indexes state them.
    options: String,
    points: Vec<[f64; 3]>,
    weights: Vec<f64>,
    area: Option<f64>,
    form_area: Option<f64>,
    complete: Completeness,
}

impl PackedQuery {
    /// Packs a description.
    #[must_use]
    pub fn of(description: &ShapeDescription, name: &str) -> Self {
        let ShapeDescription { options, form, fused, area, .. } = description;
        let complete = Completeness::of(description);
        Self::of_form(form, (name, fused, &options.text()), Some(*area), complete)
    }

    fn of_form(
        form: &CanonicalForm,
        (name, fused, options): (&str, &[f32], &str),
        area: Option<f64>,
        complete: Completeness,
    ) -> Self {
        Self {
            name: name.to_owned(),
            fused: fused.to_vec(),
            options: options.to_owned(),
            points: form.points().iter().map(|p| [p.x, p.y, p.z]).collect(),
            weights: form.weights().to_vec(),
            area,
            form_area: form.area(),
            complete,
        }
    }

    fn prepare(&self) -> Result<PreparedShape, Error> {
        let points = self.points.iter().map(|[x, y, z]| Point3::new(*x, *y, *z)).collect();
        let form = CanonicalForm::from_parts(points, self.weights.clone(), self.form_area)?;
        Ok(PreparedShape::new(self.fused.clone(), &form, self.area)?)
    }

    /// How many of the nearest signatures of all shards are candidates for `k` results, and how many results each shard gives.
    #[must_use]
    pub fn shortlist(k: usize, n_shapes: usize) -> [usize; 2] {
        let wanted = n_wanted(k, n_shapes);
        [n_candidates(wanted), wanted]
    }
}

/// What a shard found among its candidates.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ShardMatches {
    /// The nearest by combined distance.
    pub nearest: Vec<ShardMatch>,
    /// Shapes whose alignment was begun.
    pub aligned: usize,
}

/// What is known of a search for signatures in all shards.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShardedSearch {
    /// Shapes in all shards.
    pub n_shapes: usize,
    /// Shapes whose signatures were compared.
    pub measured: usize,
    /// Share of the ten nearest signatures that such searches find.
    pub recall: f64,
    /// The [threshold](index::class_threshold) of all shards.
    pub threshold: Option<UnknownThreshold>,
}

impl ShapeSearch {
    /// Packs a shape of the index as a query.
    ///
    /// # Errors
    /// [`Error::Index`].
    pub fn pack(&self, id: &str) -> Result<PackedQuery, Error> {
        let (shape, entry) = (self.prepared(id)?, self.index().entry(id)?);
        let about = (id, shape.fused(), self.index().options());
        let (area, complete) = (entry.fact(AREA), Completeness::of_entry(&entry));
        Ok(PackedQuery::of_form(shape.form(), about, area, complete))
    }

    /// The `wanted` nearest of some shapes of this index by combined distance. Names that the index does not hold are left out:
    /// their shapes were removed meanwhile.
    ///
    /// # Errors
    /// [`Error::Index`], also for a query that was described with other options; [`Error::Exceeded`].
    pub fn match_shapes(
        &self,
        query: &PackedQuery,
        ids: &[String],
        wanted: usize,
        observer: &dyn Observer,
    ) -> Result<ShardMatches, Error> {
        self.index().expect_options(&query.options)?;
        let mut known = Vec::new();
        for id in ids {
            if self.index().contains(id)? {
                known.push(id.clone());
            }
        }
        let budget: Budget = observer.budget();
        let found = self.reranked(&query.prepare()?, &known, wanted, &budget)?;
        let nearest = found.nearest.iter().map(|ranked| self.ranked_shape(&known[ranked.index], ranked));
        Ok(ShardMatches { nearest: nearest.collect::<Result<_, _>>()?, aligned: found.aligned })
    }
}

/// The answer to a search in shards: the `k` nearest of what they found, and the class.
///
/// It is the answer of one index with the shapes of all shards, if the candidates were those of that index.
#[must_use]
pub fn merge_matches(
    query: &PackedQuery,
    shards: Vec<ShardMatches>,
    search: ShardedSearch,
    k: usize,
) -> SearchReport {
    let aligned = shards.iter().map(|found| found.aligned).sum();
    let mut nearest: Vec<ShardMatch> = shards.into_iter().flat_map(|found| found.nearest).collect();
    // The order in which one index would have met them.
    nearest.sort_by(|a, b| {
        let combined = a.distance.total_cmp(&b.distance);
        combined.then(a.fused.total_cmp(&b.fused)).then_with(|| a.id.cmp(&b.id))
    });
    nearest.truncate(n_wanted(k, search.n_shapes));
    let ranked = nearest.into_iter().enumerate();
    let mut results: Vec<_> = ranked.map(|(i, found)| found.into_result(i + 1, &query.name)).collect();
    let predicted = predicted(&results, search.threshold, query.complete);
    results.truncate(k);
    SearchReport {
        results,
        rank_by: SearchRank::Plain,
        components: Vec::new(),
        wholes: Vec::new(),
        predicted,
        n_shapes: search.n_shapes,
        measured: search.measured,
        aligned,
        recall: search.recall,
        seconds: SearchSeconds::default(),
    }
}

#[cfg(test)]
mod tests {
    use index::{Index, SearchMode, class_threshold};
    use mesh::shapes;

    use super::super::build::{BuildOptions, build_index};
    use super::super::options::SearchOptions;
    use super::super::query::Query;
    use super::super::source::Shard;
    use super::*;
    use crate::form::{DescribeOptions, describe};

    /// The answer of some shards, all of which are asked for candidates.
    fn asked(shards: &[ShapeSearch], query: &PackedQuery, k: usize) -> SearchReport {
        let n_shapes = shards.iter().map(|shard| shard.index().len()).sum();
        let [n_candidates, wanted] = PackedQuery::shortlist(k, n_shapes);
        let mut near = Vec::new();
        for (place, shard) in shards.iter().enumerate() {
            let found = shard.index().nearest(&query.fused, n_candidates, SearchMode::Exact).unwrap();
            near.extend(found.shapes.into_iter().map(|shape| (shape.distance, shape.id, place)));
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        near.truncate(n_candidates);
        let matches = shards.iter().enumerate().map(|(place, shard)| {
            let of = near.iter().filter(|near| near.2 == place).map(|near| near.1.clone());
            // A name that the shard does not hold is left out.
            let ids: Vec<String> = of.chain(["gone".to_owned()]).collect();
            let found = shard.match_shapes(query, &ids, wanted, &()).unwrap();
            serde_json::from_str(&serde_json::to_string(&found).unwrap()).unwrap()
        });
        let matches = matches.collect();
        let indexes: Vec<Index> = shards.iter().map(|s| Index::open(s.index().path()).unwrap()).collect();
        let threshold = class_threshold(&indexes).unwrap();
        let search = ShardedSearch { n_shapes, measured: n_shapes, recall: 1.0, threshold };
        merge_matches(query, matches, search, k)
    }

    #[test]
    fn shards_answer_as_one_index() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for (i, size) in [0.7, 0.75, 0.8].into_iter().enumerate() {
            mesh::io::write(&at(&format!("ring{i}.off")), &shapes::torus(20, 10, 2.0, size)).unwrap();
            mesh::io::write(&at(&format!("tube{i}.off")), &shapes::torus(30, 8, 4.0, size)).unwrap();
        }
        let describe_options = DescribeOptions::default();
        let built = |name: &str, shard| {
            let options = BuildOptions { shard, ..BuildOptions::new(&describe_options) };
            build_index(folder.path(), &at(name), &options, &()).unwrap();
            ShapeSearch::open(&at(name)).unwrap()
        };
        let whole = built("whole", None);
        let shards = [1, 2].map(|i| built(&format!("part{i}"), Some(Shard::new(i, 2).unwrap())));
        let mesh = shapes::torus(22, 13, 1.0, 0.36);
        let surface = mesh::Surface::new(&mesh, &describe_options.form.repair, &()).unwrap();
        let description = describe(&surface, &describe_options, &()).unwrap();
        let queries = [
            (Query::from(&description), PackedQuery::of(&description, "the query")),
            (Query::Id("ring1"), whole.pack("ring1").unwrap()),
        ];
        for (query, packed) in queries {
            let sent: PackedQuery = serde_json::from_str(&serde_json::to_string(&packed).unwrap()).unwrap();
            assert_eq!(sent, packed);
            for k in [0, 2, 10] {
                let expected = whole.search(query, &SearchOptions { k, ..Default::default() }, &()).unwrap();
                let found = asked(&shards, &sent, k);
                let (aligned, seconds) = (expected.aligned, expected.seconds);
                assert_eq!(SearchReport { aligned, seconds, ..found }, expected);
            }
        }
    }
}
