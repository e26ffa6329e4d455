"""Maps between two surfaces."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _canonform, _html
from ._arrays import Floats, Ints
from ._settings import DistanceMethod, Progress, encoded, shown
from ._stored import Stored
from ._surface import AnyMesh, Surface, surface_of


class SurfaceMap(Stored):
    """A map from the vertices of one surface to those of another.

    Attributes
    ----------
    vertices
        For each vertex of the first surface, its partner on the second, or -1 if the repair dropped the vertex; shape (n,).
    kind
        "direct" if the map keeps the orientation, "mirrored" if it reverses it, "unoriented" if a surface has none.
    distortion
        The mean change of distances, as a share of the square root of the area.
    agreement
        How far the map keeps the orientation, from -1 to 1; `None` if a surface cannot be oriented.
    confidence
        How likely this map is the right one of its kind, and not the next best; below 0.7 it is uncertain.
    alternative
        The next best map of this kind, if this one is uncertain: front and back may be exchanged.
    """

    def __init__(self, report: dict[str, Any], arrays: list[tuple[Ints, Floats] | None]) -> None:
        assert arrays[0] is not None
        self.vertices, self._functional = arrays[0]
        self.kind: str = report["kind"]
        self.distortion: float = report["distortion"]
        self.agreement: float | None = report["agreement"]
        self.confidence: float = report["confidence"]
        other = arrays[1] if len(arrays) > 1 else None
        self.alternative: SurfaceMap | None = SurfaceMap(report["alternative"], [other]) if other is not None else None

    def functional(self, k: int | None = None) -> Floats:
        """The map of functions, shape (k, k): column j has the coefficients of the j-th eigenfunction of the second surface,
        pulled back to the first, in the eigenfunctions of the first. `k` is at most 150, the default."""
        most = len(self._functional)
        if k is None:
            k = most
        if not 1 <= k <= most:
            raise ValueError(f"k is {k}; the map has {most} eigenfunctions")
        return self._functional[:k, :k].copy()

    def carry(self, values: ArrayLike) -> NDArray[Any]:
        """Values at the vertices of the second surface, carried to those of the first; NaN where there is no partner."""
        carried: NDArray[Any] = np.asarray(values)[self.vertices]
        if (missing := self.vertices < 0).any():
            carried = carried.astype(np.result_type(carried.dtype, np.float64))
            carried[missing] = np.nan
        return carried

    def __repr__(self) -> str:
        return f"SurfaceMap({self.kind!r}, distortion={self.distortion:.4f})"


class Match(Stored):
    """The maps from one surface to another: the direct one first, unless it distorts distances clearly more.

    Attributes
    ----------
    maps
        At most two maps, of different kinds.
    seconds
        The time of the search, after both surfaces were prepared.
    """

    def __init__(
        self,
        report: dict[str, Any],
        arrays: list[list[tuple[Ints, Floats] | None]],
        colors: NDArray[np.uint8],
        shapes: tuple[Surface, Surface],
    ) -> None:
        self.maps = [SurfaceMap(*entry) for entry in zip(report["maps"], arrays, strict=True)]
        self.seconds: float = report["seconds"]
        self._colors = colors
        self._shapes = shapes

    @property
    def best(self) -> SurfaceMap:
        """The first of the maps."""
        return self.maps[0]

    def pictures(self, *, width: int = 600, height: int = 600) -> list[bytes]:
        """PNG files: the second surface in colours, and the first in the same colours under each map."""
        a, b = self._shapes
        colors = [np.where((m.vertices < 0)[:, None], np.uint8(160), self._colors[m.vertices]) for m in self.maps]
        first = [_html.picture(a.vertices, a.faces, None, (width, height), shades) for shades in colors]
        return [_html.picture(b.vertices, b.faces, None, (width, height), self._colors), *first]

    def __repr__(self) -> str:
        return f"Match({', '.join(map(repr, self.maps))})"

    def _repr_html_(self) -> str:
        titles = ["the second, in colours", *(f"the first, {m.kind} map" for m in self.maps)]
        shown = zip(self.pictures(width=440, height=440), titles, strict=True)
        rows = [(m.kind, f"distortion {m.distortion:.4f}") for m in self.maps]
        return _html.card("Match", rows, [_html.image(png, title=title) for png, title in shown])


def match(
    a: AnyMesh,
    b: AnyMesh,
    *,
    eigenfunctions: int | None = None,
    n: int | str = 100,
    geodesic: DistanceMethod = "fast-marching",
    timeout: float | None = None,
    memory: int | str | None = None,
    progress: Progress = False,
) -> Match:
    """Map the vertices of `a` to those of `b`: surfaces, mesh files, or meshes in memory.

    Shapes that are alike under a mirror, as animals are, have two maps: the direct one takes the left side to the left side, the
    mirrored one to the right side. Both are found. Each surface is prepared once, and kept.

    Parameters
    ----------
    eigenfunctions
        Most eigenfunctions of each surface that the map is refined with.
    n, geodesic
        How the canonical forms are made whose alignments the search starts from, as in `Surface.canonical_form`.
    """
    settings = encoded(eigenfunctions=eigenfunctions, n=n, geodesic=geodesic, timeout=timeout, memory=memory)
    a, b = surface_of(a), surface_of(b)
    with shown(progress) as report:
        found, vertices, colors = _canonform.match_surfaces(a._inner, b._inner, settings, report)
    return Match(json.loads(found), vertices, colors, (a, b))
