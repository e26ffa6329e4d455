//! Pages and their blocks of code.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// What a block of code is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// Commands, each behind `$ `, with their output.
    Console,
    /// Commands without their output.
    Script,
    /// Commands that are not run.
    Unrun,
    /// Anything else, such as a snippet in another language.
    Other,
}

/// A block of code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CodeBlock {
    /// The line of the page on which its text begins, counted from 1.
    pub line: usize,
    /// What it is.
    pub language: Language,
    /// Its lines.
    pub text: String,
}

/// A page of the guide.
#[derive(Debug, Clone)]
pub struct Chapter {
    /// Its file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
}

impl Chapter {
    /// Reads a page.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn read(path: &Path) -> io::Result<Self> {
        Ok(Self { path: path.to_owned(), text: fs::read_to_string(path)? })
    }

    /// Reads all pages in a folder and in the folders below, in the order of their names.
    ///
    /// # Errors
    /// If a folder or a file cannot be read.
    pub fn all(folder: &Path) -> io::Result<Vec<Self>> {
        let pattern = folder.join("**/*.md");
        let paths = glob::glob(&pattern.to_string_lossy()).map_err(io::Error::other)?;
        paths.map(|path| Self::read(&path.map_err(io::Error::other)?)).collect()
    }

    /// The blocks of code of the page. Only fences of three backquotes at the start of a line count.
    #[must_use]
    pub fn blocks(&self) -> Vec<CodeBlock> {
        let mut blocks = Vec::new();
        let mut open: Option<CodeBlock> = None;
        for (number, line) in self.text.lines().enumerate() {
            match (line.strip_prefix("```"), &mut open) {
                (Some(_), block @ Some(_)) => blocks.extend(block.take()),
                (Some(info), None) => {
                    let language = match info.trim() {
                        "console" => Language::Console,
                        "sh" => Language::Script,
                        "sh,norun" => Language::Unrun,
                        _ => Language::Other,
                    };
                    open = Some(CodeBlock { line: number + 2, language, text: String::new() });
                }
                (None, Some(block)) => block.text += &format!("{line}\n"),
                (None, None) => {}
            }
        }
        blocks
    }

    /// Whether a command of the page that a test runs calls this program.
    #[must_use]
    pub fn runs(&self, program: &str) -> bool {
        let blocks = self.blocks();
        let mut run = blocks.iter().filter(|b| matches!(b.language, Language::Console | Language::Script));
        run.any(|block| {
            let words = |line: &str| line.trim_start_matches("$ ").split_whitespace().next() == Some(program);
            block.text.lines().any(words)
        })
    }
}
