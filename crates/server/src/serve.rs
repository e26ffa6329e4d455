//! Connections and shutdown.

use std::net::{SocketAddr, TcpListener};
use std::path::Path;
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;

use axum::http::{HeaderValue, header};
use axum::middleware::{from_fn, from_fn_with_state};
use axum::response::IntoResponse;
use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::io::AsyncReadExt;
use tokio::net::TcpStream;
use tokio::sync::Semaphore;
use tokio_io_timeout::TimeoutStream;
use tokio_util::sync::CancellationToken;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::set_header::SetResponseHeaderLayer;

use crate::app::App;
use crate::error::{ApiError, ServerError};
use crate::guard::{HEADERS, refuse_foreign_pages, refuse_other_hosts};
use crate::options::{STACK, ServeOptions};
use crate::upload::Patience;
use crate::{api, page};

/// Pause after a connection could not be accepted, for example because of too many open files.
const RETRY_PAUSE: Duration = Duration::from_millis(100);

/// Most connections. A further one waits.
const CONNECTIONS: usize = 256;

/// When so few connections are left, clients must hurry to get them, so that slow ones hold up nobody.
const RESERVED: usize = CONNECTIONS / 4;

/// How long a client may keep the server waiting on a reserved connection.
const HURRY: Duration = Duration::from_secs(1);

/// Maximum size of a request header, and of one read of a body, in bytes.
const BUFFER: usize = 64 << 10;

/// Many clients read the response only after they have sent everything, and not at all if the connection breaks before. So
/// the rest of a refused upload is read and dropped, for so long and up to so many bytes.
const REFUSED_TIME: Duration = Duration::from_secs(5);
const REFUSED_BYTES: u64 = 256 << 20;

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
            .layer(from_fn_with_state(app.clone(), refuse_other_hosts))
            .layer(CatchPanicLayer::custom(|_| ApiError::internal().into_response()));
        let router = HEADERS.into_iter().fold(router, |router, (name, value)| {
            router.layer(SetResponseHeaderLayer::overriding(name, HeaderValue::from_static(value)))
        });
        // No cache keeps responses, except for images and scripts, which have their own header.
        let uncached = HeaderValue::from_static("no-store");
        let router = router
            .layer(SetResponseHeaderLayer::if_not_present(header::CACHE_CONTROL, uncached))
            .with_state(app.clone());
        let refreshing = tokio::spawn(refresh(app.clone()));
        let idle_time = app.options.idle_time;
        let slots = Arc::new(Semaphore::new(CONNECTIONS));
        let accepting = async {
            loop {
                let slot = slots.clone().acquire_owned().await;
                let Ok((stream, _)) = listener.accept().await else {
                    tokio::time::sleep(RETRY_PAUSE).await;
                    continue;
                };
                let is_reserved = slots.available_permits() < RESERVED;
                let patience = if is_reserved { idle_time.min(HURRY) } else { idle_time };
                let answered = answer(stream, router.clone(), Patience(patience), self.stop.0.clone());
                tokio::spawn(async move {
                    answered.await;
                    drop(slot);
                });
            }
        };
        self.stop.0.run_until_cancelled(accepting).await;
        drop(listener);
        refreshing.abort();
        app.duplicates.cancel();
        let all_ended = slots.acquire_many(CONNECTIONS as u32);
        let _ = tokio::time::timeout(GRACE, all_ended).await;
        Ok(())
    }
}

/// Answers all requests of a connection; after a stop, only the one in progress.
async fn answer(stream: TcpStream, router: Router, patience: Patience, stop: CancellationToken) {
    let mut stream = pin!(TimeoutStream::new(stream));
    stream.as_mut().set_write_timeout_pinned(Some(patience.0));
    let served = {
        let requests = TowerToHyperService::new(router.layer(Extension(patience)));
        let connection = http1::Builder::new()
            .timer(TokioTimer::new())
            .header_read_timeout(patience.0)
            .max_buf_size(BUFFER)
            .serve_connection(TokioIo::new(stream.as_mut()), requests);
        let mut connection = pin!(connection);
        match stop.run_until_cancelled(connection.as_mut()).await {
            Some(served) => served,
            None => {
                connection.as_mut().graceful_shutdown();
                connection.await
            }
        }
    };
    // Broken connections are not errors of the server.
    if served.is_ok() {
        let (mut rest, mut nothing) = (stream.take(REFUSED_BYTES), tokio::io::sink());
        let draining = tokio::io::copy(&mut rest, &mut nothing);
        let draining = tokio::time::timeout(REFUSED_TIME.min(patience.0), draining);
        stop.run_until_cancelled(draining).await;
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
