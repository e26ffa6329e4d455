"""Pickles and copies of everything, and equality."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, is_typeddict

import canonform
import numpy as np
import pytest
from canonform import Index, Surface
from canonform.datasets import Shape
from canonform.errors import CanonformError
from conftest import grid


def _again(value: Any) -> Any:
    """What a worker returns: pickled there and back."""
    return value


@pytest.fixture(scope="module")
def everything(cats: list[Shape], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("stored")
    [file] = canonform.datasets.write(cats[:1], folder)
    a, b = canonform.read(file), cats[1].surface()
    index = Index.build(folder, folder / "cats.canonform")
    found = canonform.match(a, b, n_eigenfunctions=40)
    a_form, b_form = (surface.canonical_form(n_landmarks=40, seed=3) for surface in (a, b))
    return {
        "surface": a,
        "report": a.repair_report,
        "repaired": a.repaired,
        "distances": a.distances(3),
        "form": a_form,
        "finer": a_form.finer(Surface(cats[0].vertices, cats[0].faces)),
        "field": a.distance_field(20),
        "pairs": a.distance_field(20).pairs([[3, 5], [7, 9]]),
        "pair": a.distance_field(20).pair(3, 5),
        "path": a.path(3, 700),
        "shape": cats[0],
        "alignment": canonform.align(a_form, b_form),
        "comparison": canonform.compare(a, b),
        "match": found,
        "index": index,
        "search": index.search(b),
        "result": index.search(b)[0],
        "entry": index["cat0"],
        "scores": canonform.Scores(nn=1.0, classes=["a"], confusion=[[3]]),
        "basis": a.eigenbasis(12),
        "nearest": a.closest_point([[0.0, 0.0, 0.0]]),
        "map": found.best,
        "mapped": found.best.points(),
        "edge point": canonform.EdgePoint(3, 4, 0.25),
        "face point": canonform.FacePoint(8, (2.0, 1.0, 1.0)),
        "marching": canonform.FastMarching(update="planar"),
        "nystrom": canonform.Nystrom(rank=9),
        "landmark": canonform.Landmark(sampling="random"),
        "spectral": canonform.Spectral(mu=5.0),
        "kernel": canonform.KernelPca(sigma="median"),
        "smacof": canonform.Smacof(max_iterations=5),
        "view": a.view(),
        "estimator": canonform.NystromMDS(n_landmarks=20).fit(cats[0].vertices),
        "error": canonform.errors.PointError("no such vertex"),
    }


def test_a_surface_and_its_form_come_back(square: Surface) -> None:
    surface, form = (pickle.loads(pickle.dumps(value)) for value in (square, square.canonical_form(20)))
    np.testing.assert_array_equal(surface.distances(5), square.distances(5))
    np.testing.assert_array_equal(form.points, square.canonical_form(20).points)


@pytest.mark.slow
def test_every_public_type_is_among_them(everything: dict[str, Any]) -> None:
    public = {getattr(canonform, name) for name in canonform.__all__ if isinstance(getattr(canonform, name), type)}
    public = {kind for kind in public if not is_typeddict(kind)}
    stored = {kind for value in everything.values() for kind in type(value).__mro__}
    assert public <= stored, public - stored


@pytest.mark.slow
def test_everything_goes_through_a_process_pool(everything: dict[str, Any]) -> None:
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=context) as pool:
        found = dict(zip(everything, pool.map(_again, everything.values()), strict=True))
    for name, value in everything.items():
        assert type(found[name]) is type(value), name
        assert repr(found[name]) == repr(value), name
    by_value = ["repaired", "pairs", "pair", "path", "shape", "result", "entry", "report", "basis", "nearest", "mapped", "edge point"]
    methods = ["face point", "marching", "nystrom", "landmark", "spectral", "kernel", "smacof"]
    for name in [*by_value, *methods]:
        assert found[name] == everything[name], name
    surface, again = everything["surface"], found["surface"]
    np.testing.assert_array_equal(again.distances(5), surface.distances(5))
    # The hash of the file goes along.
    assert canonform.compare(surface, again).match == "identical-file"
    assert not again.vertices.flags.writeable and again.repair_report == surface.repair_report
    field = everything["field"]
    assert found["field"].pairs([[3, 700]]) == field.pairs([[3, 700]]) and found["field"].facts == field.facts
    assert [result.id for result in found["search"]] == [result.id for result in everything["search"]]
    np.testing.assert_array_equal(found["comparison"].residuals, everything["comparison"].residuals)
    np.testing.assert_array_equal(found["match"].best.vertices, everything["match"].best.vertices)
    np.testing.assert_array_equal(found["map"].transfer(np.arange(1000)), everything["map"].transfer(np.arange(1000)))
    np.testing.assert_array_equal(found["estimator"].embedding_, everything["estimator"].embedding_)
    assert found["match"].pictures(width=60) == everything["match"].pictures(width=60)
    assert found["index"].shapes() == everything["index"].shapes()


@pytest.mark.slow
@pytest.mark.parametrize("name", ["form", "finer"])
def test_a_form_is_made_again_only_when_needed(everything: dict[str, Any], name: str) -> None:
    form = everything[name]
    again = pickle.loads(pickle.dumps(form))
    for attribute in ("points", "faces", "eigenvalues", "landmarks"):
        np.testing.assert_array_equal(getattr(again, attribute), getattr(form, attribute))
    assert again.report == form.report and again.options == form.options and again._made is None
    assert not again.points.flags.writeable
    np.testing.assert_array_equal(again.distances, form.distances)
    np.testing.assert_array_equal(again.place([3, 700]), form.place([3, 700]))


@pytest.mark.slow
def test_copies_are_equal_and_constant_objects_are_their_copies(everything: dict[str, Any]) -> None:
    for name, value in everything.items():
        for made in (copy.copy(value), copy.deepcopy(value)):
            assert repr(made) == repr(value), name
    for name in ("surface", "form", "field"):
        assert copy.deepcopy(everything[name]) is everything[name]


@pytest.mark.slow
def test_other_versions_are_told(everything: dict[str, Any]) -> None:
    for name in ("surface", "form", "comparison", "path"):
        make, (kind, version, state) = everything[name].__reduce__()
        with pytest.raises(CanonformError, match=f"this {kind.__name__} was pickled in layout {version + 1}"):
            make(kind, version + 1, state)


@pytest.mark.slow
def test_joblib_stores_surfaces(everything: dict[str, Any], tmp_path: Path) -> None:
    joblib = pytest.importorskip("joblib")
    joblib.dump(everything["surface"], tmp_path / "cat.joblib")
    again = joblib.load(tmp_path / "cat.joblib")
    np.testing.assert_array_equal(again.distances(7), everything["surface"].distances(7))


@pytest.mark.parametrize(
    ("first", "second", "other"),
    [
        (lambda s: s.path(0, 80), lambda s: s.path(0, 80), lambda s: s.path(0, 79)),
        (lambda s: Shape("a", "b", *grid()), lambda s: Shape("a", "b", *grid()), lambda s: Shape("a", "b", *grid(size=2.0))),
        (lambda s: s.closest_point([0, 0, 1]), lambda s: s.closest_point([0, 0, 1]), lambda s: s.closest_point([0, 0, 2])),
    ],
)
def test_values_are_equal_and_hash(square: Surface, first: Callable, second: Callable, other: Callable) -> None:
    a, b, c = first(square), second(square), other(square)
    assert a == b and hash(a) == hash(b) and a != c and a != "a"
    assert len({a, b, c}) == 2
