//! Parquet, which databases and data frames read.

use std::borrow::Cow;
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

use super::arrow::{self, Kind};
use super::columns::{Column, columns, floats_of, text_of};
use super::error::ExportError;
use crate::{Index, Shape};

/// Shapes that are written together.
const GROUP: usize = 1024;

pub(super) fn write(index: &Index, file: &mut File) -> Result<(), ExportError> {
    let columns = columns(index)?;
    let schema = schema(&columns).map_err(failed)?;
    let options = KeyValue::new("canonform.options".to_owned(), index.options().to_owned());
    let kinds = KeyValue::new(arrow::KEY.to_owned(), arrow::schema(columns.iter().map(kind)));
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        // Numbers hardly repeat.
        .set_dictionary_enabled(false)
        .set_key_value_metadata(Some(vec![options, kinds]));
    properties = properties.set_column_dictionary_enabled(ColumnPath::from("label"), true);
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
    let text = |name: &str| {
        let column = Type::primitive_type_builder(name, Physical::BYTE_ARRAY)
            .with_repetition(Repetition::REQUIRED)
            .with_converted_type(ConvertedType::UTF8)
            .with_logical_type(Some(LogicalType::String));
        column.build().map(Arc::new)
    };
    let double = |name: &str| {
        let column = Type::primitive_type_builder(name, Physical::DOUBLE);
        column.with_repetition(Repetition::OPTIONAL).build().map(Arc::new)
    };
    let list = |name: &str, repetition| {
        let element = Type::primitive_type_builder("element", Physical::FLOAT);
        let element = Arc::new(element.with_repetition(Repetition::REQUIRED).build()?);
        let inner = Type::group_type_builder("list").with_repetition(Repetition::REPEATED);
        let inner = Arc::new(inner.with_fields(vec![element]).build()?);
        let column = Type::group_type_builder(name)
            .with_repetition(repetition)
            .with_converted_type(ConvertedType::LIST)
            .with_logical_type(Some(LogicalType::List));
        column.with_fields(vec![inner]).build().map(Arc::new)
    };
    let field = |column: &Column| match column {
        Column::Text(name, _) => text(name),
        Column::Fact(_) => double(&name_of(column)),
        Column::Floats(name, _) => {
            list(name, if is_signature(name) { Repetition::OPTIONAL } else { Repetition::REQUIRED })
        }
    };
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("shapes").with_fields(fields).build().map(Arc::new)
}

fn name_of(column: &Column) -> Cow<'_, str> {
    match column {
        Column::Text(name, _) => Cow::Borrowed(name),
        Column::Fact(name) => Cow::Owned(format!("fact_{name}")),
        Column::Floats(name, _) => Cow::Borrowed(name),
    }
}

/// The name of a column, whether shapes may lack it, and its type. Only fused vectors are of one length in every index.
fn kind(column: &Column) -> (Cow<'_, str>, bool, Kind) {
    let (is_optional, kind) = match column {
        Column::Text(..) => (false, Kind::Text),
        Column::Fact(_) => (true, Kind::Double),
        Column::Floats(name, extents) => match extents[..] {
            [length] if name == "fused" && length > 0 => (false, Kind::FixedList(length)),
            _ => (is_signature(name), Kind::List),
        },
    };
    (name_of(column), is_optional, kind)
}

/// Whether shapes may lack this column. Others are empty then.
fn is_signature(name: &str) -> bool {
    name.starts_with("signature_")
}

fn write_group(
    writer: &mut SerializedFileWriter<&mut File>,
    columns: &[Column],
    rows: &[Shape],
) -> Result<(), ExportError> {
    let mut group = writer.next_row_group().map_err(failed)?;
    for column in columns {
        match column {
            Column::Text(name, _) => {
                let values: Vec<ByteArray> =
                    rows.iter().map(|shape| text_of(shape, name).into_bytes().into()).collect();
                put::<ByteArrayType>(&mut group, &values, None, None)?;
            }
            Column::Fact(name) => {
                let found: Vec<Option<f64>> = rows.iter().map(|shape| shape.entry.fact(name)).collect();
                let levels: Vec<i16> = found.iter().map(|value| i16::from(value.is_some())).collect();
                let values: Vec<f64> = found.into_iter().flatten().collect();
                put::<DoubleType>(&mut group, &values, Some(&levels), None)?;
            }
            Column::Floats(name, _) => {
                lists(&mut group, rows.iter().map(|shape| floats_of(shape, name)), is_signature(name))?;
            }
        }
    }
    group.close().map_err(failed)?;
    Ok(())
}

/// Writes a column of lists. Definition levels count what is there (a list that may be missing, an element), repetition
/// levels are 0 where a list begins.
fn lists<'a>(
    group: &mut SerializedRowGroupWriter<'_, &mut File>,
    rows: impl Iterator<Item = Option<Cow<'a, [f32]>>>,
    is_optional: bool,
) -> Result<(), ExportError> {
    let (mut values, mut definitions, mut repetitions) = (Vec::new(), Vec::new(), Vec::new());
    let of_empty = i16::from(is_optional);
    for row in rows {
        let is_there = row.is_some();
        match row.unwrap_or_default().as_ref() {
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
