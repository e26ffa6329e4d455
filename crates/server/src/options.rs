//! Limits of a server.

use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

/// Where a server listens, and its limits.
///
/// Together they bound its memory: `max_uploads` uploads of `max_upload` bytes, `jobs` meshes of `max_vertices` in
/// progress, and the caches.
#[derive(Debug, Clone, PartialEq)]
pub struct ServeOptions {
    /// The address; port 0 takes a free port. Default: `127.0.0.1:7878`, which other machines cannot reach.
    pub listen: SocketAddr,
    /// Maximum number of bytes in a request. Default: 64 MB.
    pub max_upload: usize,
    /// Maximum number of vertices of a mesh; it may have four times as many faces. Default: 200,000.
    pub max_vertices: u64,
    /// Maximum number of uploads being received or waiting. Default: 16.
    pub max_uploads: usize,
    /// Number of requests processed at once; 0 for one per core. Default: 0.
    pub jobs: usize,
    /// Number of requests that may wait for a job; further ones are rejected. Default: 64.
    pub queue: usize,
    /// Maximum time from the start of the wait for a job to the response. Default: one minute.
    pub time_limit: Duration,
    /// Maximum time for a complete upload. Default: five minutes.
    pub upload_time: Duration,
    /// Maximum time for the header of a request, and for the next piece of its body. Default: 15 seconds.
    pub idle_time: Duration,
    /// Maximum number of connections; further ones wait to be accepted. Default: 256.
    pub connections: usize,
    /// Size of the cache of meshes, forms and thumbnails, in bytes. Default: 256 MB.
    pub cache: usize,
    /// Size of the cache of queries, in bytes; the last query is always kept. A kept query can be compared with its
    /// results. Default: 128 MB.
    pub kept_queries: usize,
    /// How long a query is kept. Default: half an hour.
    pub query_lifetime: Duration,
    /// How long requests in progress may take to finish after the server is stopped. Default: 30 seconds.
    pub farewell: Duration,
}

impl Default for ServeOptions {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 7878)),
            max_upload: 64_000_000,
            max_vertices: 200_000,
            max_uploads: 16,
            jobs: 0,
            queue: 64,
            time_limit: Duration::from_secs(60),
            upload_time: Duration::from_secs(300),
            idle_time: Duration::from_secs(15),
            connections: 256,
            cache: 256_000_000,
            kept_queries: 128_000_000,
            query_lifetime: Duration::from_secs(1800),
            farewell: Duration::from_secs(30),
        }
    }
}
