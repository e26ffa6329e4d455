//! Arguments of `canonform serve`.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use server::ServeOptions;

#[derive(Debug, Args)]
pub(crate) struct ServeArgs {
    /// The index
    pub(crate) index: PathBuf,
    /// Address and port; port 0 takes a free port. Machines that can reach the address can search, and see the index and its
    /// meshes
    #[arg(long, value_name = "ADDRESS:PORT", default_value_t = ServeOptions::default().listen)]
    pub(crate) listen: SocketAddr,
    /// The host name that a reverse proxy passes on, such as shapes.example.org
    #[arg(long, value_name = "NAME", value_parser = host_name)]
    pub(crate) public_host: Option<String>,
    /// Largest upload, in megabytes
    #[arg(long, value_name = "MB", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=2000))]
    pub(crate) max_upload: u32,
    /// Largest mesh to accept, in vertices
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) max_vertices: u64,
    /// Time limit of a request, in seconds
    #[arg(long, value_name = "S", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=3600))]
    pub(crate) time_limit: u64,
    /// Requests to process at once; of several places one is kept for short ones [default: one more than there are cores]
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) jobs: usize,
}

impl ServeArgs {
    pub(crate) fn options(&self) -> ServeOptions {
        ServeOptions {
            listen: self.listen,
            public_host: self.public_host.clone(),
            max_upload: self.max_upload as usize * 1_000_000,
            max_vertices: self.max_vertices,
            time_limit: Duration::from_secs(self.time_limit),
            jobs: self.jobs,
            ..ServeOptions::default()
        }
    }
}

fn host_name(text: &str) -> Result<String, &'static str> {
    let is_name = !text.is_empty() && !text.contains(['/', ':']);
    is_name.then(|| text.to_owned()).ok_or("give the name alone, without https:// and without a port")
}
