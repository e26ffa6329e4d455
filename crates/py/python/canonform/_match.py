"""Maps between surfaces."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _canonform, _html
from ._arrays import Floats, Ints, numeric, on_vertices, straight
from ._operators import Eigenbasis, FacePoint, face_points
from ._look import Look, drawn, to_the_right
from ._methods import Geodesic, options_of
from ._settings import Call, running, some_whole, unmasked
from ._stored import ByValue, Stored
from ._surface import AnyMesh, Surface, surface_of
from .errors import OptionError

Side: TypeAlias = Literal["a", "b"]
MapKind: TypeAlias = Literal["direct", "mirrored", "unoriented"]
Part: TypeAlias = Literal["first", "second"]
_OTHER: dict[Part, Part] = {"first": "second", "second": "first"}

_Arrays: TypeAlias = tuple[Ints, Floats, Floats, list[Ints] | None]

_GRAY = 160
# Colors fade to gray around this confidence, as in pictures of the command line.
_DOUBTFUL = 0.5


@dataclass(frozen=True, repr=False, eq=False)
class MappedPoints(ByValue):
    """Points inside the faces of a surface that a map takes vertices or faces of another surface to.

    Attributes:
        faces: The face that each lies in, or -1 if the repair dropped the vertex: shape (n,). `valid` is the mask of the others.
        corners: The vertices of that face: shape (n, 3).
        weights: The weights of these vertices, with sum 1; NaN for dropped vertices: shape (n, 3).
    """

    faces: Ints
    corners: Ints
    weights: Floats

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which of them are on the surface: a mask of shape (n,)."""
        return self.faces >= 0

    @property
    def at(self) -> list[FacePoint | None]:
        """The points as sources of distances and ends of paths; `None` for dropped vertices."""
        return [None if point.face < 0 else point for point in face_points(self.faces, self.weights)]

    def interpolate(self, values: ArrayLike) -> Floats:
        """The `values` of the vertices of that surface, shape (m,) or (m, d), at the points; NaN for dropped vertices."""
        sides = ("m",) if np.ndim(values) == 1 else ("m", "d")
        array = numeric("values", values, sides)
        weights = self.weights if array.ndim == 1 else self.weights[:, :, None]
        parts = array[self.corners] * weights
        # Not a number times zero is not a number.
        parts[np.broadcast_to(weights == 0, parts.shape)] = 0
        return parts.sum(axis=1)

    def __len__(self) -> int:
        return len(self.faces)

    def __repr__(self) -> str:
        return f"MappedPoints({len(self)} points)"


class SurfaceMap(Stored):
    """A map from the vertices of one surface, `a`, to another, `b`.

    Attributes:
        vertices: For each vertex of `a`, its partner on `b`, or -1 if the repair dropped the vertex, or the part `b` lacks it; shape (n,).
        vertex_confidence: How well the map keeps distances around each vertex of `a`, from 0 to 1; shape (n,).
        kind: "direct" if the map keeps the orientation, "mirrored" if it reverses it, "unoriented" if a surface has none.
        distortion: The mean change of distances, as a share of the square root of the area.
        agreement: How far the map keeps the orientation, from -1 to 1; `None` if a surface cannot be oriented.
        confidence: How likely this map is the right one of its kind, and not the next best; below 0.7 it is uncertain.
        alternative: The next best map of this kind, unless the confidence is 0.9 or more: front and back may be exchanged.
        part: "first" or "second", the surface that is a part of the other; `None` if both are mapped as wholes.
    """

    def __init__(
        self,
        report: dict[str, Any],
        arrays: Sequence[_Arrays | None],
        shapes: tuple[Surface, Surface],
        landmarks: Ints,
        settings: dict[str, Any],
    ) -> None:
        assert arrays[0] is not None
        self.vertices, self.vertex_confidence, self._functional, self._partners = arrays[0]
        self.kind: MapKind = report["kind"]
        self.distortion: float = report["distortion"]
        self.agreement: float | None = report["agreement"]
        self.confidence: float = report["confidence"]
        self.part: Part | None = report.get("part", {}).get("part")
        self._shapes, self._landmarks, self._settings = shapes, landmarks, settings
        self._points: dict[str, MappedPoints] = {}
        others = [SurfaceMap(report["alternative"], [other], shapes, landmarks, settings) for other in arrays[1:] if other is not None]
        self.alternative: SurfaceMap | None = others[0] if others else None

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which vertices of `a` have a partner: a mask of shape (n,)."""
        return self.vertices >= 0

    def functional(
        self, n_eigenfunctions: int | None = None, *, bases: tuple[Eigenbasis, Eigenbasis] | None = None
    ) -> Floats:
        """The map of functions, a square matrix, smaller for a part: column j has the coefficients of the j-th eigenfunction of `b`,
        pulled back to `a`, in the eigenfunctions of `a`. The method `bases` gives these, by default all; `n_eigenfunctions` is how many.
        With `bases=` it is written in these of `a` and `b`.
        """
        if bases is not None:
            a, b = bases
            pulled = np.where(self.vertices[:, None] < 0, 0.0, np.nan_to_num(b.functions)[self.vertices])
            return a.project(pulled)[:n_eigenfunctions, :n_eigenfunctions]
        rows, columns = self._counts(n_eigenfunctions)
        return self._functional[:rows, :columns].copy()

    def bases(self, n_eigenfunctions: int | None = None, **call: Unpack[Call]) -> tuple[Eigenbasis, Eigenbasis]:
        """The `n_eigenfunctions` of `a` and of `b` that `functional` is written in, of both surfaces scaled to unit area."""
        counts = self._counts(n_eigenfunctions)
        with running(call):
            found = [_canonform.map_basis(shape._inner, self._settings) for shape in self._shapes]
        a, b = (
            Eigenbasis(values, on_vertices(functions), masses).first(most)
            for (values, functions, masses), most in zip(found, counts, strict=True)
        )
        return a, b

    def _counts(self, k: int | None) -> tuple[int, int]:
        rows, columns = self._functional.shape
        most = max(rows, columns)
        if k is not None and not 1 <= k <= most:
            raise OptionError(f"n_eigenfunctions={k} is not possible: the map has {most} eigenfunctions")
        k = most if k is None else k
        return min(k, rows), min(k, columns)

    def points(self, of: Side = "a", **call: Unpack[Call]) -> MappedPoints:
        """Where the vertices of the surface `of`, "a" or "b", are mapped to: points inside faces of the other."""
        with running(call):
            return self._mapped(_side("of", of), "vertices")

    def _mapped(self, of: Side, elements: str) -> MappedPoints:
        key = f"{elements} of {of}"
        if key not in self._points:
            self._points[key] = self._found(of, elements == "faces", None)
        return self._points[key]

    def _found(self, of: Side, faces: bool, corners: Floats | None) -> MappedPoints:
        a, b = (shape._inner for shape in self._shapes)
        functional, pairs = straight(self._functional), self._landmarks
        found = _canonform.map_points(a, b, functional, pairs, self._partners, of == "b", faces, corners, self._settings)
        return MappedPoints(*found)

    def _corners(self, of: Side, values: Floats) -> Floats:
        """Values at the corners of faces, shape (n_faces, 3, d), at those of the other surface."""
        if self.part:
            raise OptionError("values of corners are not carried between a part and a whole; give them by vertex")
        points = self._found(of, True, straight(values.reshape(-1, values.shape[2])))
        found: Floats = (values[points.faces] * points.weights[:, :, None]).sum(axis=1)
        return found.reshape(-1, 3, values.shape[2])

    def transfer(self, values: ArrayLike, to: Side = "b", **call: Unpack[Call]) -> NDArray[Any]:
        """Carry values from one surface to the other: from `a` to `b`, or back with `to="a"`.

        Args:
            values: One row for each vertex of the surface that they come from, or one for each of its faces, or values at the corners of
                the faces: shape (n_faces, 3, d). Fractional numbers at vertices are interpolated inside faces. Texture coordinates belong
                to corners: no face takes them from both sides of a seam. Everything else is a label, such as the number or name of a
                segment: the label of the largest weight, or that of the face.
            to: The surface that they go to. The result has a row for each of its vertices or faces, or values at its corners. Of those
                that the repair dropped, numbers are NaN or -1, and other labels are empty.
        """
        with running(call):
            return self._carried(values, _side("to", to))

    def _carried(self, values: ArrayLike, at: Side) -> NDArray[Any]:
        source = self._shapes[1 if at == "a" else 0]
        array = np.asarray(unmasked("values", values))
        n = len(array) if array.ndim else 0
        if array.ndim == 3 and array.shape[:2] == (source.n_faces, 3):
            return self._corners(at, array.astype(np.float64))
        if n == source.n_vertices:
            points = self._mapped(at, "vertices")
            if array.dtype.kind == "f":
                return points.interpolate(array)
            return _labels(array, _majority(array, points), points.faces < 0)
        if n == source.n_faces and n:
            points = self._mapped(at, "faces")
            return _labels(array, points.faces, points.faces < 0)
        raise OptionError(
            f"values have {n} rows, but the surface that they come from has {source.n_vertices} vertices and "
            f"{source.n_faces} faces; give one row for each vertex or for each face, or the shape ({source.n_faces}, 3, d)"
        )

    def inverse(self, **call: Unpack[Call]) -> SurfaceMap:
        """The same map from `b` to `a`. A vertex of `b` has the confidence of its partner."""
        if self._partners is None:
            points = self.points("b", **call)
            heaviest = np.nan_to_num(points.weights, nan=-1.0).argmax(axis=1)
            vertices = np.where(points.faces < 0, -1, points.corners[np.arange(len(points)), heaviest])
            partners = None
        else:
            partners = self._partners[::-1]
            vertices = partners[0]
        report = {**self._report(), "part": {"part": _OTHER[self.part]} if self.part else {}}
        confidence = np.where(vertices < 0, 0.0, self.vertex_confidence[vertices])
        arrays = (vertices, confidence, self._functional.T.copy(), partners)
        back = SurfaceMap(report, [arrays], self._shapes[::-1], self._landmarks[:, ::-1].copy(), self._settings)
        back.alternative = self.alternative.inverse() if self.alternative else None
        return back

    def then(self, next: SurfaceMap) -> SurfaceMap:
        """This map from `a` to `b`, followed by one from `b` to `c`. Its confidence is the product of both; its distortion is at most
        their sum, which stands for it. `next` begins on `b`.

        Raises `OptionError` if the maps do not share a surface, or one is of a part.
        """
        middle, start = self._shapes[1], next._shapes[0]
        if middle.n_vertices != start.n_vertices:
            raise OptionError(f"the first map ends on {middle.n_vertices} vertices, and the next starts on {start.n_vertices}; they must share a surface")
        if self.part or next.part:
            raise OptionError("maps of parts cannot be followed by others; index `vertices` of one with those of the other")
        known = self.vertices >= 0
        vertices = np.where(known, next.vertices[self.vertices], -1)
        confidence = np.where(known, self.vertex_confidence * next.vertex_confidence[self.vertices], 0.0)
        k = min(len(self._functional), len(next._functional))
        functional = self._functional[:k, :k] @ next._functional[:k, :k]
        kinds = {self.kind, next.kind}
        kind = "unoriented" if "unoriented" in kinds else "mirrored" if len(kinds) == 2 else "direct"
        report = {
            "kind": kind,
            "distortion": self.distortion + next.distortion,
            "agreement": None if self.agreement is None or next.agreement is None else self.agreement * next.agreement,
            "confidence": self.confidence * next.confidence,
        }
        shapes, landmarks = (self._shapes[0], next._shapes[1]), np.empty((0, 2), dtype=np.int64)
        return SurfaceMap(report, [(vertices, confidence, functional, None)], shapes, landmarks, self._settings)

    def _colors(self, colors: NDArray[np.uint8]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Colors of the first surface, and those that the map carries to the second: gray where it is not to be relied on."""
        doubt = np.clip(1.5 - self.vertex_confidence / _DOUBTFUL, 0, 1)
        source: Floats = colors + (_GRAY - colors.astype(np.float64)) * doubt[:, None] + 0.0
        return source, np.nan_to_num(self.transfer(source), nan=_GRAY)

    def _report(self) -> dict[str, Any]:
        return {name: getattr(self, name) for name in ("kind", "distortion", "agreement", "confidence")}

    def __repr__(self) -> str:
        return f"SurfaceMap({self.kind!r}, distortion={self.distortion:.4f})"


def _side(name: str, value: Any) -> Side:
    if value not in ("a", "b"):
        raise OptionError(f"{name}={value!r} is not possible: give \"a\" or \"b\"")
    return value


def _majority(labels: NDArray[Any], points: MappedPoints) -> Ints:
    """For each point, a corner whose label has the largest weight."""
    _, classes = np.unique(labels, return_inverse=True, axis=0 if labels.ndim > 1 else None)
    of = classes.reshape(len(labels))[points.corners]
    weights = np.nan_to_num(points.weights)
    sums = ((of[:, :, None] == of[:, None, :]) * weights[:, None, :]).sum(axis=2)
    return np.take_along_axis(points.corners, sums.argmax(axis=1)[:, None], axis=1)[:, 0]


def _labels(labels: NDArray[Any], rows: Ints, missing: NDArray[np.bool_]) -> NDArray[Any]:
    found: NDArray[Any] = labels[rows]
    if missing.any():
        kind = labels.dtype.kind
        if kind in "bu":
            found = found.astype(np.int64)
        found[missing] = np.nan if kind == "f" else -1 if kind in "biu" else "" if kind in "US" else None
    return found


class Match(Stored):
    """The maps from one surface to another: the direct one first, unless it distorts distances clearly more.

    Attributes:
        maps: At most two maps, of different kinds.
        seconds: The time of the search, after both surfaces were prepared.
    """

    def __init__(
        self,
        report: dict[str, Any],
        arrays: list[list[_Arrays | None]],
        colors: NDArray[np.uint8],
        shapes: tuple[Surface, Surface],
        landmarks: Ints,
        settings: dict[str, Any],
    ) -> None:
        found = zip(report["maps"], arrays, strict=True)
        self.maps = [SurfaceMap(*entry, shapes, landmarks, settings) for entry in found]
        self.seconds: float = report["seconds"]
        self._colors = colors
        self._shapes = shapes

    @property
    def best(self) -> SurfaceMap:
        """The first of the maps."""
        return self.maps[0]

    def pictures(self, **look: Unpack[Look]) -> list[bytes]:
        """PNG files: the first surface in colors, and the second in the colors that each map carries to it; gray where the map is
        not to be relied on. The keywords are those of `Look`."""
        a, b = self._shapes
        colors = [m._colors(self._colors) for m in self.maps]
        both = [(a, colors[0][0]), *((b, target) for _, target in colors)]
        return [drawn(shape.vertices, shape.faces, None, {**look, "colors": paint}) for shape, paint in both]

    def picture(self, kind: MapKind | None = None, *, n_lines: int = 0, **look: Unpack[Look]) -> bytes:
        """A PNG file of both surfaces side by side, in the colors that a map carries from the first to the second.

        Args:
            kind: The kind of the map, by default that of `best`.
            n_lines: How many vertices, spread evenly, are joined to their partners by lines.
            look: Other keywords of `Look`; the picture is twice as wide as high by default.

        >>> found.picture(n_lines=4, width=80)[1:4]
        b'PNG'
        """
        chosen = [m for m in self.maps if kind in (None, m.kind)]
        if not chosen:
            raise OptionError(f"kind={kind!r} is not possible: the maps are {' and '.join(m.kind for m in self.maps)}")
        (a, b), [source, target] = self._shapes, chosen[0]._colors(self._colors)
        right = to_the_right(look)
        spans = [np.ptp(shape.vertices[np.unique(shape.faces)] @ right) for shape in (a, b)]
        ends = [f(shape.vertices[np.unique(shape.faces)] @ right) for f, shape in ((np.max, a), (np.min, b))]
        moved = b.vertices + (ends[0] - ends[1] + 0.15 * max(spans)) * right
        from_a = a.farthest_points(n_lines) if n_lines else np.empty(0, dtype=np.int64)
        to_b = chosen[0].vertices[from_a]
        joined = [(i, j) for i, j in zip(from_a, to_b, strict=True) if j >= 0]
        lines = [(np.stack([a.vertices[i], moved[j]]), "#" + bytes(source[i].astype(np.uint8)).hex()) for i, j in joined]
        vertices = np.concatenate([a.vertices, moved])
        faces = np.concatenate([a.faces, b.faces + a.n_vertices])
        usual: Look = {"width": 1200, "height": 600, "paths": lines, "thickness": 0.4}
        return drawn(vertices, faces, None, {**usual, **look, "colors": np.concatenate([source, target])})

    def __repr__(self) -> str:
        return f"Match({', '.join(map(repr, self.maps))})"

    def _repr_html_(self) -> str:
        titles = ["the first, in colors", *(f"the second, {m.kind} map" for m in self.maps)]
        shown = zip(self.pictures(width=440, height=440), titles, strict=True)
        rows = [(m.kind, f"distortion {m.distortion:.4f}") for m in self.maps]
        return _html.card("Match", rows, [_html.image(png, title=title) for png, title in shown])


def match(
    a: AnyMesh,
    b: AnyMesh,
    *,
    landmarks: ArrayLike | None = None,
    initial: ArrayLike | tuple[ArrayLike, Eigenbasis, Eigenbasis] | None = None,
    refine: bool = True,
    descriptors: tuple[ArrayLike, ArrayLike] | None = None,
    n_eigenfunctions: int | None = None,
    geodesic: Geodesic = "fast-marching",
    **call: Unpack[Call],
) -> Match:
    """Map the vertices of `a` to those of `b`: surfaces, mesh files, or meshes in memory.

    Shapes that are alike under a mirror, as animals are, have two maps: the direct one takes the left side to the left side, the
    mirrored one to the right side. Both are found. Each surface is prepared once, and kept.

    Args:
        landmarks: Known pairs: rows of a vertex of `a` and one of `b`. They choose the map, which contains them; contradictory ones are
            refused. One ear is enough to tell left from right.
        initial: A map to start from: for each vertex of `a`, its partner on `b`, or -1; or a functional map, as `SurfaceMap.functional`
            writes it, and the bases of `a` and `b` that it is written in. It is refined, and comes out unless another map is clearly
            better.
        refine: With `False`, the initial map comes out as it is, with its distortion and its confidence beside the best map that is found.
        descriptors: Functions that correspond, beside those that are computed: an array for each surface, one row for each vertex and one
            column for each function.
        n_eigenfunctions: Most eigenfunctions of each surface that the map is refined with, 150 by default.
        geodesic: As in `Surface.distances`.

    Raises `OptionError` if an option is not possible, or landmarks contradict each other.

    >>> canonform.match(cat, other, n_eigenfunctions=30, landmarks=[[0, 0]]).best.vertices.shape
    (1000,)
    """
    eigenfunctions = some_whole("n_eigenfunctions", n_eigenfunctions)
    settings = options_of(eigenfunctions=eigenfunctions, geodesic=geodesic)
    if not refine and initial is None:
        raise OptionError("refine=False scores a map that is given; give it as initial=")
    none = landmarks is None or not np.size(landmarks)
    pairs: Ints = numeric("landmarks", np.empty((0, 2), dtype=np.int64) if none else landmarks, ("k", 2), np.int64)
    start, functions = _partners(initial), _functions(descriptors)
    with running(call):
        a, b = surface_of(a), surface_of(b)
        found, arrays, colors = _canonform.match_surfaces(a._inner, b._inner, pairs, start, functions, bool(refine), settings)
    return Match(json.loads(found), arrays, colors, (a, b), pairs, settings)


# Vertices of a functional map that are given partners; its refinement starts from no more samples.
_MOST_PARTNERS = 2000


def _partners(initial: ArrayLike | tuple[ArrayLike, Eigenbasis, Eigenbasis] | None) -> Ints | None:
    if initial is None:
        return None
    if isinstance(initial, tuple) and len(initial) == 3 and isinstance(initial[1], Eigenbasis):
        functional, a, b = initial
        return _of_functional(numeric("initial", functional, ("k", "l")), a, b)
    return numeric("initial", initial, ("n",), np.int64)


def _functions(descriptors: tuple[ArrayLike, ArrayLike] | None) -> tuple[Floats, Floats] | None:
    if descriptors is None:
        return None
    if len(descriptors) != 2:
        raise OptionError("descriptors must be two arrays, one for each surface, with one row for each vertex")
    one = [functions if np.ndim(functions) != 1 else np.reshape(functions, (-1, 1)) for functions in descriptors]
    f, g = (numeric("descriptors", functions, ("n", "d")) for functions in one)
    return f, g


def _of_functional(functional: Floats, a: Eigenbasis, b: Eigenbasis) -> Ints:
    """The vertices of `b` nearest to vertices of `a` in the space of the eigenfunctions (Ovsjanikov et al. 2012)."""
    rows, columns = functional.shape if functional.ndim == 2 else (0, 0)
    if not (0 < rows <= len(a.values) and 0 < columns <= len(b.values)):
        counts = f"{len(a.values)} and {len(b.values)}"
        raise OptionError(f"the functional map has the shape {functional.shape}, but the bases of a and b have {counts} functions")
    targets = b.functions[:, :columns]
    sq_lengths = np.where(np.isnan(targets[:, 0]), np.inf, (targets**2).sum(axis=1))
    known = np.flatnonzero(~np.isnan(a.functions[:, 0]))
    some = known[np.unique(np.linspace(0, len(known) - 1, min(len(known), _MOST_PARTNERS)).astype(np.int64))]
    places = a.functions[some, :rows] @ functional
    found = np.full(len(a.masses), -1, dtype=np.int64)
    found[some] = (sq_lengths - 2 * places @ np.nan_to_num(targets).T).argmin(axis=1)
    return found
