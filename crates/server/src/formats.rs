//! Texts with lists of the mesh formats.

use canonform::mesh::io::{FORMATS, mesh_files};

/// Replaces `{{mesh files}}` by a phrase and `{{mesh extensions}}` by a comma-separated list.
pub(crate) fn filled_in(text: &str) -> String {
    let extensions: Vec<String> = FORMATS
        .iter()
        .flat_map(|format| format.extensions)
        .map(|extension| format!(".{extension}"))
        .collect();
    text.replace("{{mesh files}}", &mesh_files()).replace("{{mesh extensions}}", &extensions.join(","))
}
