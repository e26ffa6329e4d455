"""Embedded surfaces."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from functools import cached_property
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _canonform, _html
from ._arrays import Floats, Ints, SourceRows, VertexValues, numeric, on_vertices
from ._look import Look, drawn
from ._settings import Call, StressChoice, running
from ._stored import AsArray, Constant

if TYPE_CHECKING:
    from ._surface import Point, Surface


class Form(AsArray, Constant):
    """A surface, embedded so that straight-line distances approximate the distances along it.

    `numpy.asarray(form)` gives its points. A pickled form holds its points and its report; the distances of the landmarks, and what
    `place`, `finer` and `align` need, are made again when they are first asked for.

    >>> form = cat.canonical_form(50)
    >>> form.points.shape, len(form.landmarks), form.normalized_stress < 0.2
    ((1000, 3), 50, True)
    """

    def __init__(
        self, inner: _canonform.Form | None, surface: Surface, settings: dict[str, Any], name: str = "", coarse: Form | None = None
    ) -> None:
        self._made = inner
        self._surface, self._settings, self._coarse = surface, settings, coarse
        self._name = name

    @property
    def _inner(self) -> _canonform.Form:
        if self._made is None:
            surface = self._surface._inner
            coarse = self._coarse
            finer = None if coarse is None else surface.finer(coarse._inner, self._settings)
            self._made = finer or surface.canonical_form(self._settings)
        return self._made

    def _state(self) -> dict[str, Any]:
        made = {name: getattr(self, name) for name in ("points", "eigenvalues", "report", "options")}
        return {**{k: v for k, v in vars(self).items() if k != "distances"}, **made, "_made": None}

    def _restore(self, state: dict[str, Any]) -> None:
        super()._restore(state)
        self.points.flags.writeable = False

    @cached_property
    def points(self) -> VertexValues:
        """Coordinates of the vertices, shape (n, n_components), in mesh units and in the order of the input. NaN for vertices that the repair dropped.

        The same numbers as `canonform embed -o FORM.npy` writes.
        """
        return on_vertices(self._inner.points(), writeable=False)

    @property
    def valid(self) -> NDArray[np.bool_]:
        """Which vertices have a place: a mask of shape (n,). `points[valid]` is the cloud of the form."""
        return self.points.valid

    def bent_surface(self, **call: Unpack[Call]) -> VertexValues:
        """Coordinates of the surface itself, bent into this form as rigidly as possible: shape (n, 3), NaN for vertices that the repair dropped.

        Features keep their shape: limbs stay round, and ears stay ears. The result has the handedness of the surface. Needs three components.

        >>> bent = canonform.Surface(cat.canonical_form(100).bent_surface(), cat.faces)
        >>> bool(abs(bent.area / cat.area - 1) < 0.05)
        True
        """
        with running(call):
            return on_vertices(self._inner.bent_points())

    @property
    def faces(self) -> Ints:
        """The faces of the input, shape (m, 3)."""
        return self._surface.faces

    @cached_property
    def report(self) -> dict[str, Any]:
        """Facts about the embedding: the object that `canonform embed --json` prints."""
        return json.loads(self._inner.report())

    @cached_property
    def options(self) -> dict[str, Any]:
        """How it was made, without options that have their default value."""
        return json.loads(self._inner.options())

    @property
    def stress(self) -> float | None:
        """The paper's stress, how far inner products are from those of the distances, in squared mesh units; None if not measured.

        It grows with the mesh: compare forms by `normalized_stress`. An estimate, unless all pairs were measured, so see
        `stress_interval`.
        """
        return self._stress("value")

    @property
    def stress_interval(self) -> tuple[float, float] | None:
        """A 95 % confidence interval of `stress`; its value twice if all pairs were measured."""
        return self._stress("interval")

    @property
    def normalized_stress(self) -> float | None:
        """Kruskal's stress, the relative error of the distances; None if it was not measured.

        An estimate, unless all pairs were measured, so see `normalized_stress_interval`. The argument `stress` of
        `Surface.canonical_form` says which distances it is from.
        """
        return self._stress("normalized")

    @property
    def normalized_stress_interval(self) -> tuple[float, float] | None:
        """A 95 % confidence interval of `normalized_stress`; its value twice if all pairs were measured."""
        return self._stress("normalized_interval")

    def _stress(self, key: str) -> Any:
        found = (self.report["stress"] or {}).get(key)
        return tuple(found) if isinstance(found, list) else found

    def _stress_in_words(self, key: str, interval: str) -> str:
        if self.report["stress"] is None:
            return "not measured"
        low, high = self._stress(interval)
        return f"{self._stress(key):.4g}" + (f" ({low:.4g} to {high:.4g}, estimated)" if low < high else "")

    @cached_property
    def eigenvalues(self) -> Floats:
        """Eigenvalues, descending, in squared mesh units; the first `n_components` belong to the columns of `points`."""
        return self._inner.eigenvalues()

    @property
    def landmarks(self) -> Ints:
        """The landmarks: vertex numbers of the input, in the order in which they were taken."""
        return np.array(self.report["samples"], dtype=np.int64)

    @cached_property
    def distances(self) -> SourceRows:
        """Distances from each landmark to all vertices, shape (number of landmarks, n), in mesh units."""
        return self._inner.distances().view(SourceRows)

    def place(self, points: Point | Iterable[Point], **call: Unpack[Call]) -> Floats:
        """Coordinates of `points` of the surface, as in `Surface.distances`: shape (number of points, n_components), in mesh units.

        Needs method="nmds".

        Raises `OptionError`, `PointError` if the form has no such extension, or the mesh no such point.

        >>> form = cat.canonical_form(50)
        >>> bool(np.allclose(form.place(7), form.points[7]))
        True
        """
        from ._surface import _several

        with running(call):
            return self._inner.place(_several(points, len(self)))

    def finer(self, surface: Surface, *, stress: StressChoice = "auto", seed: int = 0, **call: Unpack[Call]) -> Form:
        """A finer mesh of the same `surface` in the coordinates of this form, placed by the distances from its landmarks.

        The meshes are in the same place: each landmark is the nearest vertex of the finer mesh. Needs method="nmds". `stress` and
        `seed` are those of `Surface.canonical_form`.

        Raises `OptionError` if the form has no such extension, or the meshes are not in the same place.
        """
        settings = {"stress": stress, "seed": seed}
        with running(call):
            inner = surface._inner.finer(self._inner, settings)
        return Form(inner, surface, settings, self._name, self)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the form as a mesh to the file `path`; the extension tells the format. Vertices that the repair dropped are left out.

        Raises `FileError`, `EmbeddingError` if the file cannot be written, or the form has not three dimensions.
        """
        self._inner.write(os.fspath(path))

    def picture(self, values: ArrayLike | None = None, **look: Unpack[Look]) -> bytes:
        """A shaded picture of the form as the bytes of a PNG file, as of `Surface.picture`. Needs two or three dimensions.

        >>> cat.canonical_form(50).picture(view="principal", width=80)[1:4]
        b'PNG'
        """
        points = self.points[:, :3]
        if points.shape[1] < 3:
            points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
        return drawn(points, self.faces, None if values is None else numeric("values", values, (len(self),)), look)

    def __repr__(self) -> str:
        report = self.report
        quality = "" if report["stress"] is None else f", normalized stress {self._stress_in_words('normalized', 'normalized_interval')}"
        name = f"{self._name!r}, " if self._name else ""
        return f"Form({name}{report['n_vertices']} x {report['dim']}, {report['method']}, {report['n_samples']} landmarks{quality})"

    def _repr_html_(self) -> str:
        report = self.report
        rows = [
            ("method", f"{report['method']} on {report['geodesic']} distances"),
            ("landmarks, rank", f"{report['n_samples']}, {report['rank']}"),
            ("normalized stress", self._stress_in_words("normalized", "normalized_interval")),
            ("stress, squared mesh units", self._stress_in_words("value", "interval")),
            ("negative mass", f"{report['negative_mass']:.4f}"),
            ("seconds", f"{report['seconds']['total']:.3f}"),
        ]
        pictures = [_html.image(self.picture(width=440, height=440))] if report["dim"] >= 2 else []
        pictures.append(_html.bars(self.eigenvalues[:10], "eigenvalues"))
        return _html.card(f"Canonical form of {self._name}" if self._name else "Canonical form", rows, pictures)
