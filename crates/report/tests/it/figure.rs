//! Laws of figures.

use base64::prelude::{BASE64_STANDARD, Engine};
use canonform_report::RgbaImage;
use canonform_report::color::perceptual;
use canonform_report::record::{
    Axis, AxisScale, FigurePanels, Heat, Mark, Plot, PlotPoint, Series, SeriesKind, TileRow, Tiles,
};

use crate::{assert_closed, assert_holds, figure, plot, tile};

fn drawn(panels: FigurePanels) -> String {
    let svg = figure(panels).svg().unwrap();
    assert_closed(&svg);
    svg
}

#[test]
fn files_are_the_same_every_time_and_have_the_size_of_the_drawing() {
    let folder = tempfile::tempdir().unwrap();
    let saved = || {
        figure(FigurePanels::Plots(vec![plot("a"), plot("b")])).save(folder.path(), "x").unwrap();
        std::fs::read_to_string(folder.path().join("x-part.svg")).unwrap()
    };
    let svg = saved();
    assert_eq!(saved(), svg);
    assert!(
        svg.starts_with("<svg width=\"1000\" height=\"") && svg.contains(" viewBox=\"0 0 4000 "),
        "{svg}"
    );
}

#[test]
fn series_over_categories_stand_beside_each_other_with_the_numbers_of_the_paper() {
    let one = |name: &str, kind, y| Series {
        name: name.to_owned(),
        kind,
        points: vec![PlotPoint::new(0.0, y, "")],
    };
    let marks = vec![Mark { x: 0.0, name: "david0".to_owned() }];
    let x = Axis { scale: AxisScale::Category, ..Axis::linear("") };
    let series = [
        ("NMDS", SeriesKind::Filled, 1.0),
        ("NMDS", SeriesKind::Hollow, 1.5),
        ("MDS", SeriesKind::Filled, 0.5),
    ];
    let series = series.map(|(name, kind, y)| one(name, kind, y)).to_vec();
    let svg = drawn(FigurePanels::Plots(vec![Plot { x, marks, series, ..plot("") }]));
    assert_holds(&svg, &["NMDS, paper", ">\nMDS\n", "david0"]);
    let places = svg.split("<circle cx=\"").skip(1).map(|rest| rest.split('"').next().unwrap());
    let places: Vec<i32> = places.map(|x| x.parse().unwrap()).collect();
    assert!(places[1] == places[2] && places[1] < places[0], "{places:?}");
}

#[test]
fn matrices_name_groups_once() {
    let names = ["cat", "cat", "a & <b>"].map(str::to_owned).to_vec();
    let values = vec![vec![0.0, 1.0, 5.0], vec![1.0, 0.0, 5.0], vec![5.0, 5.0, 0.0]];
    let quantity = Axis { unit: "form units".to_owned(), ..Axis::linear("distance") };
    let heat = Heat { title: "NMDS".to_owned(), names, values, quantity };
    let svg = drawn(FigurePanels::Heats(vec![heat.clone(), heat]));
    assert_holds(&svg, &["NMDS", "a &amp; &lt;b&gt;", "distance (form units)", "data:image/png;base64,"]);
    assert_eq!(svg.matches(">\ncat\n").count(), 4, "rows and columns of both");
}

#[test]
fn surfaces_are_pictures_over_their_captions() {
    let row = TileRow { name: "cats".to_owned(), tiles: vec![tile("cat0", false), tile("stress 2", true)] };
    let heads = ["shape", "form"].map(str::to_owned).to_vec();
    let svg = drawn(FigurePanels::Tiles(Tiles { is_paired: true, heads, rows: vec![row] }));
    assert_holds(&svg, &["cats", "cat0", "stress 2", "shape"]);
    let [background, image, text] = ["<rect", "<image", "<text"].map(|part| svg.find(part));
    assert!(background < image && image < text, "pictures are under the drawing");
}

#[test]
fn plots_name_their_axes_series_marks_and_points() {
    let svg = drawn(FigurePanels::Plots(vec![plot("david0")]));
    assert_holds(&svg, &["david0", "samples n", "error (m⁴)", "recommended", "NMDS", "a &amp; b"]);
    assert_holds(&svg, &["<title>a &amp; b: 300000 (210000 to 450000) at 10, 5 runs</title>"]);
    // Single points, and values that a logarithmic axis cannot show.
    let mut broken = plot("x");
    broken.series[0].points[0].low = 0.0;
    broken.series[0].points[1].y = -1.0;
    broken.series[1].points.truncate(1);
    drawn(FigurePanels::Plots(vec![broken]));
}

/// What a drawing of a curve through these values says besides the ticks of its other axis.
fn axis_texts(values: &[f64], scale: AxisScale) -> Vec<String> {
    let y = Axis { name: "length".into(), unit: "m".into(), scale };
    let points = values.iter().map(|y| PlotPoint::new(0.0, *y, "")).collect();
    let series = vec![Series { name: String::new(), kind: SeriesKind::Curve, points }];
    let x = Axis { scale: AxisScale::Category, ..Axis::linear("") };
    let svg = drawn(FigurePanels::Plots(vec![Plot { x, y, series, marks: vec![], title: String::new() }]));
    assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    let texts = svg.split("<text").skip(1).map(|text| text.split_once('>').unwrap().1);
    texts.map(|text| text.split("</text>").next().unwrap().trim().to_owned()).collect()
}

#[test]
fn logarithmic_ticks_are_powers_of_ten_unless_the_range_is_short() {
    for (ends, ticks) in [
        ([1e-3, 1e2], &["10⁻³", "10⁻²", "10⁻¹", "10⁰", "10¹", "10²"][..]),
        ([1e-20, 1.0], &["10⁻²⁰", "10⁻¹⁶", "10⁻¹²", "10⁻⁸", "10⁻⁴", "10⁰"]),
        ([3.0, 30.0], &["5", "10", "20"]),
        ([0.02, 5000.0], &["0.1", "1", "10", "100", "1000"]),
        ([2e4, 6e4], &["2·10⁴", "3·10⁴", "4·10⁴", "5·10⁴", "6·10⁴"]),
    ] {
        let texts = axis_texts(&ends, AxisScale::Log);
        let found: Vec<_> =
            texts.iter().filter(|text| !["", "length (m)"].contains(&text.as_str())).collect();
        assert_eq!(found, ticks, "{ends:?}");
    }
}

#[test]
fn cells_of_matrices_have_the_color_of_their_value() {
    let heat = Heat {
        title: String::new(),
        names: ["a", "b"].map(str::to_owned).to_vec(),
        values: vec![vec![0.0, 1.0], vec![1.0, 0.0]],
        quantity: Axis::linear("distance"),
    };
    let svg = drawn(FigurePanels::Heats(vec![heat]));
    let (data, _) = svg.split_once("base64,").unwrap().1.split_once('"').unwrap();
    let image = RgbaImage::from_png(&BASE64_STANDARD.decode(data).unwrap()).unwrap();
    let [low, high] = [0.0, 1.0].map(|value| {
        let is_near = |pixel: &[u8; 4]| pixel.iter().zip(perceptual(value)).all(|(a, b)| a.abs_diff(b) < 8);
        image.pixels().iter().filter(|pixel| is_near(pixel)).count() as f64
    });
    assert!(low > 0.0 && (high / low - 1.0).abs() < 0.05, "{low} {high}");
}
