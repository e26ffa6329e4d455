//! Figures as data. What a figure shows is decided here once, for the static files and for the page.
//!
//! record -> [`Figure`] -> PNG, SVG and PDF by plotters ([`Figure::save`]), or JSON that the script of the page draws
//!
//! A figure consists of plots or of matrices of the same kind. Surfaces are [`Tiles`]: rendered images in rows.

mod axis;
mod drawing;
mod heat;
mod model;
mod pdf;
mod plot;
mod style;
#[cfg(test)]
mod tests;
mod tiles;
mod units;

pub use axis::PlotAxis;
pub(crate) use drawing::{Area, Bitmap, Drawn, INK, average, dark, drop_of, pixels, scaled_text, text_width};
pub(crate) use heat::bar_labels;
pub use model::{Figure, FigurePanels, GroupedValue, Heat, Plot, PlotPoint, PlotSeries, SeriesKind, grouped};
pub use plot::MAP_SIZE;
pub use style::SeriesStyle;
pub use tiles::{Tile, Tiles};

use std::path::{Path, PathBuf};

use crate::error::ReportError;

impl Figure {
    /// Draws the figure and returns the paths of its PNG, SVG and PDF: the stem, the part and the extension. On logarithmic
    /// axes, values that are not positive are left out. A figure of surfaces has no files here.
    ///
    /// # Errors
    /// [`ReportError::Draw`] or [`ReportError::File`] if drawing or writing fails.
    pub fn save(&self, stem: &Path) -> Result<Vec<PathBuf>, ReportError> {
        match &self.panels {
            FigurePanels::Plots(plots) => drawing::save(&plot::Plots(plots), stem, self.part),
            FigurePanels::Heats(heats) => drawing::save(&heat::Heats(heats), stem, self.part),
            FigurePanels::Surfaces => Ok(vec![]),
        }
    }
}
