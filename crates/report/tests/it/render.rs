//! Laws of pictures of meshes.

use base::{Budget, Exceeded};
use canonform_report::RgbaImage;
use canonform_report::render::{Background, Coloring, RenderOptions, View, dots, render};
use mesh::TriMesh;
use nalgebra::{Matrix3, Point3, Rotation3, Vector3};
use testkit::mesh;

use crate::{pixel, sphere};

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
            let alpha = pixel(&image, x, y)[3];
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
    let [upper_left, lower_right] = [pixel(&front, 45, 40), pixel(&front, 75, 80)].map(light);
    assert!(upper_left > 1.3 * lower_right, "{upper_left} {lower_right}");
    // Neighboring points have almost the same shade.
    assert!((light(pixel(&front, 59, 20)) - light(pixel(&front, 60, 20))).abs() < 12.0);
}

#[test]
fn principal_axes_undo_a_motion() {
    let still = pear();
    let motion = Rotation3::from_euler_angles(0.4, 1.1, -2.0);
    let moved = testkit::moved(&still, |p| motion * (*p * 3.5) + Vector3::new(5.0, -7.0, 11.0));
    let expected = drawn(&still, &small(View::Principal));
    assert!(difference(&expected, &drawn(&moved, &small(View::Principal))) < 0.05);
    // A mirror image is seen from its other side: other shading, same outline.
    let mirrored = testkit::moved(&still, |p| Point3::new(p.x, -p.y, p.z));
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
    let [low, high] = [pixel(&image(0), 8, 60), pixel(&image(0), 111, 60)];
    assert!(low[2] > low[1] && high[1] > high[2], "from violet to yellow: {low:?} {high:?}");
    let (plain, lined) = (image(0), image(4));
    let darker = |x: u32| light(pixel(&lined, x, 60)) < 0.93 * light(pixel(&plain, x, 60));
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
        assert_eq!(pixel(&image, 0, 0), color);
        assert!(image.pixels().iter().all(|p| p[3] == 255) && light(pixel(&image, 60, 60)) > 300.0);
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
        (light(pixel(&image, 57, 60)) - light(pixel(&image, 62, 60))).abs()
    };
    assert!(jump(30.0) > 4.0 * jump(90.0), "{} {}", jump(30.0), jump(90.0));
}

#[test]
fn upright_views_follow_azimuth_and_elevation() {
    let upright = |azimuth, elevation, up| {
        let view = View::Upright { azimuth, elevation, up }.fixed(&TriMesh::default(), false);
        let View::Fixed(axes) = view else { panic!("{view:?}") };
        axes
    };
    let front = upright(0.0, 0.0, Vector3::z());
    let rows = [Vector3::x(), Vector3::z(), -Vector3::y()].map(|row| row.transpose());
    assert!((front - Matrix3::from_rows(&rows)).norm() < 1e-15, "the viewer stands at -y");
    // A quarter turn counter-clockwise from -y leads to +x.
    let side = upright(90.0, 0.0, Vector3::z());
    assert!((side * Vector3::x() - Vector3::z()).norm() < 1e-12);
    // From straight above, z points at the viewer.
    let above = upright(0.0, 90.0, Vector3::z() * 7.0);
    assert!((above * Vector3::z() - Vector3::z()).norm() < 1e-12);
    for up in [Vector3::x(), Vector3::y(), Vector3::zeros(), Vector3::repeat(f64::NAN)] {
        let axes = upright(33.0, 21.0, up);
        assert!((axes * axes.transpose() - Matrix3::identity()).norm() < 1e-12);
        assert!((axes.determinant() - 1.0).abs() < 1e-12, "never mirrored");
    }
}

#[test]
fn dots_are_outward_oriented_octahedra_around_their_points() {
    let points = [Point3::new(1.0, 2.0, 3.0), Point3::origin()];
    let mesh = dots(&points, 0.5);
    assert_eq!((mesh.n_vertices(), mesh.n_faces()), (12, 16));
    for face in 0..16 {
        let (corners, point) = (mesh.triangle(face), points[face / 8]);
        assert!(corners.iter().all(|p| ((p - point).norm() - 0.5).abs() < 1e-15));
        assert!(mesh.area_vector(face).dot(&(corners[0] - point)) > 0.0, "outward");
    }
}

/// Long needles in all directions, and a large face in front of some of them.
fn needles(n: usize) -> TriMesh {
    let mut points = Vec::new();
    let mut faces = Vec::new();
    for i in 0..n {
        let t = 0.7 * i as f64;
        let ([sin, cos], depth) = ([t.sin(), t.cos()], (1.3 * t).sin());
        let first = points.len();
        points.extend([[cos, depth, sin], [-cos, -depth, -sin], [1e-3 * sin, 0.5 * depth, -1e-3 * cos]]);
        faces.push([0, 1, 2].map(|corner| (first + corner) as u32));
    }
    let first = points.len() as u32;
    points.extend([[-0.9, -0.2, -0.8], [0.9, 0.1, -0.7], [0.0, 0.0, 0.9]]);
    faces.push([first, first + 1, first + 2]);
    mesh(&points, &faces)
}

#[test]
fn every_sample_shows_the_nearest_face_that_covers_it() {
    const SIDE: usize = 97;
    const HUES: [[u8; 3]; 6] =
        [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0], [0, 255, 255], [255, 0, 255]];
    for mesh in [needles(150), sphere(20)] {
        // Faces that share no vertex, so that each has a color of its own, under any light.
        let soup = testkit::soup(&mesh);
        let view = View::default().fixed(&soup, false);
        let View::Fixed(axes) = view else { panic!("{view:?}") };
        let coloring = Coloring::Colors((0..soup.n_vertices()).map(|v| HUES[v / 3 % 6]).collect());
        let image =
            drawn(&soup, &RenderOptions { width: 97, height: 97, supersampling: 1, coloring, ..small(view) });
        // The box around the turned mesh fills the image up to a margin of 4 %.
        let turned: Vec<_> = soup.positions.iter().map(|p| axes * p.coords).collect();
        let low = turned.iter().copied().reduce(|a, b| a.inf(&b)).unwrap();
        let high = turned.iter().copied().reduce(|a, b| a.sup(&b)).unwrap();
        let (scale, center) = (0.92 * SIDE as f64 / (high - low).xy().max(), (low + high) / 2.0);
        let mut n_compared = 0;
        for (i, found) in image.pixels().iter().enumerate() {
            let x = (i % SIDE) as f64 + 0.5 - 0.5 * SIDE as f64;
            let y = 0.5 * SIDE as f64 - (i / SIDE) as f64 - 0.5;
            let at = center.xy() + nalgebra::Vector2::new(x, y) / scale;
            // The depth of each face there, and whether rounding decides that it covers the sample.
            let hits: Vec<_> = turned
                .chunks(3)
                .enumerate()
                .filter_map(|(f, corners)| {
                    let cross = |a: usize, b: usize| (corners[a].xy() - at).perp(&(corners[b].xy() - at));
                    let shares = Vector3::new(cross(1, 2), cross(2, 0), cross(0, 1));
                    let shares = shares / shares.sum();
                    let depth = (0..3).map(|i| shares[i] * corners[i].z).sum::<f64>();
                    (shares.min() > -1e-6).then_some((depth, f, shares.min() < 1e-6))
                })
                .collect();
            let nearest = hits.iter().copied().reduce(|a, b| if b.0 > a.0 { b } else { a });
            let is_close =
                |hit: &&(f64, usize, bool)| nearest.is_some_and(|(depth, ..)| hit.0 > depth - 1e-5);
            if hits.iter().any(|hit| hit.2) || hits.iter().filter(is_close).count() > 1 {
                continue;
            }
            n_compared += 1;
            let expected = nearest.map(|(_, f, _)| HUES[f % 6].map(|channel| channel > 0));
            let brightest = found[0].max(found[1]).max(found[2]);
            let shown = (found[3] > 0).then(|| [0, 1, 2].map(|i| found[i] > brightest / 2));
            assert_eq!(shown, expected, "sample {i}: {found:?}");
        }
        assert!(n_compared > 8000, "{n_compared}");
    }
}

#[test]
fn a_cancelled_picture_is_an_error() {
    let budget = Budget::unlimited();
    budget.cancel();
    assert_eq!(render(&sphere(8), &Default::default(), &budget).unwrap_err(), Exceeded::Cancelled);
}
