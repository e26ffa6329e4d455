//! State shared by all requests.

use std::path::Path;
use std::sync::Arc;

use axum::body::Bytes;
use canonform::descriptors::PreparedShape;
use canonform::{Error, ShapeSearch, Surface, embed};
use serde::Serialize;

use crate::cache::Cache;
use crate::error::ApiError;
use crate::measured::Measured;
use crate::options::ServeOptions;
use crate::work::Work;

/// The index, the caches and the queue.
pub(crate) struct App {
    pub(crate) search: ShapeSearch,
    /// All shapes, by ascending name.
    pub(crate) shapes: Vec<ShapeSummary>,
    pub(crate) options: ServeOptions,
    pub(crate) work: Work,
    pub(crate) measured: Cache<Arc<Measured>>,
    pub(crate) thumbnails: Cache<Bytes>,
    pub(crate) queries: Cache<Arc<Query>>,
}

/// A shape in a list.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct ShapeSummary {
    pub(crate) id: String,
    pub(crate) label: String,
    vertices: Option<u64>,
    faces: Option<u64>,
    /// In squared mesh units.
    area: Option<f64>,
    /// The largest surface distance from a sample, in mesh units.
    diameter: Option<f64>,
}

/// An upload that was searched for.
pub(crate) struct Query {
    pub(crate) name: String,
    pub(crate) measured: Measured,
    pub(crate) shape: PreparedShape,
}

impl App {
    pub(crate) fn open(index: &Path, options: ServeOptions) -> Result<Self, Error> {
        let search = ShapeSearch::open(index)?;
        let shapes = search.index().entries()?.into_iter().map(|(id, entry)| {
            let count = |name| entry.fact(name).map(|count| count as u64);
            ShapeSummary {
                vertices: count("vertices"),
                faces: count("faces"),
                area: entry.fact("area"),
                diameter: entry.fact("diameter"),
                id,
                label: entry.label,
            }
        });
        Ok(Self {
            shapes: shapes.collect(),
            work: Work::new(&options),
            // Thumbnails are smaller than meshes.
            measured: Cache::new(options.cache / 4 * 3),
            thumbnails: Cache::new(options.cache / 4),
            queries: Cache::new(options.kept_queries).with_lifetime(options.query_lifetime),
            search,
            options,
        })
    }

    /// A shape of the index with the form of all its vertices, from the cache or measured now.
    pub(crate) fn indexed(&self, id: &str) -> Result<Arc<Measured>, Error> {
        if let Some(known) = self.measured.get(id) {
            return Ok(known);
        }
        let options = &self.search.describe_options().form;
        let surface = Surface::new(&self.search.mesh(id)?, &options.repair)?;
        let embedded = embed(&surface, options, &())?;
        let measured = Arc::new(Measured::new(surface, &embedded)?);
        self.measured.put(id.to_owned(), measured.clone(), measured.bytes());
        Ok(measured)
    }

    /// Keeps a query under an unguessable name.
    pub(crate) fn keep(&self, query: Query) -> Result<String, ApiError> {
        let mut secret = [0_u8; 16];
        getrandom::fill(&mut secret).map_err(|_| ApiError::internal())?;
        let name: String = secret.iter().map(|byte| format!("{byte:02x}")).collect();
        let bytes = query.measured.bytes();
        self.queries.put(name.clone(), Arc::new(query), bytes);
        Ok(name)
    }
}
