//! Writes the seed corpus of the fuzz targets with our own writers: `make fuzz-seeds`.

use std::error::Error;
use std::fs;
use std::path::Path;

use mesh::{TriMesh, shapes};
use mesh_io::FORMATS;

/// Small meshes, intact and broken.
fn meshes() -> Vec<(&'static str, TriMesh)> {
    let mut hole = shapes::icosphere(1);
    hole.faces.truncate(70);
    let mut fin = shapes::icosphere(0);
    fin.faces.push([fin.faces[0][0], fin.faces[0][1], fin.faces[9][2]]);
    fin.faces.push(fin.faces[0]);
    fin.faces.push([fin.faces[0][0]; 3]);
    let mut needle = shapes::tetrahedron(0);
    needle.positions[0].coords *= 1e-9;
    vec![
        ("ball", shapes::icosphere(1)),
        ("sheet", shapes::grid(5, 4, 0.1)),
        ("ring", shapes::torus(8, 5, 2.0, 0.7)),
        ("pieces", shapes::disjoint(&[shapes::cube(0), shapes::tetrahedron(0)])),
        ("hole", hole),
        ("fin", fin),
        ("needle", needle),
    ]
}

/// The text formats that our writers do not write.
fn texts(mesh: &TriMesh) -> [(&'static str, String); 2] {
    let positions: String = mesh.positions.iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect();
    let faces: String = mesh.faces.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n")).collect();
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n{positions}{faces}",
        mesh.n_vertices(),
        mesh.n_faces()
    );
    let facet = |f: usize| {
        let corners = mesh.triangle(f).map(|p| format!("vertex {} {} {}\n", p.x, p.y, p.z)).concat();
        format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let stl = format!("solid s\n{}endsolid s\n", (0..mesh.n_faces()).map(facet).collect::<String>());
    [("ply", ply), ("stl", stl)]
}

/// The byte that stands for a format at the start of an input.
fn format_byte(extension: &str) -> Option<u8> {
    FORMATS.iter().position(|format| format.extensions[0] == extension)?.try_into().ok()
}

fn main() -> Result<(), Box<dyn Error>> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz/corpus");
    let folder = tempfile::tempdir()?;
    let put = |target: &str, name: String, parts: &[&[u8]]| -> Result<(), Box<dyn Error>> {
        fs::create_dir_all(corpus.join(target))?;
        Ok(fs::write(corpus.join(target).join(name), parts.concat())?)
    };
    for (i, (name, mesh)) in meshes().into_iter().enumerate() {
        let mut files: Vec<(String, u8, Vec<u8>)> = Vec::new();
        for format in FORMATS.iter().filter(|format| format.can_write(mesh_io::Content::Mesh)) {
            let path = folder.path().join(format!("{name}.{}", format.extensions[0]));
            mesh_io::write(&path, &mesh)?;
            let contents = mesh_io::files_of(&path).iter().map(fs::read).collect::<Result<Vec<_>, _>>()?;
            let byte = format_byte(format.extensions[0]).ok_or("an unknown format")?;
            files.push((format.extensions[0].to_owned(), byte, contents.join(&0)));
        }
        for (extension, text) in texts(&mesh) {
            let byte = format_byte(extension).ok_or("an unknown format")?;
            files.push((format!("ascii.{extension}"), byte, text.into_bytes()));
        }
        for (j, (extension, byte, content)) in files.iter().enumerate() {
            let seed = format!("{name}.{extension}");
            if i < 2 {
                put("read", seed.clone(), &[&[*byte], content])?;
            }
            if extension == "off" {
                put("describe", seed.clone(), &[&[*byte], content])?;
            }
            if j == i % files.len() {
                put("repair_embed", seed, &[&[(i * 5) as u8, (i * 7) as u8, *byte], content])?;
            }
        }
    }
    for (name, change) in
        [("none", vec![]), ("first", vec![0, 0, 0, 0, 1, 0]), ("page", vec![0, 16, 0, 0, 2, 1, 2])]
    {
        put("index_open", name.to_owned(), &[&change])?;
    }
    Ok(())
}
