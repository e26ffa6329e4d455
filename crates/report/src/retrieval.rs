//! Retrieval: precision over recall, and the confusion of classes.

use crate::classes::Classes;
use crate::error::ReportError;
use crate::figure::{
    Figure, FigurePanels, Heat, Plot, PlotAxis, PlotPoint, PlotSeries, SeriesKind, SeriesStyle,
};
use crate::record::Results;
use crate::results::{
    self, AxisScale, Classification, Misclassified, Published, PublishedMethod, RankedScores,
    RetrievalResults, RetrievalRow, Scale,
};
use crate::table::{Cell, SCORES, Table, scores_caption};

/// The scales in the order of the panels, with their titles and their names in tables.
const SCALES: [(Scale, &str, &str); 2] =
    [(Scale::Normalized, "size ignored", "ignored"), (Scale::Raw, "size counts", "counts")];

/// Stands for the class of shapes that are assigned to none.
const UNKNOWN: &str = "unknown";

/// The colour of a full cell of the confusion matrix.
const FULL: [u8; 3] = [31, 80, 154];

/// The curves of precision over recall, one plot for each scale.
fn precision(rows: &[RetrievalRow]) -> Vec<Plot> {
    let [x, y] = ["recall", "precision"].map(|name| results::Axis {
        name: name.to_owned(),
        unit: String::new(),
        scale: AxisScale::Linear,
    });
    let of = |scale: Scale| rows.iter().filter(move |row| row.scale == scale);
    let methods =
        Classes::of(SCALES.iter().flat_map(|(scale, ..)| of(*scale)).map(|row| row.method.as_str()));
    let series = |row: &RetrievalRow| {
        let last = row.precision.len().saturating_sub(1).max(1) as f64;
        let note = format!("mAP {:.3}", row.micro.map);
        let point = |(i, &p): (usize, &f64)| PlotPoint::new(i as f64 / last, p, &note);
        PlotSeries {
            name: row.method.clone(),
            style: SeriesStyle(methods.index(&row.method)),
            kind: SeriesKind::Curve,
            points: row.precision.iter().enumerate().map(point).collect(),
        }
    };
    let plot = |(scale, title, _): &(Scale, &str, &str)| {
        let mut series: Vec<PlotSeries> = of(*scale).map(series).collect();
        series.sort_by_key(|series| series.style.0);
        let label = format!("Precision over recall of all methods, {title}");
        (!series.is_empty()).then(|| Plot::new(title, label, &x, &y, series, vec![]))
    };
    SCALES.iter().filter_map(plot).collect()
}

/// True classes down, predicted classes across.
fn confusion(Classification { classes, confusion, .. }: &Classification) -> Heat {
    let columns: Vec<String> = classes.iter().cloned().chain([UNKNOWN.to_owned()]).collect();
    let rows = PlotAxis::categories("true class", classes.iter().cloned());
    let shares = |row: &Vec<usize>| {
        let total = row.iter().sum::<usize>().max(1) as f64;
        row.iter().map(|&count| count as f64 / total).collect()
    };
    Heat {
        title: String::new(),
        label: "True classes against predicted ones".into(),
        x: PlotAxis::categories("predicted class", columns.iter().cloned()),
        y: PlotAxis { range: [rows.range[1], rows.range[0]], ..rows },
        values: confusion.iter().map(shares).collect(),
        max: 1.0,
        tint: Some(FULL),
        bar: None,
        borders: vec![],
        counts: Some(confusion.clone()),
        rows: classes.clone(),
        columns,
        hover: "{row} classified as {column}\n{count} shapes, {percent} of the class",
    }
}

/// The shapes that are not in the class that was predicted.
fn misclassified(c: &Classification) -> Table {
    let row = |shape: &Misclassified| {
        let predicted = shape.predicted.as_deref().unwrap_or(UNKNOWN);
        let mut row = [shape.name.as_str(), &shape.label, predicted, &shape.nearest].map(Cell::text).to_vec();
        row.push(Cell::score(shape.distance));
        row
    };
    let caption = match c.misclassified.len() {
        0 => "Every shape was assigned to its class.".to_owned(),
        n => format!(
            "The {n} shapes that were not assigned to their class. A shape is unknown if its nearest neighbour is farther \
             than {:.3}.",
            c.threshold
        ),
    };
    let headings = ["shape", "class", "assigned to", "nearest shape", "distance"];
    Table::new(caption, headings, c.misclassified.iter().map(row).collect())
}

/// The ranking by distance and that on the graph, line by line, and published scores below them.
fn rankings(rows: &[RetrievalRow], published: Option<&Published>, protocol: &[String]) -> Option<Table> {
    let trained: Vec<usize> = rows
        .iter()
        .filter_map(|row| row.rankings.as_ref())
        .flat_map(|both| both.plain.splits.iter().map(|split| split.n_train))
        .fold(Vec::new(), |mut sizes, n_train| {
            if !sizes.contains(&n_train) {
                sizes.push(n_train);
            }
            sizes
        });
    let line = |row: &RetrievalRow, ranking: &str, ranked: &RankedScores| {
        let mut cells = vec![Cell::text(&row.method), Cell::text(row.scale.name()), Cell::text(ranking)];
        cells.extend(ranked.micro.to_array().map(Cell::score));
        let interval = &ranked.micro_intervals;
        cells.push(Cell::number(format!("{:.3} to {:.3}", interval.low.map, interval.high.map)));
        cells.extend(
            [ranked.macro_average.nn, ranked.macro_average.map, ranked.knn_accuracy].map(Cell::score),
        );
        for n_train in &trained {
            let split = ranked.splits.iter().find(|split| split.n_train == *n_train);
            cells.push(Cell::optional(split.map(|s| format!("{:.3} ± {:.3}", s.mean, s.deviation))));
        }
        cells
    };
    let mut lines = Vec::new();
    for row in rows {
        if let Some(both) = &row.rankings {
            lines.push(line(row, "plain", &both.plain));
            lines.push(line(row, "graph", &both.graph));
        }
    }
    let published_line = |method: &PublishedMethod| {
        let ranking = if method.uses_collection { "published, uses the collection" } else { "published" };
        let mut cells = vec![Cell::text(&method.name), Cell::text(""), Cell::text(ranking)];
        let own = [method.nn, method.ft, method.st, method.e, method.dcg, method.map];
        cells.extend(own.map(|score| score.map_or(Cell::Missing, Cell::score)));
        cells.extend((0..4 + trained.len()).map(|_| Cell::Missing));
        cells
    };
    lines.extend(published.into_iter().flat_map(|published| &published.method).map(published_line));
    let splits: Vec<String> = trained.iter().map(|n| format!("1-NN, {n} a class")).collect();
    let headings = ["method", "size", "ranking"].into_iter().chain(SCORES);
    let headings = headings.chain(["mAP interval", "macro NN", "macro mAP", "k-NN"]);
    let headings = headings.chain(splits.iter().map(String::as_str));
    let mut caption = protocol.join(" ");
    if let Some(published) = published {
        let sources: Vec<String> =
            published.method.iter().map(|m| format!("{}: {}", m.name, m.source)).collect();
        caption += &format!(" Published scores are on {}. {}.", published.collection, sources.join("; "));
    }
    (!lines.is_empty()).then(|| Table::new(caption, headings, lines))
}

impl Results for RetrievalResults {
    fn validate(&self) -> Result<(), ReportError> {
        let Classification { classes, confusion, .. } = &self.classification;
        if self.rows.iter().all(|row| row.precision.is_empty()) || classes.is_empty() {
            return Err(ReportError::Empty { figure: "the figure of retrieval", unit: "class and curve" });
        }
        for row in &self.rows {
            for &value in &row.precision {
                ReportError::check_finite(value, || {
                    format!("the precision of {} ({})", row.method, row.scale.name())
                })?;
            }
        }
        ReportError::check_length("the confusion matrix", confusion.len(), classes.len(), "class")?;
        confusion.iter().try_for_each(|row| {
            ReportError::check_length("a row of the confusion matrix", row.len(), classes.len() + 1, "class")
        })
    }

    fn figures(&self) -> Vec<Figure> {
        let c = &self.classification;
        let curves = format!(
            "Precision over recall, averaged over queries among {} shapes. Further right and up is better.",
            self.names.len()
        );
        let counts = format!(
            "Classification of every shape by the vote of its {} nearest neighbours among the others, by {}. A shape is \
             unknown if its nearest neighbour is farther than {:.3}. The colour is the share of the class.",
            c.voters, c.method, c.threshold
        );
        let precision = FigurePanels::Plots(precision(&self.rows));
        vec![
            Figure { part: "-curves", caption: curves, panels: precision },
            Figure { part: "-confusion", caption: counts, panels: FigurePanels::Heats(vec![confusion(c)]) },
        ]
    }

    fn tables(&self) -> Vec<Table> {
        let row = |row: &RetrievalRow| {
            let size = SCALES.iter().find(|(scale, ..)| *scale == row.scale).map_or("", |(.., name)| name);
            let own = [row.macro_average.nn, row.macro_average.map, row.knn_accuracy, row.held_out_map];
            let mut cells = vec![Cell::text(&row.method), Cell::text(size)];
            cells.extend(row.micro.to_array().into_iter().chain(own).map(Cell::score));
            cells
        };
        let caption = format!(
            "{} Scores are averaged over queries, macro scores over classes. Least mAP: the lowest mAP when one \
             class is left out of the collection.",
            scores_caption(self.best_e)
        );
        let own = ["macro NN", "macro mAP", "k-NN", "least mAP"];
        let headings = ["method", "size"].into_iter().chain(SCORES).chain(own);
        let all = Table::new(caption, headings, self.rows.iter().map(row).collect());
        let c = &self.classification;
        let caption = "Missed: the share of shapes classified as unknown although others of their class are in the \
                       collection. Mistaken: the share of shapes assigned to a class although no other of their own is. \
                       The thresholds are found without the class they are tested on.";
        let values = [c.missed, c.mistaken, c.threshold].map(Cell::score).to_vec();
        let unknown = Table::new(caption, ["missed", "mistaken", "threshold"], vec![values]);
        let both = rankings(&self.rows, self.published.as_ref(), &self.protocol);
        both.into_iter().chain([all, misclassified(c), unknown.folded("Unknown shapes")]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::Record;
    use crate::tests::fixtures::{assert_holds, retrieval_record};
    use serde_json::json;

    #[test]
    fn both_rankings_stand_above_published_scores() {
        let mut results = retrieval_record().results;
        assert_eq!(results.tables().len(), 3, "a record without the graph");
        let scores = json!(results.rows[0].micro);
        let level = json!({"level": 0.95, "resamples": 9, "seed": 0, "low": scores, "high": scores});
        let split = json!({
            "n_train": 10, "runs": 3, "n_classes": 2, "n_test": 4, "mean": 0.75, "deviation": 0.125,
        });
        let ranked = json!({
            "micro": scores, "micro_intervals": level, "macro_average": scores, "macro_intervals": level,
            "knn_accuracy": 0.9, "splits": [split],
        });
        let method = json!({"name": "theirs", "source": "a paper", "ft": 0.5});
        results.rows[0].rankings = serde_json::from_value(json!({"plain": ranked, "graph": ranked})).unwrap();
        results.published =
            serde_json::from_value(json!({"collection": "a benchmark", "method": [method]})).unwrap();
        results.protocol = vec!["Every shape is a query.".into()];
        let table = &results.tables()[0];
        let text = table.to_text();
        assert_holds(&text, &["plain", "graph", "published", "0.875 to 0.875", "0.750 ± 0.125", "0.500"]);
        assert_holds(&text, &["1-NN, 10 a class"]);
        let caption = "Every shape is a query. Published scores are on a benchmark. theirs: a paper.";
        assert_holds(&table.caption, &[caption]);
        assert!(table.rows.iter().all(|row| row.len() == table.headings.len()));
        let json = serde_json::to_string(&results).unwrap();
        assert_eq!(serde_json::from_str::<RetrievalResults>(&json).unwrap(), results);
    }

    #[test]
    fn inconsistent_records_are_errors_that_name_the_part() {
        let fault = |change: &dyn Fn(&mut Record<RetrievalResults>)| {
            let mut record = retrieval_record();
            change(&mut record);
            record.results.validate().unwrap_err().to_string()
        };
        assert!(fault(&|r| r.results.rows.clear()).contains("class and curve"));
        assert!(fault(&|r| r.results.rows[0].precision[1] = f64::NAN).contains("precision of wave-kernel"));
        assert!(
            fault(&|r| r.results.classification.confusion[0].truncate(1))
                .contains("row of the confusion matrix")
        );
        assert!(fault(&|r| r.results.classification.confusion.truncate(1)).contains("the confusion matrix"));
    }
}
