//! Figure 1: shapes beside their canonical forms.
//!
//! Measures `pairs`, the number of them, and `largest stress ratio`: the largest ratio of the stress to the squared spread
//! of a form, which has no unit.

use anyhow::Result;
use canonform::embed::{EmbedOptions, StressChoice, StressOptions, embed};
use report::numbers::significant;
use report::record::{Figure, FigurePanels, TileRow, Tiles};
use report::{Cell, Record, Table};

use crate::collection::map;
use crate::context::Context;
use crate::specimen::{describing, low_rank};
use crate::surfaces::{aligned, tile};
use crate::sweep::numbers;

/// The greatest number of pairs in a row.
const PAIRS: usize = 3;

const FORMS: &str = "Up to three shapes of each class (left), each with its canonical form (right). All forms of a class are seen from the same side; the number under each is its stress in squared mesh units. Colors denote classes, as in Figure 4.";

pub(crate) fn figure1(context: &Context<'_>) -> Result<Record> {
    let options = low_rank(context.options.samples, context.options.rank, context.seed);
    let stress = StressOptions { choice: StressChoice::Estimate, against: None, seed: context.seed };
    let shown = context.collection.first_of_each_class(PAIRS);
    let embedded = map(&shown, "figure 1", context.observer, |shape| {
        let embedded = embed(&shape.surface, EmbedOptions::from(&options).stress(stress), &())?;
        let form = embedded.form(&shape.surface)?;
        let stress = embedded.report.stress.map_or(f64::NAN, |stress| stress.value);
        Ok((form, stress, embedded.distances.column(0)?.into_owned()))
    })?;
    let worst = embedded.iter().map(|(form, stress, _)| stress / form.spread().powi(2)).fold(0.0, f64::max);
    let (mut first, mut rows, mut facts) = (None, Vec::<TileRow>::new(), Vec::new());
    for (shape, (form, stress, distances)) in shown.iter().zip(&embedded) {
        if rows.last().is_none_or(|row| row.name != shape.label) {
            first = None;
            rows.push(TileRow { name: shape.label.clone(), tiles: Vec::new() });
        }
        let mesh = shape.surface.mesh();
        let form = aligned(form, mesh, &mut first)?;
        if let Some(row) = rows.last_mut() {
            row.tiles.push(tile(mesh, false, distances, vec![shape.name.clone()]));
            row.tiles.push(tile(&form, true, distances, vec![format!("stress {}", significant(*stress, 4))]));
        }
        let repair = shape.surface.input.report.summary();
        let repair = if repair.is_empty() { "nothing".to_owned() } else { repair.join("; ") };
        let [name, label] = [&shape.name, &shape.label].map(|text| text.as_str().into());
        let counts = [mesh.n_vertices(), mesh.n_faces()].map(Cell::from);
        facts.push([&[name, label][..], &counts, &[(*stress).into(), repair.into()]].concat());
    }
    let columns = rows.iter().map(|row| row.tiles.len()).max().unwrap_or(0);
    let heads = ["shape", "canonical form"].map(str::to_owned).into_iter().cycle().take(columns).collect();
    let tiles = FigurePanels::Tiles(Tiles { is_paired: true, heads, rows });
    let caption =
        "The embedded shapes, the stress of their canonical forms, and what was repaired in the input.";
    let headings = ["shape", "class", "vertices", "faces", "stress", "repaired"];
    let measured = numbers([("pairs", shown.len() as f64), ("largest stress ratio", worst)]);
    Ok(Record {
        figures: vec![Figure { part: "forms".to_owned(), caption: FORMS.to_owned(), panels: tiles }],
        tables: vec![Table::new(caption, headings, facts)],
        ..context.record(&[("embedding", &describing(options))], measured)
    })
}
