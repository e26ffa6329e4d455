"""A Lance table with the fused vectors of many indexes: the shapes that a search in all of them begins with.

Columns: `id`, `label`, `path`, `shard` (the index, as seen from the folder of the table) and `vector`, padded with zeros. LanceDB, lance-ray
and whatever else reads Lance may search it, too. A reader keeps the version of the table that it opened.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._settings import optional

if TYPE_CHECKING:
    import lance
    import pyarrow

Vectors = NDArray[np.float32]

Near = tuple[float, str, str]
"""Squared distance, name, and shard of a shape."""

ABOUT = "canonform"
_NAME = "vector_idx"

LEAST = 50_000
"""Up to so many vectors all are compared, as in an index."""

_WIDTH = 8
"""Vectors are padded to a multiple of so many numbers, which Lance asks for."""

_RECALL = 0.99
_QUERIES = 200
"""Queries that choose how many partitions are searched, and as many others that measure the recall. One in a hundred is resolved."""

_NEAREST = 10
_CODED = 4
"""Numbers of a vector that one byte stands for. With 8, four vectors had to be read again for each result, at twice the time."""

_MOST_PARTITIONS = 1000
"""Finding the partition of each vector is most of coding: at 10^7, 3,000 partitions take three times as long."""

_BATCH = 8192


def lance_module() -> Any:
    """The package that reads and writes the tables."""
    return optional("lance", "tables of vectors need Lance: pip install 'canonform[lance]'")


@dataclass
class About:
    """What a table says about itself: how shapes were described, how well classes and distances agree, size and time of each index."""

    options: str = ""
    classes: dict[str, Any] | None = None
    shards: dict[str, list[int]] = field(default_factory=dict)
    # What a search visits, 0 if it compares all vectors.
    probes: int = 0
    partitions: int = 0
    # On queries that neither trained the partitions nor chose the probes.
    recall: float = 1.0


def opened(path: str, version: int | None = None) -> lance.LanceDataset:
    """A table as it is now, or was in some version, for reading: the caches of the process are kept, and nobody changes it."""
    known = _OPENED.get(path)
    if known is None:
        known = lance_module().dataset(path)
    wanted = known.latest_version if version is None else version
    found = known if known.version == wanted else known.checkout_version(wanted)
    _OPENED[path] = found
    return found


_OPENED: dict[str, Any] = {}


def about(table: lance.LanceDataset) -> About:
    """What a table says about itself."""
    stored = (table.schema.metadata or {}).get(ABOUT.encode())
    known = {} if stored is None else json.loads(stored)
    return About(**{name: value for name, value in known.items() if name in About.__dataclass_fields__})


def rows(ids: Iterable[str], labels: Iterable[str], paths: Iterable[str], shard: str, vectors: Vectors) -> pyarrow.Table:
    """Rows of a table."""
    import pyarrow as pa

    n, dim = vectors.shape
    padded = np.zeros((n, -(-dim // _WIDTH) * _WIDTH), np.float32)
    padded[:, :dim] = vectors
    return pa.table(
        {
            "id": pa.array(ids, pa.string()),
            "label": pa.array(labels, pa.string()),
            "path": pa.array(paths, pa.string()),
            "shard": pa.array([shard] * n, pa.string()),
            "vector": pa.FixedSizeListArray.from_arrays(pa.array(padded.reshape(-1)), padded.shape[1]),
        }
    )


def create(path: str, pieces: Iterable[pyarrow.Table]) -> lance.LanceDataset:
    """Makes a table of some pieces, in one step for its readers."""
    import pyarrow as pa

    pieces = iter(pieces)
    first = next(pieces)

    def batches() -> Iterator[Any]:
        yield from first.to_batches(_BATCH)
        for piece in pieces:
            yield from piece.to_batches(_BATCH)

    _OPENED.pop(path, None)
    reader = pa.RecordBatchReader.from_batches(first.schema, batches())
    lance_module().write_dataset(reader, path, mode="overwrite")
    return lance_module().dataset(path)


def change(table: lance.LanceDataset, shard: str, now: pyarrow.Table) -> int:
    """Makes the rows of a shard these. Returns how many are new or changed. Unchanged ones stay where they are."""
    import pyarrow.compute as compute

    before = table.to_table(columns=["id", "label", "vector"], filter=f"shard = '{shard.replace(chr(39), chr(39) * 2)}'")
    known = {name: place for place, name in enumerate(before["id"].to_pylist())}
    places = np.array([known.get(name, -1) for name in now["id"].to_pylist()], int)
    differs = places < 0
    if len(before):
        old, new = matrix(before), matrix(now)
        labels = np.array(before["label"].to_pylist(), object), np.array(now["label"].to_pylist(), object)
        differs |= (labels[0][places] != labels[1]) | (old[places] != new).any(axis=1)
    gone = set(known) - set(now["id"].to_pylist())
    if differs.any():
        changed = now.filter(differs)
        table.merge_insert("id").when_matched_update_all().when_not_matched_insert_all().execute(changed)
    if gone:
        table.delete(compute.field("id").isin(sorted(gone)))
    return int(differs.sum()) + len(gone)


def matrix(table: pyarrow.Table) -> Vectors:
    """The vectors of rows."""
    column = table["vector"].combine_chunks()
    return column.flatten().to_numpy(zero_copy_only=False).reshape(len(table), -1)


def nearest(table: lance.LanceDataset, query: Vectors, n: int, probes: int) -> list[Near]:
    """The shapes of a table nearest to a padded vector; with no probes, among all vectors."""
    near = {"column": "vector", "q": query, "k": n, "use_index": probes > 0} | ({"nprobes": probes} if probes else {})
    given = table.scanner(columns=["id", "shard", "_distance"], nearest=near).to_table().to_pydict()
    return sorted(zip(given["_distance"], given["id"], given["shard"], strict=True))


def padded(table: lance.LanceDataset, vector: Vectors) -> Vectors:
    """A vector as long as those of a table."""
    row: Vectors = np.zeros(table.schema.field("vector").type.list_size, np.float32)
    row[: len(vector)] = vector
    return row


def unindexed(table: lance.LanceDataset) -> int:
    """Rows that no segment of the vector index covers."""
    has_index = any(index.name == _NAME for index in table.describe_indices())
    return int(table.stats.index_stats(_NAME)["num_unindexed_rows"]) if has_index else table.count_rows()


def train(table: lance.LanceDataset, n_segments: int, run: Any) -> int:
    """Divides the vectors into partitions and codes them, in so many segments. `run` maps a function over the arguments of each, on
    workers or here. Returns the number of partitions, and leaves the table in the new version."""
    from lance.indices import IndicesBuilder

    n, builder = table.count_rows(), IndicesBuilder(table, "vector")
    partitions = min(max(1, int(np.sqrt(n))), _MOST_PARTITIONS)
    # As many samples for each partition as in an index, and for each of the 256 codes.
    samples, of_codes = (max(1, min(most, n // parts)) for most, parts in ((48, partitions), (64, 256)))
    ivf = builder.train_ivf(num_partitions=partitions, distance_type="l2", sample_rate=samples, max_iters=12)
    codes = builder.train_pq(ivf, num_subvectors=n_codes(table), sample_rate=of_codes, max_iters=12)
    fragments = [fragment.fragment_id for fragment in table.get_fragments()]
    parts = [fragments[i::n_segments] for i in range(min(n_segments, len(fragments)))]
    segments = run(segment_of, [(table.uri, table.version, part, ivf.centroids, codes.codebook) for part in parts])
    table.commit_existing_index_segments(_NAME, "vector", segments)
    return partitions


def n_codes(table: lance.LanceDataset) -> int:
    """Bytes of the code of a vector."""
    size: int = table.schema.field("vector").type.list_size
    return size // _CODED


def segment_of(path: str, version: int, fragments: list[int], centroids: Any, codebook: Any) -> Any:
    """One segment of the vector index."""
    table = opened(path, version)
    return table.create_index_uncommitted(
        "vector",
        "IVF_PQ",
        name=_NAME,
        metric="l2",
        fragment_ids=fragments,
        num_partitions=len(centroids),
        num_sub_vectors=n_codes(table),
        ivf_centroids=centroids,
        pq_codebook=codebook,
    )


def calibrate(table: lance.LanceDataset) -> tuple[int, float]:
    """How many partitions must be visited to find 99 of 100 of the ten nearest, and the recall reached, measured on other queries.

    Queries are vectors of the table, none of which finds itself.
    """
    places = np.random.default_rng(0).permutation(table.count_rows())[: 2 * _QUERIES]
    asked = table.take(np.sort(places).tolist(), columns=["id", "vector"])
    names, queries = asked["id"].to_pylist(), matrix(asked)
    found = [[name for _, name, _ in nearest(table, query, _NEAREST + 1, 0)] for query in queries]
    truth = [set([name for name in near if name != own][:_NEAREST]) for own, near in zip(names, found, strict=True)]
    halves = np.array_split(np.random.default_rng(1).permutation(len(names)), 2)

    def recall(chosen: NDArray[Any], probes: int) -> float:
        found = [{name for _, name, _ in nearest(table, queries[i], 4 * _NEAREST, probes)} for i in chosen]
        return float(np.mean([len(truth[i] & near) / max(1, len(truth[i])) for i, near in zip(chosen, found, strict=True)]))

    probes = 1
    while recall(halves[0], probes) < _RECALL and probes < table.count_rows():
        probes *= 2
    return probes, recall(halves[1], probes)


def stamp(path: str) -> tuple[int, int]:
    """What changes when an index does."""
    log = path + "-wal"
    files = [os.stat(file) for file in (path, log) if file == path or os.path.exists(file)]
    return sum(file.st_size for file in files), max(file.st_mtime_ns for file in files if file.st_size > 0)
