//! A script that moves duplicates away. It is for people to read and run; the program itself moves nothing.

use canonform::{DuplicateReport, RelationKind};

/// The script. Only copies of a file or of its geometry are moved; other lines are comments, to be checked before.
pub(super) fn script(report: &DuplicateReport) -> String {
    let mut text = "#!/bin/sh\n# Moves files that hold the shape of another file into the folder `duplicates`. Read it first; \
                    lines that begin\n# with `#` are not proved to be the same vertices.\nset -eu\nmkdir -p duplicates\n"
        .to_owned();
    for group in &report.groups {
        text += &format!("\n# keep {}: {}\n", one_line(&group.keeper.path.display().to_string()), group.why);
        for member in &group.members {
            let is_proved = member.relation.kind <= RelationKind::IdenticalGeometry;
            let mark = if is_proved { "" } else { "# " };
            text += &format!("# {}\n", one_line(&member.relation.to_string()));
            text +=
                &format!("{mark}mv -n -- {} duplicates/\n", quoted(&member.file.path.display().to_string()));
        }
    }
    text
}

/// Between single quotes, a shell takes every character as it is.
fn quoted(path: &str) -> String {
    format!("'{}'", path.replace('\'', r"'\''"))
}

/// A name with a line break must not leave its comment.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_ends_its_quotes_or_its_comment() {
        assert_eq!(quoted("it's $(rm)"), r"'it'\''s $(rm)'");
        assert_eq!(one_line("a\nrm b"), "a rm b");
    }
}
