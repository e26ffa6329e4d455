//! What is wrong with a file.

/// Why a file is not a distance field that this version can read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldFault {
    /// It begins like no distance field.
    #[error("this is not a distance field")]
    NotAField,
    /// Another version of the program wrote it.
    #[error("the distance field has format {found}, but this version reads format {known}")]
    OtherVersion {
        /// The format of the file.
        found: u32,
        /// The format that this version reads.
        known: u32,
    },
    /// Its content does not match its checksum, or contradicts itself.
    #[error("the distance field is damaged: {0}")]
    Damaged(&'static str),
}
