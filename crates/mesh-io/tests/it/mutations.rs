//! Every reader on damaged files: cut at every byte, with bytes changed, and on noise. The result is an error
//! or a mesh that keeps the invariants; never a panic, never a hang.

use std::path::Path;
use std::sync::LazyLock;

use base::SplitMix;
use canonform_mesh_io::{FORMATS, Format, ReadLimits};
use mesh::{MIN_POINTS, MeshError, TriMesh, shapes};
use proptest::prelude::*;
use testkit::written;

use crate::made::{
    Files, PLAIN, PLY, Rich, STL, Style, TRI, VERT, gltf_text, model_of, package_of, read_all,
};

/// Makes a file of bytes.
type Wrap = fn(&[u8]) -> Vec<u8>;

/// The valid files of a mesh, one of which is to be damaged.
struct Sample {
    name: String,
    files: Files,
    damaged: usize,
    /// Makes the file of the damaged bytes, where checksums would reveal any damage.
    wrap: Option<Wrap>,
}

static SAMPLES: LazyLock<Vec<Sample>> = LazyLock::new(samples);

/// A sample of each file of each format that can be written, and of what the writers do not write.
fn samples() -> Vec<Sample> {
    let mesh = shapes::icosphere(0);
    let sample = |name: &str, files, damaged| Sample { name: name.into(), files, damaged, wrap: None };
    let mut samples: Vec<Sample> = ["m.off", "m.obj", "m.ply", "m.stl", "m.glb", "m.3mf"]
        .map(|name| sample(&name[2..], vec![(name, written(name, &mesh))], 0))
        .into();
    let pair = vec![("m.vert", VERT.into()), ("m.tri", TRI.into())];
    samples.extend([("vert", 0), ("tri", 1)].map(|(name, damaged)| sample(name, pair.clone(), damaged)));
    let zipped = Style { compressed: true, big_endian: true, index_type: 4 };
    let groups = b"o a\nv 0 0 0\nv 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 2\nvt 0 0\nvn 0 0 1\n\
        g b\nf 1/1/1 2/1/1 3/1/1 4/1/1\nusemtl c\nf -1//1 -2//1 -3//1\ng\nf 1 2 3 4 -1\n";
    let rows: String = mesh.positions.iter().map(|p| format!("{} {}, {} 7\n", p.x, p.y, p.z)).collect();
    for (name, file, bytes) in [
        ("obj groups", "m.obj", groups.to_vec()),
        ("ply ascii", "m.ply", PLY.into()),
        ("stl ascii", "m.stl", STL.into()),
        ("mat", "m.mat", PLAIN.surface(&mesh)),
        ("mat zipped", "m.mat", zipped.surface(&mesh)),
        ("gltf", "m.gltf", gltf_text(&mesh).into_bytes()),
        ("xyz", "m.xyz", format!("// x y z\n{rows}").into_bytes()),
        ("pts", "m.pts", format!("12\n{rows}").into_bytes()),
    ] {
        samples.push(sample(name, vec![(file, bytes)], 0));
    }
    let rich = Rich::new();
    let scene = vec![("m.gltf", rich.json("data.bin").into_bytes()), ("data.bin", rich.data)];
    samples.push(sample("gltf rich", scene.clone(), 0));
    samples.push(sample("gltf data", scene, 1));
    let model = sample("3mf model", vec![("m.3mf", model_of(&mesh).into_bytes())], 0);
    samples.push(Sample { wrap: Some(package_of), ..model });
    samples
}

impl Sample {
    fn bytes(&self) -> &[u8] {
        &self.files[self.damaged].1
    }

    fn parse(&self, bytes: &[u8], limits: &ReadLimits) -> Result<TriMesh, MeshError> {
        let mut files = self.files.clone();
        files[self.damaged].1 = self.wrap.map_or_else(|| bytes.to_vec(), |wrap| wrap(bytes));
        read_all(&files, limits).map(|file| file.mesh)
    }
}

#[test]
fn every_format_has_a_sample() {
    for format in &FORMATS {
        let is_of = |sample: &Sample| std::ptr::eq(Format::of(Path::new(sample.files[0].0)).unwrap(), format);
        assert!(SAMPLES.iter().any(is_of), "{}", format.name);
    }
}

/// Parses and, if that succeeds, checks what readers promise.
fn check(sample: &Sample, bytes: &[u8]) -> Option<TriMesh> {
    let mesh = sample.parse(bytes, &ReadLimits::default()).ok()?;
    let n = mesh.n_vertices();
    assert!(mesh.n_faces() > 0 || n >= MIN_POINTS, "{}", sample.name);
    assert!(mesh.faces.iter().flatten().all(|v| v.index() < n), "{}", sample.name);
    assert!(mesh.positions.iter().all(|p| p.iter().all(|x| x.is_finite())), "{}", sample.name);
    Some(mesh)
}

#[test]
fn meshes_beyond_the_limits_are_errors_in_every_format() {
    for sample in &*SAMPLES {
        let read = |max_vertices, max_faces| {
            sample.parse(sample.bytes(), &ReadLimits { max_vertices, max_faces, ..ReadLimits::default() })
        };
        let whole = check(sample, sample.bytes()).unwrap();
        let [n_vertices, n_faces] = [whole.n_vertices(), whole.n_faces()].map(|n| n as u64);
        assert!(read(n_vertices, n_faces).is_ok(), "{}", sample.name);
        let is_over = |read: Result<TriMesh, MeshError>, limit: u64, items: &str| {
            let (fault, name) = (read.unwrap_err().to_string(), &sample.name);
            let expected = format!("the mesh exceeds the limit of {limit} {items}");
            assert!(fault.contains(&expected), "{name}: {fault}");
        };
        is_over(read(n_vertices - 1, n_faces), n_vertices - 1, "vertices");
        if n_faces > 0 {
            is_over(read(n_vertices, n_faces - 1), n_faces - 1, "faces");
        }
    }
}

#[test]
fn files_cut_at_every_byte() {
    for sample in &*SAMPLES {
        let whole = check(sample, sample.bytes()).expect(&sample.name);
        for length in 0..sample.bytes().len() {
            let cut = check(sample, &sample.bytes()[..length]);
            // Most formats state their size. The others cannot notice a cut at the end of a line.
            let states_size = !sample.name.starts_with("obj") && sample.name != "tri";
            if let Some(mesh) = cut.filter(|_| states_size) {
                assert_eq!(mesh.faces.len(), whole.faces.len(), "{} cut to {length}", sample.name);
            }
        }
    }
}

#[test]
fn files_with_every_byte_changed() {
    for sample in &*SAMPLES {
        let mut bytes = sample.bytes().to_vec();
        for at in 0..bytes.len() {
            for change in [1u8, 0x80, bytes[at] ^ b' ', bytes[at] ^ b'9'] {
                bytes[at] ^= change;
                check(sample, &bytes);
                bytes[at] = sample.bytes()[at];
            }
        }
    }
}

#[test]
fn a_thousand_mutations_of_every_sample() {
    assert_mutations(1000);
}

#[test]
#[ignore = "slow: make test-all"]
fn ten_thousand_mutations_of_every_sample() {
    assert_mutations(10_000);
}

fn assert_mutations(n: usize) {
    for sample in &*SAMPLES {
        let mut random = SplitMix(7);
        let mut below = |n: usize| (random.bits() % n.max(1) as u64) as usize;
        let mut intact = 0;
        for _ in 0..n {
            let mut bytes = sample.bytes().to_vec();
            for _ in 0..=below(3) {
                let at = below(bytes.len());
                match below(6) {
                    0 => bytes[at] ^= 1 << below(8),
                    1 => bytes[at] = below(256) as u8,
                    2 => bytes.truncate(at.max(1)),
                    3 => {
                        let to = below(bytes.len());
                        bytes.swap(at, to);
                    }
                    4 => {
                        let end = (at + 1 + below(200)).min(bytes.len());
                        bytes.drain(at.max(1).min(end)..end);
                    }
                    _ => {
                        let piece: Vec<u8> = bytes[at..].iter().take(below(200)).copied().collect();
                        let to = below(bytes.len());
                        bytes.splice(to..to, piece);
                    }
                }
            }
            intact += usize::from(check(sample, &bytes).is_some());
        }
        println!("{}: {n} mutations, {intact} of them still a mesh, no panic", sample.name);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn noise_after_any_beginning(
        keep in any::<prop::sample::Index>(),
        noise in prop::collection::vec(any::<u8>(), 0..400),
        words in prop::collection::vec("[-+0-9.eE/#vfnoply]{1,12}|v|f|OFF|ply|solid|facet|nan|\n", 0..120),
    ) {
        for sample in &*SAMPLES {
            let bytes = [&sample.bytes()[..keep.index(sample.bytes().len())], &noise].concat();
            check(sample, &bytes);
            check(sample, &noise);
            check(sample, words.join(" ").as_bytes());
        }
    }
}
