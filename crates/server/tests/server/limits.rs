//! Limits in number and time, who may ask, and the end.

use std::fs;
use std::io::{Read, Write};
use std::time::Duration;

use canonform::mesh::shapes;
use canonform_server::ServeOptions;

use crate::client::{ask, connect, form, upload, upload_head};
use crate::running::options;
use crate::support::{Served, written};

/// The bytes of a mesh that takes a while.
fn large() -> Vec<u8> {
    written("large.ply", &shapes::torus(240, 120, 2.0, 0.6))
}

#[test]
fn meshes_beyond_the_limit_are_rejected() {
    let server = Served::start(ServeOptions { max_vertices: 287, ..options() });
    let mesh = fs::read(server.mesh("ring0")).unwrap();
    let answer = upload(server.address, &[("q.off", &mesh)], &[]).unwrap();
    assert_eq!(answer.status, 413);
    let json = answer.json();
    let error = json["error"].as_str().unwrap();
    assert!(error.starts_with("q.off, line 2: the mesh has more than 287 vertices"), "{error}");
    assert!(json["remedy"].as_str().unwrap().contains("vertex limit"));
}

#[test]
fn clients_of_a_full_queue_are_told_to_try_again() {
    let server = Served::start(ServeOptions { jobs: 1, queue: 1, max_uploads: 3, ..options() });
    let mesh = large();
    let answers: Vec<_> = std::thread::scope(|scope| {
        let clients: Vec<_> = (0..12)
            .map(|_| scope.spawn(|| upload(server.address, &[("q.ply", &mesh)], &[]).unwrap()))
            .collect();
        clients.into_iter().map(|client| client.join().unwrap()).collect()
    });
    let count = |status| answers.iter().filter(|answer| answer.status == status).count();
    assert!(count(200) >= 1 && count(503) >= 1 && count(200) + count(503) == 12);
    for answer in answers.iter().filter(|answer| answer.status == 503) {
        assert!(answer.header("retry-after").is_some());
        assert!(answer.json()["remedy"].as_str().unwrap().starts_with("try again"));
    }
    let small = fs::read(server.mesh("ring0")).unwrap();
    assert_eq!(upload(server.address, &[("q.off", &small)], &[]).unwrap().status, 200);
}

#[test]
fn requests_end_at_the_time_limit() {
    let server = Served::start(ServeOptions { time_limit: Duration::from_millis(30), ..options() });
    let answer = upload(server.address, &[("q.ply", &large())], &[]).unwrap();
    assert_eq!(answer.status, 503);
    assert!(answer.json()["error"].as_str().unwrap().contains("within 0.03 seconds"));
}

#[test]
fn silent_clients_are_disconnected() {
    let idle = Duration::from_millis(300);
    let server = Served::start(ServeOptions { idle_time: idle, upload_time: 4 * idle, ..options() });
    // An incomplete header; nothing at all; a missing body; a slow body.
    let mut header = connect(server.address).unwrap();
    header.write_all(b"GET / HTTP/1.1\r\nHost: loc").unwrap();
    let mut nothing = connect(server.address).unwrap();
    for silent in [&mut header, &mut nothing] {
        let mut rest = Vec::new();
        // Reset and closed are both fine.
        let _ = silent.read_to_end(&mut rest);
    }
    let (body, boundary) = form(&[("q.off", &[b'0'; 1000])], &[]);
    for drips in [false, true] {
        let mut stream = connect(server.address).unwrap();
        stream.write_all(upload_head(server.address, boundary, body.len()).as_bytes()).unwrap();
        for byte in &body[..if drips { 30 } else { 0 }] {
            if stream.write_all(&[*byte]).is_err() {
                break;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        assert_eq!(crate::client::read_answer(&mut stream).unwrap().status, 408, "dripping: {drips}");
    }
}

#[test]
fn requests_for_other_servers_are_rejected() {
    let server = Served::start(options());
    let port = server.address.port();
    let status = |method: &str, target: &str, headers: &[(&str, &str)]| {
        ask(server.address, method, target, headers, b"").unwrap().status
    };
    for host in ["localhost", "127.0.0.1", "[::1]"] {
        assert_eq!(status("GET", "/healthz", &[("Host", &format!("{host}:{port}"))]), 200);
    }
    for host in ["evil.example", &format!("evil.example:{port}"), "localhost.evil.example", "10.0.0.1"] {
        for target in ["/", "/healthz", "/api/shapes"] {
            assert_eq!(status("GET", target, &[("Host", host)]), 421, "{host}");
        }
    }
    // Two programs on the way could read different ones.
    let host = format!("127.0.0.1:{port}");
    let twice = [("Host", &*host), ("Host", "evil.example")];
    assert_eq!(status("GET", "/healthz", &twice), 400);
    assert_eq!(status("GET", "/healthz", &[twice[1], twice[0]]), 400);
    assert_eq!(status("GET", "http://evil.example/healthz", &[("Host", &host)]), 400);
    assert_eq!(status("GET", &format!("http://{host}/healthz"), &[("Host", &host)]), 200);
    let search = "/api/search?shape=ring0";
    let own = format!("http://127.0.0.1:{port}");
    assert_eq!(status("POST", search, &[("Origin", &own)]), 200);
    assert_eq!(status("POST", search, &[("Origin", &own), ("Origin", "http://evil.example")]), 400);
    for origin in
        ["http://evil.example", "null", "https://127.0.0.1", &format!("http://127.0.0.1:{}", port ^ 1)]
    {
        assert_eq!(status("POST", search, &[("Origin", origin)]), 403, "{origin}");
    }
}

#[test]
fn requests_in_progress_are_finished_after_a_stop() {
    let mut server = Served::start(options());
    let (address, mesh) = (server.address, large());
    let client = std::thread::spawn(move || upload(address, &[("q.ply", &mesh)], &[]).unwrap());
    // Until the upload has arrived and is being measured.
    std::thread::sleep(Duration::from_millis(300));
    server.stop.stop();
    assert_eq!(client.join().unwrap().status, 200);
    server.join().unwrap();
    assert!(connect(address).is_err(), "nobody listens any more");
}
