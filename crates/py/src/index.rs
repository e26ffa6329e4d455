//! Indexes of shape collections.

use std::collections::HashSet;
use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

use base::object;
use canonform::collection::{LabelSource, ShapeFile, content_hash};
use canonform::index::{Entry, ExportFormat, FORMAT_VERSION, IndexError};
use canonform::library::{
    Agreement, BuildOptions, DuplicateOptions, EvaluateOptions, Inputs, Shard, add_to_index, build_index,
    evaluate_index, export_index, find_duplicates, indexed_shapes, mesh_path, remove_from_index,
    unchanged_index,
};
use canonform::linalg::DistanceMatrix;
use canonform::mesh::RepairOptions;
use canonform::retrieval::{Labels, evaluate};
use canonform::search::{Answer, Query, SearchOptions, ShapeSearch};
use canonform::{DescribeOptions, Error, Observer};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;
use serde::de::DeserializeOwned;

use crate::arrays::{Rows, Vector, of_matrix};
use crate::error::{Exception, raised, with_remedy};
use crate::record::json;
use crate::run::run;
use crate::settings::{Settings, chosen, measure};
use crate::surface::Surface;

/// An index that is open for searches.
#[pyclass(frozen, module = "canonform._canonform")]
pub(crate) struct Index {
    path: PathBuf,
    search: ShapeSearch,
}

/// What a mesh is, or which shape of the index.
#[derive(FromPyObject)]
enum Wanted<'py> {
    Surface(Bound<'py, Surface>),
    Text(PathBuf),
}

/// Name, class, path, and numbers of vertices and faces of a shape.
type ListedShape = (String, String, OsString, u64, u64);

fn search_options(k: usize, rank: &str, explain: bool) -> PyResult<SearchOptions> {
    Ok(SearchOptions { k, explain, rank_by: chosen("rank", rank)?, ..SearchOptions::default() })
}

/// Where classes come from: a word, or a label file.
fn labels_of(labels: Option<PathBuf>) -> PyResult<Option<LabelSource>> {
    raised(labels.map(|path| LabelSource::read(&path)).transpose())
}

/// The report on a build, with the remedies of failures in words.
fn report_of(mut report: canonform::library::BuildReport) -> String {
    for failure in &mut report.failed {
        failure.error = with_remedy(std::mem::take(&mut failure.error), failure.remedy);
    }
    json(&report)
}

#[pymethods]
impl Index {
    #[staticmethod]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        run(py, |_| {
            let search = ShapeSearch::open(&path)?;
            Ok(Self { path: path.clone(), search })
        })
    }

    /// Makes a file the index of the meshes in a folder; returns the report as JSON. With `only_unchanged`, nothing is done, and
    /// there is a report only if there is nothing to do.
    #[staticmethod]
    fn build(
        py: Python<'_>,
        folder: PathBuf,
        path: PathBuf,
        labels: Option<PathBuf>,
        prune: bool,
        shard: Option<(usize, usize)>,
        only: Option<HashSet<String>>,
        only_unchanged: bool,
        settings: Settings,
    ) -> PyResult<Option<String>> {
        let describe = settings.describe(settings.repair())?;
        let labels = labels_of(labels)?;
        let shard = raised(shard.map(|(i, n)| Shard::new(i, n)).transpose())?;
        let options = BuildOptions {
            labels: labels.as_ref(),
            shard,
            only: only.as_ref(),
            prune,
            limits: settings.limits()?,
            ..BuildOptions::new(&describe)
        };
        let built = run(py, |observer| match only_unchanged {
            false => build_index(&folder, &path, &options, observer).map(Some),
            true => match unchanged_index(&folder, &path, &options, observer) {
                Err(Error::Index(IndexError::OtherOptions { .. })) => Ok(None),
                found => found,
            },
        })?;
        Ok(built.map(report_of))
    }

    /// Adds meshes and folders of them to the index at a path; returns the report as JSON.
    #[staticmethod]
    fn add(
        py: Python<'_>,
        path: PathBuf,
        meshes: Vec<PathBuf>,
        label: Option<String>,
        labels: Option<PathBuf>,
        replace: bool,
        settings: Settings,
    ) -> PyResult<String> {
        let labels = labels_of(labels)?;
        let limits = settings.limits()?;
        let inputs = Inputs { paths: &meshes, labels: labels.as_ref(), label: label.as_deref(), limits };
        run(py, |observer| add_to_index(&path, &inputs, replace, observer)).map(report_of)
    }

    /// Removes shapes from the index at a path by name; returns how many are left.
    #[staticmethod]
    fn remove(py: Python<'_>, path: PathBuf, ids: Vec<String>) -> PyResult<usize> {
        run(py, |_| remove_from_index(&path, &ids))
    }

    /// Scores how well the classes are separated; returns the scores as JSON.
    fn evaluate(
        &self,
        py: Python<'_>,
        by: &str,
        k: usize,
        rank: &str,
        labels: Option<PathBuf>,
    ) -> PyResult<String> {
        let measure = measure("by", by)?;
        let labels = labels_of(labels)?;
        let options =
            EvaluateOptions { measure, labels: labels.as_ref(), knn_k: k, rank_by: chosen("rank", rank)? };
        run(py, |observer| evaluate_index(&self.path, &options, observer)).map(json)
    }

    /// Finds the shapes nearest to a surface, a mesh file or a shape of the index; returns the report as JSON.
    fn search(
        &self,
        py: Python<'_>,
        query: Wanted<'_>,
        name: &str,
        k: usize,
        rank: &str,
        explain: bool,
    ) -> PyResult<String> {
        let options = search_options(k, rank, explain)?;
        let (surface, path) = match &query {
            Wanted::Surface(surface) => (Some(surface.get()), PathBuf::new()),
            Wanted::Text(path) => (None, path.clone()),
        };
        let search = &self.search;
        let answer = run(py, |observer| {
            // As on the command line, a file goes before a shape of the same name.
            let query = match (surface, search.id_of(&path)) {
                (Some(surface), _) => query_of(surface, search.describe_options(), name, &options, observer)?,
                (None, Some(id)) => search.query_of(id, &options, observer)?,
                (None, None) => {
                    let mesh = canonform::collection::read_mesh(&path)?;
                    search.query(&mesh, (name, Some(content_hash(&path)?)), &options, observer)?
                }
            };
            search.search(&query, &options, observer)
        });
        answer.map(|answer| self.placed(answer))
    }

    /// Name and distance of the shapes whose signatures are nearest to a vector.
    fn nearest(
        &self,
        py: Python<'_>,
        vector: PyReadonlyArray1<'_, f32>,
        k: usize,
    ) -> PyResult<Vec<(String, f64)>> {
        let vector = vector.as_slice()?;
        run(py, |_| Ok(self.search.index().nearest(vector, k)?))
    }

    /// A shape as a query for other indexes, as JSON.
    fn query_of(&self, py: Python<'_>, id: &str, rank: &str, explain: bool) -> PyResult<String> {
        let options = search_options(0, rank, explain)?;
        run(py, |observer| self.search.query_of(id, &options, observer)).map(json)
    }

    /// The answer to a query of another process, among some shapes or all, and with the classes of all indexes that are searched;
    /// all as JSON.
    fn search_among(
        &self,
        py: Python<'_>,
        query: &str,
        ids: Option<Vec<String>>,
        k: usize,
        rank: &str,
        explain: bool,
        classes: &str,
    ) -> PyResult<String> {
        let query: Query = unpacked(query)?;
        let options = SearchOptions { classes: unpacked(classes)?, ..search_options(k, rank, explain)? };
        run(py, |observer| self.search.search_among(&query, ids.as_deref(), &options, observer))
            .map(|answer| self.placed(answer))
    }

    /// How its shapes were described, as the index states it.
    #[getter]
    fn options(&self) -> &str {
        &self.search.index().options
    }

    #[getter]
    fn path(&self) -> &OsStr {
        self.path.as_os_str()
    }

    #[getter]
    fn n_shapes(&self) -> usize {
        self.search.index().len()
    }

    fn contains(&self, id: &str) -> PyResult<bool> {
        raised(self.search.index().contains(id))
    }

    /// Name, class, path and numbers of vertices and faces of a shape.
    fn entry(&self, id: &str) -> PyResult<ListedShape> {
        raised(self.search.index().entry(id)).map(|found| self.listed(found))
    }

    /// What the index holds, as JSON.
    fn info(&self) -> PyResult<String> {
        let index = self.search.index();
        let (classes, n_shapes) = (raised(index.classes())?, index.len());
        Ok(json(&object! {
            format: FORMAT_VERSION,
            n_shapes,
            n_bytes: index.n_bytes(),
            options: self.search.describe_options(),
            // Shapes without a class.
            unlabelled: n_shapes as u64 - classes.values().sum::<u64>(),
            classes,
        }))
    }

    /// Name, class, path and numbers of vertices and faces of all shapes.
    fn shapes(&self, py: Python<'_>) -> PyResult<Vec<ListedShape>> {
        run(py, |_| Ok(self.search.index().entries()?.into_iter().map(|entry| self.listed(entry)).collect()))
    }

    /// The fused vectors of all shapes, in the order of `shapes`.
    fn vectors(&self, py: Python<'_>) -> PyResult<Rows<f32>> {
        run(py, |_| {
            let table = self.search.index().vector_table()?;
            let flat: Vec<f32> = (0..table.len()).flat_map(|i| table.vector(i).iter().copied()).collect();
            let length = flat.len().checked_div(table.len()).unwrap_or(0);
            Ok(Rows(flat, [table.len(), length]))
        })
    }

    /// The fused vector of one shape.
    fn vector(&self, id: &str) -> PyResult<Vector<f32>> {
        raised(self.search.index().shape(id)).map(|shape| Vector(shape.fused))
    }

    /// Distances between some shapes and others, or between all pairs of some, one row for each of the first: combined, by
    /// aligned forms and signatures, or by signatures alone.
    fn distances(
        &self,
        py: Python<'_>,
        rows: Vec<String>,
        columns: Option<Vec<String>>,
        kind: &str,
    ) -> PyResult<Rows<f64>> {
        let kind = chosen("kind", kind)?;
        let distances = run(py, |observer| self.search.distances(&rows, columns.as_deref(), kind, observer))?;
        Ok(of_matrix(&distances))
    }

    /// The surface of the mesh of a shape, repaired as the index says.
    fn surface(&self, py: Python<'_>, id: &str) -> PyResult<Surface> {
        let repair: RepairOptions = self.search.describe_options().form.repair;
        let read = || Ok((self.search.mesh(id)?, Some(self.search.index().entry(id)?.content)));
        Surface::repaired(py, &repair, read)
    }

    /// Writes the index in the format of the extension.
    fn export(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
        let Some(format) = ExportFormat::named(extension) else {
            let known = ExportFormat::ALL.map(ExportFormat::extension).join(", ");
            let message = format!("`{extension}` is not a format of exports; use one of {known}");
            return Err(Exception::OptionError.with(message));
        };
        run(py, |_| export_index(self.search.index(), format, &path))
    }

    /// Finds the shapes that are one; returns the report as JSON.
    fn duplicates(
        &self,
        py: Python<'_>,
        kinds: Option<Vec<String>>,
        min_confidence: f64,
        keep: &str,
        reference: Vec<PathBuf>,
    ) -> PyResult<String> {
        let keep =
            keep.parse().map_err(|fault: String| Exception::OptionError.with(format!("keep: {fault}")))?;
        let mut options = DuplicateOptions { min_confidence, keep, reference, ..DuplicateOptions::default() };
        if let Some(kinds) = kinds {
            let kinds = kinds.iter().map(|kind| chosen("kinds", kind));
            options.kinds = kinds.collect::<PyResult<_>>()?;
        }
        run(py, |observer| find_duplicates(&self.search, &options, observer)).map(json)
    }
}

impl Index {
    fn listed(&self, Entry { id, label, path, facts, .. }: Entry) -> ListedShape {
        (id, label, mesh_path(&self.path, &path).into_os_string(), facts.vertices, facts.faces)
    }

    /// An answer as JSON, with the paths of the meshes that this index states.
    fn placed(&self, mut answer: Answer) -> String {
        answer.place(|path| mesh_path(&self.path, path).to_string_lossy().into_owned());
        json(answer)
    }
}

/// What another process wrote as JSON.
fn unpacked<T: DeserializeOwned>(text: &str) -> PyResult<T> {
    serde_json::from_str(text).map_err(|fault| Exception::OptionError.with(format!("{text:.40}: {fault}")))
}

/// The query of a surface for indexes of these options.
fn query_of(
    surface: &Surface,
    describe: &DescribeOptions,
    name: &str,
    options: &SearchOptions,
    observer: &dyn Observer,
) -> Result<Query, Error> {
    // A surface that was repaired in another way is repaired again.
    let again = match surface.inner.input.repair == describe.form.repair {
        true => None,
        false => Some(canonform::Surface::new(&surface.mesh, &describe.form.repair, observer)?),
    };
    let shape = match &again {
        Some(again) => canonform::describe(again, describe, observer)?,
        None => (*surface.described(describe, observer)?).clone(),
    };
    let repaired = again.as_ref().unwrap_or(&surface.inner);
    let query = Query::new(shape, describe).named(name, surface.content);
    query.with_mesh(&surface.mesh, repaired, (options, describe), observer)
}

/// A surface as a query for indexes of these options, as JSON.
#[pyfunction]
pub(crate) fn query_of_surface(
    py: Python<'_>,
    surface: Bound<'_, Surface>,
    options: &str,
    name: &str,
    rank: &str,
    explain: bool,
) -> PyResult<String> {
    let unknown = || Exception::OptionError.with(format!("options {options:?} are not of this version"));
    let describe = DescribeOptions::from_text(options).ok_or_else(unknown)?;
    let (surface, options) = (surface.get(), search_options(0, rank, explain)?);
    run(py, |observer| query_of(surface, &describe, name, &options, observer)).map(json)
}

/// The components of a query: what is said of each, and the query for it; all as JSON.
#[pyfunction]
pub(crate) fn query_components(py: Python<'_>, query: &str) -> PyResult<Vec<(String, String)>> {
    let query: Query = unpacked(query)?;
    let parts = run(py, |observer| query.components(observer))?;
    Ok(parts.iter().map(|(found, query)| (json(found), json(query))).collect())
}

/// How many candidates a search for `k` results has where only vectors are searched, and how many results each shard gives.
#[pyfunction]
pub(crate) fn shortlist(k: usize) -> [usize; 2] {
    [canonform::search::n_candidates(k), canonform::search::n_results(k)]
}

/// The answer to a query in shards, from what they answer and the classes of all; all as JSON.
#[pyfunction]
pub(crate) fn merge_answers(query: &str, answers: Vec<String>, classes: &str, k: usize) -> PyResult<String> {
    let (query, classes): (Query, _) = (unpacked(query)?, unpacked(classes)?);
    let answers = answers.iter().map(|answer| unpacked(answer)).collect::<PyResult<Vec<Answer>>>()?;
    Ok(json(canonform::search::merge_answers(&query, answers, classes, k)))
}

/// How well the classes of these indexes and the distances of their shapes agree, as JSON.
#[pyfunction]
pub(crate) fn agreement(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<String> {
    run(py, |observer| Agreement::of_indexes(&paths, observer)).map(json)
}

/// Scores a square matrix of distances by the classes of its rows; returns the scores as JSON. Both directions are averaged.
#[pyfunction]
pub(crate) fn evaluate_matrix(
    py: Python<'_>,
    distances: PyReadonlyArray2<'_, f64>,
    labels: Vec<String>,
    k: usize,
    rank: &str,
) -> PyResult<String> {
    let (distances, rank_by) = (distances.as_array(), chosen("rank", rank)?);
    let mean = |i: usize, j: usize| 0.5 * (distances[(i, j)] + distances[(j, i)]);
    let matrix = raised(DistanceMatrix::from_pairs(labels.len(), mean))?;
    run(py, |_| Ok(evaluate(&matrix, &Labels::new(&labels), k, rank_by)?)).map(json)
}

/// Merges indexes into one file; returns the report as JSON.
#[pyfunction]
pub(crate) fn merge_indexes(py: Python<'_>, inputs: Vec<PathBuf>, path: PathBuf) -> PyResult<String> {
    run(py, |observer| canonform::library::merge_indexes(&inputs, &path, observer)).map(json)
}

/// Name, class and path of the shapes that an index of a folder has, without reading any mesh, with the sizes of their files
/// in bytes.
#[pyfunction]
pub(crate) fn list_folder(
    py: Python<'_>,
    folder: PathBuf,
    path: PathBuf,
    labels: Option<PathBuf>,
) -> PyResult<Vec<(String, String, PathBuf, u64)>> {
    let labels = labels_of(labels)?;
    run(py, |_| {
        let size = |path: &PathBuf| std::fs::metadata(path).map_or(0, |found| found.len());
        let listed = |shape: ShapeFile| {
            let n_bytes = canonform::mesh::io::files_of(&shape.path).iter().map(size).sum();
            (shape.name, shape.label, shape.path, n_bytes)
        };
        Ok(indexed_shapes(&folder, &path, labels.as_ref())?.into_iter().map(listed).collect())
    })
}

/// The hashes of mesh files, as text. A file that cannot be read has none.
#[pyfunction]
pub(crate) fn content_hashes(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<Vec<Option<String>>> {
    run(py, |_| {
        Ok(paths.par_iter().map(|path| content_hash(path).ok().map(|hash| hash.to_string())).collect())
    })
}
