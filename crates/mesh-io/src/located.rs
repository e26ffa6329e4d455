//! Faults and where in a file they are.

use std::path::Path;

use mesh::{Fault, MeshError, Place};

/// A fault and its place in a file that has no name yet; the error of every parser.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Located {
    /// Which of the files of the mesh.
    pub(crate) file: usize,
    /// The file inside the file, if it is an archive.
    pub(crate) member: Option<String>,
    pub(crate) place: Place,
    pub(crate) fault: Fault,
}

impl Located {
    /// Moves the fault to a file inside the file.
    pub(crate) fn of_member(self, member: &str) -> Self {
        Self { member: Some(member.to_owned()), ..self }
    }

    /// Names the file.
    pub(crate) fn in_file(self, path: &Path) -> MeshError {
        let path = self.member.map_or_else(|| path.to_owned(), |member| path.join(member));
        MeshError::File { path, place: self.place, fault: self.fault }
    }
}

/// What becomes located when it is told its place in the first file: a fault, or a result with one.
pub(crate) trait At: Sized {
    type Located;

    fn at(self, place: Place) -> Self::Located;

    /// In the file as a whole.
    fn whole(self) -> Self::Located {
        self.at(Place::File)
    }

    /// In a line, counted from one.
    fn in_line(self, line: usize) -> Self::Located {
        self.at(Place::Line(line))
    }

    /// At a byte, counted from zero.
    fn at_byte(self, byte: usize) -> Self::Located {
        self.at(Place::Byte(byte as u64))
    }

    /// In a numbered part of the file.
    fn in_part(self, kind: &'static str, number: usize) -> Self::Located {
        self.at(Place::Part(kind, number))
    }
}

impl At for Fault {
    type Located = Located;

    fn at(self, place: Place) -> Located {
        Located { file: 0, member: None, place, fault: self }
    }
}

impl<T> At for Result<T, Fault> {
    type Located = Result<T, Located>;

    fn at(self, place: Place) -> Self::Located {
        self.map_err(|fault| fault.at(place))
    }
}
