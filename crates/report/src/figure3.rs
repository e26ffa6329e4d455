//! Figure 3: canonical forms of a few shapes by several methods, with their stress.

use mesh::TriMesh;

use crate::classes::Classes;
use crate::figure::{Content, Figure, Group, Layout, Plot, Point, Tile, Tiles, grouped};
use crate::results::{Axis, AxisScale, Expectation, Figure3Record, Figure3Shape, Figure3Stress, Provenance};
use crate::table::stress;
use crate::{Cell, Record, ReportError, Table};
use view::render::View;

const PART: &str = "-forms";

/// One row of the figure.
#[derive(Debug, Clone)]
pub struct Figure3Surfaces<'a> {
    /// Names and stresses.
    pub facts: &'a Figure3Shape,
    /// The shape.
    pub shape: &'a TriMesh,
    /// Its forms in the order of `facts.forms`, rotated or reflected to match each other.
    pub forms: &'a [TriMesh],
}

/// One row per shape: the shape, seen from `view`, then its forms. Each fills its tile.
///
/// # Errors
/// [`ReportError::Empty`] without a form, [`ReportError::Shape`] if the forms of a row and their facts differ in
/// number.
pub fn figure3<'a>(rows: &[Figure3Surfaces<'a>], view: &View) -> Result<Tiles<'a>, ReportError> {
    if rows.iter().all(|row| row.forms.is_empty()) {
        return Err(ReportError::Empty { figure: "figure 3", unit: "shape with a form" });
    }
    for Figure3Surfaces { facts, forms, .. } in rows {
        ReportError::check_length(
            format!("forms of {}", facts.name),
            forms.len(),
            facts.forms.len(),
            "stress",
        )?;
    }
    let longest = rows.iter().max_by_key(|row| row.forms.len());
    let methods = longest.into_iter().flat_map(|row| row.facts.forms.iter().map(|f| f.method.clone()));
    let heads: Vec<String> = std::iter::once("shape".to_owned()).chain(methods).collect();
    let row = |Figure3Surfaces { facts, shape, forms }: &Figure3Surfaces<'a>| {
        let vertices = (format!("{} vertices", facts.n_vertices), Layout::NUMBER);
        let forms = forms.iter().zip(&facts.forms).map(|(mesh, facts)| {
            let stress = (format!("stress {}", stress(facts.stress)), Layout::NUMBER);
            let paper = facts.paper.map(|paper| (format!("paper {paper}"), Layout::NOTE));
            Tile::Form(mesh, std::iter::once(stress).chain(paper).collect())
        });
        (facts.name.clone(), std::iter::once(Tile::Shape(shape, vec![vertices])).chain(forms).collect())
    };
    let rows = rows.iter().map(row).collect();
    Ok(Tiles { part: PART, layout: &Layout::LINE, view: *view, heads, rows })
}

/// The stress of every method on one shape, for every kind of distances.
fn plot(shape: &str, stresses: &[Figure3Stress]) -> Plot {
    let own: Vec<&Figure3Stress> = stresses.iter().filter(|s| s.shape == shape).collect();
    let kinds: Vec<String> = own.iter().map(|s| format!("{} distances", s.distances)).collect();
    let groups = own.iter().zip(&kinds).map(|(s, kind)| Group {
        category: &s.method,
        series: kind,
        own: Some(Point { x: 0.0, y: s.median, low: s.low, high: s.high, note: format!("{} runs", s.runs) }),
        // The paper has one number for all kinds of distances.
        paper: s.paper.filter(|_| *kind == kinds[0]),
    });
    let groups: Vec<Group<'_>> = groups.collect();
    let (name, unit) = ("stress".to_owned(), "squared mesh units".to_owned());
    grouped(shape, &Axis { name, unit, scale: AxisScale::Log }, &groups, |_| "paper".to_owned())
}

impl Record for Figure3Record {
    fn about(&self) -> (&Provenance, &[Expectation], &str) {
        (&self.provenance, &self.expectations, &self.analysis)
    }

    fn figures(&self) -> Vec<Figure> {
        let forms = "Shapes (left) and their canonical forms by each method. Every form fills its tile and is rotated to \
                     match the first of its row. Under it: its stress in squared mesh units, from the run of median \
                     stress, and the number printed in the paper.";
        let stress = "Median and range of the stress over runs that differ in the first sample, for three kinds of \
                      distances, and the numbers printed in the paper.";
        let shapes = Classes::of(self.stresses.iter().map(|s| s.shape.as_str()));
        let plots: Vec<Plot> = shapes.names().iter().map(|shape| plot(shape, &self.stresses)).collect();
        let forms = Figure { part: PART, caption: forms.into(), content: Content::Surfaces };
        let stress = Figure { part: "-stress", caption: stress.into(), content: Content::Plots(plots) };
        vec![forms, stress]
    }

    fn tables(&self) -> Vec<Table> {
        let row = |s: &Figure3Stress| {
            let mut row = [&s.shape, &s.distances, &s.method].map(Cell::text).to_vec();
            row.extend([s.median, s.low, s.high].map(|value| Cell::number(stress(value))));
            row.extend([Cell::number(s.runs), Cell::optional(s.paper)]);
            row
        };
        let caption = "Stress in squared mesh units over runs that differ in the first sample.";
        let headings = ["shape", "distances", "method", "median", "least", "greatest", "runs", "paper"];
        vec![Table::new(caption, headings, self.stresses.iter().map(row).collect())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Shape;
    use mesh::shapes::icosphere;

    use crate::fixtures::{assert_balanced, figure3_record};

    #[test]
    fn every_form_has_its_stress_and_that_of_the_paper() {
        let record = figure3_record();
        let ball = icosphere(2);
        let forms = vec![ball.clone(); record.shapes[0].forms.len()];
        let rows: Vec<_> = record
            .shapes
            .iter()
            .map(|facts| Figure3Surfaces { facts, shape: &ball, forms: &forms })
            .collect();
        let folder = tempfile::tempdir().unwrap();
        let files = figure3(&rows, &View::default()).unwrap().save(folder.path().join("figure3")).unwrap();
        let svg = std::fs::read_to_string(&files[1]).unwrap();
        assert_balanced(&svg);
        for text in ["david&lt;0&gt;", "MDS", "NMDS", "stress 262.1", "paper 394.41", "3400 vertices"] {
            assert!(svg.contains(text), "{text}");
        }
        assert_eq!(svg.matches("data:image/png;base64,").count(), 6);
    }

    #[test]
    fn forms_without_facts_are_an_error() {
        let empty = figure3(&[], &View::default()).unwrap_err();
        assert!(matches!(empty, ReportError::Empty { .. }), "{empty}");
        let record = figure3_record();
        let ball = icosphere(2);
        let row = Figure3Surfaces { facts: &record.shapes[0], shape: &ball, forms: &[icosphere(2)] };
        let short = figure3(&[row], &View::default()).unwrap_err();
        assert!(short.to_string().starts_with("forms of david<0> has 1 entries instead of 2"), "{short}");
    }

    #[test]
    fn the_plot_of_stress_has_ranges_and_the_number_of_the_paper() {
        let record = figure3_record();
        let figures = record.figures();
        let Content::Plots(plots) = &figures[1].content else { panic!("{figures:?}") };
        let [plot] = &plots[..] else { panic!("{plots:?}") };
        assert_eq!(plot.x.ticks[0].1, "MDS");
        let [default, paper] = &plot.series[..] else { panic!("{:?}", plot.series) };
        assert_eq!((default.points[0].low, default.points[0].high), (386.0, 387.0));
        assert_eq!((paper.shape, paper.points[0].y), (Shape::Hollow, 394.41));
    }
}
