//! A writer of MATLAB files, and the laws of the reader.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::{COMPRESSED, HEADER, MATRIX};
use crate::prelude::*;
use mesh::shapes;

/// How to write.
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

    pub(crate) fn matrix(
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
        self.element(MATRIX, &data)
    }

    pub(crate) fn file(self, variables: &[Vec<u8>]) -> Vec<u8> {
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

fn parse(bytes: &[u8]) -> Result<TriMesh, Located> {
    super::parse(&[bytes], &ReadLimits::default()).map(|file| file.mesh)
}

fn fault(bytes: &[u8]) -> Fault {
    parse(bytes).unwrap_err().fault
}

#[test]
fn surfaces_read_in_every_encoding() {
    let torus = shapes::torus(8, 5, 2.0, 0.5);
    for index_type in [4, 5, 7, 9] {
        for (big_endian, compressed) in [(false, false), (false, true), (true, false), (true, true)] {
            let style = Style { big_endian, compressed, index_type };
            assert_eq!(parse(&style.surface(&torus)).unwrap(), torus);
        }
    }
}

#[test]
fn coordinates_may_be_rows_or_columns() {
    let tetrahedron = shapes::tetrahedron(0);
    let mut fields = PLAIN.fields(&tetrahedron);
    let x: Vec<f64> = tetrahedron.positions.iter().map(|p| p.x).collect();
    fields[0].1 = PLAIN.matrix("", 9, 1, 4, &x);
    assert_eq!(parse(&PLAIN.file(&[PLAIN.structure("s", &fields)])).unwrap(), tetrahedron);
}

#[test]
fn files_without_a_surface_are_errors() {
    let other = PLAIN.file(&[PLAIN.matrix("other", 9, 1, 1, &[1.0])]);
    assert!(matches!(fault(&other), Fault::Unsupported { what, .. } if what.contains("variables: other")));
    let empty = PLAIN.file(&[]);
    assert!(matches!(fault(&empty), Fault::Unsupported { what, .. } if what.contains("variables: none")));
    assert!(matches!(fault(b"MATLAB 7.3 MAT-file"), Fault::Unsupported { .. }));
    assert!(matches!(fault(b"\x89HDF\r\n"), Fault::Unsupported { .. }));
    assert!(matches!(fault(&[7; 300]), Fault::WrongFormat { .. }));
    assert!(matches!(fault(b"OFF"), Fault::WrongFormat { .. }));
    assert_eq!(fault(b"  "), Fault::Empty);
}

#[test]
fn faults_in_the_fields_are_errors() {
    let mesh = shapes::tetrahedron(0);
    let with = |i: usize, matrix: Vec<u8>| {
        let mut fields = PLAIN.fields(&mesh);
        fields[i].1 = matrix;
        fault(&PLAIN.file(&[PLAIN.structure("surface", &fields)]))
    };
    let nan = with(1, PLAIN.matrix("", 9, 4, 1, &[0.0, 0.0, f64::NAN, 0.0]));
    assert!(matches!(nan, Fault::NonFinite { vertex: 3, .. }));
    assert!(matches!(with(1, PLAIN.matrix("", 9, 3, 1, &[0.0; 3])), Fault::Syntax { .. }));
    assert!(matches!(with(3, PLAIN.matrix("", 9, 3, 4, &[1.0; 12])), Fault::Syntax { .. }));
    let index = |index: &str| Fault::IndexOutOfRange { index: index.into(), first: 1, last: 4 };
    assert_eq!(with(3, PLAIN.matrix("", 9, 1, 3, &[1.0, 2.0, 5.0])), index("5"));
    assert_eq!(with(3, PLAIN.matrix("", 9, 1, 3, &[1.0, 2.0, 2.5])), index("2.5"));
    assert_eq!(with(3, PLAIN.matrix("", 9, 1, 3, &[1.0, 2.0, f64::NAN])), index("NaN"));
    assert_eq!(with(3, PLAIN.matrix("", 9, 0, 3, &[])), Fault::NoFaces { n_vertices: 4 });
    // A header that promises more numbers than the element holds.
    assert!(matches!(
        with(0, PLAIN.matrix("", 9, 1_000_000, 1_000_000, &[0.0; 4])),
        Fault::Truncated { promised: 1_000_000_000_000, found: 4, .. }
    ));
    assert!(matches!(with(0, PLAIN.structure("", &[])), Fault::Syntax { .. }));
}

#[test]
fn a_variable_longer_than_the_file_is_truncated() {
    let bytes = PLAIN.surface(&shapes::tetrahedron(0));
    let cut = parse(&bytes[..bytes.len() - 8]).unwrap_err();
    assert!(matches!(cut.fault, Fault::Truncated { .. }));
    assert!(matches!(cut.place, Place::Byte(byte) if byte > 128));
}

#[test]
fn decompression_bombs_are_cut_off() {
    let style = Style { compressed: true, ..PLAIN };
    // A column of 320 MB of zeros, declared as such, in a file of a few.
    let length = 320u32 << 20;
    let triangle = PLAIN.fields(&shapes::tetrahedron(0));
    let mut small = style.structure("surface", &triangle);
    let start =
        small.len() - [&triangle[1], &triangle[2], &triangle[3]].map(|f| f.1.len()).iter().sum::<usize>();
    let column = start - triangle[0].1.len();
    let head = 8 + 16 + 16 + 8;
    small[column + 32..column + 36].copy_from_slice(&(length / 8).to_le_bytes());
    small[column + head + 4..column + head + 8].copy_from_slice(&length.to_le_bytes());
    small.truncate(column + head + 8);
    small[4..8].copy_from_slice(&(length + 4096).to_le_bytes());
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    zlib.write_all(&small).unwrap();
    let zeros = vec![0; 1 << 20];
    (0..length >> 20).for_each(|_| zlib.write_all(&zeros).unwrap());
    let data = zlib.finish().unwrap();
    let mut bytes = PLAIN.file(&[]);
    bytes.extend([COMPRESSED.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat());
    bytes.extend(data);
    assert!(bytes.len() < 4 << 20);
    assert!(matches!(fault(&bytes), Fault::Inflates { .. }), "{:?}", fault(&bytes));
    let limited = super::parse(&[&bytes], &ReadLimits::of_vertices(1000)).unwrap_err();
    assert_eq!(limited.fault, Fault::OverLimit { items: "vertices", limit: 1000 });
}

#[test]
fn messages_list_few_variables() {
    let many: Vec<_> = (0..100).map(|i| PLAIN.matrix(&format!("{i:06000}"), 9, 1, 1, &[1.0])).collect();
    let message = fault(&PLAIN.file(&many)).to_string();
    assert!(message.contains("and 92 more") && message.len() < 1000, "{message}");
}
