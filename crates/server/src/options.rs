//! Limits of a server.

use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

/// Where a server listens, and how much it takes on.
///
/// Together they bound its memory: `max_uploads` uploads of `max_upload` bytes, `jobs` meshes of `max_vertices` at
/// work, and the caches.
#[derive(Debug, Clone, PartialEq)]
pub struct ServeOptions {
    /// The address; port 0 takes a free one. Default: `127.0.0.1:7878`, which no other machine reaches.
    pub listen: SocketAddr,
    /// Bytes that one request may send. Default: 64 MB.
    pub max_upload: usize,
    /// Vertices of a mesh; there may be four times as many faces. Default: 200,000.
    pub max_vertices: u64,
    /// Uploads that are received or wait to be measured at once. Default: 16.
    pub max_uploads: usize,
    /// Requests that are worked on at once; 0 for one a core. Default: 0.
    pub jobs: usize,
    /// Requests that may wait for a job; the next ones are sent away. Default: 64.
    pub queue: usize,
    /// From the beginning of the wait for a job to the answer. Default: a minute.
    pub time_limit: Duration,
    /// For all of an upload to arrive. Default: five minutes.
    pub upload_time: Duration,
    /// For a request's header, and for the next piece of its body. Default: 15 seconds.
    pub idle_time: Duration,
    /// Connections at once; others wait to be accepted. Default: 256.
    pub connections: usize,
    /// Bytes of meshes, forms and thumbnails of indexed shapes that are kept. Default: 256 MB.
    pub cache: usize,
    /// Bytes of queries that are kept, so that they can be compared with what they found; the last one is kept in any
    /// case. Default: 128 MB.
    pub kept_queries: usize,
    /// How long a query is kept. Default: half an hour.
    pub query_lifetime: Duration,
    /// What is at work when the server is stopped has this long to end. Default: 30 seconds.
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
