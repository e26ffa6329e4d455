//! Raster images and their PNG encoding.

use std::io;
use std::path::Path;

use base::files::{FileError, write_bytes};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// An image of 8-bit sRGB pixels with straight (not premultiplied) alpha.
///
/// **Invariant.** `pixels.len() == width * height`, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RgbaImage {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 4]>,
}

impl RgbaImage {
    /// An image of one color.
    pub fn new(width: u32, height: u32, color: [u8; 4]) -> Self {
        Self { width, height, pixels: vec![color; width as usize * height as usize] }
    }

    /// An image of `color(column, row)` at each pixel.
    pub fn from_fn(width: u32, height: u32, color: impl Fn(usize, usize) -> [u8; 4]) -> Self {
        let color = &color;
        let row = |row| (0..width as usize).map(move |column| color(column, row));
        Self { width, height, pixels: (0..height as usize).flat_map(row).collect() }
    }

    /// The image of a PNG file.
    ///
    /// # Errors
    /// If these are not the bytes of one.
    pub fn from_png(bytes: &[u8]) -> Result<Self, png::DecodingError> {
        let mut decoder = png::Decoder::new(bytes);
        decoder
            .set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
        let mut reader = decoder.read_info()?;
        let mut found = vec![0; reader.output_buffer_size()];
        let info = reader.next_frame(&mut found)?;
        let is_gray = info.color_type == png::ColorType::GrayscaleAlpha;
        let pixels = match is_gray {
            true => found.as_chunks().0.iter().map(|[gray, alpha]| [*gray, *gray, *gray, *alpha]).collect(),
            false => found.as_chunks().0.to_vec(),
        };
        Ok(Self { width: info.width, height: info.height, pixels })
    }

    /// Two images side by side; a missing part at the bottom of the lower one has the color of its first pixel.
    pub fn beside(&self, right: &Self) -> Self {
        let pixel = |image: &Self, column: usize, row: usize| {
            let at = row * image.width as usize + column;
            let found = if row < image.height as usize { image.pixels.get(at) } else { image.pixels.first() };
            found.copied().unwrap_or_default()
        };
        let left = self.width as usize;
        Self::from_fn(self.width + right.width, self.height.max(right.height), |column, row| {
            match column.checked_sub(left) {
                None => pixel(self, column, row),
                Some(column) => pixel(right, column, row),
            }
        })
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All pixels as `[red, green, blue, alpha]`, row by row from the top left.
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }

    /// All pixels, to change them.
    pub fn pixels_mut(&mut self) -> &mut [[u8; 4]] {
        &mut self.pixels
    }

    /// Writes the image as a PNG file, completely or not at all.
    ///
    /// # Errors
    /// If the file cannot be written or the image has no pixels.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<(), FileError> {
        let path = path.as_ref();
        let encoded = self.to_png().map_err(|source| FileError::write(path, source))?;
        write_bytes(path, &encoded)
    }

    /// The image as the bytes of a PNG file.
    ///
    /// # Errors
    /// If the image has no pixels.
    pub fn to_png(&self) -> io::Result<Vec<u8>> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder.set_compression(png::Compression::Default);
        encoder.set_adaptive_filter(png::AdaptiveFilterType::Adaptive);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(self.pixels.as_flattened())?;
        writer.finish()?;
        Ok(file)
    }

    /// The image as the address of a PNG in a page.
    pub fn to_data_url(&self) -> io::Result<String> {
        Ok(format!("data:image/png;base64,{}", STANDARD.encode(self.to_png()?)))
    }
}
