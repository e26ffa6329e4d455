//! Names that a shell, a spreadsheet, a browser or a terminal might obey, and files that stay.

use std::fs;

use canonform::mesh::shapes;
use serde_json::Value;

use crate::index::body;
use crate::support::Workplace;

/// A line break, codes of terminals in 7 and in 8 bits, a reversed direction, and a formula.
const HOSTILE: [&str; 4] = [
    "a\nINJECTED \u{1b}]0;title\u{7}\u{1b}[2J.off",
    "b\r\u{9b}31m\u{85}\u{7f}.off",
    "c\u{202e}ffo.\u{2066}\u{2028}INJECTED\t.off",
    "=d|' !A0.off",
];

/// What people read holds no code, and no name begins a line.
fn assert_plain(what: &str, text: &str) {
    let is_code =
        |c: char| c.is_control() && c != '\n' && c != '\t' || "\u{202e}\u{2066}\u{2028}".contains(c);
    assert!(!text.contains(is_code), "{what}: {text:?}");
    assert!(!text.lines().any(|line| line.trim_start().starts_with("INJECTED")), "{what}: {text}");
}

#[test]
#[ignore = "slow: make test-all"]
fn no_output_for_people_obeys_a_name() {
    let place = Workplace::new();
    let class = "all/cats\u{1b}[31m\nINJECTED";
    for (i, name) in HOSTILE.iter().enumerate() {
        for (path, kind) in [(format!("{class}/{name}"), 0), (format!("all/dogs\u{202e}/{name}"), 1)] {
            place.add(&path, &body(kind, i));
        }
        place.add(&format!("{class}/copy of {name}"), &body(0, i));
    }
    fs::write(place.path(&format!("{class}/broken\u{1b}[2J\nINJECTED.off")), "OFF\n1").unwrap();
    fs::write(place.path("labels\u{1b}[2J\nINJECTED.csv"), "x\u{1b}[2J,y\n\u{9b}z\n").unwrap();
    let id = format!("{}/{}", &class[4..], HOSTILE[0].strip_suffix(".off").unwrap());
    // `~` stands for codes and a line break, `A` to `D` for the meshes, `ID` for the name of the first in the index.
    let word = |word: &str| match word {
        "A" | "B" | "C" | "D" => format!("{class}/{}", HOSTILE[usize::from(word.as_bytes()[0] - b'A')]),
        "ID" => id.clone(),
        _ => word.replace('~', "\u{1b}[2J\nINJECTED"),
    };
    for command in [
        "index build all -n 20 -o i~",
        "index build all -n 20 -o i~ --labels labels~.csv",
        "index build all -n 30 -o i~",
        "index list i~",
        "index info i~ --details",
        "index verify i~",
        "index add i~ A no~.off",
        "index remove i~ none~",
        "index merge i~ -o merged~",
        "info A B C D no~.off all",
        "compare A B --details -n 20",
        "compare A no~.off",
        "search i~ B --explain",
        "search i~ ID no~.off",
        "search i~ no~.off",
        "duplicates all --csv d.csv --html d.html",
        "duplicates all --kinds geometry,pose --move-to away~",
        "duplicates --undo away~/canonform-moved.jsonl",
        "duplicates --undo no~.off",
        "evaluate i~ --details",
        "embed A -n 20 -o form~.ply",
        "embed all -n 20 -o forms~",
        "embed A -n 20 -o A",
        "convert A o~.ply",
        "convert A no~/o.ply",
        "geodesic A --source 0 -o g~.ply",
        "geodesic A --source 999999 -o g.ply",
        "match A B -o m~.ply",
        "render A -o r~.png",
        "field build A -o f~.field",
        "field info f~.field",
        "methods A -n 20",
        "generate --family cat --poses 1 --vertices 1000 -o gen~",
        "info A --components ~",
    ] {
        let words: Vec<String> = command.split(' ').map(word).collect();
        let outcome = place.run(&words[..]);
        assert!((0..=2).contains(&outcome.code), "{command}: {}", outcome.err);
        assert!(!outcome.out.is_empty() || !outcome.err.is_empty(), "{command}");
        let mut texts = vec![outcome.out, outcome.err];
        // JSON says the same names, without codes.
        if !["methods", "match", "render", "generate", "embed"].contains(&&*words[0]) {
            let json = place.run(&[&words[..], &["--json".to_owned()]].concat()[..]);
            texts.extend([json.out, json.err]);
        }
        texts.iter().for_each(|text| assert_plain(command, text));
    }
    // Names in JSON are whole, and an export for programs says them as they are.
    let index = word("i~");
    let listed = place.json(&["index", "list", &index][..]);
    assert!(listed["shapes"].as_array().unwrap().iter().any(|shape| shape["id"] == *id), "{listed}");
    let table = place.done(&["index", "export", &index, "--output-format", "jsonl"][..]).out;
    assert!(table.lines().any(|line| serde_json::from_str::<Value>(line).unwrap()["id"] == *id));
}

#[test]
fn tables_for_people_hold_no_formula_and_pages_no_markup() {
    let place = Workplace::new();
    for name in ["=1+1", "\u{202e}x", "<img src=x onerror=alert(1)>"] {
        place.add(&format!("all/{name}.off"), &shapes::cube(0));
    }
    place.done("duplicates all --csv d.csv --html d.html");
    let text = fs::read_to_string(place.path("d.csv")).unwrap();
    assert!(text.contains(",'=1+1,") && !text.contains(",="), "{text}");
    let page = fs::read_to_string(place.path("d.html")).unwrap();
    assert_eq!(page.matches("<img").count(), 3);
    assert!(!page.contains("<img src=x") && page.contains("&lt;img src=x") && !page.contains('\u{202e}'));
}

#[test]
fn duplicates_in_an_archive_are_named_and_stay() {
    let place = Workplace::new();
    let part = testkit::written("a.off", &shapes::icosphere(1));
    let archive = testkit::zip_of(&["m/a.off", "m/b.off"].map(|name| (name, &part)));
    fs::write(place.path("all.zip"), &archive).unwrap();
    let told = place.done("duplicates all.zip --move-to away").out;
    assert!(told.contains("not moved, since it is in an archive"), "{told}");
    assert!(fs::read(place.path("all.zip")).unwrap() == archive);
}
