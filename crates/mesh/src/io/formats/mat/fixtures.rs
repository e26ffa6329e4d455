//! A writer of MATLAB files.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::container::{COMPRESSED, HEADER, MATRIX};
use crate::tri_mesh::TriMesh;

/// How to write.
#[derive(Clone, Copy)]
pub(in crate::io::formats) struct Style {
    pub(in crate::io::formats) big_endian: bool,
    pub(in crate::io::formats) compressed: bool,
    /// Type of the numbers of TRIV as stored: 4 (u16), 5 (i32), 7 (f32) or 9 (f64).
    pub(in crate::io::formats) index_type: u32,
}

pub(in crate::io::formats) const PLAIN: Style = Style { big_endian: false, compressed: false, index_type: 9 };

impl Style {
    fn word(self, x: u32) -> [u8; 4] {
        if self.big_endian { x.to_be_bytes() } else { x.to_le_bytes() }
    }

    /// An element; short ones are stored in their tag, as MATLAB does.
    fn element(self, kind: u32, data: &[u8]) -> Vec<u8> {
        let mut out = Vec::new();
        if (1..=4).contains(&data.len()) && kind != MATRIX {
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

    pub(in crate::io::formats) fn matrix(
        self,
        name: &str,
        kind: u32,
        rows: usize,
        columns: usize,
        values: &[f64],
    ) -> Vec<u8> {
        let class = match kind {
            4 => 11,
            5 => 12,
            7 => 7,
            _ => 6,
        };
        let data = [self.head(class, rows, columns, name), self.numbers(kind, values)].concat();
        self.element(MATRIX, &data)
    }

    pub(in crate::io::formats) fn structure(self, name: &str, fields: &[(&str, Vec<u8>)]) -> Vec<u8> {
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
        self.element(MATRIX, &data)
    }

    pub(in crate::io::formats) fn file(self, variables: &[Vec<u8>]) -> Vec<u8> {
        let mut out = format!("{:124}", "MATLAB 5.0 MAT-file, a test").into_bytes();
        out.extend(if self.big_endian { *b"\x01\x00MI" } else { *b"\x00\x01IM" });
        assert_eq!(out.len(), HEADER);
        for variable in variables {
            if self.compressed {
                let mut zlib = ZlibEncoder::new(Vec::new(), Compression::default());
                zlib.write_all(variable).unwrap();
                let data = zlib.finish().unwrap();
                out.extend([self.word(COMPRESSED), self.word(data.len() as u32)].concat());
                out.extend(data);
            } else {
                out.extend(variable);
            }
        }
        out
    }

    /// The fields of a mesh.
    pub(in crate::io::formats) fn fields(self, mesh: &TriMesh) -> [(&'static str, Vec<u8>); 4] {
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
    pub(in crate::io::formats) fn surface(self, mesh: &TriMesh) -> Vec<u8> {
        let [x, y, z, triv] = self.fields(mesh);
        let extra = ("name", self.matrix("", 9, 2, 2, &[1.0, 2.0, 3.0, 4.0]));
        let other = self.matrix("other", 5, 1, 3, &[7.0, 8.0, 9.0]);
        self.file(&[other, self.structure("surface", &[triv, extra, x, y, z])])
    }
}
