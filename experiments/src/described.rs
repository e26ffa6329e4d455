//! A built-in shape with its description.

use anyhow::Result;
use canonform::{DescribeOptions, ShapeDescription, Surface, describe};
use datasets::LabeledShape;
use descriptors::PreparedShape;

/// A built-in shape, with the number of its body within the family.
pub(crate) struct DescribedBody {
    pub(crate) label: String,
    pub(crate) seed: u64,
    pub(crate) body: usize,
    pub(crate) description: ShapeDescription,
    pub(crate) shape: PreparedShape,
}

impl DescribedBody {
    pub(crate) fn new(shape: &LabeledShape, seed: u64, body: usize) -> Result<Self> {
        let options = DescribeOptions::default();
        let description = describe(&Surface::new(&shape.mesh, &options.form.repair, &())?, &options, &())?;
        let prepared = description.prepare()?;
        Ok(Self { label: shape.label.clone(), seed, body, description, shape: prepared })
    }
}
