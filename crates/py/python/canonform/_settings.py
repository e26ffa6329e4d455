"""Keyword arguments on their way to Rust, and progress on its way back."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Literal, TypeAlias

import numpy as np

from . import _canonform
from .errors import OptionError

Progress: TypeAlias = bool | Callable[[str, int, int], None]
"""`True` shows a bar (needs the package tqdm); a function gets the stage, the steps done and all steps."""

DistanceMethod: TypeAlias = Literal["fast-marching", "exact", "heat", "dijkstra", "bfs"]
EmbeddingMethod: TypeAlias = Literal["nmds", "landmark", "spectral", "fmds", "kpca", "mds", "smacof"]
Update: TypeAlias = Literal["point-source", "virtual-source", "planar"]
Obtuse: TypeAlias = Literal["flip", "unfold", "ignore"]
Sampling: TypeAlias = Literal["farthest", "random", "min-variance", "max-variance"]
Regularization: TypeAlias = Literal["low-rank", "cur", "rpi", "none"]
Stress: TypeAlias = Literal["auto", "exact", "estimate", "skip"]
Components: TypeAlias = Literal["largest", "bridge", "error"]
Weld: TypeAlias = Literal["seams", "all", "none"] | float
FormDistance: TypeAlias = Literal["nn-rms", "hausdorff95"]
Rank: TypeAlias = Literal["plain", "graph", "part"]

_SIZES = {"": 0, "K": 1, "M": 2, "G": 3, "T": 4}


_OPTIONS, _FORM = map(frozenset, _canonform.option_names())


def encoded(**settings: Any) -> str:
    """The settings that were given, as JSON."""
    given = {name: _plain(value) for name, value in settings.items() if value is not None}
    return json.dumps({**given, "memory": n_bytes(given["memory"])} if "memory" in given else given)


def options_of(arguments: Mapping[str, Any]) -> str:
    """The options among the arguments of a call, as JSON."""
    return encoded(**{name: value for name, value in arguments.items() if name in _OPTIONS})


def _plain(value: Any) -> Any:
    # NumPy numbers.
    value = value.item() if hasattr(value, "item") else value
    if not isinstance(value, (bool, int, float, str)):
        raise OptionError(f"{value!r} is not possible: give a number, text or a truth value")
    # JSON has no infinity.
    return "inf" if isinstance(value, float) and math.isinf(value) and value > 0 else value


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


def ways(method: str, update: str | None, obtuse: str | None) -> tuple[str, str | None, str | None]:
    """How distances are measured, as text."""
    return (
        word("method", method),
        None if update is None else word("update", update),
        None if obtuse is None else word("obtuse", obtuse),
    )


def number(name: str, value: Any) -> float:
    """The number that an argument must be."""
    try:
        found = float(value)
    except (TypeError, ValueError):
        found = math.nan
    if math.isnan(found):
        raise OptionError(f"{name}={value!r} is not possible: give a number")
    return found


def form_options(form: Mapping[str, Any] | None) -> dict[str, Any]:
    """Further options of forms, by name."""
    options = dict(form or {})
    unknown = sorted(set(options) - _FORM)
    if unknown:
        raise OptionError(f"form={{{unknown[0]!r}: ...}} is not possible: use {', '.join(map(repr, sorted(_FORM)))}")
    return options


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
