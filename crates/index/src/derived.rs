//! What follows from the shapes of an index: the numbers of shapes and classes, and the threshold of unknown classes.

use std::collections::BTreeMap;

use crate::IndexError;
use crate::floats::Floats;
use crate::store::{Changes, LIMIT, View};
use crate::tables::{ABOUT, About, CLASSES, ENTRIES, FUSED};
use crate::texts::Texts;
use crate::vectors::{VectorTable, threshold};

/// What holds for the whole index. Sizes are checked: what they promise must fit into the file.
pub(crate) fn about(view: View<'_>) -> Result<About, IndexError> {
    let about = ABOUT.get(view, "")?.ok_or_else(|| view.damaged("its head is missing"))?;
    check_length(view, about.dim)?;
    match (about.n as u64).saturating_mul(4 * about.dim as u64) <= view.n_bytes() {
        true => Ok(about),
        false => Err(view.damaged("the number of its shapes is wrong")),
    }
}

/// Checks the length of the vectors, as the file states it.
fn check_length(view: View<'_>, dim: usize) -> Result<(), IndexError> {
    match dim <= LIMIT / 4 {
        true => Ok(()),
        false => Err(view.damaged(format!("its vectors have {dim} numbers"))),
    }
}

/// The vectors of all shapes.
pub(crate) fn vectors(view: View<'_>) -> Result<VectorTable, IndexError> {
    let mut table = VectorTable::default();
    for row in FUSED.rows(view, &[]) {
        let (id, Floats(fused)) = row?;
        let dim = if table.is_empty() { fused.len() } else { table.dim() };
        check_length(view, dim)?;
        if fused.len() != dim || fused.is_empty() {
            let found = fused.len();
            return Err(view.damaged(format!("the vector of `{id}` has {found} numbers, not {dim}")));
        }
        table.push(&id, &fused);
    }
    Ok(table)
}

/// The classes of these shapes, which must be all that have an entry.
pub(crate) fn classes(view: View<'_>, vectors: &VectorTable) -> Result<Texts, IndexError> {
    let mut classes = Texts::default();
    for row in ENTRIES.rows(view, &[]) {
        let (id, entry) = row?;
        if classes.len() == vectors.len() || vectors.id(classes.len()) != id {
            return Err(view.damaged(format!("`{id}` has no vector")));
        }
        classes.push(&entry.label);
    }
    match classes.len() == vectors.len() {
        true => Ok(classes),
        false => Err(view.damaged(format!("`{}` has no entry", vectors.id(classes.len())))),
    }
}

/// The number of shapes in each class. Shapes without a class do not count.
pub(crate) fn counted(classes: &Texts) -> BTreeMap<String, u64> {
    let mut counts = BTreeMap::new();
    for class in classes.iter().filter(|class| !class.is_empty()) {
        *counts.entry(class.to_owned()).or_insert(0) += 1;
    }
    counts
}

/// What follows from the shapes, as far as it differs from what is stored.
pub(crate) fn derived(view: View<'_>, options: &str) -> Result<Changes, IndexError> {
    let vectors = vectors(view)?;
    let classes = classes(view, &vectors)?;
    let threshold = threshold(|visit| {
        visit(&vectors, &classes);
        Ok::<_, IndexError>(())
    })?;
    let about = About { options: options.to_owned(), dim: vectors.dim(), n: vectors.len(), threshold };
    let mut changes = Changes::new();
    ABOUT.put(&mut changes, "", Some(&about))?;
    let counts = counted(&classes);
    let mut known: BTreeMap<String, u64> = CLASSES.rows(view, &[]).collect::<Result<_, _>>()?;
    for (class, count) in &counts {
        if known.remove(class) != Some(*count) {
            CLASSES.put(&mut changes, class, Some(count))?;
        }
    }
    known.keys().try_for_each(|gone| CLASSES.put(&mut changes, gone, None))?;
    Ok(changes)
}
