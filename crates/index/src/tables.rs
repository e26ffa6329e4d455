//! The tables of an index, in the order in which they are stored.

use retrieval::UnknownThreshold;
use serde::{Deserialize, Serialize};

use crate::floats::Floats;
use crate::store::{Changes, Table};
use crate::{IndexError, Shape, ShapeEntry, ShapeVectors};

/// About the whole index, under the empty key.
pub(crate) static ABOUT: Table<str, About> = Table::new(0, "the head of the index");
/// Class -> number of its shapes.
pub(crate) static CLASSES: Table<str, u64> = Table::new(1, "a class");
/// Shape -> its entry.
pub(crate) static ENTRIES: Table<str, ShapeEntry> = Table::new(2, "an entry");
/// Shape -> its fused vector.
pub(crate) static FUSED: Table<str, Floats> = Table::new(3, "a fused vector");
/// Shape -> its other vectors.
pub(crate) static BODIES: Table<str, StoredBody> = Table::new(4, "the vectors of a shape");

/// What holds for the whole index.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct About {
    pub(crate) options: String,
    /// Length of a fused vector; 0 if there are no shapes.
    pub(crate) dim: usize,
    /// Number of shapes.
    pub(crate) n: usize,
    /// See [`Index::threshold`](crate::Index::threshold).
    pub(crate) threshold: Option<UnknownThreshold>,
}

/// The vectors of a shape but the fused one.
#[derive(Serialize, Deserialize)]
pub(crate) struct StoredBody {
    form: Floats,
    disc_areas: Floats,
    components: Vec<Floats>,
    signatures: Vec<(String, Floats)>,
}

impl StoredBody {
    fn new(vectors: &ShapeVectors) -> Self {
        let floats = |numbers: &[f32]| Floats(numbers.to_vec());
        let signatures = vectors.signatures.iter();
        Self {
            form: floats(vectors.form.as_flattened()),
            disc_areas: floats(&vectors.disc_areas),
            components: vectors.components.iter().map(|fused| floats(fused)).collect(),
            signatures: signatures.map(|(name, values)| (name.clone(), floats(values))).collect(),
        }
    }

    pub(crate) fn with(self, fused: Vec<f32>) -> ShapeVectors {
        ShapeVectors {
            fused,
            form: self.form.0.as_chunks::<4>().0.to_vec(),
            disc_areas: self.disc_areas.0,
            components: self.components.into_iter().map(|fused| fused.0).collect(),
            signatures: self.signatures.into_iter().map(|(name, values)| (name, values.0)).collect(),
        }
    }
}

/// Puts a shape over the one of the same name.
pub(crate) fn put_shape(changes: &mut Changes, shape: &Shape) -> Result<(), IndexError> {
    ENTRIES.put(changes, &shape.id, Some(&shape.entry))?;
    FUSED.put(changes, &shape.id, Some(&Floats(shape.vectors.fused.clone())))?;
    BODIES.put(changes, &shape.id, Some(&StoredBody::new(&shape.vectors)))
}

pub(crate) fn remove_shape(changes: &mut Changes, id: &str) -> Result<(), IndexError> {
    ENTRIES.put(changes, id, None)?;
    FUSED.put(changes, id, None)?;
    BODIES.put(changes, id, None)
}
