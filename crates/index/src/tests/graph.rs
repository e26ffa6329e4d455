//! The graph of nearest neighbours: what it lists and what it finds.

use retrieval::{Graph as _, LINKS, Neighbor, graph_rank};

use super::{Folder, OPTIONS, shape};
use crate::{Index, IndexWriter, Job, Shape, ShapeVectors, verify};

#[test]
fn an_index_finds_what_a_matrix_of_its_distances_finds() {
    let folder = Folder::new();
    let index = Index::open(&folder.index("a", 90)).unwrap();
    let vectors: Vec<Vec<f32>> = (0..90).map(|i| shape(i).vectors.fused).collect();
    let apart = |a: &[f32], b: &[f32]| -> f64 {
        a.iter().zip(b).map(|(x, y)| (f64::from(*x) - f64::from(*y)).powi(2)).sum::<f64>().sqrt()
    };
    struct All<'a>(&'a [Vec<f32>], Vec<f32>, &'a dyn Fn(&[f32], &[f32]) -> f64);
    impl All<'_> {
        fn near(&self, row: &[f32], but: usize) -> Vec<Neighbor> {
            let others = (0..self.0.len()).filter(|i| *i != but);
            let mut near: Vec<Neighbor> =
                others.map(|index| Neighbor { index, distance: (self.2)(row, &self.0[index]) }).collect();
            near.sort_by(|a, b| a.distance.total_cmp(&b.distance));
            near.truncate(LINKS);
            near
        }
    }
    impl retrieval::Graph for All<'_> {
        type Error = std::convert::Infallible;

        fn links(&mut self, shape: usize) -> Result<Vec<Neighbor>, Self::Error> {
            Ok(self.near(&self.0[shape], shape))
        }

        fn distance(&mut self, shape: usize) -> Result<f64, Self::Error> {
            Ok((self.2)(&self.1, &self.0[shape]))
        }
    }
    for x in [40.3f32, 3.1, 88.0] {
        let query = vec![x, 0.2, 0.1];
        let mut all = All(&vectors, query.clone(), &apart);
        assert!(all.links(0).unwrap().len() == LINKS);
        let nearest = all.near(&query, usize::MAX);
        let expected = graph_rank(usize::MAX, &nearest, &mut all).unwrap();
        let found = index.nearest_on_graph(&query, 10).unwrap();
        assert_eq!(found.len(), 10);
        for (near, expected) in found.iter().zip(&expected) {
            assert_eq!(near.id, shape(expected.index).id);
            assert!((near.rank_distance - expected.rank_distance).abs() < 1e-5);
            assert!((near.distance - expected.distance).abs() < 1e-9);
            let plain = nearest.iter().position(|plain| plain.index == expected.index);
            assert_eq!(near.plain_rank, plain.map(|place| place + 1));
        }
    }
}

#[test]
fn few_shapes_equal_shapes_and_none_have_a_graph() {
    let folder = Folder::new();
    let none = Index::open(&folder.index("none", 0)).unwrap();
    assert!(none.nearest_on_graph(&[1.0, 2.0], 3).unwrap().is_empty());
    let few = Index::open(&folder.index("few", 3)).unwrap();
    assert_eq!(few.nearest_on_graph(&[0.0, 0.0, 0.1], 9).unwrap().len(), 3);
    let path = folder.path("equal");
    let mut writer = IndexWriter::open(&path, Job::Build, Some(OPTIONS)).unwrap();
    let vectors = ShapeVectors { fused: vec![1.0, 2.0], ..ShapeVectors::default() };
    let copies = (0..80).map(|i| Shape { vectors: vectors.clone(), ..shape(i) });
    writer.put(&copies.collect::<Vec<_>>()).unwrap();
    let index = writer.finish(&()).unwrap();
    let found = index.nearest_on_graph(&[1.0, 2.0], 5).unwrap();
    assert!(found.iter().all(|near| near.distance == 0.0 && near.rank_distance.is_finite()));
    assert_eq!(verify(&path).unwrap().faults, Vec::<String>::new());
}
