//! Records on disk.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::common::RunProvenance;
use crate::error::ReportError;
use base::files::{FileError, write_bytes};

/// Writes a record as indented JSON, completely or not at all.
///
/// # Errors
/// [`ReportError::File`] if the file cannot be written or the record holds what JSON cannot.
pub fn write<T: Serialize>(record: &T, path: impl AsRef<Path>) -> Result<(), ReportError> {
    let path = path.as_ref();
    let mut json = serde_json::to_vec_pretty(record).map_err(|e| FileError::write(path, e.into()))?;
    json.push(b'\n');
    Ok(write_bytes(path, &json)?)
}

/// Reads a record.
///
/// # Errors
/// [`ReportError::File`] if the file cannot be read, [`ReportError::Parse`] if it is not such a record.
pub fn read<T: DeserializeOwned>(path: impl AsRef<Path>) -> Result<T, ReportError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| FileError::read(path, source))?;
    serde_json::from_slice(&bytes).map_err(|source| ReportError::Parse { path: path.to_path_buf(), source })
}

/// Reads how a record was made.
///
/// # Errors
/// As [`read`].
pub fn provenance(path: impl AsRef<Path>) -> Result<RunProvenance, ReportError> {
    #[derive(serde::Deserialize)]
    struct Made {
        provenance: RunProvenance,
    }
    Ok(read::<Made>(path)?.provenance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{Figure1Results, Figure4Results, Record};
    use crate::tests::fixtures::{figure1_record, figure4_record};

    #[test]
    fn records_read_back_to_the_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        let one = figure1_record();
        write(&one, &path).unwrap();
        assert_eq!(read::<Record<Figure1Results>>(&path).unwrap(), one);
        let mut four = figure4_record(&[("cat", 3), ("dog", 2)]);
        four.results.panels[0].matrix[0][1] = 0.1 + 0.2;
        four.results.panels[0].map[0] = [f64::MIN_POSITIVE, -1.0 / 3.0];
        write(&four, &path).unwrap();
        assert_eq!(read::<Record<Figure4Results>>(&path).unwrap(), four);
        let json: serde_json::Value = read(&path).unwrap();
        assert_eq!(json["panels"][0]["scale"], "raw");
        assert_eq!(json["panels"][2]["scale"], "normalized");
        assert_eq!(json["labels"].as_array().map(Vec::len), Some(5));
        assert_eq!(json["panels"][0]["matrix"][4].as_array().map(Vec::len), Some(5));
    }

    #[test]
    fn errors_of_reading_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("absent.json");
        let error = read::<Record<Figure1Results>>(&path).unwrap_err();
        assert!(matches!(error, ReportError::File(_)) && error.to_string().contains("absent.json"));
        std::fs::write(&path, "[1, 2]").unwrap();
        assert!(matches!(read::<Record<Figure1Results>>(&path), Err(ReportError::Parse { .. })));
    }
}
