//! Surfaces whose coordinates are at the limits of what numbers hold.

use canonform::mesh::{TriMesh, shapes};
use nalgebra::{Point3, Vector3};

use super::file::{BrokenFile, BrokenSurfaces, ball};

fn each(mut mesh: TriMesh, change: impl Fn(&mut Point3<f64>)) -> TriMesh {
    mesh.positions.iter_mut().for_each(change);
    mesh
}

pub(super) fn extreme() -> Vec<BrokenFile> {
    let mut zoo = BrokenSurfaces::default();
    zoo.add("one-point.off", "all vertices in one position", each(ball(), |p| *p = Point3::origin()));
    zoo.add("line.off", "all vertices on a line", each(ball(), |p| *p = Point3::new(p.x, 0.0, 0.0)));
    zoo.changed("zero-edge.off", "an edge of length zero", ball(), |mesh| {
        let [a, b, _] = mesh.faces[9];
        mesh.positions[a.index()] = mesh.positions[b.index()];
    });
    zoo.changed("zero-area.off", "a face without area", shapes::grid(6, 5, 1.0), |mesh| {
        let [_, b, c] = mesh.faces[9].map(|v| mesh.positions[v.index()]);
        mesh.positions[mesh.faces[9][0].index()] = b + (c - b) * 0.5;
    });
    let sheet = || shapes::grid(12, 9, 1.0);
    zoo.add("needles.off", "a thousand times longer than wide", each(sheet(), |p| p.x *= 1e-3));
    zoo.add("slivers.off", "a billion times longer than wide", each(sheet(), |p| p.x *= 1e-9));
    zoo.changed("crumpled.off", "noise as large as the edges", ball(), |mesh| {
        for (v, p) in mesh.positions.iter_mut().enumerate() {
            let noise = |k: usize| ((v * 7919 + k * 104_729) % 1000) as f64 / 1000.0 - 0.5;
            *p += Vector3::new(noise(1), noise(2), noise(3)) * 0.6;
        }
    });
    let mixed = each(sheet(), |p| p.x = 10f64.powf(p.x - 11.0));
    zoo.add("mixed.off", "edges from 1e-12 to 1 in one surface", mixed);
    for (name, defect, factor) in [
        ("tiny.off", "coordinates of 1e-12", 1e-12),
        ("minute.off", "coordinates of 1e-100", 1e-100),
        ("subnormal.off", "coordinates of 1e-310", 1e-310),
        ("large.off", "coordinates of 1e12", 1e12),
        ("huge.off", "coordinates of 1e100", 1e100),
        ("overflow.off", "coordinates of 1e300, whose squares overflow", 1e300),
    ] {
        zoo.add(name, defect, each(ball(), |p| p.coords *= factor));
    }
    zoo.add("far.off", "a hundred million edges away from the origin", each(ball(), |p| p.x += 3e7));
    zoo.add("lost.off", "so far away that all digits are lost", each(ball(), |p| p.x += 1e17));
    let sheets = shapes::disjoint(&[shapes::grid(8, 6, 1.0), shapes::grid(8, 6, 1.0)]);
    zoo.add("sandwich.off", "two sheets in the same position", sheets);
    zoo.add("strip.off", "a strip of 4,000 squares in a row", shapes::grid(4001, 2, 1.0));
    zoo.0
}
