//! A server on a small index, in this process.

use std::fs;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::{OnceLock, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use canonform::DescribeOptions;
use canonform::library::{BuildOptions, build_index};
use canonform::mesh::{TriMesh, shapes};
use canonform_server::{ServeOptions, ServerError};
use tempfile::TempDir;

use crate::client::{Answer, ask};
use crate::running::Running;

/// Name of the index in its folder.
pub(crate) const INDEX: &str = "all.canonform";

/// The name of the last body.
pub(crate) const AWKWARD: &str = "<b>&'\" ü 100%#?";

pub(crate) fn bodies() -> Vec<(&'static str, TriMesh)> {
    vec![
        ("ball0", shapes::icosphere(3)),
        ("ball1", egg()),
        ("box0", shapes::cube(3)),
        ("box1", shapes::cube(4)),
        ("ring0", shapes::torus(24, 12, 2.0, 0.6)),
        ("ring1", shapes::torus(24, 12, 2.0, 0.8)),
        (AWKWARD, shapes::torus(20, 12, 2.0, 1.2)),
    ]
}

fn egg() -> TriMesh {
    let mut mesh = shapes::icosphere(3);
    mesh.positions.iter_mut().for_each(|p| p.z *= 0.8);
    mesh
}

/// A running server, and the folder of its index.
pub(crate) struct Served {
    running: Running,
    pub(crate) folder: PathBuf,
    _own: Option<TempDir>,
    _turn: Turn,
}

/// Held by every test with a server: tests under attack run alone, so that their times and their memory are those of the server.
static TURNS: RwLock<()> = RwLock::new(());

#[derive(Debug)]
pub(crate) enum Turn {
    Shared(#[expect(dead_code, reason = "held")] RwLockReadGuard<'static, ()>),
    Alone(#[expect(dead_code, reason = "held")] RwLockWriteGuard<'static, ()>),
}

/// A test that failed holds nothing back.
pub(crate) fn shared_turn() -> Turn {
    Turn::Shared(TURNS.read().unwrap_or_else(PoisonError::into_inner))
}

impl Deref for Served {
    type Target = Running;

    fn deref(&self) -> &Running {
        &self.running
    }
}

/// Writes meshes into a folder, and an index of them.
pub(crate) fn write_indexed(folder: &Path, meshes: &[(&str, TriMesh)]) {
    fs::create_dir_all(folder.join("meshes")).unwrap();
    for (name, mesh) in meshes {
        canonform::mesh::io::write(&folder.join(format!("meshes/{name}.off")), mesh).unwrap();
    }
    build(folder);
}

fn build(folder: &Path) {
    let describe = DescribeOptions::default();
    let (path, options) = (folder.join(INDEX), BuildOptions::new(&describe));
    if build_index(&folder.join("meshes"), &path, &options, &()).is_err() {
        // An index of an earlier version was left here.
        fs::remove_file(&path).unwrap();
        build_index(&folder.join("meshes"), &path, &options, &()).unwrap();
    }
}

/// The folder of an index that all tests share and none changes.
fn shared() -> PathBuf {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let make = || {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("server");
        write_indexed(&folder, &bodies());
        folder
    };
    FOLDER.get_or_init(make).clone()
}

impl Served {
    /// A server on the shared index.
    pub(crate) fn start(options: ServeOptions) -> Self {
        Self::serve(shared(), None, options, shared_turn())
    }

    /// A server on the shared index while no other test has a server.
    pub(crate) fn start_alone(options: ServeOptions) -> Self {
        let turn = TURNS.write().unwrap_or_else(PoisonError::into_inner);
        Self::serve(shared(), None, options, Turn::Alone(turn))
    }

    /// A server on an index of its own, whose meshes the test may change.
    pub(crate) fn start_apart(options: ServeOptions) -> Self {
        let own = tempfile::tempdir().unwrap();
        let copy = |name: &Path| {
            fs::copy(shared().join(name), own.path().join(name)).unwrap();
        };
        fs::create_dir(own.path().join("meshes")).unwrap();
        bodies().iter().for_each(|(id, _)| copy(&Path::new("meshes").join(format!("{id}.off"))));
        copy(Path::new(INDEX));
        Self::serve(own.path().to_owned(), Some(own), options, shared_turn())
    }

    fn serve(folder: PathBuf, own: Option<TempDir>, options: ServeOptions, turn: Turn) -> Self {
        Self { running: Running::start(&folder.join(INDEX), options), folder, _own: own, _turn: turn }
    }

    /// Builds the index again, from the meshes that are there now.
    pub(crate) fn rebuild(&self) {
        build(&self.folder);
    }

    /// Path of the mesh of a body.
    pub(crate) fn mesh(&self, id: &str) -> PathBuf {
        self.folder.join("meshes").join(format!("{id}.off"))
    }

    /// Waits until a stopped server has ended.
    pub(crate) fn join(&mut self) -> Result<(), ServerError> {
        self.running.join().unwrap().unwrap()
    }
}

/// Asks for an address of a server.
pub(crate) fn get(server: &Running, target: &str) -> Answer {
    ask(server.address, "GET", target, &[], b"").unwrap()
}
