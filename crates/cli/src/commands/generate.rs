//! `canonform generate`.

use std::process::ExitCode;

use anyhow::{Context, Result};
use base::object;
use base::terminal::Bars;
use datasets::{
    ArticulatedOptions, CreatureOptions, DatasetError, Family, LabeledShape, MechanicalPart, PartMesh,
    articulated_shape, creature_family, mechanical_parts,
};
use rayon::prelude::*;

use crate::args::{Common, FamilyArg, GenerateArgs};
use crate::output::{report, shown};

/// One class: its shapes can be generated without those of the others, so that a large collection needs little memory.
enum Class {
    Articulated(Family),
    Creature(usize),
    Parts,
}

/// Writes the built-in shapes as mesh files.
pub(crate) fn generate(args: &GenerateArgs, common: &Common) -> Result<ExitCode> {
    let classes: Vec<Class> = match args.family {
        FamilyArg::All => Family::all().map(Class::Articulated).into(),
        FamilyArg::Cat => vec![Class::Articulated(Family::Cat)],
        FamilyArg::Centaur => vec![Class::Articulated(Family::Centaur)],
        FamilyArg::David => vec![Class::Articulated(Family::David)],
        FamilyArg::Person => vec![Class::Articulated(Family::Person)],
        FamilyArg::Creatures => (0..args.classes).map(Class::Creature).collect(),
        FamilyArg::Parts => vec![Class::Parts],
    };
    let bar = Bars::new(common.quiet).bar("classes", classes.len());
    let (n_classes, mut written) = (classes.len(), Vec::new());
    for class in classes {
        let shapes = shapes(&class, args, common)?;
        let folder = match (&class, shapes.first()) {
            (Class::Creature(_), Some(shape)) => args.output.join(&shape.label),
            _ => args.output.clone(),
        };
        std::fs::create_dir_all(&folder)
            .with_context(|| format!("cannot create the folder {}", folder.display()))?;
        for shape in shapes {
            let path = folder.join(format!("{}.{}", shape.name, args.output_format));
            canonform::mesh::io::write(&path, &shape.mesh)?;
            let (name, label) = (shape.name, shape.label);
            let (n_vertices, n_faces) = (shape.mesh.n_vertices(), shape.mesh.n_faces());
            written.push(object! { name, label, path, n_vertices, n_faces });
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let json = object! { output: &args.output, n_classes, shapes: written };
    report(common, &json, |json| {
        let (n, folder, n_vertices) = (json.shapes.len(), shown(json.output), args.vertices);
        if args.family == FamilyArg::Parts {
            return format!("{n} mechanical parts in {folder}");
        }
        let classes = if n_classes == 1 { "class" } else { "classes" };
        format!("{n} shapes of {n_classes} {classes} with {n_vertices} vertices each in {folder}")
    })
}

fn shapes(class: &Class, args: &GenerateArgs, common: &Common) -> Result<Vec<LabeledShape>, DatasetError> {
    let n_vertices = args.vertices;
    match class {
        Class::Articulated(family) => {
            // Seed 0, the default of every command, stands for the default of the dataset.
            let seed = ArticulatedOptions::default().seed.wrapping_add(common.seed);
            let options = ArticulatedOptions { seed, n_vertices };
            let poses = (0..args.poses.unwrap_or(family.n_shapes())).into_par_iter();
            poses.map(|pose| articulated_shape(*family, pose, &options)).collect()
        }
        Class::Creature(family) => {
            let defaults = CreatureOptions::default();
            let options = CreatureOptions {
                seed: defaults.seed.wrapping_add(common.seed),
                n_families: args.classes,
                n_poses: args.poses.unwrap_or(defaults.n_poses),
                n_vertices,
            };
            creature_family(*family, &options)
        }
        Class::Parts => {
            let options = PartMesh { arcs: args.arcs, ..PartMesh::default() };
            let parts = mechanical_parts(common.seed, args.parts).into_par_iter();
            let shape = |part: MechanicalPart| LabeledShape {
                name: part.name(),
                label: part.family().name().to_owned(),
                mesh: part.mesh(&options),
            };
            Ok(parts.map(shape).collect())
        }
    }
}
