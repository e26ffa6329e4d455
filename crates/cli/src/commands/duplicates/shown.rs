//! Duplicates in words, and as a page with pictures.

use anyhow::Result;
use base::one_line;
use canonform::library::{DuplicateFile, DuplicateGroup, DuplicateReport, MoveReport};
use canonform::relations::in_four_digits;
use canonform::search::ShapeSearch;
use report::page::escape;
use report::render::{RenderOptions, render};

use crate::output::{count, decimal_bytes, shown};

const HEAD: &str = "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
<meta name=\"viewport\" content=\"width=device-width\">\n\
<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\">\n\
<title>Duplicates</title>\n<style>\n\
body { font: 16px/1.45 system-ui, sans-serif; margin: 2rem auto; max-width: 72rem; padding: 0 1rem; color: #222 }\n\
section { border-top: 1px solid #ddd; padding: 1rem 0; display: flex; flex-wrap: wrap; gap: 1rem }\n\
figure { margin: 0; width: 15rem } img { width: 15rem; height: 12rem }\n\
figcaption { overflow-wrap: anywhere } .keep { font-weight: 600 } small { color: #666; display: block }\n</style>\n";

/// The page: a row for each group, the file to keep first.
pub(super) fn page(report: &DuplicateReport, search: &ShapeSearch) -> Result<String> {
    let mut page =
        format!("{HEAD}<h1>Duplicates</h1>\n<p>{}</p>\n", escape(text(report).lines().next().unwrap_or("")));
    for group in &report.groups {
        page += "<section>\n";
        let keep = format!("<span class=\"keep\">keep {}</span>", escape(&shown(&group.keeper.path)));
        page += &card(&group.keeper, &keep, &group.why, search)?;
        for member in &group.members {
            let told = &member.relation;
            let words = format!("{}, confidence {:.2}", told, told.confidence);
            page += &card(&member.file, &escape(&shown(&member.file.path)), &words, search)?;
        }
        page += "</section>\n";
    }
    Ok(page)
}

fn card(file: &DuplicateFile, title: &str, words: &str, search: &ShapeSearch) -> Result<String> {
    let picture = match search.mesh(&file.id) {
        Ok(mesh) => {
            let options = RenderOptions { width: 480, height: 384, crease: 40.0, ..RenderOptions::default() };
            let address = render(&mesh, &options, &())?.to_data_url()?;
            format!("<img src=\"{address}\" alt=\"{}\">", escape(&one_line(&file.id)))
        }
        Err(_) => String::new(),
    };
    Ok(format!(
        "<figure>{picture}<figcaption>{title}<small>{}</small><small>{}</small></figcaption></figure>\n",
        escape(&one_line(words)),
        escape(&facts(file))
    ))
}

/// Size of the file, lengths of its box, the day of its last change, its other names, and whether and why it stays.
fn facts(file: &DuplicateFile) -> String {
    let bytes = file.bytes.map(|bytes| decimal_bytes(bytes.into()));
    let size = file.size.map(|size| size.map(in_four_digits).join(" × "));
    let day = file.modified.and_then(|seconds| chrono::DateTime::from_timestamp(seconds as i64, 0));
    let day = day.map(|day| day.format("%Y-%m-%d").to_string());
    let links = (!file.links.is_empty()).then(|| format!("also {}", one_line(&file.links.join(", "))));
    let stays = match file {
        DuplicateFile { reference: true, .. } => Some("reference".to_owned()),
        DuplicateFile { is_linked: true, .. } => Some("stays: a link or in an archive".to_owned()),
        _ => None,
    };
    [bytes, size, day, links, stays].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// The answer, and a paragraph for each group.
pub(super) fn text(report: &DuplicateReport) -> String {
    let (shapes, groups) = (count(report.n_shapes, "shape"), count(report.groups.len(), "group"));
    let mut text = match report.spare().count() {
        _ if report.groups.is_empty() => format!("no duplicates among {shapes}\n"),
        0 => format!("none of {shapes} can be spared: {groups} of files that are related\n"),
        n_spare => format!(
            "{n_spare} of {shapes} can be spared: {groups} of files of one shape, {} without those to keep\n",
            decimal_bytes(report.spare_bytes().into())
        ),
    };
    for DuplicateGroup { keeper, why, members } in &report.groups {
        text += &format!("\nkeep {} ({why}; {})\n", shown(&keeper.path), facts(keeper));
        for member in members {
            let told = &member.relation;
            let words = told.to_string();
            let words = one_line(&words);
            text += &format!("  {words} (confidence {:.2}; {})\n", told.confidence, facts(&member.file));
        }
    }
    if !report.unread.is_empty() {
        text += &format!(
            "\n{} could not be read, or changed since the index was built: {}\n",
            count(report.unread.len(), "file"),
            one_line(&report.unread.join(", "))
        );
    }
    text.trim_end().to_owned()
}

/// What was moved, and what was not.
pub(super) fn moved(moves: &MoveReport) -> String {
    let MoveReport { moved, not_moved, journal } = moves;
    let mut lines = vec![format!("{} moved", count(moved.len(), "file"))];
    lines.extend(moved.iter().map(|[from, to]| format!("  {} is now {}", shown(from), shown(to))));
    for stays in not_moved {
        let why = stays.why.to_string();
        lines.push(format!("  {}: not moved, since {}", shown(&stays.path), one_line(&why)));
    }
    if let Some(journal) = journal {
        lines.push(format!("canonform duplicates --undo {} puts them back", shown(journal)));
    }
    lines.join("\n")
}
