//! `canonform serve` as a program: its output, its errors, and how it stops.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};

use serde_json::Value;

use crate::support::{Workplace, program, ring};

struct Serving {
    child: Child,
    address: String,
    err: BufReader<std::process::ChildStderr>,
}

impl Serving {
    fn start(place: &Workplace) -> Self {
        let mut child = Command::new(program())
            .args(["serve", "i", "--listen", "127.0.0.1:0", "--max-vertices", "1000"])
            .current_dir(place.path(""))
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let err = BufReader::new(child.stderr.take().unwrap());
        // Drop ends the program if the checks below fail.
        let mut serving = Self { child, address: String::new(), err };
        let mut line = String::new();
        serving.err.read_line(&mut line).unwrap();
        let address = line.strip_prefix("listening on http://").unwrap_or_else(|| panic!("{line}"));
        let (address, rest) = address.split_once(' ').unwrap();
        assert_eq!(rest, "(1 shapes in i)\n");
        serving.address = address.to_owned();
        serving
    }

    fn upload(&self, name: &str, content: &[u8]) -> Value {
        let part =
            format!("--x\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"{name}\"\r\n\r\n");
        let body = [part.as_bytes(), content, b"\r\n--x--\r\n"].concat();
        let mut stream = TcpStream::connect(&self.address).unwrap();
        let head = format!(
            "POST /api/search HTTP/1.1\r\nHost: {}\r\nConnection: close\r\nContent-Length: {}\r\n\
             Content-Type: multipart/form-data; boundary=x\r\n\r\n",
            self.address,
            body.len()
        );
        stream.write_all(&[head.as_bytes(), &body].concat()).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let begin = answer.windows(4).position(|window| window == b"\r\n\r\n").unwrap();
        serde_json::from_slice(&answer[begin + 4..]).unwrap()
    }
}

impl Drop for Serving {
    fn drop(&mut self) {
        // The program may have stopped already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn indexed() -> Workplace {
    let place = Workplace::new();
    place.add("meshes/ring0.off", &ring());
    place.done("index build meshes -n 20 -o i");
    place
}

#[test]
fn errors_of_meshes_equal_those_of_search() {
    let place = indexed();
    let serving = Serving::start(&place);
    for (name, content) in [
        ("a.off", &b"OFF\n3 1 0\n0 0 0\n"[..]),
        ("a.obj", b"v 0 0 0\nv 1 nan 0\nf 1 2 3\n"),
        ("a.ply", b"ply\nformat ascii 1.0\n"),
        ("a.md", b"hello"),
        ("flat.off", b"OFF\n3 1 0\n0 0 0\n0 0 0\n0 0 0\n3 0 1 2\n"),
    ] {
        std::fs::write(place.path(name), content).unwrap();
        let expected = place.run(format!("search i {name}")).err;
        assert_eq!(
            format!("error: {}\n", serving.upload(name, content)["error"].as_str().unwrap()),
            expected
        );
    }
    let mesh = std::fs::read(place.path("meshes/ring0.off")).unwrap();
    assert_eq!(serving.upload("ring0.off", &mesh)["results"][0]["id"], "ring0");
}

#[test]
fn errors_name_a_taken_address_a_missing_index_and_bad_limits() {
    let place = indexed();
    let serving = Serving::start(&place);
    let again = ["serve", "i", "--listen", &serving.address];
    place.refused(&again[..], &[&serving.address, "another program uses it", "--listen with another port"]);
    place.refused("serve none", &["none"]);
    place.refused("serve i --listen nowhere", &["--listen"]);
    place.refused("serve i --max-upload 0", &["--max-upload"]);
}

#[cfg(unix)]
#[test]
fn an_interrupted_server_exits_with_success() {
    let place = indexed();
    let mut serving = Serving::start(&place);
    let id = serving.child.id().to_string();
    assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    assert_eq!(serving.child.wait().unwrap().code(), Some(0));
    let mut rest = String::new();
    serving.err.read_to_string(&mut rest).unwrap();
    assert!(rest.starts_with("finishing the requests in progress"), "{rest}");
}
