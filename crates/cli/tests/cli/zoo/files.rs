//! Files that are damaged, or that are not what their name says.

use super::file::{BrokenFile, ball, off};

/// A PLY file of one triangle whose header has other lines for vertices.
fn ply(vertices: &str, rows: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\n{vertices}element face 1\nproperty list uchar int vertex_indices\nend_header\n{rows}3 0 1 2\n"
    )
}

const XYZ: &str = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";

pub(super) fn damaged() -> Vec<BrokenFile> {
    let ball = String::from_utf8(off(&ball())).unwrap_or_default();
    let lines: Vec<&str> = ball.lines().collect();
    let first = |n: usize| lines[..n].join("\n") + "\n";
    let changed = |line: usize, text: &str| {
        let mut lines = lines.clone();
        lines[line] = text;
        lines.join("\n") + "\n"
    };
    let (vertex, face) = (2, 2 + 162);
    let mut stl = vec![0_u8; 80];
    stl.extend(320_u32.to_le_bytes());
    stl.extend([0; 50 * 3]);
    let ply_faces_first = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n\
        element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n";
    let text = |name, defect, content: String| BrokenFile { name, defect, content: content.into_bytes() };
    vec![
        text("empty.off", "no content", String::new()),
        text("blank.obj", "blank lines and comments only", "\n# nothing\n\n".into()),
        text("header.off", "ends after the keyword", "OFF\n".into()),
        text("points.off", "points without faces", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n".into()),
        text("cut-vertices.off", "ends among the vertices", first(100)),
        text("cut-faces.off", "ends among the faces", first(300)),
        text("leftover.off", "more faces than promised", ball.clone() + "3 0 1 2\n"),
        text("many-promised.off", "promises four billion vertices", changed(1, "4000000000 320 0")),
        text(
            "beyond-indices.off",
            "promises more vertices than 32 bits count",
            changed(1, "99999999999 320 0"),
        ),
        text("words.off", "a word in place of a coordinate", changed(vertex + 7, "0 here 0")),
        text("short-row.off", "a vertex of two coordinates", changed(vertex + 7, "0 1")),
        text("no-such-vertex.off", "a face with vertex 162 of 162", changed(face + 5, "3 0 1 162")),
        text("negative.off", "a face with a negative vertex", changed(face + 5, "3 0 1 -1")),
        text("two-corners.off", "a face of two corners", changed(face + 5, "2 0 1")),
        text("nan.off", "a coordinate that is not a number", changed(vertex + 7, "0 nan 0")),
        text("infinite.off", "an infinite coordinate", changed(vertex + 7, "0 inf 0")),
        text("binary.off", "binary OFF", "OFF BINARY\nxxxx".into()),
        text("four.off", "vertices of four dimensions", format!("4{ball}")),
        text("picture.off", "a picture with the extension of a mesh", "\u{89}PNG\r\n\u{1a}\n".into()),
        text(
            "zero.obj",
            "vertex 0 in a format that counts from 1",
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n".into(),
        ),
        text(
            "flat.ply",
            "vertices without z",
            ply(&XYZ.replace("property float z\n", ""), "0 0\n1 0\n0 1\n"),
        ),
        text("faces-first.ply", "faces before vertices", ply_faces_first.into()),
        text("no-header-end.ply", "a header without end", "ply\nformat ascii 1.0\nelement vertex 3\n".into()),
        text(
            "open.stl",
            "text that ends within a facet",
            "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n".into(),
        ),
        BrokenFile { name: "cut.stl", defect: "3 of 320 triangles", content: stl },
        text("garbage.mat", "text in place of MATLAB data", "these are no numbers".repeat(20)),
        text("alone.vert", "a .vert file without its .tri", "0 0 0\n1 0 0\n0 1 0\n".into()),
    ]
}
