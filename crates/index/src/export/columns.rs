//! The columns of a table of shapes.

use std::borrow::Cow;

use crate::reader::SIGNATURE;
use crate::{Index, IndexError, Shape};

/// What a shape has in a column.
pub(super) enum Value<'a> {
    Text(Cow<'a, str>),
    Fact(f64),
    /// Numbers, and how many there are in each dimension.
    Floats(Cow<'a, [f32]>, Vec<usize>),
}

fn row(values: &[f32]) -> Value<'_> {
    Value::Floats(values.into(), vec![values.len()])
}

/// Everything of a shape, by the names of columns.
pub(super) fn values(shape: &Shape) -> Vec<(Cow<'static, str>, Value<'_>)> {
    let entry = &shape.entry;
    let mut all: Vec<(Cow<'static, str>, Value<'_>)> = vec![
        ("id".into(), Value::Text((&entry.id).into())),
        ("label".into(), Value::Text((&entry.label).into())),
        ("path".into(), Value::Text((&entry.path).into())),
        ("content".into(), Value::Text(entry.content.to_string().into())),
    ];
    all.extend(entry.facts.named().map(|(name, x)| (format!("fact_{name}").into(), Value::Fact(x))));
    all.push(("fused".into(), row(&shape.fused)));
    all.push(("form".into(), Value::Floats(shape.form.as_flattened().into(), vec![shape.form.len(), 4])));
    if !shape.disc_areas.is_empty() {
        all.push(("disc_areas".into(), row(&shape.disc_areas)));
    }
    if let Some(first) = shape.components.first() {
        let extents = vec![shape.components.len(), first.len()];
        all.push(("components".into(), Value::Floats(shape.components.concat().into(), extents)));
    }
    all.extend(
        shape.signatures.iter().map(|(name, values)| (format!("{SIGNATURE}{name}").into(), row(values))),
    );
    all
}

/// A column, in order of first appearance.
pub(super) struct Column {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// The most that a shape has: characters of a text, numbers in each dimension.
    pub(super) extents: Vec<usize>,
}

/// What a column holds.
pub(super) enum Kind {
    Text,
    Fact,
    Floats,
}

impl Column {
    /// Whether shapes may lack it. Other numbers are empty then.
    pub(super) fn is_optional(&self) -> bool {
        self.name.starts_with(SIGNATURE)
    }

    /// What a shape has in it.
    pub(super) fn value<'a>(&self, shape: &'a Shape) -> Option<Value<'a>> {
        values(shape).into_iter().find(|(name, _)| *name == self.name).map(|(_, value)| value)
    }
}

/// The columns of the shapes of an index.
pub(super) fn columns(index: &Index) -> Result<Vec<Column>, IndexError> {
    let mut columns: Vec<Column> = Vec::new();
    index.each(|shape| {
        for (name, value) in values(&shape) {
            let (kind, extents) = match value {
                Value::Text(text) => (Kind::Text, vec![text.chars().count()]),
                Value::Fact(_) => (Kind::Fact, Vec::new()),
                Value::Floats(_, extents) => (Kind::Floats, extents),
            };
            match columns.iter_mut().find(|known| known.name == name) {
                Some(known) => {
                    known.extents.iter_mut().zip(extents).for_each(|(most, n)| *most = n.max(*most))
                }
                None => columns.push(Column { name: name.into_owned(), kind, extents }),
            }
        }
        Ok::<(), IndexError>(())
    })?;
    Ok(columns)
}
