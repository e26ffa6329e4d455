//! Distance fields of real meshes against exact distances.

use canonform::fields::{DistanceField, FieldBounds, FieldOptions, Finish, PairKind};
use geodesics::Method;
use mesh::RepairOptions;
use surface::VertexId;

/// How many intervals miss the exact distance, and the mean relative error after near pairs are finished.
fn score(field: &DistanceField, pairs: &[[VertexId; 2]], exact: &[f64]) -> (usize, f64) {
    let [plain, finished] = [Finish::Never, Finish::default()].map(|f| field.pairs(pairs, f, &()).unwrap());
    let misses = plain.iter().zip(exact).filter(|(pair, exact)| !(pair.lower..=pair.upper).contains(*exact));
    let errors = finished.iter().zip(exact).filter(|(_, exact)| **exact > 0.0);
    let total = errors.map(|(pair, exact)| (pair.distance / exact - 1.0).abs()).sum::<f64>();
    (misses.count(), total / pairs.len() as f64)
}

/// Exact distances of `data/exact`, from other software, to random targets: 10,000 pairs of a mesh.
#[test]
#[ignore = "slow: make test-all"]
fn intervals_hold_published_exact_distances_of_real_meshes() {
    let Some(data) = testkit::data("") else { return };
    let scans = ["spot", "rocker-arm", "armadillo"].map(|name| (name, format!("single/{name}.obj")));
    let poses = ["cat0", "cat1", "centaur1", "centaur2", "horse0", "wolf0", "wolf1"];
    let poses = poses.map(|name| (name, format!("tosca-lowres/{name}.vert")));
    for (name, path) in scans.into_iter().chain(poses) {
        let surface =
            canonform::read_surface(&data.join(path), &RepairOptions::default(), &Default::default(), &())
                .unwrap();
        let n = surface.n_input_vertices();
        let file = |what| data.join("exact").join(format!("{name}-{what}.npy"));
        let (_, sources) = testkit::array::<u32>(&file("sources"));
        let (_, rows) = testkit::array::<f64>(&file("distances"));
        let each = 10_000 / sources.len() + 1;
        let picks = (0..each * sources.len()).map(|i| (i % sources.len(), (7919 * i + 13) % n));
        let (pairs, exact): (Vec<_>, Vec<_>) =
            picks.map(|(row, v)| ([VertexId(sources[row]), VertexId::from(v)], rows[row * n + v])).unzip();
        for method in [Method::default(), Method::Exact] {
            let options = FieldOptions { method, ..FieldOptions::default() };
            let field = DistanceField::build(&surface, &options, &()).unwrap();
            assert_eq!(field.bounds() == FieldBounds::Certified, method == Method::Exact);
            let (missed, error) = score(&field, &pairs, &exact);
            assert!(missed == 0 && error < 0.005, "{name} by {}: {missed}, {error}", method.name());
            // Propagation agrees with the other software.
            let near = field.nearest(VertexId(sources[0]), 50, &()).unwrap();
            for pair in near {
                assert_eq!(pair.kind, PairKind::Exact);
                let expected = rows[pair.b.index()];
                assert!((pair.distance - expected).abs() <= 1e-6 * expected, "{name}: {pair:?} {expected}");
            }
        }
    }
}
