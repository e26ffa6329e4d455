//! Laws of labels and titles.

use canonform_report::RgbaImage;
use canonform_report::render::{Background, Label, RenderOptions, View, annotated, collage, render};
use mesh::{TriMesh, shapes};
use nalgebra::Vector3;

use crate::{pixel, sphere};

/// A mesh with these labels.
fn labelled(mesh: &TriMesh, options: &RenderOptions, labels: &[Label]) -> RgbaImage {
    annotated(mesh, options, None, labels, &()).unwrap()
}

#[test]
fn labels_neither_meet_nor_leave_the_image() {
    // Many points in one place, and others in the corners of a sheet.
    let sheet = shapes::grid(2, 2, 1.0);
    let above = View::Upright { azimuth: 0.0, elevation: 90.0, up: Vector3::z() };
    let options = RenderOptions { width: 400, height: 300, view: above, ..RenderOptions::default() };
    // Labels are darker than all of the sheet.
    let plain = labelled(&sheet, &options, &[]);
    let darkest = plain.pixels().iter().map(|pixel| pixel[0]).min().unwrap();
    let ink = |at: &[[f64; 2]]| {
        let labels: Vec<Label> = at.iter().map(|[x, y]| ([*x, *y, 0.0], "label".to_owned())).collect();
        let image = labelled(&sheet, &options, &labels);
        image.pixels().iter().map(|pixel| f64::from(darkest.saturating_sub(pixel[0]))).sum::<f64>()
    };
    let places = [
        [0.5, 0.5],
        [0.505, 0.5],
        [0.5, 0.51],
        [0.495, 0.495],
        [0.0, 0.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [1.0, 1.0],
    ];
    let one = ink(&places[..1]);
    assert!(one > 1000.0 && (ink(&places) / (8.0 * one) - 1.0).abs() < 0.05, "{one}, {}", ink(&places));
}

#[test]
fn a_label_is_written_beside_its_point_and_nowhere_else() {
    let options = RenderOptions { width: 300, height: 200, ..RenderOptions::default() };
    let plain = render(&sphere(12), &options, &()).unwrap();
    let label = |z: f64, text: &str| ([0.0, 0.0, z], text.to_owned());
    let image = labelled(&sphere(12), &options, &[label(1.0, "pole"), label(-1.0, "hidden")]);
    let changed: Vec<usize> = (0..300 * 200).filter(|i| image.pixels()[*i] != plain.pixels()[*i]).collect();
    assert!(!changed.is_empty() && changed.iter().all(|i| i % 300 > 140 && i / 300 < 60));
}

#[test]
fn pictures_are_placed_one_over_the_other_and_titles_fit() {
    let red = RgbaImage::new(2, 2, [255, 0, 0, 255]);
    let clear = RgbaImage::new(2, 2, [0, 0, 255, 0]);
    let placed = [(red, [1, 1]), (clear, [0, 0]), (RgbaImage::new(3, 1, [0, 255, 0, 255]), [-1, 29])];
    let title = |width| [("a long title".to_owned(), [20.0, 15.0], width)];
    let made = |width| collage([40, 30], Background::WHITE, &placed, (&title(width), 12.0)).unwrap();
    let image = made(18.0);
    assert_eq!(
        [pixel(&image, 0, 0), pixel(&image, 1, 1), pixel(&image, 2, 2)],
        [[255; 4], [255, 0, 0, 255], [255, 0, 0, 255]]
    );
    assert_eq!([pixel(&image, 1, 29), pixel(&image, 2, 29)], [[0, 255, 0, 255], [255; 4]]);
    let inked = |image: &RgbaImage| {
        (0..40)
            .filter(|x| (8..22).any(|y| pixel(image, *x, y)[0] < 200))
            .map(|x| x as f64)
            .collect::<Vec<_>>()
    };
    assert!(inked(&image).iter().all(|x| (x - 20.0).abs() <= 10.0) && !inked(&image).is_empty());
    assert!(inked(&made(100.0)).iter().any(|x| (x - 20.0).abs() > 12.0));
}
