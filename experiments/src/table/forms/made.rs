//! The methods that make forms.

use anyhow::{Context as _, Result};
use canonform::Surface;
use canonform::embed::{EmbedMethod, Embedded, FormOptions, Samples, embed};
use descriptors::{CanonicalForm, SampledForm};
use linalg::{LandmarkDistances, Matrix};
use mesh::TriMesh;
use nmds::{
    Bandwidth, Embedding, KernelPcaOptions, LandmarkPairs, NystromOptions, SmacofOptions, kernel_pca,
    landmark_mds, nystrom, smacof,
};

use crate::collection::{LabeledSurface, map};
use crate::context::Context;
use crate::specimen::DIM;
use crate::sweep::{half, timed};

/// Points of a form that are compared, as many as an index stores.
const POINTS: usize = 1000;

/// The spread of a form of unit area: the median of built-in creatures. It scales forms without a unit of length.
const USUAL_SPREAD: f64 = 0.43;

/// A surface with the distances from its samples, which all methods share.
pub(super) struct ShapeDistances {
    surface: Surface,
    distances: LandmarkDistances,
    /// For the distances.
    seconds: f64,
}

/// A form by one of the methods.
pub(super) struct MadeForm {
    /// In all its dimensions.
    pub(super) sampled: SampledForm,
    /// The unit of length that gives the surface unit area.
    pub(super) unit: f64,
    /// If it has three dimensions.
    solid: Option<SolidForm>,
    /// Seconds from the surface to the form.
    pub(super) seconds: f64,
}

/// A form of three dimensions.
pub(super) struct SolidForm {
    /// At all vertices.
    pub(super) whole: CanonicalForm,
    /// At the points that are compared.
    pub(super) form: CanonicalForm,
    /// With the triangles of the surface.
    pub(super) mesh: TriMesh,
}

impl MadeForm {
    /// # Errors
    /// If the form has more than three dimensions.
    pub(super) fn solid(&self) -> Result<&SolidForm> {
        self.solid.as_ref().context("a form of three dimensions")
    }
}

/// A method that makes forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FormMaker {
    /// The paper's.
    Nmds,
    /// The surface bent towards it.
    BentNmds,
    /// The paper's, in many dimensions.
    ManyNmds,
    /// With more samples.
    MoreSamples,
    /// Classical scaling of the samples.
    Landmark,
    /// Least squares of the distances from the samples.
    LeastSquares,
    /// Least squares, weighted by the inverse distance.
    Sammon,
    /// The same in many dimensions, by which an index ranks forms.
    ManySammon,
    /// The paper's baseline.
    KernelPca,
    /// The surface bent towards it.
    BentKernelPca,
    /// The baseline in many dimensions.
    ManyKernelPca,
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
    pub(super) const ALL: [Self; 13] = [
        Self::Nmds,
        Self::BentNmds,
        Self::ManyNmds,
        Self::MoreSamples,
        Self::Landmark,
        Self::LeastSquares,
        Self::Sammon,
        Self::ManySammon,
        Self::KernelPca,
        Self::BentKernelPca,
        Self::ManyKernelPca,
        Self::Classical,
        Self::Smacof,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Nmds => "NMDS",
            Self::BentNmds => "NMDS with features",
            Self::ManyNmds => "NMDS, 16 dimensions",
            Self::MoreSamples => "NMDS, more samples",
            Self::Landmark => "landmark MDS",
            Self::LeastSquares => "least squares",
            Self::Sammon => "Sammon",
            Self::ManySammon => "Sammon, 16 dimensions",
            Self::KernelPca => "KPCA-Nystrom",
            Self::BentKernelPca => "KPCA with features",
            Self::ManyKernelPca => "KPCA-Nystrom, 16 dimensions",
            Self::Classical => "classical scaling",
            Self::Smacof => "SMACOF of all pairs",
        }
    }

    pub(super) fn needs_all_pairs(self) -> bool {
        matches!(self, Self::Classical | Self::Smacof)
    }

    /// Whether its forms have more than three dimensions.
    pub(super) fn has_many_dimensions(self) -> bool {
        matches!(self, Self::ManyNmds | Self::ManySammon | Self::ManyKernelPca)
    }

    /// Whether its forms are in the components of a kernel, which have no unit of length.
    fn is_of_kernel(self) -> bool {
        matches!(self, Self::KernelPca | Self::BentKernelPca | Self::ManyKernelPca)
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
            self.form(own.and_then(|i| distances.get(i)).context("a shape of the collection")?, samples)
        })
    }

    fn form(self, shape: &ShapeDistances, [usual, more]: [usize; 2]) -> Result<MadeForm> {
        let n = if self == Self::MoreSamples { more } else { usual };
        let (distances, measuring) = shape.first(n)?;
        if self.has_many_dimensions() {
            let ((sampled, unit), seconds) =
                timed(|| self.of_many_dimensions(&distances, shape.surface.mesh()))?;
            return Ok(MadeForm { sampled, unit, solid: None, seconds: measuring + seconds });
        }
        let measuring = if self.needs_all_pairs() { 0.0 } else { measuring };
        let mesh = shape.surface.mesh();
        let masses = mesh.vertex_areas();
        let (embedding, seconds) = timed(|| self.embedding(shape, &distances, &masses))?;
        let unit = self.unit(&embedding.coords, mesh);
        let whole = CanonicalForm::new(&embedding, mesh)?;
        let whole = if self.is_of_kernel() { whole.without_unit() } else { whole };
        let (whole, bending) = match self {
            Self::BentNmds | Self::BentKernelPca => timed(|| whole.with_features(mesh, &()))?,
            _ => (whole, 0.0),
        };
        let unit = whole.area().map_or(unit, f64::sqrt);
        let coords = Matrix::from_fn(masses.len(), DIM, |i, k| whole.points()[i][k]);
        Ok(MadeForm {
            sampled: SampledForm::new(&coords, &masses)?,
            unit,
            seconds: measuring + seconds + bending,
            solid: Some(SolidForm { form: whole.reduced(POINTS), mesh: whole.to_mesh(mesh), whole }),
        })
    }

    /// A form of many dimensions, and the unit of length that gives the surface unit area.
    pub(crate) fn of_many_dimensions(
        self,
        distances: &LandmarkDistances,
        mesh: &TriMesh,
    ) -> Result<(SampledForm, f64)> {
        let masses = mesh.vertex_areas();
        let coords = match self {
            Self::ManySammon => {
                let form = SampledForm::by_least_squares(distances, &masses, &())?;
                return Ok((form, mesh.root_of_area()));
            }
            Self::ManyKernelPca => by_kernel(distances, SampledForm::DIM)?.coords,
            _ => {
                let options = NystromOptions { dim: SampledForm::DIM, ..NystromOptions::default() };
                nystrom(distances, &options)?.coords
            }
        };
        Ok((SampledForm::new(&coords, &masses)?, self.unit(&coords, mesh)))
    }

    /// The unit of length that gives the surface unit area.
    fn unit(self, coords: &Matrix, mesh: &TriMesh) -> f64 {
        match self.is_of_kernel() {
            true => spread(coords, &mesh.vertex_areas()) / USUAL_SPREAD,
            false => mesh.root_of_area(),
        }
    }

    fn embedding(
        self,
        shape: &ShapeDistances,
        distances: &LandmarkDistances,
        masses: &[f64],
    ) -> Result<Embedding> {
        let usual = || nystrom(distances, &NystromOptions::default());
        let by_least_squares = |power| {
            let pairs = LandmarkPairs { landmarks: distances.landmarks(), rows: distances, masses, power };
            let options = SmacofOptions { max_iterations: 20, tolerance: 0.0 };
            Ok::<_, anyhow::Error>(smacof(&usual()?.coords, &pairs, &options, &())?.0)
        };
        let of_all_pairs = |method| {
            let samples = Samples::Count(distances.n_landmarks());
            embed(&shape.surface, &FormOptions { method, samples, ..FormOptions::default() }, &())
        };
        Ok(match self {
            Self::Landmark => landmark_mds(distances, DIM)?,
            Self::LeastSquares => by_least_squares(0.0)?,
            Self::Sammon => by_least_squares(1.0)?,
            Self::KernelPca | Self::BentKernelPca => by_kernel(distances, DIM)?,
            Self::Classical => of_all_pairs(EmbedMethod::Classical)?.embedding,
            Self::Smacof => {
                let regularization = half(distances.n_landmarks());
                let descent = SmacofOptions::default();
                of_all_pairs(EmbedMethod::Smacof { regularization, descent })?.embedding
            }
            _ => usual()?,
        })
    }
}

fn by_kernel(distances: &LandmarkDistances, dim: usize) -> Result<Embedding> {
    let rank = Some(distances.n_landmarks().div_ceil(2));
    Ok(kernel_pca(distances, &KernelPcaOptions { bandwidth: Bandwidth::Mean, rank, dim })?)
}

/// Root of the mean squared distance from the centroid.
fn spread(coords: &Matrix, masses: &[f64]) -> f64 {
    let total: f64 = masses.iter().sum();
    let of = |x: nalgebra::DVectorView<'_, f64>| {
        let weighted = || x.iter().zip(masses);
        let mean = weighted().map(|(x, m)| x * m).sum::<f64>() / total;
        weighted().map(|(x, m)| m * (x - mean).powi(2)).sum::<f64>() / total
    };
    coords.column_iter().map(of).sum::<f64>().sqrt()
}
