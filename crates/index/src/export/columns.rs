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

/// A column.
pub(super) struct Column {
    pub(super) name: String,
    pub(super) kind: Kind,
}

/// What a column holds.
pub(super) enum Kind {
    /// Texts of at most so many characters.
    Text(usize),
    Fact,
    /// Numbers, at most so many in each dimension.
    Floats(Vec<usize>),
}

impl Column {
    /// Whether shapes may lack it. Other numbers are empty then.
    pub(super) fn is_optional(&self) -> bool {
        self.name.starts_with(SIGNATURE)
    }

    /// The text of a shape.
    pub(super) fn text(&self, shape: &Shape) -> String {
        match self.value(shape) {
            Some(Value::Text(text)) => text.into_owned(),
            _ => String::new(),
        }
    }

    /// The number of a shape.
    pub(super) fn fact(&self, shape: &Shape) -> f64 {
        match self.value(shape) {
            Some(Value::Fact(fact)) => fact,
            _ => f64::NAN,
        }
    }

    /// The numbers of a shape; `None` if it lacks them.
    pub(super) fn floats(&self, shape: &Shape) -> Option<Vec<f32>> {
        match self.value(shape)? {
            Value::Floats(values, _) => Some(values.into_owned()),
            _ => None,
        }
    }

    fn value<'a>(&self, shape: &'a Shape) -> Option<Value<'a>> {
        values(shape).into_iter().find(|(name, _)| *name == self.name).map(|(_, value)| value)
    }
}

/// The columns of the shapes of an index, in order of first appearance.
pub(super) fn columns(index: &Index) -> Result<Vec<Column>, IndexError> {
    let mut columns: Vec<Column> = Vec::new();
    index.each(|shape| {
        for (name, value) in values(&shape) {
            let kind = match value {
                Value::Text(text) => Kind::Text(text.chars().count()),
                Value::Fact(_) => Kind::Fact,
                Value::Floats(_, extents) => Kind::Floats(extents),
            };
            match columns.iter_mut().find(|known| known.name == name) {
                Some(known) => match (&mut known.kind, kind) {
                    (Kind::Text(most), Kind::Text(n)) => *most = (*most).max(n),
                    (Kind::Floats(most), Kind::Floats(extents)) => {
                        most.iter_mut().zip(extents).for_each(|(most, n)| *most = (*most).max(n));
                    }
                    _ => {}
                },
                None => columns.push(Column { name: name.into_owned(), kind }),
            }
        }
        Ok::<(), IndexError>(())
    })?;
    Ok(columns)
}
