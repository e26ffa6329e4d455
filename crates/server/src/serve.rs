//! Connections and shutdown.

use std::net::{SocketAddr, TcpListener};
use std::path::Path;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::middleware::{from_fn, from_fn_with_state};
use futures_util::future::{Either, select};
use hyper_util::server::graceful::GracefulShutdown;
use tokio_util::sync::CancellationToken;

use crate::app::App;
use crate::error::ServerError;
use crate::guard::{guard, refuse_foreign_pages};
use crate::options::{STACK, ServeOptions};
use crate::pace::Pace;
use crate::places::Places;
use crate::{api, connection, page};

/// Pause after a connection could not be accepted, for example because of too many open files.
const RETRY_PAUSE: Duration = Duration::from_millis(100);

/// Most connections; a further one takes the place of the one that has kept the server waiting longest.
const CONNECTIONS: usize = 256;

/// How long requests in progress may take to finish after the server is stopped.
const GRACE: Duration = Duration::from_secs(30);

/// A server with its address and its index, ready to [`run`](Self::run).
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    app: Arc<App>,
    stop: Stop,
}

impl std::fmt::Debug for Server {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Server").field("address", &self.address).finish_non_exhaustive()
    }
}

/// Stops a server.
#[derive(Debug, Clone, Default)]
pub struct Stop(CancellationToken);

impl Stop {
    /// Accepts no more connections and finishes the requests in progress.
    pub fn stop(&self) {
        self.0.cancel();
    }
}

impl Server {
    /// Opens the index and binds the address.
    ///
    /// # Errors
    /// [`ServerError::Index`] for the index, [`ServerError::Listen`] for the address.
    pub fn bind(index: &Path, options: ServeOptions) -> Result<Self, ServerError> {
        let app = Arc::new(App::open(index, options)?);
        let asked = app.options.listen;
        let fault = |source| ServerError::Listen { address: asked, source };
        let listener = TcpListener::bind(asked).map_err(fault)?;
        listener.set_nonblocking(true).map_err(fault)?;
        let address = listener.local_addr().map_err(fault)?;
        Ok(Self { listener, address, app, stop: Stop::default() })
    }

    /// The address, with the actual port if port 0 was requested.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Number of shapes in its index.
    #[must_use]
    pub fn n_shapes(&self) -> usize {
        self.app.served.collection().shapes.len()
    }

    /// A handle that stops the server from another thread.
    #[must_use]
    pub fn stop_handle(&self) -> Stop {
        self.stop.clone()
    }

    /// Serves until it is stopped and the requests in progress are finished or out of time.
    ///
    /// # Errors
    /// [`ServerError::Runtime`] if threads cannot be started.
    pub fn run(self) -> Result<(), ServerError> {
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .enable_all()
            .thread_stack_size(STACK)
            .build()
            .map_err(ServerError::Runtime)?;
        let served = runtime.block_on(self.serve());
        runtime.shutdown_timeout(GRACE);
        served
    }

    async fn serve(self) -> Result<(), ServerError> {
        let listener = tokio::net::TcpListener::from_std(self.listener).map_err(ServerError::Runtime)?;
        let app = self.app;
        // Pages elsewhere may link to the pages here, which begin no work before their own scripts ask for it.
        let router = api::router()
            .layer(from_fn(refuse_foreign_pages))
            .merge(page::router())
            .layer(from_fn_with_state(app.clone(), guard))
            .with_state(app.clone());
        let refreshing = tokio::spawn(refresh(app.clone()));
        let options = &app.options;
        let places = Places::new(CONNECTIONS);
        let graceful = GracefulShutdown::new();
        loop {
            let next = pin!(async {
                let (stream, _) = listener.accept().await?;
                let pace = Arc::new(Pace::new(options.idle_time));
                let place = places.enter(&pace).await;
                Ok::<_, std::io::Error>((stream, place, pace))
            });
            let stopped = pin!(self.stop.0.cancelled());
            let Either::Left((accepted, _)) = select(next, stopped).await else { break };
            let Ok((stream, place, pace)) = accepted else {
                tokio::time::sleep(RETRY_PAUSE).await;
                continue;
            };
            let watcher = graceful.watcher();
            tokio::spawn(connection::serve(stream, place, pace, router.clone(), watcher, options.idle_time));
        }
        drop(listener);
        refreshing.abort();
        app.duplicates.cancel();
        let _ = tokio::time::timeout(GRACE, graceful.shutdown()).await;
        Ok(())
    }
}

/// Looks again and again whether the index has changed.
async fn refresh(app: Arc<App>) {
    loop {
        tokio::time::sleep(app.options.index_check).await;
        app.duplicates.cancel_unwanted();
        let shared = app.clone();
        // A panic while opening leaves the old index in service.
        let _ = tokio::task::spawn_blocking(move || shared.served.refresh()).await;
    }
}
