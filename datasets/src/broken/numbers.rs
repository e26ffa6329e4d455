//! Surfaces whose coordinates are at the limits of what numbers hold.

use mesh::{TriMesh, shapes};
use nalgebra::{Point3, Vector3};

use super::file::{BrokenFile, off};

fn scaled(mut mesh: TriMesh, factor: f64) -> TriMesh {
    mesh.positions.iter_mut().for_each(|p| p.coords *= factor);
    mesh
}

pub(super) fn extreme() -> Vec<BrokenFile> {
    let mut all = Vec::new();
    let mut add = |name, defect, mesh: TriMesh| all.push(BrokenFile { name, defect, content: off(&mesh) });
    let ball = || shapes::icosphere(2);
    let changed = |mut mesh: TriMesh, change: &dyn Fn(usize, &mut Point3<f64>)| {
        mesh.positions.iter_mut().enumerate().for_each(|(v, p)| change(v, p));
        mesh
    };

    add("one-point.off", "all vertices in one position", changed(ball(), &|_, p| *p = Point3::origin()));
    add("line.off", "all vertices on a line", changed(ball(), &|_, p| *p = Point3::new(p.x, 0.0, 0.0)));
    add("zero-edge.off", "an edge of length zero", {
        let mut mesh = ball();
        let [a, b, _] = mesh.faces[9];
        mesh.positions[a.index()] = mesh.positions[b.index()];
        mesh
    });
    add("zero-area.off", "a face without area", {
        let mut mesh = shapes::grid(6, 5, 1.0);
        let [_, b, c] = mesh.faces[9].map(|v| mesh.positions[v.index()]);
        mesh.positions[mesh.faces[9][0].index()] = b + (c - b) * 0.5;
        mesh
    });
    add(
        "needles.off",
        "a thousand times longer than wide",
        changed(shapes::grid(12, 9, 1.0), &|_, p| p.x *= 1e-3),
    );
    add(
        "slivers.off",
        "a billion times longer than wide",
        changed(shapes::grid(12, 9, 1.0), &|_, p| p.x *= 1e-9),
    );
    add(
        "crumpled.off",
        "noise as large as the edges",
        changed(ball(), &|v, p| {
            let noise = |k: usize| ((v * 7919 + k * 104_729) % 1000) as f64 / 1000.0 - 0.5;
            *p += Vector3::new(noise(1), noise(2), noise(3)) * 0.6;
        }),
    );
    add(
        "mixed.off",
        "edges from 1e-12 to 1 in one surface",
        changed(shapes::grid(12, 9, 1.0), &|_, p| {
            p.x = 10f64.powf(p.x - 11.0);
        }),
    );
    add("tiny.off", "coordinates of 1e-12", scaled(ball(), 1e-12));
    add("minute.off", "coordinates of 1e-100", scaled(ball(), 1e-100));
    add("subnormal.off", "coordinates of 1e-310", scaled(ball(), 1e-310));
    add("large.off", "coordinates of 1e12", scaled(ball(), 1e12));
    add("huge.off", "coordinates of 1e100", scaled(ball(), 1e100));
    add("overflow.off", "coordinates of 1e300, whose squares overflow", scaled(ball(), 1e300));
    add("far.off", "a hundred million edges away from the origin", changed(ball(), &|_, p| p.x += 3e7));
    add("lost.off", "so far away that all digits are lost", changed(ball(), &|_, p| p.x += 1e17));
    add(
        "sandwich.off",
        "two sheets in the same position",
        shapes::disjoint(&[shapes::grid(8, 6, 1.0), shapes::grid(8, 6, 1.0)]),
    );
    add("strip.off", "a strip of 4,000 squares in a row", shapes::grid(4001, 2, 1.0));
    all
}
