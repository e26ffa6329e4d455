"""Generated shapes: the same arguments give the same meshes on every machine. Nothing is downloaded."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, Unpack

import numpy as np

from . import _canonform, _html
from ._arrays import Floats, Ints
from ._look import drawn
from ._settings import Call, Family, MeshFormat, running, whole
from ._stored import ByValue
from ._surface import Surface
from .errors import OptionError

__all__ = ["Shape", "families", "generate", "write"]

_DATASET = ["cat", "centaur", "david"]


@dataclass(frozen=True, repr=False, eq=False)
class Shape(ByValue):
    """A generated mesh.

    Attributes:
        name: Family and number, such as "cat0".
        label: Family, such as "cat".
        vertices: Shape (n, 3).
        faces: Shape (m, 3).
        rest: Where the vertices are before the body takes its pose, shape (n, 3): points of two shapes of a family correspond if they are
            in the same place there. None for creatures.

    >>> shape = canonform.datasets.generate("worm", poses=1, n_vertices=1000)[0]
    >>> shape.name, shape.label, shape.surface().n_vertices
    ('worm0', 'worm', 1000)
    """

    name: str
    label: str
    vertices: Floats
    faces: Ints
    rest: Floats | None = None

    def true_map(self, other: Shape, **call: Unpack[Call]) -> Ints:
        """For each vertex, the vertex of `other`, a shape of the family, that it truly corresponds to: shape (n,).

        Raises `OptionError` for shapes of different families, and of creatures.

        >>> a, b = canonform.datasets.generate("cat", poses=2, n_vertices=1000)
        >>> a.true_map(b).shape
        (1000,)
        """
        if self.rest is None or other.rest is None or self.label != other.label:
            raise OptionError(f"{self.name} and {other.name} have no true map; give two shapes of one of the families cat, centaur, david and person")
        with running(call):
            near = Surface(other.rest, other.faces).closest_point(self.rest)
        corners = other.faces[near.faces]
        nearest = np.linalg.norm(other.rest[corners] - near.points[:, None], axis=2).argmin(axis=1)
        return corners[np.arange(len(corners)), nearest]

    def _state(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "_surface"}

    @cached_property
    def _surface(self) -> Surface:
        surface = Surface(self.vertices, self.faces)
        surface._name = self.name
        return surface

    def surface(self) -> Surface:
        """The mesh as a surface. The same object every time, so that what is prepared on it is kept."""
        return self._surface

    def __repr__(self) -> str:
        return f"Shape({self.name!r}, {len(self.vertices)} vertices, {len(self.faces)} faces)"

    def _repr_html_(self) -> str:
        picture = drawn(self.vertices, self.faces, None, {"width": 440, "height": 440})
        return _html.card(self.name, [("vertices, faces", f"{len(self.vertices):,}, {len(self.faces):,}")], [_html.image(picture)])


def families() -> dict[str, int | None]:
    """Families, and how many shapes each has; None for creatures, which have as many poses as you like.

    >>> canonform.datasets.families()["cat"]
    9
    """
    return dict(_canonform.families())


def generate(
    family: Family | Literal["all"] | Iterable[Family] = "all",
    *,
    poses: int | Sequence[int] | None = None,
    n_vertices: int = 3400,
    seed: int = 1,
    **call: Unpack[Call],
) -> list[Shape]:
    """Generate labelled shapes in different poses.

    Args:
        family: One or more of `families()`. "all" stands for cats, centaurs and davids: thirty shapes, as in Fig. 4 of the paper. People
            differ in front and back on every limb, and their limbs touch: maps are judged on them.
        poses: How many poses of each family, or which. By default all of them, and 8 of a creature.
        n_vertices: Vertices of every shape, 1,000 to 1,000,000.
        seed: Of bodies, poses and triangulations.

    >>> [shape.name for shape in canonform.datasets.generate(["cat", "worm"], poses=[0, 2], n_vertices=1000)]
    ['cat0', 'cat2', 'worm0', 'worm2']
    """
    n_vertices, seed = whole("n_vertices", n_vertices), whole("seed", seed)
    known = families()
    one = isinstance(family, str) or not isinstance(family, Iterable)
    names: list[Any] = _DATASET if family == "all" else [family] if one else list(family)
    made: list[Shape] = []
    with running(call):
        for name in names:
            if name not in known:
                raise OptionError(f"family={name!r} is not possible: use \"all\", {', '.join(map(repr, known))}")
            count = known[name]
            wanted = range(count or 8) if poses is None else range(poses) if isinstance(poses, int) else list(poses)
            for pose in wanted:
                if whole("poses", pose, -1) < 0 or (count is not None and pose >= count):
                    raise OptionError(f"poses={pose} is not possible: {name} has the poses 0 to {(count or 8) - 1}")
            made.extend(Shape(*shape) for shape in _canonform.generate(name, list(wanted), n_vertices, seed))
    return made


def write(shapes: Iterable[Shape], folder: str | os.PathLike[str], *, format: MeshFormat = "off") -> list[str]:
    """Write `shapes` into a `folder`, one file each, and return their paths. `format` is their extension.

    >>> shapes = canonform.datasets.generate("worm", poses=1, n_vertices=1000)
    >>> canonform.datasets.write(shapes, "worms", format="ply")
    ['worms/worm0.ply']
    """
    os.makedirs(folder, exist_ok=True)
    paths = []
    for shape in shapes:
        paths.append(os.path.join(os.fspath(folder), f"{shape.name}.{format}"))
        _canonform.write(shape.vertices, shape.faces, paths[-1])
    return paths
