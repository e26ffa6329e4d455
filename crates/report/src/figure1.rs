//! Figure 1: shapes beside their canonical forms, one row per class.

use mesh::TriMesh;

use crate::classes::Classes;
use crate::error::ReportError;
use crate::figure::{Figure, FigurePanels, Tile, Tiles};
use crate::record::Results;
use crate::results::{Figure1Results, Figure1Shape};
use crate::table::{Cell, Table, stress};

const PART: &str = "-forms";

impl Figure1Results {
    /// The greatest number of pairs in a row.
    pub const PAIRS: usize = 3;

    /// The static figure: the first [`PAIRS`](Self::PAIRS) shapes of every class, each with its form.
    ///
    /// `shapes` and `forms` follow the order of `self.shapes`. The forms have the same faces in the first three
    /// dimensions of the embedding, rotated or reflected to match the first form of their class.
    ///
    /// # Errors
    /// [`ReportError::Empty`] without a shape, [`ReportError::Shape`] if the lists differ in length.
    pub fn tiles<'a>(&self, shapes: &'a [TriMesh], forms: &'a [TriMesh]) -> Result<Tiles<'a>, ReportError> {
        if self.shapes.is_empty() {
            return Err(ReportError::Empty { figure: "figure 1", unit: "pair of a shape and its form" });
        }
        for (what, found) in
            [("the surfaces of figure 1", shapes.len()), ("the forms of figure 1", forms.len())]
        {
            ReportError::check_length(what, found, self.shapes.len(), "shape")?;
        }
        let classes = Classes::of(self.shapes.iter().map(|shape| shape.label.as_str()));
        let row = |class: &&str| {
            let members = self.shapes.iter().zip(shapes.iter().zip(forms));
            let members = members.filter(|(facts, _)| facts.label == **class).take(Self::PAIRS);
            let tiles = members.flat_map(|(facts, (shape, form))| {
                let stress = format!("stress {}", stress(facts.stress));
                [
                    Tile { mesh: shape, is_form: false, captions: vec![facts.name.clone()] },
                    Tile { mesh: form, is_form: true, captions: vec![stress] },
                ]
            });
            ((*class).to_owned(), tiles.collect())
        };
        let rows: Vec<(String, Vec<Tile<'_>>)> = classes.names().iter().map(row).collect();
        let columns = rows.iter().map(|(_, tiles)| tiles.len()).max().unwrap_or(0);
        let heads =
            ["shape", "canonical form"].map(str::to_owned).into_iter().cycle().take(columns).collect();
        Ok(Tiles { part: PART, is_paired: true, heads, rows })
    }
}

impl Results for Figure1Results {
    fn figures(&self) -> Vec<Figure> {
        let caption = "Up to three shapes of each class (left), each with its canonical form (right). All forms of a \
                       class are seen from the same side; the number under each is its stress in squared mesh units. \
                       Colours denote classes, as in Figure 4.";
        vec![Figure { part: PART, caption: caption.to_owned(), panels: FigurePanels::Surfaces }]
    }

    fn tables(&self) -> Vec<Table> {
        let row = |s: &Figure1Shape| {
            let repair = if s.repair.is_empty() { "nothing".to_owned() } else { s.repair.join("; ") };
            vec![
                Cell::text(&s.name),
                Cell::text(&s.label),
                Cell::number(s.n_vertices),
                Cell::number(s.n_faces),
                Cell::number(stress(s.stress)),
                Cell::text(repair),
            ]
        };
        let caption =
            "The embedded shapes, the stress of their canonical forms, and what was repaired in the input.";
        let headings = ["shape", "class", "vertices", "faces", "stress", "repaired"];
        let table = Table::new(caption, headings, self.shapes.iter().map(row).collect());
        vec![table.folded(format!("{} shapes", self.shapes.len()))]
    }

    fn summary(&self) -> Option<Table> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::shapes::icosphere;

    use crate::tests::fixtures::{assert_balanced, assert_holds, figure1_record};

    #[test]
    fn every_shape_is_named_and_the_files_are_deterministic() {
        let mut results = figure1_record().results;
        let first = results.shapes[0].clone();
        results.shapes.extend((1..6).map(|i| Figure1Shape { name: format!("cat{i}"), ..first.clone() }));
        let balls = vec![icosphere(2); results.shapes.len()];
        let folder = tempfile::tempdir().unwrap();
        let draw = |stem: &str| -> Vec<Vec<u8>> {
            let files = results.tiles(&balls, &balls).unwrap().save(folder.path().join(stem)).unwrap();
            assert_eq!(files[0], folder.path().join(format!("{stem}-forms.png")));
            files.iter().map(|f| std::fs::read(f).unwrap()).collect()
        };
        let files = draw("a");
        assert_eq!(files, draw("b"));
        let svg = String::from_utf8(files[1].clone()).unwrap();
        assert_balanced(&svg);
        assert_holds(&svg, &["cat0", "cat1", "cat2", "dog&lt;3&gt;", "stress 262.1", "canonical form"]);
        assert_holds(&svg, &[">\ncat\n<", ">\ndog\n<"]);
        assert!(!svg.contains("cat3"), "three pairs per class");
        assert_eq!(svg.matches("data:image/png;base64,").count(), 8);
    }

    #[test]
    fn a_figure_without_a_pair_or_with_a_missing_form_is_an_error() {
        let error = Figure1Results::default().tiles(&[], &[]).unwrap_err();
        assert!(matches!(error, ReportError::Empty { .. }), "{error}");
        let balls = vec![icosphere(1); 2];
        let error = figure1_record().results.tiles(&balls, &balls[..1]).unwrap_err();
        assert!(error.to_string().starts_with("the forms of figure 1 has 1 entries instead of 2"), "{error}");
    }
}
