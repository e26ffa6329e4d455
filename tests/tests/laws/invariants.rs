//! What copies of a mechanical surface have in common.

use canonform::relations::{MeshGeometry, SurfaceInvariants};
use datasets::{Damage, Diagonals, PartMesh, mechanical_parts};
use mesh::{TriMesh, refine};

fn invariants(mesh: &TriMesh) -> SurfaceInvariants {
    MeshGeometry::new(mesh, None).unwrap().invariants()
}

/// The largest difference of spreads or volumes, and the error of flat triangles in both.
fn difference(a: &SurfaceInvariants, b: &SurfaceInvariants) -> [f64; 2] {
    let spreads = a.spreads.iter().zip(&b.spreads).map(|(x, y)| (x - y).abs());
    let volumes = a.closed.zip(b.closed).map(|((x, _), (y, _))| (x - y).abs());
    let chords = [a, b].map(|part| part.chords);
    [spreads.chain(volumes).fold(0.0, f64::max), chords[0] + chords[1]]
}

#[test]
fn invariants_of_copies_differ_by_the_error_of_flat_triangles() {
    let mut largest = 0.0_f64;
    for part in mechanical_parts(0, 12) {
        let fine = part.mesh(&PartMesh::default());
        let own = invariants(&fine);
        let arcs = [12, 16, 20, 48, 64].map(|arcs| part.mesh(&PartMesh { arcs, ..PartMesh::default() }));
        let even = part.mesh(&PartMesh { diagonals: Diagonals::Even, ..PartMesh::default() });
        let damages = [Damage::Subdivide(1), Damage::Mirror, Damage::Scale, Damage::Move];
        let refined = refine(&fine, fine.root_of_area() / 12.0, 20_000).mesh;
        let decimated = Damage::Decimate(0.5).apply(&refined, 3);
        let copies =
            damages.iter().map(|damage| damage.apply(&fine, 3)).chain(arcs).chain([even, refined, decimated]);
        for copy in copies {
            let copy = invariants(&copy);
            assert!(own.may_be_copy_of(&copy), "{}: {own:?}, {copy:?}", part.name());
            let [off, chords] = difference(&own, &copy);
            largest = largest.max((off - 5e-4) / chords);
        }
    }
    println!("invariants differ by at most 5e-4 and {largest:.2} times the error of flat triangles");
}
