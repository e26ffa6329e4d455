//! Embeds a mesh several times in one process, as a program that embeds many does, and says how long each
//! run took from vertices and faces in memory to the form: repair, connectivity, preparation, distances and
//! embedding (`bench/nmds.py`).
//!
//! ```text
//! cargo run --release -p canonform --example forms -- MESH SAMPLES RANK FORM
//! ```
//!
//! Every line on standard input is answered by one run and a line of JSON, all seconds. `FORM` then holds the
//! coordinates, three little-endian float64 a vertex.

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use canonform::{
    EmbedMethod, EmbedOptions, FirstSample, Regularization, Samples, StressChoice, Surface, embed,
};
use mesh::RepairOptions;
use surface::VertexId;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, path, samples, rank, form] = &arguments[..] else {
        return Err("usage: forms MESH SAMPLES RANK FORM".into());
    };
    let mesh = mesh::io::read(Path::new(path))?;
    let options = EmbedOptions {
        samples: Samples::Count(samples.parse()?),
        first_sample: FirstSample::Vertex(VertexId(0)),
        method: EmbedMethod::Nystrom {
            regularization: Regularization::LowRank { rank: Some(rank.parse()?) },
        },
        stress: StressChoice::Skip,
        ..EmbedOptions::default()
    };
    for line in std::io::stdin().lines() {
        line?;
        let start = Instant::now();
        let surface = Surface::new(&mesh, &RepairOptions::default())?;
        let embedded = embed(&surface, &options, &())?;
        let total = start.elapsed().as_secs_f64();
        let rows = embedded.embedding.coords.transpose();
        std::fs::write(form, rows.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>())?;
        let seconds = &embedded.report.seconds;
        let parts = (surface.repair_seconds, seconds.geodesics, seconds.embedding);
        println!(
            r#"{{"total": {total}, "repair": {}, "geodesics": {}, "embedding": {}}}"#,
            parts.0, parts.1, parts.2
        );
        std::io::stdout().flush()?;
    }
    Ok(())
}
