"""Keyword arguments on their way to Rust, and progress on its way back."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, TypeAlias

Progress: TypeAlias = bool | Callable[[str, int, int], None]
"""`True` shows a bar (needs the package tqdm); a function gets the stage, the steps done and all steps."""

_SIZES = {"": 0, "K": 1, "M": 2, "G": 3, "T": 4}


def encoded(**settings: Any) -> str:
    """The settings that were given, as JSON."""
    return json.dumps({name: value for name, value in settings.items() if value is not None}, default=_plain)


def _plain(value: Any) -> Any:
    # NumPy numbers.
    if hasattr(value, "item"):
        return value.item()
    raise TypeError(f"{value!r} is not a number, text or truth value")


_FORM = frozenset(
    "dim update obtuse sampling first_sample regularization rank alpha sigma eigenvectors mu iterations tolerance".split()
)


def form_options(form: Mapping[str, Any] | None) -> dict[str, Any]:
    """Further options of forms, by name."""
    from .errors import OptionError

    options = dict(form or {})
    unknown = sorted(set(options) - _FORM)
    if unknown:
        raise OptionError(f"form={{{unknown[0]!r}: ...}} is not possible: use {', '.join(map(repr, sorted(_FORM)))}")
    return {**options, "mu": number_or_inf(options.get("mu"))}


def number_or_inf(value: float | None) -> float | str | None:
    """JSON has no infinity."""
    return "inf" if value is not None and math.isinf(value) and value > 0 else value


def n_bytes(size: int | str | None) -> int | None:
    """A memory size such as 2_000_000_000 or "2G", in bytes."""
    from .errors import OptionError

    if size is None or not isinstance(size, str):
        return None if size is None else int(size)
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
