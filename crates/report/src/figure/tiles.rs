//! Rows of rendered surfaces with captions, as a static figure.

use mesh::TriMesh;
use plotters::prelude::DrawingBackend;
use plotters::style::text_anchor::HPos;

use super::drawing::{
    Area, Drawing, Drawn, GRID, Hover, INK, LABEL, NAME, PAGE_WIDTH, PALE_INK, PICTURE_PX, Picture, TITLE,
    anchored, bold, line, text, write,
};
use crate::color::class_clay;
use crate::error::ReportError;
use crate::record::{Tile, TileRow, Tiles};
use crate::render::{Background, Coloring, RenderOptions, View, aspect, render};

/// Around the figure.
const MARGIN: f64 = 10.0;
/// The greatest width of a tile.
const WIDEST: f64 = 240.0;
/// Space between pairs of tiles.
const GUTTER: f64 = 34.0;
/// From the top of a row to its tiles.
const TITLES: f64 = 36.0;
/// From the lower side of tiles to the middle of the first caption.
const CAPTIONS: f64 = 13.0;
/// Space under a row.
const FOOT: f64 = 16.0;
/// Height of a line of captions.
const LINE: f64 = 20.0;
/// Height of the headings of the columns.
const HEADS: f64 = 28.0;

impl Tiles {
    fn gutter(&self) -> f64 {
        if self.is_paired { GUTTER } else { 0.0 }
    }

    fn tile_width(&self) -> f64 {
        let columns = self.heads.len();
        let gutters = self.gutter() * (columns.div_ceil(2) as f64 - 1.0);
        ((f64::from(PAGE_WIDTH) - 2.0 * MARGIN - gutters) / columns as f64).floor().min(WIDEST)
    }

    fn left(&self, column: usize) -> f64 {
        MARGIN + column as f64 * self.tile_width() + (column / 2) as f64 * self.gutter()
    }

    /// The top of every row and the height of its tiles, from the mean proportions of its shapes; then the bottom.
    fn places(&self) -> (Vec<[f64; 2]>, f64) {
        let (mut places, mut top) = (Vec::new(), HEADS);
        for TileRow { tiles, .. } in &self.rows {
            let shapes = tiles.iter().filter(|tile| !tile.is_form);
            let aspects: Vec<f64> =
                shapes.map(|tile| aspect(&tile.surface.mesh(), &View::default())).collect();
            let mean = aspects.iter().sum::<f64>() / aspects.len().max(1) as f64;
            let height = (self.tile_width() / mean.clamp(0.6, 1.3)).round();
            places.push([top, height]);
            let lines = tiles.iter().map(|tile| tile.captions.len()).max().unwrap_or(0);
            top += TITLES + height + lines as f64 * LINE + FOOT;
        }
        (places, top)
    }
}

impl Drawing for Tiles {
    fn size(&self) -> [i32; 2] {
        [PAGE_WIDTH, self.places().1 as i32]
    }

    fn pictures(&self) -> Result<Vec<Picture>, ReportError> {
        let mut pictures = Vec::new();
        let width = self.tile_width();
        for (class, (row, [top, height])) in self.rows.iter().zip(self.places().0).enumerate() {
            let meshes: Vec<TriMesh> = row.tiles.iter().map(|tile| tile.surface.mesh()).collect();
            let tiles = || row.tiles.iter().zip(&meshes);
            let form = tiles().find(|(tile, _)| tile.is_form);
            let form_view =
                form.map_or(View::default(), |(_, form)| View::Principal.fixed(form, width > height));
            for (column, (tile, mesh)) in tiles().enumerate() {
                let [wide, high] = [width, height].map(|side| side as u32 * PICTURE_PX as u32);
                let options = RenderOptions {
                    width: wide,
                    height: high,
                    view: if tile.is_form { form_view } else { View::default() },
                    background: Background::Transparent,
                    coloring: Coloring::Plain(class_clay(class)),
                    ..RenderOptions::default()
                };
                let place = [self.left(column), top + TITLES].map(|at| at as i32);
                pictures.push((render(mesh, &options, &())?, place));
            }
        }
        Ok(pictures)
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB, Vec<Hover>> {
        let middle = |column: usize| self.left(column) + self.tile_width() / 2.0;
        for (column, head) in self.heads.iter().enumerate() {
            write(area, head, bold(text(NAME, INK)), [middle(column), HEADS / 2.0])?;
        }
        for (TileRow { name: title, tiles }, [top, height]) in self.rows.iter().zip(self.places().0) {
            line(area, [MARGIN, top], [f64::from(PAGE_WIDTH) - MARGIN, top], 1.0, GRID)?;
            write(area, title, anchored(bold(text(TITLE, INK)), HPos::Left), [MARGIN, top + 19.0])?;
            for (column, Tile { captions, .. }) in tiles.iter().enumerate() {
                for (i, caption) in captions.iter().enumerate() {
                    let ink = if i == 0 { INK } else { PALE_INK };
                    let down = top + TITLES + height + CAPTIONS + i as f64 * LINE;
                    write(area, caption, text(LABEL, ink), [middle(column), down])?;
                }
            }
        }
        Ok(Vec::new())
    }
}
