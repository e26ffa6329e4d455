//! Writing GLB.

use std::io::{self, Write};

use crate::field::WrittenField;
use crate::single::{origin, rounded};
use mesh::TriMesh;

/// Writes a GLB file with one mesh. Rounds coordinates to 32 bits; every vertex keeps its number. A mesh that would
/// collapse is moved to the origin, and its node back.
pub(crate) fn write(out: &mut dyn Write, mesh: &TriMesh, _: WrittenField<'_>) -> io::Result<()> {
    let (n_vertices, n_corners) = (mesh.n_vertices() as u64, 3 * mesh.n_faces() as u64);
    let (position_bytes, index_bytes) = (12 * n_vertices, 4 * n_corners);
    let data = position_bytes + index_bytes;
    // The format requires the bounds of the numbers as they are stored.
    let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    let origin = origin(mesh);
    let positions = || mesh.positions.iter().map(|p| rounded(p, &origin));
    for p in positions() {
        for axis in 0..3 {
            bounds[0][axis] = bounds[0][axis].min(p[axis]);
            bounds[1][axis] = bounds[1][axis].max(p[axis]);
        }
    }
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
    for x in positions().flatten() {
        out.write_all(&x.to_le_bytes())?;
    }
    mesh.faces.iter().flatten().try_for_each(|v| out.write_all(&v.0.to_le_bytes()))
}
