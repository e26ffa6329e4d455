//! Search with an upload, or with a shape of the index.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use axum::extract::{Request, State};
use canonform::{
    Error, Explain, SearchOptions, SearchReport, SearchSeconds, ShapeDescription, Surface, embed,
};
use mesh::RepairReport;
use mesh::io::{MemoryFile, ReadLimits, mesh_files, read_memory};
use serde::{Deserialize, Serialize};
use view::interactive::Geometry;

use super::answer::{Params, Written};
use super::shapes::{is_missing, points};
use crate::app::{App, Query};
use crate::error::ApiError;
use crate::measured::Measured;
use crate::upload::{Upload, drain, receive};

/// Maximum number of results.
const MOST_FOUND: usize = 100;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct SearchParams {
    /// A shape of the index to search with, instead of an upload.
    shape: Option<String>,
    k: Option<usize>,
    explain: Option<bool>,
}

impl SearchParams {
    /// Adds the fields of a form.
    fn with_fields(mut self, upload: &Upload) -> Result<Self, ApiError> {
        for (name, text) in &upload.fields {
            let wrong =
                |expected: &str| ApiError::bad_request(format!("{name} is `{text}`; expected {expected}"));
            match name.as_str() {
                "k" => self.k = Some(text.parse().map_err(|_| wrong("a number"))?),
                "explain" => self.explain = Some(text.parse().map_err(|_| wrong("true or false"))?),
                _ => {
                    let error = format!("the form has an unknown field `{name}`");
                    return Err(ApiError::bad_request(error).with_remedy("send files, `k` and `explain`"));
                }
            }
        }
        Ok(self)
    }

    fn options(&self) -> Result<SearchOptions, ApiError> {
        let k = self.k.unwrap_or(SearchOptions::default().k);
        if !(1..=MOST_FOUND).contains(&k) {
            return Err(ApiError::bad_request(format!("k is {k}; use 1 to {MOST_FOUND}")));
        }
        let explain = if self.explain == Some(true) { Explain::Kind } else { Explain::No };
        Ok(SearchOptions { k, explain, ..SearchOptions::default() })
    }
}

/// The output of `canonform search --json`, and the geometry for the page.
#[derive(Serialize)]
struct Answer {
    /// Name of the file, or of the shape of the index.
    query: String,
    #[serde(flatten)]
    report: SearchReport,
    /// Identifies this upload for later comparisons; none for a shape of the index.
    query_id: Option<String>,
    /// None if the mesh of a shape of the index is missing.
    repair: Option<RepairReport>,
    /// The repair in words, one line per kind of change.
    repaired: Vec<String>,
    mesh: Option<Geometry>,
    /// Why there is no mesh.
    mesh_missing: Option<String>,
    form: Geometry,
}

impl Answer {
    fn new(query: String, report: SearchReport, measured: &Measured) -> Self {
        let repair = measured.surface.repaired.report.clone();
        Self {
            query,
            report,
            query_id: None,
            repaired: repair.summary(),
            repair: Some(repair),
            mesh: Some(measured.mesh()),
            mesh_missing: None,
            form: measured.form(),
        }
    }
}

/// Searches with an upload, or with a shape of the index.
pub(super) async fn search(
    State(app): State<Arc<App>>,
    Params(params): Params<SearchParams>,
    request: Request,
) -> Result<Written, ApiError> {
    let shared = app.clone();
    if let Some(id) = params.shape.clone() {
        let options = params.options()?;
        return app.work.run(None, move || Written::new(&with_shape(&shared, id, &options)?)).await;
    }
    let permit = match app.work.upload() {
        Ok(permit) => permit,
        Err(busy) => {
            drain(request);
            return Err(busy);
        }
    };
    let upload = receive(request, &app.options).await?;
    let options = params.with_fields(&upload)?.options()?;
    let answer = move || Written::new(&with_upload(&shared, upload, &options)?);
    app.work.run(Some(permit), answer).await
}

fn with_shape(app: &App, id: String, options: &SearchOptions) -> Result<Answer, ApiError> {
    let report = app.search.search_shape(&id, options)?;
    match app.indexed(&id) {
        Ok(measured) => Ok(Answer::new(id, report, &measured)),
        Err(fault) if is_missing(&fault) => Ok(Answer {
            form: points(app, &id)?,
            query: id,
            report,
            query_id: None,
            repair: None,
            repaired: Vec::new(),
            mesh: None,
            mesh_missing: Some(fault.to_string()),
        }),
        Err(fault) => Err(fault.into()),
    }
}

fn with_upload(app: &App, upload: Upload, options: &SearchOptions) -> Result<Answer, ApiError> {
    let Some(name) = upload.files.first().map(|(name, _)| name.clone()) else {
        let remedy = format!("send one mesh, {}; or name a shape of the index with ?shape=", mesh_files());
        return Err(ApiError::bad_request("the request has no file").with_remedy(remedy));
    };
    let (query, report) = measure(app, upload, options).map_err(|fault| ApiError::of_upload(&name, fault))?;
    let answer = Answer::new(query.name.clone(), report, &query.measured);
    Ok(Answer { query_id: Some(app.keep(query)?), ..answer })
}

fn measure(app: &App, upload: Upload, options: &SearchOptions) -> Result<(Query, SearchReport), Error> {
    let start = Instant::now();
    let files: Vec<MemoryFile<'_>> =
        upload.files.iter().map(|(name, bytes)| MemoryFile { name: Path::new(name), bytes }).collect();
    let name = files.first().map(|file| file.name.display().to_string()).unwrap_or_default();
    let mesh = read_memory(&files, &ReadLimits::of_vertices(app.options.max_vertices))?;
    drop(upload);
    let describe = app.search.describe_options();
    let surface = Surface::new(&mesh, &describe.form.repair)?;
    let embedded = embed(&surface, &describe.form, &())?;
    let description = ShapeDescription::new(&surface, &embedded, describe)?;
    let described = start.elapsed().as_secs_f64();
    let report = app.search.search_described(&description, options)?;
    let seconds = SearchSeconds { describe: described, ..report.seconds };
    let shape = description.prepare()?;
    let query = Query { name, measured: Measured::new(surface, &embedded)?, shape };
    Ok((query, SearchReport { seconds, ..report }))
}
