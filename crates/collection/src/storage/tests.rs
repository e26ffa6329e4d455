//! Archives, compressed files and lists as datasets.

use std::fs;
use std::io::{Seek, Write};

use ::parquet::data_type::{ByteArray, ByteArrayType};
use ::parquet::file::properties::WriterProperties;
use ::parquet::file::writer::SerializedFileWriter;
use ::parquet::schema::parser::parse_message_type;
use mesh::shapes;
use rayon::prelude::*;
use tempfile::TempDir;
use testkit::{gzip_of, tar_of, written, zip_of};

use super::*;
use crate::{Dataset, SkipKind, content_hash, count_skipped, list_shapes};

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// Writes a file into a folder.
fn put(place: &TempDir, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = place.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, bytes).unwrap();
    path
}

/// Two classes of meshes, with other files between them.
fn contents() -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("all/cat/cat10.off", written("m.off", &shapes::icosphere(1))),
        ("all/cat/cat9.ply.gz", written("m.ply.gz", &shapes::icosphere(2))),
        ("all/dog/dog0.glb", written("m.glb", &shapes::cube(1))),
        ("all/dog/dog1.vert", written("m.vert", &shapes::cube(2))),
        ("all/README.md", b"meshes".to_vec()),
    ]
}

/// The other half of the pair in [`contents`].
fn other_half() -> (&'static str, Vec<u8>) {
    let folder = folder();
    let path = folder.path().join("m.vert");
    mesh_io::write(&path, &shapes::cube(2)).unwrap();
    ("all/dog/dog1.tri", fs::read(path.with_extension("tri")).unwrap())
}

/// Rows of id, label, format and bytes.
type Rows<'a> = &'a [(&'a str, Option<&'a str>, &'a str, Vec<u8>)];

fn parquet_of(rows: Rows<'_>) -> Vec<u8> {
    let schema = "message meshes { REQUIRED BYTE_ARRAY id (UTF8); OPTIONAL BYTE_ARRAY label (UTF8);
        REQUIRED BYTE_ARRAY format (UTF8); REQUIRED BYTE_ARRAY bytes; }";
    let schema = parse_message_type(schema).unwrap().into();
    let mut out = Vec::new();
    let properties =
        WriterProperties::builder().set_compression(::parquet::basic::Compression::SNAPPY).build();
    let mut writer = SerializedFileWriter::new(&mut out, schema, properties.into()).unwrap();
    for rows in rows.chunks(3) {
        let mut group = writer.next_row_group().unwrap();
        let levels: Vec<i16> = rows.iter().map(|row| i16::from(row.1.is_some())).collect();
        let columns: [Vec<ByteArray>; 4] = [
            rows.iter().map(|row| row.0.into()).collect(),
            rows.iter().filter_map(|row| Some(row.1?.into())).collect(),
            rows.iter().map(|row| row.2.into()).collect(),
            rows.iter().map(|row| row.3.clone().into()).collect(),
        ];
        for (number, values) in columns.iter().enumerate() {
            let mut column = group.next_column().unwrap().unwrap();
            let levels = (number == 1).then_some(&levels[..]);
            column.typed::<ByteArrayType>().write_batch(values, levels, None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    writer.close().unwrap();
    out
}

/// Archives of every kind of some files.
fn archives(place: &TempDir, files: &[(&str, Vec<u8>)]) -> [PathBuf; 3] {
    let tar = tar_of(files);
    [("a.zip", zip_of(files)), ("a.tar.gz", gzip_of(&tar)), ("a.tar", tar)]
        .map(|(name, bytes)| put(place, name, bytes))
}

fn names(dataset: &Dataset) -> Vec<&str> {
    dataset.shapes.iter().map(|shape| shape.name.as_str()).collect()
}

fn described(dataset: &Dataset) -> Vec<(String, String)> {
    dataset.shapes.iter().map(|shape| (shape.name.clone(), shape.label.clone())).collect()
}

#[test]
fn archives_in_folders_are_looked_into_or_listed() {
    let folder = folder();
    let off = written("m.off", &shapes::icosphere(1));
    let inner = zip_of(&[("b.off", off.clone())]);
    for (name, bytes) in [
        ("a.off", off.clone()),
        ("all.zip", zip_of(&[("in/b.off", off.clone()), ("deep.zip", inner.clone())])),
        ("old.tar", tar_of(&[("c.off", off.clone())])),
        ("pictures.zip", zip_of(&[("x.jpg", vec![1])])),
        ("nested.zip", zip_of(&[("x.jpg", vec![1]), ("inner.zip", inner.clone())])),
        ("damaged.zip", b"PK".to_vec()),
        ("packed.tar.gz", gzip_of(&tar_of(&[("d.off", off)]))),
        ("other.7z", b"7z".to_vec()),
    ] {
        put(&folder, name, bytes);
    }
    let found = Dataset::read(folder.path(), None).unwrap();
    assert_eq!(names(&found), ["a", "all.zip/in/b", "old.tar/c"]);
    assert!(found.shapes.iter().all(|shape| read_mesh(&shape.path).unwrap().n_vertices() == 42));
    let unread: Vec<_> =
        found.skipped.iter().filter(|it| !it.kind.is_expected()).map(|it| it.path.clone()).collect();
    assert_eq!(
        unread,
        ["all.zip/deep.zip", "damaged.zip", "nested.zip/inner.zip", "other.7z", "packed.tar.gz"]
            .map(|name| folder.path().join(name))
    );
    let error = Dataset::read(&folder.path().join("nested.zip"), None).unwrap_err().to_string();
    let expected = "sub-folders, skipping .zip archive that is not looked into (1); a mesh is a .off";
    assert!(error.contains(expected), "{error}");
}

#[test]
fn an_archive_is_the_dataset_that_it_was_made_from() {
    let place = folder();
    let mut files = contents();
    files.push(other_half());
    for (name, content) in &files {
        put(&place, &format!("plain/{name}"), content);
    }
    let plain = Dataset::read(&place.path().join("plain/all"), None).unwrap();
    assert_eq!(names(&plain), ["cat/cat9", "cat/cat10", "dog/dog0", "dog/dog1"]);
    let other = put(&place, "A.TGZ", gzip_of(&tar_of(&files)));
    for path in archives(&place, &files).into_iter().chain([other]) {
        assert!(is_dataset(&path));
        let dataset = Dataset::read(&path, None).unwrap();
        assert_eq!(described(&dataset), described(&plain), "{path:?}");
        assert_eq!(count_skipped(&dataset.skipped), count_skipped(&plain.skipped), "{path:?}");
        for (member, file) in dataset.shapes.iter().zip(&plain.shapes) {
            assert!(member.path.starts_with(&path) && Storage.holds(&member.path));
            assert_eq!(read_mesh(&member.path).unwrap(), read_mesh(&file.path).unwrap(), "{path:?}");
            assert_eq!(content_hash(&member.path).unwrap(), content_hash(&file.path).unwrap(), "{path:?}");
        }
        let missing = read_mesh(&path.join("all/cat/cat11.off")).unwrap_err().to_string();
        assert!(missing.contains("cat11.off") && missing.contains("no such member"), "{missing}");
        let archive = read_mesh(&path).unwrap_err().to_string();
        assert!(
            archive.contains("holds 4 meshes, such as all/cat/cat10.off, all/cat/cat9.ply.gz"),
            "{archive}"
        );
    }
}

#[test]
fn an_archive_of_one_mesh_is_that_mesh() {
    let place = folder();
    let files = &contents()[3..];
    let files = [files, &[other_half()]].concat();
    for path in archives(&place, &files) {
        let member = path.join("all/dog/dog1.vert");
        assert_eq!(
            (mesh_at(&path).unwrap(), mesh_at(&member).unwrap()),
            ((&member).into(), (&member).into())
        );
        assert_eq!(read_mesh(&path).unwrap(), shapes::cube(2), "{path:?}");
        assert_eq!(content_hash(&path).unwrap(), content_hash(&member).unwrap(), "{path:?}");
    }
    let path = put(&place, "none.zip", zip_of(&[("README.md", b"meshes".to_vec())]));
    assert!(read_mesh(&path).unwrap_err().to_string().contains("holds 0 meshes, not one"));
    // The same from memory.
    let found = single_mesh(Path::new("dog.tar"), &tar_of(&files), 1 << 20).unwrap();
    let names: Vec<_> = found.iter().map(|(name, _)| name.to_str().unwrap()).collect();
    assert_eq!(names, ["dog1.vert", "dog1.tri"]);
    let both = tar_of(&[("a.off", b"OFF".to_vec()), ("b.off", b"OFF".to_vec())]);
    let error = single_mesh(Path::new("all.tar"), &both, 1000).unwrap_err().to_string();
    assert!(error.contains("all.tar: the archive holds 2 meshes"), "{error}");
    assert!(single_mesh(Path::new("cat.zip"), b"PK", 1000).is_err());
    let archives =
        ["a.zip", "a.tar.gz", "a.tgz", "a.off", "a.txt"].map(|name| is_archive_name(Path::new(name)));
    assert_eq!(archives, [true, true, true, false, false]);
}

#[test]
fn files_of_macos_are_skipped_everywhere() {
    let place = folder();
    let double = b"\0\x05\x16\x07\0\x02\0\0Mac OS X        ".to_vec();
    let files = |names: [&'static str; 2]| {
        let [a, b] = names.map(|name| (name, double.clone()));
        [("s/cat0.off", written("m.off", &shapes::cube(0))), a, b]
    };
    let beside = files(["s/._cat0.off", "s/._notes.txt"]);
    for (name, content) in &beside {
        put(&place, &format!("plain/{name}"), content);
    }
    put(&place, "a.zip", zip_of(&files(["__MACOSX/s/._cat0.off", "__MACOSX/s/._notes.txt"])));
    put(&place, "a.tar", tar_of(&beside));
    for name in ["plain/s", "a.zip", "a.tar"] {
        let dataset = Dataset::read(&place.path().join(name), None).unwrap();
        assert_eq!(dataset.shapes.len(), 1, "{name}");
        assert_eq!(count_skipped(&dataset.skipped)["._ file of macOS"], 2, "{name}");
        assert!(dataset.skipped.iter().all(|skipped| skipped.kind.is_expected()), "{name}");
    }
}

#[test]
fn a_hard_link_in_a_tar_is_the_file_it_names() {
    let place = folder();
    let mut archive = ::tar::Builder::new(Vec::new());
    let cube = written("m.off", &shapes::cube(1));
    let mut header = ::tar::Header::new_gnu();
    header.set_size(cube.len() as u64);
    archive.append_data(&mut header, "s/cat0.off", &cube[..]).unwrap();
    for (name, target) in
        [("s/same.off", "s/cat0.off"), ("s/again.off", "./s/same.off"), ("s/lost.off", "s/gone.off")]
    {
        let mut header = ::tar::Header::new_gnu();
        header.set_entry_type(::tar::EntryType::Link);
        header.set_size(0);
        archive.append_link(&mut header, name, target).unwrap();
    }
    // A name that is not UTF-8.
    let mut header = ::tar::Header::new_old();
    header.as_old_mut().name[..8].copy_from_slice(b"s/b\xff.off");
    header.set_size(0);
    header.set_cksum();
    archive.append(&header, &b""[..]).unwrap();
    let path = put(&place, "a.tar", archive.into_inner().unwrap());
    let dataset = Dataset::read(&path, None).unwrap();
    assert_eq!(names(&dataset), ["again", "cat0", "same"]);
    for shape in &dataset.shapes {
        assert_eq!(read_mesh(&shape.path).unwrap(), shapes::cube(1));
    }
    let skipped: Vec<_> = dataset.skipped.iter().map(|skipped| &skipped.kind).collect();
    assert_eq!(skipped, [&SkipKind::NotUtf8, &SkipKind::BrokenLink]);
}

#[test]
fn other_archives_and_files_are_no_datasets() {
    let place = folder();
    for (name, words) in [
        ("a.tar.bz2", "pack its files as .zip, .tar or .tar.gz"),
        ("a.RAR", ".zip"),
        ("a.off", "a dataset is a folder, a .zip"),
    ] {
        let path = put(&place, name, "x");
        let error = Dataset::read(&path, None).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains(words), "{error}");
        if !words.contains("dataset") {
            assert!(read_mesh(&path).unwrap_err().to_string().contains(words), "{name}");
        }
    }
}

#[test]
fn members_are_read_by_many_threads_at_once() {
    let place = folder();
    let files = ["m1.off", "m2.off", "m3.off"].map(|name| (name, written(name, &shapes::grid(99, 98, 0.1))));
    for path in archives(&place, &files) {
        let shapes = list_shapes(&path, None).unwrap();
        (0..60).into_par_iter().for_each(|i| {
            assert_eq!(read_mesh(&shapes[i % 3].path).unwrap(), shapes::grid(99, 98, 0.1), "{path:?}");
        });
    }
}

#[test]
fn a_changed_archive_is_read_again() {
    let place = folder();
    let path = place.path().join("a.zip");
    for n in [1, 2] {
        fs::write(&path, zip_of(&[("m.off", written("m.off", &shapes::icosphere(n)))])).unwrap();
        assert_eq!(read_mesh(&path.join("m.off")).unwrap(), shapes::icosphere(n));
    }
}

#[test]
fn members_that_lead_out_of_an_archive_are_skipped() {
    let place = folder();
    let cube = written("m.off", &shapes::cube(0));
    let evil = [
        "../evil.off",
        "/etc/evil.off",
        "a/../../evil.off",
        "C:\\evil.off",
        "..\\evil.off",
        "a\nevil.off",
        "./in//good.off",
        "in\\too.off",
    ];
    for path in archives(&place, &evil.map(|name| (name, cube.clone()))) {
        let dataset = Dataset::read(&path, None).unwrap();
        assert_eq!(names(&dataset), ["good", "too"], "{path:?}");
        let unsafe_names = dataset.skipped.iter().filter(|skipped| skipped.kind == SkipKind::UnsafeName);
        assert_eq!(unsafe_names.count(), 6, "{path:?}");
        assert!(read_mesh(&path.join("../evil.off")).is_err());
    }
}

#[test]
fn encrypted_and_damaged_members_are_errors_that_name_them() {
    let place = folder();
    let path = place.path().join("a.zip");
    let off = written("m.off", &shapes::icosphere(2));
    let intact = zip_of(&[("a.off", off.clone()), ("b.off", off.clone())]);
    // Flags of the first entry, in its own header and in the directory.
    let mut locked = intact.clone();
    locked[6] |= 1;
    let directory = locked.windows(4).position(|window| window == b"PK\x01\x02").unwrap();
    locked[directory + 8] |= 1;
    fs::write(&path, &locked).unwrap();
    let error = read_mesh(&path.join("a.off")).unwrap_err().to_string();
    assert!(error.contains("a.zip/a.off: this member is encrypted; unpack"), "{error}");
    assert_eq!(read_mesh(&path.join("b.off")).unwrap(), shapes::icosphere(2));
    let mut damaged = intact.clone();
    damaged[200] ^= 0x55;
    fs::write(&path, &damaged).unwrap();
    let error = read_mesh(&path.join("a.off")).unwrap_err().to_string();
    assert!(error.contains("a.zip/a.off: expected"), "{error}");
    for (name, bytes) in [
        ("cut.zip", &intact[..intact.len() / 2]),
        ("cut.tar", &tar_of(&[("a.off", off.clone())])[..700]),
        ("cut.tar.gz", &gzip_of(&tar_of(&[("a.off", off.clone())]))[..200]),
        ("a.parquet", &b"PAR1xxxxPAR1"[..]),
        ("empty.zip", b""),
        ("empty.tar", b""),
        ("empty.parquet", b""),
    ] {
        let path = put(&place, name, bytes);
        let error = list_shapes(&path, None).map(|shapes| read_mesh(&shapes[0].path));
        let error = match error {
            Ok(Ok(_)) => panic!("{name} was read"),
            Ok(Err(error)) | Err(error) => error.to_string(),
        };
        assert!(error.contains(name), "{error}");
    }
}

#[test]
fn decompression_bombs_are_cut_off() {
    let place = folder();
    let files = [("bomb.obj", vec![b'\n'; 100 << 20])];
    for (name, bytes) in [("a.zip", zip_of(&files)), ("a.tar.gz", gzip_of(&tar_of(&files)))] {
        let path = put(&place, name, bytes);
        let error = list_shapes(&path, None).and_then(|shapes| read_mesh(&shapes[0].path)).unwrap_err();
        assert!(error.to_string().contains("out of proportion"), "{name}: {error}");
    }
}

#[test]
fn rows_of_a_parquet_file_are_meshes_with_classes() {
    let place = folder();
    let path = place.path().join("meshes.parquet");
    let [ball, cube] = [shapes::icosphere(1), shapes::cube(1)];
    let rows = [
        ("a/one", Some("round"), "off", written("m.off", &ball)),
        ("two.ply", Some("round"), "ply", written("m.ply", &ball)),
        ("three", None, ".stl", written("m.stl", &cube)),
        ("four", Some("square"), "obj.gz", written("m.obj.gz", &cube)),
    ];
    fs::write(&path, parquet_of(&rows)).unwrap();
    let dataset = Dataset::read(&path, None).unwrap();
    let expected = [("a/one", "round"), ("four", "square"), ("three", ""), ("two", "round")];
    assert_eq!(described(&dataset), expected.map(|(name, label)| (name.to_owned(), label.to_owned())));
    for shape in &dataset.shapes {
        let mesh = read_mesh(&shape.path).unwrap();
        assert_eq!(mesh.n_faces(), if shape.label == "round" { ball.n_faces() } else { cube.n_faces() });
    }
    for (rows, words) in [
        (&[("x", None, "txt", vec![1])][..], "expected the extension of a mesh"),
        (&[("x", None, "off", vec![1]), ("x", None, "off", vec![2])], "a different id in every row"),
    ] {
        fs::write(&path, parquet_of(rows)).unwrap();
        let error = Dataset::read(&path, None).unwrap_err().to_string();
        assert!(error.contains("meshes.parquet") && error.contains(words), "{error}");
    }
}

const TRIANGLE: &[u8] = b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

#[test]
fn archives_with_bytes_changed_do_not_panic() {
    let files = ["cat/cat0.off", "dog/dog0.off"].map(|name| (name, TRIANGLE.to_vec()));
    let tar = tar_of(&files);
    for (name, intact, container) in [
        ("a.zip", zip_of(&files), Container::Zip),
        ("a.tar", tar.clone(), Container::Tar),
        ("a.tar.gz", gzip_of(&tar), Container::Tar),
        ("a.parquet", parquet_of(&[("one", Some("round"), "off", TRIANGLE.to_vec())]), Container::Parquet),
    ] {
        let path = Path::new(name);
        let mut random = base::SplitMix(7);
        let mut below = |n: usize| (random.bits() % n as u64) as usize;
        // A few bytes are changed, or cut off.
        for _ in 0..10_000 {
            let mut bytes = intact.clone();
            for _ in 0..=below(3) {
                let at = below(bytes.len());
                match below(4) {
                    0 => bytes.truncate(at.max(1)),
                    _ => bytes[at] = below(256) as u8,
                }
            }
            let mut file = tempfile::tempfile().unwrap();
            file.write_all(&bytes).unwrap();
            file.rewind().unwrap();
            if let Ok(archive) = cache::members(path, file, container, u64::MAX) {
                archive.members().for_each(|(member, _)| drop(archive.read(member, path)));
            }
        }
    }
}

#[test]
fn lists_name_files_and_members_relative_to_themselves() {
    let place = folder();
    for name in ["meshes/cat/cat0.off", "meshes/dog1.off"] {
        put(&place, name, written("m.off", &shapes::cube(0)));
    }
    put(&place, "meshes/more.zip", zip_of(&[("x/dog2.off", written("m.off", &shapes::cube(1)))]));
    let lines = "\u{feff}# comment\n../meshes/dog1.off\r\n\n ../meshes/more.zip/x/dog2.off\n./../meshes/cat/cat0.off\n../meshes/dog1.off\n";
    let list = put(&place, "lists/all.txt", lines);
    let dataset = Dataset::read(&list, None).unwrap();
    let expected = [("cat/cat0", "cat"), ("dog1", "dog"), ("more.zip/x/dog2", "dog")];
    assert_eq!(described(&dataset), expected.map(|(name, label)| (name.to_owned(), label.to_owned())));
    assert_eq!(dataset.skipped.len(), 1);
    assert!(dataset.shapes.iter().all(|shape| read_mesh(&shape.path).is_ok()));
    for (line, words) in [
        (&b"../meshes"[..], "is a folder"),
        (b"notes.md", "is not a mesh"),
        (b"\xff.off", "save the file as UTF-8"),
    ] {
        fs::write(&list, [&b"\n"[..], line, b"\n"].concat()).unwrap();
        let error = Dataset::read(&list, None).unwrap_err().to_string();
        assert!(error.contains("all.txt, line 2: ") && error.contains(words), "{error}");
    }
    fs::write(&list, "").unwrap();
    assert!(Dataset::read(&list, None).unwrap_err().to_string().contains("no mesh found"));
}
