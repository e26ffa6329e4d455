//! PLY, text and binary.

use mesh::MIN_POINTS;

use crate::prelude::*;

const FORMAT: &str = "a PLY file";
/// The last line of the header.
const END: &[u8] = b"end_header";

/// Checks the first line, and that the header is text.
pub(super) fn check_start(start: &[u8], _: Option<u64>) -> Result<(), Located> {
    check_is_not_utf16(start)?;
    if let Some(first) = Lines::new(start).next().filter(|first| first.text != b"ply") {
        return Err(other_format(FORMAT, first.text).whole());
    }
    let end = start.windows(END.len()).position(|window| window == END).unwrap_or(start.len());
    check_is_text(&start[..end], FORMAT)
}

/// Reads PLY: the element `vertex` with `x y z`, then `face` with a list `vertex_indices` or `vertex_index`. The first
/// floating-point property of the vertices other than positions, normals, colors and texture coordinates is a scalar
/// field. Other elements and properties are ignored.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let bytes = files[0];
    let mut lines = Lines::new(bytes);
    // The first line is `ply`.
    lines.next();
    let header = Header::parse(&mut lines)?;
    header.check(lines.remaining(), limits).whole()?;
    let mut body = match header.byte_order {
        None => Body::Text(Words::new(lines, false)),
        Some(order) => Body::Binary(Bytes::new(bytes, bytes.len() - lines.remaining(), order)),
    };
    let (mut positions, mut polygons) = (Vec::new(), Polygons::default());
    let (mut corners, mut values) = (Vec::new(), Vec::new());
    for element in &header.elements {
        let (is_vertex, is_face) = (element.name == "vertex", element.name == "face");
        let n_vertices = positions.len() as f64;
        for row in 0..element.count {
            let (mut p, mut outside) = (Point3::origin(), None);
            corners.clear();
            let place = body.row(element, row, |role, x| match role {
                Role::Axis(axis) => p[axis] = x,
                Role::Field => values.push(x),
                Role::Corner if (0.0..n_vertices).contains(&x) => corners.push(VertexId(x as u32)),
                Role::Corner => drop(outside.get_or_insert(x)),
                Role::Ignored => {}
            })?;
            if is_vertex {
                positions.push(finite(p, row as usize).at(place)?);
            } else if let Some(index) = outside {
                return Err(Fault::no_vertex(index, 0, n_vertices as u64).at(place));
            } else if is_face {
                polygons.push(&positions, &corners, limits).at(place)?;
            }
        }
    }
    let leftover = match body {
        Body::Text(mut words) => words.row().map(|line| Place::Line(line.number)),
        Body::Binary(bytes) => (!bytes.rest.trim_ascii().is_empty()).then_some(Place::Byte(bytes.at as u64)),
    };
    if let Some(place) = leftover {
        let promised = header.elements.iter().map(|element| element.count).sum();
        return Err(Fault::leftover("elements", promised).at(place));
    }
    let mut properties = header.elements.into_iter().flat_map(|element| element.properties);
    let field = properties.find(|property| property.role == Role::Field);
    let field = field.map(|property| ScalarField { name: property.name, values });
    Ok(MeshFile { field, ..polygons.finish(positions, limits)? })
}

/// What follows the header: in text, a row per line.
enum Body<'a> {
    Text(Words<'a>),
    Binary(Bytes<'a>),
}

impl Body<'_> {
    /// Reads the next row and gives each of its numbers to `take`; returns the place of the row. Only words of positions and
    /// corners must be numbers: others may be given as NaN.
    fn row(&mut self, element: &Element, row: u64, take: impl FnMut(Role, f64)) -> Result<Place, Located> {
        let truncated = || Fault::truncated(format!("rows of `{}`", element.name), element.count, row);
        match self {
            Self::Text(words) => {
                let line = words.row().ok_or_else(|| truncated().in_line(words.lines.number))?;
                let mut tokens = line.tokens();
                let next = |scalar, role| {
                    let is_needed = matches!(role, Role::Axis(_) | Role::Corner);
                    parse_scalar(scalar, tokens.next()?).or_else(|| (!is_needed).then_some(f64::NAN))
                };
                element
                    .read_row(next, take)
                    .ok_or_else(|| line.expected("a row as the header declares it"))?;
                Ok(Place::Line(line.number))
            }
            Self::Binary(bytes) => {
                let place = Place::Byte(bytes.at as u64);
                let next = |scalar, _| bytes.number(scalar);
                element.read_row(next, take).ok_or_else(|| truncated().at(place))?;
                Ok(place)
            }
        }
    }
}

/// A number as its type can hold it.
fn parse_scalar(scalar: Scalar, token: &[u8]) -> Option<f64> {
    match scalar {
        Scalar::F32 => parse_number::<f32>(token).map(f64::from),
        Scalar::F64 => parse_number(token),
        _ => parse_integer(token).map(|x| x as f64),
    }
}

/// Which numbers follow, and how they are stored.
struct Header {
    /// `None` for text.
    byte_order: Option<ByteOrder>,
    elements: Vec<Element>,
}

/// A table of `count` rows.
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

/// A column: one number per row, or a list of them.
struct Property {
    name: String,
    /// Type of the length of a list; `None` for a single number.
    length: Option<Scalar>,
    item: Scalar,
    role: Role,
}

/// What the numbers of a property are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    /// The coordinate of a vertex along this axis.
    Axis(usize),
    /// The scalar field.
    Field,
    /// The corners of a face, and lengths of lists.
    Corner,
    Ignored,
}

impl Header {
    /// Reads the lines after `ply` up to `end_header`.
    fn parse(lines: &mut Lines<'_>) -> Result<Self, Located> {
        let mut byte_order = None;
        let mut elements: Vec<Element> = Vec::new();
        for line in lines.by_ref() {
            let unexpected = || line.expected("a line of a PLY header");
            let words: Vec<&str> = line.tokens().map(|word| str::from_utf8(word).unwrap_or("")).collect();
            match words[..] {
                ["comment" | "obj_info", ..] => {}
                ["format", name, version] if byte_order.is_none() => {
                    parse_number::<f64>(version.as_bytes()).ok_or_else(unexpected)?;
                    byte_order = Some(match name {
                        "ascii" => None,
                        "binary_little_endian" => Some(ByteOrder::Little),
                        "binary_big_endian" => Some(ByteOrder::Big),
                        _ => return Err(unexpected()),
                    });
                }
                ["element", name, count] if elements.iter().all(|element| element.name != name) => {
                    let count = count.parse().map_err(|_| unexpected())?;
                    elements.push(Element { name: name.into(), count, properties: Vec::new() });
                }
                ["property", .., name] if words.len() > 2 => {
                    let scalar = |name| scalar(name).ok_or_else(unexpected);
                    let (length, item) = match words[1..words.len() - 1] {
                        [item] => (None, scalar(item)?),
                        ["list", length, item] => (Some(scalar(length)?), scalar(item)?),
                        _ => return Err(unexpected()),
                    };
                    let element = elements.last_mut().ok_or_else(unexpected)?;
                    let role = element.role(name, length.is_some(), item.is_integer());
                    element.properties.push(Property { name: name.into(), length, item, role });
                }
                ["end_header"] => {
                    let byte_order =
                        byte_order.ok_or_else(|| line.expected("a line `format` before the end"))?;
                    return Ok(Self { byte_order, elements });
                }
                _ => return Err(unexpected()),
            }
        }
        Err(Fault::cut_short("the rest of the header, to `end_header`").in_line(lines.number))
    }

    /// Rejects a header that does not declare a mesh or that promises more than `payload` bytes can hold,
    /// before anything is read or reserved.
    fn check(&self, payload: usize, limits: &ReadLimits) -> Result<(), Fault> {
        let remedy = "export the mesh with vertices `x y z`, then faces `vertex_indices`";
        let unsupported = |what: &str| Err(Fault::unsupported(what, remedy));
        let position_of = |name: &str| self.elements.iter().position(|element| element.name == name);
        let Some(vertex_at) = position_of("vertex") else {
            return unsupported("the header declares no element `vertex`");
        };
        let vertex = &self.elements[vertex_at];
        let face_at = position_of("face");
        let n_faces = face_at.map_or(0, |at| self.elements[at].count);
        limits.check(vertex.count, n_faces)?;
        if n_faces == 0 && position_of("tristrips").is_some() {
            return unsupported("the faces are strips of triangles");
        }
        if n_faces == 0 && vertex.count < MIN_POINTS as u64 {
            return Err(Fault::no_faces(vertex.count));
        }
        if face_at.is_some_and(|face_at| face_at < vertex_at) {
            return unsupported("the faces come before the vertices");
        }
        if !(0..3).all(|axis| vertex.has(Role::Axis(axis))) {
            return unsupported("the vertices lack one of the properties `x y z`");
        }
        if n_faces > 0 && face_at.is_some_and(|at| !self.elements[at].has(Role::Corner)) {
            return unsupported("the faces lack a list of integers `vertex_indices`");
        }

        // The last number of an ASCII file needs no separator after it.
        let mut room = payload as u64 + u64::from(self.byte_order.is_none());
        for element in self.elements.iter().filter(|element| element.count > 0) {
            let shortest = element.shortest_row(self.byte_order);
            if shortest == 0 {
                return unsupported(&format!("the element `{}` has no properties", element.name));
            }
            let found = room / shortest;
            if element.count > found {
                return Err(Fault::truncated(format!("rows of `{}`", element.name), element.count, found));
            }
            room -= element.count * shortest;
        }
        Ok(())
    }
}

impl Element {
    fn has(&self, role: Role) -> bool {
        self.properties.iter().any(|property| property.role == role)
    }

    /// What the next property is for.
    fn role(&self, name: &str, is_list: bool, is_integer: bool) -> Role {
        /// Properties of vertices that are no field.
        const OTHERS: &str = "nx ny nz red green blue alpha r g b a s t u v texture_u texture_v w";
        match (self.name.as_str(), name) {
            ("face", "vertex_indices" | "vertex_index")
                if is_list && is_integer && !self.has(Role::Corner) =>
            {
                Role::Corner
            }
            ("vertex", "x") if !is_list => Role::Axis(0),
            ("vertex", "y") if !is_list => Role::Axis(1),
            ("vertex", "z") if !is_list => Role::Axis(2),
            ("vertex", name)
                if !is_list
                    && !is_integer
                    && !self.has(Role::Field)
                    && !OTHERS.split(' ').any(|other| other == name) =>
            {
                Role::Field
            }
            _ => Role::Ignored,
        }
    }

    /// Reads a row, number by number; `None` if one is missing or malformed.
    fn read_row(
        &self,
        mut next: impl FnMut(Scalar, Role) -> Option<f64>,
        mut take: impl FnMut(Role, f64),
    ) -> Option<()> {
        for property in &self.properties {
            let n = match property.length {
                None => 1,
                Some(length) => next(length, Role::Corner).filter(|n| *n >= 0.0 && n.fract() == 0.0)? as u64,
            };
            for _ in 0..n {
                take(property.role, next(property.item, property.role)?);
            }
        }
        Some(())
    }

    /// The fewest bytes that a row can take.
    fn shortest_row(&self, byte_order: Option<ByteOrder>) -> u64 {
        // A digit and a separator in text.
        let shortest = |p: &Property| byte_order.map_or(2, |_| p.length.unwrap_or(p.item).size() as u64);
        self.properties.iter().map(shortest).sum()
    }
}

fn scalar(name: &str) -> Option<Scalar> {
    Some(match name {
        "char" | "int8" => Scalar::I8,
        "uchar" | "uint8" => Scalar::U8,
        "short" | "int16" => Scalar::I16,
        "ushort" | "uint16" => Scalar::U16,
        "int" | "int32" => Scalar::I32,
        "uint" | "uint32" => Scalar::U32,
        "float" | "float32" => Scalar::F32,
        "double" | "float64" => Scalar::F64,
        _ => return None,
    })
}

const FACE_PROPERTIES: &str = "property list uchar uint vertex_indices\n";
const FIELD_COLORS: &str = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

/// Writes a mesh, perhaps with a value and a color per vertex; coordinates read back bit for bit.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh, field: Field<'_>) -> io::Result<()> {
    let properties = field.map(|field| format!("property double {}\n{FIELD_COLORS}", field.name));
    let properties = properties.unwrap_or_default();
    write_header(out, mesh.n_vertices(), &properties, "face", mesh.n_faces(), FACE_PROPERTIES)?;
    for (v, p) in mesh.positions.iter().enumerate() {
        write_coordinates(out, p)?;
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
pub(super) fn write_lines(out: &mut dyn Write, lines: &[Vec<Point3<f64>>]) -> io::Result<()> {
    let n_points = lines.iter().map(Vec::len).sum();
    let n_edges = lines.iter().map(|line| line.len().saturating_sub(1)).sum();
    write_header(out, n_points, "", "edge", n_edges, "property uint vertex1\nproperty uint vertex2\n")?;
    lines.iter().flatten().try_for_each(|p| write_coordinates(out, p))?;
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

fn write_coordinates(out: &mut dyn Write, p: &Point3<f64>) -> io::Result<()> {
    p.iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))
}
