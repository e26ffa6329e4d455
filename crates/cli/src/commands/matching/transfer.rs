//! Values and labels that a map carries from one mesh to another.

use std::path::Path;

use anyhow::{Result, bail};
use base::files::write_atomically;
use base::object;
use canonform::collection::TextTable;
use canonform::descriptors::Side;
use canonform::linalg::Matrix;
use canonform::maps::{Mapping, SurfaceMap};
use canonform::mesh::io::extension;
use serde::Serialize;

use super::files::MappedFile;
use crate::args::VALUE_FORMATS;
use crate::output::{check_format, word};
use crate::table::{Numbers, Table, write_csv, write_matrix, write_npy};

/// The elements of a mesh that have rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Elements {
    Vertices,
    Faces,
    Corners,
}

/// What is carried.
#[derive(Debug, Clone, PartialEq)]
enum Content {
    /// Functions, as columns.
    Values(Matrix),
    /// One word or whole number for each element; `None` for what the repair dropped.
    Labels(Vec<Option<String>>),
}

/// Rows of a file.
pub(super) struct Transfer {
    elements: Elements,
    content: Content,
}

/// Reads one row for each vertex, each face or each corner of the faces of a mesh. Refuses what cannot be carried, or not be
/// written to `output`.
pub(super) fn read_transfer(path: &Path, side: &MappedFile, output: &Path) -> Result<Transfer> {
    let content = match check_format(path, "values", &VALUE_FORMATS)?.as_str() {
        "npy" => of_table(Table::read(path, "values", &VALUE_FORMATS)?),
        _ => of_text(&TextTable::read(path)?)?,
    };
    let n = match &content {
        Content::Values(values) => values.nrows(),
        Content::Labels(labels) => labels.len(),
    };
    let [n_vertices, n_faces] = [side.mesh.n_vertices(), side.mesh.n_faces()];
    let elements = match n {
        _ if n == n_vertices => Elements::Vertices,
        _ if n == n_faces => Elements::Faces,
        _ if n == 3 * n_faces => Elements::Corners,
        _ => bail!(
            "{}: {n} rows, but the first mesh has {n_vertices} vertices and {n_faces} faces; give one row for each \
             vertex, for each face or for each of the {} corners of its faces",
            path.display(),
            3 * n_faces
        ),
    };
    if let Content::Labels(labels) = &content {
        if elements == Elements::Corners {
            bail!(
                "{}: labels belong to vertices or faces; write the values of corners with fractions",
                path.display()
            );
        }
        let is_word = |label: &String| label.parse::<i64>().is_err();
        if extension(output) == "npy" && labels.iter().flatten().any(is_word) {
            bail!("{}: words cannot be written to .npy; use .csv", output.display());
        }
    }
    Ok(Transfer { elements, content })
}

fn of_table(table: Table) -> Content {
    let n_columns = table.n_columns;
    let is_column = |numbers: usize| [1, numbers].contains(&n_columns);
    match table.numbers {
        Numbers::Whole(numbers) if is_column(numbers.len()) => {
            Content::Labels(numbers.iter().map(|number| Some(number.to_string())).collect())
        }
        _ => {
            let numbers = table.into_reals();
            let n_columns = if is_column(numbers.len()) { 1 } else { n_columns };
            Content::Values(Matrix::from_row_slice(numbers.len() / n_columns.max(1), n_columns, &numbers))
        }
    }
}

/// Words and whole numbers in one column are labels.
fn of_text(table: &TextTable) -> Result<Content> {
    let is_label = |word: &str| word.parse::<i64>().is_ok() || word.parse::<f64>().is_err();
    if table.rows().all(|row| row.n_cells() == 1 && row.cells().all(is_label)) {
        return Ok(Content::Labels(table.rows().map(|row| row.cells().next().map(str::to_owned)).collect()));
    }
    Table::of_text(table).map(of_table)
}

impl Transfer {
    /// Writes what a map carries to the second mesh. What was written, and the same in words.
    pub(super) fn write(
        &self,
        path: &Path,
        map: &SurfaceMap,
        sides: [&MappedFile; 2],
    ) -> Result<(impl Serialize + use<>, String)> {
        let mapping = Mapping::new(map, sides.map(|side| &side.mapped));
        let elements = self.elements;
        let found = match &self.content {
            Content::Labels(labels) => {
                let found = match elements {
                    Elements::Vertices => mapping.vertices(Side::Second).vertex_labels(labels),
                    // Corners have no labels.
                    _ => mapping.faces(Side::Second).face_labels(labels),
                };
                Content::Labels(found.into_iter().map(Option::flatten).collect())
            }
            Content::Values(values) => Content::Values(match elements {
                Elements::Vertices => mapping.vertices(Side::Second).values(values),
                Elements::Faces => {
                    let rows: Vec<usize> = (0..values.nrows()).collect();
                    let rows = mapping.faces(Side::Second).face_labels(&rows);
                    let value = |i: usize, j: usize| rows[i].map_or(f64::NAN, |row| values[(row, j)]);
                    Matrix::from_fn(rows.len(), values.ncols(), value)
                }
                Elements::Corners => match mapping.corners(Side::Second, values) {
                    Some(corners) => corners.corner_values(values),
                    None => bail!(
                        "{}: values of corners are not carried between a part and a whole; give them by vertex",
                        path.display()
                    ),
                },
            }),
        };
        found.write(path)?;
        let (kind, rows, columns) = match &found {
            Content::Values(values) => ("values", values.nrows(), values.ncols()),
            Content::Labels(labels) => ("labels", labels.len(), 1),
        };
        let of = if elements == Elements::Corners { "corners of faces" } else { &word(elements) };
        let words = format!("{kind} of {rows} {of}, in {}", path.display());
        Ok((object! { path: path.to_owned(), elements, kind, rows, columns }, words))
    }
}

impl Content {
    fn write(&self, path: &Path) -> Result<()> {
        match (self, extension(path) == "npy") {
            (Self::Values(values), true) => write_matrix(path, values),
            (Self::Values(values), false) => {
                write_csv(path, values.row_iter().map(|row| row.iter().copied().collect::<Vec<_>>()))
            }
            (Self::Labels(labels), true) => {
                let number = |label: &Option<String>| label.as_ref().map_or(Ok(-1), |label| label.parse());
                let numbers = labels.iter().map(number).collect::<Result<Vec<i64>, _>>()?;
                write_npy(path, &[numbers.len()], numbers)
            }
            (Self::Labels(labels), false) => Ok(write_atomically(path, |out| {
                labels.iter().try_for_each(|label| writeln!(out, "{}", label.as_deref().unwrap_or("-1")))
            })?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn content(text: &str) -> Result<Content> {
        of_text(&TextTable::parse(text.into(), Path::new("rows.csv"))?)
    }

    #[test]
    fn words_and_whole_numbers_are_labels() {
        let labels =
            |words: &[&str]| Content::Labels(words.iter().map(|word| Some((*word).to_owned())).collect());
        assert_eq!(content("ear\nleg\n\near\n").unwrap(), labels(&["ear", "leg", "ear"]));
        assert_eq!(content("3\n1\n").unwrap(), labels(&["3", "1"]));
        assert_eq!(content("3\n1.5\n").unwrap(), Content::Values(Matrix::from_row_slice(2, 1, &[3.0, 1.5])));
        assert_eq!(
            content("0,1\n1,0\n").unwrap(),
            Content::Values(Matrix::from_row_slice(2, 2, &[0.0, 1.0, 1.0, 0.0]))
        );
        for (text, what) in
            [("1.5\near", "line 2: `ear`"), ("1,2\n3", "line 2: found 1"), ("a,b\nc,d", "line 2: `c`")]
        {
            assert!(content(text).unwrap_err().to_string().contains(what), "{text}");
        }
    }
}
