"""Indexes and distances on several machines, with Dask.

Describing shapes is the heavy part of an index, and every shape is described on its own: a pool of tasks, without any exchange between
them. `build_index` cuts a collection into batches, a worker makes an index of each, and the client merges them. Workers need this package
and must see the meshes and the index under the same paths.

    >>> from distributed import Client, LocalCluster                             # doctest: +SKIP
    >>> client = Client(LocalCluster(n_workers=2, threads_per_worker=1))          # doctest: +SKIP
    >>> index = canonform.distributed.build_index("meshes", client, "shapes.canonform", progress=True)   # doctest: +SKIP

The result is that of `Index.build` and of `canonform index build`: both export the same bytes.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _canonform
from ._arrays import Floats
from ._index import OF_INDEXES, AnyPath, Index, Meshes, _dataset, _in_files, _label_file
from ._methods import Embedding, Geodesic, options_of
from ._settings import Components, IndexDistance, Landmarks, Progress, Weld, renamed, shown
from .errors import MeshError, OptionError

try:
    from distributed import as_completed, get_worker
except ImportError as missing:
    raise ImportError("canonform.distributed needs Dask: pip install 'canonform[dask]'") from missing

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["batches_by_size", "build_index", "distance_matrix"]

_BATCHES_PER_THREAD = 8
_MOST_IN_BATCH = 256


def batches_by_size(sizes: Sequence[int], n_batches: int, most: int = _MOST_IN_BATCH) -> list[list[int]]:
    """Cut items into batches of about the same size, the largest items first.

    Work on meshes is heavy-tailed: a batch of the largest that started last would keep one worker busy while the others wait.

    Parameters
    ----------
    sizes
        The size of each item.
    n_batches
        About how many batches; more if they would hold more than `most` items, fewer if there are fewer items.

    Returns
    -------
    list of lists of positions in `sizes`, those with the largest items first
    """
    target = max(sum(sizes) / max(n_batches, 1), 1)
    batches: list[list[int]] = []
    filled = float("inf")
    for item in sorted(range(len(sizes)), key=lambda item: (-sizes[item], item)):
        if filled + sizes[item] > target or len(batches[-1]) >= most:
            batches.append([])
            filled = 0
        batches[-1].append(item)
        filled += sizes[item]
    return batches


@renamed(**OF_INDEXES)
def build_index(
    meshes: Meshes,
    client: Client,
    out: AnyPath,
    *,
    labels: Mapping[str, str] | AnyPath | None = None,
    n_landmarks: Landmarks = 100,
    n_points: int = 1000,
    size: bool = False,
    method: Embedding = "nmds",
    geodesic: Geodesic = "fast-marching",
    components: Components = "largest",
    weld: Weld = "seams",
    seed: int = 0,
    max_vertices: int | None = None,
    timeout: float | None = None,
    memory: int | str | None = None,
    n_batches: int | None = None,
    retries: int = 3,
    shards: AnyPath | None = None,
    keep_shards: bool = False,
    progress: Progress = False,
) -> Index:
    """Make a file the index of meshes, on the workers of a Dask client.

    Each batch becomes a small index in the folder `shards`, named by the hash of its options and of the content of its meshes. A batch
    that is there already is not described again, so a run that was interrupted goes on where it stopped. A batch whose worker is lost
    moves to another worker; nothing else is repeated.

    Parameters
    ----------
    meshes, labels, n_landmarks, n_points, size, method, geodesic, components, weld, seed, max_vertices, timeout, memory
        As in `Index.build`.
    client
        A `distributed.Client`, of any cluster: local, over SSH, or of Slurm through dask-jobqueue.
    out
        The index. It is replaced.
    n_batches
        About how many batches. By default 8 for each thread of the cluster.
    retries
        How often a batch that raised an exception is tried again.
    shards
        The folder of the small indexes; by default `out` with the ending `.shards`. Workers must see it.
    keep_shards
        Whether to keep that folder when all is done, so that the next run describes only batches that have changed.

    Raises
    ------
    MeshError
        If there are no meshes, or none of them can be described.
    """
    settings = options_of(**locals())
    out = os.path.abspath(out)
    place = os.path.abspath(shards if shards is not None else f"{out}.shards")
    os.makedirs(place, exist_ok=True)
    meshes, labels = _in_files(meshes, out, labels, replace=True)
    # Workers do not see temporary files of the client, so lists of meshes and labels are kept beside the shards.
    with _label_file(labels) as given, _dataset(meshes, place) as (dataset, name):
        dataset, label_file = os.path.abspath(dataset), None
        if given in ("folders", "names", "none"):
            label_file = given
        elif given is not None:
            label_file = os.path.join(place, "labels.csv")
            shutil.copyfile(given, label_file)
        found = _canonform.list_folder(dataset, out, label_file)
    threads = sum(client.nthreads().values()) or 1
    batches = batches_by_size([n_bytes for *_, n_bytes in found], n_batches or _BATCHES_PER_THREAD * threads)
    # The largest batches run first.
    tasks = [
        client.submit(
            _describe,
            dataset,
            [found[item][:3] for item in batch],
            place,
            label_file,
            settings,
            key=f"canonform-{_hash(settings, dataset, [found[item] for item in batch])}",
            priority=-place_in_line,
            retries=retries,
            pure=False,
        )
        for place_in_line, batch in enumerate(batches)
    ]
    reports: list[tuple[str, dict[str, Any]]] = _gathered(client, tasks, [len(batch) for batch in batches], "shapes", progress)

    failed = sorted((failure for _, report in reports for failure in report["failed"]), key=lambda failure: str(failure["id"]))
    written = sorted({path for path, _ in reports if os.path.exists(path)})
    if not written:
        first = failed[0]["error"] if failed else "there are no meshes"
        raise MeshError(f"no mesh of {name} could be described, so no index was written; the first: {first}")
    index = Index.merge(written, out)
    index.build_report = {
        "n_shapes": len(index),
        "described": sum(report["described"] for _, report in reports),
        "unchanged": sum(report["unchanged"] for _, report in reports),
        "failed": failed,
        "batches": len(batches),
    }
    if not keep_shards:
        shutil.rmtree(place)
    return index


def distance_matrix(
    index: Index | AnyPath,
    client: Client,
    *,
    kind: IndexDistance = "combined",
    block: int = 64,
    retries: int = 3,
    progress: Progress = False,
) -> tuple[list[str], Floats]:
    """Distances between all pairs of shapes of an index, on the workers of a Dask client.

    Parameters
    ----------
    index
        An index, or its path. Workers must see the file.
    kind
        "combined" aligns the forms of every pair; "fused" compares signatures only.
    block
        Shapes in a block; a task measures the pairs of two blocks.

    Returns
    -------
    names of the shapes, and an array of shape (number of shapes, number of shapes), equal to `Index.distances`
    """
    if kind not in ("combined", "fused"):
        raise OptionError(f'kind="{kind}" is not possible: use "combined", "fused"')
    if block < 1:
        raise OptionError(f"block={block} is not possible: give a positive number")
    index = index if isinstance(index, Index) else Index(index)
    path, ids = os.path.abspath(index.path), list(index)
    starts = range(0, len(ids), block)
    # Half of the pairs: distances are symmetric.
    places = [(row, column) for row in starts for column in starts if row <= column]
    tasks = [
        client.submit(
            _measure,
            path,
            ids[row : row + block],
            None if row == column else ids[column : column + block],
            kind,
            pure=False,
            retries=retries,
        )
        for row, column in places
    ]
    blocks: list[Floats] = _gathered(client, tasks, [1] * len(tasks), "blocks", progress)
    matrix = np.empty((len(ids), len(ids)))
    for (row, column), measured in zip(places, blocks, strict=True):
        matrix[column : column + block, row : row + block] = measured.T
        matrix[row : row + block, column : column + block] = measured
    return ids, matrix


def _describe(
    dataset: str, shapes: list[tuple[str, str, str]], place: str, label_file: str | None, settings: str
) -> tuple[str, dict[str, Any]]:
    """Makes the index of a batch, on a worker. Returns its path and report."""
    _use_threads_of_worker()
    contents = _canonform.content_hashes([path for _, _, path in shapes])
    name = _hash(settings, [(*shape, content) for shape, content in zip(shapes, contents, strict=True)])
    path = os.path.join(place, f"{name}.canonform")
    # An unfinished batch is resumed, and one that is there is recognised by the content of its meshes.
    report = _canonform.Index.build(
        dataset, path, label_file, False, None, {name for name, _, _ in shapes}, settings, None
    )
    return path, json.loads(report)


def _measure(path: str, rows: list[str], columns: list[str] | None, kind: str) -> Floats:
    """Measures the distances between two blocks of shapes, on a worker."""
    _use_threads_of_worker()
    return _canonform.Index.open(path).distances(rows, columns, kind, None)


def _use_threads_of_worker() -> None:
    """Not more threads than Dask gave the worker. The tasks of one worker share them."""
    threads = get_worker().state.nthreads
    if _canonform.threads() != threads:
        _canonform.set_threads(threads)


def _hash(*parts: Any) -> str:
    return hashlib.sha256(json.dumps(parts, default=str).encode()).hexdigest()[:32]


def _gathered(client: Client, tasks: list[Any], weights: Iterable[int], stage: str, progress: Progress) -> list[Any]:
    """The results in the order of the tasks. After an error, or Ctrl-C, the other tasks are cancelled."""
    weight = dict(zip((task.key for task in tasks), weights, strict=True))
    results: dict[str, Any] = {}
    done, total = 0, sum(weight.values())
    try:
        with shown(progress) as update:
            for task, result in as_completed(tasks, with_results=True):
                results[task.key] = result
                done += weight[task.key]
                if update is not None:
                    update(stage, done, total)
    except BaseException:
        client.cancel(tasks)
        raise
    return [results[task.key] for task in tasks]
