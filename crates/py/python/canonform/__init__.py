"""Nonrigid 3D shape retrieval by canonical forms.

A sitting cat and a leaping cat are the same shape. This package measures distances along surfaces, embeds surfaces so that
straight lines equal these distances (their *canonical forms*), and aligns, compares, searches and classifies shapes by them.

    >>> import canonform
    >>> cat = canonform.datasets.generate("cat", n_vertices=1000)[0].surface()
    >>> cat.distances(0).shape
    (1000,)
    >>> cat.canonical_form(50).points.shape
    (1000, 3)

`Surface` holds a mesh and everything that was prepared on it. `method=` says how distances become coordinates, `geodesic=` how they are
measured: a name, or an object such as `Nystrom` or `FastMarching` with the options of that method. Counts are called `n_...`. Calls that
may take long take the keywords of `Call`: `progress`, `timeout`, `memory` and `threads`. `Index` is a searchable file of shapes.
`NystromMDS` embeds any metric space (needs scikit-learn), and `canonform.distributed` builds indexes on several machines (needs Dask).

Arrays may be of any real type and layout. Vertices and faces are counted from 0, results are in the vertex order of the input, and
lengths are in the units of the mesh. The same input, options and seed give the same numbers as the command line, for any number of
threads. Arguments that are not possible raise `OptionError`, points that a mesh lacks `PointError`, names that an index lacks
`NoSuchShapeError`, files `FileError`, and limits `LimitError`, all in `canonform.errors`; docstrings name what else may happen.

In all examples `cat` and `other` are surfaces, two poses of a cat, `found` the maps from one to the other, and `index` is an index
of three cats, three centaurs and three davids.
"""

from __future__ import annotations

from typing import TYPE_CHECKING as _TYPE_CHECKING
from typing import Any as _Any

from . import datasets, errors
from ._canonform import __version__, threads
from ._arrays import VertexValues
from ._compare import Alignment, Comparison, align, compare
from ._field import DistanceField, PairDistance, PairDistances
from ._form import Form
from ._index import Index, Result, Scores, SearchResults, ShapeEntry
from ._look import Look, figure
from ._match import MappedPoints, Match, SurfaceMap, match
from ._methods import FastMarching, KernelPca, Landmark, Nystrom, Smacof, Spectral
from ._operators import ClosestPoints, EdgePoint, Eigenbasis, FacePoint
from ._settings import Call, Shown, set_threads
from ._surface import Path, RepairedMesh, RepairReport, Surface, distance_methods, embedding_methods, read, signature_kinds
from ._view import SurfaceView
from .errors import CanonformError

if _TYPE_CHECKING:
    from . import distributed
    from .learn import NystromMDS

__all__ = [
    "Alignment", "Call", "CanonformError", "ClosestPoints", "Comparison", "DistanceField", "EdgePoint", "Eigenbasis", "FacePoint",
    "FastMarching", "Form", "Index", "KernelPca", "Landmark", "Look", "MappedPoints", "Match", "Nystrom", "NystromMDS", "PairDistance",
    "PairDistances", "Path", "RepairReport", "RepairedMesh", "Result", "Scores", "SearchResults", "ShapeEntry", "Shown", "Smacof",
    "Spectral", "Surface", "SurfaceMap", "SurfaceView", "VertexValues", "__version__", "align", "compare", "datasets",
    "distance_methods", "distributed", "embedding_methods", "errors", "figure", "match", "read", "set_threads", "signature_kinds",
    "threads",
]  # fmt: skip


def __getattr__(name: str) -> _Any:
    # These need scikit-learn and Dask, which not everybody has.
    if name == "NystromMDS":
        from .learn import NystromMDS

        globals()[name] = NystromMDS
        return NystromMDS
    if name == "distributed":
        from importlib import import_module

        return import_module(".distributed", __name__)
    raise AttributeError(f"module 'canonform' has no attribute {name!r}")
