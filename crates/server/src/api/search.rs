//! What is a mesh like?

use std::path::{Path, PathBuf};
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
use super::shapes::{form_of, is_missing};
use crate::app::{App, Query};
use crate::error::ApiError;
use crate::measured::Measured;
use crate::upload::{Upload, pass, receive};

/// Most shapes that are found.
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
                |expected: &str| ApiError::bad_request(format!("{name} is `{text}`; it is {expected}"));
            match name.as_str() {
                "k" => self.k = Some(text.parse().map_err(|_| wrong("a number"))?),
                "explain" => self.explain = Some(text.parse().map_err(|_| wrong("true or false"))?),
                _ => {
                    return Err(ApiError::bad_request(format!(
                        "the form has a field `{name}` that means nothing"
                    ))
                    .with_remedy("send files, `k` and `explain`"));
                }
            }
        }
        Ok(self)
    }

    fn options(&self) -> Result<SearchOptions, ApiError> {
        let k = self.k.unwrap_or(SearchOptions::default().k);
        if !(1..=MOST_FOUND).contains(&k) {
            return Err(ApiError::bad_request(format!("k is {k}; it goes from 1 to {MOST_FOUND}")));
        }
        let explain = if self.explain == Some(true) { Explain::Kind } else { Explain::No };
        Ok(SearchOptions { k, explain, ..SearchOptions::default() })
    }
}

/// What `canonform search --json` prints, and what a page shows besides.
#[derive(Serialize)]
struct Answer {
    /// Name of the file, or of the shape of the index.
    query: String,
    #[serde(flatten)]
    report: SearchReport,
    /// Names this upload for a while, to be compared with what was found; none for a shape of the index.
    query_id: Option<String>,
    /// What was repaired; none where the mesh of a shape of the index is gone.
    repair: Option<RepairReport>,
    /// The same in words, a line for each kind of change.
    repaired: Vec<String>,
    mesh: Option<Geometry>,
    /// Why there is no mesh.
    mesh_missing: Option<String>,
    form: Geometry,
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
            pass(request);
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
    let nothing = || (None, Vec::new(), None);
    let (measured, mesh_missing) = match app.indexed(&id) {
        Ok(measured) => (Some(measured), None),
        Err(fault) if is_missing(&fault) => (None, Some(fault.to_string())),
        Err(fault) => return Err(fault.into()),
    };
    let (repair, repaired, mesh) = measured.map_or_else(nothing, |measured| {
        let repair = measured.surface.repaired.report.clone();
        (Some(repair), measured.surface.repaired.report.summary(), Some(measured.mesh()))
    });
    let form = form_of(app, &id)?;
    Ok(Answer { query: id, report, query_id: None, repair, repaired, mesh, mesh_missing, form })
}

fn with_upload(app: &App, upload: Upload, options: &SearchOptions) -> Result<Answer, ApiError> {
    let name: PathBuf = match upload.files.first() {
        Some((name, _)) => name.clone(),
        None => {
            return Err(ApiError::bad_request("no file came with the request").with_remedy(format!(
                "send one mesh, {}; or name a shape of the index with ?shape=",
                mesh_files()
            )));
        }
    };
    let (query, report) =
        measure(app, upload, options).map_err(|fault| ApiError::of_upload(&name, &fault))?;
    let (name, measured) = (query.name.clone(), &query.measured);
    let repair = measured.surface.repaired.report.clone();
    let (mesh, form) = (measured.mesh(), measured.form());
    let query_id = app.keep(query)?;
    Ok(Answer {
        query: name,
        report,
        query_id: Some(query_id),
        repaired: repair.summary(),
        repair: Some(repair),
        mesh: Some(mesh),
        mesh_missing: None,
        form,
    })
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
    let query = Query { name, measured: Measured::of(surface, &embedded)?, shape };
    Ok((query, SearchReport { seconds, ..report }))
}
