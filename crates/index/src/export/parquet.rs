//! Parquet, which databases and data frames read.

use std::fs::File;
use std::io;
use std::sync::Arc;

use parquet::basic::{Compression, ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, FloatType};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::{ColumnPath, Type, TypePtr};

use super::columns::{Column, Kind, columns};
use super::error::ExportError;
use crate::{Index, Shape};

/// Shapes that are written together.
const GROUP: usize = 1024;

pub(super) fn write(index: &Index, file: &mut File) -> Result<(), ExportError> {
    let columns = columns(index)?;
    let schema = schema(&columns).map_err(failed)?;
    let options = KeyValue::new("canonform.options".to_owned(), index.options().to_owned());
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
        Ok::<(), ExportError>(())
    })?;
    if !rows.is_empty() {
        write_group(&mut writer, &columns, &rows)?;
    }
    writer.close().map_err(failed)?;
    Ok(())
}

fn schema(columns: &[Column]) -> Result<TypePtr, ParquetError> {
    let fields = columns.iter().map(|column| field(column).map(Arc::new)).collect::<Result<_, _>>()?;
    Type::group_type_builder("shapes").with_fields(fields).build().map(Arc::new)
}

fn field(column: &Column) -> Result<Type, ParquetError> {
    let name = column.name.as_str();
    let repetition = if column.is_optional() { Repetition::OPTIONAL } else { Repetition::REQUIRED };
    match &column.kind {
        Kind::Text(_) => Type::primitive_type_builder(name, Physical::BYTE_ARRAY)
            .with_repetition(repetition)
            .with_logical_type(Some(LogicalType::String))
            .build(),
        Kind::Fact => {
            Type::primitive_type_builder(name, Physical::DOUBLE).with_repetition(repetition).build()
        }
        Kind::Floats(_) => {
            let element = Type::primitive_type_builder("element", Physical::FLOAT);
            let element = Arc::new(element.with_repetition(Repetition::REQUIRED).build()?);
            let inner = Type::group_type_builder("list").with_repetition(Repetition::REPEATED);
            let inner = Arc::new(inner.with_fields(vec![element]).build()?);
            Type::group_type_builder(name)
                .with_repetition(repetition)
                .with_converted_type(ConvertedType::LIST)
                .with_logical_type(Some(LogicalType::List))
                .with_fields(vec![inner])
                .build()
        }
    }
}

fn write_group(
    writer: &mut SerializedFileWriter<&mut File>,
    columns: &[Column],
    rows: &[Shape],
) -> Result<(), ExportError> {
    let mut group = writer.next_row_group().map_err(failed)?;
    for column in columns {
        match &column.kind {
            Kind::Text(_) => {
                let values: Vec<ByteArray> =
                    rows.iter().map(|shape| column.text(shape).into_bytes().into()).collect();
                put::<ByteArrayType>(&mut group, &values, None, None)?;
            }
            Kind::Fact => {
                let values: Vec<f64> = rows.iter().map(|shape| column.fact(shape)).collect();
                put::<DoubleType>(&mut group, &values, None, None)?;
            }
            Kind::Floats(_) => lists(&mut group, column, rows)?,
        }
    }
    group.close().map_err(failed)?;
    Ok(())
}

/// Writes a column of lists. Definition levels count what is there (a list that may be missing, an element), repetition
/// levels are 0 where a list begins.
fn lists(
    group: &mut SerializedRowGroupWriter<'_, &mut File>,
    column: &Column,
    rows: &[Shape],
) -> Result<(), ExportError> {
    let (mut values, mut definitions, mut repetitions) = (Vec::new(), Vec::new(), Vec::new());
    let of_empty = i16::from(column.is_optional());
    for row in rows.iter().map(|shape| column.floats(shape)) {
        let is_there = row.is_some();
        match row.unwrap_or_default().as_slice() {
            [] => {
                definitions.push(if is_there { of_empty } else { 0 });
                repetitions.push(0);
            }
            row => {
                values.extend_from_slice(row);
                definitions.extend(row.iter().map(|_| of_empty + 1));
                repetitions.extend((0..row.len()).map(|i| i16::from(i > 0)));
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
) -> Result<(), ExportError> {
    let column = group.next_column().map_err(failed)?;
    let mut column = column.ok_or_else(|| io::Error::other("the table has no further column"))?;
    column.typed::<T>().write_batch(values, definitions, repetitions).map_err(failed)?;
    column.close().map_err(failed)
}

fn failed(error: ParquetError) -> ExportError {
    ExportError::Write(io::Error::other(error))
}
