//! `canonform serve` as a program: its output, its errors, and how it stops.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};

use crate::support::{Workplace, ring};

struct Serving {
    child: Child,
    address: String,
    err: BufReader<std::process::ChildStderr>,
}

impl Serving {
    fn start(place: &Workplace) -> Self {
        let mut command = place.command("serve i --listen 127.0.0.1:0 --max-vertices 1000");
        let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
        let err = BufReader::new(child.stderr.take().unwrap());
        // Drop ends the program if the checks below fail.
        let mut serving = Self { child, address: String::new(), err };
        let mut line = String::new();
        serving.err.read_line(&mut line).unwrap();
        let address = line.strip_prefix("listening on http://").unwrap_or_else(|| panic!("{line}"));
        let (address, rest) = address.split_once(' ').unwrap();
        assert_eq!(rest, "(1 shape in i)\n");
        serving.address = address.to_owned();
        serving
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
fn an_error_names_a_taken_address() {
    let place = indexed();
    let serving = Serving::start(&place);
    let again = ["serve", "i", "--listen", &serving.address];
    place.refused(&again[..], &[&serving.address, "another program uses it", "--listen with another port"]);
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
