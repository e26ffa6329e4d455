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
may take long take the keywords of `Call`: `progress`, `timeout`, `memory` and `threads`. `Index` is a searchable file of shapes. `NystromMDS` embeds any
metric space (needs scikit-learn), and `canonform.distributed` builds indexes on several machines (needs Dask).

Arrays may be of any real type and layout. Vertices and faces are counted from 0, results are in the vertex order of the input, and
lengths are in the units of the mesh. The same input, options and seed give the same numbers as the command line, for any number of
threads.
"""

from __future__ import annotations

import os as _os
from typing import TYPE_CHECKING as _TYPE_CHECKING
from typing import Any as _Any
from typing import Unpack as _Unpack

from . import datasets, errors
from . import _canonform as _canonform
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
from ._settings import Call, Shown
from ._settings import whole as _whole
from ._surface import Path, RepairedMesh, RepairReport, Surface, distance_methods, embedding_methods, signature_kinds
from ._view import SurfaceView
from .errors import CanonformError

if _TYPE_CHECKING:
    from . import distributed
    from ._settings import Components, Weld
    from .learn import NystromMDS

__all__ = [
    "Alignment",
    "Call",
    "CanonformError",
    "ClosestPoints",
    "Comparison",
    "DistanceField",
    "EdgePoint",
    "Eigenbasis",
    "FacePoint",
    "FastMarching",
    "Form",
    "Index",
    "KernelPca",
    "Landmark",
    "Look",
    "MappedPoints",
    "Match",
    "Nystrom",
    "NystromMDS",
    "PairDistance",
    "PairDistances",
    "Path",
    "RepairReport",
    "RepairedMesh",
    "Result",
    "Scores",
    "SearchResults",
    "ShapeEntry",
    "Shown",
    "Smacof",
    "Spectral",
    "Surface",
    "SurfaceMap",
    "SurfaceView",
    "VertexValues",
    "__version__",
    "align",
    "compare",
    "datasets",
    "distance_methods",
    "distributed",
    "embedding_methods",
    "errors",
    "figure",
    "match",
    "read",
    "set_threads",
    "signature_kinds",
    "threads",
]


def read(path: str | _os.PathLike[str], *, components: Components = "largest", weld: Weld = "seams", **call: _Unpack[Call]) -> Surface:
    """Read and repair a mesh file; the same as `Surface(path)`."""
    return Surface(path, components=components, weld=weld, **call)


def set_threads(n: int) -> None:
    """Set the number of worker threads, 0 for all cores, also of processes that are started from now on.

    Otherwise the environment variables RAYON_NUM_THREADS and OMP_NUM_THREADS say it. Results do not depend on it.
    """
    _canonform.set_threads(_whole("n", n))


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
