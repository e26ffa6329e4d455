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

mod data;
mod scene;
mod schema;

use crate::polygons::Assembly;
use crate::prelude::*;
use crate::single::{origin, rounded};
use data::{Data, companions_of, open};
use schema::Root;

pub(super) use data::{check_binary_start, check_start};

/// Extensions that a file may require although this reader does not know them: they change no positions.
const HARMLESS: &str = "KHR_materials_ KHR_texture_ KHR_lights_ KHR_node_ KHR_animation_ KHR_xmp KHR_mesh_quantization \
    KHR_techniques_ KHR_technique_ EXT_texture_ EXT_materials_ EXT_lights_ MSFT_texture_";

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

/// Names of the other files that hold the data of a file.
pub(super) fn companions(bytes: &[u8]) -> Result<Vec<String>, Located> {
    companions_of(&open(bytes)?.0)
}

/// Reads a `.gltf` or `.glb` file, followed by its companions.
pub(super) fn parse(files: &[&[u8]], limits: &ReadLimits) -> Result<MeshFile, Located> {
    let (root, chunk) = &open(files[0])?;
    check_support(root).whole()?;
    let data = Data::new(root, *chunk, files)?;
    let Assembly { whole, instances, .. } = scene::read(&data, limits)?;
    let facts = FileFacts {
        unit: Some(LengthUnit::Meter),
        instances: Some(instances),
        ignored: scene::ignored(root),
        ..FileFacts::default()
    };
    Ok(MeshFile { facts, ..finish(whole, limits)? })
}

/// Refuses extensions without which positions would be wrong.
fn check_support(root: &Root) -> Result<(), Fault> {
    for (name, what, remedy) in REFUSED {
        // Compression that is not required has a fallback, which is read.
        let is_fatal = root.extensions_required.iter().any(|required| required.ends_with(name))
            || name == "EXT_mesh_gpu_instancing" && root.extensions_used.iter().any(|used| used == name);
        if is_fatal {
            return Err(Fault::unsupported(what, remedy));
        }
    }
    let is_harmless = |name: &&String| HARMLESS.split(' ').any(|prefix| name.starts_with(prefix));
    root.extensions_required.iter().find(|name| !is_harmless(name)).map_or(Ok(()), |name| {
        let what = format!("it requires the extension {}, which is not supported", excerpt(name.as_bytes()));
        Err(Fault::unsupported(what, "export it without this extension"))
    })
}

/// Writes a GLB file with one mesh. Rounds coordinates to 32 bits; every vertex keeps its number. A mesh that would
/// collapse is moved to the origin, and its node back.
pub(super) fn write(out: &mut dyn Write, mesh: &TriMesh, _: Field<'_>) -> io::Result<()> {
    let (n_vertices, n_corners) = (mesh.n_vertices() as u64, 3 * mesh.n_faces() as u64);
    let (position_bytes, index_bytes) = (12 * n_vertices, 4 * n_corners);
    let data = position_bytes + index_bytes;
    // The format requires the bounds of the numbers as they are stored.
    let origin = origin(mesh);
    // Rounding keeps the order of coordinates, so the bounds of rounded positions are those of all, rounded.
    let bounds = mesh.bounds().unwrap_or_default().map(|corner| rounded(&corner, &origin));
    let [x, y, z] = [origin.x, origin.y, origin.z];
    let place =
        if [x, y, z] == [0.0; 3] { String::new() } else { format!(r#","translation":[{x:?},{y:?},{z:?}]"#) };
    let [least, most] = bounds.map(|[x, y, z]| format!("[{x:?},{y:?},{z:?}]"));
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0","generator":"canonform"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0{place}}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":{n_vertices},"type":"VEC3","min":{least},"max":{most}}},{{"bufferView":1,"componentType":5125,"count":{n_corners},"type":"SCALAR"}}],"bufferViews":[{{"buffer":0,"byteLength":{position_bytes},"target":34962}},{{"buffer":0,"byteOffset":{position_bytes},"byteLength":{index_bytes},"target":34963}}],"buffers":[{{"byteLength":{data}}}]}}"#
    );
    while json.len() % 4 != 0 {
        json.push(' ');
    }
    let word = |n: u64| {
        let word = u32::try_from(n)
            .map_err(|_| io::Error::other("a GLB file is limited to 4 GiB; use another format"));
        word.map(u32::to_le_bytes)
    };
    out.write_all(b"glTF")?;
    out.write_all(&word(2)?)?;
    out.write_all(&word(12 + 8 + json.len() as u64 + 8 + data)?)?;
    out.write_all(&word(json.len() as u64)?)?;
    out.write_all(b"JSON")?;
    out.write_all(json.as_bytes())?;
    out.write_all(&word(data)?)?;
    out.write_all(b"BIN\0")?;
    for x in mesh.positions.iter().flat_map(|p| rounded(p, &origin)) {
        out.write_all(&x.to_le_bytes())?;
    }
    mesh.faces.iter().flatten().try_for_each(|v| out.write_all(&v.0.to_le_bytes()))
}
