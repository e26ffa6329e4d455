//! The columns of a table of shapes.

use std::borrow::Cow;

use crate::{Index, IndexError, Shape};

/// A column.
#[derive(Debug)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) content: Content,
}

/// What a column holds.
#[derive(Debug)]
pub(super) enum Content {
    /// A text of at most so many characters.
    Text(TextOf, usize),
    /// The fact of this name.
    Fact(String),
    /// Numbers, at most so many in each dimension.
    Floats(Vec<usize>),
}

/// The text of a shape in a column.
pub(super) type TextOf = fn(&Shape) -> String;

/// The columns of texts.
const TEXTS: [(&str, TextOf); 4] = [
    ("id", |shape| shape.id.clone()),
    ("label", |shape| shape.entry.label.clone()),
    ("path", |shape| shape.entry.path.clone()),
    ("content", |shape| shape.entry.content.to_string()),
];

/// Numbers of a shape in a column.
struct Floats<'a> {
    name: Cow<'static, str>,
    /// Their number in each dimension.
    extents: Vec<usize>,
    values: Cow<'a, [f32]>,
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

impl Column {
    /// Whether shapes may lack it. Other numbers are empty then.
    pub(super) fn is_optional(&self) -> bool {
        matches!(self.content, Content::Fact(_)) || self.name.starts_with("signature_")
    }

    /// The numbers of a shape; `None` if it lacks them.
    pub(super) fn floats<'a>(&self, shape: &'a Shape) -> Option<Cow<'a, [f32]>> {
        floats(shape).into_iter().find(|known| known.name == self.name).map(|found| found.values)
    }
}

/// The columns of the shapes of an index: texts, facts and numbers, each in order of first appearance.
pub(super) fn columns(index: &Index) -> Result<Vec<Column>, IndexError> {
    let mut longest = [0; TEXTS.len()];
    let mut facts: Vec<String> = Vec::new();
    let mut numbers: Vec<(String, Vec<usize>)> = Vec::new();
    index.each(|shape| {
        for (longest, (_, text)) in longest.iter_mut().zip(TEXTS) {
            *longest = (*longest).max(text(&shape).chars().count());
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
    let texts = TEXTS.into_iter().zip(longest);
    let texts = texts.map(|((name, text), longest)| (name.to_owned(), Content::Text(text, longest)));
    let facts = facts.into_iter().map(|name| (format!("fact_{name}"), Content::Fact(name)));
    let numbers = numbers.into_iter().map(|(name, extents)| (name, Content::Floats(extents)));
    Ok(texts.chain(facts).chain(numbers).map(|(name, content)| Column { name, content }).collect())
}
