//! One connection: its bytes are counted, and it ends when its client is too slow.

use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::extract::Request;
use futures_util::future::{Either, select};
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::{Service, service_fn};
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::Watcher;
use hyper_util::service::TowerToHyperService;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;

use crate::pace::{Pace, Phase};
use crate::places::Place;

/// Maximum size of a request header, and of one read of a body, in bytes.
const BUFFER: usize = 64 << 10;

/// Answers all requests of a connection. Ends with the connection, when its place is lost, and when its client takes no
/// response or sends no request for `idle_time`, beyond what the bytes that moved account for.
pub(crate) async fn serve(
    stream: TcpStream,
    place: Place,
    pace: Arc<Pace>,
    router: axum::Router,
    watcher: Watcher,
    idle_time: Duration,
) {
    let router = TowerToHyperService::new(router);
    let requests = {
        let pace = pace.clone();
        service_fn(move |mut request: hyper::Request<Incoming>| {
            // For the guard, and for the reception of uploads.
            request.extensions_mut().insert(pace.clone());
            router.call(request)
        })
    };
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(idle_time)
        .max_buf_size(BUFFER)
        .serve_connection(TokioIo::new(Counted { stream, pace: pace.clone() }), requests);
    let served = std::pin::pin!(watcher.watch(connection));
    let slow = std::pin::pin!(async {
        let (lost, late) =
            (std::pin::pin!(place.lost()), std::pin::pin!(pace.exceeds(idle_time, &[Phase::Waiting])));
        select(lost, late).await;
    });
    // Broken connections are not errors of the server.
    match select(served, slow).await {
        Either::Left(_) | Either::Right(_) => {}
    }
}

/// The account of the connection of a request.
pub(crate) fn pace_of(request: &Request) -> Option<Arc<Pace>> {
    request.extensions().get::<Arc<Pace>>().cloned()
}

/// A stream that tells its account how many bytes move.
struct Counted {
    stream: TcpStream,
    pace: Arc<Pace>,
}

impl Counted {
    fn count(&self, moved: Poll<io::Result<usize>>) -> Poll<io::Result<usize>> {
        if let Poll::Ready(Ok(bytes)) = moved {
            self.pace.moved(bytes);
        }
        moved
    }
}

impl AsyncRead for Counted {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        let read = Pin::new(&mut self.stream).poll_read(context, buffer);
        self.pace.moved(buffer.filled().len() - before);
        read
    }
}

impl AsyncWrite for Counted {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write(context, bytes);
        self.count(written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        pieces: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.stream).poll_write_vectored(context, pieces);
        self.count(written)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}
