//! Figure 1: shapes beside their canonical forms, one row per class.

use mesh::TriMesh;

use crate::classes::Classes;
use crate::figure::{Content, Figure, Layout, Tile, Tiles};
use crate::results::{Expectation, Figure1Record, Figure1Shape, Provenance};
use crate::table::stress;
use crate::{Cell, Record, ReportError, Table};
use view::render::View;

const PART: &str = "-forms";

/// The greatest number of pairs in a row.
pub const PAIRS: usize = 3;

/// A shape and its canonical form.
#[derive(Debug, Clone, Copy)]
pub struct Figure1Pair<'a> {
    /// Name, class and stress.
    pub facts: &'a Figure1Shape,
    /// The shape.
    pub shape: &'a TriMesh,
    /// Its canonical form: the same faces in the first three dimensions of the embedding, rotated or reflected to
    /// match the first form of its class.
    pub form: &'a TriMesh,
}

/// The first [`PAIRS`] pairs of every class, with the shapes seen from `view`.
///
/// # Errors
/// [`ReportError::Empty`] without a pair.
pub fn figure1<'a>(pairs: &[Figure1Pair<'a>], view: &View) -> Result<Tiles<'a>, ReportError> {
    if pairs.is_empty() {
        return Err(ReportError::Empty { figure: "figure 1", unit: "pair of a shape and its form" });
    }
    let classes = Classes::of(pairs.iter().map(|p| p.facts.label.as_str()));
    let row = |class: &&str| {
        let members = pairs.iter().filter(|p| p.facts.label == **class).take(PAIRS);
        let tiles = members.flat_map(|pair| {
            let stress = format!("stress {}", stress(pair.facts.stress));
            [
                Tile::Shape(pair.shape, vec![(pair.facts.name.clone(), Layout::NAME)]),
                Tile::Form(pair.form, vec![(stress, Layout::NOTE)]),
            ]
        });
        ((*class).to_owned(), tiles.collect())
    };
    let rows: Vec<(String, Vec<Tile<'_>>)> = classes.names().iter().map(row).collect();
    let columns = rows.iter().map(|(_, tiles)| tiles.len()).max().unwrap_or(0);
    let heads = ["shape", "canonical form"].map(str::to_owned).into_iter().cycle().take(columns).collect();
    Ok(Tiles { part: PART, layout: &Layout::PAIRS, view: *view, heads, rows })
}

impl Record for Figure1Record {
    fn about(&self) -> (&Provenance, &[Expectation], &str) {
        (&self.provenance, &self.expectations, &self.analysis)
    }

    fn figures(&self) -> Vec<Figure> {
        let caption = "Up to three shapes of each class (left), each with its canonical form (right). All forms of a \
                       class are seen from the same side; the number under each is its stress in squared mesh units. \
                       Colours denote classes, as in Figure 4.";
        vec![Figure { part: PART, caption: caption.to_owned(), content: Content::Surfaces }]
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

    use crate::fixtures::{assert_balanced, figure1_record};

    #[test]
    fn every_shape_is_named_and_the_files_are_deterministic() {
        let mut shapes = figure1_record().shapes;
        let first = shapes[0].clone();
        shapes.extend((1..6).map(|i| Figure1Shape { name: format!("cat{i}"), ..first.clone() }));
        let ball = icosphere(2);
        let pairs: Vec<Figure1Pair> =
            shapes.iter().map(|facts| Figure1Pair { facts, shape: &ball, form: &ball }).collect();
        let folder = tempfile::tempdir().unwrap();
        let draw = |stem: &str| -> Vec<Vec<u8>> {
            let files = figure1(&pairs, &View::default()).unwrap().save(folder.path().join(stem)).unwrap();
            assert_eq!(files[0], folder.path().join(format!("{stem}-forms.png")));
            files.iter().map(|f| std::fs::read(f).unwrap()).collect()
        };
        let files = draw("a");
        assert_eq!(files, draw("b"));
        let svg = String::from_utf8(files[1].clone()).unwrap();
        assert_balanced(&svg);
        for text in
            ["cat0", "cat1", "cat2", "dog&lt;3&gt;", "cat\n", "dog\n", "stress 262.1", "canonical form"]
        {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("cat3"), "three pairs per class");
        assert_eq!(svg.matches("data:image/png;base64,").count(), 8);
    }

    #[test]
    fn a_figure_without_a_pair_is_an_error() {
        let error = figure1(&[], &View::default()).unwrap_err();
        assert!(matches!(error, ReportError::Empty { .. }), "{error}");
    }
}
