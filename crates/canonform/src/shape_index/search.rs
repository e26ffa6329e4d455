//! Searching an index for the shapes nearest to a mesh.

use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

use base::{Budget, Observer};
use collection::Storage;
use descriptors::{
    FormAlignment, PartDiscAreas, PartDistance, PreparedShape, ShapeMetric, ShapePair, SignatureKind,
};
use index::{Index, RankedShape, ShapeEntry};
use mesh::TriMesh;
use mesh::io::FileSource;
use rayon::prelude::*;
use retrieval::{Candidate, UnknownThreshold};
use serde::{Deserialize, Serialize};

use super::found::{ComponentResult, OrderedBy, SearchResult, ShardMatch};
use super::options::{Explain, SearchOptions, SearchRank};
use super::predict::{Completeness, Prediction, VOTERS, predicted};
use super::query::{KnownQuery, Query};
use super::record::{disc_areas, options_of, prepared, signature};
use super::rerank::{Ranked, Reranked, bounds, rerank};
use super::source::read_unchanged;
use crate::compare::compare;
use crate::error::Error;
use crate::form::DescribeOptions;

/// Results that are looked for if so many are requested: those that vote are among them.
pub(super) fn n_wanted(k: usize, n_shapes: usize) -> usize {
    k.max(VOTERS).min(n_shapes)
}

/// The answer to a search.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchReport {
    /// The best first, by what `rank_by` states.
    pub results: Vec<SearchResult>,
    /// How results are ordered.
    pub rank_by: SearchRank,
    /// The components of a query that has several, if results are explained: what each of them is.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub components: Vec<ComponentResult>,
    /// Shapes of which the query is a component, but not the largest, if results are explained. Their distance is that by
    /// signatures.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wholes: Vec<SearchResult>,
    /// The class.
    pub predicted: Prediction,
    /// Shapes in the index.
    pub n_shapes: usize,
    /// Shapes whose signatures were compared.
    pub measured: usize,
    /// Shapes whose alignment was begun.
    pub aligned: usize,
    /// Expected share of the nearest shapes that are found: 1, unless the vectors of many indexes are coded.
    pub recall: f64,
    /// Wall-clock seconds.
    pub seconds: SearchSeconds,
}

/// What is known of a search for signatures in all shards.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ShardedSearch {
    /// How results are ordered.
    pub rank_by: SearchRank,
    /// Shapes in all shards.
    pub n_shapes: usize,
    /// Shapes whose signatures were compared.
    pub measured: usize,
    /// Share of the ten nearest signatures that such searches find.
    pub recall: f64,
    /// The [threshold](index::class_threshold) of all shards, if signatures were searched.
    pub threshold: Option<UnknownThreshold>,
}

impl SearchReport {
    /// The answer to a query of this name, from the nearest shapes in their order.
    pub(super) fn of(
        (name, complete): (&str, Completeness),
        nearest: Vec<ShardMatch>,
        search: ShardedSearch,
        k: usize,
    ) -> Self {
        let ShardedSearch { rank_by, n_shapes, measured, recall, threshold } = search;
        let ranked = nearest.into_iter().enumerate();
        let mut results: Vec<_> = ranked.map(|(i, found)| found.into_result(i + 1, name)).collect();
        let predicted = predicted(&results, threshold, complete);
        results.truncate(k);
        Self {
            results,
            rank_by,
            components: Vec::new(),
            wholes: Vec::new(),
            predicted,
            n_shapes,
            measured,
            aligned: 0,
            recall,
            seconds: SearchSeconds::default(),
        }
    }

    /// Replaces the path of every shape that was found, which the index states as seen from its folder.
    pub fn place(&mut self, path: impl Fn(&str) -> String) {
        let components = self.components.iter_mut().filter_map(|part| part.nearest.as_mut());
        for found in self.results.iter_mut().chain(components).chain(&mut self.wholes) {
            found.path = path(&found.path);
        }
    }
}

/// Wall-clock seconds of a search.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SearchSeconds {
    /// Repair, distances, form and signatures of the query.
    pub describe: f64,
    /// Searching, aligning and voting.
    pub search: f64,
}

/// An index that is open for searches.
#[derive(Debug)]
pub struct ShapeSearch {
    index: Index,
    describe: DescribeOptions,
    /// Filled by the first explained search.
    pub(super) components: OnceLock<Vec<(String, Vec<f32>)>>,
}

impl ShapeSearch {
    /// Opens an index.
    ///
    /// # Errors
    /// [`Error::Index`], [`Error::UnknownOptions`].
    pub fn open(path: &Path) -> Result<Self, Error> {
        let index = Index::open(path)?;
        let describe = options_of(&index)?;
        Ok(Self { index, describe, components: OnceLock::new() })
    }

    /// How the shapes of the index were described; queries are described in the same way.
    pub fn describe_options(&self) -> &DescribeOptions {
        &self.describe
    }

    /// The index.
    pub fn index(&self) -> &Index {
        &self.index
    }

    /// A shape with its form at the points that the index stores, ready to be compared.
    ///
    /// # Errors
    /// [`Error::Index`].
    pub fn prepared(&self, id: &str) -> Result<PreparedShape, Error> {
        prepared(&self.index.entry(id)?, self.index.vectors(id)?, &self.describe)
    }

    /// Reads the mesh of a shape again.
    ///
    /// # Errors
    /// [`Error::MeshGone`] and [`Error::MeshChanged`] unless the file still has the content that was indexed;
    /// [`Error::Index`], [`Error::Mesh`].
    pub fn mesh(&self, id: &str) -> Result<TriMesh, Error> {
        read_unchanged(self.index.path(), id, &self.index.entry(id)?)
    }

    /// The shape that a text names, unless there is a file of this name, which goes first.
    #[must_use]
    pub fn id_of<'p>(&self, given: &'p Path) -> Option<&'p str> {
        given.to_str().filter(|id| !Storage.holds(given) && self.index.contains(id).unwrap_or(false))
    }

    /// Finds the shapes nearest to a query, ordered as the options say: by combined distance, by their places on the graph of
    /// nearest neighbours, as wholes of which the query is a part, or by forms alone. The results for a number of results are
    /// the first of those for a larger one, and the class does not depend on it.
    ///
    /// ```
    /// use canonform::{BuildOptions, DescribeOptions, Query, SearchOptions, ShapeSearch, build_index, mesh};
    ///
    /// let folder = tempfile::tempdir()?;
    /// mesh::io::write(&folder.path().join("ball1.off"), &mesh::shapes::icosphere(2))?;
    /// mesh::io::write(&folder.path().join("ring1.off"), &mesh::shapes::torus(24, 12, 2.0, 0.7))?;
    /// let index = folder.path().join("shapes.canonform");
    /// let describe = DescribeOptions::default();
    /// let options = BuildOptions::new(&describe);
    /// build_index(folder.path(), &index, &options, &())?;
    ///
    /// let search = ShapeSearch::open(&index)?;
    /// let ring = mesh::shapes::torus(22, 13, 1.0, 0.35);
    /// let report = search.search(Query::from(&ring), &SearchOptions::default(), &())?;
    /// assert_eq!((report.results[0].id.as_str(), report.results.len()), ("ring1", 2));
    /// let itself = search.search(Query::Id("ball1"), &SearchOptions::default(), &())?;
    /// assert_eq!(itself.results[0].id, "ball1");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Index`], also for an unknown shape and for a description with other options than those of the index; those of
    /// describing a mesh; [`Error::NoPart`] for a description without its surface that is ranked as a part;
    /// [`Error::Exceeded`].
    pub fn search(
        &self,
        query: Query<'_>,
        options: &SearchOptions,
        observer: &dyn Observer,
    ) -> Result<SearchReport, Error> {
        let start = Instant::now();
        let budget = observer.budget();
        let mut made = None;
        let known = self.resolved(query, options, &mut made, observer)?;
        let describe = start.elapsed().as_secs_f64();
        let mut report = self.nearest(&known, options, &budget)?;
        report.seconds.describe = describe;
        if options.explain == Explain::Kind {
            report.components = self.search_components(&known, options, &budget)?;
            report.wholes = self.search_wholes(&known, &budget)?;
        }
        Ok(report)
    }

    /// The nearest shapes and the class.
    pub(super) fn nearest(
        &self,
        query: &KnownQuery<'_>,
        options: &SearchOptions,
        budget: &Budget,
    ) -> Result<SearchReport, Error> {
        let start = Instant::now();
        let wanted = n_wanted(options.k, self.index.len());
        let shortlist = match options.rank_by {
            SearchRank::Plain => self.by_distance(query)?,
            SearchRank::Graph => Shortlist::ordered(self.on_graph(query.shape.fused(), wanted)?),
            rank => Shortlist::ordered(self.by_all(query, rank, self.ids()?, wanted, budget)?),
        };
        let (found, aligned) = self.aligned(&query.shape, shortlist, wanted, budget)?;
        let (matches, alignments): (Vec<_>, Vec<_>) = found.into_iter().unzip();
        let (rank_by, n_shapes) = (options.rank_by, self.index.len());
        let by_signatures = matches!(rank_by, SearchRank::Plain | SearchRank::Graph);
        let threshold = self.index.threshold().filter(|_| by_signatures);
        let about = ShardedSearch { rank_by, n_shapes, measured: n_shapes, recall: 1.0, threshold };
        let mut report = SearchReport::of((query.name, query.complete), matches, about, options.k);
        report.aligned = aligned;
        if options.explain == Explain::Kind {
            let found = report.results.par_iter_mut().zip(alignments);
            found.try_for_each(|(result, best)| self.explain(query, result, Some(best), budget))?;
        }
        report.seconds.search = start.elapsed().as_secs_f64();
        Ok(report)
    }

    /// Adds what the files and meshes of a query and a result tell. `best` is the alignment of their forms, if it is known.
    pub(super) fn explain(
        &self,
        query: &KnownQuery<'_>,
        result: &mut SearchResult,
        best: Option<FormAlignment>,
        budget: &Budget,
    ) -> Result<(), Error> {
        budget.check()?;
        let shape = self.prepared(&result.id)?;
        let pair = ShapePair::new([&query.shape, &shape]);
        let pair = if let Some(best) = best { pair.with_best(best) } else { pair };
        result.comparison = Some(compare(&pair)?);
        result.relation = self.related(query, &result.id, result.relation.clone())?;
        Ok(())
    }

    /// The names of all shapes.
    pub(super) fn ids(&self) -> Result<Vec<String>, Error> {
        Ok(self.index.entries()?.into_iter().map(|(id, _)| id).collect())
    }

    /// All shapes, those first that may be nearest.
    pub(super) fn by_distance(&self, query: &KnownQuery<'_>) -> Result<Shortlist<'_>, Error> {
        let all = self.index.vector_table()?;
        let candidates = bounds(query.shape.fused(), all.len(), |i| all.vector(i));
        Ok(Shortlist { candidates, id: Box::new(|i| all.id(i).to_owned()), orders: None })
    }

    /// The first shapes by rank distance. The graph knows fused distances only, because aligning the forms of all pairs
    /// would take too long.
    fn on_graph(&self, fused: &[f32], wanted: usize) -> Result<Vec<OrderedShape>, Error> {
        let order = |near: RankedShape| {
            let RankedShape { id, rank_distance, plain_rank, .. } = near;
            (id, OrderedBy::Graph { rank_distance, plain_rank })
        };
        Ok(self.index.nearest_on_graph(fused, wanted)?.into_iter().map(order).collect())
    }

    /// The first of some shapes by a distance that is measured from each of them: how well the query fits as a part, or how
    /// much forms differ.
    pub(super) fn by_all(
        &self,
        query: &KnownQuery<'_>,
        rank: SearchRank,
        ids: Vec<String>,
        wanted: usize,
        budget: &Budget,
    ) -> Result<Vec<OrderedShape>, Error> {
        let part = query.part.as_ref().filter(|_| rank == SearchRank::Part);
        if rank == SearchRank::Part && part.is_none() {
            return Err(Error::NoPart);
        }
        let measured = |id: &str| match part {
            Some(part) => self.fit(part, id),
            None => self.form_distance(&query.form_spectrum, id),
        };
        let one = |id: String| {
            budget.check()?;
            Ok((measured(&id)?, id))
        };
        let mut found = ids.into_par_iter().map(one).collect::<Result<Vec<_>, Error>>()?;
        found.sort_by(|(a, x), (b, y)| a.distance().total_cmp(&b.distance()).then_with(|| x.cmp(y)));
        found.truncate(wanted);
        Ok(found.into_iter().map(|(order, id)| (id, order)).collect())
    }

    /// The distance from the spectrum of a form, in units of two poses of one body.
    fn form_distance(&self, spectrum: &[f32], id: &str) -> Result<OrderedBy, Error> {
        let distance = ShapeMetric::fused(spectrum, &self.form_spectrum(id)?);
        Ok(OrderedBy::Forms { form_distance: distance / ShapeMetric::unit(SignatureKind::FormSpectrum) })
    }

    pub(super) fn form_spectrum(&self, id: &str) -> Result<Vec<f32>, Error> {
        Ok(signature(self.index.vectors(id)?, SignatureKind::FormSpectrum, id, self.index.path())?)
    }

    /// How well a part fits into a shape.
    fn fit(&self, part: &PartDiscAreas, id: &str) -> Result<OrderedBy, Error> {
        let areas = disc_areas(&self.index.vectors(id)?);
        let missing = || Error::NoDiscAreas { path: self.index.path().to_owned(), id: id.to_owned() };
        let PartDistance { distance, share } = part.distance(&areas.ok_or_else(missing)?);
        Ok(OrderedBy::Part { part_distance: distance, part_share: share })
    }

    /// Aligns the forms of a shortlist: of as many as are needed for the `wanted` nearest by combined distance, or of all of
    /// them for their relations if something else decides on their order. Returns how many alignments were begun, too.
    pub(super) fn aligned(
        &self,
        query: &PreparedShape,
        shortlist: Shortlist<'_>,
        wanted: usize,
        budget: &Budget,
    ) -> Result<(Vec<(ShardMatch, FormAlignment)>, usize), Error> {
        let Shortlist { candidates, id, orders } = shortlist;
        let n = if orders.is_some() { candidates.len() } else { wanted };
        let Reranked { mut nearest, aligned, .. } = rerank(query, candidates, n, |i| {
            budget.check()?;
            self.prepared(&id(i))
        })?;
        if orders.is_some() {
            nearest.sort_by_key(|ranked| ranked.index);
        }
        let found = nearest.into_iter().map(|ranked| {
            let Ranked { index, distance, fused, shape_distance, scale, alignment } = ranked;
            let (id, order) = (id(index), orders.as_ref().map(|all| all[index]));
            let ShapeEntry { label, path, .. } = self.index.entry(&id)?;
            Ok((ShardMatch { id, label, path, distance, fused, shape_distance, scale, order }, alignment))
        });
        Ok((found.collect::<Result<_, Error>>()?, aligned))
    }
}

/// The name of a shape and what it is ordered by.
pub(super) type OrderedShape = (String, OrderedBy);

/// Shapes that may be results.
pub(super) struct Shortlist<'a> {
    /// In ascending order of lower bounds of their combined distances.
    pub(super) candidates: Vec<Candidate>,
    /// The name of each.
    pub(super) id: Box<dyn Fn(usize) -> String + Sync + 'a>,
    /// What they are ordered by, if not by combined distance.
    pub(super) orders: Option<Vec<OrderedBy>>,
}

impl Shortlist<'static> {
    /// Shapes in their order, all of which are results.
    pub(super) fn ordered(shapes: Vec<OrderedShape>) -> Self {
        let (ids, orders): (Vec<String>, _) = shapes.into_iter().unzip();
        let candidates = (0..ids.len()).map(|index| Candidate { index, bound: 0.0 }).collect();
        Self { candidates, id: Box::new(move |i| ids[i].clone()), orders: Some(orders) }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use index::{IndexError, IndexWriter, Job};
    use mesh::{Surface, shapes};
    use surface::VertexId;
    use tempfile::TempDir;

    use super::*;
    use crate::error::Remedy;
    use crate::form::{EmbedMethod, FormOptions, describe};
    use crate::shape_index::{BuildOptions, build_index};
    use relations::{Basis, RelationKind};

    /// An index of a few bodies.
    fn indexed(describe: &DescribeOptions) -> (TempDir, ShapeSearch) {
        let folder = tempfile::tempdir().unwrap();
        let bodies = [
            ("ball0.off", shapes::icosphere(3)),
            ("ring0.off", shapes::torus(24, 12, 2.0, 0.6)),
            ("ring1.off", shapes::torus(24, 12, 2.0, 0.9)),
            ("box0.vert", shapes::cube(3)),
        ];
        for (name, mesh) in bodies {
            mesh::io::write(&folder.path().join(name), &mesh).unwrap();
        }
        let path = folder.path().join("all.canonform");
        build_index(folder.path(), &path, &BuildOptions::new(describe), &()).unwrap();
        let search = ShapeSearch::open(&path).unwrap();
        (folder, search)
    }

    #[test]
    fn a_mesh_a_description_and_a_stored_shape_find_exactly_the_same() {
        let method = EmbedMethod::KernelPca { rank: None, bandwidth: Default::default() };
        let form = FormOptions { method, ..FormOptions::default() };
        let kernel = DescribeOptions { form, ..DescribeOptions::default() };
        for describe_options in [DescribeOptions::default(), kernel] {
            let (_folder, search) = indexed(&describe_options);
            assert_eq!(*search.describe_options(), describe_options);
            let options = SearchOptions { explain: Explain::Kind, ..SearchOptions::default() };
            let mesh = search.mesh("ring0").unwrap();
            let by_mesh = search.search(Query::from(&mesh), &options, &()).unwrap();
            let by_name = search.search(Query::Id("ring0"), &options, &()).unwrap();
            let surface = Surface::new(&mesh, &describe_options.form.repair, &()).unwrap();
            let described = describe(&surface, &describe_options, &()).unwrap();
            let by_description = search.search(Query::from(&described), &options, &()).unwrap();
            assert!(by_mesh.results[0].id == "ring0" && by_mesh.results[0].distance < 1e-6);
            let unexplained = |report: &SearchReport| {
                let results = report.results.iter();
                let numbers = |r: &SearchResult| (r.id.clone(), r.distance, r.fused, r.comparison.clone());
                results.map(numbers).collect::<Vec<_>>()
            };
            assert_eq!(unexplained(&by_mesh), unexplained(&by_name));
            assert_eq!(unexplained(&by_mesh), unexplained(&by_description));
            let kind = |report: &SearchReport| report.results[0].relation.kind;
            assert_eq!(kind(&by_mesh), RelationKind::IdenticalGeometry);
            assert_eq!(kind(&by_name), RelationKind::IdenticalFile);
            assert_eq!(kind(&by_description), RelationKind::OtherPose, "only descriptions were compared");
            // The comparison of the two shapes says the same.
            for result in &by_mesh.results {
                let other = search.prepared(&result.id).unwrap();
                let query = described.prepare().unwrap();
                let direct = compare(&ShapePair::new([&query, &other])).unwrap();
                assert_eq!(result.comparison.as_ref(), Some(&direct));
                assert_eq!(result.relation.because.distance, direct.shape_distance);
                assert_eq!(result.distance, direct.shape_distance.combined);
            }
        }
    }

    #[test]
    fn a_query_described_with_other_options_is_refused() {
        let (_folder, search) = indexed(&DescribeOptions::default());
        let options = DescribeOptions { points: 500, ..DescribeOptions::default() };
        let surface = Surface::new(&shapes::icosphere(2), &Default::default(), &()).unwrap();
        let query = describe(&surface, &options, &()).unwrap();
        let fault = search.search(Query::from(&query), &SearchOptions::default(), &()).unwrap_err();
        assert!(matches!(fault, Error::Index(IndexError::OtherOptions { .. })));
        assert!(fault.to_string().contains("\"points\":500"), "{fault}");
    }

    #[test]
    fn forms_alone_rank_every_shape_and_a_mirror_image_is_the_same() {
        let (_folder, search) = indexed(&DescribeOptions::default());
        let options = SearchOptions { rank_by: SearchRank::Forms, ..SearchOptions::default() };
        let by_name = search.search(Query::Id("ring0"), &options, &()).unwrap();
        assert_eq!((by_name.rank_by, by_name.results.len(), by_name.measured), (SearchRank::Forms, 4, 4));
        let distance = |found: &SearchResult| found.order.unwrap().distance();
        assert!(by_name.results.windows(2).all(|pair| distance(&pair[0]) <= distance(&pair[1])));
        assert!(by_name.results[0].id == "ring0" && distance(&by_name.results[0]) == 0.0);
        assert_eq!(by_name.results[1].id, "ring1");
        let mut mirrored = search.mesh("ring0").unwrap();
        mirrored.positions.iter_mut().for_each(|p| (p.x, p.y) = (-3.0 * p.x, 3.0 * p.y));
        mirrored.positions.iter_mut().for_each(|p| p.z *= 3.0);
        let by_mesh = search.search(Query::from(&mirrored), &options, &()).unwrap();
        let nearest = &by_mesh.results[0];
        // Which of the points of a ring are taken is left to rounding, so it is less than two poses apart, but not zero.
        assert!(nearest.id == "ring0" && distance(nearest) < 0.8, "{}: {}", nearest.id, distance(nearest));
        let plain = search.search(Query::Id("ring0"), &SearchOptions::default(), &()).unwrap();
        assert!(plain.results.iter().all(|found| found.order.is_none()));
    }

    #[test]
    fn the_graph_ranks_the_same_shapes_in_its_own_order() {
        let (_folder, search) = indexed(&DescribeOptions::default());
        let plain = search.search(Query::Id("ring0"), &SearchOptions::default(), &()).unwrap();
        let options = SearchOptions { rank_by: SearchRank::Graph, ..SearchOptions::default() };
        let graph = search.search(Query::Id("ring0"), &options, &()).unwrap();
        assert_eq!((plain.rank_by, graph.rank_by), (SearchRank::Plain, SearchRank::Graph));
        assert_eq!((graph.results.len(), graph.results[0].id.as_str()), (4, "ring0"));
        let order = |found: &SearchResult| found.order.unwrap().distance();
        assert!(graph.results.windows(2).all(|pair| order(&pair[0]) <= order(&pair[1])));
        assert!(matches!(graph.results[0].order, Some(OrderedBy::Graph { plain_rank: Some(1), .. })));
        for found in &graph.results {
            let same = plain.results.iter().find(|other| other.id == found.id).unwrap();
            assert_eq!(
                (same.distance, same.fused, &same.relation),
                (found.distance, found.fused, &found.relation)
            );
            assert_eq!(same.order, None);
        }
        let json = serde_json::to_value(&graph).unwrap();
        assert_eq!(json["rank_by"], "graph");
        assert_eq!(json["results"][0]["plain_rank"], 1);
        assert!(json["results"][0]["rank_distance"].is_number());
        assert!(serde_json::to_value(&plain).unwrap()["results"][0].get("rank_distance").is_none());
    }

    #[test]
    fn a_part_finds_its_whole_and_needs_a_mesh() {
        let (folder, search) = indexed(&DescribeOptions::default());
        let options = SearchOptions { rank_by: SearchRank::Part, ..SearchOptions::default() };
        let mut part = search.mesh("ring1").unwrap();
        let x = |v: VertexId, part: &TriMesh| part.positions[v.index()].x;
        let kept = part.faces.iter().copied().filter(|face| face.iter().all(|v| x(*v, &part) < 1.0));
        part.faces = kept.collect();
        let found = search.search(Query::from(&part), &options, &()).unwrap();
        assert_eq!(
            (found.rank_by, found.results[0].id.as_str(), found.measured),
            (options.rank_by, "ring1", 4)
        );
        let fit = |found: &SearchResult| found.order.unwrap().distance();
        let share = |found: &SearchResult| match found.order {
            Some(OrderedBy::Part { part_share, .. }) => part_share,
            other => panic!("{other:?}"),
        };
        assert!(found.results.windows(2).all(|pair| fit(&pair[0]) <= fit(&pair[1])));
        let of_ring = share(&found.results[0]);
        assert!((0.5..0.9).contains(&of_ring), "{of_ring}");
        let json = serde_json::to_value(&found).unwrap();
        assert!(json["rank_by"] == "part" && json["results"][0]["part_distance"].is_number());
        // As a whole, it is another shape.
        let plain = search.search(Query::from(&part), &SearchOptions::default(), &()).unwrap();
        assert!(
            !plain.results[0].relation.because.distance.may_be_same_class()
                && plain.results[0].order.is_none()
        );
        // A shape of the index is read again, and a description is not enough.
        let itself = search.search(Query::Id("box0"), &options, &()).unwrap();
        assert!(itself.results[0].id == "box0" && share(&itself.results[0]) == 1.0);
        fs::remove_file(folder.path().join("box0.tri")).unwrap();
        assert!(matches!(search.search(Query::Id("box0"), &options, &()), Err(Error::MeshGone { .. })));
        let surface = Surface::new(&part, &Default::default(), &()).unwrap();
        let described = describe(&surface, search.describe_options(), &()).unwrap();
        assert!(matches!(search.search(Query::from(&described), &options, &()), Err(Error::NoPart)));
    }

    #[test]
    fn an_index_without_disc_areas_is_named_with_its_remedy() {
        let (_folder, search) = indexed(&DescribeOptions::default());
        let old = tempfile::tempdir().unwrap();
        let path = old.path().join("old.canonform");
        let mut writer = IndexWriter::open(&path, Job::Build, Some(search.index().options())).unwrap();
        search
            .index()
            .each(|mut shape| {
                shape.vectors.disc_areas.clear();
                writer.put(&[shape])
            })
            .unwrap();
        writer.finish(&()).unwrap();
        let old = ShapeSearch::open(&path).unwrap();
        let options = SearchOptions { rank_by: SearchRank::Part, ..SearchOptions::default() };
        let fault = old.search(Query::from(&shapes::icosphere(3)), &options, &()).unwrap_err();
        assert!(
            matches!(fault, Error::NoDiscAreas { .. }) && fault.to_string().contains("disc areas"),
            "{fault}"
        );
        assert_eq!(fault.remedy(), Some(Remedy::BuildIndexAnew));
        old.search(Query::from(&shapes::icosphere(3)), &SearchOptions::default(), &()).unwrap();
    }

    #[test]
    fn shapes_are_found_by_name() {
        let (_folder, search) = indexed(&DescribeOptions::default());
        let options = SearchOptions::default();
        assert!(matches!(search.search(Query::Id("none"), &options, &()), Err(Error::Index(_))));
        let names: Vec<String> = search.index().entries().unwrap().into_iter().map(|(id, _)| id).collect();
        assert_eq!(names, ["ball0", "box0", "ring0", "ring1"]);
        assert_eq!(search.index().entry("box0").unwrap().label, "box");
    }

    #[test]
    fn missing_and_changed_meshes_are_different_errors() {
        let (folder, search) = indexed(&DescribeOptions::default());
        assert_eq!(search.mesh("box0").unwrap(), shapes::cube(3));
        fs::copy(folder.path().join("ring1.off"), folder.path().join("ring0.off")).unwrap();
        fs::remove_file(folder.path().join("box0.tri")).unwrap();
        let changed = search.mesh("ring0").unwrap_err();
        assert!(matches!(&changed, Error::MeshChanged { id, .. } if id == "ring0"));
        assert_eq!(changed.remedy(), Some(Remedy::RestoreMesh));
        let gone = search.mesh("box0").unwrap_err();
        assert!(matches!(&gone, Error::MeshGone { id, .. } if id == "box0"));
        assert!(gone.to_string().contains("box0.vert"), "{gone}");
        search.prepared("box0").unwrap();
    }

    #[test]
    fn results_are_explained_by_meshes_where_their_files_are_unchanged() {
        let (folder, search) = indexed(&DescribeOptions::default());
        let options = SearchOptions { explain: Explain::Kind, ..SearchOptions::default() };
        let mut ring = search.mesh("ring0").unwrap();
        ring.positions.iter_mut().for_each(|p| *p /= 25.4);
        let nearest = || search.search(Query::from(&ring), &options, &()).unwrap().results[0].clone();
        let found = nearest().relation;
        assert_eq!((found.kind, found.because.basis), (RelationKind::Scaled, Basis::Meshes));
        assert_eq!(found.to_string(), "ring0 is the query scaled by 25.4 (inches to millimetres)");
        fs::remove_file(folder.path().join("ring0.off")).unwrap();
        let found = nearest().relation;
        assert_eq!((found.kind, found.because.basis), (RelationKind::OtherPose, Basis::Descriptions));
        assert!(found.reason().ends_with("the mesh was not compared"), "{}", found.reason());
        let by_name = search.search(Query::Id("ring0"), &options, &()).unwrap();
        assert_eq!(by_name.results[0].relation.kind, RelationKind::IdenticalFile);
    }

    #[test]
    fn the_file_of_a_query_and_copies_on_a_plate_are_recognised() {
        let (folder, search) = indexed(&DescribeOptions::default());
        let options = SearchOptions { explain: Explain::Kind, ..SearchOptions::default() };
        let path = folder.path().join("ring1.off");
        let content = crate::content_hash(&path).unwrap();
        let ring = mesh::io::read(&path).unwrap();
        let explained = |mesh: &TriMesh, name: &str, content| {
            let found = search.search(Query::Mesh { mesh, name, content }, &options, &()).unwrap();
            found.results[0].relation.to_string()
        };
        assert_eq!(explained(&ring, "a.off", Some(content)), "ring1 is the same file as a.off");
        let plate = |mut meshes: [TriMesh; 3]| {
            for (i, mesh) in meshes.iter_mut().enumerate() {
                mesh.positions.iter_mut().for_each(|p| p.x += 40.0 * i as f64);
            }
            shapes::disjoint(&meshes)
        };
        let rings = plate([ring.clone(), ring.clone(), ring]);
        assert_eq!(explained(&rings, "plate.stl", None), "plate.stl is three copies of ring1");

        let (mut other, ball) = (search.mesh("ring0").unwrap(), search.mesh("ball0").unwrap());
        other.positions.iter_mut().for_each(|p| p.coords *= 3.0);
        let plate = plate([ball.clone(), other, ball]);
        let report = search
            .search(Query::Mesh { mesh: &plate, name: "plate.stl", content: None }, &options, &())
            .unwrap();
        let found: Vec<_> =
            report.components.iter().map(|part| (part.copies, part.nearest.clone().unwrap())).collect();
        assert_eq!((found[0].0, found[0].1.id.as_str()), (1, "ring0"));
        assert_eq!((found[1].0, found[1].1.id.as_str(), found.len()), (2, "ball0", 2));
        // The ball is a component of the plate, but not the largest.
        mesh::io::write(&folder.path().join("plate7.off"), &plate).unwrap();
        let path = folder.path().join("all.canonform");
        build_index(folder.path(), &path, &BuildOptions::new(search.describe_options()), &()).unwrap();
        let again = ShapeSearch::open(&path).unwrap();
        let wholes = again.search(Query::Id("ball0"), &options, &()).unwrap().wholes;
        assert_eq!((wholes.len(), wholes[0].id.as_str()), (1, "plate7"));
        assert_eq!(
            wholes[0].relation.to_string(),
            "plate7 has two copies of ball0 among its three components"
        );
        fs::remove_file(folder.path().join("plate7.off")).unwrap();
        assert_eq!(
            again.search(Query::Id("ball0"), &options, &()).unwrap().wholes[0].relation.to_string(),
            "ball0 is part of plate7, one of its three components, in this or another pose"
        );
        assert!(again.search(Query::Id("box0"), &options, &()).unwrap().wholes.is_empty());

        let kinds: Vec<_> = found.iter().map(|(_, result)| result.relation.kind).collect();
        assert_eq!(kinds, [RelationKind::Scaled, RelationKind::IdenticalGeometry]);
        assert!(
            search
                .search(Query::Mesh { mesh: &plate, name: "", content: None }, &SearchOptions::default(), &())
                .unwrap()
                .components
                .is_empty()
        );
    }
}
