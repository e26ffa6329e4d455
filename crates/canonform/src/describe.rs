//! A mesh as an index keeps it: form, signatures and facts.

use descriptors::{
    CanonicalForm, LaplaceSpectrum, Normalization, PreparedForm, Signature, SignatureKind, d2_histogram,
    fuse, geodesic_spectrum, heat_kernel_signature, moment_signature, shape_dna, wave_kernel_signature,
};
use geodesics::{FirstSample, Method, Sampling};
use linalg::LandmarkDistances;
use mesh::{RepairOptions, RepairReport, TriMesh};
use nmds::{NystromOptions, nystrom};
use serde::{Deserialize, Serialize};

use crate::forms::MATCHED_POINTS;
use crate::{PipelineError, Surface};

/// Counts every change of what the same mesh and options are turned into: descriptions of different versions
/// must not be compared.
pub const DESCRIPTION_VERSION: u32 = 1;

/// How a shape is described.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, rename_all = "kebab-case")]
pub struct DescribeOptions {
    /// How the mesh is repaired. Default: the largest component, cracks closed.
    pub repair: RepairOptions,
    /// Samples that distances are measured from, at least 8. Default: 100.
    pub samples: usize,
    /// Points of the form that are kept, at least 4. Default: 1000.
    pub points: usize,
    /// Whether size counts. Default: [`Normalization::UnitArea`], it does not.
    pub size: Normalization,
}

impl Default for DescribeOptions {
    fn default() -> Self {
        Self { repair: RepairOptions::default(), samples: 100, points: 1000, size: Normalization::UnitArea }
    }
}

impl DescribeOptions {
    /// All that decides a description, on one line that stays the same from version to version: what an index
    /// writes down to know whether a description can be compared with its own.
    #[must_use]
    pub fn text(&self) -> String {
        let Self { repair, samples, points, size } = self;
        let RepairOptions { components, weld, orient } = repair;
        let size = match size {
            Normalization::Raw => "counts",
            Normalization::UnitArea => "ignored",
        };
        format!(
            "description {DESCRIPTION_VERSION}; components {components:?}; weld {weld:?}; orient {orient:?}; \
             samples {samples}; points {points}; size {size}"
        )
        .to_lowercase()
    }

    /// # Errors
    /// [`PipelineError::BadDescription`] names the option, its value and the least it can be.
    pub fn validate(&self) -> Result<(), PipelineError> {
        for (option, value, least) in [("samples", self.samples, 8), ("points", self.points, 4)] {
            if value < least {
                return Err(PipelineError::BadDescription { option, value, least });
            }
        }
        Ok(())
    }
}

/// What is known of a shape once its mesh is put aside.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeDescription {
    /// The canonical form at evenly spread points, in mesh units, with the area of the surface.
    pub form: CanonicalForm,
    /// One signature of every kind, in the order of [`SignatureKind::ALL`], without size.
    pub signatures: Vec<Signature>,
    /// All of them as one vector, with the size when it counts: what an index scans.
    pub fused: Vec<f32>,
    /// Area of the surface, in squared mesh units.
    pub area: f64,
    /// The longest distance on the surface from one of the samples, in mesh units.
    pub diameter: f64,
    /// Everything that was repaired; it also knows the number of vertices and faces.
    pub repair: RepairReport,
}

impl ShapeDescription {
    /// [`prepare_form`] of the form.
    ///
    /// # Errors
    /// [`PipelineError::Descriptor`].
    pub fn prepare(&self) -> Result<PreparedForm, PipelineError> {
        prepare_form(&self.form)
    }

    /// The signature of one kind.
    #[must_use]
    pub fn signature(&self, kind: SignatureKind) -> Option<&Signature> {
        self.signatures.iter().find(|signature| signature.kind == kind)
    }
}

/// The form of a description, at unit area, made ready to be matched. Where size counts it does so as a number of
/// its own, see [`fuse`], so that a body and its likeness in another size still have forms that match.
///
/// # Errors
/// [`PipelineError::Descriptor`].
pub fn prepare_form(form: &CanonicalForm) -> Result<PreparedForm, PipelineError> {
    Ok(PreparedForm::new(&form.normalized(Normalization::UnitArea), MATCHED_POINTS)?)
}

/// Describes a mesh: repair, one Laplacian, distances from one set of samples, one embedding.
///
/// Runs on one thread but for the eigenvectors; the result does not depend on the number of threads.
///
/// # Errors
/// [`PipelineError::BadDescription`] and those of the stages: a mesh without area or without extent has no
/// description.
pub fn describe(mesh: &TriMesh, options: &DescribeOptions) -> Result<ShapeDescription, PipelineError> {
    describe_surface(&Surface::new(mesh, &options.repair)?, options)
}

/// Describes a surface that was read and repaired with the options' [`repair`](DescribeOptions::repair).
///
/// # Errors
/// As [`describe`].
pub fn describe_surface(
    surface: &Surface,
    options: &DescribeOptions,
) -> Result<ShapeDescription, PipelineError> {
    Ok(describe_with_form(surface, options)?.0)
}

/// The canonical form of all vertices of a surface, which a description has at some of them.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceForm {
    /// The form.
    pub form: CanonicalForm,
    /// How far every vertex is from the first sample along the surface, in mesh units.
    pub distances: Vec<f64>,
}

impl SurfaceForm {
    /// The form that [`describe_surface`] makes of a surface on the way, without the signatures.
    ///
    /// # Errors
    /// As [`describe`].
    pub fn new(surface: &Surface, options: &DescribeOptions) -> Result<Self, PipelineError> {
        options.validate()?;
        let (distances, form) = embedded(surface, options)?;
        Ok(Self { form, distances: distances.column(0).to_vec() })
    }
}

/// Distances from the samples, and the form of all vertices.
fn embedded(
    surface: &Surface,
    options: &DescribeOptions,
) -> Result<(LandmarkDistances, CanonicalForm), PipelineError> {
    let solver = Method::default().prepare(&surface.intrinsic)?;
    let distances = {
        let mut sampler = Sampling::default().start(solver.as_ref(), FirstSample::default(), 0)?;
        sampler.extend_to(options.samples)?;
        sampler.distances(options.samples)?
    };
    let embedding = nystrom(&distances, &NystromOptions::default())?;
    let form = CanonicalForm::new(&embedding, surface.mesh())?;
    Ok((distances, form))
}

/// Describes a surface and keeps the form of all its vertices, which descriptions have at some of them.
///
/// # Errors
/// As [`describe`].
pub fn describe_with_form(
    surface: &Surface,
    options: &DescribeOptions,
) -> Result<(ShapeDescription, SurfaceForm), PipelineError> {
    options.validate()?;
    let (distances, form) = embedded(surface, options)?;
    let reduced = form.reduced(options.points);
    let spectrum = LaplaceSpectrum::new(&surface.intrinsic, LaplaceSpectrum::DESCRIBING)?;
    let signatures = vec![
        moment_signature(&form),
        d2_histogram(&reduced),
        geodesic_spectrum(&distances, &spectrum.masses, spectrum.area)?,
        shape_dna(&spectrum),
        heat_kernel_signature(&spectrum),
        wave_kernel_signature(&spectrum),
    ];
    let area = match options.size {
        Normalization::Raw => Some(spectrum.area),
        Normalization::UnitArea => None,
    };
    let description = ShapeDescription {
        fused: fuse(&signatures, area),
        form: reduced,
        signatures,
        area: spectrum.area,
        diameter: distances.max(),
        repair: surface.repaired.report.clone(),
    };
    Ok((description, SurfaceForm { form, distances: distances.column(0).to_vec() }))
}

#[cfg(test)]
mod tests {
    use mesh::shapes;
    use nalgebra::{Point3, Rotation3};
    use surface::VertexId;

    use super::*;

    fn described(mesh: &TriMesh) -> ShapeDescription {
        describe(mesh, &DescribeOptions::default()).unwrap()
    }

    /// Largest distance of two signatures of a kind, in units of what poses change.
    fn gap(a: &ShapeDescription, b: &ShapeDescription) -> f64 {
        let parts = a.signatures.iter().zip(&b.signatures);
        parts.map(|(a, b)| a.distance(b) / a.kind.unit()).fold(0.0, f64::max)
    }

    fn fused_distance(a: &ShapeDescription, b: &ShapeDescription) -> f64 {
        let sq = |(x, y): (&f32, &f32)| f64::from(x - y).powi(2);
        a.fused.iter().zip(&b.fused).map(sq).sum::<f64>().sqrt()
    }

    /// A torus with a bump: no symmetry.
    fn lopsided() -> TriMesh {
        let mut mesh = shapes::torus(40, 20, 2.0, 0.7);
        for p in &mut mesh.positions {
            let bump = (-(*p - Point3::new(2.4, 0.5, 0.3)).norm_squared()).exp();
            p.coords *= 1.0 + 0.5 * bump + 0.1 * p.y;
        }
        mesh
    }

    #[test]
    fn motions_mirrors_scale_and_order_change_nothing() {
        let mesh = lopsided();
        let base = described(&mesh);
        let turn = Rotation3::from_euler_angles(0.3, 2.0, -1.0);
        let mut moved = mesh.clone();
        moved
            .positions
            .iter_mut()
            .for_each(|p| *p = turn * Point3::new(-p.x, p.y, p.z) * 7.0 + Point3::new(1.0, 2.0, 3.0).coords);
        let same = described(&moved);
        assert!(gap(&base, &same) < 1e-3, "{}", gap(&base, &same));
        assert!(
            (same.area / base.area / 49.0 - 1.0).abs() < 1e-9
                && (same.diameter / base.diameter / 7.0 - 1.0).abs() < 1e-9
        );
        let n = mesh.n_vertices();
        let renumbered = TriMesh {
            positions: (0..n).map(|i| mesh.positions[n - 1 - i]).collect(),
            faces: mesh.faces.iter().rev().map(|f| f.map(|v| VertexId::from(n - 1 - v.index()))).collect(),
        };
        // Another first sample: distances and the approximation differ a little.
        assert!(gap(&base, &described(&renumbered)) < 0.5, "{}", gap(&base, &described(&renumbered)));
        let other = described(&shapes::torus(40, 20, 2.0, 0.7));
        assert!(gap(&base, &other) > 3.0, "{}", gap(&base, &other));
    }

    #[test]
    fn the_fused_distance_is_the_weighted_sum_of_those_of_the_parts() {
        let (a, b) = (described(&lopsided()), described(&shapes::icosphere(3)));
        let total: f64 = SignatureKind::ALL.iter().map(|kind| kind.weight()).sum();
        assert!((total - 1.0).abs() < 1e-9);
        let part =
            |(a, b): (&Signature, &Signature)| a.kind.weight() * (a.distance(b) / a.kind.unit()).powi(2);
        let expected = a.signatures.iter().zip(&b.signatures).map(part).sum::<f64>().sqrt();
        assert!((fused_distance(&a, &b) / expected - 1.0).abs() < 1e-5);
        assert_eq!(a.fused.len(), descriptors::FUSED_SIZE);
        assert!(a.signatures.iter().all(|s| s.values.len() == s.kind.n_values()));
    }

    #[test]
    fn size_counts_when_asked_for() {
        let small = lopsided();
        let mut large = small.clone();
        large.positions.iter_mut().for_each(|p| p.coords *= 1.05);
        let options = DescribeOptions { size: Normalization::Raw, ..Default::default() };
        let [a, b] = [&small, &large].map(|mesh| describe(mesh, &options).unwrap());
        assert!((fused_distance(&a, &b) - 1.0).abs() < 1e-3, "5 % are a unit");
        assert!(fused_distance(&described(&small), &described(&large)) < 1e-3);
        let dna =
            |d: &ShapeDescription| d.signature(SignatureKind::ShapeDna).unwrap().clone().with_size(d.area);
        assert!((dna(&a).distance(&dna(&b)) / SignatureKind::ShapeDna.unit() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn small_flat_and_broken_meshes_are_described() {
        let mut fans = shapes::disjoint(&[shapes::grid(6, 6, 0.3), shapes::tetrahedron(0), shapes::cube(1)]);
        // An edge with three faces, a repeated face, a face turned over.
        let first = fans.faces[0];
        fans.positions.push(Point3::new(0.1, 0.1, 1.0));
        fans.faces.push([first[0], first[1], VertexId::from(fans.positions.len() - 1)]);
        fans.faces.push(first);
        fans.faces[3].swap(0, 1);
        for mesh in
            [shapes::tetrahedron(0), shapes::tetrahedron(1), shapes::grid(4, 4, 1.0), shapes::cube(1), fans]
        {
            let found = described(&mesh);
            assert!(found.fused.iter().all(|x| x.is_finite()), "{:?}", found.signatures);
            assert_eq!(found.fused.len(), descriptors::FUSED_SIZE);
            found.prepare().unwrap();
        }
    }

    #[test]
    fn the_form_of_all_vertices_is_that_of_the_description() {
        let (mesh, options) = (lopsided(), DescribeOptions::default());
        let surface = Surface::new(&mesh, &options.repair).unwrap();
        let (description, form) = describe_with_form(&surface, &options).unwrap();
        assert_eq!(description, describe(&mesh, &options).unwrap());
        assert_eq!(form, SurfaceForm::new(&surface, &options).unwrap());
        assert_eq!(form.form.points().len(), mesh.n_vertices());
        assert_eq!(form.form.reduced(options.points), description.form);
        assert!((form.distances.iter().copied().fold(0.0, f64::max) / description.diameter) > 0.5);
    }

    #[test]
    fn options_have_a_stable_text_and_are_checked() {
        let options = DescribeOptions::default();
        assert_eq!(
            options.text(),
            "description 1; components largest; weld seams; orient keep; samples 100; points 1000; size ignored"
        );
        for (options, name) in [
            (DescribeOptions { samples: 7, ..options.clone() }, "samples"),
            (DescribeOptions { points: 3, ..options }, "points"),
        ] {
            let fault = describe(&shapes::cube(1), &options).unwrap_err();
            assert!(matches!(fault, PipelineError::BadDescription { option, .. } if option == name));
        }
    }
}
