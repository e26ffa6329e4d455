//! 3MF, the 3D Manufacturing Format: a zip archive with models as XML.
//!
//! **Vertices.** The items of the build are visited in their order, and the components of an object in theirs. Each object
//! with a mesh adds its vertices in their order, whether a triangle uses them or not. An object that is placed three times
//! adds them three times. A file with an empty build has each object once that is not a component of another.
//!
//! **Coordinates.** The transforms of components and items are applied. The unit of length is reported, not converted.

mod model;
mod package;

use std::collections::HashMap;

use nalgebra::Matrix4;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

use crate::polygons::Assembly;
use crate::prelude::*;
use model::{Model, Object, Reference};
use package::{Package, canonical};

pub(super) use package::check_start;

/// Components may be nested this deep.
const MAX_DEPTH: usize = 64;

/// Reads a 3MF file.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let bytes = files[0];
    let mut package = Package::open(bytes)?;
    let root = package.root()?;
    let mut file = Parts { models: Vec::new(), numbers: HashMap::from([(canonical(&root), 0)]) };
    let mut waiting = vec![root];
    // Objects may be in other parts of the package.
    while let Some(name) = waiting.get(file.models.len()).cloned() {
        let content = package.read(&name)?;
        let model = model::parse(&content, limits).map_err(|fault| fault.of_member(&name))?;
        for other in model.parts() {
            let next = file.numbers.len();
            if *file.numbers.entry(canonical(other)).or_insert(next) == next {
                waiting.push(other.to_owned());
            }
        }
        file.models.push(model);
    }
    file.assemble(bytes.len() as u64, limits)
}

/// The models of all parts.
struct Parts {
    models: Vec<Model>,
    /// Their numbers by canonical name.
    numbers: HashMap<String, usize>,
}

/// A part and the id of one of its objects.
type Key = (usize, u64);

impl Parts {
    fn key(&self, reference: &Reference, part: usize) -> Key {
        let other = reference.part.as_ref().and_then(|name| self.numbers.get(&canonical(name)));
        (other.copied().unwrap_or(part), reference.object)
    }

    fn object(&self, (part, id): Key) -> Result<&Object, Located> {
        self.models[part]
            .object(id)
            .ok_or_else(|| Fault::syntax("the id of an object that exists", format!("object {id}")).whole())
    }

    fn assemble(&self, n_bytes: u64, limits: &ReadLimits) -> Result<MeshFile, Located> {
        let root = &self.models[0];
        let mut items: Vec<_> = root.items.iter().map(|item| (self.key(item, 0), item.place)).collect();
        if items.is_empty() {
            let components = root.objects.iter().flat_map(|object| &object.components);
            let of_others: Vec<Key> = components.map(|component| self.key(component, 0)).collect();
            let tops = root.objects.iter().map(|object| (0, object.id));
            items =
                tops.filter(|key| !of_others.contains(key)).map(|key| (key, Matrix4::identity())).collect();
        }
        let mut assembly = Assembly::new(limits, n_bytes);
        for (key, place) in items {
            self.append(&mut assembly, key, &place, 0)?;
        }
        let has_supports =
            self.models.iter().flat_map(|model| &model.objects).any(|object| object.is_support);
        let has_beams = self.models.iter().any(|model| model.has_beams);
        let ignored = [(has_supports, "supports"), (has_beams, "beam lattices")];
        let facts = FileFacts {
            unit: root.unit.or(Some(LengthUnit::Millimeter)),
            instances: Some(assembly.instances),
            ignored: ignored.into_iter().filter_map(|(is_there, what)| is_there.then_some(what)).collect(),
            ..FileFacts::default()
        };
        Ok(MeshFile { facts, ..finish(assembly.whole, limits)? })
    }

    /// Appends an object with its components, which must be a tree.
    fn append(
        &self,
        assembly: &mut Assembly<'_>,
        key: Key,
        place: &Matrix4<f64>,
        depth: usize,
    ) -> Result<(), Located> {
        if depth > MAX_DEPTH {
            let what = format!(
                "object {} has components more than {MAX_DEPTH} deep, or is its own component",
                key.1
            );
            return Err(Fault::unsupported(what, "export it as a single mesh").whole());
        }
        let object = self.object(key)?;
        if object.is_support {
            return Ok(());
        }
        assembly.append(&object.mesh, place).in_part("object", key.1 as usize)?;
        object.components.iter().try_for_each(|component| {
            self.append(assembly, self.key(component, key.0), &(place * component.place), depth + 1)
        })
    }
}

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rel0" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// Writes a 3MF file with one object in millimeters, the default unit; coordinates read back bit for bit.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh, _: Field<'_>) -> io::Result<()> {
    let mut archive = ZipWriter::new(io::Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().large_file(mesh.n_vertices() + mesh.n_faces() > 1 << 24);
    for (name, content) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        archive.start_file(name, options)?;
        archive.write_all(content.as_bytes())?;
    }
    archive.start_file("3D/3dmodel.model", options)?;
    let mut text = io::BufWriter::with_capacity(1 << 16, &mut archive);
    write!(
        text,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model unit=\"millimeter\" xml:lang=\"en\" \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n\
         <resources><object id=\"1\" type=\"model\"><mesh>\n<vertices>\n"
    )?;
    for p in &mesh.positions {
        writeln!(text, r#"<vertex x="{:?}" y="{:?}" z="{:?}"/>"#, p.x, p.y, p.z)?;
    }
    write!(text, "</vertices>\n<triangles>\n")?;
    for [a, b, c] in &mesh.faces {
        writeln!(text, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?;
    }
    write!(
        text,
        "</triangles>\n</mesh></object></resources>\n<build><item objectid=\"1\"/></build>\n</model>\n"
    )?;
    text.flush()?;
    drop(text);
    out.write_all(archive.finish()?.get_ref())
}
