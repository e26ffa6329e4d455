"""Alignment and comparison of two shapes."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike

from . import _canonform, _html
from ._arrays import Floats, VertexValues, numeric, on_vertices
from ._form import Form
from ._methods import Embedding, Geodesic, options_of
from ._settings import Call, Landmarks, RelationKind, running
from ._stored import ByValue, Stored
from ._surface import AnyMesh, Surface, surface_of
from .errors import OptionError


@dataclass(frozen=True, repr=False, eq=False)
class Alignment(ByValue):
    """The rigid motion that takes one form onto another: `points @ rotation.T + translation`.

    Attributes:
        rotation: An orthogonal matrix, shape (3, 3); its determinant is -1 if the motion includes a reflection.
        translation: In mesh units, shape (3,).
        reflected: Whether the motion includes a reflection.
        rms: Root mean square distance between nearest points of the aligned forms, in mesh units.
    """

    rotation: Floats
    translation: Floats
    reflected: bool
    rms: float

    def apply(self, points: ArrayLike) -> Floats:
        """Moves `points`, shape (k, 3)."""
        return numeric("points", points, ("k", 3)) @ self.rotation.T + self.translation

    def __repr__(self) -> str:
        reflected = ", reflected" if self.reflected else ""
        return f"Alignment(rms={self.rms:.6g}{reflected})"


def align(a: Form | AnyMesh, b: Form | AnyMesh, *, reflections: bool = True, **call: Unpack[Call]) -> Alignment:
    """The motion that takes the form of a onto that of b, in mesh units.

    Args:
        a, b: Forms; or surfaces and meshes as `compare` takes them, which stand for their canonical forms with default options.
        reflections: Whether the motion may include a reflection.

    Raises `EmbeddingError` if a form is not three-dimensional.

    >>> canonform.align(cat, cat).rms < 1e-6
    True
    """
    with running(call):
        forms = [shape if isinstance(shape, Form) else surface_of(shape).canonical_form(stress="skip") for shape in (a, b)]
        return Alignment(*_canonform.align(forms[0]._inner, forms[1]._inner, bool(reflections)))


class Comparison(Stored):
    """How two shapes resemble each other.

    Attributes:
        report: The object that `canonform compare --json` prints.
        residuals: For each vertex of the first mesh, the distance of its form from that of the second, in mesh units; shape (n,).

    >>> found = canonform.compare(cat, other)
    >>> found.match, found.confidence > 0.5
    ('other-pose', True)
    """

    def __init__(self, report: dict[str, Any], residuals: VertexValues, shapes: tuple[Surface, Surface]) -> None:
        self.report = report
        self.residuals = residuals
        self._shapes = shapes

    @property
    def relation(self) -> dict[str, Any]:
        """How the meshes are related: `kind`, `confidence`, `changes`, `text`, and the numbers that decided in `because`."""
        return self.report["relation"]

    @property
    def distance(self) -> float:
        """Combined distance, by signatures and aligned forms at equal size."""
        return float(self.report["combined_distance"])

    @property
    def form_distance(self) -> float:
        """Distance between the aligned forms at equal size."""
        return float(self.report["normalized_distance"])

    @property
    def scale(self) -> float:
        """Size of the second over that of the first, by the square roots of their areas."""
        return float(self.report["scale"])

    @property
    def match(self) -> RelationKind:
        """The kind of relation, such as "identical-file", "scaled", "remeshed" or "other-pose"."""
        return self.relation["kind"]

    @property
    def confidence(self) -> float:
        """Probability of the kind of relation, 0 to 1."""
        return float(self.relation["confidence"])

    def __str__(self) -> str:
        return f"{self.relation['text']} (confidence {self.confidence:.2f}); {self.relation['because']['text']}"

    def __repr__(self) -> str:
        return f"Comparison({self.match!r}, distance={self.distance:.4g})"

    def _repr_html_(self) -> str:
        a, b = self._shapes
        rows = [
            ("relation", self.relation["text"]),
            ("confidence", f"{self.confidence:.2f}"),
            ("because", self.relation["because"]["text"]),
            ("combined distance", f"{self.distance:.4f}"),
            ("forms, at equal size", f"{self.form_distance:.6f}"),
            ("scale, second over first", f"{self.scale:.6g}"),
        ]
        pictures = [
            _html.image(a.picture(self.residuals, width=440, height=440), title="the first, colored by how far the forms are apart"),
            _html.image(b.picture(width=440, height=440), title="the second"),
        ]
        return _html.card("Comparison", rows, pictures)


def compare(
    a: AnyMesh,
    b: AnyMesh,
    *,
    names: tuple[str, str] | None = None,
    n_landmarks: Landmarks = 100,
    method: Embedding = "nmds",
    geodesic: Geodesic = "fast-marching",
    seed: int = 0,
    **call: Unpack[Call],
) -> Comparison:
    """Compare two shapes: one shape, one class or different ones; the same geometry, scaled, mirrored, remeshed, part of the other.

    Args:
        names: What the two are called in words; by default their file names.
        a, b: Surfaces, mesh files, or meshes in memory as `Surface` takes them.
        n_landmarks, method, geodesic, seed: As in `Surface.canonical_form`; the relation does not depend on them.

    >>> canonform.compare(cat, canonform.Surface(2 * cat.vertices, cat.faces)).match
    'scaled'
    """
    settings = options_of(n_landmarks=n_landmarks, method=method, geodesic=geodesic, seed=seed)
    if names is not None and (isinstance(names, str) or np.shape(names) != (2,)):
        raise OptionError(f"names={names!r} is not possible: give two names")
    with running(call):
        a, b = surface_of(a), surface_of(b)
        called = names or (a._name or "the first", b._name or "the second")
        found, residuals = _canonform.compare(a._inner, b._inner, list(called), settings)
    return Comparison(json.loads(found), on_vertices(residuals), (a, b))
