//! Every parser on damaged files: cut at every byte, with bytes changed, and on noise. Whatever comes,
//! there is an error or a mesh that keeps the invariants; never a panic, never a hang.

use proptest::prelude::*;

use crate::error::{Fault, Located};
use crate::{TriMesh, shapes};
use surface::VertexId;

use super::mat::sample::{PLAIN, Style};
use super::{ReadLimits, mat, obj, off, ply, stl, tosca};

/// A parser with a valid file for it.
struct Sample {
    name: &'static str,
    parse: fn(&[u8], &ReadLimits) -> Result<TriMesh, Located>,
    bytes: Vec<u8>,
}

fn parse_vert(bytes: &[u8], limits: &ReadLimits) -> Result<TriMesh, Located> {
    let positions = tosca::parse_positions(bytes, limits)?;
    Ok(TriMesh { positions, faces: vec![[VertexId(0); 3]] })
}

fn parse_tri(bytes: &[u8], limits: &ReadLimits) -> Result<TriMesh, Located> {
    let faces = tosca::parse_faces(bytes, 12, limits)?;
    Ok(TriMesh { positions: vec![nalgebra::Point3::origin(); 12], faces })
}

fn samples() -> Vec<Sample> {
    let mesh = shapes::icosphere(0);
    let written = |write: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = Vec::new();
        write(&mut bytes);
        bytes
    };
    let ascii_ply = format!(
        "ply\nformat ascii 1.0\nelement vertex 12\nproperty double x\nproperty double y\nproperty double z\n\
         element edge 1\nproperty list uchar int ends\nelement face 20\n\
         property list uchar int vertex_indices\nend_header\n{}2 0 1\n{}",
        mesh.positions.iter().map(|p| format!("{} {} {}\n", p.x, p.y, p.z)).collect::<String>(),
        mesh.faces.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n")).collect::<String>(),
    );
    let facet = |f: usize| {
        let corners = mesh.triangle(f).map(|p| format!("vertex {} {} {}\n", p.x, p.y, p.z)).concat();
        format!("facet normal 0 0 1\nouter loop\n{corners}endloop\nendfacet\n")
    };
    let ascii_stl = format!("solid s\n{}endsolid s\n", (0..4).map(facet).collect::<String>());
    let binary_stl = written(&|out| stl::write(out, &stl::triangles(&mesh).unwrap()).unwrap());
    let zipped = Style { compressed: true, big_endian: true, index_type: 4 };
    let parse_stl = |bytes: &[u8], limits: &ReadLimits| stl::parse(bytes.to_vec(), limits);
    let sample = |name, parse, bytes| Sample { name, parse, bytes };
    vec![
        sample("off", off::parse, written(&|out| off::write(out, &mesh).unwrap())),
        sample("obj", obj::parse, written(&|out| obj::write(out, &mesh).unwrap())),
        sample(
            "obj groups",
            obj::parse,
            b"o a\nv 0 0 0\nv 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 2\nvt 0 0\nvn 0 0 1\n\
            g b\nf 1/1/1 2/1/1 3/1/1 4/1/1\nusemtl c\nf -1//1 -2//1 -3//1\ng\nf 1 2 3 4 -1\n"
                .to_vec(),
        ),
        sample("ply binary", ply::parse, written(&|out| ply::write(out, &mesh).unwrap())),
        sample("ply ascii", ply::parse, ascii_ply.into_bytes()),
        sample("stl binary", parse_stl, binary_stl),
        sample("stl ascii", parse_stl, ascii_stl.into_bytes()),
        sample("vert", parse_vert, written(&|out| tosca::write_positions(out, &mesh).unwrap())),
        sample("tri", parse_tri, written(&|out| tosca::write_faces(out, &mesh).unwrap())),
        sample("mat", mat::parse, PLAIN.surface(&mesh)),
        sample("mat zipped", mat::parse, zipped.surface(&mesh)),
    ]
}

/// Parses and, where that succeeds, holds the mesh to what readers promise.
fn check(sample: &Sample, bytes: &[u8]) -> Option<TriMesh> {
    let mesh = (sample.parse)(bytes, &ReadLimits::default()).ok()?;
    let n = mesh.n_vertices();
    assert!(mesh.n_faces() > 0, "{}", sample.name);
    assert!(mesh.faces.iter().flatten().all(|v| v.index() < n), "{}", sample.name);
    assert!(mesh.positions.iter().all(|p| p.iter().all(|x| x.is_finite())), "{}", sample.name);
    Some(mesh)
}

#[test]
fn meshes_beyond_the_limits_are_refused_in_every_format() {
    for sample in samples().into_iter().filter(|sample| !["obj groups", "stl ascii"].contains(&sample.name)) {
        let read = |max_vertices, max_faces| {
            let limits = ReadLimits { max_vertices, max_faces };
            (sample.parse)(&sample.bytes, &limits).map_err(|located| located.fault)
        };
        assert!(read(12, 20).is_ok(), "{}", sample.name);
        for (limits, items) in [((11, 20), "vertices"), ((12, 19), "faces")] {
            let half = ["vert", "tri"].iter().position(|half| *half == sample.name);
            if half.is_none() || (half == Some(0)) == (items == "vertices") {
                let limit = if items == "vertices" { limits.0 } else { limits.1 };
                assert_eq!(
                    read(limits.0, limits.1),
                    Err(Fault::OverLimit { items, limit }),
                    "{}",
                    sample.name
                );
            }
        }
    }
}

#[test]
fn files_cut_at_every_byte() {
    for sample in samples() {
        let whole = check(&sample, &sample.bytes).expect(sample.name);
        for length in 0..sample.bytes.len() {
            let cut = check(&sample, &sample.bytes[..length]);
            // Formats that state their size notice a missing vertex or face; in the others a cut at
            // the end of a line leaves a shorter file.
            let states_size = ["off", "ply", "stl", "mat"].iter().any(|f| sample.name.starts_with(f));
            if let Some(mesh) = cut.filter(|_| states_size) {
                assert_eq!(mesh.faces.len(), whole.faces.len(), "{} cut to {length}", sample.name);
            }
        }
    }
}

#[test]
fn files_with_every_byte_changed() {
    for sample in samples() {
        let mut bytes = sample.bytes.clone();
        for at in 0..bytes.len() {
            for change in [1u8, 0x80, 0xff, bytes[at] ^ b' ', bytes[at] ^ b'9'] {
                bytes[at] ^= change;
                check(&sample, &bytes);
                bytes[at] = sample.bytes[at];
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn files_with_many_bytes_changed(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..40),
    ) {
        for sample in samples() {
            let mut bytes = sample.bytes.clone();
            for (at, value) in &changes {
                let at = at.index(bytes.len());
                bytes[at] = *value;
            }
            check(&sample, &bytes);
        }
    }

    #[test]
    fn files_with_a_stretch_removed_doubled_or_moved(
        from in any::<prop::sample::Index>(), to in any::<prop::sample::Index>(), length in 0usize..200,
    ) {
        for sample in samples() {
            let (from, to) = (from.index(sample.bytes.len()), to.index(sample.bytes.len()));
            let piece = sample.bytes[from..].iter().take(length).copied().collect::<Vec<u8>>();
            let mut removed = sample.bytes.clone();
            removed.drain(from..from + piece.len());
            check(&sample, &removed);
            let at = to.min(removed.len());
            removed.splice(at..at, piece.iter().copied());
            check(&sample, &removed);
            let mut doubled = sample.bytes.clone();
            doubled.splice(to..to, piece);
            check(&sample, &doubled);
        }
    }

    #[test]
    fn noise_after_any_beginning(
        keep in any::<prop::sample::Index>(), noise in prop::collection::vec(any::<u8>(), 0..400),
    ) {
        for sample in samples() {
            let bytes = [&sample.bytes[..keep.index(sample.bytes.len())], &noise].concat();
            check(&sample, &bytes);
            check(&sample, &noise);
        }
    }

    #[test]
    fn text_noise(words in prop::collection::vec("[-+0-9.eE/#vfnoply]{1,12}|v|f|OFF|ply|solid|facet|nan|\n", 0..120)) {
        for sample in samples() {
            check(&sample, words.join(" ").as_bytes());
        }
    }
}
