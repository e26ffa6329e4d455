//! The columns of a table of shapes.

use std::borrow::Cow;

use crate::{Index, IndexError, Shape};

/// A column by its name.
#[derive(Debug)]
pub(super) enum Column {
    /// Texts of at most so many characters.
    Text(&'static str, usize),
    /// Facts.
    Fact(String),
    /// Numbers, at most so many in each dimension.
    Floats(String, Vec<usize>),
}

/// The names of the columns of texts.
const TEXTS: [&str; 4] = ["id", "label", "path", "content"];

/// The texts of a shape, in the order of their columns.
fn texts(shape: &Shape) -> [String; 4] {
    let entry = &shape.entry;
    [shape.id.clone(), entry.label.clone(), entry.path.clone(), entry.content.to_string()]
}

/// The text of a shape in the column of this name.
pub(super) fn text_of(shape: &Shape, name: &str) -> String {
    TEXTS
        .into_iter()
        .zip(texts(shape))
        .find(|(known, _)| *known == name)
        .map_or_else(String::new, |found| found.1)
}

/// Numbers of a shape in a column.
pub(super) struct Floats<'a> {
    name: Cow<'static, str>,
    /// Their number in each dimension.
    extents: Vec<usize>,
    pub(super) values: Cow<'a, [f32]>,
}

/// All numbers of a shape but its facts.
fn floats(shape: &Shape) -> Vec<Floats<'_>> {
    let vectors = &shape.vectors;
    let plain = |name: Cow<'static, str>, values| -> Floats<'_> {
        let values: &[f32] = values;
        Floats { name, extents: vec![values.len()], values: Cow::Borrowed(values) }
    };
    let form = Cow::Borrowed(vectors.form.as_flattened());
    let mut found = vec![
        plain("fused".into(), &vectors.fused),
        Floats { name: "form".into(), extents: vec![vectors.form.len(), 4], values: form },
    ];
    if !vectors.disc_areas.is_empty() {
        found.push(plain("disc_areas".into(), &vectors.disc_areas));
    }
    if let Some(first) = vectors.components.first() {
        let extents = vec![vectors.components.len(), first.len()];
        let values = Cow::Owned(vectors.components.concat());
        found.push(Floats { name: "components".into(), extents, values });
    }
    let signatures = vectors.signatures.iter();
    found.extend(signatures.map(|(name, values)| plain(format!("signature_{name}").into(), values)));
    found
}

/// The numbers of a shape in the column of this name; `None` if it lacks them.
pub(super) fn floats_of<'a>(shape: &'a Shape, name: &str) -> Option<Cow<'a, [f32]>> {
    floats(shape).into_iter().find(|known| known.name == name).map(|found| found.values)
}

/// The columns of the shapes of an index: texts, facts and numbers, each in order of first appearance.
pub(super) fn columns(index: &Index) -> Result<Vec<Column>, IndexError> {
    let mut longest = TEXTS.map(|name| (name, 0));
    let mut facts: Vec<String> = Vec::new();
    let mut numbers: Vec<(String, Vec<usize>)> = Vec::new();
    index.each(|shape| {
        for ((_, longest), text) in longest.iter_mut().zip(texts(&shape)) {
            *longest = (*longest).max(text.chars().count());
        }
        for (name, _) in &shape.entry.facts {
            if !facts.contains(name) {
                facts.push(name.clone());
            }
        }
        for Floats { name, extents, .. } in floats(&shape) {
            match numbers.iter_mut().find(|(known, _)| *known == name) {
                Some((_, most)) => most.iter_mut().zip(extents).for_each(|(most, n)| *most = (*most).max(n)),
                None => numbers.push((name.into_owned(), extents)),
            }
        }
        Ok::<(), IndexError>(())
    })?;
    let texts = longest.into_iter().map(|(name, longest)| Column::Text(name, longest));
    let numbers = numbers.into_iter().map(|(name, extents)| Column::Floats(name, extents));
    Ok(texts.chain(facts.into_iter().map(Column::Fact)).chain(numbers).collect())
}
