//! A shape without its mesh: form, signatures and facts, with the 32-bit numbers that an index stores.

use base::Observer;
use descriptors::{
    CanonicalForm, DescriptorError, DiscAreas, LaplaceSpectrum, Normalization, PreparedShape, SampledForm,
    ShapeMetric, Signature, SignatureKind, geodesic_spectrum, heat_kernel_signature, rigid_signature,
    shape_dna, wave_kernel_signature,
};
use index::{Entry, Facts, Shape};
use nalgebra::Point3;

use super::embed::embed;
use super::embedded::Embedded;
use super::options::{DescribeOptions, FormOptions};
use crate::error::Error;
use mesh::{Remap, Surface};
use surface::{VertexId, unit_for};

/// What a description needs at its peak: 200 MB for 43,000 vertices, by the resident memory of `index build`.
const BYTES_PER_VERTEX: usize = 5000;

/// Most vertices of a surface that is described, before it is [prepared](Surface::for_description); finer ones are
/// [simplified](Surface::simplified), so that cost grows slowly from there on. A built-in cat of 500,000 vertices is then 0.12
/// from one of 28,000 in the combined distance, where subdivision changes 0.14; other shapes are several units apart.
const MAX_VERTICES: usize = 30_000;

/// Describes a surface: one embedding, one Laplacian, all signatures. Nothing is known of its components.
///
/// ```
/// use canonform::{DescribeOptions, Surface, describe, mesh::shapes};
///
/// let surface = Surface::new(&shapes::torus(24, 12, 2.0, 0.7), &Default::default(), &())?;
/// let shape = describe(&surface, &DescribeOptions::default(), &())?;
/// assert_eq!(shape.signatures.len(), 5);
/// assert!(shape.entry.facts.diameter > 6.0 && shape.entry.facts.area > 50.0);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// A surface that was repaired in another way than the options say keeps its repair.
///
/// # Errors
/// [`Error::Refused`], [`Error::Exceeded`] and those of the stages: a mesh without area or without extent has no
/// description.
pub fn describe(
    surface: &Surface,
    options: &DescribeOptions,
    observer: &dyn Observer,
) -> Result<Shape, Error> {
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
    /// From the vertices of the surface to those of the prepared one. They are the first ones unless it was simplified.
    remap: Remap,
}

impl MeasuredSurface {
    /// Prepares and embeds a surface, within the time and the memory of the observer's budget.
    ///
    /// # Errors
    /// [`Error::Exceeded`] and those of [`embed`].
    pub fn new(surface: &Surface, options: &FormOptions, observer: &dyn Observer) -> Result<Self, Error> {
        Self::simplified(surface, MAX_VERTICES, options, observer)
    }

    fn simplified(
        surface: &Surface,
        most_vertices: usize,
        options: &FormOptions,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        let (prepared, remap) = match surface.simplified(most_vertices, observer)? {
            Some((simple, remap)) => (simple.for_description(observer)?, remap),
            None => {
                let kept = Remap::extended(surface.mesh().n_vertices(), Vec::new());
                (surface.for_description(observer)?, kept)
            }
        };
        let needed = prepared.mesh().n_vertices().saturating_mul(BYTES_PER_VERTEX);
        observer.budget().check_memory(needed)?;
        let embedded = embed(&prepared, options, observer)?;
        Ok(Self { prepared, embedded, remap })
    }

    /// How the surface was embedded.
    pub fn options(&self) -> &FormOptions {
        &self.embedded.options
    }

    /// The form of the vertices of `surface`, from which this one was made.
    ///
    /// # Errors
    /// [`Error::Descriptor`] unless the form has three dimensions.
    pub fn form_of(&self, surface: &Surface) -> Result<CanonicalForm, Error> {
        let vertices: Vec<VertexId> = self.remap.all_to_new().flatten().collect();
        Ok(self.embedded.form(&self.prepared)?.at(&vertices, surface.mesh().vertex_areas())?)
    }

    /// Distances of the vertices of the repaired mesh from the first sample, in mesh units.
    ///
    /// # Errors
    /// [`Error::Linalg`] if distances are in a file that cannot be read.
    pub fn distances_from_first(&self) -> Result<Vec<f64>, Error> {
        let all = self.embedded.distances.column(0)?;
        Ok(self.remap.all_to_new().flatten().map(|v| all[v.index()]).collect())
    }

    /// The description. The form options are those of the embedding; `options` says how many points are kept and whether size
    /// counts.
    ///
    /// # Errors
    /// As [`describe`].
    pub fn describe(&self, options: &DescribeOptions, observer: &dyn Observer) -> Result<Shape, Error> {
        let Self { prepared, embedded, .. } = self;
        let (mut shape, spectrum) = self.metric_part(options, observer)?;
        let form = SampledForm::by_least_squares(&embedded.distances, &spectrum.masses, observer)?;
        shape.signatures.extend([stored(form.spectrum(spectrum.area.sqrt())?)]);
        shape.disc_areas = DiscAreas::new(&embedded.distances, &prepared.mesh().vertex_areas())?.to_numbers();
        Ok(shape)
    }

    /// The shape, ready to be compared: as that of the [description](Self::describe), without what only searches ask for.
    ///
    /// # Errors
    /// As [`describe`].
    pub fn prepare(
        &self,
        options: &DescribeOptions,
        observer: &dyn Observer,
    ) -> Result<PreparedShape, Error> {
        options.prepare(&self.metric_part(options, observer)?.0)
    }

    /// What the metric needs of a description, and the spectrum of the surface.
    fn metric_part(
        &self,
        options: &DescribeOptions,
        observer: &dyn Observer,
    ) -> Result<(Shape, LaplaceSpectrum), Error> {
        let Self { prepared, embedded, .. } = self;
        let options = DescribeOptions { form: embedded.options.clone(), ..*options };
        options.validate()?;
        if self.remap.all_to_new().count() < 4 {
            return Err(DescriptorError::OneTriangle.into());
        }
        let spectrum = LaplaceSpectrum::describing(prepared.intrinsic(), observer)?;
        observer.budget().check()?;
        let mut signatures = vec![
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
        let report = &prepared.input.report;
        let facts = Facts {
            vertices: report.input_vertices as u64,
            faces: report.input_faces as u64,
            area: spectrum.area,
            diameter: embedded.distances.max(),
            dropped_area_share: report.dropped_area_share,
            components: report.components as u64,
            shortcuts: prepared.shortcuts().len() as u64,
            longest_boundary: prepared.longest_boundary(),
        };
        let form = embedded.form(prepared)?.reduced(options.points);
        let unit = options.form_unit(facts.area);
        let points = form.points().iter().map(|p| p / unit).zip(form.weights());
        let shape = Shape {
            entry: Entry { facts, ..Entry::default() },
            fused,
            signatures: signatures.into_iter().map(stored).collect(),
            form: points.map(|(p, w)| [p.x, p.y, p.z, *w].map(|x| x as f32)).collect(),
            ..Shape::default()
        };
        Ok((shape, spectrum))
    }
}

/// A signature as an index stores it.
fn stored(Signature { kind, values }: Signature) -> (String, Vec<f32>) {
    (kind.name().to_owned(), values.into_iter().map(|value| value as f32).collect())
}

impl DescribeOptions {
    /// A shape that was described with these options, ready to be compared.
    ///
    /// # Errors
    /// [`Error::Descriptor`] if its form or its fused vector is none.
    pub fn prepare(&self, shape: &Shape) -> Result<PreparedShape, Error> {
        let rigid = shape.signatures.get(SignatureKind::Rigid.name()).cloned().unwrap_or_default();
        let area = Some(shape.entry.facts.area);
        Ok(PreparedShape::new(shape.fused.clone(), rigid, &self.form_of(shape)?, area)?)
    }

    /// The canonical form of a shape that was described with these options, in mesh units.
    ///
    /// # Errors
    /// [`Error::Descriptor`] if it is none.
    pub fn form_of(&self, shape: &Shape) -> Result<CanonicalForm, Error> {
        let area = shape.entry.facts.area;
        let unit = self.form_unit(area);
        let points = shape.form.iter().map(|[x, y, z, _]| Point3::new(*x, *y, *z).cast() * unit);
        let weights = shape.form.iter().map(|[.., w]| f64::from(*w)).collect();
        let form_area = self.form.method.has_unit().then_some(area);
        Ok(CanonicalForm::from_parts(points.collect(), weights, form_area)?)
    }

    /// The unit of the points of a form, in mesh units: 1 unless 32-bit numbers could not hold them.
    fn form_unit(&self, area: f64) -> f64 {
        if self.form.method.has_unit() { unit_for(area.sqrt()) } else { 1.0 }
    }
}

/// The signature of one kind, if a shape has it.
pub fn signature(shape: &Shape, kind: SignatureKind) -> Option<Signature> {
    let values = shape.signatures.get(kind.name())?;
    Some(Signature { kind, values: values.iter().map(|value| f64::from(*value)).collect() })
}

#[cfg(test)]
mod tests {
    use geodesics::Method;
    use mesh::{RepairOptions, TriMesh, shapes};

    use descriptors::ShapePair;

    use super::*;
    use crate::form::{EmbedMethod, FormOptions, Samples};
    use mesh::shapes::lopsided_torus;

    fn described_by(mesh: &TriMesh, options: &DescribeOptions) -> Shape {
        describe(&Surface::new(mesh, &options.form.repair, &()).unwrap(), options, &()).unwrap()
    }

    fn described(mesh: &TriMesh) -> Shape {
        described_by(mesh, &DescribeOptions::default())
    }

    #[test]
    fn a_single_triangle_has_no_description() {
        let fault = |mesh: &TriMesh| {
            let surface = Surface::new(mesh, &Default::default(), &()).unwrap();
            describe(&surface, &DescribeOptions::default(), &()).err().map(|fault| fault.to_string())
        };
        let square = mesh::shapes::grid(2, 2, 1.0);
        let triangle = TriMesh { faces: square.faces[..1].to_vec(), ..square.clone() };
        assert!(fault(&triangle).unwrap().contains("a single triangle"));
        assert_eq!(fault(&square), None);
    }

    #[test]
    fn holes_are_closed_and_welds_cut_but_counted() {
        let whole = described(&lopsided_torus());
        let mut pierced = lopsided_torus();
        pierced.faces.retain(|face| !face.contains(&VertexId(100)));
        let mut welded = lopsided_torus();
        welded.faces.iter_mut().flatten().filter(|v| v.0 == 400).for_each(|v| *v = VertexId(5));
        // The spectrum of the form depends on which of its points are taken, the others change less.
        for (mesh, shortcuts, most) in [(&pierced, 0, 0.6), (&welded, 1, 0.5)] {
            let found = described(mesh);
            assert!(gap(&whole, &found) < most, "{}", gap(&whole, &found));
            assert_eq!(found.entry.facts.shortcuts, shortcuts);
        }
        let boundary = |shape: &Shape| shape.entry.facts.longest_boundary;
        assert!(boundary(&whole) == 0.0 && boundary(&described(&pierced)) > 0.5);
    }

    /// Largest distance between two signatures of one kind, in units of the change by poses.
    fn gap(a: &Shape, b: &Shape) -> f64 {
        SignatureKind::INTRINSIC.into_iter().map(|kind| change(kind, a, b)).fold(0.0, f64::max)
    }

    /// The distance between two signatures of one kind, in its unit.
    fn change(kind: SignatureKind, a: &Shape, b: &Shape) -> f64 {
        let [a, b] = [a, b].map(|shape| signature(shape, kind).unwrap());
        a.distance(&b) / ShapeMetric::unit(kind)
    }

    fn fused_distance(a: &Shape, b: &Shape) -> f64 {
        ShapeMetric::fused(&a.fused, &b.fused)
    }

    #[test]
    #[ignore = "slow: make test-all"]
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
    fn the_fused_distance_is_the_weighted_sum_of_the_parts() {
        let (a, b) = (described(&lopsided_torus()), described(&shapes::icosphere(3)));
        let part = |kind| ShapeMetric::weight(kind) * change(kind, &a, &b).powi(2);
        let expected = SignatureKind::INTRINSIC.into_iter().map(part).sum::<f64>().sqrt();
        assert!((fused_distance(&a, &b) / expected - 1.0).abs() < 1e-5);
        assert_eq!(a.fused.len(), ShapeMetric::FUSED_LENGTH);
        assert!(
            SignatureKind::INTRINSIC.iter().all(|kind| a.signatures[kind.name()].len() == kind.n_values())
        );
    }

    #[test]
    fn size_counts_if_chosen() {
        let small = lopsided_torus();
        let large = testkit::moved(&small, |p| p * 1.05);
        let options = DescribeOptions { size: Normalization::Raw, ..Default::default() };
        let [a, b] = [&small, &large].map(|mesh| described_by(mesh, &options));
        assert!((fused_distance(&a, &b) - 1.0).abs() < 1e-3, "5 % are a unit");
        assert!(fused_distance(&described(&small), &described(&large)) < 1e-3);
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
            DescribeOptions::default().prepare(&found).unwrap();
        }
    }

    #[test]
    fn rounding_changes_no_description_of_a_flat_surface() {
        let prepared = |mesh: &TriMesh| DescribeOptions::default().prepare(&described(mesh)).unwrap();
        let mat = testkit::moved(&shapes::grid(41, 41, 1.0), |p| {
            Point3::new(p.x, p.y, 0.3 * (2.5 * p.x).sin() * (2.5 * p.y).sin())
        });
        for mesh in [shapes::grid(21, 11, 0.5), shapes::cylinder(8, 40, 0.005, 10.0), mat] {
            // Elsewhere, as a file of 32 bits has it.
            let turn = nalgebra::Rotation3::from_euler_angles(2.0, 1.0, -0.7);
            let place = |p: &Point3<f64>| turn * p * 25.4 + nalgebra::Vector3::new(90.0, -140.0, 33.0);
            let rounded = testkit::moved(&mesh, |p| place(p).map(|x| f64::from(x as f32)));
            let distance = ShapePair::new([&prepared(&mesh), &prepared(&rounded)]).distance().combined;
            assert!(distance < 0.3, "{distance}");
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
        assert!(distance < 0.25, "{distance}");
        assert_eq!(whole.entry.facts.vertices, simple.entry.facts.vertices);
        let [form, other] = [of_whole, of_simple].map(|measured| measured.form_of(&surface).unwrap());
        assert!(form.points().len() == n && other.points().len() == n);
        let ratio = other.spread() / form.spread();
        assert!((ratio - 1.0).abs() < 0.03, "{ratio}");
        let [all, some] = [of_whole, of_simple].map(|measured| measured.distances_from_first().unwrap());
        assert!(all.len() == n && some.len() == n);
    }

    #[test]
    fn every_method_is_described_from_the_same_samples_and_the_form_is_a_part_of_the_embedded_one() {
        let surface = Surface::new(&shapes::torus(18, 11, 2.0, 0.7), &Default::default(), &()).unwrap();
        let mut samples = Vec::new();
        for method in EmbedMethod::all() {
            // Its distances do not depend on the direction.
            let geodesic = Method::Dijkstra;
            let form =
                FormOptions { method, geodesic, samples: Samples::Count(60), ..FormOptions::default() };
            let options = DescribeOptions { form, ..DescribeOptions::default() };
            let measured = MeasuredSurface::new(&surface, &options.form, &()).unwrap();
            let description = measured.describe(&options, &()).unwrap();
            let MeasuredSurface { prepared, embedded, .. } = measured;
            let reduced = embedded.form(&prepared).unwrap().reduced(options.points);
            let rounded = reduced.points().iter().map(|p| [p.x, p.y, p.z].map(|x| x as f32));
            assert!(rounded.eq(description.form.iter().map(|[x, y, z, _]| [*x, *y, *z])));
            assert!(description.fused.iter().all(|x| x.is_finite()));
            samples.push(embedded.distances.landmarks().to_vec());
        }
        assert!(samples.iter().all(|found| *found == samples[0] && found.len() == 60));
    }
}
