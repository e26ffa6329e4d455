//! Limits of a server.

use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

/// Stack size of the threads that measure.
pub(crate) const STACK: usize = 8 << 20;

/// Where a server listens, and its limits.
///
/// Together they bound its memory: `max_uploads` uploads of `max_upload` bytes, `jobs` meshes of `max_vertices` in
/// progress, and the caches.
#[derive(Debug, Clone, PartialEq)]
pub struct ServeOptions {
    /// The address; port 0 takes a free port. Default: `127.0.0.1:7878`, which other machines cannot reach.
    pub listen: SocketAddr,
    /// The name under which a reverse proxy passes requests on, without a port. A server that listens on a loopback address
    /// answers no other name but those of this machine. Default: none.
    pub public_host: Option<String>,
    /// Maximum number of bytes in a request. Default: 64 MB.
    pub max_upload: usize,
    /// Maximum number of vertices of a mesh; it may have four times as many faces. Default: 200,000.
    pub max_vertices: u64,
    /// Number of uploads of the maximum size for which there is memory. Those being received, waiting and in progress share it;
    /// one for which none is left is refused. Default: 16.
    pub max_uploads: usize,
    /// Number of requests processed at once; 0 for one more than there are cores. One of several places is kept for
    /// requests that take little time. Default: 0.
    pub jobs: usize,
    /// Maximum time from the start of the wait for a job to the response; then the job is cancelled. An upload that
    /// could not be answered in time, as far as can be estimated, is refused at once. Default: one minute.
    pub time_limit: Duration,
    /// Maximum time for a complete upload. Default: five minutes.
    pub upload_time: Duration,
    /// How long a client may keep the server waiting: for a request, for its body, or for taking the response. Every byte of a
    /// body is worth some of that time: at 4,000 bytes per second the server does not wait. When three quarters of the
    /// connections are taken, others have one second. Default: 15 seconds.
    pub idle_time: Duration,
    /// How long a query is kept. Default: one hour.
    pub query_lifetime: Duration,
    /// Time between two looks at the file of the index, which is opened again when it has changed. Default: one second.
    pub index_check: Duration,
}

impl Default for ServeOptions {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 7878)),
            public_host: None,
            max_upload: 64_000_000,
            max_vertices: 200_000,
            max_uploads: 16,
            jobs: 0,
            time_limit: Duration::from_secs(60),
            upload_time: Duration::from_secs(300),
            idle_time: Duration::from_secs(15),
            query_lifetime: Duration::from_secs(3600),
            index_check: Duration::from_secs(1),
        }
    }
}
