//! A zoo of broken meshes: files that are damaged, surfaces with defects, and surfaces at the limits of numbers.
//!
//! What the programs say about each of them, what they repair and what comes out is the table in
//! `docs/broken-meshes.md`, which a test keeps true.

mod defects;
mod files;
mod numbers;

use mesh::TriMesh;

/// The file of a broken mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BrokenFile {
    /// Its name, with the extension of its format.
    pub name: &'static str,
    /// What is wrong with it.
    pub defect: &'static str,
    /// Its content.
    pub content: Vec<u8>,
}

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

/// A mesh as text, also with coordinates that our writer refuses.
fn off(mesh: &TriMesh) -> Vec<u8> {
    let mut text = format!("OFF\n{} {} 0\n", mesh.n_vertices(), mesh.n_faces());
    for p in &mesh.positions {
        text += &format!("{:?} {:?} {:?}\n", p.x, p.y, p.z);
    }
    for [a, b, c] in &mesh.faces {
        text += &format!("3 {a} {b} {c}\n");
    }
    text.into_bytes()
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
