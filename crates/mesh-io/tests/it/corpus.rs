//! A table of files as programs write them, and what reading each gives: vertices, faces, area and notes, or the message.
//! Unless a case says otherwise, the mesh is a rectangle of 2 by 1.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use canonform_mesh_io::{Disk, MeshFile, ReadLimits, read, read_file, write};
use mesh::{TriMesh, shapes};
use nalgebra::Point3;
use tempfile::TempDir;

/// Files, the first of which is read.
type Files = Vec<(&'static str, Vec<u8>)>;

fn one(name: &'static str, content: impl AsRef<[u8]>) -> Files {
    vec![(name, content.as_ref().to_vec())]
}

/// What reading gives, in words.
fn outcome(files: &Files) -> String {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in files {
        std::fs::write(folder.path().join(name), content).unwrap();
    }
    match read_file(&folder.path().join(files[0].0), &Disk, &ReadLimits::default()) {
        Ok(MeshFile { mesh, facts, .. }) => {
            let area = (mesh.area() * 1e6).round() / 1e6;
            let mut words = format!("{} vertices, {} faces, area {area}", mesh.n_vertices(), mesh.n_faces());
            facts.ignored.iter().for_each(|what| write!(words, ", ignored {what}").unwrap());
            facts.notes.iter().for_each(|what| write!(words, ", {what}").unwrap());
            words
        }
        Err(fault) => fault.to_string().replace(&format!("{}/", folder.path().display()), ""),
    }
}

/// Checks a table: what a case shows, its files, and how the outcome begins.
fn check(cases: Vec<(&str, Files, &str)>) {
    let wrong: Vec<String> = cases
        .into_iter()
        .map(|(what, files, expected)| (what, outcome(&files), expected))
        .filter(|(_, found, expected)| !found.starts_with(expected))
        .map(|(what, found, expected)| format!("{what}:\n  {found}\nis not\n  {expected}"))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

const RECTANGLE: &str = "4 vertices, 2 faces, area 2";
const OBJ: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n";
const OFF: &str = "OFF\n4 1 4\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n";
const VERT: &str = "0 0 0\n2 0 0\n2 1 0\n0 1 0\n";
const TRI: &str = "1 2 3\n1 3 4\n";
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property float nx\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\n\
    property float quality\nend_header\n0 0 0 0 9\n2 0 0 0 9\n2 1 0 0 9\n0 1 0 0 9\n4 0 1 2 3 .5\n";
const STL: &str = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 2 1 0\nendloop\nendfacet\n\
    facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid x\n";

/// A grid of points, of which the fourth has this text.
fn xyz(separator: &str, mark: &str, fourth: &str) -> String {
    let row = |i: usize| match i {
        4 => fourth.to_owned(),
        i => [i % 4, i / 4, 0].map(|x| format!("{x}{mark}5")).join(separator),
    };
    (0..16).map(|i| row(i) + "\n").collect()
}

fn utf16(text: &str, mark: &[u8], encode: fn(u16) -> [u8; 2]) -> Vec<u8> {
    [mark, &text.encode_utf16().flat_map(encode).collect::<Vec<u8>>()].concat()
}

#[test]
fn words_that_are_no_numbers_are_never_read_as_their_beginnings() {
    for word in
        ["1.#QNAN", "-1.#IND00", "1.#INF", "1.#J", "-1.#QNAN0", "nan(ind)", "1,5", "0x1p3", "1_0", "1.5#"]
    {
        for (name, text) in [
            ("m.obj", OBJ.replace("v 2 1 0", &format!("v 2 1 {word}"))),
            ("m.off", OFF.replace("2 1 0", &format!("2 1 {word}"))),
            ("m.ply", PLY.replace("2 1 0 0 9", &format!("2 1 {word} 0 9"))),
            ("m.stl", STL.replace("vertex 2 1 0", &format!("vertex 2 1 {word}"))),
            ("m.xyz", xyz(" ", ".", "1.5 2.5 1").replace("1.5 2.5 1", &format!("1.5 2.5 {word}"))),
            ("m.vert", VERT.replace("2 1 0", &format!("2 1 {word}"))),
            ("m.tri", TRI.replace("1 3 4", &format!("1 3 {word}"))),
        ] {
            let line = 1 + text.lines().position(|line| line.contains(word)).unwrap();
            let mut files = one(name, text);
            match name {
                "m.vert" => files.push(("m.tri", TRI.into())),
                "m.tri" => files.push(("m.vert", VERT.into())),
                _ => {}
            }
            let found = outcome(&files);
            assert!(found.starts_with(&format!("{name}, line {line}: ")), "{word} in {name}: {found}");
        }
    }
}

#[test]
fn text_in_utf16_is_named_in_every_format() {
    for (name, text) in [
        ("m.obj", OBJ),
        ("m.off", OFF),
        ("m.ply", PLY),
        ("m.stl", STL),
        ("m.xyz", "0 0 0\n1 1 1\n"),
        ("m.pts", "0 0 0\n1 1 1\n"),
        ("m.vert", VERT),
        ("m.gltf", "{\"asset\":{\"version\":\"2.0\"}}"),
    ] {
        for content in [
            utf16(text, b"\xff\xfe", u16::to_le_bytes),
            utf16(text, b"\xfe\xff", u16::to_be_bytes),
            utf16(text, b"", u16::to_le_bytes),
            utf16(text, b"", u16::to_be_bytes),
        ] {
            let mut files = one(name, content);
            files.push(("m.tri", TRI.into()));
            assert_eq!(outcome(&files), format!("{name}: the text is encoded as UTF-16; save it as UTF-8"));
        }
    }
}

#[test]
fn text_of_any_dialect_is_read() {
    let marked = |text: &str| format!("\u{feff}{text}");
    let broken = |text: &str| text.replace(' ', "\n");
    let windows = |text: &str| text.replace('\n', "\r\n");
    let single = |text: &str| text.replace('\n', " ");
    check(vec![
        (
            "comments",
            one("m.obj", format!("# a\n{} # b\n", OBJ.replace("v 2 0 0", "v 2 0 0 # c\n#d"))),
            RECTANGLE,
        ),
        (
            "continued lines",
            one("m.obj", OBJ.replace("2 0 0", "2 0 \\\n0").replace("2 3", "2 \\\n\\\r\n3")),
            RECTANGLE,
        ),
        (
            "a line continued at the end",
            one("m.obj", format!("{OBJ}f 1 2 \\")),
            "m.obj, line 6: a face has 2 corners",
        ),
        ("a continued comment", one("m.obj", OBJ.replace("f 1", "# c \\\nf 1")), RECTANGLE),
        ("a continued group", one("m.obj", OBJ.replace("f 1", "g a \\\nv 9 9 9\nf 1")), RECTANGLE),
        (
            "`\\` within a word",
            one("m.obj", OBJ.replace("2 3", "2\\\n3")),
            "m.obj, line 5: a face has 2 corners",
        ),
        (
            "faults behind a continuation",
            one("m.obj", OBJ.replace("2 0 0", "2 \\\n0 x")),
            "m.obj, line 2: expected three coordinates, found `v 2 0 x`",
        ),
        (
            "indices behind a continuation",
            one("m.obj", OBJ.replace("1 2 3", "1 \\\n2 9")),
            "m.obj, line 5: a face refers to vertex 9",
        ),
        ("a mark", one("m.obj", marked(OBJ)), RECTANGLE),
        ("a mark", one("m.off", marked(OFF)), RECTANGLE),
        ("two vertices in a line", one("m.off", OFF.replace("0 0 0\n2", "0 0 0 2")), RECTANGLE),
        ("words on their own", one("m.off", broken(OFF)), RECTANGLE),
        ("one line", one("m.off", single(OFF)), RECTANGLE),
        ("colours", one("m.off", OFF.replace(" 0\n", " 0 9 9 9\n")), RECTANGLE),
        (
            "colours that run on",
            one("m.off", OFF.replace("OFF", "COFF").replace("0 0 0\n2", "0 0 0 2")),
            "m.off, line 6: ",
        ),
        (
            "a vertex too few",
            one("m.off", OFF.replace("0 0 0\n", "")),
            "m.off, line 6: the header promises 1 faces",
        ),
        ("a mark", one("m.stl", marked(STL)), RECTANGLE),
        ("a comment first", one("m.stl", format!("# by x\n\n{STL}")), RECTANGLE),
        ("words on their own", one("m.stl", broken(&STL.replace(" x", ""))), RECTANGLE),
        ("one line", one("m.stl", single(STL)), RECTANGLE),
        ("windows", one("m.stl", windows(STL)), RECTANGLE),
        (
            "two solids",
            one("m.stl", format!("{STL}{}", single(&STL.replace(" 0\n", " 3\n")))),
            "8 vertices, 4 faces, area 4",
        ),
        ("names of keywords", one("m.stl", STL.replace("solid x", "solid facet endsolid outer")), RECTANGLE),
        ("no name", one("m.stl", STL.replace("solid x", "solid")), RECTANGLE),
        ("`end solid`", one("m.stl", STL.replace("endsolid x", "end solid x")), RECTANGLE),
        ("a normal that is no number", one("m.stl", STL.replace("0 0 1\n", "-nan(ind) 1.#J 0\n")), RECTANGLE),
        ("no normal", one("m.stl", STL.replace("normal 0 0 1", "")), RECTANGLE),
        (
            "a loop without a word",
            one("m.stl", STL.replacen("outer loop\n", "", 1)),
            "m.stl, line 3: expected `outer loop`",
        ),
        (
            "four corners",
            one("m.stl", STL.replacen("endloop", "vertex 0 1 0\nendloop", 1)),
            "m.stl, line 7: expected `endloop`, found `vertex 0 1 0`",
        ),
        ("a facet cut off", one("m.stl", &STL[..150]), "m.stl, line 12: the file ends where `endsolid`"),
        (
            "another text",
            one("m.stl", OFF.repeat(3)),
            "m.stl: this is not an STL file (it begins with `OFF`)",
        ),
        (
            "columns of no interest",
            one("m.ply", PLY.replace("0 9\n", "-nan(ind) 1.#IND\n").replace(".5", "x")),
            RECTANGLE,
        ),
        (
            "a column too few",
            one("m.ply", PLY.replace("2 1 0 0 9", "2 1 0 0")),
            "m.ply, line 15: expected a row as the header declares it",
        ),
        (
            "a corner that is no number",
            one("m.ply", PLY.replace("4 0 1 2", "4 0 x 2")),
            "m.ply, line 17: expected a row as the header declares it",
        ),
    ]);
}

#[test]
fn commas_mark_decimals_or_separate_numbers_or_are_refused() {
    let tetrahedra = "16 vertices, 0 faces";
    let refused =
        "m.xyz, line 5: commas may separate numbers here, or mark decimals; write decimals with points";
    let numbers = |separator: &str, mark: &str, fourth: &str| one("m.xyz", xyz(separator, mark, fourth));
    let mut cases = Vec::new();
    for separator in [" ", "\t", ";", "; ", "  "] {
        cases.push((separator, numbers(separator, ",", "1,25 2,5 3"), tetrahedra));
    }
    for fourth in
        ["1, 2, 3", "1,2,3", "1.5,-2.5, 3.5", "12.345,123, 3", "-1,-22, 3", "1 2 3 0,5", "1;2;3;4,5,6"]
    {
        cases.push((fourth, numbers(",", ".", fourth), tetrahedra));
    }
    for fourth in
        ["1,234.5 2 3", "1,5 2.5 3", "1,5, 2,5, 3,5", "1,2 3", "1,2,3 255 0", "1,5;2", "1,234,567 2 3"]
    {
        cases.push((fourth, numbers(" ", ".", fourth), refused));
    }
    cases.push(("-1,#IND", numbers(" ", ",", "1,5 1,5 -1,#IND"), "m.xyz, line 5: "));
    check(cases);
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("m.xyz");
    std::fs::write(&path, xyz(";", ",", "-1,25;+2,5e-1;318")).unwrap();
    assert_eq!(
        read(&path).unwrap().positions[4..6],
        [[-1.25, 0.25, 318.0], [1.5, 1.5, 0.5]].map(Point3::from)
    );
}

/// Binary STL of the rectangle with another header, a count and bytes at the end.
fn binary_stl(header: &[u8], count: u32, end: &[u8]) -> Files {
    let corners = [[0f32, 0., 0.], [2., 0., 0.], [2., 1., 0.], [0., 1., 0.]];
    let mut bytes = vec![b' '; 80];
    bytes[..header.len()].copy_from_slice(header);
    bytes.extend(count.to_le_bytes());
    for face in [[0, 1, 2], [0, 2, 3]] {
        bytes.extend([0; 12]);
        bytes.extend(face.iter().flat_map(|v| corners[*v]).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes.extend(end);
    one("m.stl", bytes)
}

#[test]
fn binary_stl_has_the_length_that_its_header_promises() {
    let longer = "m.stl: the file continues after the 1 triangles that its header promises";
    let shorter = "m.stl: the header promises 3 triangles but the file holds only 2";
    let mut cases = Vec::new();
    for header in [&b"solid plate"[..], b"plate", b"# plate", b"", b"\xef\xbb\xbfsolid", b"s\0o\0l\0i\0d\0"] {
        cases.push(("whole", binary_stl(header, 2, b""), RECTANGLE));
    }
    for header in [&b"solid plate"[..], b"plate", b"# plate", b"", b"\xef\xbb\xbfsolid"] {
        cases.push(("bytes at the end", binary_stl(header, 2, b"ab"), RECTANGLE));
        cases.push(("almost a triangle at the end", binary_stl(header, 2, &[1; 49]), RECTANGLE));
        cases.push(("a count too large", binary_stl(header, 3, b""), shorter));
        cases.push(("a count too large, and bytes", binary_stl(header, 3, &[0; 49]), shorter));
        cases.push(("a count too small", binary_stl(header, 1, b""), longer));
        cases.push((
            "a count of nothing",
            binary_stl(header, 0, b""),
            "m.stl: the file continues after the 0 triangles",
        ));
    }
    cases.push(("no triangles", one("m.stl", [0; 84]), "m.stl: the file has 0 vertices but no faces"));
    cases.push(("no count", one("m.stl", [0; 83]), "m.stl, byte 0: this is not an STL file (it is not text"));
    check(cases);
}

#[test]
fn polygons_are_covered_once_and_doubts_are_noted() {
    let obj =
        |points: &str, face: &str| one("m.obj", format!("v {}\nf {face}\n", points.replace(", ", "\nv ")));
    let notch = "0 0 0, 4 0 0, 4 4 0, 2 1 0, 0 4 0";
    let rows = notch.replace(", ", "\n");
    let ply = PLY.replace("vertex 4", "vertex 5").replace("property float nx\nproperty uchar red\n", "");
    let ply = format!("{}end_header\n{rows}\n5 4 3 2 1 0 0\n", &ply[..ply.find("end_header").unwrap()]);
    check(vec![
        ("concave", obj(notch, "1 2 3 4 5"), "5 vertices, 3 faces, area 10"),
        (
            "concave",
            one("m.off", format!("OFF 5 1 0\n{rows}\n5 0 1 2 3 4\n")),
            "5 vertices, 3 faces, area 10",
        ),
        ("concave", one("m.ply", ply), "5 vertices, 3 faces, area 10"),
        (
            "a concave quadrilateral",
            obj("0 0 0, 2 1 0, 4 0 0, 2 4 0", "1 2 3 4"),
            "4 vertices, 2 faces, area 6",
        ),
        ("in a row", obj("0 0 0, 1 0 0, 2 0 0, 2 1 0, 0 1 0", "1 2 3 4 5"), "5 vertices, 3 faces, area 2"),
        (
            "crossing",
            obj("0 0 0, 1 1 0, 1 0 0, 0 1 0", "1 2 3 4"),
            "4 vertices, 2 faces, area 1, polygons that cross themselves, which are covered in parts twice or not at all: 1",
        ),
        (
            "bent",
            obj("0 0 0, 1 0 0, 1 1 .5, 0 1 0", "1 2 3 4"),
            "4 vertices, 2 faces, area 1.112372, polygons that are not flat, whose surface depends on how they are split: 1",
        ),
        (
            "slightly bent",
            obj("0 0 0, 1 0 0, 1 1 .01, 0 1 0", "1 2 3 4"),
            "4 vertices, 2 faces, area 1.00005",
        ),
    ]);
}

fn far() -> TriMesh {
    let mut grid = shapes::grid(10, 10, 0.1);
    grid.positions.iter_mut().for_each(|p| *p += nalgebra::Vector3::new(1e7, 1e7, -3e5));
    grid
}

#[test]
fn writing_merges_no_corners_of_a_face() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mesh = far();
    let refused = write(&at("far.stl"), &mesh).unwrap_err().to_string();
    assert_eq!(
        refused,
        "corners of face 0 coincide in the 32-bit floats of STL; move the mesh to the origin or use another format"
    );
    write(&at("far.glb"), &mesh).unwrap();
    let back = read(&at("far.glb")).unwrap();
    assert_eq!(back.faces, mesh.faces);
    let error = back.positions.iter().zip(&mesh.positions).map(|(p, q)| (p - q).norm()).fold(0.0, f64::max);
    assert!(error < 1e-7, "{error}");
    // What no origin can save: two specks far from each other.
    let mut tiny = shapes::disjoint(&[shapes::grid(2, 2, 1e-9), shapes::grid(2, 2, 1e-9)]);
    tiny.positions.iter_mut().enumerate().for_each(|(v, p)| p.x += if v < 4 { 1.0 } else { 3.0 });
    for name in ["tiny.stl", "tiny.glb"] {
        assert!(
            write(&at(name), &tiny).unwrap_err().to_string().starts_with("corners of face 0 coincide in")
        );
        assert!(!at(name).exists());
    }
    // Corners that were one before, a speck on a surface, and other formats.
    let mut speck = shapes::disjoint(&[shapes::grid(2, 2, 1e-9), shapes::grid(2, 2, 1.0)]);
    speck.positions.iter_mut().for_each(|p| p.x += 1.0);
    let mut closed = shapes::grid(2, 2, 1.0);
    closed.positions[1] = closed.positions[0];
    for (name, mesh) in [
        ("closed.stl", &closed),
        ("closed.glb", &closed),
        ("speck.stl", &speck),
        ("far.ply", &mesh),
        ("far.off", &mesh),
    ] {
        write(&at(name), mesh).unwrap();
        assert_eq!(read(&at(name)).unwrap().n_faces(), mesh.n_faces(), "{name}");
    }
}

/// A glTF file of the rectangle, with members of its second node and of the root.
fn gltf(uri: &str, second: &str, root: &str) -> Vec<u8> {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0,1]}}],"nodes":[{{"mesh":0}},{{"mesh":0{second}}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":4}},
{{"bufferView":1,"componentType":5121,"type":"SCALAR","count":6}}],
"bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":6}}],
"buffers":[{{"byteLength":54,"uri":"{uri}"}}]{root}}}"#
    )
    .into_bytes()
}

#[test]
fn gltf_refers_to_files_and_hides_nodes() {
    let corners = [0f32, 0., 0., 2., 0., 0., 2., 1., 0., 0., 1., 0.];
    let data: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).chain([0, 1, 2, 0, 2, 3]).collect();
    let with = |uri: &str, second: &str, root: &str| {
        vec![("m.gltf", gltf(uri, second, root)), ("my data.bin", data.clone())]
    };
    let hidden = r#","children":[],"extensions":{"KHR_node_visibility":{"visible":false}}"#;
    let both = "8 vertices, 4 faces, area 4";
    check(vec![
        ("a dot", with("./my%20data.bin", "", ""), both),
        ("dots", with("././my data.bin", "", ""), both),
        ("another folder", with("./../my%20data.bin", "", ""), "m.gltf, buffer 0: its data is in"),
        ("hidden", with("my data.bin", hidden, ""), "4 vertices, 2 faces, area 2, ignored hidden nodes"),
        (
            "hidden, as required",
            with("my data.bin", hidden, r#","extensionsRequired":["KHR_node_visibility"]"#),
            "4 vertices, 2 faces, area 2, ignored hidden nodes",
        ),
        ("shown", with("my data.bin", &hidden.replace("false", "true"), ""), both),
        ("no such member", with("my data.bin", r#","extensions":{"KHR_node_visibility":7}"#, ""), both),
        (
            "below a hidden one",
            with("my data.bin", &hidden.replace("[]", "[2]"), "")
                .into_iter()
                .map(|(name, content)| {
                    let text = String::from_utf8_lossy(&content).replace(
                        r#"}}],
"meshes""#,
                        r#"}},{"mesh":0}],
"meshes""#,
                    );
                    (name, if name == "m.gltf" { text.into_bytes() } else { content })
                })
                .collect(),
            "4 vertices, 2 faces, area 2, ignored hidden nodes",
        ),
    ]);
}

/// A 3MF file whose relationship names a part, and whose second object has attributes and content.
fn threemf(target: &str, entry: &str, attributes: &str, more: &str) -> Files {
    let mesh = r#"<vertices><vertex x="0" y="0" z="0"/><vertex x="&#50;" y="0" z="0"/><vertex x="2" y="1" z="0"/>
<vertex x="0" y="1" z="0"/></vertices><triangles><triangle v1="0" v2="1" v3="2"/><triangle v1="0" v2="2" v3="3"/></triangles>"#;
    let model = format!(
        r#"<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources>
<object id="1"><mesh>{mesh}</mesh></object><object id="2"{attributes}><mesh>{mesh}{more}</mesh></object></resources>
<build><item objectid="1"/><item objectid="2" transform="1 0 0 0 1 0 0 0 1 &#x31;0 0 0"/></build></model>"#
    );
    let relationships = format!(
        r#"<Relationships><Relationship Target="{target}" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#
    );
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, content) in [("_rels/.rels", &relationships), (entry, &model)] {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(content.as_bytes()).unwrap();
    }
    one("m.3mf", archive.finish().unwrap().into_inner())
}

#[test]
fn threemf_finds_its_parts_and_leaves_out_supports() {
    let both = "8 vertices, 4 faces, area 4";
    check(vec![
        ("absolute", threemf("/3D/a.model", "3D/a.model", "", ""), both),
        ("a dot", threemf("./3D/a.model", "3D/a.model", "", ""), both),
        ("escaped", threemf("/3D/Foo%20Bar.model", "3D/Foo Bar.model", "", ""), both),
        ("escaped in the archive", threemf("/3D/Foo Bar.model", "3D/Foo%20Bar.model", "", ""), both),
        ("an entity", threemf("/3D/a&amp;b.model", "3D/A&B.model", "", ""), both),
        (
            "missing",
            threemf("/3D/b.model", "3D/a.model", "", ""),
            "m.3mf: this is not a 3MF file (a zip archive without 3D/b.model)",
        ),
        ("a model", threemf("/3D/a.model", "3D/a.model", r#" type="model""#, ""), both),
        (
            "a support",
            threemf("/3D/a.model", "3D/a.model", r#" type="support""#, ""),
            "4 vertices, 2 faces, area 2, ignored supports",
        ),
        (
            "a solid support",
            threemf("/3D/a.model", "3D/a.model", r#" type="solidsupport""#, ""),
            "4 vertices, 2 faces, area 2, ignored supports",
        ),
        (
            "beams",
            threemf("/3D/a.model", "3D/a.model", "", "<b:beamlattice/>"),
            "8 vertices, 4 faces, area 4, ignored beam lattices",
        ),
    ]);
}

/// A stream with more bytes than allowed is never read in part.
#[test]
fn streams_beyond_their_limit_are_refused_at_any_limit() {
    use canonform_mesh_io::{Format, read_from};
    let rows = |n: usize| "1 2 3\n".repeat(n).into_bytes();
    let mut zipped = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    zipped.write_all(&rows(20_000)).unwrap();
    for (content, size) in [(rows(50), 300), (rows(20_000), 120_000), (zipped.finish().unwrap(), 120_000)] {
        for limit in [1, 60, 299, 300, 301, 16_383, 16_384, 16_385, 16_386, 119_999, 120_000, 120_001] {
            let limits = ReadLimits { max_bytes: limit, ..ReadLimits::default() };
            let read = read_from(Path::new("-"), &mut &content[..], Format::named("xyz").unwrap(), &limits);
            match read {
                Ok(file) => {
                    assert!(file.mesh.n_vertices() as u64 * 6 == size && size <= limit, "{size} {limit}")
                }
                Err(fault) => assert!(size > limit, "{size} {limit}: {fault}"),
            }
        }
    }
}
