"""Arrays and meshes of other packages, and arrays of results."""

from __future__ import annotations

from collections.abc import Sized
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import CanonformError, MeshError, OptionError

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]


class VertexValues(np.ndarray[Any, np.dtype[np.float64]]):
    """A number or a row for each vertex of the input, or for each face: NaN where there is no surface, infinite where nothing was reached.

    An array like others, but `max`, `min`, `argmax` and `argmin` pass over what is not finite.

    >>> near = cat.distances(0, max_distance=20)
    >>> near.max() <= 20 and bool(near.valid[near.argmax()])
    True
    """

    _axis: ClassVar[int] = 0

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        # Sums and means are numbers, as those of other arrays.
        return array.view(type(self)) if array.ndim else array[()]

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which vertices, or faces, have finite numbers: a mask."""
        others = tuple(axis for axis in range(self.ndim) if axis != self._axis) if self.ndim > 1 else ()
        return np.asarray(np.isfinite(self.view(np.ndarray)).all(axis=others))

    def _finite_or(self, other: float) -> Floats:
        values = self.view(np.ndarray)
        return np.where(np.isfinite(values), values, other)

    def max(self, *args: Any, **kwargs: Any) -> Any:  # noqa: D102
        return self._finite_or(-np.inf).max(*args, **kwargs)

    def min(self, *args: Any, **kwargs: Any) -> Any:  # noqa: D102
        return self._finite_or(np.inf).min(*args, **kwargs)

    def argmax(self, *args: Any, **kwargs: Any) -> Any:  # noqa: D102
        return self._finite_or(-np.inf).argmax(*args, **kwargs)

    def argmin(self, *args: Any, **kwargs: Any) -> Any:  # noqa: D102
        return self._finite_or(np.inf).argmin(*args, **kwargs)


class SourceRows(VertexValues):
    """Values with a row for each source, and a column for each vertex."""

    _axis = 1


def on_vertices(values: Floats, *, writeable: bool = True) -> VertexValues:
    """The same numbers as values on vertices, or faces."""
    if not writeable:
        values.flags.writeable = False
    return values.view(VertexValues)


def straight(array: ArrayLike, dtype: Any = None) -> NDArray[Any]:
    """The same numbers in order and aligned, as Rust reads them; the same array if they are already."""
    return np.require(array, dtype, ["C_CONTIGUOUS", "ALIGNED"])


def edges_of(faces: Ints) -> Ints:
    """The edges of faces as pairs of vertices, each once and in order."""
    return np.unique(np.sort(faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)


def numeric(
    name: str, values: Any, sides: tuple[int | str, ...], dtype: Any = np.float64, error: type[CanonformError] = OptionError
) -> NDArray[Any]:
    """The array that an argument must be; the same one if possible. `sides` are its shape, with letters for sides of any length."""
    # Tensors of PyTorch may have gradients, or be on another device.
    values = values.detach().cpu() if hasattr(values, "detach") else values
    if np.ma.is_masked(values):
        raise error(f"{name} has masked values; fill them in, or leave them out")
    is_whole = np.issubdtype(dtype, np.integer)
    shape = f"({', '.join(map(str, sides))}{',' if len(sides) == 1 else ''})"
    wanted = f"{name} must be an array of {'whole numbers' if is_whole else 'numbers'} of shape {shape}"
    try:
        array = np.asarray(values)
    except (TypeError, ValueError) as fault:
        raise error(f"{wanted}, with as many in each row: {fault}") from fault
    fits = [side == length or isinstance(side, str) for side, length in zip(sides, array.shape)]
    if is_whole and array.dtype.kind == "f" and np.array_equal(array, np.trunc(array)):
        array = array.astype(np.int64)
    if len(fits) != len(sides) or array.ndim != len(sides) or not all(fits) or array.dtype.kind not in ("iu" if is_whole else "fiu"):
        raise error(f"{wanted}, not {array.dtype} of shape {array.shape}")
    return straight(array, dtype)


def numbers(name: str, values: Any, least: float = -np.inf) -> Floats:
    """The finite numbers that an argument must be, one or several, larger than the least one."""
    found: Floats = numeric(name, values if np.ndim(values) else [values], ("k",))
    if not found.size or not np.isfinite(found).all() or found.min() <= least:
        raise OptionError(f"{name}={values!r} is not possible: give finite numbers" + (f" larger than {least:g}" if least > -np.inf else ""))
    return found


def mesh_of(mesh: Any, faces: Any = None) -> tuple[Floats, Ints, list[str]]:
    """Vertices, triangles and notes, from arrays, from both in a tuple, or from a mesh or points of another package."""
    blocks = None if faces is None else _blocks(faces)
    if faces is None:
        mesh, blocks = _parts(mesh)
    vertices: Floats = numeric("vertices", mesh, ("n", 3), error=MeshError)
    if blocks is None:
        return vertices, np.empty((0, 3), dtype=np.int64), []
    triangles = [_triangles(block, vertices) for block in blocks if np.shape(block)[:1] != (0,)]
    if not triangles:
        raise MeshError("there are no faces; leave out `faces` for a point cloud")
    n_split = sum(np.shape(block)[0] for block in blocks if np.shape(block)[-1:] == (4,))
    notes = [f"split {n_split:,} faces of 4 corners into triangles"] if n_split else []
    return vertices, np.concatenate(triangles), notes


def _parts(mesh: Any) -> tuple[Any, list[Any] | None]:
    """The vertices of a mesh, and its faces by their number of corners; none of points."""
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2 and len(getattr(mesh[0], "shape", np.shape(mesh[0]))) == 2:
        return mesh[0], _blocks(mesh[1])
    if hasattr(mesh, "geometry") and hasattr(mesh, "dump"):
        # A scene of trimesh.
        if not mesh.geometry:
            raise MeshError("the scene is empty")
        mesh = mesh.dump(concatenate=True) if not hasattr(mesh, "to_geometry") else mesh.to_geometry()
    if hasattr(mesh, "points") and hasattr(mesh, "is_all_triangles"):
        # PyVista writes the number of corners before the corners of a face.
        return mesh.points, _unpadded(np.asarray(mesh.faces)) or None
    if hasattr(mesh, "points") and hasattr(mesh, "cells"):
        return mesh.points, _cells(mesh)
    for points, corners in (("vertices", "faces"), ("vertices", "triangles"), ("points", ""), ("vertices", "")):
        if hasattr(mesh, points) and (not corners or hasattr(mesh, corners)) and not hasattr(mesh, "entities"):
            return np.asarray(getattr(mesh, points)), _blocks(getattr(mesh, corners)) if corners else None
    if isinstance(mesh, (list, tuple)) or hasattr(mesh, "__array__"):
        return mesh, None
    raise MeshError(
        f"{type(mesh).__name__} is not a mesh; give vertices and faces as arrays, a mesh or points of trimesh, meshio, PyVista or Open3D, "
        "points as an array, or a file by its path"
    )


def _cells(mesh: Any) -> list[Any] | None:
    """The faces of a mesh of meshio."""
    if hasattr(mesh, "extract_surface"):
        raise MeshError("a grid is not a mesh; call its method extract_surface() first")
    others = sorted({block.type for block in mesh.cells} - {"triangle", "quad", "line", "vertex"})
    if others:
        raise MeshError(f"the mesh has cells of type {', '.join(others)}; only triangles and quads make a surface here")
    return [block.data for block in mesh.cells if block.type in ("triangle", "quad")] or None


def _unpadded(corners: Ints) -> list[Any]:
    rows, at = [], 0
    while at < len(corners):
        rows.append(corners[at + 1 : at + 1 + corners[at]])
        at += 1 + int(corners[at])
    return _blocks(rows) if rows else []


def _blocks(faces: Any) -> list[Any]:
    """Faces by their number of corners."""
    if not isinstance(faces, (list, tuple)):
        return [faces]
    by_length: dict[int, list[Any]] = {}
    for face in faces:
        by_length.setdefault(len(face) if isinstance(face, Sized) else 0, []).append(face)
    return list(by_length.values())


def _triangles(faces: Any, vertices: Floats) -> Ints:
    """Faces of as many corners each as triangles."""
    shape = np.shape(faces)
    if len(shape) == 2 and shape[1] not in (3, 4):
        raise MeshError(f"faces have {shape[1]} corners; split them into triangles first, for example with trimesh or PyVista")
    array: Ints = numeric("faces", faces, ("m", shape[1] if len(shape) == 2 else 3), np.int64, MeshError)
    n = len(vertices)
    wrong = np.flatnonzero((array < 0).any(axis=1) | (array >= n).any(axis=1))
    if len(wrong):
        row = int(wrong[0])
        vertex = int(array[row].min() if array[row].min() < 0 else array[row].max())
        from_one = array.min() == 1 and array.max() == n
        remedy = "; they seem to be counted from 1: pass faces - 1" if from_one else ""
        raise MeshError(f"face {row} has the vertex number {vertex}; the {n} vertices are counted from 0{remedy}")
    return array if array.shape[1] == 3 else _split(array, vertices)


def _split(quads: Ints, vertices: Floats) -> Ints:
    """Faces of four corners as triangles, split as in files: along the diagonal that folds neither half over, else the shorter one."""
    ways = quads[:, [[[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]]]
    a, b, c = np.moveaxis(vertices[ways], 3, 0)
    normals = np.cross(b - a, c - a)
    folds = np.einsum("fwk,fwk->fw", normals[:, :, 0], normals[:, :, 1]) <= 0
    lengths = np.linalg.norm(vertices[quads[:, [0, 1]]] - vertices[quads[:, [2, 3]]], axis=2)
    second = np.where(folds[:, 0] == folds[:, 1], lengths[:, 1] < lengths[:, 0], folds[:, 0])
    return ways[np.arange(len(quads)), second.astype(int)].reshape(-1, 3)
