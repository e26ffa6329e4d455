"""What can go wrong. Every message says what to do, and names keyword arguments where they help.

All exceptions are `CanonformError`; each is also the built-in exception that fits, so that `except ValueError` or `except
FileNotFoundError` works.

>>> try:
...     cat.distances(5000)
... except IndexError as fault:
...     print(type(fault).__name__, fault)
PointError vertex 5000 does not exist; the mesh has 1996 faces and 1000 vertices, ...
"""

from __future__ import annotations

__all__ = [
    "CanonformError", "EmbeddingError", "FileError", "LimitError", "MemoryLimitError", "MeshError", "MissingFileError",
    "NoSuchShapeError", "OptionError", "PointError", "ShapeIndexError", "SkippedMeshWarning", "SurfaceLossWarning", "TimeLimitError",
]  # fmt: skip


class CanonformError(Exception):
    """Any error of this package."""


class MeshError(CanonformError, ValueError):
    """A mesh, or a mesh file, cannot be used."""


class OptionError(CanonformError, ValueError):
    """A keyword argument has a value that is not possible, or would have no effect."""


class PointError(CanonformError, IndexError):
    """The mesh has no such vertex, edge or face, the repair dropped it, or no path leads there."""


class EmbeddingError(CanonformError, ValueError):
    """Distances, coordinates or signatures cannot be computed from this input with these options."""


class LimitError(CanonformError, RuntimeError):
    """The work was not finished within its limits."""


class MemoryLimitError(LimitError, MemoryError):
    """The work needs more memory than allowed."""


class TimeLimitError(LimitError, TimeoutError):
    """The work takes longer than allowed."""


class FileError(CanonformError, OSError):
    """A file cannot be read or written."""


class MissingFileError(FileError, FileNotFoundError):
    """A file does not exist."""


class ShapeIndexError(CanonformError, RuntimeError):
    """An index cannot be used in this way."""


class NoSuchShapeError(ShapeIndexError, LookupError):
    """An index has no shape of this name."""


class SurfaceLossWarning(UserWarning):
    """The repair of a mesh dropped more than 1 % of its surface; the command line ends with code 1 then."""


class SkippedMeshWarning(UserWarning):
    """Some meshes are not in the index."""
