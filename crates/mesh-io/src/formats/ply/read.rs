//! Reading PLY, ASCII and binary.

use nalgebra::Point3;
use surface::VertexId;

use super::header::{Element, Encoding, Header};
use crate::binary::{ByteOrder, Scalar};
use crate::facts::MeshFile;
use crate::field::ScalarField;
use crate::limits::ReadLimits;
use crate::located::{At, Located};
use crate::polygons::{Polygons, finite};
use crate::text::{Lines, check_is_not_utf16, check_is_text, excerpt, parse_integer, parse_number};
use mesh::{Fault, Place};

const FORMAT: &str = "a PLY file";
/// The last line of the header.
const END: &[u8] = b"end_header";

/// Checks the first line, and that the header is text.
pub(crate) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    check_is_not_utf16(start)?;
    check_first_line(&mut Lines::new(start))?;
    let end = start.windows(END.len()).position(|window| window == END).unwrap_or(start.len());
    check_is_text(&start[..end], FORMAT)
}

/// Reads `ply`.
fn check_first_line(lines: &mut Lines<'_>) -> Result<(), Located> {
    match lines.next() {
        None => Err(Fault::Empty.whole()),
        Some(first) if first.text == b"ply" => Ok(()),
        Some(first) => {
            Err(Fault::wrong_format(FORMAT, format!("it begins with `{}`", excerpt(first.text))).whole())
        }
    }
}

/// Reads PLY: the element `vertex` with `x y z`, then `face` with a list `vertex_indices` or `vertex_index`. The first
/// floating-point property of the vertices other than positions, normals, colours and texture coordinates is a scalar
/// field. Other elements and properties are ignored.
pub(crate) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let (bytes, mut field) = (files[0], None);
    let mut lines = Lines::new(bytes);
    check_first_line(&mut lines)?;
    let header = Header::parse(&mut lines)?;
    header.check(lines.remaining(), limits).map_err(Fault::whole)?;
    let mut body = match header.encoding {
        Encoding::Ascii => Body::Ascii(lines),
        Encoding::Binary(order) => Body::Binary { bytes, at: bytes.len() - lines.remaining(), order },
    };
    let (mut positions, mut polygons, mut corners) = (Vec::new(), Polygons::default(), Vec::new());
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => {
                positions.reserve_exact(element.count as usize);
                let axes: Vec<Option<usize>> = element.properties.iter().map(|p| p.axis()).collect();
                let carrier = element.properties.iter().position(|p| p.is_field());
                let mut values = Vec::new();
                let is_needed = |property: usize| axes[property].is_some();
                for row in 0..element.count {
                    let mut p = Point3::origin();
                    let place = body.row(element, row, is_needed, |property, x| {
                        if let Some(axis) = axes[property] {
                            p[axis] = x;
                        }
                        if carrier == Some(property) {
                            values.push(x);
                        }
                    })?;
                    positions.push(finite(p, row as usize).map_err(|fault| fault.at(place))?);
                }
                field = carrier.map(|i| ScalarField { name: element.properties[i].name.clone(), values });
            }
            "face" => {
                polygons = Polygons::with_room_for(element.count as usize);
                let list = element.corner_list();
                for row in 0..element.count {
                    let mut outside = None;
                    corners.clear();
                    let is_needed = |property| Some(property) == list;
                    let place = body.row(element, row, is_needed, |property, index| {
                        if !is_needed(property) {
                        } else if (0.0..positions.len() as f64).contains(&index) {
                            corners.push(VertexId(index as u32));
                        } else {
                            outside.get_or_insert(index);
                        }
                    })?;
                    if let Some(index) = outside {
                        let n = positions.len() as u64;
                        return Err(Fault::no_vertex(index.to_string(), 0, n).at(place));
                    }
                    polygons.push(&positions, &corners, limits).map_err(|fault| fault.at(place))?;
                }
            }
            _ => {
                for row in 0..element.count {
                    body.row(element, row, |_| false, |_, _| ())?;
                }
            }
        }
    }
    if let Some(place) = body.leftover() {
        let promised = header.elements.iter().map(|element| element.count).sum();
        return Err(Fault::Leftover { items: "elements", promised }.at(place));
    }
    Ok(MeshFile { field, ..polygons.finish(positions, limits)? })
}

/// What follows the header.
enum Body<'a> {
    Ascii(Lines<'a>),
    Binary { bytes: &'a [u8], at: usize, order: ByteOrder },
}

impl Body<'_> {
    /// Reads the next row and gives each of its numbers to `take`, with the index of its property; returns
    /// the place of the row. Words of properties that are not needed may be no numbers: they are given as NaN.
    fn row(
        &mut self,
        element: &Element,
        row: u64,
        is_needed: impl Fn(usize) -> bool,
        take: impl FnMut(usize, f64),
    ) -> Result<Place, Located> {
        let truncated = || Fault::truncated(format!("rows of `{}`", element.name), element.count, row);
        match self {
            Self::Ascii(lines) => {
                let line = lines.next().ok_or_else(|| truncated().in_line(lines.number()))?;
                let mut tokens = line.tokens();
                let next = |scalar, property: Option<usize>| {
                    let token = tokens.next()?;
                    parse_scalar(scalar, token)
                        .or_else(|| (!property.is_none_or(&is_needed)).then_some(f64::NAN))
                };
                read_row(element, next, take)
                    .ok_or_else(|| line.expected("a row as the header declares it"))?;
                Ok(Place::Line(line.number))
            }
            Self::Binary { bytes, at, order } => {
                let place = Place::Byte(*at as u64);
                let next = |scalar: Scalar, _| {
                    let x = scalar.decode(*order, bytes.get(*at..)?)?;
                    *at += scalar.size();
                    Some(x)
                };
                read_row(element, next, take).ok_or_else(|| truncated().at(place))?;
                Ok(place)
            }
        }
    }

    /// The place of anything after the last row.
    fn leftover(self) -> Option<Place> {
        match self {
            Self::Ascii(mut lines) => lines.next().map(|line| Place::Line(line.number)),
            Self::Binary { bytes, at, .. } => {
                (!bytes[at..].trim_ascii().is_empty()).then_some(Place::Byte(at as u64))
            }
        }
    }
}

/// Reads a row, number by number; `None` if one is missing or malformed. `next` learns the property that a number belongs
/// to, `None` for the length of a list.
fn read_row(
    element: &Element,
    mut next: impl FnMut(Scalar, Option<usize>) -> Option<f64>,
    mut take: impl FnMut(usize, f64),
) -> Option<()> {
    for (i, property) in element.properties.iter().enumerate() {
        let n = match property.length {
            None => 1,
            Some(length) => Some(next(length, None)?).filter(|n| *n >= 0.0 && n.fract() == 0.0)? as u64,
        };
        for _ in 0..n {
            take(i, next(property.item, Some(i))?);
        }
    }
    Some(())
}

/// A number as its type can hold it.
fn parse_scalar(scalar: Scalar, token: &[u8]) -> Option<f64> {
    match scalar {
        Scalar::F32 => parse_number::<f32>(token).map(f64::from),
        Scalar::F64 => parse_number(token),
        _ => parse_integer(token).map(|x| x as f64),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::{TriMesh, shapes};

    const HEADER: &str = "ply\nformat ascii 1.0\ncomment c\nelement vertex 4\nproperty float x\n\
        property float y\nproperty double z\nproperty uchar red\nelement face 2\n\
        property list uchar int vertex_indices\nproperty int flags\nend_header\n";
    const BODY: &str = "0 0 0 255\n1 0 0 9\n1 1 0 9\n0 1 .5 9\n3 0 1 2 7\n3 0 2 3 7\n";

    fn parse(bytes: &[u8]) -> Result<TriMesh, Located> {
        super::parse(&[bytes], &ReadLimits::default()).map(|file| file.mesh)
    }

    fn fault(text: &str) -> (Place, Fault) {
        let Located { place, fault, .. } = parse(text.as_bytes()).unwrap_err();
        (place, fault)
    }

    #[test]
    fn other_properties_and_elements_are_ignored() {
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
    fn binary_parses_in_both_byte_orders() {
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
    fn headers_that_declare_no_mesh_or_too_much_are_errors() {
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
        let Located { place, fault, .. } = parse(&bytes).unwrap_err();
        assert_eq!(place, Place::Byte(start as u64 + 12));
        assert_eq!(fault, Fault::NonFinite { vertex: 1, value: f64::INFINITY });
        let mut bytes = whole.clone();
        bytes[start + 96] = 200;
        let Located { place, fault, .. } = parse(&bytes).unwrap_err();
        assert_eq!(place, Place::Byte(start as u64 + 96));
        assert_eq!(fault, Fault::Truncated { items: "rows of `face`".into(), promised: 12, found: 0 });
        assert!(matches!(parse(&whole[..whole.len() - 1]).unwrap_err().fault, Fault::Truncated { .. }));
        assert!(matches!(parse(&[whole, vec![1]].concat()).unwrap_err().fault, Fault::Leftover { .. }));
    }
}
