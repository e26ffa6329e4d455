//! Dense maps between a whole and what a cut has left of it.

use canonform::descriptors::Side;
use canonform::maps::{
    CorrespondOptions, MapKind, MappedSurface, PartOfWhole, PointMap, VertexMap, correspond,
};
use datasets::{ArticulatedOptions, Damage, Family, articulated_at_rest};
use geodesics::Method;
use mesh::TriMesh;
use nalgebra::Point3;
use rigid::NearestPoints;
use surface::VertexId;

use crate::support::surface;

/// A surface with the places of its vertices on the body at rest.
struct Known {
    mapped: MappedSurface,
    mesh: TriMesh,
    at_rest: NearestPoints,
}

impl Known {
    fn new(mesh: TriMesh, at_rest: Vec<Point3<f64>>) -> Self {
        let mapped = MappedSurface::new(surface(&mesh), &CorrespondOptions::default(), &()).unwrap();
        Self { mapped, mesh, at_rest: NearestPoints::new(at_rest).unwrap() }
    }

    fn pose(family: Family, pose: usize) -> Self {
        let options = ArticulatedOptions { n_vertices: 1500, ..ArticulatedOptions::default() };
        let rested = articulated_at_rest(family, 0, pose, &options, &()).unwrap();
        Self::new(rested.shape.mesh, rested.rest.positions)
    }

    /// What a plane has left of it.
    fn part(&self, share: f64, seed: u64) -> Self {
        let part = Damage::Slice(share).apply(&self.mesh, seed);
        let originals = NearestPoints::new(self.mesh.positions.clone()).unwrap();
        let at_rest = part.positions.iter().map(|p| self.at_rest.points()[originals.nearest(p).0]);
        let at_rest = at_rest.collect();
        Self::new(part, at_rest)
    }

    fn maps_to(&self, other: &Self) -> Vec<VertexMap> {
        correspond(&self.mapped, &other.mapped, &CorrespondOptions::default(), &()).unwrap().maps
    }

    /// The true partner of a vertex, directly (1) or mirrored (-1), and how far away at rest it is.
    fn partner(&self, other: &Self, x: usize, sign: f64) -> (usize, f64) {
        let p = self.at_rest.points()[x];
        let p = Point3::new(sign * p.x, p.y, p.z);
        let y = other.at_rest.nearest(&p).0;
        (y, (other.at_rest.points()[y] - p).norm())
    }

    /// The mean distance on the other surface between images and true partners, over a unit of length.
    fn error(&self, other: &Self, map: &VertexMap, unit: f64) -> f64 {
        let sign = if map.kind == MapKind::Mirrored { -1.0 } else { 1.0 };
        let solver = Method::default().prepare(other.mesh.intrinsic(), &()).unwrap();
        let matched = map.vertices.iter().enumerate().filter_map(|(x, y)| Some((x, (*y)?.index())));
        let error = |(x, y): (usize, usize)| {
            let (truth, _) = self.partner(other, x, sign);
            solver.distances(VertexId::from(truth)).unwrap()[y] / unit
        };
        let errors: Vec<f64> = matched.step_by(10).map(error).collect();
        errors.iter().sum::<f64>() / errors.len() as f64
    }
}

fn of_kind(maps: &[VertexMap], kind: MapKind) -> &VertexMap {
    maps.iter().find(|map| map.kind == kind).unwrap_or_else(|| panic!("no {kind:?} map"))
}

fn part_of(map: &VertexMap) -> &PartOfWhole {
    map.part.as_ref().unwrap_or_else(|| panic!("no map of a part: {}", map.distortion))
}

#[test]
fn a_part_is_mapped_to_where_it_was_in_another_pose_and_back() {
    let whole = Known::pose(Family::Cat, 3);
    let part = Known::pose(Family::Cat, 2).part(0.7, 2);
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
    let whole = Known::pose(Family::David, 0);
    let part = Known::pose(Family::David, 5).part(0.7, 3);
    let unit = whole.mesh.area().sqrt();
    let nearest = |x: usize| part.partner(&whole, x, 1.0);
    // Vertices far from each other that are on both, and their partners.
    let n = part.mesh.n_vertices();
    let pairs = [n / 7, n / 3, n / 2, 6 * n / 7].map(|x| [x, nearest(x).0].map(VertexId::from));
    let mut options = CorrespondOptions::default();
    options.known.landmarks = pairs.to_vec();
    let maps = correspond(&part.mapped, &whole.mapped, &options, &()).unwrap().maps;
    let map = &maps[0];
    let error = part.error(&whole, map, unit);
    println!(
        "{:?}: error {error:.4}, alone {:.4}",
        map.kind,
        part.error(&whole, &part.maps_to(&whole)[0], unit)
    );
    assert!(map.kind == MapKind::Direct && part_of(map).part == Side::First, "{:?}", map.kind);
    assert!(pairs.iter().all(|[x, y]| map.vertices[x.index()] == Some(*y)));
    assert!(error < 0.08, "{error}");
}

#[test]
#[ignore = "slow: make test-all"]
fn an_initial_map_of_a_part_decides_its_orientation() {
    let whole = Known::pose(Family::Cat, 3);
    let part = Known::pose(Family::Cat, 2).part(0.7, 2);
    let unit = whole.mesh.area().sqrt();
    for (from, to, sign) in [(&part, &whole, 1.0), (&part, &whole, -1.0), (&whole, &part, -1.0)] {
        let partner = |x: usize| Some(VertexId::from(from.partner(to, x, sign).0));
        let mut options = CorrespondOptions::default();
        // A third of the vertices.
        options.known.initial =
            (0..from.mesh.n_vertices()).map(|x| partner(x).filter(|_| x % 3 == 0)).collect();
        let maps = correspond(&from.mapped, &to.mapped, &options, &()).unwrap().maps;
        let (map, error) = (&maps[0], from.error(to, &maps[0], unit));
        println!("{sign}: {:?}, error {error:.4}", map.kind);
        let sought = if sign < 0.0 { MapKind::Mirrored } else { MapKind::Direct };
        assert!(map.kind == sought && map.part.is_some(), "{:?} for {sought:?}", map.kind);
        assert!(error < 0.08, "{sought:?}: {error}");
    }
}

#[test]
fn a_piece_of_a_surface_is_mapped_to_itself() {
    let whole = Known::pose(Family::Centaur, 0);
    let part = whole.part(0.7, 1);
    let maps = part.maps_to(&whole);
    let map = of_kind(&maps, MapKind::Direct);
    let error = part.error(&whole, map, whole.mesh.area().sqrt());
    println!("error {error:.4}, distortion {:.4}, confidence {:.2}", map.distortion, map.confidence);
    assert!(part_of(map).part == Side::First && error < 0.03, "{error}");
    // Points go by vertices, both ways; faces go where all of their corners do.
    let sides = [&part, &whole];
    for (of, partners) in [Side::First, Side::Second].into_iter().zip(&part_of(map).partners) {
        let between = map.between(sides.map(|side| &side.mapped));
        let corners = |found: PointMap| found.points.into_iter().map(|p| Some(p?.nearest_corner()));
        assert!(corners(between.vertices(of)).eq(partners.iter().copied()));
        let mesh = &sides[of as usize].mesh;
        let is_mapped = |face: &[VertexId; 3]| face.iter().all(|v| partners[v.index()].is_some());
        let faces = between.faces(of).points;
        assert!(faces.iter().map(Option::is_some).eq(mesh.faces.iter().map(is_mapped)));
    }
    let functional = &map.functional;
    assert!(functional.nrows() < functional.ncols() && functional.iter().all(|c| c.is_finite()));
}

#[test]
fn a_smaller_whole_is_no_part() {
    // Closed, and open with the same shape.
    let whole = Known::pose(Family::Cat, 0);
    let mut small = whole.mesh.clone();
    small.positions.iter_mut().for_each(|p| p.coords *= 0.8);
    let open = |mesh: &TriMesh| TriMesh { faces: mesh.faces[1..].to_vec(), ..mesh.clone() };
    let places = whole.at_rest.points().to_vec();
    for small in [small.clone(), open(&small)] {
        let small = Known::new(small, places.clone());
        let maps = small.maps_to(&whole);
        let map = of_kind(&maps, MapKind::Direct);
        assert!(map.part.is_none(), "{:?}", map.part);
        assert!(small.error(&whole, map, whole.mesh.area().sqrt()) < 0.02);
    }
}
