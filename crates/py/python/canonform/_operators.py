"""What is computed on surfaces: eigenfunctions, kernels, nearest points, and points as objects."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Floats, Ints, VertexValues, numbers, numeric, on_vertices
from ._settings import number, whole
from ._stored import AsArray, ByValue
from .errors import OptionError


@dataclass(frozen=True)
class EdgePoint:
    """A point of an edge. It may stand wherever a vertex may, as a source or a target.

    Attributes:
        start: The vertex at one end.
        end: The vertex at the other.
        t: Where the point is, from 0 at the start to 1 at the end.
    """

    start: int
    end: int
    t: float = 0.5

    def __str__(self) -> str:
        return f"{self.start}-{self.end}@{self.t!r}"


@dataclass(frozen=True)
class FacePoint:
    """A point of a face. It may stand wherever a vertex may, as a source or a target.

    Attributes:
        face: The face.
        weights: Weights of the corners of the face, in their order: not negative, with a positive sum.

    >>> cat.path(0, canonform.FacePoint(8, (2, 1, 1))).at[-1]
    FacePoint(face=8, weights=(2.0, 1.0, 1.0))
    """

    face: int
    weights: tuple[float, float, float] = (1.0, 1.0, 1.0)

    def __str__(self) -> str:
        return f"f{self.face}@{':'.join(repr(float(weight)) for weight in self.weights)}"


def face_points(faces: Ints, weights: Floats) -> list[FacePoint]:
    """Points of faces, by the weights of their corners."""
    return [FacePoint(face, (u, v, w)) for face, (u, v, w) in zip(faces.tolist(), weights.tolist(), strict=True)]


def parsed(text: str) -> int | EdgePoint | FacePoint:
    """The point that text stands for."""
    place, _, share = text.partition("@")
    if place.startswith("f"):
        a, b, c = (float(weight) for weight in (share or "1:1:1").split(":"))
        return FacePoint(int(place[1:]), (a, b, c))
    if "-" in place:
        start, end = place.split("-")
        return EdgePoint(int(start), int(end), float(share or 0.5))
    return int(place)


@dataclass(frozen=True, repr=False, eq=False)
class ClosestPoints(AsArray, ByValue):
    """The points of a surface that are nearest to points in space. `numpy.asarray` gives them.

    Attributes:
        points: Shape (k, 3), in mesh units.
        distances: How far they are, in mesh units: shape (k,).
        faces: The face that each lies in: shape (k,).
        weights: The weights of the corners of that face: shape (k, 3).
    """

    points: Floats
    distances: Floats
    faces: Ints
    weights: Floats

    @property
    def at(self) -> list[FacePoint]:
        """The points as sources of distances and ends of paths."""
        return face_points(self.faces, self.weights)

    def __repr__(self) -> str:
        return f"ClosestPoints({len(self)} points)"


@dataclass(frozen=True, repr=False, eq=False)
class Eigenbasis(ByValue):
    """The smoothest functions on a surface: `laplacian @ functions == mass @ functions * values`.

    Attributes:
        values: Eigenvalues, ascending from 0, in one over squared mesh units: shape (k,).
        functions: Eigenfunctions as columns, orthonormal with the areas around vertices: shape (n, k). NaN for vertices that the repair
            dropped.
        masses: The area around each vertex, in squared mesh units: shape (n,).
    """

    values: Floats
    functions: VertexValues
    masses: Floats

    @cached_property
    def _weighted(self) -> Floats:
        return np.nan_to_num(self.functions.view(np.ndarray)) * self.masses[:, None]

    def project(self, values: ArrayLike) -> Floats:
        """The coefficients in this basis, shape (k,) or (k, d), of functions with these `values`, shape (n,) or (n, d).

        >>> basis = cat.eigenbasis(20)
        >>> basis.project(basis.functions[:, 3]).round(6).tolist()[2:5]
        [0.0, 1.0, 0.0]
        """
        array = numeric("values", values, (len(self.masses), "d")[: max(np.ndim(values), 1)])
        known = np.where(self.functions.valid.reshape(-1, *[1] * (array.ndim - 1)), array, 0)
        return self._weighted.T @ known

    def synthesize(self, coefficients: ArrayLike) -> VertexValues:
        """The functions of `coefficients`, shape (k,) or (k, d), at the vertices.

        >>> basis = cat.eigenbasis(20)
        >>> bool(np.allclose(basis.synthesize(np.eye(20)[3]), basis.functions[:, 3]))
        True
        """
        return on_vertices(self.functions.view(np.ndarray) @ numeric("coefficients", coefficients, (len(self), "d")[: max(np.ndim(coefficients), 1)]))

    def hks(self, times: ArrayLike | None = None, *, n_times: int = 16, scaled: bool = False) -> VertexValues:
        """The heat kernel signature of every vertex (Sun et al. 2009), shape (n_vertices, number of times).

        Args:
            times, n_times: In squared mesh units; by default `n_times` of them, from the time of the last eigenfunction to that of the
                first.
            scaled: Whether to divide each column by the trace of the kernel at that time, so that all times count alike.
        """
        curved = self._curved()
        if times is None:
            first, last = (float(4 * np.log(10) / value) for value in curved[[-1, 0]])
            times = np.geomspace(first, last, whole("n_times", n_times, 1))
        return self._spread(np.exp(-np.multiply.outer(self.values, numbers("times", times, 0))), scaled)

    def wks(
        self, energies: ArrayLike | None = None, *, n_energies: int = 100, sigma: float | None = None, scaled: bool = True
    ) -> VertexValues:
        """The wave kernel signature of every vertex (Aubry et al. 2011), shape (n_vertices, number of energies).

        Args:
            energies, n_energies: Logarithms of eigenvalues; by default `n_energies` of them, evenly spaced from the lowest of the basis
                plus 2 `sigma` to the highest minus 2 `sigma`.
            sigma: Width of the bands of energy; by default 7 times the range of the logarithms over their number, as published.
            scaled: Whether to divide each column by the sum of the weights of its eigenfunctions, as published.

        Raises `OptionError` if bands are wider than the spectrum, or all functions are constant.
        """
        curved = self._curved()
        low, high = np.log(curved[[0, -1]])
        given = None if energies is None else numbers("energies", energies)
        n = whole("n_energies", n_energies, 1) if given is None else len(given)
        width = 7 * (high - low) / n if sigma is None else number("sigma", sigma)
        if not 0 < width < np.inf:
            raise OptionError(f"sigma={width:g} is not possible: give a positive number, or more eigenfunctions")
        if given is None and 4 * width >= high - low:
            what = f"n_energies={n}" if sigma is None else f"sigma={sigma:g}"
            raise OptionError(f"{what} makes bands that are wider than the spectrum; give 29 energies or more, a smaller sigma=, or energies=")
        at = np.linspace(low + 2 * width, high - 2 * width, n) if given is None else given
        # The constant functions say nothing.
        logarithms = np.log(np.where(self._is_curved, self.values, 1.0))
        weights = np.exp(-0.5 * ((at[None, :] - logarithms[:, None]) / width) ** 2)
        return self._spread(np.where(self._is_curved[:, None], weights, 0.0), scaled)

    @property
    def _is_curved(self) -> Floats:
        return self.values * self.masses.sum() > 1e-6

    def _curved(self) -> Floats:
        curved: Floats = self.values[self._is_curved]
        if not len(curved):
            raise OptionError(f"n_eigenfunctions={len(self.values)} is not possible here: kernels need an eigenfunction that is not constant")
        return curved

    def _spread(self, weights: Floats, scaled: bool) -> VertexValues:
        weights = weights / weights.sum(axis=0) if scaled else weights
        return on_vertices(self.functions.view(np.ndarray) ** 2 @ weights, writeable=False)

    def first(self, n_eigenfunctions: int) -> Eigenbasis:
        """The first `n_eigenfunctions` of its functions."""
        n = whole("n_eigenfunctions", n_eigenfunctions, 1)
        return Eigenbasis(self.values[:n], self.functions[:, :n].view(VertexValues), self.masses)

    def __len__(self) -> int:
        return len(self.values)

    def __repr__(self) -> str:
        return f"Eigenbasis({len(self.masses)} vertices, {len(self)} functions)"
