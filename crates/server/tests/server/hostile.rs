//! Malicious and broken uploads: each gets an error that says why, and the server keeps running.

use std::fs;
use std::io::{Read, Write};
use std::path::Path;

use canonform::mesh::shapes;
use canonform_server::ServeOptions;
use testkit::written;

use crate::client::{Answer, ask, connect, form, read_answer, upload};
use crate::support::{Served, options};

type Files = Vec<(String, Vec<u8>)>;

fn one(name: &str, content: impl Into<Vec<u8>>) -> Files {
    vec![(name.to_owned(), content.into())]
}

/// Bad uploads of every kind beside those of `tests/contracts`.
fn hostile() -> Vec<Files> {
    let ball = shapes::icosphere(2);
    let [vert, tri, off] = ["b.vert", "b.tri", "a.off"].map(|name| written(name, &ball));
    let mut all = vec![
        one("b.vert", &*vert),
        one("b.tri", &*tri),
        [one("b.vert", &*vert), one("c.tri", &*tri)].concat(),
        [one("b.vert", &*vert), one("b.vert", &*vert)].concat(),
        [one("a.off", &*off), one("b.off", &*off)].concat(),
        [one("a.vert", "0 0 x\n1 0 0\n0 1 0\n"), one("a.tri", "1 2 3\n")].concat(),
    ];
    // Bad names.
    for name in ["../../etc/passwd", "C:\\boot.ini", "a.txt", "a.off.exe", "off", "a.", "..", " "] {
        all.push(one(name, &*off));
    }
    all.extend([
        one(&"x".repeat(5000), &*off),
        one("a.mat", "MATLAB 7.3 MAT-file"),
        // One endless line, many short ones, one huge polygon.
        one("a.off", "1 ".repeat(1 << 20)),
        one("a.obj", "v 0 0 0\n".repeat(300_000)),
        one("a.obj", format!("v 0 0 0\n{}", "f 1 1 1\n".repeat(900_000))),
        one("a.obj", format!("v 0 0 0\nf{}\n", " 1".repeat(1_000_000))),
    ]);
    all
}

fn check(what: &str, answer: &Answer) {
    let json = answer.json();
    let error = json["error"].as_str().unwrap_or_default();
    assert!((400..500).contains(&answer.status), "{what}: {} {error}", answer.status);
    assert!(error.len() > 10 && error.len() < 1000, "{what}: {error}");
    assert!(!error.contains("etc/") && !error.contains("boot\\"), "{what}: {error}");
}

fn still_serves(server: &Served) {
    let mesh = fs::read(server.mesh("ring0")).unwrap();
    let found = upload(server.address, &[("q.off", &mesh)], &[]).unwrap();
    assert_eq!((found.status, found.json()["results"][0]["id"].as_str()), (200, Some("ring0")));
}

#[test]
fn bad_meshes_get_an_error() {
    let server = Served::start(options());
    for files in hostile() {
        let files: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (&name[..], &bytes[..])).collect();
        let (name, content) = files[0];
        let what = String::from_utf8_lossy(&content[..content.len().min(60)]);
        check(&format!("{name}: {what}"), &upload(server.address, &files, &[]).unwrap());
    }
    still_serves(&server);
}

#[test]
fn meshes_that_the_command_line_refuses_are_refused_in_its_words() {
    let server = Served::start(ServeOptions { max_vertices: u64::MAX, ..options() });
    let contracts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/contracts");
    let table = fs::read_to_string(contracts.join("broken-meshes.tsv")).unwrap();
    let refused = table.lines().map(|row| row.split('\t').collect::<Vec<_>>()).filter(|row| row[4] == "2, 2");
    let mut n_refused = 0;
    for row in refused {
        let mesh = fs::read(contracts.join("meshes").join(row[0])).unwrap();
        let answer = upload(server.address, &[(row[0], &mesh)], &[]).unwrap();
        check(row[0], &answer);
        let words = row[2].split("; ").next().unwrap();
        assert!(answer.json()["error"].as_str().unwrap().contains(words), "{}: {}", row[0], answer.json());
        n_refused += 1;
    }
    assert!(n_refused > 30, "{n_refused}");
    still_serves(&server);
}

#[test]
fn bad_forms_get_an_error() {
    let server = Served::start(options());
    let mesh = fs::read(server.mesh("ring0")).unwrap();
    let (body, boundary) = form(&[("q.off", &mesh)]);
    let multipart = format!("multipart/form-data; boundary={boundary}");
    let post = |kind: &str, body: &[u8]| {
        ask(server.address, "POST", "/api/search", &[("Content-Type", kind)], body).unwrap()
    };
    let field = "--x\r\nContent-Disposition: form-data; name=\"k\"\r\n\r\n3\r\n--x--";
    let parts = field.replace("--x--", "").replace("\"k\"", "\"k\"; filename=\"a.off\"").repeat(1000);
    let headers = format!("--x\r\n{}\r\n\r\n", "A: b\r\n".repeat(10_000));
    for (what, kind, body) in [
        ("no form", "application/json", &b"{}"[..]),
        ("no boundary", "multipart/form-data", &body),
        ("no end", &multipart, &body[..body.len() / 2]),
        ("nothing", &multipart, b""),
        ("no parts", "multipart/form-data; boundary=x", b"--x--\r\n"),
        ("a field", "multipart/form-data; boundary=x", field.as_bytes()),
        ("many files", "multipart/form-data; boundary=x", parts.as_bytes()),
        ("many headers", "multipart/form-data; boundary=x", headers.as_bytes()),
    ] {
        check(what, &post(kind, body));
    }
    let mesh = [("q.off", &mesh[..])];
    let long = "x".repeat(2000);
    for parameter in
        [("k", "0"), ("k", "101"), ("k", "x"), ("explain", "perhaps"), ("other", "1"), ("k", &long)]
    {
        check(parameter.0, &upload(server.address, &mesh, &[parameter]).unwrap());
    }
    check("no file", &upload(server.address, &[], &[("k", "3")]).unwrap());
    check("an empty choice", &upload(server.address, &[("", b"")], &[]).unwrap());
    let wrong = ask(server.address, "POST", "/api/search?k=-1", &[], b"").unwrap();
    check("a negative number", &wrong);
    let json = wrong.json();
    assert!(json["error"].as_str().unwrap().ends_with(" k: use a whole number, 0 or more"), "{json}");
    assert!(json["remedy"].as_str().unwrap().starts_with("/api/openapi.json"), "{json}");
    still_serves(&server);
}

#[test]
fn a_gigabyte_of_zeros_is_cut_off() {
    let limited = ServeOptions { max_upload: 1 << 20, ..options() };
    let server = Served::start_alone(limited);
    let head = |length: &str| {
        format!(
            "POST /api/search HTTP/1.1\r\nHost: {}\r\nContent-Type: multipart/form-data; boundary=x\r\n{length}\r\n\r\n",
            server.address
        )
    };
    let part = b"--x\r\nContent-Disposition: form-data; name=\"m\"; filename=\"a.off\"\r\n\r\n";
    let zeros = vec![0; 1 << 20];
    let before = resident();
    for announced in [true, false] {
        let mut stream = connect(server.address).unwrap();
        let length = if announced { "Content-Length: 1073741824" } else { "Transfer-Encoding: chunked" };
        stream.write_all(head(length).as_bytes()).unwrap();
        let mut answers = stream.try_clone().unwrap();
        let answer = std::thread::spawn(move || read_answer(&mut answers).unwrap());
        let chunk = |bytes: &[u8]| match announced {
            true => bytes.to_vec(),
            false => [format!("{:x}\r\n", bytes.len()).as_bytes(), bytes, b"\r\n"].concat(),
        };
        let mut sent = 0;
        stream.write_all(&chunk(part)).unwrap();
        while sent < 1 << 30 && stream.write_all(&chunk(&zeros)).is_ok() {
            sent += zeros.len();
        }
        assert!(sent < 1 << 30, "all of it was taken");
        let answer = answer.join().unwrap();
        check("a gigabyte", &answer);
        assert_eq!(answer.status, 413);
    }
    if let (Some(before), Some(after)) = (before, resident()) {
        assert!(after < before + (64 << 20), "{before} bytes before, {after} after");
    }
    still_serves(&server);
}

/// Resident memory of this process in bytes, where the system tells it.
fn resident() -> Option<usize> {
    let mut text = String::new();
    fs::File::open("/proc/self/statm").ok()?.read_to_string(&mut text).ok()?;
    Some(text.split(' ').nth(1)?.parse::<usize>().ok()? * 4096)
}
