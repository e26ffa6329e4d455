//! The rows of a PLY file as this crate holds them.

use nalgebra::Point3;
use ply_rs_bw::ply::{PropertyAccess, PropertyAccessResult};

/// A vertex on its way in.
pub(super) struct VertexIn(pub(super) Point3<f64>);

impl VertexIn {
    fn set(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return PropertyAccessResult::Ignored,
        };
        self.0[axis] = value;
        PropertyAccessResult::Set
    }
}

macro_rules! scalar_setters {
    ($($setter:ident: $type:ty),*) => {
        $(fn $setter(&mut self, name: &str, value: $type) -> PropertyAccessResult {
            self.set(name, value.into())
        })*
    };
}

impl PropertyAccess for VertexIn {
    fn new() -> Self {
        Self(Point3::origin())
    }

    scalar_setters!(
        set_char: i8, set_uchar: u8, set_short: i16, set_ushort: u16,
        set_int: i32, set_uint: u32, set_float: f32, set_double: f64
    );
}

/// The names under which programs list the corners of a face.
pub(super) const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// A face on its way in: its corners, in range or not.
pub(super) struct FaceIn(pub(super) Vec<i64>);

impl FaceIn {
    fn set<T: Into<i64>>(&mut self, name: &str, corners: Vec<T>) -> PropertyAccessResult {
        if !CORNER_LISTS.contains(&name) {
            return PropertyAccessResult::Ignored;
        }
        self.0 = corners.into_iter().map(Into::into).collect();
        PropertyAccessResult::Set
    }
}

macro_rules! list_setters {
    ($($setter:ident: $type:ty),*) => {
        $(fn $setter(&mut self, name: &str, values: Vec<$type>) -> PropertyAccessResult {
            self.set(name, values)
        })*
    };
}

impl PropertyAccess for FaceIn {
    fn new() -> Self {
        Self(Vec::new())
    }

    list_setters!(
        set_list_char: i8, set_list_uchar: u8, set_list_short: i16, set_list_ushort: u16,
        set_list_int: i32, set_list_uint: u32
    );
}

/// A row of an element that is passed over.
pub(super) struct OtherIn;

impl PropertyAccess for OtherIn {
    fn new() -> Self {
        Self
    }
}

/// A row on its way out.
pub(super) enum RowOut {
    /// A vertex with its value and colour, which a plain mesh does not declare and so not write.
    Vertex {
        /// Where it is.
        position: Point3<f64>,
        /// The value of the field.
        value: f64,
        /// Red, green, blue.
        color: [u8; 3],
    },
    /// A triangle.
    Face([u32; 3]),
}

impl PropertyAccess for RowOut {
    fn new() -> Self {
        Self::Face([0; 3])
    }

    fn get_double(&self, name: &str) -> Option<f64> {
        match (self, name) {
            (Self::Vertex { position, .. }, "x") => Some(position.x),
            (Self::Vertex { position, .. }, "y") => Some(position.y),
            (Self::Vertex { position, .. }, "z") => Some(position.z),
            (Self::Vertex { value, .. }, _) => Some(*value),
            (Self::Face(_), _) => None,
        }
    }

    fn get_uchar(&self, name: &str) -> Option<u8> {
        match (self, name) {
            (Self::Vertex { color, .. }, "red") => Some(color[0]),
            (Self::Vertex { color, .. }, "green") => Some(color[1]),
            (Self::Vertex { color, .. }, "blue") => Some(color[2]),
            _ => None,
        }
    }

    fn get_list_uint(&self, _name: &str) -> Option<&[u32]> {
        match self {
            Self::Face(corners) => Some(corners),
            Self::Vertex { .. } => None,
        }
    }
}
