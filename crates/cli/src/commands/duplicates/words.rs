//! Duplicates in words.

use canonform::relations::in_four_digits;
use canonform::{DuplicateFile, DuplicateGroup, DuplicateReport};

use crate::output::{count, decimal_bytes};

/// Size of the file, lengths of its box, and the day of its last change.
pub(super) fn facts(file: &DuplicateFile) -> String {
    let bytes = file.bytes.map(|bytes| decimal_bytes(bytes.into()));
    let size = file.size.map(|size| size.map(in_four_digits).join(" × "));
    let day = file.modified.and_then(|seconds| chrono::DateTime::from_timestamp(seconds as i64, 0));
    let day = day.map(|day| day.format("%Y-%m-%d").to_string());
    [bytes, size, day].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The answer, and a paragraph for each group.
pub(super) fn text(report: &DuplicateReport) -> String {
    let n_spare: usize = report.groups.iter().map(|group| group.members.len()).sum();
    let mut text = if report.groups.is_empty() {
        format!("no duplicates among {}\n", count(report.n_shapes, "shape"))
    } else {
        format!(
            "{} of {} can be spared: {} of files of one shape, {} without those to keep\n",
            n_spare,
            count(report.n_shapes, "shape"),
            count(report.groups.len(), "group"),
            decimal_bytes(report.spare_bytes().into())
        )
    };
    for DuplicateGroup { keeper, why, members } in &report.groups {
        text += &format!("\nkeep {} ({why}; {})\n", keeper.path.display(), facts(keeper));
        for member in members {
            let told = &member.relation;
            text += &format!("  {told} (confidence {:.2}; {})\n", told.confidence, facts(&member.file));
        }
    }
    if !report.unread.is_empty() {
        text += &format!(
            "\n{} could not be read, or changed since the index was built: {}\n",
            count(report.unread.len(), "file"),
            report.unread.join(", ")
        );
    }
    text.trim_end().to_owned()
}
