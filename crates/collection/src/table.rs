//! Tables in text files, as spreadsheets and other programs write them.

use std::path::{Path, PathBuf};

use base::files::FileError;
use csv::{ReaderBuilder, StringRecord, Trim};

use crate::error::CollectionError;

/// What may stand between cells. The first one that all lines have is taken, so that a comma may be part of a number or a name.
const SEPARATORS: [u8; 3] = *b"\t;,";

/// Rows of cells, separated by tabs, semicolons or commas. A cell that holds one of these stands in quotation marks. Empty lines
/// and lines that begin with `#` are skipped, and a byte order mark is ignored.
///
/// ```
/// use std::path::Path;
///
/// use canonform_collection::TextTable;
///
/// let table = TextTable::parse("width;height\n1,5;2\n".into(), Path::new("sizes.csv"))?;
/// assert_eq!(table.numbers()?, (2, vec![1.5, 2.0], vec![2]));
/// # Ok::<(), canonform_collection::CollectionError>(())
/// ```
#[derive(Debug)]
pub struct TextTable {
    path: PathBuf,
    text: String,
    separator: u8,
}

/// A row of a [`TextTable`].
#[derive(Debug)]
pub struct Row<'a> {
    table: &'a TextTable,
    /// Its line in the file, counted from one.
    pub line: usize,
    text: &'a str,
    cells: StringRecord,
}

impl TextTable {
    /// # Errors
    /// [`CollectionError::File`], and those of [`parse`](Self::parse).
    pub fn read(path: &Path) -> Result<Self, CollectionError> {
        Self::parse(std::fs::read(path).map_err(|source| FileError::read(path, source))?, path)
    }

    /// The table in the content of a file; `path` names it in messages.
    ///
    /// # Errors
    /// [`CollectionError::BadLine`] if it is not UTF-8, or has no rows.
    pub fn parse(content: Vec<u8>, path: &Path) -> Result<Self, CollectionError> {
        let text = decode(content, path)?;
        let mut possible = SEPARATORS.to_vec();
        for (_, line) in lines(&text) {
            let found: Vec<u8> = possible.iter().copied().filter(|it| separates(line, *it)).collect();
            if !found.is_empty() {
                possible = found;
            }
            if possible.len() == 1 {
                break;
            }
        }
        // Without any, all is one column.
        let separator = if possible.len() == SEPARATORS.len() { b',' } else { possible[0] };
        let table = Self { path: path.to_owned(), text, separator };
        let is_empty = table.rows().next().is_none();
        if is_empty { Err(table.fault(1, "the table has no rows")) } else { Ok(table) }
    }

    /// All rows, also one of names.
    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        lines(&self.text).map(|(line, text)| {
            let mut reader = ReaderBuilder::new()
                .has_headers(false)
                .delimiter(self.separator)
                .trim(Trim::All)
                .from_reader(text.as_bytes());
            let mut cells = StringRecord::new();
            // One line of text is one record, whatever is in it.
            let _ = reader.read_record(&mut cells);
            Row { table: self, line, text, cells }
        })
    }

    /// The rows below one of names, if the first row is one.
    ///
    /// # Errors
    /// [`CollectionError::BadLine`] if there are names only.
    fn body(&self) -> Result<impl Iterator<Item = Row<'_>>, CollectionError> {
        let mut rows = self.rows().peekable();
        let names = rows.next_if(Row::is_names);
        match (names, rows.peek()) {
            (Some(names), None) => Err(names.fault("there are no rows below these names")),
            _ => Ok(rows),
        }
    }

    /// The number of columns, all numbers, row by row, and the line of each row. A row of names above them is left out; blanks
    /// separate numbers, too.
    ///
    /// # Errors
    /// [`CollectionError::BadLine`] if a cell is not a number or rows differ in length.
    pub fn numbers(&self) -> Result<(usize, Vec<f64>, Vec<usize>), CollectionError> {
        let (mut n_columns, mut numbers, mut lines) = (None, Vec::new(), Vec::new());
        for row in self.body()? {
            let before = numbers.len();
            let words = row.cells().flat_map(|cell| {
                cell.split([' ', '\t']).filter(move |word| !word.is_empty() || cell.is_empty())
            });
            for word in words {
                let number = row.number(word).ok_or_else(|| row.fault(format!("`{word}` is not a number")));
                numbers.push(number?);
            }
            let (found, expected) = (numbers.len() - before, *n_columns.get_or_insert(numbers.len()));
            if found != expected {
                let fault = format!("found {found} values instead of {expected}; give as many in every line");
                return Err(row.fault(fault));
            }
            lines.push(row.line);
        }
        Ok((n_columns.unwrap_or(1), numbers, lines))
    }

    /// The error that something is wrong in a line.
    pub fn fault(&self, line: usize, what: impl Into<String>) -> CollectionError {
        CollectionError::BadLine { path: self.path.clone(), line, what: what.into() }
    }
}

impl Row<'_> {
    /// The cells, without blanks around them.
    pub fn cells(&self) -> impl Iterator<Item = &str> {
        self.cells.iter()
    }

    /// The first cells as one, with what is between them; `None` if any is in quotation marks.
    pub fn before(&self, n_cells: usize) -> Option<&str> {
        let (separator, _) =
            self.text.match_indices(self.table.separator as char).nth(n_cells.checked_sub(1)?)?;
        (!self.text.contains('"')).then(|| self.text[..separator].trim())
    }

    /// The number of cells, at least one.
    pub fn n_cells(&self) -> usize {
        self.cells.len()
    }

    /// A cell as a number. It may have a decimal comma where semicolons separate cells.
    pub fn number(&self, cell: &str) -> Option<f64> {
        let point =
            || (self.table.separator == b';' && !cell.contains('.')).then(|| cell.replacen(',', ".", 1));
        cell.parse().ok().or_else(|| point()?.parse().ok())
    }

    /// Whether every word is a name, not a number.
    fn is_names(&self) -> bool {
        let is_name = |word: &str| word.starts_with(char::is_alphabetic) && word.parse::<f64>().is_err();
        self.cells().all(|cell| !cell.is_empty() && cell.split_whitespace().all(is_name))
    }

    /// The error that something is wrong with this row.
    pub fn fault(&self, what: impl Into<String>) -> CollectionError {
        self.table.fault(self.line, what)
    }
}

/// The lines that count, with their numbers.
pub(crate) fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let lines = text.lines().zip(1..).map(|(line, number)| (number, line.trim()));
    lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
}

/// Whether a line has a separator outside of quotation marks.
fn separates(line: &str, separator: u8) -> bool {
    line.split('"').step_by(2).any(|part| part.as_bytes().contains(&separator))
}

/// Text in UTF-8, which may have a byte order mark.
///
/// # Errors
/// [`CollectionError::BadLine`] if it is encoded otherwise.
pub(crate) fn decode(content: Vec<u8>, path: &Path) -> Result<String, CollectionError> {
    let bad = |line: usize, what: &str| CollectionError::BadLine {
        path: path.to_owned(),
        line,
        what: format!("{what}; save the file as UTF-8"),
    };
    if content.starts_with(b"\xff\xfe") || content.starts_with(b"\xfe\xff") || content.contains(&0) {
        return Err(bad(1, "the text is encoded as UTF-16, or is not text"));
    }
    let mut text = String::from_utf8(content).map_err(|fault| {
        let valid = &fault.as_bytes()[..fault.utf8_error().valid_up_to()];
        bad(1 + valid.iter().filter(|byte| **byte == b'\n').count(), "the line is not text in UTF-8")
    })?;
    if text.starts_with('\u{feff}') {
        text.drain(..'\u{feff}'.len_utf8());
    }
    // As old programs on Macintosh computers end lines.
    Ok(if text.contains('\n') { text } else { text.replace('\r', "\n") })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<TextTable, String> {
        TextTable::parse(text.into(), Path::new("t.csv")).map_err(|fault| fault.to_string())
    }

    fn cells(text: &str) -> Vec<(usize, Vec<String>)> {
        let table = table(text).unwrap();
        table.rows().map(|row| (row.line, row.cells().map(str::to_owned).collect())).collect()
    }

    #[test]
    fn every_spelling_of_a_table_has_the_same_cells() {
        let expected = [(1, vec!["cat0", "cat"]), (2, vec!["dog 1", "dog"])];
        let expected = expected.map(|(line, row)| (line, row.into_iter().map(str::to_owned).collect()));
        for text in [
            "cat0,cat\ndog 1,dog",
            "cat0;cat\r\ndog 1;dog\r\n",
            "cat0\tcat\rdog 1\tdog\r",
            "\u{feff}cat0, cat\n \"dog 1\",\"dog\"\n",
        ] {
            assert_eq!(cells(text), expected, "{text:?}");
        }
    }

    #[test]
    fn separators_may_stand_in_names_and_numbers() {
        let row = |line: usize, cells: [&str; 2]| (line, cells.map(str::to_owned).to_vec());
        assert_eq!(
            cells("# names\n\na;b,cat\n\"c,d\",dog\n"),
            [row(3, ["a;b", "cat"]), row(4, ["c,d", "dog"])]
        );
        assert_eq!(cells("\"a;b\";cat\n"), [row(1, ["a;b", "cat"])]);
        assert_eq!(cells("a \"big\" cat,cat"), [row(1, ["a \"big\" cat", "cat"])]);
        assert_eq!(
            table("x;y\n1,5;-2,25\n1e3;.5").unwrap().numbers().unwrap(),
            (2, vec![1.5, -2.25, 1e3, 0.5], vec![2, 3])
        );
        // A comma in a table of tabs may separate thousands.
        for text in ["1,234\t5", "1.234,5;6", "1,2,3;4", "1;1.#QNAN"] {
            let fault = table(text).unwrap().numbers().unwrap_err().to_string();
            assert!(fault.contains("t.csv, line 1: `1") && fault.contains("is not a number"), "{fault}");
        }
    }

    #[test]
    fn a_row_of_names_is_left_out_of_numbers() {
        for text in ["a,b\n1,2\n", "\u{feff}\"a\",\"b 2\"\n1,2", "1,2", "# a b\n1,2\n"] {
            let found = table(text).unwrap().numbers();
            match text.contains("b 2") {
                true => assert!(found.is_err(), "a row with a number has no names only"),
                false => assert_eq!(found.unwrap().1, [1.0, 2.0], "{text:?}"),
            }
        }
        assert_eq!(table("inf,nan\n1,2").unwrap().numbers().unwrap().1.len(), 4);
    }

    #[test]
    fn errors_name_the_line_and_the_encoding() {
        let utf16: Vec<u8> = "\u{feff}a,b".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let utf16be: Vec<u8> = "\u{feff}a,b".encode_utf16().flat_map(u16::to_be_bytes).collect();
        for content in [utf16.clone(), utf16[2..].to_vec(), utf16be] {
            let fault = TextTable::parse(content, Path::new("t.csv")).unwrap_err().to_string();
            assert!(fault.contains("UTF-16") && fault.ends_with("save the file as UTF-8"), "{fault}");
        }
        let fault = TextTable::parse(b"a,b\nc,\xe4".to_vec(), Path::new("t.csv")).unwrap_err().to_string();
        assert!(fault.contains("t.csv, line 2") && fault.contains("save the file as UTF-8"), "{fault}");
        for (text, what) in [
            ("\u{feff}# nothing\n\n", "line 1: the table has no rows"),
            ("\n\nx,y\n", "line 3: there are no rows below these names"),
            ("1,2\n\n3\n", "line 3: found 1 values instead of 2"),
            ("1,2\n3,x", "line 2: `x` is not a number"),
            ("1,2\n3,", "line 2: `` is not a number"),
        ] {
            let fault = table(text).and_then(|table| table.numbers().map_err(|fault| fault.to_string()));
            let fault = fault.unwrap_err();
            assert!(fault.contains(what), "{text:?}: {fault}");
        }
    }
}
