//! Whether pages are short, links between them lead somewhere, and the book contains every page.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::support::{files, workspace_root};

/// All Markdown files below a folder, sorted.
fn pages(folder: &Path) -> Vec<PathBuf> {
    let mut pages = files(folder, "md");
    pages.sort();
    pages
}

/// The lines of a page outside blocks of code, without code in between.
fn prose(text: &str) -> String {
    let mut is_code = false;
    let mut prose = String::new();
    for line in text.lines() {
        if line.starts_with("```") {
            is_code = !is_code;
        } else if !is_code {
            prose.extend(line.split('`').step_by(2));
            prose.push('\n');
        }
    }
    prose
}

/// The targets of the links of a page that do not lead out of the repository.
fn links(text: &str) -> Vec<String> {
    let prose = prose(text);
    let targets = prose.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    targets.filter(|target| !target.contains("://")).map(str::to_owned).collect()
}

/// The anchors of the headings of a page, as mdBook and GitHub name them.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut is_code = false;
    let mut anchors = BTreeSet::new();
    for line in text.lines() {
        is_code ^= line.starts_with("```");
        let heading = line.trim_start_matches('#');
        if is_code || heading.len() == line.len() || !heading.starts_with(' ') {
            continue;
        }
        let letters = heading.trim().to_lowercase();
        let letters = letters.chars().map(|c| if c.is_whitespace() { '-' } else { c });
        anchors.insert(letters.filter(|c| c.is_alphanumeric() || matches!(c, '-' | '_')).collect());
    }
    anchors
}

/// What is wrong with a link of a page.
fn fault(page: &Path, target: &str) -> Option<String> {
    let (file, anchor) = target.split_once('#').unwrap_or((target, ""));
    let path = if file.is_empty() { page.to_owned() } else { page.with_file_name("").join(file) };
    if !path.exists() {
        return Some("leads nowhere".to_owned());
    }
    let has_anchor = || anchors(&fs::read_to_string(&path).unwrap()).contains(anchor);
    (!anchor.is_empty() && !has_anchor()).then(|| "names a heading that does not exist".to_owned())
}

/// Every page of the repository.
fn all_pages(root: &Path) -> Vec<PathBuf> {
    let folders = ["docs", "crates", "datasets", "examples", "fuzz"].map(|folder| root.join(folder));
    let tops = fs::read_dir(root).unwrap().map(|entry| entry.unwrap().path());
    let tops = tops.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    folders.iter().filter(|folder| folder.is_dir()).flat_map(|folder| pages(folder)).chain(tops).collect()
}

#[test]
fn pages_are_short() {
    let root = workspace_root().canonicalize().unwrap();
    let words = |page: &Path| fs::read_to_string(page).unwrap().split_whitespace().count();
    let total: usize = all_pages(&root).iter().map(|page| words(page)).sum();
    assert!(total <= 25_000, "all pages have {total} words");
    assert!(words(&root.join("README.md")) < 700);
    assert!(words(&root.join("ARCHITECTURE.md")) <= 1000);
    let decisions = pages(&root.join("docs/decisions"));
    assert!(decisions.len() <= 27, "more than 26 decisions and their introduction");
    for page in decisions {
        assert!(words(&page) <= 250, "{} has {} words", page.display(), words(&page));
    }
}

#[test]
fn links_between_pages_lead_somewhere() {
    let root = workspace_root().canonicalize().unwrap();
    let (mut faults, mut n_links) = (Vec::new(), 0);
    for page in &all_pages(&root) {
        for link in links(&fs::read_to_string(page).unwrap()) {
            n_links += 1;
            let place = page.strip_prefix(&root).unwrap().display();
            faults.extend(fault(page, &link).map(|what| format!("{place}: the link to {link} {what}")));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(n_links >= 100, "only {n_links} links were found");
}

#[test]
fn the_book_contains_every_page_once() {
    let book = workspace_root().join("docs").canonicalize().unwrap();
    let summary = fs::read_to_string(book.join("SUMMARY.md")).unwrap();
    let mut listed: Vec<PathBuf> = links(&summary).iter().map(|link| book.join(link)).collect();
    listed.push(book.join("SUMMARY.md"));
    listed.sort();
    assert_eq!(listed, pages(&book), "docs/SUMMARY.md lists every page once");
}
