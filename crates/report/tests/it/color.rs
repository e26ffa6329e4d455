//! Laws of colors.

use canonform_report::color::{
    ColorMap, Rgb, color_scale, from_linear, mix, perceptual, perceptual_stops, to_linear,
};
use strum::VariantArray;

#[test]
fn srgb_to_linear_and_back_is_the_identity_on_every_byte() {
    for c in 0..=255 {
        assert_eq!(from_linear(to_linear(c)), c);
    }
}

#[test]
fn the_color_map_is_linear_between_its_stops() {
    let [stops, middle] = [perceptual_stops(), [perceptual(1.5 / 7.0); 8]];
    assert_eq!(middle[0], mix(stops[1], stops[2], 0.5));
}

#[test]
fn a_scale_spans_the_finite_values() {
    let color = color_scale(&[3.0, f64::NAN, 1.0, f64::INFINITY, 2.0]);
    assert_eq!([1.0, 2.0, 3.0].map(color), [0.0, 0.5, 1.0].map(perceptual));
    let color = color_scale(&[f64::INFINITY, 1.0, 2.0]);
    assert_eq!([color(f64::NAN), color(f64::INFINITY)], [perceptual(f64::NAN); 2]);
    // Without a range it is dark.
    assert_eq!(color_scale(&[])(f64::NAN), perceptual(f64::NAN));
    assert_eq!(color_scale(&[5.0; 3])(5.0), perceptual(0.0));
    let wide = color_scale(&[f64::MIN, f64::MAX]);
    assert_eq!([f64::MIN, 0.0, f64::MAX].map(wide), [0.0, 0.5, 1.0].map(perceptual));
}

fn luminance(color: Rgb) -> f32 {
    let [r, g, b] = color.map(to_linear);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

#[test]
fn maps_have_their_ends_and_show_what_is_missing() {
    for &map in ColorMap::VARIANTS {
        assert_eq!([map.color(-1.0), map.color(f64::INFINITY)], [map.color(0.0), map.color(1.0)]);
        assert_eq!(map.color(f64::NAN), [160; 3]);
    }
    assert_eq!([0.0, 1.0].map(|t| ColorMap::Magma.color(t)), [[0, 0, 4], [252, 253, 191]]);
}

#[test]
fn sequential_maps_grow_lighter_and_the_diverging_one_is_lightest_in_the_middle() {
    let light = |map: ColorMap, i: u32| luminance(map.color(f64::from(i) / 20.0));
    for map in [ColorMap::Viridis, ColorMap::Magma, ColorMap::Inferno, ColorMap::Cividis, ColorMap::Gray] {
        assert!((0..20).all(|i| light(map, i) < light(map, i + 1)), "{map:?}");
    }
    let diverging = ColorMap::Coolwarm;
    assert!((0..10).all(|i| light(diverging, i) < light(diverging, i + 1)));
    assert!((10..20).all(|i| light(diverging, i) > light(diverging, i + 1)));
}
