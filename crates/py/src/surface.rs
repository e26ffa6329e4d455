//! Surfaces: distances, paths, samples, forms and signatures.

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use base::{Budget, Cache};
use canonform::collection::content_hash;
use canonform::compare::ComparedMesh;
use canonform::embed::{EmbedOptions, FormOptions, embed};
use canonform::geodesics::{
    DistanceSolver, FirstSample, Method, PathTracer, Sampling, Source, SurfacePath, distance_rows,
};
use canonform::library::Measure;
use canonform::maps::{CorrespondOptions, MappedSurface};
use canonform::mesh::io::{MemoryFile, MeshFile, ReadLimits};
use canonform::mesh::{InputPoint, RepairOptions, TriMesh};
use canonform::rigid::TriangleTree;
use canonform::surface::VertexId;
use canonform::{ContentHash, DescribeOptions, Error, Observer, Shape};
use numpy::{IntoPyArray, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{Rows, Vector, faces, mesh_of, positions};
use crate::error::{Exception, raised};
use crate::form::Form;
use crate::points::{point_of, points_of};
use crate::record::json;
use crate::run::{Stopped, memory_limit, run, run_within};
use crate::settings::{Settings, measure};

/// Most prepared solvers, descriptions and sides of comparisons that a surface keeps of each kind.
const MOST_KEPT: usize = 4;

pub(crate) type Compared = ComparedMesh<Arc<canonform::Surface>>;
pub(crate) type Matched = MappedSurface<Arc<canonform::Surface>>;

/// A repaired triangle mesh, with everything that was prepared on it.
#[pyclass(frozen, module = "canonform._canonform")]
pub(crate) struct Surface {
    /// The input.
    pub(crate) mesh: TriMesh,
    pub(crate) inner: Arc<canonform::Surface>,
    /// The hash of the file that it was read from.
    pub(crate) content: Option<ContentHash>,
    /// Whether the repair left all vertices as they are, so that no values need to be reordered.
    unchanged: bool,
    /// Who cancels the budget that a solver was prepared with has to prepare another.
    solvers: Cache<Method, Arc<dyn DistanceSolver>>,
    descriptions: Cache<DescribeOptions, Arc<Shape>>,
    compared: Cache<FormOptions, Arc<Compared>>,
    matched: Cache<CorrespondOptions, Arc<Matched>>,
    tree: OnceLock<(TriangleTree, Vec<i64>)>,
}

impl Surface {
    pub(crate) fn of(mesh: TriMesh, inner: canonform::Surface, content: Option<ContentHash>) -> Self {
        Self {
            mesh,
            unchanged: inner.input.remap.is_identity(),
            inner: Arc::new(inner),
            content,
            solvers: Cache::new(MOST_KEPT),
            descriptions: Cache::new(MOST_KEPT),
            compared: Cache::new(MOST_KEPT),
            matched: Cache::new(MOST_KEPT),
            tree: OnceLock::new(),
        }
    }

    /// Reads a mesh, with the hash of its file, and repairs it.
    pub(crate) fn repaired(
        py: Python<'_>,
        options: &RepairOptions,
        read: impl FnOnce() -> Result<(TriMesh, Option<ContentHash>), Error> + Send,
    ) -> PyResult<Self> {
        run(py, |observer| {
            let (mesh, content) = read()?;
            let inner = canonform::Surface::new(&mesh, options, observer)?;
            Ok(Self::of(mesh, inner, content))
        })
    }

    /// Values of the repaired vertices in the order of the input; without a copy if that is the same.
    fn in_input_order(&self, values: Vec<f64>) -> Vec<f64> {
        match self.unchanged {
            true => values,
            false => self.inner.in_input_order(&values, f64::NAN),
        }
    }

    /// Runs work with the solver of a method, which is prepared the first time.
    pub(crate) fn solve<T: Send>(
        &self,
        py: Python<'_>,
        method: Method,
        work: impl Fn(&dyn DistanceSolver, &dyn Observer) -> Result<T, Error> + Sync,
    ) -> PyResult<T> {
        // Solvers that are kept know no limit on memory.
        let limit = memory_limit();
        loop {
            let kept = self.solvers.get(&method).filter(|_| limit.is_none());
            let budget = kept.as_ref().map_or_else(Budget::unlimited, |solver| solver.budget());
            let budget = limit.map_or(budget.clone(), |bytes| budget.with_memory(bytes));
            let outcome = run_within(py, &budget, |observer| {
                let solver = match kept {
                    Some(solver) => solver,
                    None => {
                        let solver = method.prepare(self.inner.intrinsic(), &budget)?;
                        let solver: Arc<dyn DistanceSolver> = solver.into();
                        if limit.is_none() {
                            self.solvers.put(method, solver.clone(), 1);
                        }
                        solver
                    }
                };
                work(solver.as_ref(), observer)
            });
            match outcome {
                // Another thread was interrupted while it used the same solver.
                Err(stopped) if stopped.is_cancelled() => self.solvers.remove(&method),
                Err(stopped @ Stopped::Interrupted(_)) => {
                    self.solvers.remove(&method);
                    return Err(stopped.into());
                }
                outcome => return Ok(outcome?),
            }
        }
    }

    pub(crate) fn sources(&self, points: &[InputPoint]) -> Result<Vec<Source>, Error> {
        let located =
            |point: &InputPoint| Ok(Source::new(self.inner.intrinsic(), self.inner.locate(point)?)?);
        points.iter().map(located).collect()
    }

    /// The description with these options, made once. Work may go on after the first of two threads has it.
    pub(crate) fn described(
        &self,
        options: &DescribeOptions,
        observer: &dyn Observer,
    ) -> Result<Arc<Shape>, Error> {
        let describe = || canonform::describe(&self.inner, options, observer).map(Arc::new);
        self.descriptions.get_or_put(options, describe)
    }

    /// The surface, ready to be compared, made once.
    pub(crate) fn compared(
        &self,
        options: &FormOptions,
        observer: &dyn Observer,
    ) -> Result<Arc<Compared>, Error> {
        let surface = self.inner.clone();
        self.compared.get_or_put(options, || {
            ComparedMesh::new(&self.mesh, self.content, surface, options, observer).map(Arc::new)
        })
    }

    /// The faces of the input that the repair kept, to look for nearest points, and their numbers; made once.
    pub(crate) fn tree(&self) -> &(TriangleTree, Vec<i64>) {
        self.tree.get_or_init(|| {
            let input = &self.inner.input;
            let is_kept = |face: &[VertexId; 3]| match face.map(|v| input.remap.to_new(v)) {
                [Some(a), Some(b), Some(c)] => a != b && b != c && c != a,
                _ => false,
            };
            let kept = (0..).zip(&input.faces).filter(|(_, face)| is_kept(face));
            let (numbers, faces): (Vec<i64>, _) = kept.unzip();
            let positions = self.mesh.positions.clone();
            (TriangleTree::new(&TriMesh { positions, faces }), numbers)
        })
    }

    /// The surface, ready to be mapped to others, made once.
    pub(crate) fn matched(
        &self,
        options: &CorrespondOptions,
        observer: &dyn Observer,
    ) -> Result<Arc<Matched>, Error> {
        let prepare = || MappedSurface::new(self.inner.clone(), options, observer).map(Arc::new);
        self.matched.get_or_put(options, prepare)
    }

    fn description_of(&self, py: Python<'_>, settings: Settings) -> PyResult<Arc<Shape>> {
        let options = settings.describe(self.inner.input.repair)?;
        run(py, |observer| self.described(&options, observer))
    }
}

/// Vertices, faces, options of the repair as JSON, and the hash of a file.
type State = (Rows<f64>, Rows<i64>, String, Option<String>);

/// Vertices, faces, and the numbers of vertices of another mesh.
type Repaired = (Rows<f64>, Rows<i64>, Vector<i64>, Vector<i64>);

/// A path: its points, the points of the input that they are, and its length.
type FoundPath = (Rows<f64>, Vec<String>, Vec<f64>, f64);

#[pymethods]
impl Surface {
    /// Repairs a mesh in memory.
    #[new]
    fn new(
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, i64>,
        settings: Settings,
    ) -> PyResult<Self> {
        let mesh = mesh_of(&vertices, &faces)?;
        Self::repaired(py, &settings.repair(), || Ok((mesh, None)))
    }

    /// Reads and repairs a mesh file. Returns also what was ignored of it, in words.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, settings: Settings) -> PyResult<(Self, Vec<String>)> {
        let mut notes = Vec::new();
        let surface = Self::repaired(py, &settings.repair(), || {
            let MeshFile { mesh, facts, .. } =
                canonform::collection::read_mesh_file(&path, &ReadLimits::default())?;
            notes = facts.notes;
            notes.extend(facts.ignored.iter().map(|what| format!("ignored {what}")));
            Ok((mesh, Some(content_hash(&path)?)))
        })?;
        Ok((surface, notes))
    }

    /// Reads and repairs the content of a mesh file of this name.
    #[staticmethod]
    fn parse(py: Python<'_>, name: PathBuf, bytes: &[u8], settings: Settings) -> PyResult<Self> {
        Self::repaired(py, &settings.repair(), || {
            let file = MemoryFile { name: &name, bytes };
            let mesh = canonform::mesh::io::read_memory(&[file], &ReadLimits::default())?;
            Ok((mesh, Some(ContentHash::of(&[bytes]))))
        })
    }

    /// What [`restore`](Self::restore) needs: vertices and faces as they were given, how they are repaired, and the hash of
    /// the file that they are from.
    fn state(&self) -> State {
        let (vertices, faces) = (positions(&self.mesh.positions), faces(&self.mesh.faces));
        (vertices, faces, json(self.inner.input.repair), self.content.map(|hash| hash.to_string()))
    }

    /// The surface of which [`state`](Self::state) is the state.
    #[staticmethod]
    fn restore(
        py: Python<'_>,
        vertices: PyReadonlyArray2<'_, f64>,
        faces: PyReadonlyArray2<'_, i64>,
        repair: &str,
        content: Option<&str>,
    ) -> PyResult<Self> {
        let options = serde_json::from_str(repair).map_err(|fault| Exception::OptionError.with(fault))?;
        let content = content.map(str::parse).transpose();
        let content = content.map_err(|fault: String| Exception::CanonformError.with(fault))?;
        let mesh = mesh_of(&vertices, &faces)?;
        Self::repaired(py, &options, || Ok((mesh, content)))
    }

    #[getter]
    fn n_vertices(&self) -> usize {
        self.mesh.n_vertices()
    }

    #[getter]
    fn n_faces(&self) -> usize {
        self.inner.input.faces.len()
    }

    #[getter]
    fn area(&self) -> f64 {
        self.inner.mesh().area()
    }

    fn vertices(&self) -> Rows<f64> {
        positions(&self.mesh.positions)
    }

    fn faces(&self) -> Rows<i64> {
        faces(&self.inner.input.faces)
    }

    /// Vertices and faces of the repaired mesh, the vertex of the input that each of its vertices is from, and the vertex that
    /// each of the input became, or -1.
    fn repaired_mesh(&self) -> Repaired {
        let (mesh, remap) = (self.inner.mesh(), &self.inner.input.remap);
        let number = |v: VertexId| i64::from(v.0);
        let of_input = remap.all_to_new().map(|vertex| vertex.map_or(-1, number)).collect();
        let to_input = (0..mesh.n_vertices()).map(|v| number(remap.to_old(VertexId::from(v)))).collect();
        (positions(&mesh.positions), faces(&mesh.faces), Vector(to_input), Vector(of_input))
    }

    /// The report on the repair, as JSON, and in words.
    fn repair_report(&self) -> (String, Vec<String>) {
        let report = &self.inner.input.report;
        (json(report), report.summary())
    }

    /// Distances from the nearest of several points to all vertices of the input.
    fn distances(
        &self,
        py: Python<'_>,
        sources: &Bound<'_, PyAny>,
        geodesic: Settings,
        max_distance: f64,
    ) -> PyResult<Vector<f64>> {
        let (method, points) = (geodesic.distances()?, points_of(sources)?);
        self.solve(py, method, |solver, _| {
            let mut distances = solver.budget().vector(solver.n_vertices())?;
            solver.solve_into(&self.sources(&points)?, max_distance, &mut distances)?;
            Ok(Vector(self.in_input_order(distances)))
        })
    }

    /// One row of distances for each of several points, computed in parallel.
    fn distances_many(
        &self,
        py: Python<'_>,
        sources: &Bound<'_, PyAny>,
        geodesic: Settings,
        max_distance: f64,
    ) -> PyResult<Rows<f64>> {
        let (method, points) = (geodesic.distances()?, points_of(sources)?);
        let p = self.mesh.n_vertices();
        let mut rows = self.solve(py, method, |solver, observer| {
            distance_rows(&self.inner, solver, &self.sources(&points)?, max_distance, observer)
        })?;
        let dropped = self.inner.input.remap.all_to_new().enumerate().filter(|(_, vertex)| vertex.is_none());
        for (v, _) in dropped {
            rows.iter_mut().skip(v).step_by(p).for_each(|distance| *distance = f64::NAN);
        }
        Ok(Rows(rows, [points.len(), p]))
    }

    /// Shortest paths from one point to each of several.
    fn paths(
        &self,
        py: Python<'_>,
        source: &Bound<'_, PyAny>,
        targets: &Bound<'_, PyAny>,
    ) -> PyResult<Vec<FoundPath>> {
        let (source, targets) = ([point_of(source)?], points_of(targets)?);
        let paths = self.solve(py, Method::Exact, |solver, _| {
            let inner = &self.inner;
            targets.iter().try_for_each(|target| inner.locate(target).map(drop))?;
            let sources = self.sources(&source)?;
            let mut distances = vec![0.0; solver.n_vertices()];
            solver.solve_into(&sources, f64::INFINITY, &mut distances)?;
            let tracer = PathTracer::new(inner.intrinsic(), &sources, &distances, &solver.budget());
            let path = |target: &InputPoint| SurfacePath::trace(inner, &tracer, &source, *target);
            targets.iter().map(path).collect::<Result<Vec<_>, Error>>()
        })?;
        let found = |path: &SurfacePath| {
            let places: Vec<_> = path.points.iter().map(|point| point.position).collect();
            let at = path.points.iter().map(|point| point.at.to_string()).collect();
            let along = path.points.iter().map(|point| point.distance).collect();
            (positions(&places), at, along, path.length)
        };
        Ok(paths.iter().map(found).collect())
    }

    /// Vertices spread evenly, each the farthest from those before it.
    fn farthest_points(
        &self,
        py: Python<'_>,
        n: usize,
        first: Option<u32>,
        geodesic: Settings,
    ) -> PyResult<Vector<i64>> {
        self.solve(py, geodesic.distances()?, |solver, observer| {
            let inner = &self.inner;
            let first = match first {
                None => FirstSample::Farthest,
                Some(vertex) => FirstSample::Vertex(inner.repaired_vertex(VertexId(vertex))?),
            };
            observer.begin("samples", n);
            let distances = Sampling::Farthest.start(solver, first, 0)?.into_distances(n)?;
            let input = |&v: &usize| i64::from(inner.input_vertex(VertexId::from(v)).0);
            Ok(Vector(distances.landmarks().iter().map(input).collect()))
        })
    }

    /// The embedded surface.
    fn canonical_form(&self, py: Python<'_>, settings: Settings) -> PyResult<Form> {
        let (options, stress) = (settings.form(self.inner.input.repair)?, settings.stress());
        let options = EmbedOptions::from(&options).stress(stress);
        let surface = &*self.inner;
        let embedded = run(py, |observer| embed(surface, options, observer))?;
        Ok(Form { surface: self.inner.clone(), embedded })
    }

    /// This mesh, a finer one of the surface of a form, in the coordinates of that form.
    fn finer(&self, py: Python<'_>, form: PyRef<'_, Form>, settings: Settings) -> PyResult<Form> {
        let (stress, form) = (settings.stress(), &*form);
        let embedded = run(py, |observer| {
            let options = EmbedOptions::finer(&self.inner, &form.surface, &form.embedded)?;
            embed(&*self.inner, options.stress(stress), observer)
        })?;
        Ok(Form { surface: self.inner.clone(), embedded })
    }

    /// The signature of one kind, or all of them as one vector if the kind is `fused`.
    fn signature<'py>(&self, py: Python<'py>, kind: &str, settings: Settings) -> PyResult<Bound<'py, PyAny>> {
        let measure = measure("kind", kind)?;
        let described = self.description_of(py, settings)?;
        Ok(match measure {
            Measure::Fused => described.fused.clone().into_pyarray(py).into_any(),
            Measure::Signature(kind) => {
                let found = canonform::embed::signature(&described, kind);
                found.map(|found| found.values).unwrap_or_default().into_pyarray(py).into_any()
            }
        })
    }
}

/// Writes a mesh; the extension of the path tells the format.
#[pyfunction]
pub(crate) fn write(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    faces: PyReadonlyArray2<'_, i64>,
    path: PathBuf,
) -> PyResult<()> {
    let mesh = mesh_of(&vertices, &faces)?;
    raised(py.detach(|| canonform::mesh::io::write(&path, &mesh)))
}
