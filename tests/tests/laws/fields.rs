//! Distance fields of real meshes against exact distances.

use canonform::Surface;
use canonform::fields::{DistanceField, FieldBounds, FieldOptions, Finish, PairKind};
use geodesics::Method;
use mesh::RepairOptions;
use surface::VertexId;

fn field(surface: &Surface, method: Method) -> DistanceField {
    DistanceField::build(surface, &FieldOptions { method, ..FieldOptions::default() }, &()).unwrap()
}

/// What a field says about pairs whose exact distances are known.
#[derive(Debug, Default)]
struct FieldErrors {
    missed: usize,
    /// Mean relative errors before and after near pairs are finished.
    plain: f64,
    finished: f64,
}

fn scored(field: &DistanceField, pairs: &[[VertexId; 2]], exact: &[f64]) -> FieldErrors {
    let plain = field.pairs(pairs, Finish::Never, &()).unwrap();
    let finished = field.pairs(pairs, Finish::default(), &()).unwrap();
    let mut score = FieldErrors::default();
    for ((plain, finished), exact) in plain.iter().zip(&finished).zip(exact) {
        score.missed += usize::from(*exact < plain.lower || *exact > plain.upper);
        if *exact > 0.0 {
            score.plain += (plain.distance / exact - 1.0).abs() / pairs.len() as f64;
            score.finished += (finished.distance / exact - 1.0).abs() / pairs.len() as f64;
        }
    }
    score
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
            let field = field(&surface, method);
            assert_eq!(field.bounds() == FieldBounds::Certified, method == Method::Exact);
            let score = scored(&field, &pairs, &exact);
            let megabytes = field.facts().bytes as f64 / 1e6;
            println!("{name} by {}: {megabytes:.2} MB, {score:?}", method.name());
            assert_eq!(score.missed, 0, "{name} by {}: {score:?}", method.name());
            assert!(score.finished < 0.005, "{name} by {}: {score:?}", method.name());
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
