"""Indexes and searches on several machines, with Dask.

`build_index` cuts a collection into batches, a worker makes an index of each, and the client merges them. Workers need this package and
must see the meshes and the index under the same paths.

    >>> from distributed import Client, LocalCluster                             # doctest: +SKIP
    >>> client = Client(LocalCluster(n_workers=2, threads_per_worker=1))          # doctest: +SKIP
    >>> index = canonform.distributed.build_index("meshes", client, "shapes.canonform", progress=True)   # doctest: +SKIP

The result is that of `Index.build` and of `canonform index build`: both export the same bytes.

What is too large for one index stays in several. `vector_table` collects their vectors in a Lance table, and `search` looks there first.
Then it aligns forms where the indexes are: names and distances travel, forms do not.

    >>> canonform.distributed.vector_table(["part-1.canonform", "part-2.canonform"], "shapes.lance")     # doctest: +SKIP
    >>> results = canonform.distributed.search("shapes.lance", "query.off", client=client)               # doctest: +SKIP

Without a client, this process does everything.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from . import _canonform, _vectors
from ._index import AnyPath, Index, Labels, Meshes, SearchResults, dataset_of, in_files, label_file_of, none_described
from ._methods import Embedding, Geodesic, options_of
from ._settings import Call, Components, Landmarks, Progress, Ranking, Weld, optional, running, shown, whole, word
from ._stored import Stored
from ._surface import AnyMesh, Surface, surface_of
from .errors import CanonformError, NoSuchShapeError, OptionError, ShapeIndexError, TimeLimitError

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["build_index", "search", "vector_table"]

_BATCHES_PER_THREAD = 8
_MOST_IN_BATCH = 256


def _batches(sizes: Sequence[int], n_batches: int, most: int = _MOST_IN_BATCH) -> list[list[int]]:
    """Cuts items into about so many batches of about the same size, positions in `sizes`.

    Work on meshes is heavy-tailed: a batch of the largest that started last would keep one worker busy while the others wait, so those
    come first.
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


def build_index(
    meshes: Meshes,
    client: Client,
    out: AnyPath,
    *,
    labels: Labels | None = None,
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
    moves to another worker; nothing else is repeated. If the index holds just these meshes already, there is nothing to do.

    Args:
        meshes, labels, n_landmarks, n_points, size, method, geodesic, components, weld, seed, max_vertices, timeout, memory, progress: As
            in `Index.build`.
        client: A `distributed.Client`, of any cluster: local, over SSH, or of Slurm through dask-jobqueue.
        out: The index. It is replaced.
        n_batches: About how many batches. By default 8 for each thread of the cluster.
        retries: How often a batch that raised an exception is tried again.
        shards: The folder of the small indexes; by default `out` with the ending `.shards`. Workers must see it. Other files in it stay.
        keep_shards: Whether to keep these indexes when all is done, so that the next run describes only batches that have changed.

    Raises `MeshError` if there are no meshes, or none of them can be described.
    """
    settings = options_of(
        n_landmarks=n_landmarks, n_points=n_points, size=size, method=method, geodesic=geodesic, components=components,
        weld=weld, seed=seed, max_vertices=max_vertices, timeout=timeout, memory=memory,
    )  # fmt: skip
    out = os.path.abspath(out)
    place = os.path.abspath(shards if shards is not None else f"{out}.shards")
    is_new = not os.path.exists(place)
    os.makedirs(place, exist_ok=True)
    try:
        # Workers do not see temporary files of the client, so lists of meshes and labels are beside the shards.
        with (
            in_files(meshes, out, labels, keep=False) as (paths, known, unusable),
            TemporaryDirectory(prefix="canonform-", dir=place) as lists,
        ):
            (dataset, name), label_file = dataset_of(paths, lists), label_file_of(known, lists)
            dataset = os.path.abspath(dataset)
            if label_file is not None and os.path.isfile(label_file) and os.path.dirname(label_file) != lists:
                label_file = shutil.copy(label_file, lists)
            unchanged = _canonform.Index.build(dataset, out, label_file, True, None, None, True, settings) if os.path.exists(out) else None
            if unchanged is not None:
                index, report = Index(out), json.loads(unchanged)
                index.build_report = {key: report[key] for key in ("n_shapes", "described", "unchanged", "failed")} | {"batches": 0}
                return index
            _dask()
            found = _canonform.list_folder(dataset, out, label_file)
            threads = sum(client.nthreads().values()) or 1
            batches = _batches([n_bytes for *_, n_bytes in found], n_batches or _BATCHES_PER_THREAD * threads)
            items = [(dataset, [found[item][:3] for item in batch], place, label_file, settings) for batch in batches]
            reports: list[tuple[str, dict[str, Any]]] = _mapped(
                client, _describe, items, {"progress": progress}, retries, stage="shapes", weights=[len(batch) for batch in batches]
            )
        failed = sorted([*unusable, *(failure for _, report in reports for failure in report["failed"])], key=lambda failure: str(failure["id"]))
        written = sorted({path for path, _ in reports if os.path.exists(path)})
        if not written:
            raise none_described(name, failed)
        index = Index.merge(written, out)
        counts = {key: sum(report[key] for _, report in reports) for key in ("described", "unchanged")}
        index.build_report = {"n_shapes": len(index), **counts, "failed": failed, "batches": len(batches)}
        if not keep_shards:
            for path in written:
                os.remove(path)
        return index
    finally:
        # A folder that holds anything else stays.
        if (is_new or shards is None) and not os.listdir(place):
            os.rmdir(place)


def vector_table(shards: Iterable[AnyPath], table: AnyPath, *, client: Client | None = None, **call: Unpack[Call]) -> dict[str, Any]:
    """Collect the vectors of indexes in a Lance table, in which `search` finds the shapes nearest to a query. Returns facts about it.

    These are `n_shapes`, `changed`: shapes that were written; `partitions`, `probes`: how many of them a search visits, 0 if it compares
    all; `recall`: the share of the ten nearest vectors that searches find, on queries that did not decide about it.

    Call it again when indexes have changed: only their new and changed shapes are written, and searches that run meanwhile see the table
    before or after. Beyond 50,000 shapes their vectors are divided into partitions and coded in a byte for four numbers (IVF_PQ), and
    searches in held-out queries decide how many partitions are visited.

    Args:
        shards: Indexes made with the same options, without shapes of the same name, such as the parts of `Index.build(shard=...)`.
        table: The folder of the table. Paths of indexes are kept as seen from its own folder, so that both can move.
        client: A `distributed.Client` whose workers code the vectors. They must see the table under the same path.

    Raises `OptionError`, `ShapeIndexError` if an index of the table is left out, or two have a shape of the same name.
    """
    _vectors.lance_module()
    paths, uri = [os.path.abspath(path) for path in shards], os.path.abspath(table)
    if not paths:
        raise OptionError("shards=[] is not possible: give paths of indexes")
    names = [os.path.relpath(path, os.path.dirname(uri)).replace(os.sep, "/") for path in paths]
    stamps = {name: list(_vectors.stamp(path)) for name, path in zip(names, paths, strict=True)}
    is_new = not os.path.exists(uri)
    stored = None if is_new else _vectors.lance_module().dataset(uri)
    facts = _vectors.About() if stored is None else _vectors.about(stored)
    if set(facts.shards) - set(names):
        gone = ", ".join(sorted(set(facts.shards) - set(names))[:3])
        raise OptionError(f"shards= leaves out indexes of the table: {gone}; name them, too, or make another table")
    new = [(path, name) for path, name in zip(paths, names, strict=True) if facts.shards.get(name) != stamps[name]]
    if new:
        _refuse_repeated(paths)
    changed = 0
    with running(call), shown(call.get("progress", False)) as update:

        def rows_of(path: str, name: str) -> Any:
            index = Index(path)
            listed = index.shapes()
            columns = [shape.id for shape in listed], [shape.label for shape in listed], [shape.path for shape in listed]
            if update is not None:
                update("vectors", 1 + new.index((path, name)), len(new))
            return _vectors.rows(*columns, name, index.vectors())

        if stored is None:
            stored = _vectors.create(uri, (rows_of(path, name) for path, name in new))
            changed = stored.count_rows()
        else:
            for path, name in new:
                changed += _vectors.change(stored, name, rows_of(path, name))
        n = stored.count_rows()
        # A few vectors beside the partitions are compared one by one, and hardly move the boundary of classes.
        trains = n > _vectors.LEAST and (facts.partitions == 0 or 8 * _vectors.unindexed(stored) > n)
        if trains or new and n <= _vectors.LEAST:
            facts.classes = json.loads(_canonform.agreement(paths))
        if trains:
            workers = 1 if client is None else max(1, len(client.nthreads()))
            facts.partitions = _vectors.train(stored, workers, lambda make, items: _mapped(client, make, items, call))
            facts.probes, facts.recall = _vectors.calibrate(stored)
    if trains or new:
        facts.options, facts.shards = Index(paths[0])._inner.options, stamps
        stored.update_schema_metadata({_vectors.ABOUT: json.dumps(vars(facts))})
    return {"n_shapes": n, "changed": changed} | {name: getattr(facts, name) for name in ("partitions", "probes", "recall")}


def _refuse_repeated(paths: list[str]) -> None:
    seen: dict[int, str] = {}
    for path in paths:
        for name in Index(path):
            first = seen.setdefault(hash(name), path)
            if first != path:
                raise ShapeIndexError(f"{first} and {path} have a shape {name!r} each; rename one of them, or merge the indexes")


def search(
    table: AnyPath,
    query: AnyMesh,
    k: int = 10,
    *,
    rank: Ranking = "plain",
    explain: bool = False,
    exact: bool = False,
    client: Client | None = None,
    where: Mapping[str, str | Sequence[str]] | None = None,
    retries: int = 3,
    **call: Unpack[Call],
) -> SearchResults:
    """Find the shapes nearest to a query in all indexes of a `table` of `vector_table`, as `Index.search` does in one.

    Candidates come from the table. Their forms are aligned by tasks that open the index of each, and the best of all are the results;
    `report["recall"]` is the measured share of the ten nearest signatures that such a search finds.

    Args:
        query: A surface, a mesh as `Surface` takes it, a mesh file, or the name of a shape. It is described by this process.
        k, explain: As in `Index.search`.
        rank: "plain", "part" or "forms", as in `Index.search`; the last two compare the query with every shape, where its index is.
        client: A `distributed.Client` whose workers align forms. They must see the indexes under the same paths, and their meshes if
            results are explained. By default this process does it.
        exact: Compare the signatures of all shapes, where their indexes are. The results are then those of one index of all shapes.
        where: The workers that see an index, by its path as in `vector_table`: addresses or names of hosts. By default all do.
        retries: How often a task that raised an exception is tried again.
    """
    if rank == "graph":
        raise OptionError(
            'rank="graph" needs the neighbors of all shapes, which several indexes do not know: merge them with Index.merge and search '
            'the result, or use "plain", "part" or "forms"'
        )
    start = time.perf_counter()
    with running(call):
        shards = _Search(os.path.abspath(table), client, exact, where or {}, retries, call)
        packed, surface, name = shards.packed(query, word("rank", rank), explain)
        described = time.perf_counter()
        report = shards.report(packed, whole("k", k), rank, explain)
        if explain:
            report["components"] = [
                json.loads(about) | {"nearest": next(iter(shards.report(part, 1, "plain", explain)["results"]), None)}
                for about, part in _canonform.query_components(packed)
            ]
    report = {key: value for key, value in report.items() if value or key not in ("components", "wholes")}
    report["seconds"] = {"describe": described - start, "search": time.perf_counter() - described}
    return SearchResults(report, surface or name, name, _Shards(shards.shards_of))


class _Shards(Stored):
    """The indexes that hold some shapes."""

    def __init__(self, of: dict[str, str]) -> None:
        self.of = of

    def surface(self, id: str) -> Surface:
        return Index(self.of[id]).surface(id)


class _Search:
    """A search in the indexes of a table, which are as the table states them when it begins."""

    def __init__(
        self, uri: str, client: Client | None, exact: bool, where: Mapping[str, str | Sequence[str]], retries: int, call: Call
    ) -> None:
        self.table, self.folder, self.client, self.exact = _vectors.opened(uri), os.path.dirname(uri), client, exact
        self.retries, self.call = retries, call
        self.facts = _vectors.about(self.table)
        if not self.facts.options:
            raise OptionError(f"{uri} is not a table of vector_table")
        self.workers = {os.path.abspath(path): [at] if isinstance(at, str) else list(at) for path, at in where.items()}
        self.shards_of: dict[str, str] = {}

    def ask(self, method: str, items: Iterable[tuple[Any, ...]]) -> list[Any]:
        """What indexes answer, each asked with some arguments."""
        asked = [(os.path.join(self.folder, shard), method, *arguments) for shard, *arguments in items]
        return _mapped(self.client, _ask, asked, self.call, self.retries, [self.workers.get(item[0]) for item in asked])

    def packed(self, query: AnyMesh, rank: str, explain: bool) -> tuple[str, Surface | None, str]:
        """A described query, its surface if it is known, and what it is called."""
        name = os.fspath(query) if isinstance(query, (str, os.PathLike)) else ""
        if name and not os.path.exists(name):
            escaped = name.replace("'", "''")
            found = self.table.to_table(columns=["shard"], filter=f"id = '{escaped}'")["shard"].to_pylist()
            if not found:
                raise NoSuchShapeError(f"{name!r} is neither a file nor a shape of the table")
            return self.ask("query_of", [(found[0], name, rank, explain)])[0], None, name
        surface = Surface(name) if name else surface_of(query)
        name = os.path.basename(name) or surface._name or "the query"
        return _canonform.query_of_surface(surface._inner, self.facts.options, name, rank, explain), surface, name

    def report(self, packed: str, k: int, rank: str, explain: bool) -> dict[str, Any]:
        """The report on a query, without its components."""
        n, facts = self.table.count_rows(), self.facts
        n_candidates, wanted = _canonform.shortlist(k)
        asked: dict[str, list[str] | None] = dict.fromkeys(facts.shards)
        if rank == "plain" and not self.exact:
            candidates: dict[str, list[str]] = {}
            row = _vectors.padded(self.table, np.array(json.loads(packed)["shape"]["fused"], np.float32))
            for _, id, shard in _vectors.nearest(self.table, row, n_candidates, facts.probes):
                candidates.setdefault(shard, []).append(id)
            asked = {**candidates}
        classes = json.dumps(facts.classes)
        answers = self.ask("search_among", [(shard, packed, ids, wanted, rank, False, classes) for shard, ids in asked.items()])
        report: dict[str, Any] = json.loads(_canonform.merge_answers(packed, answers, classes, k))
        report |= {"n_shapes": n, "measured": n, "rank_by": rank}
        if facts.probes and rank == "plain" and not self.exact:
            loose = _vectors.unindexed(self.table)
            report |= {"recall": facts.recall, "measured": loose + round((n - loose) * min(1, facts.probes / facts.partitions))}
        results = {result["id"]: result for result in report["results"]}
        held = {
            shard: [result["id"] for result in json.loads(answer)["results"] if result["id"] in results]
            for shard, answer in zip(asked, answers, strict=True)
        }
        self.shards_of |= {id: os.path.join(self.folder, shard) for shard, ids in held.items() for id in ids}
        if explain:
            items = [(shard, packed, held.get(shard, []), len(held.get(shard, [])), rank, True, classes) for shard in facts.shards | held]
            explained = [json.loads(some) for some in self.ask("search_among", items)]
            for result in (result for some in explained for result in some["results"]):
                results[result["id"]] |= {key: result[key] for key in ("relation", "comparison")}
            wholes = [whole for some in explained for whole in some.get("wholes", [])]
            wholes.sort(key=lambda found: (found["distance"], found["id"]))
            report["wholes"] = [whole | {"rank": place} for place, whole in enumerate(wholes[:_MOST_WHOLES], 1)]
        return report


_MOST_WHOLES = 10


def _mapped(
    client: Client | None,
    task: Callable[..., Any],
    items: list[tuple[Any, ...]],
    call: Call,
    retries: int = 3,
    workers: Sequence[list[str] | None] = (),
    stage: str = "tasks",
    weights: Sequence[int] = (),
) -> list[Any]:
    """The results of a task for each of these arguments, the first of which begin first, on workers or here.

    After an error, the end of the time, or Ctrl-C, the other tasks are cancelled.
    """
    if client is None:
        return [task(*item) for item in items]
    limits = {name: value for name, value in call.items() if name in ("timeout", "memory")}
    places = workers or [None] * len(items)
    tasks = [client.submit(_within, limits, task, *item, workers=at, pure=False, retries=retries) for item, at in zip(items, places, strict=True)]
    weight = dict(zip((task.key for task in tasks), weights or [1] * len(tasks), strict=True))
    results: dict[str, Any] = {}
    done, total, timeout = 0, sum(weight.values()), call.get("timeout")
    try:
        with shown(call.get("progress", False)) as update:
            for future, result in _dask().as_completed(tasks, with_results=True, timeout=timeout):
                results[future.key] = result
                done += weight[future.key]
                if update is not None:
                    update(stage, done, total)
    except BaseException as fault:
        client.cancel(tasks)
        if isinstance(fault, TimeoutError) and not isinstance(fault, CanonformError):
            raise TimeLimitError(f"not finished within the time limit of {timeout:g} seconds; raise timeout=") from fault
        raise
    return [results[future.key] for future in tasks]


def _within(limits: Call, task: Callable[..., Any], *arguments: Any) -> Any:
    """Runs a task under the limits of the call that it is for, on the threads that Dask gave the worker."""
    with running({**limits, "threads": _dask().get_worker().state.nthreads}):
        return task(*arguments)


def _ask(path: str, method: str, *arguments: Any) -> Any:
    """What an index answers."""
    return getattr(_opened(path, _vectors.stamp(path)), method)(*arguments)


@lru_cache(maxsize=64)
def _opened(path: str, _: tuple[int, int]) -> _canonform.Index:
    """An index, opened again after it has changed."""
    return _canonform.Index.open(path)


def _dask() -> Any:
    return optional("distributed", "canonform.distributed needs Dask: pip install 'canonform[dask]'")


def _describe(
    dataset: str, shapes: list[tuple[str, str, str]], place: str, label_file: str | None, settings: dict[str, Any]
) -> tuple[str, dict[str, Any]]:
    """Makes the index of a batch, on a worker. Returns its path and report."""
    contents = _canonform.content_hashes([path for _, _, path in shapes])
    parts = settings, [(*shape, content) for shape, content in zip(shapes, contents, strict=True)]
    path = os.path.join(place, f"{hashlib.sha256(json.dumps(parts, default=str).encode()).hexdigest()[:32]}.canonform")
    # An unfinished batch is resumed, and one that is there is recognized by the content of its meshes.
    names = {name for name, _, _ in shapes}
    report = _canonform.Index.build(dataset, path, label_file, False, None, names, False, settings)
    return path, json.loads(report)
