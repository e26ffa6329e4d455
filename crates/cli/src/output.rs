//! Output: JSON, tables, files and exit codes.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use canonform::mesh::io::{
    Content, Format, VertexField, extension, files_of, is_gzip, or_list, without_extension,
};
use canonform::mesh::{MeshError, TriMesh};
use report::color::{Rgb, color_scale};
use serde::Serialize;

use crate::args::Common;
use crate::input::is_stream;

/// Prints the result of a command: one JSON object with `--json`, else a table.
pub(crate) fn report<T: Serialize>(
    common: &Common,
    result: &T,
    table: impl FnOnce(&T) -> String,
) -> Result<ExitCode> {
    if common.json {
        print_json(result)?
    } else {
        print(&table(result))?
    }
    Ok(ExitCode::SUCCESS)
}

/// Success, or 2 if some inputs failed.
pub(crate) fn exit_code(all_done: bool) -> ExitCode {
    if all_done { ExitCode::SUCCESS } else { ExitCode::from(2) }
}

/// Bytes in powers of 1000, as disks are sold.
pub(crate) fn decimal_bytes(bytes: u128) -> String {
    let units = [(1_000_000_000_000, "TB"), (1_000_000_000, "GB"), (1_000_000, "MB")];
    let (unit, name) = units.into_iter().find(|(unit, _)| bytes >= *unit).unwrap_or((1_000, "kB"));
    format!("{:.1} {name}", bytes as f64 / unit as f64)
}

/// Prints one JSON object to standard output.
pub(crate) fn print_json(value: &impl Serialize) -> Result<()> {
    let text = serde_json::to_string(value)?;
    Ok(writeln!(io::stdout().lock(), "{}", base::printable_json(&text))?)
}

/// Prints text to standard output, without codes that a terminal would obey.
pub(crate) fn print(text: &str) -> Result<()> {
    Ok(writeln!(io::stdout().lock(), "{}", base::printable(text))?)
}

/// A name and a value.
pub(crate) type Fact = (&'static str, String);

/// What people read: the answer in one sentence, at most four facts, and the rest, which `--details` adds.
pub(crate) struct Answer {
    pub(crate) sentence: String,
    pub(crate) facts: Vec<Fact>,
    pub(crate) details: Vec<Fact>,
}

impl Answer {
    /// The answer as text.
    pub(crate) fn text(mut self, common: &Common) -> String {
        if common.details {
            self.facts.append(&mut self.details);
        }
        let sentence = base::one_line(&self.sentence);
        match self.facts.is_empty() {
            true => sentence.into_owned(),
            false => format!("{sentence}\n{}", facts(&self.facts)),
        }
    }
}

/// A file in a sentence, without codes that a terminal would obey.
pub(crate) fn shown(path: &Path) -> String {
    let name = path.to_string_lossy();
    if is_stream(path) { "standard output".to_owned() } else { base::one_line(&name).into_owned() }
}

/// The word for a value of an enum, as in JSON.
pub(crate) fn word(value: impl Serialize) -> String {
    serde_json::to_value(value).ok().and_then(|word| word.as_str().map(str::to_owned)).unwrap_or_default()
}

/// A number with a noun in the singular or in the plural.
pub(crate) fn count(n: usize, noun: &str) -> String {
    let plural = if noun.ends_with('s') { "es" } else { "s" };
    if n == 1 { format!("1 {noun}") } else { format!("{n} {noun}{plural}") }
}

/// A table of two columns: names and values.
pub(crate) fn facts(rows: &[(&str, String)]) -> String {
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let line = |(name, value): &(&str, String)| format!("  {name:<width$}  {}", base::one_line(value));
    rows.iter().map(line).collect::<Vec<_>>().join("\n")
}

/// An empty table without lines between its cells.
pub(crate) fn table_of(header: impl IntoIterator<Item = impl AsRef<str>>) -> comfy_table::Table {
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING).set_header(row_of(header));
    table
}

/// A row of a table, each cell on one line.
pub(crate) fn row_of(cells: impl IntoIterator<Item = impl AsRef<str>>) -> Vec<String> {
    cells.into_iter().map(|cell| base::one_line(cell.as_ref()).into_owned()).collect()
}

/// Where a command writes its result: a file, or standard output.
#[derive(Debug)]
pub(crate) struct Output {
    /// The file to write.
    pub(crate) path: PathBuf,
    /// The name in reports.
    pub(crate) name: PathBuf,
    /// The extension of the file.
    pub(crate) format: String,
    /// Holds the file until it is complete and goes to standard output.
    scratch: Option<base::files::Scratch>,
}

impl Output {
    /// Refuses an unsupported format and a folder that does not exist, before any work is done. Standard output gets
    /// `format`, or the first of `formats`.
    pub(crate) fn new(
        path: &Path,
        what: &str,
        formats: &[&str],
        format: Option<&str>,
        common: &Common,
    ) -> Result<Self> {
        let name = path.to_owned();
        if !is_stream(path) {
            let format = check_output(path, what, formats)?;
            return Ok(Self { path: name.clone(), name, format, scratch: None });
        }
        if common.json {
            bail!(
                "--json and `-` both write to standard output; write {what} to a file, or leave out --json"
            );
        }
        let format = format.or(formats.first().copied()).unwrap_or_default().to_owned();
        let scratch = base::files::Scratch::new()?;
        let path = scratch.file(&format!("stdout.{format}"));
        if check_format(&path, what, formats).is_err() {
            let formats = or_list(formats.iter().copied());
            bail!(
                "{what} cannot be written to standard output as {format}; pass --output-format with {formats}"
            );
        }
        Ok(Self { path, name, format, scratch: Some(scratch) })
    }

    /// Whether it is standard output.
    pub(crate) fn is_stream(&self) -> bool {
        self.scratch.is_some()
    }

    /// Prints the result of a command whose file is complete. If the file goes to standard output, the table goes to
    /// standard error.
    pub(crate) fn report<T: Serialize>(
        &self,
        common: &Common,
        result: &T,
        table: impl FnOnce(&T) -> String,
    ) -> Result<ExitCode> {
        if !self.is_stream() {
            return report(common, result, table);
        }
        self.copy_to_stdout()?;
        table(result).lines().for_each(base::terminal::note);
        Ok(ExitCode::SUCCESS)
    }

    /// Copies the complete file to standard output, if it goes there.
    pub(crate) fn copy_to_stdout(&self) -> Result<()> {
        if self.is_stream() {
            let mut out = io::stdout().lock();
            io::copy(&mut File::open(&self.path)?, &mut out)?;
            out.flush()?;
        }
        Ok(())
    }
}

/// The extension of a file name, which must be one of `formats`.
pub(crate) fn check_format(path: &Path, what: &str, formats: &[&str]) -> Result<String> {
    let format = extension(path);
    let is_mesh = |format: &str| Format::named(format).is_some_and(|format| format.can_write(Content::Mesh));
    if is_gzip(path) && !is_mesh(&format) {
        bail!("{}: {what} cannot be written compressed; leave out .gz", path.display());
    }
    if !formats.contains(&format.as_str()) {
        bail!("{}: unsupported format for {what}; use {}", path.display(), or_list(formats.iter().copied()));
    }
    Ok(format)
}

/// The extension of an output file, which must be one of `formats` if there are any. Refuses a folder, a file that would take the
/// place of an input, and one in a folder that does not exist, before any work is done.
pub(crate) fn check_output(path: &Path, what: &str, formats: &[&str]) -> Result<String> {
    let shown = path.display();
    if path.is_dir() {
        let name = path.join(["name", formats.first().unwrap_or(&"file")].join("."));
        bail!("cannot write {shown}: it is a folder; name a file for {what}, such as {}", name.display());
    }
    let format = if formats.is_empty() { extension(path) } else { check_format(path, what, formats)? };
    if files_of(path).iter().any(|file| base::files::is_input(file)) {
        bail!("{shown}: the result would overwrite an input; choose another name for it");
    }
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            bail!("cannot write {shown}: the folder {} does not exist; create it first", folder.display())
        }
        _ => Ok(format),
    }
}

/// The path of a further file: `map-mirrored.npy` beside `map.npy`.
pub(crate) fn beside(path: &Path, what: &str) -> PathBuf {
    let mut name = without_extension(path).into_os_string();
    name.push(format!("-{what}.{}", extension(path) + if is_gzip(path) { ".gz" } else { "" }));
    name.into()
}

/// Writes a mesh colored by one value per vertex.
pub(crate) fn write_colored(
    path: &Path,
    mesh: &TriMesh,
    name: &str,
    values: &[f64],
) -> Result<(), MeshError> {
    let colors: Vec<Rgb> = values.iter().copied().map(color_scale(values)).collect();
    canonform::mesh::io::write_scalar_field(path, mesh, &VertexField { name, values, colors: &colors })
}
