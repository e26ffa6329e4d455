//! A number per vertex, and a colour when it is written.

use mesh::MeshError;

/// A scalar field on the vertices of a mesh, with the colours to show it in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VertexField<'a> {
    /// Name of the property in the file: letters, digits and `_`, beginning with a letter.
    pub name: &'a str,
    /// One value per vertex; NaN and infinities are allowed.
    pub values: &'a [f64],
    /// One colour per vertex: red, green, blue.
    pub colors: &'a [[u8; 3]],
}

/// The field that is written with a mesh, if there is one.
pub(super) type WrittenField<'a> = Option<&'a VertexField<'a>>;

/// A scalar field read from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ScalarField {
    /// Its name in the file.
    pub name: String,
    /// One value per vertex, in the order of the file; NaN and infinities are allowed.
    pub values: Vec<f64>,
}

impl VertexField<'_> {
    /// Refuses a field that does not fit the mesh or whose name a file cannot carry.
    pub(super) fn check(&self, n_vertices: usize) -> Result<(), MeshError> {
        for values in [self.values.len(), self.colors.len()] {
            if values != n_vertices {
                return Err(MeshError::Unusable(format!(
                    "{values} values for {n_vertices} vertices; provide exactly one value and one colour per vertex"
                )));
            }
        }
        let is_word = self.name.starts_with(|c: char| c.is_ascii_alphabetic())
            && self.name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        if !is_word || ["x", "y", "z", "red", "green", "blue"].contains(&self.name) {
            return Err(MeshError::Unusable(format!(
                "`{}` is not a valid name of a PLY property; use letters, digits and `_`, begin with a letter, \
                 and avoid x y z red green blue",
                self.name
            )));
        }
        Ok(())
    }
}
