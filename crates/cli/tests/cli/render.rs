//! `render`: pictures of meshes, fields and forms.

use std::fs;

use report::RgbaImage;

use crate::support::{Workplace, broken_ring, ring};

fn place() -> Workplace {
    let place = Workplace::new();
    place.add("ring.off", &ring());
    place
}

fn pixels(place: &Workplace, name: &str) -> RgbaImage {
    RgbaImage::from_png(&fs::read(place.path(name)).unwrap()).unwrap()
}

fn drawn(place: &Workplace, options: &str) -> Vec<[u8; 4]> {
    place.done(format!("render ring.off --size 200 -o x.png {options}"));
    pixels(place, "x.png").pixels().to_vec()
}

#[test]
fn every_option_changes_the_picture() {
    let place = place();
    let json = place.json("render ring.off --size 90x60 -o x.png");
    assert_eq!([&json["width"], &json["height"], &json["n_faces"]], [90, 60, 320]);
    let seen = pixels(&place, "x.png");
    assert_eq!((seen.width(), seen.height(), seen.pixels()[0]), (90, 60, [255; 4]));
    let mut pictures: Vec<_> = [
        "--view top",
        "--view front",
        "--view=-40,25",
        "--view=-40,25 --up y",
        "--background transparent",
        "--background #102030",
        "--background dark",
        "--color #ff0000",
        "--distance-from 3",
        "--distance-from 3 --no-bar",
        "--distance-from 3 --isolines 5",
        "--distance-from 3,90",
        "--form",
    ]
    .map(|options| drawn(&place, options))
    .to_vec();
    assert_eq!(pictures[1], drawn(&place, "--view 0,0"));
    assert_eq!((pictures[4][0][3], pictures[5][0]), (0, [16, 32, 48, 255]));
    assert!(pictures[7].iter().any(|p| p[0] > 150 && p[1] < 80), "red");
    let n = pictures.len();
    pictures.sort_unstable();
    pictures.dedup();
    assert_eq!(pictures.len(), n);
}

#[test]
fn distances_and_the_same_numbers_from_files_give_the_same_picture() {
    let place = place();
    place.done("geodesic ring.off --source 3,90 -o two.npy");
    place.done("geodesic ring.off --source 90 -o one.csv");
    let asked = drawn(&place, "--distance-from 90 --isolines 5 --no-bar");
    for field in ["two.npy --row 1", "one.csv"] {
        assert!(asked == drawn(&place, &format!("--field {field} --isolines 5 --no-bar")), "{field}");
    }
    let narrow = place.json("render ring.off --distance-from 3 --range 0,1 --size 60 -o n.png");
    assert_eq!(narrow["field"]["range"], serde_json::json!([0.0, 1.0]));
    assert_eq!((&narrow["field"]["values"][0], &narrow["field"]["missing"]), (&0.0.into(), &0.into()));
    // One number per line is a field too.
    let row = fs::read_to_string(place.path("one.csv")).unwrap();
    fs::write(place.path("column.csv"), row.replace(',', "\n")).unwrap();
    assert!(asked == drawn(&place, "--field column.csv --isolines 5 --no-bar"));
}

#[test]
fn what_a_repair_dropped_is_gray_counted_and_drawn_the_same_with_any_number_of_threads() {
    let place = place();
    place.add("broken.off", &broken_ring());
    let draw = "render broken.off --distance-from 0 --size 60";
    let json = place.json(format!("{draw} --form -o x.png"));
    assert_eq!((&json["field"]["missing"], &json["repair"]["dropped_components"]), (&10.into(), &1.into()));
    let [text, again] = [1, 2].map(|n| place.done(format!("{draw} --threads {n} -o {n}.png")).out);
    assert!([text, again].iter().all(|text| text.contains("10 vertices without a finite value")));
    assert_eq!(fs::read(place.path("1.png")).unwrap(), fs::read(place.path("2.png")).unwrap());
    fs::write(place.path("nan.csv"), vec!["nan"; 160].join(",")).unwrap();
    let gray = drawn(&place, "--field nan.csv --background transparent");
    assert!(gray.iter().filter(|p| p[3] == 255).all(|p| p[0].abs_diff(p[2]) < 30));
}
