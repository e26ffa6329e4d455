//! Values and labels that a map carries from one mesh to another.

use std::fmt;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use canonform::collection::TextTable;
use canonform::descriptors::Side;
use canonform::linalg::Matrix;
use canonform::maps::VertexMap;
use report::color::{Rgb, class_color, color_scale, perceptual};
use serde::Serialize;

use super::files::{MappedFile, picture, write_colored, write_whole};
use crate::field::{Numbers, read_array};
use crate::output::{check_format, write_npy};

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
    /// One word or whole number for each element.
    Labels(Vec<String>),
}

/// Rows of a file.
pub(super) struct Transfer {
    elements: Elements,
    content: Content,
}

/// What was carried.
#[derive(Serialize)]
pub(super) struct Transferred {
    path: PathBuf,
    elements: Elements,
    /// `values`, which are interpolated, or `labels`.
    kind: &'static str,
    /// Rows written, one for each vertex, face or corner of the second mesh.
    rows: usize,
    /// Columns of them.
    columns: usize,
}

impl fmt::Display for Transferred {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let elements = match self.elements {
            Elements::Vertices => "vertices",
            Elements::Faces => "faces",
            Elements::Corners => "corners of faces",
        };
        write!(f, "{} of {} {elements}, in {}", self.kind, self.rows, self.path.display())
    }
}

/// Reads one row for each vertex, each face or each corner of the faces of a mesh.
pub(super) fn read_transfer(path: &Path, side: &MappedFile) -> Result<Transfer> {
    let content = match check_format(path, "values", &["npy", "csv"])?.as_str() {
        "npy" => of_array(path)?,
        _ => of_table(&TextTable::read(path)?)?,
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
    Ok(Transfer { elements, content })
}

fn of_array(path: &Path) -> Result<Content> {
    let (n_columns, numbers) = read_array(path)?;
    // An array of one dimension, or one row as `canonform geodesic` writes it, is a column.
    let n_columns = if n_columns == numbers.len() { 1 } else { n_columns };
    let n_rows = numbers.len().checked_div(n_columns).unwrap_or(0);
    Ok(match numbers {
        Numbers::Whole(numbers) if n_columns == 1 => {
            Content::Labels(numbers.iter().map(i64::to_string).collect())
        }
        numbers => Content::Values(Matrix::from_row_slice(n_rows, n_columns, &numbers.reals())),
    })
}

fn of_table(table: &TextTable) -> Result<Content> {
    let is_label = |word: &str| word.parse::<i64>().is_ok() || word.parse::<f64>().is_err();
    if table.rows().all(|row| row.n_cells() == 1 && row.cells().all(is_label)) {
        return Ok(Content::Labels(
            table.rows().flat_map(|row| row.cells().map(str::to_owned).collect::<Vec<_>>()).collect(),
        ));
    }
    let (n_columns, values) = table.numbers()?;
    let n_rows = values.len() / n_columns.max(1);
    let (n_rows, n_columns) = if n_rows == 1 { (n_columns, 1) } else { (n_rows, n_columns) };
    Ok(Content::Values(Matrix::from_row_slice(n_rows, n_columns, &values)))
}

impl Transfer {
    /// Writes what a map carries to the second mesh.
    pub(super) fn write(&self, path: &Path, map: &VertexMap, sides: [&MappedFile; 2]) -> Result<Transferred> {
        let mapping = map.between(sides.map(|side| &side.mapped));
        let found = match (&self.elements, &self.content) {
            (Elements::Vertices, Content::Values(values)) => {
                Carried::Values(mapping.vertices(Side::Second).values(values))
            }
            (Elements::Vertices, Content::Labels(labels)) => {
                Carried::Labels(mapping.vertices(Side::Second).vertex_labels(labels))
            }
            (Elements::Faces, Content::Labels(labels)) => {
                Carried::Labels(mapping.faces(Side::Second).face_labels(labels))
            }
            (Elements::Corners, Content::Values(values)) => {
                let Some(corners) = mapping.corners(Side::Second, values) else {
                    bail!(
                        "{}: values of corners are not carried between a part and a whole; give them by vertex",
                        path.display()
                    )
                };
                Carried::Values(corners.corner_values(values))
            }
            (Elements::Corners, Content::Labels(_)) => bail!(
                "{}: labels belong to vertices or faces; write the values of corners with fractions",
                path.display()
            ),
            (Elements::Faces, Content::Values(values)) => {
                let rows: Vec<usize> = (0..values.nrows()).collect();
                let rows = mapping.faces(Side::Second).face_labels(&rows);
                Carried::Values(Matrix::from_fn(rows.len(), values.ncols(), |i, j| {
                    rows[i].map_or(f64::NAN, |row| values[(row, j)])
                }))
            }
        };
        match check_format(path, "values", &["npy", "csv", "ply", "png"])?.as_str() {
            "csv" => found.write_csv(path)?,
            "npy" => found.write_npy(path)?,
            format => self.draw(path, format, &found, sides)?,
        }
        let (kind, rows, columns) = match &found {
            Carried::Values(values) => ("values", values.nrows(), values.ncols()),
            Carried::Labels(labels) => ("labels", labels.len(), 1),
        };
        Ok(Transferred { path: path.to_owned(), elements: self.elements, kind, rows, columns })
    }

    /// Writes the second mesh, or a picture of both, coloured by what was carried.
    fn draw(&self, path: &Path, format: &str, found: &Carried, sides: [&MappedFile; 2]) -> Result<()> {
        let (own, values, colors) = match (self.elements, &self.content, found) {
            (Elements::Vertices, Content::Values(own), Carried::Values(values)) if own.ncols() == 1 => {
                let color = color_scale(own.as_slice());
                let own = own.iter().map(|value| color(*value)).collect();
                let colors: Vec<Rgb> = values.iter().map(|value| color(*value)).collect();
                (own, values.as_slice().to_vec(), colors)
            }
            (Elements::Vertices, Content::Labels(own), Carried::Labels(labels)) => {
                let mut names: Vec<&String> = own.iter().collect();
                names.sort_unstable();
                names.dedup();
                let class = |label: &String| names.binary_search(&label).unwrap_or_default();
                let colors = labels.iter();
                let colors = colors.map(|label| {
                    label.as_ref().map_or(perceptual(f64::NAN), |label| class_color(class(label)))
                });
                let own = own.iter().map(|label| class_color(class(label))).collect();
                let numbers = labels.iter();
                let numbers = numbers.map(|label| label.as_ref().map_or(-1.0, |label| class(label) as f64));
                (own, numbers.collect(), colors.collect())
            }
            _ => bail!(
                "{}: colours show one value or label for each vertex; write rows of faces and corners, and several columns, to .npy or .csv",
                path.display()
            ),
        };
        let meshes = sides.map(|side| &side.mesh);
        match format {
            "ply" => write_colored(path, meshes[1], "transfer", &values, &colors),
            _ => picture(path, meshes, [own, colors]),
        }
    }
}

/// What arrived on the second mesh.
enum Carried {
    Values(Matrix),
    /// `None` for what the repair dropped.
    Labels(Vec<Option<String>>),
}

impl Carried {
    fn write_csv(&self, path: &Path) -> Result<()> {
        Ok(base::files::write_atomically(path, |out| match self {
            Self::Values(values) => values.row_iter().try_for_each(|row| {
                let row: Vec<String> = row.iter().map(f64::to_string).collect();
                writeln!(out, "{}", row.join(","))
            }),
            Self::Labels(labels) => {
                labels.iter().try_for_each(|label| writeln!(out, "{}", label.as_deref().unwrap_or("-1")))
            }
        })?)
    }

    fn write_npy(&self, path: &Path) -> Result<()> {
        match self {
            Self::Values(values) => {
                let transposed = values.transpose();
                write_npy(path, values.ncols(), transposed.as_slice().chunks_exact(values.ncols().max(1)))
            }
            Self::Labels(labels) => {
                let number = |label: &Option<String>| label.as_ref().map_or(Ok(-1), |label| label.parse());
                let numbers: Result<Vec<i64>, _> = labels.iter().map(number).collect();
                let numbers = numbers.with_context(|| {
                    format!("{}: words cannot be written to .npy; use .csv", path.display())
                })?;
                write_whole(path, &numbers)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_text(text: &str) -> Result<Content> {
        of_table(&TextTable::parse(text.into(), Path::new("rows.csv"))?)
    }

    #[test]
    fn words_and_whole_numbers_are_labels() {
        let labels = |words: &[&str]| Content::Labels(words.iter().map(|word| (*word).to_owned()).collect());
        assert_eq!(of_text("ear\nleg\n\near\n").unwrap(), labels(&["ear", "leg", "ear"]));
        assert_eq!(of_text("3\n1\n").unwrap(), labels(&["3", "1"]));
        assert_eq!(of_text("3\n1.5\n").unwrap(), Content::Values(Matrix::from_row_slice(2, 1, &[3.0, 1.5])));
        assert_eq!(
            of_text("0,1\n1,0\n").unwrap(),
            Content::Values(Matrix::from_row_slice(2, 2, &[0.0, 1.0, 1.0, 0.0]))
        );
        for (text, what) in
            [("1.5\near", "line 2: `ear`"), ("1,2\n3", "line 2: found 1"), ("a,b\nc,d", "line 2: `c`")]
        {
            assert!(of_text(text).unwrap_err().to_string().contains(what), "{text}");
        }
    }
}
