//! Growth of time and memory with the number of vertices, on a generated body.
//!
//! Measures `map growth`, `preparation growth`, `NMDS growth` and `memory growth`, exponents in the number of vertices, and
//! `NMDS seconds`, the time of a whole form at the greatest number.

use anyhow::Result;
use base::terminal::with_peak_bytes;
use canonform::Surface;
use canonform::embed::embed;
use datasets::{ArticulatedOptions, Family, articulated_shape};
use geodesics::Method;
use mesh::RepairOptions;
use report::Record;
use report::record::{Axis, Series};
use surface::VertexId;

use crate::context::Context;
use crate::specimen::low_rank;
use crate::sweep::{MeasuredNumbers, curves, places, plot, plots, timed};

/// The curves of time, and of memory.
const CURVES: [&str; 4] = ["preparation", "map", "NMDS", "NMDS"];

const MIB: f64 = (1u64 << 20) as f64;

pub(crate) fn scaling(context: &Context<'_>) -> Result<Record> {
    let options = &context.options;
    let mut runs = vec![Vec::new(); options.runs];
    context.observer.begin("scaling", options.counts.len() * (options.runs + 1));
    for &n_vertices in &options.counts {
        let body =
            articulated_shape(Family::David, 0, &ArticulatedOptions { seed: context.seed, n_vertices })?;
        let surface = Surface::new(&body.mesh, &RepairOptions::default(), &())?;
        drop(body);
        context.observer.step();
        for run in &mut runs {
            run.push([of_one_map(&surface)?, of_form(context, &surface)?].concat());
            context.observer.step();
        }
    }
    let at = places(&options.counts);
    let mut times = curves(&CURVES, &at, &runs);
    let memory = times.split_off(3);
    let mut measured: MeasuredNumbers =
        times.iter().map(|curve| (format!("{} growth", curve.name), growth(curve))).collect();
    measured.insert("memory growth".to_owned(), growth(&memory[0]));
    measured.insert("NMDS seconds".to_owned(), times[2].points.last().map_or(f64::NAN, |p| p.low));
    let of = |title: &str, unit: &str, series| {
        plot(title, Axis::log("vertices", ""), Axis::log(&title.to_lowercase(), unit), series)
    };
    let both = vec![of("Time", "seconds", times), of("Memory", "MiB", memory)];
    Ok(Record { figures: vec![plots("curves", both)], ..context.record(&[], measured) })
}

/// Seconds for preparing a surface, and for the distances from one vertex in a second run.
fn of_one_map(surface: &Surface) -> Result<[f64; 2]> {
    let method = Method::default();
    let (solver, preparation) = timed(|| method.prepare(surface.intrinsic(), &()))?;
    let mut distances = solver.distances(VertexId(0))?;
    let (_, map) = timed(|| solver.distances_into(VertexId(0), &mut distances))?;
    Ok([preparation, map])
}

/// Seconds and MiB for a canonical form.
fn of_form(context: &Context<'_>, surface: &Surface) -> Result<[f64; 2]> {
    let options = low_rank(context.options.samples, context.options.rank, 0);
    let (embedded, peak_bytes) = with_peak_bytes(|| timed(|| embed(surface, &options, &())));
    Ok([embedded?.1, peak_bytes as f64 / MIB])
}

/// The exponent of the least values of a curve: the slope of the line that fits their logarithms best.
fn growth(curve: &Series) -> f64 {
    let logs: Vec<[f64; 2]> = curve.points.iter().map(|p| [p.x.ln(), p.low.ln()]).collect();
    let mean = |i: usize| logs.iter().map(|log| log[i]).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let slope = |i: usize| logs.iter().map(|log| (log[0] - x) * (log[i] - [x, y][i])).sum::<f64>();
    slope(1) / slope(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::series;

    #[test]
    fn the_growth_of_a_power_is_its_exponent() {
        let at = [1e3, 4e3, 5e4, 1e6];
        let power = at.map(|p: f64| 3.0 * p.powf(1.1)).to_vec();
        let slower = power.iter().map(|y| 2.0 * y).collect();
        assert!((growth(&series("power", &at, &[power, slower])) - 1.1).abs() < 1e-12);
    }
}
