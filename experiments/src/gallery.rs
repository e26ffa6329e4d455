//! The described collection, and some of its shapes that are changed and searched for in it.

use anyhow::{Context as _, Result};
use canonform::index::Shape;
use canonform::{DescribeOptions, Surface, describe};
use datasets::Damage;
use descriptors::PreparedShape;
use retrieval::{Labels, Scores, rank_row};

use crate::collection::{LabeledSurface, map};
use crate::context::Context;

/// The described collection.
pub(crate) struct Gallery<'a> {
    context: &'a Context<'a>,
    pub(crate) options: DescribeOptions,
    pub(crate) described: Vec<Shape>,
    pub(crate) labels: Labels,
}

/// A shape that is searched for.
pub(crate) struct GalleryQuery<'a> {
    pub(crate) shape: &'a LabeledSurface,
    /// Its number in the gallery.
    pub(crate) own: usize,
    /// The seed of what is done to it.
    pub(crate) seed: u64,
}

impl<'a> Gallery<'a> {
    pub(crate) fn new(context: &'a Context<'a>) -> Result<Self> {
        let options = DescribeOptions::default();
        let described = map(&context.collection.all(), "describing", context.observer, |shape| {
            Ok(describe(&shape.surface, &options, &())?)
        })?;
        Ok(Self { context, options, described, labels: Labels::new(&context.collection.labels()) })
    }

    /// The collection, ready for comparisons.
    pub(crate) fn prepared(&self) -> Result<Vec<PreparedShape>> {
        Ok(self.described.iter().map(|shape| self.options.prepare(shape)).collect::<Result<_, _>>()?)
    }

    /// Calls `work` for up to `n` shapes of every class.
    pub(crate) fn map<T: Send>(
        &self,
        n: usize,
        stage: &str,
        work: impl Fn(&GalleryQuery<'_>) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let Context { collection, observer, seed, .. } = self.context;
        map(&collection.first_of_each_class(n), stage, *observer, |shape| {
            let own = collection.shapes.iter().position(|other| other.name == shape.name);
            let own = own.context("a shape of the collection")?;
            work(&GalleryQuery { shape, own, seed: seed + own as u64 })
        })
    }

    /// The scores of a query that is left out itself. Of a shape that is alone in its class, nothing can be found.
    pub(crate) fn scores(&self, query: &GalleryQuery<'_>, distance: impl Fn(usize) -> f64) -> Scores {
        let distances: Vec<f64> = (0..self.described.len()).map(distance).collect();
        Scores::for_query(&rank_row(&distances, query.own), query.own, &self.labels).unwrap_or_default()
    }

    /// Whether a shape of the gallery has the class of the query.
    pub(crate) fn is_right(&self, query: &GalleryQuery<'_>, index: usize) -> bool {
        self.labels.class(index) == self.labels.class(query.own)
    }
}

impl GalleryQuery<'_> {
    pub(crate) fn damaged(&self, damage: Damage) -> Result<Surface> {
        let mesh = damage.apply(self.shape.surface.mesh(), self.seed);
        Ok(Surface::new(&mesh, &self.shape.surface.input.repair, &())?)
    }
}
