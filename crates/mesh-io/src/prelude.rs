//! What readers and writers of formats are made of.

pub(crate) use std::io::{self, Write};

pub(crate) use mesh::{Fault, Place, TriMesh};
pub(crate) use nalgebra::Point3;
pub(crate) use surface::VertexId;

pub(crate) use crate::binary::{ByteOrder, Bytes, Scalar};
pub(crate) use crate::file::{FileFacts, LengthUnit, MeshFile, ReadLimits, ScalarField, VertexField};
pub(crate) use crate::located::{At, Located};
pub(crate) use crate::polygons::{Polygons, finish, finite};
pub(crate) use crate::text::{
    Line, Lines, Words, check_is_not_utf16, check_is_text, excerpt, other_format, parse_integer,
    parse_number, parse_position, parse_vertex, write_position,
};

/// The field that is written with a mesh, if there is one.
pub(crate) type Field<'a> = Option<&'a VertexField<'a>>;
