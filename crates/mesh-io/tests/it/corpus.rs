//! A corpus of small files, and what reading each gives: vertices, faces, area and notes, or the message.
//! Unless a case says otherwise, the mesh is a rectangle of 2 by 1.

use std::io::Write as _;
use std::path::Path;

use canonform_mesh_io::{Format, LengthUnit, ReadLimits, read, read_from, write};
use mesh::{TriMesh, shapes};
use nalgebra::Point3;
use tempfile::TempDir;
use testkit::written;

use crate::made::{
    HEAD, OBJ, OFF, PLAIN, PLY, RECTANGLE, Rich, SQUARE, STL, Style, TRI, VERT, binary_ply, binary_stl,
    check, gltf_text, mesh_text, model_of, one, outcome, package_of, read_all,
};

/// The bytes that a text stands for, in which `\n`, `\\` and `\u00ff` are escapes as in JSON.
fn unescaped(text: &str) -> Vec<u8> {
    let text = format!("\"{}\"", text.replace('"', "\\\""));
    let text: String = serde_json::from_str(&text).unwrap_or_else(|fault| panic!("{fault}: {text}"));
    text.chars().map(|byte| u8::try_from(byte).unwrap()).collect()
}

/// `corpus.tsv`: the name of a file, what it shows, its content and how its outcome begins. `@OFF|a|b` is the text [`OFF`]
/// with `b` for every `a`. A zero byte separates a `.vert` from its `.tri`, and 3MF files hold their content as model.
#[test]
fn files_of_any_dialect_are_read_or_refused_with_the_place() {
    let rich = Rich::new();
    let model = model_of(&shapes::tetrahedron(0));
    let bases = [
        ("@OFF", OFF.to_owned()),
        ("@OBJ", OBJ.to_owned()),
        ("@PLY", PLY.to_owned()),
        ("@STL", STL.to_owned()),
        ("@XYZ", xyz()),
        ("@RICH", rich.json("data.bin")),
        ("@MODEL", model),
    ];
    check(include_str!("corpus.tsv").lines().skip(1).map(|row| {
        let [name, what, content, expected] = *row.split('\t').collect::<Vec<_>>() else { panic!("{row}") };
        let mut edits = content.split('|');
        let mut text = edits.next().unwrap().to_owned();
        for (base, whole) in &bases {
            text = text.replace(base, &whole.replace('\n', "\\n"));
        }
        while let (Some(from), Some(to)) = (edits.next(), edits.next()) {
            assert!(text.contains(from), "{name}, {what}: {from}");
            text = text.replace(from, to);
        }
        let bytes = unescaped(&text);
        let files = match name {
            "m.vert" | "m.tri" => {
                let (vert, tri) = bytes.split_at(bytes.iter().position(|byte| *byte == 0).unwrap());
                let mut pair = vec![("m.vert", vert.to_vec()), ("m.tri", tri[1..].to_vec())];
                pair.sort_by_key(|(other, _)| *other != name);
                pair
            }
            "m.gltf" => vec![(name, bytes), ("data.bin", rich.data.clone())],
            "m.3mf" => one(name, package_of(&bytes)),
            _ => one(name, bytes),
        };
        (format!("{name}, {what}"), files, expected.replace("a rectangle", RECTANGLE))
    }));
}

/// A grid of points, of which the fourth is elsewhere.
fn xyz() -> String {
    let row = |i: usize| match i {
        4 => "1.5 2.5 1\n".to_owned(),
        i => format!("{}.5 {}.5 0.5\n", i % 4, i / 4),
    };
    (0..16).map(row).collect()
}

#[test]
fn text_in_utf16_is_named_in_every_format() {
    for (name, text) in [
        ("m.obj", OBJ),
        ("m.off", OFF),
        ("m.ply", PLY),
        ("m.stl", STL),
        ("m.xyz", "0 0 0\n1 1 1\n"),
        ("m.vert", VERT),
        ("m.gltf", "{\"asset\":{\"version\":\"2.0\"}}"),
    ] {
        for (mark, encode) in [
            (&b"\xff\xfe"[..], u16::to_le_bytes as fn(u16) -> [u8; 2]),
            (b"\xfe\xff", u16::to_be_bytes),
            (b"", u16::to_le_bytes),
            (b"", u16::to_be_bytes),
        ] {
            let content = [mark, &text.encode_utf16().flat_map(encode).collect::<Vec<u8>>()].concat();
            let mut files = one(name, content);
            files.push(("m.tri", TRI.into()));
            assert_eq!(outcome(&files), format!("{name}: the text is encoded as UTF-16; save it as UTF-8"));
        }
    }
}

#[test]
fn binary_stl_has_the_length_that_its_header_promises() {
    let longer = "m.stl: the file continues after the 1 triangles that its header promises";
    let shorter = "m.stl: the header promises 3 triangles but the file holds only 2";
    let mut cases = Vec::new();
    cases.push(("like UTF-16", binary_stl(b"s\0o\0l\0i\0d\0", 2, b""), RECTANGLE));
    for header in [&b"solid plate"[..], b"plate", b"# plate", b"", b"\xef\xbb\xbfsolid"] {
        let of = |count: u32, end: &[u8]| binary_stl(header, count, end);
        cases.extend([
            ("whole", of(2, b""), RECTANGLE),
            ("bytes at the end", of(2, b"ab"), RECTANGLE),
            ("almost a triangle at the end", of(2, &[1; 49]), RECTANGLE),
            ("a count too large", of(3, b""), shorter),
            ("a count too large, and bytes", of(3, &[0; 49]), shorter),
            ("a count too small", of(1, b""), longer),
            ("a count of nothing", of(0, b""), "m.stl: the file continues after the 0 triangles"),
        ]);
    }
    cases.push(("no triangles", one("m.stl", [0; 84]), "m.stl: the file has 0 vertices but no faces"));
    cases.push(("no count", one("m.stl", [0; 83]), "m.stl, byte 0: this is not an STL file (it is not text"));
    let of_numbers = |at: usize, x: u32| {
        let mut bytes = binary_stl(b"\0", 2, b"").remove(0).1;
        bytes[at..at + 4].copy_from_slice(&x.to_le_bytes());
        one("m.stl", bytes)
    };
    let nan = of_numbers(84 + 50 + 16, f32::NAN.to_bits());
    cases.push(("no number", nan, "m.stl, byte 134: vertex 3 has the coordinate NaN"));
    let bold = of_numbers(80, u32::MAX);
    cases.push(("a bold count", bold, "m.stl: the header promises 4294967295 triangles"));
    check(cases);
}

#[test]
fn binary_ply_is_read_in_both_byte_orders_and_faults_name_the_byte() {
    let whole = binary_ply(false);
    let start = whole.len() - 9 - 48;
    let with = |at: usize, bytes: &[u8]| {
        let mut changed = whole.clone();
        changed[start + at..start + at + bytes.len()].copy_from_slice(bytes);
        one("m.ply", changed)
    };
    let of_vertex = format!("m.ply, byte {}: vertex 1 has the coordinate inf", start + 12);
    let of_face =
        format!("m.ply, byte {}: the header promises 1 rows of `face` but the file holds only 0", start + 48);
    let behind = format!("m.ply, byte {}: the file continues after the 5 elements", whole.len());
    check([
        ("little", one("m.ply", &whole), RECTANGLE),
        ("big", one("m.ply", binary_ply(true)), RECTANGLE),
        ("infinite", with(12, &f32::INFINITY.to_le_bytes()), &of_vertex),
        ("a long list", with(48, &[200]), &of_face),
        ("cut", one("m.ply", &whole[..whole.len() - 1]), &of_face),
        ("bytes behind", one("m.ply", [&whole[..], &[1]].concat()), &behind),
        ("blanks behind", one("m.ply", [&whole[..], b"\n "].concat()), RECTANGLE),
    ]);
}

#[test]
fn writing_merges_no_corners_of_a_face() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mesh = testkit::moved(&shapes::grid(10, 10, 0.1), |p| p + nalgebra::Vector3::new(1e7, 1e7, -3e5));
    let refused = |name: &str, mesh: &TriMesh| {
        let text = write(&at(name), mesh).unwrap_err().to_string();
        assert!(text.starts_with("corners of face 0 coincide in the 32-bit floats of "), "{text}");
        assert!(!at(name).exists());
    };
    refused("far.stl", &mesh);
    write(&at("far.glb"), &mesh).unwrap();
    let back = read(&at("far.glb")).unwrap();
    assert_eq!(back.faces, mesh.faces);
    let error = back.positions.iter().zip(&mesh.positions).map(|(p, q)| (p - q).norm()).fold(0.0, f64::max);
    assert!(error < 1e-7, "{error}");
    // What no origin can save: two specks far from each other.
    let mut tiny = shapes::disjoint(&[shapes::grid(2, 2, 1e-9), shapes::grid(2, 2, 1e-9)]);
    tiny.positions.iter_mut().enumerate().for_each(|(v, p)| p.x += if v < 4 { 1.0 } else { 3.0 });
    ["tiny.stl", "tiny.glb"].iter().for_each(|name| refused(name, &tiny));
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

#[test]
fn gltf_puts_primitives_nodes_and_accessors_of_every_kind_together() {
    let rich = Rich::new();
    let files = vec![("m.gltf", rich.json("data.bin").into_bytes()), ("data.bin", rich.data.clone())];
    let file = read_all(&files, &ReadLimits::default()).unwrap();
    // The root, in its own place: a strip and a fan on the same vertices.
    assert_eq!(file.mesh.positions[..4], SQUARE.map(|p| Point3::from(p.map(f64::from))));
    // Its first child, moved, whose last vertex is sparse; its grandchild: mirrored, then twice as large and moved.
    assert_eq!(
        file.mesh.positions[4..],
        [
            [10., 0., 0.],
            [11., 0., 0.],
            [10., 1., 0.],
            [11., 1., 5.],
            [0., 20., 0.],
            [-2., 20., 0.],
            [0., 22., 0.],
            [-2., 22., 0.],
        ]
        .map(Point3::from)
    );
    assert!(outcome(&files).ends_with("; 0 1 2, 1 3 2, 1 3 0, 3 2 0, 4 5 6, 6 5 7, 8 10 9, 10 11 9"));
    // All squares face the same side, the mirrored one too.
    assert!((0..file.mesh.n_faces()).all(|f| file.mesh.area_vector(f).z > 0.0));
    assert_eq!((file.facts.unit, file.facts.instances), (Some(LengthUnit::Meter), Some(3)));
    assert_eq!(file.facts.ignored, ["all scenes but the default one", "points and lines"]);
    // What is written keeps the numbers of vertices, and reads alike as text.
    let mesh = shapes::disjoint(&[shapes::icosphere(2), shapes::cube(1)]);
    let [glb, gltf] = [one("m.glb", written("m.glb", &mesh)), one("m.gltf", gltf_text(&mesh))]
        .map(|files| read_all(&files, &ReadLimits::default()).unwrap().mesh);
    let rounded = mesh.positions.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
    assert_eq!(glb, TriMesh { positions: rounded, faces: mesh.faces });
    assert_eq!(gltf, glb);
}

#[test]
fn small_files_cannot_make_huge_meshes() {
    // Without data, four billion zeros.
    let zeros = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"data:;base64,AAAAAAAAAAAAAAAAAAAAAA==","byteLength":16}],"bufferViews":[{"buffer":0,"byteLength":16}],"accessors":[{"componentType":5126,"count":4000000000,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]}"#;
    // Thousands of copies of a mesh of thousands of vertices.
    let nodes = vec![r#"{"mesh":0}"#; 20_000].join(",");
    let numbers: Vec<String> = (0..20_000).map(|i| i.to_string()).collect();
    let copies = gltf_text(&shapes::icosphere(5))
        .replace(r#""nodes":[{"mesh":0}]"#, &format!(r#""nodes":[{nodes}]"#))
        .replace(r#"{"nodes":[0]}"#, &format!(r#"{{"nodes":[{}]}}"#, numbers.join(",")));
    // Every object consists of two copies of the one before it.
    let doubled = |id: usize| {
        let component = format!("<component objectid=\"{}\"/>", id - 1);
        format!("<object id=\"{id}\"><components>{component}{component}</components></object>")
    };
    let objects: String = (2..60).map(doubled).collect();
    let of = |first: &str| {
        let model = format!(
            "{HEAD}<resources>{first}{objects}</resources><build><item objectid=\"59\"/></build></model>"
        );
        one("m.3mf", package_of(model.as_bytes()))
    };
    let first = format!("<object id=\"1\">{}</object>", mesh_text(&shapes::tetrahedron(0)));
    // A column of 20 MB of zeros.
    let mut fields = PLAIN.fields(&shapes::tetrahedron(0));
    fields[0].1 = PLAIN.matrix("", 9, 20 << 17, 1, &vec![0.0; 20 << 17]);
    let style = Style { compressed: true, ..PLAIN };
    let mat = one("m.mat", style.file(&[PLAIN.structure("surface", &fields)]));
    let over = read_all(&mat, &ReadLimits::of_vertices(1000)).unwrap_err().to_string();
    assert!(over.contains("the mesh exceeds the limit of 1000 vertices"), "{over}");
    check([
        ("zeros", one("m.gltf", zeros), "m.gltf, accessor 0: the compressed data grows beyond"),
        ("copies", one("m.gltf", copies), "m.gltf, mesh 0: its copies of meshes add up to more than"),
        ("doubled", of(&first), "m.3mf, object 1: its copies of meshes add up to more than"),
        (
            "doubled nothing",
            of("<object id=\"1\"/>"),
            "m.3mf, object 1: its copies of meshes add up to more than",
        ),
        (
            "blanks",
            one("m.3mf", package_of(&vec![b' '; 80 << 20])),
            "m.3mf/3D/3dmodel.model: the compressed data grows",
        ),
        ("a column", mat, "m.mat, byte 136: the compressed data grows beyond"),
    ]);
}

#[test]
fn threemf_finds_its_parts() {
    let whole = "4 vertices, 4 faces";
    check(
        [
            ("absolute", "/3D/a.model", "3D/a.model", whole),
            ("a dot", "./3D/a.model", "3D/a.model", whole),
            ("escaped", "/3D/Foo%20Bar.model", "3D/Foo Bar.model", whole),
            ("escaped in the archive", "/3D/Foo Bar.model", "3D/Foo%20Bar.model", whole),
            ("an entity", "/3D/a&amp;b.model", "3D/A&B.model", whole),
            ("missing", "/3D/b.model", "3D/a.model", "m.3mf: this is not a 3MF file (a zip archive without"),
        ]
        .map(|(what, target, entry, expected)| {
            let relationships = format!(
                "<Relationships><Relationship Target=\"{target}\" Id=\"r\" \
                 Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>"
            );
            let parts = [("_rels/.rels", relationships), (entry, model_of(&shapes::tetrahedron(0)))];
            (what, one("m.3mf", testkit::zip_of(&parts)), expected)
        }),
    );
}

#[test]
fn threemf_places_and_counts_components_and_items() {
    let corner = shapes::tetrahedron(0);
    let model = format!(
        "{HEAD}<resources><object id=\"7\" type=\"model\">{}</object>\
         <object id=\"8\"><components>\
         <component objectid=\"7\" transform=\"2 0 0 0 2 0 0 0 2 10 0 0\"/>\
         <component objectid=\"7\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>\
         </components></object></resources>\
         <build><item objectid=\"8\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 5\"/><item objectid=\"7\"/></build></model>",
        mesh_text(&corner)
    );
    let file = read_all(&one("m.3mf", package_of(model.as_bytes())), &ReadLimits::default()).unwrap();
    assert_eq!((file.facts.unit, file.facts.instances), (Some(LengthUnit::Inch), Some(3)));
    assert_eq!((file.mesh.n_vertices(), file.mesh.n_faces()), (12, 12));
    for (v, p) in corner.positions.iter().enumerate() {
        // Doubled and moved, then turned by a right angle and lifted.
        let q = file.mesh.positions[v];
        assert_eq!([q.x, q.y, q.z], [-2.0 * p.y, 2.0 * p.x + 10.0, 2.0 * p.z + 5.0]);
        assert_eq!(file.mesh.positions[v + 8], *p);
    }
    // The mirrored copy keeps its outside.
    assert!((file.mesh.signed_volume() / corner.signed_volume() - 10.0).abs() < 1e-12);
    // Objects of other parts, and without a build every object that is no component.
    let ball = shapes::icosphere(1);
    let other = format!(
        "{HEAD}<resources><object id=\"1\">{}</object></resources><build/></model>",
        mesh_text(&ball)
    );
    let root = format!(
        "{HEAD}<resources><object id=\"1\"><components><component p:path=\"/3D/Objects/ball.model\" objectid=\"1\"/>\
         </components></object></resources><build><item objectid=\"1\"/></build></model>"
    );
    let parts = [("3D/3dmodel.model", root.as_bytes()), ("3d/objects/BALL.model", other.as_bytes())];
    let whole = read_all(&one("m.3mf", testkit::zip_of(&parts)), &ReadLimits::default()).unwrap().mesh;
    assert_eq!(whole, ball);
    let no_build =
        model_of(&ball).replace("<item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 2 0 0\"/>", "");
    let file = read_all(&one("m.3mf", package_of(no_build.as_bytes())), &ReadLimits::default()).unwrap();
    assert_eq!((file.mesh.n_vertices(), file.facts.instances), (42, Some(1)));
    assert_eq!(written("m.3mf", &ball), written("m.3mf", &ball), "the same mesh gives the same bytes");
    let too_few = one("m.3mf", testkit::zip_of(&parts[..1]));
    let expected = "m.3mf: expected all parts that the file refers to, found `no part 3D/Objects/ball.model`";
    assert!(outcome(&too_few).starts_with(expected), "{}", outcome(&too_few));
}

#[test]
fn matlab_files_are_read_in_every_encoding() {
    let torus = shapes::torus(8, 5, 2.0, 0.5);
    for index_type in [4, 5, 7, 9] {
        for (big_endian, compressed) in [(false, false), (false, true), (true, false), (true, true)] {
            let style = Style { big_endian, compressed, index_type };
            let files = one("m.mat", style.surface(&torus));
            assert_eq!(read_all(&files, &ReadLimits::default()).unwrap().mesh, torus);
        }
    }
    let mesh = shapes::tetrahedron(0);
    let x: Vec<f64> = mesh.positions.iter().map(|p| p.x).collect();
    let index = "m.mat, byte 136: a face refers to vertex";
    let short = "m.mat, byte 136: expected columns X Y Z of equal length";
    let wide = "m.mat, byte 136: expected three columns in TRIV, found `3 x 4`";
    let bold =
        "m.mat, byte 136: the header promises 1000000000000 numbers of a matrix but the file holds only 4";
    let of_fields: [(usize, usize, usize, &[f64], &str); 9] = [
        (0, 1, 4, &x, "4 vertices, 4 faces"),
        (1, 4, 1, &[0.0, 0.0, f64::NAN, 0.0], "m.mat, byte 136: vertex 3 has the coordinate NaN"),
        (1, 3, 1, &[0.0; 3], short),
        (3, 3, 4, &[1.0; 12], wide),
        (3, 1, 3, &[1.0, 2.0, 5.0], index),
        (3, 1, 3, &[1.0, 2.0, 2.5], index),
        (3, 1, 3, &[1.0, 2.0, f64::NAN], index),
        (3, 0, 3, &[], "m.mat: the file has 4 vertices but no faces"),
        (0, 1_000_000, 1_000_000, &[0.0; 4], bold),
    ];
    check(of_fields.map(|(field, rows, columns, values, expected)| {
        let mut fields = PLAIN.fields(&mesh);
        fields[field].1 = PLAIN.matrix("", 9, rows, columns, values);
        (expected, one("m.mat", PLAIN.file(&[PLAIN.structure("surface", &fields)])), expected)
    }));
    let mut nested = PLAIN.fields(&mesh);
    nested[0].1 = PLAIN.structure("", &[]);
    let many: Vec<_> = (0..100).map(|i| PLAIN.matrix(&format!("{i:06000}"), 9, 1, 1, &[1.0])).collect();
    let whole = PLAIN.surface(&mesh);
    check([
        (
            "a struct in a field",
            one("m.mat", PLAIN.file(&[PLAIN.structure("surface", &nested)])),
            "m.mat, byte 136: expected a full matrix",
        ),
        (
            "another variable",
            one("m.mat", PLAIN.file(&[PLAIN.matrix("other", 9, 1, 1, &[1.0])])),
            "m.mat: the file has no struct with the fields X Y Z TRIV (its variables: other)",
        ),
        ("cut", one("m.mat", &whole[..whole.len() - 8]), "m.mat, byte 208: the header promises"),
    ]);
    let message = outcome(&one("m.mat", PLAIN.file(&many)));
    assert!(message.contains("and 92 more") && message.len() < 1000, "{message}");
}

/// A stream with more bytes than allowed is never read in part.
#[test]
fn streams_beyond_their_limit_are_refused_at_any_limit() {
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
