use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::*;
use mesh::shapes;

/// Files with dense, sparse, strided and quantized accessors, strips, fans and nodes, and which of them to damage.
pub(crate) fn samples(mesh: &TriMesh) -> Vec<(&'static str, Vec<Vec<u8>>, usize)> {
    let rich = Rich::new().json("data.bin");
    let plain = as_text(mesh);
    let data = Rich::new().data;
    vec![
        ("gltf", vec![plain.into_bytes()], 0),
        ("gltf rich", vec![rich.clone().into_bytes(), data.clone()], 0),
        ("gltf data", vec![rich.into_bytes(), data], 1),
    ]
}

/// What the writer writes, as text with a data URI.
fn as_text(mesh: &TriMesh) -> String {
    let mut glb = Vec::new();
    write(&mut glb, mesh, None).unwrap();
    let (json, _, data) = split_binary(&glb).unwrap();
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(data.unwrap()));
    let json = std::str::from_utf8(json).unwrap().trim_end();
    json.replace(r#""buffers":[{"#, &format!(r#""buffers":[{{"uri":"{uri}","#))
}

/// A file in which positions are a unit square, stored in several ways.
struct Rich {
    data: Vec<u8>,
}

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

impl Rich {
    fn new() -> Self {
        let mut data = Vec::new();
        // 0: four vertices, 16 bytes each.
        for p in SQUARE {
            p.iter().for_each(|x| data.extend(x.to_le_bytes()));
            data.extend([7; 4]);
        }
        // 64: a strip; 72: a fan; 80: two triangles as bytes.
        [0u16, 1, 2, 3].iter().for_each(|v| data.extend(v.to_le_bytes()));
        [0u16, 1, 3, 2].iter().for_each(|v| data.extend(v.to_le_bytes()));
        data.extend([0u8, 1, 2, 2, 1, 3, 0, 0]);
        // 88: the sparse vertex 3 moves up; 96: its position.
        data.extend([3u8, 0, 0, 0, 0, 0, 0, 0]);
        [1.0f32, 1.0, 5.0].iter().for_each(|x| data.extend(x.to_le_bytes()));
        // 108: the square as normalised 16-bit integers, 8 bytes a row.
        for p in SQUARE {
            p.iter().for_each(|x| data.extend(((x * 32767.0) as i16).to_le_bytes()));
            data.extend([0; 2]);
        }
        Self { data }
    }

    fn json(&self, uri: &str) -> String {
        let length = self.data.len();
        format!(
            r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_mesh_quantization"],
"extensionsRequired":["KHR_mesh_quantization"],
"buffers":[{{"uri":"{uri}","byteLength":{length}}}],
"bufferViews":[{{"buffer":0,"byteLength":64,"byteStride":16}},{{"buffer":0,"byteOffset":64,"byteLength":24}},
{{"buffer":0,"byteOffset":88,"byteLength":20}},{{"buffer":0,"byteOffset":108,"byteLength":32,"byteStride":8}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
{{"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"}},
{{"bufferView":1,"byteOffset":8,"componentType":5123,"count":4,"type":"SCALAR"}},
{{"bufferView":1,"byteOffset":16,"componentType":5121,"count":6,"type":"SCALAR"}},
{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":1,
"indices":{{"bufferView":2,"componentType":5121}},"values":{{"bufferView":2,"byteOffset":8}}}},"min":[0,0,0],"max":[1,1,5]}},
{{"bufferView":3,"componentType":5122,"normalized":true,"count":4,"type":"VEC3","min":[0,0,0],"max":[32767,32767,0]}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":5}},
{{"attributes":{{"POSITION":0}},"indices":2,"mode":6}}]}},
{{"primitives":[{{"attributes":{{"POSITION":4}},"indices":3}},{{"attributes":{{"POSITION":0}},"mode":0}}]}},
{{"primitives":[{{"attributes":{{"POSITION":5}},"indices":3}}]}}],
"nodes":[{{"mesh":0,"children":[1,2]}},{{"mesh":1,"translation":[10,0,0]}},
{{"children":[3],"matrix":[2,0,0,0,0,2,0,0,0,0,2,0,0,20,0,1]}},{{"mesh":2,"scale":[-1,1,1]}},{{"mesh":0}}],
"scenes":[{{"nodes":[4]}},{{"nodes":[0]}}],"scene":1}}"#
        )
    }
}

fn parse_text(json: &str, others: &[&[u8]]) -> Result<MeshFile, Located> {
    let files: Vec<&[u8]> = std::iter::once(json.as_bytes()).chain(others.iter().copied()).collect();
    parse(&files, &ReadLimits::default())
}

fn fault_of(json: &str) -> Fault {
    let rich = Rich::new();
    parse_text(json, &[&rich.data]).unwrap_err().fault
}

#[test]
fn primitives_nodes_and_accessors_of_every_kind_become_one_mesh() {
    let rich = Rich::new();
    let file = parse_text(&rich.json("data.bin"), &[&rich.data]).unwrap();
    let square = SQUARE.map(|p| Point3::from(p.map(f64::from)));
    // The root, in its own place: a strip and a fan on the same vertices.
    assert_eq!(file.mesh.positions[..4], square);
    // Its first child, moved, whose last vertex is sparse.
    assert_eq!(
        file.mesh.positions[4..8],
        [[10., 0., 0.], [11., 0., 0.], [10., 1., 0.], [11., 1., 5.]].map(Point3::from)
    );
    // Its grandchild: mirrored, then twice as large and moved.
    assert_eq!(
        file.mesh.positions[8..],
        [[0., 20., 0.], [-2., 20., 0.], [0., 22., 0.], [-2., 22., 0.]].map(Point3::from)
    );
    let faces: Vec<[u32; 3]> = file.mesh.faces.iter().map(|face| face.map(|v| v.0)).collect();
    let expected =
        [[0, 1, 2], [1, 3, 2], [1, 3, 0], [3, 2, 0], [4, 5, 6], [6, 5, 7], [8, 10, 9], [10, 11, 9]];
    assert_eq!(faces, expected);
    // All squares face the same side, the mirrored one too.
    assert!((0..file.mesh.n_faces()).all(|f| file.mesh.area_vector(f).z > 0.0));
    assert_eq!((file.facts.unit, file.facts.instances), (Some(LengthUnit::Meter), Some(3)));
    assert_eq!(file.facts.ignored, ["all scenes but the default one", "points and lines"]);
}

#[test]
fn what_is_written_reads_back_with_the_numbers_of_vertices() {
    let mesh = shapes::disjoint(&[shapes::icosphere(2), shapes::cube(1)]);
    let mut bytes = Vec::new();
    write(&mut bytes, &mesh, None).unwrap();
    let back = parse_binary(&[&bytes], &ReadLimits::default()).unwrap().mesh;
    assert_eq!(back.faces, mesh.faces);
    for (p, q) in back.positions.iter().zip(&mesh.positions) {
        assert!((0..3).all(|i| p[i] == f64::from(q[i] as f32)));
    }
    assert_eq!(parse_text(&as_text(&mesh), &[]).unwrap().mesh, back);
}

#[test]
fn compressed_and_foreign_files_are_refused_with_a_remedy() {
    let json = Rich::new().json("data.bin");
    for (extension, words) in [
        ("KHR_draco_mesh_compression", "Draco"),
        ("EXT_meshopt_compression", "meshopt"),
        ("KHR_meshopt_compression", "meshopt"),
        ("EXT_mesh_gpu_instancing", "copies"),
        ("ACME_surprise", "ACME_surprise"),
    ] {
        let fault = fault_of(&json.replace("KHR_mesh_quantization", extension));
        assert!(matches!(&fault, Fault::Unsupported { what, .. } if what.contains(words)), "{fault}");
    }
    let old = json.replace(r#""version":"2.0""#, r#""version":"1.0""#);
    assert!(matches!(fault_of(&old), Fault::Unsupported { .. }));
    let without_view = json.replace(
        r#"{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}"#,
        r#"{"componentType":5126,"count":4,"type":"VEC3"}"#,
    );
    assert!(matches!(fault_of(&without_view), Fault::Unsupported { .. }));
}

#[test]
fn harmless_extensions_are_ignored() {
    let rich = Rich::new();
    let json = rich.json("data.bin").replace("KHR_mesh_quantization", "KHR_materials_unlit");
    assert!(parse_text(&json, &[&rich.data]).is_ok());
}

#[test]
fn faults_name_the_part() {
    let json = Rich::new().json("data.bin");
    let located = |json: &str| {
        let rich = Rich::new();
        let fault = parse_text(json, &[&rich.data]).unwrap_err();
        (fault.place, fault.fault)
    };
    let more =
        json.replace(r#""count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]"#, r#""count":5,"type":"VEC3""#);
    let (place, fault) = located(&more);
    assert_eq!(place, Place::Part("accessor", 0));
    assert!(matches!(fault, Fault::Truncated { promised: 5, found: 4, .. }), "{fault}");
    let short = json.replace(r#""byteOffset":108,"byteLength":32"#, r#""byteOffset":108,"byteLength":33"#);
    assert_eq!(located(&short).0, Place::Part("buffer view", 3));
    let cycle = json.replace(r#"{"mesh":2,"scale":[-1,1,1]}"#, r#"{"mesh":2,"children":[0]}"#);
    assert_eq!(located(&cycle).0, Place::Part("node", 0));
    let outside = json.replace("data.bin", "../data.bin");
    assert_eq!(located(&outside).0, Place::Part("buffer", 0));
    let (place, fault) = located("{\n\"asset\": 3}");
    assert!(matches!(fault, Fault::Syntax { .. }) && place == Place::Line(2), "{fault}");
    let index = json.replace(r#""componentType":5121,"count":6"#, r#""componentType":5123,"count":4"#);
    assert!(matches!(located(&index).1, Fault::IndexOutOfRange { .. }));
}

#[test]
fn small_files_cannot_make_huge_meshes() {
    // Without data, four billion zeros.
    let zeros = r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"data:;base64,AAAAAAAAAAAAAAAAAAAAAA==","byteLength":16}],"bufferViews":[{"buffer":0,"byteLength":16}],"accessors":[{"componentType":5126,"count":4000000000,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":0}}}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]}"#;
    assert!(matches!(parse_text(zeros, &[]).unwrap_err().fault, Fault::Inflates { .. }));
    // Thousands of copies of a mesh of thousands of vertices.
    let mesh = shapes::icosphere(5);
    let nodes = vec![r#"{"mesh":0}"#; 20_000].join(",");
    let numbers: Vec<String> = (0..20_000).map(|i| i.to_string()).collect();
    let copies = as_text(&mesh)
        .replace(r#""nodes":[{"mesh":0}]"#, &format!(r#""nodes":[{nodes}]"#))
        .replace(r#"{"nodes":[0]}"#, &format!(r#"{{"nodes":[{}]}}"#, numbers.join(",")));
    let fault = parse_text(&copies, &[]).unwrap_err().fault;
    assert!(fault.to_string().starts_with("its copies of meshes add up"), "{fault}");
}

#[test]
fn binary_faults_are_named() {
    let mut bytes = Vec::new();
    write(&mut bytes, &shapes::tetrahedron(0), None).unwrap();
    let fault = |bytes: &[u8]| parse_binary(&[bytes], &ReadLimits::default()).unwrap_err().fault;
    assert!(matches!(fault(&bytes[..bytes.len() - 1]), Fault::Truncated { .. }));
    assert!(matches!(fault(b"glTF\x01\0\0\0\x0c\0\0\0"), Fault::Unsupported { .. }));
    assert!(matches!(fault(b"glTF\x02\0\0\0\x0c\0\0\0"), Fault::Syntax { .. }));
    assert!(matches!(fault(b"glTF\x02\0\0\0\x14\0\0\0\0\0\0\0BIN\0"), Fault::CutShort { .. }));
    assert!(matches!(fault(b"ply\n"), Fault::WrongFormat { .. }));
    assert_eq!(fault(b" "), Fault::Empty);
    assert!(matches!(check_start(&bytes, None).unwrap_err().fault, Fault::WrongFormat { .. }));
}
