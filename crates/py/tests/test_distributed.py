"""Indexes and distances on several workers."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("distributed")

from canonform import Index  # noqa: E402
from canonform.distributed import _batches, build_index  # noqa: E402
from canonform.datasets import Shape  # noqa: E402
from canonform.errors import MeshError, OptionError  # noqa: E402
from distributed import Client  # noqa: E402

# Dask and its dependencies warn of their own affairs.
pytestmark = pytest.mark.filterwarnings("default")


@pytest.fixture
def single(index: Index) -> Index:
    """The index that one process makes."""
    return index


def exported(index: Index, folder: Path, name: str) -> bytes:
    index.export(folder / name)
    return (folder / name).read_bytes()


def test_batches_are_even_and_begin_with_the_largest() -> None:
    sizes = [5, 1, 1, 100, 1, 40, 1, 1, 50, 3]
    batches = _batches(sizes, 3)
    assert batches[0] == [3] and sorted(sum(batches, [])) == list(range(10))
    # 203 in all: a batch holds 67, unless one item is larger.
    assert [sum(sizes[item] for item in batch) for batch in batches] == [100, 50, 53]
    assert [max(sizes[item] for item in batch) for batch in batches] == [100, 50, 40]
    assert [len(batch) for batch in _batches([1] * 10, 1, most=4)] == [4, 4, 2]
    assert _batches([], 3) == [] and _batches([0, 0], 5) == [[0, 1]]


def test_two_workers_make_the_index_of_one_process(client: Client, single: Index, collection: Path, tmp_path: Path) -> None:
    seen = []
    index = build_index(
        collection, client, tmp_path / "many.canonform", n_batches=4, progress=lambda *step: seen.append(step)
    )
    assert exported(index, tmp_path, "many.jsonl") == exported(single, tmp_path, "single.jsonl")
    assert seen[-1] == ("shapes", 9, 9) and index.build_report is not None
    assert index.build_report["described"] == 9 and index.build_report["batches"] >= 4
    assert not (tmp_path / "many.canonform.shards").exists()
    assert index.search(collection / "cat1.off", k=1)[0].id == "cat1"


def test_meshes_in_memory_are_described_by_workers(client: Client, cats: list[Shape], tmp_path: Path) -> None:
    index = build_index(cats, client, tmp_path / "i.canonform")
    assert list(index) == ["cat0", "cat1"] and index.info()["classes"] == {"cat": 2}
    # Objects go to workers and back.
    surface = cats[0].surface()
    distances = client.submit(lambda surface: surface.distances(0), surface).result()
    np.testing.assert_array_equal(distances, surface.distances(0))
    form = client.submit(lambda surface: surface.canonical_form(n_landmarks=20), surface).result()
    np.testing.assert_array_equal(form.points, surface.canonical_form(n_landmarks=20).points)


@pytest.mark.slow
def test_a_finished_batch_is_not_described_again(client: Client, collection: Path, tmp_path: Path) -> None:
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    for mesh in collection.iterdir():
        (meshes / mesh.name).write_bytes(mesh.read_bytes())
    out = tmp_path / "i.canonform"
    build_index(meshes, client, out, n_batches=9, keep_shards=True)
    again = build_index(meshes, client, out, n_batches=9, keep_shards=True)
    assert again.build_report is not None
    assert (again.build_report["described"], again.build_report["unchanged"]) == (0, 9)
    # One mesh changes, though not its size or name.
    changed = meshes / "cat0.off"
    text = changed.read_text().splitlines()
    text[2], text[3] = text[3], text[2]
    changed.write_text("\n".join(text) + "\n")
    third = build_index(meshes, client, out, n_batches=9, keep_shards=True)
    assert third.build_report is not None and third.build_report["unchanged"] >= 6
    assert third.build_report["described"] >= 1


@pytest.mark.slow
def test_what_else_is_in_the_folder_of_the_shards_stays(client: Client, single: Index, collection: Path, tmp_path: Path) -> None:
    folder = tmp_path / "my results"
    folder.mkdir()
    own = {name: f"my {name}" for name in ("thesis.txt", "labels.csv", "meshes.txt", "mine.canonform")}
    for name, text in own.items():
        (folder / name).write_text(text)
    paths = sorted(collection.glob("*.off"))
    labels = {path.stem: path.stem.rstrip("0123456789") for path in paths}
    for keep in (True, False):
        index = build_index(
            paths, client, tmp_path / f"{keep}.canonform", labels=labels, n_batches=3, shards=folder, keep_shards=keep
        )
        assert list(index) == list(single) and index.build_report is not None
        assert {name: (folder / name).read_text() for name in own} == own
        shards = {path.name for path in folder.iterdir()} - set(own)
        assert len(shards) == (index.build_report["batches"] if keep else 0), shards


@pytest.mark.slow
def test_a_lost_worker_costs_its_batch_only(own_client: Client, single: Index, collection: Path, tmp_path: Path) -> None:
    shards = tmp_path / "shards"
    victims = own_client.run(os.getpid)
    victim = next(iter(victims.values()))
    finished: list[int] = []

    def kill_after_the_first(_: str, done: int, total: int) -> None:
        if not finished:
            os.kill(victim, signal.SIGKILL)
        finished.append(done)

    index = build_index(
        collection,
        own_client,
        tmp_path / "many.canonform",
        n_batches=9,
        shards=shards,
        keep_shards=True,
        progress=kill_after_the_first,
    )
    assert exported(index, tmp_path, "many.jsonl") == exported(single, tmp_path, "single.jsonl")
    assert finished[-1] == 9 and index.build_report is not None
    # Every batch was described to its end once: at most the one that the worker had was begun twice.
    assert index.build_report["described"] + index.build_report["unchanged"] == 9
    assert index.build_report["unchanged"] <= 1
    assert len(list(shards.glob("*.canonform"))) == index.build_report["batches"]


def test_failures_are_listed_and_nothing_at_all_is_an_error(client: Client, collection: Path, tmp_path: Path) -> None:
    meshes = tmp_path / "meshes"
    meshes.mkdir()
    (meshes / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n")
    with pytest.raises(MeshError, match="broken"):
        build_index(meshes, client, tmp_path / "none.canonform")
    (meshes / "cat0.off").write_bytes((collection / "cat0.off").read_bytes())
    index = build_index(meshes, client, tmp_path / "one.canonform", labels={"cat0": "feline"})
    assert index.build_report is not None
    assert [failure["id"] for failure in index.build_report["failed"]] == ["broken"]
    assert index.info()["classes"] == {"feline": 1}
    with pytest.raises(OptionError, match="geodesic="):
        build_index(collection, client, tmp_path / "bad.canonform", geodesic="magic")


@pytest.mark.slow
def test_paths_make_the_index_of_their_folder(client: Client, single: Index, collection: Path, tmp_path: Path) -> None:
    # The folder of the index decides which paths it states.
    paths = sorted(collection.glob("*.off"), reverse=True)
    alone = Index.build(iter(paths), tmp_path / "alone.canonform")
    index = build_index(iter(paths), client, tmp_path / "many.canonform", n_batches=4)
    expected = exported(single, tmp_path, "single.jsonl")
    assert exported(alone, tmp_path, "alone.jsonl") == expected
    assert exported(index, tmp_path, "many.jsonl") == expected
    assert len(build_index(paths[:2], client, tmp_path / "two.canonform")) == 2
    with pytest.raises(OptionError, match="give a folder"):
        build_index([], client, tmp_path / "none.canonform")
    with pytest.raises(OptionError, match="ends with space"):
        Index.build([f"{paths[0]} "], tmp_path / "none.canonform")
