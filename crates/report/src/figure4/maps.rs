//! Two-dimensional maps of the distances, one marker a shape, with the scores under each.

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::{COLUMN, WIDTH, corner, rows, title};
use crate::classes::Classes;
use crate::markers::draw_marker;
use crate::results::Figure4Panel;
use view::canvas::{
    Anchor, Canvas, DrawError, Drawing, GRID, INK, PALE_INK, RASTER, SMALL, TEXT, Type, style, text_width,
};
use view::numbers::{Numbers, signed};

/// The maps of one scale.
pub(super) struct Maps<'a> {
    pub(super) panels: Vec<&'a Figure4Panel>,
    pub(super) labels: &'a [String],
    pub(super) classes: &'a Classes<'a>,
}

/// A panel from top to bottom, in units: title, plot, axis labels, scores.
const TITLE_HEIGHT: f64 = 38.0;
const PLOT: (f64, f64) = (406.0, 340.0);
const LEFT: f64 = 74.0;
const AXIS: f64 = 54.0;
/// Ticks wanted at most.
const X_TICKS: usize = 7;
const Y_TICKS: usize = 6;
const SCORES: f64 = 66.0;
const PANEL: f64 = TITLE_HEIGHT + PLOT.1 + AXIS + SCORES;
/// Type of the legend, and height of its lines.
const LEGEND: Type = Type::new(TEXT, Anchor::Left);
const LEGEND_LINE: f64 = 28.0;

impl Drawing for Maps<'_> {
    fn size(&self) -> (u32, u32) {
        let legend = self.legend_lines().len() as f64 * LEGEND_LINE;
        (WIDTH as u32, (rows(self.panels.len()) * PANEL + legend + 14.0) as u32)
    }

    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), DrawError> {
        let legend_end = self.legend(canvas)?;
        for (i, panel) in self.panels.iter().enumerate() {
            self.panel(canvas, panel, corner(i, legend_end, PANEL))?;
        }
        Ok(())
    }
}

impl Maps<'_> {
    /// The classes of each line of the legend.
    fn legend_lines(&self) -> Vec<Vec<usize>> {
        let mut lines: Vec<Vec<usize>> = Vec::new();
        let mut used = f64::INFINITY;
        for class in 0..self.classes.len() {
            let width = self.legend_width(class);
            if used + width > WIDTH - 40.0 {
                lines.push(Vec::new());
                used = 0.0;
            }
            used += width;
            lines.last_mut().into_iter().for_each(|line| line.push(class));
        }
        lines
    }

    fn legend_width(&self, class: usize) -> f64 {
        52.0 + text_width(self.classes.name(class), LEGEND)
    }

    /// Draws the legend at the top and returns where it ends.
    fn legend<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<f64, DrawError> {
        let mut top = 6.0;
        for line in self.legend_lines() {
            let width: f64 = line.iter().map(|&class| self.legend_width(class)).sum();
            let mut left = (WIDTH - width) / 2.0 + 14.0;
            for class in line {
                let middle = top + LEGEND_LINE / 2.0;
                draw_marker(canvas, class, (canvas.px(left + 9.0), canvas.px(middle)))?;
                canvas.text(
                    self.classes.name(class),
                    (left + 24.0, middle),
                    Type::new(TEXT, Anchor::Left),
                )?;
                left += self.legend_width(class);
            }
            top += LEGEND_LINE;
        }
        Ok(top)
    }

    fn panel<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        panel: &Figure4Panel,
        (left, top): (f64, f64),
    ) -> Result<(), DrawError> {
        title(canvas, panel, (left + LEFT + PLOT.0 / 2.0, top + TITLE_HEIGHT / 2.0))?;
        let area = canvas.part((left, top + TITLE_HEIGHT), (LEFT + PLOT.0, PLOT.1 + AXIS));
        let [x, y] = equal_ranges(&panel.map);
        let mut chart = ChartBuilder::on(area.area())
            .set_label_area_size(LabelAreaPosition::Left, canvas.px(LEFT))
            .set_label_area_size(LabelAreaPosition::Bottom, canvas.px(AXIS))
            .build_cartesian_2d(x.clone(), y.clone())?;
        chart
            .configure_mesh()
            .x_labels(X_TICKS)
            .y_labels(Y_TICKS)
            .max_light_lines(0)
            .bold_line_style(GRID.stroke_width(canvas.px(1.0) as u32))
            .axis_style(PALE_INK.stroke_width(canvas.px(1.0) as u32))
            .set_all_tick_mark_size(canvas.px(4.0))
            // Numbers and names are written below, centred; without a font of ours plotters looks for its own.
            .label_style(style(Type::new(SMALL, Anchor::Center), RASTER))
            .x_label_formatter(&|_| String::new())
            .y_label_formatter(&|_| String::new())
            .draw()?;
        axis_labels(&area, [x, y], panel.scale.unit())?;
        for (point, label) in panel.map.iter().zip(self.labels) {
            draw_marker(canvas, self.classes.index(label), chart.backend_coord(&(point[0], point[1])))?;
        }
        scores(canvas, panel, (left, top + TITLE_HEIGHT + PLOT.1 + AXIS))
    }
}

/// Ranges of both axes that show all points with one scale, so that distances on paper are true.
fn equal_ranges(points: &[[f64; 2]]) -> [std::ops::Range<f64>; 2] {
    let low: [f64; 2] = std::array::from_fn(|i| points.iter().map(|p| p[i]).fold(f64::INFINITY, f64::min));
    let high: [f64; 2] =
        std::array::from_fn(|i| points.iter().map(|p| p[i]).fold(f64::NEG_INFINITY, f64::max));
    let plot = [PLOT.0, PLOT.1];
    let per_unit = ((high[0] - low[0]) / plot[0]).max((high[1] - low[1]) / plot[1]) * 1.14;
    // All points in one place: any scale that can still tell the ends of the range apart.
    let smallest = 1e-6 * low.iter().chain(&high).fold(0.0_f64, |m, v| m.max(v.abs()));
    let per_unit = if per_unit > smallest { per_unit } else { smallest.max(1.0 / plot[0]) };
    std::array::from_fn(|i| {
        let (middle, half) = (low[i] + (high[i] - low[i]) / 2.0, per_unit * plot[i] / 2.0);
        middle - half..middle + half
    })
}

/// Writes the numbers at the ticks and the names of both axes around the plot in `area`.
fn axis_labels<DB: DrawingBackend>(
    area: &Canvas<DB>,
    [x, y]: [std::ops::Range<f64>; 2],
    unit: &str,
) -> Result<(), DrawError> {
    let across = RangedCoordf64::from(x.clone()).key_points(X_TICKS);
    let upwards = RangedCoordf64::from(y.clone()).key_points(Y_TICKS);
    let numbers = Numbers::for_ticks(&[across.as_slice(), &upwards].concat());
    for tick in across {
        let along = LEFT + PLOT.0 * (tick - x.start) / (x.end - x.start);
        area.text(&numbers.write(tick), (along, PLOT.1 + 15.0), Type::new(SMALL, Anchor::Center))?;
    }
    for tick in upwards {
        let along = PLOT.1 * (y.end - tick) / (y.end - y.start);
        area.text(&numbers.write(tick), (LEFT - 9.0, along), Type::new(SMALL, Anchor::Right))?;
    }
    let unit = numbers.unit(unit);
    let name = Type::new(TEXT, Anchor::Center);
    area.text(&format!("MDS axis 1 ({unit})"), (LEFT + PLOT.0 / 2.0, PLOT.1 + 38.0), name)?;
    area.text(&format!("MDS axis 2 ({unit})"), (13.0, PLOT.1 / 2.0), name.up())
}

/// Writes the scores of a panel as a small table in a column that starts at `left`.
fn scores<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    panel: &Figure4Panel,
    (left, top): (f64, f64),
) -> Result<(), DrawError> {
    let s = &panel.scores;
    let number = |v: f64| signed(v, 3);
    let columns = [
        ("NN", number(s.mean.nn)),
        ("FT", number(s.mean.ft)),
        ("ST", number(s.mean.st)),
        ("DCG", number(s.mean.dcg)),
        ("mAP", number(s.mean.map)),
        ("silhouette", number(s.silhouette)),
        ("map silh.", number(panel.map_silhouette)),
        ("map stress", number(panel.map_stress)),
    ];
    let kind = Type::new(SMALL, Anchor::Center);
    let widths = columns.each_ref().map(|(name, value)| text_width(name, kind).max(text_width(value, kind)));
    let room = COLUMN - 16.0;
    let gap = (room - widths.iter().sum::<f64>()) / widths.len() as f64;
    let mut at = left + (COLUMN - room) / 2.0;
    for ((name, value), width) in columns.iter().zip(widths) {
        let middle = at + (width + gap) / 2.0;
        canvas.text(name, (middle, top + 20.0), kind.pale())?;
        canvas.text(value, (middle, top + 42.0), kind)?;
        at += width + gap;
    }
    let rule =
        |y: f64, color| canvas.line((left + 10.0, top + y), (left + COLUMN - 10.0, top + y), 1.0, color);
    rule(8.0, INK)?;
    rule(31.0, GRID)?;
    rule(54.0, INK)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_axes_have_one_scale_and_hold_all_points() {
        for points in [
            vec![[0.0, 0.0], [10.0, 1.0]],
            vec![[5.0, -3.0], [5.0, 40.0]],
            vec![[7.0, 7.0]],
            vec![[1e9, 1e9]],
        ] {
            let [x, y] = equal_ranges(&points);
            let scales = [(x.end - x.start) / PLOT.0, (y.end - y.start) / PLOT.1];
            assert!(scales[0] > 0.0 && (scales[0] / scales[1] - 1.0).abs() < 1e-9, "{scales:?}");
            assert!(points.iter().all(|p| x.contains(&p[0]) && y.contains(&p[1])));
        }
    }
}
