//! State shared by all requests.

use std::path::Path;
use std::sync::Arc;

use axum::body::Bytes;
use axum::http::StatusCode;
use base::Cache;
use canonform::embed::describe_part;
use canonform::search::{Answer, SearchOptions, SearchRank};
use canonform::{Budget, ContentHash, Error};
use tokio::sync::Semaphore;

use crate::collection::{Collection, Served};
use crate::cost;
use crate::duplicates::Duplicates;
use crate::error::ApiError;
use crate::measured::Measured;
use crate::options::ServeOptions;
use crate::upload::FRAME;
use crate::work::Work;

/// Size of the cache of meshes, forms and thumbnails, in bytes.
const CACHE: usize = 256_000_000;

/// Size of the cache of queries, in bytes; the last query is always kept. A kept query can be compared with its results.
const KEPT_QUERIES: usize = 128_000_000;

/// The index, the caches and the queue.
pub(crate) struct App {
    pub(crate) served: Served,
    pub(crate) options: ServeOptions,
    pub(crate) work: Work,
    /// Bytes of uploads for which there is memory.
    pub(crate) uploads: Arc<Semaphore>,
    pub(crate) duplicates: Duplicates,
    /// By the content of the mesh and the options, as a mesh has another form with other options.
    measured: Cache<(ContentHash, String), Arc<Measured>>,
    pub(crate) thumbnails: Cache<String, Bytes>,
    queries: Cache<String, Arc<Query>>,
}

/// An upload that was searched for.
pub(crate) struct Query {
    pub(crate) described: canonform::search::Query,
    pub(crate) measured: Arc<Measured>,
}

impl Query {
    pub(crate) fn n_vertices(&self) -> u64 {
        self.measured.surface.mesh().n_vertices() as u64
    }

    /// Searches the collection with it.
    pub(crate) fn search(
        &self,
        collection: &Collection,
        options: &SearchOptions,
        budget: &Budget,
    ) -> Result<Answer, Error> {
        let search = &collection.search;
        let mut query = self.described.clone();
        if options.rank_by == SearchRank::Part {
            query.part = Some(describe_part(&self.measured.surface, search.describe_options(), budget)?);
        }
        search.search(&query, options, budget)
    }
}

impl App {
    pub(crate) fn open(index: &Path, options: ServeOptions) -> Result<Self, Error> {
        Ok(Self {
            served: Served::open(index)?,
            work: Work::new(&options),
            uploads: Arc::new(Semaphore::new(options.max_uploads * (options.max_upload + FRAME))),
            duplicates: Duplicates::new(options.idle_time),
            // Thumbnails are smaller than meshes.
            measured: Cache::new(CACHE / 4 * 3),
            thumbnails: Cache::new(CACHE / 4),
            queries: Cache::new(KEPT_QUERIES).with_lifetime(options.query_lifetime),
            options,
        })
    }

    /// A shape of the index with the form of all its vertices, from the cache or measured now.
    pub(crate) fn indexed(
        &self,
        collection: &Collection,
        id: &str,
        budget: &Budget,
    ) -> Result<Arc<Measured>, Error> {
        let index = collection.search.index();
        let content = index.entry(id)?.content;
        let key = (content, index.options.clone());
        if let Some(known) = self.measured.get(&key) {
            return Ok(known);
        }
        let options = &collection.search.describe_options().form;
        let (measured, _) = Measured::new(&collection.search.mesh(id)?, content, options, budget)?;
        let measured = Arc::new(measured);
        self.measured.put(key, measured.clone(), measured.bytes());
        Ok(measured)
    }

    /// What [`indexed`](Self::indexed) costs, in seconds: nothing if the shape is in the cache.
    pub(crate) fn cost(&self, collection: &Collection, id: &str) -> f64 {
        let Some(shape) = collection.shape(id) else { return 0.0 };
        let key = (shape.content, collection.search.index().options.clone());
        let is_known = self.measured.get(&key).is_some();
        if is_known { 0.0 } else { collection.n_vertices(id) as f64 * cost::MEASURED_VERTEX }
    }

    /// The address of an upload: part of the hash of its names and contents.
    pub(crate) fn address(files: &[(std::path::PathBuf, Vec<u8>)]) -> String {
        let pieces: Vec<&[u8]> =
            files.iter().flat_map(|(name, content)| [name.as_os_str().as_encoded_bytes(), content]).collect();
        ContentHash::of(&pieces).to_string()[..32].to_owned()
    }

    /// Keeps a query under its address.
    pub(crate) fn keep(&self, address: String, query: Arc<Query>) {
        let bytes = query.measured.bytes();
        self.queries.put(address, query, bytes);
    }

    /// A kept query, if it was described as the shapes of the index are.
    pub(crate) fn kept(&self, collection: &Collection, address: &str) -> Option<Arc<Query>> {
        let query = self.queries.get(address)?;
        (query.described.options == collection.search.index().options).then_some(query)
    }

    /// As [`kept`](Self::kept), or an error for the client.
    pub(crate) fn query(&self, collection: &Collection, address: &str) -> Result<Arc<Query>, ApiError> {
        self.kept(collection, address).ok_or_else(|| {
            ApiError::new(StatusCode::GONE, "this upload has expired").with_remedy("choose the file again")
        })
    }
}
