//! STL, ascii and binary, through `stl_io`.

use std::collections::HashMap;
use std::io::{self, Cursor, Write};

use nalgebra::Point3;
use stl_io::{Normal, Triangle, Vertex};

use crate::TriMesh;
use crate::error::{Fault, Located, MeshError, Place};
use crate::position_key::position_key;
use surface::VertexId;

use super::ReadLimits;
use super::assembly::finish;
use super::text::{Lines, excerpt, parse_f64};

/// Bytes of a binary file: free text, a 32-bit count, then the triangles.
const HEADER: usize = 80;
const PREFIX: usize = HEADER + 4;
const TRIANGLE: usize = 50;

/// Reads STL. The format lists each triangle with its own three corners; corners in the same place
/// become one vertex, numbered in the order of first appearance.
pub(super) fn parse(bytes: Vec<u8>, limits: &ReadLimits) -> Result<TriMesh, Located> {
    let text = bytes.trim_ascii_start();
    if text.is_empty() {
        return Err(Fault::Empty.whole());
    }
    let promised = bytes.get(HEADER..PREFIX).map(|b| u64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])));
    let held = bytes.len().saturating_sub(PREFIX) as u64 / TRIANGLE as u64;
    let fills_file = bytes.len() % TRIANGLE == PREFIX % TRIANGLE && promised == Some(held);
    // Binary files may say "solid" in their free text too.
    if text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) && !fills_file {
        return parse_ascii(&bytes, limits);
    }
    match promised {
        None => {
            let found = format!("{} bytes beginning with `{}`", bytes.len(), excerpt(text));
            Err(Fault::WrongFormat { expected: "an STL file", found }.whole())
        }
        Some(promised) if promised > held => {
            Err(Fault::Truncated { items: "triangles".into(), promised, found: held }.whole())
        }
        Some(promised) => parse_binary(bytes, promised, limits),
    }
}

fn parse_binary(mut bytes: Vec<u8>, n_triangles: u64, limits: &ReadLimits) -> Result<TriMesh, Located> {
    limits.check(0, n_triangles).map_err(Fault::whole)?;
    // By the word "solid" stl_io would take the file for ascii.
    bytes[..HEADER].fill(0);
    let place = |triangle: u64| Place::Byte(PREFIX as u64 + triangle * TRIANGLE as u64);
    merge_corners(bytes, limits, |triangle, error| match error {
        Broken::Parser(error) => {
            let expected = format!("a triangle ({error})");
            Located { place: place(triangle), fault: Fault::CutShort { expected } }
        }
        Broken::NonFinite(fault) => Located { place: place(triangle), fault },
    })
}

/// Reads the ascii form after writing it the one way `stl_io` takes: lower case, a single solid with
/// a name, and zero normals, which many programs write as NaN and nothing here reads.
fn parse_ascii(bytes: &[u8], limits: &ReadLimits) -> Result<TriMesh, Located> {
    let mut plain = b"solid s\n".to_vec();
    let mut is_open = true;
    let mut n_triangles = 0;
    let mut lines = Lines::new(bytes);
    for line in lines.by_ref() {
        let text = line.text.to_ascii_lowercase();
        if text.starts_with(b"solid") {
            is_open = true;
        } else if text.starts_with(b"endsolid") || text.starts_with(b"end solid") {
            is_open = false;
        } else if text.starts_with(b"facet") {
            n_triangles += 1;
            limits.check(0, n_triangles).map_err(|fault| fault.in_line(line.number))?;
            plain.extend_from_slice(b"facet normal 0 0 0\n");
        } else {
            plain.extend_from_slice(&text);
            plain.push(b'\n');
        }
    }
    if is_open {
        return Err(Fault::CutShort { expected: "`endsolid`".into() }.in_line(lines.number()));
    }
    plain.extend_from_slice(b"endsolid\n");
    merge_corners(plain, limits, |triangle, error| diagnose_ascii(bytes, triangle, error))
}

/// Places a fault of the ascii form: in the line of a vertex that is no point, or else in the first
/// line of the triangle.
fn diagnose_ascii(bytes: &[u8], triangle: u64, error: Broken) -> Located {
    let starts = |text: &[u8], word: &str| {
        text.get(..word.len()).is_some_and(|begin| begin.eq_ignore_ascii_case(word.as_bytes()))
    };
    let (mut facet, mut first_line, mut corner) = (None, 0, 0);
    for line in Lines::new(bytes) {
        if starts(line.text, "facet") {
            facet = Some(facet.map_or(0, |f: u64| f + 1));
            first_line = if facet == Some(triangle) { line.number } else { first_line };
        }
        if facet == Some(triangle) && starts(line.text, "vertex") {
            let value = line.tokens().skip(1).filter_map(parse_f64).find(|x| !(*x as f32).is_finite());
            if let Some(value) = value {
                return Fault::NonFinite { vertex: 3 * triangle + corner, value }.in_line(line.number);
            }
            corner += 1;
        }
    }
    let found = match error {
        Broken::Parser(error) => error.to_string(),
        Broken::NonFinite(fault) => fault.to_string(),
    };
    let expected = "a facet with an outer loop of three vertices, endloop and endfacet";
    Fault::Syntax { expected, found }.in_line(first_line)
}

/// What stopped the reading of a triangle.
enum Broken {
    Parser(io::Error),
    NonFinite(Fault),
}

fn merge_corners(
    bytes: Vec<u8>,
    limits: &ReadLimits,
    place: impl Fn(u64, Broken) -> Located,
) -> Result<TriMesh, Located> {
    let most = bytes.len() / TRIANGLE;
    let mut cursor = Cursor::new(bytes);
    let triangles = stl_io::create_stl_reader(&mut cursor).map_err(|e| place(0, Broken::Parser(e)))?;
    let mut numbers: HashMap<[u64; 3], VertexId> = HashMap::new();
    let mut positions = Vec::new();
    let mut faces = Vec::with_capacity(most);
    for (t, triangle) in (0u64..).zip(triangles) {
        let triangle = triangle.map_err(|e| place(t, Broken::Parser(e)))?;
        let mut face = [VertexId(0); 3];
        for (slot, corner) in triangle.vertices.iter().enumerate() {
            let p = Point3::from(corner.0.map(f64::from));
            if let Some(&value) = p.iter().find(|x| !x.is_finite()) {
                let fault = Fault::NonFinite { vertex: 3 * t + slot as u64, value };
                return Err(place(t, Broken::NonFinite(fault)));
            }
            face[slot] = *numbers.entry(position_key(&p)).or_insert_with(|| {
                positions.push(p);
                VertexId::from(positions.len() - 1)
            });
        }
        limits.check(positions.len() as u64, 0).map_err(Fault::whole)?;
        faces.push(face);
    }
    finish(positions, faces, limits)
}

/// The triangles as STL stores them; an error names a coordinate that 32-bit floats cannot hold.
pub(super) fn triangles(mesh: &TriMesh) -> Result<Vec<Triangle>, MeshError> {
    for (vertex, p) in mesh.positions.iter().enumerate() {
        if let Some(&value) = p.iter().find(|x| !(**x as f32).is_finite()) {
            return Err(MeshError::CoordinateOverflow { vertex: VertexId::from(vertex), value });
        }
    }
    let single = |x: f64| x as f32;
    let triangle = |f: usize| {
        let normal = mesh.area_vector(f).try_normalize(0.0).unwrap_or_default();
        Triangle {
            normal: Normal::new([normal.x, normal.y, normal.z].map(single)),
            vertices: mesh.triangle(f).map(|p| Vertex::new([p.x, p.y, p.z].map(single))),
        }
    };
    Ok((0..mesh.n_faces()).map(triangle).collect())
}

/// Writes binary STL: coordinates are rounded to 32 bits, and vertex numbers and vertices that no
/// face uses are lost.
pub(super) fn write(mut out: &mut dyn Write, triangles: &[Triangle]) -> io::Result<()> {
    stl_io::write_stl(&mut out, triangles.iter())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    const FACET: &str = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";

    fn parse(bytes: Vec<u8>) -> Result<TriMesh, Located> {
        super::parse(bytes, &ReadLimits::default())
    }

    fn binary(mesh: &TriMesh) -> Vec<u8> {
        let mut bytes = Vec::new();
        write(&mut bytes, &triangles(mesh).unwrap()).unwrap();
        bytes
    }

    fn fault(text: &str) -> (Place, Fault) {
        let Located { place, fault } = parse(text.as_bytes().to_vec()).unwrap_err();
        (place, fault)
    }

    #[test]
    fn the_soup_is_stitched_again() {
        let cube = shapes::cube(1);
        for header in ["", "solid but binary"] {
            let mut bytes = binary(&cube);
            bytes[..header.len()].copy_from_slice(header.as_bytes());
            let back = parse(bytes).unwrap();
            assert_eq!((back.n_vertices(), back.n_faces()), (cube.n_vertices(), cube.n_faces()));
            for f in 0..cube.n_faces() {
                assert_eq!(back.triangle(f), cube.triangle(f));
            }
        }
    }

    #[test]
    fn ascii_in_every_dialect() {
        let expected = parse(format!("solid a\n{FACET}endsolid a\n").into_bytes()).unwrap();
        assert_eq!((expected.n_vertices(), expected.n_faces()), (3, 1));
        for text in [
            format!("solid\n{FACET}endsolid"),
            format!("SOLID X\r\n{}ENDSOLID\r\n", FACET.to_uppercase().replace('\n', "\r\n")),
            format!("solid a\n{}endsolid\n", FACET.replace("0 0 1", "nan nan nan")),
            format!("solid a\n{}endsolid\n", FACET.replace("  vertex 0 0 0", "vertex -0 0e5 -0.0")),
        ] {
            assert_eq!(parse(text.into_bytes()).unwrap(), expected);
        }
        let two = format!("solid a\n{FACET}endsolid a\nsolid b\n{FACET}endsolid b\n");
        assert_eq!(parse(two.into_bytes()).unwrap().n_faces(), 2);
    }

    #[test]
    fn ascii_faults_name_the_line() {
        let cut = fault(&format!("solid a\n{FACET}"));
        assert_eq!(cut, (Place::Line(8), Fault::CutShort { expected: "`endsolid`".into() }));
        let broken = FACET.replace("endloop", "endlop");
        let (place, broken) = fault(&format!("solid a\n{FACET}{broken}endsolid\n"));
        assert_eq!(place, Place::Line(9));
        assert!(matches!(broken, Fault::Syntax { .. }));
        for word in ["nan", "inf", "1e300"] {
            let broken = FACET.replace("1 0 0", &format!("1 {word} 0"));
            let (place, fault) = fault(&format!("solid a\n{FACET}{broken}endsolid\n"));
            assert_eq!(place, Place::Line(12));
            assert!(matches!(fault, Fault::NonFinite { vertex: 4, .. }));
        }
        assert_eq!(fault("solid a\nendsolid\n"), (Place::File, Fault::NoFaces { n_vertices: 0 }));
        assert_eq!(fault(" \n"), (Place::File, Fault::Empty));
        assert!(matches!(fault("OFF\n"), (Place::File, Fault::WrongFormat { .. })));
    }

    #[test]
    fn binary_faults_name_the_byte() {
        let mut bytes = binary(&shapes::tetrahedron(0));
        bytes[PREFIX + TRIANGLE + 16..PREFIX + TRIANGLE + 20].copy_from_slice(&f32::NAN.to_le_bytes());
        let nan = parse(bytes.clone()).unwrap_err();
        assert_eq!(nan.place, Place::Byte(134));
        assert!(matches!(nan.fault, Fault::NonFinite { vertex: 3, .. }));
        bytes.pop();
        let short = Fault::Truncated { items: "triangles".into(), promised: 4, found: 3 };
        assert_eq!(parse(bytes).unwrap_err().fault, short);
        assert_eq!(parse(vec![0; PREFIX]).unwrap_err().fault, Fault::NoFaces { n_vertices: 0 });
        let bold = [[0u8; HEADER].as_slice(), &u32::MAX.to_le_bytes()].concat();
        assert!(matches!(parse(bold).unwrap_err().fault, Fault::Truncated { found: 0, .. }));
    }
}
