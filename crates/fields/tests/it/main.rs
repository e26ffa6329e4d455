//! Laws of fields: what holds for every surface and for every file.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

use canonform_fields::*;
use geodesics::{GeodesicError, Method};
use linalg::Matrix;
use mesh::{ComponentPolicy, RepairOptions, Surface, TriMesh, shapes};
use nmds::NmdsError;
use surface::VertexId;

fn surface(mesh: &TriMesh) -> Surface {
    Surface::new(mesh, &RepairOptions::default(), &()).unwrap()
}

fn exact(landmarks: usize) -> FieldOptions {
    FieldOptions { method: Method::Exact, landmarks, rank: None }
}

fn built(surface: &Surface, options: &FieldOptions) -> DistanceField {
    DistanceField::build(surface, options, &()).unwrap()
}

/// All pairs of vertices.
fn all_pairs(n: usize) -> Vec<[VertexId; 2]> {
    (0..n).flat_map(|a| (0..n).map(move |b| [VertexId::from(a), VertexId::from(b)])).collect()
}

/// Exact distances from every vertex, each in its column.
fn exact_columns(surface: &Surface) -> Matrix {
    let vertices: Vec<_> = (0..surface.intrinsic().n_vertices()).map(VertexId::from).collect();
    Method::Exact.prepare(surface.intrinsic(), &()).unwrap().distance_columns(&vertices).unwrap()
}

/// A torus with a crack, whose vertices are merged, beside a small component, which is dropped.
fn repaired() -> Surface {
    let pieces = shapes::disjoint(&[shapes::grid(2, 2, 0.01), shapes::torus(14, 8, 2.0, 0.6)]);
    surface(&testkit::cracked(&pieces, 10))
}

/// Surfaces of every kind: closed, open, with handles, with needles, with a fold, in two pieces that are joined.
fn zoo() -> Vec<Surface> {
    let meshes = [
        shapes::icosphere(2),
        shapes::torus(16, 9, 2.0, 0.7),
        shapes::jittered_grid(14, 11, 1.0, 0.3, 5),
        shapes::sheared_grid(12, 9, 1.0, 4.0),
        shapes::fold(&shapes::grid(12, 8, 1.0), 5.0, 1.5),
        shapes::cube(2),
        shapes::cylinder(24, 3, 1.0, 9.0),
        shapes::disjoint(&[shapes::icosphere(1), shapes::cube(1)]),
    ];
    let bridged = RepairOptions { components: ComponentPolicy::Bridge, ..Default::default() };
    meshes.map(|mesh| Surface::new(&mesh, &bridged, &()).unwrap()).into()
}

#[test]
fn certified_and_measured_intervals_hold_every_exact_distance() {
    let methods = [Method::Exact, Method::default(), Method::Dijkstra, Method::Heat(Default::default())];
    for surface in zoo() {
        let columns = exact_columns(&surface);
        for method in methods {
            let landmarks = if method == Method::Exact { 12 } else { 16 };
            let field = built(&surface, &FieldOptions { method, ..exact(landmarks) });
            // Where other columns contradict exact ones, the interval is as wide as their error.
            let (n_exact, error) = match field.bounds() {
                FieldBounds::Certified => (landmarks, 0.0),
                FieldBounds::Measured { exact_columns, over, under } => (exact_columns, over + under),
            };
            assert_eq!(n_exact, if method == Method::Exact { landmarks } else { 4 });
            let sources = &field.landmarks()[..n_exact];
            // Distances are stored in 16 bits.
            let known = error + 2.2 * columns.max() / 65535.0;
            for [a, b] in all_pairs(field.n_vertices()) {
                let (pair, distance) = (field.pair(a, b).unwrap(), columns[(b.index(), a.index())]);
                let holds = pair.lower <= distance && distance <= pair.upper;
                assert!(holds, "{}: {pair:?}: {distance}", field.facts().method);
                assert!(pair.lower <= pair.distance && pair.distance <= pair.upper, "{pair:?}");
                assert!(!sources.contains(&a) || pair.upper - pair.lower < known, "{pair:?}");
            }
        }
    }
}

#[test]
fn finished_pairs_are_exact_and_the_others_as_near_as_promised() {
    let methods = [Method::Exact, Method::default(), Method::Heat(Default::default())];
    for (surface, method) in zoo().iter().flat_map(|surface| methods.map(|method| (surface, method))) {
        let field = built(surface, &FieldOptions { method, ..exact(12) });
        let n = field.n_vertices();
        let columns = exact_columns(surface);
        let pairs = all_pairs(n);
        let share = 0.1;
        let found = field.pairs(&pairs, Finish::Beyond(share), &()).unwrap();
        for pair in &found {
            let distance = columns[(pair.a.index(), pair.b.index())];
            let error = (pair.distance - distance).abs();
            match pair.kind {
                PairKind::Exact => assert!(error <= 1e-9 * distance, "{pair:?}: {distance}"),
                _ => assert!(pair.upper - pair.lower <= share * pair.lower, "{pair:?}: {distance}"),
            }
            assert!(error <= share * distance, "{pair:?}: {distance}");
            assert!(pair.lower <= distance && distance <= pair.upper, "{pair:?}: {distance}");
            // The same in both directions, and zero from a vertex to itself.
            let back = found[pair.b.index() * n + pair.a.index()];
            assert_eq!(PairDistance { a: pair.a, b: pair.b, ..back }, *pair);
            assert!(pair.a != pair.b || pair.upper == 0.0);
        }
        let is_estimated = found.iter().any(|pair| pair.kind == PairKind::Estimated);
        assert!(is_estimated || method != Method::Exact);
        // Rows give the same answers, or exact ones.
        for source in [0, n / 2] {
            let row = field.row(VertexId::from(source), Finish::Beyond(share), &()).unwrap();
            for (answer, same) in row.iter().zip(&found[source * n..]) {
                assert_eq!((answer.a, answer.b), (same.a, same.b));
                match answer.kind {
                    PairKind::Exact => {
                        assert!(answer.distance >= same.lower && answer.distance <= same.upper)
                    }
                    _ => assert_eq!(answer, same),
                }
            }
        }
    }
}

#[test]
fn another_unit_changes_nothing_but_the_unit() {
    let mesh = shapes::jittered_grid(14, 11, 1.0, 0.3, 5);
    let pairs: Vec<_> = all_pairs(mesh.n_vertices()).into_iter().step_by(7).collect();
    let found = |scale: f64| {
        let surface = surface(&testkit::moved(&mesh, |p| p * scale));
        built(&surface, &exact(12)).pairs(&pairs, Finish::Never, &()).unwrap()
    };
    let plain = found(1.0);
    for scale in [2f64.powi(-40), 2f64.powi(60)] {
        for (a, b) in plain.iter().zip(found(scale)) {
            assert_eq!([a.lower, a.upper].map(|d| d * scale), [b.lower, b.upper]);
            assert!((a.distance * scale - b.distance).abs() <= 1e-6 * b.distance, "{a:?} {b:?}");
        }
    }
}

#[test]
fn the_nearest_vertices_are_those_of_the_exact_distances() {
    for method in [Method::default(), Method::Exact] {
        for surface in zoo() {
            let field = built(&surface, &FieldOptions { method, landmarks: 9, rank: None });
            let solver = Method::Exact.prepare(surface.intrinsic(), &()).unwrap();
            for source in [0, field.n_vertices() / 3].map(VertexId::from) {
                let distances = solver.distances(source).unwrap();
                let mut sorted = distances.clone();
                sorted.sort_by(f64::total_cmp);
                for k in [1, 7, field.n_vertices() + 5] {
                    let nearest = field.nearest(source, k, &()).unwrap();
                    assert_eq!(nearest.len(), k.min(field.n_vertices() - 1));
                    for (pair, expected) in nearest.iter().zip(&sorted[1..]) {
                        assert_eq!((pair.a, pair.kind), (source, PairKind::Exact));
                        assert!((distances[pair.b.index()] - pair.distance).abs() <= 1e-9 * expected);
                        assert!((pair.distance - expected).abs() <= 1e-9 * expected);
                    }
                }
            }
        }
    }
}

#[test]
fn answers_are_in_the_vertex_numbers_of_the_input() {
    let surface = repaired();
    let n_vertices = surface.n_input_vertices();
    let field = built(&surface, &exact(10));
    assert_eq!(field.n_vertices(), n_vertices);
    assert!(field.landmarks().iter().all(|v| v.index() >= 4), "the first component was dropped");
    let solver = Method::Exact.prepare(surface.intrinsic(), &()).unwrap();
    let source = surface.repaired_vertex(VertexId(30)).unwrap();
    let distances = surface.in_input_order(&solver.distances(source).unwrap(), f64::INFINITY);
    let row = field.row(VertexId(30), Finish::Never, &()).unwrap();
    for (pair, distance) in row.iter().zip(&distances) {
        assert!(pair.lower <= *distance && *distance <= pair.upper, "{pair:?}: {distance}");
        assert_eq!(pair.kind == PairKind::Dropped, distance.is_infinite());
    }
    let [a, b] = [VertexId(10), VertexId::from(n_vertices - 1)];
    assert_eq!(field.pair(a, b).unwrap().distance, 0.0);
    assert_eq!(field.nearest(a, 1, &()).unwrap()[0].b, b, "the merged vertex is nearest");
    assert!(field.nearest(VertexId(0), 3, &()).unwrap().is_empty(), "a dropped vertex has no neighbors");
    let beyond = VertexId::from(n_vertices);
    let fault = field.pairs(&[[a, beyond]], Finish::Never, &()).unwrap_err();
    assert!(
        matches!(fault, FieldError::Geodesic(f) if f == GeodesicError::NoSuchVertex { vertex: beyond, n_vertices })
    );
}

#[test]
fn a_field_that_was_saved_gives_the_same_answers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.field");
    let bridged = zoo().pop().unwrap();
    for (surface, method) in [(repaired(), Method::default()), (bridged, Method::Exact)] {
        let field = built(&surface, &FieldOptions { method, landmarks: 9, rank: Some(4) });
        field.save(&path).unwrap();
        let again = DistanceField::open(&path).unwrap();
        assert_eq!(again.facts(), field.facts());
        assert_eq!(again.facts().bytes as u64, std::fs::metadata(&path).unwrap().len());
        assert_eq!(again.landmarks(), field.landmarks());
        let pairs = all_pairs(field.n_vertices());
        for finish in [Finish::Never, Finish::default()] {
            // Infinity equals itself, so whole answers can be compared.
            assert_eq!(again.pairs(&pairs, finish, &()).unwrap(), field.pairs(&pairs, finish, &()).unwrap());
        }
        assert_eq!(
            again.nearest(VertexId(20), 9, &()).unwrap(),
            field.nearest(VertexId(20), 9, &()).unwrap()
        );
        assert_eq!(again.to_bytes(), field.to_bytes());
    }
}

#[test]
fn a_field_does_not_depend_on_the_number_of_threads() {
    let surface = surface(&shapes::torus(30, 14, 2.0, 0.7));
    for method in [Method::default(), Method::Exact] {
        let of = |threads| {
            testkit::on_threads(threads, || {
                let field = built(&surface, &FieldOptions { method, landmarks: 20, rank: None });
                let pairs: Vec<_> = all_pairs(field.n_vertices()).into_iter().step_by(7).collect();
                (field.to_bytes(), field.pairs(&pairs, Finish::default(), &()).unwrap())
            })
        };
        let one = of(1);
        assert_eq!(of(2), one);
        assert_eq!(of(5), one);
    }
}

#[test]
fn every_changed_byte_of_a_file_is_detected() {
    let field = built(&surface(&shapes::icosphere(0)), &exact(3));
    let bytes = field.to_bytes();
    assert!(DistanceField::from_bytes(&bytes).is_ok());
    for at in 0..bytes.len() {
        for change in [1, 0x80, 0xff] {
            let mut changed = bytes.clone();
            changed[at] ^= change;
            let fault = DistanceField::from_bytes(&changed).unwrap_err();
            match at {
                0..8 => assert_eq!(fault, FieldFault::NotAField),
                8..12 => assert!(matches!(fault, FieldFault::OtherVersion { known: 3, .. })),
                _ => assert_eq!(fault, FieldFault::Damaged("its checksum is wrong")),
            }
        }
        assert!(DistanceField::from_bytes(&bytes[..at]).is_err());
    }
    assert!(DistanceField::from_bytes(&[&bytes[..], &[0]].concat()).is_err());
}

#[test]
fn a_forged_file_is_refused_or_answers_without_a_panic() {
    let original = built(&repaired(), &FieldOptions { landmarks: 5, ..exact(5) });
    let bytes = original.to_bytes();
    let end = bytes.len() - 4;
    let mut refused = 0;
    for at in 12..end {
        for change in [1, 0x80, 0xff] {
            let mut changed = bytes.clone();
            changed[at] ^= change;
            let sum = crc32fast::hash(&changed[..end]);
            changed[end..].copy_from_slice(&sum.to_le_bytes());
            let Ok(field) = DistanceField::from_bytes(&changed) else {
                refused += 1;
                continue;
            };
            let _ = (field.facts(), field.landmarks());
            // Propagation on every forged surface would take too long.
            let finish = if at % 97 == 0 { Finish::default() } else { Finish::Never };
            let last = VertexId::from(field.n_vertices() - 1);
            let _ = field.pairs(&[[VertexId(5), VertexId(60)], [last, VertexId(9)]], finish, &());
            let _ = field.row(VertexId(7), finish, &());
        }
    }
    assert!(refused > 500, "only {refused} forged files were refused");
}

#[test]
fn impossible_options_are_refused() {
    let surface = surface(&shapes::icosphere(1));
    let fault = |options| DistanceField::build(&surface, &options, &()).unwrap_err();
    assert!(matches!(fault(exact(0)), FieldError::Geodesic(GeodesicError::NoSamples)));
    let rank = FieldOptions { rank: Some(9), ..exact(8) };
    assert!(matches!(fault(rank), FieldError::Nmds(NmdsError::BadRank { rank: 9, n_landmarks: 8 })));
    let all = built(&surface, &exact(1000));
    assert_eq!(all.facts().n_landmarks, 42, "as many landmarks as there are vertices");
}

#[test]
fn every_query_keeps_to_a_budget_of_its_own() {
    let surface = surface(&shapes::torus(40, 20, 2.0, 0.7));
    let field = built(&surface, &FieldOptions { landmarks: 4, ..Default::default() });
    let source = VertexId(3);
    // The first query prepares the exact solver, which the next ones share.
    let small = base::Budget::unlimited().with_memory(1 << 10);
    for _ in 0..2 {
        let over = field.row(source, Finish::Beyond(0.0), &small).unwrap_err();
        assert!(matches!(over, FieldError::Exceeded(base::Exceeded::Memory { .. })), "{over}");
        assert!(field.row(source, Finish::Beyond(0.0), &()).is_ok());
    }
    let late = base::Budget::unlimited();
    late.cancel();
    let over = field.nearest(source, 3, &late).unwrap_err();
    assert!(matches!(over, FieldError::Exceeded(base::Exceeded::Cancelled)), "{over}");
}
