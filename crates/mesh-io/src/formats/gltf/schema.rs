//! The members of glTF's JSON that decide on positions and faces. Every other one is skipped, whatever it holds.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;

use crate::binary::Scalar;

/// The number of a part in its list in [`Root`].
pub(super) type Index = usize;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Root {
    pub(super) asset: Asset,
    pub(super) scene: Option<Index>,
    #[serde(default)]
    pub(super) extensions_used: Vec<String>,
    #[serde(default)]
    pub(super) extensions_required: Vec<String>,
    #[serde(default)]
    pub(super) buffers: Vec<Buffer>,
    #[serde(default)]
    pub(super) buffer_views: Vec<View>,
    #[serde(default)]
    pub(super) accessors: Vec<Accessor>,
    #[serde(default)]
    pub(super) meshes: Vec<Mesh>,
    #[serde(default)]
    pub(super) nodes: Vec<Node>,
    #[serde(default)]
    pub(super) scenes: Vec<Scene>,
    #[serde(default)]
    pub(super) animations: Vec<IgnoredAny>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Asset {
    pub(super) version: String,
    pub(super) min_version: Option<String>,
}

#[derive(Deserialize)]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    pub(super) buffer: Index,
    pub(super) byte_length: u64,
    pub(super) byte_offset: Option<u64>,
    pub(super) byte_stride: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<Index>,
    pub(super) byte_offset: Option<u64>,
    pub(super) count: u64,
    pub(super) component_type: u32,
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) sparse: Option<Sparse>,
}

/// Rows that replace others.
#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparseIndices,
    pub(super) values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub(super) buffer_view: Index,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: u32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub(super) buffer_view: Index,
    #[serde(default)]
    pub(super) byte_offset: u64,
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    pub(super) primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub(super) attributes: BTreeMap<String, Index>,
    pub(super) indices: Option<Index>,
    #[serde(default)]
    pub(super) mode: Mode,
    #[serde(default)]
    pub(super) targets: Vec<IgnoredAny>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(from = "u32")]
pub(super) enum Mode {
    PointsOrLines,
    #[default]
    Triangles,
    Strip,
    Fan,
    /// Not in the standard.
    Unknown,
}

impl From<u32> for Mode {
    fn from(number: u32) -> Self {
        match number {
            0..=3 => Self::PointsOrLines,
            4 => Self::Triangles,
            5 => Self::Strip,
            6 => Self::Fan,
            _ => Self::Unknown,
        }
    }
}

#[derive(Deserialize)]
pub(super) struct Node {
    pub(super) mesh: Option<Index>,
    pub(super) skin: Option<Index>,
    #[serde(default)]
    pub(super) children: Vec<Index>,
    pub(super) matrix: Option<[f32; 16]>,
    pub(super) translation: Option<[f32; 3]>,
    pub(super) rotation: Option<[f32; 4]>,
    pub(super) scale: Option<[f32; 3]>,
    #[serde(default)]
    extensions: Value,
}

impl Node {
    /// Whether the file hides the node and those below it.
    pub(super) fn is_hidden(&self) -> bool {
        self.extensions.pointer("/KHR_node_visibility/visible") == Some(&Value::Bool(false))
    }
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub(super) nodes: Vec<Index>,
}

/// How numbers of a component type are stored. `None` for a number that is not in the standard.
pub(super) fn scalar(component_type: u32) -> Option<Scalar> {
    Some(match component_type {
        5120 => Scalar::I8,
        5121 => Scalar::U8,
        5122 => Scalar::I16,
        5123 => Scalar::U16,
        5125 => Scalar::U32,
        5126 => Scalar::F32,
        _ => return None,
    })
}
