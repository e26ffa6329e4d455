//! Fast marching on surfaces with known distances.

use canonform::Exceeded;
use datasets::Family;
use geodesics::{
    DistanceSolver, FastMarching, FastMarchingOptions, FirstSample, Method, ObtuseTreatment, Sampling,
    Source, Update,
};
use mesh::{TriMesh, shapes};
use nalgebra::Point3;
use surface::{IntrinsicMesh, VertexId};

use crate::support::body;

/// The largest error on a flat sheet, relative to the largest distance.
fn error_on_plane(sheet: &TriMesh, source: usize, obtuse: ObtuseTreatment) -> f64 {
    let options = FastMarchingOptions { obtuse, ..Default::default() };
    let solver = FastMarching::new(sheet.intrinsic(), options, &());
    let found = solver.distances(VertexId::from(source)).unwrap();
    let straight: Vec<f64> = sheet.positions.iter().map(|p| (p - sheet.positions[source]).norm()).collect();
    crate::support::gap(&found, &straight)
}

/// Three corners, the middle of a side, the center, and one more vertex.
fn sources(nx: usize, ny: usize) -> [usize; 6] {
    [0, nx - 1, nx * ny - 1, nx / 2, nx * (ny / 2) + nx / 2, 5 * nx + 3]
}

#[test]
fn flat_sheets_are_exact_for_any_angles_and_sources() {
    use ObtuseTreatment::{Flip, Ignore, Unfold};
    let (nx, ny) = (21, 17);
    // Nearly equilateral, right and obtuse triangles, with angles up to 150 degrees.
    let sheared = [-1.0, -0.5, -0.3, 0.0, 0.5, 1.0, 1.7].map(|shear| {
        let all: &[_] = if [-1.0, -0.3].contains(&shear) { &[Flip, Unfold] } else { &[Flip, Unfold, Ignore] };
        (shapes::sheared_grid(nx, ny, 0.3, shear), all)
    });
    // In irregular triangles a vertex may be finalized before the opposite edge, and is corrected afterwards.
    let jittered = [(0.1, 1), (0.1, 2), (0.2, 1), (0.2, 2), (0.24, 1), (0.24, 3)];
    let jittered = jittered
        .map(|(jitter, seed)| (shapes::jittered_grid(nx, ny, 0.3, jitter, seed), &[Flip, Unfold] as &[_]));
    for (i, (sheet, treatments)) in sheared.into_iter().chain(jittered).enumerate() {
        for source in sources(nx, ny) {
            for obtuse in treatments {
                let error = error_on_plane(&sheet, source, *obtuse);
                assert!(error < 1e-12, "sheet {i}, {obtuse:?}, source {source}: {error:e}");
            }
        }
    }
}

/// Triangle sizes vary by a factor of ten thousand across the sheet, so no single bucket width suits all of them.
#[test]
fn graded_sheets_are_exact_for_all_triangle_sizes() {
    let (nx, ny) = (51, 51);
    for jitter in [0.0, 0.2] {
        let mut sheet = shapes::jittered_grid(nx, ny, 1.0, jitter, 4);
        for p in &mut sheet.positions {
            (p.x, p.y) = (1.2f64.powf(p.x), 1.2f64.powf(p.y));
        }
        for source in sources(nx, ny) {
            let error = error_on_plane(&sheet, source, ObtuseTreatment::Flip);
            assert!(error < 1e-10, "jitter {jitter}, source {source}: {error:e}");
        }
    }
}

#[test]
fn paths_go_around_a_hole_however_fine_the_mesh() {
    for n in [60, 120, 240] {
        // Flat, between the radii 1 and 10.
        let ring = testkit::moved(&shapes::cylinder(n, n / 6 + 1, 1.0, 9.0), |p| {
            Point3::new(p.x * (1.0 + p.z), p.y * (1.0 + p.z), 0.0)
        });
        let found =
            FastMarching::new(ring.intrinsic(), Default::default(), &()).distances(VertexId(0)).unwrap();
        let exact = Method::Exact.prepare(ring.intrinsic(), &()).unwrap().distances(VertexId(0)).unwrap();
        let errors: Vec<f64> = found.iter().zip(&exact).skip(1).map(|(x, y)| x / y - 1.0).collect();
        let mean = errors.iter().map(|error| error.abs()).sum::<f64>() / errors.len() as f64;
        let least = errors.iter().copied().fold(0.0, f64::min);
        assert!(mean < 1e-3 && least > -0.01, "{n} sectors: mean {mean:e}, least {least}");
    }
}

/// The mean errors on spheres of ever shorter edges.
fn errors_on_spheres(update: Update) -> Vec<f64> {
    let options = FastMarchingOptions { update, ..Default::default() };
    let error = |level| {
        let sphere = shapes::icosphere(level);
        let found = FastMarching::new(sphere.intrinsic(), options, &()).distances(VertexId(0)).unwrap();
        let axis = sphere.positions[0].coords;
        let arc = |v: usize| {
            axis.cross(&sphere.positions[v].coords).norm().atan2(axis.dot(&sphere.positions[v].coords))
        };
        (0..found.len()).map(|v| (found[v] - arc(v)).abs()).sum::<f64>() / found.len() as f64
    };
    (2..=5).map(error).collect()
}

/// A triangle sees the source through one side only, so a tenth of a per cent remains however short the edges are.
#[test]
fn errors_on_spheres_are_below_half_of_those_of_the_planar_update() {
    let [carried, planar] = [Update::VirtualSource, Update::Planar].map(errors_on_spheres);
    println!("mean errors on spheres with halved edges: {carried:?}, planar {planar:?}");
    for (carried, planar) in carried.iter().zip(planar) {
        assert!(*carried < 0.5 * planar, "{carried} {planar}");
    }
    assert!(carried[3] < 1.5e-3, "{carried:?}");
}

/// A solver that computes all distances from each sample as in Procedure 1 of the paper, or one whose pruned fronts stop
/// much too early.
#[derive(Debug)]
struct Other<'a> {
    solver: &'a dyn DistanceSolver,
    is_careless: bool,
}

impl DistanceSolver for Other<'_> {
    fn n_vertices(&self) -> usize {
        self.solver.n_vertices()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        self.solver.solve_into(sources, max_distance, out)
    }

    fn prunes(&self) -> bool {
        self.is_careless
    }

    fn lower(&self, source: VertexId, nearest: &mut [f64]) -> Result<(), Exceeded> {
        for (near, distance) in nearest.iter_mut().zip(self.solver.distances(source)?) {
            if distance < 0.5 * *near {
                *near = distance;
            }
        }
        Ok(())
    }
}

/// Asserts that pruned fronts, even careless ones, choose the samples of Procedure 1 with the same distances.
fn pruning_changes_nothing(name: &str, surface: &IntrinsicMesh, n: usize) {
    let solver = FastMarching::new(surface, FastMarchingOptions::default(), &());
    let [unpruned, careless] = [false, true].map(|is_careless| Other { solver: &solver, is_careless });
    for first in [FirstSample::Farthest, FirstSample::Vertex(VertexId(7))] {
        let sampled = |solver: &dyn DistanceSolver| {
            Sampling::Farthest.start(solver, first, 0).unwrap().into_distances(n).unwrap()
        };
        let full = sampled(&unpruned);
        for ahead in [&solver as &dyn DistanceSolver, &careless] {
            let pruned = testkit::on_threads(2, || sampled(ahead));
            assert_eq!(pruned.landmarks(), full.landmarks(), "{name} from {first:?}");
            assert_eq!(pruned.to_matrix(), full.to_matrix(), "{name} from {first:?}");
        }
    }
}

#[test]
fn pruned_fronts_choose_the_same_samples_as_full_fronts() {
    pruning_changes_nothing("cat", &body(Family::Cat).intrinsic(), 200);
    pruning_changes_nothing("torus", &shapes::torus(60, 23, 2.0, 0.7).intrinsic(), 100);
}
