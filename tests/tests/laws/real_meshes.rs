//! Expected results on real meshes: scans and TOSCA.

use std::path::Path;

use canonform::collection::list_shapes;
use canonform::{DescribeOptions, Surface, describe};
use descriptors::{ShapeMetric, ShapePair};
use mesh::RepairOptions;
use rayon::prelude::*;
use surface::{IntrinsicMesh, VertexId};

use crate::support::marching;

fn read(path: &Path) -> Surface {
    let surface = canonform::read_surface(path, &RepairOptions::default(), &Default::default(), &()).unwrap();
    assert_eq!(surface.n_input_vertices(), surface.intrinsic().n_vertices(), "{}", path.display());
    surface
}

fn tosca(data: &Path, name: &str) -> Surface {
    read(&data.join("tosca-lowres").join(format!("{name}.vert")))
}

/// Mean relative error of fast marching over all vertices except the source, and the largest outside the one-ring of the
/// source.
fn errors(data: &Path, name: &str, surface: &IntrinsicMesh) -> (f64, f64) {
    let exact = |what| data.join("exact").join(format!("{name}-{what}.npy"));
    let (_, sources) = testkit::array::<u32>(&exact("sources"));
    let (_, rows) = testkit::array::<f64>(&exact("distances"));
    let p = surface.n_vertices();
    assert_eq!(rows.len(), sources.len() * p, "{name}");
    let solver = marching().prepare(surface, &()).unwrap();
    let (mut total, mut count, mut worst) = (0.0, 0usize, 0.0f64);
    for (source, exact) in sources.into_iter().zip(rows.chunks(p)) {
        let source = VertexId(source);
        let found = solver.distances(source).unwrap();
        for v in (0..p).filter(|&v| v != source.index()) {
            let error = (found[v] - exact[v]).abs() / exact[v];
            total += error;
            count += 1;
            if surface.topology().edge_between(source, VertexId::from(v)).is_none() {
                worst = worst.max(error);
            }
        }
    }
    (total / count as f64, worst)
}

#[test]
fn fast_marching_is_close_to_exact_distances() {
    let Some(data) = testkit::data("") else { return };
    let scans = [("armadillo", 0.0025), ("spot", 0.005)].map(|(name, most)| {
        (name, read(&data.join("single").join(format!("{name}.obj"))), [most, f64::INFINITY])
    });
    let poses = ["cat0", "cat1", "centaur1", "horse0", "wolf0"];
    let poses = poses.map(|name| (name, tosca(&data, name), [0.004, 0.1]));
    for (name, surface, most) in scans.into_iter().chain(poses) {
        let (mean, worst) = errors(&data, name, surface.intrinsic());
        let [of_mean, of_worst] = [mean, worst].map(|error| 100.0 * error);
        println!("{name}: mean error {of_mean:.3} %, worst outside the one-ring {of_worst:.2} %");
        assert!(mean <= most[0] && worst <= most[1], "{name}: {mean} {worst}");
    }
}

#[test]
#[ignore = "slow: make test-all"]
fn distances_distinguish_poses_from_animals() {
    let Some(data) = testkit::data("") else { return };
    let shapes = list_shapes(&data.join("tosca-lowres"), None).unwrap();
    // Every other pose; all poses give the same result but take four times as long.
    let classes = ["cat", "centaur", "david", "dog"];
    let shapes: Vec<_> =
        shapes.into_iter().filter(|s| classes.contains(&s.label.as_str())).step_by(2).collect();
    let described: Vec<_> = shapes
        .par_iter()
        .map(|s| {
            DescribeOptions::default()
                .prepare(&describe(&read(&s.path), &DescribeOptions::default(), &()).unwrap())
                .unwrap()
        })
        .collect();
    let pairs: Vec<(usize, usize)> =
        (0..shapes.len()).flat_map(|i| (i + 1..shapes.len()).map(move |j| (i, j))).collect();
    let distance = |&(i, j): &(usize, usize)| {
        let pair = [&described[i], &described[j]];
        let aligned = ShapePair::new(pair);
        let fused = ShapeMetric::fused(&pair[0].fused, &pair[1].fused);
        // The robust loss shortens large distances, so the ratio is one of squared losses.
        let euclidean = ShapeMetric::combined(fused, aligned.best().gap.rms);
        (shapes[i].label == shapes[j].label, aligned.distance(), euclidean)
    };
    let distances: Vec<_> = pairs.par_iter().map(distance).collect();
    let of = |same| distances.iter().filter(move |d| d.0 == same).map(|d| d.2);
    let (farthest, nearest) = (of(true).fold(0.0, f64::max), of(false).fold(f64::INFINITY, f64::min));
    println!(
        "{} pairs: poses of one animal differ by up to {farthest:.2}, animals by at least {nearest:.2}",
        pairs.len()
    );
    for (same, found, _) in &distances {
        assert_eq!(found.same_class() > 0.5, *same, "{found:?}");
        assert!(*same || !found.is_same_shape(), "{found:?}");
        assert!(!*same || !found.is_different(), "{found:?}");
    }
    assert!(nearest > 2.0 * farthest, "{farthest} {nearest}");
}
