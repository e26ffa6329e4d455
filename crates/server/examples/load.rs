//! Load test: many clients search with the same mesh at once.
//!
//! `cargo run --release -p canonform-server --example load -- INDEX MESH [--clients 8] [--seconds 60]` serves the index
//! in this process and prints the number of requests and errors, the median and 99th percentile of response times, and
//! the memory at the start, in the middle and at the end.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use canonform_server::{ServeOptions, Server};

#[path = "../tests/server/client.rs"]
mod client;

/// Memory at the start is measured after this time, when the caches are filled.
const WARM: Duration = Duration::from_secs(5);

struct Arguments {
    index: PathBuf,
    mesh: PathBuf,
    clients: usize,
    seconds: u64,
}

fn arguments() -> Option<Arguments> {
    let mut words = std::env::args().skip(1);
    let (index, mesh) = (words.next()?.into(), words.next()?.into());
    let mut found = Arguments { index, mesh, clients: 8, seconds: 60 };
    while let (Some(name), Some(value)) = (words.next(), words.next()) {
        match name.as_str() {
            "--clients" => found.clients = value.parse().ok()?,
            "--seconds" => found.seconds = value.parse().ok()?,
            _ => return None,
        }
    }
    Some(found)
}

/// Resident memory of this process in megabytes; NaN where the system does not tell.
fn resident() -> f64 {
    let pages = |text: String| text.split(' ').nth(1)?.parse::<f64>().ok();
    fs::read_to_string("/proc/self/statm").ok().and_then(pages).map_or(f64::NAN, |pages| pages * 4096.0 / 1e6)
}

/// Names and contents of a mesh.
fn files(mesh: &Path) -> std::io::Result<Vec<(String, Vec<u8>)>> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    canonform::mesh::io::files_of(mesh).iter().map(|path| Ok((name(path), fs::read(path)?))).collect()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(Arguments { index, mesh, clients, seconds }) = arguments() else {
        return Err("usage: load INDEX MESH [--clients N] [--seconds S]".into());
    };
    let options = ServeOptions { listen: ([127, 0, 0, 1], 0).into(), ..ServeOptions::default() };
    let server = Server::bind(&index, options)?;
    let (address, stop) = (server.address(), server.stop_handle());
    let serving = std::thread::spawn(move || server.run());
    let files = files(&mesh)?;
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, content)| (&name[..], &content[..])).collect();
    let begin = Instant::now();
    let end = begin + Duration::from_secs(seconds);
    let (times, errors) = (Mutex::new(Vec::new()), AtomicUsize::new(0));
    let memory = std::thread::scope(|scope| {
        for _ in 0..clients {
            scope.spawn(|| {
                while Instant::now() < end {
                    let start = Instant::now();
                    match client::upload(address, &files, &[]) {
                        Ok(answer) if answer.status == 200 => {
                            if let Ok(mut times) = times.lock() {
                                times.push(start.elapsed().as_secs_f64());
                            }
                        }
                        other => {
                            eprintln!("{:?}", other.map(|answer| answer.status));
                            errors.fetch_add(1, Ordering::Relaxed);
                        }
                    }
                }
            });
        }
        let at = |when: Instant| {
            std::thread::sleep(when.saturating_duration_since(Instant::now()));
            resident()
        };
        [at((begin + WARM).min(end)), at(begin + Duration::from_secs(seconds) / 2), at(end)]
    });
    stop.stop();
    serving.join().map_err(|_| "the server panicked")??;
    let mut times = times.into_inner()?;
    times.sort_by(f64::total_cmp);
    let at =
        |share: f64| times.get(((times.len() as f64 - 1.0) * share) as usize).copied().unwrap_or(f64::NAN);
    println!("{} requests of {clients} clients in {seconds} s, {} errors", times.len(), errors.into_inner());
    println!("median {:.3} s, 99th percentile {:.3} s", at(0.5), at(0.99));
    let [start, middle, last] = memory;
    println!("in memory {start:.0} MB at the start, {middle:.0} MB in the middle, {last:.0} MB at the end");
    Ok(())
}
