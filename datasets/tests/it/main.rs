//! Laws of the generated shapes.

#[cfg(test)]
mod articulated;
#[cfg(test)]
mod creatures;

/// Whether a closed surface in one piece has no defects and is oriented consistently.
#[cfg(test)]
fn is_clean(report: &mesh::MeshReport) -> bool {
    report.genus.is_some()
        && report.volume.is_some()
        && [report.zero_area_faces, report.unreferenced_vertices, report.duplicate_vertices] == [0; 3]
}
