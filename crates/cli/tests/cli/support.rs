//! A temporary folder, test meshes, and the program.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use canonform::mesh::{TriMesh, io, shapes};
use serde_json::{Value, json};
use tempfile::TempDir;

/// A temporary folder for one test.
pub(crate) struct Workplace(TempDir);

/// Exit code, standard output and standard error of the program.
pub(crate) struct Outcome {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

/// Arguments of the program: words with a space between them, or one by one.
pub(crate) trait Arguments {
    fn words(&self) -> Vec<&str>;
}

impl Arguments for &str {
    fn words(&self) -> Vec<&str> {
        self.split(' ').collect()
    }
}

impl Arguments for String {
    fn words(&self) -> Vec<&str> {
        self.split(' ').collect()
    }
}

impl<S: AsRef<str>> Arguments for &[S] {
    fn words(&self) -> Vec<&str> {
        self.iter().map(AsRef::as_ref).collect()
    }
}

impl Workplace {
    pub(crate) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn add(&self, name: &str, mesh: &TriMesh) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        io::write(&path, mesh).unwrap();
    }

    /// The program, to be run in the folder.
    pub(crate) fn command(&self, arguments: impl Arguments) -> Command {
        let mut command = Command::new(program());
        command.current_dir(self.0.path()).args(arguments.words());
        command
    }

    pub(crate) fn run(&self, arguments: impl Arguments) -> Outcome {
        let output = self.command(arguments).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Outcome { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
    }

    /// Runs the program with these bytes as standard input: exit code, standard output, standard error.
    pub(crate) fn piped(&self, input: &[u8], arguments: impl Arguments) -> (i32, Vec<u8>, String) {
        let mut command = self.command(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        // The program may refuse before it has read everything.
        let _ = child.stdin.take().unwrap().write_all(input);
        let output = child.wait_with_output().unwrap();
        (output.status.code().unwrap(), output.stdout, String::from_utf8(output.stderr).unwrap())
    }

    /// Runs the program, which must succeed.
    pub(crate) fn done(&self, arguments: impl Arguments) -> Outcome {
        let words = arguments.words();
        let outcome = self.run(&words[..]);
        assert_eq!(outcome.code, 0, "{words:?}: {}", outcome.err);
        outcome
    }

    /// Runs the program with `--json`: standard output must be one object on one line.
    pub(crate) fn json(&self, arguments: impl Arguments) -> Value {
        one_object(&self.done(&[&arguments.words()[..], &["--json"]].concat()[..]).out)
    }

    /// The answer to the only query of a search.
    pub(crate) fn found(&self, arguments: impl Arguments) -> Value {
        let mut answers = self.json(&[&["search"], &arguments.words()[..]].concat()[..]);
        assert_eq!((answers["queries"].as_array().unwrap().len(), &answers["failed"]), (1, &json!([])));
        answers["queries"][0].take()
    }
}

pub(crate) fn program() -> &'static str {
    env!("CARGO_BIN_EXE_canonform")
}

pub(crate) fn one_object(text: &str) -> Value {
    assert_eq!(text.lines().count(), 1, "more than one line: {text}");
    let value: Value = serde_json::from_str(text).unwrap();
    assert!(value.is_object(), "{text}");
    value
}

/// A clean closed surface of 160 vertices.
pub(crate) fn ring() -> TriMesh {
    shapes::torus(16, 10, 2.0, 0.6)
}

/// [`ring`], then an isolated vertex, then a small separate sheet: vertices 160 to 169 are dropped.
pub(crate) fn broken_ring() -> TriMesh {
    let mut mesh = ring();
    mesh.positions.push([9.0, 9.0, 9.0].into());
    shapes::disjoint(&[mesh, shapes::grid(3, 3, 0.1)])
}

/// Shape and rows of a NumPy array, which must be little-endian float64 in C order.
pub(crate) fn read_npy(path: &Path) -> (Vec<u64>, Vec<f64>) {
    testkit::array(path)
}
