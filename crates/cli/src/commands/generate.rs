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
use crate::output::{count, report, shown};

/// Writes the built-in shapes as mesh files, one class at a time, so that a large collection needs little memory.
pub(crate) fn generate(args: &GenerateArgs, common: &Common) -> Result<ExitCode> {
    let n_classes = match args.family {
        FamilyArg::All => Family::all().len(),
        FamilyArg::Creatures => args.classes,
        _ => 1,
    };
    let bar = Bars::new(common.quiet).bar("classes", n_classes);
    let mut written = Vec::new();
    for class in 0..n_classes {
        let shapes = shapes(class, args, common)?;
        let folder = match (args.family, shapes.first()) {
            (FamilyArg::Creatures, Some(shape)) => args.output.join(&shape.label),
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
            return format!("{} in {folder}", count(n, "mechanical part"));
        }
        let (shapes, classes) = (count(n, "shape"), count(n_classes, "class"));
        format!("{shapes} of {classes} with {n_vertices} vertices each in {folder}")
    })
}

/// The shapes of a class, by its number.
fn shapes(class: usize, args: &GenerateArgs, common: &Common) -> Result<Vec<LabeledShape>, DatasetError> {
    let n_vertices = args.vertices;
    let family = match args.family {
        FamilyArg::All => Family::all()[class],
        FamilyArg::Cat => Family::Cat,
        FamilyArg::Centaur => Family::Centaur,
        FamilyArg::David => Family::David,
        FamilyArg::Person => Family::Person,
        FamilyArg::Creatures => {
            let defaults = CreatureOptions::default();
            let options = CreatureOptions {
                seed: defaults.seed.wrapping_add(common.seed),
                n_families: args.classes,
                n_poses: args.poses.unwrap_or(defaults.n_poses),
                n_vertices,
            };
            return creature_family(class, &options);
        }
        FamilyArg::Parts => {
            let options = PartMesh { arcs: args.arcs, ..PartMesh::default() };
            let parts = mechanical_parts(common.seed, args.parts).into_par_iter();
            let shape = |part: MechanicalPart| LabeledShape {
                name: part.name(),
                label: part.family().name().to_owned(),
                mesh: part.mesh(&options),
            };
            return Ok(parts.map(shape).collect());
        }
    };
    // Seed 0, the default of every command, stands for the default of the dataset.
    let seed = ArticulatedOptions::default().seed.wrapping_add(common.seed);
    let options = ArticulatedOptions { seed, n_vertices };
    let poses = (0..args.poses.unwrap_or(family.n_shapes())).into_par_iter();
    poses.map(|pose| articulated_shape(family, pose, &options)).collect()
}
