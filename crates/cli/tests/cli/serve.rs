//! `canonform serve` as a program: its output, its errors, and how it stops.

use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};

use crate::support::{Workplace, ring};

/// A program that ends with the test.
struct Serving(Child);

impl Drop for Serving {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[test]
fn a_server_keeps_its_address_and_ends_with_success_when_interrupted() {
    let place = Workplace::new();
    place.add("meshes/ring0.off", &ring());
    place.done("index build meshes -n 20 -o i");
    let mut command = place.command("serve i --listen 127.0.0.1:0 --max-vertices 1000");
    let mut serving = Serving(command.stderr(Stdio::piped()).spawn().unwrap());
    let mut err = BufReader::new(serving.0.stderr.take().unwrap());
    let mut line = String::new();
    err.read_line(&mut line).unwrap();
    let address = line.strip_prefix("listening on http://").unwrap_or_else(|| panic!("{line}"));
    let address = address.strip_suffix(" (1 shape in i)\n").unwrap();
    let again = ["serve", "i", "--listen", address];
    let refused = place.run(&again[..]);
    let words = [address, "another program uses it", "--listen with another port"];
    assert!(refused.code == 2 && words.iter().all(|words| refused.err.contains(words)), "{}", refused.err);
    let interrupted = Command::new("kill").args(["-INT", &serving.0.id().to_string()]).status();
    assert!(interrupted.unwrap().success());
    assert_eq!(serving.0.wait().unwrap().code(), Some(0));
    let mut rest = String::new();
    err.read_to_string(&mut rest).unwrap();
    assert!(rest.starts_with("finishing the requests in progress"), "{rest}");
}
