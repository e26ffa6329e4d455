//! Drawings as PDF: one page of 7 inches width, with text that can be searched.

use std::collections::BTreeMap;
use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str};
use subsetter::{GlyphRemapper, subset};
use ttf_parser::{Face, GlyphId};

use super::drawing::{Anchor, Canvas, DROP, Element, PAGE_WIDTH, Point, TextStyle};
use crate::color::Rgb;
use crate::image::RgbaImage;

/// Points per unit.
const SCALE: f32 = (7.0 * 72.0 / PAGE_WIDTH) as f32;

const SYSTEM: SystemInfo<'static> =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// The bytes of a PDF file, or why there are none.
pub(super) fn pdf(canvas: &Canvas) -> Result<Vec<u8>, String> {
    let mut page = Page::new()?;
    let (width, height) = (canvas.size.0 as f32, canvas.size.1 as f32);
    // The drawing has y downwards.
    page.content.transform([SCALE, 0.0, 0.0, -SCALE, 0.0, height * SCALE]);
    for element in &canvas.elements {
        page.draw(element)?;
    }
    page.finish([width * SCALE, height * SCALE])
}

/// A page while it is drawn.
struct Page {
    pdf: Pdf,
    content: Content,
    /// The number of the last object.
    last: i32,
    /// Plain and bold.
    fonts: [Font; 2],
    images: Vec<(String, Ref)>,
    /// Names of the states with an opacity, in percent.
    opacities: BTreeMap<u8, Ref>,
}

impl Page {
    fn new() -> Result<Self, String> {
        let fonts = [Font::new(dejavu::sans::regular(), "F1")?, Font::new(dejavu::sans::bold(), "F2")?];
        let (pdf, content) = (Pdf::new(), Content::new());
        Ok(Self { pdf, content, last: 0, fonts, images: Vec::new(), opacities: BTreeMap::new() })
    }

    fn next(&mut self) -> Ref {
        self.last += 1;
        Ref::new(self.last)
    }

    fn draw(&mut self, element: &Element) -> Result<(), String> {
        match element {
            Element::Text { text, at, style } => self.text(text, *at, *style),
            Element::Image { image, corner } => return self.image(image, *corner),
            Element::Path { points, width, color } => {
                let [r, g, b] = rgb(*color);
                self.content.set_stroke_rgb(r, g, b).set_line_width(*width as f32);
                self.outline(points, (0.0, 0.0));
                self.content.stroke();
            }
            Element::Polygon { origin, points, color, opacity } => {
                let [r, g, b] = rgb(*color);
                self.content.save_state();
                if *opacity < 1.0 {
                    let percent = (opacity * 100.0).round() as u8;
                    let next = Ref::new(self.last + 1);
                    let state = *self.opacities.entry(percent).or_insert(next);
                    self.last = self.last.max(state.get());
                    self.content.set_parameters(Name(format!("O{percent}").as_bytes()));
                }
                self.content.set_fill_rgb(r, g, b);
                self.outline(points, *origin);
                self.content.close_path().fill_nonzero().restore_state();
            }
        }
        Ok(())
    }

    fn outline(&mut self, points: &[Point], (left, top): Point) {
        for (i, (x, y)) in points.iter().enumerate() {
            let (x, y) = ((x + left) as f32, (y + top) as f32);
            if i == 0 {
                self.content.move_to(x, y)
            } else {
                self.content.line_to(x, y)
            };
        }
    }

    fn text(&mut self, text: &str, (x, y): Point, style: TextStyle) {
        let font = &mut self.fonts[usize::from(style.bold)];
        let size = style.size as f32;
        let (bytes, width) = font.encoded(text);
        let before = match style.anchor {
            Anchor::Left => 0.0,
            Anchor::Center => width * size / 2.0,
            Anchor::Right => width * size,
        };
        let (x, y, drop) = (x as f32, y as f32, DROP as f32 * size);
        // Letters have y upwards.
        let place = match style.upwards {
            true => [0.0, -1.0, -1.0, 0.0, x + drop, y + before],
            false => [1.0, 0.0, 0.0, -1.0, x - before, y + drop],
        };
        let [r, g, b] = rgb(style.color);
        self.content.set_fill_rgb(r, g, b).begin_text();
        self.content.set_font(Name(font.name.as_bytes()), size).set_text_matrix(place);
        self.content.show(Str(&bytes)).end_text();
    }

    fn image(&mut self, image: &RgbaImage, (left, top): Point) -> Result<(), String> {
        let (id, mask) = (self.next(), self.next());
        let (width, height) = (image.width() as i32, image.height() as i32);
        let colors: Vec<u8> = image.pixels().iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
        let alpha: Vec<u8> = image.pixels().iter().map(|p| p[3]).collect();
        let colors = compressed(&colors)?;
        let mut object = self.pdf.image_xobject(id, &colors);
        object.width(width).height(height).bits_per_component(8).filter(Filter::FlateDecode);
        object.color_space().device_rgb();
        object.s_mask(mask);
        object.finish();
        let alpha = compressed(&alpha)?;
        let mut object = self.pdf.image_xobject(mask, &alpha);
        object.width(width).height(height).bits_per_component(8).filter(Filter::FlateDecode);
        object.color_space().device_gray();
        object.finish();
        let name = format!("I{}", self.images.len());
        let [wide, high] = super::drawing::in_units(image).map(|side| side as f32);
        self.content.save_state();
        self.content.transform([wide, 0.0, 0.0, -high, left as f32, top as f32 + high]);
        self.content.x_object(Name(name.as_bytes())).restore_state();
        self.images.push((name, id));
        Ok(())
    }

    fn finish(mut self, [width, height]: [f32; 2]) -> Result<Vec<u8>, String> {
        let [catalog, pages, page, content] = [(); 4].map(|()| self.next());
        let fonts = [(); 2].map(|()| [(); 5].map(|()| self.next()));
        let Self { mut pdf, content: drawn, fonts: faces, images, opacities, .. } = self;
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([page]).count(1);
        let mut sheet = pdf.page(page);
        sheet.media_box(Rect::new(0.0, 0.0, width, height)).parent(pages).contents(content);
        let mut resources = sheet.resources();
        let mut dict = resources.fonts();
        for (font, [id, ..]) in faces.iter().zip(&fonts) {
            dict.pair(Name(font.name.as_bytes()), *id);
        }
        dict.finish();
        let mut dict = resources.x_objects();
        for (name, id) in &images {
            dict.pair(Name(name.as_bytes()), *id);
        }
        dict.finish();
        let mut dict = resources.ext_g_states();
        for (percent, id) in &opacities {
            dict.pair(Name(format!("O{percent}").as_bytes()), *id);
        }
        dict.finish();
        resources.finish();
        sheet.finish();
        for (percent, id) in &opacities {
            pdf.ext_graphics(*id).non_stroking_alpha(f32::from(*percent) / 100.0);
        }
        pdf.stream(content, &compressed(&drawn.finish())?).filter(Filter::FlateDecode);
        for (font, ids) in faces.iter().zip(fonts) {
            font.write(&mut pdf, ids)?;
        }
        Ok(pdf.finish())
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

fn rgb(color: Rgb) -> [f32; 3] {
    color.map(|channel| f32::from(channel) / 255.0)
}

fn compressed(bytes: &[u8]) -> Result<Vec<u8>, String> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).and_then(|()| encoder.finish()).map_err(|e| e.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_text_images_and_the_width_of_a_printed_page() {
        let mut canvas = Canvas::new(1000, 400);
        canvas.text("stress σ₁⁴", (500.0, 50.0), TextStyle::TITLE);
        canvas.text("up", (50.0, 200.0), TextStyle::NAME.up());
        canvas.image(RgbaImage::new(20, 10, [200, 0, 0, 128]), (100.0, 100.0));
        canvas.line((0.0, 0.0), (100.0, 100.0), 2.0, [0, 0, 255]);
        canvas.polygon((200.0, 200.0), vec![(0.0, 0.0), (50.0, 0.0), (0.0, 50.0)], [0, 255, 0], 0.16);
        let bytes = pdf(&canvas).unwrap();
        assert_eq!(bytes, pdf(&canvas).unwrap(), "no date, no random identifier");
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.starts_with("%PDF-") && text.trim_end().ends_with("%%EOF"));
        for part in ["/MediaBox [0 0 504", "/FontFile2", "/SMask", "/ca 0.16", "<03C3>"] {
            assert!(text.contains(part), "{part}");
        }
        assert!(bytes.len() < 60_000, "the fonts are subsets: {}", bytes.len());
    }
}
