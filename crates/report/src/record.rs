//! What the results of all experiments have in common, and the files made of them.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::ReportError;
use crate::figure::Figure;
use crate::results::{Record, write};
use crate::table::Table;

/// The results of one experiment, with the figures and tables that show them.
pub trait Results: Serialize + DeserializeOwned {
    /// Checks that there is something to draw, that lists agree in length and that numbers are finite.
    ///
    /// # Errors
    /// [`ReportError::Empty`], [`ReportError::Shape`] or [`ReportError::NotFinite`], which name the part of the record.
    fn validate(&self) -> Result<(), ReportError> {
        Ok(())
    }

    /// The figures of valid results.
    fn figures(&self) -> Vec<Figure>;

    /// The tables of valid results.
    fn tables(&self) -> Vec<Table>;

    /// The table that a run prints.
    fn summary(&self) -> Option<Table> {
        self.tables().into_iter().next()
    }
}

/// Writes the static figures of a record and `NAME.json` into a folder.
///
/// # Errors
/// Those of [`Results::validate`] and [`write`](crate::results::write), [`ReportError::Draw`].
pub fn save(record: &Record<impl Results>, folder: &Path, name: &str) -> Result<(), ReportError> {
    record.results.validate()?;
    for figure in record.results.figures() {
        figure.save(&folder.join(name))?;
    }
    write(record, folder.join(format!("{name}.json")))
}
