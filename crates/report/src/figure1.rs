//! Figure 1: shapes beside their canonical forms, shaded, one row for each class.

use std::path::{Path, PathBuf};

use mesh::TriMesh;
use plotters::prelude::DrawingBackend;

use crate::classes::Classes;
use crate::results::Figure1Shape;
use view::RgbaImage;
use view::canvas::{Anchor, Canvas, DrawError, Drawing, GRID, RASTER, SMALL, TEXT, TITLE, Type, save};
use view::color::class_clay;
use view::render::{RenderOptions, Surface, View, aspect, render};

use crate::ReportError;

/// What is appended to the stem of Figure 1's files, before `.png` and `.svg`.
pub const PART: &str = "-forms";

/// Pairs drawn for each class; further ones are left out.
pub const PAIRS: usize = 3;

/// One pair of the figure.
#[derive(Debug, Clone, Copy)]
pub struct Figure1Pair<'a> {
    /// Name, class and stress, which are written under the pictures.
    pub facts: &'a Figure1Shape,
    /// The shape.
    pub shape: &'a TriMesh,
    /// Its canonical form: the same faces, in the first three dimensions of the embedding, turned (or
    /// mirrored, as embeddings are free to be) to match the first form of its class.
    pub form: &'a TriMesh,
}

/// Draws the first [`PAIRS`] pairs of each class, in the order given, and returns the paths of
/// `STEM-forms.png` and `STEM-forms.svg`. Shapes are seen from `view`; the forms of a class all
/// from one side, on which the principal axes of the first lie in the picture.
///
/// # Errors
/// [`ReportError::Empty`] without a pair, [`ReportError::View`].
pub fn figure1(
    pairs: &[Figure1Pair],
    view: &View,
    stem: impl AsRef<Path>,
) -> Result<Vec<PathBuf>, ReportError> {
    if pairs.is_empty() {
        return Err(ReportError::Empty { figure: "figure 1", unit: "pair of a shape and its form" });
    }
    let mut stem = stem.as_ref().as_os_str().to_owned();
    stem.push(PART);
    Ok(save(&Grid::new(pairs, view), Path::new(&stem))?)
}

const WIDTH: f64 = 1000.0;
const MARGIN: f64 = 10.0;
/// Between two pairs.
const GUTTER: f64 = 34.0;
/// Above all: which column is which.
const COLUMN_HEAD: f64 = 26.0;
/// Above the tiles of a class: its name. Under them: the names of the shapes.
const HEAD: f64 = 38.0;
const FOOT: f64 = 34.0;

/// The figure, laid out, its tiles rendered.
struct Grid {
    rows: Vec<Row>,
    /// Width of a tile, in units.
    tile: f64,
}

struct Row {
    title: String,
    /// Height of a tile, in units.
    height: f64,
    cells: Vec<Cell>,
}

struct Cell {
    images: [RgbaImage; 2],
    captions: [String; 2],
}

impl Grid {
    fn new(pairs: &[Figure1Pair], view: &View) -> Self {
        let classes = Classes::of(pairs.iter().map(|p| p.facts.label.as_str()));
        let groups: Vec<Vec<&Figure1Pair>> = (0..classes.len())
            .map(|class| {
                pairs.iter().filter(|p| classes.index(&p.facts.label) == class).take(PAIRS).collect()
            })
            .collect();
        let columns = groups.iter().map(Vec::len).max().unwrap_or(1) as f64;
        let tile = ((WIDTH - 2.0 * MARGIN - GUTTER * (columns - 1.0)) / (2.0 * columns)).floor().min(240.0);
        let rows = groups
            .iter()
            .enumerate()
            .map(|(class, group)| {
                let mean = group.iter().map(|p| aspect(p.shape, view)).sum::<f64>() / group.len() as f64;
                let height = (tile / mean.clamp(0.6, 1.4)).round();
                let views = [*view, View::Principal.fixed(group[0].form, tile > height)];
                let cells = group.iter().map(|pair| Cell::new(pair, views, class, [tile, height])).collect();
                Row { title: classes.name(class).to_string(), height, cells }
            })
            .collect();
        Self { rows, tile }
    }

    /// Left edge of a tile of pair number `pair`: 0 is the shape's, 1 the form's.
    fn left(&self, pair: usize, side: usize) -> f64 {
        MARGIN + pair as f64 * (2.0 * self.tile + GUTTER) + side as f64 * self.tile
    }
}

impl Cell {
    fn new(pair: &Figure1Pair, views: [View; 2], class: usize, tile: [f64; 2]) -> Self {
        let [width, height] = tile.map(|side| side as u32 * RASTER);
        let surface = Surface::Plain(class_clay(class));
        let shape = RenderOptions { width, height, view: views[0], surface, ..RenderOptions::default() };
        let form = RenderOptions { view: views[1], ..shape.clone() };
        Self {
            images: [render(pair.shape, &shape), render(pair.form, &form)],
            captions: [pair.facts.name.clone(), format!("stress {}", stress_digits(pair.facts.stress))],
        }
    }
}

/// A stress with about four digits.
pub(crate) fn stress_digits(stress: f64) -> String {
    match stress.abs() {
        s if s >= 1000.0 => format!("{stress:.0}"),
        s if s >= 10.0 => format!("{stress:.1}"),
        s if s >= 0.1 || s == 0.0 => format!("{stress:.3}"),
        _ => format!("{stress:.2e}"),
    }
}

impl Drawing for Grid {
    fn size(&self) -> (u32, u32) {
        let height: f64 = self.rows.iter().map(|row| HEAD + row.height + FOOT).sum();
        (WIDTH as u32, (COLUMN_HEAD + height + MARGIN) as u32)
    }

    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), DrawError> {
        let columns = self.rows.iter().map(|row| row.cells.len()).max().unwrap_or(0);
        for column in 0..2 * columns {
            let head = ["shape", "canonical form"][column % 2];
            let middle = self.left(column / 2, column % 2) + self.tile / 2.0;
            canvas.text(head, (middle, 15.0), Type::new(SMALL, Anchor::Center).pale())?;
        }
        let mut top = COLUMN_HEAD;
        for row in &self.rows {
            let title = Type::new(TITLE, Anchor::Left).bold();
            canvas.text(&row.title, (MARGIN, top + 22.0), title)?;
            canvas.line((MARGIN, top + 2.0), (WIDTH - MARGIN, top + 2.0), 1.0, GRID)?;
            for (c, cell) in row.cells.iter().enumerate() {
                for side in 0..2 {
                    let left = self.left(c, side);
                    let middle = left + self.tile / 2.0;
                    canvas.image(&cell.images[side], (left, top + HEAD))?;
                    let small = Type::new(if side == 0 { TEXT } else { SMALL }, Anchor::Center);
                    let small = if side == 0 { small } else { small.pale() };
                    canvas.text(&cell.captions[side], (middle, top + HEAD + row.height + 14.0), small)?;
                }
            }
            top += HEAD + row.height + FOOT;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::shapes::icosphere;

    use crate::fixtures::{assert_balanced, figure1_record};

    #[test]
    fn every_shape_is_named_and_files_repeat() {
        let mut shapes = figure1_record().shapes;
        let first = shapes[0].clone();
        shapes.extend((1..6).map(|i| Figure1Shape { name: format!("cat{i}"), ..first.clone() }));
        let ball = icosphere(2);
        let pairs: Vec<Figure1Pair> =
            shapes.iter().map(|facts| Figure1Pair { facts, shape: &ball, form: &ball }).collect();
        let folder = tempfile::tempdir().unwrap();
        let draw = |stem: &str| -> Vec<Vec<u8>> {
            let files = figure1(&pairs, &View::default(), folder.path().join(stem)).unwrap();
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
        assert!(!svg.contains("cat3"), "three pairs a class");
        assert_eq!(svg.matches("data:image/png;base64,").count(), 8);
    }

    #[test]
    fn without_a_pair_there_is_no_figure() {
        let folder = tempfile::tempdir().unwrap();
        let error = figure1(&[], &View::default(), folder.path().join("x")).unwrap_err();
        assert!(matches!(error, ReportError::Empty { .. }), "{error}");
    }

    #[test]
    fn stress_keeps_its_digits_at_every_size() {
        for (stress, text) in
            [(395.94, "395.9"), (12345.6, "12346"), (0.5, "0.500"), (0.0, "0.000"), (1.234e-5, "1.23e-5")]
        {
            assert_eq!(stress_digits(stress), text);
        }
    }
}
