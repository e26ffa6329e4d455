//! Searching an index for the shapes nearest to a mesh.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::time::Instant;

use base::{Budget, Observer};
use collection::Storage;
use descriptors::{Boundary, DiscAreas, PartDistance, PreparedShape, ShapeMetric, ShapePair, SignatureKind};
use index::{Entry, Index, IndexError, VectorTable};
use mesh::TriMesh;
use mesh_io::FileSource;
use rayon::prelude::*;
use retrieval::{LINKS, Neighbor, graph_rank};
use serde::{Deserialize, Serialize};

use super::agreement::Agreement;
use super::found::{ComponentResult, Hit, OrderedBy};
use super::options::{SearchOptions, SearchRank};
use super::predict::{Prediction, n_results, predicted};
use super::query::Query;
use super::record::{missing, options_of};
use super::rerank::{Aligned, bounds, rerank};
use super::source::{read_unchanged, unchanged_files};
use crate::compare::compare;
use crate::error::Error;
use crate::form::DescribeOptions;

/// The nearest shapes whose surfaces are aligned with that of a query with noise. A limit of effort.
const SURFACES: usize = 20;

/// The answer to a search. Read from JSON, it is one that can be [merged](crate::search::merge_answers): without its explanations and
/// its class.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Answer {
    /// The best first, by what `rank_by` states.
    pub results: Vec<Hit>,
    /// How results are ordered.
    pub rank_by: SearchRank,
    /// The components of a query that has several, if results are explained: what each of them is.
    #[serde(skip_deserializing, skip_serializing_if = "Vec::is_empty")]
    pub components: Vec<ComponentResult>,
    /// Shapes of which the query is a component, but not the largest, if results are explained. Their distance is that by
    /// signatures.
    #[serde(skip_deserializing, skip_serializing_if = "Vec::is_empty")]
    pub wholes: Vec<Hit>,
    /// The class.
    #[serde(skip_deserializing)]
    pub predicted: Prediction,
    /// Shapes in the index.
    pub n_shapes: usize,
    /// Shapes whose signatures were compared.
    pub measured: usize,
    /// Shapes whose alignment was begun.
    pub aligned: usize,
    /// Files that could not be read to align their surfaces with a query that has noise; their shapes are ordered by distance.
    pub unread: usize,
    /// Expected share of the nearest shapes that are found: 1, unless the vectors of many indexes are coded.
    pub recall: f64,
    /// Wall-clock seconds.
    #[serde(skip_deserializing)]
    pub seconds: SearchSeconds,
}

impl Answer {
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

/// A query, ready to be compared with the shapes of an index.
pub(super) struct Asked<'a> {
    pub(super) query: &'a Query,
    pub(super) shape: PreparedShape,
    /// The name of the shape that it is.
    itself: Option<String>,
    /// The boundary of classes.
    classes: Option<Boundary>,
}

/// An index that is open for searches.
#[derive(Debug)]
pub struct ShapeSearch {
    index: Index,
    describe: DescribeOptions,
    /// The boundary of its classes, if it has enough pairs of one class.
    classes: Option<Boundary>,
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
        let classes = Agreement::stated(&index)?.map(|agreement| agreement.classes());
        Ok(Self { index, describe, classes, components: OnceLock::new() })
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
        self.describe.prepare(&self.index.shape(id)?)
    }

    /// Reads the mesh of a shape again.
    ///
    /// # Errors
    /// [`Error::MeshGone`] and [`Error::MeshChanged`] unless the file still has the content that was indexed;
    /// [`Error::Index`], [`Error::Mesh`].
    pub fn mesh(&self, id: &str) -> Result<TriMesh, Error> {
        read_unchanged(&self.index.path, &self.index.entry(id)?)
    }

    /// Names and contents of the files of the mesh of a shape, if they still have the content that was indexed.
    ///
    /// # Errors
    /// As those of [`mesh`](Self::mesh), but nothing is parsed.
    pub fn files(&self, id: &str) -> Result<Vec<(PathBuf, Vec<u8>)>, Error> {
        unchanged_files(&self.index.path, &self.index.entry(id)?)
    }

    /// The shape that a text names, unless there is a file of this name, which goes first.
    pub fn id_of<'p>(&self, given: &'p Path) -> Option<&'p str> {
        given.to_str().filter(|id| !Storage.holds(given) && self.index.contains(id).unwrap_or(false))
    }

    /// Finds the shapes nearest to a query, ordered as the options say: by combined distance, by their places on the graph of
    /// nearest neighbors, as wholes of which the query is a part, or by forms alone. The results for a number of results are
    /// the first of those for a larger one, and the class does not depend on it.
    ///
    /// ```
    /// use canonform::{DescribeOptions, mesh};
    /// use canonform::library::{BuildOptions, build_index};
    /// use canonform::search::{SearchOptions, ShapeSearch};
    ///
    /// let folder = tempfile::tempdir()?;
    /// mesh::io::write(&folder.path().join("ball1.off"), &mesh::shapes::icosphere(2))?;
    /// mesh::io::write(&folder.path().join("ring1.off"), &mesh::shapes::torus(24, 12, 2.0, 0.7))?;
    /// let index = folder.path().join("shapes.canonform");
    /// let describe = DescribeOptions::default();
    /// let options = BuildOptions::new(&describe);
    /// build_index(folder.path(), &index, &options, &())?;
    ///
    /// let (search, options) = (ShapeSearch::open(&index)?, SearchOptions::default());
    /// let ring = mesh::shapes::torus(22, 13, 1.0, 0.35);
    /// let answer = search.search(&search.query(&ring, ("a ring", None), &options, &())?, &options, &())?;
    /// assert_eq!((answer.results[0].id.as_str(), answer.results.len()), ("ring1", 2));
    /// let itself = search.search(&search.query_of("ball1", &options, &())?, &options, &())?;
    /// assert_eq!(itself.results[0].id, "ball1");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Index`], also for a query that was described with other options than the shapes of the index;
    /// [`Error::Refused`] for a query that is ranked as a part and has none; [`Error::Exceeded`].
    pub fn search(
        &self,
        query: &Query,
        options: &SearchOptions,
        observer: &dyn Observer,
    ) -> Result<Answer, Error> {
        let mut answer = self.search_among(query, None, options, observer)?;
        if options.explain {
            answer.components = self.search_components(query, options, observer)?;
        }
        Ok(answer)
    }

    /// [Searches](Self::search) among some shapes only, and not for components. Names that the index does not hold are left
    /// out: their shapes were removed meanwhile.
    ///
    /// # Errors
    /// As of [`search`](Self::search).
    pub fn search_among(
        &self,
        query: &Query,
        ids: Option<&[String]>,
        options: &SearchOptions,
        observer: &dyn Observer,
    ) -> Result<Answer, Error> {
        let budget = observer.budget();
        let itself = match (&query.id, &query.content) {
            (None, Some(content)) => self.index.entry_with(content)?.map(|entry| entry.id),
            (id, _) => id.clone(),
        };
        let classes = options.classes.map(|agreement| agreement.classes()).or(self.classes);
        let asked = Asked { query, shape: self.prepared_query(query)?, itself, classes };
        let mut answer = self.nearest(&asked, ids, options, &budget)?;
        if options.explain && !query.is_component {
            answer.wholes = self.search_wholes(&asked, &budget)?;
        }
        Ok(answer)
    }

    /// The shape of a query, ready to be compared.
    ///
    /// # Errors
    /// [`Error::Index`] if it was described with other options than the shapes of the index.
    pub fn prepared_query(&self, query: &Query) -> Result<PreparedShape, Error> {
        self.index.expect_options(&query.options)?;
        self.describe.prepare(&query.shape)
    }

    /// The nearest of all shapes or of some, and the class.
    fn nearest(
        &self,
        asked: &Asked<'_>,
        ids: Option<&[String]>,
        options: &SearchOptions,
        budget: &Budget,
    ) -> Result<Answer, Error> {
        let start = Instant::now();
        let (rank_by, n_shapes) = (options.rank_by, self.index.len());
        let wanted = n_results(options.k).min(n_shapes);
        let held = |id: &String| self.index.contains(id).map(|held| held.then(|| id.clone())).transpose();
        let ids = ids.map(|ids| ids.iter().filter_map(held).collect::<Result<Vec<_>, _>>()).transpose()?;
        let ordered = match (rank_by, &ids) {
            (SearchRank::Graph, None) => Some(self.on_graph(&asked.shape.fused, wanted)?),
            (SearchRank::Part | SearchRank::Forms, _) => {
                Some(self.by_all(asked.query, rank_by, &ids, wanted, budget)?)
            }
            (SearchRank::Plain | SearchRank::Graph, _) => None,
        };
        let mut unread = 0;
        let (found, aligned) = match &ordered {
            Some(ordered) => {
                let candidates = (0..ordered.len()).map(|index| Neighbor { index, distance: 0.0 });
                let at = |i: usize| (ordered[i].0.as_str(), Some(ordered[i].1));
                self.aligned(asked, candidates, ordered.len(), &at, budget)?
            }
            None => {
                let some = ids.map(|ids| self.table_of(&ids)).transpose()?;
                let all = some.as_ref().map_or_else(|| self.index.vector_table(), Ok)?;
                let candidates = bounds(&asked.shape.fused, all);
                let wanted = asked.query.noisy_surface().map_or(wanted, |_| wanted.max(SURFACES));
                let mut nearest = self.aligned(asked, candidates, wanted, &|i| (all.id(i), None), budget)?;
                unread = self.by_surfaces(asked.query, &mut nearest.0, budget)?;
                nearest
            }
        };
        let (mut results, alignments): (Vec<Hit>, Vec<_>) = found.into_iter().unzip();
        let predicted = predicted(&results, asked.classes, &asked.query.shape.entry.facts);
        results.truncate(options.k);
        if options.explain {
            let found = results.par_iter_mut().zip(alignments);
            found.try_for_each(|(hit, aligned)| self.explain(asked, hit, &aligned, budget))?;
        }
        let seconds = SearchSeconds { describe: asked.query.seconds, search: start.elapsed().as_secs_f64() };
        Ok(Answer {
            results,
            rank_by,
            predicted,
            n_shapes,
            measured: n_shapes,
            aligned,
            unread,
            recall: 1.0,
            seconds,
            ..Answer::default()
        })
    }

    /// Puts parts that fit the surface of a query with noise first, of the nearest shapes: noise moves the surface less than the
    /// descriptors. Returns the number of files that cannot be read.
    fn by_surfaces(
        &self,
        query: &Query,
        nearest: &mut [(Hit, Aligned)],
        budget: &Budget,
    ) -> Result<usize, Error> {
        let Some(surface) = query.noisy_surface() else { return Ok(0) };
        let align = |(hit, aligned): &mut (Hit, Aligned)| {
            budget.check()?;
            if !aligned.is_mechanical {
                return Ok(0);
            }
            let Some(other) = self.geometry(&self.index.entry(&hit.id)?) else { return Ok(1) };
            let gap = surface.noise_beside(&other);
            hit.order = gap.map(|surface_gap| OrderedBy::Surface { surface_gap });
            Ok(0)
        };
        let unread = nearest.par_iter_mut().take(SURFACES).map(align).sum::<Result<usize, Error>>()?;
        nearest.sort_by(|(a, _), (b, _)| a.surface_gap().total_cmp(&b.surface_gap()));
        nearest.iter_mut().zip(1..).for_each(|((hit, _), rank)| hit.rank = rank);
        Ok(unread)
    }

    /// Adds what the files and meshes of a query and a result tell. `aligned` has the alignment of their forms.
    fn explain(
        &self,
        asked: &Asked<'_>,
        hit: &mut Hit,
        aligned: &Aligned,
        budget: &Budget,
    ) -> Result<(), Error> {
        budget.check()?;
        let other = self.prepared(&hit.id)?;
        hit.comparison = Some(compare(&ShapePair::new([&asked.shape, &other]).with_best(aligned.alignment))?);
        hit.relation = self.related(asked.query, &self.index.entry(&hit.id)?, hit.relation.clone())?;
        Ok(())
    }

    /// The vectors of some shapes.
    fn table_of(&self, ids: &[String]) -> Result<VectorTable, IndexError> {
        let mut some = VectorTable::default();
        for id in ids {
            some.push(id, &self.index.shape(id)?.fused);
        }
        Ok(some)
    }

    /// The first shapes by [rank distance](graph_rank), among the nearest and their neighbors. The graph knows fused distances
    /// only, because aligning the forms of all pairs would take too long. Every list of neighbors is found when it is visited,
    /// at most about 600 of them. Up to [`LINKS`] results are the first of one another; more look farther around.
    fn on_graph(&self, fused: &[f32], wanted: usize) -> Result<Vec<OrderedShape>, Error> {
        let all = self.index.vector_table()?;
        let nearest = all.nearest(fused, wanted.max(LINKS));
        let links = |shape: usize| {
            let found = all.nearest(all.vector(shape), LINKS + 1).into_iter();
            found.filter(|near| near.index != shape).take(LINKS).collect()
        };
        let distance = |shape: usize| ShapeMetric::fused(fused, all.vector(shape));
        let mut ranked = graph_rank(usize::MAX, &nearest, links, distance);
        ranked.truncate(wanted);
        let ordered = ranked.into_iter().map(|found| {
            let place = nearest.iter().position(|near| near.index == found.index);
            let (rank_distance, plain_rank) = (found.rank_distance, place.map(|place| place + 1));
            (all.id(found.index).to_owned(), OrderedBy::Graph { rank_distance, plain_rank })
        });
        Ok(ordered.collect())
    }

    /// The first of all shapes or of some by a distance that is measured from each of them.
    fn by_all(
        &self,
        query: &Query,
        rank: SearchRank,
        ids: &Option<Vec<String>>,
        wanted: usize,
        budget: &Budget,
    ) -> Result<Vec<OrderedShape>, Error> {
        let one = |id: String| {
            budget.check()?;
            Ok((self.measured(query, rank, &id)?, id))
        };
        let ids = match ids {
            Some(ids) => ids.clone(),
            None => self.index.entries()?.into_iter().map(|entry| entry.id).collect(),
        };
        let mut found = ids.into_par_iter().map(one).collect::<Result<Vec<_>, Error>>()?;
        found.sort_by(|(a, x), (b, y)| a.distance().total_cmp(&b.distance()).then_with(|| x.cmp(y)));
        found.truncate(wanted);
        Ok(found.into_iter().map(|(order, id)| (id, order)).collect())
    }

    /// How well the query fits into a shape as a part, or how much their forms differ, in units of two poses of one body.
    ///
    /// # Errors
    /// [`IndexError::Damaged`] if what is measured is not stored of the shape.
    fn measured(&self, query: &Query, rank: SearchRank, id: &str) -> Result<OrderedBy, Error> {
        if rank == SearchRank::Part {
            let part = query.part.as_ref().ok_or_else(|| {
                Error::refused("ranking by part needs the mesh of the query; a description is not enough")
            })?;
            let areas = self.index.vector(id, "disc_areas")?;
            let areas = areas.and_then(|numbers| DiscAreas::from_numbers(&numbers));
            let areas = areas.ok_or_else(|| missing(&self.index.path, id, "disc areas"))?;
            let PartDistance { distance: part_distance, share: part_share } = part.distance(&areas);
            return Ok(OrderedBy::Part { part_distance, part_share });
        }
        let kind = SignatureKind::FormSpectrum;
        let own = query.shape.signatures.get(kind.name()).map_or(&[][..], Vec::as_slice);
        let found = self.index.vector(id, &format!("signature_{}", kind.name()))?;
        let what = format_args!("{} signature", kind.name());
        let found = found.ok_or_else(|| missing(&self.index.path, id, what))?;
        Ok(OrderedBy::Forms { form_distance: ShapeMetric::fused(own, &found) / ShapeMetric::unit(kind) })
    }

    /// Aligns the forms of candidates, in ascending order of lower bounds of their combined distances: of as many as are needed for
    /// the `wanted` nearest, or of all of them for their relations if something else decides on their order. `at` gives the name of
    /// a candidate, and what it is ordered by. Returns how many alignments were begun, too.
    fn aligned<'a>(
        &self,
        asked: &Asked<'_>,
        candidates: impl Iterator<Item = Neighbor>,
        wanted: usize,
        at: &(dyn Fn(usize) -> (&'a str, Option<OrderedBy>) + Sync),
        budget: &Budget,
    ) -> Result<(Vec<(Hit, Aligned)>, usize), Error> {
        let mut refined = rerank(&asked.shape, candidates, wanted, |i| {
            budget.check()?;
            self.prepared(at(i).0)
        })?;
        refined.nearest.sort_by_key(|(near, _)| at(near.index).1.map(|_| near.index));
        let found =
            refined.nearest.into_iter().zip(1..).map(|((Neighbor { index, distance }, found), rank)| {
                let (id, order) = at(index);
                let Entry { id, label, path, .. } = self.index.entry(id)?;
                let numbers = (found.shape_distance, found.scale);
                // Only what has the same description may be called the same part without its mesh.
                let are_parts = found.is_mechanical && !asked.shape.rigid.is_empty() && found.fused > 0.0;
                let relation = Hit::by_descriptions(numbers, are_parts, order, asked.classes);
                let relation = relation.named(&asked.query.name, &id);
                let (fused, itself) = (found.fused, asked.itself.as_ref() == Some(&id));
                let hit =
                    Hit { rank, id, label, itself, path, distance, fused, order, relation, comparison: None };
                Ok((hit, found))
            });
        Ok((found.collect::<Result<_, Error>>()?, refined.evaluated))
    }
}

/// The name of a shape and what it is ordered by.
type OrderedShape = (String, OrderedBy);

#[cfg(test)]
mod tests {
    use std::fs;

    use base::{ContentHash, SplitMix};
    use index::{IndexWriter, Shape};
    use mesh::{Surface, shapes};
    use nalgebra::{Point3, Vector3};
    use tempfile::TempDir;

    use super::*;
    use crate::error::Remedy;
    use crate::form::{EmbedMethod, FormOptions, describe};
    use crate::library::{BuildOptions, build_index};
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
            mesh_io::write(&folder.path().join(name), &mesh).unwrap();
        }
        let path = folder.path().join("all.canonform");
        build_index(folder.path(), &path, &BuildOptions::new(describe), &()).unwrap();
        let search = ShapeSearch::open(&path).unwrap();
        (folder, search)
    }

    fn search_for(search: &ShapeSearch, mesh: &TriMesh, options: &SearchOptions) -> Answer {
        search_as(search, mesh, ("the query", None), options)
    }

    fn search_as(
        search: &ShapeSearch,
        mesh: &TriMesh,
        name: (&str, Option<ContentHash>),
        options: &SearchOptions,
    ) -> Answer {
        search.search(&search.query(mesh, name, options, &()).unwrap(), options, &()).unwrap()
    }

    /// What is found for a shape of the index.
    fn search_by(search: &ShapeSearch, id: &str, options: &SearchOptions) -> Answer {
        search.search(&search.query_of(id, options, &()).unwrap(), options, &()).unwrap()
    }

    #[test]
    fn a_mesh_a_description_and_a_stored_shape_find_exactly_the_same() {
        let method = EmbedMethod::KernelPca { rank: None, bandwidth: Default::default() };
        let form = FormOptions { method, ..FormOptions::default() };
        let kernel = DescribeOptions { form, ..DescribeOptions::default() };
        for describe_options in [DescribeOptions::default(), kernel] {
            let (_folder, search) = indexed(&describe_options);
            assert_eq!(*search.describe_options(), describe_options);
            let options = SearchOptions { explain: true, ..SearchOptions::default() };
            let mesh = search.mesh("ring0").unwrap();
            let by_mesh = search_for(&search, &mesh, &options);
            let by_name = search_by(&search, "ring0", &options);
            let surface = Surface::new(&mesh, &describe_options.form.repair, &()).unwrap();
            let described = describe(&surface, &describe_options, &()).unwrap();
            let by_description =
                search.search(&Query::new(described.clone(), &describe_options), &options, &()).unwrap();
            assert!(by_mesh.results[0].id == "ring0" && by_mesh.results[0].distance < 1e-6);
            let numbers = |report: &Answer| {
                let numbers = |r: &Hit| (r.id.clone(), r.distance, r.fused, r.comparison.clone());
                report.results.iter().map(numbers).collect::<Vec<_>>()
            };
            assert_eq!(numbers(&by_mesh), numbers(&by_name));
            assert_eq!(numbers(&by_mesh), numbers(&by_description));
            // Of a description, only descriptions are compared.
            let kinds = [&by_mesh, &by_name, &by_description].map(|report| report.results[0].relation.kind);
            let expected =
                [RelationKind::IdenticalGeometry, RelationKind::IdenticalFile, RelationKind::OtherPose];
            assert_eq!(kinds, expected);
            // The comparison of the two shapes says the same.
            let query = describe_options.prepare(&described).unwrap();
            for result in &by_mesh.results {
                let other = search.prepared(&result.id).unwrap();
                let direct = compare(&ShapePair::new([&query, &other])).unwrap();
                assert_eq!(result.comparison.as_ref(), Some(&direct));
                assert_eq!(result.relation.evidence.distance, direct.shape_distance);
                assert_eq!(result.distance, direct.shape_distance.combined);
            }
        }
    }

    /// The number that results are ordered by, which ascends.
    fn order(answer: &Answer) -> Vec<f64> {
        let order: Vec<f64> = answer.results.iter().map(|hit| hit.order.unwrap().distance()).collect();
        assert!(order.len() == 4 && order.is_sorted(), "{order:?}");
        order
    }

    #[test]
    fn forms_alone_rank_every_shape_and_a_mirror_image_is_the_same() {
        let (_folder, search) = indexed(&DescribeOptions::default());
        let options = SearchOptions { rank_by: SearchRank::Forms, ..SearchOptions::default() };
        let by_name = search_by(&search, "ring0", &options);
        assert_eq!((by_name.rank_by, order(&by_name)[0]), (SearchRank::Forms, 0.0));
        assert_eq!([0, 1].map(|i| by_name.results[i].id.as_str()), ["ring0", "ring1"]);
        let mut mirrored = search.mesh("ring0").unwrap();
        mirrored.positions.iter_mut().for_each(|p| *p = Point3::new(-3.0 * p.x, 3.0 * p.y, 3.0 * p.z));
        let by_mesh = search_for(&search, &mirrored, &options);
        // Which of the points of a ring are taken is left to rounding, so it is less than two poses apart, but not zero.
        assert!(by_mesh.results[0].id == "ring0" && order(&by_mesh)[0] < 0.8, "{by_mesh:?}");
    }

    #[test]
    fn the_graph_ranks_the_same_shapes_in_its_own_order() {
        let (_folder, search) = indexed(&DescribeOptions::default());
        let plain = search_by(&search, "ring0", &SearchOptions::default());
        let options = SearchOptions { rank_by: SearchRank::Graph, ..SearchOptions::default() };
        let graph = search_by(&search, "ring0", &options);
        order(&graph);
        assert_eq!((plain.rank_by, graph.rank_by), (SearchRank::Plain, SearchRank::Graph));
        assert!(matches!(graph.results[0].order, Some(OrderedBy::Graph { plain_rank: Some(1), .. })));
        for found in &graph.results {
            let same = plain.results.iter().find(|other| other.id == found.id).unwrap();
            assert_eq!(Hit { rank: same.rank, order: None, ..found.clone() }, *same);
        }
        let [plain, graph] = [plain, graph].map(|answer| serde_json::to_value(answer).unwrap());
        assert_eq!((&graph["rank_by"], &graph["results"][0]["plain_rank"]), (&"graph".into(), &1.into()));
        assert!(graph["results"][0]["rank_distance"].is_number());
        assert!(plain["results"][0].get("rank_distance").is_none());
    }

    #[test]
    fn a_part_finds_its_whole_and_needs_a_mesh() {
        let (folder, search) = indexed(&DescribeOptions::default());
        let options = SearchOptions { rank_by: SearchRank::Part, ..SearchOptions::default() };
        let mut part = search.mesh("ring1").unwrap();
        let TriMesh { positions, faces } = &mut part;
        faces.retain(|face| face.iter().all(|v| positions[v.index()].x < 1.0));
        let found = search_for(&search, &part, &options);
        order(&found);
        assert_eq!((found.rank_by, found.results[0].id.as_str()), (options.rank_by, "ring1"));
        let share = |found: &Answer| match found.results[0].order {
            Some(OrderedBy::Part { part_share, .. }) => part_share,
            other => panic!("{other:?}"),
        };
        assert!((0.5..0.9).contains(&share(&found)), "{}", share(&found));
        let json = serde_json::to_value(&found).unwrap();
        assert!(json["rank_by"] == "part" && json["results"][0]["part_distance"].is_number());
        // As a whole, it is another shape.
        let plain = search_for(&search, &part, &SearchOptions::default());
        assert!(plain.results[0].relation.evidence.distance.same_class() < 0.5);
        // A shape of the index is read again, and a description is not enough.
        let itself = search_by(&search, "box0", &options);
        assert!(itself.results[0].id == "box0" && share(&itself) == 1.0);
        fs::remove_file(folder.path().join("box0.tri")).unwrap();
        assert!(matches!(search.query_of("box0", &options, &()), Err(Error::MeshGone { .. })));
        let query = search.query(&part, ("", None), &SearchOptions::default(), &()).unwrap();
        let fault = search.search(&query, &options, &()).unwrap_err().to_string();
        assert!(fault.contains("needs the mesh of the query"), "{fault}");
    }

    #[test]
    fn an_index_without_disc_areas_is_named_with_its_remedy() {
        let (folder, search) = indexed(&DescribeOptions::default());
        let path = folder.path().join("old.canonform");
        let mut writer = IndexWriter::build(&path, &search.index().options).unwrap();
        let shape = Shape { disc_areas: Vec::new(), ..search.index().shape("ball0").unwrap() };
        writer.put(&[shape]).unwrap();
        writer.finish().unwrap();
        let old = ShapeSearch::open(&path).unwrap();
        let options = SearchOptions { rank_by: SearchRank::Part, ..SearchOptions::default() };
        let query = old.query_of("ball0", &options, &()).unwrap();
        let fault = old.search(&query, &options, &()).unwrap_err();
        assert!(fault.to_string().contains("has no disc areas"), "{fault}");
        assert_eq!(fault.remedy(), Some(Remedy::BuildIndexAgain));
    }

    #[test]
    fn unknown_names_and_descriptions_of_other_options_are_refused() {
        let (_folder, search) = indexed(&DescribeOptions::default());
        let options = SearchOptions { k: usize::MAX, ..SearchOptions::default() };
        let other = DescribeOptions { points: 500, ..DescribeOptions::default() };
        let query = Query { options: other.text(), ..search.query_of("box0", &options, &()).unwrap() };
        let fault = search.search(&query, &options, &()).unwrap_err();
        assert!(matches!(fault, Error::Index(IndexError::OtherOptions { .. })));
        assert!(fault.to_string().contains("\"points\":500"), "{fault}");
        assert!(matches!(search.query_of("none", &options, &()), Err(Error::Index(_))));
        // More results than shapes are all shapes.
        assert_eq!(search_by(&search, "box0", &options).results.len(), 4);
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
        let options = SearchOptions { explain: true, ..SearchOptions::default() };
        let mut ring = search.mesh("ring0").unwrap();
        ring.positions.iter_mut().for_each(|p| *p /= 25.4);
        let nearest = || search_for(&search, &ring, &options).results[0].clone();
        let found = nearest().relation;
        assert_eq!((found.kind, found.evidence.basis), (RelationKind::Scaled, Basis::Meshes));
        assert_eq!(found.to_string(), "ring0 is the query scaled by 25.4 (inches to millimetres)");
        fs::remove_file(folder.path().join("ring0.off")).unwrap();
        let found = nearest().relation;
        assert_eq!((found.kind, found.evidence.basis), (RelationKind::OtherPose, Basis::Descriptions));
        assert!(found.reason().ends_with("the mesh was not compared"), "{}", found.reason());
        let by_name = search_by(&search, "ring0", &options);
        assert_eq!(by_name.results[0].relation.kind, RelationKind::IdenticalFile);
    }

    #[test]
    fn the_surface_of_a_query_with_noise_comes_first_if_its_file_is_read() {
        let (folder, search) = indexed(&DescribeOptions::default());
        let (mut noisy, mut random) = (search.mesh("box0").unwrap(), SplitMix(5));
        let mut shift = || 0.002 * random.uniform();
        noisy.positions.iter_mut().for_each(|p| *p += Vector3::from_fn(|_, _| shift()));
        let nearest = |mesh: &TriMesh| {
            let answer = search_for(&search, mesh, &SearchOptions { k: 1, ..SearchOptions::default() });
            let Hit { id, order, .. } = answer.results[0].clone();
            (id, order.map(|order| order.distance() < 0.002), answer.unread)
        };
        assert_eq!(nearest(&noisy), ("box0".to_owned(), Some(true), 0));
        assert_eq!(nearest(&search.mesh("box0").unwrap()), ("box0".to_owned(), None, 0));
        fs::remove_file(folder.path().join("box0.tri")).unwrap();
        assert_eq!(nearest(&noisy), ("box0".to_owned(), None, 1));
    }

    #[test]
    fn the_file_of_a_query_and_copies_on_a_plate_are_recognized() {
        let (folder, search) = indexed(&DescribeOptions::default());
        let options = SearchOptions { explain: true, ..SearchOptions::default() };
        let path = folder.path().join("ring1.off");
        let content = crate::collection::content_hash(&path).unwrap();
        let ring = mesh_io::read(&path).unwrap();
        let explained = |mesh: &TriMesh, name: &str, content| {
            search_as(&search, mesh, (name, content), &options).results[0].relation.to_string()
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
        let report = search_as(&search, &plate, ("plate.stl", None), &options);
        let about = |part: &ComponentResult| {
            let nearest = part.nearest.as_ref().unwrap();
            (part.copies, nearest.id.clone(), nearest.relation.kind)
        };
        let found: Vec<_> = report.components.iter().map(about).collect();
        let expected = [
            (1, "ring0".to_owned(), RelationKind::Scaled),
            (2, "ball0".to_owned(), RelationKind::IdenticalGeometry),
        ];
        assert_eq!(found, expected);
        assert!(search_as(&search, &plate, ("", None), &SearchOptions::default()).components.is_empty());
        // The ball is a component of the plate, but not the largest.
        mesh_io::write(&folder.path().join("plate7.off"), &plate).unwrap();
        let path = folder.path().join("all.canonform");
        build_index(folder.path(), &path, &BuildOptions::new(search.describe_options()), &()).unwrap();
        let again = ShapeSearch::open(&path).unwrap();
        let words = || {
            search_by(&again, "ball0", &options)
                .wholes
                .into_iter()
                .map(|hit| hit.relation.to_string())
                .collect::<Vec<_>>()
        };
        assert_eq!(words(), ["plate7 has two copies of ball0 among its three components"]);
        fs::remove_file(folder.path().join("plate7.off")).unwrap();
        assert_eq!(
            words(),
            ["ball0 is part of plate7, one of its three components, in this or another pose"]
        );
        assert!(search_by(&again, "box0", &options).wholes.is_empty());
    }
}
