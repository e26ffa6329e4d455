//! Writing PLY, binary little endian.

use std::io::{self, Write};

use nalgebra::Point3;

use crate::field::WrittenField;
use mesh::TriMesh;

const FACE_PROPERTIES: &str = "property list uchar uint vertex_indices\n";
const FIELD_COLORS: &str = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

/// Writes a mesh, perhaps with a value and a colour per vertex; coordinates read back bit for bit.
pub(crate) fn write(out: &mut dyn Write, mesh: &TriMesh, field: WrittenField<'_>) -> io::Result<()> {
    let properties = field.map(|field| format!("property double {}\n{FIELD_COLORS}", field.name));
    let properties = properties.unwrap_or_default();
    write_header(out, mesh.n_vertices(), &properties, "face", mesh.n_faces(), FACE_PROPERTIES)?;
    for (v, p) in mesh.positions.iter().enumerate() {
        write_position(out, p)?;
        if let Some(field) = field {
            out.write_all(&field.values[v].to_le_bytes())?;
            out.write_all(&field.colors[v])?;
        }
    }
    for face in &mesh.faces {
        out.write_all(&[3])?;
        face.iter().try_for_each(|v| out.write_all(&v.0.to_le_bytes()))?;
    }
    Ok(())
}

/// Writes the points of polylines, and an element `edge` for each segment.
pub(crate) fn write_lines(out: &mut dyn Write, lines: &[Vec<Point3<f64>>]) -> io::Result<()> {
    let n_points = lines.iter().map(Vec::len).sum();
    let n_edges = lines.iter().map(|line| line.len().saturating_sub(1)).sum();
    write_header(out, n_points, "", "edge", n_edges, "property uint vertex1\nproperty uint vertex2\n")?;
    lines.iter().flatten().try_for_each(|p| write_position(out, p))?;
    let mut first = 0u32;
    for line in lines {
        for vertex in (first..).take(line.len().saturating_sub(1)) {
            out.write_all(&vertex.to_le_bytes())?;
            out.write_all(&(vertex + 1).to_le_bytes())?;
        }
        first += line.len() as u32;
    }
    Ok(())
}

/// Writes the header of vertices, with `more` properties after their coordinates, and of another element.
fn write_header(
    out: &mut dyn Write,
    n_vertices: usize,
    more: &str,
    element: &str,
    count: usize,
    properties: &str,
) -> io::Result<()> {
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {n_vertices}\nproperty double x\nproperty double y\n\
         property double z\n{more}element {element} {count}\n{properties}end_header\n"
    )
}

fn write_position(out: &mut dyn Write, p: &Point3<f64>) -> io::Result<()> {
    p.iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_have_an_edge_per_segment() {
        let point = |x: f64| Point3::new(x, 0.5, -1.0);
        let lines =
            [vec![point(0.0), point(1.0), point(2.5)], vec![point(7.0)], vec![point(3.0), point(4.0)]];
        let mut out = Vec::new();
        write_lines(&mut out, &lines).unwrap();
        let header = "ply\nformat binary_little_endian 1.0\nelement vertex 6\nproperty double x\nproperty double y\n\
            property double z\nelement edge 3\nproperty uint vertex1\nproperty uint vertex2\nend_header\n";
        let body = out.strip_prefix(header.as_bytes()).unwrap();
        let (points, edges) = body.split_at(6 * 24);
        let x = |v: usize| f64::from_le_bytes(*points[24 * v..].first_chunk().unwrap());
        assert_eq!([0, 1, 2, 3, 4, 5].map(x), [0.0, 1.0, 2.5, 7.0, 3.0, 4.0]);
        let ends: Vec<u32> = edges.as_chunks().0.iter().map(|&v| u32::from_le_bytes(v)).collect();
        assert_eq!(ends, [0, 1, 1, 2, 4, 5]);
    }
}
