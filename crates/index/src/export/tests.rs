//! What is exported reads back.

use std::io::Read;

use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::record::{Field, Row, RowAccessor};
use zip::ZipArchive;

use super::ExportFormat;
use crate::tests::{Folder, OPTIONS, exported, shape};
use crate::{Entry, Index, Shape};

/// An index in which one shape lacks a signature that another one has.
fn uneven() -> (Folder, Index, Vec<Shape>) {
    let folder = Folder::new();
    let mut shapes: Vec<Shape> = (0..5).map(shape).collect();
    shapes[2].signatures.insert("extra".to_owned(), vec![1.5, -2.5]);
    shapes[2].components = vec![vec![1.0, 2.0, 3.0]; 2];
    shapes[3].entry.label = "a, \"b\" ä".to_owned();
    let path = folder.path("uneven");
    folder.fill(&path, &shapes);
    let index = Index::open(&path).unwrap();
    shapes.sort_by(|a, b| a.entry.id.cmp(&b.entry.id));
    (folder, index, shapes)
}

fn floats(row: &Row, column: usize) -> Option<Vec<f32>> {
    let Field::ListInternal(list) = row.get_column_iter().nth(column).unwrap().1 else { return None };
    let number = |field: &Field| match field {
        Field::Float(value) => *value,
        other => panic!("{other:?}"),
    };
    Some(list.elements().iter().map(number).collect())
}

#[test]
fn parquet_holds_everything() {
    let (_folder, index, shapes) = uneven();
    let reader = SerializedFileReader::new(exported(&index, ExportFormat::Parquet)).unwrap();
    let about = reader.metadata().file_metadata();
    let options = about.key_value_metadata().unwrap().iter().find(|pair| pair.key == "canonform.options");
    assert_eq!(options.unwrap().value.as_deref(), Some(OPTIONS));
    let rows: Vec<Row> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
    assert_eq!(rows.len(), shapes.len());
    for (row, shape) in rows.iter().zip(&shapes) {
        let Entry { id, label, path, content, .. } = &shape.entry;
        let texts = [0, 1, 2, 3].map(|column| row.get_string(column).unwrap());
        assert_eq!(texts, [id, label, path, &content.to_string()]);
        for (column, (name, field)) in row.get_column_iter().enumerate().skip(4) {
            if let Some(fact) = name.strip_prefix("fact_") {
                let facts = shape.entry.facts.named();
                let (_, expected) = facts.iter().find(|(name, _)| *name == fact).unwrap();
                assert_eq!(row.get_double(column).unwrap(), *expected, "{name}: {field}");
                continue;
            }
            let expected = match name.as_str() {
                "components" => Some(shape.components.concat()),
                "disc_areas" => Some(shape.disc_areas.clone()),
                "fused" => Some(shape.fused.clone()),
                "form" => Some(shape.form.as_flattened().to_vec()),
                name => shape.signatures.get(name.strip_prefix("signature_").unwrap()).cloned(),
            };
            assert_eq!(floats(row, column), expected, "{name}");
        }
    }
}

#[test]
fn npz_holds_everything() {
    let (_folder, index, shapes) = uneven();
    let mut archive = ZipArchive::new(exported(&index, ExportFormat::Npz)).unwrap();
    let mut bytes = |name: &str| {
        let mut bytes = Vec::new();
        archive.by_name(&format!("{name}.npy")).unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    };
    let mut array = |name: &str| -> (Vec<u64>, Vec<f32>) {
        let bytes = bytes(name);
        let array = npyz::NpyFile::new(&bytes[..]).unwrap();
        (array.shape().to_vec(), array.into_vec().unwrap())
    };
    let n = shapes.len() as u64;
    let fused: Vec<f32> = shapes.iter().flat_map(|shape| shape.fused.clone()).collect();
    assert_eq!(array("fused"), (vec![n, 3], fused));
    assert_eq!((array("form").0[2], array("components").0), (4, vec![n, 2, 3]));
    let (_, extra) = array("signature_extra");
    assert_eq!(extra.iter().filter(|x| x.is_nan()).count(), 2 * (shapes.len() - 1));
    let ids = bytes("id");
    let start = ids.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    assert!(String::from_utf8_lossy(&ids[..start]).contains("'descr': '<U") && start % 64 == 0);
    let characters: String =
        ids[start..].chunks(4).map(|character| char::from(character[0])).filter(|c| *c != '\0').collect();
    assert_eq!(characters, shapes.iter().map(|shape| shape.entry.id.as_str()).collect::<String>());
}

#[test]
fn csv_holds_what_search_compares() {
    let (_folder, index, shapes) = uneven();
    let mut text = String::new();
    exported(&index, ExportFormat::Csv).read_to_string(&mut text).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].starts_with("id,label,path,content,fact_"), "{}", lines[0]);
    assert_eq!(lines.len(), 1 + shapes.len());
    assert!(text.contains(",\"a, \"\"b\"\" ä\","));
    let n = shapes[0].fused.len();
    for (line, shape) in lines[1..].iter().zip(&shapes) {
        let mut last: Vec<f32> = line.rsplit(',').take(n).map(|x| x.parse().unwrap()).collect();
        last.reverse();
        assert_eq!(last, shape.fused);
    }
}
