//! Surfaces and canonical forms for figures, and for the 3D views of the page (`figure4-shapes.json`).

use anyhow::{Result, bail};
use canonform::embed::{Embedded, FormOptions};
use descriptors::{CanonicalForm, Normalization};
use geodesics::DistanceSolver;
use linalg::Matrix;
use mesh::{TriMesh, orient_consistently};
use nalgebra::Point3;
use report::results::{Motions, Scale, ShownForm, ShownShape};
use report::viewer::Geometry;
use rigid::{PointSet, Reflections, Similarity, align_points};
use surface::VertexId;

use crate::coarse::coarse;
use crate::collection::LabeledSurface;

/// The greatest number of vertices of all shapes together, for a page of about 20 MB.
const ALL_VERTICES: usize = 200_000;

/// The greatest number of vertices of one shape.
const SHAPE_VERTICES: usize = 20_000;

/// A mesh with consistently oriented faces.
pub(crate) fn oriented(mesh: &TriMesh) -> TriMesh {
    let mut mesh = mesh.clone();
    orient_consistently(&mut mesh);
    mesh
}

/// A form over the faces of its shape, aligned with `first`; without a first one, it becomes the first.
pub(crate) fn aligned(
    form: &CanonicalForm,
    shape: &TriMesh,
    first: &mut Option<PointSet>,
) -> Result<TriMesh> {
    let mut surface = form.to_mesh(shape);
    let prepared = form.prepared()?;
    if let Some(target) = first {
        let motion = align_points(&prepared, target, Reflections::Allow).map;
        surface.positions.iter_mut().for_each(|p| *p = motion.apply(p));
    } else {
        *first = Some(prepared);
    }
    Ok(oriented(&surface))
}

/// The greatest number of vertices of each of `n_shapes`.
pub(crate) fn vertex_limit(n_shapes: usize) -> usize {
    (ALL_VERTICES / n_shapes.max(1)).clamp(100, SHAPE_VERTICES)
}

/// A canonical form, its samples, and the motion that turns it towards its shape.
pub(crate) struct Formed {
    pub(crate) form: CanonicalForm,
    /// Vertices of the repaired mesh.
    samples: Vec<VertexId>,
    turn: Similarity,
}

impl Formed {
    /// The form of an embedded shape.
    pub(crate) fn new(shape: &LabeledSurface, embedded: &Embedded) -> Result<Self> {
        let surface = &shape.surface;
        let form = embedded.form(surface)?;
        let to_repaired = |&input: &u32| surface.repaired_vertex(VertexId(input));
        let samples = embedded.report.samples.iter().map(to_repaired).collect::<Result<_, _>>()?;
        let turn = turned_like(form.points(), &surface.mesh().positions);
        Ok(Self { form, samples, turn })
    }

    /// The form at the vertices that are shown.
    fn shown(&self, vertices: &[usize], from_samples: &Matrix) -> ShownForm {
        let points = self.form.points();
        let single = |&v: &usize| self.turn.apply(&points[v]).coords.map(|c| c as f32).into();
        let off = |v: usize| {
            let sample = |(j, &s): (usize, &VertexId)| {
                let straight = (points[v] - points[s.index()]).norm();
                (straight - from_samples[(v, j)]).powi(2)
            };
            let sum: f64 = self.samples.iter().enumerate().map(sample).sum();
            (sum / self.samples.len() as f64).sqrt() as f32
        };
        ShownForm {
            positions: vertices.iter().map(single).collect(),
            size: self.form.spread() / self.form.normalized(Normalization::UnitArea).spread(),
            residual: self.form.area().map(|_| vertices.iter().map(|&v| off(v)).collect()),
        }
    }
}

/// The rotation or reflection about the origin that brings points closest to those of the shape.
fn turned_like(points: &[Point3<f64>], shape: &[Point3<f64>]) -> Similarity {
    let pairs: Vec<_> = points.iter().copied().zip(shape.iter().copied()).collect();
    let off =
        |motion: &Similarity| pairs.iter().map(|(p, q)| (motion.apply(p) - q).norm_squared()).sum::<f64>();
    let fits = [false, true].into_iter().filter_map(|reflected| Similarity::fit_motion(&pairs, reflected));
    let best = fits.min_by(|a, b| off(a).total_cmp(&off(b)));
    Similarity::about_origin(best.map_or_else(nalgebra::Matrix3::identity, |motion| motion.rotation))
}

/// A shape with its forms by several methods, at no more than `limit` vertices.
pub(crate) fn shown(
    shape: &LabeledSurface,
    forms: &[&Formed],
    options: &FormOptions,
    limit: usize,
) -> Result<ShownShape> {
    let mesh = oriented(shape.surface.mesh());
    let solver: Box<dyn DistanceSolver> = options.geodesic.prepare(shape.surface.intrinsic(), &())?;
    let Some(first) = forms.first() else { bail!("there is no canonical form") };
    let (vertices, thin) = coarse(&mesh, limit);
    let distances = solver.distance_columns(&first.samples[..1.min(first.samples.len())])?;
    let distance: Vec<f64> = vertices.iter().map(|&v| distances[(v, 0)]).collect();
    let form = |formed: &&Formed| {
        let from_samples = solver.distance_columns(&formed.samples)?;
        Ok::<_, anyhow::Error>(formed.shown(&vertices, &from_samples))
    };
    Ok(ShownShape {
        name: shape.name.clone(),
        label: shape.label.clone(),
        n_vertices: mesh.n_vertices(),
        surface: Geometry::new(&thin).with_values("distance (mesh units)", &distance),
        forms: forms.iter().map(form).collect::<Result<_>>()?,
    })
}

/// The motions between forms, for forms turned as they are shown.
pub(crate) fn motions(method: &str, scale: Scale, forms: &[Formed], alignments: &[Similarity]) -> Motions {
    let pairs = (0..forms.len()).flat_map(|i| (i + 1..forms.len()).map(move |j| (i, j)));
    let shown = pairs.zip(alignments).flat_map(|((i, j), alignment)| {
        let motion = forms[j].turn.after(&alignment.after(&forms[i].turn.inverse()));
        let row = |r: usize| std::array::from_fn(|c| motion.rotation[(r, c)] as f32);
        [row(0), row(1), row(2), motion.translation.map(|c| c as f32).into()]
    });
    Motions { method: method.to_owned(), scale, motions: shown.collect() }
}
