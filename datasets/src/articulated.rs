//! The built-in dataset: labeled shapes of articulated families.

use base::{Budget, Observer};
use mesh::TriMesh;
use nalgebra::Point3;
use rayon::prelude::*;

use crate::clearance::entanglement;
use crate::error::DatasetError;
use crate::model::BodyModel;
use crate::pose::{PosedSkeleton, random_build};
use crate::shape::{posed_positions, rest_surface, shuffled};
use crate::stream::{Purpose, Stream};

/// Area of the rest surface of every family, in squared units, so that families do not differ by size alone.
/// Lengths are roughly centimeters of a grown man.
const AREA: f64 = 18_000.0;

/// A family of shapes: poses of one body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Family {
    /// A cat; nine shapes.
    Cat,
    /// A horse with the trunk, arms and head of a man; six shapes.
    Centaur,
    /// A man; fifteen shapes.
    David,
    /// A man with belly, calves, heels, kneecaps and elbows, so that front and back differ on every limb, in poses whose limbs
    /// touch; eight shapes, which are not in the dataset. Maps are judged on them.
    Person,
}

impl Family {
    /// The families of the dataset, in its order.
    pub fn all() -> [Self; 3] {
        [Self::Cat, Self::Centaur, Self::David]
    }

    /// The class label: `cat`, `centaur` or `david`.
    pub fn name(self) -> &'static str {
        self.entry().0
    }

    /// Number of shapes of the family in the dataset.
    pub fn n_shapes(self) -> usize {
        self.entry().1
    }

    pub(crate) fn model(self) -> BodyModel {
        BodyModel::read(self.entry().2)
    }

    /// Name, number of shapes, and description.
    fn entry(self) -> (&'static str, usize, &'static str) {
        match self {
            Self::Cat => ("cat", 9, include_str!("../bodies/cat.toml")),
            Self::Centaur => ("centaur", 6, include_str!("../bodies/centaur.toml")),
            Self::David => ("david", 15, include_str!("../bodies/david.toml")),
            Self::Person => ("person", 8, include_str!("../bodies/person.toml")),
        }
    }
}

/// Options of [`articulated()`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArticulatedOptions {
    /// Determines joint angles, triangulations and vertex numbers, for any number of threads. Default: 1.
    pub seed: u64,
    /// Exact number of vertices of every shape; 1,000 to 1,000,000. Default: 3,400.
    pub n_vertices: usize,
}

impl Default for ArticulatedOptions {
    fn default() -> Self {
        Self { seed: 1, n_vertices: 3400 }
    }
}

impl ArticulatedOptions {
    /// Fewest vertices with which a body is recognizable.
    pub const MIN_VERTICES: usize = 1_000;
    /// Most vertices.
    pub const MAX_VERTICES: usize = 1_000_000;

    /// Checks the ranges.
    ///
    /// # Errors
    /// [`DatasetError::VertexCount`].
    pub fn validate(&self) -> Result<(), DatasetError> {
        let (n_vertices, least, most) = (self.n_vertices, Self::MIN_VERTICES, Self::MAX_VERTICES);
        match (least..=most).contains(&n_vertices) {
            true => Ok(()),
            false => Err(DatasetError::VertexCount { n_vertices, least, most }),
        }
    }
}

/// A mesh with its name and class.
#[derive(Debug, Clone, PartialEq)]
pub struct LabeledShape {
    /// Family and number, such as `cat0`.
    pub name: String,
    /// Family, such as `cat`.
    pub label: String,
    /// A closed surface in one piece, oriented outwards; `z` is up and the ground at zero. Only some creatures have
    /// handles.
    pub mesh: TriMesh,
}

/// Generates the built-in dataset: 9 cats, 6 centaurs and 15 davids, in that order.
///
/// The shapes of a family are one body, bent into different poses within the limits of its joints, so their
/// surfaces are nearly isometric: on average, half of the shortest paths change by less than 4 %. Each shape
/// has its own triangulation with its own density and a random numbering, so that nothing corresponds between
/// two meshes. Bodies are triangulated at rest, so that limbs which touch do not merge. All families have the
/// same area at rest. Shapes are generated in parallel.
///
/// # Errors
/// As [`ArticulatedOptions::validate`], and [`DatasetError::NoSurface`].
///
/// ```
/// use canonform_datasets::{ArticulatedOptions, Family, articulated_shape};
///
/// let options = ArticulatedOptions { n_vertices: 1000, ..Default::default() };
/// let cat = articulated_shape(Family::Cat, 3, &options)?;
/// assert_eq!((cat.name.as_str(), cat.label.as_str()), ("cat3", "cat"));
/// assert_eq!(cat.mesh.n_vertices(), 1000);
/// # Ok::<(), canonform_datasets::DatasetError>(())
/// ```
pub fn articulated(options: &ArticulatedOptions) -> Result<Vec<LabeledShape>, DatasetError> {
    let numbered = |family: Family| (0..family.n_shapes()).map(move |pose| (family, pose));
    let shapes: Vec<_> = Family::all().into_iter().flat_map(numbered).collect();
    shapes.into_par_iter().map(|(family, pose)| articulated_shape(family, pose, options)).collect()
}

/// Generates one shape of the dataset, the same as in [`articulated()`].
///
/// Pose 0 is the rest pose, on all fours or standing with arms spread. Poses from
/// [`n_shapes`](Family::n_shapes) on are further random variations.
///
/// # Errors
/// As [`articulated()`].
pub fn articulated_shape(
    family: Family,
    pose: usize,
    options: &ArticulatedOptions,
) -> Result<LabeledShape, DatasetError> {
    articulated_body(family, 0, pose, options)
}

/// Generates a shape of another body of the family: of the same anatomy, with other lengths and girths of trunk and
/// limbs. Body 0 is that of [`articulated()`]; bodies do not depend on the seed.
///
/// # Errors
/// As [`articulated()`].
///
/// ```
/// use canonform_datasets::{ArticulatedOptions, Family, articulated_body};
///
/// let options = ArticulatedOptions { n_vertices: 1000, ..Default::default() };
/// let other = articulated_body(Family::Cat, 2, 3, &options)?;
/// assert_eq!((other.name.as_str(), other.label.as_str()), ("cat-body2-pose3", "cat"));
/// # Ok::<(), canonform_datasets::DatasetError>(())
/// ```
pub fn articulated_body(
    family: Family,
    body: usize,
    pose: usize,
    options: &ArticulatedOptions,
) -> Result<LabeledShape, DatasetError> {
    Ok(articulated_at_rest(family, body, pose, options, &())?.shape)
}

/// A shape with the surface that it was bent from.
#[derive(Debug, Clone, PartialEq)]
pub struct RestedShape {
    /// The shape.
    pub shape: LabeledShape,
    /// The same vertices and faces at rest on body 0, in the units of the dataset. All shapes of a family, of any body, are bent
    /// from it, and it is its own mirror image at `x = 0`: so points of two shapes correspond if they are in the same place at rest.
    pub rest: TriMesh,
}

/// Generates a shape as [`articulated_body`] does, with the surface at rest: the ground truth of maps between shapes.
///
/// # Errors
/// As [`articulated()`], and [`DatasetError::Exceeded`] when the budget of the observer is.
///
/// ```
/// use canonform_datasets::{ArticulatedOptions, Family, articulated_at_rest};
///
/// let options = ArticulatedOptions { n_vertices: 1000, ..Default::default() };
/// let found = articulated_at_rest(Family::Cat, 0, 3, &options, &())?;
/// assert_eq!(found.rest.faces, found.shape.mesh.faces);
/// assert_ne!(found.rest.positions, found.shape.mesh.positions);
/// # Ok::<(), canonform_datasets::DatasetError>(())
/// ```
pub fn articulated_at_rest(
    family: Family,
    body: usize,
    pose: usize,
    options: &ArticulatedOptions,
    observer: &dyn Observer,
) -> Result<RestedShape, DatasetError> {
    options.validate()?;
    let stream = |number, purpose| match purpose {
        // Bodies do not depend on the seed.
        Purpose::Build => Stream::new(body as u64, family as usize, 0, purpose),
        _ => Stream::new(options.seed, family as usize, number, purpose),
    };
    bent(&family.model(), family.name(), [body, pose], options, stream, &observer.budget())
}

/// A body of a model, 0 for its own, in a pose. A stream of random numbers has a number and a purpose.
pub(crate) fn bent(
    model: &BodyModel,
    label: &str,
    [body, pose]: [usize; 2],
    options: &ArticulatedOptions,
    stream: impl Fn(usize, Purpose) -> Stream,
    budget: &Budget,
) -> Result<RestedShape, DatasetError> {
    let ArticulatedOptions { seed, n_vertices } = *options;
    let name = match body {
        0 => format!("{label}{pose}"),
        _ => format!("{label}-body{body}-pose{pose}"),
    };
    let of_pose = |purpose| stream(body * POSES_PER_BODY + pose, purpose);
    let surface = rest_surface(model, n_vertices, &mut of_pose(Purpose::Lattice), budget)?
        .ok_or_else(|| DatasetError::NoSurface { shape: name.clone(), n_vertices, seed })?;
    let mut posed = posed_skeleton(model, pose, &mut of_pose(Purpose::Pose));
    if body > 0 {
        let mut proportions = stream(body * POSES_PER_BODY, Purpose::Build);
        posed = posed.built(&random_build(&model.skeleton, &mut proportions));
    }
    let positions = posed_positions(&surface, &posed, scale(model));
    let numbered =
        |positions: &[Point3<f64>]| shuffled(&surface, positions, &mut of_pose(Purpose::Numbering));
    let at_rest: Vec<_> = surface.positions.iter().map(|p| p * scale(model)).collect();
    let shape = LabeledShape { name, label: label.to_owned(), mesh: numbered(&positions) };
    Ok(RestedShape { shape, rest: numbered(&at_rest) })
}

/// Poses that have streams of random numbers of their own for every body.
const POSES_PER_BODY: usize = 1 << 20;

/// From body units to the units of the dataset.
fn scale(model: &BodyModel) -> f64 {
    (AREA / model.area).sqrt()
}

/// Most variations of a pose to draw; the least entangled one is used.
const N_DRAWS: usize = 12;

/// The skeleton in a random variation of a typical pose without intersecting limbs; number 0 is exactly the
/// rest pose.
fn posed_skeleton<'a>(model: &'a BodyModel, pose: usize, stream: &mut Stream) -> PosedSkeleton<'a> {
    let typical = &model.poses[pose % model.poses.len()];
    if pose == 0 {
        return PosedSkeleton::new(&model.skeleton, typical);
    }
    let mut draw = || {
        let posed = PosedSkeleton::new(&model.skeleton, &typical.varied(&model.skeleton, stream));
        (entanglement(&posed), posed)
    };
    let mut best = draw();
    for _ in 1..N_DRAWS {
        if best.0 <= 0.0 {
            break;
        }
        let next = draw();
        if next.0 < best.0 {
            best = next;
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use surface::{EdgeGraph, IntrinsicMesh, Topology, VertexId};

    use super::*;
    use crate::implicit::{Blob, BodyPart};
    use crate::simplify::RestSurface;

    /// Relative changes of path lengths between two poses of one triangulation, in ascending order.
    fn changes(surface: &RestSurface, poses: [&[Point3<f64>]; 2]) -> Vec<f64> {
        let faces: Vec<_> = surface.table.faces().collect();
        let graphs = poses.map(|at| {
            let length = |[a, b]: [VertexId; 2]| (at[a.index()] - at[b.index()]).norm();
            EdgeGraph::of(&IntrinsicMesh::with_lengths(Topology::new(at.len(), faces.clone()), length))
        });
        let mut changes = Vec::new();
        for source in (0..poses[0].len()).step_by(67).map(VertexId::from) {
            let [before, after] = graphs.each_ref().map(|graph| graph.from(source));
            let pairs = before.iter().zip(&after).filter(|(d, _)| **d > 0.0);
            changes.extend(pairs.map(|(d, e)| (e / d - 1.0).abs()));
        }
        changes.sort_by(f64::total_cmp);
        changes
    }

    #[test]
    fn poses_of_a_family_are_nearly_isometric_and_limbs_of_people_hardly_intersect() {
        for family in Family::all().into_iter().chain([Family::Person]) {
            let model = family.model();
            let surface =
                rest_surface(&model, 2000, &mut Stream::new(5, 0, 0, Purpose::Lattice), &Budget::unlimited())
                    .unwrap()
                    .unwrap();
            let posed = |seed, pose| {
                posed_skeleton(&model, pose, &mut Stream::new(seed, family as usize, pose, Purpose::Pose))
            };
            let positions = |pose| posed_positions(&surface, &posed(1, pose), scale(&model));
            let rest = positions(0);
            let mut medians = Vec::new();
            for pose in 1..family.n_shapes() {
                let changes = changes(&surface, [&rest, &positions(pose)]);
                let quantile = |q: f64| changes[(q * changes.len() as f64) as usize];
                println!("{}{pose}: median {:.3}, 90 % {:.3}", family.name(), quantile(0.5), quantile(0.9));
                assert!(quantile(0.5) < 0.06 && quantile(0.9) < 0.17, "{}{pose}", family.name());
                medians.push(quantile(0.5));
                if family == Family::Person {
                    let depths = (0..30).map(|seed| entanglement(&posed(seed, pose)));
                    // Limbs touch: .001 of their thickness was measured.
                    let depth = depths.fold(f64::NEG_INFINITY, f64::max);
                    assert!(depth <= 0.01, "{pose}: {depth}");
                }
            }
            let mean = medians.iter().sum::<f64>() / medians.len() as f64;
            assert!(family == Family::Person || mean < 0.04, "{}: {mean:.3} on average", family.name());
        }
    }

    #[test]
    fn a_body_with_two_components_is_an_error() {
        let mut model = Family::Cat.model();
        model.body.parts = [0.0, 50.0]
            .map(|y| BodyPart::new(false, vec![Blob::new([[0.0, y, 0.0, 10.0]; 2], None, 0.0)], 0.0))
            .into();
        let options = ArticulatedOptions::default();
        let stream = |number, purpose| Stream::new(1, 0, number, purpose);
        let error = bent(&model, "cat", [0, 3], &options, stream, &Budget::unlimited()).unwrap_err();
        let expected = DatasetError::NoSurface { shape: "cat3".to_owned(), n_vertices: 3400, seed: 1 };
        assert_eq!(error, expected);
        assert!(error.to_string().contains("try another seed"));
    }
}
