use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::HPos;

use super::drawing::*;
use crate::RgbaImage;
use crate::color::class_color;
use crate::error::ReportError;
use crate::tests::fixtures::{assert_balanced, assert_holds};

/// Words of every look, a line and a translucent picture.
struct Sample([i32; 2]);

impl Drawing for Sample {
    fn size(&self) -> [i32; 2] {
        self.0
    }

    fn pictures(&self) -> Result<Vec<Picture>, ReportError> {
        Ok(vec![(RgbaImage::new(20, 10, [200, 0, 0, 128]), [30, 15])])
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        write(area, "a < b", anchored(text(NAME, INK), HPos::Left), [5.0, 15.0])?;
        write(area, "stress σ₁⁴", bold(text(TITLE, class_color(0))), [30.0, 20.0])?;
        write(area, "up", upwards(text(LABEL, PALE_INK)), [50.0, 20.0])?;
        line(area, [0.0, 0.0], [60.0, 30.0], 1.0, GRID)
    }
}

#[test]
fn files_have_the_size_of_the_drawing_its_text_and_pictures_and_the_same_bytes_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let saved = |name: &str, part: &str| {
        let files = save(&Sample([60, 30]), &folder.path().join(name), part).unwrap();
        let ends = [".png", ".svg", ".pdf"];
        assert_eq!(files, ends.map(|end| folder.path().join(format!("{name}{part}{end}"))));
        ends.map(|end| std::fs::read(folder.path().join(format!("{name}{part}{end}"))).unwrap())
    };
    let [png, svg, pdf] = saved("a", ".b");
    assert!([&png, &svg, &pdf].into_iter().eq(&saved("again", "")));
    let png = png::Decoder::new(&png[..]).read_info().unwrap();
    assert_eq!((png.info().width, png.info().height), (120, 60));
    assert!(pdf.len() < 60_000, "the fonts are subsets: {}", pdf.len());
    let pdf = String::from_utf8_lossy(&pdf);
    assert_holds(&pdf, &["/MediaBox [0 0 30.24 15.12]", "/FontFile2", "/SMask", "<03C3>"]);
    assert!(pdf.trim_end().ends_with("%%EOF"));
    let svg = String::from_utf8(svg).unwrap();
    assert_balanced(&svg);
    assert!(svg.starts_with("<svg width=\"60\" height=\"30\" viewBox=\"0 0 240 120\""), "{svg}");
    assert_holds(&svg, &["a &lt; b", "font-family=\"DejaVu Sans, "]);
    let [background, image, first_text] =
        ["<rect", "<image x=\"120\" y=\"60\"", "<text"].map(|part| svg.find(part));
    assert!(background < image && image < first_text, "pictures are under the drawing: {svg}");
    let dark = dark(&svg);
    assert!(dark.contains("prefers-color-scheme:dark") && dark.find("<style>") < dark.find("<rect"));
    for color in ["#222222", "#696969", "#E4E4E4", "#FFFFFF"] {
        assert!(svg.contains(color) && dark.contains(&format!("[fill=\"{color}\"]")), "{color}");
    }
}

#[test]
fn a_failing_drawing_is_an_error_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let error = save(&Sample([0, 30]), &folder.path().join("empty"), "").unwrap_err();
    assert!(matches!(error, ReportError::Draw { .. }), "{error}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn text_width_grows_with_the_text_and_its_weight() {
    let style = text(NAME, INK);
    assert_eq!(text_width("", &style), 0.0);
    let digit = text_width("0", &style) / f64::from(PX) / NAME;
    assert!((digit - 0.636).abs() < 0.02, "a digit of DejaVu Sans is 0.636 em wide: {digit}");
    assert!(text_width("wide", &bold(style.clone())) > text_width("wide", &style));
}

#[test]
fn averaging_halves_an_image() {
    let row = [0, 10, 20, 100, 110, 121, 8, 8, 8, 8, 8, 8];
    assert_eq!(average(&[row, row].concat(), 4, 2), [50, 60, 71, 8, 8, 8]);
}
