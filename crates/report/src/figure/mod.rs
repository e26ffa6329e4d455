//! Figures as data. What a figure shows is decided here once, for the static files and for the page.
//!
//! record -> [`Figure`] -> PNG, SVG and PDF ([`Figure::save`]), or JSON that the script of the page draws
//!
//! A figure consists of plots or of matrices of the same kind. Surfaces are [`Tiles`]: rendered images in rows.

mod axis;
mod groups;
mod heat;
mod model;
mod plot;
mod style;
mod tiles;

pub use axis::Axis;
pub use groups::{Group, grouped};
pub use model::{Content, Figure, Heat, Plot, Point, Series, Shape};
pub use plot::MAP_SIZE;
pub use style::Style;
pub use tiles::{Layout, Tile, Tiles};

use std::path::{Path, PathBuf};

use crate::error::ReportError;

impl Figure {
    /// Draws the figure and returns the paths of its PNG, SVG and PDF: the stem, the part and the extension. On logarithmic
    /// axes, values that are not positive are left out. A figure of surfaces has no files here.
    ///
    /// # Errors
    /// [`ReportError::View`] if drawing or writing fails.
    pub fn save(&self, stem: &Path) -> Result<Vec<PathBuf>, ReportError> {
        let canvas = match &self.content {
            Content::Plots(plots) => plot::draw(plots),
            Content::Heats(heats) => heat::draw(heats),
            Content::Surfaces => return Ok(vec![]),
        };
        Ok(canvas.save(stem, self.part)?)
    }
}
