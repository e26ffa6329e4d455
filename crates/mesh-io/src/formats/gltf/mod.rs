//! glTF 2.0 and its binary form GLB.
//!
//! **Vertices.** The nodes of the default scene (else the first) are visited in depth-first order, a node before its
//! children, children in their order. Each node with a mesh adds, for every primitive of triangles, strips or fans, the
//! vertices of its positions accessor in their order, whether a face uses them or not; primitives that share an accessor
//! share its vertices. A file without scenes has all nodes that are not children, a file without nodes all meshes.
//!
//! **Coordinates.** Transforms of nodes are applied in double precision. A mesh with a skin is in its bind pose, and the
//! transform of its node is ignored, as the standard demands. Where a transform mirrors, the corners of faces change
//! their order.

mod accessors;
mod container;
mod scene;
mod schema;
mod write;

use crate::facts::{FileFacts, LengthUnit, MeshFile};
use crate::limits::ReadLimits;
use crate::located::{At, Located};
use crate::polygons::finish;
use crate::text::excerpt;
use accessors::Accessors;
use container::{Buffers, Parts, split_binary};
use mesh::Fault;
use schema::Root;

pub(super) use container::{check_binary_start, check_start};
pub(super) use write::write;

/// Extensions that a file may require although this reader does not know them: they change no positions.
const HARMLESS: [&str; 11] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_node_",
    "KHR_animation_",
    "KHR_xmp",
    "EXT_texture_",
    "EXT_materials_",
    "EXT_lights_",
    "MSFT_texture_",
    "KHR_mesh_quantization",
];

/// Extensions that hide or multiply geometry, by the ends of their names, and what to do about each.
const REFUSED: [(&str, &str, &str); 3] = [
    (
        "KHR_draco_mesh_compression",
        "its meshes are compressed by Draco",
        "decompress them, for example with `gltf-transform copy in.glb out.glb`, or export without compression",
    ),
    (
        "_meshopt_compression",
        "its meshes are compressed by meshopt",
        "decompress them, for example with `gltf-transform copy in.glb out.glb`, or run gltfpack without -c",
    ),
    (
        "EXT_mesh_gpu_instancing",
        "it places copies of meshes by EXT_mesh_gpu_instancing",
        "export every copy as a node of its own",
    ),
];

/// Names of the other files that hold the data of a `.gltf` file.
pub(super) fn companions(json: &[u8]) -> Result<Vec<String>, Located> {
    container::companions(&parse_json(json, 0)?)
}

/// Names of the other files that hold the data of a `.glb` file.
pub(super) fn companions_of_binary(bytes: &[u8]) -> Result<Vec<String>, Located> {
    let (json, start, _) = split_binary(bytes)?;
    container::companions(&parse_json(json, start)?)
}

/// Reads a `.gltf` file, followed by its companions.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    read((files[0], 0, None), files, limits)
}

/// Reads a `.glb` file, followed by its companions.
pub(super) fn parse_binary(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    read(split_binary(files[0])?, files, limits)
}

/// Parses the description of the scene, which begins at byte `start` of the file.
fn parse_json(json: &[u8], start: usize) -> Result<Root, Located> {
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    if json.trim_ascii().is_empty() {
        return Err(Fault::Empty.whole());
    }
    serde_json::from_slice(json).map_err(|error| {
        let fault = Fault::syntax("the JSON of glTF 2.0", error.to_string());
        match start {
            0 => fault.in_line(error.line()),
            start => fault.at_byte(start),
        }
    })
}

fn read((json, start, chunk): Parts<'_>, files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let root = &parse_json(json, start)?;
    check_version(root)?;
    check_extensions(root)?;
    let buffers = Buffers::new(root, chunk, &files[1..])?;
    let n_bytes = files.iter().map(|file| file.len() as u64).sum();
    let (mesh, instances) = scene::read(&Accessors { root, buffers, n_bytes }, limits)?;
    let facts = FileFacts {
        unit: Some(LengthUnit::Meter),
        instances: Some(instances),
        ignored: scene::ignored(root),
        ..FileFacts::default()
    };
    Ok(MeshFile { facts, ..finish(mesh, limits)? })
}

fn check_version(root: &Root) -> Result<(), Located> {
    let version = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
    if version.split('.').next() != Some("2") {
        let what = format!("this is glTF {}", excerpt(version.as_bytes()));
        return Err(Fault::unsupported(what, "export it as glTF 2.0").whole());
    }
    Ok(())
}

fn check_extensions(root: &Root) -> Result<(), Located> {
    let used = root.extensions_required.iter().chain(&root.extensions_used);
    for (name, what, remedy) in REFUSED {
        // Compression that is not required has a fallback, which is read.
        let is_fatal = root.extensions_required.iter().any(|used| used.ends_with(name))
            || name == "EXT_mesh_gpu_instancing" && used.clone().any(|used| used == name);
        if is_fatal {
            return Err(Fault::unsupported(what, remedy).whole());
        }
    }
    let is_harmless = |name: &String| HARMLESS.iter().any(|prefix| name.starts_with(prefix));
    match root.extensions_required.iter().find(|name| !is_harmless(name)) {
        Some(name) => {
            let what =
                format!("it requires the extension {}, which is not supported", excerpt(name.as_bytes()));
            Err(Fault::unsupported(what, "export it without this extension").whole())
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests;
#[cfg(test)]
pub(super) use tests::samples;
