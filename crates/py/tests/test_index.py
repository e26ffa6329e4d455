"""Indexes: building, changing, searching, classifying, scoring."""

from __future__ import annotations

import shutil
from pathlib import Path

import canonform
import numpy as np
import pytest
from canonform import Index
from canonform.datasets import Shape
from canonform.errors import MeshError, MissingFileError, NoSuchShapeError, OptionError, ShapeIndexError


def test_a_shape_finds_its_class(index: Index, collection: Path) -> None:
    assert len(index) == 9 and "cat1" in index and "dog" not in index
    found = index.search(canonform.read(collection / "cat1.off"), k=3)
    assert [result.label for result in found] == ["cat"] * 3
    assert found[0].id == "cat1" and found[0].distance < 1e-3 and found.label == "cat"
    assert index.classify("david0") == "david"
    assert [result.rank for result in found[:2]] == [1, 2]


def test_both_ranks_are_offered(index: Index) -> None:
    plain, graph = index.search("cat0", rank="plain"), index.search("cat0", rank="graph")
    assert plain[0].rank_distance is None and graph[0].rank_distance is not None
    scores = index.evaluate(rank="graph")
    assert scores["nn"] == 1.0 and scores["graph"]["nn"] == 1.0
    with pytest.raises(OptionError, match='use "plain", "graph", "part", "forms"'):
        index.search("cat0", rank="best")
    with pytest.raises(OptionError, match='use "plain" or "graph"'):
        index.evaluate(rank="part")


def test_forms_alone_order_results(index: Index) -> None:
    found = index.search("cat1", rank="forms")
    distances = [result.form_distance for result in found]
    assert found[0].id == "cat1" and None not in distances and distances == sorted(distances)
    assert index.search("cat1")[0].form_distance is None


def test_results_go_to_pandas(index: Index) -> None:
    frame = index.search("cat0", k=4).to_pandas()
    assert list(frame.columns) == ["id", "label", "distance", "fused", "relation", "path"]
    assert frame.loc[1, "id"] == "cat0" and len(frame) == 4
    assert index.to_pandas().loc["cat0", "label"] == "cat"


def test_vectors_are_the_signatures(index: Index, collection: Path) -> None:
    vectors = index.vectors()
    ids = list(index)
    assert vectors.shape == (9, len(index.vector("cat0")))
    signature = canonform.read(collection / "cat0.off").signature()
    np.testing.assert_array_equal(vectors[ids.index("cat0")], signature)


def test_an_index_is_changed_while_it_is_open(index: Index, collection: Path, tmp_path: Path, cat: Shape) -> None:
    index = Index(shutil.copy(index.path, tmp_path / "i.canonform"))
    extra = canonform.datasets.write([Shape("tom", "", cat.vertices * 2, cat.faces)], tmp_path / "extra")
    report = index.add(extra, label="cat")
    assert report["described"] == 1 and len(index) == 10
    assert index.search("tom", k=2)[1].label == "cat"
    assert index.remove("tom") == 9 and "tom" not in index
    again = Index.build(collection, index.path)
    assert again.build_report is not None and again.build_report["unchanged"] == 9


def test_labels_come_from_a_mapping_or_a_file(index: Index, collection: Path, tmp_path: Path) -> None:
    labels = {f"{name}{i}": kind for name, kind in [("cat", "beast"), ("centaur", "beast")] for i in range(3)}
    path = shutil.copy(index.path, tmp_path / "i.canonform")
    index = Index.build(collection, path, labels=labels)
    assert index.info()["classes"] == {"beast": 6} and index.info()["unlabelled"] == 3
    file = tmp_path / "labels.csv"
    file.write_text("cat0,x\n")
    assert Index.build(collection, path, labels=file).info()["classes"]["x"] == 1
    none = Index.build(collection, path, labels="none")
    assert none.info()["unlabelled"] == 9 and none.build_report is not None and none.build_report["labels_from"] == "none"
    quoted = Index.build(collection, path, labels={"cat0": 'a; "b", c'})
    assert quoted.info()["classes"] == {'a; "b", c': 1}
    with pytest.raises(OptionError, match="line break"):
        Index.build(collection, path, labels={"a": "b\nc"})


@pytest.mark.slow
def test_progress_is_reported(collection: Path, tmp_path: Path) -> None:
    seen = []
    Index.build(collection, tmp_path / "i.canonform", progress=lambda *step: seen.append(step))
    assert seen and all(isinstance(stage, str) and 0 <= done <= total for stage, done, total in seen)


def test_meshes_that_fail_are_listed(collection: Path, tmp_path: Path, cat: Shape) -> None:
    folder = tmp_path / "meshes"
    canonform.datasets.write([cat], folder)
    (folder / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n")
    index = Index.build(folder, tmp_path / "i.canonform")
    assert index.build_report is not None
    assert [failure["id"] for failure in index.build_report["failed"]] == ["broken"]
    (folder / "cat0.off").unlink()
    with pytest.raises(MeshError, match=r"broken\.off"):
        Index.build(folder, tmp_path / "none.canonform")


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda i, d: Index(d / "none.canonform"), MissingFileError, "none.canonform"),
        (lambda i, d: Index(d / "cat0.off"), ShapeIndexError, "not a shape index"),
        (lambda i, d: i.search("nobody"), NoSuchShapeError, "Index.shapes()"),
        (lambda i, d: i.remove(["nobody"]), NoSuchShapeError, "nobody"),
        (lambda i, d: i.vector("nobody"), NoSuchShapeError, "nobody"),
        (lambda i, d: i.evaluate(by="magic"), OptionError, "magic"),
        (lambda i, d: i.add(d / "cat0.off", label="x", labels={"a": "b"}), OptionError, "label="),
        (lambda i, d: Index.build(d / "nowhere", d / "x.canonform"), MissingFileError, "nowhere"),
        (lambda i, d: Index.build(d, i.path, n_landmarks=50), ShapeIndexError, "other options"),
        (lambda i, d: Index.build(d, i.path, shard=(5, 2)), OptionError, "shard 5 of 2"),
        (lambda i, d: Index.build(d, i.path, n_points=2), OptionError, "points"),
    ],
)
def test_errors_say_what_to_do(index: Index, collection: Path, call, kind: type[Exception], words: str) -> None:
    with pytest.raises(kind) as raised:
        call(index, collection)
    assert words in str(raised.value), str(raised.value)
    assert "--" not in str(raised.value)


@pytest.mark.slow
def test_a_shape_in_the_way_is_replaced_on_request(index: Index, collection: Path, tmp_path: Path, cat: Shape) -> None:
    own = Index.build(collection, tmp_path / "i.canonform")
    other = canonform.datasets.write([Shape("cat0", "", cat.vertices[:, [1, 0, 2]] * 3, cat.faces)], tmp_path / "other")
    with pytest.raises(ShapeIndexError, match="replace=True"):
        own.add(other)
    assert own.add(other, replace=True)["described"] == 1
