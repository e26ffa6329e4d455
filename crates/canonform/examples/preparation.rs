//! Times the preparation of a mesh on one thread and on two: from vertices and faces in memory to a solver that is
//! ready for its first source (`bench/preparation.py`).
//!
//! ```text
//! cargo run --release -p canonform --example preparation -- MESH SUBDIVISIONS ROUNDS
//! ```
//!
//! Prints a line of JSON for each number of threads: medians over the rounds, in seconds, of repair and connectivity,
//! of the solver's preparation, of both, and of one distance map, which always runs on one thread.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use canonform::geodesics::Method;
use canonform::mesh::shapes;
use canonform::surface::VertexId;
use canonform::{Surface, mesh};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, path, subdivisions, rounds] = &arguments[..] else {
        return Err("usage: preparation MESH SUBDIVISIONS ROUNDS".into());
    };
    let mut mesh = mesh::io::read(Path::new(path))?;
    for _ in 0..subdivisions.parse()? {
        mesh = shapes::subdivide(&mesh);
    }
    let rounds: usize = rounds.parse()?;
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pools = [(1, pool(1)?), (2, pool(2)?)];
    let mut seconds = [const { [const { Vec::new() }; 4] }; 2];
    for round in 0..=rounds {
        for ((_, pool), seconds) in pools.iter().zip(&mut seconds) {
            let found = pool.install(|| one_round(&mesh, round))?;
            // The first round warms up.
            if round > 0 {
                seconds.iter_mut().zip(found).for_each(|(all, one)| all.push(one));
            }
        }
    }
    for ((threads, _), seconds) in pools.iter().zip(&mut seconds) {
        let [connectivity, solver, both, map] = seconds.each_mut().map(|all| median(all));
        println!(
            r#"{{"vertices": {}, "threads": {threads}, "connectivity": {connectivity}, "solver": {solver}, "both": {both}, "map": {map}}}"#,
            mesh.n_vertices()
        );
    }
    Ok(())
}

/// Seconds of connectivity, solver, both, and one distance map.
fn one_round(mesh: &mesh::TriMesh, round: usize) -> Result<[f64; 4], canonform::Error> {
    let start = Instant::now();
    let surface = Surface::new(mesh, &Default::default(), &())?;
    let connectivity = start.elapsed().as_secs_f64();
    let solver = Method::default().prepare(surface.intrinsic(), &())?;
    let both = start.elapsed().as_secs_f64();
    let mut out = vec![0.0; solver.n_vertices()];
    let mut map = 0.0;
    // The first map allocates.
    for run in 0..2 {
        let source = VertexId::from((2 * round + run) * 7919 % solver.n_vertices());
        let start = Instant::now();
        solver.distances_into(source, &mut out)?;
        map = start.elapsed().as_secs_f64();
    }
    Ok([connectivity, both - connectivity, both, map])
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
