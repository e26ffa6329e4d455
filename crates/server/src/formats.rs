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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn placeholders_are_replaced_by_all_formats() {
        let page = crate::page::whole(include_str!("page/index.html"));
        let description = filled_in(include_str!("../openapi.json"));
        for text in [&page, &description] {
            assert!(text.contains(&mesh_files()) && !text.contains("{{"));
        }
        for extension in FORMATS.iter().flat_map(|format| format.extensions) {
            assert!(page.contains(&format!(".{extension},")) || page.contains(&format!(".{extension}\"")));
        }
    }
}
