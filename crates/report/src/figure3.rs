//! Figure 3: canonical forms of a few shapes by several methods, with their stress.

use mesh::TriMesh;

use crate::classes::Classes;
use crate::error::ReportError;
use crate::figure::{Figure, FigurePanels, GroupedValue, Plot, PlotPoint, Tile, Tiles, grouped};
use crate::record::Results;
use crate::results::{Axis, AxisScale, Figure3Results, Figure3Shape, Figure3Stress};
use crate::table::{Cell, Table, stress};

const PART: &str = "-forms";

impl Figure3Results {
    /// The static figure: a row per shape, with the shape and its forms. Each fills its tile.
    ///
    /// `surfaces` are the shapes with their forms, in the order of `self.shapes`. The forms of a shape are rotated or
    /// reflected to match each other.
    ///
    /// # Errors
    /// [`ReportError::Empty`] without a form, [`ReportError::Shape`] if there is not one form per stress.
    pub fn tiles<'a>(&self, surfaces: &'a [(TriMesh, Vec<TriMesh>)]) -> Result<Tiles<'a>, ReportError> {
        if surfaces.iter().all(|(_, forms)| forms.is_empty()) {
            return Err(ReportError::Empty { figure: "figure 3", unit: "shape with a form" });
        }
        for (facts, (_, forms)) in self.shapes.iter().zip(surfaces) {
            let what = format!("forms of {}", facts.name);
            ReportError::check_length(what, forms.len(), facts.forms.len(), "stress")?;
        }
        let longest = self.shapes.iter().max_by_key(|facts| facts.forms.len());
        let methods = longest.into_iter().flat_map(|facts| facts.forms.iter().map(|f| f.method.clone()));
        let heads = std::iter::once("shape".to_owned()).chain(methods).collect();
        let row = |(facts, (shape, forms)): (&Figure3Shape, &'a (TriMesh, Vec<TriMesh>))| {
            let captions = vec![format!("{} vertices", facts.n_vertices)];
            let forms = forms.iter().zip(&facts.forms).map(|(mesh, facts)| {
                let paper = facts.paper.map(|paper| format!("paper {paper}"));
                let captions =
                    [format!("stress {}", stress(facts.stress))].into_iter().chain(paper).collect();
                Tile { mesh, is_form: true, captions }
            });
            let tiles = std::iter::once(Tile { mesh: shape, is_form: false, captions }).chain(forms);
            (facts.name.clone(), tiles.collect())
        };
        let rows = self.shapes.iter().zip(surfaces).map(row).collect();
        Ok(Tiles { part: PART, is_paired: false, heads, rows })
    }
}

/// The stress of every method on one shape, for every kind of distances.
fn plot(shape: &str, stresses: &[Figure3Stress]) -> Plot {
    let own: Vec<&Figure3Stress> = stresses.iter().filter(|s| s.shape == shape).collect();
    let kinds: Vec<String> = own.iter().map(|s| format!("{} distances", s.distances)).collect();
    let groups = own.iter().zip(&kinds).map(|(s, kind)| GroupedValue {
        category: &s.method,
        series: kind,
        own: Some(PlotPoint {
            x: 0.0,
            y: s.median,
            low: s.low,
            high: s.high,
            note: format!("{} runs", s.runs),
        }),
        // The paper has one number for all kinds of distances.
        paper: s.paper.filter(|_| *kind == kinds[0]),
    });
    let groups: Vec<GroupedValue<'_>> = groups.collect();
    let (name, unit) = ("stress".to_owned(), "squared mesh units".to_owned());
    grouped(shape, &Axis { name, unit, scale: AxisScale::Log }, &groups, |_| "paper".to_owned())
}

impl Results for Figure3Results {
    fn figures(&self) -> Vec<Figure> {
        let forms = "Shapes (left) and their canonical forms by each method. Every form fills its tile and is rotated to \
                     match the first of its row. Under it: its stress in squared mesh units, from the run of median \
                     stress, and the number printed in the paper.";
        let stress = "Median and range of the stress over runs that differ in the first sample, for three kinds of \
                      distances, and the numbers printed in the paper.";
        let shapes = Classes::of(self.stresses.iter().map(|s| s.shape.as_str()));
        let plots: Vec<Plot> = shapes.names().iter().map(|shape| plot(shape, &self.stresses)).collect();
        let forms = Figure { part: PART, caption: forms.into(), panels: FigurePanels::Surfaces };
        let stress = Figure { part: "-stress", caption: stress.into(), panels: FigurePanels::Plots(plots) };
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
    use crate::figure::SeriesKind;
    use mesh::shapes::icosphere;

    use crate::tests::fixtures::{assert_balanced, assert_holds, figure3_record};

    #[test]
    fn every_form_has_its_stress_and_that_of_the_paper() {
        let record = figure3_record();
        let ball = icosphere(2);
        let surfaces = vec![(ball.clone(), vec![ball; 2]); 2];
        let folder = tempfile::tempdir().unwrap();
        let files = record.results.tiles(&surfaces).unwrap().save(folder.path().join("figure3")).unwrap();
        let svg = std::fs::read_to_string(&files[1]).unwrap();
        assert_balanced(&svg);
        assert_holds(
            &svg,
            &["david&lt;0&gt;", "MDS", "NMDS", "stress 262.1", "paper 394.41", "3400 vertices"],
        );
        assert_eq!(svg.matches("data:image/png;base64,").count(), 6);
    }

    #[test]
    fn forms_without_facts_are_an_error() {
        let record = figure3_record();
        let empty = record.results.tiles(&[]).unwrap_err();
        assert!(matches!(empty, ReportError::Empty { .. }), "{empty}");
        let ball = icosphere(2);
        let short = record.results.tiles(&[(ball.clone(), vec![ball])]).unwrap_err();
        assert!(short.to_string().starts_with("forms of david<0> has 1 entries instead of 2"), "{short}");
    }

    #[test]
    fn the_plot_of_stress_has_ranges_and_the_number_of_the_paper() {
        let record = figure3_record();
        let figures = record.results.figures();
        let FigurePanels::Plots(plots) = &figures[1].panels else { panic!("{figures:?}") };
        let [plot] = &plots[..] else { panic!("{plots:?}") };
        assert_eq!(plot.x.ticks[0].1, "MDS");
        let [default, paper] = &plot.series[..] else { panic!("{:?}", plot.series) };
        assert_eq!((default.points[0].low, default.points[0].high), (386.0, 387.0));
        assert_eq!((paper.kind, paper.points[0].y), (SeriesKind::Hollow, 394.41));
    }
}
