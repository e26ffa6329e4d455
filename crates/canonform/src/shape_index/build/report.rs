//! What building an index did.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use base::Exceeded;
use collection::{LabelOrigin, Skipped, UnusedLabel, count_skipped, n_classes};
use index::Entry;
use mesh::{Fault, MeshError};
use serde::{Serialize, Serializer};

use crate::error::{Error, Remedy};
use crate::shape_index::place::mesh_path;
use crate::shape_index::source::{Listed, Listing};

/// A mesh that could not be described.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Failure {
    /// Name of the shape.
    pub id: String,
    /// Path of the mesh.
    pub path: PathBuf,
    /// Why it failed.
    pub reason: FailureReason,
    /// The error.
    pub error: String,
    /// What would help against it.
    #[serde(skip)]
    pub remedy: Option<Remedy>,
}

/// A shape that is indexed without a part of its surface.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dropped {
    /// Name of the shape.
    pub id: String,
    /// Path of the mesh.
    pub path: PathBuf,
    /// The share of the surface that the repair dropped, above 0.
    pub dropped_area_share: f64,
}

/// Why a mesh could not be described.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum FailureReason {
    /// The file cannot be read, or holds no mesh.
    Unreadable,
    /// The mesh has more vertices or faces than allowed.
    TooLarge,
    /// It took longer than allowed.
    Time,
    /// It needs more memory than allowed.
    Memory,
    /// The mesh has no description.
    Shape,
}

impl FailureReason {
    fn new(fault: &Error) -> Self {
        match fault {
            Error::Exceeded(Exceeded::Time { .. }) => Self::Time,
            Error::Exceeded(Exceeded::Memory { .. }) => Self::Memory,
            Error::Mesh(MeshError::File { fault: Fault::OverLimit { .. }, .. }) => Self::TooLarge,
            Error::Mesh(MeshError::Io(_) | MeshError::File { .. } | MeshError::UnknownFormat { .. })
            | Error::File(_) => Self::Unreadable,
            _ => Self::Shape,
        }
    }
}

/// The outcome of building or extending an index.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct BuildReport {
    /// Shapes in the index now.
    pub n_shapes: usize,
    /// Shapes that were described.
    pub described: usize,
    /// Those of them whose files have the bytes of another file, and so its description.
    pub copies: usize,
    /// Shapes with unchanged content, from the index or from an interrupted run.
    pub unchanged: usize,
    /// Shapes whose path or class changed.
    pub renamed: usize,
    /// Shapes removed because their files are gone from the folder or cannot be described any more.
    pub removed: usize,
    /// Shapes kept although their files cannot be read now: the file, its folder, or a link to it.
    pub unreadable: Vec<String>,
    /// Shapes kept although they did not come from the folder; [`prune`](super::BuildOptions::prune) removes them.
    pub elsewhere: usize,
    /// Shapes removed by [`prune`](super::BuildOptions::prune).
    pub pruned: usize,
    /// Shapes of this run without a class.
    pub unlabelled: usize,
    /// The class that nearly all shapes would have got from the letters that their names begin with. It says nothing, so
    /// they have none.
    pub single_class: Option<String>,
    /// What the classes were taken from; `None` for meshes that were added.
    pub labels_from: Option<LabelOrigin>,
    /// Classes of the shapes of this run.
    pub n_classes: usize,
    /// Lines of the label file that name none of the shapes.
    pub unused_labels: usize,
    /// These lines.
    pub unused_label_lines: Vec<UnusedLabel>,
    /// What was found beside meshes: the number of each kind.
    pub skipped: BTreeMap<String, usize>,
    /// What was skipped although its name is that of a mesh or a folder.
    #[serde(serialize_with = "as_text")]
    pub skipped_paths: Vec<Skipped>,
    /// Whether an index was replaced that is damaged or of a past version; `NAME.damaged` keeps it.
    pub replaced_damaged: bool,
    /// Whether an interrupted run was resumed.
    pub resumed: bool,
    /// Meshes that could not be described, in order.
    pub failed: Vec<Failure>,
    /// Shapes among the inputs whose repair dropped a part of the surface, new and unchanged ones, by name.
    pub dropped: Vec<Dropped>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// JSON has no names that are not UTF-8.
fn as_text<S: Serializer>(skipped: &[Skipped], out: S) -> Result<S::Ok, S::Error> {
    out.collect_seq(skipped.iter().map(|it| it.path.to_string_lossy()))
}

impl BuildReport {
    /// The report on a listing before anything is described.
    pub(in crate::shape_index) fn new(listing: &Listing) -> Self {
        let unexpected = listing.skipped.iter().filter(|skipped| !skipped.kind.is_expected());
        Self {
            unlabelled: listing.shapes.iter().filter(|listed| listed.file.label.is_empty()).count(),
            single_class: listing.single_class.clone(),
            labels_from: listing.labelled_by,
            n_classes: n_classes(listing.shapes.iter().map(|listed| &listed.file)),
            unused_labels: listing.unused_labels.len(),
            unused_label_lines: listing.unused_labels.clone(),
            skipped: count_skipped(&listing.skipped),
            skipped_paths: unexpected.cloned().collect(),
            ..Self::default()
        }
    }

    pub(super) fn fail(&mut self, listed: &Listed, fault: &Error) {
        let (id, path) = (listed.file.name.clone(), listed.file.path.clone());
        let (reason, error) = (FailureReason::new(fault), fault.to_string());
        self.failed.push(Failure { id, path, reason, error, remedy: fault.remedy() });
    }

    /// Notes a shape of the index at `path` if its repair dropped a part of the surface.
    pub(super) fn note_dropped(&mut self, path: &Path, entry: &Entry) {
        let dropped_area_share = entry.facts.dropped_area_share;
        if dropped_area_share > 0.0 {
            let path = mesh_path(path, &entry.path);
            self.dropped.push(Dropped { id: entry.id.clone(), path, dropped_area_share });
        }
    }
}
