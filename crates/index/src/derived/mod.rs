//! What an index derives from its shapes: cells of near vectors, trials that calibrate searches, the graph of nearest
//! neighbours, and classes. A writer derives all of it anew (`train`), or follows a few changes (`change`).

mod cells;
mod change;
mod change_graph;
mod changed_cells;
mod train;

pub(crate) use cells::{Heads, about, all_shapes};
pub(crate) use change::changes;
pub(crate) use train::trained;
