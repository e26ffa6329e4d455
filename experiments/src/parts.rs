//! Copies of mechanical parts.

use datasets::{Damage, Diagonals, LabeledShape, MechanicalPart, PartMesh, mechanical_parts};
use mesh::{TriMesh, refine};
use rayon::prelude::*;
use surface::VertexId;

/// The part as other programs would write it: no two of the copies differ in shape by more than their arcs do.
pub(crate) fn copies(part: &MechanicalPart) -> Vec<TriMesh> {
    let with_arcs = |arcs| part.mesh(&PartMesh { arcs, ..PartMesh::default() });
    let mesh = part.mesh(&PartMesh::default());
    let refined = refine(&mesh, mesh.root_of_area() / 12.0, 20_000).mesh;
    let moved = |mesh: &TriMesh| Damage::Move.apply(mesh, 7);
    let even = part.mesh(&PartMesh { diagonals: Diagonals::Even, ..PartMesh::default() });
    vec![
        Damage::Decimate(0.5).apply(&refined, 7),
        moved(&Damage::Mirror.apply(&even, 7)),
        moved(&with_arcs(48)),
        in_inches(&moved(&with_arcs(64))),
        moved(&Damage::Subdivide(1).apply(&mesh, 7)),
        with_arcs(20),
        refined,
        moved(&even),
        moved(&mesh),
        renumbered(&mesh),
        in_inches(&mesh),
        Damage::Mirror.apply(&mesh, 7),
    ]
}

/// Parts with copies of each, `n_copies` in all; the class of a shape is its part.
pub(crate) fn parts(seed: u64, n_parts: usize, n_copies: usize) -> Vec<LabeledShape> {
    let shapes = mechanical_parts(seed, n_parts).into_par_iter().flat_map_iter(|part| {
        let label = part.name();
        let meshes = std::iter::once(part.mesh(&PartMesh::default())).chain(copies(&part));
        let shape = |(i, mesh)| LabeledShape { name: format!("{label}-copy{i}"), label: label.clone(), mesh };
        meshes.take(n_copies).enumerate().map(shape).collect::<Vec<_>>()
    });
    shapes.collect()
}

fn in_inches(mesh: &TriMesh) -> TriMesh {
    mesh.moved(|p| p / 25.4)
}

/// Rounded to 32 bits, with vertices and faces in another order.
fn renumbered(mesh: &TriMesh) -> TriMesh {
    let n = mesh.n_vertices();
    let other = |v: VertexId| VertexId::from(n - 1 - v.index());
    TriMesh {
        positions: mesh.positions.iter().rev().map(|p| p.map(|x| f64::from(x as f32))).collect(),
        faces: mesh.faces.iter().rev().map(|[a, b, c]| [*b, *c, *a].map(other)).collect(),
    }
}
