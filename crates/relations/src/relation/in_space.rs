//! How far two surfaces are apart in space, after the best motion, reflection and change of size.

use descriptors::{Alignment, FormAlignment, Reflections, align_forms};
use nalgebra::{
    Matrix3, Point3, Rotation3, SMatrix, SVector, SymmetricEigen, U3, Unit, UnitQuaternion, Vector3,
};
use serde::Serialize;

use super::exact::{Similarity, of_frames};
use super::geometry::MeshGeometry;

/// Surfaces of one spread whose spreads along a principal axis differ by more than this are not aligned: they are farther apart
/// than any copy of a surface (`cargo test -p tests --test laws matches`).
const MOST_SPREAD: f64 = 0.05;

/// Samples of either surface that refine an alignment.
const REFINING: usize = 400;

/// Most steps of a refinement; it ends earlier once the distance is reduced by less than [`LEAST_GAIN`].
const STEPS: usize = 30;

/// The share by which a step of a refinement must reduce the distance. A tolerance.
const LEAST_GAIN: f64 = 1e-3;

/// Axes whose spreads differ by less than this factor may be turned into each other, so that turned starts are tried too. A
/// safety limit: more starts cost time only.
const NEAR_EQUAL_AXES: f64 = 1.05;

/// Turned starts are tried unless the surfaces are nearer than this, relative to the size. A safety limit: other bodies are at
/// least 0.0045 apart (`cargo test -p tests --test laws matches`).
const CLOSE: f64 = 0.003;

/// Mechanical parts that are nearer than this are aligned: their planes lie in each other. A tolerance of rounding.
const SEATED: f64 = 1e-5;

/// Directions of planes and axes that are tried for frames and mirror planes, those with the largest area. A safety limit.
const MOST_DIRECTIONS: usize = 6;

/// Directions that span a frame are at least this far from parallel (sine). A safety limit.
const ACROSS: f64 = 0.2;

/// Shares of the area, and half of the cosines, that differ by less than this are alike, so that more frames are tried. A
/// safety limit.
const ALIKE: f64 = 0.025;

/// Turned starts about one axis, and about all, the samples that rank them, and how many of them are refined.
const TURNS: usize = 36;
const ORIENTATIONS: usize = 300;
const RANKING: usize = 60;
const RANKED: usize = 4;

/// A surface is the mirror image of another, and not the same, if the distance is smaller with a reflection: by this factor
/// and by [`EXCESS`]. A safety limit.
const DECISIVE: f64 = 1.25;

/// Least difference of both distances in the mean square. A tolerance: the distances of a surface that is its own mirror image are
/// those at which the refinement ends.
const EXCESS: f64 = 1e-4;

/// An alignment of the samples is refined unless the other handedness is better by this factor, and one that is refined counts
/// unless the best is better by it. A safety limit: it saves time.
const PROMISING: f64 = 1.6;

/// How far two surfaces are apart after alignment in space, relative to the size of the second: the square root of its area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SurfaceGap {
    /// Root mean square distance from points of either surface to the other.
    pub rms: f64,
    /// The largest of these distances.
    pub max: f64,
}

/// Two surfaces laid over each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Aligned {
    /// Takes the first surface, at unit area, onto the second, at unit area. With a reflection only if the surfaces fit
    /// decisively better.
    pub(super) map: Similarity,
    pub(super) gap: SurfaceGap,
}

impl Aligned {
    /// By a map.
    pub(super) fn by(a: &MeshGeometry, b: &MeshGeometry, map: Similarity) -> Option<Self> {
        gap(a, b, &map, usize::MAX).map(|gap| Self { map, gap })
    }
}

/// Aligns two surfaces in space; `None` if their extents differ too much to be one surface.
pub(super) fn aligned(a: &MeshGeometry, b: &MeshGeometry) -> Option<Aligned> {
    let [spreads_a, spreads_b] = [a, b].map(|geometry| geometry.spreads.map(|x| x / geometry.spread()));
    if spreads_a.iter().zip(&spreads_b).any(|(x, y)| (x - y).abs() > MOST_SPREAD) {
        return None;
    }
    let start = |by| Some(align_forms(a.form()?, b.form()?, by));
    let [proper, reflected] = [start(Reflections::Forbid)?, start(Reflections::Require)?];
    let turnable = equal_axes(a, b) != [false; 2];
    let worth = |mine: FormAlignment, other: FormAlignment| turnable || mine.rms < PROMISING * other.rms;
    let found =
        |start: FormAlignment, is_worth: bool| if is_worth { best(a, b, &start.alignment) } else { None };
    let proper_found = found(proper, worth(proper, reflected));
    // No reflection is decisively better than a map that is as good as refinement ends.
    let is_found = proper_found.is_some_and(|found| found.gap.rms <= EXCESS);
    let reflected_found = found(reflected, !is_found && worth(reflected, proper));
    match (proper_found, reflected_found) {
        (Some(proper), Some(reflected)) if !is_decisive(&reflected.gap, &proper.gap) => Some(proper),
        (_, Some(reflected)) => Some(unmirrored(a, b, &reflected).unwrap_or(reflected)),
        (proper, None) => proper,
    }
}

/// Whether one map is better than another by more than the limits of refinement.
fn is_decisive(better: &SurfaceGap, worse: &SurfaceGap) -> bool {
    worse.rms > (DECISIVE * better.rms).hypot(EXCESS)
}

/// The map without a reflection that is as good as one with a reflection, if the surface is its own mirror image.
fn unmirrored(a: &MeshGeometry, b: &MeshGeometry, mirrored: &Aligned) -> Option<Aligned> {
    let starts = mirror_planes(b).into_iter().map(|mirror| mirror.after(&mirrored.map));
    nearest_starts(a, b, starts).into_iter().find_map(|start| {
        let found = Aligned::by(a, b, refined(a, b, start).0)?;
        (!is_decisive(&mirrored.gap, &found.gap)).then_some(found)
    })
}

/// Whether a surface is its own mirror image.
pub(super) fn is_symmetric(geometry: &MeshGeometry) -> bool {
    let zero = SurfaceGap { rms: 0.0, max: 0.0 };
    // A reflection of the surface, undone by itself, is a map without a reflection.
    let is_image = |mirror: Similarity| {
        let near = gap(geometry, geometry, &mirror, RANKING).is_some_and(|gap| gap.rms < CLOSE);
        near && Aligned::by(geometry, geometry, refined(geometry, geometry, mirror).0)
            .is_some_and(|found| !is_decisive(&zero, &found.gap))
    };
    mirror_planes(geometry).into_iter().any(is_image)
}

/// Reflections in planes through the centroid that may leave a surface as it is: across its principal axes, and across its
/// planes and axes and halfway between them.
fn mirror_planes(geometry: &MeshGeometry) -> Vec<Similarity> {
    let axes = principal_axes(geometry).eigenvectors;
    let directions = geometry.regions().directions();
    let main: Vec<Vector3<f64>> = directions.iter().take(MOST_DIRECTIONS).map(|(d, _)| *d).collect();
    let mut normals: Vec<Vector3<f64>> =
        axes.column_iter().map(|axis| axis.into_owned()).chain(main.iter().copied()).collect();
    for (i, d) in main.iter().enumerate() {
        let between = main[..i].iter().flat_map(|e| [d + e, d - e, d.cross(e)]);
        normals.extend(between.filter_map(|normal| normal.try_normalize(1e-3)));
    }
    let reflection = |n: Vector3<f64>| Similarity {
        motion: Alignment::about_origin(Matrix3::identity() - 2.0 * n * n.transpose()),
        scale: 1.0,
    };
    normals.into_iter().map(reflection).collect()
}

/// The best alignment from a motion between the forms, with a reflection if and only if that has one.
fn best(a: &MeshGeometry, b: &MeshGeometry, start: &Alignment) -> Option<Aligned> {
    // The forms have unit spread.
    let scaled = |motion: Alignment| {
        let translation = motion.translation * b.spread();
        Similarity { motion: Alignment { translation, ..motion }, scale: b.spread() / a.spread() }
    };
    let mut best = Aligned::by(a, b, refined(a, b, scaled(*start)).0)?;
    let is_mechanical = a.is_mechanical() && b.is_mechanical();
    if best.gap.rms < if is_mechanical { SEATED } else { CLOSE } {
        return Some(best);
    }
    let mut turned = turned_starts(a, b, start);
    if is_mechanical {
        turned.extend(framed_starts(a, b, start.reflected));
    }
    for start in nearest_starts(a, b, turned.into_iter().map(scaled)) {
        let (map, rms) = refined(a, b, start);
        if rms > PROMISING * best.gap.rms {
            continue;
        }
        let found = Aligned::by(a, b, map)?;
        if found.gap.rms < best.gap.rms {
            best = found;
        }
        if best.gap.rms < SEATED {
            break;
        }
    }
    Some(best)
}

/// The [`RANKED`] starts that bring few samples nearest to the other surface, in this order.
fn nearest_starts(
    a: &MeshGeometry,
    b: &MeshGeometry,
    starts: impl Iterator<Item = Similarity>,
) -> Vec<Similarity> {
    let mut ranked: Vec<(f64, Similarity)> = Vec::with_capacity(RANKED + 1);
    for start in starts {
        let most = ranked.get(RANKED - 1).map_or(f64::INFINITY, |last| last.0);
        let mut sum = 0.0;
        // The sum only grows, so most starts are left early.
        let is_near = contacts(a, b, &start, RANKING).all(|contact| {
            sum += contact.sq_distance();
            sum < most
        });
        if is_near {
            ranked.insert(ranked.partition_point(|other| other.0 <= sum), (sum, start));
            ranked.truncate(RANKED);
        }
    }
    ranked.into_iter().map(|(_, start)| start).collect()
}

/// Whether the spreads along the first and second, and along the second and third axis are nearly equal.
fn equal_axes(a: &MeshGeometry, b: &MeshGeometry) -> [bool; 2] {
    [0, 1].map(|i| {
        [a, b].iter().all(|geometry| geometry.spreads[i] <= NEAR_EQUAL_AXES * geometry.spreads[i + 1])
    })
}

/// Motions that take the two main directions of planes and axes of one part to two of the other.
fn framed_starts(a: &MeshGeometry, b: &MeshGeometry, reflected: bool) -> Vec<Alignment> {
    let [of_a, of_b] = [a, b].map(|part| part.regions().directions());
    let is_across = |x: &Vector3<f64>, y: &Vector3<f64>| x.cross(y).norm() > ACROSS;
    let Some(&(first, area)) = of_a.first() else { return Vec::new() };
    let Some(&(second, other_area)) = of_a.iter().find(|(d, _)| is_across(d, &first)) else {
        return Vec::new();
    };
    let alike = |x: f64, y: f64| (x - y).abs() < ALIKE;
    let main = || of_b.iter().take(MOST_DIRECTIONS);
    let pairs = main().flat_map(|x| main().map(move |y| (*x, *y)));
    let fitting = pairs.filter(|((x, area_x), (y, area_y))| {
        is_across(x, y)
            && alike(*area_x, area)
            && alike(*area_y, other_area)
            && alike(0.5 * x.dot(y).abs(), 0.5 * first.dot(&second).abs())
    });
    fitting
        .flat_map(|((x, _), (y, _))| [[x, y], [x, -y], [-x, y], [-x, -y]])
        .filter_map(|to| of_frames([first, second], to, reflected))
        .collect()
}

/// Starts that are turned about axes which the spreads of a surface do not determine.
fn turned_starts(a: &MeshGeometry, b: &MeshGeometry, start: &Alignment) -> Vec<Alignment> {
    let turned = |turn: Rotation3<f64>| Alignment::about_origin(turn.into_inner()).after(start);
    match equal_axes(a, b) {
        [true, true] => (0..ORIENTATIONS).map(|i| turned(orientation(i))).collect(),
        [false, false] => Vec::new(),
        [first, _] => {
            let Some(axis) = principal_axis(b, if first { 2 } else { 0 }) else { return Vec::new() };
            let turn = |i: usize| std::f64::consts::TAU * i as f64 / TURNS as f64;
            (1..TURNS).map(|i| turned(Rotation3::from_axis_angle(&axis, turn(i)))).collect()
        }
    }
}

/// One of many evenly spread orientations (Shoemake's uniform quaternions from an additive sequence).
fn orientation(i: usize) -> Rotation3<f64> {
    const STEPS: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
    let [u, v, w] = STEPS.map(|step| (0.5 + step * i as f64).fract());
    let (v, w) = (std::f64::consts::TAU * v, std::f64::consts::TAU * w);
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    let quaternion = nalgebra::Quaternion::new(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos());
    UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix()
}

/// The principal axes of the samples.
fn principal_axes(geometry: &MeshGeometry) -> SymmetricEigen<f64, U3> {
    let samples = geometry.samples().iter();
    samples.map(|p| p.coords * p.coords.transpose()).sum::<Matrix3<f64>>().symmetric_eigen()
}

/// The principal axis with the largest (0) or smallest (2) spread.
fn principal_axis(geometry: &MeshGeometry, place: usize) -> Option<Unit<Vector3<f64>>> {
    let eigen = principal_axes(geometry);
    let at = if place == 0 { eigen.eigenvalues.imax() } else { eigen.eigenvalues.imin() };
    Unit::try_new(eigen.eigenvectors.column(at).into_owned(), 0.0)
}

/// A point of the first surface under the map, the point of the second that is as near as can be, and the normal there.
struct Contact {
    from: Point3<f64>,
    to: Point3<f64>,
    normal: Vector3<f64>,
}

impl Contact {
    fn sq_distance(&self) -> f64 {
        (self.from - self.to).norm_squared()
    }
}

/// Nearest points in both directions, of every so many samples, under a map.
fn contacts<'a>(
    a: &'a MeshGeometry,
    b: &'a MeshGeometry,
    map: &'a Similarity,
    n: usize,
) -> impl Iterator<Item = Contact> + 'a {
    let (samples_a, samples_b) = (a.samples(), b.samples());
    let step = |samples: &[Point3<f64>]| (samples.len() / n.max(1)).max(1);
    let there = samples_a.iter().step_by(step(samples_a)).filter_map(move |p| {
        let from = map.apply(p);
        let near = b.tree().nearest(&from)?;
        Some(Contact { from, to: near.point, normal: near.normal })
    });
    let back = map.motion.inverse();
    let here = samples_b.iter().step_by(step(samples_b)).filter_map(move |q| {
        let near = a.tree().nearest(&(back.apply(q) / map.scale))?;
        let normal = map.motion.rotation * near.normal;
        Some(Contact { from: map.apply(&near.point), to: *q, normal })
    });
    there.chain(here)
}

/// The distance under a map, by at least `n` samples of either surface.
fn gap(a: &MeshGeometry, b: &MeshGeometry, map: &Similarity, n: usize) -> Option<SurfaceGap> {
    let squares = contacts(a, b, map, n).map(|contact| contact.sq_distance());
    let (n, sum, max) = squares.fold((0, 0.0, 0.0), |(n, sum, max), sq| (n + 1, sum + sq, f64::max(max, sq)));
    (n > 0).then(|| SurfaceGap { rms: (sum / f64::from(n)).sqrt(), max: max.sqrt() })
}

/// Refines a map by iterative closest points. Each step moves points towards the tangent planes of their partners (Chen and
/// Medioni 1992, `chen1992` in `REFERENCES.bib`), in seven degrees of freedom: motion and scale. Returns the root mean square
/// distance of the samples, too.
fn refined(a: &MeshGeometry, b: &MeshGeometry, start: Similarity) -> (Similarity, f64) {
    let error = |contacts: &[Contact]| {
        contacts.iter().map(Contact::sq_distance).sum::<f64>() / contacts.len().max(1) as f64
    };
    let mut map = start;
    let mut found: Vec<Contact> = contacts(a, b, &map, REFINING).collect();
    let mut damping = 1e-6;
    for _ in 0..STEPS {
        let before = error(&found);
        let Some(step) = tangent_step(&found, damping) else { break };
        let next = step.after(&map);
        let after: Vec<Contact> = contacts(a, b, &next, REFINING).collect();
        let reached = error(&after);
        if reached < before {
            (map, found) = (next, after);
            damping = f64::max(damping * 0.1, 1e-9);
            if reached > before * (1.0 - LEAST_GAIN) || reached < 1e-24 {
                break;
            }
        } else {
            damping *= 100.0;
            if damping > 1.0 {
                break;
            }
        }
    }
    let rms = error(&found).sqrt();
    (map, rms)
}

/// The small similarity that brings points nearest to the tangent planes of their partners; `damping` shortens it.
fn tangent_step(contacts: &[Contact], damping: f64) -> Option<Similarity> {
    let mut matrix = SMatrix::<f64, 7, 7>::zeros();
    let mut right = SVector::<f64, 7>::zeros();
    for Contact { from, to, normal } in contacts {
        let turn = from.coords.cross(normal);
        let row = SVector::<f64, 7>::from([
            turn.x,
            turn.y,
            turn.z,
            normal.x,
            normal.y,
            normal.z,
            from.coords.dot(normal),
        ]);
        matrix += row * row.transpose();
        right += row * (to - from).dot(normal);
    }
    let scale = matrix.trace().max(f64::MIN_POSITIVE);
    matrix += SMatrix::identity() * (damping * scale);
    let step = matrix.cholesky()?.solve(&right);
    let rotation = Rotation3::new(Vector3::new(step[0], step[1], step[2]));
    let motion = Alignment {
        rotation: rotation.into_inner(),
        translation: Vector3::new(step[3], step[4], step[5]),
        reflected: false,
    };
    Some(Similarity { motion, scale: step[6].clamp(-0.2, 0.2).exp() })
}

#[cfg(test)]
mod tests {
    use mesh::{TriMesh, shapes};

    use super::*;

    fn geometry(mesh: &TriMesh) -> MeshGeometry {
        MeshGeometry::new(mesh, None).unwrap()
    }

    fn changed(mesh: &TriMesh, scale: f64, flip: f64) -> TriMesh {
        let turn = Rotation3::from_euler_angles(0.3, 2.0, -1.0);
        let to =
            |p: &Point3<f64>| turn * Point3::new(flip * p.x, p.y, p.z) * scale + Vector3::new(5.0, 2.0, 3.0);
        TriMesh { positions: mesh.positions.iter().map(to).collect(), faces: mesh.faces.clone() }
    }

    /// A ball with arms of different lengths.
    fn hand() -> TriMesh {
        let mut mesh = shapes::icosphere(4);
        let arms = [([1.0, 1.0, 1.0], 1.0), ([1.0, -1.0, -1.0], 1.6), ([-1.0, 1.0, -1.0], 2.3)];
        for p in &mut mesh.positions {
            let direction = p.coords;
            for (towards, length) in arms {
                let cosine = direction.dot(&Vector3::from(towards)) / 3f64.sqrt();
                p.coords += direction * length * (-(1.0 - cosine) * 12.0).exp();
            }
        }
        mesh
    }

    #[test]
    fn subdivided_and_moved_surfaces_coincide() {
        let mesh = hand();
        for (flip, mirrored) in [(1.0, false), (-1.0, true)] {
            let other = changed(&shapes::subdivide(&mesh), 25.4, flip);
            let found = aligned(&geometry(&mesh), &geometry(&other)).unwrap();
            assert!(found.gap.max < 1e-4, "{found:?}");
            assert_eq!(found.map.motion.reflected, mirrored);
            assert!((found.map.scale - 1.0).abs() < 1e-4, "{}", found.map.scale);
        }
    }

    #[test]
    fn bodies_with_equal_axes_are_aligned() {
        // A cube, and a ring with three knobs.
        let mut ring = shapes::torus(60, 20, 2.0, 0.5);
        for p in &mut ring.positions {
            let angle = p.y.atan2(p.x);
            p.coords *= 1.0 + 0.3 * ((3.0 * angle).cos() - 1.0).exp();
        }
        for mesh in [shapes::cube(5), ring] {
            let other = changed(&shapes::subdivide(&mesh), 1.0, 1.0);
            let found = aligned(&geometry(&mesh), &geometry(&other)).unwrap();
            assert!(found.gap.rms < 1e-3, "{found:?}");
            assert!(!found.map.motion.reflected, "its own mirror image");
        }
    }

    #[test]
    fn other_surfaces_are_apart() {
        let (mesh, mut bent) = (hand(), hand());
        for p in &mut bent.positions {
            p.x += 0.25 * p.y * p.y;
        }
        let found = aligned(&geometry(&mesh), &geometry(&bent)).unwrap();
        assert!(found.gap.rms > 0.01, "{found:?}");
        assert_eq!(aligned(&geometry(&mesh), &geometry(&shapes::icosphere(3))), None);
    }
}
