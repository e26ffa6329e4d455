//! A zoo of broken meshes: files that are damaged, surfaces with defects, and surfaces at the limits of numbers.
//!
//! What the programs say about each of them, what they repair and what comes out is the table in
//! `crates/cli/tests/broken-meshes.tsv`, which a test keeps true.

mod defects;
mod file;
mod files;
mod numbers;

pub use file::BrokenFile;

/// All broken meshes, in the order of the table: damaged files, defects of the surface, limits of numbers.
///
/// ```
/// let zoo = canonform_datasets::broken_meshes();
/// assert!(zoo.len() >= 60);
/// assert!(zoo.iter().any(|file| file.name == "moebius.off"));
/// ```
#[must_use]
pub fn broken_meshes() -> Vec<BrokenFile> {
    let mut all = files::damaged();
    all.extend(defects::defective());
    all.extend(numbers::extreme());
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_contents_are_unique() {
        let zoo = broken_meshes();
        for (i, a) in zoo.iter().enumerate() {
            assert!(a.name.contains('.') && !a.defect.is_empty(), "{}", a.name);
            for b in &zoo[..i] {
                assert!(a.name != b.name && a.content != b.content, "{} and {}", a.name, b.name);
            }
        }
    }
}
