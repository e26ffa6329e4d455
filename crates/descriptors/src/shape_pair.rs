//! Two shapes and the ways their forms align.

use std::cell::OnceCell;

use mesh::TriMesh;
use nalgebra::Point3;
use rigid::{Alignment, Handedness, OrientedPoints, PointSet, Reflections, align_points};
use serde::Serialize;

use crate::canonical_form::{CanonicalForm, Normalization};
use crate::error::DescriptorError;
use crate::metric::{ShapeDistance, ShapeMetric};

/// A shape prepared for comparison: its fused vector, its rigid signature if it has one, and its form rounded to the 32 bits that an index stores, so that a
/// shape compares in the same way before and after it is stored.
#[derive(Debug)]
pub struct PreparedShape {
    /// All signatures as one vector.
    pub fused: Vec<f32>,
    /// The values of its rigid signature, if it has one.
    pub rigid: Vec<f32>,
    /// The form, in mesh units.
    pub form: CanonicalForm,
    /// The form at unit area, ready to be aligned.
    pub unit: PointSet,
    area: Option<f64>,
}

impl PreparedShape {
    /// Prepares a shape from its [fused](ShapeMetric::fuse) vector, the values of its [rigid signature](crate::rigid_signature),
    /// none if its surface may bend, its form at some points, and the area of its surface in squared mesh units. A form without a
    /// unit of length stays without one.
    ///
    /// # Errors
    /// [`DescriptorError::NoExtent`].
    pub fn new(
        fused: Vec<f32>,
        rigid: Vec<f32>,
        form: &CanonicalForm,
        area: Option<f64>,
    ) -> Result<Self, DescriptorError> {
        let rounded = |x: f64| f64::from(x as f32);
        let points = form.points().iter().map(|p| p.map(rounded)).collect();
        let weights = form.weights().iter().map(|w| rounded(*w)).collect();
        let form = CanonicalForm::from_parts(points, weights, form.area().and(area))?;
        let unit = form.normalized(Normalization::UnitArea);
        Ok(Self { fused, rigid, unit: unit.prepared()?, form, area })
    }

    /// The shape with another form.
    ///
    /// # Errors
    /// [`DescriptorError::NoExtent`].
    pub fn with_form(&self, form: &CanonicalForm) -> Result<Self, DescriptorError> {
        Self::new(self.fused.clone(), self.rigid.clone(), form, self.area)
    }

    /// The robust distance, with the [rigid part](ShapeMetric::rigid). [`ShapeMetric::robust`] of the fused vectors is a lower
    /// bound.
    pub fn robust(&self, other: &Self) -> f64 {
        ShapeMetric::robust(&self.fused, &other.fused).hypot(ShapeMetric::rigid(&self.rigid, &other.rigid))
    }

    /// The unit of length that gives the surface unit area; 1 if the form has no unit of length.
    pub fn size(&self) -> f64 {
        self.form.area().map_or(1.0, f64::sqrt)
    }

    /// Points of the form of this shape at unit area; `form` may have more points than the one that was prepared.
    pub fn at_unit_area(&self, form: &CanonicalForm) -> Vec<Point3<f64>> {
        let size = self.size();
        form.points().iter().map(|p| p / size).collect()
    }
}

/// One of two shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Side {
    /// The first shape.
    First,
    /// The second shape.
    Second,
}

impl Side {
    /// A pair in the other order, if this is the second side: what belongs to this side comes first.
    pub fn ordered<T>(self, [first, second]: [T; 2]) -> [T; 2] {
        match self {
            Self::First => [first, second],
            Self::Second => [second, first],
        }
    }
}

/// Forms of unit area with a smaller root mean square distance fit so well that the normals of their surfaces can be
/// compared: three times that of two poses. Between poses of TOSCA's cats, centaurs and davids the distance is mostly below 0.07, between two of
/// these animals mostly above 0.1; but a cat and a dog may be 0.06 apart, so a fit alone does not make one shape.
const FITTING: f64 = 3.0 * ShapeMetric::FORM_UNIT;

/// Two shapes and the ways the form of the first aligns with that of the second. Each alignment at unit area is found at
/// most once, and only when it is needed.
#[derive(Debug)]
pub struct ShapePair<'a> {
    /// The two shapes.
    pub shapes: [&'a PreparedShape; 2],
    best: OnceCell<Alignment>,
    other_handed: OnceCell<Alignment>,
}

impl<'a> ShapePair<'a> {
    /// Two shapes, not yet aligned.
    pub fn new(shapes: [&'a PreparedShape; 2]) -> Self {
        let [best, other_handed] = Default::default();
        Self { shapes, best, other_handed }
    }

    /// The pair with a [best](Self::best) alignment that is known already.
    #[must_use]
    pub fn with_best(self, best: Alignment) -> Self {
        Self { best: OnceCell::from(best), ..self }
    }

    /// The size of the second surface over that of the first, from their areas; 1 if one is unknown.
    pub fn scale(&self) -> f64 {
        let [a, b] = self.shapes.map(|shape| shape.area);
        a.zip(b).map_or(1.0, |(a, b)| (b / a).sqrt())
    }

    /// The best alignment of the forms at unit area, with or without a reflection.
    pub fn best(&self) -> Alignment {
        *self.best.get_or_init(|| self.aligned(Reflections::Allow))
    }

    /// The best alignment at unit area under a restriction on reflections.
    pub fn best_with(&self, reflections: Reflections) -> Alignment {
        let best = self.best();
        let excluded = if best.map.reflected { Reflections::Forbid } else { Reflections::Require };
        match reflections == excluded {
            true => *self.other_handed.get_or_init(|| self.aligned(reflections)),
            false => best,
        }
    }

    /// Aligns the forms in mesh units. Without a unit of length that is the [best](Self::best) alignment.
    ///
    /// # Errors
    /// [`DescriptorError::NoExtent`].
    pub fn align_raw(&self) -> Result<Alignment, DescriptorError> {
        let [a, b] = self.shapes.map(|shape| &shape.form);
        if a.area().or(b.area()).is_none() {
            return Ok(self.best());
        }
        Ok(align_points(&a.prepared()?, &b.prepared()?, Reflections::Allow))
    }

    /// Whether the second surface is the mirror image of the first, from the forms of all their vertices and the meshes.
    ///
    /// # Errors
    /// [`DescriptorError::NoExtent`].
    pub fn handedness(
        &self,
        surfaces: [(&CanonicalForm, &TriMesh); 2],
    ) -> Result<Handedness, DescriptorError> {
        if self.best().gap.rms >= FITTING {
            return Ok(Handedness::Unknown);
        }
        let [a, b] = [0, 1].map(|i| {
            let (form, mesh) = surfaces[i];
            OrientedPoints::new(mesh, self.shapes[i].at_unit_area(form), form.weights())
        });
        let (Some(a), Some(b)) = (a, b) else { return Ok(Handedness::Unknown) };
        // A point is about half of √(1 / n) from the nearest of n others.
        let sampling = 0.5 / (self.shapes[1].form.points().len() as f64).sqrt();
        let alignments = [Reflections::Forbid, Reflections::Require].map(|by| self.best_with(by));
        // Half of the mean square distance between two poses says nothing: they change both alignments, and much alike.
        let uncertainty = sampling.hypot(ShapeMetric::FORM_UNIT * std::f64::consts::FRAC_1_SQRT_2);
        Ok(Handedness::from_alignments(alignments, [&a, &b], uncertainty)?)
    }

    /// How far apart the shapes are, regardless of size.
    pub fn distance(&self) -> ShapeDistance {
        let [a, b] = self.shapes.map(|shape| ShapeMetric::without_size(&shape.fused));
        let rigid = ShapeMetric::rigid(&self.shapes[0].rigid, &self.shapes[1].rigid);
        let combined = ShapeMetric::combined(ShapeMetric::robust(a, b).hypot(rigid), self.best().gap.rms);
        ShapeDistance { fused: ShapeMetric::fused(a, b), combined }
    }

    fn aligned(&self, reflections: Reflections) -> Alignment {
        align_points(&self.shapes[0].unit, &self.shapes[1].unit, reflections)
    }
}
