//! Laws of canonical forms.

use canonform_descriptors::{CanonicalForm, DescriptorError, Normalization};
use linalg::Matrix;
use mesh::TriMesh;
use nalgebra::{Point3, Vector3};
use nmds::Embedding;
use surface::VertexId;

fn embedding(coords: Matrix) -> Embedding {
    Embedding { coords, eigenvalues: vec![1.0; 3], negative_mass: 0.0, rank: 3 }
}

fn square() -> TriMesh {
    let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
    testkit::mesh(&corners, &[[0, 1, 2], [0, 2, 3]])
}

#[test]
fn the_form_is_centered_by_area_and_its_spread_scales() {
    let mesh = square();
    let coords = Matrix::from_fn(4, 3, |i, j| mesh.positions[i][j] + 7.0);
    let form = CanonicalForm::new(&embedding(coords.clone()), &mesh).unwrap();
    let centroid =
        form.points().iter().zip(form.weights()).fold(Vector3::zeros(), |s, (p, w)| s + p.coords * *w);
    assert!(centroid.norm() < 1e-15);
    assert!((form.weights().iter().sum::<f64>() - 1.0).abs() < 1e-15);
    assert!((form.spread() - 2f64.sqrt()).abs() < 1e-15);
    let mut large = mesh.clone();
    large.positions.iter_mut().for_each(|p| *p *= 5.0);
    let scaled = CanonicalForm::new(&embedding(coords * 5.0), &large).unwrap();
    let [a, b] = [&form, &scaled].map(|form| form.normalized(Normalization::UnitArea));
    assert!((a.spread() - 0.5f64.sqrt()).abs() < 1e-15);
    let bare = form.clone().without_unit();
    assert_eq!(bare.normalized(Normalization::UnitArea), bare);
    assert!(a.points().iter().zip(b.points()).all(|(p, q)| (p - q).norm() < 1e-14));
    assert_eq!(form.to_mesh(&mesh).faces, mesh.faces);
}

#[test]
fn some_points_keep_their_coordinates() {
    let points = [[3.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -2.0]].map(Point3::from).to_vec();
    let form = CanonicalForm::from_parts(points, vec![0.2, 0.3, 0.5], Some(4.0)).unwrap();
    let first_two = [0, 1].map(VertexId);
    let first = form.at(&first_two, vec![1.0, 3.0]).unwrap();
    assert_eq!((first.points(), first.weights()), (&form.points()[..2], &[0.25, 0.75][..]));
    assert_eq!(first.area(), form.area());
    assert_eq!(form.at(&first_two, vec![0.0; 2]).unwrap().weights(), [0.5; 2]);
    let fault = form.at(&[0, 1, 2, 3].map(VertexId), vec![1.0; 4]).unwrap_err();
    assert_eq!(fault, DescriptorError::SizeMismatch { n_points: 3, n_vertices: 4 });
}

#[test]
fn invalid_forms_are_refused() {
    let mesh = square();
    let new = |coords| CanonicalForm::new(&embedding(coords), &mesh);
    let no_extent = DescriptorError::NoExtent { n_points: 4 };
    for (coords, fault) in [
        (Matrix::zeros(4, 2), DescriptorError::NotThreeDimensional { dim: 2 }),
        (Matrix::zeros(5, 3), DescriptorError::SizeMismatch { n_points: 5, n_vertices: 4 }),
        (Matrix::zeros(4, 3), no_extent.clone()),
        (Matrix::from_element(4, 3, f64::NAN), no_extent),
    ] {
        assert_eq!(new(coords), Err(fault));
    }
}
