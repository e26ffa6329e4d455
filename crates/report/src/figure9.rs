//! Figure 9: times and memory of whole embeddings.

use crate::figure::{Figure, FigurePanels, GroupedValue, Plot, PlotPoint, grouped};
use crate::numbers::{bytes, seconds};
use crate::record::Results;
use crate::results::{Axis, AxisScale, Figure9Results, Figure9Row};
use crate::table::{Cell, Table};

/// The times of all methods on every shape.
fn plot(rows: &[Figure9Row]) -> Plot {
    let places: Vec<String> =
        rows.iter().map(|row| format!("{}, {} vertices", row.shape, row.n_vertices)).collect();
    let groups = rows.iter().zip(&places).map(|(row, category)| {
        let own = row.measured.map(|m| {
            let [distances, algebra] = [m.geodesics, m.embedding].map(seconds);
            let note = format!("{distances} s distances, {algebra} s algebra, {}", bytes(m.peak_bytes));
            PlotPoint::new(0.0, m.total(), note)
        });
        GroupedValue { category, series: &row.method, own, paper: row.paper_seconds }
    });
    let groups: Vec<GroupedValue<'_>> = groups.collect();
    let time = Axis { name: "time".into(), unit: "seconds".into(), scale: AxisScale::Log };
    grouped("From the repaired mesh to coordinates", &time, &groups, |method| format!("{method}, paper"))
}

impl Results for Figure9Results {
    fn figures(&self) -> Vec<Figure> {
        let caption = "Filled: this program. Hollow: the paper, on a laptop of 2015.";
        vec![Figure {
            part: "-times",
            caption: caption.into(),
            panels: FigurePanels::Plots(vec![plot(&self.rows)]),
        }]
    }

    fn tables(&self) -> Vec<Table> {
        let row = |row: &Figure9Row| {
            let m = row.measured;
            vec![
                Cell::text(&row.shape),
                Cell::number(row.n_vertices),
                Cell::text(&row.method),
                Cell::optional(m.map(|m| seconds(m.geodesics))),
                Cell::optional(m.map(|m| seconds(m.embedding))),
                Cell::optional(m.map(|m| seconds(m.total()))),
                Cell::optional(m.map(|m| bytes(m.peak_bytes))),
                Cell::optional(m.map(|m| m.runs)),
                Cell::optional(row.paper_seconds),
                Cell::text(&row.note),
            ]
        };
        let caption = format!(
            "Wall-clock seconds of the fastest run on {} worker threads, and peak memory in addition to the surface. The \
             times of the paper are those of a laptop of 2015.",
            self.threads
        );
        let headings = "shape vertices method distances algebra total memory runs paper remark".split(' ');
        vec![Table::new(caption, headings, self.rows.iter().map(row).collect())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::SeriesKind;
    use crate::record::save;
    use crate::tests::fixtures::figure9_record;

    #[test]
    fn methods_that_were_not_run_have_dashes_and_no_points() {
        let record = figure9_record();
        let text = record.results.summary().unwrap().to_text();
        assert!(text.contains("0.025") && text.contains("3.0 MiB") && text.contains("0.24"), "{text}");
        assert!(text.lines().nth(2).is_some_and(|line| line.matches(" - ").count() >= 4), "{text}");
        let plot = plot(&record.results.rows);
        let drawn: Vec<(&str, SeriesKind)> = plot.series.iter().map(|s| (s.name.as_str(), s.kind)).collect();
        assert_eq!(drawn, [("NMDS", SeriesKind::Filled), ("NMDS, paper", SeriesKind::Hollow)]);
        assert_eq!(plot.x.ticks[0].1, "david0, 3400 vertices");
        save(&record, tempfile::tempdir().unwrap().path(), "figure9").unwrap();
    }
}
