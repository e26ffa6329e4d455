//! Searching an index for the shapes nearest to a mesh.

use std::path::Path;
use std::time::Instant;

use descriptors::{CanonicalForm, MatchOptions};
use index::{Index, SearchMode, ShapeEntry, ShapeVectors};
use mesh::TriMesh;
use rayon::prelude::*;
use retrieval::{Candidate, vote};
use serde::Serialize;

use super::record::{form, options_of};
use super::source::read_unchanged;
use crate::Error;
use crate::compare::{Comparison, ShapeDistance, compare_forms, prepare_form, rerank};
use crate::form::{DescribeOptions, ShapeDescription, describe};
use crate::input::Surface;

/// Neighbours that vote on the class of a query.
const VOTERS: usize = 5;

/// Shapes whose forms may be aligned, for every one that is wanted, and at least.
const CANDIDATES: usize = 4;
const LEAST_CANDIDATES: usize = 40;

/// How an index is asked.
#[derive(Debug, Clone, PartialEq)]
pub struct SearchOptions {
    /// Shapes wanted. Default: 10.
    pub k: usize,
    /// How carefully signatures are searched. Default: [`SearchMode::Auto`].
    pub mode: SearchMode,
    /// Whether every shape found is told apart from the query: resized, mirrored, different. Default: no.
    pub explain: Explain,
    /// How forms are aligned.
    pub matching: MatchOptions,
}

/// Whether matches are explained.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Explain {
    /// No.
    #[default]
    No,
    /// What kind of match each is.
    Kind,
}

impl Default for SearchOptions {
    fn default() -> Self {
        Self { k: 10, mode: SearchMode::Auto, explain: Explain::No, matching: MatchOptions::default() }
    }
}

/// A shape that was found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchResult {
    /// From 1 on.
    pub rank: usize,
    /// Its name.
    pub id: String,
    /// Its class.
    pub label: String,
    /// Where it came from.
    pub path: String,
    /// How far it is, by signatures and aligned forms; the order of the results.
    pub distance: f64,
    /// How far it is by fused signatures alone.
    pub fused: f64,
    /// What kind of match it is, when asked for.
    #[serde(rename = "match", skip_serializing_if = "Option::is_none")]
    pub comparison: Option<Comparison>,
}

/// The class that the nearest shapes suggest.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prediction {
    /// The class; `None` when nothing is near.
    pub label: Option<String>,
    /// Neighbours of that class.
    pub votes: usize,
    /// Neighbours that are near enough to vote.
    pub voters: usize,
    /// Share of the votes that the class has, nearer neighbours counting more, 0 to 1.
    pub confidence: f64,
    /// Distance of fused signatures beyond which nothing is near; `None` when the classes of the index are
    /// too small to tell.
    pub threshold: Option<f64>,
}

/// What an index says to a mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SearchReport {
    /// Nearest first.
    pub results: Vec<SearchResult>,
    /// The class.
    pub predicted: Prediction,
    /// Shapes of the index.
    pub n_shapes: usize,
    /// Shapes whose signatures were measured.
    pub measured: usize,
    /// Shapes whose forms were aligned, or begun to be.
    pub aligned: usize,
    /// Share of the ten nearest signatures that searches in this index find: 1 when it is exact.
    pub recall: f64,
    /// Wall-clock seconds.
    pub seconds: SearchSeconds,
}

/// Where the time of a search went.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SearchSeconds {
    /// Repair, distances, form and signatures of the query.
    pub describe: f64,
    /// Finding, aligning and voting.
    pub search: f64,
}

/// An index that is asked.
#[derive(Debug)]
pub struct ShapeSearch {
    index: Index,
    describe: DescribeOptions,
}

impl ShapeSearch {
    /// # Errors
    /// [`Error::Index`], [`Error::UnknownOptions`].
    pub fn open(path: &Path) -> Result<Self, Error> {
        let index = Index::open(path)?;
        let describe = options_of(&index)?;
        Ok(Self { index, describe })
    }

    /// How its shapes were described, and queries are.
    #[must_use]
    pub fn describe_options(&self) -> &DescribeOptions {
        &self.describe
    }

    /// All names with what is known of them, ascending.
    ///
    /// # Errors
    /// [`Error::Index`].
    pub fn entries(&self) -> Result<Vec<(String, ShapeEntry)>, Error> {
        Ok(self.index.entries()?)
    }

    /// What is known of a shape.
    ///
    /// # Errors
    /// [`Error::Index`].
    pub fn entry(&self, id: &str) -> Result<ShapeEntry, Error> {
        Ok(self.index.entry(id)?)
    }

    /// The form of a shape as the index keeps it, at some points.
    ///
    /// # Errors
    /// [`Error::Index`].
    pub fn form(&self, id: &str) -> Result<CanonicalForm, Error> {
        let (entry, vectors) = self.shape(id)?;
        form(&entry, &vectors, &self.describe)
    }

    /// The fused signature and the form of a shape: what tells it from others, see
    /// [`ShapeDistance::of`].
    ///
    /// # Errors
    /// [`Error::Index`].
    pub fn description(&self, id: &str) -> Result<(Vec<f32>, CanonicalForm), Error> {
        let (entry, vectors) = self.shape(id)?;
        let form = form(&entry, &vectors, &self.describe)?;
        Ok((vectors.fused, form))
    }

    /// The mesh of a shape, read again from where it was when it was indexed.
    ///
    /// # Errors
    /// [`Error::MeshGone`] and [`Error::MeshChanged`] unless it is still the same;
    /// [`Error::Index`], [`Error::Mesh`].
    pub fn mesh(&self, id: &str) -> Result<TriMesh, Error> {
        read_unchanged(id, &self.index.entry(id)?)
    }

    /// The shapes of the index that are nearest to a mesh: by fused signatures, then by aligned forms.
    ///
    /// # Errors
    /// [`Error::Index`], and those of describing the mesh.
    pub fn search(&self, mesh: &TriMesh, options: &SearchOptions) -> Result<SearchReport, Error> {
        let start = Instant::now();
        let query = describe(&Surface::new(mesh, &self.describe.form.repair)?, &self.describe)?;
        let describe = start.elapsed().as_secs_f64();
        let report = self.search_described(&query, options)?;
        Ok(SearchReport { seconds: SearchSeconds { describe, ..report.seconds }, ..report })
    }

    /// As [`search`](Self::search), with a mesh that was described with
    /// [`describe_options`](Self::describe_options).
    ///
    /// # Errors
    /// [`Error::Index`].
    pub fn search_described(
        &self,
        query: &ShapeDescription,
        options: &SearchOptions,
    ) -> Result<SearchReport, Error> {
        self.nearest(&query.fused, &query.form, options)
    }

    /// As [`search`](Self::search), with a shape of the index; its mesh is not needed. It finds itself.
    ///
    /// # Errors
    /// [`Error::Index`].
    pub fn search_shape(&self, id: &str, options: &SearchOptions) -> Result<SearchReport, Error> {
        let (entry, vectors) = self.shape(id)?;
        self.nearest(&vectors.fused, &form(&entry, &vectors, &self.describe)?, options)
    }

    fn nearest(
        &self,
        fused: &[f32],
        query: &CanonicalForm,
        options: &SearchOptions,
    ) -> Result<SearchReport, Error> {
        let start = Instant::now();
        let wanted = options.k.max(VOTERS);
        let asked = (CANDIDATES * wanted).max(LEAST_CANDIDATES);
        let found = self.index.nearest(fused, asked, options.mode)?;
        let near = &found.shapes;
        let candidates =
            near.iter().enumerate().map(|(index, near)| Candidate { index, bound: near.distance });
        let form_of = |i: usize| {
            let (entry, vectors) = self.shape(&near[i].id)?;
            prepare_form(&form(&entry, &vectors, &self.describe)?)
        };
        let refined = rerank(&prepare_form(query)?, candidates, wanted, &options.matching, form_of)?;

        let mut results = Vec::with_capacity(wanted);
        for (place, neighbor) in refined.nearest.iter().enumerate() {
            let near = &near[neighbor.index];
            let entry = self.index.entry(&near.id)?;
            results.push(SearchResult {
                rank: place + 1,
                id: near.id.clone(),
                label: entry.label,
                path: entry.path,
                distance: neighbor.distance,
                fused: near.distance,
                comparison: None,
            });
        }
        let predicted = predicted(&results, found.threshold);
        results.truncate(options.k);
        if options.explain == Explain::Kind {
            results.par_iter_mut().try_for_each(|result| {
                let (entry, vectors) = self.shape(&result.id)?;
                let comparison =
                    compare_forms(query, &form(&entry, &vectors, &self.describe)?, &options.matching)?;
                let distance = ShapeDistance::new([fused, &vectors.fused], comparison.normalized_distance);
                result.comparison = Some(comparison.decided_by(distance));
                Ok::<_, Error>(())
            })?;
        }
        Ok(SearchReport {
            results,
            predicted,
            n_shapes: found.n_shapes,
            measured: found.n_measured,
            aligned: refined.asked,
            recall: found.recall,
            seconds: SearchSeconds { describe: 0.0, search: start.elapsed().as_secs_f64() },
        })
    }

    fn shape(&self, id: &str) -> Result<(ShapeEntry, ShapeVectors), Error> {
        Ok((self.index.entry(id)?, self.index.vectors(id)?))
    }
}

/// The vote of the first results. Who comes first was decided by forms as well; how near is near enough is
/// known for fused signatures.
fn predicted(results: &[SearchResult], threshold: Option<retrieval::UnknownThreshold>) -> Prediction {
    let mut classes: Vec<&str> = results.iter().map(|result| result.label.as_str()).collect();
    classes.sort_unstable();
    classes.dedup();
    let class_of = |i: usize| classes.partition_point(|class| *class < results[i].label.as_str());
    let neighbors: Vec<_> = results
        .iter()
        .enumerate()
        .map(|(index, result)| retrieval::Neighbor { index, distance: result.fused })
        .collect();
    let vote = vote(&neighbors, class_of, VOTERS, threshold);
    Prediction {
        label: vote.class.map(|class| classes[class].to_owned()),
        votes: vote.votes,
        voters: vote.voters,
        confidence: vote.confidence,
        threshold: threshold.map(|threshold| threshold.distance),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use mesh::shapes;
    use tempfile::TempDir;

    use super::*;
    use crate::{BuildOptions, Remedy, Surface, build_index, describe};

    /// An index of a few bodies.
    fn indexed() -> (TempDir, ShapeSearch) {
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
        let options = BuildOptions { describe: &DescribeOptions::default(), labels: None, shard: None };
        build_index(folder.path(), &path, &options, &()).unwrap();
        let search = ShapeSearch::open(&path).unwrap();
        (folder, search)
    }

    #[test]
    fn a_shape_finds_what_its_mesh_finds() {
        let (_folder, search) = indexed();
        let options = SearchOptions { explain: Explain::Kind, ..SearchOptions::default() };
        let mesh = search.mesh("ring0").unwrap();
        let by_mesh = search.search(&mesh, &options).unwrap();
        let by_name = search.search_shape("ring0", &options).unwrap();
        let surface = Surface::new(&mesh, &search.describe_options().form.repair).unwrap();
        let described = describe(&surface, search.describe_options()).unwrap();
        let by_description = search.search_described(&described, &options).unwrap();
        let found = |report: &SearchReport| -> Vec<_> {
            report.results.iter().map(|r| (r.id.clone(), (r.distance * 1e4).round())).collect()
        };
        assert_eq!(found(&by_mesh)[0], ("ring0".to_owned(), 0.0));
        assert_eq!(found(&by_mesh), found(&by_name));
        assert_eq!(found(&by_mesh), found(&by_description));
        assert_eq!(search.form("ring0").unwrap().points().len(), described.form.points().len());
        assert!(matches!(search.search_shape("none", &options), Err(Error::Index(_))));
        let names: Vec<String> = search.entries().unwrap().into_iter().map(|(id, _)| id).collect();
        assert_eq!(names, ["ball0", "box0", "ring0", "ring1"]);
        assert_eq!(search.entry("box0").unwrap().label, "box");
    }

    #[test]
    fn a_mesh_that_is_gone_or_another_is_told_from_the_one_that_was_indexed() {
        let (folder, search) = indexed();
        assert_eq!(search.mesh("box0").unwrap(), shapes::cube(3));
        fs::copy(folder.path().join("ring1.off"), folder.path().join("ring0.off")).unwrap();
        fs::remove_file(folder.path().join("box0.tri")).unwrap();
        let changed = search.mesh("ring0").unwrap_err();
        assert!(matches!(&changed, Error::MeshChanged { id, .. } if id == "ring0"));
        assert_eq!(changed.remedy(), Some(Remedy::RestoreMesh));
        let gone = search.mesh("box0").unwrap_err();
        assert!(matches!(&gone, Error::MeshGone { id, .. } if id == "box0"));
        assert!(gone.to_string().contains("box0.vert"), "{gone}");
        search.form("box0").unwrap();
    }
}
