//! `canonform methods`.

use std::process::ExitCode;

use anyhow::Result;
use canonform::{MethodFacts, MethodsReport, StressOptions, compare_methods};
use peak_alloc::PeakAlloc;
use terminal::Bars;

use crate::args::{Common, MethodsArgs};
use crate::input::{named, read_surface};
use crate::output::report;

/// Counts the bytes on the heap.
#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

/// Embeds a mesh by every method and tabulates the results.
pub(crate) fn methods(args: &MethodsArgs, common: &Common) -> Result<ExitCode> {
    let stress = StressOptions { choice: args.stress, against: None, seed: common.seed };
    let surface = read_surface(&args.mesh, &args.form.repair)?;
    // The bytes beyond those before the work; the whole program is counted, so methods run one at a time.
    let peak_bytes = |work: &mut dyn FnMut()| {
        ALLOCATOR.reset_peak_usage();
        let before = ALLOCATOR.current_usage();
        work();
        ALLOCATOR.peak_usage().saturating_sub(before)
    };
    let methods =
        compare_methods(&surface, &args.form.options(common), &stress, &Bars::new(common.quiet), &peak_bytes)
            .map_err(|fault| named(&args.mesh, fault))?;
    report(common, &methods, table)
}

/// One row per method, with a star at the lowest value of a column.
fn table(report: &MethodsReport) -> String {
    let least = |value: &dyn Fn(&MethodFacts) -> Option<f64>| {
        let facts = report.methods.iter().filter_map(|m| m.facts.as_ref());
        facts.filter_map(value).fold(f64::INFINITY, f64::min)
    };
    let stress = |f: &MethodFacts| f.stress.as_ref().map(|s| s.value);
    let seconds = |f: &MethodFacts| Some(f.seconds);
    let memory = |f: &MethodFacts| Some(f.peak_bytes as f64);
    let best = [least(&stress), least(&seconds), least(&memory)];
    let star = |value: Option<f64>, best: f64| if value == Some(best) { " *" } else { "  " };

    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING).set_header([
        "method",
        "options",
        "samples",
        "stress  ",
        "seconds  ",
        "memory  ",
        "negative mass",
    ]);
    for method in &report.methods {
        let mut row = vec![method.method.to_owned(), method.options.to_owned()];
        match &method.facts {
            Some(f) => {
                let value = stress(f).map_or_else(|| "no unit".to_owned(), |s| format!("{s:.4}"));
                row.extend([
                    f.n_samples.to_string(),
                    value + star(stress(f), best[0]),
                    view::numbers::seconds(f.seconds) + star(seconds(f), best[1]),
                    view::numbers::bytes(f.peak_bytes) + star(memory(f), best[2]),
                    format!("{:.4}", f.negative_mass),
                ]);
            }
            None => row.extend(["", "failed  ", "", "", ""].map(str::to_owned)),
        }
        table.add_row(row);
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(comfy_table::CellAlignment::Right);
    }
    let mut text = table.trim_fmt();
    for method in &report.methods {
        if let Some(error) = &method.error {
            text += &format!("\n{} {} failed: {error}", method.method, method.options);
        }
    }
    let kind = report.methods.iter().find_map(|m| m.facts.as_ref()?.stress.as_ref());
    let kind = kind.map_or_else(String::new, |s| format!(", {:?}", s.kind).to_lowercase());
    text + &format!(
        "\n* lowest of its column. {} vertices, {} dimensions; stress against {} distances{kind}; seconds from the \
         repaired mesh to the embedding.",
        report.n_embedded, report.dim, report.geodesic
    )
}
