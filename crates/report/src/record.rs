//! What all records have in common, and the files made of them.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::figure::Figure;
use crate::results::{Expectation, Provenance, write};
use crate::{ReportError, Table};

/// The result of one experiment, with the figures and tables that show it.
pub trait Record: Serialize + DeserializeOwned {
    /// How the record was made, what was expected of it, and what it shows, in paragraphs of plain text separated by
    /// empty lines.
    fn about(&self) -> (&Provenance, &[Expectation], &str);

    /// Checks that there is something to draw, that lists agree in length and that numbers are finite.
    ///
    /// # Errors
    /// [`ReportError::Empty`], [`ReportError::Shape`] or [`ReportError::NotFinite`], which name the part of the record.
    fn validate(&self) -> Result<(), ReportError> {
        Ok(())
    }

    /// The figures of a valid record.
    fn figures(&self) -> Vec<Figure>;

    /// The tables of a valid record.
    fn tables(&self) -> Vec<Table>;

    /// The table that a run prints.
    fn summary(&self) -> Option<Table> {
        self.tables().into_iter().next()
    }
}

/// Writes the static figures of a record and `NAME.json` into a folder.
///
/// # Errors
/// Those of [`Record::validate`] and [`write`](crate::results::write), [`ReportError::View`].
pub fn save(record: &impl Record, folder: &Path, name: &str) -> Result<(), ReportError> {
    record.validate()?;
    for figure in record.figures() {
        figure.save(&folder.join(name))?;
    }
    write(record, folder.join(format!("{name}.json")))
}
