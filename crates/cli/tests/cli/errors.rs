//! Errors: each names the file, what is wrong and what to do, and leaves nothing behind.

use std::fs;

use testkit::tree;

use crate::support::{Workplace, ring};

fn place() -> Workplace {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place
}

#[test]
fn errors_name_unwritable_outputs_once_and_leave_nothing() {
    let place = place();
    // A folder in place of the output: writing fails at the very end, for any user.
    for name in ["taken.npy", "taken.csv", "taken.ply", "taken.off"] {
        fs::create_dir(place.path(name)).unwrap();
    }
    let before = tree(&place.path(""));
    for (command, files) in [
        (
            "embed ring.off -n 20",
            &["nowhere/form.npy", "nowhere/form.ply", "taken.npy", "taken.ply", "taken.off"][..],
        ),
        (
            "geodesic ring.off --source 0",
            &["nowhere/d.npy", "nowhere/d.ply", "taken.npy", "taken.csv", "taken.ply"],
        ),
    ] {
        for file in files {
            let outcome = place.run(format!("{command} -o {file}"));
            assert_eq!((outcome.code, outcome.out.as_str()), (2, ""), "{file}");
            assert_eq!(outcome.err.matches(&format!("cannot write {file}")).count(), 1, "{}", outcome.err);
        }
    }
    assert!(tree(&place.path("")) == before);
}

#[test]
fn a_failure_keeps_existing_files() {
    let place = place();
    fs::write(place.path("form.npy"), "precious").unwrap();
    place.refused("embed ring.off --rank 99 -n 20 -o form.npy", &["99"]);
    place.refused("geodesic ring.off --source 0,500 -o form.npy", &["500"]);
    assert_eq!(fs::read(place.path("form.npy")).unwrap(), b"precious");
}
