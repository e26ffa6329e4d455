//! The shapes of a run.

use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use base::terminal::note;
use canonform::collection::list_shapes;
use canonform::{Observer, Surface, read_surface, side_by_side};
use clap::Args;
use mesh::RepairOptions;
use rayon::prelude::*;

use crate::families::Families;

/// Name of the built-in dataset in records.
const BUILT_IN: &str = "built-in articulated families";

/// The classes of the paper's Figure 4.
pub(crate) const PAPER_CLASSES: [&str; 3] = ["cat", "centaur", "david"];

/// Stands for all classes on the command line.
const ALL_CLASSES: &str = "all";

/// The classes of TOSCA, sorted, which identify it.
const TOSCA_CLASSES: [&str; 12] = [
    "cat", "centaur", "david", "dog", "gorilla", "horse", "lioness", "michael", "seahorse", "shark",
    "victoria", "wolf",
];

/// The classes of TOSCA of which whole maps are known, sorted, and the least number of vertices of their shapes in full
/// resolution.
const MAPPED_CLASSES: [&str; 3] = ["cat", "david", "gorilla"];
const FULL_RESOLUTION: usize = 20_000;

/// Where the shapes come from, on the command line.
#[derive(Debug, Args)]
pub(crate) struct ShapeSource {
    /// A folder of meshes; classes come from sub-folders or from the leading letters of file names, as for `canonform index
    /// build`
    /// [default: the built-in articulated families]
    #[arg(long, value_name = "DIR")]
    dataset: Option<PathBuf>,
    /// Classes to use, in this order, or `all` [default: cat, centaur and david, as in the paper, if the
    /// folder has them; else all]
    #[arg(long, value_delimiter = ',', value_name = "CLASS,...")]
    classes: Vec<String>,
    /// Built-in families: `articulated` (30 shapes), `bodies:BxP` (B bodies of each family in P poses), `creatures:FxP` (F random
    /// families of P shapes each), `parts:NxC` (C copies each of N mechanical parts), or several of them
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "articulated",
        value_name = "NAME,...",
        conflicts_with = "dataset"
    )]
    families: Vec<Families>,
    /// Vertices of the built-in shapes, 1,000 to 1,000,000
    #[arg(long, default_value_t = 3400, value_name = "P", conflicts_with = "dataset")]
    vertices: usize,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 0, value_name = "S")]
    pub(crate) seed: u64,
}

/// Labelled surfaces, sorted by class.
pub(crate) struct SurfaceCollection {
    /// The folder, or the name of the built-in dataset.
    pub(crate) dataset: String,
    /// The classes, in the order of the shapes.
    pub(crate) classes: Vec<String>,
    pub(crate) shapes: Vec<LabeledSurface>,
}

pub(crate) struct LabeledSurface {
    pub(crate) name: String,
    pub(crate) label: String,
    pub(crate) surface: Surface,
}

impl SurfaceCollection {
    /// Generates or reads the shapes. Files that cannot be read are reported on standard error and left out.
    pub(crate) fn load(args: &ShapeSource, observer: &dyn Observer) -> Result<Self> {
        let repair = RepairOptions::default();
        let takes_all = args.classes == [ALL_CLASSES];
        let mut wanted = if takes_all { Vec::new() } else { args.classes.clone() };
        let (dataset, found) = match &args.dataset {
            None => {
                observer.begin("generating", 0);
                let mut shapes = Vec::new();
                for families in &args.families {
                    shapes.extend(families.generate(args.seed, args.vertices)?);
                }
                let shape = |shape: datasets::LabeledShape| {
                    let surface = Surface::new(&shape.mesh, &repair, &()).map_err(canonform::Error::from);
                    (shape.name, shape.label, surface)
                };
                let dataset = match args.families[..] {
                    [Families::Articulated] => BUILT_IN,
                    _ => "built-in families",
                };
                (dataset.to_owned(), shapes.into_par_iter().map(shape).collect::<Vec<_>>())
            }
            Some(folder) => {
                let mut files = list_shapes(folder, None)?;
                files.retain(|file| !file.label.is_empty());
                let is_there = |class: &&str| files.iter().any(|file| file.label == *class);
                if wanted.is_empty() && !takes_all && PAPER_CLASSES.iter().all(is_there) {
                    wanted = PAPER_CLASSES.map(str::to_owned).to_vec();
                }
                files.retain(|file| wanted.is_empty() || wanted.contains(&file.label));
                observer.begin("reading", files.len());
                let shape = |file: canonform::collection::ShapeFile| {
                    let surface = read_surface(&file.path, &repair, &Default::default(), &());
                    observer.step();
                    (file.name, file.label, surface)
                };
                (folder.display().to_string(), files.into_par_iter().map(shape).collect())
            }
        };
        let mut shapes = Vec::new();
        for (name, label, surface) in found {
            match surface {
                Ok(surface) => shapes.push(LabeledSurface { name, label, surface }),
                Err(fault) => note(&format!("left out {name}: {fault}")),
            }
        }
        Self::in_class_order(dataset, shapes, &wanted)
    }

    /// Sorts shapes by class, in the order of `wanted`, or of first appearance if it is empty.
    fn in_class_order(dataset: String, mut shapes: Vec<LabeledSurface>, wanted: &[String]) -> Result<Self> {
        let mut classes = wanted.to_vec();
        if classes.is_empty() {
            for shape in &shapes {
                if !classes.contains(&shape.label) {
                    classes.push(shape.label.clone());
                }
            }
        }
        if let Some(empty) = classes.iter().find(|class| shapes.iter().all(|s| s.label != **class)) {
            bail!("no readable shape of the class `{empty}` in {dataset}; leave it out of --classes");
        }
        let rank = |label: &String| classes.iter().position(|class| class == label);
        shapes.retain(|shape| rank(&shape.label).is_some());
        shapes.sort_by_key(|shape| rank(&shape.label));
        Ok(Self { dataset, classes, shapes })
    }

    pub(crate) fn labels(&self) -> Vec<String> {
        self.shapes.iter().map(|shape| shape.label.clone()).collect()
    }

    /// Whether the shapes are those of the built-in families, or some classes of them.
    pub(crate) fn is_built_in(&self) -> bool {
        self.dataset == BUILT_IN
    }

    pub(crate) fn setting(&self) -> Setting {
        let has = |classes: &[&str]| BTreeSet::from_iter(&self.classes).into_iter().eq(classes);
        let is_full = |shape: &LabeledSurface| shape.surface.mesh().n_vertices() >= FULL_RESOLUTION;
        match self.classes == PAPER_CLASSES {
            true if self.is_built_in() => Setting::BuiltIn,
            true => Setting::Paper,
            false if has(&TOSCA_CLASSES) => Setting::Tosca,
            false if has(&MAPPED_CLASSES) && self.shapes.iter().all(is_full) => Setting::FullResolution,
            false => Setting::Other,
        }
    }

    pub(crate) fn all(&self) -> Vec<&LabeledSurface> {
        self.shapes.iter().collect()
    }

    /// Up to `n` shapes of each class.
    pub(crate) fn first_of_each_class(&self, n: usize) -> Vec<&LabeledSurface> {
        let (classes, all) = (self.classes.iter(), &self.shapes);
        classes.flat_map(|class| all.iter().filter(move |shape| shape.label == *class).take(n)).collect()
    }
}

/// Calls `work` on all shapes, side by side. Every shape is a step of `stage`.
pub(crate) fn map<T: Send>(
    shapes: &[&LabeledSurface],
    stage: &str,
    observer: &dyn Observer,
    work: impl Fn(&LabeledSurface) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    observer.begin(stage, shapes.len());
    let one = |shape: &&LabeledSurface| {
        let result = work(shape).with_context(|| shape.name.clone());
        observer.step();
        result
    };
    side_by_side(shapes.iter().collect(), one)
}

/// The kind of a collection, which decides the expectations that apply.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Setting {
    BuiltIn,
    /// The paper's classes from a folder.
    Paper,
    /// All classes of TOSCA from a folder.
    Tosca,
    /// The classes of TOSCA whose shapes correspond vertex by vertex, in full resolution, from a folder. Only what names it
    /// applies to it.
    FullResolution,
    /// Any other collection; no expectation applies.
    Other,
}
