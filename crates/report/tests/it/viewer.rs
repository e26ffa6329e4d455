//! Laws of surfaces in the browser.

use canonform_report::viewer::{Geometry, scene_page, scene_scripts};
use mesh::TriMesh;
use nalgebra::Point3;
use surface::VertexId;

#[test]
fn a_scene_runs_its_own_scripts_only_and_names_cannot_leave_their_place() {
    let geometry =
        Geometry { positions: vec![[0.0, 0.5, 1.0]; 3], faces: vec![[0, 1, 2]], ..Geometry::default() };
    let page = scene_page(&geometry.with_values("</script>", &[1.0, 2.0, 3.0]), "<b>cat");
    assert!(page.contains("&lt;b&gt;cat") && !page.contains("<b>cat"));
    assert_eq!((page.matches("'sha256-").count(), page.matches("<script>").count()), (4, 1));
    assert_eq!(page.matches("</script>").count(), 5);
    assert!(!page.contains("http:") && !page.contains("https:") && !page.contains("unsafe-eval"));
    assert!((600_000..900_000).contains(&page.len()), "{} bytes", page.len());
    assert!(page.replace(scene_scripts(), "").len() < 5_000);
}

fn triangle() -> TriMesh {
    testkit::mesh(&[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 6.0, 4.0]], &[[0, 1, 2]])
}

#[test]
fn arrays_read_back_from_json_to_the_bit() {
    let one = Geometry::new(&triangle()).with_values("distance", &[0.0, f64::NAN, 1.0 / 3.0]);
    let json = serde_json::to_string(&one).unwrap();
    let back: Geometry = serde_json::from_str(&json).unwrap();
    assert_eq!((&back.positions, &back.faces), (&one.positions, &one.faces));
    let bits = |g: &Geometry| g.values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&back), bits(&one), "NaN included");
    assert_eq!(back.values_name.as_deref(), Some("distance"));
    let bare = serde_json::to_value(Geometry::new(&triangle())).unwrap();
    assert_eq!(bare.as_object().unwrap().len(), 2, "absent fields are left out: {bare}");
    // The first vertex, little-endian: -1 is 0xbf800000, -3 is 0xc0400000, -2 is 0xc0000000.
    assert!(bare["positions"].as_str().unwrap().starts_with("AACAvwAAQMAAAADA"), "{bare}");
    assert_eq!(bare["faces"], "AAAAAAEAAAACAAAA");
}

#[test]
fn surfaces_are_centered_unusable_faces_are_left_out_and_missing_values_are_nan() {
    assert_eq!(
        Geometry::new(&triangle()).positions,
        [[-1.0, -3.0, -2.0], [1.0, -3.0, -2.0], [-1.0, 3.0, 2.0]]
    );
    assert_eq!(Geometry::in_place(&triangle()).mesh(), triangle());
    assert_eq!(Geometry::new(&TriMesh::default()), Geometry::default());
    let mut mesh = triangle();
    mesh.positions.push(Point3::new(f64::NAN, 0.0, 0.0));
    mesh.faces.extend([[0, 1, 3], [0, 1, 9]].map(|f: [u32; 3]| f.map(VertexId)));
    let geometry = Geometry::new(&mesh).with_values("v", &[1.0]);
    assert_eq!(geometry.faces, [[0, 1, 2]]);
    let values = geometry.values;
    assert!(values.len() == 4 && values[0] == 1.0 && values[1..].iter().all(|v| v.is_nan()));
}

#[test]
fn strings_that_are_not_arrays_are_refused() {
    for (positions, what) in [("AAAA", "3 bytes are not a whole number of groups"), ("?", "not base64")] {
        let json = serde_json::json!({"positions": positions, "faces": ""});
        assert!(serde_json::from_value::<Geometry>(json).unwrap_err().to_string().contains(what));
    }
}
