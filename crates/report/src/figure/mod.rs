//! Figures of records, drawn by plotters.
//!
//! [`Figure`] -> SVG, as a file ([`Figure::save`]) or in the page ([`Figure::svg`]), which names points on hover.

mod axis;
mod drawing;
mod heat;
mod plot;
mod tiles;

pub(crate) use axis::PlotAxis;
pub(crate) use drawing::{
    Area, Bitmap, Drawn, INK, average, bar_labels, dark_rules, drop_of, pixels, scaled_text, text_width,
};

use std::path::Path;

use base::files::write_bytes;

use crate::error::ReportError;
use crate::record::{Figure, FigurePanels};

impl Figure {
    /// Writes the figure as SVG. On logarithmic axes, values that are not positive are left out.
    ///
    /// # Errors
    /// [`ReportError::Draw`] or [`ReportError::File`] if drawing or writing fails.
    pub fn save(&self, folder: &Path, name: &str) -> Result<(), ReportError> {
        let path = folder.join(format!("{name}-{}.svg", self.part));
        Ok(write_bytes(&path, self.svg()?.as_bytes())?)
    }

    /// The text of the figure as SVG.
    ///
    /// # Errors
    /// [`ReportError::Draw`] if drawing fails.
    pub fn svg(&self) -> Result<String, ReportError> {
        let svg = match &self.panels {
            FigurePanels::Plots(plots) => drawing::svg(&plot::Plots::new(plots)),
            FigurePanels::Heats(heats) => drawing::svg(&heat::Heats(heats)),
            FigurePanels::Tiles(tiles) => drawing::svg(tiles),
        };
        svg.map_err(|e| ReportError::draw(&self.part, e))
    }
}
