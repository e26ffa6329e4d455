//! The graph of nearest neighbours, in a table of the index.
//!
//! A row for each shape holds its name and its links. An index of an earlier format has no such table.

use redb::TableDefinition;
use serde::{Deserialize, Serialize};

use super::IndexError;
use super::guard::Guarded;
use super::tables::{Snapshot, Store, Table};
use crate::vectors::{Links, NodeKey};

pub(super) const GRAPH: TableDefinition<'_, NodeKey, &[u8]> = TableDefinition::new("graph");

/// The property of the index that states the number of shapes in its graph.
pub(super) const N_NODES: &str = "graph";

/// A shape in the graph.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Node {
    pub(crate) id: String,
    pub(crate) links: Links,
}

/// The graph of an index.
pub(crate) struct Graph<'a> {
    store: &'a Store<'a>,
    /// `None` if the index is empty.
    table: Option<Guarded<Table<NodeKey>>>,
}

impl<'a> Graph<'a> {
    /// `None` if the index has no graph.
    pub(crate) fn open(snapshot: &Snapshot<'a>) -> Result<Option<Self>, IndexError> {
        match snapshot.about::<u64>(N_NODES)? {
            Some(_) => Ok(Some(Self { store: snapshot.store, table: snapshot.table(GRAPH)? })),
            None => Ok(None),
        }
    }

    /// A shape and its links; `None` if it is not in the graph.
    pub(crate) fn node(&self, key: NodeKey) -> Result<Option<Node>, IndexError> {
        let Some(table) = &self.table else { return Ok(None) };
        let bytes =
            self.store.call(|| Ok::<_, redb::Error>(table.get(key)?.map(|bytes| bytes.value().to_vec())))?;
        bytes.map(|bytes| self.decoded(key, &bytes)).transpose()
    }

    fn decoded(&self, key: NodeKey, bytes: &[u8]) -> Result<Node, IndexError> {
        let node: Node = self.store.decoded(bytes, "a list of neighbours")?;
        match node.links.are_sound(key) {
            true => Ok(node),
            false => {
                Err(self.store.damaged(format!("the neighbours of `{}` contradict each other", node.id)))
            }
        }
    }

    /// Calls `visit` with each shape, in ascending order of keys.
    pub(crate) fn each(
        &self,
        mut visit: impl FnMut(NodeKey, Node) -> Result<(), IndexError>,
    ) -> Result<(), IndexError> {
        let Some(table) = &self.table else { return Ok(()) };
        let rows = self.store.call(|| table.range(0..))?;
        self.store.each_row(rows, |key| key, |&key, bytes| visit(key, self.decoded(key, &bytes)?))
    }
}

/// Removes what formats 1 and 2 do not have.
#[cfg(test)]
pub(crate) fn drop_graph(store: &Store<'_>) -> Result<(), IndexError> {
    store.write(|transaction| {
        store.call(|| transaction.delete_table(GRAPH).map(drop))?;
        store.remove_property(transaction, N_NODES)
    })
}
