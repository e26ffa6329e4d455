//! The tables of an index, in the order in which they are stored.

use serde::{Deserialize, Serialize};

use crate::floats::Floats;
use crate::shape::ShapeKey;
use crate::store::{Changes, Table, View};
use crate::vectors::{CellsHeader, Links, Part, Trial};
use crate::{IndexError, Shape, ShapeEntry, ShapeVectors};

/// About the whole index, under the empty key.
pub(crate) static ABOUT: Table<str, About> = Table::new(0, "the head of the index");
/// Class -> number of its shapes.
pub(crate) static CLASSES: Table<str, u64> = Table::new(1, "a class");
/// Number of a part and zero -> centres of cells.
pub(crate) static CENTROIDS: Table<[u32; 2], Floats> = Table::new(2, "centres of the cells");
/// Cell and number of a part -> shapes of the cell.
pub(crate) static CELLS: Table<[u32; 2], Part> = Table::new(3, "a part of a cell");
/// Shapes that calibrate searches.
pub(crate) static TRIALS: Table<ShapeKey, Trial> = Table::new(4, "a trial");
/// The graph of nearest neighbours.
pub(crate) static GRAPH: Table<ShapeKey, Node> = Table::new(5, "a list of neighbours");
/// Shape -> its entry.
pub(crate) static ENTRIES: Table<str, ShapeEntry> = Table::new(6, "an entry");
/// Shape -> its fused vector.
pub(crate) static FUSED: Table<str, Floats> = Table::new(7, "a fused vector");
/// Shape -> its other vectors.
pub(crate) static BODIES: Table<str, StoredBody> = Table::new(8, "the vectors of a shape");

/// Where the tables begin that hold shapes. Those before follow from them.
pub(crate) const SHAPES: [u8; 1] = [6];

/// What holds for the whole index.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct About {
    pub(crate) options: String,
    pub(crate) cells: CellsHeader,
}

/// A shape in the graph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Node {
    pub(crate) id: String,
    pub(crate) links: Links,
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

/// The list of a shape; `None` if it is not in the graph.
pub(crate) fn node(view: View<'_>, key: ShapeKey) -> Result<Option<Node>, IndexError> {
    GRAPH.get(view, &key)?.map(|node| sound(view, key, node)).transpose()
}

/// The lists of all shapes.
pub(crate) fn nodes(view: View<'_>) -> impl Iterator<Item = Result<(ShapeKey, Node), IndexError>> + '_ {
    GRAPH.rows(view, &[]).map(move |row| {
        let (key, node) = row?;
        Ok((key, sound(view, key, node)?))
    })
}

fn sound(view: View<'_>, key: ShapeKey, node: Node) -> Result<Node, IndexError> {
    match node.links.are_sound(key) {
        true => Ok(node),
        false => Err(view.damaged(format!("the neighbours of `{}` contradict each other", node.id))),
    }
}
