//! Invariance: changes and retrieval of damaged shapes.

use crate::error::ReportError;
use crate::figure::Figure;
use crate::record::Results;
use crate::results::{InvarianceResults, InvarianceRow, SignatureChange};
use crate::table::{Cell, Table};

impl Results for InvarianceResults {
    fn validate(&self) -> Result<(), ReportError> {
        if self.rows.is_empty() {
            return Err(ReportError::Empty { figure: "the table of invariance", unit: "row" });
        }
        for row in &self.rows {
            for value in [row.form, row.combined, row.largest] {
                ReportError::check_finite(value, || format!("a distance of the row `{}`", row.damage))?;
            }
        }
        Ok(())
    }

    fn figures(&self) -> Vec<Figure> {
        Vec::new()
    }

    fn tables(&self) -> Vec<Table> {
        let found = Table::new(
            format!(
                "{} of {} shapes of about {} vertices, damaged and searched for in the undamaged collection. \
                 Distance: combined distance from the undamaged shape; at {:.2}, one shape and two are equally likely. \
                 Top 1: share of shapes whose nearest has their class; others: the same without the undamaged shape \
                 itself. Unknown: share of shapes whose nearest is {:.2} or farther. Told: share of shapes whose relation \
                 to the undamaged shape is right.",
                self.n_damaged, self.n_shapes, self.n_vertices, self.same_shape, self.same_class
            ),
            ["damage", "distance, median", "largest", "farthest shape", "top 1", "others", "unknown", "told"],
            self.rows
                .iter()
                .map(|row| {
                    let mut cells = vec![Cell::text(&row.damage)];
                    cells.extend([row.combined, row.largest].map(Cell::score));
                    cells.push(Cell::text(&row.farthest));
                    cells.extend([row.top1, row.top1_others, row.unknown].map(Cell::score));
                    cells.push(row.told.map_or(Cell::Missing, Cell::score));
                    cells
                })
                .collect(),
        );
        let names = self.rows.first().map_or(&[][..], |row| &row.signatures).iter().map(|s| s.name.as_str());
        let headings: Vec<&str> = ["damage"].into_iter().chain(names).chain(["aligned forms"]).collect();
        let changes = |caption: &str,
                       value: &dyn Fn(&SignatureChange) -> f64,
                       form: &dyn Fn(&InvarianceRow) -> Cell| {
            let row = |row: &InvarianceRow| {
                let mut cells = vec![Cell::text(&row.damage)];
                cells.extend(row.signatures.iter().map(|change| Cell::score(value(change))));
                cells.push(form(row));
                cells
            };
            Table::new(caption, headings.iter().copied(), self.rows.iter().map(row).collect())
        };
        let relative = changes(
            "Median distance between the signatures of the damaged and the undamaged shape, over the length of the latter.",
            &|change| change.relative,
            &|_| Cell::Missing,
        );
        let units = changes(
            "The same changes in units of the distance between two poses of one body.",
            &|change| change.units,
            &|row| Cell::score(row.form),
        );
        vec![found, relative, units]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::fixtures::assert_holds;

    fn results() -> InvarianceResults {
        let row = serde_json::json!({
            "damage": "subdivided", "keeps_surface": true, "form": 0.25, "combined": 0.4, "largest": 0.75,
            "farthest": "cat3", "top1": 1.0, "top1_others": 0.975, "unknown": 0.0, "told": 0.625,
            "signatures": [{"name": "shape-dna", "relative": 0.012, "units": 0.5}],
        });
        let results = serde_json::json!({
            "n_shapes": 30, "n_damaged": 12, "n_vertices": 3400, "same_class": 3.5, "same_shape": 1.6,
            "rows": [row],
        });
        serde_json::from_value(results).unwrap()
    }

    #[test]
    fn tables_show_every_number_of_the_record() {
        let results = results();
        results.validate().unwrap();
        let text: String = results.tables().iter().map(Table::to_text).collect();
        assert_holds(&text, &["subdivided", "shape-dna", "cat3", "0.400", "0.750", "1.000", "0.975"]);
        assert_holds(&text, &["0.012", "0.500", "0.250", "0.625"]);
    }

    #[test]
    fn records_without_rows_or_with_infinite_distances_are_errors() {
        let mut broken = results();
        broken.rows[0].combined = f64::INFINITY;
        assert!(broken.validate().unwrap_err().to_string().contains("subdivided"));
        broken.rows.clear();
        assert!(broken.validate().is_err());
    }
}
