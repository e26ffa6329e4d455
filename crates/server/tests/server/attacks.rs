//! Attacks: the server still answers `/healthz`, and a normal upload within its time limit.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use canonform::mesh::shapes;
use canonform_server::ServeOptions;
use testkit::written;

use crate::client::{Answer, ask, connect, form, upload, upload_head};
use crate::support::{Served, options};

/// Asks for the health of the server and searches with a normal mesh, several times.
fn assert_serves(server: &Served) {
    let mesh = fs::read(server.mesh("ring0")).unwrap();
    for _ in 0..3 {
        assert_eq!(ask(server.address, "GET", "/healthz", &[], b"").unwrap().status, 200);
        let found = upload(server.address, &[("q.off", &mesh)], &[("geometry", "false")]).unwrap();
        assert_eq!(found.status, 200, "{}", String::from_utf8_lossy(&found.body));
    }
}

/// A polygon with this many corners: one vertex of its triangulation has all of them as neighbors.
fn polygon(corners: usize) -> Vec<u8> {
    let mut text = format!("OFF\n{corners} 1 0\n");
    for i in 0..corners {
        let angle = std::f64::consts::TAU * i as f64 / corners as f64;
        text += &format!("{:.7} {:.7} 0\n", angle.cos(), angle.sin());
    }
    text += &corners.to_string();
    (0..corners).for_each(|i| text += &format!(" {i}"));
    text.into_bytes()
}

/// The answers to clients that all send a mesh at once, while others are served.
fn attacked(server: &Served, n: usize, name: &str, mesh: &[u8]) -> Vec<Answer> {
    let attack = || upload(server.address, &[(name, mesh)], &[("geometry", "false")]).unwrap();
    std::thread::scope(|scope| {
        let attackers: Vec<_> = (0..n).map(|_| scope.spawn(attack)).collect();
        std::thread::sleep(Duration::from_millis(500));
        assert_serves(server);
        attackers.into_iter().map(|attacker| attacker.join().unwrap()).collect()
    })
}

#[test]
#[ignore = "slow: make test-all"]
fn uploads_of_huge_polygons_free_their_places_at_the_time_limit() {
    let limit = Duration::from_secs(8);
    let server = Served::start_alone(ServeOptions { time_limit: limit, ..options() });
    for answer in attacked(&server, 4, "hub.off", &polygon(100_000)) {
        assert!([200, 422, 503].contains(&answer.status), "{}", answer.status);
    }
    assert_serves(&server);
}

#[test]
#[ignore = "slow: make test-all"]
fn large_uploads_are_answered_in_time_or_refused_at_once() {
    let limit = Duration::from_secs(30);
    let server = Served::start_alone(ServeOptions { time_limit: limit, max_uploads: 20, ..options() });
    // 2 MB, some seconds each.
    let mesh = written("large.off", &shapes::torus(200, 160, 2.0, 0.6));
    let answers = attacked(&server, 20, "large.off", &mesh);
    let (done, refused): (Vec<_>, Vec<_>) = answers.iter().partition(|answer| answer.status == 200);
    assert!(!done.is_empty(), "some are answered");
    assert!(refused.iter().all(|answer| answer.status == 503));
    // Those without a place are told so before their upload is taken.
    let early = refused.iter().filter(|answer| answer.header("retry-after").is_some()).count();
    assert!(early >= 12, "{} answered, {early} refused at once", done.len());
}

#[test]
fn the_job_of_a_client_that_disconnects_is_cancelled() {
    let server = Served::start_alone(ServeOptions { jobs: 1, ..options() });
    let mesh = written("large.off", &shapes::torus(300, 300, 2.0, 0.6));
    let (body, boundary) = form(&[("large.off", &mesh)]);
    let small = fs::read(server.mesh("ring0")).unwrap();
    let status = || upload(server.address, &[("q.off", &small)], &[]).unwrap().status;
    let attacked = || {
        let mut attacker = connect(server.address).unwrap();
        attacker.write_all(upload_head(server.address, boundary, body.len()).as_bytes()).unwrap();
        attacker.write_all(&body).unwrap();
        std::thread::sleep(Duration::from_millis(700));
        std::thread::scope(|scope| {
            let waiting = scope.spawn(status);
            std::thread::sleep(Duration::from_secs(1));
            // Its job takes the only place, and would for much longer than a test waits; unless it came too late for it.
            if waiting.is_finished() {
                return false;
            }
            let start = Instant::now();
            drop(attacker);
            assert_eq!(waiting.join().unwrap(), 200);
            assert!(start.elapsed() < Duration::from_secs(5), "the large job goes on");
            true
        })
    };
    assert!((0..10).any(|_| attacked()), "the large job never begins");
}

/// Keeps connections open and does something on each of them again and again, until the end of `meanwhile`.
fn besieged(
    server: &Served,
    n: usize,
    open: impl Fn(&mut TcpStream) + Sync,
    again: impl Fn(&mut TcpStream) + Sync,
    meanwhile: impl FnOnce(),
) {
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let start = || {
                let mut stream = connect(server.address).unwrap();
                open(&mut stream);
                stream
            };
            let mut streams: Vec<TcpStream> = (0..n).map(|_| start()).collect();
            while !done.load(Ordering::Relaxed) {
                for stream in &mut streams {
                    again(stream);
                    // Whoever is disconnected comes back.
                    stream.set_nonblocking(true).unwrap();
                    if matches!(stream.read(&mut [0; 1]), Ok(0)) {
                        *stream = start();
                    } else {
                        stream.set_nonblocking(false).unwrap();
                    }
                }
                std::thread::sleep(Duration::from_millis(200));
            }
        });
        std::thread::sleep(Duration::from_secs(1));
        // Ends the attack also if this panics.
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(meanwhile));
        done.store(true, Ordering::Relaxed);
        outcome.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    });
}

#[test]
#[ignore = "slow: make test-all"]
fn idle_connections_give_way() {
    let server = Served::start_alone(options());
    besieged(&server, 300, |_| (), |_| (), || assert_serves(&server));
}

#[test]
fn uploads_of_a_byte_now_and_then_give_way() {
    let server = Served::start_alone(options());
    let (_, boundary) = form(&[]);
    let head = upload_head(server.address, boundary, 1_000_000) + &format!("--{boundary}\r\n");
    let open = |stream: &mut TcpStream| drop(stream.write_all(head.as_bytes()));
    let again = |stream: &mut TcpStream| drop(stream.write_all(b"C"));
    besieged(&server, 300, open, again, || assert_serves(&server));
}
