"""The estimators of scikit-learn."""

from __future__ import annotations

import pickle
import time

import canonform
import numpy as np
import pytest

pytest.importorskip("sklearn")

from canonform import NystromMDS  # noqa: E402
from canonform.datasets import Shape  # noqa: E402
from sklearn.base import clone  # noqa: E402
from sklearn.datasets import make_swiss_roll  # noqa: E402
from sklearn.metrics import pairwise_distances  # noqa: E402
from sklearn.neighbors import KNeighborsClassifier, kneighbors_graph  # noqa: E402
from sklearn.pipeline import make_pipeline  # noqa: E402
from sklearn.utils.estimator_checks import parametrize_with_checks  # noqa: E402


@parametrize_with_checks(
    [
        NystromMDS(n_components=1),
        NystromMDS(n_components=1, sampling="random", random_state=0),
    ]
)
def test_estimator_checks(estimator, check) -> None:
    check(estimator)


def points(n: int, dim: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(n, dim))


def test_points_in_space_are_embedded_exactly_and_new_ones_placed_exactly() -> None:
    known, new = points(300, 3), points(50, 3, 1)
    mds = NystromMDS(n_landmarks=20).fit(known)
    np.testing.assert_allclose(pairwise_distances(mds.embedding_), pairwise_distances(known), atol=1e-8)
    placed = mds.transform(new)
    np.testing.assert_allclose(pairwise_distances(placed, mds.embedding_), pairwise_distances(new, known), atol=1e-7)
    np.testing.assert_allclose(mds.transform(known), mds.embedding_, atol=1e-9)
    np.testing.assert_array_equal(NystromMDS(n_landmarks=20).fit_transform(known), mds.embedding_)


def test_precomputed_distances_give_the_same_as_their_metric() -> None:
    known, new = points(100, 4), points(10, 4, 1)
    by_metric = NystromMDS(n_landmarks=15, n_components=4, metric="manhattan").fit(known)
    all_pairs = pairwise_distances(known, metric="manhattan")
    precomputed = NystromMDS(n_landmarks=15, n_components=4, metric="precomputed").fit(all_pairs)
    np.testing.assert_array_equal(precomputed.embedding_, by_metric.embedding_)
    to_all = pairwise_distances(new, known, metric="manhattan")
    for given in (to_all, to_all[:, precomputed.landmarks_]):
        np.testing.assert_allclose(precomputed.transform(given), by_metric.transform(new), atol=1e-12)


def test_a_function_embeds_any_metric_space() -> None:
    words = [a + b + c for a in "abcd" for b in "abcd" for c in "abcd"]

    def hamming(word: str, words: list[str]) -> list[float]:
        return [float(np.sqrt(sum(x != y for x, y in zip(word, other, strict=True)))) for other in words]

    mds = NystromMDS(n_landmarks=40, n_components=9, rank=16, metric=hamming).fit(words)
    apart = np.linalg.norm(mds.embedding_[0] - mds.embedding_, axis=1)
    np.testing.assert_allclose(apart, hamming(words[0], words), atol=1e-6)
    np.testing.assert_allclose(mds.transform(["aaa", "dcb"]), mds.embedding_[[0, words.index("dcb")]], atol=1e-9)


def test_a_graph_is_unrolled() -> None:
    from scipy.sparse.csgraph import dijkstra

    X, t = make_swiss_roll(800, random_state=0)
    graph = kneighbors_graph(X, 8, mode="distance")
    nodes = np.arange(len(X))
    mds = NystromMDS(n_landmarks=60, n_components=2, metric=lambda a, b: dijkstra(graph, directed=False, indices=a)[b])
    embedded = mds.fit_transform(nodes)
    assert abs(np.corrcoef(embedded[:, 0], t)[0, 1]) > 0.99


def test_the_form_of_a_surface_is_its_embedding(cat: Shape) -> None:
    surface = cat.surface()
    form = surface.canonical_form(n_landmarks=40)
    metric = lambda a, b: surface.distances(int(a))[b]  # noqa: E731
    mds = NystromMDS(n_landmarks=40, metric=metric).fit(np.arange(surface.n_vertices))
    np.testing.assert_array_equal(mds.landmarks_, form.landmarks)
    np.testing.assert_array_equal(mds.embedding_, form.points)


def test_it_works_in_a_pipeline_and_after_pickling() -> None:
    X = np.concatenate([points(60, 5), points(60, 5, 1) + 6])
    y = np.repeat([0, 1], 60)
    pipeline = make_pipeline(NystromMDS(n_landmarks=20, n_components=2), KNeighborsClassifier(3)).fit(X[::2], y[::2])
    assert pipeline.score(X[1::2], y[1::2]) == 1.0
    mds = pipeline[0]
    again = pickle.loads(pickle.dumps(mds))
    np.testing.assert_array_equal(again.transform(X), mds.transform(X))
    assert clone(mds).get_params() == mds.get_params()
    assert mds.get_feature_names_out().tolist() == ["nystrommds0", "nystrommds1"]


def test_fewer_landmarks_are_taken_if_points_repeat() -> None:
    X = np.repeat(points(12, 3), 5, axis=0)
    mds = NystromMDS(n_landmarks=30).fit(X)
    assert len(mds.landmarks_) == 12 and len(set(mds.landmarks_.tolist())) == 12


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"n_landmarks": 0}, "n_landmarks=0"),
        ({"n_landmarks": 2.5}, "n_landmarks=2.5 is not possible: give a whole number"),
        ({"n_landmarks": True}, "n_landmarks=True"),
        ({"n_components": True}, "n_components=true"),
        ({"n_landmarks": "many"}, "n_landmarks='many' is not possible: give a whole number"),
        ({"sampling": "best"}, "'farthest' or 'random'"),
        ({"regularization": "magic"}, 'use "low-rank"'),
        ({"n_components": 200}, "200 dimensions"),
        ({"metric": "magic"}, "magic"),
        ({"metric": "precomputed"}, "square matrix"),
        ({"metric": lambda a, X: [1.0]}, "must return 50 distances"),
        ({"alpha": 1e-9}, 'regularization="rpi"'),
    ],
)
def test_errors_say_what_to_do(parameters: dict, words: str) -> None:
    with pytest.raises(canonform.CanonformError) as raised:
        NystromMDS(**parameters).fit(points(50, 4))
    assert isinstance(raised.value, ValueError) and words in str(raised.value), str(raised.value)


@pytest.mark.parametrize(
    ("X", "words"),
    [
        (np.ones((50, 4)), "50 points coincide"),
        (np.ma.masked_greater(points(50, 4), 0.5), "masked"),
        (np.full((50, 4), np.nan), "NaN"),
        (np.ones((1, 4)), "minimum of 2"),
    ],
)
def test_points_without_a_shape_are_refused(X: np.ndarray, words: str) -> None:
    with pytest.raises(canonform.CanonformError) as raised:
        NystromMDS().fit(X)
    assert isinstance(raised.value, ValueError) and words in str(raised.value), str(raised.value)


def test_unreachable_points_are_refused() -> None:
    distances = np.array([[0, 1, np.inf], [1, 0, np.inf], [np.inf, np.inf, 0]])
    mds = NystromMDS(n_components=1, metric=lambda a, X: distances[a][X])
    with pytest.raises(ValueError, match="finite"):
        mds.fit(np.arange(3))


def test_calls_end_at_their_limits() -> None:
    def slow(a, b):
        time.sleep(0.01)
        return np.linalg.norm(np.asarray(b) - a, axis=1)

    X = points(200, 3)
    with pytest.raises(canonform.errors.TimeLimitError, match="timeout="):
        NystromMDS(metric=slow).fit(X, timeout=0.1)
    with pytest.raises(canonform.errors.MemoryLimitError, match="memory="):
        NystromMDS().fit(X, memory="10K")
    fitted = NystromMDS(n_landmarks=20).fit(X, timeout=60, memory="1G")
    with pytest.raises(canonform.errors.MemoryLimitError):
        fitted.transform(X, memory=100)
    with pytest.raises(TypeError, match="'time'"):
        fitted.transform(X, time=3)
