"""Meshes in memory, wherever meshes are taken, and what is told about wrong arguments."""

from __future__ import annotations

import gc
import os
import pickle
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import canonform
import numpy as np
import pytest
from canonform import FacePoint, Index, Surface
from canonform.datasets import Shape
from canonform.errors import (
    CanonformError,
    MeshError,
    MissingFileError,
    NoSuchShapeError,
    OptionError,
    PointError,
    ShapeIndexError,
    SkippedMeshWarning,
)
from conftest import grid

trimesh = pytest.importorskip("trimesh")


@pytest.fixture(scope="module")
def shapes() -> list[Shape]:
    return canonform.datasets.generate(["cat", "david"], poses=2, n_vertices=1000)


@pytest.fixture(scope="module")
def index(shapes: list[Shape], tmp_path_factory: pytest.TempPathFactory) -> Index:
    """One mesh of each kind that is in memory."""
    tom, tim, dave, don = shapes
    items: list[Any] = [
        ("tom", tom.surface(), "cat"),
        ("tim", trimesh.Trimesh(tim.vertices, tim.faces, process=False), "cat"),
        ("dave", (dave.vertices, dave.faces), "david"),
        don,
    ]
    return Index.build(iter(items), tmp_path_factory.mktemp("memory") / "i.canonform", keep_meshes=True)


def test_an_index_of_meshes_in_memory_is_complete(index: Index, shapes: list[Shape]) -> None:
    assert sorted(index) == ["dave", "david1", "tim", "tom"]
    assert index.info()["classes"] == {"cat": 2, "david": 2}
    np.testing.assert_array_equal(index.surface("tim").vertices, shapes[1].vertices)
    np.testing.assert_array_equal(index.vector("tom"), shapes[0].surface().signature())
    found = index.search("tom", k=2, explain=True)
    assert [result.label for result in found] == ["cat", "cat"]


def test_any_mesh_is_a_query(index: Index, shapes: list[Shape]) -> None:
    cat = shapes[0]
    for query in (cat, trimesh.Trimesh(cat.vertices, cat.faces, process=False), (cat.vertices, cat.faces), index.surface("tom")):
        assert index.search(query, k=1)[0].id == "tom"
    assert index.classify(shapes[2]) == "david"


def test_a_vector_is_a_query_by_signatures(index: Index, shapes: list[Shape]) -> None:
    [(name, distance), (other, _)] = index.nearest(shapes[0].surface().signature(), k=2)
    assert (name, distance, other) == ("tom", 0.0, "tim")
    assert index.nearest(index.vector("dave"), k=1)[0][0] == "dave"


def test_meshes_in_memory_are_added(index: Index, shapes: list[Shape], tmp_path: Path) -> None:
    own = Index.build({"tom": shapes[0], "dave": shapes[2]}, tmp_path / "own.canonform", keep_meshes=True)
    assert own.info()["unlabelled"] == 2
    own.add([("tim", shapes[1], "cat")])
    own.add({"don": shapes[3]}, label="david")
    assert own.info()["classes"] == {"cat": 1, "david": 1} and len(own) == 4
    with pytest.raises(ShapeIndexError, match="replace=True"):
        own.add({"tom": shapes[1]})
    np.testing.assert_array_equal(own.surface("tom").vertices, shapes[0].vertices)
    own.add({"tom": shapes[1]}, replace=True)
    np.testing.assert_array_equal(own.surface("tom").vertices, shapes[1].vertices)
    again = Index.build({"tom": shapes[1], "dave": shapes[2]}, own.path)
    assert again.build_report is not None and again.build_report["unchanged"] == 2
    # Building again replaces: the others are not among the meshes any more.
    assert sorted(again) == ["dave", "tom"]


@pytest.mark.slow
def test_an_index_from_memory_has_no_surprises(shapes: list[Shape], tmp_path: Path) -> None:
    tom, tim, dave, don = shapes
    bad = (np.full((4, 3), np.nan), [[0, 1, 2]])
    meshes = {"cats/tom": tom, "cats/tim": tim, "bad": bad, "none": object(), "men/dave": dave, "men/don": don}
    with pytest.warns(SkippedMeshWarning, match="2 of the meshes are not in the index"):
        index = Index.build(meshes, tmp_path / "i.canonform", labels=["cat", "cat", "", "", "david", "david"])
    assert sorted(failure["id"] for failure in index.build_report["failed"]) == ["bad", "none"]
    assert list(index) == ["cats/tim", "cats/tom", "men/dave", "men/don"]
    assert index["cats/tom"].label == "cat" and index["cats/tom"].n_vertices == 1000
    with pytest.raises(NoSuchShapeError):
        index["tom"]
    # Nothing is left beside it, and what needs the meshes says so.
    assert not (tmp_path / "i.canonform.meshes").exists()
    with pytest.raises(MissingFileError, match="keep_meshes=True"):
        index.surface("cats/tom")
    assert [index.search(query, k=1)[0].id for query in (tom, "men/don")] == ["cats/tom", "men/don"]
    # Without its own vote: a class of one shape is unknown, or the other class.
    assert index.classify("cats/tom") == "cat"
    alone = Index.build({"cat1": tom, "cat2": tim, "dave": dave}, tmp_path / "alone.canonform", labels=["cat", "cat", "david"])
    assert alone.classify("dave") is None and alone.search("dave").label is None
    again = Index.build({"cats/tom": tom}, index.path)
    assert list(again) == ["cats/tom"] and again.build_report["unchanged"] == 1


@pytest.mark.slow
def test_an_index_is_evaluated_by_any_distances(shapes: list[Shape], tmp_path: Path) -> None:
    pytest.importorskip("pandas")
    names = [f"{shape.name}-{i}" for i in range(2) for shape in shapes]
    index = Index.build(dict(zip(names, 2 * shapes, strict=True)), tmp_path / "i.canonform", labels=[name[:3] for name in names])
    combined = index.evaluate(by="combined")
    assert combined["nn"] == 1 and combined == index.evaluate(by=index.distances())
    assert combined.to_pandas().loc["cat"].tolist() == [4, 0]
    classes = np.array(["odd", "even"] * 4)
    assert index.evaluate(by=1.0 * (classes[:, None] != classes), labels=classes.tolist())["map"] == 1
    with pytest.raises(OptionError, match="by must be"):
        index.evaluate(by=np.zeros((2, 2)))


@pytest.mark.slow
def test_compare_match_and_align_take_any_mesh(shapes: list[Shape], tmp_path: Path) -> None:
    a, b = shapes[:2]
    expected = canonform.compare(a.surface(), b.surface()).distance
    [file] = canonform.datasets.write([b], tmp_path, format="ply")
    for other in (b, file, Path(file), (b.vertices, b.faces), trimesh.Trimesh(b.vertices, b.faces, process=False)):
        assert canonform.compare(a, other).distance == pytest.approx(expected)
    assert canonform.match((a.vertices, a.faces), file, n_eigenfunctions=30).best.vertices.shape == (1000,)
    assert canonform.align(a, a.surface().canonical_form(stress="skip")).rms < 1e-6


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda s, i: canonform.compare(s, object()), MeshError, "object is not a mesh"),
        (lambda s, i: canonform.compare("nowhere.off", s), canonform.errors.MissingFileError, "nowhere.off"),
        (lambda s, i: canonform.match(s, None), MeshError, "NoneType is not a mesh"),
        (lambda s, i: canonform.align(s, [[1, 2, 3]]), MeshError, "at least 12 points"),
        (lambda s, i: Surface([[0, 0, 0], [1, 2]], [[0, 1, 2]]), MeshError, "as many in each row"),
        (lambda s, i: Surface(SimpleNamespace(points=1, cells=1, extract_surface=1)), MeshError, "extract_surface"),
        (lambda s, i: s.distances(None), PointError, "None is not a point"),
        (lambda s, i: s.distances([0.5]), PointError, "0.5 is not a point"),
        (lambda s, i: s.distances(np.array([0.5])), PointError, "0.5 is not a point"),
        (lambda s, i: s.distances(-1), PointError, "-1 is not a vertex"),
        (lambda s, i: s.distances(2**70), PointError, "is not a point"),
        (lambda s, i: s.path(0.5, 3), PointError, "0.5 is not a point"),
        (lambda s, i: s.path(0, None), PointError, "None is not a point"),
        (lambda s, i: s.distances(0, max_distance="far"), OptionError, "max_distance='far'"),
        (lambda s, i: s.farthest_points(-1), OptionError, "n_points=-1 is not possible"),
        (lambda s, i: s.farthest_points(3, first=-1), OptionError, "first=-1"),
        (lambda s, i: s.distance_field(-3), OptionError, "n_landmarks=-3"),
        (lambda s, i: s.canonical_form(n_landmarks=-1), OptionError, "n_landmarks=-1 is not possible"),
        (lambda s, i: s.canonical_form(seed=-1), OptionError, "seed=-1"),
        (lambda s, i: canonform.Nystrom(rank=[3]), OptionError, "rank=[3]"),
        (lambda s, i: s.canonical_form(memory=1.5), OptionError, "memory=1.5"),
        (lambda s, i: s.canonical_form(method=5), OptionError, "method=5"),
        (lambda s, i: s.distances(0, geodesic=5), OptionError, "geodesic=5"),
        (lambda s, i: s.signature(3), OptionError, "kind=3"),
        (lambda s, i: i.search("tom", k=-1), OptionError, "k=-1"),
        (lambda s, i: i.search("tom", k=1.5), OptionError, "k=1.5"),
        (lambda s, i: i.search(3), MeshError, "int is not a mesh"),
        (lambda s, i: i.evaluate(k=-1), OptionError, "k=-1"),
        (lambda s, i: i.add([("a/b", s)]), OptionError, "'a/b'"),
        (lambda s, i: i.add([("a", s, "x", 4)]), OptionError, "meshes[0]"),
        (lambda s, i: i.add([("a", s), ("a", s)]), OptionError, "two meshes"),
        (lambda s, i: i.add([object()]), MeshError, "object is not a mesh"),
        (lambda s, i: i.nearest([1, 2]), ShapeIndexError, "2"),
        (lambda s, i: i.nearest("tom"), OptionError, "vector must be"),
        (lambda s, i: i.add(5), OptionError, "meshes=5"),
        (lambda s, i: canonform.datasets.generate("cat", n_vertices=-1), OptionError, "n_vertices=-1"),
        (lambda s, i: canonform.datasets.generate("cat", n_vertices=1000, seed=-1), OptionError, "seed=-1"),
        (lambda s, i: canonform.set_threads(-1), OptionError, "n=-1"),
        (lambda s, i: canonform.set_threads("all"), OptionError, "n='all'"),
        (lambda s, i: s.distances(0, memory="64X"), OptionError, "memory='64X'"),
        (lambda s, i: s.distances(FacePoint(3, ("a", 1, 1))), PointError, "is not a point"),
        (lambda s, i: Index.build([s], "x", shard=("a", 2)), OptionError, "shard='a'"),
        (lambda s, i: canonform.datasets.generate("cat", poses=[1.5]), OptionError, "poses=1.5"),
        (lambda s, i: canonform.datasets.generate(5), OptionError, "family=5"),
        (lambda s, i: canonform.compare(s, s, names="a"), OptionError, "names='a'"),
        (lambda s, i: i.distances([3]), OptionError, "ids=3"),
        (lambda s, i: i.duplicates(kinds=["x"]), OptionError, 'kinds="x" is not possible: use "identical-file"'),
        (lambda s, i: s.picture(width="x"), OptionError, "width='x'"),
        (lambda s, i: s.picture(view="above"), OptionError, "view='above'"),
        (lambda s, i: s.picture(colormap="jet"), OptionError, 'use "viridis", "magma"'),
        (lambda s, i: s.picture(points=[99]), PointError, "99 is not a point"),
        (lambda s, i: canonform.FastMarching(update=3), OptionError, "update=3 is not possible: use text"),
        (lambda s, i: s.farthest_points(3, first=2**40), PointError, "1099511627776"),
    ],
)
def test_every_error_is_ours(index: Index, square: Surface, call: Callable, kind: type[Exception], words: str) -> None:
    with pytest.raises(CanonformError) as raised:
        call(square, index)
    assert type(raised.value) is kind and words in str(raised.value), repr(raised.value)


@pytest.mark.slow
def test_generated_shapes_come_with_their_true_maps() -> None:
    a, b = canonform.datasets.generate("cat", poses=2, n_vertices=1000)
    truth = a.true_map(b)
    assert truth.shape == (1000,) and a.rest is not None and b.rest is not None
    spacing = np.sqrt(b.surface().area / 1000)
    assert np.linalg.norm(a.rest - b.rest[truth], axis=1).max() < 2 * spacing
    np.testing.assert_array_equal(a.true_map(a), np.arange(1000))
    found = {m.kind: m for m in canonform.match(a, b, n_eigenfunctions=60).maps}["direct"]
    error = b.surface().distances_many(truth[::50])[np.arange(20), found.vertices[::50]]
    assert np.median(error) < 3 * spacing
    first, second = canonform.datasets.generate("person", poses=[0, 3], n_vertices=1000)
    assert (first.name, second.name, first.label) == ("person0", "person3", "person")
    assert len(set(first.true_map(second).tolist())) > 500
    dog = canonform.datasets.generate("david", poses=1, n_vertices=1000)[0]
    with pytest.raises(OptionError, match="no true map"):
        a.true_map(dog)


def _resident() -> int:
    """The memory that is resident now, in bytes."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc")
@pytest.mark.slow
def test_ten_thousand_calls_take_no_more_memory(index: Index, square: Surface) -> None:
    field, form, basis = square.distance_field(10), square.canonical_form(20), square.eigenbasis(9)
    at, vector = canonform.FacePoint(8), index.vector("tom")

    def wrong() -> None:
        with pytest.raises(CanonformError):
            square.distances(81)

    calls: dict[str, Callable[[], object]] = {
        "distances": lambda: square.distances(7),
        "exact distances": lambda: square.distances(at, geodesic="exact"),
        "options": lambda: square.distances(3, geodesic=canonform.FastMarching(update="planar")),
        "distances_many": lambda: square.distances_many([0, 5]),
        "path": lambda: square.path(0, 80),
        "farthest_points": lambda: square.farthest_points(5),
        "closest_point": lambda: square.closest_point([0.3, 0.2, 1.0]),
        "gradient": lambda: square.gradient(square.vertices[:, 0]),
        "laplacian": lambda: square.laplacian(),
        "signature": lambda: square.signature(),
        "hks": lambda: basis.hks(n_times=4),
        "pair": lambda: field.pair(3, 70),
        "pairs": lambda: field.pairs([[3, 70], [4, 5]]),
        "nearest": lambda: field.nearest(3, 4),
        "place": lambda: form.place(11),
        "points": lambda: form._inner.points(),
        "vector": lambda: index.vector("tom"),
        "index.nearest": lambda: index.nearest(vector, k=2),
        "contains": lambda: "tom" in index,
        "shapes": lambda: index.shapes(),
        "an error": wrong,
        "a surface": lambda: Surface(square.vertices, square.faces),
        "a pickle": lambda: pickle.loads(pickle.dumps(square)),
        "a method": lambda: canonform.Nystrom(rank=9),
    }
    for name, call in calls.items():
        for _ in range(300):
            call()
        gc.collect()
        before = _resident()
        for _ in range(10_000):
            call()
        gc.collect()
        grown = _resident() - before
        # A leak of 200 bytes a call would show; allocators keep a little.
        assert grown < 2_000_000, f"{name}: {grown} bytes"
