//! Figure 4: how well distances between canonical forms separate classes.
//!
//! For each scale, one figure of the two-dimensional maps with their scores and one of the distance matrices.

use crate::classes::Classes;
use crate::error::ReportError;
use crate::figure::{
    Figure, FigurePanels, Heat, MAP_SIZE, Plot, PlotAxis, PlotPoint, PlotSeries, SeriesKind, SeriesStyle,
};
use crate::numbers::signed;
use crate::record::Results;
use crate::results::{Figure4Panel, Figure4Results, Scale};
use crate::table::{Cell, SCORES, Table, scores_caption};

/// What each scale is called in titles, in captions and in file names.
const SCALES: [(Scale, &str, &str, [&str; 2]); 3] = [
    (
        Scale::Raw,
        "original size",
        "forms of original size (in mesh units; those of kernel PCA have their own units)",
        ["-maps-raw", "-matrices-raw"],
    ),
    (
        Scale::Normalized,
        "normalised size",
        "forms scaled to the same size",
        ["-maps-normalized", "-matrices-normalized"],
    ),
    (
        Scale::Spectrum,
        "16 dimensions",
        "forms of 16 dimensions, by their spectra of straight distances, size ignored",
        ["-maps-spectrum", "-matrices-spectrum"],
    ),
];

/// The figures of one panel: the map, and the matrix with its rows grouped by class.
pub(crate) struct Shown {
    pub(crate) map: Plot,
    pub(crate) matrix: Heat,
    /// The shape of every row of the matrix.
    pub(crate) order: Vec<usize>,
}

/// A panel of the record as figures.
pub(crate) fn shown(record: &Figure4Results, panel: &Figure4Panel) -> Shown {
    let classes = Classes::of(record.labels.iter().map(String::as_str));
    let size = SCALES.iter().find(|(scale, ..)| *scale == panel.scale).map_or("", |(_, name, ..)| name);
    let title = format!("{}, {size}", panel.method);
    let class = |shape: usize| classes.index(&record.labels[shape]);
    let mut order: Vec<usize> = (0..record.names.len()).collect();
    order.sort_by_key(|&shape| class(shape));
    let map = map(record, panel, &classes, &title);
    let matrix = matrix(record, panel, &classes, &title, &order);
    Shown { map, matrix, order }
}

fn map(record: &Figure4Results, panel: &Figure4Panel, classes: &Classes<'_>, title: &str) -> Plot {
    let series = |(class, name): (usize, &&str)| {
        let members = (0..record.names.len()).filter(|&shape| record.labels[shape] == **name);
        let point = |shape: usize| {
            let [x, y] = panel.map[shape];
            PlotPoint::new(x, y, &record.names[shape])
        };
        let points = members.map(point).collect();
        PlotSeries { name: (*name).to_owned(), style: SeriesStyle(class), kind: SeriesKind::Filled, points }
    };
    let (unit, [across, up]) = (panel.scale.unit(), equal_ranges(&panel.map));
    let retrieval = SCORES.into_iter().zip(panel.scores.mean.to_array()).filter(|(name, _)| *name != "E");
    let own = [
        ("silhouette", panel.scores.silhouette),
        ("2D silhouette", panel.map_silhouette),
        ("2D stress", panel.map_stress),
    ];
    Plot {
        title: title.to_owned(),
        label: format!("2D map of the shapes ({title})"),
        x: PlotAxis::linear("MDS axis 1", unit, across, 7),
        y: PlotAxis::linear("MDS axis 2", unit, up, 6),
        is_map: true,
        series: classes.names().iter().enumerate().map(series).collect(),
        marks: vec![],
        scores: retrieval.chain(own).map(|(name, value)| (name, signed(value, 3))).collect(),
    }
}

/// Ranges of both axes that show all points at one scale in a map.
fn equal_ranges(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let low: [f64; 2] = std::array::from_fn(|i| points.iter().map(|p| p[i]).fold(f64::INFINITY, f64::min));
    let high: [f64; 2] =
        std::array::from_fn(|i| points.iter().map(|p| p[i]).fold(f64::NEG_INFINITY, f64::max));
    let per_unit = ((high[0] - low[0]) / MAP_SIZE[0]).max((high[1] - low[1]) / MAP_SIZE[1]) * 1.14;
    // All points in one place: any scale at which the ends of the range differ.
    let smallest = 1e-6 * low.iter().chain(&high).fold(0.0_f64, |m, v| m.max(v.abs()));
    let per_unit = if per_unit > smallest { per_unit } else { smallest.max(1.0 / MAP_SIZE[0]) };
    std::array::from_fn(|i| {
        let (middle, half) = (low[i] + (high[i] - low[i]) / 2.0, per_unit * MAP_SIZE[i] / 2.0);
        [middle - half, middle + half]
    })
}

fn matrix(
    record: &Figure4Results,
    panel: &Figure4Panel,
    classes: &Classes<'_>,
    title: &str,
    order: &[usize],
) -> Heat {
    let label = |row: usize| record.labels[order[row]].as_str();
    let n = order.len();
    let borders: Vec<usize> = (1..n).filter(|&row| label(row) != label(row - 1)).collect();
    let edges: Vec<usize> = [0].into_iter().chain(borders.iter().copied()).chain([n]).collect();
    let middle = |edges: &[usize]| (edges[0] + edges[1]) as f64 / 2.0 - 0.5;
    let ticks =
        edges.windows(2).zip(classes.names()).map(|(edges, name)| (middle(edges), (*name).to_owned()));
    let x = PlotAxis::cells(n, ticks.collect());
    let y = PlotAxis { range: [x.range[1], x.range[0]], ..x.clone() };
    // The diagonal is zero, and so is the first colour: equal colours are equal distances in all panels.
    let max = panel.matrix.iter().flatten().fold(0.0_f64, |m, &v| m.max(v));
    let range = [0.0, if max > 0.0 { max } else { 1.0 }];
    let names: Vec<String> = order.iter().map(|&shape| record.names[shape].clone()).collect();
    Heat {
        title: title.to_owned(),
        label: format!("Distances of all pairs ({title})"),
        x,
        y,
        values: order.iter().map(|&i| order.iter().map(|&j| panel.matrix[i][j]).collect()).collect(),
        max,
        tint: None,
        bar: Some(PlotAxis::bar("distance", panel.scale.unit(), range, 7)),
        borders,
        counts: None,
        columns: names.clone(),
        rows: names,
        hover: "{row} and {column}\ndistance {value}",
    }
}

impl Results for Figure4Results {
    fn validate(&self) -> Result<(), ReportError> {
        let n = self.names.len();
        let length = |what: String, found: usize| ReportError::check_length(what, found, n, "shape");
        if n == 0 {
            return Err(ReportError::Empty { figure: "figure 4", unit: "shape" });
        }
        if self.panels.is_empty() {
            return Err(ReportError::Empty { figure: "figure 4", unit: "panel" });
        }
        length("labels".into(), self.labels.len())?;
        for panel in &self.panels {
            let of = |part: &str| format!("{part} of {} ({})", panel.method, panel.scale.name());
            length(of("matrix"), panel.matrix.len())?;
            length(of("map"), panel.map.len())?;
            for (row, values) in panel.matrix.iter().enumerate() {
                length(of(&format!("matrix row {row}")), values.len())?;
                for (column, &value) in values.iter().enumerate() {
                    ReportError::check_finite(value, || of(&format!("matrix entry {row}, {column}")))?;
                }
            }
            for (point, &[x, y]) in panel.map.iter().enumerate() {
                ReportError::check_finite(x + y, || of(&format!("map point {point}")))?;
            }
            let own = [
                ("map_stress", panel.map_stress),
                ("negative_mass", panel.negative_mass),
                ("map_silhouette", panel.map_silhouette),
                ("k-NN", panel.scores.knn_accuracy),
                ("silhouette", panel.scores.silhouette),
            ];
            for (name, value) in own.into_iter().chain(SCORES.into_iter().zip(panel.scores.mean.to_array())) {
                ReportError::check_finite(value, || of(name))?;
            }
        }
        Ok(())
    }

    fn figures(&self) -> Vec<Figure> {
        let n = self.names.len();
        let mut figures = Vec::new();
        for (scale, _, size, [maps, matrices]) in SCALES {
            let panels = self.panels.iter().filter(|panel| panel.scale == scale);
            let (plots, heats): (Vec<Plot>, Vec<Heat>) =
                panels.map(|panel| shown(self, panel)).map(|shown| (shown.map, shown.matrix)).unzip();
            if plots.is_empty() {
                continue;
            }
            let caption = format!(
                "Multidimensional scaling of the distances between the canonical forms of {n} shapes, {size}. Both axes of \
                 a 2D map have the same scale, so nearby points are similar forms. Under each 2D map: the scores of the \
                 distances (mAP: mean average precision), and the silhouette and stress of the map itself."
            );
            figures.push(Figure { part: maps, caption, panels: FigurePanels::Plots(plots) });
            let caption = format!(
                "The {n} × {n} distances between {size}, grouped by class. Dark colours are small distances."
            );
            figures.push(Figure { part: matrices, caption, panels: FigurePanels::Heats(heats) });
        }
        figures
    }

    fn tables(&self) -> Vec<Table> {
        let row = |panel: &Figure4Panel| {
            let Figure4Panel { scores: s, map_silhouette, map_stress, negative_mass, .. } = panel;
            let own = [s.knn_accuracy, s.silhouette, *map_silhouette, *map_stress, *negative_mass];
            let mut row = vec![Cell::text(&panel.method), Cell::text(panel.scale.name())];
            row.extend(s.mean.to_array().into_iter().chain(own).map(Cell::score));
            row
        };
        let caption = format!(
            "{} k-NN: leave-one-out accuracy. Neg. mass: the share of the spectrum that no Euclidean space can \
             represent. 2D: of the map in the plane.",
            scores_caption(self.best_e)
        );
        let own = ["k-NN", "silhouette", "2D silhouette", "2D stress", "neg. mass"];
        let headings = ["method", "scale"].into_iter().chain(SCORES).chain(own);
        vec![Table::new(caption, headings, self.panels.iter().map(row).collect())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::save;
    use crate::results::Record;
    use crate::tests::fixtures::figure4_record;

    #[test]
    fn many_classes_and_single_shapes_fit() {
        let names: Vec<String> = (0..14).map(|i| format!("class number {i}")).collect();
        let classes: Vec<(&str, usize)> =
            names.iter().enumerate().map(|(i, n)| (n.as_str(), 1 + 3 * i % 20)).collect();
        let folder = tempfile::tempdir().unwrap();
        save(&figure4_record(&classes), folder.path(), "figure4").unwrap();
        let svg = std::fs::read_to_string(folder.path().join("figure4-maps-raw.svg")).unwrap();
        assert!(names.iter().all(|name| svg.contains(name.as_str())), "the legend names every class");
        for classes in [[("only", 1)], [("alike", 3)]] {
            save(&figure4_record(&classes), folder.path(), "few").unwrap();
        }
    }

    #[test]
    fn rows_of_the_matrix_are_grouped_by_class() {
        let mut record = figure4_record(&[("cat", 2), ("dog", 2)]);
        record.results.labels.swap(1, 2);
        let Shown { map, matrix, order } = shown(&record.results, &record.results.panels[0]);
        assert_eq!((order, matrix.borders.as_slice()), (vec![0, 2, 1, 3], &[2][..]));
        assert_eq!(matrix.rows, ["cat0", "dog2", "cat1", "dog3"]);
        assert_eq!(matrix.values[0][1], record.results.panels[0].matrix[0][2]);
        assert_eq!(matrix.x.ticks[1], (2.5, "dog".to_owned()));
        assert_eq!(map.series[1].points[0].note, "cat1");
    }

    #[test]
    fn records_without_content_are_errors_and_leave_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let fault = |record: &Record<Figure4Results>| save(record, folder.path(), "figure4").unwrap_err();
        let mut record = figure4_record(&[("cat", 2)]);
        record.results.panels.clear();
        assert!(matches!(fault(&record), ReportError::Empty { unit: "panel", .. }));
        assert!(matches!(
            fault(&Record::<Figure4Results>::default()),
            ReportError::Empty { unit: "shape", .. }
        ));
        record = figure4_record(&[("cat", 2)]);
        record.results.panels[0].map[0][0] = f64::NAN;
        assert!(matches!(fault(&record), ReportError::NotFinite { .. }));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn inconsistent_records_are_errors_that_name_the_part() {
        let good = figure4_record(&[("cat", 3), ("dog", 2)]);
        good.results.validate().unwrap();
        let broken = |change: &dyn Fn(&mut Record<Figure4Results>)| {
            let mut record = good.clone();
            change(&mut record);
            record.results.validate().unwrap_err().to_string()
        };
        assert!(broken(&|r| r.results.labels.truncate(4)).starts_with("labels has 4 entries instead of 5"));
        assert!(broken(&|r| r.results.panels[1].map.truncate(2)).contains("map of KPCA-Nyström (raw) has 2"));
        assert!(
            broken(&|r| r.results.panels[2].matrix[3].truncate(1))
                .contains("matrix row 3 of NMDS (normalized) has 1")
        );
        assert!(
            broken(&|r| r.results.panels[0].matrix[1][2] = f64::NAN)
                .contains("matrix entry 1, 2 of NMDS (raw) is NaN")
        );
        assert!(broken(&|r| r.results.panels[0].map[4][0] = f64::INFINITY).contains("map point 4"));
        assert!(broken(&|r| r.results.panels[0].scores.silhouette = f64::NAN).contains("silhouette of NMDS"));
    }

    #[test]
    fn both_axes_of_a_map_have_one_scale_and_hold_all_points() {
        for points in [
            vec![[0.0, 0.0], [10.0, 1.0]],
            vec![[5.0, -3.0], [5.0, 40.0]],
            vec![[7.0, 7.0]],
            vec![[1e9, 1e9]],
        ] {
            let ranges = equal_ranges(&points);
            let scales: [f64; 2] = std::array::from_fn(|i| (ranges[i][1] - ranges[i][0]) / MAP_SIZE[i]);
            assert!(scales[0] > 0.0 && (scales[0] / scales[1] - 1.0).abs() < 1e-9, "{scales:?}");
            let inside = |p: &[f64; 2], i: usize| ranges[i][0] <= p[i] && p[i] <= ranges[i][1];
            assert!(points.iter().all(|p| inside(p, 0) && inside(p, 1)));
        }
    }

    #[test]
    fn the_table_has_a_row_per_method_and_scale() {
        let record = figure4_record(&[("cat", 3), ("dog", 2)]);
        let text = record.results.summary().unwrap().to_text();
        assert_eq!(text.lines().count(), 1 + record.results.panels.len());
        assert!(text.contains("normalized") && text.contains("2D stress"), "{text}");
        let lines: Vec<&str> = text.lines().collect();
        for (heading, value) in SCORES.iter().zip(record.results.panels[0].scores.mean.to_array()) {
            let end = lines[0].find(heading).map(|at| at + heading.len()).unwrap();
            assert!(lines[1][..end].ends_with(&format!("{value:.3}")), "{heading} {value}\n{text}");
        }
    }
}
