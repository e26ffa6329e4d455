//! The threshold of unknown classes of several indexes.

use retrieval::UnknownThreshold;

use crate::derived::all_shapes;
use crate::vectors::Trials;
use crate::{Index, IndexError};

/// The [threshold](crate::Found::threshold) of the index that would hold the shapes of all of these, which have different names
/// and were described with the same options. Holds the vectors of one index at a time in memory.
///
/// # Errors
/// [`IndexError::Io`], [`IndexError::Damaged`].
pub fn class_threshold(indexes: &[Index]) -> Result<Option<UnknownThreshold>, IndexError> {
    let trials = Trials::in_pieces(1, |visit| {
        for index in indexes {
            let (shapes, _) = all_shapes(index.view())?;
            if shapes.ids.len() > 0 {
                visit(shapes.in_cell(&0));
            }
        }
        Ok::<_, IndexError>(())
    })?;
    Ok(trials.threshold())
}
