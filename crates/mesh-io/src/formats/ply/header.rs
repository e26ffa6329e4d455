//! The header of a PLY file: which numbers follow, and how they are stored.

use crate::binary::{ByteOrder, Scalar};
use crate::limits::ReadLimits;
use crate::located::{At, Located};
use crate::text::{Lines, parse_number};
use mesh::{Fault, MIN_POINTS};

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    /// One row per line.
    Ascii,
    Binary(ByteOrder),
}

/// A table of `count` rows.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// A column: one number per row, or a list of them.
pub(super) struct Property {
    pub(super) name: String,
    /// Type of the length of a list; `None` for a single number.
    pub(super) length: Option<Scalar>,
    pub(super) item: Scalar,
}

impl Header {
    /// Reads the lines after `ply` up to `end_header`.
    pub(super) fn parse(lines: &mut Lines<'_>) -> Result<Self, Located> {
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        for line in lines.by_ref() {
            let unexpected = || line.expected("a line of a PLY header");
            let words: Vec<&str> = line.tokens().map(|word| str::from_utf8(word).unwrap_or("")).collect();
            match words[..] {
                ["comment" | "obj_info", ..] => {}
                ["format", name, version] if encoding.is_none() => {
                    parse_number::<f64>(version.as_bytes()).ok_or_else(unexpected)?;
                    encoding = Some(match name {
                        "ascii" => Encoding::Ascii,
                        "binary_little_endian" => Encoding::Binary(ByteOrder::Little),
                        "binary_big_endian" => Encoding::Binary(ByteOrder::Big),
                        _ => return Err(unexpected()),
                    });
                }
                ["element", name, count] if elements.iter().all(|element| element.name != name) => {
                    let count = count.parse().map_err(|_| unexpected())?;
                    elements.push(Element { name: name.into(), count, properties: Vec::new() });
                }
                ["property", .., name] if words.len() > 2 => {
                    let property = match words[1..words.len() - 1] {
                        [item] => scalar(item).map(|item| (None, item)),
                        ["list", length, item] => scalar(length).zip(scalar(item)).map(|(n, i)| (Some(n), i)),
                        _ => None,
                    };
                    let (length, item) = property.ok_or_else(unexpected)?;
                    let element = elements.last_mut().ok_or_else(unexpected)?;
                    element.properties.push(Property { name: name.into(), length, item });
                }
                ["end_header"] => {
                    let encoding = encoding.ok_or_else(|| line.expected("a line `format` before the end"))?;
                    return Ok(Self { encoding, elements });
                }
                _ => return Err(unexpected()),
            }
        }
        Err(Fault::cut_short("the rest of the header, to `end_header`").in_line(lines.number()))
    }

    /// Rejects a header that does not declare a mesh or that promises more than `payload` bytes can hold,
    /// before anything is read or reserved.
    pub(super) fn check(&self, payload: usize, limits: &ReadLimits) -> Result<(), Fault> {
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
            return Err(Fault::NoFaces { n_vertices: vertex.count as usize });
        }
        if face_at.is_some_and(|face_at| face_at < vertex_at) {
            return unsupported("the faces come before the vertices");
        }
        if (0..3).any(|axis| !vertex.properties.iter().any(|p| p.axis() == Some(axis))) {
            return unsupported("the vertices lack one of the properties `x y z`");
        }
        if n_faces > 0 && face_at.is_some_and(|at| self.elements[at].corner_list().is_none()) {
            return unsupported("the faces lack a list of integers `vertex_indices`");
        }

        // The last number of an ASCII file needs no separator after it.
        let mut room = payload as u64 + u64::from(self.encoding == Encoding::Ascii);
        for element in self.elements.iter().filter(|element| element.count > 0) {
            let shortest = element.shortest_row(self.encoding);
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
    /// Index of the property that lists the corners of a face.
    pub(super) fn corner_list(&self) -> Option<usize> {
        let names = ["vertex_indices", "vertex_index"];
        self.properties
            .iter()
            .position(|p| names.contains(&p.name.as_str()) && p.length.is_some() && p.item.is_integer())
    }

    /// The fewest bytes that a row can take.
    fn shortest_row(&self, encoding: Encoding) -> u64 {
        let shortest = |p: &Property| match encoding {
            // A digit and a separator.
            Encoding::Ascii => 2,
            Encoding::Binary(_) => p.length.unwrap_or(p.item).size() as u64,
        };
        self.properties.iter().map(shortest).sum()
    }
}

impl Property {
    /// The axis whose coordinate a property of a vertex holds.
    pub(super) fn axis(&self) -> Option<usize> {
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == self.name);
        axis.filter(|_| self.length.is_none())
    }

    /// Whether a property of a vertex is a scalar field, judging by its type and name.
    pub(super) fn is_field(&self) -> bool {
        const OTHERS: &str = "x y z nx ny nz red green blue alpha r g b a s t u v texture_u texture_v w";
        self.length.is_none() && !self.item.is_integer() && OTHERS.split(' ').all(|other| other != self.name)
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
