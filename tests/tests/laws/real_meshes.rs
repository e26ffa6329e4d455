//! Expected results on real meshes: TOSCA.

use std::path::Path;

use canonform::collection::list_shapes;
use canonform::{DescribeOptions, Surface, describe};
use descriptors::{ShapeMetric, ShapePair};
use mesh::RepairOptions;
use rayon::prelude::*;

fn read(path: &Path) -> Surface {
    let surface = canonform::read_surface(path, &RepairOptions::default(), &Default::default(), &()).unwrap();
    assert_eq!(surface.n_input_vertices(), surface.intrinsic().n_vertices(), "{}", path.display());
    surface
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
