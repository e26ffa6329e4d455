use mesh::TriMesh;
use nalgebra::{Point3, Rotation3, Vector3};

use super::*;
use crate::image::RgbaImage;
use crate::tests::meshes::{mesh, sphere};

const FRONT: View = View::Upright { azimuth: 0.0, elevation: 0.0, up: Vector3::new(0.0, 0.0, 1.0) };

fn small(view: View) -> RenderOptions {
    RenderOptions {
        width: 120,
        height: 120,
        view,
        background: Background::Transparent,
        ..RenderOptions::default()
    }
}

fn drawn(mesh: &TriMesh, options: &RenderOptions) -> RgbaImage {
    render(mesh, options, &()).unwrap()
}

fn covered(image: &RgbaImage) -> f64 {
    image.pixels().iter().map(|p| f64::from(p[3]) / 255.0).sum()
}

fn light(pixel: [u8; 4]) -> f64 {
    f64::from(pixel[0]) + f64::from(pixel[1]) + f64::from(pixel[2])
}

/// Mean absolute difference of the channels of two images.
fn difference(a: &RgbaImage, b: &RgbaImage) -> f64 {
    let (a, b) = (a.pixels().as_flattened(), b.pixels().as_flattened());
    a.iter().zip(b).map(|(x, y)| f64::from(x.abs_diff(*y))).sum::<f64>() / a.len() as f64
}

/// A closed body with three different principal axes and no symmetry along them.
fn pear() -> TriMesh {
    let mut pear = sphere(24);
    for p in &mut pear.positions {
        let bulge = 1.0 + 0.5 * (1.2 * p.z).sin();
        *p = Point3::new(bulge * (p.x + 0.25 * p.x * p.x), 0.6 * bulge * p.y, 1.9 * p.z);
    }
    pear
}

#[test]
fn a_sphere_is_a_disc_that_fills_the_image_up_to_the_margin() {
    let image = drawn(&sphere(60), &small(FRONT));
    let radius = (covered(&image) / std::f64::consts::PI).sqrt();
    assert!((radius - 55.2).abs() < 0.3, "radius {radius}");
    for y in 0..120 {
        for x in 0..120 {
            let distance = (f64::from(x) - 59.5).hypot(f64::from(y) - 59.5);
            let alpha = image.pixel(x, y)[3];
            assert!(distance > 54.2 || alpha == 255, "hole at {x}, {y}");
            assert!(distance < 56.7 || alpha == 0, "speck at {x}, {y}");
        }
    }
}

#[test]
fn a_sphere_looks_the_same_from_all_sides_and_is_lit_from_the_upper_left() {
    let ball = sphere(40);
    let front = drawn(&ball, &small(FRONT));
    let other = drawn(&ball, &small(View::Upright { azimuth: 77.0, elevation: 50.0, up: Vector3::y() }));
    assert!(difference(&front, &other) < 0.5, "{}", difference(&front, &other));
    let [upper_left, lower_right] = [front.pixel(45, 40), front.pixel(75, 80)].map(light);
    assert!(upper_left > 1.3 * lower_right, "{upper_left} {lower_right}");
    // Neighboring points have almost the same shade.
    assert!((light(front.pixel(59, 20)) - light(front.pixel(60, 20))).abs() < 12.0);
}

#[test]
fn principal_axes_undo_a_motion() {
    let still = pear();
    let motion = Rotation3::from_euler_angles(0.4, 1.1, -2.0);
    let mut moved = still.clone();
    moved.positions.iter_mut().for_each(|p| *p = motion * (*p * 3.5) + Vector3::new(5.0, -7.0, 11.0));
    let expected = drawn(&still, &small(View::Principal));
    assert!(difference(&expected, &drawn(&moved, &small(View::Principal))) < 0.05);
    // A mirror image is seen from its other side: other shading, same outline.
    let mut mirrored = still.clone();
    mirrored.positions.iter_mut().for_each(|p| p.y = -p.y);
    let mirrored = drawn(&mirrored, &small(View::Principal));
    assert!((covered(&expected) - covered(&mirrored)).abs() < 1.0);
}

#[test]
fn meshes_without_drawable_faces_give_empty_images() {
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
    let mut far = triangle;
    far[1][0] = 1e308;
    far[2][2] = -1e308;
    let cases = [
        TriMesh::default(),
        mesh(&triangle, &[]),
        mesh(&triangle, &[[0, 0, 1]]),
        mesh(&triangle, &[[0, 1, 9]]),
        mesh(&[[0.0; 3]; 3], &[[0, 1, 2]]),
        mesh(&[[f64::NAN; 3], [0.0; 3], [1.0; 3]], &[[0, 1, 2]]),
        mesh(&[[0.0; 3], [1.0; 3], [2.0; 3]], &[[0, 1, 2]]),
    ];
    let mut sizes = vec![small(FRONT), small(View::Principal)];
    sizes.push(RenderOptions { width: 0, height: 0, supersampling: 0, ..small(FRONT) });
    for options in &sizes {
        for case in &cases {
            assert_eq!(covered(&drawn(case, options)), 0.0, "{case:?}");
        }
        let _ = drawn(&mesh(&far, &[[0, 1, 2]]), options);
        assert!(covered(&drawn(&mesh(&triangle, &[[0, 1, 2]]), options)) > 0.0);
    }
    let missing = Coloring::Scalars { values: vec![f64::NAN], range: Some([3.0, 3.0]), isolines: 4 };
    let options = RenderOptions { coloring: missing, ..small(FRONT) };
    assert!(covered(&drawn(&mesh(&triangle, &[[0, 1, 2]]), &options)) > 0.0);
}

#[test]
fn scalars_follow_the_color_map_with_isolines_at_equal_steps() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0]];
    let flat = mesh(&square, &[[0, 1, 2], [0, 2, 3]]);
    let surface = |isolines| Coloring::Scalars { values: vec![0.0, 1.0, 1.0, 0.0], range: None, isolines };
    let image = |isolines| drawn(&flat, &RenderOptions { coloring: surface(isolines), ..small(FRONT) });
    let [low, high] = [image(0).pixel(8, 60), image(0).pixel(111, 60)];
    assert!(low[2] > low[1] && high[1] > high[2], "from violet to yellow: {low:?} {high:?}");
    let (plain, lined) = (image(0), image(4));
    let darker = |x: u32| light(lined.pixel(x, 60)) < 0.93 * light(plain.pixel(x, 60));
    let lines = (8..112).filter(|&x| darker(x) && !darker(x - 1)).count();
    assert_eq!(lines, 3, "at a quarter, a half and three quarters");
}

#[test]
fn backgrounds_are_opaque_and_images_are_deterministic() {
    for (background, color) in
        [(Background::Color([20, 30, 40]), [20, 30, 40, 255]), (Background::WHITE, [255; 4])]
    {
        let options = RenderOptions { background, ..small(View::default()) };
        let image = drawn(&pear(), &options);
        assert_eq!(image.pixel(0, 0), color);
        assert!(image.pixels().iter().all(|p| p[3] == 255) && light(image.pixel(60, 60)) > 300.0);
        assert_eq!(image, drawn(&pear(), &options));
    }
}

#[test]
fn edges_sharper_than_the_crease_angle_are_not_smoothed() {
    // A roof seen from above: two slopes that meet at a right angle.
    let roof = [
        [-1.0, -1.0, 0.0],
        [-1.0, 1.0, 0.0],
        [0.0, 1.0, 1.0],
        [0.0, -1.0, 1.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
    ];
    let faces = [[0, 1, 2], [0, 2, 3], [3, 2, 5], [3, 5, 4]];
    let above = View::Upright { azimuth: 0.0, elevation: 90.0, up: Vector3::z() };
    let jump = |crease| {
        let image = drawn(&mesh(&roof, &faces), &RenderOptions { crease, ..small(above) });
        (light(image.pixel(57, 60)) - light(image.pixel(62, 60))).abs()
    };
    assert!(jump(30.0) > 4.0 * jump(90.0), "{} {}", jump(30.0), jump(90.0));
}
