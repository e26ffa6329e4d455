//! Creatures: families of articulated shapes from a seed.
//!
//! A plan in `bodies/creatures.toml` says what a body is made of, such as a trunk with eight legs; random proportions say how long, how
//! thick and how many. Bodies are then made like those of the [articulated](crate::articulated()) families.

mod draft;
mod plans;
mod proportions;

use base::{Budget, Observer};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::articulated::{ArticulatedOptions, LabeledShape, bent};
use crate::clearance::entanglement;
use crate::error::DatasetError;
use crate::extract::{Lattice, extract};
use crate::implicit::ImplicitBody;
use crate::model::BodyModel;
use crate::pose::{Pose, PosedSkeleton};
use crate::shape::genus;
use crate::skeleton::Skeleton;
use crate::stream::Stream;
use draft::{Draft, PLAY};
use plans::PLANS;
use proportions::Proportions;

/// Options of [`creatures`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CreatureOptions {
    /// Determines bodies, poses, triangulations and vertex numbers, for any number of threads. Default: 1.
    pub seed: u64,
    /// Number of families; families with the same number are the same for any total. Default: 48.
    pub n_families: usize,
    /// Shapes of each family. Default: 8.
    pub n_poses: usize,
    /// Exact number of vertices of every shape; 1,000 to 1,000,000. Default: 3,400.
    pub n_vertices: usize,
}

impl Default for CreatureOptions {
    fn default() -> Self {
        Self { seed: 1, n_families: 48, n_poses: 8, n_vertices: 3400 }
    }
}

impl CreatureOptions {
    fn of_shape(&self) -> ArticulatedOptions {
        ArticulatedOptions { seed: self.seed, n_vertices: self.n_vertices }
    }
}

/// Typical poses of a family; others are variations of them.
const N_POSES: usize = 12;

/// Most draws of the proportions of a family, until its body has the topology of its plan.
const N_ATTEMPTS: usize = 40;

/// Most draws of a typical pose.
const N_DRAWS: usize = 60;

/// Spacing of the lattice, relative to the smallest radius of the body.
const SPACING: f64 = 0.55;

/// Generates families of creatures: worms, stars, octopuses, spiders, hands, birds, fish, animals on four and on two
/// legs, trees, and also rings, glasses, keys, cups and scissors, whose surfaces have handles.
///
/// Families take turns to follow [each plan](creature_plans); those of one plan differ in all proportions and in the
/// number of their limbs. The shapes of a family are one body in different poses, nearly isometric; each has a
/// triangulation and a numbering of its own, as in [`articulated()`](crate::articulated()). All bodies have the same area
/// at rest. Shapes are generated in parallel.
///
/// # Errors
/// [`DatasetError::VertexCount`] and [`DatasetError::NoSurface`].
///
/// ```
/// use canonform_datasets::{CreatureOptions, creatures};
///
/// let options = CreatureOptions { n_families: 2, n_poses: 3, n_vertices: 1000, ..Default::default() };
/// let shapes = creatures(&options)?;
/// let names: Vec<&str> = shapes.iter().map(|shape| shape.name.as_str()).collect();
/// assert_eq!(names, ["worm0", "worm1", "worm2", "star0", "star1", "star2"]);
/// assert!(shapes.iter().all(|shape| shape.mesh.n_vertices() == 1000));
/// # Ok::<(), canonform_datasets::DatasetError>(())
/// ```
pub fn creatures(options: &CreatureOptions) -> Result<Vec<LabeledShape>, DatasetError> {
    let families: Vec<Vec<LabeledShape>> = (0..options.n_families)
        .into_par_iter()
        .map(|family| creature_family(family, options))
        .collect::<Result<_, _>>()?;
    Ok(families.into_iter().flatten().collect())
}

/// Generates the shapes of one family, the same as in [`creatures`]: a large collection can be made a family at a time.
///
/// # Errors
/// As [`creatures`].
pub fn creature_family(family: usize, options: &CreatureOptions) -> Result<Vec<LabeledShape>, DatasetError> {
    options.of_shape().validate()?;
    let budget = Budget::unlimited();
    let model = model(family, options, &budget)?;
    (0..options.n_poses)
        .into_par_iter()
        .map(|pose| shape(family, &model, [0, pose], options, &budget))
        .collect()
}

/// Generates one creature; poses beyond the number in the options are further variations. Body 0 is that of [`creatures`], others have
/// other lengths and girths of trunk and limbs, as those of [`articulated_body`](crate::articulated_body).
///
/// # Errors
/// As [`creatures`], and [`DatasetError::Exceeded`] when the budget of the observer is.
pub fn creature_body(
    family: usize,
    body: usize,
    pose: usize,
    options: &CreatureOptions,
    observer: &dyn Observer,
) -> Result<LabeledShape, DatasetError> {
    options.of_shape().validate()?;
    let budget = observer.budget();
    shape(family, &model(family, options, &budget)?, [body, pose], options, &budget)
}

/// The names of the body plans, in the order of the families; they are the labels of the first ones.
pub fn creature_plans() -> Vec<&'static str> {
    PLANS.iter().map(|plan| plan.name.as_str()).collect()
}

/// The label of a family: that of its plan, followed by a capital letter after the first round (`worm`, `wormB`, ...).
/// Letters, since the leading letters of a file name are its class.
fn label(family: usize) -> String {
    let (name, mut round) = (&PLANS[family % PLANS.len()].name, family / PLANS.len());
    let mut letters = String::new();
    while round > 0 {
        letters.insert(0, char::from(b'A' + (round % 26) as u8));
        round /= 26;
    }
    name.clone() + &letters
}

fn model(family: usize, options: &CreatureOptions, budget: &Budget) -> Result<BodyModel, DatasetError> {
    let (plan, round) = (family % PLANS.len(), family / PLANS.len());
    for attempt in 0..N_ATTEMPTS {
        let mut proportions = Proportions::new(options.seed, plan, round, attempt);
        let draft = PLANS[plan].draft(&mut proportions);
        if let Some(model) = measured(draft, &mut proportions.stream, budget)? {
            return Ok(model);
        }
    }
    Err(DatasetError::NoSurface { shape: label(family), n_vertices: options.n_vertices, seed: options.seed })
}

/// The model of a body with random poses; `None` if its limbs touch at rest.
fn measured(draft: Draft, stream: &mut Stream, budget: &Budget) -> Result<Option<BodyModel>, DatasetError> {
    let Draft { skeleton, parts, genus: n_handles, finest: Some(finest) } = draft else { return Ok(None) };
    let body = ImplicitBody { parts, is_symmetric: false };
    let spacing = SPACING * finest;
    let lattice = Lattice { rotation: Matrix3::identity(), shift: Vector3::repeat(0.37), spacing };
    let raw = extract(&body, lattice, budget)?;
    if genus(&raw) != Some(n_handles) {
        return Ok(None);
    }
    let mut poses = vec![Pose::rest(&skeleton)];
    poses.extend((1..N_POSES).map(|_| typical_pose(&skeleton, stream)));
    Ok(Some(BodyModel { area: raw.area(), body, skeleton, poses, genus: n_handles, spacing }))
}

/// A random pose without intersecting limbs; after a few draws, the last one.
fn typical_pose(skeleton: &Skeleton, stream: &mut Stream) -> Pose {
    let mut draw = || random_pose(skeleton, stream);
    let is_free = |pose: &Pose| entanglement(&PosedSkeleton::new(skeleton, pose)) <= 0.0;
    (1..N_DRAWS).map(|_| draw()).find(is_free).unwrap_or_else(draw)
}

/// A random pose within the limits of the joints. A limb bends to one side in most places.
fn random_pose(skeleton: &Skeleton, stream: &mut Stream) -> Pose {
    let mut pose = Pose::rest(skeleton);
    for (c, chain) in skeleton.chains.iter().enumerate() {
        let side = [(); 2].map(|()| stream.uniform(-0.6, 0.6));
        for (j, joint) in chain.joints.iter().enumerate() {
            let [x, y, z] = joint.play.map(|play| play / PLAY);
            let [a, b] = side.map(|side| side + stream.uniform(-0.4, 0.4));
            pose.turns[c][j] = [a * x, stream.uniform(-y, y), b * z];
        }
    }
    pose
}

fn shape(
    family: usize,
    model: &BodyModel,
    numbers: [usize; 2],
    options: &CreatureOptions,
    budget: &Budget,
) -> Result<LabeledShape, DatasetError> {
    let stream = |number, purpose| Stream::of_creature(options.seed, family, number, purpose);
    Ok(bent(model, &label(family), numbers, &options.of_shape(), stream, budget)?.shape)
}
