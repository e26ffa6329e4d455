//! The duplicates of the index.

use std::fs;
use std::time::{Duration, Instant};

use canonform::library::{DuplicateOptions, find_duplicates};
use canonform::search::ShapeSearch;
use canonform_server::ServeOptions;
use serde_json::Value;

use crate::schema::told;
use crate::support::{INDEX, Served, get, options};

/// Asks until the search is done, or until a report is as it should be.
fn report(server: &Served, is_wanted: impl Fn(&Value) -> bool) -> Value {
    let start = Instant::now();
    loop {
        let answer = get(server, "/api/duplicates");
        let json = told(server, "get", "/api/duplicates", answer.status, &answer);
        match answer.status {
            200 if is_wanted(&json) => return json,
            202 => assert_eq!(answer.header("retry-after"), Some("1")),
            _ => (),
        }
        assert!(start.elapsed() < Duration::from_secs(120), "{json}");
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn duplicates_are_those_of_the_library_and_searched_for_once() {
    let server = Served::start(options());
    let found = report(&server, |_| true);
    let search = ShapeSearch::open(&server.folder.join(INDEX)).unwrap();
    let own = find_duplicates(&search, &DuplicateOptions::default(), &()).unwrap();
    let own = serde_json::to_value(&own).unwrap();
    for key in ["n_shapes", "n_compared", "unread"] {
        assert_eq!(found[key], own[key], "{key}");
    }
    let [group, expected] = [&found, &own].map(|report| &report["groups"][0]);
    assert_eq!((found["groups"].as_array().unwrap().len(), &group["why"]), (1, &expected["why"]));
    assert_eq!(group["members"][0]["relation"], expected["members"][0]["relation"]);
    assert_eq!((&group["keeper"]["id"], &group["members"][0]["id"]), (&"box0".into(), &"box1".into()));
    assert_eq!(group["keeper"]["path"], "meshes/box0.off", "where the index lies is not told");
    assert_eq!(report(&server, |_| true)["seconds"], found["seconds"], "not searched for again");
}

#[test]
fn a_changed_index_is_searched_again() {
    let check = ServeOptions { index_check: Duration::from_millis(50), ..options() };
    let server = Served::start_apart(check);
    let n_groups = |report: &Value| report["groups"].as_array().unwrap().len();
    assert_eq!(n_groups(&report(&server, |_| true)), 1);
    fs::copy(server.mesh("ring0"), server.mesh("ring0 copy")).unwrap();
    server.rebuild();
    let found = report(&server, |report| report["n_shapes"] == 8);
    assert_eq!(n_groups(&found), 2);
    let kinds = |i: usize| &found["groups"][i]["members"][0]["relation"]["kind"];
    assert!([0, 1].into_iter().any(|i| kinds(i) == "identical-file"), "{found}");
}
