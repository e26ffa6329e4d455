//! Laws of color bars.

use canonform_report::RgbaImage;
use canonform_report::color::ColorMap;
use canonform_report::render::{Background, Coloring, RenderOptions, annotated, render};

use crate::{pixel, sphere};

fn options(values: Vec<f64>) -> RenderOptions {
    let coloring = Coloring::Scalars { values, range: None, isolines: 4 };
    RenderOptions { width: 320, height: 240, coloring, ..RenderOptions::default() }
}

fn with_bar(options: &RenderOptions) -> RgbaImage {
    annotated(&sphere(12), options, Some("z"), &[], &()).unwrap()
}

fn heights() -> Vec<f64> {
    sphere(12).positions.iter().map(|p| p.z).collect()
}

#[test]
fn the_bar_shares_the_image_with_the_mesh() {
    let options = options(heights());
    let (plain, image) = (render(&sphere(12), &options, &()).unwrap(), with_bar(&options));
    assert_eq!((image.width(), image.height()), (320, 240));
    assert!(plain != image);
    let other = RenderOptions { colors: ColorMap::Magma, ..options.clone() };
    assert!(with_bar(&other) != image);
    // The bar is where a column begins with the last color and ends with the first one.
    let is_near = |x: u32, y: u32, color: [u8; 3]| {
        pixel(&image, x, y).iter().zip(color).all(|(a, b)| a.abs_diff(b) < 8)
    };
    let [first, last] = [0.0, 1.0].map(|share| ColorMap::Viridis.color(share));
    let ends = |x: u32| {
        let top = (0..240).find(|y| is_near(x, *y, last))?;
        Some((top, (top..240).rev().find(|y| is_near(x, *y, first))?))
    };
    let bars: Vec<_> = (240..320).filter_map(|x| Some((x, ends(x)?))).collect();
    assert!(bars.len() > 8 && bars.iter().all(|(_, ends)| ends.1 - ends.0 > 160), "{bars:?}");
    for (x, (top, bottom)) in bars {
        let is_hole = |y: &u32| pixel(&image, x, *y).iter().all(|c| *c > 150);
        assert_eq!((top..bottom).filter(is_hole).count(), 0, "the bar has no holes");
    }
    assert_eq!(image, with_bar(&options));
}

#[test]
fn surfaces_without_finite_numbers_and_small_images_have_no_bar() {
    let has_bar = |options: &RenderOptions| with_bar(options) != render(&sphere(12), options, &()).unwrap();
    assert!(has_bar(&options(heights())));
    assert!(!has_bar(&options(vec![f64::NAN])) && !has_bar(&options(vec![])));
    assert!(!has_bar(&options(vec![-1e308, 1e308])));
    assert!(!has_bar(&RenderOptions { width: 90, ..options(heights()) }));
    assert!(!has_bar(&RenderOptions { height: 60, ..options(heights()) }));
    assert!(!has_bar(&RenderOptions::default()));
}

#[test]
fn labels_contrast_with_every_background() {
    let on = |background| {
        let options = RenderOptions { background, ..options(heights()) };
        let image = with_bar(&options);
        let right = image.pixels().iter().enumerate().filter(|(i, _)| i % 320 > 270);
        right.map(|(_, pixel)| *pixel).collect::<Vec<_>>()
    };
    assert!(on(Background::WHITE).iter().any(|p| p[0] < 60));
    assert!(on(Background::Color([20, 20, 24])).iter().any(|p| p[0] > 200));
    let clear = on(Background::Transparent);
    assert!(clear.iter().any(|p| p[3] == 0) && clear.iter().any(|p| p[0].abs_diff(118) < 3 && p[3] > 200));
}
