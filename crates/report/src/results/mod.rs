//! Records of experiment runs: everything a figure, a table or the page shows, as JSON.
//!
//! A record is written once by the run and read as often as it is drawn. It carries what made it
//! ([`Provenance`]), what was expected of it ([`Expectation`]) and a few words on what it means.

mod curves;
mod figure3;
mod figure9;
mod retrieval;
mod shapes;

use std::collections::BTreeMap;
use std::path::Path;

pub use self::retrieval::{Classification, RetrievalRecord, RetrievalRow};
pub use curves::{Axis, AxisScale, CurvesPanel, CurvesRecord, Mark, Series, SeriesPoint};
pub use figure3::{Figure3Form, Figure3Record, Figure3Shape, Figure3Stress};
pub use figure9::{Figure9Measured, Figure9Record, Figure9Row};
pub use shapes::{Motions, SHAPES_FILE, SeenForm, SeenShape, ShapesRecord};

use ::retrieval::Evaluation;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::ReportError;
use files::{FileError, write_bytes};

/// What made a record.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Provenance {
    /// Name of the program.
    pub program: String,
    /// Its version.
    pub version: String,
    /// The command line that repeats the run.
    pub command: String,
    /// Where the shapes came from: a folder, or the name of a built-in dataset.
    pub dataset: String,
    /// The classes that took part, in the order they were asked for.
    pub classes: Vec<String>,
    /// Seed of everything random.
    pub seed: u64,
    /// Every option of every stage, as the program saw it.
    pub options: serde_json::Value,
    /// Wall-clock seconds by stage.
    pub seconds: BTreeMap<String, f64>,
}

/// A number that was expected, and what came out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Expectation {
    /// What was measured, for example `NMDS, raw: first tier`.
    pub what: String,
    /// What was expected, for example `at least 0.99`.
    pub expected: String,
    /// What came out, for example `0.994`.
    pub measured: String,
    /// Whether the measured value is as expected.
    pub held: bool,
}

/// The record of Figure 1: shapes and their canonical forms.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure1Record {
    /// What made it.
    pub provenance: Provenance,
    /// One entry for each shape that was embedded.
    pub shapes: Vec<Figure1Shape>,
    /// What was expected.
    pub expectations: Vec<Expectation>,
    /// What the figure shows, in paragraphs of plain text separated by empty lines.
    pub analysis: String,
}

/// One shape of Figure 1.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure1Shape {
    /// Its name, for example `cat0`.
    pub name: String,
    /// Its class, for example `cat`.
    pub label: String,
    /// Vertices of the surface that was embedded.
    pub n_vertices: usize,
    /// Faces of the surface that was embedded.
    pub n_faces: usize,
    /// The paper's stress of the canonical form (Frobenius norm over the number of points), in squared
    /// mesh units.
    pub stress: f64,
    /// What was repaired in the input, one sentence each.
    pub repair: Vec<String>,
}

/// The record of Figure 4: distances between canonical forms, and their maps.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Figure4Record {
    /// What made it.
    pub provenance: Provenance,
    /// Names of the `n` shapes, the order of all rows below.
    pub names: Vec<String>,
    /// Their classes.
    pub labels: Vec<String>,
    /// One entry for each method and scale.
    pub panels: Vec<Figure4Panel>,
    /// What was expected.
    pub expectations: Vec<Expectation>,
    /// What the figure shows, in paragraphs of plain text separated by empty lines.
    pub analysis: String,
}

/// One method at one scale in Figure 4.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure4Panel {
    /// Name of the method, for example `NMDS`.
    pub method: String,
    /// Whether forms kept their size.
    pub scale: Scale,
    /// Distances between the forms, n x n, in units of the forms.
    pub matrix: Vec<Vec<f64>>,
    /// The two-dimensional embedding of `matrix`, n points, in the same units.
    pub map: Vec<[f64; 2]>,
    /// Normalised stress of the map; 0 is a map without distortion.
    pub map_stress: f64,
    /// Share of the spectrum of the doubly centred matrix that is negative, in 0..=1: how far the
    /// distances are from those of points in any Euclidean space.
    pub negative_mass: f64,
    /// Retrieval scores of `matrix`.
    pub scores: Evaluation,
    /// Mean silhouette of the classes on the map, in -1..=1.
    pub map_silhouette: f64,
}

/// Whether forms kept their size before they were compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// As embedded.
    Raw,
    /// Every form scaled to the same size.
    Normalized,
}

impl Scale {
    /// The word used in file names and in JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Normalized => "normalized",
        }
    }

    /// The unit of distances at this scale.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Raw => "form units",
            Self::Normalized => "form size = 1",
        }
    }
}

impl Figure4Record {
    /// Checks that every list has as many entries as there are shapes and that every number is finite.
    ///
    /// # Errors
    /// [`ReportError::Shape`] or [`ReportError::NotFinite`], naming the part of the record.
    pub fn validate(&self) -> Result<(), ReportError> {
        let n = self.names.len();
        let shape = |what: String, found: usize| match found == n {
            true => Ok(()),
            false => Err(ReportError::Shape { what, found, expected: n, unit: "shape" }),
        };
        let finite = |what: &dyn Fn() -> String, value: f64| match value.is_finite() {
            true => Ok(()),
            false => Err(ReportError::NotFinite { what: what(), value }),
        };
        shape("labels".into(), self.labels.len())?;
        for panel in &self.panels {
            let of = |part: &str| format!("{part} of {} ({})", panel.method, panel.scale.name());
            shape(of("matrix"), panel.matrix.len())?;
            shape(of("map"), panel.map.len())?;
            for (row, values) in panel.matrix.iter().enumerate() {
                shape(of(&format!("matrix row {row}")), values.len())?;
                for (column, &value) in values.iter().enumerate() {
                    finite(&|| of(&format!("matrix entry {row}, {column}")), value)?;
                }
            }
            for (point, coords) in panel.map.iter().enumerate() {
                coords.iter().try_for_each(|&value| finite(&|| of(&format!("map point {point}")), value))?;
            }
            let s = &panel.scores;
            for (name, value) in [
                ("map_stress", panel.map_stress),
                ("negative_mass", panel.negative_mass),
                ("map_silhouette", panel.map_silhouette),
                ("nn", s.mean.nn),
                ("ft", s.mean.ft),
                ("st", s.mean.st),
                ("e", s.mean.e),
                ("dcg", s.mean.dcg),
                ("map", s.mean.map),
                ("knn_accuracy", s.knn_accuracy),
                ("silhouette", s.silhouette),
            ] {
                finite(&|| of(name), value)?;
            }
        }
        Ok(())
    }

    /// The panels of one scale, in the record's order.
    pub fn panels_at(&self, scale: Scale) -> impl Iterator<Item = &Figure4Panel> {
        self.panels.iter().filter(move |p| p.scale == scale)
    }
}

/// Writes a record as indented JSON, whole or not at all.
///
/// # Errors
/// [`ReportError::File`] when the file cannot be written or the record holds what JSON cannot.
pub fn write<T: Serialize>(record: &T, path: impl AsRef<Path>) -> Result<(), ReportError> {
    let path = path.as_ref();
    let mut json = serde_json::to_vec_pretty(record).map_err(|e| FileError::write(path, e.into()))?;
    json.push(b'\n');
    Ok(write_bytes(path, &json)?)
}

/// Reads a record back.
///
/// # Errors
/// [`ReportError::File`] when the file cannot be read, [`ReportError::Parse`] when it is not such a
/// record.
pub fn read<T: DeserializeOwned>(path: impl AsRef<Path>) -> Result<T, ReportError> {
    let path = path.as_ref();
    let bytes = std::fs::read(path).map_err(|source| FileError::read(path, source))?;
    serde_json::from_slice(&bytes).map_err(|source| ReportError::Parse { path: path.to_path_buf(), source })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{figure1_record, figure4_record};

    #[test]
    fn records_read_back_as_they_were_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        let one = figure1_record();
        write(&one, &path).unwrap();
        assert_eq!(read::<Figure1Record>(&path).unwrap(), one);
        let mut four = figure4_record(&[("cat", 3), ("dog", 2)]);
        four.panels[0].matrix[0][1] = 0.1 + 0.2;
        four.panels[0].map[0] = [f64::MIN_POSITIVE, -1.0 / 3.0];
        write(&four, &path).unwrap();
        assert_eq!(read::<Figure4Record>(&path).unwrap(), four, "to the last bit");
        let json: serde_json::Value = read(&path).unwrap();
        assert_eq!(json["panels"][0]["scale"], "raw");
        assert_eq!(json["panels"][2]["scale"], "normalized");
        assert_eq!(json["labels"].as_array().map(Vec::len), Some(5));
        assert_eq!(json["panels"][0]["matrix"][4].as_array().map(Vec::len), Some(5));
    }

    #[test]
    fn reading_names_what_is_wrong() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("absent.json");
        let error = read::<Figure1Record>(&path).unwrap_err();
        assert!(matches!(error, ReportError::File(_)) && error.to_string().contains("absent.json"));
        std::fs::write(&path, "[1, 2]").unwrap();
        assert!(matches!(read::<Figure1Record>(&path), Err(ReportError::Parse { .. })));
    }

    #[test]
    fn a_record_that_contradicts_itself_is_told_so() {
        let good = figure4_record(&[("cat", 3), ("dog", 2)]);
        good.validate().unwrap();
        let broken = |change: &dyn Fn(&mut Figure4Record)| {
            let mut record = good.clone();
            change(&mut record);
            record.validate().unwrap_err().to_string()
        };
        assert!(broken(&|r| r.labels.truncate(4)).starts_with("labels has 4 entries where 5"));
        assert!(broken(&|r| r.panels[1].map.truncate(2)).contains("map of KPCA-Nyström (raw) has 2"));
        assert!(
            broken(&|r| r.panels[2].matrix[3].truncate(1))
                .contains("matrix row 3 of NMDS (normalized) has 1")
        );
        assert!(
            broken(&|r| r.panels[0].matrix[1][2] = f64::NAN)
                .contains("matrix entry 1, 2 of NMDS (raw) is NaN")
        );
        assert!(broken(&|r| r.panels[0].map[4][0] = f64::INFINITY).contains("map point 4"));
        assert!(broken(&|r| r.panels[0].scores.silhouette = f64::NAN).contains("silhouette of NMDS"));
    }
}
