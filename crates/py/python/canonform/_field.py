"""All pairs of distances in little memory, with bounds."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _canonform
from ._arrays import Floats, Ints, numeric
from ._settings import Call, number, running, whole
from ._stored import AsArray, ByValue, Constant
from .errors import PointError


@dataclass(frozen=True)
class PairDistance:
    """The distance of two vertices, with bounds, in mesh units.

    Attributes:
        distance, lower, upper, exact: As in `PairDistances`.
    """

    distance: float
    lower: float
    upper: float
    exact: bool


@dataclass(frozen=True, repr=False, eq=False)
class PairDistances(AsArray, ByValue):
    """The distances of several pairs, with bounds: arrays of one number for each pair, in mesh units.

    `numpy.asarray(distances)` gives the distances.

    Attributes:
        distance: The estimates, between the bounds; NaN if the repair dropped one of the vertices, and so are the bounds.
        lower: No distance is below these.
        upper: No distance is above these.
        exact: Which distances are exact instead of estimates.
    """

    _rows = "distance"

    distance: Floats
    lower: Floats
    upper: Floats
    exact: NDArray[np.bool_]

    @property
    def valid(self) -> NDArray[np.bool_]:
        """The pairs whose vertices are both on the surface: a mask."""
        return np.isfinite(self.distance)

    def __repr__(self) -> str:
        return f"PairDistances({len(self)} pairs, {int(self.exact.sum())} exact)"


class DistanceField(Constant):
    """The distances between all pairs of vertices of a surface, in a few hundred bytes per vertex, with bounds.

    Made by `Surface.distance_field`, or read from a file by `DistanceField.load`. A file is that of the command line.
    """

    def __init__(self, inner: _canonform.DistanceField) -> None:
        self._inner = inner

    def _state(self) -> dict[str, Any]:
        return {"bytes": self._inner.to_bytes()}

    def _restore(self, state: dict[str, Any]) -> None:
        self._inner = _canonform.DistanceField.from_bytes(state["bytes"])

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> DistanceField:
        """Read a field from the file `path`.

        >>> cat.distance_field(20).save("cat.field")
        >>> canonform.DistanceField.load("cat.field").n_vertices
        1000
        """
        return cls(_canonform.DistanceField.open(os.fspath(path)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the field to the file `path`."""
        self._inner.save(os.fspath(path))

    @property
    def n_vertices(self) -> int:
        """Number of vertices of the input."""
        return self._inner.n_vertices

    @property
    def landmarks(self) -> Ints:
        """The landmarks: vertices of the input."""
        return self._inner.landmarks()

    @property
    def facts(self) -> dict[str, Any]:
        """How the field was built, and what its bounds rest on: the object that `canonform field info --json` prints."""
        return json.loads(self._inner.facts())

    @property
    def certified(self) -> bool:
        """Whether the bounds rest on exact distances alone, so that no distance can lie outside."""
        return bool(self.facts["bounds"]["kind"] == "certified")

    def pair(self, a: int, b: int) -> PairDistance:
        """The distance of two vertices, `a` and `b`, estimated."""
        found = self.pairs([[a, b]], tolerance=None)
        return PairDistance(*(values[0].item() for values in (found.distance, found.lower, found.upper, found.exact)))

    def pairs(
        self, pairs: ArrayLike, *, tolerance: float | None = 0.05, **call: Unpack[Call]
    ) -> PairDistances:
        """The distances of many pairs of vertices, in parallel.

        Args:
            pairs: Vertex numbers, shape (k, 2).
            tolerance: Pairs whose bounds are farther apart than this share of the distance are finished by exact propagation on the
                surface. None finishes no pair.
        """
        array: Ints = numeric("pairs", pairs, ("k", 2), np.int64, PointError) if np.size(pairs) else np.empty((0, 2), dtype=np.int64)
        with running(call):
            return PairDistances(*self._inner.pairs(array, _share(tolerance)))

    def row(self, source: int, *, tolerance: float | None = 0.05, **call: Unpack[Call]) -> PairDistances:
        """The distances from one vertex, `source`, to all, in the order of the input; `tolerance` as in `pairs`."""
        with running(call):
            return PairDistances(*self._inner.row(source, _share(tolerance)))

    def nearest(self, source: int, k: int, **call: Unpack[Call]) -> tuple[Ints, Floats]:
        """The `k` vertices nearest to the vertex `source` along the surface, itself left out, and their exact distances, nearest first.

        >>> vertices, distances = cat.distance_field(20).nearest(0, 5)
        >>> len(vertices), bool((np.diff(distances) >= 0).all())
        (5, True)
        """
        with running(call):
            return self._inner.nearest(source, whole("k", k))

    def __repr__(self) -> str:
        facts = self.facts
        bounds = facts["bounds"]["kind"]
        return f"DistanceField({facts['n_vertices']} vertices, {facts['n_landmarks']} landmarks, {bounds} bounds)"


def _share(tolerance: float | None) -> float | None:
    return None if tolerance is None else number("tolerance", tolerance, 0)
