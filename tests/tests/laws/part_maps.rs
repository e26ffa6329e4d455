//! Dense maps between a whole and what a cut has left of it.

use canonform::descriptors::Side;
use canonform::maps::{KnownMap, MapKind, Mapping, PartOfWhole, PointMap, SurfaceMap};
use datasets::Family;
use mesh::TriMesh;
use surface::VertexId;

use crate::rested::{CATS, Rested, maps_with, of_kind};

fn pose(family: Family, pose: usize) -> Rested {
    Rested::pose(family, pose, 1000)
}

fn part_of(map: &SurfaceMap) -> &PartOfWhole {
    map.part.as_ref().unwrap_or_else(|| panic!("no map of a part: {}", map.distortion))
}

#[test]
fn a_part_is_mapped_to_where_it_was_in_another_pose_and_back() {
    let whole = pose(Family::Cat, 3);
    let part = pose(Family::Cat, 2).part(0.7, 2);
    let unit = whole.mesh.area().sqrt();
    let forth = part.maps_to(&whole);
    for kind in [MapKind::Direct, MapKind::Mirrored] {
        let map = of_kind(&forth, kind);
        let PartOfWhole { part: side, covered, .. } = part_of(map);
        let error = part.error(&whole, map, unit);
        println!("{kind:?}: error {error:.4}, {covered:.3} covered, distortion {:.4}", map.distortion);
        assert!(*side == Side::First && (0.6..0.85).contains(covered), "{side:?}: {covered}");
        assert!(error < 0.07 && map.vertices.iter().all(Option::is_some), "{kind:?}: {error}");
    }
    // Points go by vertices, both ways; faces go where all of their corners do.
    let (map, sides) = (of_kind(&forth, MapKind::Direct), [&part, &whole]);
    for (of, partners) in [Side::First, Side::Second].into_iter().zip(&part_of(map).partners) {
        let between = Mapping::new(map, sides.map(|side| &side.mapped));
        let corners = |found: PointMap| found.points.into_iter().map(|p| Some(p?.nearest_corner()));
        assert!(corners(between.vertices(of)).eq(partners.iter().copied()));
        let mesh = &sides[of as usize].mesh;
        let is_mapped = |face: &[VertexId; 3]| face.iter().all(|v| partners[v.index()].is_some());
        let faces = between.faces(of).points;
        assert!(faces.iter().map(Option::is_some).eq(mesh.faces.iter().map(is_mapped)));
    }
    // Back: what is missing has no partner.
    let back = whole.maps_to(&part);
    let map = of_kind(&back, MapKind::Direct);
    assert_eq!(part_of(map).part, Side::Second);
    assert_eq!(part_of(map).covered, part_of(of_kind(&forth, MapKind::Direct)).covered);
    let error = whole.error(&part, map, unit);
    // Beyond a tenth of the square root of the area at rest, 134 units, a vertex is missing for sure.
    let missing: Vec<usize> =
        (0..whole.mesh.n_vertices()).filter(|x| whole.partner(&part, *x, 1.0).1 > 13.4).collect();
    let unmatched = missing.iter().filter(|x| map.vertices[**x].is_none()).count() as f64;
    println!("back: error {error:.4}, {unmatched} of {} missing vertices have no partner", missing.len());
    assert!(error < 0.08, "{error}");
    assert!(unmatched > 0.8 * missing.len() as f64 && !missing.is_empty(), "{unmatched}");
}

#[test]
#[ignore = "slow: make test-all"]
fn landmarks_of_a_part_are_kept_and_decide() {
    let whole = pose(Family::David, 0);
    let part = pose(Family::David, 5).part(0.7, 3);
    let unit = whole.mesh.area().sqrt();
    // Vertices far from each other that are on both, and their partners.
    let n = part.mesh.n_vertices();
    let pairs = [n / 7, n / 3, n / 2, 6 * n / 7].map(|x| [VertexId::from(x), part.partner(&whole, x, 1.0).0]);
    let known = KnownMap { landmarks: pairs.to_vec(), ..KnownMap::default() };
    let maps = maps_with(known, [&part.mapped, &whole.mapped]);
    let map = &maps[0];
    let error = part.error(&whole, map, unit);
    println!("{:?}: error {error:.4}", map.kind);
    assert!(map.kind == MapKind::Direct && part_of(map).part == Side::First, "{:?}", map.kind);
    assert!(pairs.iter().all(|[x, y]| map.vertices[x.index()] == Some(*y)));
    assert!(error < 0.08, "{error}");
}

#[test]
#[ignore = "slow: make test-all"]
fn an_initial_map_of_a_part_decides_its_orientation() {
    let whole = pose(Family::Cat, 3);
    let part = pose(Family::Cat, 2).part(0.7, 2);
    let unit = whole.mesh.area().sqrt();
    for (from, to, sign) in [(&part, &whole, 1.0), (&part, &whole, -1.0), (&whole, &part, -1.0)] {
        // A third of the vertices.
        let partner = |x: usize| x.is_multiple_of(3).then(|| from.partner(to, x, sign).0);
        let initial = (0..from.mesh.n_vertices()).map(partner).collect();
        let known = KnownMap { initial, ..KnownMap::default() };
        let maps = maps_with(known, [&from.mapped, &to.mapped]);
        let (map, error) = (&maps[0], from.error(to, &maps[0], unit));
        println!("{sign}: {:?}, error {error:.4}", map.kind);
        let sought = if sign < 0.0 { MapKind::Mirrored } else { MapKind::Direct };
        assert!(map.kind == sought && map.part.is_some(), "{:?} for {sought:?}", map.kind);
        assert!(error < 0.08, "{sought:?}: {error}");
    }
}

#[test]
fn a_smaller_whole_is_no_part() {
    let whole = &CATS.0[0];
    let positions = whole.mesh.positions.iter().map(|p| p * 0.8).collect();
    // Without a face it is open, as a part would be.
    let small = TriMesh { positions, faces: whole.mesh.faces[1..].to_vec() };
    let small = Rested::new(small, whole.at_rest.points().to_vec());
    let maps = small.maps_to(whole);
    let map = of_kind(&maps, MapKind::Direct);
    assert!(map.part.is_none(), "{:?}", map.part);
    assert!(small.error(whole, map, whole.mesh.area().sqrt()) < 0.02);
}
