//! The report of a repair.

use serde::Serialize;

use surface::{Link, VertexId};

use crate::points::PointsReport;

/// All changes that [`repair()`](crate::repair()) made to a mesh.
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

    /// How points were joined by faces; `None` if the input has faces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<PointsReport>,

    /// Faces removed because of a repeated vertex.
    pub degenerate_faces: usize,
    /// Faces removed because an earlier one has the same three vertices.
    pub duplicate_faces: usize,
    /// Faces removed because two of their corners were in the same position.
    pub zero_length_faces: usize,
    /// Vertices merged by welding into an earlier one in the same position.
    pub welded_vertices: usize,
    /// Vertices merged by welding into another nearby, the lowest of them, whose position they take.
    pub near_welded_vertices: usize,
    /// The widest gap that welding closed, in mesh units.
    pub weld_gap: f64,
    /// The tolerance that allowed it, in mesh units.
    pub weld_tolerance: f64,
    /// Vertices merged into an earlier one at the other end of an edge of length zero.
    pub collapsed_vertices: usize,
    /// Vertices on an edge of a face beside them, which was split there.
    pub t_junctions: usize,
    /// Vertices dropped because no remaining face uses them.
    pub unreferenced_vertices: usize,
    /// Faces flipped.
    pub flipped_faces: usize,

    /// The spacing of numbers at the farthest coordinate, relative to the mean side of the faces: far from the origin,
    /// sides are known to this accuracy only.
    pub coordinate_rounding: f64,
    /// Whether that is the spacing of numbers of 32 bits, as STL, GLB and many PLY files store, to which all coordinates
    /// were rounded.
    #[serde(skip)]
    pub is_single: bool,

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
    /// Sum of the lengths of all bridges, in mesh units.
    pub bridge_length: f64,

    /// The input vertices that are not part of the result, ascending. Nothing computed from the result has
    /// coordinates for them.
    pub dropped_vertices: Vec<VertexId>,
}

/// Rounding of coordinates that is worth a note: far more than that of a mesh at the origin, in 64 and in 32 bits.
const COARSE: [f64; 2] = [1e-9, 1e-3];

impl RepairReport {
    /// One short line per kind of change; empty if nothing was changed.
    pub fn summary(&self) -> Vec<String> {
        const FACES: [&str; 2] = ["face", "faces"];
        const VERTICES: [&str; 2] = ["vertex", "vertices"];
        let counts = [
            (self.degenerate_faces, FACES, "with a repeated vertex removed"),
            (self.duplicate_faces, ["duplicate face", "duplicate faces"], "removed"),
            (self.welded_vertices, VERTICES, "merged with another in the same position"),
            (self.collapsed_vertices, VERTICES, "merged across an edge of length zero"),
            (self.zero_length_faces, FACES, "with two corners in the same position removed"),
            (self.t_junctions, VERTICES, "on an edge joined to its face (T-junctions)"),
            (self.unreferenced_vertices, VERTICES, "without a face dropped"),
            (self.flipped_faces, FACES, "flipped"),
        ];
        let mut lines: Vec<String> = self.points.iter().map(PointsReport::summary).collect();
        let counts = counts
            .into_iter()
            .filter(|(count, ..)| *count > 0)
            .map(|(count, noun, what)| format!("{} {what}", counted(count, noun)));
        lines.extend(counts);
        if self.near_welded_vertices > 0 {
            lines.push(format!(
                "{} merged with another across a gap of up to {:.3e} (tolerance {:.3e})",
                counted(self.near_welded_vertices, VERTICES),
                self.weld_gap,
                self.weld_tolerance
            ));
        }
        lines.extend(self.uncertainty());
        if self.dropped_components > 0 {
            lines.push(format!(
                "{} of {} components dropped, {} and {} with {:.2} % of the area; the largest is kept",
                self.dropped_components,
                self.components,
                counted(self.dropped_component_faces, FACES),
                counted(self.dropped_component_vertices, VERTICES),
                100.0 * self.dropped_area_share
            ));
        }
        if !self.bridges.is_empty() {
            lines.push(format!(
                "{} components joined by {} of total length {:.6}",
                self.components,
                counted(self.bridges.len(), ["link", "links"]),
                self.bridge_length
            ));
        }
        lines
    }

    /// The line of the [summary](Self::summary) that says how well coordinates tell edges, if that is badly. It is no change.
    pub fn uncertainty(&self) -> Option<String> {
        let rounding = self.coordinate_rounding;
        let [place, remedy] = match self.is_single {
            false => ["the mesh is so far from the origin", ""],
            true => ["its coordinates have 32 bits and are so far from the origin", ", or with 64 bits"],
        };
        (rounding > COARSE[usize::from(self.is_single)]).then(|| {
            format!(
                "{place} that its edges are only known to {rounding:.0e} of their length; \
                 export it closer to the origin{remedy}"
            )
        })
    }
}

/// "1 face" or "7 faces".
fn counted(count: usize, [one, many]: [&str; 2]) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
