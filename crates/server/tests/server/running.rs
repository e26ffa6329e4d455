//! A server in this process.

use std::net::SocketAddr;
use std::path::Path;
use std::thread::JoinHandle;

use canonform_server::{ServeOptions, Server, ServerError, Stop};

/// Options with a free port.
pub(crate) fn options() -> ServeOptions {
    ServeOptions { listen: "127.0.0.1:0".parse().unwrap(), ..ServeOptions::default() }
}

/// A running server, stopped on drop.
pub(crate) struct Running {
    pub(crate) address: SocketAddr,
    pub(crate) stop: Stop,
    thread: Option<JoinHandle<Result<(), ServerError>>>,
}

impl Running {
    pub(crate) fn start(index: &Path, options: ServeOptions) -> Self {
        let server = Server::bind(index, options).unwrap();
        let (address, stop) = (server.address(), server.stop_handle());
        Self { address, stop, thread: Some(std::thread::spawn(move || server.run())) }
    }

    /// Waits until a stopped server has ended, and returns its result once.
    pub(crate) fn join(&mut self) -> Option<std::thread::Result<Result<(), ServerError>>> {
        self.thread.take().map(JoinHandle::join)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.stop.stop();
        let _ = self.join();
    }
}
