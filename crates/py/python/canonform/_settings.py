"""Keyword arguments on their way to Rust, and progress on its way back."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any, Literal, ParamSpec, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from .errors import OptionError

Progress: TypeAlias = bool | Callable[[str, int, int], None]
"""`True` shows a bar (needs the package tqdm); a function gets the stage, the steps done and all steps."""

# The names that Rust knows; a test compares them.
DistanceName: TypeAlias = Literal["fast-marching", "exact", "heat", "dijkstra", "bfs"]
EmbeddingName: TypeAlias = Literal["nmds", "landmark", "spectral", "kpca", "mds", "smacof"]
Update: TypeAlias = Literal["virtual-source", "planar"]
Obtuse: TypeAlias = Literal["flip", "unfold", "ignore"]
Sampling: TypeAlias = Literal["farthest", "random", "min-variance", "max-variance"]
Regularization: TypeAlias = Literal["low-rank", "rpi", "none", "cur"]
Bandwidth: TypeAlias = Literal["mean", "median", "max"] | float
StressChoice: TypeAlias = Literal["auto", "exact", "estimate", "skip"]
Components: TypeAlias = Literal["largest", "bridge", "error"]
Weld: TypeAlias = Literal["seams", "all", "none"] | float
LaplacianKind: TypeAlias = Literal["intrinsic", "cotangent"]
SignatureKind: TypeAlias = Literal[
    "fused", "form-spectrum", "geodesic-spectrum", "shape-dna", "heat-kernel", "wave-kernel", "rigid"
]
IndexDistance: TypeAlias = Literal["combined", "fused"]
Ranking: TypeAlias = Literal["plain", "graph", "part", "forms"]
RelationKind: TypeAlias = Literal[
    "identical-file", "identical-geometry", "scaled", "mirrored", "noisy", "remeshed",
    "copies", "part-of", "variant", "other-pose", "same-class", "different",
]  # fmt: skip
Family: TypeAlias = Literal[
    "cat", "centaur", "david", "person",
    "worm", "star", "octopus", "spider", "hand", "bird", "dog", "human", "fish", "ring", "ant", "lizard", "tree", "crab",
    "glasses", "snake", "dinosaur", "teddy", "scissors", "giraffe", "tadpole", "turtle", "cup", "pliers", "ape", "key",
    "centipede", "fork",
]  # fmt: skip
MeshFormat: TypeAlias = Literal["off", "obj", "ply", "stl", "vert", "glb", "3mf"]

Landmarks: TypeAlias = int | Literal["auto"]
"""A number of landmarks, or as many as are needed."""

_SIZES = {"": 0, "K": 1, "M": 2, "G": 3, "T": 4}


def whole(name: str, value: Any, least: int = 0) -> int:
    """The whole number that an argument must be."""
    number = value.item() if isinstance(value, np.generic) else value
    if isinstance(number, bool) or not isinstance(number, int) or not least <= number < 2**63:
        raise OptionError(f"{name}={value!r} is not possible: give a whole number, {least} or more")
    return number


def some_whole(name: str, value: Any, least: int = 0) -> int | None:
    """The same, unless it is left out."""
    return None if value is None else whole(name, value, least)


def word(name: str, value: Any) -> str:
    """The text that an argument must be."""
    if not isinstance(value, str):
        raise OptionError(f"{name}={value!r} is not possible: give text")
    return value


def number(name: str, value: Any, least: float = -math.inf) -> float:
    """The number that an argument must be."""
    try:
        found = math.nan if isinstance(value, (bool, np.bool_, np.ma.MaskedArray)) else float(value)
    except (TypeError, ValueError):
        found = math.nan
    if math.isnan(found) or found < least:
        raise OptionError(f"{name}={value!r} is not possible: give a number" + (f", {least:g} or more" if least > -math.inf else ""))
    return found


def unmasked(name: str, values: Any) -> Any:
    """The values, unless some of them are masked: other functions would take what is under the mask."""
    if np.ma.is_masked(values):
        raise OptionError(f"{name} has masked values; fill them in, or leave them out")
    return values


def numbers(name: str, values: Any, least: float = -math.inf) -> NDArray[np.float64]:
    """The finite numbers that an argument must be, one or several, larger than the least one."""
    try:
        found = np.atleast_1d(np.asarray(unmasked(name, values), dtype=np.float64))
    except (TypeError, ValueError):
        found = np.empty(0)
    if found.ndim != 1 or not found.size or not np.isfinite(found).all() or found.min() <= least:
        kind = "finite numbers" if least == -math.inf else f"finite numbers larger than {least:g}"
        raise OptionError(f"{name}={values!r} is not possible: give {kind}")
    return found


def n_bytes(size: int | str) -> int:
    """A memory size such as 2_000_000_000 or "2G", in bytes."""
    if not isinstance(size, str):
        return whole("memory", size)
    text = size.strip().upper().removesuffix("B").removesuffix("I")
    unit = text[-1:] if text[-1:].isalpha() else ""
    number = text.removesuffix(unit)
    if unit not in _SIZES or not number.isdigit():
        raise OptionError(f"memory={size!r} is not possible: give a number of bytes, or text such as \"800M\" or \"2G\"")
    return int(number) << (10 * _SIZES[unit])


_P = ParamSpec("_P")
_R = TypeVar("_R")

_OF_METHODS = {
    "regularization": "method=Nystrom(regularization=...)",
    "rank": "method=Nystrom(rank=...)",
    "alpha": "method=Nystrom(alpha=...)",
    "sampling": "method=Nystrom(sampling=...)",
    "first_sample": "method=Nystrom(first=...)",
    "sigma": "method=KernelPca(sigma=...)",
    "eigenvectors": "method=Spectral(n_eigenfunctions=...)",
    "mu": "method=Spectral(mu=...)",
    "iterations": "method=Smacof(max_iterations=...)",
    "tolerance": "method=Smacof(tolerance=...)",
}

OF_MARCHING = {"update": "geodesic=FastMarching(update=...)", "obtuse": "geodesic=FastMarching(obtuse=...)"}
"""What stands for earlier keywords of distances."""

OF_FORMS = {"n": "n_landmarks=", "dim": "n_components=", **OF_MARCHING, **_OF_METHODS}
"""What stands for earlier keywords of forms."""


def renamed(**forms: str) -> Callable[[Callable[_P, _R]], Callable[_P, _R]]:
    """A call that names what stands for keywords of earlier versions."""

    def checked(call: Callable[_P, _R]) -> Callable[_P, _R]:
        @wraps(call)
        def checking(*args: _P.args, **kwargs: _P.kwargs) -> _R:
            for old in forms.keys() & kwargs.keys():
                raise OptionError(f"{old}= is not possible: use {forms[old]}")
            return call(*args, **kwargs)

        return checking

    return checked


@contextmanager
def shown(progress: Progress) -> Iterator[Callable[[str, int, int], None] | None]:
    """What the Rust side calls to show progress."""
    if callable(progress):
        yield progress
        return
    if not progress:
        yield None
        return
    try:
        from tqdm.auto import tqdm
    except ImportError as missing:
        raise ImportError("progress=True needs the package tqdm (`pip install tqdm`); or pass a function") from missing
    bar: Any = None
    current = ""

    def update(stage: str, done: int, total: int) -> None:
        nonlocal bar, current
        if bar is None or stage != current:
            if bar is not None:
                bar.close()
            bar, current = tqdm(total=total, desc=stage, leave=False), stage
        bar.update(done - bar.n)

    try:
        yield update
    finally:
        if bar is not None:
            bar.close()
