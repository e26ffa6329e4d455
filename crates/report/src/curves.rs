//! Figures of curves: medians of repeated runs as lines, the range of the runs as bands.

use crate::classes::Classes;
use crate::error::ReportError;
use crate::figure::{Figure, FigurePanels, Plot, PlotPoint, PlotSeries, SeriesKind, SeriesStyle};
use crate::record::Results;
use crate::results::{CurvesPanel, CurvesResults, Series, SeriesPoint};
use crate::table::{Cell, Table, significant};
use crate::tables::shown;

/// The distinct names of the series of all panels.
fn series_names(panels: &[CurvesPanel]) -> Classes<'_> {
    Classes::of(panels.iter().flat_map(|panel| panel.series.iter().map(|series| series.name.as_str())))
}

impl Results for CurvesResults {
    fn validate(&self) -> Result<(), ReportError> {
        let is_empty = |panel: &CurvesPanel| panel.series.iter().all(|series| series.points.is_empty());
        if self.panels.is_empty() || self.panels.iter().any(is_empty) {
            return Err(ReportError::Empty { figure: "a figure of curves", unit: "point in each panel" });
        }
        for panel in &self.panels {
            for series in &panel.series {
                for point in &series.points {
                    for value in [point.x, point.median, point.low, point.high] {
                        ReportError::check_finite(value, || {
                            format!("a point of {} in {} at {}", series.name, panel.title, point.x)
                        })?;
                    }
                }
            }
            for mark in &panel.marks {
                ReportError::check_finite(mark.x, || format!("the mark {} in {}", mark.name, panel.title))?;
            }
        }
        Ok(())
    }

    fn figures(&self) -> Vec<Figure> {
        let names = series_names(&self.panels);
        let series = |series: &Series| PlotSeries {
            name: series.name.clone(),
            style: SeriesStyle(names.index(&series.name)),
            kind: SeriesKind::Curve,
            points: series
                .points
                .iter()
                .map(|p| PlotPoint {
                    x: p.x,
                    y: p.median,
                    low: p.low,
                    high: p.high,
                    note: format!("{} runs", p.runs),
                })
                .collect(),
        };
        let plot = |panel: &CurvesPanel| {
            let mut series: Vec<PlotSeries> = panel.series.iter().map(series).collect();
            series.sort_by_key(|series| series.style.0);
            let label = format!("{}: {}", self.caption, panel.title);
            Plot::new(&panel.title, label, &panel.x, &panel.y, series, panel.marks.clone())
        };
        let plots = self.panels.iter().map(plot).collect();
        vec![Figure { part: "-curves", caption: self.caption.clone(), panels: FigurePanels::Plots(plots) }]
    }

    /// The tables of the record, and one per panel with every point of every curve.
    fn tables(&self) -> Vec<Table> {
        let table = |panel: &CurvesPanel| {
            let points = panel.series.iter().flat_map(|s| s.points.iter().map(move |p| (&s.name, p)));
            let row = |(name, p): (&String, &SeriesPoint)| {
                let mut row = vec![Cell::text(name)];
                row.extend([p.x, p.median, p.low, p.high].map(|v| Cell::number(significant(v))));
                row.push(Cell::number(p.runs));
                row
            };
            let unit = if panel.y.unit.is_empty() { String::new() } else { format!(", in {}", panel.y.unit) };
            let headings = ["method", panel.x.name.as_str(), "median", "least", "greatest", "runs"];
            Table::new(format!("{}{unit}.", panel.y.name), headings, points.map(row).collect())
                .folded(&panel.title)
        };
        self.tables.iter().map(shown).chain(self.panels.iter().map(table)).collect()
    }

    /// The first table of the record or, without one, the medians of all curves side by side, one row per panel and place on
    /// the horizontal axis.
    fn summary(&self) -> Option<Table> {
        if let Some(table) = self.tables.first() {
            return Some(shown(table));
        }
        let names = series_names(&self.panels);
        let rows = self.panels.iter().flat_map(|panel| {
            let mut places: Vec<f64> =
                panel.series.iter().flat_map(|s| s.points.iter().map(|p| p.x)).collect();
            places.sort_by(f64::total_cmp);
            places.dedup();
            let names = &names;
            places.into_iter().map(move |x| {
                let median = |name: &&str| {
                    let series = panel.series.iter().find(|s| s.name == **name);
                    let point = series.and_then(|s| s.points.iter().find(|p| p.x == x));
                    Cell::optional(point.map(|p| significant(p.median)))
                };
                let mut row = vec![Cell::text(&panel.title), Cell::text(significant(x))];
                row.extend(names.names().iter().map(median));
                row
            })
        });
        let across = self.panels.first().map_or("", |panel| panel.x.name.as_str());
        let headings = ["", across].into_iter().chain(names.names().iter().copied());
        Some(Table::new(&self.caption, headings, rows.collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::save;
    use crate::results::Record;
    use crate::tests::fixtures::curves_record;

    #[test]
    fn single_panels_and_values_that_are_not_positive_can_be_drawn() {
        let mut record = curves_record();
        record.results.panels.truncate(1);
        record.results.panels[0].series[0].points[0].low = 0.0;
        record.results.panels[0].series[0].points[1].median = -1.0;
        save(&record, tempfile::tempdir().unwrap().path(), "x").unwrap();
    }

    #[test]
    fn records_without_a_point_or_with_a_point_that_is_not_finite_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let fault =
            |record: &Record<CurvesResults>| save(record, folder.path(), "x").unwrap_err().to_string();
        assert!(fault(&Record::<CurvesResults>::default()).contains("nothing to draw"));
        let mut record = curves_record();
        record.results.panels[1].series[0].points[0].high = f64::NAN;
        assert!(fault(&record).contains("NMDS in cat0"));
        record = curves_record();
        record.results.panels[0].marks[0].x = f64::INFINITY;
        assert!(fault(&record).contains("the mark recommended"));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn the_summary_sets_medians_side_by_side_with_dashes_for_gaps() {
        let mut record = curves_record();
        record.results.panels[1].series[1].points.remove(0);
        let text = record.results.summary().unwrap().to_text();
        assert_eq!(text.lines().count(), 1 + 6, "{text}");
        assert!(text.contains("samples n") && text.contains("1.0e4"), "{text}");
        assert!(text.lines().nth(4).is_some_and(|line| line.ends_with('-')), "{text}");
    }
}
