//! Writes an index of many shapes that were not made from meshes, to measure searches.
//!
//! ```text
//! cargo run --release -p canonform --example large_index -- 100000 large.canonform
//! ```
//!
//! The fused vectors are random, in classes of 20 around random centers. Forms have 20 points.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use canonform::DescribeOptions;
use canonform::descriptors::{ShapeMetric, SignatureKind};
use canonform::index::{ContentHash, Entry, Facts, IndexWriter, Shape};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Shapes of a class, and in one transaction.
const CLASS: usize = 20;
const BATCH: usize = 10_000;

fn noise(random: &mut ChaCha8Rng, n: usize, width: f32) -> Vec<f32> {
    (0..n).map(|_| width * ((random.next_u64() >> 40) as f32 / (1 << 23) as f32 - 1.0)).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [n, path] = &arguments[..] else { return Err("usage: large_index NUMBER INDEX".into()) };
    let (n, mut random) = (n.parse::<usize>()?, ChaCha8Rng::seed_from_u64(1));
    let mut writer = IndexWriter::build(Path::new(path), &DescribeOptions::default().text())?;
    let (start, mut batch, mut center) = (Instant::now(), Vec::new(), Vec::new());
    for i in 0..n {
        if i % CLASS == 0 {
            center = noise(&mut random, ShapeMetric::FUSED_LENGTH, 1.0);
        }
        let fused = center.iter().zip(noise(&mut random, center.len(), 0.1)).map(|(x, y)| x + y);
        let form = noise(&mut random, 80, 1.0);
        let spectrum = noise(&mut random, SignatureKind::FormSpectrum.n_values(), 1.0);
        batch.push(Shape {
            entry: Entry {
                id: format!("shape{i:07}"),
                label: format!("class{}", i / CLASS),
                path: format!("meshes/shape{i:07}.off"),
                content: ContentHash::of(&[i.to_le_bytes()]),
                facts: Facts { area: 1.0, diameter: 1.0, components: 1, ..Facts::default() },
            },
            fused: fused.collect(),
            signatures: [(SignatureKind::FormSpectrum.name().to_owned(), spectrum)].into(),
            form: form.chunks_exact(4).map(|p| [p[0], p[1], p[2], 0.05]).collect(),
            ..Shape::default()
        });
        if batch.len() == BATCH || i + 1 == n {
            writer.put(&batch)?;
            writer.commit()?;
            batch.clear();
        }
    }
    let stored = start.elapsed().as_secs_f64();
    writer.finish()?;
    println!("stored in {stored:.2} s, finished in {:.2} s", start.elapsed().as_secs_f64() - stored);
    Ok(())
}
