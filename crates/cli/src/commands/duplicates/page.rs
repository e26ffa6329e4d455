//! Duplicates as a page with pictures.

use anyhow::Result;
use canonform::library::{DuplicateFile, DuplicateReport};
use canonform::search::ShapeSearch;
use report::page::escape;
use report::render::{RenderOptions, render};

use super::words::{facts, text};
use crate::output::shown;

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
            format!("<img src=\"{address}\" alt=\"{}\">", escape(&base::one_line(&file.id)))
        }
        Err(_) => String::new(),
    };
    Ok(format!(
        "<figure>{picture}<figcaption>{title}<small>{}</small><small>{}</small></figcaption></figure>\n",
        escape(&base::one_line(words)),
        escape(&facts(file))
    ))
}
