"""Embedded surfaces."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _canonform, _html
from ._arrays import Floats, Ints
from ._settings import Progress, encoded, shown

if TYPE_CHECKING:
    from ._surface import Surface


class Form:
    """A surface, embedded so that straight-line distances approximate the distances along it.

    `numpy.asarray(form)` gives its points.
    """

    def __init__(self, inner: _canonform.Form, name: str = "") -> None:
        self._inner = inner
        self._name = name

    @cached_property
    def points(self) -> Floats:
        """Coordinates of the vertices, shape (n, dim), in mesh units and in the order of the input. NaN for vertices that the repair dropped.

        The same numbers as `canonform embed -o FORM.npy` writes.
        """
        points = self._inner.points()
        points.flags.writeable = False
        return points

    @cached_property
    def faces(self) -> Ints:
        """The faces of the input, shape (m, 3)."""
        faces = self._inner.faces()
        faces.flags.writeable = False
        return faces

    @cached_property
    def report(self) -> dict[str, Any]:
        """Facts about the embedding: the object that `canonform embed --json` prints."""
        report: dict[str, Any] = json.loads(self._inner.report())
        return report

    @cached_property
    def options(self) -> dict[str, Any]:
        """How it was made, without options that have their default value."""
        options: dict[str, Any] = json.loads(self._inner.options())
        return options

    @property
    def stress(self) -> float | None:
        """The paper's stress, in squared mesh units; None if it was not measured."""
        stress = self.report["stress"]
        return None if stress is None else float(stress["value"])

    @property
    def normalized_stress(self) -> float | None:
        """Kruskal's stress, the relative error of the distances; None if it was not measured."""
        stress = self.report["stress"]
        return None if stress is None else float(stress["normalized"])

    @cached_property
    def eigenvalues(self) -> Floats:
        """Eigenvalues, descending, in squared mesh units; the first `dim` belong to the columns of `points`."""
        return self._inner.eigenvalues()

    @property
    def samples(self) -> Ints:
        """The samples: vertex numbers of the input, in the order in which they were taken."""
        return np.array(self.report["samples"], dtype=np.int64)

    @cached_property
    def distances(self) -> Floats:
        """Distances from each sample to all vertices, shape (number of samples, n), in mesh units."""
        return self._inner.distances()

    def place(self, points: int | str | Sequence[int | str]) -> Floats:
        """Coordinates of points of the surface, shape (number of points, dim), in mesh units. Needs method="nmds".

        Parameters
        ----------
        points
            Points as in `Surface.distances`: vertex numbers, or text such as "17-42@0.3" on an edge and "f8@2:1:1" in a face.
        """
        one = isinstance(points, (int, np.integer, str))
        return self._inner.place([points] if one else list(points))  # type: ignore[list-item,arg-type]

    def finer(self, surface: Surface, *, stress: str = "auto", seed: int = 0, progress: Progress = False) -> Form:
        """A finer mesh of the same surface in the coordinates of this form, placed by the distances from its samples.

        The meshes are in the same place: each sample is the nearest vertex of the finer mesh. Needs method="nmds".
        """
        with shown(progress) as report:
            return Form(surface._inner.finer(self._inner, encoded(stress=stress, seed=seed), report), self._name)

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the form as a mesh; the extension tells the format. Vertices that the repair dropped are left out."""
        self._inner.write(os.fspath(path))

    def picture(self, *, width: int = 600, height: int = 600) -> bytes:
        """A shaded picture of the form as the bytes of a PNG file. Needs two or three dimensions."""
        points = self.points[:, :3]
        if points.shape[1] < 3:
            points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
        return _html.picture(points, self.faces, None, (width, height))

    def __len__(self) -> int:
        return len(self.points)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.points, dtype=dtype, copy=True if copy is None else copy)

    def __repr__(self) -> str:
        report = self.report
        stress = self.normalized_stress
        quality = "" if stress is None else f", normalized stress {stress:.4f}"
        name = f"{self._name!r}, " if self._name else ""
        return f"Form({name}{report['n_vertices']} x {report['dim']}, {report['method']}, {report['n_samples']} samples{quality})"

    def _repr_html_(self) -> str:
        report = self.report
        stress = self.normalized_stress
        rows = [
            ("method", f"{report['method']} on {report['geodesic']} distances"),
            ("samples, rank", f"{report['n_samples']}, {report['rank']}"),
            ("normalized stress", "not measured" if stress is None else f"{stress:.4f}"),
            ("negative mass", f"{report['negative_mass']:.4f}"),
            ("seconds", f"{report['seconds']['total']:.3f}"),
        ]
        pictures = [_html.image(self.picture(width=440, height=440))] if report["dim"] >= 2 else []
        pictures.append(_html.bars(self.eigenvalues[:10], "eigenvalues"))
        return _html.card(f"Canonical form of {self._name}" if self._name else "Canonical form", rows, pictures)
