//! Names that a shell, a spreadsheet, a browser or a terminal might obey, and files that must stay as they are.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use canonform::mesh::shapes;

use crate::index::body;
use crate::support::{Workplace, program};

/// A line break, codes of terminals in 7 and in 8 bits, a reversed direction, and a formula.
const HOSTILE: [&str; 4] = [
    "a\nINJECTED \u{1b}]0;title\u{7}\u{1b}[2J.off",
    "b\r\u{9b}31m\u{85}\u{7f}.off",
    "c\u{202e}ffo.\u{2066}\u{2028}INJECTED\t.off",
    "=d|' !A0.off",
];

/// A folder of two hostile classes, with copies, and what else is there.
fn collection() -> Workplace {
    let place = Workplace::new();
    for (i, name) in HOSTILE.iter().enumerate() {
        for (j, class) in ["cats\u{1b}[31m\nINJECTED", "dogs\u{202e}"].iter().enumerate() {
            place.add(&format!("all/{class}/{name}"), &body(j, i));
        }
        place.add(&format!("all/cats\u{1b}[31m\nINJECTED/copy of {name}"), &body(0, i));
    }
    place
}

/// What people read holds no code, and no name begins a line.
fn assert_plain(what: &[&str], text: &str) {
    let is_code =
        |c: char| c.is_control() && c != '\n' && c != '\t' || "\u{202e}\u{2066}\u{2028}".contains(c);
    assert!(!text.contains(is_code), "{what:?}: {text:?}");
    assert!(!text.lines().any(|line| line.trim_start().starts_with("INJECTED")), "{what:?}: {text}");
}

#[test]
#[ignore = "slow: make test-all"]
fn no_output_for_people_obeys_a_name() {
    let place = collection();
    let class = "all/cats\u{1b}[31m\nINJECTED";
    let [a, b, c, d] = HOSTILE.map(|name| format!("{class}/{name}"));
    fs::write(place.path(&format!("{class}/broken\u{1b}[2J\nINJECTED.off")), "OFF\n1").unwrap();
    fs::write(place.path("labels\u{1b}[2J\nINJECTED.csv"), "x\u{1b}[2J,y\n\u{9b}z\n").unwrap();
    let index = "i\u{1b}[2J\nINJECTED";
    let id = a.strip_prefix("all/").unwrap().strip_suffix(".off").unwrap();
    let missing = "no\u{1b}[2J\nINJECTED.off";
    let labels = "labels\u{1b}[2J\nINJECTED.csv";
    let form = "form\u{1b}[2J\nINJECTED.ply";
    let runs: Vec<Vec<&str>> = vec![
        vec!["index", "build", "all", "-n", "20", "-o", index],
        vec!["index", "build", "all", "-n", "20", "-o", index, "--labels", labels],
        vec!["index", "build", "all", "-n", "30", "-o", index],
        vec!["index", "list", index],
        vec!["index", "info", index, "--details"],
        vec!["index", "verify", index],
        vec!["index", "add", index, &a, missing],
        vec!["index", "remove", index, "none\u{1b}[2J"],
        vec!["index", "merge", index, "-o", "merged\u{1b}[2J"],
        vec!["info", &a, &b, &c, &d, missing, "all"],
        vec!["compare", &a, &b, "--details", "-n", "20"],
        vec!["compare", &a, missing],
        vec!["search", index, &b, "--explain"],
        vec!["search", index, id, missing],
        vec!["search", index, missing],
        vec!["duplicates", "all", "--csv", "d.csv", "--html", "d.html"],
        vec!["duplicates", "all", "--kinds", "geometry,pose", "--move-to", "away\u{1b}[2J\nINJECTED"],
        vec!["duplicates", "--undo", "away\u{1b}[2J\nINJECTED/canonform-moved.jsonl"],
        vec!["duplicates", "--undo", missing],
        vec!["evaluate", index, "--details"],
        vec!["embed", &a, "-n", "20", "-o", form],
        vec!["embed", "all", "-n", "20", "-o", "forms\u{1b}[2J"],
        vec!["embed", &a, "-n", "20", "-o", &a],
        vec!["convert", &a, "o\u{1b}[2J\nINJECTED.ply"],
        vec!["convert", &a, "no\u{1b}[2J\nINJECTED/o.ply"],
        vec!["geodesic", &a, "--source", "0", "-o", "g\u{1b}[2J\nINJECTED.ply"],
        vec!["geodesic", &a, "--source", "999999", "-o", "g.ply"],
        vec!["match", &a, &b, "-o", "m\u{1b}[2J\nINJECTED.ply"],
        vec!["render", &a, "-o", "r\u{1b}[2J\nINJECTED.png"],
        vec!["field", "build", &a, "-o", "f\u{1b}[2J\nINJECTED.field"],
        vec!["field", "info", "f\u{1b}[2J\nINJECTED.field"],
        vec!["methods", &a, "-n", "20"],
        vec![
            "generate",
            "--family",
            "cat",
            "--poses",
            "1",
            "--vertices",
            "1000",
            "-o",
            "gen\u{1b}[2J\nINJECTED",
        ],
        vec!["info", &a, "--components", "\u{1b}[2J"],
    ];
    for arguments in &runs {
        let outcome = place.run(arguments);
        assert!((0..=2).contains(&outcome.code), "{arguments:?}: {}", outcome.err);
        assert_plain(arguments, &outcome.out);
        assert_plain(arguments, &outcome.err);
        assert!(!outcome.out.is_empty() || !outcome.err.is_empty(), "{arguments:?}");
        // JSON says the same names, without codes.
        if ["methods", "match", "render", "generate", "embed"].contains(&arguments[0]) {
            continue;
        }
        let outcome = place.run(&[&arguments[..], &["--json"]].concat());
        assert_plain(arguments, &outcome.out);
        assert_plain(arguments, &outcome.err);
    }
    let listed = place.json(&["index", "list", index]);
    let ids: Vec<_> = listed["shapes"].as_array().unwrap().iter().map(|shape| &shape["id"]).collect();
    assert!(ids.iter().any(|found| found.as_str() == Some(id)), "names in JSON are whole: {ids:?}");
    // An export for programs says names as they are.
    let table = place.done(&["index", "export", index, "--output-format", "jsonl"]).out;
    assert!(table.lines().any(|line| serde_json::from_str::<serde_json::Value>(line).unwrap()["id"] == *id));
}

#[test]
fn tables_for_people_hold_no_formula_and_pages_no_markup() {
    let place = Workplace::new();
    for name in ["all/=1+1", "all/+1", "all/-1", "all/@x", "all/\tx", "all/a,\"b\nc", "two/\u{202e}x"] {
        place.add(&format!("{name}.off"), &shapes::cube(0));
    }
    place.add("two/<img src=x onerror=alert(1)>.off", &shapes::cube(0));
    place.done("duplicates all --csv d.csv");
    place.done("duplicates two --html d.html");
    let text = fs::read_to_string(place.path("d.csv")).unwrap();
    for cell in ["'=1+1,", "'+1,", "'-1,", "'@x,", "\"'\tx\",", "\"a,\"\"b\nc\","] {
        assert!(text.contains(&format!(",{cell}")), "{cell}: {text}");
    }
    assert!(![",=", ",+", ",-", ",@", ",\t"].iter().any(|start| text.contains(start)), "{text}");
    let page = fs::read_to_string(place.path("d.html")).unwrap();
    assert_eq!(page.matches("<img").count(), 2);
    assert!(!page.contains("<img src=x") && page.contains("&lt;img src=x") && !page.contains('\u{202e}'));
}

/// All files below a folder.
pub(crate) fn tree(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        match entry.file_type().unwrap().is_dir() {
            true => found.extend(tree(&entry.path())),
            false => drop(found.insert(entry.path(), fs::read(entry.path()).unwrap())),
        }
    }
    found
}

#[cfg(unix)]
#[test]
fn no_result_takes_the_place_of_what_it_is_made_from() {
    let place = Workplace::new();
    let mesh = body(0, 0);
    for name in ["x.off", "x.ply", "y.ply", "x-0.ply", "x-source.ply", "pair.vert", "sub/x.off"] {
        place.add(name, &mesh);
    }
    std::os::unix::fs::symlink("x.off", place.path("link.off")).unwrap();
    fs::hard_link(place.path("x.off"), place.path("hard.off")).unwrap();
    place.done("field build x.off -o x.field");
    fs::write(place.path("pairs.csv"), "0,1\n").unwrap();
    let before = tree(&place.path(""));
    for arguments in [
        "embed x.off -n 20 -o x.off",
        "embed x.off -n 20 -o ./x.off",
        "embed x.off -n 20 -o sub/../x.off",
        "embed x.off -n 20 -o link.off",
        "embed link.off -n 20 -o x.off",
        "embed hard.off -n 20 -o x.off",
        "embed x.ply -n 20 --extend x.off -o x.off",
        "embed x.off x.ply -n 20 -o . --output-format off",
        "convert x.off x.off",
        "convert --repair x.off ./x.off",
        "convert pair.vert pair.tri",
        "geodesic x.ply --source 0 -o x.ply",
        "geodesic x-0.ply --source 0,1 -o x.ply",
        "field build x.off -o x.off",
        "field query x.field --pairs pairs.csv -o pairs.csv",
        "match x.off x.ply -o x.ply",
        "match x-source.ply y.ply -o x.ply",
        "compare x.off x.ply --residual-mesh x.ply",
        "duplicates x.off --csv x.off",
    ] {
        let outcome = place.run(arguments);
        assert_eq!(outcome.code, 2, "{arguments}: {}", outcome.err);
        assert!(tree(&place.path("")) == before, "{arguments}: {}", outcome.err);
    }
    place.refused("convert x.off sub", &["cannot write sub: it is a folder", "sub/name."]);
    // What is no input is replaced as ever.
    place.done("embed x.off -n 20 -o y.ply");
    place.done("embed x.off -n 20 -o y.ply");
}

#[test]
fn duplicates_move_with_their_journal_and_come_back() {
    let place = Workplace::new();
    for name in ["x/part.off", "y/part.off", "c\ntouch pwned #.off", "$(touch pwned).off", "-rf.off"] {
        place.add(&format!("models/{name}"), &shapes::icosphere(1));
    }
    let before = tree(&place.path(""));
    let moved = place.json("duplicates models --move-to models/away");
    let n = |list: &serde_json::Value| list.as_array().unwrap().len();
    assert_eq!([&moved["groups"][0]["members"], &moved["moved"], &moved["not_moved"]].map(n), [4, 4, 0]);
    let journal = moved["journal"].as_str().unwrap();
    let after = tree(&place.path(""));
    assert_eq!(after.len(), before.len() + 1);
    // Nothing is left to move.
    assert_eq!(place.run("duplicates models --move-to models/away").code, 1);
    assert!(tree(&place.path("")) == after);
    let told = place.done(&["duplicates", "--undo", journal]).out;
    assert!(told.starts_with("4 files moved"), "{told}");
    assert!(tree(&place.path("")) == before);
    place.refused("duplicates models --move-to models", &["the meshes are in this folder"]);
    place.refused("duplicates models --move-to models/x", &["holds other files"]);
    place.refused("duplicates --undo models/x/part.off", &["no journal"]);
    place.done("index build models -n 20 -o i");
    place.refused("duplicates i --move-to away", &["out of folders"]);
    // Members of an archive are named, and stay.
    let mut zip = zip::ZipWriter::new(fs::File::create(place.path("all.zip")).unwrap());
    for name in ["m/a.off", "m/b.off"] {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        std::io::Write::write_all(&mut zip, &fs::read(place.path("models/x/part.off")).unwrap()).unwrap();
    }
    zip.finish().unwrap();
    let told = place.done("duplicates all.zip --move-to away").out;
    assert!(told.contains("not moved, since it is in an archive"), "{told}");
    assert!(!place.path("away").exists());
}

#[cfg(unix)]
#[test]
fn a_search_for_duplicates_leaves_nothing_behind() {
    let place = Workplace::new();
    (0..40).for_each(|i| place.add(&format!("models/{i}.off"), &body(i % 3, i)));
    (0..2).for_each(|i| place.add(&format!("few/{i}.off"), &body(0, 0)));
    place.add("one/broken.off", &shapes::icosphere(1));
    fs::write(place.path("one/broken.off"), "OFF\n").unwrap();
    fs::create_dir(place.path("t")).unwrap();
    let start = |arguments: &[&str]| {
        let mut command = Command::new(program());
        command.args(arguments).current_dir(place.path("")).env("TMPDIR", place.path("t"));
        command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    for signal in ["-INT", "-TERM"] {
        let mut child = start(&["duplicates", "models", "--threads", "1"]);
        while fs::read_dir(place.path("t")).unwrap().count() == 0 {
            assert!(child.try_wait().unwrap().is_none(), "it ended before it began");
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert_eq!(fs::read_dir(place.path("t")).unwrap().count(), 0, "{signal}");
    }
    // Also after a failure, and in the end.
    assert_eq!(start(&["duplicates", "one"]).wait().unwrap().code(), Some(2));
    assert_eq!(
        start(&["duplicates", "few", "--html", "no/such/folder.html"]).wait().unwrap().code(),
        Some(2)
    );
    assert_eq!(start(&["duplicates", "few", "--kinds", "file"]).wait().unwrap().code(), Some(0));
    assert_eq!(fs::read_dir(place.path("t")).unwrap().count(), 0);
}
