//! A model part: the unit, objects and the build.

use std::borrow::Cow;
use std::collections::HashMap;

use nalgebra::Matrix4;
use quick_xml::events::attributes::Attribute;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;
use surface::VertexId;

use crate::facts::LengthUnit;
use crate::limits::ReadLimits;
use crate::located::{At, Located};
use crate::polygons::{Placement, finite, placed_by};
use crate::text::{check_is_not_utf16, excerpt, parse_integer, parse_number};
use mesh::Fault;
use mesh::TriMesh;

/// Required extensions that this reader knows or that change no positions, by the end of their namespaces.
const KNOWN: [&str; 6] =
    ["/production/", "/material/", "/slice/", "/trianglesets/", "/core/", "/productionalternatives/"];

/// One model part.
pub(super) struct Model {
    pub(super) unit: LengthUnit,
    pub(super) objects: Vec<Object>,
    /// Where the objects are in the list, by their ids.
    numbers: HashMap<u64, usize>,
    pub(super) items: Vec<Reference>,
    /// Whether an object has beams, which are not read.
    pub(super) has_beams: bool,
}

/// A mesh, or other objects put together.
#[derive(Default)]
pub(super) struct Object {
    pub(super) id: u64,
    /// Whether it only supports others while they are printed.
    pub(super) is_support: bool,
    pub(super) mesh: TriMesh,
    pub(super) components: Vec<Reference>,
}

/// An object that is placed somewhere.
pub(super) struct Reference {
    /// The other part that has the object, if it is not the same.
    pub(super) part: Option<String>,
    pub(super) object: u64,
    pub(super) place: Placement,
}

impl Model {
    pub(super) fn object(&self, id: u64) -> Option<&Object> {
        self.numbers.get(&id).map(|number| &self.objects[*number])
    }

    /// Names of other parts, in order of appearance.
    pub(super) fn parts(&self) -> impl Iterator<Item = &str> {
        let components = self.objects.iter().flat_map(|object| &object.components);
        self.items.iter().chain(components).filter_map(|reference| reference.part.as_deref())
    }
}

/// Where in the file the parser is.
struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Cursor<'_> {
    /// Places a fault in the line of the element.
    fn locate(&self, fault: Fault) -> Located {
        let before = &self.bytes[..self.at.min(self.bytes.len())];
        fault.in_line(1 + before.iter().filter(|byte| **byte == b'\n').count())
    }

    fn syntax(&self, expected: &'static str, found: &str) -> Located {
        self.locate(Fault::syntax(expected, excerpt(found.as_bytes())))
    }

    /// The value of an attribute, in which `&amp;` stands for `&`.
    fn value<'a>(&self, attribute: &Attribute<'a>) -> Result<Cow<'a, str>, Located> {
        attribute
            .normalized_value(quick_xml::XmlVersion::Explicit1_0)
            .map_err(|fault| self.syntax("an attribute", &fault.to_string()))
    }

    /// Three attributes of an element, if it has them all.
    fn numbers<T: Copy>(
        &self,
        element: &BytesStart<'_>,
        names: [&str; 3],
        parse: fn(&[u8]) -> Option<T>,
    ) -> Result<Option<[T; 3]>, Located> {
        let mut found = [None; 3];
        for attribute in element.attributes().with_checks(false) {
            let attribute = attribute.map_err(|fault| self.syntax("an attribute", &fault.to_string()))?;
            if let Some(slot) = names.iter().position(|name| *name == attribute.key.as_ref()) {
                found[slot] = parse(self.value(&attribute)?.trim().as_bytes());
            }
        }
        let [a, b, c] = found;
        Ok(a.zip(b).zip(c).map(|((a, b), c)| [a, b, c]))
    }
}

/// The elements that lead to what is read. Elements of extensions may have the same names elsewhere.
const ELEMENTS: &str =
    "vertex triangle component item model resources object mesh vertices triangles components build";

/// Parses a part.
pub(super) fn parse(bytes: &[u8], limits: &ReadLimits) -> Result<Model, Located> {
    check_is_not_utf16(bytes)?;
    let text = std::str::from_utf8(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
        .map_err(|fault| Fault::syntax("text in UTF-8", "other bytes").at_byte(fault.valid_up_to()))?;
    let mut reader = Reader::from_str(text);
    reader.config_mut().expand_empty_elements = true;
    let mut parser = Parser {
        cursor: Cursor { bytes: text.as_bytes(), at: 0 },
        limits,
        model: Model {
            unit: LengthUnit::Millimeter,
            objects: Vec::new(),
            numbers: HashMap::new(),
            items: Vec::new(),
            has_beams: false,
        },
        object: Object::default(),
        path: Vec::new(),
        prefix: String::new(),
        n_vertices: 0,
        n_faces: 0,
    };
    loop {
        parser.cursor.at = reader.buffer_position() as usize;
        let event = reader.read_event().map_err(|fault| {
            parser.cursor.at = reader.error_position() as usize;
            parser.cursor.syntax("XML", &fault.to_string())
        })?;
        match event {
            Event::Start(element) => parser.start(&element)?,
            Event::End(_) => parser.end()?,
            Event::DocType(_) => return Err(parser.cursor.syntax("a model", "<!DOCTYPE")),
            Event::Eof if !parser.path.is_empty() => {
                return Err(parser.cursor.locate(Fault::cut_short("the end of the model")));
            }
            Event::Eof => return Ok(parser.model),
            _ => {}
        }
    }
}

struct Parser<'a> {
    cursor: Cursor<'a>,
    limits: &'a ReadLimits,
    model: Model,
    /// The object whose content is read.
    object: Object,
    /// The names of the open elements; empty for those that are not read.
    path: Vec<&'static str>,
    /// The prefix of the core elements, with its colon.
    prefix: String,
    n_vertices: u64,
    n_faces: u64,
}

impl Parser<'_> {
    /// Handles the beginning of an element.
    fn start(&mut self, element: &BytesStart<'_>) -> Result<(), Located> {
        let name = element.name();
        if self.path.is_empty() {
            if name.local_name().as_ref() != "model" {
                return Err(self.cursor.syntax("the element `model`", name.as_ref()));
            }
            self.prefix = name.prefix().map_or_else(String::new, |prefix| format!("{}:", prefix.as_ref()));
        }
        self.model.has_beams |= name.local_name().as_ref() == "beamlattice";
        let local = name.as_ref().strip_prefix(self.prefix.as_str());
        self.path.push(ELEMENTS.split(' ').find(|known| Some(*known) == local).unwrap_or_default());
        match self.path[..] {
            ["model"] => self.model(element),
            ["model", "resources", "object"] => {
                let attributes = Attributes::of(element, &self.cursor)?;
                let is_support = matches!(attributes.find("type"), Some("support" | "solidsupport"));
                self.object = Object { id: attributes.id("id")?, is_support, ..Object::default() };
                Ok(())
            }
            ["model", "resources", "object", "mesh", "vertices", "vertex"] => self.vertex(element),
            ["model", "resources", "object", "mesh", "triangles", "triangle"] => self.triangle(element),
            ["model", "resources", "object", "components", "component"] => {
                self.object.components.push(Attributes::of(element, &self.cursor)?.reference()?);
                Ok(())
            }
            ["model", "build", "item"] => {
                self.model.items.push(Attributes::of(element, &self.cursor)?.reference()?);
                Ok(())
            }
            _ if self.path.len() < 1000 => Ok(()),
            _ => Err(self.cursor.syntax("a model", "elements nested more than 1000 deep")),
        }
    }

    fn model(&mut self, element: &BytesStart<'_>) -> Result<(), Located> {
        let attributes = Attributes::of(element, &self.cursor)?;
        if let Some(unit) = attributes.find("unit") {
            let named = LengthUnit::ALL.into_iter().find(|known| known.name() == unit.trim());
            self.model.unit = named.ok_or_else(|| {
                self.cursor.syntax("a unit: micron, millimeter, centimeter, inch, foot or meter", unit)
            })?;
        }
        let required = attributes.find("requiredextensions").unwrap_or_default().split_ascii_whitespace();
        let mut namespaces =
            required.map(|prefix| attributes.find(&format!("xmlns:{prefix}")).unwrap_or(prefix));
        let is_unknown = |namespace: &&str| !KNOWN.iter().any(|known| namespace.contains(known));
        let Some(namespace) = namespaces.find(is_unknown) else { return Ok(()) };
        let name = namespace.rsplit("/3dmanufacturing/").next().unwrap_or(namespace);
        let what = match namespace.contains("/securecontent/") {
            true => "its content is encrypted".to_owned(),
            false => {
                format!("it requires the extension {}, which is not supported", excerpt(name.as_bytes()))
            }
        };
        Err(self.cursor.locate(Fault::unsupported(what, "export it without this extension")))
    }

    fn vertex(&mut self, element: &BytesStart<'_>) -> Result<(), Located> {
        let at = |fault| self.cursor.locate(fault);
        let position: [f64; 3] = self
            .cursor
            .numbers(element, ["x", "y", "z"], parse_number)?
            .ok_or_else(|| self.cursor.syntax("the coordinates x, y and z as numbers", element.as_ref()))?;
        let positions = &mut self.object.mesh.positions;
        positions.push(finite(position, positions.len()).map_err(at)?);
        self.n_vertices += 1;
        self.limits.check(self.n_vertices, 0).map_err(at)
    }

    fn triangle(&mut self, element: &BytesStart<'_>) -> Result<(), Located> {
        let at = |fault| self.cursor.locate(fault);
        let face = self
            .cursor
            .numbers(element, ["v1", "v2", "v3"], parse_integer)?
            .ok_or_else(|| self.cursor.syntax("the vertices v1, v2 and v3 as numbers", element.as_ref()))?;
        // Triangles come after all vertices of their object.
        let mesh = &mut self.object.mesh;
        let n = mesh.n_vertices() as u64;
        if let Some(index) = face.into_iter().find(|v| !(0..n as i64).contains(v)) {
            return Err(at(Fault::no_vertex(index.to_string(), 0, n)));
        }
        mesh.faces.push(face.map(|v| VertexId(v as u32)));
        self.n_faces += 1;
        self.limits.check(0, self.n_faces).map_err(at)
    }

    /// Handles the end of an element.
    fn end(&mut self) -> Result<(), Located> {
        let is_object = self.path == ["model", "resources", "object"];
        self.path.pop();
        if !is_object {
            return Ok(());
        }
        let object = std::mem::take(&mut self.object);
        let id = object.id;
        if self.model.numbers.insert(id, self.model.objects.len()).is_some() {
            return Err(self.cursor.syntax("objects with different ids", &format!("id {id} twice")));
        }
        self.model.objects.push(object);
        Ok(())
    }
}

/// The attributes of an element.
struct Attributes<'a> {
    pairs: Vec<(String, String)>,
    cursor: &'a Cursor<'a>,
}

impl<'a> Attributes<'a> {
    fn of(element: &BytesStart<'_>, cursor: &'a Cursor<'a>) -> Result<Self, Located> {
        let mut attributes = element.attributes();
        let pairs = attributes.with_checks(false).map(|attribute| {
            let attribute = attribute.map_err(|fault| cursor.syntax("an attribute", &fault.to_string()))?;
            Ok((attribute.key.as_ref().to_owned(), cursor.value(&attribute)?.into_owned()))
        });
        Ok(Self { pairs: pairs.collect::<Result<_, Located>>()?, cursor })
    }

    fn find(&self, name: &str) -> Option<&str> {
        self.pairs.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// A number of a resource.
    fn id(&self, name: &'static str) -> Result<u64, Located> {
        let text = self.find(name).unwrap_or_default();
        let id = parse_integer(text.trim().as_bytes()).and_then(|id| u64::try_from(id).ok());
        id.ok_or_else(|| self.cursor.syntax("the id of an object, a positive number", text))
    }

    /// An object and where it is placed.
    fn reference(&self) -> Result<Reference, Located> {
        let path = self.pairs.iter().find(|(name, _)| name.rsplit(':').next() == Some("path"));
        let part = path.map(|(_, part)| part.trim_start_matches('/').to_owned());
        let object = self.id("objectid")?;
        let Some(text) = self.find("transform") else { return Ok(Reference { part, object, place: None }) };
        let expected = || self.cursor.syntax("a transform of 12 numbers", text);
        let numbers: Option<Vec<f64>> =
            text.split_ascii_whitespace().map(|word| parse_number(word.as_bytes())).collect();
        let m: [f64; 12] = numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(expected)?;
        if m.iter().any(|x| !x.is_finite()) {
            return Err(expected());
        }
        // The file has rows that a row vector is multiplied by.
        #[rustfmt::skip]
        let place = Matrix4::new(
            m[0], m[3], m[6], m[9],
            m[1], m[4], m[7], m[10],
            m[2], m[5], m[8], m[11],
            0.0, 0.0, 0.0, 1.0,
        );
        Ok(Reference { part, object, place: placed_by(place) })
    }
}
