//! Laws of images.

use canonform_report::RgbaImage;

#[test]
fn a_png_reads_back_unchanged() {
    let mut image = RgbaImage::new(3, 2, [10, 20, 30, 255]);
    image.pixels_mut()[4] = [1, 2, 3, 4];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    image.write_png(&path).unwrap();
    assert_eq!(RgbaImage::from_png(&std::fs::read(&path).unwrap()).unwrap(), image);
    let mut gray = Vec::new();
    let mut encoder = png::Encoder::new(&mut gray, 2, 1);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[7, 200]).unwrap();
    assert_eq!(RgbaImage::from_png(&gray).unwrap().pixels(), [[7, 7, 7, 255], [200, 200, 200, 255]]);
    assert!(RgbaImage::from_png(b"not a picture").is_err());
}

#[test]
fn images_of_different_height_stand_side_by_side() {
    let (mut a, b) = (RgbaImage::new(1, 2, [1; 4]), RgbaImage::new(2, 1, [2; 4]));
    a.pixels_mut()[1] = [3; 4];
    let both = a.beside(&b);
    assert_eq!((both.width(), both.height()), (3, 2));
    assert_eq!(both.pixels(), [[1; 4], [2; 4], [2; 4], [3; 4], [2; 4], [2; 4]]);
}
