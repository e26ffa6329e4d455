//! The file of a broken mesh.

use canonform::mesh::{TriMesh, shapes};

/// The file of a broken mesh.
pub(super) struct BrokenFile {
    /// Its name, with the extension of its format.
    pub(super) name: &'static str,
    /// What is wrong with it.
    pub(super) defect: &'static str,
    /// Its content.
    pub(super) content: Vec<u8>,
}

/// Broken surfaces, as files.
#[derive(Default)]
pub(super) struct BrokenSurfaces(pub(super) Vec<BrokenFile>);

impl BrokenSurfaces {
    pub(super) fn add(&mut self, name: &'static str, defect: &'static str, mesh: TriMesh) {
        self.0.push(BrokenFile { name, defect, content: off(&mesh) });
    }

    /// Adds a mesh after a change.
    pub(super) fn changed(
        &mut self,
        name: &'static str,
        defect: &'static str,
        mut mesh: TriMesh,
        change: impl FnOnce(&mut TriMesh),
    ) {
        change(&mut mesh);
        self.add(name, defect, mesh);
    }
}

pub(super) fn ball() -> TriMesh {
    shapes::icosphere(2)
}

/// A mesh as text, also with coordinates that our writer refuses.
pub(crate) fn off(mesh: &TriMesh) -> Vec<u8> {
    let mut text = format!("OFF\n{} {} 0\n", mesh.n_vertices(), mesh.n_faces());
    for p in &mesh.positions {
        text += &format!("{:?} {:?} {:?}\n", p.x, p.y, p.z);
    }
    for [a, b, c] in &mesh.faces {
        text += &format!("3 {a} {b} {c}\n");
    }
    text.into_bytes()
}
