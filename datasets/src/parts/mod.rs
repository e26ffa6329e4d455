//! Mechanical parts as CAD programs export them: closed surfaces with sharp edges, flat faces and uneven triangles.
//!
//! Their parameters are near each other on purpose, to test by how little two parts may differ.

mod build;
mod family;
mod flat;
mod options;
mod solid;
#[cfg(test)]
mod tests;

use std::collections::HashSet;

use mesh::TriMesh;

use crate::stream::{Purpose, Stream};

pub use family::PartFamily;
pub use options::{Diagonals, PartMesh};
use solid::Solid;

/// A mechanical part: a family and its parameters. Lengths are in millimetres.
///
/// ```
/// use canonform_datasets::{PartMesh, mechanical_parts};
///
/// let parts = mechanical_parts(0, 112);
/// let gear = &parts[2];
/// assert_eq!(gear.family().name(), "gear");
/// assert_eq!(gear.parameters()[0].0, "teeth");
/// let coarse = gear.mesh(&PartMesh::default());
/// let fine = gear.mesh(&PartMesh { arcs: 400, ..PartMesh::default() });
/// assert!(fine.signed_volume() < coarse.signed_volume() && coarse.n_faces() < fine.n_faces());
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MechanicalPart {
    family: PartFamily,
    values: Vec<f64>,
}

impl MechanicalPart {
    /// A part with the values of all parameters, in the order of [`parameters`](Self::parameters). Those that do not fit
    /// together, such as a hole wider than its plate, give surfaces that intersect themselves.
    ///
    /// # Panics
    /// If the number of values is not that of the parameters of the family.
    pub fn new(family: PartFamily, values: &[f64]) -> Self {
        assert_eq!(values.len(), family.parameters().len(), "parameters of a {}", family.name());
        Self { family, values: values.to_vec() }
    }

    /// Its family.
    pub fn family(&self) -> PartFamily {
        self.family
    }

    /// Names and values of the parameters: lengths in millimetres, counts, angles in degrees. A thread's hand is 1 if it
    /// is right-handed and -1 if it is left-handed; such screws are each other's mirror images.
    pub fn parameters(&self) -> Vec<(&'static str, f64)> {
        self.family.parameters().iter().map(|(name, ..)| *name).zip(self.values.iter().copied()).collect()
    }

    /// The parameters in which two parts of one family differ, with both values; `None` for parts of two families.
    pub fn differences(&self, other: &Self) -> Option<Vec<(&'static str, [f64; 2])>> {
        let pairs = self.parameters().into_iter().zip(&other.values);
        let differing = pairs.filter(|((_, a), b)| a != *b).map(|((name, a), &b)| (name, [a, b]));
        (self.family == other.family).then(|| differing.collect())
    }

    /// Family and parameters, such as `gear-z18-m1-t5-d4`.
    pub fn name(&self) -> String {
        let parameters = self.family.parameters().iter().zip(&self.values);
        parameters.fold(self.family.name().to_owned(), |name, ((_, letter, _), value)| {
            format!("{name}-{letter}{value}")
        })
    }

    /// The surface: closed, manifold, in one piece and oriented outwards.
    pub fn mesh(&self, options: &PartMesh) -> TriMesh {
        let mut solid = Solid::new(*options);
        self.build(&mut solid);
        solid.mesh
    }
}

/// Different parts, from all families in turn. Every other part differs in one parameter from the one before it in its
/// family, and most others in a few, by a millimetre or two.
///
/// The first parts of a longer list are those of a shorter one. Families without further parts are left out, and the
/// list ends when there are none; that is after more than 300 parts.
pub fn mechanical_parts(seed: u64, n: usize) -> Vec<MechanicalPart> {
    let mut families: Vec<Draw> = PartFamily::ALL.iter().map(|family| Draw::new(seed, *family)).collect();
    let mut parts = Vec::with_capacity(n);
    while parts.len() < n && !families.is_empty() {
        families.retain_mut(|family| {
            let next = family.next();
            parts.extend(next.clone());
            next.is_some()
        });
    }
    parts.truncate(n);
    parts
}

/// Parts of one family, none twice.
struct Draw {
    family: PartFamily,
    stream: Stream,
    /// The choices of the last part.
    last: Vec<usize>,
    seen: HashSet<Vec<usize>>,
}

impl Draw {
    fn new(seed: u64, family: PartFamily) -> Self {
        let stream = Stream::of_creature(seed, family as usize, 0, Purpose::Part);
        Self { family, stream, last: Vec::new(), seen: HashSet::new() }
    }

    fn next(&mut self) -> Option<MechanicalPart> {
        let parameters = self.family.parameters();
        if self.seen.len() == parameters.iter().map(|(.., values)| values.len()).product::<usize>() {
            return None;
        }
        loop {
            let mut choices = self.last.clone();
            if choices.is_empty() || self.stream.below(2) == 0 {
                choices = parameters.iter().map(|(.., values)| self.stream.below(values.len())).collect();
            } else {
                let changed = self.stream.below(parameters.len());
                choices[changed] = self.stream.below(parameters[changed].2.len());
            }
            if self.seen.insert(choices.clone()) {
                let values: Vec<f64> =
                    parameters.iter().zip(&choices).map(|((.., values), &i)| values[i]).collect();
                self.last = choices;
                return Some(MechanicalPart::new(self.family, &values));
            }
        }
    }
}
