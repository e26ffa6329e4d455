//! Malicious and broken uploads: each gets an error that says why, and the server keeps running.

use std::fs;
use std::io::{Read, Write};

use canonform::mesh::shapes;
use canonform_server::ServeOptions;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::client::{Answer, ask, connect, form, read_answer, upload};
use crate::running::options;
use crate::support::{Served, written};

type Files = Vec<(String, Vec<u8>)>;

fn one(name: &str, content: impl Into<Vec<u8>>) -> Files {
    vec![(name.to_owned(), content.into())]
}

/// A MATLAB file of a compressed variable with this content.
fn zipped(content: &[&[u8]]) -> Vec<u8> {
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
    content.iter().for_each(|piece| zlib.write_all(piece).unwrap());
    let data = zlib.finish().unwrap();
    let mut file = format!("{:124}", "MATLAB 5.0 MAT-file").into_bytes();
    file.extend(b"\x00\x01IM");
    file.extend([15u32.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat());
    file.extend(data);
    file
}

/// Two hundred bad uploads.
fn hostile() -> Vec<(String, Files)> {
    let mut all: Vec<(String, Files)> = Vec::new();
    let mut add = |what: String, files: Files| all.push((what, files));
    let ball = shapes::icosphere(2);
    let written = |name: &str| written(name, &ball);
    // Truncated. Formats without counts in a header are cut within a line of their faces.
    for name in ["a.off", "a.ply", "a.stl"] {
        let whole = written(name);
        for share in 0..20 {
            add(format!("{name} cut at {share}/20"), one(name, &whole[..whole.len() * share / 20]));
        }
    }
    for name in ["a.obj", "a.tri"] {
        let whole = written(name);
        let text = String::from_utf8(whole).unwrap();
        for line in 1..6 {
            let place = text.match_indices('\n').rev().nth(line).unwrap().0;
            let cut = format!("{}f 1 2\n1 2\n", &text[..place + 1]);
            let mut files = one(name, cut);
            if name == "a.tri" {
                files.push(("a.vert".to_owned(), written("a.vert")));
            }
            add(format!("{name} cut {line} lines before its end"), files);
        }
    }
    let vert = written("b.vert");
    add("half a pair".into(), one("b.vert", vert.clone()));
    add("the other half".into(), one("b.tri", written("b.tri")));
    add("two halves of two".into(), [one("b.vert", vert.clone()), one("c.tri", written("b.tri"))].concat());
    add("a half twice".into(), [one("b.vert", vert.clone()), one("b.vert", vert)].concat());
    add("two meshes".into(), [one("a.off", written("a.off")), one("b.off", written("a.off"))].concat());
    // Headers with huge counts.
    for count in ["200001", "4000000000", "4294967295", "99999999999999999999", "-1", "1e18", "nan"] {
        add(format!("OFF {count}"), one("a.off", format!("OFF\n{count} {count} 0\n0 0 0\n")));
        add(
            format!("OFF {count} faces"),
            one("a.off", format!("OFF\n3 {count} 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")),
        );
        let ply = |vertices: &str, faces: &str| {
            format!(
                "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
                 property float z\nelement face {faces}\nproperty list uint uint vertex_indices\nend_header\n0123456789"
            )
        };
        add(format!("PLY {count}"), one("a.ply", ply(count, "1")));
        add(format!("PLY {count} faces"), one("a.ply", ply("0", count)));
        // A relative index before the first vertex: -1 would be the last one.
        let count = if count == "-1" { "-4" } else { count };
        add(format!("OBJ face {count}"), one("a.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {count}\n")));
        add(format!("OFF corners {count}"), one("a.off", format!("OFF\n1 1 0\n0 0 0\n{count} 0 0 0\n")));
    }
    for count in [1u32, 800_001, u32::MAX] {
        add(
            format!("STL {count}"),
            one("a.stl", [&[0; 80][..], &count.to_le_bytes(), b"0123456789"].concat()),
        );
        let list = [
            &b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n\
               property float z\nelement face 1\nproperty list uint uint vertex_indices\nend_header\n"[..],
            &[0; 12],
            &count.to_le_bytes(),
            &[0; 16],
        ];
        add(format!("PLY list {count}"), one("a.ply", list.concat()));
    }
    // Malformed numbers.
    for word in ["nan", "inf", "-inf", "1e999", "NaN", "x", "", "0x10", "1,5"] {
        add(format!("OFF {word}"), one("a.off", format!("OFF\n3 1 0\n0 0 {word}\n1 0 0\n0 1 0\n3 0 1 2\n")));
        add(format!("OBJ {word}"), one("a.obj", format!("v 0 0 {word}\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")));
        let ply = format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 {word}\n1 0 0\n0 1 0\n3 0 1 2\n"
        );
        add(format!("PLY {word}"), one("a.ply", ply));
        let pair = [one("a.vert", format!("0 0 {word}\n1 0 0\n0 1 0\n")), one("a.tri", "1 2 3\n")].concat();
        add(format!("VERT {word}"), pair);
    }
    for index in ["3", "-1", "4294967296", "1.5", "x"] {
        add(
            format!("index {index}"),
            one("a.off", format!("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 {index}\n")),
        );
    }
    // Surfaces that cannot be measured.
    for (what, vertices) in [
        ("no extent", "0 0 0\n0 0 0\n0 0 0\n"),
        ("as wide as numbers go", "-1e308 0 0\n1e308 0 0\n0 1e308 0\n"),
        ("as small as numbers go", "0 0 0\n5e-324 0 0\n0 5e-324 0\n"),
    ] {
        add(what.into(), one("a.off", format!("OFF\n3 1 0\n{vertices}3 0 1 2\n")));
    }
    add("a corner three times".into(), one("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 1 1 1\n"));
    // Wrong formats and bad names.
    for name in ["a.off", "a.obj", "a.ply", "a.stl", "a.mat", "a.vert", "a.tri"] {
        for (what, content) in [
            ("nothing", &b""[..]),
            ("blanks", b" \n\t"),
            ("a picture", b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR"),
            ("a page", b"<html><script>alert(1)</script>"),
            ("an archive", b"PK\x03\x04\x14\x00"),
        ] {
            add(format!("{what} as {name}"), one(name, content));
        }
    }
    for name in
        ["../../etc/passwd", "/etc/passwd", "C:\\boot.ini", "a.txt", "a.off.exe", "off", "a.", ".", "..", " "]
    {
        add(format!("named {name}"), one(name, written("a.off")));
    }
    add("a name of 5000 letters".into(), one(&"x".repeat(5000), written("a.off")));
    // Compression bombs.
    add("MAT bomb".into(), one("a.mat", zipped(&[&[0; 1 << 20][..]; 400])));
    add("MAT without struct".into(), one("a.mat", zipped(&[&[0; 1000]])));
    add("MAT cut".into(), one("a.mat", &zipped(&[&[0; 1000]])[..140]));
    add("MATLAB 7.3".into(), one("a.mat", "MATLAB 7.3 MAT-file"));
    // One endless line, many short ones, one huge polygon.
    add("a long line".into(), one("a.off", "1 ".repeat(1 << 20)));
    add("many lines".into(), one("a.obj", "v 0 0 0\n".repeat(300_000)));
    add("many faces".into(), one("a.obj", format!("v 0 0 0\n{}", "f 1 1 1\n".repeat(900_000))));
    add("a large polygon".into(), one("a.obj", format!("v 0 0 0\nf{}\n", " 1".repeat(1_000_000))));
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
    assert_eq!((found.status, found.json()["predicted"]["label"].as_str()), (200, Some("ring")));
}

#[test]
fn two_hundred_bad_meshes_get_an_error() {
    let server = Served::start(options());
    let all = hostile();
    assert!(all.len() >= 200, "{}", all.len());
    for (i, (what, files)) in all.iter().enumerate() {
        let files: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (&name[..], &bytes[..])).collect();
        check(what, &upload(server.address, &files, &[]).unwrap());
        if i % 50 == 0 {
            still_serves(&server);
        }
    }
    still_serves(&server);
}

#[test]
fn bad_forms_get_an_error() {
    let server = Served::start(options());
    let mesh = fs::read(server.mesh("ring0")).unwrap();
    let (body, boundary) = form(&[("q.off", &mesh)], &[]);
    let multipart = format!("multipart/form-data; boundary={boundary}");
    let post = |kind: &str, body: &[u8]| {
        ask(server.address, "POST", "/api/search", &[("Content-Type", kind)], body).unwrap()
    };
    let parts = "--x\r\nContent-Disposition: form-data; name=\"a\"\r\n\r\n\r\n".repeat(1000);
    let headers = format!("--x\r\n{}\r\n\r\n", "A: b\r\n".repeat(10_000));
    for (what, kind, body) in [
        ("no form", "application/json", &b"{}"[..]),
        ("no boundary", "multipart/form-data", &body),
        ("another boundary", "multipart/form-data; boundary=other", &body),
        ("no end", &multipart, &body[..body.len() / 2]),
        ("no beginning", &multipart, &body[20..]),
        ("nothing", &multipart, b""),
        ("no parts", "multipart/form-data; boundary=x", b"--x--\r\n"),
        ("many parts", "multipart/form-data; boundary=x", parts.as_bytes()),
        ("many headers", "multipart/form-data; boundary=x", headers.as_bytes()),
        ("zeros", &multipart, &[0; 10_000]),
    ] {
        check(what, &post(kind, body));
    }
    let mesh = [("q.off", &mesh[..])];
    let long = "x".repeat(2000);
    for field in [("k", "0"), ("k", "101"), ("k", "x"), ("explain", "perhaps"), ("other", "1"), ("k", &long)]
    {
        check(field.0, &upload(server.address, &mesh, &[field]).unwrap());
    }
    check("no file", &upload(server.address, &[], &[("k", "3")]).unwrap());
    check("an empty choice", &upload(server.address, &[("", b"")], &[]).unwrap());
    for target in ["/api/search?k=0&shape=ring0", "/api/search?x=1", "/api/search?shape=none"] {
        check(target, &ask(server.address, "POST", target, &[], b"").unwrap());
    }
    still_serves(&server);
}

#[test]
fn a_gigabyte_of_zeros_is_cut_off() {
    let limited = ServeOptions { max_upload: 1 << 20, ..options() };
    let server = Served::start(limited);
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
