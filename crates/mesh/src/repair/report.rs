//! What repair has done.

use serde::Serialize;

use surface::{Link, VertexId};

/// Every change that [`repair()`](crate::repair()) has made to a mesh.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct RepairReport {
    /// Vertices before.
    pub input_vertices: usize,
    /// Faces before.
    pub input_faces: usize,
    /// Vertices after.
    pub output_vertices: usize,
    /// Faces after.
    pub output_faces: usize,

    /// Faces removed because they named a vertex twice.
    pub degenerate_faces: usize,
    /// Faces removed because an earlier one has the same three vertices.
    pub duplicate_faces: usize,
    /// Faces removed because two of their corners were in one place.
    pub zero_length_faces: usize,
    /// Vertices merged into an earlier one in the same place, as welding was asked for.
    pub welded_vertices: usize,
    /// Vertices merged into an earlier one at the other end of an edge of length zero.
    pub collapsed_vertices: usize,
    /// Vertices dropped because no face that is left names them.
    pub unreferenced_vertices: usize,
    /// Faces turned over.
    pub flipped_faces: usize,

    /// Connected components found.
    pub components: usize,
    /// Components dropped.
    pub dropped_components: usize,
    /// Faces of the dropped components.
    pub dropped_component_faces: usize,
    /// Input vertices of the dropped components.
    pub dropped_component_vertices: usize,
    /// Area of the dropped components as a share of the whole, 0 to 1.
    pub dropped_area_share: f64,
    /// Links added between components, in input vertices; lengths in mesh units.
    pub bridges: Vec<Link>,
    /// Sum of their lengths, in mesh units.
    pub bridge_length: f64,

    /// The input vertices that are in no way part of the result, ascending: those without a row of
    /// coordinates in anything computed from it.
    pub dropped_vertices: Vec<VertexId>,
}

impl RepairReport {
    /// Whether nothing was changed.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.summary().is_empty()
    }

    /// One short line for each kind of change; none when nothing was changed.
    #[must_use]
    pub fn summary(&self) -> Vec<String> {
        let mut lines = Vec::new();
        let mut say = |count: usize, one: &str, many: &str| {
            if count > 0 {
                lines.push(counted(count, one, many));
            }
        };
        say(
            self.degenerate_faces,
            "face that named a vertex twice removed",
            "faces that named a vertex twice removed",
        );
        say(self.duplicate_faces, "duplicate face removed", "duplicate faces removed");
        say(
            self.welded_vertices,
            "vertex welded to another in the same place",
            "vertices welded to others in the same place",
        );
        say(
            self.collapsed_vertices,
            "vertex merged along an edge of length zero",
            "vertices merged along edges of length zero",
        );
        say(
            self.zero_length_faces,
            "face with two corners in one place removed",
            "faces with two corners in one place removed",
        );
        say(self.unreferenced_vertices, "vertex without a face dropped", "vertices without a face dropped");
        say(self.flipped_faces, "face turned over", "faces turned over");
        if self.dropped_components > 0 {
            lines.push(format!(
                "{} of {} components dropped, {} and {} with {:.2} % of the area; the largest is kept",
                self.dropped_components,
                self.components,
                counted(self.dropped_component_faces, "face", "faces"),
                counted(self.dropped_component_vertices, "vertex", "vertices"),
                100.0 * self.dropped_area_share
            ));
        }
        if !self.bridges.is_empty() {
            lines.push(format!(
                "{} components joined by {} of total length {:.6}",
                self.components,
                counted(self.bridges.len(), "link", "links"),
                self.bridge_length
            ));
        }
        lines
    }
}

/// "1 face" or "7 faces".
fn counted(count: usize, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
