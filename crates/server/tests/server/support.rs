//! A server on a small index, in this process.

use std::any::Any;
use std::fs;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::{OnceLock, PoisonError, RwLock};
use std::thread::JoinHandle;

use canonform::DescribeOptions;
use canonform::library::{BuildOptions, build_index};
use canonform::mesh::{TriMesh, shapes};
use canonform_server::{ServeOptions, Server, ServerError, Stop};
use tempfile::TempDir;

use crate::client::{Answer, ask};

/// Name of the index in its folder.
pub(crate) const INDEX: &str = "all.canonform";

/// The name of the last body.
pub(crate) const AWKWARD: &str = "<b>&'\" ü 100%#?";

pub(crate) fn bodies() -> Vec<(&'static str, TriMesh)> {
    vec![
        ("ball0", shapes::icosphere(3)),
        ("ball1", testkit::moved(&shapes::icosphere(3), |p| [p.x, p.y, 0.8 * p.z].into())),
        ("box0", shapes::cube(3)),
        ("box1", shapes::cube(4)),
        ("ring0", shapes::torus(24, 12, 2.0, 0.6)),
        ("ring1", shapes::torus(24, 12, 2.0, 0.8)),
        (AWKWARD, shapes::torus(20, 12, 2.0, 1.2)),
    ]
}

/// Options with a free port.
pub(crate) fn options() -> ServeOptions {
    ServeOptions { listen: "127.0.0.1:0".parse().unwrap(), ..ServeOptions::default() }
}

/// A running server, stopped on drop.
pub(crate) struct Served {
    pub(crate) address: SocketAddr,
    pub(crate) stop: Stop,
    /// The folder of its index.
    pub(crate) folder: PathBuf,
    thread: Option<JoinHandle<Result<(), ServerError>>>,
    _own: Option<TempDir>,
    _turn: Box<dyn Any + Sync>,
}

/// Held by every test with a server: tests under attack run alone, so that their times and their memory are those of the server.
static TURNS: RwLock<()> = RwLock::new(());

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
        Self::on(shared(), None, options)
    }

    /// A server on the shared index while no other test has a server.
    pub(crate) fn start_alone(options: ServeOptions) -> Self {
        // A test that failed holds nothing back.
        let turn = TURNS.write().unwrap_or_else(PoisonError::into_inner);
        Self::serve(shared(), None, options, Box::new(turn))
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
        Self::on(own.path().to_owned(), Some(own), options)
    }

    /// A server on the index in a folder.
    pub(crate) fn on(folder: PathBuf, own: Option<TempDir>, options: ServeOptions) -> Self {
        let turn = TURNS.read().unwrap_or_else(PoisonError::into_inner);
        Self::serve(folder, own, options, Box::new(turn))
    }

    fn serve(
        folder: PathBuf,
        own: Option<TempDir>,
        options: ServeOptions,
        turn: Box<dyn Any + Sync>,
    ) -> Self {
        let server = Server::bind(&folder.join(INDEX), options).unwrap();
        let (address, stop) = (server.address(), server.stop_handle());
        let thread = Some(std::thread::spawn(move || server.run()));
        Self { address, stop, folder, thread, _own: own, _turn: turn }
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
        self.thread.take().unwrap().join().unwrap()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        self.stop.stop();
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Asks for an address of a server.
pub(crate) fn get(server: &Served, target: &str) -> Answer {
    ask(server.address, "GET", target, &[], b"").unwrap()
}
