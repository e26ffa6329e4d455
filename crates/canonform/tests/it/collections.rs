//! Collections on the disk: what becomes of files that are copies, move, or cannot be read.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use canonform::DescribeOptions;
use canonform::collection::LabelSource;
use canonform::index::Index;
use canonform::library::{
    BuildOptions, BuildReport, DuplicateOptions, DuplicateReport, EvaluateOptions, Inputs, Keep, MoveReport,
    add_to_index, build_index, check_place, evaluate_index, find_duplicates, move_duplicates, undo_moves,
};
use canonform::mesh::{TriMesh, io, shapes};
use canonform::relations::RelationKind;
use canonform::search::{Answer, SearchOptions, SearchRank, ShapeSearch};
use testkit::tree;

use crate::progress::Stages;

/// Names that a shell, a spreadsheet, a terminal or a browser may obey.
const HOSTILE: [&str; 12] = [
    "c\ntouch pwned #.off",
    "it's \"$(touch pwned)\" `touch pwned`;&|<>*?.off",
    "-rf --help.off",
    "#comment.off",
    "tab\there\r.off",
    "\u{1b}[2J\u{9b}31m\u{7}\u{85}.off",
    "\u{202e}ffo.tac\u{2066}.off",
    "ünïcödé 日本.off",
    " blank at both ends .off",
    "=cmd|' /C calc'!A0.off",
    "\\back\\slash\\n%20.off",
    "..off",
];

fn ball() -> TriMesh {
    shapes::icosphere(1)
}

fn build(folder: &Path, index: &Path) -> BuildReport {
    build_index(folder, index, &BuildOptions::new(&DescribeOptions::default()), &()).unwrap()
}

fn duplicates(folder: &Path) -> DuplicateReport {
    let place = tempfile::tempdir().unwrap();
    let index = place.path().canonicalize().unwrap().join("all.canonform");
    build(folder, &index);
    find_duplicates(&ShapeSearch::open(&index).unwrap(), &DuplicateOptions::default(), &()).unwrap()
}

fn moved(folder: &Path, place: &Path) -> MoveReport {
    check_place(folder, place).unwrap();
    move_duplicates(&duplicates(folder), &[folder], place).unwrap()
}

fn written(folder: &Path, names: &[&str]) {
    for name in names {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        io::write(&path, &ball()).unwrap();
        for file in io::files_of(&path) {
            // Files of one age are kept in the order of their names.
            fs::File::options().write(true).open(file).unwrap().set_modified(UNIX_EPOCH).unwrap();
        }
    }
}

fn reasons(report: &MoveReport) -> BTreeMap<String, String> {
    let name = |path: &Path| path.file_name().unwrap().to_str().unwrap().to_owned();
    report.not_moved.iter().map(|stays| (name(&stays.path), stays.why.clone())).collect()
}

#[test]
fn files_of_any_name_move_and_come_back_and_nothing_is_overwritten() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().canonicalize().unwrap().join("models");
    written(&folder, &HOSTILE);
    let before = tree(&folder);
    // Below the collection, where it must not be taken for a part of it.
    let away = folder.join("away\nfrom here");
    let report = moved(&folder, &away);
    assert_eq!((report.moved.len(), &report.not_moved[..]), (HOSTILE.len() - 1, &[][..]));
    let journal = fs::read_to_string(report.journal.as_ref().unwrap()).unwrap();
    assert_eq!(journal.lines().count(), HOSTILE.len() - 1, "one line a mesh");
    assert!(!journal.contains(|c: char| c.is_ascii_control() && c != '\n'));
    let after = tree(&folder);
    assert_eq!(after.len(), before.len() + 1, "nothing is lost");
    let folder_of_journal = report.journal.as_ref().unwrap().parent().unwrap();
    assert!(report.moved.iter().all(|[from, to]| !from.exists() && to.starts_with(folder_of_journal)));
    assert_eq!(duplicates(&folder).groups, []);
    assert_eq!(moved(&folder, &away), MoveReport::default());
    assert!(tree(&folder) == after);
    // The same names once more.
    let names = report.moved.iter().map(|[from, _]| from.strip_prefix(&folder).unwrap().to_str().unwrap());
    let gone: Vec<&str> = names.collect();
    written(&folder, &gone);
    assert_eq!(moved(&folder, &away).moved.len(), gone.len());
    assert_eq!(tree(&folder).len(), after.len() + gone.len());
    // The second ones come back, and the first ones once their places are free.
    for n_left in [gone.len(), 0] {
        let undone = undo_moves(report.journal.as_ref().unwrap()).unwrap();
        assert_eq!((undone.moved.len(), undone.not_moved.len()), (gone.len(), n_left));
        assert!(undone.not_moved.iter().all(|stays| stays.why.starts_with("another file is now")));
        assert_eq!((undone.journal.is_some(), away.exists()), (n_left > 0, n_left > 0));
        if n_left > 0 {
            gone.iter().for_each(|name| fs::remove_file(folder.join(name)).unwrap());
        }
    }
    assert!(tree(&folder) == before);
}

#[cfg(unix)]
#[test]
fn links_and_what_they_lead_to_stay() {
    use std::os::unix::fs::symlink;
    let place = tempfile::tempdir().unwrap();
    let (folder, master) = (place.path().join("models"), place.path().join("master"));
    written(&folder, &["a.off", "linked.off", "hard.off", "free longer name.off"]);
    written(&master, &["precious.off", "other/far.off"]);
    symlink("../master/precious.off", folder.join("out.off")).unwrap();
    symlink("../master/other", folder.join("far")).unwrap();
    symlink("linked.off", folder.join("alias.off")).unwrap();
    fs::hard_link(folder.join("hard.off"), folder.join("hard too.off")).unwrap();
    let (outside, before) = (tree(&master), tree(&folder));
    let found = duplicates(&folder);
    // Neither links nor second names are space to spare.
    let keeper = &found.groups[0].keeper.id;
    let own = ["a", "linked", "free longer name"].iter().filter(|id| *id != keeper).count() as u64;
    assert_eq!(found.spare_bytes(), own * fs::metadata(folder.join("a.off")).unwrap().len());
    let report = move_duplicates(&found, &[&folder], &place.path().join("away")).unwrap();
    let why = reasons(&report);
    assert!(why["out.off"].starts_with("it is a link"));
    assert!(why["far.off"].starts_with("it is a link"));
    // Two names of one file are no duplicates.
    assert!(why["hard.off"].starts_with("it has several names") && !why.contains_key("hard too.off"));
    let hard = found.groups[0].members.iter().find(|member| member.file.id == "hard").unwrap();
    assert_eq!((&hard.file.links[..], hard.is_spare()), (&["hard too".to_owned()][..], false));
    assert!(!report.moved.is_empty());
    assert!(tree(&master) == outside);
    for name in ["linked.off", "alias.off", "out.off"] {
        assert!(io::read(&folder.join(name)).is_ok(), "{name}");
    }
    undo_moves(report.journal.as_ref().unwrap()).unwrap();
    assert!(tree(&folder) == before);
}

/// A glTF file of a tetrahedron and its buffer; both the buffer and a picture are other files.
fn gltf(buffer: &str, picture: &str) -> (String, Vec<u8>) {
    let solid = shapes::tetrahedron(0);
    let corners = solid.positions.iter().flat_map(|p| [p.x, p.y, p.z]).flat_map(|x| (x as f32).to_le_bytes());
    let faces = solid.faces.iter().flatten().flat_map(|v| v.0.to_le_bytes());
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"uri":"{buffer}","byteLength":96}}],"images":[{{"uri":"{picture}"}}],
        "bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":48}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"}},
        {{"bufferView":1,"componentType":5125,"count":12,"type":"SCALAR"}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"nodes":[{{"mesh":0}}],"scenes":[{{"nodes":[0]}}],"scene":0}}"#
    );
    (text, corners.chain(faces).collect())
}

#[test]
fn all_files_of_a_mesh_move_together_and_what_another_needs_stays() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("models");
    let at = |name: &str| folder.join(name);
    written(&folder, &["pair/a.vert", "pair/bb.vert", "obj/a.obj", "obj/bb.obj"]);
    // Copies of an OBJ file with materials of their own, one of them in a folder below.
    for (name, materials) in [("a", "a.mtl"), ("bb", "sub/my bb.mtl")] {
        let text = fs::read_to_string(at(&format!("obj/{name}.obj"))).unwrap();
        fs::write(at(&format!("obj/{name}.obj")), format!("mtllib {materials}\n{text}")).unwrap();
        let path = at(&format!("obj/{materials}"));
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, format!("newmtl m\nmap_Kd -s 1 1 1 {name} skin.png\n")).unwrap();
    }
    fs::write(at("obj/a skin.png"), "a").unwrap();
    fs::write(at("obj/sub/bb skin.png"), "bb").unwrap();
    for name in ["own/a", "own/bb", "shared/a", "shared/bb"] {
        fs::create_dir_all(at(name).parent().unwrap()).unwrap();
        let (buffer, picture) = match name.split_once('/').unwrap() {
            ("own", stem) => (format!("{stem}.bin"), format!("my%20{stem}.png")),
            _ => ("all.bin".to_owned(), "all.png".to_owned()),
        };
        let (text, bytes) = gltf(&buffer, &picture);
        fs::write(at(&format!("{name}.gltf")), text).unwrap();
        fs::write(at(name).with_file_name(buffer), bytes).unwrap();
        fs::write(at(name).with_file_name(picture.replace("%20", " ")), name).unwrap();
    }
    let before = tree(&folder);
    let report = moved(&folder, &place.path().join("away"));
    let away: Vec<String> =
        tree(&place.path().join("away")).into_keys().map(|path| path.to_str().unwrap().to_owned()).collect();
    let kept = tree(&folder);
    // Whichever of two is kept, the files of the other are all there.
    for files in [
        ["pair/a.vert", "pair/a.tri"].as_slice(),
        &["pair/bb.vert", "pair/bb.tri"],
        &["obj/a.obj", "obj/a.mtl", "obj/a skin.png"],
        &["obj/bb.obj", "obj/sub/my bb.mtl", "obj/sub/bb skin.png"],
        &["own/a.gltf", "own/a.bin", "own/my a.png"],
        &["own/bb.gltf", "own/bb.bin", "own/my bb.png"],
        &["shared/a.gltf", "shared/bb.gltf", "shared/all.bin", "shared/all.png"],
    ] {
        let n_moved = files.iter().filter(|name| away.iter().any(|moved| moved == *name)).count();
        let n_kept = files.iter().filter(|name| kept.contains_key(Path::new(name))).count();
        assert!([(0, files.len()), (files.len(), 0)].contains(&(n_moved, n_kept)), "{files:?}: {away:?}");
    }
    let is_away = |part: &str| away.iter().any(|name| name.contains(part));
    assert!([".tri", "skin.png", "own/my "].into_iter().all(is_away) && !is_away("shared"));
    assert!(reasons(&report).values().any(|why| why.ends_with("needs a file of it")));
    for [_, to] in report.moved.iter().filter(|[_, to]| io::is_mesh_path(to)) {
        assert!(io::read(to).is_ok(), "{}", to.display());
    }
    undo_moves(report.journal.as_ref().unwrap()).unwrap();
    assert!(tree(&folder) == before);
}

/// A pair that was moved, and its journal.
fn moved_pair(place: &Path) -> (PathBuf, PathBuf, [[PathBuf; 2]; 2], PathBuf) {
    let (folder, away) = (place.join("models"), place.join("away"));
    written(&folder, &["a.vert", "bb.vert"]);
    let report = moved(&folder, &away);
    (folder, away, report.moved.clone().try_into().unwrap(), report.journal.unwrap())
}

#[test]
fn whatever_interrupts_a_move_it_can_be_undone_or_resumed() {
    // What an interruption leaves: the journal says what was to be done, and a part of it is done.
    let states: [fn(&[[PathBuf; 2]; 2]); 4] = [
        |_| {},
        |[_, [from, to]]| fs::rename(to, from).unwrap(),
        |[_, [from, to]]| {
            fs::rename(to, from).unwrap();
            fs::write(to, "").unwrap();
        },
        |moves| moves.iter().for_each(|[from, to]| fs::rename(to, from).unwrap()),
    ];
    for (n, state) in states.iter().enumerate() {
        for is_resumed in [false, true] {
            let place = tempfile::tempdir().unwrap();
            let (folder, away, moves, journal) = moved_pair(place.path());
            state(&moves);
            // A line that was cut: its mesh has not moved.
            let lines = fs::read_to_string(&journal).unwrap();
            fs::write(&journal, format!("{lines}{{\"files\":[[\"/x")).unwrap();
            if is_resumed {
                moved(&folder, &away);
                assert_eq!(tree(&folder).len(), 2, "state {n}");
                assert_eq!(duplicates(&folder).groups, []);
                assert!(moves.iter().all(|[from, to]| !from.exists() && to.exists()), "state {n}");
            }
            let undone = undo_moves(&journal).unwrap();
            assert_eq!(undone.not_moved, [], "state {n}");
            assert!(undone.journal.is_none() && !away.exists());
            assert_eq!(tree(&folder).len(), 4, "state {n}");
            assert!(moves.iter().all(|[from, _]| fs::metadata(from).unwrap().len() > 0), "state {n}");
        }
    }
}

#[test]
fn undoing_overwrites_nothing_and_keeps_what_is_left_in_the_journal() {
    let place = tempfile::tempdir().unwrap();
    let (_, _, moves, journal) = moved_pair(place.path());
    fs::write(&moves[0][0], "a new file").unwrap();
    let undone = undo_moves(&journal).unwrap();
    assert_eq!((undone.moved.len(), undone.journal.as_ref()), (1, Some(&journal)));
    assert!(undone.not_moved[0].why.starts_with("another file is now"));
    assert_eq!(fs::read_to_string(&moves[0][0]).unwrap(), "a new file");
    fs::remove_file(&moves[0][0]).unwrap();
    fs::remove_file(&moves[0][1]).unwrap();
    let rest = undo_moves(&journal).unwrap();
    assert_eq!((rest.not_moved[0].why.as_str(), rest.journal), ("it is gone", None));
    // Whatever is no journal stays as it is.
    for text in ["", "mine", "{\"x\":1}\n", "{\"files\":[", "mine\nand mine"] {
        let path = place.path().join("mine.jsonl");
        fs::write(&path, text).unwrap();
        assert!(undo_moves(&path).unwrap_err().to_string().contains("no journal"), "{text}");
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
}

#[test]
fn places_that_hold_or_hide_something_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("models");
    written(&folder, &["a.off", "bb.off", "sub/c.ply"]);
    let found = duplicates(&folder);
    for (away, what) in [
        ("models", "the meshes are in this folder"),
        ("models/sub", "holds other files"),
        (".", "the meshes"),
    ] {
        let error = move_duplicates(&found, &[&folder], &place.path().join(away)).unwrap_err().to_string();
        assert!(error.contains(what), "{away}: {error}");
    }
    // What changed since it was compared stays.
    let member = &found.groups[0].members[0].file.path;
    fs::write(member, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").unwrap();
    let report = move_duplicates(&found, &[&folder], &place.path().join("away")).unwrap();
    assert!(reasons(&report)[member.file_name().unwrap().to_str().unwrap()].contains("has changed"));
}

#[test]
fn files_of_equal_bytes_are_described_once() {
    let place = tempfile::tempdir().unwrap();
    // The index is in the folder.
    let (folder, path) = (place.path().join("models"), place.path().join("models/all.canonform"));
    written(&folder, &["a.off", "b/a.off", "c.off", "d.ply"]);
    io::write(&folder.join("ring.off"), &shapes::torus(12, 8, 2.0, 0.7)).unwrap();
    // The same bytes, read as another format.
    fs::copy(folder.join("a.off"), folder.join("e.obj")).unwrap();
    for name in ["broken.off", "broken too.off"] {
        fs::write(folder.join(name), "OFF\n3 1 0\n0 0 0\n").unwrap();
    }
    let report = build(&folder, &path);
    assert_eq!((report.n_shapes, report.described, report.copies), (5, 5, 2), "{:?}", report.failed);
    // Each failure names its own file.
    assert_eq!(report.failed.len(), 3);
    for failure in &report.failed {
        assert!(failure.error.contains(failure.path.to_str().unwrap()), "{}", failure.error);
    }
    let index = Index::open(&path).unwrap();
    let [a, b, c] = ["a", "b/a", "c"].map(|id| index.shape(id).unwrap());
    assert!(a.fused == b.fused && a.form == b.form && a.form == c.form);
    assert_eq!(index.entry("b/a").unwrap().path, "b/a.off");
    fs::copy(folder.join("a.off"), folder.join("f.off")).unwrap();
    assert_eq!(build(&folder, &path).n_shapes, 6);
    // What has changed is described again.
    io::write(&folder.join("c.off"), &shapes::cube(1)).unwrap();
    fs::remove_file(folder.join("d.ply")).unwrap();
    let report = build(&folder, &path);
    assert_eq!((report.n_shapes, report.described, report.removed), (5, 1, 1));
}

#[test]
fn places_of_two_folders_stay_apart_and_what_moves_is_not_described_again() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let (index, other) = (at("all.canonform"), shapes::torus(12, 8, 2.0, 0.7));
    written(place.path(), &["disk/a.off", "disk/b.ply"]);
    io::write(&at("disk/ring.off"), &other).unwrap();
    build(&at("disk"), &index);
    // A backup, a further copy, another shape of a known name, and what is not looked into.
    written(place.path(), &["backup/a.off", "backup/b.ply", "backup/more.off"]);
    io::write(&at("backup/ring.off"), &shapes::torus(12, 8, 2.0, 0.5)).unwrap();
    fs::write(at("backup/old.7z"), "7z").unwrap();
    let add = || {
        let (paths, limits) = ([at("backup")], Default::default());
        add_to_index(&index, &Inputs { paths: &paths, labels: None, label: None, limits }, false, &())
            .unwrap()
    };
    let report = add();
    assert_eq!((report.n_shapes, report.described, report.copies, report.unchanged), (7, 4, 3, 0));
    let [skipped] = &report.skipped_paths[..] else { panic!("{:?}", report.skipped_paths) };
    assert_eq!(skipped.path, at("backup/old.7z"));
    let paths = || -> Vec<[String; 2]> {
        let entries = Index::open(&index).unwrap().entries().unwrap();
        entries.into_iter().map(|entry| [entry.id, entry.path]).collect()
    };
    let expected = [
        ["a", "disk/a.off"],
        ["b", "disk/b.ply"],
        ["backup/a", "backup/a.off"],
        ["backup/b", "backup/b.ply"],
        ["backup/ring", "backup/ring.off"],
        ["more", "backup/more.off"],
        ["ring", "disk/ring.off"],
    ];
    assert_eq!(paths(), expected.map(|pair| pair.map(str::to_owned)));
    // Again, and one folder after the other, whatever it is called.
    let renamed = at("backup/../disk/.");
    assert_eq!((add().unchanged, build(&renamed, &index).unchanged, paths().len()), (4, 3, 7));
    assert_eq!(build(&at("backup"), &index).unchanged, 4);
    let search = ShapeSearch::open(&index).unwrap();
    let options = DuplicateOptions { reference: vec![at("backup")], ..DuplicateOptions::default() };
    let found = find_duplicates(&search, &options, &()).unwrap();
    let [group] = &found.groups[..] else { panic!("{:?}", found.groups) };
    assert_eq!((group.members.len(), group.keeper.reference), (4, true));
    let spare: Vec<&str> = found.spare().map(|file| file.id.as_str()).collect();
    assert_eq!(spare, ["a", "b"], "nothing in the reference");
    let all = find_duplicates(&search, &DuplicateOptions::default(), &()).unwrap();
    assert_eq!(all.spare().count(), 4);
    fs::rename(at("disk/ring.off"), at("disk/renamed.off")).unwrap();
    let report = build(&at("disk"), &index);
    assert_eq!((report.described, report.copies, report.removed), (1, 1, 1));
}

#[test]
fn classes_that_were_given_stay_and_have_a_boundary_of_their_own() {
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    // Nine rings of each of two widths: each is first found by eight of its class, then by one more.
    for (i, class) in (0..18).map(|i| (i, if i % 2 == 0 { "thin" } else { "fat" })) {
        let width = if i % 2 == 0 { 0.2 } else { 0.9 } + 0.001 * f64::from(i);
        fs::create_dir_all(at("models")).unwrap();
        io::write(&at(&format!("models/{class}{i}.off")), &shapes::torus(12, 8, 2.0, width)).unwrap();
    }
    let rows = (0..18).map(|i| format!("{}{i}.off,{}\n", ["thin", "fat"][i % 2], ["wire", "tyre"][i % 2]));
    fs::write(at("labels.csv"), rows.collect::<String>()).unwrap();
    let (describe, index) = (DescribeOptions::default(), at("all.canonform"));
    let stages = Stages::default();
    let build_at = |index: &Path, labels: Option<&LabelSource>| {
        let options = BuildOptions { labels, ..BuildOptions::new(&describe) };
        build_index(&at("models"), index, &options, &stages).unwrap();
        Index::open(index).unwrap().classes().unwrap().into_keys().collect::<Vec<_>>()
    };
    let build = |labels: Option<&LabelSource>| build_at(&index, labels);
    let boundary = |index: &Path| Index::open(index).unwrap().note("agreement").unwrap().unwrap();
    let n_fitted = || stages.0.lock().unwrap().iter().filter(|stage| stage.0 == "comparing classes").count();
    let file = LabelSource::read(&at("labels.csv")).unwrap();
    fs::rename(at("models/fat17.off"), at("fat17.off")).unwrap();
    assert_eq!(build(Some(&file)), ["tyre", "wire"]);
    let of_17 = boundary(&index);
    io::write(&at("models/new.off"), &ball()).unwrap();
    assert_eq!(build(None), ["tyre", "wire"], "the new shape has no class");
    assert_eq!((boundary(&index), n_fitted()), (of_17.clone(), 1), "nor does it move the boundary");
    fs::rename(at("fat17.off"), at("models/fat17.off")).unwrap();
    build(Some(&file));
    build_at(&at("at once.canonform"), Some(&file));
    assert_eq!((boundary(&index), n_fitted()), (boundary(&at("at once.canonform")), 3));
    assert_ne!(boundary(&index), of_17);
    let found = |rank_by| {
        let (search, options) =
            (ShapeSearch::open(&index).unwrap(), SearchOptions { k: 18, rank_by, ..Default::default() });
        search.search(&search.query_of("thin0", &options, &()).unwrap(), &options, &()).unwrap()
    };
    let of_classes =
        |answer: &Answer| answer.results.iter().any(|hit| hit.relation.to_string().contains("class"));
    let plain = found(SearchRank::Plain);
    assert!(plain.results[0].itself && plain.results[1..].iter().all(|hit| !hit.itself));
    assert!(
        plain.predicted.label.as_deref() == Some("wire") && plain.predicted.nearest.unwrap().id != "thin0"
    );
    for hit in &plain.results[1..] {
        let told = hit.relation.kind != RelationKind::Different;
        assert!(hit.label.is_empty() || told == (hit.label == "wire"), "{}: {}", hit.id, hit.relation);
    }
    // Distances from a part say nothing of its class.
    assert!(!of_classes(&found(SearchRank::Part)));
    let agreement = evaluate_index(&index, &EvaluateOptions::default(), &()).unwrap().agreement.unwrap();
    assert_eq!((agreement.same_class, agreement.other_classes), (144, 18));
    assert!(agreement.agree > 0.95, "{agreement:?}");
    assert_eq!(build(Some(&LabelSource::None)), Vec::<String>::new());
    assert_eq!(build(None), Vec::<String>::new(), "that there are none was said, too");
    assert!(!of_classes(&found(SearchRank::Plain)));
}

#[test]
fn what_is_wanted_is_kept_and_copies_of_copies_are_exact() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("models");
    written(&folder, &["new/it.off", "old/copy.off"]);
    let write = |name: &str, mesh: &TriMesh| io::write(&folder.join(name), mesh).unwrap();
    // Subdivided twice, and a copy of that.
    let fine = shapes::subdivide(&ball());
    write("fine.off", &fine);
    write("fine too.ply", &fine);
    let index = place.path().join("all.canonform");
    build(&folder, &index);
    let search = ShapeSearch::open(&index).unwrap();
    let group = |keep: Keep| {
        let found = find_duplicates(&search, &DuplicateOptions { keep, ..Default::default() }, &()).unwrap();
        found.groups[0].clone()
    };
    let exact = group(Keep::Exact);
    let told = exact
        .members
        .iter()
        .map(|member| (member.file.id.as_str(), member.of.as_str(), member.relation.kind));
    let told: Vec<_> = told.collect();
    assert_eq!(exact.keeper.id, "new/it");
    assert_eq!(
        told,
        [
            ("old/copy", "new/it", RelationKind::IdenticalFile),
            ("fine", "new/it", RelationKind::Remeshed),
            ("fine too", "fine", RelationKind::IdenticalGeometry)
        ]
    );
    for (keep, id) in [("largest", "fine"), ("smallest", "new/it"), ("oldest", "new/it")] {
        assert_eq!(group(keep.parse().unwrap()).keeper.id, id, "{keep}");
    }
    assert_eq!(group(folder.join("old").to_str().unwrap().parse().unwrap()).keeper.id, "old/copy");
    assert!("none".parse::<Keep>().is_err());
    // Moved with all that it is a copy of.
    let found = find_duplicates(&search, &DuplicateOptions::default(), &()).unwrap();
    let moved = move_duplicates(&found, &[&folder], &place.path().join("away")).unwrap();
    assert_eq!((moved.moved.len(), moved.not_moved.len()), (2, 1));
}

#[cfg(unix)]
#[test]
fn what_cannot_be_read_now_is_kept_and_what_is_gone_is_removed() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let place = tempfile::tempdir().unwrap();
    let at = |name: &str| place.path().join(name);
    let (folder, path) = (at("models"), at("all.canonform"));
    written(
        place.path(),
        &["share/far.off", "store.off", "models/here.off", "models/gone.off", "models/pair.vert"],
    );
    written(place.path(), &["models/closed/inner.off", "models/lost/inner.off"]);
    symlink("../share", folder.join("share")).unwrap();
    symlink("../store.off", folder.join("link.off")).unwrap();
    assert_eq!(build(&folder, &path).n_shapes, 7);
    // A share and a file that links lead to are away, half of a pair cannot be opened, and two files are really gone.
    fs::rename(at("share"), at("share away")).unwrap();
    fs::rename(at("store.off"), at("store away.off")).unwrap();
    fs::rename(folder.join("pair.tri"), at("half.tri")).unwrap();
    fs::create_dir(folder.join("pair.tri")).unwrap();
    fs::remove_file(folder.join("gone.off")).unwrap();
    fs::remove_dir_all(folder.join("lost")).unwrap();
    let closed = folder.join("closed");
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o000)).unwrap();
    // Nothing is closed to the superuser.
    let is_closed = fs::read_dir(&closed).is_err();
    for removed in [2, 0] {
        let report = build(&folder, &path);
        let mut kept = vec!["link", "pair", "share/far"];
        if is_closed {
            kept.insert(0, "closed/inner");
        }
        assert_eq!(
            (report.n_shapes, report.removed, report.unreadable),
            (5, removed, kept.into_iter().map(str::to_owned).collect())
        );
    }
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o755)).unwrap();
    fs::remove_dir(folder.join("pair.tri")).unwrap();
    fs::rename(at("half.tri"), folder.join("pair.tri")).unwrap();
    fs::rename(at("share away"), at("share")).unwrap();
    fs::remove_file(folder.join("link.off")).unwrap();
    let report = build(&folder, &path);
    assert_eq!((report.n_shapes, report.described, report.removed), (4, 0, 1));
    assert!(report.unreadable.is_empty());
}
