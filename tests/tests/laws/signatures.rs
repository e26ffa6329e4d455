//! Signatures depend little on pose and triangulation, distinguish bodies, and exist for any mesh.

use canonform::embed::signature;
use canonform::index::Shape;
use canonform::search::rerank;
use canonform::{DescribeOptions, describe};
use datasets::{ArticulatedOptions, Family, articulated_shape};
use descriptors::{ShapeMetric, SignatureKind};
use rayon::prelude::*;
use retrieval::Neighbor;

use crate::support::data;
use crate::support::surface;

/// Three poses of each family, class by class, each with its own triangulation and resolution.
fn described() -> Vec<Shape> {
    let shape = |i: usize| {
        let (family, pose) = (Family::all()[i / 3], i % 3);
        let options = ArticulatedOptions { seed: 11 + pose as u64, n_vertices: 1000 + 500 * pose };
        let mesh = articulated_shape(family, pose + 1, &options).unwrap().mesh;
        describe(&surface(&mesh), &DescribeOptions::default(), &()).unwrap()
    };
    (0..9).into_par_iter().map(shape).collect()
}

#[test]
fn every_signature_separates_bodies_more_than_poses_and_triangulations() {
    let shapes = described();
    for kind in SignatureKind::INTRINSIC {
        let of = |i: usize| signature(&shapes[i], kind).unwrap();
        let mean = |same: bool| {
            let pairs = (0..9).flat_map(|i| (0..i).map(move |j| (i, j)));
            let found: Vec<f64> = pairs
                .filter(|(i, j)| (i / 3 == j / 3) == same)
                .map(|(i, j)| of(i).distance(&of(j)))
                .collect();
            found.iter().sum::<f64>() / found.len() as f64
        };
        assert!(mean(false) > 2.0 * mean(true), "{}: {} {}", kind.name(), mean(true), mean(false));
    }
}

#[test]
fn the_nearest_shapes_are_poses_of_the_same_body() {
    let shapes = described();
    let prepared: Vec<_> =
        shapes.iter().map(|shape| DescribeOptions::default().prepare(shape).unwrap()).collect();
    for query in 0..9 {
        let mut candidates: Vec<_> = (0..9)
            .filter(|&i| i != query)
            .map(|index| Neighbor {
                index,
                distance: ShapeMetric::robust(&shapes[query].fused, &shapes[index].fused),
            })
            .collect();
        candidates.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        assert!(candidates[..2].iter().all(|c| c.index / 3 == query / 3), "{query}: {candidates:?}");
        let found = rerank(&prepared[query], candidates, 2, |i| Ok(&prepared[i])).unwrap();
        assert!(found.nearest.iter().all(|(n, _)| n.index / 3 == query / 3), "{query}: {found:?}");
    }
}

#[test]
fn real_meshes_with_defects_have_signatures() {
    let Some(folder) = data("signatures of meshes with defects") else { return };
    // Several components, boundaries, edges with three faces, obtuse triangles.
    for name in ["gorilla0", "seahorse0", "lioness0", "shark0", "david0"] {
        let surface = canonform::read_surface(
            &folder.join("tosca-lowres").join(format!("{name}.vert")),
            &Default::default(),
            &Default::default(),
            &(),
        )
        .unwrap();
        let found = describe(&surface, &DescribeOptions::default(), &()).unwrap();
        assert!(found.fused.iter().all(|x| x.is_finite()), "{name}");
        // By Weyl's law the values of ShapeDNA are near one.
        let dna = signature(&found, SignatureKind::ShapeDna).unwrap().values;
        assert!(dna.iter().all(|x| (0.01..3.0).contains(x)), "{name}: {dna:?}");
    }
}
