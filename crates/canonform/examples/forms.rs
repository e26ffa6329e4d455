//! Embeds a mesh several times in one process, as a program that embeds many meshes does, and prints how long
//! each run took from vertices and faces in memory to the form: repair, connectivity, preparation, distances and
//! embedding (`bench/nmds.py`).
//!
//! ```text
//! cargo run --release -p canonform --example forms -- MESH SAMPLES RANK FORM
//! ```
//!
//! Each line on standard input starts one run, which answers with a line of JSON: all values are seconds. `FORM`
//! then holds the coordinates, three little-endian float64 per vertex.

use std::error::Error;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

use canonform::embed::{EmbedMethod, FormOptions, Samples, embed};
use canonform::geodesics::FirstSample;
use canonform::surface::VertexId;
use canonform::{Surface, mesh};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, path, samples, rank, form] = &arguments[..] else {
        return Err("usage: forms MESH SAMPLES RANK FORM".into());
    };
    let mesh = mesh::io::read(Path::new(path))?;
    let options = FormOptions {
        samples: Samples::Count(samples.parse()?),
        first_sample: FirstSample::Vertex(VertexId(0)),
        method: EmbedMethod::low_rank(rank.parse()?),
        ..FormOptions::default()
    };
    for line in std::io::stdin().lines() {
        line?;
        let start = Instant::now();
        let surface = Surface::new(&mesh, &options.repair, &())?;
        let embedded = embed(&surface, &options, &())?;
        let total = start.elapsed().as_secs_f64();
        let rows = embedded.embedding.coords.transpose();
        std::fs::write(form, rows.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>())?;
        let seconds = &embedded.report.seconds;
        let parts = (surface.input.repair_seconds, seconds.geodesics, seconds.embedding);
        println!(
            r#"{{"total": {total}, "repair": {}, "geodesics": {}, "embedding": {}}}"#,
            parts.0, parts.1, parts.2
        );
        std::io::stdout().flush()?;
    }
    Ok(())
}
