//! What copies of a mechanical surface have in common.

use canonform::relations::{MeshGeometry, SurfaceInvariants};
use datasets::{Damage, Diagonals, PartMesh, mechanical_parts};
use mesh::{TriMesh, refine};

fn invariants(mesh: &TriMesh) -> SurfaceInvariants {
    MeshGeometry::new(mesh, None).unwrap().invariants()
}

#[test]
fn copies_of_parts_are_not_excluded_by_their_invariants() {
    for part in mechanical_parts(0, 12).iter().step_by(3) {
        let fine = part.mesh(&PartMesh::default());
        let own = invariants(&fine);
        let arcs = [12, 16, 20, 48, 64].map(|arcs| part.mesh(&PartMesh { arcs, ..PartMesh::default() }));
        let even = part.mesh(&PartMesh { diagonals: Diagonals::Even, ..PartMesh::default() });
        let others = [Damage::Subdivide(1), Damage::Mirror, Damage::Scale, Damage::Move];
        let damages = others.into_iter().chain([0.0005, 0.001, 0.002].map(Damage::Noise));
        let refined = refine(&fine, fine.root_of_area() / 12.0, 20_000).mesh;
        let decimated = Damage::Decimate(0.5).apply(&refined, 3);
        let copies =
            damages.map(|damage| damage.apply(&fine, 3)).chain(arcs).chain([even, refined, decimated]);
        for copy in copies {
            let copy = invariants(&copy);
            assert!(own.may_be_copy_of(&copy), "{}: {own:?}, {copy:?}", part.name());
        }
    }
}
