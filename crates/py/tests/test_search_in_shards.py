"""Searching several indexes as one."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("lance")
pytest.importorskip("distributed")

import canonform  # noqa: E402
from canonform import Index, SearchResults, _vectors  # noqa: E402
from canonform.distributed import search, vector_table  # noqa: E402
from canonform.errors import MemoryLimitError, NoSuchShapeError, OptionError, ShapeIndexError, TimeLimitError  # noqa: E402
from distributed import Client  # noqa: E402

# Dask, Lance and their dependencies warn of their own affairs.
pytestmark = pytest.mark.filterwarnings("default")


@pytest.fixture(scope="module")
def whole(index: Index) -> Index:
    """One index of all shapes."""
    return index


@pytest.fixture(scope="module")
def built(collection: Path, tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    folder = tmp_path_factory.mktemp("shards")
    return [Index.build(collection, folder / f"part-{i}.canonform", shard=(i, 3)).path for i in (1, 2, 3)]


@pytest.fixture
def shards(built: list[str], tmp_path: Path) -> list[Path]:
    return [Path(shutil.copy(path, tmp_path)) for path in built]


def found(results: SearchResults) -> dict[str, object]:
    """All of a report that does not depend on where it was made."""
    report = {key: value for key, value in results.report.items() if key not in ("seconds", "aligned", "measured")}

    def named(result: dict[str, object]) -> dict[str, object]:
        return {**result, "path": os.path.basename(str(result["path"]))}

    for key in ("results", "wholes"):
        if key in report:
            report[key] = [named(result) for result in report[key]]
    for part in report.get("components", ()):
        part["nearest"] = named(part["nearest"])
    return report


def test_two_workers_find_what_one_index_finds(
    client: Client, whole: Index, shards: list[Path], collection: Path, tmp_path: Path
) -> None:
    table = tmp_path / "shapes.lance"
    made = vector_table(shards, table)
    assert made == {"n_shapes": 9, "changed": 9, "partitions": 0, "probes": 0, "recall": 1.0}
    for query, k in ((collection / "cat1.off", 0), (list(whole)[-1], 20), (canonform.read(collection / "cat0.off"), 4)):
        expected = found(whole.search(query, k))
        for workers, exact in ((None, True), (client, True), (client, False)):
            assert found(search(table, query, k, client=workers, exact=exact)) == expected
    with pytest.raises(NoSuchShapeError, match="nothing"):
        search(table, "nothing")
    results = search(table, collection / "cat1.off", 2)
    assert "cat" in results._repr_html_() and results.label == "cat"


def plate(meshes: list[Path]) -> tuple[np.ndarray, np.ndarray]:
    """Some meshes beside each other, the last two of them smaller."""
    vertices, faces, n = [], [], 0
    for i, path in enumerate(meshes):
        surface = canonform.read(path)
        vertices.append(surface.vertices / (1 + i) + [5.0 * i * np.ptp(surface.vertices), 0, 0])
        faces.append(surface.faces + n)
        n += len(surface.vertices)
    return np.concatenate(vertices), np.concatenate(faces)


@pytest.mark.slow
def test_all_rankings_and_explanations_are_those_of_one_index(
    client: Client, whole: Index, shards: list[Path], collection: Path, tmp_path: Path
) -> None:
    table = tmp_path / "shapes.lance"
    vector_table(shards, table)
    file, name = collection / "cat1.off", list(whole)[-1]
    in_memory = canonform.read(collection / "cat0.off")
    for query, rank, workers in ((file, "plain", client), (name, "part", client), (in_memory, "forms", None)):
        expected = found(whole.search(query, 3, rank=rank, explain=True))
        assert found(search(table, query, 3, rank=rank, explain=True, client=workers)) == expected
    with pytest.raises(OptionError, match=r"Index\.merge"):
        search(table, file, rank="graph")
    with pytest.raises(OptionError, match='"forms"'):
        search(table, file, rank="color")


@pytest.mark.slow
def test_components_are_found_in_other_indexes(client: Client, collection: Path, tmp_path: Path) -> None:
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    for mesh in sorted(collection.glob("*.off"))[:3]:
        shutil.copy(mesh, meshes)
    vertices, faces = plate(sorted(meshes.glob("*.off")))
    canonform.datasets.write([canonform.datasets.Shape("plate", "plate", vertices, faces)], meshes)
    whole = Index.build(meshes, tmp_path / "whole.canonform")
    parts = [Index.build(meshes, tmp_path / f"part-{i}.canonform", shard=(i, 2)).path for i in (1, 2)]
    vector_table(parts, tmp_path / "shapes.lance")
    for query, key in (("plate", "components"), (sorted(meshes.glob("*.off"))[0], "wholes")):
        expected = found(whole.search(query, 2, explain=True))
        assert expected[key]
        for workers in (None, client):
            assert found(search(tmp_path / "shapes.lance", query, 2, explain=True, client=workers)) == expected


@pytest.mark.slow
def test_a_killed_worker_costs_a_retry(own_client: Client, whole: Index, shards: list[Path], tmp_path: Path) -> None:
    table = tmp_path / "shapes.lance"
    vector_table(shards, table)
    expected = found(whole.search("cat1", 5))
    for exact in (True, False):
        victim = next(iter(own_client.run(os.getpid).values()))
        # Every worker is busy, so tasks of the search wait for the one that dies.
        busy = own_client.map(lambda seconds: time.sleep(seconds), [0.5, 0.5001], pure=False)
        threading.Timer(0.2, os.kill, (victim, signal.SIGKILL)).start()
        assert found(search(table, "cat1", 5, client=own_client, exact=exact)) == expected
        own_client.gather(busy)


@pytest.mark.slow
def test_shapes_are_added_while_others_search(
    client: Client, whole: Index, collection: Path, tmp_path: Path
) -> None:
    names = sorted(collection.glob("*.off"))
    parts = [tmp_path / "old.canonform", tmp_path / "new.canonform"]
    Index.build(names[:4], parts[0], labels="names")
    Index.build(names[4:6], parts[1], labels="names")
    table = tmp_path / "shapes.lance"
    vector_table(parts, table)
    seen: list[int] = []
    over = threading.Event()

    def searching() -> None:
        while not over.is_set():
            results = search(table, names[0], 20)
            assert results[0].id == names[0].stem and results[0].distance < 1e-6
            seen.append(len(results))

    thread = threading.Thread(target=searching)
    thread.start()
    try:
        for mesh in names[6:]:
            Index(parts[1]).add(mesh)
            assert vector_table(parts, table)["changed"] == 1
    finally:
        over.set()
        thread.join()
    # Every answer is that of some state in between.
    assert seen == sorted(seen) and set(seen) <= {6, 7, 8, 9}
    expected = [result.id for result in whole.search(names[0], 20)]
    assert [result.id for result in search(table, names[0], 20, client=client)] == expected
    assert vector_table(parts, table)["changed"] == 0
    Index(parts[0]).remove(names[1].stem)
    # Before the table knows, a shape that is gone is no result.
    assert names[1].stem not in [result.id for result in search(table, names[0], 20, client=client)]
    assert vector_table(parts, table) == {"n_shapes": 8, "changed": 1, "partitions": 0, "probes": 0, "recall": 1.0}


@pytest.mark.slow
def test_coded_vectors_state_their_recall(client: Client, tmp_path: Path) -> None:
    random = np.random.default_rng(0)
    centers = random.normal(size=(40, 20))
    vectors = (centers[random.integers(0, 40, 3000)] + 0.3 * random.normal(size=(3000, 20))).astype("f4")
    names = [f"s{i}" for i in range(3000)]
    path = str(tmp_path / "vectors.lance")
    rows = [_vectors.rows(names[i : i + 1000], [""] * 1000, [""] * 1000, "x.canonform", vectors[i : i + 1000]) for i in (0, 1000)]
    table = _vectors.create(path, rows)
    # A table of several fragments has a segment for each worker.
    table.insert(_vectors.rows(names[2000:], [""] * 1000, [""] * 1000, "x.canonform", vectors[2000:]))
    facts = _vectors.About(options="x")
    facts.partitions = _vectors.train(table, 2, lambda task, items: client.gather([client.submit(task, *i) for i in items]))
    facts.probes, facts.recall = _vectors.calibrate(table)
    assert facts.partitions == 54 and 0 < facts.probes < 54 and 0.95 < facts.recall <= 1
    [coded] = table.describe_indices()
    assert len(coded.segments) == 2 and _vectors.unindexed(table) == 0
    # New rows are found beside the coded ones.
    table.insert(_vectors.rows(["new"], [""], [""], "x.canonform", vectors[:1] + 1e-4))
    assert _vectors.unindexed(table) == 1
    near = _vectors.nearest(table, _vectors.padded(table, vectors[0]), 40, facts.probes)
    # Distances of coded vectors are estimates, so the ten nearest are among the candidates, in some order.
    truth = {names[i] for i in np.argsort(((vectors - vectors[0]) ** 2).sum(axis=1))[:10]}
    candidates = {name for _, name, _ in near}
    assert {"s0", "new"} <= candidates and len(truth & candidates) >= 9


@pytest.mark.slow
def test_an_export_is_a_table_of_vectors(whole: Index, tmp_path: Path) -> None:
    lancedb, parquet, pa = (pytest.importorskip(name) for name in ("lancedb", "pyarrow.parquet", "pyarrow"))
    whole.export(tmp_path / "shapes.parquet")
    whole.export(tmp_path / "vectors.lance")
    exported = parquet.read_table(tmp_path / "shapes.parquet")
    # Parquet knows lists only; LanceDB searches vectors of a fixed length.
    fused = exported["fused"].cast(pa.list_(pa.float32(), len(whole.vector("cat1"))))
    exported = exported.set_column(exported.schema.get_field_index("fused"), "fused", fused)
    database = lancedb.connect(tmp_path)
    expected = [name for name, _ in whole.nearest(whole.vector("cat1"), 9)]
    near = database.create_table("shapes", exported).search(whole.vector("cat1")).limit(9).to_list()
    assert [row["id"] for row in near] == expected
    assert {row["id"]: row["label"] for row in near} == {shape.id: shape.label for shape in whole.shapes()}
    assert np.array_equal(np.stack(exported["fused"].to_pylist()).astype("f4"), whole.vectors())
    query = _vectors.padded(database.open_table("vectors").to_lance(), whole.vector("cat1"))
    assert [row["id"] for row in database.open_table("vectors").search(query).limit(9).to_list()] == expected
    assert [found.id for found in search(tmp_path / "vectors.lance", "cat1", 9)] == [found.id for found in whole.search("cat1", 9)]


def test_other_programs_search_the_table(shards: list[Path], whole: Index, tmp_path: Path) -> None:
    lance_ray, ray = pytest.importorskip("lance_ray"), pytest.importorskip("ray")
    vector_table(shards, tmp_path / "shapes.lance")
    ray.init(num_cpus=2, log_to_driver=False, include_dashboard=False)
    try:
        query = _vectors.padded(_vectors.opened(str(tmp_path / "shapes.lance")), whole.vector("cat1"))
        near = {"column": "vector", "q": query, "k": 9}
        found = lance_ray.vector_search(str(tmp_path / "shapes.lance"), nearest=near, columns=["id"], num_workers=2)
    finally:
        ray.shutdown()
    assert found["id"].to_pylist() == [name for name, _ in whole.nearest(whole.vector("cat1"), 9)]


def test_calls_end_at_their_limits(client: Client, shards: list[Path], whole: Index, tmp_path: Path) -> None:
    table = tmp_path / "shapes.lance"
    vector_table(shards, table, timeout=60)
    for given in ({}, {"client": client}):
        with pytest.raises(TimeLimitError, match="timeout="):
            search(table, "cat1", timeout=1e-9, **given)
    with pytest.raises(MemoryLimitError, match="memory="):
        search(table, whole.surface("cat1"), memory=1000)
    assert len(search(table, "cat1", 3, client=client, timeout=60, memory="2G")) == 3


def test_mistakes_are_told(shards: list[Path], whole: Index, collection: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as without:
        without.setitem(sys.modules, "lance", None)
        with pytest.raises(ImportError, match=r"pip install 'canonform\[lance\]'"):
            vector_table(shards, tmp_path / "none.lance")
    with pytest.raises(OptionError, match="shards="):
        vector_table([], tmp_path / "none.lance")
    with pytest.raises(ShapeIndexError, match="'cat"):
        vector_table([*shards, whole.path], tmp_path / "twice.lance")
    with pytest.raises(ShapeIndexError):
        other = Index.build([collection / "cat0.off"], tmp_path / "other.canonform", n_landmarks=50)
        vector_table([shards[0], other.path], tmp_path / "other.lance")
    vector_table(shards, tmp_path / "shapes.lance")
    with pytest.raises(OptionError, match="part-3"):
        vector_table(shards[:2], tmp_path / "shapes.lance")
