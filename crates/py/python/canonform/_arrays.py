"""Arrays and meshes of other packages."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import MeshError

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int64]


def straight(array: ArrayLike, dtype: Any = None) -> NDArray[Any]:
    """The same numbers in order and aligned, as Rust reads them; the same array if they are already."""
    return np.require(array, dtype, ["C_CONTIGUOUS", "ALIGNED"])


def vertices_of(vertices: ArrayLike) -> Floats:
    """An n x 3 array of float64; the same array if it is one already."""
    array = _array(vertices, "vertices")
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "fiu":
        raise MeshError(f"vertices must be an array of numbers of shape (n, 3), not {_described(array)}")
    return straight(array, dtype=np.float64)


def faces_of(faces: ArrayLike) -> Ints:
    """An m x 3 array of int64; the same array if it is one already."""
    array = _array(faces, "faces")
    if array.size == 0:
        raise MeshError("there are no faces; leave out `faces` for a point cloud")
    if array.ndim == 2 and array.shape[1] == 4:
        raise MeshError("faces have 4 corners; split them into triangles first, for example with trimesh or PyVista")
    if array.ndim != 2 or array.shape[1] != 3:
        raise MeshError(f"faces must be an array of vertex numbers of shape (m, 3), not {_described(array)}")
    if array.dtype.kind == "f" and np.array_equal(array, np.trunc(array)):
        array = array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise MeshError(f"faces must be whole numbers, not {array.dtype}")
    if array.min() < 0:
        row = int(np.flatnonzero(array.min(axis=1) < 0)[0])
        raise MeshError(f"face {row} has the vertex number {int(array[row].min())}; vertices are counted from 0")
    return straight(array, dtype=np.int64)


def mesh_of(mesh: Any, faces: Any) -> tuple[Floats, Ints]:
    """Vertices and faces, from two arrays, from points without faces, or from a mesh of trimesh, meshio, PyVista or Open3D."""
    if faces is not None:
        return vertices_of(mesh), faces_of(faces)
    if isinstance(mesh, np.ndarray) or isinstance(mesh, (list, tuple)):
        return vertices_of(mesh), np.empty((0, 3), dtype=np.int64)
    for read in (_pyvista, _trimesh, _meshio, _open3d):
        found = read(mesh)
        if found is not None:
            return vertices_of(found[0]), faces_of(found[1])
    raise MeshError(
        f"{type(mesh).__name__} is not a mesh; give vertices and faces as arrays, a mesh of trimesh, meshio, PyVista or Open3D, "
        "points as an array, or read a file with canonform.read(path)"
    )


def _trimesh(mesh: Any) -> tuple[Any, Any] | None:
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return mesh.vertices, mesh.faces
    return None


def _meshio(mesh: Any) -> tuple[Any, Any] | None:
    if not (hasattr(mesh, "points") and hasattr(mesh, "cells")):
        return None
    if hasattr(mesh, "extract_surface"):
        raise MeshError("a grid is not a mesh; call its methods extract_surface().triangulate() first")
    blocks = [block.data for block in mesh.cells if block.type == "triangle"]
    others = sorted({block.type for block in mesh.cells if block.type not in ("triangle", "line", "vertex")})
    if others:
        raise MeshError(f"the mesh has cells of type {', '.join(others)}; only triangles make a surface here, so split them first")
    if not blocks:
        raise MeshError("the mesh has no triangles")
    return mesh.points, np.concatenate(blocks)


def _pyvista(mesh: Any) -> tuple[Any, Any] | None:
    if not (hasattr(mesh, "points") and hasattr(mesh, "is_all_triangles")):
        return None
    if not mesh.is_all_triangles:
        raise MeshError("the mesh has faces that are not triangles; call its method triangulate() first")
    return mesh.points, mesh.faces.reshape(-1, 4)[:, 1:]


def _open3d(mesh: Any) -> tuple[Any, Any] | None:
    if hasattr(mesh, "vertices") and hasattr(mesh, "triangles"):
        return np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    return None


def _array(values: Any, name: str) -> NDArray[Any]:
    if np.ma.is_masked(values):
        raise MeshError(f"{name} has masked values; fill them in, or leave them out")
    try:
        return np.asarray(values)
    except ValueError as fault:
        raise MeshError(f"{name} must be an array with 3 numbers in each row: {fault}") from fault


def _described(array: NDArray[Any]) -> str:
    return f"shape {array.shape} of {array.dtype}"
