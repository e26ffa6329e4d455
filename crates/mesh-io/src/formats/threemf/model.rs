//! A model part: the unit, objects and the build.

use std::borrow::Cow;
use std::collections::HashMap;

use nalgebra::Matrix4;
use quick_xml::XmlVersion;
use quick_xml::events::attributes::{AttrError, Attribute};
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;

use crate::prelude::*;

/// Required extensions that this reader knows or that change no positions, by the end of their namespaces.
const KNOWN: [&str; 6] =
    ["/production/", "/material/", "/slice/", "/trianglesets/", "/core/", "/productionalternatives/"];

/// One model part.
#[derive(Default)]
pub(super) struct Model {
    /// If it is stated.
    pub(super) unit: Option<LengthUnit>,
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
    pub(super) place: Matrix4<f64>,
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
        text: text.as_bytes(),
        at: 0,
        limits,
        model: Model::default(),
        object: Object::default(),
        path: Vec::new(),
        prefix: String::new(),
        counts: [0; 2],
    };
    loop {
        parser.at = reader.buffer_position() as usize;
        let event = reader.read_event().map_err(|fault| {
            parser.at = reader.error_position() as usize;
            parser.syntax("XML", &fault.to_string())
        })?;
        match event {
            Event::Start(element) => parser.start(&element)?,
            Event::End(_) => parser.end()?,
            Event::DocType(_) => return Err(parser.syntax("a model", "<!DOCTYPE")),
            Event::Eof if !parser.path.is_empty() => {
                return Err(parser.locate(Fault::cut_short("the end of the model")));
            }
            Event::Eof => return Ok(parser.model),
            _ => {}
        }
    }
}

struct Parser<'a> {
    text: &'a [u8],
    /// Where the parser is.
    at: usize,
    limits: &'a ReadLimits,
    model: Model,
    /// The object whose content is read.
    object: Object,
    /// The names of the open elements; empty for those that are not read.
    path: Vec<&'static str>,
    /// The prefix of the core elements, with its colon.
    prefix: String,
    /// Vertices and triangles so far.
    counts: [u64; 2],
}

impl Parser<'_> {
    /// Places a fault in the line of the element.
    fn locate(&self, fault: Fault) -> Located {
        let before = &self.text[..self.at.min(self.text.len())];
        fault.in_line(1 + before.iter().filter(|byte| **byte == b'\n').count())
    }

    fn syntax(&self, expected: &'static str, found: &str) -> Located {
        self.locate(Fault::syntax(expected, excerpt(found.as_bytes())))
    }

    /// Handles the beginning of an element.
    fn start(&mut self, element: &BytesStart<'_>) -> Result<(), Located> {
        let name = element.name();
        if self.path.is_empty() {
            if name.local_name().as_ref() != "model" {
                return Err(self.syntax("the element `model`", name.as_ref()));
            }
            self.prefix = name.prefix().map_or_else(String::new, |prefix| format!("{}:", prefix.as_ref()));
        }
        self.model.has_beams |= name.local_name().as_ref() == "beamlattice";
        let local = name.as_ref().strip_prefix(self.prefix.as_str());
        self.path.push(ELEMENTS.split(' ').find(|known| Some(*known) == local).unwrap_or_default());
        match self.path[..] {
            ["model"] => self.model(&self.attributes(element)?)?,
            ["model", "resources", "object"] => {
                let attributes = self.attributes(element)?;
                let is_support = matches!(find(&attributes, "type"), Some("support" | "solidsupport"));
                self.object = Object { id: self.id(&attributes, "id")?, is_support, ..Object::default() };
            }
            ["model", "resources", "object", "mesh", "vertices", "vertex"] => self.vertex(element)?,
            ["model", "resources", "object", "mesh", "triangles", "triangle"] => self.triangle(element)?,
            ["model", "resources", "object", "components", "component"] => {
                self.object.components.push(self.reference(element)?);
            }
            ["model", "build", "item"] => self.model.items.push(self.reference(element)?),
            _ if self.path.len() < 1000 => {}
            _ => return Err(self.syntax("a model", "elements nested more than 1000 deep")),
        }
        Ok(())
    }

    fn model(&mut self, attributes: &Attributes<'_>) -> Result<(), Located> {
        if let Some(unit) = find(attributes, "unit") {
            let named = LengthUnit::ALL.into_iter().find(|known| known.name() == unit.trim());
            let expected = "a unit: micron, millimeter, centimeter, inch, foot or meter";
            self.model.unit = Some(named.ok_or_else(|| self.syntax(expected, unit))?);
        }
        let required = find(attributes, "requiredextensions").unwrap_or_default().split_ascii_whitespace();
        let mut namespaces =
            required.map(|prefix| find(attributes, &format!("xmlns:{prefix}")).unwrap_or(prefix));
        let is_unknown = |namespace: &&str| !KNOWN.iter().any(|known| namespace.contains(known));
        let Some(namespace) = namespaces.find(is_unknown) else { return Ok(()) };
        let name = namespace.rsplit("/3dmanufacturing/").next().unwrap_or(namespace);
        let what = match namespace.contains("/securecontent/") {
            true => "its content is encrypted".to_owned(),
            false => {
                format!("it requires the extension {}, which is not supported", excerpt(name.as_bytes()))
            }
        };
        Err(self.locate(Fault::unsupported(what, "export it without this extension")))
    }

    fn vertex(&mut self, element: &BytesStart<'_>) -> Result<(), Located> {
        let expected = "the coordinates x, y and z as numbers";
        let position: [f64; 3] = self.numbers(element, ["x", "y", "z"], parse_number, expected)?;
        let position = finite(position, self.object.mesh.n_vertices()).map_err(|fault| self.locate(fault))?;
        self.object.mesh.positions.push(position);
        self.counts[0] += 1;
        self.limits.check(self.counts[0], 0).map_err(|fault| self.locate(fault))
    }

    fn triangle(&mut self, element: &BytesStart<'_>) -> Result<(), Located> {
        let expected = "the vertices v1, v2 and v3 as numbers";
        let face = self.numbers(element, ["v1", "v2", "v3"], parse_integer, expected)?;
        // Triangles come after all vertices of their object.
        let n = self.object.mesh.n_vertices() as u64;
        if let Some(index) = face.into_iter().find(|v| !(0..n as i64).contains(v)) {
            return Err(self.locate(Fault::no_vertex(index, 0, n)));
        }
        self.object.mesh.faces.push(face.map(|v| VertexId(v as u32)));
        self.counts[1] += 1;
        self.limits.check(0, self.counts[1]).map_err(|fault| self.locate(fault))
    }

    /// Handles the end of an element.
    fn end(&mut self) -> Result<(), Located> {
        let is_object = self.path == ["model", "resources", "object"];
        self.path.pop();
        if is_object {
            let id = self.object.id;
            if self.model.numbers.insert(id, self.model.objects.len()).is_some() {
                return Err(self.syntax("objects with different ids", &format!("id {id} twice")));
            }
            self.model.objects.push(std::mem::take(&mut self.object));
        }
        Ok(())
    }

    /// Three attributes of an element.
    fn numbers<T>(
        &self,
        element: &BytesStart<'_>,
        names: [&str; 3],
        parse: fn(&[u8]) -> Option<T>,
        expected: &'static str,
    ) -> Result<[T; 3], Located> {
        let attributes = self.attributes(element)?;
        match names.map(|name| parse(find(&attributes, name)?.trim().as_bytes())) {
            [Some(a), Some(b), Some(c)] => Ok([a, b, c]),
            _ => Err(self.syntax(expected, element.as_ref())),
        }
    }

    fn attributes<'a>(&self, element: &'a BytesStart<'_>) -> Result<Attributes<'a>, Located> {
        attributes(element).map_err(|fault| self.syntax("an attribute", &fault.to_string()))
    }

    /// A number of a resource.
    fn id(&self, attributes: &Attributes<'_>, name: &str) -> Result<u64, Located> {
        let text = find(attributes, name).unwrap_or_default();
        let id = parse_integer(text.trim().as_bytes()).and_then(|id| u64::try_from(id).ok());
        id.ok_or_else(|| self.syntax("the id of an object, a positive number", text))
    }

    /// An object and where it is placed.
    fn reference(&self, element: &BytesStart<'_>) -> Result<Reference, Located> {
        let attributes = self.attributes(element)?;
        let part = find_local(&attributes, "path").map(|part| part.trim_start_matches('/').to_owned());
        let object = self.id(&attributes, "objectid")?;
        let text = find(&attributes, "transform").unwrap_or("1 0 0 0 1 0 0 0 1 0 0 0");
        let numbers: Vec<f64> =
            text.split_ascii_whitespace().map_while(|word| parse_number(word.as_bytes())).collect();
        let is_finite = numbers.iter().all(|x| x.is_finite());
        if numbers.len() != 12 || text.split_ascii_whitespace().count() != 12 || !is_finite {
            return Err(self.syntax("a transform of 12 numbers", text));
        }
        // The file has four rows that a row vector is multiplied by, without the last column.
        let mut place = Matrix4::identity();
        place.fixed_view_mut::<3, 4>(0, 0).copy_from_slice(&numbers);
        Ok(Reference { part, object, place })
    }
}

/// The names of attributes with their values, in which `&amp;` stands for `&`.
type Attributes<'a> = Vec<(&'a str, Cow<'a, str>)>;

/// All attributes of an element.
pub(super) fn attributes<'a>(element: &'a BytesStart<'_>) -> quick_xml::Result<Attributes<'a>> {
    let pair = |attribute: Result<Attribute<'a>, AttrError>| {
        let attribute = attribute?;
        Ok((attribute.key.into_inner(), attribute.normalized_value(XmlVersion::Explicit1_0)?))
    };
    element.attributes().with_checks(false).map(pair).collect()
}

fn find<'a>(attributes: &'a Attributes<'_>, name: &str) -> Option<&'a str> {
    attributes.iter().find(|(known, _)| *known == name).map(|(_, value)| &**value)
}

/// The value of an attribute, whatever the prefix of its name.
pub(super) fn find_local<'a>(attributes: &'a Attributes<'_>, name: &str) -> Option<&'a str> {
    let mut named = attributes.iter().filter(|(known, _)| known.rsplit(':').next() == Some(name));
    named.next().map(|(_, value)| &**value)
}
