"""Surfaces: distances, paths, samples, forms and signatures."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, Unpack, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _canonform, _html
from ._arrays import Floats, Ints, SourceRows, VertexValues, edges_of, mesh_of, numeric, on_vertices, straight
from ._field import DistanceField
from ._form import Form
from ._look import Look, drawn
from ._methods import Embedding, Geodesic, options_of
from ._operators import ClosestPoints, EdgePoint, Eigenbasis, FacePoint, parsed
from ._settings import (
    Call, Components, Landmarks, SignatureKind, StressChoice, Weld, number, optional, running, some_whole, unmasked,
    warned, whole, word,
)  # fmt: skip
from ._stored import AsArray, ByValue, Constant
from ._view import SurfaceView, scene
from .errors import MeshError, OptionError, PointError, SurfaceLossWarning

if TYPE_CHECKING:
    from scipy import sparse

Point: TypeAlias = int | np.integer[Any] | EdgePoint | FacePoint | str
"""A vertex by its number, or a point of an edge or face; also as text, such as "17-42@0.3" and "f8@2:1:1"."""

Points: TypeAlias = list[Point] | tuple[Point, ...] | range | Ints
"""Several points."""


_MOST_DROPPED = 0.01
"""Losing more of a surface is a warning."""


def distance_methods() -> dict[str, str]:
    """Methods that measure distances: names, and what they compute.

    >>> sorted(canonform.distance_methods())
    ['bfs', 'dijkstra', 'exact', 'fast-marching', 'heat']
    """
    return dict(_canonform.DISTANCE_METHODS)


def embedding_methods() -> dict[str, str]:
    """Methods that turn distances into coordinates: names, and what they compute."""
    return dict(_canonform.EMBEDDING_METHODS)


def signature_kinds() -> list[str]:
    """Kinds of signatures that `Surface.signature` computes, besides "fused"."""
    return list(_canonform.SIGNATURE_KINDS)


class RepairReport(dict[str, Any]):
    """What the repair of a mesh changed: the object `repair` that the command line prints, with the same keys.

    `str(report)` says it in words.

    Attributes:
        lines: One line for each kind of change; empty if nothing was changed.
    """

    def __init__(self, report: dict[str, Any], lines: list[str]) -> None:
        super().__init__(report)
        self.lines = lines

    def __str__(self) -> str:
        return "\n".join(self.lines) or "nothing to repair"


@dataclass(frozen=True, repr=False, eq=False)
class Path(AsArray, ByValue):
    """A shortest path along a surface.

    Attributes:
        points: Its points from start to end, joined by straight lines: shape (k, 3), in mesh units.
        at: The point of the mesh that each of them is: the number of a vertex, or a point of an edge or face.
        along: The distance of each from the start, along the path, in mesh units: shape (k,).
        length: Its length, in mesh units.
    """

    points: Floats
    at: list[int | EdgePoint | FacePoint]
    along: Floats
    length: float

    def __repr__(self) -> str:
        return f"Path(length={self.length:.6g}, points={len(self)}, from {self.at[0]} to {self.at[-1]})"


@dataclass(frozen=True, repr=False, eq=False)
class RepairedMesh(ByValue):
    """The mesh that the repair made of the input, without what it dropped, and the way from one to the other.

    Values on the input become values on this mesh by `values[to_input]`, and matrices by `matrix[to_input][:, to_input]`.

    Attributes:
        vertices: Its vertices: shape (k, 3).
        faces: Its faces: shape (l, 3).
        to_input: For each of its vertices, the vertex of the input that it was, the first of those that were merged: shape (k,).
        from_input: For each vertex of the input, the vertex that it became, or -1 if the repair dropped it: shape (n,).
    """

    vertices: Floats
    faces: Ints
    to_input: Ints
    from_input: Ints

    def __repr__(self) -> str:
        return f"RepairedMesh({len(self.vertices)} vertices, {len(self.faces)} faces)"


class Surface(Constant):
    """A triangle mesh, repaired, with everything that was prepared on it.

    Preparing a solver takes longer than one run of it, so keep the surface, and call it as often as you like, also from several threads.

    Args:
        mesh: The vertices: an array of shape (n, 3), of any type of numbers, in any unit of length. Or, without `faces`: vertices and faces
            in a tuple; a mesh, scene or points of trimesh, meshio, PyVista or Open3D; the path of a mesh file; the file, open, or its
            bytes. Or points without faces: they are smoothed if they are noisy, and joined by triangles.
        faces: The triangles: an array of shape (m, 3) of vertex numbers, counted from 0. Faces of 4 corners are split into triangles, as in
            files. Leave it out for a point cloud.
        components: What happens to a mesh of several components: "largest" keeps the one of the largest area, "bridge" joins them by links,
            "error" refuses the mesh.
        weld: Which vertices are merged: "seams" merges those on boundaries that coincide or nearly do, "all" those in the same position,
            "none" none, and a number those on boundaries within that distance, in mesh units.
        format: The format of bytes, or of an open file without a name, such as "ply". Otherwise the extension tells it.

    Raises `MeshError` if it is not a mesh with finite coordinates.

    >>> square = canonform.Surface(np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]]))
    >>> square.distances(0).round(6).tolist()
    [0.0, 1.0, 1.414214, 1.0]
    """

    _inner: _canonform.Surface
    _name: str
    _notes: list[str]

    def __init__(
        self,
        mesh: ArrayLike | Any,
        faces: ArrayLike | None = None,
        *,
        components: Components = "largest",
        weld: Weld = "seams",
        format: str | None = None,
        **call: Unpack[Call],
    ) -> None:
        settings = options_of(components=components, weld=weld)
        self._name, self._notes = "", []
        with running(call):
            if isinstance(mesh, (str, os.PathLike)) and faces is None:
                self._name = os.path.basename(os.fspath(mesh))
                self._inner, self._notes = _canonform.Surface.read(os.fspath(mesh), settings)
            elif isinstance(mesh, (bytes, bytearray)) or hasattr(mesh, "readable"):
                self._name, content = _content_of(mesh, format)
                self._inner = _canonform.Surface.parse(self._name, content, settings)
            else:
                vertices, triangles, self._notes = mesh_of(mesh, faces)
                self._inner = _canonform.Surface(vertices, triangles, settings)
        share = self.repair_report["dropped_area_share"]
        if share > _MOST_DROPPED:
            whose = f" of {self._name}" if self._name else ""
            warned(
                f"{100 * share:.0f} % of the surface{whose} is not used: {self.repair_report}; components=\"bridge\" keeps it",
                SurfaceLossWarning,
            )

    @classmethod
    def _of(cls, inner: _canonform.Surface, name: str = "") -> Surface:
        surface = cls.__new__(cls)
        surface._inner, surface._name, surface._notes = inner, name, []
        return surface

    def _state(self) -> dict[str, Any]:
        vertices, faces, repair, content = self._inner.state()
        return {"vertices": vertices, "faces": faces, "repair": repair, "content": content, "name": self._name, "notes": self._notes}

    def _restore(self, state: dict[str, Any]) -> None:
        mesh = (state[key] for key in ("vertices", "faces", "repair", "content"))
        self._inner, self._name, self._notes = _canonform.Surface.restore(*mesh), state["name"], state["notes"]

    @property
    def n_vertices(self) -> int:
        """Number of vertices of the input."""
        return self._inner.n_vertices

    @property
    def n_faces(self) -> int:
        """Number of faces of the input."""
        return self._inner.n_faces

    @property
    def area(self) -> float:
        """Area of the repaired surface, in squared mesh units."""
        return self._inner.area

    @cached_property
    def vertices(self) -> Floats:
        """The vertices of the input, shape (n, 3). Not writable."""
        vertices = self._inner.vertices()
        vertices.flags.writeable = False
        return vertices

    @cached_property
    def faces(self) -> Ints:
        """The faces of the input, shape (m, 3). Not writable."""
        faces = self._inner.faces()
        faces.flags.writeable = False
        return faces

    @cached_property
    def repair_report(self) -> RepairReport:
        """What the repair changed. Results are NaN at vertices that it dropped, see `kept`."""
        report, lines = self._inner.repair_report()
        return RepairReport(json.loads(report), [*self._notes, *lines])

    @cached_property
    def repaired(self) -> RepairedMesh:
        """The repaired mesh, and where its vertices come from."""
        return RepairedMesh(*self._inner.repaired_mesh())

    @property
    def kept(self) -> NDArray[np.bool_]:
        """Which vertices of the input are on the surface, shape (n,): all but those without faces and those of dropped components.

        All results have finite numbers there, and NaN elsewhere.
        """
        return self.repaired.from_input >= 0

    def distances(
        self,
        sources: Point | Iterable[Point],
        *,
        geodesic: Geodesic = "fast-marching",
        max_distance: float = np.inf,
        **call: Unpack[Call],
    ) -> VertexValues:
        """Distances along the surface from the nearest of the sources to every vertex: shape (n,), in mesh units.

        NaN for vertices that the repair dropped.

        Args:
            sources: A vertex number, an `EdgePoint`, a `FacePoint`, or several of them; or a mask of the vertices.
            geodesic: How distances are measured, one of `distance_methods()`: "fast-marching", "exact", "heat", "dijkstra", "bfs"; or
                `FastMarching` with options.
            max_distance: Do not look farther than this, in mesh units; vertices beyond are infinitely far.

        >>> distances = cat.distances([0, 10])
        >>> distances.shape, float(distances[10])
        ((1000,), 0.0)
        """
        points = _several(sources, self.n_vertices)
        if not points:
            raise PointError("there are no sources; give at least one point")
        with running(call):
            return on_vertices(self._inner.distances(points, options_of(geodesic=geodesic), number("max_distance", max_distance, 0)))

    def distances_many(
        self, sources: Iterable[Point], *, geodesic: Geodesic = "fast-marching", max_distance: float = np.inf, **call: Unpack[Call]
    ) -> SourceRows:
        """Distances from each of several `sources` on its own, in parallel: shape (number of sources, n), in mesh units.

        Row i equals that of `distances` from one.
        """
        with running(call):
            return self._inner.distances_many(
                _several(sources, self.n_vertices), options_of(geodesic=geodesic), number("max_distance", max_distance, 0)
            ).view(SourceRows)

    @overload
    def path(self, a: Point, b: Point, **call: Unpack[Call]) -> Path: ...
    @overload
    def path(self, a: Point, b: Points, **call: Unpack[Call]) -> list[Path]: ...
    def path(self, a: Point, b: Point | Points, **call: Unpack[Call]) -> Path | list[Path]:
        """The shortest path along the surface from a to b; one path for each if b is a list, tuple or array of points.

        The path crosses faces and is as long as the exact distance.

        Args:
            a: The start: a vertex, an `EdgePoint` or a `FacePoint`.
            b: The end, or several.

        Raises `PointError` if the mesh has no such point, the repair dropped it, or no path leads there.

        >>> path, other_path = cat.path(0, [500, "f8@2:1:1"])
        >>> path.at[-1], other_path.at[-1]
        (500, FacePoint(face=8, weights=(2.0, 1.0, 1.0)))
        """
        single = isinstance(b, (str, EdgePoint, FacePoint)) or not isinstance(b, Iterable)
        [source] = _several(a, self.n_vertices)
        ends = _several(b, self.n_vertices)
        with running(call):
            paths = self._inner.paths(source, ends)
        found = [Path(points, list(map(parsed, at)), along, length) for points, at, along, length in paths]
        return found[0] if single else found

    def farthest_points(
        self, n_points: int, *, first: int | None = None, geodesic: Geodesic = "fast-marching", **call: Unpack[Call]
    ) -> Ints:
        """Vertices spread evenly over the surface, each the farthest from those before it: shape (n_points,).

        Args:
            n_points: How many; fewer if the surface has fewer vertices.
            first: The first of them. By default, the vertex farthest from vertex 0, a tip of the surface.
            geodesic: As in `distances`.
        """
        if first is not None and whole("first", first) >= self.n_vertices:
            raise PointError(f"first={first} is not possible: the mesh has {self.n_vertices} vertices, counted from 0")
        with running(call):
            return self._inner.farthest_points(whole("n_points", n_points), some_whole("first", first), options_of(geodesic=geodesic))

    def distance_field(
        self, n_landmarks: int = 100, *, rank: int | None = None, geodesic: Geodesic = "fast-marching", **call: Unpack[Call]
    ) -> DistanceField:
        """The distances between all pairs of vertices, with bounds, in little memory.

        Args:
            n_landmarks: Number of landmarks; each takes 2 bytes per vertex.
            rank: Number of eigenpairs behind the estimates, by default half the landmarks; each takes 2 bytes per vertex.
            geodesic: How distances are measured, as in `distances`. Only "exact" certifies the bounds; with others they are widened by the
                error that was measured on this surface.
        """
        with running(call):
            inner = _canonform.DistanceField.build(
                self._inner, whole("n_landmarks", n_landmarks), some_whole("rank", rank), options_of(geodesic=geodesic)
            )
        return DistanceField(inner)

    def canonical_form(
        self,
        n_landmarks: Landmarks = 100,
        *,
        method: Embedding = "nmds",
        n_components: int = 3,
        geodesic: Geodesic = "fast-marching",
        stress: StressChoice = "auto",
        seed: int = 0,
        **call: Unpack[Call],
    ) -> Form:
        """Embed the surface so that straight-line distances approximate those along it.

        Args:
            n_landmarks: Number of landmarks, vertices from which distances are measured; or "auto" to take them until twice as many reduced
                the stress by less than 1 %, at most 640.
            method: How distances become coordinates, one of `embedding_methods()`: "nmds", "landmark", "spectral", "kpca", "mds", "smacof";
                or one of `Nystrom`, `Landmark`, `Spectral`, `KernelPca`, `Smacof` with options.
            n_components: Dimensions of the embedding.
            stress: From which distances the stress is found: "exact" measures those between all pairs of vertices, "estimate" those of 100
                vertices to all others, "skip" none. "auto" is exact where the method measures all pairs anyway; else it estimates from one
                vertex for every 7 landmarks, at least 3, and at least 32 with n_landmarks="auto". `Form.normalized_stress_interval` says
                how far an estimate is to be relied on.
            seed: Of everything random, a whole number.

        `geodesic` is that of `distances`.

        Raises `OptionError`, `EmbeddingError` if an option is not possible, has no effect beside the others, or does not fit the mesh.

        >>> cat.canonical_form(50, method=canonform.Nystrom(rank=20)).points.shape
        (1000, 3)
        """
        settings = options_of(
            n_landmarks=n_landmarks, method=method, n_components=n_components, geodesic=geodesic, stress=stress, seed=seed
        )
        with running(call):
            inner = self._inner.canonical_form(settings)
        return Form(inner, self, settings, self._name)

    def signature(
        self, kind: SignatureKind = "fused", *, n_landmarks: int = 100, size: bool = False, **call: Unpack[Call]
    ) -> NDArray[np.float32] | Floats:
        """A vector that describes the shape regardless of pose, position, triangulation and, by default, size.

        Its numbers have 32 bits if it is "fused", else 64. It is computed once and kept.

        Args:
            kind: "fused" for all signatures as one vector, by which an index is searched: Euclidean distances between such vectors compare
                shapes. Or one of "form-spectrum", "geodesic-spectrum", "shape-dna", "heat-kernel", "wave-kernel", "rigid".
            n_landmarks: Number of landmarks of the form, see `canonical_form`.
            size: Whether size counts; then all meshes need the same unit of length.
        """
        with running(call):
            return self._inner.signature(word("kind", kind), options_of(n_landmarks=n_landmarks, size=size))

    def laplacian(self, *, repaired: bool = False, **call: Unpack[Call]) -> sparse.csr_array:
        """The stiffness matrix, sparse, symmetric, positive semidefinite: shape (n, n). Needs SciPy.

        Its entries are cotangents on an intrinsic Delaunay triangulation (Sharp and Crane 2020), none of them negative, for any mesh.

        Args:
            repaired: Whether rows and columns are vertices of `Surface.repaired`. Otherwise those of vertices that the repair dropped are
                empty, and of those that it merged, the first stands for all.

        >>> W, A = cat.laplacian(), cat.mass()
        >>> W.shape, bool(abs(W.sum()) < 1e-6)
        ((1000, 1000), True)
        """
        own = self.repaired.to_input
        with running(call):
            matrix = self._operators[0]
            return matrix[own][:, own] if repaired else matrix.copy()

    def mass(self, *, repaired: bool = False, **call: Unpack[Call]) -> sparse.dia_array:
        """The areas around the vertices, in squared mesh units, as a sparse diagonal matrix: shape (n, n). Needs SciPy.

        Parameters as in `laplacian`. Vertices whose rows are empty there have mass 1, so that the matrix is not singular.

        >>> bool(np.isclose(cat.mass().trace(), cat.area))
        True
        """
        own = self.repaired.to_input
        with running(call):
            areas = self._operators[1][own]
            masses = np.ones(self.n_vertices)
            masses[own] = areas
            return _sparse().diags_array(areas if repaired else masses)

    @cached_property
    def _operators(self) -> tuple[sparse.csr_array, Floats]:
        """The stiffness matrix, and the areas around the vertices."""
        rows, columns, values, masses = _canonform.laplacian(self._inner)
        return _sparse().coo_array((values, (rows, columns)), shape=(self.n_vertices, self.n_vertices)).tocsr(), masses

    def eigenbasis(self, n_eigenfunctions: int = 100, **call: Unpack[Call]) -> Eigenbasis:
        """The `n_eigenfunctions` smallest eigenvalues of the intrinsic Laplacian, and their eigenfunctions.

        Fewer if the surface has fewer vertices. They are kept: the next call takes the first of them, and finds more only if needed.
        """
        n = whole("n_eigenfunctions", n_eigenfunctions, 1)
        with running(call):
            found, basis = self.__dict__.get("_basis", (0, None))
            if found < n:
                values, functions, masses = _canonform.eigenbasis(self._inner, n)
                found, basis = self.__dict__["_basis"] = n, Eigenbasis(values, on_vertices(functions, writeable=False), masses)
            return basis if found == n else basis.first(n)

    def hks(
        self, times: ArrayLike | None = None, *, n_times: int = 16, scaled: bool = False, n_eigenfunctions: int = 100, **call: Unpack[Call]
    ) -> VertexValues:
        """The heat kernel signature of every vertex, `Eigenbasis.hks` of `n_eigenfunctions`. Not writable."""
        return self.eigenbasis(n_eigenfunctions, **call).hks(times, n_times=n_times, scaled=scaled)

    def wks(
        self,
        energies: ArrayLike | None = None,
        *,
        n_energies: int = 100,
        sigma: float | None = None,
        scaled: bool = True,
        n_eigenfunctions: int = 100,
        **call: Unpack[Call],
    ) -> VertexValues:
        """The wave kernel signature of every vertex, `Eigenbasis.wks` of `n_eigenfunctions`. Not writable."""
        return self.eigenbasis(n_eigenfunctions, **call).wks(energies, n_energies=n_energies, sigma=sigma, scaled=scaled)

    @cached_property
    def _face_vectors(self) -> Floats:
        """The normal of each face, as long as twice its area."""
        a, b, c = (self.vertices[self.faces[:, corner]] for corner in range(3))
        return np.cross(b - a, c - a)

    @cached_property
    def areas(self) -> Floats:
        """The area of each face of the input, in squared mesh units: shape (m,)."""
        return 0.5 * np.linalg.norm(self._face_vectors, axis=1)

    @cached_property
    def face_normals(self) -> VertexValues:
        """The unit normal of each face of the input: shape (m, 3). NaN for a face without area."""
        return on_vertices(_units(self._face_vectors))

    @cached_property
    def normals(self) -> VertexValues:
        """The unit normal at each vertex of the input, the mean of its faces by area: shape (n, 3). NaN at a vertex without faces."""
        sums = np.zeros_like(self.vertices)
        for corner in range(3):
            np.add.at(sums, self.faces[:, corner], self._face_vectors)
        return on_vertices(_units(sums))

    @cached_property
    def edges(self) -> Ints:
        """The edges of the input as pairs of vertices, each once and in order: shape (k, 2)."""
        return edges_of(self.faces)

    @cached_property
    def _slopes(self) -> Floats:
        """On each face, the gradients of the functions that are 1 at one corner and 0 at the others: shape (m, 3, 3)."""
        corners = self.vertices[self.faces]
        opposite = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
        sides = np.cross(self._face_vectors[:, None, :], opposite)
        with np.errstate(invalid="ignore", divide="ignore"):
            slopes: Floats = sides / (2 * self.areas[:, None, None]) ** 2
        return slopes

    @overload
    def gradient(self) -> sparse.csr_array: ...
    @overload
    def gradient(self, values: ArrayLike) -> VertexValues: ...
    def gradient(self, values: ArrayLike | None = None) -> sparse.csr_array | VertexValues:
        """The gradient on each face, shape (m, 3), of the function with these `values` at the vertices, shape (n,).

        Without values, the sparse matrix, shape (3 m, n), by which they are multiplied. On faces without area, its rows are empty, and
        gradients are NaN.

        >>> slopes = np.linalg.norm(cat.gradient(cat.distances(0)), axis=1)
        >>> bool(abs(np.median(slopes) - 1) < 0.1)
        True
        """
        if values is not None:
            array = numeric("values", values, (self.n_vertices,))
            return on_vertices(np.einsum("fk,fkx->fx", array[self.faces], self._slopes))
        slopes = np.where(np.isfinite(self._slopes), self._slopes, 0)
        rows, columns = np.broadcast_arrays(np.arange(3 * self.n_faces).reshape(-1, 1, 3), self.faces[:, :, None])
        entries = slopes.ravel(), (rows.ravel(), columns.ravel())
        return _sparse().coo_array(entries, shape=(3 * self.n_faces, self.n_vertices)).tocsr()

    @overload
    def divergence(self) -> sparse.csr_array: ...
    @overload
    def divergence(self, vectors: ArrayLike) -> VertexValues: ...
    def divergence(self, vectors: ArrayLike | None = None) -> sparse.csr_array | VertexValues:
        """The divergence of `vectors` on faces, shape (m, 3), integrated over the area around each vertex: shape (n,). Needs SciPy.

        Without vectors, the sparse matrix, shape (n, 3 m), by which they are multiplied. Divided by the diagonal of `mass`, it is a density.
        `divergence() @ gradient()` has minus the cotangents of the faces as they are.

        >>> G, D = cat.gradient(), cat.divergence()
        >>> (D @ G).shape, bool(abs((D @ G).sum()) < 1e-9)
        ((1000, 1000), True)
        """
        matrix = (-self.gradient().T.multiply(np.repeat(self.areas, 3))).tocsr()
        if vectors is None:
            return matrix
        given = numeric("vectors", vectors, (self.n_faces, 3)).ravel()
        return on_vertices(np.asarray(matrix @ np.where(np.isfinite(given), given, 0)))

    def log_map(self, source: Point, *, max_distance: float = np.inf, **call: Unpack[Call]) -> VertexValues:
        """Where the vertices lie around a point, unrolled into the plane that touches there: shape (n, 2), in mesh units.

        Row v is the direction in which the shortest path from `source`, a point, to vertex v starts, as long as this path: its norm is
        the exact distance. NaN for vertices beyond `max_distance` and for those that the repair dropped. Takes as long as exact distances.

        The first axis points, from a vertex, along the edge to its neighbor with the lowest number; from a point of an edge, to the
        end with the higher number; in a face, from its first corner to the second. The second axis is 90 degrees to the left, seen
        from the side on which the corners of faces run counterclockwise. Angles at an inner vertex are scaled to a full turn.

        >>> square = canonform.Surface(np.array([[0, 0, 5], [1, 0, 5], [1, 1, 5], [0, 1, 5]]), np.array([[0, 1, 2], [0, 2, 3]]))
        >>> (square.log_map(0) + 0.0).round(6).tolist()
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
        """
        points = _several(source, self.n_vertices)
        if len(points) != 1:
            raise PointError(f"the logarithmic map is about one point, not {len(points)}")
        with running(call):
            return on_vertices(_canonform.log_map(self._inner, points[0], number("max_distance", max_distance, 0)))

    def closest_point(self, points: ArrayLike, **call: Unpack[Call]) -> ClosestPoints:
        """For `points` in space, shape (3,) or (k, 3), the nearest points of the faces of the input that the repair kept.

        >>> near = cat.closest_point([0, 0, 50])
        >>> cat.distances(near.at).shape
        (1000,)
        """
        single = points if np.ndim(points) != 1 else [points]
        queries: Floats = numeric("points", single, ("k", 3), error=PointError)
        if not np.isfinite(queries).all():
            raise PointError("points has numbers that are not finite; leave them out")
        with running(call):
            places, distances, faces = _canonform.closest_points(self._inner, queries)
        a, b, c = (self.vertices[self.faces[faces, corner]] for corner in range(3))
        normal = np.cross(b - a, c - a)
        shares = [np.einsum("ij,ij->i", np.cross(y - x, places - x), normal) for x, y in ((b, c), (c, a), (a, b))]
        weights = np.clip(np.stack(shares, axis=1) / np.einsum("ij,ij->i", normal, normal)[:, None], 0, 1)
        return ClosestPoints(places, distances, faces, weights)

    def write(self, path: str | os.PathLike[str], *, repaired: bool = False) -> None:
        """Write the input, or the `repaired` mesh, to the file `path`. The extension tells the format; .ply keeps coordinates exactly."""
        mesh = self.repaired if repaired else self
        _canonform.write(straight(mesh.vertices), straight(mesh.faces), os.fspath(path))

    def picture(self, values: ArrayLike | None = None, **look: Unpack[Look]) -> bytes:
        """A shaded picture of the surface as the bytes of a PNG file, colored by `values` at its vertices if given.

        The keywords of `Look` say from where, how large, and what is drawn on it.

        >>> png = cat.picture(cat.distances(0), view="left", bar="distance", paths=[cat.path(0, 500)], points=[0, 500])
        >>> png[1:4]
        b'PNG'
        """
        numbers = None if values is None else numeric("values", values, (self.n_vertices,))
        return drawn(self.vertices, self.faces, numbers, look)

    def view(
        self, values: ArrayLike | None = None, *, name: str = "", height: int = 480, up: Literal["x", "y", "z"] = "z"
    ) -> SurfaceView:
        """The surface to turn and zoom in a notebook, colored by values at its vertices if given.

        Args:
            values: One number for each vertex; faces at vertices whose number is not finite are gray.
            name: What the values are, for the color bar.
            height, up: The height of the view in pixels, and the axis that points up.

        >>> cat.view(cat.distances(0), name="distance")
        SurfaceView('cat0', 1996 faces)
        """
        numbers = None if values is None else numeric("values", values, (self.n_vertices,))
        return scene(self.vertices, self.faces, numbers, self._name or "Surface", name, whole("height", height, 40), up)

    def __repr__(self) -> str:
        name = f"{self._name!r}, " if self._name else ""
        return f"Surface({name}{self.n_vertices} vertices, {self.n_faces} faces)"

    def _repr_html_(self) -> str:
        report = self.repair_report
        rows = [
            ("vertices, faces", f"{self.n_vertices:,}, {self.n_faces:,}"),
            ("area", f"{self.area:.6g}"),
            ("size", " x ".join(f"{side:.4g}" for side in np.ptp(self.vertices, axis=0))),
            ("repair", str(report)),
        ]
        return _html.card(self._name or "Surface", rows, [_html.image(self.picture(width=440, height=440))])


def read(path: str | os.PathLike[str], *, components: Components = "largest", weld: Weld = "seams", **call: Unpack[Call]) -> Surface:
    """Read and repair the mesh file `path`, as `Surface` does.

    >>> cat.write("cat.ply")
    >>> canonform.read("cat.ply").n_vertices
    1000
    """
    return Surface(path, components=components, weld=weld, **call)


def _several(points: Any, n_vertices: int) -> list[Any]:
    """Points one by one. A mask stands for the vertices where it is true."""
    is_one = isinstance(points, (str, EdgePoint, FacePoint)) or not isinstance(points, Iterable)
    points = [points] if is_one else points if isinstance(points, np.ndarray) else list(points)
    if not is_one and (isinstance(points, np.ndarray) or any(isinstance(point, (bool, np.bool_)) for point in points)):
        array = np.asarray(unmasked("sources", points))
        if array.dtype == bool and array.shape != (n_vertices,):
            raise PointError(f"a mask of sources needs one value for each of the {n_vertices} vertices; it has shape {array.shape}")
        points = (np.flatnonzero(array) if array.dtype == bool else array.ravel()).tolist()
    try:
        return [str(point) if isinstance(point, (EdgePoint, FacePoint)) else point for point in points]
    except (TypeError, ValueError) as fault:
        raise PointError(f"{points!r} is not a point; give numbers in it: {fault}") from fault


def _sparse() -> Any:
    return optional("scipy.sparse", "sparse matrices need the package SciPy (`pip install scipy`)")


def _units(vectors: Floats) -> Floats:
    with np.errstate(invalid="ignore", divide="ignore"):
        units: Floats = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return units


AnyMesh: TypeAlias = Surface | str | os.PathLike[str] | ArrayLike | Any
"""A surface, or what makes one: a mesh file, a mesh of another package, a generated shape, vertices with faces, or points."""


def surface_of(mesh: AnyMesh) -> Surface:
    """The surface that a mesh is, or makes."""
    from .datasets import Shape

    if isinstance(mesh, Surface):
        return mesh
    return mesh.surface() if isinstance(mesh, Shape) else Surface(mesh)


def _content_of(file: Any, format: str | None) -> tuple[str, bytes]:
    """Name and content of an open file, or of bytes."""
    name = getattr(file, "name", None)
    name = f"mesh.{format}" if format else name if isinstance(name, str) else ""
    if not name:
        raise MeshError('bytes and files without a name do not tell their format; name it, such as format="ply"')
    content = file.read() if hasattr(file, "read") else file
    return os.path.basename(name), content.encode() if isinstance(content, str) else bytes(content)
