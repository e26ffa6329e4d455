use std::io::Cursor;

use super::*;
use mesh::shapes;

/// A package with these parts.
fn package(parts: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in parts {
        archive.start_file(*name, SimpleFileOptions::default()).unwrap();
        archive.write_all(content).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A package with this model in the usual place.
pub(crate) fn package_of(model: &[u8]) -> Vec<u8> {
    package(&[("3D/3dmodel.model", model)])
}

fn mesh_text(mesh: &TriMesh) -> String {
    let vertices =
        mesh.positions.iter().map(|p| format!("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", p.x, p.y, p.z));
    let triangles = mesh
        .faces
        .iter()
        .map(|[a, b, c]| format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" pid=\"9\"/>\n"));
    format!(
        "<mesh><vertices>\n{}</vertices><triangles>\n{}</triangles></mesh>",
        vertices.collect::<String>(),
        triangles.collect::<String>()
    )
}

const HEAD: &str = "<?xml version=\"1.0\"?>\n<model unit=\"inch\" requiredextensions=\"p\" \
    xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
    xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\">";

/// A model with an object, a component and a moved item, which add up to the mesh.
pub(crate) fn model_of(mesh: &TriMesh) -> String {
    format!(
        "{HEAD}<resources><object id=\"1\">{}</object><object id=\"2\"><components><component objectid=\"1\" \
         transform=\"1 0 0 0 1 0 0 0 1 0 0 1\"/></components></object></resources>\
         <build><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 2 0 0\"/></build></model>",
        mesh_text(mesh)
    )
}

fn parse_model(model: &str) -> Result<MeshFile, Located> {
    parse(&[&package_of(model.as_bytes())], &ReadLimits::default())
}

#[test]
fn components_and_items_are_placed_and_counted() {
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
    let file = parse_model(&model).unwrap();
    assert_eq!((file.facts.unit, file.facts.instances), (Some(LengthUnit::Inch), Some(3)));
    assert_eq!((file.mesh.n_vertices(), file.mesh.n_faces()), (12, 12));
    for (v, p) in corner.positions.iter().enumerate() {
        // Doubled and moved, then turned by a right angle and lifted.
        let q = file.mesh.positions[v];
        assert_eq!([q.x, q.y, q.z], [-2.0 * p.y, 2.0 * p.x + 10.0, 2.0 * p.z + 5.0]);
        assert_eq!(file.mesh.positions[v + 8], *p);
    }
    let volume = |faces: std::ops::Range<usize>| -> f64 {
        faces.map(|f| file.mesh.triangle(f)).map(|[a, b, c]| a.coords.dot(&b.coords.cross(&c.coords))).sum()
    };
    // The mirrored copy keeps its outside.
    assert!(volume(4..8) * volume(8..12) > 0.0);
}

#[test]
fn objects_of_other_parts_are_found() {
    let ball = shapes::icosphere(1);
    let other = format!(
        "{HEAD}<resources><object id=\"1\">{}</object></resources><build/></model>",
        mesh_text(&ball)
    );
    let root = format!(
        "{HEAD}<resources><object id=\"1\"><components><component p:path=\"/3D/Objects/ball.model\" objectid=\"1\"/>\
         </components></object></resources><build><item objectid=\"1\"/></build></model>"
    );
    let relationships = "<Relationships><Relationship Target=\"/3D/main.model\" Id=\"a\" \
        Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";
    let bytes = package(&[
        ("_rels/.rels", relationships.as_bytes()),
        ("3D/main.model", root.as_bytes()),
        ("3d/objects/BALL.model", other.as_bytes()),
    ]);
    assert_eq!(parse(&[&bytes], &ReadLimits::default()).unwrap().mesh, ball);
    let missing = package(&[("3D/3dmodel.model", root.as_bytes())]);
    let fault = parse(&[&missing], &ReadLimits::default()).unwrap_err().fault.to_string();
    assert!(fault.contains("no part 3D/Objects/ball.model"), "{fault}");
}

#[test]
fn what_is_written_reads_back_bit_for_bit() {
    let mut mesh = shapes::icosphere(2);
    mesh.positions[3].x = 1e-300;
    mesh.positions[4].y = -0.0;
    mesh.positions.push([1.0 / 3.0, 1e300, 0.1].into());
    let mut bytes = Vec::new();
    write(&mut bytes, &mesh, None).unwrap();
    let back = parse(&[&bytes], &ReadLimits::default()).unwrap();
    assert_eq!(back.mesh, mesh);
    assert!(back.mesh.positions[4].y.is_sign_negative());
    assert_eq!(back.facts.unit, Some(LengthUnit::Millimeter));
    let mut again = Vec::new();
    write(&mut again, &mesh, None).unwrap();
    assert_eq!(bytes, again, "the same mesh gives the same bytes");
}

#[test]
fn an_empty_build_has_every_object_that_is_no_component() {
    let model = model_of(&shapes::cube(0))
        .replace("<item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 2 0 0\"/>", "");
    let file = parse_model(&model).unwrap();
    assert_eq!((file.mesh.n_vertices(), file.facts.instances), (8, Some(1)));
}

#[test]
fn faults_name_part_line_and_remedy() {
    let model = model_of(&shapes::tetrahedron(0));
    let located = |from: &str, to: &str| {
        assert!(model.contains(from), "{from}");
        let fault = parse_model(&model.replacen(from, to, 1)).unwrap_err();
        let error = fault.clone().in_file(std::path::Path::new("a.3mf")).to_string();
        (fault.fault, error)
    };
    let (fault, error) = located("v1=\"0\"", "v1=\"4\"");
    assert!(matches!(fault, Fault::IndexOutOfRange { last: 3, .. }), "{fault}");
    assert!(error.starts_with("a.3mf/3D/3dmodel.model, line 8: "), "{error}");
    for (from, to, words) in [
        ("<vertex x=", "<vertex y=", "the coordinates x, y and z"),
        ("objectid=\"1\"", "objectid=\"5\"", "object 5"),
        ("objectid=\"1\"", "objectid=\"2\"", "its own component"),
        ("unit=\"inch\"", "unit=\"ell\"", "a unit"),
        ("</model>", "", "ends where"),
        ("<resources>", "<!DOCTYPE a>", "DOCTYPE"),
        ("0 0 0 1 2 0 0\"", "0 0 0 1 2 0\"", "12 numbers"),
        ("id=\"2\"", "id=\"1\"", "id 1 twice"),
        ("/production/", "/securecontent/", "encrypted"),
        ("/production/", "/volumetric/", "volumetric"),
    ] {
        let (_, error) = located(from, to);
        assert!(error.contains(words), "{from} {to}: {error}");
    }
    let foreign = parse(&[b"PNG"], &ReadLimits::default()).unwrap_err().fault;
    assert!(matches!(foreign, Fault::WrongFormat { .. }));
    let empty = package(&[("word/document.xml", b"<a/>")]);
    let fault = parse(&[&empty], &ReadLimits::default()).unwrap_err().fault;
    assert!(matches!(fault, Fault::WrongFormat { .. }), "{fault}");
}

#[test]
fn elements_of_extensions_are_not_mistaken_for_meshes() {
    let model = model_of(&shapes::cube(0)).replace(
        "<resources>",
        "<resources><p:object id=\"3\"><mesh><vertices><vertex x=\"1\"/></vertices></mesh></p:object>\
         <slicestack id=\"9\"><vertices><vertex x=\"1\" y=\"2\"/></vertices></slicestack>",
    );
    assert_eq!(parse_model(&model).unwrap().mesh.n_vertices(), 8);
}

#[test]
fn small_files_cannot_make_huge_meshes() {
    // Every object consists of two copies of the one before it.
    let doubled = |id: usize| {
        let component = format!("<component objectid=\"{}\"/>", id - 1);
        format!("<object id=\"{id}\"><components>{component}{component}</components></object>")
    };
    let objects: String = (2..60).map(doubled).collect();
    let of = |first: &str| {
        format!("{HEAD}<resources>{first}{objects}</resources><build><item objectid=\"59\"/></build></model>")
    };
    let first = format!("<object id=\"1\">{}</object>", mesh_text(&shapes::tetrahedron(0)));
    let fault = parse_model(&of(&first)).unwrap_err().fault;
    assert!(matches!(fault, Fault::TooLarge { .. } | Fault::Unsupported { .. }), "{fault}");
    let fault = parse_model(&of("<object id=\"1\"/>")).unwrap_err().fault;
    assert!(matches!(fault, Fault::NoFaces { .. }), "{fault}");
    // A zip bomb: 200 MB of blanks.
    let bomb = package_of(&vec![b' '; 200 << 20]);
    let fault = parse(&[&bomb], &ReadLimits::default()).unwrap_err().fault;
    assert!(matches!(fault, Fault::Inflates { .. }), "{fault}");
}
