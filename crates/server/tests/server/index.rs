//! The index changes while it is served.

use std::fs;
use std::time::{Duration, Instant};

use canonform::mesh::shapes;
use canonform_server::ServeOptions;
use serde_json::Value;
use testkit::written;

use crate::client::upload;
use crate::support::{INDEX, Served, get, options};

fn health(server: &Served) -> Value {
    get(server, "/healthz").json()
}

/// Waits until the health of the server satisfies a condition.
fn until(server: &Served, condition: impl Fn(&Value) -> bool) -> Value {
    let start = Instant::now();
    loop {
        let health = health(server);
        if condition(&health) {
            return health;
        }
        assert!(start.elapsed() < Duration::from_secs(30), "{health}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn a_changed_index_is_opened_again() {
    let check = ServeOptions { index_check: Duration::from_millis(50), ..options() };
    let server = Served::start_apart(check);
    let mesh = written("q.off", &shapes::torus(24, 12, 2.0, 0.9));
    let find = || {
        let answer = upload(server.address, &[("q.off", &mesh)], &[("k", "1")]).unwrap();
        assert_eq!(answer.status, 200);
        answer.json()
    };
    let first = health(&server);
    assert_eq!((&first["index"]["state"], &first["shapes"]), (&"current".into(), &7.into()));
    assert_eq!(find()["results"][0]["id"], "ring1");

    fs::write(server.mesh("ring2"), &mesh).unwrap();
    // Searches go on while the index is replaced.
    std::thread::scope(|scope| {
        let searches = scope.spawn(|| (0..5).for_each(|_| drop(find())));
        server.rebuild();
        searches.join().unwrap();
    });
    // The server may have opened it between its last batch and its end.
    std::thread::sleep(Duration::from_millis(200));
    let second = until(&server, |health| health["shapes"] == 8);
    assert_ne!(second["index"]["version"], first["index"]["version"]);
    assert_eq!(find()["results"][0]["id"], "ring2");

    let path = server.folder.join(INDEX);
    let whole = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    until(&server, |health| health["index"]["state"] == "missing");
    assert_eq!(find()["results"][0]["id"], "ring2");
    fs::write(&path, b"not an index").unwrap();
    let third = until(&server, |health| health["index"]["state"] == "unreadable");
    assert_eq!((&third["index"]["version"], &third["shapes"]), (&second["index"]["version"], &8.into()));
    assert_eq!(find()["results"][0]["id"], "ring2");
    fs::remove_file(&path).unwrap();
    fs::write(&path, &whole).unwrap();
    until(&server, |health| health["index"]["state"] == "current");
}
