//! Parquet, which databases and data frames read.

use std::fs::File;
use std::io;
use std::sync::Arc;

use parquet::basic::Compression;
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::ColumnPath;

use super::columns::{Column, Kind, Value, columns};
use crate::{Index, Shape};

/// Shapes that are written together.
const GROUP: usize = 1024;

pub(super) fn write(index: &Index, file: &mut File) -> io::Result<()> {
    let columns = columns(index)?;
    let schema = parse_message_type(&schema(&columns)).map_err(failed)?.into();
    let options = KeyValue::new("canonform.options".to_owned(), index.options.clone());
    let properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        // Numbers hardly repeat.
        .set_dictionary_enabled(false)
        .set_column_dictionary_enabled(ColumnPath::from("label"), true)
        .set_key_value_metadata(Some(vec![options]));
    let mut writer = SerializedFileWriter::new(file, schema, Arc::new(properties.build())).map_err(failed)?;
    let mut rows: Vec<Shape> = Vec::with_capacity(GROUP);
    index.each(|shape| {
        rows.push(shape);
        if rows.len() == GROUP {
            write_group(&mut writer, &columns, &rows)?;
            rows.clear();
        }
        Ok::<(), io::Error>(())
    })?;
    if !rows.is_empty() {
        write_group(&mut writer, &columns, &rows)?;
    }
    writer.close().map_err(failed)?;
    Ok(())
}

fn schema(columns: &[Column]) -> String {
    let field = |column: &Column| {
        let (name, repetition) = (&column.name, if column.is_optional() { "OPTIONAL" } else { "REQUIRED" });
        match column.kind {
            Kind::Text => format!("{repetition} BYTE_ARRAY {name} (STRING);"),
            Kind::Fact => format!("{repetition} DOUBLE {name};"),
            Kind::Floats => {
                let list = "{ REPEATED GROUP list { REQUIRED FLOAT element; } }";
                format!("{repetition} GROUP {name} (LIST) {list}")
            }
        }
    };
    format!("message shapes {{ {} }}", columns.iter().map(field).collect::<String>())
}

fn write_group(
    writer: &mut SerializedFileWriter<&mut File>,
    columns: &[Column],
    rows: &[Shape],
) -> io::Result<()> {
    let mut group = writer.next_row_group().map_err(failed)?;
    for column in columns {
        let values = rows.iter().map(|shape| column.value(shape));
        match column.kind {
            Kind::Text => {
                let text = |value| {
                    if let Some(Value::Text(text)) = value { text.as_bytes().to_vec() } else { Vec::new() }
                };
                let values: Vec<ByteArray> = values.map(text).map(ByteArray::from).collect();
                put::<ByteArrayType>(&mut group, &values, None, None)?;
            }
            Kind::Fact => {
                let fact = |value| if let Some(Value::Fact(fact)) = value { fact } else { f64::NAN };
                put::<DoubleType>(&mut group, &values.map(fact).collect::<Vec<_>>(), None, None)?;
            }
            Kind::Floats => lists(&mut group, column.is_optional(), values)?,
        }
    }
    group.close().map_err(failed)?;
    Ok(())
}

/// Writes a column of lists. Definition levels count what is there (a list that may be missing, an element), repetition
/// levels are 0 where a list begins.
fn lists<'a>(
    group: &mut SerializedRowGroupWriter<'_, &mut File>,
    is_optional: bool,
    rows: impl Iterator<Item = Option<Value<'a>>>,
) -> io::Result<()> {
    let (mut values, mut definitions, mut repetitions) = (Vec::new(), Vec::new(), Vec::new());
    let of_empty = i16::from(is_optional);
    for row in rows {
        match row {
            Some(Value::Floats(row, _)) if !row.is_empty() => {
                values.extend_from_slice(&row);
                definitions.extend(row.iter().map(|_| of_empty + 1));
                repetitions.extend((0..row.len()).map(|i| i16::from(i > 0)));
            }
            row => {
                definitions.push(if row.is_some() { of_empty } else { 0 });
                repetitions.push(0);
            }
        }
    }
    put::<FloatType>(group, &values, Some(&definitions), Some(&repetitions))
}

/// Writes the next column.
fn put<T: DataType>(
    group: &mut SerializedRowGroupWriter<'_, &mut File>,
    values: &[T::T],
    definitions: Option<&[i16]>,
    repetitions: Option<&[i16]>,
) -> io::Result<()> {
    let column = group.next_column().map_err(failed)?;
    let mut column = column.ok_or_else(|| io::Error::other("the table has no further column"))?;
    column.typed::<T>().write_batch(values, definitions, repetitions).map_err(failed)?;
    column.close().map_err(failed)
}

fn failed(error: ParquetError) -> io::Error {
    io::Error::other(error)
}
