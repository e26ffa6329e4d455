//! What maps are good for: known pairs, points inside faces, and what they carry.

use canonform::descriptors::Side;
use canonform::maps::{
    CorrespondOptions, KnownMap, LandmarkConflict, MapKind, MappedSurface, Mapping, SurfaceMap, correspond,
    score_map,
};
use canonform::{Error, Surface};
use datasets::Family;
use linalg::Matrix;
use mesh::{TriMesh, refine, shapes};
use nalgebra::{Point3, Vector3};
use surface::VertexId;

use crate::rested::{CATS, maps, maps_with, of_kind, prepared};
use crate::support::body;

/// The surfaces of both poses.
fn sides() -> [&'static MappedSurface; 2] {
    CATS.0.each_ref().map(|cat| &cat.mapped)
}

fn coordinates(mesh: &TriMesh) -> Matrix {
    Matrix::from_fn(mesh.n_vertices(), 3, |i, j| mesh.positions[i][j])
}

/// The mean distance of rows, as a share of the square root of an area.
fn gap(found: &Matrix, expected: &Matrix, mesh: &TriMesh) -> f64 {
    let gaps = (found - expected).row_iter().map(|row| row.norm()).sum::<f64>();
    gaps / found.nrows() as f64 / mesh.area().sqrt()
}

/// A vertex of each leg on the right side, far out: landmarks that tell left from right.
fn right_ends(rest: &[Point3<f64>]) -> [VertexId; 2] {
    [[5.0, 1.0, -1.0], [5.0, -1.0, -1.0]].map(|way| {
        let along = |v: &usize| rest[*v].coords.dot(&Vector3::from(way));
        (0..rest.len()).max_by(|v, w| along(v).total_cmp(&along(w))).unwrap().into()
    })
}

/// Why a map is refused.
fn fault(known: KnownMap, [a, b]: [&MappedSurface; 2]) -> Error {
    let options = CorrespondOptions { known, ..CorrespondOptions::default() };
    correspond(a, b, &options, &()).unwrap_err()
}

#[test]
fn a_surface_is_mapped_to_itself_by_the_identity_which_carries_everything_and_by_its_mirror() {
    let mesh = body(Family::Cat);
    let side = prepared(&mesh);
    let found = maps(&side, &side);
    let map = of_kind(&found, MapKind::Direct);
    assert_eq!(found[0], *map, "the identity distorts nothing");
    let n_fixed = |map: &SurfaceMap| {
        map.vertices.iter().enumerate().filter(|(x, y)| **y == Some(VertexId::from(*x))).count()
    };
    assert_eq!(n_fixed(map), mesh.n_vertices());
    // Distances by fast marching differ a little in the two directions.
    assert!(map.distortion < 0.005, "{}", map.distortion);
    let mirrored = of_kind(&found, MapKind::Mirrored);
    assert!(mirrored.distortion > 1e-3 && mirrored.distortion < 0.06, "{}", mirrored.distortion);
    assert!(2 * n_fixed(mirrored) < mesh.n_vertices(), "{}", n_fixed(mirrored));
    let own = coordinates(&mesh);
    let labels: Vec<usize> = (0..mesh.n_vertices()).collect();
    let of_faces: Vec<usize> = (0..mesh.n_faces()).collect();
    for of in [Side::First, Side::Second] {
        let between = Mapping::new(map, [&side, &side]);
        let points = between.vertices(of);
        assert!(gap(&points.values(&own), &own, &mesh) < 1e-6);
        assert_eq!(points.vertex_labels(&labels), labels.iter().copied().map(Some).collect::<Vec<_>>());
        assert_eq!(
            between.faces(of).face_labels(&of_faces),
            of_faces.iter().copied().map(Some).collect::<Vec<_>>()
        );
    }
    let k = map.functional.ncols();
    assert!((&map.functional - Matrix::identity(k, k)).norm() < 1e-6);
}

#[test]
fn there_and_back_is_near_the_identity() {
    let (cats, maps) = &*CATS;
    let (mesh, map) = (&cats[0].mesh, &maps[0]);
    let between = Mapping::new(map, sides());
    let own = coordinates(mesh);
    let there = between.vertices(Side::Second).values(&own);
    let points = between.vertices(Side::First);
    let error = gap(&points.values(&there), &own, mesh);
    assert!(error < 0.01, "{error}");
    // The nearest corner is the vertex that the map names, nearly always.
    let same = points.points.iter().zip(&map.vertices);
    let same = same.filter(|(p, v)| p.map(|p| p.nearest_corner()) == **v).count();
    assert!(same > 850, "{same} of 1000");
}

#[test]
fn points_inside_faces_are_nearer_than_vertices() {
    let coarse = body(Family::Cat);
    let size = coarse.area().sqrt();
    let fine = refine(&coarse, 0.03 * size, 20_000).mesh;
    let sides = [&fine, &coarse].map(prepared);
    let shapes = sides.each_ref();
    let map = &maps(shapes[0], shapes[1])[0];
    let places = coordinates(&coarse);
    let truth = coordinates(&fine);
    let inside = gap(&Mapping::new(map, shapes).vertices(Side::First).values(&places), &truth, &fine);
    let images: Vec<usize> = map.vertices.iter().map(|v| v.unwrap().index()).collect();
    let at_vertices = gap(&places.select_rows(&images), &truth, &fine);
    println!("inside faces {inside:.5}, at vertices {at_vertices:.5}");
    assert!(inside < 0.7 * at_vertices, "{inside}, at vertices {at_vertices}");
}

#[test]
fn what_breaks_the_symmetry_chooses_the_map() {
    let (cats, maps) = &*CATS;
    let kinds = |maps: &[SurfaceMap]| maps.iter().map(|map| map.kind).collect::<Vec<_>>();
    assert_eq!(kinds(maps), [MapKind::Direct, MapKind::Mirrored]);
    let ends = right_ends(cats[0].at_rest.points());
    let truth = cats[0].partners(&cats[1]);
    let [front, back] = ends.map(|v| [v, truth[v.index()]]);
    let by = |landmarks: &[[VertexId; 2]]| {
        maps_with(KnownMap { landmarks: landmarks.to_vec(), ..KnownMap::default() }, sides())
    };
    let found = by(&[back, front, back]);
    assert_eq!(kinds(&found), [MapKind::Direct]);
    let points = Mapping::new(&found[0], sides()).vertices(Side::First).points;
    for [x, y] in [front, back] {
        assert_eq!(found[0].vertices[x.index()], Some(y), "known pairs are kept");
        assert_eq!(points[x.index()].unwrap().nearest_corner(), y);
    }
    // The mirrored map, by partners on the other side.
    let mirrored = of_kind(maps, MapKind::Mirrored);
    let one = [ends[0], mirrored.vertices[ends[0].index()].unwrap()];
    assert_eq!(kinds(&by(&[one])), [MapKind::Mirrored]);
    // As a start, it comes first.
    let initial = mirrored.vertices.clone();
    let found = maps_with(KnownMap { initial, ..KnownMap::default() }, sides());
    assert_eq!(found[0].kind, MapKind::Mirrored);
}

#[test]
fn contradictory_landmarks_are_refused_and_name_the_pair() {
    let cats = &CATS.0;
    let truth = cats[0].partners(&cats[1]);
    let refused = |mut landmarks: [[VertexId; 2]; 2]| {
        landmarks.sort_unstable();
        match fault(KnownMap { landmarks: landmarks.to_vec(), ..KnownMap::default() }, sides()) {
            Error::ContradictoryLandmarks { pairs, how } if pairs == landmarks => how,
            other => panic!("{landmarks:?}: {other:?}"),
        }
    };
    let [front, back] = right_ends(cats[0].at_rest.points()).map(|v| [v, truth[v.index()]]);
    for shared in [[front[0], back[1]], [back[0], front[1]]] {
        assert_eq!(refused([front, shared]), LandmarkConflict::SharedVertex);
    }
    // Both ends of a leg go to one place.
    let near = cats[1].mesh.faces.iter().find(|face| face.contains(&front[1])).unwrap();
    let next = *near.iter().find(|v| **v != front[1]).unwrap();
    let how = refused([[back[0], next], front]);
    assert!(matches!(how, LandmarkConflict::Distance([a, b]) if a > 0.3 && b < 0.1), "{how:?}");
    // One right leg goes to the right, and the other to the left.
    let other = cats[0].partner(&cats[1], back[0].index(), -1.0).0;
    assert_eq!(refused([front, [back[0], other]]), LandmarkConflict::Orientation);
}

#[test]
fn maps_that_miss_a_landmark_are_uncertain() {
    let (cats, sides) = (&CATS.0, sides());
    let truth = cats[0].partners(&cats[1]);
    // A point of the plane of symmetry goes to one that is a third of the square root of the area away.
    let rest = cats[0].at_rest.points();
    let x = (0..rest.len()).min_by(|v, w| rest[*v].x.abs().total_cmp(&rest[*w].x.abs())).unwrap();
    let solver = geodesics::Method::default().prepare(sides[1].surface().intrinsic(), &()).unwrap();
    let from = solver.distances(truth[x]).unwrap();
    let away = |v: &usize| (from[*v] / cats[1].mesh.area().sqrt() - 0.33).abs();
    let y = (0..from.len()).min_by(|v, w| away(v).total_cmp(&away(w))).unwrap();
    let landmarks = vec![[x, y].map(VertexId::from)];
    let maps = maps_with(KnownMap { landmarks, ..KnownMap::default() }, sides);
    assert!(!maps.is_empty() && maps.iter().all(|map| !map.is_certain()), "{maps:?}");
}

#[test]
fn a_given_map_is_scored_as_it_is() {
    let (cats, sides) = (&CATS.0, sides());
    let score = |initial: &[Option<VertexId>]| {
        let known = KnownMap { initial: initial.to_vec(), ..KnownMap::default() };
        let options = CorrespondOptions { known, ..CorrespondOptions::default() };
        score_map(sides[0], sides[1], &options, &())
    };
    let scored = |initial: Vec<VertexId>| {
        let initial: Vec<_> = initial.into_iter().map(Some).collect();
        let [map] = <[SurfaceMap; 1]>::try_from(score(&initial).unwrap().maps).unwrap();
        assert_eq!(map.vertices, initial);
        map
    };
    let truth = scored(cats[0].partners(&cats[1]));
    assert_eq!(truth.kind, MapKind::Direct);
    assert!(truth.is_certain() && truth.distortion < 0.03, "{} {}", truth.confidence, truth.distortion);
    // The nose goes to the tail, by the rest of a cat that was turned by half.
    let turned = &cats[1].at_rest;
    let rest = cats[0].at_rest.points();
    let wrong = scored(rest.iter().map(|p| turned.nearest(&Point3::new(-p.x, -p.y, p.z)).0.into()).collect());
    assert!(!wrong.is_certain() && wrong.confidence < 0.1, "{}", wrong.confidence);
    assert!(wrong.distortion > 1.8 * truth.distortion, "{} {}", wrong.distortion, truth.distortion);
    assert!(wrong.alternative.is_some(), "the best one that is found");
    let few: Vec<_> = (0..rest.len()).map(|x| (x < 3).then_some(VertexId::from(x))).collect();
    assert!(score(&few).unwrap_err().to_string().contains("at least four"));
}

#[test]
fn what_does_not_fit_the_meshes_is_refused() {
    let sides = [shapes::grid(9, 7, 0.1), shapes::grid(8, 8, 0.1)].each_ref().map(prepared);
    let refused = |known| fault(known, sides.each_ref());
    let landmarks = vec![[VertexId(0), VertexId(64)]];
    assert!(matches!(refused(KnownMap { landmarks, ..KnownMap::default() }), Error::Point(_)));
    let initial = vec![Some(VertexId(0)); 5];
    assert!(refused(KnownMap { initial, ..KnownMap::default() }).to_string().contains("5 rows"));
    let initial = vec![None; 63];
    assert!(refused(KnownMap { initial, ..KnownMap::default() }).to_string().contains("no vertex a partner"));
    for (n, columns, value, what) in
        [(64, 2, 1.0, "1 and 2"), (60, 1, 1.0, "60 rows"), (64, 1, f64::NAN, "not finite at vertex 0")]
    {
        let functions = Some([Matrix::from_element(63, 1, 1.0), Matrix::from_element(n, columns, value)]);
        let fault = refused(KnownMap { functions, ..KnownMap::default() }).to_string();
        assert!(fault.contains(what), "{fault}");
    }
}

/// A tube of `n` columns and `m` rows, narrower at one end, whose first and last columns coincide; and how far around each of its
/// vertices lies, from 0 to 1.
fn tube(n: usize, m: usize) -> (TriMesh, Matrix) {
    let mut tube = shapes::grid(n + 1, m, 1.0);
    let around = Matrix::from_fn(tube.n_vertices(), 1, |v, _| tube.positions[v].x / n as f64);
    for p in &mut tube.positions {
        let angle = p.x / n as f64 * std::f64::consts::TAU;
        let height = p.y / (m - 1) as f64;
        let radius = 2.0 + 1.5 * height;
        *p = Point3::new(radius * angle.cos(), radius * angle.sin(), 15.0 * height);
    }
    (tube, around)
}

/// The values of vertices at the corners of faces.
fn at_corners(mesh: &TriMesh, values: &Matrix) -> Matrix {
    values.select_rows(&mesh.faces.iter().flatten().map(|v| v.index()).collect::<Vec<_>>())
}

#[test]
fn texture_coordinates_of_corners_are_not_torn_at_seams() {
    let [(a, around), (b, _)] = [tube(24, 16), tube(29, 19)];
    let corners = at_corners(&a, &around);
    let sides = [prepared(&a), prepared(&b)];
    let map = &maps(&sides[0], &sides[1])[0];
    let mapping = Mapping::new(map, sides.each_ref());
    let by_corner = mapping.corners(Side::Second, &corners).unwrap().corner_values(&corners);
    assert_eq!(by_corner.nrows(), 3 * b.n_faces());
    let extent = |values: [f64; 3]| {
        values.iter().copied().fold(0.0, f64::max) - values.iter().copied().fold(1.0, f64::min)
    };
    // Faces of both have 1/24 and 1/29 of the way around.
    let of_faces = |values: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
        (0..b.n_faces()).map(|f| extent([0, 1, 2].map(|slot| values(f, slot)))).collect()
    };
    let extents = of_faces(&|f, slot| by_corner[(3 * f + slot, 0)]);
    assert!(extents.iter().all(|extent| *extent < 0.1), "{extents:?}");
    let by_vertex = mapping.vertices(Side::Second).values(&around);
    let torn = of_faces(&|f, slot| by_vertex[(b.faces[f][slot].index(), 0)]);
    let n_torn = torn.iter().filter(|extent| **extent > 0.1).count();
    assert!(n_torn > 18, "a row of faces lies across the seam: {torn:?}");
}

#[test]
fn twins_of_a_seam_keep_their_own_values() {
    let (tube, texture) = tube(24, 16);
    let side = prepared(&tube);
    assert!(side.surface().mesh().n_vertices() < tube.n_vertices(), "the repair welds the seam");
    let k = side.shape.spectrum().values.len();
    let identity = Matrix::identity(k, k);
    let mapping: Mapping<'_, Surface> =
        Mapping { shapes: [&side, &side], functional: &identity, landmarks: &[], partners: None };
    // The centroid of each face has the mean of its own corners, also beside the seam.
    let found = mapping.faces(Side::First).values(&texture);
    for (f, face) in tube.faces.iter().enumerate() {
        let mean = face.iter().map(|v| texture[(v.index(), 0)]).sum::<f64>() / 3.0;
        assert!((found[(f, 0)] - mean).abs() < 1e-6, "face {f}: {} for {mean}", found[(f, 0)]);
    }
    // And each corner its own.
    let corners = at_corners(&tube, &texture);
    let found = mapping.corners(Side::First, &corners).unwrap().corner_values(&corners);
    assert!((found - corners).abs().max() < 1e-6);
}
