//! Searching several indexes as one: a packed query goes to each, and names, distances and relations come back.
//!
//! ```text
//! PackedQuery -> shortlist of every shard -> for the best of all: match_shapes -> merge_matches -> SearchReport
//!             -> for the results, if they are explained: explain_matches
//! ```

use base::{ContentHash, Observer};
use descriptors::{CanonicalForm, PartDiscAreas, PreparedShape, SignatureKind};
use mesh::TriMesh;
use nalgebra::Point3;
use rayon::prelude::*;
use relations::MeshGeometry;
use serde::{Deserialize, Serialize};
use surface::VertexId;

use super::explain::components;
use super::found::{ComponentResult, SearchResult, ShardMatch};
use super::options::{Explain, SearchOptions, SearchRank};
use super::predict::Completeness;
use super::query::{KnownQuery, Query};
use super::record::AREA;
use super::rerank::bounds;
use super::search::{SearchReport, ShapeSearch, ShardedSearch, Shortlist, n_wanted};
use crate::error::Error;
use crate::form::{DescribeOptions, ShapeDescription};

/// A described query that can be sent to other processes: what comparing it with other shapes needs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PackedQuery {
    /// What it is called in words.
    pub name: String,
    /// Its fused vector.
    pub fused: Vec<f32>,
    /// Its rigid signature, if it has one.
    rigid: Vec<f32>,
    /// The [hash](crate::content_hash) of its file.
    pub content: Option<ContentHash>,
    /// The spectrum of its form, which results by forms alone are ordered by.
    form_spectrum: Vec<f32>,
    /// What its fit as a part is measured by, if results are ordered by it.
    pub part: Option<PartDiscAreas>,
    /// The options it was described with, as indexes state them.
    options: String,
    points: Vec<[f64; 3]>,
    weights: Vec<f64>,
    area: Option<f64>,
    form_area: Option<f64>,
    complete: Completeness,
    mesh: Option<PackedMesh>,
    /// Which of the different components of the mesh it is, if it is not the whole.
    component: Option<usize>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct PackedMesh {
    positions: Vec<[f64; 3]>,
    faces: Vec<[VertexId; 3]>,
}

impl PackedQuery {
    /// Packs a description.
    #[must_use]
    pub fn of(description: &ShapeDescription, name: &str) -> Self {
        let ShapeDescription { options, form, fused, area, .. } = description;
        let complete = Completeness::of(description);
        let form_spectrum = description.form_spectrum();
        let rigid = description.rounded(SignatureKind::Rigid);
        let packed = Self::of_form(form, (name, fused, &options.text()), Some(*area), complete);
        Self { form_spectrum, rigid, ..packed }
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
            rigid: Vec::new(),
            content: None,
            form_spectrum: Vec::new(),
            part: None,
            options: options.to_owned(),
            points: form.points().iter().map(|p| (*p).into()).collect(),
            weights: form.weights().to_vec(),
            area,
            form_area: form.area(),
            complete,
            mesh: None,
            component: None,
        }
    }

    /// Adds the mesh, by which results are explained.
    #[must_use]
    pub fn with_mesh(self, mesh: &TriMesh) -> Self {
        let positions = mesh.positions.iter().map(|p| (*p).into()).collect();
        Self { mesh: Some(PackedMesh { positions, faces: mesh.faces.clone() }), ..self }
    }

    /// The mesh of the whole in space.
    fn geometry(&self) -> Option<MeshGeometry> {
        let PackedMesh { positions, faces } = self.mesh.as_ref()?;
        let positions = positions.iter().map(|p| Point3::from(*p)).collect();
        MeshGeometry::new(&TriMesh { positions, faces: faces.clone() }, self.content)
    }

    fn known<'a>(&'a self, whole: Option<&'a MeshGeometry>) -> Result<KnownQuery<'a>, Error> {
        let points = self.points.iter().map(|p| Point3::from(*p)).collect();
        let form = CanonicalForm::from_parts(points, self.weights.clone(), self.form_area)?;
        let geometry = whole.map(|whole| match self.component {
            Some(i) => whole.different_components()[i].0,
            None => whole,
        });
        Ok(KnownQuery {
            shape: PreparedShape::new(self.fused.clone(), &form, self.area)?.with_rigid(self.rigid.clone()),
            form_spectrum: self.form_spectrum.clone(),
            name: &self.name,
            content: self.content.filter(|_| self.component.is_none()),
            geometry,
            part: self.part.clone(),
            complete: self.complete,
        })
    }

    /// The different components of a query that comes with its mesh, as queries of their own. Results are to be found for each.
    ///
    /// # Errors
    /// [`Error::Exceeded`].
    pub fn components(&self, observer: &dyn Observer) -> Result<Vec<(ComponentResult, Self)>, Error> {
        let Some(options) = DescribeOptions::from_text(&self.options) else { return Ok(Vec::new()) };
        let Some(whole) = self.geometry() else { return Ok(Vec::new()) };
        let parts = components(&whole, &self.name, &options, &observer.budget())?;
        let packed = parts.into_iter().map(|part| {
            let complete = Completeness::default();
            let query = Self { complete, ..Self::of(&part.description, &part.name) };
            let (content, mesh, component) = (self.content, self.mesh.clone(), Some(part.place));
            (part.found, Self { content, mesh, component, ..query })
        });
        Ok(packed.collect())
    }

    /// How many shapes with the nearest fused vectors are candidates for `k` results, where only vectors are searched, and how
    /// many results each shard gives.
    #[must_use]
    pub fn shortlist(k: usize, n_shapes: usize) -> [usize; 2] {
        let wanted = n_wanted(k, n_shapes);
        [CANDIDATES.saturating_mul(wanted).max(LEAST_CANDIDATES), wanted]
    }
}

/// Candidates for each result, and for any number of results.
const CANDIDATES: usize = 4;
const LEAST_CANDIDATES: usize = 40;

/// What a shard found among its candidates.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ShardMatches {
    /// The best, in the order of results.
    pub nearest: Vec<ShardMatch>,
    /// Shapes whose alignment was begun.
    pub aligned: usize,
}

/// What a shard knows about results.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShardExplained {
    /// The results, with their relations by files and meshes. Ranks are 0.
    pub results: Vec<SearchResult>,
    /// As in [`SearchReport::wholes`], for the shapes of this shard.
    pub wholes: Vec<SearchResult>,
}

impl ShapeSearch {
    /// Packs a shape of the index as a query. Its mesh is read as for [`Query::Id`].
    ///
    /// # Errors
    /// As of [`ShapeSearch::search`].
    pub fn pack(
        &self,
        id: &str,
        options: &SearchOptions,
        observer: &dyn Observer,
    ) -> Result<PackedQuery, Error> {
        let unexplained = SearchOptions { explain: Explain::No, ..options.clone() };
        let KnownQuery { shape, form_spectrum, content, part, complete, .. } =
            self.resolved(Query::Id(id), &unexplained, &mut None, observer)?;
        let about = (id, shape.fused(), self.index().options());
        let area = self.index().entry(id)?.fact(AREA);
        let packed = PackedQuery {
            form_spectrum,
            rigid: shape.rigid().to_vec(),
            content,
            part,
            ..PackedQuery::of_form(shape.form(), about, area, complete)
        };
        let mesh = (options.explain == Explain::Kind).then(|| self.mesh(id).ok()).flatten();
        Ok(if let Some(mesh) = mesh { packed.with_mesh(&mesh) } else { packed })
    }

    /// The first `n` shapes of this index in some order, and the distances that they are ordered by: combined distances, or as
    /// a part, or of forms alone. A graph of several indexes does not exist, so it stands for combined distances.
    ///
    /// # Errors
    /// As of [`ShapeSearch::search`].
    pub fn shortlist(
        &self,
        query: &PackedQuery,
        rank_by: SearchRank,
        n: usize,
        observer: &dyn Observer,
    ) -> Result<Vec<(f64, String)>, Error> {
        self.index().expect_options(&query.options)?;
        let (known, budget) = (query.known(None)?, observer.budget());
        if matches!(rank_by, SearchRank::Plain | SearchRank::Graph) {
            let (found, _) = self.aligned(&known.shape, self.by_distance(&known)?, n, &budget)?;
            return Ok(found.into_iter().map(|(near, _)| (near.distance, near.id)).collect());
        }
        let shapes = self.by_all(&known, rank_by, self.ids()?, n, &budget)?;
        Ok(shapes.into_iter().map(|(id, order)| (order.distance(), id)).collect())
    }

    /// The `wanted` best of some shapes of this index. Names that the index does not hold are left out: their shapes were removed
    /// meanwhile.
    ///
    /// # Errors
    /// As of [`ShapeSearch::search`].
    pub fn match_shapes(
        &self,
        query: &PackedQuery,
        ids: &[String],
        rank_by: SearchRank,
        wanted: usize,
        observer: &dyn Observer,
    ) -> Result<ShardMatches, Error> {
        self.index().expect_options(&query.options)?;
        let mut held = Vec::with_capacity(ids.len());
        for id in ids {
            if self.index().contains(id)? {
                held.push(id.clone());
            }
        }
        let (known, budget) = (query.known(None)?, observer.budget());
        let shortlist = match rank_by {
            SearchRank::Plain | SearchRank::Graph => {
                let fused = held.iter().map(|id| Ok(self.index().vectors(id)?.fused));
                let fused = fused.collect::<Result<Vec<_>, Error>>()?;
                let candidates = bounds(known.shape.fused(), held.len(), |i| &fused[i]);
                Shortlist { candidates, id: Box::new(move |i| held[i].clone()), orders: None }
            }
            _ => Shortlist::ordered(self.by_all(&known, rank_by, held, wanted, &budget)?),
        };
        let (found, aligned) = self.aligned(&known.shape, shortlist, wanted, &budget)?;
        Ok(ShardMatches { nearest: found.into_iter().map(|(found, _)| found).collect(), aligned })
    }

    /// What the files and meshes of this index tell about results, and of which shapes the query is a component.
    ///
    /// # Errors
    /// As of [`ShapeSearch::search`].
    pub fn explain_matches(
        &self,
        query: &PackedQuery,
        matches: Vec<ShardMatch>,
        observer: &dyn Observer,
    ) -> Result<ShardExplained, Error> {
        let (whole, budget) = (query.geometry(), observer.budget());
        let known = query.known(whole.as_ref())?;
        let explained = |found: ShardMatch| {
            let mut result = found.into_result(0, known.name);
            self.explain(&known, &mut result, None, &budget)?;
            Ok(result)
        };
        let results = matches.into_par_iter().map(explained).collect::<Result<_, Error>>()?;
        let wholes = match query.component {
            Some(_) => Vec::new(),
            None => self.search_wholes(&known, &budget)?,
        };
        Ok(ShardExplained { results, wholes })
    }
}

/// The answer to a search in shards: the `k` best of what they found, and the class.
///
/// It is the answer of one index with the shapes of all shards, if every shard matched the first of its shortlist.
#[must_use]
pub fn merge_matches(
    query: &PackedQuery,
    shards: Vec<ShardMatches>,
    search: ShardedSearch,
    k: usize,
) -> SearchReport {
    let aligned = shards.iter().map(|found| found.aligned).sum();
    let mut nearest: Vec<ShardMatch> = shards.into_iter().flat_map(|found| found.nearest).collect();
    nearest.sort_by(ShardMatch::cmp);
    nearest.truncate(n_wanted(k, search.n_shapes));
    SearchReport { aligned, ..SearchReport::of((&query.name, query.complete), nearest, search, k) }
}

#[cfg(test)]
mod tests {
    use index::{Index, class_threshold};
    use mesh::shapes;

    use super::super::build::{BuildOptions, build_index};
    use super::super::source::Shard;
    use super::*;
    use crate::form::describe;

    /// The answer of some shards, all of which are asked for candidates.
    fn asked(shards: &[ShapeSearch], query: &PackedQuery, rank_by: SearchRank, k: usize) -> SearchReport {
        let n_shapes = shards.iter().map(|shard| shard.index().len()).sum();
        let [_, wanted] = PackedQuery::shortlist(k, n_shapes);
        let mut near = Vec::new();
        for (place, shard) in shards.iter().enumerate() {
            let found = shard.shortlist(query, rank_by, wanted, &()).unwrap();
            near.extend(found.into_iter().map(|(distance, id)| (distance, id, place)));
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        near.truncate(wanted);
        let matches = shards.iter().enumerate().map(|(place, shard)| {
            let of = near.iter().filter(|near| near.2 == place).map(|near| near.1.clone());
            // A name that the shard does not hold is left out.
            let ids: Vec<String> = of.chain(["gone".to_owned()]).collect();
            let found = shard.match_shapes(query, &ids, rank_by, wanted, &()).unwrap();
            serde_json::from_str(&serde_json::to_string(&found).unwrap()).unwrap()
        });
        let matches = matches.collect();
        let indexes: Vec<Index> = shards.iter().map(|s| Index::open(s.index().path()).unwrap()).collect();
        let threshold = class_threshold(&indexes).unwrap().filter(|_| rank_by == SearchRank::Plain);
        let search = ShardedSearch { rank_by, n_shapes, measured: n_shapes, recall: 1.0, threshold };
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
            (Query::Id("ring1"), whole.pack("ring1", &SearchOptions::default(), &()).unwrap()),
        ];
        for (query, packed) in queries {
            let sent: PackedQuery = serde_json::from_str(&serde_json::to_string(&packed).unwrap()).unwrap();
            assert_eq!(sent, packed);
            for (k, rank_by) in [
                (0, SearchRank::Plain),
                (2, SearchRank::Plain),
                (10, SearchRank::Plain),
                (2, SearchRank::Forms),
            ] {
                let options = SearchOptions { k, rank_by, ..Default::default() };
                let expected = whole.search(query, &options, &()).unwrap();
                let found = asked(&shards, &sent, rank_by, k);
                let (aligned, seconds) = (expected.aligned, expected.seconds);
                assert_eq!(SearchReport { aligned, seconds, ..found }, expected);
            }
        }
    }
}
