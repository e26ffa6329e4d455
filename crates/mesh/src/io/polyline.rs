//! Lines through points, without faces.

use std::io::{self, Write};

use nalgebra::Point3;

/// A `v` for each point and an `l` for each line; a line of one point is a `p`.
pub(super) fn write_obj(out: &mut dyn Write, lines: &[Vec<Point3<f64>>]) -> io::Result<()> {
    for p in lines.iter().flatten() {
        writeln!(out, "v {:?} {:?} {:?}", p.x, p.y, p.z)?;
    }
    let mut first = 1;
    for line in lines.iter().filter(|line| !line.is_empty()) {
        write!(out, "{}", if line.len() == 1 { "p" } else { "l" })?;
        for vertex in first..first + line.len() {
            write!(out, " {vertex}")?;
        }
        writeln!(out)?;
        first += line.len();
    }
    Ok(())
}

/// Elements `vertex` and `edge`, binary little endian.
pub(super) fn write_ply(out: &mut dyn Write, lines: &[Vec<Point3<f64>>]) -> io::Result<()> {
    let n_points: usize = lines.iter().map(Vec::len).sum();
    let n_edges: usize = lines.iter().map(|line| line.len().saturating_sub(1)).sum();
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {n_points}\n\
         property double x\nproperty double y\nproperty double z\n\
         element edge {n_edges}\nproperty uint vertex1\nproperty uint vertex2\nend_header\n"
    )?;
    for coordinate in lines.iter().flatten().flat_map(|p| p.coords.iter()) {
        out.write_all(&coordinate.to_le_bytes())?;
    }
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

#[cfg(test)]
mod tests {
    use ply_rs_bw::parser::Parser;
    use ply_rs_bw::ply::{DefaultElement, Property};

    use super::*;

    fn lines() -> Vec<Vec<Point3<f64>>> {
        let point = |x: f64| Point3::new(x, 0.1, -1e-9);
        vec![vec![point(0.0), point(1.0), point(2.5)], vec![point(7.0)], vec![point(3.0), point(4.0)]]
    }

    #[test]
    fn obj_has_a_line_each() {
        let mut out = Vec::new();
        write_obj(&mut out, &lines()).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert_eq!(text.lines().filter(|line| line.starts_with("v ")).count(), 6);
        assert!(text.ends_with("v 4.0 0.1 -1e-9\nl 1 2 3\np 4\nl 5 6\n"), "{text}");
    }

    #[test]
    fn what_no_file_can_hold_is_refused() {
        use std::path::Path;

        use super::super::write_polylines;
        use crate::MeshError;
        let error = write_polylines(Path::new("lines.stl"), &lines()).unwrap_err();
        assert!(matches!(error, MeshError::LinesFormat { .. }) && error.to_string().contains(".obj or .ply"));
        let nowhere = vec![vec![Point3::new(f64::NAN, 0.0, 0.0)]];
        let error = write_polylines(Path::new("lines.obj"), &nowhere).unwrap_err();
        assert!(matches!(error, MeshError::NonFinitePosition { .. }));
        let unknown = write_polylines(Path::new("lines.txt"), &lines());
        assert!(matches!(unknown, Err(MeshError::UnknownFormat { .. })));
    }

    #[test]
    fn ply_is_read_back_by_others() {
        let mut out = Vec::new();
        write_ply(&mut out, &lines()).unwrap();
        let read = Parser::<DefaultElement>::new().read_ply(&mut &out[..]).unwrap();
        assert_eq!(read.payload["vertex"][5]["x"], Property::Double(4.0));
        let edges: Vec<_> = read.payload["edge"].iter().map(|e| (&e["vertex1"], &e["vertex2"])).collect();
        let expected = [(0, 1), (1, 2), (4, 5)].map(|(a, b)| (Property::UInt(a), Property::UInt(b)));
        assert_eq!(edges.len(), 3);
        assert!(edges.iter().zip(&expected).all(|((a, b), (c, d))| *a == c && *b == d));
    }
}
