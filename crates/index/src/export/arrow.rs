//! The schema of a table as Arrow states it, in the metadata of a Parquet file. Parquet has no lists of fixed length, and databases
//! of vectors (Lance, Polars) ask for them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::columns::{Column, Content};

/// The key of the metadata.
pub(super) const KEY: &str = "ARROW:schema";

/// The value of the metadata for these columns.
pub(super) fn schema(columns: &[Column]) -> String {
    use Value::{Number, Table, Tables};

    let fields = columns.iter().map(field).collect();
    // Message.fbs: version 5, whose header is a schema.
    let message = Table(vec![(0, Number(4)), (1, Number(1)), (2, Table(vec![(1, Tables(fields))]))]);
    let mut bytes = vec![0; 4];
    let at = message.write(&mut bytes);
    bytes[..4].copy_from_slice(&at.to_le_bytes());
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    let length = (bytes.len() as u32).to_le_bytes();
    STANDARD.encode([&[0xff; 4], &length, bytes.as_slice()].concat())
}

/// Field and Type of Schema.fbs. Only fused vectors are of one length in every index.
fn field(column: &Column) -> Value {
    use Value::{Number, Table, Tables, Text};

    let float = |precision| Table(vec![(0, Number(precision))]);
    let (number, about) = match &column.content {
        Content::Text(..) => (5, Table(Vec::new())),
        Content::Fact(_) => (3, float(2)),
        Content::Floats(extents) if column.name == "fused" && extents[0] > 0 => {
            (16, Table(vec![(0, Number(extents[0] as u32))]))
        }
        Content::Floats(_) => (12, Table(Vec::new())),
    };
    let element = || {
        let name = Text("element".to_owned());
        Table(vec![(0, name), (1, Number(0)), (2, Number(3)), (3, float(1)), (5, Tables(Vec::new()))])
    };
    let children = match column.content {
        Content::Text(..) | Content::Fact(_) => Vec::new(),
        Content::Floats(_) => vec![element()],
    };
    Table(vec![
        (0, Text(column.name.clone())),
        (1, Number(column.is_optional().into())),
        (2, Number(number)),
        (3, about),
        (5, Tables(children)),
    ])
}

/// What a FlatBuffer holds.
enum Value {
    /// Of one, two or four bytes: the first come first.
    Number(u32),
    Text(String),
    /// Fields by their numbers, ascending.
    Table(Vec<(usize, Value)>),
    Tables(Vec<Value>),
}

impl Value {
    /// Appends a text, table or list, and returns its place. A place holds four bytes, whatever it is for; references lead forward.
    fn write(&self, out: &mut Vec<u8>) -> u32 {
        out.resize(out.len().next_multiple_of(4), 0);
        let (places, at): (Vec<(usize, &Self)>, usize) = match self {
            Self::Number(_) => (Vec::new(), out.len()),
            Self::Text(text) => {
                let at = out.len();
                out.extend((text.len() as u32).to_le_bytes());
                out.extend(text.as_bytes());
                out.push(0);
                (Vec::new(), at)
            }
            Self::Tables(values) => {
                let at = out.len();
                out.extend((values.len() as u32).to_le_bytes());
                (values.iter().enumerate().map(|(i, value)| (at + 4 + 4 * i, value)).collect(), at)
            }
            Self::Table(fields) => {
                // Before a table is a list of where its fields are: its size, that of the table, and the place of each number.
                let n = fields.last().map_or(0, |(number, _)| number + 1);
                let mut places = vec![0; n];
                fields.iter().enumerate().for_each(|(i, (number, _))| places[*number] = 4 + 4 * i as u16);
                let (before, size) = (4 + 2 * n as u16, 4 + 4 * fields.len() as u16);
                out.extend([before, size].into_iter().chain(places).flat_map(u16::to_le_bytes));
                out.resize(out.len().next_multiple_of(4), 0);
                let at = out.len();
                let back = usize::from(before).next_multiple_of(4) as u32;
                out.extend(back.to_le_bytes());
                (fields.iter().enumerate().map(|(i, (_, value))| (at + 4 + 4 * i, value)).collect(), at)
            }
        };
        out.resize(out.len() + 4 * places.len(), 0);
        for (place, value) in places {
            let written = match value {
                Self::Number(x) => *x,
                _ => value.write(out) - place as u32,
            };
            out[place..place + 4].copy_from_slice(&written.to_le_bytes());
        }
        at as u32
    }
}
