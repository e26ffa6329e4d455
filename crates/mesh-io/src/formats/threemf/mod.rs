//! 3MF, the 3D Manufacturing Format: a zip archive with models as XML.
//!
//! **Vertices.** The items of the build are visited in their order, and the components of an object in theirs. Each object
//! with a mesh adds its vertices in their order, whether a triangle uses them or not. An object that is placed three times
//! adds them three times. A file with an empty build has each object once that is not a component of another.
//!
//! **Coordinates.** The transforms of components and items are applied. The unit of length is reported, not converted.

mod model;
mod package;
mod write;

use std::collections::HashMap;

use crate::facts::{FileFacts, MeshFile};
use crate::limits::ReadLimits;
use crate::located::{At, Located};
use crate::polygons::{Placement, append_placed, check_copies, finish, placed_within};
use mesh::Fault;
use mesh::TriMesh;
use model::{Model, Object, Reference};
use package::{Package, canonical};

pub(super) use package::check_start;
pub(super) use write::write;

/// Components may be nested this deep.
const DEEPEST: usize = 64;

/// Reads a 3MF file.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let bytes = files[0];
    let mut package = Package::open(bytes)?;
    let mut file = Parts { models: Vec::new(), numbers: HashMap::new() };
    let root = package.root()?;
    file.numbers.insert(canonical(&root), 0);
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
    assemble(&file, bytes.len() as u64, limits)
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
}

/// Vertices, faces and meshes of an object with its components.
#[derive(Debug, Clone, Copy, Default)]
struct Size {
    vertices: u64,
    faces: u64,
    meshes: u64,
}

impl Size {
    fn add(&mut self, other: Self) {
        self.vertices = self.vertices.saturating_add(other.vertices);
        self.faces = self.faces.saturating_add(other.faces);
        self.meshes = self.meshes.saturating_add(other.meshes);
    }
}

fn assemble(file: &Parts, n_bytes: u64, limits: &ReadLimits) -> Result<MeshFile, Located> {
    let mut sizes = HashMap::new();
    let root = &file.models[0];
    let mut items: Vec<(Key, Placement)> =
        root.items.iter().map(|item| (file.key(item, 0), item.place)).collect();
    if items.is_empty() {
        let components = root.objects.iter().flat_map(|object| &object.components);
        let of_others: Vec<Key> = components.map(|component| file.key(component, 0)).collect();
        let tops = root.objects.iter().map(|object| (0, object.id));
        items = tops.filter(|key| !of_others.contains(key)).map(|key| (key, None)).collect();
    }
    let mut whole = Size::default();
    for (key, _) in &items {
        whole.add(measure(file, *key, 0, &mut sizes)?);
    }
    limits.check(whole.vertices, whole.faces).map_err(Fault::whole)?;
    if whole.meshes > 1 {
        check_copies(whole.vertices.saturating_add(whole.faces), n_bytes).map_err(Fault::whole)?;
    }
    let mut mesh = TriMesh {
        positions: Vec::with_capacity(whole.vertices as usize),
        faces: Vec::with_capacity(whole.faces as usize),
    };
    for (key, place) in items {
        append(&mut mesh, file, key, place, &sizes)?;
    }
    let has_supports = file.models.iter().flat_map(|model| &model.objects).any(|object| object.is_support);
    let has_beams = file.models.iter().any(|model| model.has_beams);
    let ignored = [(has_supports, "supports"), (has_beams, "beam lattices")];
    let facts = FileFacts {
        unit: Some(root.unit),
        instances: Some(whole.meshes as usize),
        ignored: ignored.into_iter().filter(|(is_there, _)| *is_there).map(|(_, what)| what).collect(),
        ..FileFacts::default()
    };
    Ok(MeshFile { facts, ..finish(mesh, limits)? })
}

/// The size of an object with its components, which must be a tree.
fn measure(file: &Parts, key: Key, depth: usize, known: &mut HashMap<Key, Size>) -> Result<Size, Located> {
    if let Some(size) = known.get(&key) {
        return Ok(*size);
    }
    if depth > DEEPEST {
        let what =
            format!("object {} has components more than {DEEPEST} deep, or is its own component", key.1);
        return Err(Fault::unsupported(what, "export it as a single mesh").whole());
    }
    let object = file.object(key)?;
    let mut size = Size::default();
    if !object.is_support {
        let (vertices, faces) = (object.mesh.n_vertices() as u64, object.mesh.n_faces() as u64);
        size = Size { vertices, faces, meshes: u64::from(vertices > 0) };
        for component in &object.components {
            size.add(measure(file, file.key(component, key.0), depth + 1, known)?);
        }
    }
    known.insert(key, size);
    Ok(size)
}

/// Appends an object with its components.
fn append(
    mesh: &mut TriMesh,
    file: &Parts,
    key: Key,
    place: Placement,
    sizes: &HashMap<Key, Size>,
) -> Result<(), Located> {
    // Without meshes, or as a support, there is nothing to visit, however many components there are.
    if sizes.get(&key).is_none_or(|size| size.meshes == 0) {
        return Ok(());
    }
    let object = file.object(key)?;
    append_placed(mesh, &object.mesh, place).map_err(|fault| fault.in_part("object", key.1 as usize))?;
    object.components.iter().try_for_each(|component| {
        append(mesh, file, file.key(component, key.0), placed_within(place, component.place), sizes)
    })
}

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(super) use tests::{model_of, package_of};
