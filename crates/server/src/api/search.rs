//! Search with an upload, or with a shape of the index.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use axum::Extension;
use axum::extract::{Request, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use base::object;
use canonform::collection::{is_archive_name, single_mesh};
use canonform::index::ContentHash;
use canonform::mesh::io::{MemoryFile, ReadLimits, is_mesh_path, mesh_files, read_memory};
use canonform::search::{Answer, SearchOptions, SearchRank};
use canonform::{Budget, Error};
use report::viewer::Geometry;
use serde::Deserialize;

use super::answer::{Params, json};
use super::csv;
use super::shapes::{is_missing, points};
use crate::app::{App, Query};
use crate::collection::Collection;
use crate::cost;
use crate::error::ApiError;
use crate::measured::Measured;
use crate::upload::{Files, Patience, announced, receive};

/// Maximum number of results.
const MOST_FOUND: usize = 100;

/// Bytes of a text file per vertex.
const VERTEX_BYTES: usize = 70;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct SearchParams {
    /// A shape of the index to search with, instead of an upload.
    shape: Option<String>,
    /// The `query_id` of an earlier upload, instead of an upload.
    query: Option<String>,
    k: Option<usize>,
    explain: Option<bool>,
    rank: Option<SearchRank>,
    geometry: Option<bool>,
    format: Option<Format>,
}

/// How results are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Format {
    Json,
    Csv,
}

/// What to answer.
struct Wanted {
    options: SearchOptions,
    /// Whether the response contains the surfaces.
    geometry: bool,
    format: Format,
}

impl SearchParams {
    fn wanted(&self) -> Result<Wanted, ApiError> {
        let k = self.k.unwrap_or(SearchOptions::default().k);
        if !(1..=MOST_FOUND).contains(&k) {
            return Err(ApiError::bad_request(format!("k is {k}; use 1 to {MOST_FOUND}")));
        }
        let explain = self.explain == Some(true);
        let format = self.format.unwrap_or(Format::Json);
        let geometry = format == Format::Json && self.geometry != Some(false);
        let rank_by = self.rank.unwrap_or_default();
        let options = SearchOptions { k, explain, rank_by, ..SearchOptions::default() };
        Ok(Wanted { options, geometry, format })
    }
}

/// A query as it is drawn; without its mesh the points of its form, and why there is no mesh.
type Drawn = (Option<Arc<Measured>>, Option<(Geometry, String)>);

impl Wanted {
    /// The output of `canonform search --json`, and the geometry for the page. `query_id` identifies an upload for later
    /// searches and comparisons. Paths are shown as clients may see them.
    fn written(
        &self,
        collection: &Collection,
        query: &str,
        query_id: Option<&str>,
        mut answer: Answer,
        (measured, points): Drawn,
    ) -> Result<Response, ApiError> {
        answer.place(|path| collection.public_path(path));
        if self.format == Format::Csv {
            let kind = (header::CONTENT_TYPE, "text/csv; charset=utf-8; header=present");
            return Ok(([kind], csv::of(query, &answer)).into_response());
        }
        let repair = measured.as_ref().map(|measured| &measured.surface.input.report);
        let (points, mesh_missing) = points.unzip();
        let shown = measured.as_ref().filter(|_| self.geometry);
        json(&object! {
            query,
            #[serde(flatten)]
            answer,
            query_id,
            repair,
            // The repair in words, one line per kind of change.
            repaired: repair.map(|repair| repair.summary()).unwrap_or_default(),
            mesh: shown.map(|measured| measured.mesh()),
            mesh_missing,
            form: points.or_else(|| shown.map(|measured| measured.form())),
        })
    }
}

/// Searches with an upload.
pub(super) async fn search(
    State(app): State<Arc<App>>,
    Extension(patience): Extension<Patience>,
    Params(params): Params<SearchParams>,
    request: Request,
) -> Result<Response, ApiError> {
    let wanted = params.wanted()?;
    if params.shape.is_some() || params.query.is_some() {
        return Err(ApiError::bad_request("`shape` and `query` are for GET; the file is the query"));
    }
    // Only to learn whether it would be.
    drop(app.work.accept(announced(&request) as f64 * cost::UPLOADED_BYTE)?);
    let (files, held) = receive(request, patience, &app.uploads, &app.options).await?;
    let (shared, bytes) = (app.clone(), files.iter().map(|(_, content)| content.len()).sum::<usize>());
    let vertices = (bytes / VERTEX_BYTES) as u64;
    let searching = app.served.collection().search_cost(&wanted.options, vertices);
    let answer = move |budget: &Budget| with_upload(&shared, files, &wanted, budget);
    app.work.run(bytes as f64 * cost::UPLOADED_BYTE + searching, Some(held), answer).await
}

/// Searches with a shape of the index or an earlier upload.
pub(super) async fn search_again(
    State(app): State<Arc<App>>,
    Params(params): Params<SearchParams>,
) -> Result<Response, ApiError> {
    let wanted = params.wanted()?;
    let (shared, collection) = (app.clone(), app.served.collection());
    match (params.shape, params.query) {
        (Some(id), None) => {
            let measuring = if wanted.geometry { app.cost(&collection, &id) } else { 0.0 };
            let searching = collection.search_cost(&wanted.options, collection.n_vertices(&id));
            let answer = move |budget: &Budget| with_shape(&shared, &collection, &id, &wanted, budget);
            app.work.run(measuring + searching, None, answer).await
        }
        (None, Some(address)) => {
            let query = app.query(&collection, &address)?;
            let cost = collection.search_cost(&wanted.options, query.n_vertices());
            let answer = move |budget: &Budget| {
                let answer = query.search(&collection, &wanted.options, budget)?;
                let (name, drawn) = (&query.described.name, query.measured.clone());
                wanted.written(&collection, name, Some(&address), answer, (Some(drawn), None))
            };
            app.work.run(cost, None, answer).await
        }
        _ => Err(ApiError::bad_request("give either a shape with `shape` or an upload with `query`")),
    }
}

fn with_shape(
    app: &App,
    collection: &Collection,
    id: &str,
    wanted: &Wanted,
    budget: &Budget,
) -> Result<Response, ApiError> {
    let query = collection.search.query_of(id, &wanted.options, budget)?;
    let answer = collection.search.search(&query, &wanted.options, budget)?;
    let drawn = match wanted.geometry.then(|| app.indexed(collection, id, budget)) {
        None => (None, None),
        Some(Ok(measured)) => (Some(measured), None),
        Some(Err(fault)) if is_missing(&fault) => {
            (None, Some((points(collection, id)?, ApiError::from(fault).error)))
        }
        Some(Err(fault)) => return Err(fault.into()),
    };
    wanted.written(collection, id, None, answer, drawn)
}

fn with_upload(app: &App, files: Files, wanted: &Wanted, budget: &Budget) -> Result<Response, ApiError> {
    let Some(name) = files.first().map(|(name, _)| name.clone()) else {
        let remedy =
            format!("send one mesh, {}; or name a shape of the index with GET and ?shape=", mesh_files());
        return Err(ApiError::bad_request("the request has no file").with_remedy(remedy));
    };
    let start = Instant::now();
    let collection = app.served.collection();
    // The mesh of an archive instead of the archive.
    let files = match &files[..] {
        [(name, bytes)] if is_archive_name(name) => {
            single_mesh(name, bytes, app.options.max_upload as u64)
                .map_err(|fault| ApiError::of_upload(name, fault.into()))?
        }
        _ => files,
    };
    let address = App::address(&files);
    let query = match app.kept(&collection, &address) {
        Some(known) => known,
        None => {
            let query = measure(app, &collection, files, budget);
            let query = Arc::new(query.map_err(|fault| ApiError::of_upload(&name, fault))?);
            app.keep(address.clone(), query.clone());
            query
        }
    };
    let describe = start.elapsed().as_secs_f64();
    let mut answer = query.search(&collection, &wanted.options, budget)?;
    answer.seconds.describe = describe;
    let (name, drawn) = (&query.described.name, query.measured.clone());
    wanted.written(&collection, name, Some(&address), answer, (Some(drawn), None))
}

fn measure(app: &App, collection: &Collection, files: Files, budget: &Budget) -> Result<Query, Error> {
    let in_memory: Vec<MemoryFile<'_>> =
        files.iter().map(|(name, bytes)| MemoryFile { name: Path::new(name), bytes }).collect();
    let name = in_memory.first().map(|file| file.name.display().to_string()).unwrap_or_default();
    let mesh = read_memory(&in_memory, &ReadLimits::of_vertices(app.options.max_vertices))?;
    let content = content_of(&in_memory);
    drop(files);
    let describe = collection.search.describe_options();
    let (measured, embedded) = Measured::new(&mesh, content, &describe.form, budget)?;
    let described = canonform::search::Query::new(embedded.describe(describe, budget)?, describe);
    let mut described = described.named(&name, Some(content));
    described.geometry.clone_from(&measured.geometry);
    Ok(Query { described, measured: Arc::new(measured) })
}

/// The hash by which an index knows the files of a mesh: that of the mesh itself comes first.
fn content_of(files: &[MemoryFile<'_>]) -> ContentHash {
    let mut files: Vec<_> = files.iter().collect();
    files.sort_by_key(|file| !is_mesh_path(file.name));
    ContentHash::of(&files.iter().map(|file| file.bytes).collect::<Vec<_>>())
}
