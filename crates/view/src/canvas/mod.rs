//! A drawing as a list of elements, which becomes a PNG, an SVG and a PDF of the same content.
//!
//! Drawings are measured in **units**: [`PAGE_WIDTH`] of them are as wide as the text of a printed page (7 inches), so
//! a type size of 16 units prints at 8 points. Rasters have a whole number of pixels per unit.

mod bitmap;
mod drawing;
mod pdf;
mod svg;

use std::path::{Path, PathBuf};

use files::write_bytes;

use crate::error::ViewError;
pub use bitmap::text_width;
pub use drawing::{
    Anchor, Canvas, GRID, INK, PAGE_WIDTH, PALE_INK, PAPER, PIXELS_PER_UNIT, Point, TextStyle,
};
pub use svg::dark;

impl Canvas {
    /// Writes a PNG, an SVG and a PDF and returns their paths: the stem, the part and the extension.
    ///
    /// # Errors
    /// [`ViewError::Draw`] when drawing fails, [`ViewError::File`] when a file cannot be written.
    pub fn save(&self, stem: &Path, part: &str) -> Result<Vec<PathBuf>, ViewError> {
        let failed = |reason: String| ViewError::draw(stem.display(), reason);
        let png = bitmap::png(self).map_err(|e| failed(e.0))?;
        let svg = svg::svg(self).map_err(|e| failed(e.to_string()))?.into_bytes();
        let pdf = pdf::pdf(self).map_err(failed)?;
        let write = |(extension, bytes): (&str, Vec<u8>)| {
            let mut name = stem.as_os_str().to_owned();
            name.push(part);
            name.push(extension);
            let path = PathBuf::from(name);
            write_bytes(&path, &bytes)?;
            Ok(path)
        };
        [(".png", png), (".svg", svg), (".pdf", pdf)].into_iter().map(write).collect()
    }

    /// The share of every pixel that a black drawing covers, 0 to 255, row by row, with one pixel per unit.
    ///
    /// # Errors
    /// [`ViewError::Draw`] when drawing fails.
    pub fn coverage(&self) -> Result<Vec<u8>, ViewError> {
        let pixels = bitmap::pixels(self, 1).map_err(|e| ViewError::draw("a drawing", e.0))?;
        Ok(pixels.chunks_exact(3).map(|p| 255 - p[1]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drawing with one word on it.
    fn word(width: u32, height: u32) -> Canvas {
        let mut canvas = Canvas::new(width, height);
        canvas.text("word", (5.0, 15.0), TextStyle::NAME.at(Anchor::Left));
        canvas
    }

    #[test]
    fn all_files_have_the_size_of_the_canvas() {
        let folder = tempfile::tempdir().unwrap();
        let files = word(60, 30).save(&folder.path().join("a"), ".b").unwrap();
        assert_eq!(files, [".png", ".svg", ".pdf"].map(|end| folder.path().join(format!("a.b{end}"))));
        let png = png::Decoder::new(std::fs::File::open(&files[0]).unwrap()).read_info().unwrap();
        assert_eq!((png.info().width, png.info().height), (120, 60));
        let svg = std::fs::read_to_string(&files[1]).unwrap();
        assert!(svg.contains("width=\"60\" height=\"30\" viewBox=\"0 0 60 30\""), "{svg}");
        let pdf = std::fs::read(&files[2]).unwrap();
        assert!(String::from_utf8_lossy(&pdf).contains("/MediaBox [0 0 30.24 15.12]"));
    }

    #[test]
    fn a_failing_drawing_is_an_error_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = word(0, 30).save(&folder.path().join("empty"), "").unwrap_err();
        assert!(matches!(error, ViewError::Draw { .. }), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
