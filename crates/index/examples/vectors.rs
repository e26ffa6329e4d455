//! Indexes the rows of a NumPy array and answers queries, for `bench/search.py`.
//!
//! ```text
//! vectors build BASE.npy INDEX           builds an index and prints the seconds taken
//! vectors add QUERIES.npy INDEX COUNT    adds the first rows one by one; prints the seconds and the bytes of each addition
//! vectors serve INDEX QUERIES.npy        for each input line `K FIRST COUNT`, prints
//!                                        {"seconds": [..], "found": [[..], ..]}
//! ```
//!
//! Arrays are little-endian float32 in C order.

use std::error::Error;
use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use canonform_index::{Entry, Index, IndexWriter, Shape};
use serde_json::json;

/// Shapes in one transaction.
const BATCH: usize = 20_000;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["build", base, index] => build(Path::new(base), Path::new(index)),
        ["add", queries, index, count] => add(Path::new(queries), Path::new(index), count.parse()?),
        ["serve", index, queries] => serve(Path::new(index), Path::new(queries)),
        _ => {
            Err("usage: vectors build BASE.npy INDEX | add QUERIES.npy INDEX COUNT | serve INDEX QUERIES.npy"
                .into())
        }
    }
}

/// Reads the rows of an array and their length.
fn read(path: &Path) -> Result<(Vec<f32>, usize), Box<dyn Error>> {
    let bytes = std::fs::read(path)?;
    let array = npyz::NpyFile::new(&bytes[..])?;
    let dim = *array.shape().last().ok_or("an array without dimensions")? as usize;
    Ok((array.into_vec()?, dim))
}

/// A shape of which only the vector matters.
fn shape(id: String, row: &[f32]) -> Shape {
    Shape { entry: Entry { id, ..Entry::default() }, fused: row.to_vec(), ..Shape::default() }
}

fn add(queries: &Path, path: &Path, count: usize) -> Result<(), Box<dyn Error>> {
    let (rows, dim) = read(queries)?;
    let (mut seconds, mut bytes) = (Vec::new(), Vec::new());
    for (i, row) in rows.chunks_exact(dim).take(count).enumerate() {
        let before = std::fs::metadata(path)?.len();
        let start = Instant::now();
        let mut writer = IndexWriter::open(path)?;
        writer.put(&[shape(format!("added{i:04}"), row)])?;
        writer.finish()?;
        seconds.push(start.elapsed().as_secs_f64());
        bytes.push(std::fs::metadata(path)?.len() as i64 - before as i64);
    }
    println!("{}", json!({ "seconds": seconds, "bytes": bytes, "megabytes": peak_memory() }));
    Ok(())
}

fn build(base: &Path, path: &Path) -> Result<(), Box<dyn Error>> {
    let (rows, dim) = read(base)?;
    let start = Instant::now();
    let mut writer = IndexWriter::build(path, "vectors")?;
    let shape = |(i, row): (usize, &[f32])| shape(format!("{i:08}"), row);
    let mut shapes = rows.chunks_exact(dim).enumerate().map(shape).peekable();
    while shapes.peek().is_some() {
        writer.put(&shapes.by_ref().take(BATCH).collect::<Vec<_>>())?;
        writer.commit()?;
    }
    let stored = start.elapsed().as_secs_f64();
    drop(shapes);
    drop(rows);
    writer.finish()?;
    let finished = start.elapsed().as_secs_f64() - stored;
    println!("{}", json!({ "stored": stored, "finished": finished, "megabytes": peak_memory() }));
    Ok(())
}

fn serve(path: &Path, queries: &Path) -> Result<(), Box<dyn Error>> {
    let (queries, dim) = read(queries)?;
    let start = Instant::now();
    let index = Index::open(path)?;
    let opened = start.elapsed().as_secs_f64();
    index.vector_table()?;
    let loaded = start.elapsed().as_secs_f64();
    println!("{}", json!({ "opened": opened, "loaded": loaded, "megabytes": peak_memory() }));
    std::io::stdout().flush()?;
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let words: Vec<&str> = line.split_whitespace().collect();
        let [k, first, count] = words[..] else { return Err(format!("`{line}`?").into()) };
        let (k, first, count): (usize, usize, usize) = (k.parse()?, first.parse()?, count.parse()?);
        let (mut seconds, mut found) = (Vec::new(), Vec::new());
        for query in queries[first * dim..(first + count) * dim].chunks_exact(dim) {
            let start = Instant::now();
            let near = index.nearest(query, k)?;
            seconds.push(start.elapsed().as_secs_f64());
            found.push(near.iter().map(|(id, _)| id.parse()).collect::<Result<Vec<u32>, _>>()?);
        }
        println!("{}", json!({ "seconds": seconds, "found": found }));
        std::io::stdout().flush()?;
    }
    Ok(())
}

/// Peak memory of this process in megabytes; 0 if the system does not report it.
fn peak_memory() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kibibytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kibibytes.unwrap_or(0) / 1000
}
