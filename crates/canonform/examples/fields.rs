//! Measures distance fields against exact distances: size, time, error and missed intervals.
//!
//! ```text
//! cargo run --release -p canonform --example fields -- MESH [LANDMARKS [RANK]]
//! ```
//!
//! Prints a row of a Markdown table for fields by fast marching and by exact distances, each from 20 random vertices to 500
//! others. Errors are relative to the exact distance, in per cent. "Finished" are pairs whose interval is wider than 5 %.

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use canonform::fields::{DistanceField, FieldOptions, Finish, PairDistance, PairKind};
use canonform::geodesics::Method;
use canonform::read_surface;
use canonform::surface::VertexId;

const SOURCES: usize = 20;
const TARGETS: usize = 500;
const PAIRS: usize = 1_000_000;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some(path) = arguments.first() else { return Err("usage: fields MESH [LANDMARKS [RANK]]".into()) };
    let landmarks = arguments.get(1).map_or(Ok(FieldOptions::default().landmarks), |text| text.parse())?;
    let rank = arguments.get(2).map(|text| text.parse()).transpose()?;
    let surface = read_surface(Path::new(path), &Default::default(), &Default::default(), &())?;
    let mut random = Random(7);
    let n = surface.n_input_vertices();

    let solver = Method::Exact.prepare(surface.intrinsic(), &())?;
    let (mut pairs, mut exact) = (Vec::new(), Vec::new());
    for _ in 0..SOURCES {
        let source = random.vertex(n);
        let distances = solver.distances(surface.repaired_vertex(source)?)?;
        let distances = surface.in_input_order(&distances, f64::INFINITY);
        for target in (0..TARGETS).map(|_| random.vertex(n)).filter(|target| *target != source) {
            pairs.push([source, target]);
            exact.push(distances[target.index()]);
        }
    }
    println!(
        "| mesh, method, n, rank | vertices | MB | build s | ns a pair | mean, median, p95, max error % | finished %, ms each | mean, p95, max error % when finished | median width % | missed of {} |",
        pairs.len()
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for method in [Method::default(), Method::Exact] {
        let start = Instant::now();
        let field = DistanceField::build(&surface, &FieldOptions { method, landmarks, rank }, &())?;
        let build = start.elapsed().as_secs_f64();
        let looked_up: Vec<_> = (0..PAIRS).map(|_| [random.vertex(n), random.vertex(n)]).collect();
        let start = Instant::now();
        let mut sum = 0.0;
        for [a, b] in looked_up {
            sum += field.pair(a, b)?.distance;
        }
        let nanoseconds = start.elapsed().as_secs_f64() * 1e9 / PAIRS as f64;
        assert!(sum > 0.0);

        let plain = field.pairs(&pairs, Finish::Never, &())?;
        // The first call prepares the solver.
        field.nearest(pairs[0][0], 1, &())?;
        let start = Instant::now();
        let mut finished = plain.clone();
        for (answer, pair) in finished.iter_mut().zip(&pairs) {
            *answer = field.pairs(&[*pair], Finish::default(), &())?[0];
        }
        let n_finished = finished.iter().filter(|pair| pair.kind == PairKind::Exact).count();
        let each = 1e3 * start.elapsed().as_secs_f64() / n_finished.max(1) as f64;
        let missed =
            plain.iter().zip(&exact).filter(|(pair, d)| **d < pair.lower || **d > pair.upper).count();
        let widths =
            sorted(plain.iter().zip(&exact).map(|(pair, d)| (pair.upper - pair.lower) / d).collect());
        let (plain, after) = (errors(&plain, &exact), errors(&finished, &exact));
        let facts = field.facts();
        let name = Path::new(path).file_stem().unwrap_or_default().to_string_lossy();
        println!(
            "| {name}, {}, {}, {} | {n} | {:.2} | {build:.3} | {nanoseconds:.0} | {:.3}, {:.3}, {:.2}, {:.0} | {:.1}, {each:.2} | {:.3}, {:.2}, {:.1} | {:.2} | {missed} |",
            facts.method,
            facts.n_landmarks,
            facts.rank,
            facts.bytes as f64 / 1e6,
            mean(&plain),
            at(&plain, 0.5),
            at(&plain, 0.95),
            at(&plain, 1.0),
            100.0 * n_finished as f64 / pairs.len() as f64,
            mean(&after),
            at(&after, 0.95),
            at(&after, 1.0),
            100.0 * at(&widths, 0.5),
        );
        eprintln!("{}: {:?}", facts.method, facts.bounds);
    }
    Ok(())
}

/// Relative errors in per cent, sorted.
fn errors(found: &[PairDistance], exact: &[f64]) -> Vec<f64> {
    sorted(found.iter().zip(exact).map(|(pair, d)| 100.0 * (pair.distance / d - 1.0).abs()).collect())
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    values
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn at(values: &[f64], share: f64) -> f64 {
    let last = values.len().saturating_sub(1);
    values.get((share * last as f64) as usize).copied().unwrap_or(f64::NAN)
}

/// A linear congruential generator.
struct Random(u64);

impl Random {
    fn vertex(&mut self, n: usize) -> VertexId {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        VertexId::from((self.0 >> 33) as usize % n)
    }
}
