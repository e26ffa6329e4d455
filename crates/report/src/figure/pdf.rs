//! A backend of plotters that writes a PDF: one page of 7 inches width, with text that can be searched.

use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};
use plotters::style::text_anchor::{HPos, VPos};
use plotters::style::{FontStyle, FontTransform};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
};
use subsetter::{GlyphRemapper, subset};
use ttf_parser::{Face, GlyphId};

use super::units::{LINE, PAGE_WIDTH, PICTURE_PX, PX, Picture};

/// Points per pixel.
const SCALE: f32 = 7.0 * 72.0 / (PAGE_WIDTH * PX) as f32;

/// From the anchor of a text down to its baseline, in lines, as plotters places text on bitmaps.
pub(super) const TOP: f32 = 0.5;
pub(super) const CENTER: f32 = 0.097;
pub(super) const BOTTOM: f32 = -0.306;

const SYSTEM: SystemInfo<'static> =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// A page while it is drawn.
pub(super) struct Page {
    size: [i32; 2],
    pdf: Pdf,
    content: Content,
    /// The number of the last object.
    last: i32,
    /// Plain and bold.
    fonts: [Font; 2],
    pictures: Vec<(String, Ref)>,
    /// Opacities in use, in percent.
    opacities: BTreeSet<u8>,
}

impl Page {
    /// A page of a size in units, with pictures on it.
    pub(super) fn new(size: [i32; 2], pictures: &[Picture]) -> Result<Self, String> {
        let fonts = [Font::new(dejavu::sans::regular(), "F1")?, Font::new(dejavu::sans::bold(), "F2")?];
        let (pdf, mut content) = (Pdf::new(), Content::new());
        // plotters has y downwards.
        content.transform([SCALE, 0.0, 0.0, -SCALE, 0.0, (size[1] * PX) as f32 * SCALE]);
        let (pictures_of_page, opacities) = (Vec::new(), BTreeSet::new());
        let mut page = Self { size, pdf, content, last: 0, fonts, pictures: pictures_of_page, opacities };
        for picture in pictures {
            page.picture(picture)?;
        }
        Ok(page)
    }

    fn next(&mut self) -> Ref {
        self.last += 1;
        Ref::new(self.last)
    }

    fn picture(&mut self, (image, corner): &Picture) -> Result<(), String> {
        let (id, mask) = (self.next(), self.next());
        let size = [image.width(), image.height()].map(|side| side as i32);
        let colors: Vec<u8> = image.pixels().iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
        let alpha: Vec<u8> = image.pixels().iter().map(|p| p[3]).collect();
        for (id, bytes, mask) in [(id, colors, Some(mask)), (mask, alpha, None)] {
            let bytes = compressed(&bytes)?;
            let mut object = self.pdf.image_xobject(id, &bytes);
            object.width(size[0]).height(size[1]).bits_per_component(8).filter(Filter::FlateDecode);
            match mask {
                Some(mask) => {
                    object.color_space().device_rgb();
                    object.s_mask(mask);
                }
                None => object.color_space().device_gray(),
            }
        }
        let name = format!("I{}", self.pictures.len());
        let [wide, high] = size.map(|side| (side * PX / PICTURE_PX) as f32);
        let [left, top] = corner.map(|at| (at * PX) as f32);
        self.content.save_state().transform([wide, 0.0, 0.0, -high, left, top + high]);
        self.content.x_object(Name(name.as_bytes())).restore_state();
        self.pictures.push((name, id));
        Ok(())
    }

    /// Strokes a line of this width, or fills a polygon.
    fn shape(
        &mut self,
        points: impl IntoIterator<Item = BackendCoord>,
        color: BackendColor,
        width: Option<u32>,
    ) {
        let percent = (color.alpha * 100.0).round() as u8;
        if percent == 0 {
            return;
        }
        self.opacities.insert(percent);
        self.content.save_state().set_parameters(Name(format!("O{percent}").as_bytes()));
        let [r, g, b] = channels(color);
        for (i, (x, y)) in points.into_iter().enumerate() {
            let (x, y) = (x as f32, y as f32);
            if i == 0 {
                self.content.move_to(x, y)
            } else {
                self.content.line_to(x, y)
            };
        }
        match width {
            Some(width) => self.content.set_stroke_rgb(r, g, b).set_line_width(width as f32).stroke(),
            None => self.content.set_fill_rgb(r, g, b).close_path().fill_nonzero(),
        };
        self.content.restore_state();
    }

    fn text(&mut self, text: &str, style: &impl BackendTextStyle, (x, y): BackendCoord) {
        let font = &mut self.fonts[usize::from(matches!(style.style(), FontStyle::Bold))];
        let (line, anchor) = (style.size() as f32, style.anchor());
        let size = line / LINE as f32;
        let (bytes, width) = font.encoded(text);
        let before = match anchor.h_pos {
            HPos::Left => 0.0,
            HPos::Center => width * size / 2.0,
            HPos::Right => width * size,
        };
        let drop = line
            * match anchor.v_pos {
                VPos::Top => TOP,
                VPos::Center => CENTER,
                VPos::Bottom => BOTTOM,
            };
        let (x, y) = (x as f32, y as f32);
        // Letters have y upwards.
        let place = match style.transform() {
            FontTransform::Rotate270 => [0.0, -1.0, -1.0, 0.0, x + drop, y + before],
            FontTransform::Rotate90 => [0.0, 1.0, 1.0, 0.0, x - drop, y - before],
            _ => [1.0, 0.0, 0.0, -1.0, x - before, y + drop],
        };
        let [r, g, b] = channels(style.color());
        self.content.set_fill_rgb(r, g, b).begin_text();
        self.content.set_font(Name(font.name.as_bytes()), size).set_text_matrix(place);
        self.content.show(Str(&bytes)).end_text();
    }

    /// The bytes of the file.
    pub(super) fn finish(mut self) -> Result<Vec<u8>, String> {
        let [catalog, pages, page, content] = [(); 4].map(|()| self.next());
        let font_ids = [(); 2].map(|()| [(); 5].map(|()| self.next()));
        let opacities: Vec<(u8, Ref)> =
            std::mem::take(&mut self.opacities).into_iter().map(|percent| (percent, self.next())).collect();
        let Self { mut pdf, content: drawn, fonts, pictures, size, .. } = self;
        let [width, height] = size.map(|side| (side * PX) as f32 * SCALE);
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([page]).count(1);
        let mut sheet = pdf.page(page);
        sheet.media_box(Rect::new(0.0, 0.0, width, height)).parent(pages).contents(content);
        let mut resources = sheet.resources();
        let names = fonts.iter().zip(&font_ids).map(|(font, [id, ..])| (Name(font.name.as_bytes()), *id));
        resources.fonts().pairs(names);
        resources.x_objects().pairs(pictures.iter().map(|(name, id)| (Name(name.as_bytes()), *id)));
        let mut states = resources.ext_g_states();
        for (percent, id) in &opacities {
            states.pair(Name(format!("O{percent}").as_bytes()), *id);
        }
        states.finish();
        resources.finish();
        sheet.finish();
        for (percent, id) in &opacities {
            let share = f32::from(*percent) / 100.0;
            pdf.ext_graphics(*id).non_stroking_alpha(share).stroking_alpha(share);
        }
        pdf.stream(content, &compressed(&drawn.finish())?).filter(Filter::FlateDecode);
        for (font, ids) in fonts.iter().zip(font_ids) {
            font.write(&mut pdf, ids)?;
        }
        Ok(pdf.finish())
    }
}

/// Draws on a page.
pub(super) struct PdfBackend<'a>(pub(super) &'a mut Page);

type Done = Result<(), DrawingErrorKind<Infallible>>;

impl DrawingBackend for PdfBackend<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        let [width, height] = self.0.size.map(|side| (side * PX) as u32);
        (width, height)
    }

    fn ensure_prepared(&mut self) -> Done {
        Ok(())
    }

    fn present(&mut self) -> Done {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Done {
        self.fill_polygon([(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)], &color)
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Done {
        self.draw_path([from, to], style)
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Done {
        self.0.shape(path, style.color(), Some(style.stroke_width()));
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Done {
        self.0.shape(corners, style.color(), None);
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, place: BackendCoord) -> Done {
        self.0.text(text, style, place);
        Ok(())
    }
}
/// A font, and the glyphs of it that are used.
struct Font {
    data: &'static [u8],
    face: Face<'static>,
    /// In the resources of the page.
    name: &'static str,
    glyphs: GlyphRemapper,
    /// The character of each glyph of the subset.
    characters: BTreeMap<u16, char>,
}

impl Font {
    fn new(data: &'static [u8], name: &'static str) -> Result<Self, String> {
        let face = Face::parse(data, 0).map_err(|e| e.to_string())?;
        Ok(Self { data, face, name, glyphs: GlyphRemapper::new(), characters: BTreeMap::new() })
    }

    /// A text as glyphs of the subset, two bytes each, and its width in ems.
    fn encoded(&mut self, text: &str) -> (Vec<u8>, f32) {
        let (mut bytes, mut width) = (Vec::new(), 0.0);
        for c in text.chars() {
            let glyph = self.face.glyph_index(c).unwrap_or_default();
            width += self.advance(glyph);
            let own = self.glyphs.remap(glyph.0);
            self.characters.insert(own, c);
            bytes.extend(own.to_be_bytes());
        }
        (bytes, width)
    }

    fn advance(&self, glyph: GlyphId) -> f32 {
        f32::from(self.face.glyph_hor_advance(glyph).unwrap_or(0)) / f32::from(self.face.units_per_em())
    }

    fn write(&self, pdf: &mut Pdf, [id, cid, descriptor, data, to_unicode]: [Ref; 5]) -> Result<(), String> {
        let name = if self.face.is_bold() { "CANONF+DejaVuSans-Bold" } else { "CANONF+DejaVuSans" };
        let name = Name(name.as_bytes());
        pdf.type0_font(id)
            .base_font(name)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid)
            .to_unicode(to_unicode);
        let mut font = pdf.cid_font(cid);
        font.subtype(CidFontType::Type2).base_font(name).system_info(SYSTEM).font_descriptor(descriptor);
        font.default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
        let widths = self.glyphs.remapped_gids().map(|glyph| 1000.0 * self.advance(GlyphId(glyph)));
        font.widths().consecutive(0, widths);
        font.finish();
        let em = 1000.0 / f32::from(self.face.units_per_em());
        let bounds = self.face.global_bounding_box();
        let [left, low, right, high] =
            [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(|side| f32::from(side) * em);
        pdf.font_descriptor(descriptor)
            .name(name)
            .flags(FontFlags::SYMBOLIC)
            .bbox(Rect::new(left, low, right, high))
            .italic_angle(0.0)
            .ascent(f32::from(self.face.ascender()) * em)
            .descent(f32::from(self.face.descender()) * em)
            .cap_height(f32::from(self.face.capital_height().unwrap_or_default()) * em)
            .stem_v(80.0)
            .font_file2(data);
        let subset = subset(self.data, 0, &self.glyphs).map_err(|e| e.to_string())?;
        let length = subset.len() as i32;
        let subset = compressed(&subset)?;
        let mut stream = pdf.stream(data, &subset);
        stream.filter(Filter::FlateDecode).pair(Name(b"Length1"), length);
        stream.finish();
        let mut unicode = UnicodeCmap::new(Name(b"Unicode"), SYSTEM);
        self.characters.iter().for_each(|(glyph, c)| unicode.pair(*glyph, *c));
        pdf.cmap(to_unicode, &unicode.finish());
        Ok(())
    }
}

fn channels(color: BackendColor) -> [f32; 3] {
    let (r, g, b) = color.rgb;
    [r, g, b].map(|channel| f32::from(channel) / 255.0)
}

fn compressed(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).map_err(|e| e.to_string())
}
