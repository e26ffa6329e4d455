"""Estimators for scikit-learn: embed points of any metric space, and place further points in the embedding."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Literal, TypeAlias, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _canonform
from ._arrays import Floats, Ints
from ._settings import Call, Regularization, running, unmasked, whole
from .errors import CanonformError, OptionError

try:
    from sklearn.base import BaseEstimator, ClassNamePrefixFeaturesOutMixin, TransformerMixin
    from sklearn.metrics import pairwise_distances
    from sklearn.utils import check_random_state
    from sklearn.utils.validation import check_is_fitted, validate_data
except ImportError as missing:
    raise ImportError("canonform.learn needs scikit-learn 1.6 or later: pip install 'canonform[learn]'") from missing

__all__ = ["NystromMDS"]

_ROUNDING = 1e-7
"""Differences of distances that are not told from zero, relative to the largest distance."""

Metric: TypeAlias = str | Callable[[Any, Any], ArrayLike]


@contextmanager
def _refused() -> Iterator[None]:
    """Every error is a `CanonformError`, those of scikit-learn too."""
    try:
        yield
    except CanonformError:
        raise
    except ValueError as fault:
        raise OptionError(str(fault)) from fault


class NystromMDS(ClassNamePrefixFeaturesOutMixin, TransformerMixin, BaseEstimator):  # type: ignore[misc]
    """Multidimensional scaling from the distances to a few landmarks, with `transform` for new points.

    Classical scaling needs the distances between all pairs of n points, and O(n^2) memory. This estimator needs p columns of them, one for
    each landmark, and O(n p) memory. It approximates the eigenvectors by the Nystrom method (Shamai, Zibulevsky and Kimmel 2015), and the
    same formula places points that were not there when it was fitted, from their distances to the landmarks.

    Args:
        n_landmarks: Number of landmarks, fewer if there are fewer different points.
        n_components: Dimensions of the embedding.
        metric: A name that `sklearn.metrics.pairwise_distances` knows, for vectors X. Or "precomputed": X is the matrix of distances
            between all points, in `transform` those from new points to all points of the fit, or to the landmarks only. Or a function
            `metric(a, X)` that returns the distances from the point a to each of the points X, any sequence: vectors, images, nodes of
            a graph, vertices of a surface.
        metric_params: Further arguments of the metric.
        sampling: How landmarks are chosen: "farthest", each the farthest from those before it, or "random".
        regularization, rank, alpha: As in `Nystrom`; parameters here, since grids of scikit-learn change them one by one.
        random_state: For `sampling="random"`. Elsewhere in canonform a whole number, `seed`.

    Attributes:
        embedding_: Coordinates of the points of the fit, centered, in the unit of the distances: shape (n, n_components).
        landmarks_: The landmarks, indices of points of the fit: shape (p,).
        eigenvalues_: Eigenvalues, descending; the first n_components belong to the columns of the embedding.
        negative_mass_: Share of negative eigenvalues, 0 to 1: how far the distances are from Euclidean.
        rank_: Eigenpairs of the matrix of the landmarks that were used.
        n_features_in_: Number of features of the points of the fit.

    Distances along the arc of a circle, which are those of points on a line:

    >>> angles = np.linspace(0, 3, 50)
    >>> along = canonform.NystromMDS(n_landmarks=8, n_components=1, metric=lambda a, b: abs(a - b)).fit(angles)
    >>> new = along.transform(np.array([1.5]))
    >>> bool(abs(new[0, 0] - along.embedding_[[24, 25], 0].mean()) < 1e-9)
    True
    """

    embedding_: Floats
    landmarks_: Ints
    eigenvalues_: Floats
    negative_mass_: float
    rank_: int
    _extension: _canonform.Extension

    def __init__(
        self,
        n_landmarks: int = 100,
        n_components: int = 3,
        *,
        metric: Metric = "euclidean",
        metric_params: dict[str, Any] | None = None,
        sampling: Literal["farthest", "random"] = "farthest",
        regularization: Regularization = "low-rank",
        rank: int | None = None,
        alpha: float | Literal["paper"] | None = None,
        random_state: Any = None,
    ) -> None:
        self.n_landmarks = n_landmarks
        self.n_components = n_components
        self.metric = metric
        self.metric_params = metric_params
        self.sampling = sampling
        self.regularization = regularization
        self.rank = rank
        self.alpha = alpha
        self.random_state = random_state

    def fit(self, X: Any, y: object = None, **call: Unpack[Call]) -> NystromMDS:
        """Choose landmarks and embed the points X.

        Args:
            X, y: The points, as the metric takes them; y is ignored.
        """
        with _refused(), running(call):
            return self._fitted(X)

    def _fitted(self, X: Any) -> NystromMDS:
        X = self._points(X, reset=True)
        n = len(X)
        if n < 2:
            raise OptionError(f"a metric space of 1 sample has no extent, and X has {n} sample(s); give at least 2")
        landmarks, columns = self._sampled(X, min(whole("n_landmarks", self.n_landmarks, 1), n))
        settings = {"n_components": self.n_components, "regularization": self.regularization, "rank": self.rank, "alpha": self.alpha}
        found = _canonform.nystrom(columns, landmarks.tolist(), settings)
        self.embedding_, self.eigenvalues_, self.negative_mass_, self.rank_, self._extension = found
        self.landmarks_ = landmarks
        self._n_fitted = n
        self._landmark_points: Any = None if self.metric == "precomputed" else _items(X, landmarks)
        return self

    def _sampled(self, X: Any, n: int) -> tuple[Ints, Floats]:
        """Landmarks, n if there are so many different points, and the distances from each to all points, as columns."""
        if self.sampling not in ("farthest", "random"):
            raise OptionError(f"sampling={self.sampling!r} is not possible: use 'farthest' or 'random'")
        is_random = self.sampling == "random"
        # As on surfaces, the first is the point farthest from point 0, at a tip.
        order = check_random_state(self.random_state).permutation(len(X)) if is_random else [self._measure(X, 0).argmax()]
        landmarks = [int(i) for i in order]
        _canonform.check_call(8 * len(X) * n)
        columns, nearest = np.empty((len(X), n), order="F"), np.full(len(X), np.inf)
        for j in range(n):
            _canonform.check_call(columns.nbytes)
            columns[:, j] = self._measure(X, landmarks[j])
            if not is_random:
                np.minimum(nearest, columns[:, j], out=nearest)
                nearest[landmarks[j]] = 0
                landmarks.append(int(nearest.argmax()))
                # The other points repeat landmarks, up to the rounding of Euclidean distances by scikit-learn.
                if not nearest[landmarks[-1]] > _ROUNDING * columns[:, 0].max():
                    break
        return np.array(landmarks[: j + 1], dtype=np.int64), columns[:, : j + 1]

    def fit_transform(self, X: Any, y: object = None, **call: Unpack[Call]) -> Floats:
        """Embed the points `X` as `fit` does, and return their coordinates: shape (n, n_components)."""
        return self.fit(X, **call).embedding_

    def transform(self, X: Any, **call: Unpack[Call]) -> Floats:
        """Place points in the embedding, from their distances to the landmarks: shape (len(X), n_components).

        Points of the fit get their coordinates in `embedding_`, up to rounding.

        Args:
            X: Points, or their distances to those of the fit or to the landmarks, as the metric takes them.
        """
        check_is_fitted(self)
        with _refused(), running(call):
            return self._placed(X)

    def _placed(self, X: Any) -> Floats:
        n_landmarks = len(self.landmarks_)
        if self.metric == "precomputed":
            given = np.shape(X)
            # The library refuses distances that are not finite.
            to_landmarks = len(given) == 2 and given[1] == n_landmarks != self._n_fitted
            columns = np.asarray(X) if to_landmarks else self._points(X, reset=False)[:, self.landmarks_]
        else:
            X = self._points(X, reset=False)
            columns = np.empty((len(X), n_landmarks))
            for j in range(n_landmarks):
                _canonform.check_call(columns.nbytes)
                columns[:, j] = self._column(self._landmark_points[j], X)
        return self._extension.place(np.asarray(columns, dtype=np.float64))

    def _points(self, X: Any, *, reset: bool) -> Any:
        """The points, checked if they are numbers."""
        unmasked("X", X)
        if callable(self.metric):
            if reset:
                array = np.asarray(X) if isinstance(X, np.ndarray) else None
                self.n_features_in_ = array.shape[1] if array is not None and array.ndim == 2 else 1
            return X
        X = validate_data(self, X, dtype=np.float64, reset=reset, ensure_min_samples=2 if reset else 1)
        if reset and self.metric == "precomputed" and X.shape[0] != X.shape[1]:
            raise OptionError(f"metric='precomputed' needs the distances between all pairs, a square matrix; X has shape {X.shape}")
        if reset and self.metric == "precomputed" and not np.allclose(X, X.T, rtol=0, atol=1e-6 * np.abs(X).max(initial=0)):
            i, j = np.unravel_index(np.abs(X - X.T).argmax(), X.shape)
            raise OptionError(
                f"metric='precomputed' needs a symmetric matrix, but X[{i}, {j}] is {X[i, j]:.6g} and X[{j}, {i}] is {X[j, i]:.6g}; "
                "pass (X + X.T) / 2 for the mean of both"
            )
        return X

    def _column(self, a: Any, X: Any) -> Floats:
        """The distances from a point to each of several."""
        parameters = self.metric_params or {}
        if callable(self.metric):
            column = np.asarray(self.metric(a, X, **parameters), dtype=np.float64)
            if column.shape != (len(X),):
                raise OptionError(f"metric(a, X) must return {len(X)} distances, one for each point of X; got shape {column.shape}")
            return column
        return pairwise_distances(X, np.asarray(a)[None], metric=self.metric, **parameters)[:, 0]

    def _measure(self, X: Any, i: int) -> Floats:
        """The distances from a point of the fit to all."""
        return X[:, i] if self.metric == "precomputed" else self._column(X[i], X)

    @property
    def _n_features_out(self) -> int:
        return int(self.embedding_.shape[1])

    def __sklearn_tags__(self) -> Any:
        tags = super().__sklearn_tags__()
        tags.input_tags.pairwise = self.metric == "precomputed"
        tags.transformer_tags.preserves_dtype = ["float64"]
        return tags


def _items(X: Any, indices: NDArray[np.int64]) -> Any:
    return X[indices] if isinstance(X, np.ndarray) else [X[i] for i in indices]
