//! Writing 3MF.

use std::io::{self, Cursor, Write};

use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::field::WrittenField;
use mesh::TriMesh;

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rel0" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// Writes a 3MF file with one object in millimetres, the default unit; coordinates read back bit for bit.
pub(crate) fn write(out: &mut dyn Write, mesh: &TriMesh, _: WrittenField<'_>) -> io::Result<()> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().large_file(mesh.n_vertices() + mesh.n_faces() > 1 << 24);
    for (name, content) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONSHIPS)] {
        archive.start_file(name, options)?;
        archive.write_all(content.as_bytes())?;
    }
    archive.start_file("3D/3dmodel.model", options)?;
    let mut text = io::BufWriter::with_capacity(1 << 16, &mut archive);
    write!(
        text,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n\
         <resources><object id=\"1\" type=\"model\"><mesh>\n<vertices>\n"
    )?;
    for p in &mesh.positions {
        writeln!(text, r#"<vertex x="{:?}" y="{:?}" z="{:?}"/>"#, p.x, p.y, p.z)?;
    }
    write!(text, "</vertices>\n<triangles>\n")?;
    for [a, b, c] in &mesh.faces {
        writeln!(text, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?;
    }
    write!(
        text,
        "</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n"
    )?;
    text.flush()?;
    drop(text);
    out.write_all(archive.finish()?.get_ref())
}
