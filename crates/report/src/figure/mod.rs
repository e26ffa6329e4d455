//! Figures of records, drawn by plotters.
//!
//! [`Figure`] -> PNG and SVG files ([`Figure::save`]), or SVG in the page ([`Figure::svg`]), which names points on hover.

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
    /// Draws the figure as PNG and as SVG. On logarithmic axes, values that are not positive are left out.
    ///
    /// # Errors
    /// [`ReportError::Draw`] or [`ReportError::File`] if drawing or writing fails.
    pub fn save(&self, folder: &Path, name: &str) -> Result<(), ReportError> {
        let png = match &self.panels {
            FigurePanels::Plots(plots) => drawing::png(&plot::Plots::new(plots)),
            FigurePanels::Heats(heats) => drawing::png(&heat::Heats(heats)),
            FigurePanels::Tiles(tiles) => drawing::png(tiles),
        };
        write_bytes(&self.file(folder, name, "png"), &png.map_err(|e| ReportError::draw(name, e))?)?;
        Ok(write_bytes(&self.file(folder, name, "svg"), self.svg()?.as_bytes())?)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Axis, AxisScale, Heat, Mark, Plot, PlotPoint, Series, SeriesKind, TileRow, Tiles};
    use crate::tests::{assert_closed, assert_holds, figure, plot, tile};

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
            ["png", "svg"].map(|end| std::fs::read(folder.path().join(format!("x-part.{end}"))).unwrap())
        };
        let [png, svg] = saved();
        assert_eq!(saved(), [png.clone(), svg.clone()]);
        let svg = String::from_utf8(svg).unwrap();
        let png = png::Decoder::new(&png[..]).read_info().unwrap();
        let height = png.info().height / 2;
        assert!(
            svg.starts_with(&format!("<svg width=\"1000\" height=\"{height}\" viewBox=\"0 0 4000 ")),
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
        let row =
            TileRow { name: "cats".to_owned(), tiles: vec![tile("cat0", false), tile("stress 2", true)] };
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
        // Dark pages have rules for the colors of drawings.
        let rules = dark_rules();
        for color in ["#222222", "#696969", "#E4E4E4", "#FFFFFF"] {
            assert!(svg.contains(color) && rules.contains(&format!("[fill=\"{color}\"]")), "{color}");
        }
        // Single points, and values that a logarithmic axis cannot show.
        let mut broken = plot("x");
        broken.series[0].points[0].low = 0.0;
        broken.series[0].points[1].y = -1.0;
        broken.series[1].points.truncate(1);
        drawn(FigurePanels::Plots(vec![broken]));
    }
}
