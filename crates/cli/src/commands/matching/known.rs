//! Landmarks and initial maps from files.

use std::path::Path;

use anyhow::{Context, Result, bail};
use canonform::Surface;
use canonform::maps::KnownMap;
use canonform::surface::VertexId;

use crate::args::MatchArgs;
use crate::table::{Table, read_pairs, vertex};

/// What the options say of the map between two surfaces.
pub(super) fn read(args: &MatchArgs, surfaces: [&Surface; 2]) -> Result<KnownMap> {
    let exist = |pair: [VertexId; 2]| {
        for ((vertex, surface), name) in pair.iter().zip(surfaces).zip(["first", "second"]) {
            surface.repaired_vertex(*vertex).with_context(|| format!("in the {name} mesh"))?;
        }
        Ok(())
    };
    let landmarks = args.landmarks.as_deref().map(|path| read_pairs(path, exist)).transpose()?;
    let initial = args.initial.as_deref().map(|path| {
        let table = Table::read(path, "a map", &["npy", "csv"])?;
        initial(table, path, surfaces[0].n_input_vertices())
    });
    Ok(KnownMap {
        landmarks: landmarks.unwrap_or_default(),
        initial: initial.transpose()?.unwrap_or_default(),
        functions: None,
    })
}

/// Rows of a map as it is written, a vertex and its partner, or only the partner in every row.
fn initial(table: Table, path: &Path, n_vertices: usize) -> Result<Vec<Option<VertexId>>> {
    let mut found = vec![None; n_vertices];
    table.rows(path, |next, row| {
        let (at, image) = match *row {
            [at, image, ..] => (vertex(at)?.index(), image),
            [image] => (next, image),
            [] => return Ok(()),
        };
        let Some(place) = found.get_mut(at) else {
            bail!("vertex {at} does not exist; the first mesh has {n_vertices} vertices")
        };
        *place = match image {
            -1.0 => None,
            _ => Some(vertex(image).context("write -1 where there is no partner")?),
        };
        Ok(())
    })?;
    Ok(found)
}

#[cfg(test)]
mod tests {
    use canonform::collection::TextTable;

    use super::*;

    fn of_text(text: &str, n_vertices: usize) -> Result<Vec<Option<VertexId>>> {
        let path = Path::new("map.csv");
        initial(Table::of_text(&TextTable::parse(text.into(), path)?)?, path, n_vertices)
    }

    #[test]
    fn maps_are_read_as_they_are_written() {
        let expected = [Some(VertexId(4)), None, Some(VertexId(0))];
        for text in ["vertex,match,confidence\n0,4,0.9\n1,-1,0\n2,0,1\n", "2,0\n0,4", "4\n-1\n0\n"] {
            assert_eq!(of_text(text, 3).unwrap(), expected, "{text}");
        }
        for (text, what) in [("0,1\n7,2", "line 2: vertex 7"), ("0,1.5", "line 1"), ("-2", "line 1")] {
            assert!(format!("{:#}", of_text(text, 3).unwrap_err()).contains(what), "{text}");
        }
    }
}
