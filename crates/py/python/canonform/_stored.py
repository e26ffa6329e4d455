"""What pickles, copies and compares."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ._arrays import straight
from .errors import CanonformError

_VERSION = 3


class Stored:
    """An object that pickles as plain data with a version: for processes, joblib and Dask."""

    def _state(self) -> dict[str, Any]:
        """What the object is made of: plain data, arrays, and other stored objects."""
        return dict(vars(self))

    def _restore(self, state: dict[str, Any]) -> None:
        """Makes an empty object the one of this state."""
        vars(self).update(state)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...]]:
        return _restored, (type(self), _VERSION, self._state())


class Constant(Stored):
    """An object that never changes, so that copies are the object itself."""

    def __copy__(self) -> Any:
        return self

    def __deepcopy__(self, memo: Any) -> Any:
        return self


class ByValue(Stored):
    """A data class that is equal to another of the same values, also of arrays, and hashes."""

    def _key(self) -> tuple[Any, ...]:
        return tuple(_hashable(getattr(self, field.name)) for field in fields(self))  # type: ignore[arg-type]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ByValue) or type(other) is not type(self):
            return NotImplemented
        return self is other or self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())


class AsArray:
    """An object with as many rows as one of its arrays, which `numpy.asarray` gives."""

    _rows: ClassVar[str] = "points"

    def __len__(self) -> int:
        return len(getattr(self, self._rows))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(getattr(self, self._rows), dtype=dtype, copy=True if copy is None else copy)


def _restored(kind: type[Stored], version: int, state: dict[str, Any]) -> Stored:
    if version != _VERSION:
        raise CanonformError(
            f"this {kind.__name__} was pickled in layout {version}, and this version of canonform reads layout {_VERSION}; make it again"
        )
    made = kind.__new__(kind)
    # Arrays that arrive in buffers of their own may be unaligned.
    made._restore({name: straight(value) if isinstance(value, np.ndarray) else value for name, value in state.items()})
    return made


def _hashable(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return value.dtype.str, value.shape, value.tobytes()
    return tuple(value) if isinstance(value, list) else value
