//! Reading PLY, ascii and binary of either byte order.

use std::io::ErrorKind;

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess, PropertyType, ScalarType};

use crate::TriMesh;
use crate::error::{Fault, Located, Place};
use surface::VertexId;

use super::elements::{CORNER_LISTS, FaceIn, OtherIn, VertexIn};
use crate::io::ReadLimits;
use crate::io::assembly::{finish, push_polygon};
use crate::io::text::{excerpt, parse_f64, tokens};

/// Reads PLY: the element `vertex` with `x y z`, then `face` with a list `vertex_indices` or
/// `vertex_index`; other elements and properties are passed over.
pub(crate) fn parse(bytes: &[u8], limits: &ReadLimits) -> Result<TriMesh, Located> {
    if bytes.trim_ascii().is_empty() {
        return Err(Fault::Empty.whole());
    }
    if !bytes.starts_with(b"ply") {
        let found = format!("it begins with `{}`", excerpt(bytes));
        return Err(Fault::WrongFormat { expected: "a PLY file", found }.whole());
    }
    let mut reader = Reader::new(bytes);
    let header = Parser::<OtherIn>::new().read_header(&mut reader).map_err(|e| in_header(bytes, &e))?;
    let mut body = Body { encoding: header.encoding, line: reader.line(), bytes, at: 0 };
    body.at = bytes.len() - reader.into_inner().len();
    check_header(&header, bytes.len() - body.at, limits).map_err(Fault::whole)?;

    let mut positions = Vec::new();
    let mut faces = Vec::new();
    let mut corners = Vec::new();
    for element in header.elements.values() {
        match element.name.as_str() {
            "vertex" => positions.reserve_exact(element.count),
            "face" => faces.reserve_exact(element.count),
            _ => {}
        }
        for row in 0..element.count {
            match element.name.as_str() {
                "vertex" => {
                    let (place, VertexIn(p)) = body.next(element, row)?;
                    if let Some(&value) = p.iter().find(|x| !x.is_finite()) {
                        return Err(Located { place, fault: Fault::NonFinite { vertex: row as u64, value } });
                    }
                    positions.push(p);
                }
                "face" => {
                    let (place, FaceIn(indices)) = body.next(element, row)?;
                    let pushed = corners_in_range(&indices, positions.len(), &mut corners)
                        .and_then(|()| push_polygon(&positions, &corners, &mut faces, limits));
                    pushed.map_err(|fault| Located { place, fault })?;
                }
                _ => _ = body.next::<OtherIn>(element, row)?,
            }
        }
    }
    if !bytes[body.at..].trim_ascii().is_empty() {
        let promised = header.elements.values().map(|e| e.count as u64).sum();
        let fault = Fault::Leftover { items: "elements", promised };
        return Err(Located { place: body.place(), fault });
    }
    finish(positions, faces, limits)
}

fn corners_in_range(indices: &[i64], n_vertices: usize, corners: &mut Vec<VertexId>) -> Result<(), Fault> {
    corners.clear();
    for &index in indices {
        if !(0..n_vertices as i64).contains(&index) {
            let last = n_vertices.saturating_sub(1) as u64;
            return Err(Fault::IndexOutOfRange { index: index.to_string(), first: 0, last });
        }
        corners.push(VertexId(index as u32));
    }
    Ok(())
}

/// A fault of the header, with the offending line instead of the grammar's view of it.
fn in_header(bytes: &[u8], error: &ParseError) -> Located {
    let number = error.line().unwrap_or(1);
    if error.kind() == ErrorKind::UnexpectedEof {
        return Fault::CutShort { expected: "the rest of the header, to `end_header`".into() }
            .in_line(number);
    }
    let line = bytes.split(|&b| b == b'\n').nth(number - 1).unwrap_or_default();
    Fault::Syntax { expected: "a line of a PLY header", found: excerpt(line.trim_ascii()) }.in_line(number)
}

/// Refuses a header that lacks what a mesh needs or promises more than `payload` bytes can hold,
/// before anything is read or reserved.
fn check_header(header: &Header, payload: usize, limits: &ReadLimits) -> Result<(), Fault> {
    let remedy = "export the mesh with vertices `x y z`, then faces `vertex_indices`";
    let unsupported = |what: &str| Err(Fault::Unsupported { what: what.into(), remedy });
    let position_of = |name: &str| header.elements.get_index_of(name);
    let (Some(vertex_at), Some(vertex)) = (position_of("vertex"), header.elements.get("vertex")) else {
        return unsupported("the header declares no element `vertex`");
    };
    let (Some(face_at), Some(face)) = (position_of("face"), header.elements.get("face")) else {
        return Err(Fault::NoFaces { n_vertices: vertex.count });
    };
    limits.check(vertex.count as u64, face.count as u64)?;
    if face_at < vertex_at {
        return unsupported("the faces come before the vertices");
    }
    let is_scalar = |name: &str| {
        vertex.properties.get(name).is_some_and(|p| matches!(p.data_type, PropertyType::Scalar(_)))
    };
    if !["x", "y", "z"].into_iter().all(is_scalar) {
        return unsupported("the vertices lack one of the properties `x y z`");
    }
    let is_index_list = |name: &str| match face.properties.get(name).map(|p| &p.data_type) {
        Some(PropertyType::List(_, item)) => !matches!(item, ScalarType::Float | ScalarType::Double),
        _ => false,
    };
    if !CORNER_LISTS.into_iter().any(is_index_list) {
        return unsupported("the faces lack a list of whole numbers `vertex_indices`");
    }

    // The last number of an ascii file needs no separator after it.
    let mut room = payload as u64 + u64::from(header.encoding == Encoding::Ascii);
    for element in header.elements.values().filter(|e| e.count > 0) {
        let shortest = shortest_row(element, header.encoding);
        if shortest == 0 {
            return unsupported(&format!("the element `{}` has no properties", element.name));
        }
        let found = room / shortest;
        if element.count as u64 > found {
            let items = format!("rows of `{}`", element.name);
            return Err(Fault::Truncated { items, promised: element.count as u64, found });
        }
        room -= element.count as u64 * shortest;
    }
    Ok(())
}

/// The fewest bytes a row can take.
fn shortest_row(element: &ElementDef, encoding: Encoding) -> u64 {
    let size = |scalar: &ScalarType| match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    };
    let shortest = element.properties.values().map(|p| match (&p.data_type, encoding) {
        // A digit and a separator.
        (_, Encoding::Ascii) => 2,
        (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _), _) => size(scalar),
    });
    shortest.sum()
}

/// What follows the header.
struct Body<'a> {
    encoding: Encoding,
    bytes: &'a [u8],
    at: usize,
    /// The number of the next line of an ascii file.
    line: usize,
}

impl<'a> Body<'a> {
    fn place(&self) -> Place {
        match self.encoding {
            Encoding::Ascii => Place::Line(self.line),
            _ => Place::Byte(self.at as u64),
        }
    }

    /// The next row and its place.
    fn next<E: PropertyAccess>(&mut self, element: &ElementDef, row: usize) -> Result<(Place, E), Located> {
        let parser = Parser::<E>::new();
        let truncated = Fault::Truncated {
            items: format!("rows of `{}`", element.name),
            promised: element.count as u64,
            found: row as u64,
        };
        if self.encoding == Encoding::Ascii {
            let line = self.next_line().ok_or_else(|| truncated.whole())?;
            let place = Place::Line(self.line - 1);
            let parsed = parse_row(&parser, line, element, row);
            return Ok((place, parsed.map_err(|fault| Located { place, fault })?));
        }
        let place = self.place();
        let mut rest = &self.bytes[self.at..];
        let parsed = match self.encoding {
            Encoding::BinaryBigEndian => parser.read_big_endian_element(&mut rest, element),
            _ => parser.read_little_endian_element(&mut rest, element),
        };
        self.at = self.bytes.len() - rest.len();
        let fault = |e: ParseError| match e.kind() {
            ErrorKind::UnexpectedEof => truncated,
            _ => Fault::Syntax { expected: "a row as the header declares it", found: e.to_string() },
        };
        Ok((place, parsed.map_err(|e| Located { place, fault: fault(e) })?))
    }

    /// The next line that holds something.
    fn next_line(&mut self) -> Option<&'a [u8]> {
        while self.at < self.bytes.len() {
            let rest = &self.bytes[self.at..];
            let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
            self.at = (self.at + end + 1).min(self.bytes.len());
            self.line += 1;
            let line = rest[..end].trim_ascii();
            if !line.is_empty() {
                return Some(line);
            }
        }
        None
    }
}

fn parse_row<E: PropertyAccess>(
    parser: &Parser<E>,
    line: &[u8],
    element: &ElementDef,
    row: usize,
) -> Result<E, Fault> {
    let syntax = || Fault::Syntax { expected: "a row as the header declares it", found: excerpt(line) };
    let text = std::str::from_utf8(line).map_err(|_| syntax())?;
    parser.read_ascii_element(text, element).or_else(|_| {
        // The grammar knows neither `.5` and `5.` nor NaN.
        let numbers: Option<Vec<f64>> = tokens(line).map(parse_f64).collect();
        let numbers = numbers.ok_or_else(syntax)?;
        match numbers.iter().find(|x| !x.is_finite()) {
            Some(&value) if element.name == "vertex" => {
                return Err(Fault::NonFinite { vertex: row as u64, value });
            }
            Some(_) => return Err(syntax()),
            None => {}
        }
        let plain = |x: &f64| if x.fract() == 0.0 { format!("{x:.0}") } else { format!("{x:?}") };
        let plain: Vec<String> = numbers.iter().map(plain).collect();
        parser.read_ascii_element(&plain.join(" "), element).map_err(|_| syntax())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes;

    const HEADER: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\n\
        property float y\nproperty double z\nproperty uchar red\nelement face 2\n\
        property list uchar int vertex_indices\nproperty int flags\nend_header\n";
    const BODY: &str = "0 0 0 255\n1 0 0 9\n1 1 0 9\n0 1 .5 9\n3 0 1 2 7\n3 0 2 3 7\n";

    fn parse(bytes: &[u8]) -> Result<TriMesh, Located> {
        super::parse(bytes, &ReadLimits::default())
    }

    fn fault(text: &str) -> (Place, Fault) {
        let Located { place, fault } = parse(text.as_bytes()).unwrap_err();
        (place, fault)
    }

    #[test]
    fn ascii_with_foreign_properties_and_elements() {
        let mesh = parse(format!("{HEADER}{BODY}").as_bytes()).unwrap();
        assert_eq!(mesh.positions[3], nalgebra::Point3::new(0.0, 1.0, 0.5));
        assert_eq!(mesh.faces, [[0, 1, 2].map(VertexId), [0, 2, 3].map(VertexId)]);
        let windows = format!("{HEADER}{BODY}").replace('\n', "\r\n");
        assert_eq!(parse(windows.as_bytes()).unwrap(), mesh);
        let header = HEADER.replace("end_header", "element edge 1\nproperty int a\nend_header");
        assert_eq!(parse(format!("{header}{BODY}3\n").as_bytes()).unwrap(), mesh);
        let header = HEADER.replace("vertex_indices", "vertex_index").replace("uchar int", "int8 uint16");
        assert_eq!(parse(format!("{header}{BODY}").as_bytes()).unwrap(), mesh);
        let quad = BODY.replace("3 0 1 2 7\n3 0 2 3 7", "4 0 1 2 3 7");
        let header = HEADER.replace("face 2", "face 1");
        assert_eq!(parse(format!("{header}{quad}").as_bytes()).unwrap(), mesh);
    }

    /// The same mesh in either byte order, floats for coordinates and shorts for indices.
    fn binary(mesh: &TriMesh, big: bool) -> Vec<u8> {
        let order = if big { "big" } else { "little" };
        let header = format!(
            "ply\nformat binary_{order}_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
             property float z\nelement face {}\nproperty list uchar short vertex_index\nend_header\n",
            mesh.n_vertices(),
            mesh.n_faces()
        );
        let mut bytes = header.into_bytes();
        for x in mesh.positions.iter().flat_map(|p| [p.x, p.y, p.z]) {
            bytes.extend(if big { (x as f32).to_be_bytes() } else { (x as f32).to_le_bytes() });
        }
        for face in &mesh.faces {
            bytes.push(3);
            for v in face.map(|v| v.0 as i16) {
                bytes.extend(if big { v.to_be_bytes() } else { v.to_le_bytes() });
            }
        }
        bytes
    }

    #[test]
    fn binary_of_both_byte_orders() {
        let cube = shapes::cube(1);
        assert_eq!(parse(&binary(&cube, false)).unwrap(), cube);
        assert_eq!(parse(&binary(&cube, true)).unwrap(), cube);
    }

    #[test]
    fn ascii_faults_name_the_line() {
        let with = |from: &str, to: &str| fault(&format!("{HEADER}{BODY}").replacen(from, to, 1));
        assert!(matches!(
            with("1 1 0 9", "1 nan 0 9"),
            (Place::Line(15), Fault::NonFinite { vertex: 2, .. })
        ));
        assert!(matches!(with("1 1 0 9", "1 x 0 9"), (Place::Line(15), Fault::Syntax { .. })));
        assert!(matches!(with("1 1 0 9", "1 1"), (Place::Line(15), Fault::Syntax { .. })));
        let index = |index: &str| Fault::IndexOutOfRange { index: index.into(), first: 0, last: 3 };
        assert_eq!(with("3 0 2 3", "3 0 2 4"), (Place::Line(18), index("4")));
        assert_eq!(with("3 0 2 3", "3 0 -2 3"), (Place::Line(18), index("-2")));
        assert_eq!(with("3 0 2 3", "2 0 2 3"), (Place::Line(18), Fault::TooFewCorners { corners: 2 }));
        assert!(matches!(with("3 0 2 3", "9 0 2 3"), (Place::Line(18), Fault::Syntax { .. })));
        assert!(matches!(with("face 2", "face 1"), (Place::Line(18), Fault::Leftover { .. })));
        let rows = Fault::Truncated { items: "rows of `face`".into(), promised: 3, found: 2 };
        assert_eq!(with("face 2", "face 3").1, rows);
        assert!(matches!(with("ascii 1.0", "ascii one"), (Place::Line(2), Fault::Syntax { .. })));
        assert!(matches!(with("comment c", "commend c"), (Place::Line(3), Fault::Syntax { .. })));
    }

    #[test]
    fn headers_that_declare_no_mesh_or_too_much_are_refused() {
        let with = |from: &str, to: &str| fault(&format!("{HEADER}{BODY}").replacen(from, to, 1)).1;
        assert!(matches!(with("property float x\n", ""), Fault::Unsupported { .. }));
        assert!(matches!(with("vertex_indices", "texcoords"), Fault::Unsupported { .. }));
        assert!(matches!(with("uchar int", "uchar float"), Fault::Unsupported { .. }));
        assert!(matches!(with("element vertex", "element vertices"), Fault::Unsupported { .. }));
        assert!(matches!(with("element face", "element faces"), Fault::NoFaces { n_vertices: 4 }));
        assert!(matches!(
            with("end_header\n", "element e 99999999999999999\nend_header\n"),
            Fault::Unsupported { .. }
        ));
        let bold = with("vertex 4", "vertex 4000000000");
        assert!(matches!(bold, Fault::Truncated { promised: 4_000_000_000, .. }), "{bold:?}");
        assert!(matches!(with("vertex 4", "vertex 99999999999"), Fault::TooLarge { .. }));
        assert!(matches!(fault("ply\nformat ascii 1.0\n"), (_, Fault::CutShort { .. })));
        assert!(matches!(fault("OFF\n"), (Place::File, Fault::WrongFormat { .. })));
        assert_eq!(fault("\n"), (Place::File, Fault::Empty));
        assert!(parse(b"ply\n\xff\xfe\n").is_err());
    }

    #[test]
    fn binary_faults_name_the_byte() {
        let cube = shapes::cube(0);
        let whole = binary(&cube, false);
        let start = whole.len() - 12 * 8 - 7 * 12;
        let mut bytes = whole.clone();
        bytes[start + 12..start + 16].copy_from_slice(&f32::INFINITY.to_le_bytes());
        let Located { place, fault } = parse(&bytes).unwrap_err();
        assert_eq!(place, Place::Byte(start as u64 + 12));
        assert_eq!(fault, Fault::NonFinite { vertex: 1, value: f64::INFINITY });
        let mut bytes = whole.clone();
        bytes[start + 96] = 200;
        let Located { place, fault } = parse(&bytes).unwrap_err();
        assert_eq!(place, Place::Byte(start as u64 + 96));
        assert_eq!(fault, Fault::Truncated { items: "rows of `face`".into(), promised: 12, found: 0 });
        assert!(matches!(parse(&whole[..whole.len() - 1]).unwrap_err().fault, Fault::Truncated { .. }));
        assert!(matches!(parse(&[whole, vec![1]].concat()).unwrap_err().fault, Fault::Leftover { .. }));
    }
}
