//! Surfaces with defects of connectivity.

use canonform::mesh::{TriMesh, shapes};
use canonform::surface::VertexId;
use nalgebra::{Point3, Vector3};

use super::file::{BrokenFile, BrokenSurfaces, ball};

fn face(corners: [usize; 3]) -> [VertexId; 3] {
    corners.map(VertexId::from)
}

fn moved(mut mesh: TriMesh, by: [f64; 3]) -> TriMesh {
    mesh.positions.iter_mut().for_each(|p| *p += Vector3::from(by));
    mesh
}

/// A body with a hundredth of the size of the ball.
fn crumb(at: [f64; 3]) -> TriMesh {
    let mut mesh = shapes::tetrahedron(0);
    mesh.positions.iter_mut().for_each(|p| p.coords *= 0.01);
    moved(mesh, at)
}

/// Gives every face corners of its own.
fn soup(mesh: &TriMesh) -> TriMesh {
    let positions = mesh.faces.iter().flatten().map(|v| mesh.positions[v.index()]).collect();
    let faces = (0..mesh.n_faces()).map(|f| face([3 * f, 3 * f + 1, 3 * f + 2])).collect();
    TriMesh { positions, faces }
}

/// Cuts a mesh along the plane z = 0 of its vertices: faces below it get copies of the vertices near it, moved by `gap`.
fn cut(mesh: &TriMesh, gap: impl Fn(usize) -> f64) -> TriMesh {
    let mut cut = mesh.clone();
    let mut copies = vec![None; mesh.n_vertices()];
    let is_below = |f: &[VertexId; 3]| f.iter().map(|v| mesh.positions[v.index()].z).sum::<f64>() < 0.0;
    let mut above = vec![false; mesh.n_vertices()];
    for v in mesh.faces.iter().filter(|f| !is_below(f)).flatten() {
        above[v.index()] = true;
    }
    for f in 0..mesh.n_faces() {
        if !is_below(&mesh.faces[f]) {
            continue;
        }
        for v in &mut cut.faces[f] {
            if above[v.index()] {
                let at = v.index();
                *v = *copies[at].get_or_insert_with(|| {
                    cut.positions.push(mesh.positions[at] - Vector3::z() * gap(at));
                    VertexId::from(cut.positions.len() - 1)
                });
            }
        }
    }
    cut
}

/// All triangles over `n` points of a helix.
fn all_triangles(n: usize) -> TriMesh {
    let positions = (0..n).map(|i| {
        let t = i as f64;
        Point3::new(t.cos(), t.sin(), 0.1 * t)
    });
    let mut faces = Vec::new();
    for a in 0..n {
        for b in a + 1..n {
            faces.extend((b + 1..n).map(|c| face([a, b, c])));
        }
    }
    TriMesh { positions: positions.collect(), faces }
}

/// `n` triangles around one vertex.
fn fan(n: usize) -> TriMesh {
    let mut positions = vec![Point3::origin()];
    positions.extend((0..n).map(|i| {
        let angle = std::f64::consts::TAU * i as f64 / n as f64;
        Point3::new(angle.cos(), angle.sin(), 0.0)
    }));
    TriMesh { positions, faces: (0..n).map(|i| face([0, 1 + i, 1 + (i + 1) % n])).collect() }
}

/// A band of `n` quadrilaterals with half a twist.
fn moebius(n: usize) -> TriMesh {
    let mut positions = Vec::new();
    for i in 0..n {
        let angle = std::f64::consts::TAU * i as f64 / n as f64;
        for side in [-0.3, 0.3] {
            let (r, z) = (1.0 + side * (angle / 2.0).cos(), side * (angle / 2.0).sin());
            positions.push(Point3::new(r * angle.cos(), r * angle.sin(), z));
        }
    }
    let mut faces = Vec::new();
    for i in 0..n {
        let next = if i + 1 < n { [2 * i + 2, 2 * i + 3] } else { [1, 0] };
        faces.push(face([2 * i, next[0], 2 * i + 1]));
        faces.push(face([2 * i + 1, next[0], next[1]]));
    }
    TriMesh { positions, faces }
}

/// The projective plane with six vertices, every two of which are joined by an edge.
fn projective_plane() -> TriMesh {
    let positions = (0..6).map(|i| {
        let angle = f64::from(i);
        Point3::new(angle.cos(), angle.sin(), f64::from(i % 3))
    });
    // Around vertex 0, and between the others.
    let faces = (1..6).map(|i| [0, i, i % 5 + 1]).chain((1..6).map(|i| [i, i % 5 + 1, (i + 2) % 5 + 1]));
    TriMesh { positions: positions.collect(), faces: faces.map(face).collect() }
}

pub(super) fn defective() -> Vec<BrokenFile> {
    let mut zoo = BrokenSurfaces::default();
    degenerate_faces(&mut zoo);
    open_surfaces(&mut zoo);
    several_bodies(&mut zoo);
    non_manifold(&mut zoo);
    without_a_side(&mut zoo);
    zoo.add("fan.off", "2,000 faces around one vertex", fan(2000));
    zoo.add("triangle.off", "a single triangle", TriMesh { faces: vec![face([0, 1, 2])], ..fan(5) });
    zoo.add("two-triangles.off", "two triangles", shapes::grid(2, 2, 1.0));
    zoo.0
}

fn degenerate_faces(zoo: &mut BrokenSurfaces) {
    zoo.changed("repeated-corner.off", "a face with one vertex twice", ball(), |m| {
        m.faces[9][1] = m.faces[9][0];
    });
    zoo.changed("no-usable-face.off", "only faces with one vertex twice", ball(), |m| {
        m.faces.iter_mut().for_each(|f| f[1] = f[0]);
    });
    zoo.changed("duplicate-face.off", "a face twice", ball(), |m| m.faces.push(m.faces[9]));
    zoo.changed("reversed-duplicate.off", "a face twice, once reversed", ball(), |m| {
        let [a, b, c] = m.faces[9];
        m.faces.push([a, c, b]);
    });
    zoo.changed("doubled.off", "every face twice, once reversed", ball(), |m| {
        let reversed: Vec<_> = m.faces.iter().map(|&[a, b, c]| [a, c, b]).collect();
        m.faces.extend(reversed);
    });
    zoo.changed("stray-vertices.off", "ten vertices without a face", ball(), |m| {
        m.positions.extend((0..10).map(|i| Point3::new(f64::from(i), 5.0, 5.0)));
    });
}

fn open_surfaces(zoo: &mut BrokenSurfaces) {
    zoo.add("soup.off", "every face with corners of its own", soup(&ball()));
    zoo.add("seam.off", "cut along the equator, the copies in the same positions", cut(&ball(), |_| 0.0));
    let loose = cut(&ball(), |v| 1e-6 * (v % 7) as f64);
    zoo.add("loose-seam.off", "cut along the equator, the copies 1e-6 away", loose);
    zoo.add("gap.off", "cut along the equator, the copies a fifth of an edge away", cut(&ball(), |_| 0.06));
    zoo.changed("hole.off", "one face missing", ball(), |m| m.faces.truncate(319));
    zoo.changed("half.off", "half of the faces missing", ball(), |m| {
        m.faces.retain(|f| f.iter().all(|v| v.0 % 3 != 1));
    });
    zoo.changed("sieve.off", "every fifth face missing", ball(), |m| {
        let mut i = 0;
        m.faces.retain(|_| {
            i += 1;
            i % 5 != 0
        });
    });
}

fn several_bodies(zoo: &mut BrokenSurfaces) {
    let pair = |by: [f64; 3]| shapes::disjoint(&[ball(), moved(ball(), by)]);
    zoo.add("twins.off", "two components of one size", pair([3.0, 0.0, 0.0]));
    zoo.add("crumb.off", "a small second component", shapes::disjoint(&[ball(), crumb([9.0; 3])]));
    let crumbs = (0..60).map(|i| moved(shapes::tetrahedron(0), [f64::from(i) * 3.0, 0.0, 0.0]));
    zoo.add("crumbs.off", "sixty components", shapes::disjoint(&crumbs.collect::<Vec<_>>()));
    let mut inner = ball();
    inner.positions.iter_mut().for_each(|p| p.coords *= 0.5);
    zoo.add("nested.off", "a body inside another", shapes::disjoint(&[shapes::icosphere(3), inner]));
    zoo.add("crossing.off", "two bodies that cross", pair([0.7, 0.0, 0.0]));
    let two = shapes::disjoint(&[shapes::tetrahedron(2), shapes::tetrahedron(2)]);
    zoo.changed("touching-vertex.off", "two bodies that share a vertex", two, |both| {
        let n = shapes::tetrahedron(2).n_vertices();
        let by = both.positions[0] - both.positions[n + 1];
        both.positions[n..].iter_mut().for_each(|p| *p += by);
        both.faces.iter_mut().flatten().filter(|v| v.index() == n + 1).for_each(|v| *v = VertexId(0));
    });
}

fn non_manifold(zoo: &mut BrokenSurfaces) {
    zoo.changed("fin.off", "a third face on an edge", ball(), |m| {
        m.faces.push([m.faces[0][0], m.faces[0][1], m.faces[200][2]]);
    });
    let mut positions = vec![Point3::origin(), Point3::new(0.0, 0.0, 1.0)];
    positions.extend((0..10).map(|i| Point3::new(f64::from(i).cos(), f64::from(i).sin(), 0.5)));
    let faces = (0..10).map(|i| face([0, 1, 2 + i])).collect();
    zoo.add("book.off", "ten faces on one edge", TriMesh { positions, faces });
    zoo.add("all-triangles.off", "all triangles over ten points", all_triangles(10));
    zoo.changed("wall.off", "a wall through a closed body", ball(), |m| {
        let mut rim: Vec<usize> = (0..m.n_vertices()).filter(|&v| m.positions[v].z.abs() < 1e-9).collect();
        let angle = |v: usize| m.positions[v].y.atan2(m.positions[v].x);
        rim.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
        let centre = m.n_vertices();
        m.positions.push(Point3::origin());
        for (i, &a) in rim.iter().enumerate() {
            m.faces.push(face([a, rim[(i + 1) % rim.len()], centre]));
        }
    });
    let points = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, -1.0], [2.0, -1.0]];
    let positions = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
    let faces = [[0, 1, 2], [0, 4, 3], [3, 4, 5], [3, 5, 1]].map(face).to_vec();
    zoo.add("t-junction.off", "a vertex on the edge of another face", TriMesh { positions, faces });
}

fn without_a_side(zoo: &mut BrokenSurfaces) {
    zoo.changed("flipped.off", "every third face reversed", ball(), |m| {
        m.faces.iter_mut().step_by(3).for_each(|f| f.swap(0, 1));
    });
    zoo.changed("inside-out.off", "every face reversed", ball(), |m| {
        m.faces.iter_mut().for_each(|f| f.swap(0, 1));
    });
    zoo.add("moebius.off", "a band with one side", moebius(40));
    zoo.add("projective-plane.off", "a closed surface with one side", projective_plane());
}
