//! Where the classes of shapes come from.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use serde::Serialize;

use super::labels::LabelFile;
use super::shape_file::ShapeFile;
use crate::error::CollectionError;

/// Where the classes of shapes come from, if somebody says so. Otherwise they decide by their names: see
/// [`Dataset`](super::Dataset).
#[derive(Debug, Clone, PartialEq)]
pub enum LabelSource {
    /// The sub-folder of a shape is its class: all of its path, or one level, counted from 1 for the outermost.
    Folders(Option<usize>),
    /// The leading letters of its file name are: `cat0` is a `cat`.
    Names,
    /// There are no classes.
    None,
    /// A file states them. Shapes that it does not name have none.
    File(LabelFile),
}

impl LabelSource {
    /// One of the words `folders`, `folders:N`, `names` and `none`, or a label file.
    ///
    /// ```
    /// use canonform_collection::LabelSource;
    ///
    /// assert_eq!(LabelSource::read("folders".as_ref())?, LabelSource::Folders(None));
    /// assert_eq!(LabelSource::read("folders:2".as_ref())?.label("train/cats/a1", None), "cats");
    /// assert!(LabelSource::read("no-such-file.csv".as_ref()).is_err());
    /// # Ok::<(), canonform_collection::CollectionError>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`LabelFile::read`].
    pub fn read(given: &Path) -> Result<Self, CollectionError> {
        let level = given.to_str().and_then(|text| text.strip_prefix("folders:")?.parse().ok());
        match given.to_str() {
            Some("folders") => Ok(Self::Folders(None)),
            _ if level.is_some_and(|level: usize| level > 0) => Ok(Self::Folders(level)),
            Some("names") => Ok(Self::Names),
            Some("none") => Ok(Self::None),
            _ => LabelFile::read(given).map(Self::File),
        }
    }

    /// The word that [`read`](Self::read) reads as this source, unless it is a file.
    pub fn word(&self) -> Option<String> {
        Some(match self {
            Self::Folders(None) => "folders".to_owned(),
            Self::Folders(Some(level)) => format!("folders:{level}"),
            Self::Names => "names".to_owned(),
            Self::None => "none".to_owned(),
            Self::File(_) => return None,
        })
    }

    /// The label file, if there is one.
    pub fn file(&self) -> Option<&LabelFile> {
        match self {
            Self::File(file) => Some(file),
            _ => None,
        }
    }

    /// The class of a shape; empty if it has none.
    pub fn label(&self, name: &str, mesh: Option<&Path>) -> String {
        match self {
            Self::Folders(level) => {
                let path = folder(name).unwrap_or_default();
                level
                    .map_or(Some(path), |level| path.split('/').nth(level - 1))
                    .unwrap_or_default()
                    .to_owned()
            }
            Self::Names => leading_letters(name).to_owned(),
            Self::None => String::new(),
            Self::File(file) => file.label(name, mesh).unwrap_or_default().to_owned(),
        }
    }
}

/// What the classes of a dataset were taken from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LabelOrigin {
    /// Nothing: there are none.
    #[default]
    None,
    /// Sub-folders.
    Folders,
    /// Leading letters of file names.
    Names,
    /// A label file.
    File,
    /// The dataset itself, such as a column of a Parquet file.
    Dataset,
}

/// Gives every shape its class. Without a source, a label that a shape has stays. If none has one, sub-folders beside each other,
/// at any depth, are classes if at least two hold at least two shapes each and none lies in another; else the leading letters of file names, if at least
/// two share them.
pub fn label_shapes(shapes: &mut [ShapeFile], source: Option<&LabelSource>) -> LabelOrigin {
    let folders = class_level(shapes).map(|level| LabelSource::Folders(Some(level)));
    let (origin, source) = match source {
        Some(LabelSource::Folders(_)) => (LabelOrigin::Folders, source),
        Some(LabelSource::Names) => (LabelOrigin::Names, source),
        Some(LabelSource::None) => (LabelOrigin::None, source),
        Some(LabelSource::File(_)) => (LabelOrigin::File, source),
        None if shapes.iter().any(|shape| !shape.label.is_empty()) => return LabelOrigin::Dataset,
        None if folders.is_some() => (LabelOrigin::Folders, folders.as_ref()),
        None if share_letters(shapes) => (LabelOrigin::Names, Some(&LabelSource::Names)),
        None => return LabelOrigin::None,
    };
    let label = |shape: &ShapeFile| source.map(|source| source.label(&shape.name, Some(&shape.path)));
    shapes.iter_mut().for_each(|shape| shape.label = label(shape).unwrap_or_default());
    origin
}

/// The level of sub-folders that look like classes.
fn class_level(shapes: &[ShapeFile]) -> Option<usize> {
    let folders = || shapes.iter().filter_map(|shape| folder(&shape.name));
    let large = counted(folders()).values().filter(|count| **count > 1).count();
    let parents: HashSet<Option<&str>> = folders().map(folder).collect();
    let level = folders().next()?.split('/').count();
    (large > 1 && parents.len() == 1).then_some(level)
}

/// Whether file names look like those of classes.
fn share_letters(shapes: &[ShapeFile]) -> bool {
    let letters =
        shapes.iter().map(|shape| leading_letters(&shape.name)).filter(|letters| !letters.is_empty());
    counted(letters).values().any(|count| *count > 1)
}

fn counted<'a>(words: impl Iterator<Item = &'a str>) -> HashMap<&'a str, usize> {
    let mut counts = HashMap::new();
    words.for_each(|word| *counts.entry(word).or_default() += 1);
    counts
}

fn folder(name: &str) -> Option<&str> {
    name.rsplit_once('/').map(|(folder, _)| folder)
}

/// The letters that a file name begins with.
fn leading_letters(name: &str) -> &str {
    let file = name.rsplit_once('/').map_or(name, |(_, file)| file);
    &file[..file.len() - file.trim_start_matches(char::is_alphabetic).len()]
}

/// Whether a label is one that a name suggests in some way, so that nobody need have given it.
pub fn is_suggested(label: &str, name: &str) -> bool {
    let path = folder(name).unwrap_or_default();
    label == leading_letters(name) || label == path || path.split('/').any(|part| part == label)
}

/// The class that a name alone suggests: its sub-folder, else the leading letters of its file name
/// (`cat0` is a `cat`), else the whole name.
pub fn label_of(name: &str) -> String {
    let found = folder(name).unwrap_or_else(|| leading_letters(name));
    if found.is_empty() { name } else { found }.to_owned()
}

/// Share of the shapes of a folder that makes one label suspicious.
const NEARLY_ALL: f64 = 0.95;

/// Removes labels that come from leading letters, if nearly all shapes would get the same one: names such as `T174` are
/// numbers rather than classes. Returns that label.
///
/// `known` tells labels that are classes already.
pub fn drop_single_class(shapes: &mut [ShapeFile], known: impl Fn(&str) -> bool) -> Option<String> {
    let by_letters =
        |shape: &ShapeFile| shape.label.is_empty() || shape.label == leading_letters(&shape.name);
    if shapes.len() < 2 || !shapes.iter().all(by_letters) {
        return None;
    }
    let counts = counted(shapes.iter().map(|shape| shape.label.as_str()));
    let (label, count) = counts.iter().max_by_key(|(label, count)| (**count, **label))?;
    let others_are_single = counts.iter().all(|(other, count)| other == label || *count == 1);
    let is_small = (*count as f64) < NEARLY_ALL * shapes.len() as f64;
    if label.is_empty() || is_small || !others_are_single || known(label) {
        return None;
    }
    let label = (*label).to_owned();
    shapes.iter_mut().for_each(|shape| shape.label.clear());
    Some(label)
}

/// The number of classes that shapes have.
pub fn n_classes<'a>(shapes: impl IntoIterator<Item = &'a ShapeFile>) -> usize {
    let labels = shapes.into_iter().map(|shape| shape.label.as_str()).filter(|label| !label.is_empty());
    labels.collect::<HashSet<_>>().len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes(names: &[&str]) -> Vec<ShapeFile> {
        let shape = |name: &&str| ShapeFile {
            name: (*name).to_owned(),
            label: String::new(),
            path: format!("{name}.off").into(),
        };
        names.iter().map(shape).collect()
    }

    /// The labels that shapes get, and where they come from.
    fn labelled(names: &[&str], source: Option<&LabelSource>) -> (LabelOrigin, Vec<String>) {
        let mut shapes = shapes(names);
        let origin = label_shapes(&mut shapes, source);
        (origin, shapes.into_iter().map(|shape| shape.label).collect())
    }

    #[test]
    fn a_name_alone_suggests_a_class() {
        for (name, label) in [("cat0", "cat"), ("cats/sitting1", "cats"), ("0001", "0001"), ("T_rex", "T")] {
            assert_eq!(label_of(name), label);
        }
    }

    #[test]
    fn folders_are_classes_only_if_they_look_like_classes() {
        let both: &[&str] = &["cats/a1", "cats/b1", "dogs/a1", "dogs/b1", "odd/c", "top"];
        for (names, origin, expected) in [
            (both, LabelOrigin::Folders, &["cats", "cats", "dogs", "dogs", "odd", ""][..]),
            // One folder, single shapes and deeper folders hold what somebody put there.
            (&["games/cat0", "games/cat1"], LabelOrigin::Names, &["cat", "cat"]),
            (&["a/cat0", "b/dog0", "b/cat1"], LabelOrigin::Names, &["cat", "dog", "cat"]),
            (&["a/x1", "a/y1", "b/z1", "b/c/w1", "b/v1"], LabelOrigin::None, &["", "", "", "", ""]),
            (&["cat0", "dog0", "17"], LabelOrigin::None, &["", "", ""]),
            (&["cat0", "cat1", "17"], LabelOrigin::Names, &["cat", "cat", ""]),
            (
                &["in/cats/a1", "in/cats/b1", "in/dogs/a1", "in/dogs/b1", "top"],
                LabelOrigin::Folders,
                &["cats", "cats", "dogs", "dogs", ""],
            ),
        ] {
            let (found, labels) = labelled(names, None);
            assert_eq!(
                (found, labels),
                (origin, expected.iter().map(|s| (*s).to_owned()).collect()),
                "{names:?}"
            );
        }
    }

    #[test]
    fn whoever_says_where_classes_come_from_is_believed() {
        let names = ["game/old/cat0", "game/dog0", "7"];
        for (source, origin, expected) in [
            (LabelSource::Folders(None), LabelOrigin::Folders, ["game/old", "game", ""]),
            (LabelSource::Folders(Some(1)), LabelOrigin::Folders, ["game", "game", ""]),
            (LabelSource::Names, LabelOrigin::Names, ["cat", "dog", ""]),
            (LabelSource::None, LabelOrigin::None, ["", "", ""]),
        ] {
            let (found, labels) = labelled(&names, Some(&source));
            assert_eq!((found, labels), (origin, expected.map(str::to_owned).to_vec()));
        }
        let mut stated = shapes(&["cat0", "cat1"]);
        stated[0].label = "beast".to_owned();
        assert_eq!(label_shapes(&mut stated, None), LabelOrigin::Dataset);
        assert_eq!((stated[0].label.as_str(), stated[1].label.as_str()), ("beast", ""));
        label_shapes(&mut stated, Some(&LabelSource::None));
        assert_eq!((stated[0].label.as_str(), n_classes(&stated)), ("", 0));
        assert!(LabelSource::read("folders:0".as_ref()).is_err());
    }

    #[test]
    fn one_class_for_nearly_all_shapes_is_none() {
        let labelled = |names: &[&str]| {
            let mut shapes = shapes(names);
            shapes.iter_mut().for_each(|shape| shape.label = label_of(&shape.name));
            shapes
        };
        let names: Vec<String> = (0..40).map(|i| format!("T{i}")).collect();
        let mut numbered = labelled(&names.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(drop_single_class(&mut numbered.clone(), |label| label == "T"), None, "a class by now");
        numbered.extend(labelled(&["query"]));
        assert_eq!(drop_single_class(&mut numbered, |_| false).as_deref(), Some("T"));
        assert!(numbered.iter().all(|shape| shape.label.is_empty()));
        // A few of one class beside many of another are two classes.
        let skewed = [&vec!["cat0"; 98][..], &["dog0", "dog1"]].concat();
        for classes in [&["cat0", "cat1", "dog0", "dog1"][..], &["cat0"], &["cats/0", "cats/1"], &skewed] {
            let mut classes = labelled(classes);
            assert_eq!(drop_single_class(&mut classes, |_| false), None);
            assert!(classes.iter().all(|shape| !shape.label.is_empty()));
        }
    }
}
