//! The record of the surfaces of Figure 4, which the page shows in 3D.

use serde::{Deserialize, Serialize};

use super::common::Scale;
use super::figure4::Figure4Results;
use crate::error::ReportError;
use crate::viewer::Geometry;
use crate::viewer::base64::{optional_list, triples};

/// Name of the file in a folder of results.
pub const SHAPES_FILE: &str = "figure4-shapes.json";

/// The shapes of Figure 4 and their canonical forms, for the 3D views of the page.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ShapesRecord {
    /// The methods, in the order of [`ShownShape::forms`].
    pub methods: Vec<String>,
    /// The shapes, in the order of Figure 4.
    pub shapes: Vec<ShownShape>,
    /// The rigid motions that align forms, for each method and scale.
    pub motions: Vec<Motions>,
}

/// A shape and its forms, which share their faces.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ShownShape {
    /// Its name, for example `cat0`.
    pub name: String,
    /// Its class, for example `cat`.
    pub label: String,
    /// Vertices of the embedded surface; that below may be coarser.
    pub n_vertices: usize,
    /// The shape, in mesh units, with the geodesic distances from the first sample.
    pub surface: Geometry,
    /// Its form by each method.
    pub forms: Vec<ShownForm>,
}

/// A canonical form over the faces of its shape.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct ShownForm {
    /// Positions in units of the form around its centroid, rotated or reflected such that vertices are as close as
    /// possible to those of the shape.
    #[serde(with = "triples")]
    pub positions: Vec<[f32; 3]>,
    /// The length by which positions are divided if size is ignored.
    pub size: f64,
    /// For each vertex, the root mean square over the samples of the Euclidean distance in the form minus the geodesic
    /// distance, in mesh units; `None` if forms have no unit of length.
    #[serde(with = "optional_list", default, skip_serializing_if = "Option::is_none")]
    pub residual: Option<Vec<f32>>,
}

/// The rigid motions between the forms of one method at one scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Motions {
    /// Name of the method.
    pub method: String,
    /// Whether forms keep their size; if not, motions apply to the positions of [`ShownForm`] divided by the size.
    pub scale: Scale,
    /// Four triples for each pair `i < j` of shapes, row by row: the rows of a rotation or reflection and a
    /// translation, which map form `i` onto form `j`.
    #[serde(with = "triples")]
    pub motions: Vec<[f32; 3]>,
}

impl ShapesRecord {
    /// Whether these are the shapes of `figure4`, in its order.
    #[must_use]
    pub fn belongs_to(&self, figure4: &Figure4Results) -> bool {
        let own = self.shapes.iter().map(|shape| (&shape.name, &shape.label));
        own.eq(figure4.names.iter().zip(&figure4.labels))
    }

    /// Checks that lists agree in length.
    ///
    /// # Errors
    /// [`ReportError::Shape`], naming the part of the record.
    pub fn validate(&self) -> Result<(), ReportError> {
        let length = ReportError::check_length;
        for shape in &self.shapes {
            let n = shape.surface.positions.len();
            length(format!("the forms of {}", shape.name), shape.forms.len(), self.methods.len(), "method")?;
            if let Some(values) = &shape.surface.values {
                length(format!("the distances on {}", shape.name), values.len(), n, "vertex")?;
            }
            for form in &shape.forms {
                length(format!("a form of {}", shape.name), form.positions.len(), n, "vertex")?;
                let residual = form.residual.as_ref().map_or(n, Vec::len);
                length(format!("a residual of {}", shape.name), residual, n, "vertex")?;
            }
        }
        let pairs = self.shapes.len() * self.shapes.len().saturating_sub(1) / 2;
        for Motions { method, scale, motions } in &self.motions {
            let what = format!("the motions of {method} ({})", scale.name());
            length(what, motions.len(), 4 * pairs, "row of a motion")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{read, write};
    use crate::tests::fixtures::{figure4_record, shapes_record};

    #[test]
    fn the_record_reads_back_and_belongs_to_its_figure() {
        let record = shapes_record(&[("cat", 2), ("dog", 1)]);
        record.validate().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shapes.json");
        write(&record, &path).unwrap();
        assert_eq!(read::<ShapesRecord>(&path).unwrap(), record);
        assert!(record.belongs_to(&figure4_record(&[("cat", 2), ("dog", 1)]).results));
        assert!(!record.belongs_to(&figure4_record(&[("cat", 1), ("dog", 2)]).results));
        assert!(!record.belongs_to(&figure4_record(&[("cat", 2)]).results));
    }

    #[test]
    fn inconsistent_records_are_errors_that_name_the_part() {
        let good = shapes_record(&[("cat", 2), ("dog", 1)]);
        let broken = |change: &dyn Fn(&mut ShapesRecord)| {
            let mut record = good.clone();
            change(&mut record);
            record.validate().unwrap_err().to_string()
        };
        assert!(
            broken(&|r| r.methods.truncate(1)).starts_with("the forms of cat0 has 2 entries instead of 1")
        );
        assert!(broken(&|r| r.shapes[1].forms[0].positions.truncate(2)).contains("a form of cat1"));
        assert!(broken(&|r| r.shapes[1].forms[0].residual = Some(vec![])).contains("a residual of cat1"));
        assert!(broken(&|r| r.shapes[2].surface.values = Some(vec![])).contains("the distances on dog2"));
        assert!(broken(&|r| r.motions[1].motions.truncate(3)).contains("instead of 12"));
    }
}
