//! One connection: its bytes are counted, and it ends when its client is too slow.

use std::sync::Arc;
use std::time::Duration;

use axum::Extension;
use futures_util::future::{Either, select};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::Watcher;
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpStream;
use tokio_util::io::{InspectReader, InspectWriter};

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
    // For the guard, and for the reception of uploads.
    let requests = TowerToHyperService::new(router.layer(Extension(pace.clone())));
    let counted = |pace: &Arc<Pace>| {
        let pace = pace.clone();
        move |moved: &[u8]| pace.moved(moved.len())
    };
    let stream = InspectWriter::new(InspectReader::new(stream, counted(&pace)), counted(&pace));
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(idle_time)
        .max_buf_size(BUFFER)
        .serve_connection(TokioIo::new(stream), requests);
    let served = std::pin::pin!(watcher.watch(connection));
    let slow = std::pin::pin!(async {
        let (lost, late) = (std::pin::pin!(place.lost()), std::pin::pin!(pace.is_over(Phase::Waiting)));
        select(lost, late).await;
    });
    // Broken connections are not errors of the server.
    match select(served, slow).await {
        Either::Left(_) | Either::Right(_) => {}
    }
}
