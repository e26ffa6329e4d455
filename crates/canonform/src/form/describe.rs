//! A shape without its mesh: form, signatures and facts.

use base::Observer;
use descriptors::{
    CanonicalForm, DescriptorError, DiscAreas, LaplaceSpectrum, Normalization, PreparedShape, SampledForm,
    ShapeMetric, Signature, SignatureKind, geodesic_spectrum, heat_kernel_signature, rigid_signature,
    shape_dna, wave_kernel_signature,
};
use mesh::{RepairReport, Shortcut};

use super::embed::{Embedded, embed};
use super::options::{DescribeOptions, FormOptions};
use crate::error::Error;
use mesh::Surface;
use surface::VertexId;

/// What a description needs at its peak: 200 MB for 43,000 vertices, by the resident memory of `index build`.
const BYTES_PER_VERTEX: usize = 5000;

/// Most vertices of a surface that is described, before it is [prepared](Surface::for_description); finer ones are
/// [simplified](Surface::simplified), so that cost grows slowly from there on. A built-in cat of 500,000 vertices is then 0.12
/// from one of 28,000 in the combined distance, where subdivision changes 0.14; other shapes are several units apart.
const MOST_VERTICES: usize = 30_000;

/// Everything that an index keeps of a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeDescription {
    /// How it was made.
    pub options: DescribeOptions,
    /// The canonical form at evenly spread points, in mesh units, with the area of the surface.
    pub form: CanonicalForm,
    /// Signatures in the order of [`SignatureKind::ALL`], without size: one of every kind, but a rigid one only if the surface does
    /// not bend.
    pub signatures: Vec<Signature>,
    /// The areas of geodesic discs, which parts of the shape are compared with.
    pub disc_areas: DiscAreas,
    /// All signatures that bending does not change as one vector, with the size if it counts. An index searches by it.
    pub fused: Vec<f32>,
    /// Area of the surface, in squared mesh units.
    pub area: f64,
    /// The largest distance on the surface from one of the samples, in mesh units.
    pub diameter: f64,
    /// Length of the longest boundary before holes were closed, in mesh units; 0 for a closed surface.
    pub longest_boundary: f64,
    /// Shortcuts of the surface, where parts that touch were welded; it is described without them.
    pub shortcuts: Vec<Shortcut>,
    /// What was repaired, with the numbers of vertices and faces.
    pub repair: RepairReport,
}

/// Describes a surface: one embedding, one Laplacian, all signatures.
///
/// ```
/// use canonform::{DescribeOptions, Surface, describe, mesh::shapes};
///
/// let surface = Surface::new(&shapes::torus(24, 12, 2.0, 0.7), &Default::default(), &())?;
/// let description = describe(&surface, &DescribeOptions::default(), &())?;
/// assert_eq!(description.signatures.len(), 5);
/// assert!(description.diameter > 6.0 && description.area > 50.0);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// A surface that was repaired in another way than the options say keeps its repair, and the
/// [options of the result](ShapeDescription::options) tell.
///
/// # Errors
/// [`Error::BadDescription`], [`Error::Exceeded`] and those of the stages: a mesh without area or without extent has no
/// description.
pub fn describe(
    surface: &Surface,
    options: &DescribeOptions,
    observer: &dyn Observer,
) -> Result<ShapeDescription, Error> {
    options.validate()?;
    MeasuredSurface::new(surface, &options.form, observer)?.describe(options, observer)
}

/// A surface on the road to its description: [simplified](Surface::simplified) to 30,000 vertices if it has more,
/// [prepared](Surface::for_description) and embedded. Every description and every form that is compared is made from one.
#[derive(Debug)]
pub struct MeasuredSurface {
    /// The prepared surface.
    prepared: Surface,
    embedded: Embedded,
    /// For each vertex of the repaired mesh, one of the prepared surface. They are the first ones unless it was simplified.
    vertices: Vec<VertexId>,
}

impl MeasuredSurface {
    /// Prepares and embeds a surface, within the time and the memory of the observer's budget.
    ///
    /// # Errors
    /// [`Error::Exceeded`] and those of [`embed`].
    pub fn new(surface: &Surface, options: &FormOptions, observer: &dyn Observer) -> Result<Self, Error> {
        Self::simplified(surface, MOST_VERTICES, options, observer)
    }

    fn simplified(
        surface: &Surface,
        most_vertices: usize,
        options: &FormOptions,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        let simplified = surface.simplified(most_vertices, observer)?;
        let (prepared, vertices) = match simplified {
            Some((simple, vertices)) => (simple.for_description(observer)?, vertices),
            None => {
                let vertices = (0..surface.mesh().n_vertices()).map(VertexId::from);
                (surface.for_description(observer)?, vertices.collect())
            }
        };
        let needed = prepared.mesh().n_vertices().saturating_mul(BYTES_PER_VERTEX);
        observer.budget().check_memory(needed)?;
        let embedded = embed(&prepared, options, observer)?;
        Ok(Self { prepared, embedded, vertices })
    }

    /// How the surface was embedded.
    #[must_use]
    pub fn options(&self) -> &FormOptions {
        &self.embedded.options
    }

    /// The form of the vertices of `surface`, from which this one was made.
    ///
    /// # Errors
    /// [`Error::Descriptor`] unless the form has three dimensions.
    pub fn form_of(&self, surface: &Surface) -> Result<CanonicalForm, Error> {
        Ok(self.embedded.form(&self.prepared)?.at(&self.vertices, surface.mesh().vertex_areas())?)
    }

    /// Distances of the vertices of the repaired mesh from the first sample, in mesh units.
    ///
    /// # Errors
    /// [`Error::Linalg`] if distances are in a file that cannot be read.
    pub fn distances_from_first(&self) -> Result<Vec<f64>, Error> {
        let all = self.embedded.distances.column(0)?;
        Ok(self.vertices.iter().map(|v| all[v.index()]).collect())
    }

    /// The description. The form options are those of the embedding; `options` says how many points are kept and whether size
    /// counts.
    ///
    /// # Errors
    /// As [`describe`].
    pub fn describe(
        &self,
        options: &DescribeOptions,
        observer: &dyn Observer,
    ) -> Result<ShapeDescription, Error> {
        let Self { prepared, embedded, .. } = self;
        let options = DescribeOptions { form: embedded.options.clone(), ..*options };
        options.validate()?;
        let form = embedded.form(prepared)?;
        let reduced = form.reduced(options.points);
        let spectrum = LaplaceSpectrum::describing(prepared.intrinsic(), observer)?;
        observer.budget().check()?;
        let mut signatures = vec![
            SampledForm::by_least_squares(&embedded.distances, &spectrum.masses, observer)?
                .spectrum(spectrum.area.sqrt())?,
            geodesic_spectrum(&embedded.distances, &spectrum.masses, spectrum.area)?,
            shape_dna(&spectrum),
            heat_kernel_signature(&spectrum),
            wave_kernel_signature(&spectrum),
        ];
        signatures.extend(rigid_signature(prepared.mesh()));
        let area = match options.size {
            Normalization::Raw => Some(spectrum.area),
            Normalization::UnitArea => None,
        };
        let fused = ShapeMetric::fuse(&signatures, area);
        if fused.iter().any(|value| !value.is_finite()) {
            return Err(DescriptorError::NotFinite.into());
        }
        Ok(ShapeDescription {
            fused,
            options,
            form: reduced,
            disc_areas: DiscAreas::new(&embedded.distances, &prepared.mesh().vertex_areas())?,
            signatures,
            area: spectrum.area,
            diameter: embedded.distances.max(),
            longest_boundary: prepared.longest_boundary(),
            shortcuts: prepared.shortcuts().to_vec(),
            repair: prepared.repaired.report.clone(),
        })
    }
}

impl ShapeDescription {
    /// The shape, ready to be compared; exactly as an index would store it.
    ///
    /// # Errors
    /// [`Error::Descriptor`].
    pub fn prepare(&self) -> Result<PreparedShape, Error> {
        let shape = PreparedShape::new(self.fused.clone(), &self.form, Some(self.area))?;
        Ok(shape.with_rigid(self.rounded(SignatureKind::Rigid)))
    }

    /// The values of a signature, with the precision of an index; none if there is no such signature.
    pub(crate) fn rounded(&self, kind: SignatureKind) -> Vec<f32> {
        let values = self.signature(kind).into_iter().flat_map(|signature| &signature.values);
        values.map(|value| *value as f32).collect()
    }

    /// The signature of one kind.
    pub fn signature(&self, kind: SignatureKind) -> Option<&Signature> {
        self.signatures.iter().find(|signature| signature.kind == kind)
    }
}

#[cfg(test)]
mod tests {
    use base::Budget;
    use geodesics::Method;
    use mesh::{RepairOptions, TriMesh, Weld, shapes};
    use nalgebra::Point3;

    use super::*;
    use crate::form::{EmbedMethod, FormOptions, Samples};
    use mesh::shapes::lopsided_torus;

    fn described_by(mesh: &TriMesh, options: &DescribeOptions) -> ShapeDescription {
        describe(&Surface::new(mesh, &options.form.repair, &()).unwrap(), options, &()).unwrap()
    }

    fn described(mesh: &TriMesh) -> ShapeDescription {
        described_by(mesh, &DescribeOptions::default())
    }

    #[test]
    fn a_description_beyond_the_memory_of_its_budget_is_an_error() {
        let surface = Surface::new(&lopsided_torus(), &Default::default(), &()).unwrap();
        let within =
            |bytes| describe(&surface, &DescribeOptions::default(), &Budget::unlimited().with_memory(bytes));
        assert!(matches!(within(1_000_000), Err(Error::Exceeded(_))));
        assert!(within(100_000_000).is_ok());
    }

    #[test]
    fn holes_are_closed_and_still_counted_as_boundaries() {
        let mut pierced = lopsided_torus();
        pierced.faces.retain(|face| !face.contains(&VertexId(100)));
        let (whole, pierced) = (described(&lopsided_torus()), described(&pierced));
        // The spectrum of the form depends on which of its points are taken, the others change less.
        assert!(gap(&whole, &pierced) < 0.4, "{}", gap(&whole, &pierced));
        assert_eq!(whole.longest_boundary, 0.0);
        assert!(pierced.longest_boundary > 0.5);
    }

    #[test]
    fn a_weld_of_two_distant_points_is_cut() {
        let mut welded = lopsided_torus();
        welded.faces.iter_mut().flatten().filter(|v| v.0 == 400).for_each(|v| *v = VertexId(5));
        let (whole, welded) = (described(&lopsided_torus()), described(&welded));
        assert!(gap(&whole, &welded) < 0.5, "{}", gap(&whole, &welded));
        assert!(whole.shortcuts.is_empty());
        let [shortcut] = welded.shortcuts[..] else { panic!("{:?}", welded.shortcuts) };
        assert!(shortcut.vertex == VertexId(5) && shortcut.detour > 3.0, "{shortcut:?}");
    }

    /// Largest distance between two signatures of one kind, in units of the change by poses.
    fn gap(a: &ShapeDescription, b: &ShapeDescription) -> f64 {
        let parts = a.signatures.iter().zip(&b.signatures);
        parts.map(|(a, b)| a.distance(b) / ShapeMetric::unit(a.kind)).fold(0.0, f64::max)
    }

    fn fused_distance(a: &ShapeDescription, b: &ShapeDescription) -> f64 {
        ShapeMetric::fused(&a.fused, &b.fused)
    }

    #[test]
    fn descriptions_are_finite_or_an_error() {
        for far in [1e3, 1e50, 8.9e124, 1e150] {
            let mut mesh = shapes::grid(5, 4, 0.1);
            mesh.positions[8].z = 1.0;
            mesh.positions[18].y = far;
            let surface = Surface::new(&mesh, &RepairOptions::default(), &()).unwrap();
            match describe(&surface, &DescribeOptions::default(), &()) {
                Ok(found) => assert!(found.fused.iter().all(|value| value.is_finite()), "{far:e}"),
                Err(fault) => assert!(matches!(fault, Error::Descriptor(_)), "{far:e}: {fault}"),
            }
        }
    }

    #[test]
    fn vertex_order_changes_little() {
        let mesh = lopsided_torus();
        let base = described(&mesh);
        let n = mesh.n_vertices();
        let renumbered = TriMesh {
            positions: (0..n).map(|i| mesh.positions[n - 1 - i]).collect(),
            faces: mesh.faces.iter().rev().map(|f| f.map(|v| VertexId::from(n - 1 - v.index()))).collect(),
        };
        // Another first sample changes distances and approximation slightly.
        assert!(gap(&base, &described(&renumbered)) < 0.5, "{}", gap(&base, &described(&renumbered)));
        let other = described(&shapes::torus(40, 20, 2.0, 0.7));
        assert!(gap(&base, &other) > 3.0, "{}", gap(&base, &other));
    }

    #[test]
    fn the_fused_distance_is_the_weighted_sum_of_the_parts() {
        let (a, b) = (described(&lopsided_torus()), described(&shapes::icosphere(3)));
        let part = |(a, b): (&Signature, &Signature)| {
            ShapeMetric::weight(a.kind) * (a.distance(b) / ShapeMetric::unit(a.kind)).powi(2)
        };
        let expected = a.signatures.iter().zip(&b.signatures).map(part).sum::<f64>().sqrt();
        assert!((fused_distance(&a, &b) / expected - 1.0).abs() < 1e-5);
        assert_eq!(a.fused.len(), ShapeMetric::FUSED_LENGTH);
        assert!(a.signatures.iter().all(|s| s.values.len() == s.kind.n_values()));
    }

    #[test]
    fn size_counts_if_chosen() {
        let small = lopsided_torus();
        let mut large = small.clone();
        large.positions.iter_mut().for_each(|p| p.coords *= 1.05);
        let options = DescribeOptions { size: Normalization::Raw, ..Default::default() };
        let [a, b] = [&small, &large].map(|mesh| described_by(mesh, &options));
        assert!((fused_distance(&a, &b) - 1.0).abs() < 1e-3, "5 % are a unit");
        assert!(fused_distance(&described(&small), &described(&large)) < 1e-3);
        let dna = |d: &ShapeDescription| {
            ShapeMetric::with_size(d.signature(SignatureKind::ShapeDna).unwrap().clone(), d.area)
        };
        assert!((dna(&a).distance(&dna(&b)) / ShapeMetric::unit(SignatureKind::ShapeDna) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn small_flat_and_broken_meshes_are_described() {
        let mut fans = shapes::disjoint(&[shapes::grid(6, 6, 0.3), shapes::tetrahedron(0), shapes::cube(1)]);
        // An edge with three faces, a duplicate face, a reversed face.
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
            assert_eq!(found.fused.len(), ShapeMetric::FUSED_LENGTH);
            found.prepare().unwrap();
        }
    }

    #[test]
    fn a_simplified_surface_has_nearly_the_same_signatures_and_a_form_of_all_vertices() {
        let mesh = (0..2).fold(lopsided_torus(), |mesh, _| shapes::subdivide(&mesh));
        let surface = Surface::new(&mesh, &Default::default(), &()).unwrap();
        let n = mesh.n_vertices();
        let options = DescribeOptions::default();
        let measured = [n, n / 4].map(|most| {
            let measured = MeasuredSurface::simplified(&surface, most, &options.form, &()).unwrap();
            (measured.describe(&options, &()).unwrap(), measured)
        });
        let [(whole, of_whole), (simple, of_simple)] = &measured;
        assert!(of_simple.prepared.mesh().n_vertices() < n / 3 && of_whole.prepared.mesh().n_vertices() >= n);
        let distance = fused_distance(whole, simple);
        println!("{n} vertices, simplified to a quarter: {distance:.4}");
        assert!(distance < 0.25, "{distance}");
        assert_eq!(whole.repair, simple.repair);
        let [form, other] = [of_whole, of_simple].map(|measured| measured.form_of(&surface).unwrap());
        assert!(form.points().len() == n && other.points().len() == n);
        let ratio = other.spread() / form.spread();
        assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
        let [all, some] = [of_whole, of_simple].map(|measured| measured.distances_from_first().unwrap());
        assert!(all.len() == n && some.len() == n);
    }

    #[test]
    fn every_method_is_described_and_the_form_is_a_part_of_the_embedded_one() {
        let mesh = lopsided_torus();
        let surface = Surface::new(&mesh, &Default::default(), &()).unwrap();
        for method in EmbedMethod::all() {
            let form = FormOptions { method, samples: Samples::Count(60), ..FormOptions::default() };
            let options = DescribeOptions { form, ..DescribeOptions::default() };
            let description = describe(&surface, &options, &()).unwrap();
            let MeasuredSurface { prepared, embedded, .. } =
                MeasuredSurface::new(&surface, &options.form, &()).unwrap();
            let whole = embedded.form(&prepared).unwrap();
            assert_eq!(whole.reduced(options.points), description.form);
            assert_eq!(description.form.area().is_some(), options.form.method.has_unit());
            assert_eq!(embedded.distances.n_landmarks(), 60, "{}", options.form.method.name());
            assert!(description.fused.iter().all(|x| x.is_finite()));
        }
    }

    #[test]
    fn classical_scaling_and_nmds_measure_the_same_samples() {
        let surface = Surface::new(&lopsided_torus(), &Default::default(), &()).unwrap();
        let samples = |method| {
            // Its distances do not depend on the direction.
            let geodesic = Method::Dijkstra;
            let samples = Samples::Count(20);
            let options = FormOptions { method, geodesic, samples, ..FormOptions::default() };
            embed(&surface, &options, &()).unwrap().distances.landmarks().to_vec()
        };
        assert_eq!(samples(EmbedMethod::Classical), samples(EmbedMethod::default()));
    }

    #[test]
    fn the_repair_of_the_surface_is_part_of_the_options() {
        let repair = RepairOptions { weld: Weld::All, ..RepairOptions::default() };
        let surface = Surface::new(&lopsided_torus(), &repair, &()).unwrap();
        let description = describe(&surface, &DescribeOptions::default(), &()).unwrap();
        assert_eq!(description.options.form.repair, repair);
    }
}
