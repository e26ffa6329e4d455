//! Files as programs write them, and what reading them gives.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use canonform_mesh_io::{FileSource, MeshFile, Opened, ReadLimits, read_file};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use mesh::{MeshError, TriMesh};

/// Files, the first of which is read.
pub(crate) type Files = Vec<(&'static str, Vec<u8>)>;

pub(crate) fn one(name: &'static str, content: impl AsRef<[u8]>) -> Files {
    vec![(name, content.as_ref().to_vec())]
}

/// A store of files in which names are paths.
struct Store<'a>(&'a [(&'static str, Vec<u8>)]);

impl FileSource for Store<'_> {
    fn holds(&self, path: &Path) -> bool {
        self.0.iter().any(|(name, _)| Path::new(name) == path)
    }

    fn open(&self, path: &Path) -> Result<Opened<'_>, MeshError> {
        let (_, content) = self.0.iter().find(|(name, _)| Path::new(name) == path).unwrap();
        Ok(Opened::of(content))
    }
}

pub(crate) fn read_all(
    files: &[(&'static str, Vec<u8>)],
    limits: &ReadLimits,
) -> Result<MeshFile, MeshError> {
    read_file(Path::new(files[0].0), &Store(files), limits)
}

/// What reading gives, in words: counts, area and what else the file says, then the corners of faces or the last point.
pub(crate) fn outcome(files: &Files) -> String {
    let MeshFile { mesh, facts, .. } = match read_all(files, &ReadLimits::default()) {
        Ok(file) => file,
        Err(fault) => return fault.to_string(),
    };
    let area = (mesh.area() * 1e6).round() / 1e6 + 0.0;
    let mut words = format!("{} vertices, {} faces, area {area}", mesh.n_vertices(), mesh.n_faces());
    facts.ignored.iter().for_each(|what| write!(words, ", ignored {what}").unwrap());
    facts.notes.iter().for_each(|what| write!(words, ", {what}").unwrap());
    match (&mesh.faces[..], mesh.positions.last()) {
        ([], Some(p)) => write!(words, ", to {} {} {}", p.x, p.y, p.z).unwrap(),
        _ => {
            let faces = mesh.faces.iter().map(|[a, b, c]| format!("{a} {b} {c}"));
            write!(words, "; {}", faces.collect::<Vec<_>>().join(", ")).unwrap();
        }
    }
    words
}

/// Checks a table: what a case shows, its files, and how the outcome begins.
pub(crate) fn check<S: AsRef<str>>(cases: impl IntoIterator<Item = (S, Files, S)>) {
    let wrong: Vec<String> = cases
        .into_iter()
        .map(|(what, files, expected)| (what, outcome(&files), expected))
        .filter(|(_, found, expected)| !found.starts_with(expected.as_ref()))
        .map(|(what, found, expected)| {
            format!("{}:\n  {found}\nis not\n  {}", what.as_ref(), expected.as_ref())
        })
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

pub(crate) const RECTANGLE: &str = "4 vertices, 2 faces, area 2";
pub(crate) const OBJ: &str = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n";
pub(crate) const OFF: &str = "OFF\n4 1 4\n0 0 0\n2 0 0\n2 1 0\n0 1 0\n4 0 1 2 3\n";
pub(crate) const VERT: &str = "0 0 0\n2 0 0\n2 1 0\n0 1 0\n";
pub(crate) const TRI: &str = "1 2 3\n1 3 4\n";
pub(crate) const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
    property float nx\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\n\
    property float quality\nend_header\n0 0 0 0 9\n2 0 0 0 9\n2 1 0 0 9\n0 1 0 0 9\n4 0 1 2 3 .5\n";
pub(crate) const STL: &str = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 2 1 0\nendloop\nendfacet\n\
    facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid x\n";

/// Binary PLY of the rectangle, with floats for coordinates and shorts for corners.
pub(crate) fn binary_ply(is_big: bool) -> Vec<u8> {
    let order = if is_big { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\nproperty list uchar short vertex_index\nend_header\n"
    )
    .into_bytes();
    for x in [0f32, 0., 0., 2., 0., 0., 2., 1., 0., 0., 1., 0.] {
        bytes.extend(if is_big { x.to_be_bytes() } else { x.to_le_bytes() });
    }
    bytes.push(4);
    (0..4i16).for_each(|v| bytes.extend(if is_big { v.to_be_bytes() } else { v.to_le_bytes() }));
    bytes
}

/// Binary STL of the rectangle with another header, a count and bytes at the end.
pub(crate) fn binary_stl(header: &[u8], count: u32, end: &[u8]) -> Files {
    let corners = [[0f32, 0., 0.], [2., 0., 0.], [2., 1., 0.], [0., 1., 0.]];
    let mut bytes = vec![b' '; 80];
    bytes[..header.len()].copy_from_slice(header);
    bytes.extend(count.to_le_bytes());
    for face in [[0, 1, 2], [0, 2, 3]] {
        bytes.extend([0; 12]);
        bytes.extend(face.iter().flat_map(|v| corners[*v]).flat_map(f32::to_le_bytes));
        bytes.extend([0; 2]);
    }
    bytes.extend(end);
    one("m.stl", bytes)
}

/// What the writer of GLB writes, as text with a data URI.
pub(crate) fn gltf_text(mesh: &TriMesh) -> String {
    let glb = testkit::written("m.glb", mesh);
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let (json, data) = (std::str::from_utf8(&glb[20..20 + length]).unwrap().trim_end(), &glb[28 + length..]);
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(data));
    json.replace(r#""buffers":[{"#, &format!(r#""buffers":[{{"uri":"{uri}","#))
}

/// A file in which positions are a unit square, stored in several ways.
pub(crate) struct Rich {
    pub(crate) data: Vec<u8>,
}

pub(crate) const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];

impl Rich {
    pub(crate) fn new() -> Self {
        let mut data = Vec::new();
        // 0: four vertices, 16 bytes each.
        for p in SQUARE {
            p.iter().for_each(|x| data.extend(x.to_le_bytes()));
            data.extend([7; 4]);
        }
        // 64: a strip; 72: a fan; 80: two triangles as bytes.
        [0u16, 1, 2, 3].iter().for_each(|v| data.extend(v.to_le_bytes()));
        [0u16, 1, 3, 2].iter().for_each(|v| data.extend(v.to_le_bytes()));
        data.extend([0u8, 1, 2, 2, 1, 3, 0, 0]);
        // 88: the sparse vertex 3 moves up; 96: its position.
        data.extend([3u8, 0, 0, 0, 0, 0, 0, 0]);
        [1.0f32, 1.0, 5.0].iter().for_each(|x| data.extend(x.to_le_bytes()));
        // 108: the square as normalized 16-bit integers, 8 bytes a row.
        for p in SQUARE {
            p.iter().for_each(|x| data.extend(((x * 32767.0) as i16).to_le_bytes()));
            data.extend([0; 2]);
        }
        Self { data }
    }

    pub(crate) fn json(&self, uri: &str) -> String {
        let length = self.data.len();
        format!(
            r#"{{"asset":{{"version":"2.0"}},"extensionsUsed":["KHR_mesh_quantization"],
"extensionsRequired":["KHR_mesh_quantization"],
"buffers":[{{"uri":"{uri}","byteLength":{length}}}],
"bufferViews":[{{"buffer":0,"byteLength":64,"byteStride":16}},{{"buffer":0,"byteOffset":64,"byteLength":24}},
{{"buffer":0,"byteOffset":88,"byteLength":20}},{{"buffer":0,"byteOffset":108,"byteLength":32,"byteStride":8}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
{{"bufferView":1,"componentType":5123,"count":4,"type":"SCALAR"}},
{{"bufferView":1,"byteOffset":8,"componentType":5123,"count":4,"type":"SCALAR"}},
{{"bufferView":1,"byteOffset":16,"componentType":5121,"count":6,"type":"SCALAR"}},
{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":1,
"indices":{{"bufferView":2,"componentType":5121}},"values":{{"bufferView":2,"byteOffset":8}}}},"min":[0,0,0],"max":[1,1,5]}},
{{"bufferView":3,"componentType":5122,"normalized":true,"count":4,"type":"VEC3","min":[0,0,0],"max":[32767,32767,0]}}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":5}},
{{"attributes":{{"POSITION":0}},"indices":2,"mode":6}}]}},
{{"primitives":[{{"attributes":{{"POSITION":4}},"indices":3}},{{"attributes":{{"POSITION":0}},"mode":0}}]}},
{{"primitives":[{{"attributes":{{"POSITION":5}},"indices":3}}]}}],
"nodes":[{{"mesh":0,"children":[1,2]}},{{"mesh":1,"translation":[10,0,0]}},
{{"children":[3],"matrix":[2,0,0,0,0,2,0,0,0,0,2,0,0,20,0,1]}},{{"mesh":2,"scale":[-1,1,1]}},{{"mesh":0}}],
"scenes":[{{"nodes":[4]}},{{"nodes":[0]}}],"scene":1}}"#
        )
    }
}

/// A 3MF file with this model in the usual place.
pub(crate) fn package_of(model: &[u8]) -> Vec<u8> {
    testkit::zip_of(&[("3D/3dmodel.model", model)])
}

pub(crate) fn mesh_text(mesh: &TriMesh) -> String {
    let vertices =
        mesh.positions.iter().map(|p| format!("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", p.x, p.y, p.z));
    let triangles = mesh
        .faces
        .iter()
        .map(|[a, b, c]| format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" pid=\"9\"/>\n"));
    format!(
        "<mesh><vertices>\n{}</vertices><triangles>\n{}</triangles></mesh>",
        vertices.collect::<String>(),
        triangles.collect::<String>()
    )
}

pub(crate) const HEAD: &str = "<?xml version=\"1.0\"?>\n<model unit=\"inch\" requiredextensions=\"p\" \
    xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
    xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\">";

/// A model with an object, a component and a moved item, which add up to the mesh.
pub(crate) fn model_of(mesh: &TriMesh) -> String {
    format!(
        "{HEAD}<resources><object id=\"1\">{}</object><object id=\"2\"><components><component objectid=\"1\" \
         transform=\"1 0 0 0 1 0 0 0 1 0 0 1\"/></components></object></resources>\
         <build><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 2 0 0\"/></build></model>",
        mesh_text(mesh)
    )
}

/// How to write a MATLAB file.
#[derive(Clone, Copy)]
pub(crate) struct Style {
    pub(crate) big_endian: bool,
    pub(crate) compressed: bool,
    /// Type of the numbers of TRIV as stored: 4 (u16), 5 (i32), 7 (f32) or 9 (f64).
    pub(crate) index_type: u32,
}

pub(crate) const PLAIN: Style = Style { big_endian: false, compressed: false, index_type: 9 };

impl Style {
    fn word(self, x: u32) -> [u8; 4] {
        if self.big_endian { x.to_be_bytes() } else { x.to_le_bytes() }
    }

    /// An element; short ones are stored in their tag, as MATLAB does.
    fn element(self, kind: u32, data: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        if (1..=4).contains(&data.len()) && kind != 14 {
            out.extend(self.word((data.len() as u32) << 16 | kind));
            out.extend(data);
        } else {
            out.extend([self.word(kind), self.word(data.len() as u32)].concat());
            out.extend(data);
        }
        out.resize(out.len().next_multiple_of(8), 0);
        out
    }

    fn numbers(self, kind: u32, values: &[f64]) -> Vec<u8> {
        let bytes = |x: f64| -> Vec<u8> {
            let big = match kind {
                4 => (x as u16).to_be_bytes().to_vec(),
                5 => (x as i32).to_be_bytes().to_vec(),
                7 => (x as f32).to_be_bytes().to_vec(),
                _ => x.to_be_bytes().to_vec(),
            };
            if self.big_endian { big } else { big.into_iter().rev().collect() }
        };
        self.element(kind, &values.iter().flat_map(|&x| bytes(x)).collect::<Vec<u8>>())
    }

    fn head(self, class: u32, rows: usize, columns: usize, name: &str) -> Vec<u8> {
        let dimensions = [self.word(rows as u32), self.word(columns as u32)].concat();
        [
            self.element(6, &[self.word(class), self.word(0)].concat()),
            self.element(5, &dimensions),
            self.element(1, name.as_bytes()),
        ]
        .concat()
    }

    pub(crate) fn matrix(
        self,
        name: &str,
        kind: u32,
        rows: usize,
        columns: usize,
        values: &[f64],
    ) -> Vec<u8> {
        // A matrix of doubles, whose numbers may be stored as any type.
        let data = [self.head(6, rows, columns, name), self.numbers(kind, values)].concat();
        self.element(14, &data)
    }

    pub(crate) fn structure(self, name: &str, fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
        const NAME_LENGTH: usize = 8;
        let mut names = Vec::new();
        for (field, _) in fields {
            names.extend(field.bytes());
            names.resize(names.len().next_multiple_of(NAME_LENGTH), 0);
        }
        let mut data = self.head(2, 1, 1, name);
        data.extend(self.element(5, &self.word(NAME_LENGTH as u32)));
        data.extend(self.element(1, &names));
        fields.iter().for_each(|(_, matrix)| data.extend(matrix));
        self.element(14, &data)
    }

    pub(crate) fn file(self, variables: &[Vec<u8>]) -> Vec<u8> {
        let mut out = format!("{:124}", "MATLAB 5.0 MAT-file, a test").into_bytes();
        out.extend(if self.big_endian { *b"\x01\x00MI" } else { *b"\x00\x01IM" });
        assert_eq!(out.len(), 128);
        for variable in variables {
            if self.compressed {
                let mut zlib = ZlibEncoder::new(Vec::new(), Compression::default());
                zlib.write_all(variable).unwrap();
                let data = zlib.finish().unwrap();
                out.extend([self.word(15), self.word(data.len() as u32)].concat());
                out.extend(data);
            } else {
                out.extend(variable);
            }
        }
        out
    }

    /// The fields of a mesh.
    pub(crate) fn fields(self, mesh: &TriMesh) -> [(&'static str, Vec<u8>); 4] {
        let n = mesh.n_vertices();
        let column = |axis: usize| {
            let values: Vec<f64> = mesh.positions.iter().map(|p| p[axis]).collect();
            self.matrix("", 9, n, 1, &values)
        };
        let slots = (0..3).flat_map(|slot| mesh.faces.iter().map(move |f| f64::from(f[slot].0) + 1.0));
        let triv = self.matrix("", self.index_type, mesh.n_faces(), 3, &slots.collect::<Vec<f64>>());
        [("X", column(0)), ("Y", column(1)), ("Z", column(2)), ("TRIV", triv)]
    }

    /// A file with a mesh, preceded by another variable and with another field.
    pub(crate) fn surface(self, mesh: &TriMesh) -> Vec<u8> {
        let [x, y, z, triv] = self.fields(mesh);
        let extra = ("name", self.matrix("", 9, 2, 2, &[1.0, 2.0, 3.0, 4.0]));
        let other = self.matrix("other", 5, 1, 3, &[7.0, 8.0, 9.0]);
        self.file(&[other, self.structure("surface", &[triv, extra, x, y, z])])
    }
}
