//! The methods that make forms.

use anyhow::{Context as _, Result};
use canonform::{EmbedMethod, Embedded, FormOptions, Samples, Surface, embed};
use descriptors::CanonicalForm;
use linalg::LandmarkDistances;
use mesh::TriMesh;
use nmds::{
    Bandwidth, Embedding, KernelPcaOptions, LandmarkSmacofOptions, NystromOptions, SmacofOptions, kernel_pca,
    landmark_mds, landmark_smacof, nystrom,
};

use crate::collection::{LabeledSurface, map};
use crate::context::Context;
use crate::specimen::DIM;
use crate::sweep::{half, timed};

/// Points of a form that are compared, as many as an index stores.
const POINTS: usize = 1000;

/// A surface with the distances from its samples, which all methods share.
pub(super) struct ShapeDistances {
    surface: Surface,
    distances: LandmarkDistances,
    /// For the distances.
    seconds: f64,
}

/// A form by one of the methods.
pub(super) struct MadeForm {
    /// At all vertices.
    pub(super) whole: CanonicalForm,
    /// At the points that are compared.
    pub(super) form: CanonicalForm,
    /// With the triangles of the surface.
    pub(super) mesh: TriMesh,
    /// Seconds from the surface to the form.
    pub(super) seconds: f64,
}

/// A method that makes forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FormMaker {
    /// The paper's.
    Nmds,
    /// The surface bent towards it.
    BentNmds,
    /// With more samples.
    MoreSamples,
    /// Classical scaling of the samples.
    Landmark,
    /// Least squares of the distances from the samples.
    LeastSquares,
    /// Least squares, weighted by the inverse distance.
    Sammon,
    /// The paper's baseline.
    KernelPca,
    /// The surface bent towards it.
    BentKernelPca,
    /// Classical scaling of all pairs of vertices.
    Classical,
    /// Least squares of all pairs of vertices.
    Smacof,
}

impl ShapeDistances {
    /// Measures all shapes of a collection.
    pub(super) fn of(shapes: &[&LabeledSurface], samples: usize, context: &Context<'_>) -> Result<Vec<Self>> {
        map(shapes, "measuring", context.observer, |shape| {
            let surface = shape.surface.for_description(&())?;
            let options = FormOptions { samples: Samples::Count(samples), ..FormOptions::default() };
            let (embedded, seconds) = timed(|| embed(&surface, &options, &()))?;
            let Embedded { distances, .. } = embedded;
            Ok(Self { surface, distances, seconds })
        })
    }

    /// From the first `n` samples, and the seconds that they take.
    fn first(&self, n: usize) -> Result<(LandmarkDistances, f64)> {
        let n = n.min(self.distances.n_landmarks());
        let share = n as f64 / self.distances.n_landmarks() as f64;
        let columns = self.distances.to_matrix()?.columns(0, n).into_owned();
        let landmarks = self.distances.landmarks()[..n].to_vec();
        Ok((LandmarkDistances::new(landmarks, columns)?, share * self.seconds))
    }
}

impl FormMaker {
    pub(super) const ALL: [Self; 10] = [
        Self::Nmds,
        Self::BentNmds,
        Self::MoreSamples,
        Self::Landmark,
        Self::LeastSquares,
        Self::Sammon,
        Self::KernelPca,
        Self::BentKernelPca,
        Self::Classical,
        Self::Smacof,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Nmds => "NMDS",
            Self::BentNmds => "NMDS with features",
            Self::MoreSamples => "NMDS, more samples",
            Self::Landmark => "landmark MDS",
            Self::LeastSquares => "least squares",
            Self::Sammon => "Sammon",
            Self::KernelPca => "KPCA-Nystrom",
            Self::BentKernelPca => "KPCA with features",
            Self::Classical => "classical scaling",
            Self::Smacof => "SMACOF of all pairs",
        }
    }

    pub(super) fn needs_all_pairs(self) -> bool {
        matches!(self, Self::Classical | Self::Smacof)
    }

    /// The forms of all shapes, by the given numbers of samples, usual and more.
    pub(super) fn forms(
        self,
        shapes: &[&LabeledSurface],
        distances: &[ShapeDistances],
        samples: [usize; 2],
        context: &Context<'_>,
    ) -> Result<Vec<MadeForm>> {
        map(shapes, self.name(), context.observer, |shape| {
            let own = shapes.iter().position(|other| other.name == shape.name);
            let known = own.and_then(|i| distances.get(i)).context("a shape of the collection")?;
            let (whole, seconds) = self.form(known, samples)?;
            let mesh = whole.to_mesh(known.surface.mesh());
            Ok(MadeForm { form: whole.reduced(POINTS), whole, mesh, seconds })
        })
    }

    fn form(self, shape: &ShapeDistances, [usual, more]: [usize; 2]) -> Result<(CanonicalForm, f64)> {
        let n = if self == Self::MoreSamples { more } else { usual };
        if self.needs_all_pairs() {
            let method = match self {
                Self::Smacof => {
                    EmbedMethod::Smacof { regularization: half(n), descent: SmacofOptions::default() }
                }
                _ => EmbedMethod::Classical,
            };
            let options = FormOptions { method, samples: Samples::Count(n), ..FormOptions::default() };
            let (embedded, seconds) = timed(|| embed(&shape.surface, &options, &()))?;
            return Ok((embedded.form(&shape.surface)?, seconds));
        }
        let (distances, measuring) = shape.first(n)?;
        let (embedding, seconds) = timed(|| self.embedding(&distances, &shape.surface))?;
        let form = CanonicalForm::new(&embedding, shape.surface.mesh())?;
        let has_unit = !matches!(self, Self::KernelPca | Self::BentKernelPca);
        let form = if has_unit { form } else { form.without_unit() };
        let (form, bending) = match self {
            Self::BentNmds | Self::BentKernelPca => timed(|| form.with_features(shape.surface.mesh(), &()))?,
            _ => (form, 0.0),
        };
        Ok((form, measuring + seconds + bending))
    }

    fn embedding(self, distances: &LandmarkDistances, surface: &Surface) -> Result<Embedding> {
        let usual = || nystrom(distances, &NystromOptions::default());
        let by_least_squares = |power| {
            let options = LandmarkSmacofOptions { power, ..LandmarkSmacofOptions::default() };
            let masses = surface.mesh().vertex_areas();
            landmark_smacof(&usual()?.coords, distances, &masses, &options, &())
        };
        Ok(match self {
            Self::Landmark => landmark_mds(distances, DIM)?,
            Self::LeastSquares => by_least_squares(0.0)?,
            Self::Sammon => by_least_squares(1.0)?,
            Self::KernelPca | Self::BentKernelPca => {
                let rank = Some(distances.n_landmarks().div_ceil(2));
                kernel_pca(distances, &KernelPcaOptions { bandwidth: Bandwidth::Mean, rank, dim: DIM })?
            }
            _ => usual()?,
        })
    }
}
