//! Responses: their content, and that they follow `openapi.json`.

use std::fs;
use std::path::Path;

use canonform::mesh::shapes;
use report::viewer::Geometry;
use serde_json::Value;
use testkit::written;

use crate::client::{ask, upload};
use crate::schema::told;
use crate::support::{AWKWARD, INDEX, Served, bodies, get, options};

fn geometry(value: &Value) -> Geometry {
    serde_json::from_value(value.clone()).unwrap()
}

/// A percent-encoded name.
fn escaped(id: &str) -> String {
    id.bytes().map(|byte| format!("%{byte:02x}")).collect()
}

fn ids<'a>(answer: &'a Value, list: &str) -> Vec<&'a str> {
    answer[list].as_array().unwrap().iter().map(|r| r["id"].as_str().unwrap()).collect()
}

#[test]
fn an_upload_finds_itself_in_every_format() {
    let server = Served::start(options());
    let ring = shapes::torus(24, 12, 2.0, 0.6);
    for names in [&["q.off"][..], &["q.stl"], &["q.tri", "q.vert"]] {
        let contents: Vec<_> = names.iter().map(|name| written(name, &ring)).collect();
        let files: Vec<_> =
            names.iter().zip(&contents).map(|(name, content)| (*name, &content[..])).collect();
        let answer = upload(server.address, &files, &[("k", "3"), ("explain", "true")]).unwrap();
        let json = told(&server, "post", "/api/search", 200, &answer);
        let found = (json["query"].as_str().unwrap(), ids(&json, "results").len());
        assert_eq!((found, ids(&json, "results")[0]), ((names[0], 3), "ring0"));
        let kind = json["results"][0]["relation"]["kind"].as_str().unwrap();
        assert!(kind.starts_with("identical-"), "{names:?}: {kind}");
        // A file of the index has no vote on its own class.
        assert_eq!(json["predicted"]["label"].as_str(), (names != ["q.off"]).then_some("ring"));
        let (mesh, form) = (geometry(&json["mesh"]), geometry(&json["form"]));
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (ring.n_vertices(), ring.n_faces()));
        assert_eq!((&mesh.faces, &mesh.values), (&form.faces, &form.values));
        assert_eq!(mesh.values.len(), ring.n_vertices());
    }
    let two = shapes::disjoint(&[ring, shapes::tetrahedron(0)]);
    let answer = upload(server.address, &[("q.ply", &written("q.ply", &two))], &[]).unwrap().json();
    let line = answer["repaired"][0].as_str().unwrap();
    assert!(line.starts_with("1 of 2 components dropped, 4 faces and 4 vertices"), "{line}");
    assert_eq!(geometry(&answer["mesh"]).positions.len(), two.n_vertices() - 4);
    // An archive of one mesh is that mesh.
    let off = fs::read(server.mesh("ring0")).unwrap();
    let packed = |names: [&str; 2]| {
        let archive = testkit::gzip_of(&testkit::tar_of(&names.map(|name| (name, &off))));
        upload(server.address, &[("scans.tar.gz", &archive)], &[("explain", "true")]).unwrap()
    };
    let one = packed(["scans/ring.off", "scans/notes.md"]).json();
    let kind = &one["results"][0]["relation"]["kind"];
    assert_eq!((&one["query"], kind), (&"ring.off".into(), &"identical-file".into()));
    assert_eq!(packed(["a.off", "b.off"]).status, 422);
}

#[test]
fn an_upload_gives_the_same_answer_as_the_library() {
    let server = Served::start(options());
    let mesh = shapes::torus(24, 12, 2.0, 0.7);
    let search = canonform::search::ShapeSearch::open(&server.folder.join(INDEX)).unwrap();
    let options = canonform::search::SearchOptions::default();
    let query = search.query(&mesh, ("q.off", None), &options, &()).unwrap();
    let report = search.search(&query, &options, &()).unwrap();
    let answer = upload(server.address, &[("q.off", &written("q.off", &mesh))], &[]).unwrap().json();
    let mut report = serde_json::to_value(&report).unwrap();
    for found in report["results"].as_array_mut().unwrap() {
        // Only the library tells where the meshes lie.
        let path = std::path::PathBuf::from(found["path"].as_str().unwrap());
        let path = path.strip_prefix(&server.folder).unwrap_or(&path);
        found["path"] = path.to_str().into();
    }
    for (name, expected) in report.as_object().unwrap() {
        assert!(name == "seconds" || answer[name] == *expected, "{name}");
    }
}

#[test]
fn an_upload_can_be_searched_again_and_exported() {
    let server = Served::start(options());
    let mesh = written("q.off", &shapes::torus(24, 12, 2.0, 0.7));
    let send = |name: &str, parameters: &[(&str, &str)]| {
        upload(server.address, &[(name, &mesh)], parameters).unwrap()
    };
    let first = send("q.off", &[("k", "3")]).json();
    let query = first["query_id"].as_str().unwrap();
    let again = get(&server, &format!("/api/search?query={query}&k=3"));
    for (name, value) in told(&server, "get", "/api/search", 200, &again).as_object().unwrap() {
        assert!(name == "seconds" || *value == first[name], "{name}");
    }
    // The address depends on the content, and on the name, which tells the format.
    let same = send("q.off", &[("geometry", "false")]).json();
    assert_eq!((same["query_id"].as_str(), &same["mesh"]), (Some(query), &Value::Null));
    assert_ne!(send("r.off", &[]).json()["query_id"], query);

    let table = get(&server, &format!("/api/search?query={query}&k=3&format=csv"));
    assert_eq!(table.header("content-type"), Some("text/csv; charset=utf-8; header=present"));
    let table = String::from_utf8(table.body).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!((lines.len(), lines[0]), (4, "query,rank,id,label,path,distance,signature_distance"));
    assert!(lines[1].starts_with("q.off,1,") && lines[1].contains(",meshes/"), "{}", lines[1]);
    assert_eq!(send("q.off", &[("k", "3"), ("format", "csv")]).body, table.as_bytes());
    for (rank, key, columns) in [
        ("plain", "distance", ""),
        ("graph", "rank_distance", ",rank_distance"),
        ("part", "part_share", ",part_distance,part_share"),
        ("forms", "form_distance", ",form_distance"),
    ] {
        let found = get(&server, &format!("/api/search?shape=ring0&geometry=false&rank={rank}"));
        let found = told(&server, "get", "/api/search", 200, &found);
        assert_eq!((ids(&found, "results")[0], &found["rank_by"]), ("ring0", &rank.into()));
        assert!(found["results"][0][key].is_number() && found["mesh"].is_null(), "{found}");
        let table = String::from_utf8(send("q.off", &[("rank", rank), ("format", "csv")]).body).unwrap();
        let head = table.lines().next().unwrap();
        assert!(head.ends_with(&format!(",signature_distance{columns}")), "{head}");
    }
    let gone = get(&server, "/api/search?query=0123456789abcdef0123456789abcdef").json();
    assert_eq!([&gone["error"], &gone["remedy"]], ["this upload has expired", "choose the file again"]);
}

#[test]
fn no_response_tells_where_the_index_lies() {
    let server = Served::start_apart(options());
    let mesh = fs::read(server.mesh("ring1")).unwrap();
    fs::remove_file(server.mesh("ring0")).unwrap();
    fs::write(server.mesh("box0"), "OFF\n").unwrap();
    let mut texts = vec![upload(server.address, &[("q.off", &mesh)], &[("explain", "true")]).unwrap()];
    texts.push(upload(server.address, &[("q.off", b"OFF\n3 1 0\n")], &[]).unwrap());
    for target in [
        "/healthz",
        "/api/shapes",
        "/api/shapes/ring0/mesh",
        "/api/shapes/box0/mesh",
        "/api/shapes/none/mesh",
        "/api/search?shape=ring0",
        "/api/search?shape=box0",
        "/api/search?shape=none",
        "/api/search?shape=ring1&format=csv",
        "/api/compare?a=ring0&b=box0",
        "/api/compare?a=none&b=box0",
    ] {
        texts.push(get(&server, target));
    }
    let folder = server.folder.canonicalize().unwrap();
    for answer in texts {
        let text = String::from_utf8(answer.body).unwrap();
        for path in [&server.folder, &folder] {
            assert!(!text.contains(path.to_str().unwrap()), "{text}");
        }
        assert!(answer.status != 500, "{text}");
    }
}

#[test]
fn the_list_is_paged_and_filtered() {
    let server = Served::start(options());
    for (target, total, expected) in [
        ("?offset=1&limit=2", 7, "ball0 ball1"),
        ("?q=OX", 2, "box0 box1"),
        ("?label=ring&limit=1", 2, "ring0"),
        ("?q=%3Cb%3E", 1, AWKWARD),
        ("?q=none", 0, ""),
        ("?offset=99", 7, ""),
    ] {
        let list = get(&server, &format!("/api/shapes{target}"));
        let json = told(&server, "get", "/api/shapes", 200, &list);
        assert_eq!((&json["total"], ids(&json, "shapes").join(" ")), (&total.into(), expected.to_owned()));
    }
}

#[test]
fn every_shape_has_a_mesh_a_form_and_a_thumbnail() {
    let server = Served::start(options());
    for (id, mesh) in bodies().split_off(5) {
        let part = |part: &str| get(&server, &format!("/api/shapes/{}/{part}", escaped(id)));
        for name in ["mesh", "form"] {
            let shown = told(&server, "get", &format!("/api/shapes/{{id}}/{name}"), 200, &part(name));
            assert_eq!(geometry(&shown).positions.len(), mesh.n_vertices());
        }
        let file = part("file");
        assert!(file.status == 200 && file.body == fs::read(server.mesh(id)).unwrap());
        assert!(file.header("content-disposition").unwrap().starts_with("attachment; filename*=UTF-8''"));
        let picture = part("thumbnail");
        assert!(picture.status == 200 && picture.body.starts_with(b"\x89PNG\r\n"));
        assert_eq!(picture.header("content-type"), Some("image/png"));
        let tag = picture.header("etag").unwrap();
        let target = format!("/api/shapes/{}/thumbnail", escaped(id));
        let same = ask(server.address, "GET", &target, &[("If-None-Match", tag)], b"").unwrap();
        assert!(same.status == 304 && same.body.is_empty() && same.header("etag") == Some(tag));
    }
}

#[test]
fn a_shape_without_its_mesh_shows_the_points_of_its_form() {
    let server = Served::start_apart(options());
    fs::remove_file(server.mesh("ring0")).unwrap();
    fs::copy(server.mesh("box0"), server.mesh("box1")).unwrap();
    for (id, status, words) in
        [("ring0", 404, "cannot read the mesh"), ("box1", 410, "has changed since it was indexed")]
    {
        let part = |part: &str| get(&server, &format!("/api/shapes/{id}/{part}"));
        let mesh = told(&server, "get", "/api/shapes/{id}/mesh", status, &part("mesh"));
        let error = mesh["error"].as_str().unwrap();
        assert!(error.contains(words) && error.contains(&format!("`{id}`")), "{error}");
        assert_eq!(part("thumbnail").status, 200);
        let form = geometry(&part("form").json());
        assert!(!form.faces.is_empty() && form.positions.len().is_multiple_of(6), "dots");
        let found = get(&server, &format!("/api/search?shape={id}"));
        let found = told(&server, "get", "/api/search", 200, &found);
        // `box0` and `box1` are one surface.
        assert!(ids(&found, "results")[..2].contains(&id), "{found}");
        assert_eq!(found["mesh_missing"], error);
        let compared = get(&server, &format!("/api/compare?a={id}&b=ring1"));
        let compared = told(&server, "get", "/api/compare", 200, &compared);
        assert!(compared["triangulation"].is_null());
        assert_eq!(compared["relation"]["because"]["basis"], "descriptions");
    }
}

#[test]
fn an_upload_can_be_compared_with_its_results() {
    let server = Served::start(options());
    let mut mesh = shapes::torus(24, 12, 2.0, 0.8);
    mesh.positions.iter_mut().for_each(|p| p.coords *= 4.0);
    let found = upload(server.address, &[("q.off", &written("q.off", &mesh))], &[("explain", "true")]);
    let found = found.unwrap().json();
    let query = found["query_id"].as_str().unwrap();
    let answer = get(&server, &format!("/api/compare?query={query}&b=ring1"));
    let json = told(&server, "get", "/api/compare", 200, &answer);
    assert_eq!((json["a"].as_str(), json["b"].as_str()), (Some("q.off"), Some("ring1")));
    let mut results = found["results"].as_array().unwrap().iter();
    let result = results.find(|result| result["id"] == "ring1").unwrap();
    let relation = &json["relation"];
    assert_eq!((&relation["kind"], &relation["because"]["basis"]), (&"scaled".into(), &"meshes".into()));
    assert_eq!(relation["text"], "ring1 is q.off scaled by 0.25");
    for key in ["/kind", "/text", "/changes", "/confidence", "/because/text", "/because/vertex_gap"] {
        assert_eq!(relation.pointer(key), result["relation"].pointer(key), "{key}");
    }
    for (key, value) in result["comparison"].as_object().unwrap() {
        assert_eq!(*value, json[key], "{key}");
    }
    let largest = geometry(&json["forms"][1]).values.into_iter().fold(0.0, f32::max);
    assert!((f64::from(largest) - json["residual"][1]["max"].as_f64().unwrap()).abs() < 1e-5, "{largest}");
    assert_eq!(geometry(&json["meshes"][0]).faces.len(), mesh.n_faces());
    assert!(json["gap"]["max"].as_f64().unwrap() < 1e-6, "{}", json["gap"]);
    let pair = told(&server, "get", "/api/compare", 200, &get(&server, "/api/compare?a=ring0&b=box0"));
    assert_eq!(pair["relation"]["kind"], "different");
    assert!(pair["meshes"].is_null() && pair["gap"].is_null());
    let matched = get(&server, &format!("/api/match?query={query}&b=ring1"));
    let matched = told(&server, "get", "/api/match", 200, &matched);
    assert!(matched["maps"][0]["distortion"].as_f64().unwrap() < 0.05, "{}", matched["maps"]);
    // The first mesh has values of the second.
    let values = [0, 1].map(|i| geometry(&matched["meshes"][i]).values);
    assert!(values[0].iter().all(|value| values[1].contains(value)));
    assert!(values[0].iter().any(|value| *value > 0.0));
}

#[test]
fn the_page_and_its_files_have_tags_and_security_headers() {
    let server = Served::start(options());
    let health = get(&server, "/healthz");
    assert_eq!(told(&server, "get", "/healthz", 200, &health)["shapes"], 7);
    let page = get(&server, "/");
    assert_eq!((page.status, page.header("content-type")), (200, Some("text/html; charset=utf-8")));
    let html = String::from_utf8(page.body.clone()).unwrap();
    let files: Vec<&str> = html.split(['"', '\'']).filter(|text| text.starts_with("/assets/")).collect();
    assert_eq!(files.len(), 4, "the page loads its other scripts as modules");
    assert!(html.contains(&canonform::mesh::io::mesh_files()) && !html.contains("{{"));
    for address in files {
        let file = get(&server, address);
        assert!(file.status == 200 && !file.body.is_empty(), "{address}");
        let tag = [("If-None-Match", file.header("etag").unwrap())];
        assert_eq!(ask(server.address, "GET", address, &tag, b"").unwrap().status, 304);
    }
    assert_eq!(html.matches("http:/").count(), html.matches("http://www.w3.org").count());
    for answer in [page, health, get(&server, "/none")] {
        let policy = answer.header("content-security-policy").unwrap();
        assert!(policy.starts_with("default-src 'none'; script-src 'self';"), "{policy}");
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"));
        assert_eq!(answer.header("referrer-policy"), Some("no-referrer"));
        assert_eq!(answer.header("access-control-allow-origin"), None);
        assert!(answer.header("cache-control").is_some());
    }
}

#[test]
fn requests_are_answered_as_the_table_says_and_errors_are_in_json() {
    let server = Served::start(options());
    let contracts = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/contracts");
    let table = fs::read_to_string(contracts.join("requests.txt")).unwrap();
    let rows: Vec<&str> = table.lines().filter(|row| row.contains(" | ")).collect();
    let described = get(&server, "/api/openapi.json").json();
    for row in &rows {
        let (asked, status) = row.rsplit_once(" | ").unwrap();
        let mut parts = asked.split("; ");
        let (method, target) = parts.next().unwrap().split_once(' ').unwrap();
        let headers: Vec<_> = parts.map(|header| header.split_once(':').unwrap()).collect();
        let answer = ask(server.address, method, target, &headers, b"").unwrap();
        assert_eq!(answer.status.to_string(), status, "{row}");
        assert!(answer.status == 200 || answer.json()["error"].is_string(), "{row}");
        let (method, route) = (method.to_lowercase(), target.split('?').next().unwrap());
        if headers.is_empty() && described["paths"][route][&method].is_object() {
            told(&server, &method, route, answer.status, &answer);
        }
    }
    assert!(rows.len() > 70, "{}", rows.len());
}
