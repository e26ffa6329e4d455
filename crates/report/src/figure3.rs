//! Figure 3: the forms of a few shapes by several methods, shaded, the stress under each.

use std::path::{Path, PathBuf};

use mesh::TriMesh;
use plotters::prelude::DrawingBackend;

use crate::figure1::stress_digits;
use crate::results::Figure3Shape;
use view::RgbaImage;
use view::canvas::{Anchor, Canvas, DrawError, Drawing, GRID, RASTER, SMALL, TEXT, TITLE, Type, save};
use view::color::class_clay;
use view::render::{RenderOptions, Surface, View, aspect, render};

use crate::ReportError;

/// What is appended to the stem of Figure 3's files, before `.png` and `.svg`.
pub const PART: &str = "-forms";

/// One row of the figure.
#[derive(Debug, Clone)]
pub struct Figure3Surfaces<'a> {
    /// Names and stresses, which are written under the pictures.
    pub facts: &'a Figure3Shape,
    /// The shape.
    pub shape: &'a TriMesh,
    /// Its forms in the order of `facts.forms`, turned to match each other.
    pub forms: &'a [TriMesh],
}

/// Draws a row for each shape, the shape first and then its forms, and returns the paths of
/// `STEM-forms.png` and `STEM-forms.svg`. The forms of a row are all seen from one side, on which the
/// principal axes of the first lie in the picture; each fills its tile, whatever its size.
///
/// # Errors
/// [`ReportError::Empty`] without a row, [`ReportError::Shape`] when forms and facts do not pair up,
/// [`ReportError::View`].
pub fn figure3(
    rows: &[Figure3Surfaces<'_>],
    view: &View,
    stem: impl AsRef<Path>,
) -> Result<Vec<PathBuf>, ReportError> {
    if rows.iter().all(|row| row.forms.is_empty()) {
        return Err(ReportError::Empty { figure: "figure 3", unit: "shape with a form" });
    }
    for row in rows {
        let (found, expected) = (row.forms.len(), row.facts.forms.len());
        if found != expected {
            let what = format!("forms of {}", row.facts.name);
            return Err(ReportError::Shape { what, found, expected, unit: "stress" });
        }
    }
    let mut stem = stem.as_ref().as_os_str().to_owned();
    stem.push(PART);
    Ok(save(&Grid::new(rows, view), Path::new(&stem))?)
}

const WIDTH: f64 = 1000.0;
const MARGIN: f64 = 10.0;
/// Above all: the names of the columns. Above a row: the name of its shape. Under it: two lines.
const COLUMN_HEAD: f64 = 28.0;
const HEAD: f64 = 34.0;
const FOOT: f64 = 48.0;

struct Grid {
    heads: Vec<String>,
    rows: Vec<Row>,
    tile: f64,
}

struct Row {
    title: String,
    height: f64,
    images: Vec<RgbaImage>,
    /// Two lines for each image.
    captions: Vec<[String; 2]>,
}

impl Grid {
    fn new(rows: &[Figure3Surfaces<'_>], view: &View) -> Self {
        let columns = rows.iter().map(|row| row.forms.len() + 1).max().unwrap_or(1);
        let tile = ((WIDTH - 2.0 * MARGIN) / columns as f64).floor().min(240.0);
        let longest = rows.iter().max_by_key(|row| row.forms.len());
        let methods = longest.into_iter().flat_map(|row| row.facts.forms.iter().map(|f| f.method.clone()));
        Self {
            heads: std::iter::once("shape".to_owned()).chain(methods).collect(),
            rows: rows.iter().enumerate().map(|(i, row)| Row::new(row, i, view, tile)).collect(),
            tile,
        }
    }

    fn middle(&self, column: usize) -> f64 {
        MARGIN + (column as f64 + 0.5) * self.tile
    }
}

impl Row {
    fn new(row: &Figure3Surfaces<'_>, class: usize, view: &View, tile: f64) -> Self {
        let height = (tile / aspect(row.shape, view).clamp(0.6, 1.2)).round();
        let fixed = row.forms.first().map_or(*view, |form| View::Principal.fixed(form, tile > height));
        let [width, high] = [tile, height].map(|side| side as u32 * RASTER);
        let picture = |mesh, view| {
            let surface = Surface::Plain(class_clay(class));
            render(mesh, &RenderOptions { width, height: high, view, surface, ..RenderOptions::default() })
        };
        let mut images = vec![picture(row.shape, *view)];
        images.extend(row.forms.iter().map(|form| picture(form, fixed)));
        let mut captions = vec![[format!("{} vertices", row.facts.n_vertices), String::new()]];
        captions.extend(row.facts.forms.iter().map(|form| {
            let paper = form.paper.map_or_else(String::new, |paper| format!("paper {paper}"));
            [format!("stress {}", stress_digits(form.stress)), paper]
        }));
        Self { title: row.facts.name.clone(), height, images, captions }
    }

    fn full_height(&self) -> f64 {
        HEAD + self.height + FOOT
    }
}

impl Drawing for Grid {
    fn size(&self) -> (u32, u32) {
        let height: f64 = self.rows.iter().map(Row::full_height).sum();
        (WIDTH as u32, (COLUMN_HEAD + height + MARGIN) as u32)
    }

    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), DrawError> {
        for (column, head) in self.heads.iter().enumerate() {
            canvas.text(head, (self.middle(column), 15.0), Type::new(TEXT, Anchor::Center).bold())?;
        }
        let mut top = COLUMN_HEAD;
        for row in &self.rows {
            canvas.line((MARGIN, top + 1.0), (WIDTH - MARGIN, top + 1.0), 1.0, GRID)?;
            canvas.text(&row.title, (MARGIN, top + 20.0), Type::new(TITLE, Anchor::Left).bold())?;
            for (column, (image, caption)) in row.images.iter().zip(&row.captions).enumerate() {
                let (middle, under) = (self.middle(column), top + HEAD + row.height);
                canvas.image(image, (middle - self.tile / 2.0, top + HEAD))?;
                canvas.text(&caption[0], (middle, under + 12.0), Type::new(SMALL, Anchor::Center))?;
                let pale = Type::new(SMALL, Anchor::Center).pale();
                canvas.text(&caption[1], (middle, under + 32.0), pale)?;
            }
            top += row.full_height();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let files = figure3(&rows, &View::default(), folder.path().join("figure3")).unwrap();
        let svg = std::fs::read_to_string(&files[1]).unwrap();
        assert_balanced(&svg);
        for text in ["david&lt;0&gt;", "MDS", "NMDS", "stress 262.1", "paper 394.41", "3400 vertices"] {
            assert!(svg.contains(text), "{text}");
        }
        assert_eq!(svg.matches("data:image/png;base64,").count(), 6);
    }

    #[test]
    fn rows_that_do_not_pair_up_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let stem = folder.path().join("x");
        let empty = figure3(&[], &View::default(), &stem).unwrap_err();
        assert!(matches!(empty, ReportError::Empty { .. }), "{empty}");
        let record = figure3_record();
        let ball = icosphere(2);
        let row = Figure3Surfaces { facts: &record.shapes[0], shape: &ball, forms: &[icosphere(2)] };
        let short = figure3(&[row], &View::default(), &stem).unwrap_err();
        assert!(short.to_string().starts_with("forms of david<0> has 1 entries where 2"), "{short}");
    }
}
