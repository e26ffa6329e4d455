//! Writing PLY, binary little endian.

use std::io::{self, Write};

use ply_rs_bw::ply::{Addable, ElementDef, Encoding, Header, PropertyDef, PropertyType, ScalarType};
use ply_rs_bw::writer::Writer;

use crate::TriMesh;

use super::elements::{CORNER_LISTS, RowOut};

/// Writes a mesh; coordinates are read back bit for bit.
pub(crate) fn write(out: &mut dyn Write, mesh: &TriMesh) -> io::Result<()> {
    write_rows(out, mesh, &["x", "y", "z"], &[], |_| (0.0, [0; 3]))
}

/// Writes a mesh with a value, named `name`, and a colour for every vertex.
pub(crate) fn write_with_field(
    out: &mut dyn Write,
    mesh: &TriMesh,
    name: &str,
    field: impl Fn(usize) -> (f64, [u8; 3]),
) -> io::Result<()> {
    write_rows(out, mesh, &["x", "y", "z", name], &["red", "green", "blue"], field)
}

fn write_rows(
    mut out: &mut dyn Write,
    mesh: &TriMesh,
    doubles: &[&str],
    bytes: &[&str],
    field: impl Fn(usize) -> (f64, [u8; 3]),
) -> io::Result<()> {
    let mut vertex = ElementDef::new("vertex".into());
    vertex.count = mesh.n_vertices();
    let scalars = doubles.iter().map(|name| (name, ScalarType::Double));
    for (name, scalar) in scalars.chain(bytes.iter().map(|name| (name, ScalarType::UChar))) {
        vertex.properties.add(PropertyDef::new(name.to_string(), PropertyType::Scalar(scalar)));
    }
    let mut face = ElementDef::new("face".into());
    face.count = mesh.n_faces();
    let corners = PropertyType::List(ScalarType::UChar, ScalarType::UInt);
    face.properties.add(PropertyDef::new(CORNER_LISTS[0].into(), corners));

    let mut header = Header::new();
    header.encoding = Encoding::BinaryLittleEndian;
    header.elements.add(vertex.clone());
    header.elements.add(face.clone());
    let writer = Writer::<RowOut>::new();
    writer.write_header(&mut out, &header)?;
    for (v, &position) in mesh.positions.iter().enumerate() {
        let (value, color) = field(v);
        let row = RowOut::Vertex { position, value, color };
        writer.write_little_endian_element(&mut out, &row, &vertex)?;
    }
    for corners in &mesh.faces {
        let row = RowOut::Face(corners.map(|v| v.0));
        writer.write_little_endian_element(&mut out, &row, &face)?;
    }
    Ok(())
}
