//! Responses: their content, and that they follow `openapi.json`.

use std::fs;

use canonform::mesh::shapes;
use report::viewer::Geometry;
use serde_json::Value;

use crate::client::{ask, upload};
use crate::running::options;
use crate::schema::Description;
use crate::support::{AWKWARD, INDEX, Served, bodies, get, written};

fn description(server: &Served) -> Description {
    Description(get(server, "/api/openapi.json").json())
}

fn geometry(value: &Value) -> Geometry {
    serde_json::from_value(value.clone()).unwrap()
}

/// A percent-encoded name.
fn escaped(id: &str) -> String {
    id.bytes().map(|byte| format!("%{byte:02x}")).collect()
}

fn ids(answer: &Value) -> Vec<&str> {
    answer["results"].as_array().unwrap().iter().map(|r| r["id"].as_str().unwrap()).collect()
}

#[test]
fn an_upload_finds_itself_in_every_format() {
    let server = Served::start(options());
    let description = description(&server);
    let ring = shapes::torus(24, 12, 2.0, 0.6);
    for names in [&["q.off"][..], &["q.stl"], &["q.tri", "q.vert"]] {
        let contents: Vec<_> = names.iter().map(|name| written(name, &ring)).collect();
        let files: Vec<_> =
            names.iter().zip(&contents).map(|(name, content)| (*name, &content[..])).collect();
        let answer = upload(server.address, &files, &[("k", "3"), ("explain", "true")]).unwrap();
        let json = answer.json();
        assert_eq!(answer.status, 200, "{json}");
        description.check("post", "/api/search", 200, &json);
        assert_eq!(
            (json["query"].as_str().unwrap(), json["results"].as_array().unwrap().len()),
            (names[0], 3)
        );
        assert_eq!(ids(&json)[0], "ring0");
        // The rotation of a ring about its axis is arbitrary: rounding decides which vertices are landmarks.
        let distance = json["results"][0]["distance"].as_f64().unwrap();
        assert!(distance < 0.4 || names == ["q.stl"], "{names:?}: {distance}");
        let kind = json["results"][0]["relation"]["kind"].as_str().unwrap();
        assert!(kind.starts_with("identical-"), "{names:?}: {kind}");
        assert_eq!(json["predicted"]["label"], "ring");
        let (mesh, form) = (geometry(&json["mesh"]), geometry(&json["form"]));
        assert_eq!((mesh.positions.len(), mesh.faces.len()), (ring.n_vertices(), ring.n_faces()));
        assert_eq!((&mesh.faces, &mesh.values), (&form.faces, &form.values));
        assert_eq!(mesh.values.unwrap().len(), ring.n_vertices());
    }
}

#[test]
fn an_archive_of_one_mesh_is_that_mesh() {
    let server = Served::start(options());
    let ring = fs::read(server.mesh("ring0")).unwrap();
    let archive = |names: &[&str]| {
        let mut archive = tar::Builder::new(flate2::write::GzEncoder::new(Vec::new(), Default::default()));
        for name in names {
            let mut header = tar::Header::new_gnu();
            header.set_size(ring.len() as u64);
            archive.append_data(&mut header, name, &ring[..]).unwrap();
        }
        archive.into_inner().unwrap().finish().unwrap()
    };
    let one = archive(&["scans/ring.off", "scans/notes.md"]);
    let answer = upload(server.address, &[("scans.tar.gz", &one)], &[("explain", "true")]).unwrap().json();
    let kind = &answer["results"][0]["relation"]["kind"];
    assert_eq!((&answer["query"], kind), (&"ring.off".into(), &"identical-file".into()), "{answer}");
    // No mesh, several and a damaged archive.
    for (name, content, status, words) in [
        ("all.tar.gz", archive(&["a.off", "b.off"]), 422, "all.tar.gz: the archive holds 2 meshes"),
        ("all.tar.gz", archive(&["a.md"]), 422, "all.tar.gz: the archive holds 0 meshes"),
        ("all.zip", b"PK".to_vec(), 400, ""),
    ] {
        let answer = upload(server.address, &[(name, &content)], &[]).unwrap();
        let error = answer.json()["error"].as_str().unwrap().to_owned();
        assert!(answer.status == status && error.starts_with(words), "{error}");
    }
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
        if name != "seconds" {
            assert_eq!(&answer[name], expected, "{name}");
        }
    }
}

#[test]
fn repairs_are_reported() {
    let server = Served::start(options());
    let two = shapes::disjoint(&[shapes::torus(24, 12, 2.0, 0.6), shapes::tetrahedron(0)]);
    let answer = upload(server.address, &[("q.ply", &written("q.ply", &two))], &[]).unwrap().json();
    let line = answer["repaired"][0].as_str().unwrap();
    assert!(line.starts_with("1 of 2 components dropped, 4 faces and 4 vertices"), "{line}");
    assert_eq!(answer["repair"]["dropped_vertices"].as_array().unwrap().len(), 4);
    assert_eq!(geometry(&answer["mesh"]).positions.len(), two.n_vertices() - 4);
}

#[test]
fn a_shape_of_the_index_finds_itself() {
    let server = Served::start(options());
    let description = description(&server);
    for id in ["box0", AWKWARD] {
        let target = format!("/api/search?shape={}&k=2&explain=true", escaped(id));
        let answer = ask(server.address, "POST", &target, &[], b"").unwrap();
        let json = answer.json();
        assert_eq!(answer.status, 200, "{json}");
        description.check("post", "/api/search", 200, &json);
        assert_eq!(json["query"].as_str().unwrap(), id);
        assert!(json["results"][0]["distance"].as_f64().unwrap() < 1e-9, "{json}");
        // `box0` and `box1` are one surface, at one distance; any other shape is first alone.
        let n_first = if id.starts_with("box") { 2 } else { 1 };
        assert!(ids(&json)[..n_first].contains(&id), "{json}");
        assert!(json["query_id"].is_null() && json["mesh_missing"].is_null());
    }
}

#[test]
fn an_upload_can_be_searched_again_and_exported() {
    let server = Served::start(options());
    let description = description(&server);
    let mesh = written("q.off", &shapes::torus(24, 12, 2.0, 0.7));
    let first = upload(server.address, &[("q.off", &mesh)], &[("k", "3")]).unwrap().json();
    let query = first["query_id"].as_str().unwrap();
    let again = get(&server, &format!("/api/search?query={query}&k=3")).json();
    description.check("get", "/api/search", 200, &again);
    for (name, value) in again.as_object().unwrap() {
        assert!(name == "seconds" || *value == first[name], "{name}");
    }
    // The address depends on the content, and on the name, which tells the format.
    let same = upload(server.address, &[("q.off", &mesh)], &[("geometry", "false")]).unwrap().json();
    assert_eq!(
        (same["query_id"].as_str(), &same["mesh"], &same["form"]),
        (Some(query), &Value::Null, &Value::Null)
    );
    let other = upload(server.address, &[("r.off", &mesh)], &[]).unwrap().json();
    assert_ne!(other["query_id"], query);

    let table = get(&server, &format!("/api/search?query={query}&k=3&format=csv"));
    assert_eq!(table.header("content-type"), Some("text/csv; charset=utf-8; header=present"));
    let table = String::from_utf8(table.body).unwrap();
    let lines: Vec<&str> = table.lines().collect();
    assert_eq!((lines.len(), lines[0]), (4, "query,rank,id,label,path,distance,signature_distance"));
    assert!(lines[1].starts_with("q.off,1,") && lines[1].contains(",meshes/"), "{}", lines[1]);
    let posted = upload(server.address, &[("q.off", &mesh)], &[("k", "3"), ("format", "csv")]).unwrap();
    assert_eq!(posted.body, table.as_bytes());
    let shape = get(&server, "/api/search?shape=ring0&geometry=false").json();
    description.check("get", "/api/search", 200, &shape);
    assert_eq!((ids(&shape)[0], &shape["mesh"]), ("ring0", &Value::Null));
    for (rank, key, columns) in [
        ("graph", "rank_distance", ",rank_distance"),
        ("part", "part_share", ",part_distance,part_share"),
        ("forms", "form_distance", ",form_distance"),
    ] {
        let found = get(&server, &format!("/api/search?shape=ring0&geometry=false&rank={rank}")).json();
        description.check("get", "/api/search", 200, &found);
        assert_eq!((ids(&found)[0], &found["rank_by"]), ("ring0", &rank.into()));
        assert!(found["results"][0][key].is_number(), "{found}");
        let fields = [("rank", rank), ("format", "csv")];
        let table = upload(server.address, &[("q.off", &mesh)], &fields).unwrap().body;
        let head = String::from_utf8(table).unwrap().lines().next().unwrap().to_owned();
        assert!(head.ends_with(&format!(",signature_distance{columns}")), "{head}");
    }
    assert_eq!(shape["rank_by"], "plain");
    assert_eq!(upload(server.address, &[("q.off", &mesh)], &[("rank", "best")]).unwrap().status, 400);

    let gone = get(&server, "/api/search?query=0123456789abcdef0123456789abcdef");
    description.check("get", "/api/search", 410, &gone.json());
    assert_eq!(gone.json()["error"], "this upload has expired");
    assert_eq!(gone.json()["remedy"], "choose the file again");
    for bad in [format!("shape=ring0&query={query}"), "k=3".to_owned(), "shape=ring0&format=xml".to_owned()] {
        let answer = get(&server, &format!("/api/search?{bad}"));
        assert_eq!(answer.status, 400, "{bad}");
        description.check("get", "/api/search", 400, &answer.json());
    }
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
    let description = description(&server);
    let list = |target: &str| {
        let answer = get(&server, target);
        assert_eq!(answer.status, 200);
        let json = answer.json();
        description.check("get", "/api/shapes", 200, &json);
        let shapes = json["shapes"].as_array().unwrap();
        let ids = shapes.iter().map(|shape| shape["id"].as_str().unwrap().to_owned()).collect::<Vec<_>>();
        (json["total"].as_u64().unwrap(), ids.join(" "))
    };
    assert_eq!(list("/api/shapes?offset=1&limit=2"), (7, "ball0 ball1".to_owned()));
    assert_eq!(list("/api/shapes?q=OX"), (2, "box0 box1".to_owned()));
    assert_eq!(list("/api/shapes?label=ring&limit=1"), (2, "ring0".to_owned()));
    assert_eq!(list("/api/shapes?q=%3Cb%3E"), (1, AWKWARD.to_owned()));
    assert_eq!(list("/api/shapes?q=none"), (0, String::new()));
    assert_eq!(list("/api/shapes?offset=99"), (7, String::new()));
    // One shape of each class before the second of any, in the order of their names.
    assert_eq!(list("/api/shapes?sample=4"), (7, format!("{AWKWARD} ball0 box0 ring0")));
    assert_eq!(list("/api/shapes?sample=2"), (7, format!("{AWKWARD} box0")));
    assert_eq!(list("/api/shapes?sample=99").1, list("/api/shapes").1);
    for bad in ["limit=0", "limit=501", "limit=x", "offset=-1", "other=1", "sample=0"] {
        let answer = get(&server, &format!("/api/shapes?{bad}"));
        assert_eq!(answer.status, 400, "{bad}");
        description.check("get", "/api/shapes", 400, &answer.json());
    }
}

#[test]
fn every_shape_has_a_mesh_a_form_and_a_thumbnail() {
    let server = Served::start(options());
    let description = description(&server);
    for (id, mesh) in bodies().split_off(5) {
        let part = |part: &str| get(&server, &format!("/api/shapes/{}/{part}", escaped(id)));
        let [shown, form] = ["mesh", "form"].map(|name| {
            let answer = part(name);
            assert_eq!(answer.status, 200);
            description.check("get", &format!("/api/shapes/{{id}}/{name}"), 200, &answer.json());
            geometry(&answer.json())
        });
        assert_eq!((shown.positions.len(), form.positions.len()), (mesh.n_vertices(), mesh.n_vertices()));
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
    for part in ["mesh", "form", "file", "thumbnail"] {
        for id in ["none", "..%2f..%2fmeshes%2fball0", "%2fetc%2fpasswd"] {
            let answer = get(&server, &format!("/api/shapes/{id}/{part}"));
            assert!(
                answer.status == 404 && answer.json()["error"].as_str().unwrap().contains("has no shape")
            );
        }
        assert_eq!(get(&server, &format!("/api/shapes/%ff/{part}")).status, 400);
    }
}

#[test]
fn a_shape_without_its_mesh_shows_the_points_of_its_form() {
    let server = Served::start_apart(options());
    let description = description(&server);
    fs::remove_file(server.mesh("ring0")).unwrap();
    fs::copy(server.mesh("box0"), server.mesh("box1")).unwrap();
    for (id, status, words) in
        [("ring0", 404, "cannot read the mesh"), ("box1", 410, "has changed since it was indexed")]
    {
        let mesh = get(&server, &format!("/api/shapes/{id}/mesh"));
        assert_eq!(mesh.status, status);
        description.check("get", "/api/shapes/{id}/mesh", status, &mesh.json());
        let error = mesh.json()["error"].as_str().unwrap().to_owned();
        assert!(error.contains(words) && error.contains(&format!("`{id}`")), "{error}");
        assert_eq!(get(&server, &format!("/api/shapes/{id}/thumbnail")).status, 200);
        let form = geometry(&get(&server, &format!("/api/shapes/{id}/form")).json());
        assert!(!form.faces.is_empty() && form.positions.len().is_multiple_of(6), "dots");
        let found = ask(server.address, "POST", &format!("/api/search?shape={id}"), &[], b"").unwrap().json();
        description.check("post", "/api/search", 200, &found);
        // `box0` and `box1` are one surface.
        assert!(ids(&found)[..2].contains(&id), "{found}");
        assert_eq!(found["mesh_missing"].as_str().unwrap(), error);
        let compared = get(&server, &format!("/api/compare?a={id}&b=ring1"));
        description.check("get", "/api/compare", 200, &compared.json());
        assert!(compared.json()["triangulation"].is_null());
        assert_eq!(compared.json()["relation"]["because"]["basis"], "descriptions");
    }
}

#[test]
fn an_upload_can_be_compared_with_its_results() {
    let server = Served::start(options());
    let description = description(&server);
    let mut mesh = shapes::torus(24, 12, 2.0, 0.8);
    mesh.positions.iter_mut().for_each(|p| p.coords *= 4.0);
    let found = upload(server.address, &[("q.off", &written("q.off", &mesh))], &[("explain", "true")]);
    let found = found.unwrap().json();
    let query = found["query_id"].as_str().unwrap();
    assert!(query.len() == 32 && query.bytes().all(|c| c.is_ascii_hexdigit()));
    let answer = get(&server, &format!("/api/compare?query={query}&b=ring1"));
    let json = answer.json();
    assert_eq!(answer.status, 200, "{json}");
    description.check("get", "/api/compare", 200, &json);
    assert_eq!((json["a"].as_str(), json["b"].as_str()), (Some("q.off"), Some("ring1")));
    assert_eq!(json["triangulation"], "same");
    assert!((json["scale"].as_f64().unwrap() * 4.0 - 1.0).abs() < 1e-6);
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
    let forms = [0, 1].map(|i| geometry(&json["forms"][i]));
    for (i, form) in forms.iter().enumerate() {
        let largest = form.values.as_ref().unwrap().iter().copied().fold(0.0, f32::max);
        let largest_residual = json["residual"][i]["max"].as_f64().unwrap();
        assert!((f64::from(largest) - largest_residual).abs() < 1e-5, "{largest}, {largest_residual}");
    }
    assert_eq!(geometry(&json["meshes"][0]).faces.len(), mesh.n_faces());
    assert!(json["gap"]["max"].as_f64().unwrap() < 1e-6, "{}", json["gap"]);
    let pair = get(&server, "/api/compare?a=ring0&b=box0").json();
    description.check("get", "/api/compare", 200, &pair);
    assert_eq!(pair["relation"]["kind"], "different");
    assert!(pair["meshes"].is_null() && pair["gap"].is_null());
    for (target, status) in [
        ("query=0123456789abcdef0123456789abcdef&b=ring1".to_owned(), 410),
        ("a=none&b=ring1".to_owned(), 404),
        ("a=ring1&b=none".to_owned(), 404),
        ("b=ring1".to_owned(), 400),
        (format!("query={query}&a=ring0&b=ring1"), 400),
        ("a=ring1".to_owned(), 400),
    ] {
        for path in ["/api/compare", "/api/match"] {
            let answer = get(&server, &format!("{path}?{target}"));
            assert_eq!(answer.status, status, "{target}");
            description.check("get", path, status, &answer.json());
        }
    }
    let matched = get(&server, &format!("/api/match?query={query}&b=ring1")).json();
    description.check("get", "/api/match", 200, &matched);
    assert_eq!((matched["a"].as_str(), matched["b"].as_str()), (Some("q.off"), Some("ring1")));
    assert!(matched["maps"][0]["distortion"].as_f64().unwrap() < 0.05, "{}", matched["maps"]);
    // The first mesh has values of the second.
    let values = [0, 1].map(|i| geometry(&matched["meshes"][i]).values.unwrap());
    assert!(values[0].iter().all(|value| values[1].contains(value)));
    assert!(values[0].iter().any(|value| *value > 0.0));
}

#[test]
fn the_page_and_its_files_have_tags_and_security_headers() {
    let server = Served::start(options());
    let health = get(&server, "/healthz");
    description(&server).check("get", "/healthz", 200, &health.json());
    assert_eq!(health.json()["shapes"], 7);
    let page = get(&server, "/");
    assert_eq!((page.status, page.header("content-type")), (200, Some("text/html; charset=utf-8")));
    let html = String::from_utf8(page.body.clone()).unwrap();
    let mut files = 0;
    for address in html.split(['"', '\'']).filter(|text| text.starts_with("/assets/")) {
        let file = get(&server, address);
        assert!(file.status == 200 && !file.body.is_empty(), "{address}");
        let again =
            ask(server.address, "GET", address, &[("If-None-Match", file.header("etag").unwrap())], b"");
        assert_eq!(again.unwrap().status, 304);
        files += 1;
    }
    assert_eq!(files, 4, "the page loads its other scripts as modules");
    assert!(
        !html.contains("http:/")
            || html.matches("http:/").count() == html.matches("http://www.w3.org").count()
    );
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
fn errors_of_unknown_routes_are_json() {
    let server = Served::start(options());
    for (method, target, status) in [
        ("GET", "/none", 404),
        ("GET", "/../../etc/passwd", 404),
        ("GET", "/assets/../openapi.json", 404),
        ("DELETE", "/api/search", 405),
        ("POST", "/api/shapes", 405),
        ("DELETE", "/api/shapes/ring0/mesh", 405),
    ] {
        let answer = ask(server.address, method, target, &[], b"").unwrap();
        assert_eq!(answer.status, status, "{target}");
        assert!(answer.json()["error"].is_string(), "{target}");
    }
}
