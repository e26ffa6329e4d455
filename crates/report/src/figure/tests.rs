use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::HPos;

use super::drawing::*;
use crate::RgbaImage;
use crate::color::class_color;
use crate::error::ReportError;

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
fn all_files_have_the_size_of_the_drawing_and_the_same_bytes_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let files = save(&Sample([60, 30]), &folder.path().join("a"), ".b").unwrap();
    assert_eq!(files, [".png", ".svg", ".pdf"].map(|end| folder.path().join(format!("a.b{end}"))));
    let bytes = |files: &[std::path::PathBuf]| -> Vec<Vec<u8>> {
        files.iter().map(|file| std::fs::read(file).unwrap()).collect()
    };
    let drawn = bytes(&files);
    assert_eq!(drawn, bytes(&save(&Sample([60, 30]), &folder.path().join("again"), "").unwrap()));
    let png = png::Decoder::new(&drawn[0][..]).read_info().unwrap();
    assert_eq!((png.info().width, png.info().height), (120, 60));
    let svg = String::from_utf8_lossy(&drawn[1]);
    assert!(svg.starts_with("<svg width=\"60\" height=\"30\" viewBox=\"0 0 240 120\""), "{svg}");
    let pdf = String::from_utf8_lossy(&drawn[2]);
    assert!(pdf.contains("/MediaBox [0 0 30.24 15.12]") && pdf.trim_end().ends_with("%%EOF"));
}

#[test]
fn a_pdf_embeds_the_letters_it_uses_and_their_characters() {
    let folder = tempfile::tempdir().unwrap();
    let files = save(&Sample([60, 30]), &folder.path().join("a"), "").unwrap();
    let bytes = std::fs::read(&files[2]).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for part in ["/FontFile2", "/SMask", "<03C3>"] {
        assert!(text.contains(part), "{part}");
    }
    assert!(bytes.len() < 60_000, "the fonts are subsets: {}", bytes.len());
}

#[test]
fn an_svg_holds_its_text_and_pictures_and_follows_dark_mode() {
    let folder = tempfile::tempdir().unwrap();
    let files = save(&Sample([60, 30]), &folder.path().join("a"), "").unwrap();
    let svg = std::fs::read_to_string(&files[1]).unwrap();
    crate::tests::fixtures::assert_balanced(&svg);
    assert!(svg.contains("a &lt; b") && svg.contains("font-family=\"DejaVu Sans, "), "{svg}");
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
