//! The surfaces of the parts, put together from prisms, revolved lines and swept circles.

use std::f64::consts::{PI, TAU};

use nalgebra::{Point3, Vector3};

use super::solid::{Loop, Outline, Solid, circle, hexagon, on_circle, rectangle};
use super::{MechanicalPart, PartFamily};
use crate::trig::sin_cos;

/// Diameter of the holes in the floor of an enclosure.
const FLOOR_HOLE: f64 = 3.0;

/// Rows of vertices along one turn of a thread.
const ROWS_PER_TURN: usize = 6;

impl MechanicalPart {
    pub(super) fn build(&self, solid: &mut Solid) {
        let v = &self.values[..];
        let arcs = solid.arcs();
        let disc = |diameter: f64| circle([0.0, 0.0], diameter / 2.0, arcs);
        match self.family {
            PartFamily::Bracket => bracket(solid, v),
            PartFamily::Plate => {
                let holes: Vec<Outline> =
                    plate_holes(v).into_iter().map(|at| circle(at, v[4] / 2.0, arcs)).collect();
                solid.extrude(&rectangle([v[0], v[1]], v[3], arcs), &holes, [0.0, v[2]]);
            }
            PartFamily::Gear => solid.extrude(&gear_outline(v[0], v[1]), &[disc(v[3])], [0.0, v[2]]),
            PartFamily::HexScrew => {
                let size = v[0];
                let [under, top] = solid.prism(&hexagon(1.6 * size), [0.0, 0.7 * size], false);
                solid.cap(&top, &[], Vector3::z());
                let shank = thread(solid, size, v[1], v[2]);
                solid.cap(&under, &[shank], -Vector3::z());
            }
            PartFamily::Enclosure => enclosure(solid, v),
            PartFamily::BentPipe => bent_pipe(solid, v),
            PartFamily::Shaft => {
                let [a, b, c] = [v[0], v[1], v[2]].map(|diameter| diameter / 2.0);
                let [d, e, f] = [v[3], v[3] + v[4], v[3] + v[4] + v[5]];
                solid.revolve(&[[a, 0.0], [a, d], [b, d], [b, e], [c, e], [c, f]]);
            }
            PartFamily::Block => solid.extrude(&rectangle([v[0], v[1]], 0.0, arcs), &[], [0.0, v[2]]),
        }
    }
}

fn plate_holes(v: &[f64]) -> Vec<[f64; 2]> {
    let columns = v[5] as usize / 2;
    let [x, y] = [v[0] / 2.0 - 5.0, v[1] / 2.0 - 5.0];
    let column = |i: usize| -x + 2.0 * x * i as f64 / (columns - 1) as f64;
    (0..columns).flat_map(|i| [[column(i), -y], [column(i), y]]).collect()
}

/// Teeth with straight flanks between the circles of roots and tips.
fn gear_outline(teeth: f64, module: f64) -> Outline {
    let [root, tip] = [module * (teeth / 2.0 - 1.25), module * (teeth / 2.0 + 1.0)];
    let tooth = |i: usize| {
        [(root, -0.3), (tip, -0.12), (tip, 0.12), (root, 0.3)]
            .map(|(radius, turn)| on_circle([0.0, 0.0], radius, TAU * (i as f64 + turn) / teeth))
    };
    (0..teeth as usize).flat_map(tooth).collect()
}

/// An L in the plane of x and z, drawn along y; the holes go through the legs along z and x.
fn bracket(solid: &mut Solid, v: &[f64]) {
    let &[length, height, width, t, diameter, holes] = v else { return };
    let profile = [[0.0, 0.0], [length, 0.0], [length, t], [t, t], [t, height], [0.0, height]];
    let [front, back] = [0.0, width].map(|y| solid.ring(profile.iter().map(|&[x, z]| Point3::new(x, y, z))));
    solid.cap(&front, &[], -Vector3::y());
    solid.cap(&back, &[], Vector3::y());
    let side = |i: usize| [front[i], front[(i + 1) % 6], back[(i + 1) % 6], back[i]];
    solid.cap(&side(1), &[], Vector3::x());
    solid.cap(&side(4), &[], Vector3::z());
    // Seen against the direction of a leg, all its loops run the same way.
    for (leg, up, outer, inner) in [(length, Vector3::z(), 0, 2), (height, Vector3::x(), 5, 3)] {
        let mut rims: [Vec<Loop>; 2] = Default::default();
        for hole in 0..holes as usize {
            let along = t + (leg - t) * (hole as f64 + 1.0) / (holes + 1.0);
            let outline = circle([along, width / 2.0], diameter / 2.0, solid.arcs());
            let place = |depth: f64| {
                move |&[a, b]: &[f64; 2]| {
                    if up.z > 0.0 { Point3::new(a, b, depth) } else { Point3::new(depth, b, a) }
                }
            };
            let lower = solid.ring(outline.iter().map(place(0.0)));
            let upper = solid.ring(outline.iter().map(place(t)));
            // Exchanging x and z turns the circle over.
            let [from, to] = if up.z > 0.0 { [&upper, &lower] } else { [&lower, &upper] };
            solid.wall(from, to);
            rims[0].push(lower);
            rims[1].push(upper);
        }
        solid.cap(&side(outer), &rims[0], -up);
        solid.cap(&side(inner), &rims[1], up);
    }
}

/// A threaded shank from z = 0 down to its end, which is closed: the loop at its upper end. The thread fades out within
/// one turn of the ends.
fn thread(solid: &mut Solid, size: f64, length: f64, hand: f64) -> Loop {
    let (pitch, depth, arcs) = (0.1 * size + 0.3, 0.06 * size + 0.18, solid.arcs());
    let rows = (length / pitch).ceil() as usize * ROWS_PER_TURN;
    let rings: Vec<Loop> = (0..=rows)
        .map(|row| {
            let z = -length * row as f64 / rows as f64;
            let fade = (z + length).min(-z).min(pitch) / pitch;
            let point = |i: usize| {
                let turn = i as f64 / arcs as f64;
                let phase = (z / pitch - hand * turn).rem_euclid(1.0);
                let radius = size / 2.0 - depth * fade * (2.0 * phase - 1.0).abs();
                let [x, y] = on_circle([0.0, 0.0], radius, TAU * turn);
                Point3::new(x, y, z)
            };
            solid.ring((0..arcs).map(point))
        })
        .collect();
    rings.windows(2).for_each(|pair| solid.wall(&pair[1], &pair[0]));
    solid.cap(&rings[rows], &[], -Vector3::z());
    rings[0].clone()
}

fn enclosure(solid: &mut Solid, v: &[f64]) {
    let &[length, width, height, wall, holes] = v else { return };
    let arcs = solid.arcs();
    let [under, top] = solid.prism(&rectangle([length, width], 0.0, arcs), [0.0, height], false);
    let inner = rectangle([length - 2.0 * wall, width - 2.0 * wall], 0.0, arcs);
    let [floor, rim] = solid.prism(&inner, [wall, height], true);
    solid.cap(&top, &[rim], Vector3::z());
    let [x, y] = [length / 2.0 - 8.0, width / 2.0 - 8.0];
    let places = [[-x, -y], [x, y], [-x, y], [x, -y]];
    let outlines = places.map(|at| circle(at, FLOOR_HOLE / 2.0, arcs));
    let [lower, upper] = solid.bores(&outlines[..holes as usize], [0.0, wall]);
    solid.cap(&under, &lower, -Vector3::z());
    solid.cap(&floor, &upper, Vector3::z());
}

/// From the origin along z, then bent towards x.
fn bent_pipe(solid: &mut Solid, v: &[f64]) {
    let &[diameter, wall, bend, degrees, straight] = v else { return };
    let angle = degrees * (PI / 180.0);
    let steps = (solid.arcs() as f64 * degrees / 360.0).ceil() as usize + 1;
    let forward = |turn: f64| {
        let (sin, cos) = sin_cos(turn);
        Vector3::new(sin, 0.0, cos)
    };
    let mut stations = vec![(Point3::origin(), 0.0)];
    stations.extend((0..=steps).map(|i| {
        let turn = angle * i as f64 / steps as f64;
        let (sin, cos) = sin_cos(turn);
        (Point3::new(bend * (1.0 - cos), 0.0, straight + bend * sin), turn)
    }));
    stations.push((stations[steps + 1].0 + forward(angle) * straight, angle));

    let mut tube = |radius: f64| -> Vec<Loop> {
        let outline = circle([0.0, 0.0], radius, solid.arcs());
        let place = |&(center, turn): &(Point3<f64>, f64)| {
            let (sin, cos) = sin_cos(turn);
            let across = Vector3::new(cos, 0.0, -sin);
            solid.ring(outline.iter().map(|&[a, b]| center + across * a + Vector3::y() * b))
        };
        stations.iter().map(place).collect()
    };
    let [outer, inner] = [diameter / 2.0, diameter / 2.0 - wall].map(&mut tube);
    outer.windows(2).for_each(|pair| solid.wall(&pair[0], &pair[1]));
    inner.windows(2).for_each(|pair| solid.wall(&pair[1], &pair[0]));
    solid.cap(&outer[0], &inner[..1], -forward(0.0));
    solid.cap(&outer[steps + 2], &inner[steps + 2..], forward(angle));
}
