//! Limits in number and time, who may ask, and the end.

use std::fs;
use std::io::{Read, Write};
use std::time::Duration;

use canonform::mesh::shapes;
use canonform_server::ServeOptions;
use testkit::written;

use crate::client::{ask, connect, form, upload, upload_head};
use crate::support::{Served, options};

/// The bytes of a mesh that takes a while.
fn large() -> Vec<u8> {
    written("large.ply", &shapes::torus(120, 80, 2.0, 0.6))
}

#[test]
fn meshes_beyond_the_limit_are_rejected() {
    let server = Served::start(ServeOptions { max_vertices: 287, ..options() });
    let mesh = fs::read(server.mesh("ring0")).unwrap();
    let answer = upload(server.address, &[("q.off", &mesh)], &[]).unwrap();
    assert_eq!(answer.status, 413);
    let [error, remedy] = ["error", "remedy"].map(|key| answer.json()[key].as_str().unwrap().to_owned());
    assert!(error.starts_with("q.off, line 2: the mesh exceeds the limit of 287 vertices"), "{error}");
    assert!(remedy.contains("vertex limit"));
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
    let idle = Duration::from_millis(200);
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
    let (body, boundary) = form(&[("q.off", &[b'0'; 1000])]);
    for drips in [false, true] {
        let mut stream = connect(server.address).unwrap();
        stream.write_all(upload_head(server.address, boundary, body.len()).as_bytes()).unwrap();
        for byte in &body[..if drips { 15 } else { 0 }] {
            if stream.write_all(&[*byte]).is_err() {
                break;
            }
            std::thread::sleep(Duration::from_millis(100));
        }
        assert_eq!(crate::client::read_answer(&mut stream).unwrap().status, 408, "dripping: {drips}");
    }
}

#[test]
fn clients_that_take_no_response_are_disconnected() {
    let idle = Duration::from_millis(200);
    let server = Served::start(ServeOptions { idle_time: idle, ..options() });
    let file = ask(server.address, "GET", "/assets/plotly.js", &[], b"").unwrap().body.len();
    let mut stream = connect(server.address).unwrap();
    let request = format!("GET /assets/plotly.js HTTP/1.1\r\nHost: {}\r\n\r\n", server.address);
    // More than all buffers between the two hold.
    let n = (64 << 20) / file;
    stream.write_all(request.repeat(n).as_bytes()).unwrap();
    std::thread::sleep(10 * idle);
    let mut taken = Vec::new();
    let _ = stream.read_to_end(&mut taken);
    assert!(taken.len() < n * file / 2, "{} of {} bytes", taken.len(), n * file);
}

#[test]
fn uploads_beyond_the_memory_for_them_are_refused() {
    let limits = ServeOptions { max_upload: 200_000, max_uploads: 1, ..options() };
    let server = Served::start(limits);
    let mesh = fs::read(server.mesh("ring0")).unwrap();
    let (_, boundary) = form(&[]);
    let mut first = connect(server.address).unwrap();
    first.write_all(upload_head(server.address, boundary, 200_000).as_bytes()).unwrap();
    // Nothing of it is a file.
    first.write_all(&[b'0'; 199_000]).unwrap();
    std::thread::sleep(Duration::from_millis(300));
    let second = upload(server.address, &[("q.off", &[b'0'; 100_000])], &[]).unwrap();
    assert_eq!((second.status, second.header("retry-after")), (503, Some("2")));
    drop(first);
    std::thread::sleep(Duration::from_millis(300));
    assert_eq!(upload(server.address, &[("q.off", &mesh)], &[]).unwrap().status, 200);
}

#[test]
fn a_proxy_may_pass_on_its_name_if_it_is_told() {
    let public_host = Some("shapes.example.org".to_owned());
    let server = Served::start(ServeOptions { public_host, ..options() });
    for (host, expected) in [
        ("localhost", 200),
        ("Shapes.Example.ORG", 200),
        ("shapes.example.org:8443", 200),
        ("shapes.example.org.evil.example", 421),
        ("x.shapes.example.org", 421),
    ] {
        let answer = ask(server.address, "GET", "/healthz", &[("Host", host)], b"").unwrap();
        assert_eq!(answer.status, expected, "{host}");
    }
}

#[test]
fn only_own_pages_and_programs_may_ask() {
    let server = Served::start(options());
    let work = [
        ("GET", "/api/search?shape=ring0&geometry=false"),
        ("POST", "/api/search"),
        ("GET", "/api/compare?a=none&b=ring1"),
        ("GET", "/api/match?a=none&b=ring1"),
        ("GET", "/api/duplicates"),
        ("GET", "/api/shapes"),
        ("GET", "/api/shapes/ring0/mesh"),
        ("GET", "/api/shapes/ring0/form"),
        ("GET", "/api/shapes/ring0/file"),
        ("GET", "/api/shapes/ring0/thumbnail"),
        ("GET", "/api/openapi.json"),
        ("GET", "/healthz"),
    ];
    let described = ask(server.address, "GET", "/api/openapi.json", &[], b"").unwrap().json();
    for path in described["paths"].as_object().unwrap().keys() {
        let path = path.replace("{id}", "ring0");
        let is_tried = work.iter().any(|(_, target)| target.split('?').next() == Some(&*path));
        assert!(is_tried, "{path} is not tried");
    }
    let status =
        |(method, target), headers: &[_]| ask(server.address, method, target, headers, b"").unwrap().status;
    let [same, cross] = ["same-origin", "cross-site"].map(|site| ("Sec-Fetch-Site", site));
    let foreign = ("Origin", "http://evil.example");
    for asked in work {
        // An upload without a form and a pair without its first shape cost nothing.
        let allowed: &[u16] = match asked {
            ("POST", _) => &[415],
            (_, target) if target.contains("a=none") => &[404],
            _ => &[200, 202],
        };
        for headers in [&[][..], &[same]] {
            assert!(allowed.contains(&status(asked, headers)), "{asked:?} {headers:?}");
        }
        assert_eq!([status(asked, &[cross]), status(asked, &[foreign])], [403, 403], "{asked:?}");
    }
}

#[test]
fn requests_in_progress_are_finished_after_a_stop() {
    let mut server = Served::start(options());
    let (address, mesh) = (server.address, large());
    let client = std::thread::spawn(move || upload(address, &[("q.ply", &mesh)], &[]).unwrap());
    // Until the upload has arrived and is being measured.
    std::thread::sleep(Duration::from_millis(100));
    server.stop.stop();
    assert_eq!(client.join().unwrap().status, 200);
    server.join().unwrap();
    assert!(connect(address).is_err(), "nobody listens any more");
}
