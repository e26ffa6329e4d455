//! Parquet files with one mesh a row: the bytes of a file, and columns for its name, class and format.

use std::fs::File;
use std::panic::{AssertUnwindSafe, catch_unwind};

use mesh::Fault;
use mesh_io::Format;
use parquet::basic::Type as Physical;
use parquet::column::reader::{ColumnReader, get_typed_column_reader};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, Int32Type, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use parquet::schema::types::SchemaDescriptor;

use super::archive::{Archive, Data, Member, Spool};

/// Rows that are decoded at once.
const BATCH: usize = 16;

/// Names of columns; the first that a file has is taken.
const BYTES: [&str; 4] = ["bytes", "data", "content", "mesh"];
const IDS: [&str; 4] = ["id", "name", "path", "file_name"];
const LABELS: [&str; 2] = ["label", "class"];
const FORMATS: [&str; 2] = ["format", "extension"];

pub(super) fn open(file: File) -> Result<Archive, Fault> {
    // The library has assertions about what a file states; those that are known are checked before.
    catch_unwind(AssertUnwindSafe(|| read(file)))
        .unwrap_or_else(|_| Err(Fault::syntax("an intact Parquet file", "data that contradicts itself")))
}

fn read(file: File) -> Result<Archive, Fault> {
    let size = file.metadata().map_or(0, |about| about.len());
    if size == 0 {
        return Err(Fault::Empty);
    }
    let reader = SerializedFileReader::new(file).map_err(damaged)?;
    let (contents, others) = columns(reader.metadata().file_metadata().schema_descr())?;
    let mut spool = Spool::new(size, u64::MAX)?;
    let mut rows: Vec<(String, Member)> = Vec::new();
    for group in 0..reader.num_row_groups() {
        let group = reader.get_row_group(group).map_err(damaged)?;
        let texts = |i: usize| others[i].map_or(Ok(Vec::new()), |column| texts(&*group, column));
        let [ids, labels, formats] = [texts(0)?, texts(1)?, texts(2)?];
        let text = |texts: &[Option<String>], row: usize| texts.get(row).cloned().flatten();
        let mut numbers = 0..;
        each(&*group, contents, |value| {
            let (Some(row), Some(bytes)) = (numbers.next(), value) else { return Ok(()) };
            let id = text(&ids, row).unwrap_or_else(|| format!("row{}", rows.len()));
            let name = named(id, text(&formats, row).as_deref(), rows.len())?;
            let at = spool.append(bytes)?;
            let label = text(&labels, row).unwrap_or_default();
            rows.push((name, Member { size: bytes.len() as u64, label, at }));
            Ok(())
        })?;
    }
    let mut archive = Archive::of(Data::Plain(spool.finish()?));
    for (name, member) in rows {
        if archive.member(&name).is_some() {
            return Err(Fault::syntax("a different id in every row", name));
        }
        archive.add(&name, member);
    }
    Ok(archive)
}

/// The name of a row as a file: its id, with the format as its extension.
fn named(id: String, format: Option<&str>, row: usize) -> Result<String, Fault> {
    let Some(stated) = format else {
        return match Format::of(id.as_ref()) {
            Ok(_) => Ok(id),
            Err(_) => {
                let expected = "a column `format`, or ids with the extension of a mesh";
                Err(Fault::syntax(expected, format!("{id} in row {row}")))
            }
        };
    };
    let extension = stated.trim_start_matches('.');
    if Format::named(extension.trim_end_matches(".gz")).is_none() {
        let expected = "the extension of a mesh, such as ply, in the column `format`";
        return Err(Fault::syntax(expected, format!("{stated} in row {row}")));
    }
    Ok(if mesh_io::extension(id.as_ref()) == extension { id } else { format!("{id}.{extension}") })
}

/// The number of the column of bytes, and those of ids, labels and formats if there are such columns.
fn columns(schema: &SchemaDescriptor) -> Result<(usize, [Option<usize>; 3]), Fault> {
    // The last part of the name, so that `mesh.bytes` of a struct is found too.
    let find = |names: &[&str], is_right: &dyn Fn(Physical) -> bool| {
        names.iter().find_map(|name| {
            (0..schema.num_columns()).find(|&column| {
                let about = schema.column(column);
                let last = about.path().parts().last().is_some_and(|part| part == name);
                last && about.max_rep_level() == 0 && is_right(about.physical_type())
            })
        })
    };
    let is_bytes = |kind| kind == Physical::BYTE_ARRAY;
    let is_text = |kind| matches!(kind, Physical::BYTE_ARRAY | Physical::INT32 | Physical::INT64);
    let bytes = find(&BYTES, &is_bytes).ok_or_else(|| {
        let names: Vec<&str> = schema.columns().iter().map(|column| column.name()).collect();
        Fault::syntax(
            "a column `bytes` with the contents of mesh files, beside `id`, `label` and `format`",
            names.join(", "),
        )
    })?;
    let [id, label] = [&IDS[..], &LABELS].map(|names| find(names, &is_text));
    Ok((bytes, [id, label, find(&FORMATS, &is_bytes)]))
}

/// The values of a column as text.
fn texts(group: &dyn RowGroupReader, column: usize) -> Result<Vec<Option<String>>, Fault> {
    let mut texts = Vec::new();
    each(group, column, |value| {
        let fault = |bytes| Fault::syntax("text in UTF-8", String::from_utf8_lossy(bytes));
        let text = value.map(|bytes| String::from_utf8(bytes.to_vec()).map_err(|_| fault(bytes)));
        texts.push(text.transpose()?);
        Ok(())
    })?;
    Ok(texts)
}

/// Hands over the values of a column, row by row.
fn each(
    group: &dyn RowGroupReader,
    column: usize,
    take: impl FnMut(Option<&[u8]>) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let about = group.metadata().column(column);
    let start = about.dictionary_page_offset().unwrap_or_else(|| about.data_page_offset());
    if start < 0 || about.compressed_size() < 0 {
        return Err(Fault::syntax("an intact Parquet file", "a column at a negative place"));
    }
    match group.get_column_reader(column).map_err(damaged)? {
        reader @ ColumnReader::ByteArrayColumnReader(_) => {
            each_of::<ByteArrayType>(reader, group, column, |value: &ByteArray| value.data().to_vec(), take)
        }
        reader @ ColumnReader::Int32ColumnReader(_) => {
            each_of::<Int32Type>(reader, group, column, |value| value.to_string().into_bytes(), take)
        }
        reader @ ColumnReader::Int64ColumnReader(_) => {
            each_of::<Int64Type>(reader, group, column, |value| value.to_string().into_bytes(), take)
        }
        _ => Err(Fault::syntax("a column of bytes, text or integers", "another type")),
    }
}

fn each_of<T: DataType>(
    reader: ColumnReader,
    group: &dyn RowGroupReader,
    column: usize,
    bytes_of: impl Fn(&T::T) -> Vec<u8>,
    mut take: impl FnMut(Option<&[u8]>) -> Result<(), Fault>,
) -> Result<(), Fault> {
    let most = group.metadata().column(column).column_descr().max_def_level();
    let mut reader = get_typed_column_reader::<T>(reader);
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    loop {
        values.clear();
        levels.clear();
        let wants_levels = (most > 0).then_some(&mut levels);
        let (records, _, _) = reader.read_records(BATCH, wants_levels, None, &mut values).map_err(damaged)?;
        if records == 0 {
            return Ok(());
        }
        let mut found = values.iter();
        for row in 0..records {
            let is_there = most == 0 || levels.get(row) == Some(&most);
            let value = if is_there { found.next().map(&bytes_of) } else { None };
            take(value.as_deref())?;
        }
    }
}

fn damaged(error: ParquetError) -> Fault {
    let unsupported = |what: &str| {
        let what = format!("it uses a feature of Parquet that is not supported: {what}");
        Fault::unsupported(what, "write it with Snappy compression or none")
    };
    match error {
        // Compression by a library that was left out.
        ParquetError::General(what) if what.contains("Disabled feature") => unsupported(&what),
        ParquetError::NYI(what) => unsupported(&what),
        other => Fault::syntax("an intact Parquet file", other.to_string()),
    }
}
