"""Keyword arguments on their way to Rust, and progress on its way back."""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any, Literal, TypeAlias, TypedDict

import numpy as np

from . import _canonform
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


def n_bytes(size: int | str) -> int:
    """A memory size such as 2_000_000_000 or "2G", in bytes."""
    if not isinstance(size, str):
        return whole("memory", size)
    text = size.strip().upper().removesuffix("B").removesuffix("I")
    unit = text[-1:] if text[-1:].isalpha() else ""
    try:
        return whole("memory", int(float(text.removesuffix(unit)) * 2 ** (10 * _SIZES[unit])))
    except (KeyError, ValueError, OverflowError):
        raise OptionError(f"memory={size!r} is not possible: give a number of bytes, or text such as \"800M\" or \"2G\"") from None


class Shown(TypedDict, total=False):
    """Keywords that say how a call runs, and change nothing about its result.

    Attributes:
        progress: True shows a bar (needs the package tqdm); a function gets the stage, the steps done and all steps.
        threads: Number of threads, 0 for all cores; by default that of `set_threads`.
    """

    progress: Progress
    threads: int | None


class Call(Shown, total=False):
    """Keywords of every call that may take long. They change nothing about its result.

    Attributes:
        progress, threads: Whether to show progress, and the number of threads, as in `Shown`.
        timeout: Seconds after which the call ends with `TimeLimitError`.
        memory: Bytes that it may use, or text such as "2G". It replaces the limits that hold otherwise.

    >>> cat.distances(0, timeout=10, memory="1G", threads=1).shape
    (1000,)
    """

    timeout: float | None
    memory: int | str | None


def optional(module: str, remedy: str) -> Any:
    """A module of a package that not everybody has."""
    try:
        return import_module(module)
    except ImportError as missing:
        raise ImportError(remedy) from missing


def warned(message: str, kind: type[Warning]) -> None:
    """Warns at the line that called this package."""
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_globals.get("__package__") == __package__:
        frame, level = frame.f_back, level + 1
    warnings.warn(message, kind, stacklevel=level)


def set_threads(n: int) -> None:
    """Set the number of worker threads, 0 for all cores, also of processes that are started from now on.

    Otherwise the environment variables RAYON_NUM_THREADS and OMP_NUM_THREADS say it. Results do not depend on it.

    Args:
        n: The number, 0 for all cores.

    >>> canonform.set_threads(2)
    >>> canonform.threads()
    2
    """
    _canonform.set_threads(whole("n", n))


@contextmanager
def running(call: Call | Shown) -> Iterator[None]:
    """Runs the work inside as the keywords of a call say. Without any, calls inside of others run as those."""
    given: dict[str, Any] = {**call}
    for name in given.keys() - {"progress", "threads", "timeout", "memory"}:
        raise TypeError(f"got an unexpected keyword argument {name!r}")
    if not given:
        yield
        return
    timeout, memory = given.get("timeout"), given.get("memory")
    with shown(given.get("progress", False)) as update:
        _canonform.begin_call(
            update,
            None if timeout is None else number("timeout", timeout),
            None if memory is None else n_bytes(memory),
            some_whole("threads", given.get("threads")),
        )
        try:
            yield
        finally:
            _canonform.end_call()


@contextmanager
def shown(progress: Progress) -> Iterator[Callable[[str, int, int], None] | None]:
    """What the Rust side calls to show progress."""
    if callable(progress) or not progress:
        yield progress or None
        return
    tqdm = optional("tqdm.auto", "progress=True needs the package tqdm (`pip install tqdm`); or pass a function").tqdm
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
