"""Methods with options of their own, for `method=` and `geodesic=`. The name of a method stands for its defaults."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, ClassVar, TypeAlias

from . import _canonform
from ._settings import Bandwidth, DistanceName, EmbeddingName, Obtuse, Regularization, Sampling, Update, n_bytes


class Options:
    """Options of a method."""

    _of: ClassVar[str]
    _name: ClassVar[str]

    def __post_init__(self) -> None:
        _canonform.check_options(self.settings())

    def settings(self) -> dict[str, Any]:
        """The method and its options as keywords."""
        return {self._of: self._name, **{field.name: getattr(self, field.name) for field in fields(self)}}  # type: ignore[arg-type]

    def __repr__(self) -> str:
        given = [field for field in fields(self) if getattr(self, field.name) != field.default]  # type: ignore[arg-type]
        return f"{type(self).__name__}({', '.join(f'{field.name}={getattr(self, field.name)!r}' for field in given)})"


@dataclass(frozen=True, kw_only=True, repr=False)
class FastMarching(Options):
    """`geodesic="fast-marching"` with options.

    Attributes:
        update: The local solver: "virtual-source" or "planar".
        obtuse: What happens to angles wider than 90 degrees: "flip", "unfold" or "ignore".

    >>> distances = cat.distances(0, geodesic=canonform.FastMarching(obtuse="ignore"))
    >>> bool(abs(distances - cat.distances(0, geodesic="exact")).max() < 0.02 * distances.max())
    True
    """

    _of = "geodesic"
    _name = "fast-marching"

    update: Update = "virtual-source"
    obtuse: Obtuse = "flip"


@dataclass(frozen=True, kw_only=True, repr=False)
class _Sampled(Options):
    _of = "method"

    sampling: Sampling = "farthest"
    first: int | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class _Regularized(_Sampled):
    regularization: Regularization = "low-rank"
    rank: int | None = None
    alpha: float | str | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Nystrom(_Regularized):
    """`method="nmds"` with options: Nystrom multidimensional scaling, the default.

    Attributes:
        regularization: How the matrix of the landmarks is inverted: "low-rank" keeps `rank` eigenvalues, "cur" as many columns, "rpi" damps
            small eigenvalues by `alpha`, and "none" keeps all.
        rank: Of "low-rank" and "cur"; by default half the landmarks, at least `n_components` + 4.
        alpha: Of "rpi": alpha over the fourth power of the largest eigenvalue, by default 1e-10, or "paper" for the third power of that
            eigenvalue, which depends on the unit of length.
        sampling: How landmarks are chosen: "farthest", each the farthest from those before it; "random", "min-variance" or "max-variance".
        first: The first landmark, a vertex. By default the one farthest from vertex 0; with other samplings it is drawn with the seed.
    """

    _name = "nmds"


@dataclass(frozen=True, kw_only=True, repr=False)
class Landmark(_Sampled):
    """`method="landmark"` with options: landmarks by classical scaling, all others by their distances to them.

    Attributes:
        sampling, first: How landmarks are chosen, see `Nystrom`.
    """

    _name = "landmark"


@dataclass(frozen=True, kw_only=True, repr=False)
class Spectral(_Sampled):
    """`method="spectral"` with options: distances between landmarks, smooth in eigenfunctions of the surface.

    Attributes:
        n_eigenfunctions: Number of eigenfunctions of the Laplacian.
        mu: Weight of the distances against smoothness, for a surface of unit area; `math.inf` fits the distances exactly.
        sampling, first: How landmarks are chosen, see `Nystrom`.
    """

    _name = "spectral"

    n_eigenfunctions: int = 300
    mu: float = 1000.0


@dataclass(frozen=True, kw_only=True, repr=False)
class KernelPca(_Sampled):
    """`method="kpca"` with options: kernel PCA with the Nystrom method.

    Attributes:
        sigma: Width of the kernel: "mean", "median" or "max" of the measured distances, or a length in mesh units.
        rank: Eigenpairs of the kernel of the landmarks to keep, by default half.
        sampling, first: How landmarks are chosen, see `Nystrom`.
    """

    _name = "kpca"

    sigma: Bandwidth = "mean"
    rank: int | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Smacof(_Regularized):
    """`method="smacof"` with options: SMACOF on all pairs, from the result of "nmds".

    Attributes:
        max_iterations: Most steps.
        tolerance: The last step reduces the stress by less than this share.
        regularization, rank, alpha, sampling, first: Of the start, see `Nystrom`.
    """

    _name = "smacof"

    max_iterations: int = 300
    tolerance: float = 1e-6


Embedding: TypeAlias = EmbeddingName | Nystrom | Landmark | Spectral | KernelPca | Smacof
"""How distances become coordinates."""

Geodesic: TypeAlias = DistanceName | FastMarching
"""How distances are measured."""


def options_of(**arguments: Any) -> dict[str, Any]:
    """Arguments of a call, with the options of methods beside their names."""
    given: dict[str, Any] = {}
    for name, value in arguments.items():
        given |= value.settings() if isinstance(value, Options) and value._of == name else {name: value}
    return given if given.get("memory") is None else {**given, "memory": n_bytes(given["memory"])}
