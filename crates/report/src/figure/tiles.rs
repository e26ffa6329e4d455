//! Rows of rendered surfaces with captions, as a static figure.

use std::path::{Path, PathBuf};

use mesh::TriMesh;

use crate::error::ReportError;
use view::canvas::{Anchor, Canvas, GRID, PAGE_WIDTH, PALE_INK, PIXELS_PER_UNIT, TextStyle};
use view::color::class_clay;
use view::render::{Background, RenderOptions, Surface, View, aspect, render};

const MARGIN: f64 = 10.0;
const TILE: f64 = 240.0;

/// Rows of surfaces. Those of row number `n` have the colour of class number `n`.
///
/// Shapes have the default view; all forms of a row share the view of the principal axes of the first one.
#[derive(Debug, Clone)]
pub struct Tiles<'a> {
    /// What follows the name of the experiment in the names of the files.
    pub part: &'static str,
    /// The arrangement.
    pub layout: &'static Layout,
    /// Headings of the columns.
    pub heads: Vec<String>,
    /// The rows, with their headings.
    pub rows: Vec<(String, Vec<Tile<'a>>)>,
}

/// A surface, with lines of text under it.
#[derive(Debug, Clone)]
pub enum Tile<'a> {
    /// A shape.
    Shape(&'a TriMesh, Vec<(String, TextStyle)>),
    /// A canonical form.
    Form(&'a TriMesh, Vec<(String, TextStyle)>),
}

/// An arrangement of tiles: distances in units, from the top of the figure or row unless stated otherwise.
#[derive(Debug)]
pub struct Layout {
    /// Space after every second tile.
    gutter: f64,
    /// The greatest ratio of width to height of a tile.
    widest: f64,
    heads: TextStyle,
    first_row: f64,
    rule: f64,
    title: f64,
    tiles: f64,
    /// Space under the tiles.
    foot: f64,
    /// From the lower side of a tile to its captions.
    captions: [f64; 2],
}

impl Layout {
    /// Two tiles that belong together, with a caption each.
    pub const PAIRS: Self = Self {
        gutter: 34.0,
        widest: 1.4,
        heads: Self::NOTE,
        first_row: 26.0,
        rule: 2.0,
        title: 22.0,
        tiles: 38.0,
        foot: 34.0,
        captions: [14.0, 34.0],
    };

    /// Tiles side by side, with two captions each.
    pub const LINE: Self = Self {
        gutter: 0.0,
        widest: 1.2,
        heads: TextStyle::NAME.bold(),
        first_row: 28.0,
        rule: 1.0,
        title: 20.0,
        tiles: 34.0,
        foot: 48.0,
        captions: [12.0, 32.0],
    };

    /// The style of notes.
    pub const NOTE: TextStyle = TextStyle::LABEL.colored(PALE_INK);
}

impl Tiles<'_> {
    /// Draws the figure and returns the paths of the PNG, the SVG and the PDF.
    ///
    /// # Errors
    /// [`ReportError::View`] if drawing or writing fails.
    pub fn save(&self, stem: impl AsRef<Path>) -> Result<Vec<PathBuf>, ReportError> {
        let layout = self.layout;
        let columns = self.heads.len();
        let gutters = layout.gutter * (columns.div_ceil(2) as f64 - 1.0);
        let width = ((PAGE_WIDTH - 2.0 * MARGIN - gutters) / columns as f64).floor().min(TILE);
        let left = |column: usize| MARGIN + column as f64 * width + (column / 2) as f64 * layout.gutter;
        let heights: Vec<f64> = self.rows.iter().map(|(_, tiles)| self.height(tiles, width)).collect();
        let row = |height: f64| layout.tiles + height + layout.foot;
        let high = layout.first_row + heights.iter().copied().map(row).sum::<f64>() + MARGIN;
        let mut canvas = Canvas::new(PAGE_WIDTH as u32, high as u32);
        for (column, head) in self.heads.iter().enumerate() {
            canvas.text(head, (left(column) + width / 2.0, 15.0), layout.heads);
        }
        let mut top = layout.first_row;
        for (class, ((title, tiles), height)) in self.rows.iter().zip(heights).enumerate() {
            canvas.text(title, (MARGIN, top + layout.title), TextStyle::TITLE.at(Anchor::Left));
            let rule = top + layout.rule;
            canvas.line((MARGIN, rule), (PAGE_WIDTH - MARGIN, rule), 1.0, GRID);
            let form =
                tiles.iter().find_map(|tile| if let Tile::Form(mesh, _) = tile { Some(mesh) } else { None });
            let form_view = form.map_or(View::default(), |form| View::Principal.fixed(form, width > height));
            for (column, tile) in tiles.iter().enumerate() {
                let (mesh, view, captions) = match tile {
                    Tile::Shape(mesh, captions) => (mesh, View::default(), captions),
                    Tile::Form(mesh, captions) => (mesh, form_view, captions),
                };
                let options = RenderOptions {
                    width: width as u32 * PIXELS_PER_UNIT,
                    height: height as u32 * PIXELS_PER_UNIT,
                    view,
                    background: Background::Transparent,
                    surface: Surface::Plain(class_clay(class)),
                    ..RenderOptions::default()
                };
                canvas.image(render(mesh, &options), (left(column), top + layout.tiles));
                let (middle, under) = (left(column) + width / 2.0, top + layout.tiles + height);
                for ((text, style), down) in captions.iter().zip(layout.captions) {
                    canvas.text(text, (middle, under + down), *style);
                }
            }
            top += row(height);
        }
        Ok(canvas.save(stem.as_ref(), self.part)?)
    }

    /// The height of the tiles of a row, from the mean proportions of its shapes.
    fn height(&self, tiles: &[Tile<'_>], width: f64) -> f64 {
        let shape = |tile: &Tile<'_>| {
            if let Tile::Shape(mesh, _) = tile { Some(aspect(mesh, &View::default())) } else { None }
        };
        let aspects: Vec<f64> = tiles.iter().filter_map(shape).collect();
        let mean = aspects.iter().sum::<f64>() / aspects.len() as f64;
        (width / mean.clamp(0.6, self.layout.widest)).round()
    }
}
