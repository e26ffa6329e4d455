"""Pictures: how they are drawn, and marks on surfaces."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _canonform
from ._arrays import Floats, Ints, edges_of, numeric, straight
from ._operators import EdgePoint, FacePoint, parsed
from ._settings import number, whole, word
from .errors import OptionError, PointError

if TYPE_CHECKING:
    from ._surface import Path

ColorMap: TypeAlias = Literal["viridis", "magma", "inferno", "cividis", "turbo", "coolwarm", "gray"]
View: TypeAlias = Literal["front", "back", "left", "right", "top", "bottom", "principal"] | tuple[float, float]

_VIEWS = {"front": (0, 0), "right": (90, 0), "back": (180, 0), "left": (270, 0), "top": (0, 90), "bottom": (0, -90)}
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_EDGE, _PATH, _POINT = [60, 60, 60], "#c81e1e", [30, 60, 200]
_LARGEST = 8192
"""Most pixels along a side."""


class Look(TypedDict, total=False):
    """Keywords of pictures.

    Attributes:
        width, height: In pixels, 600 by default.
        view: Where the viewer stands: "front", "right", "back", "left", "top", "bottom", "principal" along the principal axes, or how far
            around and how far up, in degrees; by default (30, 12).
        up: The axis that points up: "x", "y" or "z", the default.
        colormap: Colors of values: "viridis", "magma", "inferno", "cividis", "turbo", "coolwarm" or "gray".
        range: The values of the first and the last color; by default the least and the greatest.
        bar: The name of the values beside a bar of their colors; by default no bar. True for a bar without a name.
        isolines: Number of steps of the range that lines of equal value separate.
        colors: A color for each vertex instead of values: shape (n, 3), from 0 to 255, or from 0 to 1 if they are fractions.
        edges: Whether edges are drawn.
        thickness: Of paths and points, as a share of the usual.
        paths: Paths of `Surface.path`, or arrays of points of shape (k, 3), drawn as red lines; or pairs of one and a color.
        points: Points drawn as blue dots: vertices, points of edges and faces, or places of shape (k, 3).
        labels: Texts by points, such as {0: "nose"}: they are written beside these, none over another.
        background: A color such as "#ffffff", by default none.

    >>> look = canonform.Look(view="left", width=80, bar="distance", labels={0: "source"})
    >>> cat.picture(cat.distances(0), **look)[1:4]
    b'PNG'
    """

    width: int
    height: int
    view: View
    up: Literal["x", "y", "z"]
    colormap: ColorMap
    range: tuple[float, float]
    bar: str | bool
    isolines: int
    colors: ArrayLike
    edges: bool
    thickness: float
    paths: Sequence[Path | ArrayLike | tuple[Path | ArrayLike, str]]
    points: Iterable[Any]
    labels: Mapping[Any, str]
    background: str


def drawn(vertices: Floats, faces: Ints, values: Floats | None, look: Look) -> bytes:
    """A PNG file of a mesh, colored by values if there are some."""
    for name in look.keys() - Look.__annotations__.keys():
        raise TypeError(f"got an unexpected keyword argument {name!r}")
    vertices, faces = vertices.view(np.ndarray), np.asarray(faces)
    size = float(np.linalg.norm(np.ptp(vertices[np.unique(faces)], axis=0))) if len(faces) else 1.0
    thick = size * number("thickness", look.get("thickness", 1), 0)
    marks: list[tuple[Floats, Ints, list[int]]] = []
    if look.get("edges"):
        marks.append((*_tubes(vertices[edges_of(faces)], 0.0007 * size), _EDGE))
    for path in look.get("paths", ()):
        path, color = path if isinstance(path, tuple) and len(path) == 2 and isinstance(path[1], str) else (path, _PATH)
        places: Floats = numeric("paths", np.asarray(path), ("k", 3))
        marks.append((*_tubes(np.stack([places[:-1], places[1:]], axis=1), 0.004 * thick), _rgb("paths", color)))
    points = look.get("points")
    if points is not None:
        places = _places(points, vertices, faces)
        marks.append((*_solid(places[:, None] + 0.01 * thick * _BALL[0], _BALL[1]), _POINT))
    colors = None if "colors" not in look else _colors(look["colors"], len(vertices))
    n = len(vertices) + np.cumsum([0, *(len(mark[0]) for mark in marks)])
    every = np.concatenate([vertices, *(mark[0] for mark in marks)])
    corners = np.concatenate([faces, *(mark[1] + first for mark, first in zip(marks, n[:-1], strict=True))])
    paint = np.concatenate([np.empty((0, 3), np.uint8), *(np.full((len(mark[0]), 3), mark[2], np.uint8) for mark in marks)])
    numbers = None if values is None else straight(values.view(np.ndarray), dtype=np.float64)
    names = look.get("labels", {})
    labels = list(zip(_places(names, vertices, faces).tolist(), map(str, names.values()), strict=True))
    return _canonform.draw(straight(every), straight(corners), numbers, colors, straight(paint), _settings(look) | {"labels": labels})


def figure(
    pictures: Iterable[bytes],
    *,
    titles: Iterable[str] = (),
    n_columns: int | None = None,
    at: ArrayLike | None = None,
    width: int = 1200,
    height: int = 900,
    background: str = "#ffffff",
) -> bytes:
    """One picture of several: in rows, or at places. The bytes of a PNG file.

    Args:
        pictures: PNG files, such as `Surface.picture` makes them.
        titles: What is written under each of them; in a small type if it is long.
        n_columns: Pictures in a row; by default all, but no more than four.
        at: Where the middle of each picture is instead, to the right and up: shape (number of pictures, 2), such as an embedding of a
            matrix of distances. Both axes have one scale, and pictures that would be one over the other move apart if there is room.
        width, height: With `at`, the size in pixels.
        background: A color such as "#ffffff".

    >>> both = canonform.figure([cat.picture(width=80), other.picture(width=80)], titles=["one", "other"])
    >>> both[1:4]
    b'PNG'
    """
    files, names = list(pictures), list(titles)
    if not files or names and len(names) != len(files):
        raise OptionError(f"{len(names)} titles for {len(files)} pictures are not possible: give pictures, and one title for each, or none")
    sizes = np.array([struct.unpack(">II", file[16:24].rjust(8, b"\0")) for file in files])
    cell = sizes.max(axis=0)
    type_size = float(np.clip(0.05 * cell.min(), 11, 22))
    cell[1] += int(2 * type_size) if names else 0
    if at is None:
        columns = min(len(files), 4) if n_columns is None else min(whole("n_columns", n_columns, 1), len(files))
        row, column = np.divmod(np.arange(len(files)), columns)
        corners = np.column_stack([column, row]) * cell
        size = cell * [columns, row[-1] + 1]
    else:
        size = np.array([whole("width", width, 1), whole("height", height, 1)])
        places = numeric("at", at, (len(files), 2)) * [1, -1]
        span = np.maximum(np.ptp(places, axis=0), 1e-300)
        scale = max(0.0, float((np.maximum(size - cell, 0) / span).min()))
        corners = _apart((places - places.min(axis=0) - span / 2) * scale + (size - cell) / 2, cell, size)
    left = (corners + (cell - [0, int(2 * type_size) if names else 0] - sizes) / 2).round().astype(int).tolist()
    middles = (corners + cell * [0.5, 1] - [0, type_size]).tolist()
    texts = [(str(name), middle, 0.95 * float(cell[0])) for name, middle in zip(names, middles, strict=False)]
    return _canonform.figure(size.tolist(), _rgb("background", background), list(zip(files, left, strict=True)), texts, type_size)


def _apart(corners: Floats, cell: Ints, size: Ints) -> Floats:
    """Corners of rectangles near those given, which overlap as little as there is room for."""
    # Those in the same place go different ways.
    corners = corners + 1e-3 * np.arange(len(corners))[:, None]
    for _ in range(500):
        away = corners[:, None] - corners[None]
        shares = 1 - np.abs(away) / cell
        meets = (shares.min(axis=2) > 1e-3) & ~np.eye(len(corners), dtype=bool)
        if not meets.any():
            break
        # Along the side on which they overlap least, a part of the way.
        along = np.eye(2)[shares.argmin(axis=2)] * meets[..., None]
        corners = np.clip(corners + (0.3 * along * np.sign(away) * shares * cell).sum(axis=1), 0, np.maximum(size - cell, 0))
    return corners


def to_the_right(look: Look) -> Floats:
    """The direction that points right in a picture."""
    settings = _settings(look)
    up, around = np.array(settings["up"]), np.radians((settings["view"] or (0, 0))[0])
    flat = np.array(_AXES["y" if settings["up"] == _AXES["x"] else "x"])
    return np.cos(around) * flat + np.sin(around) * np.cross(up, flat)


def _settings(look: Look) -> dict[str, Any]:
    view, up, bar = look.get("view", (30, 12)), look.get("up", "z"), look.get("bar", False)
    named = _VIEWS.get(view) if isinstance(view, str) else view
    if up not in _AXES:
        raise OptionError(f'up={up!r} is not possible: use "x", "y" or "z"')
    if named is None and view != "principal" or named is not None and len(named) != 2:
        raise OptionError(f"view={view!r} is not possible: use {', '.join(map(repr, _VIEWS))}, 'principal', or two angles such as (30, 12)")
    ends = look.get("range")
    if ends is not None and not (len(ends) == 2 and -np.inf < number("range", ends[0]) < number("range", ends[1]) < np.inf):
        raise OptionError(f"range={ends!r} is not possible: give the values of the first and the last color, such as (0, 80)")
    sides = {name: min(whole(name, look.get(name, 600), 1), _LARGEST) for name in ("width", "height")}
    return {
        **sides,
        "view": None if named is None else [number("view", angle) for angle in named],
        "up": _AXES[up],
        "colormap": word("colormap", look.get("colormap", "viridis")),
        "range": None if ends is None else [float(end) for end in ends],
        "isolines": min(whole("isolines", look.get("isolines", 0)), 1000),
        "bar": None if bar is False else "" if bar is True else word("bar", bar),
        "background": _rgb("background", look["background"]) if "background" in look else None,
    }


def _rgb(name: str, text: str) -> list[int]:
    digits = word(name, text).removeprefix("#")
    try:
        if len(digits) != 6:
            raise ValueError
        return list(bytes.fromhex(digits))
    except ValueError:
        raise OptionError(f'{name}={text!r} is not possible: write it as "#rrggbb", such as "#ffffff"') from None


def _colors(colors: ArrayLike, n: int) -> NDArray[np.uint8]:
    array = numeric("colors", np.asarray(colors)[..., :3], (n, 3))
    bright = array * 255 if np.asarray(colors).dtype.kind == "f" and np.nanmax(array, initial=0) <= 1 else array
    return straight(np.clip(np.nan_to_num(bright, nan=160), 0, 255).round(), np.uint8)


def _places(points: Iterable[Any], vertices: Floats, faces: Ints) -> Floats:
    """Where points of a mesh are."""
    if isinstance(points, np.ndarray) and points.ndim == 2:
        return numeric("points", points, ("k", 3), error=PointError)
    places = []
    for point in points:
        at = point
        try:
            at = parsed(point) if isinstance(point, str) else point
            if isinstance(at, EdgePoint):
                places.append(vertices[at.start] * (1 - at.t) + vertices[at.end] * at.t)
            elif isinstance(at, FacePoint):
                places.append(np.average(vertices[faces[at.face]], axis=0, weights=at.weights))
            else:
                places.append(vertices[whole("points", at)])
        except (IndexError, ValueError):
            raise PointError(f"{at} is not a point of this mesh") from None
    return np.array(places).reshape(-1, 3)


def _ball() -> tuple[Floats, Ints]:
    """An octahedron, each of whose faces is divided into four, twice: points of the unit sphere."""
    corners = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=float)
    triangles = corners[[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [1, 0, 5], [2, 1, 5], [3, 2, 5], [0, 3, 5]]]
    for _ in range(2):
        middles = triangles + np.roll(triangles, -1, axis=1)
        middles /= np.linalg.norm(middles, axis=2, keepdims=True)
        a, b, c, ab, bc, ca = np.moveaxis(np.concatenate([triangles, middles], axis=1), 1, 0)
        triangles = np.stack([a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca], axis=1).reshape(-1, 3, 3)
    places, corners_of = np.unique(triangles.reshape(-1, 3).round(12), axis=0, return_inverse=True)
    return places, corners_of.reshape(-1, 3)


_BALL = _ball()
_PRISM = np.array([[i, (i + 1) % 4, 4 + i] for i in range(4)] + [[(i + 1) % 4, 4 + (i + 1) % 4, 4 + i] for i in range(4)])


def _solid(corners: Floats, faces: Ints) -> tuple[Floats, Ints]:
    """Copies of a solid, each with its own corners, as one mesh."""
    first = corners.shape[1] * np.arange(len(corners))
    return corners.reshape(-1, 3), (faces[None] + first[:, None, None]).reshape(-1, 3)


def _tubes(segments: Floats, radius: float) -> tuple[Floats, Ints]:
    """Prisms around segments, shape (k, 2, 3)."""
    along = segments[:, 1] - segments[:, 0]
    aside = np.cross(along, np.eye(3)[np.abs(along).argmin(axis=1)])
    across = np.cross(along, aside)
    with np.errstate(invalid="ignore", divide="ignore"):
        units = [np.nan_to_num(v / np.linalg.norm(v, axis=1, keepdims=True)) for v in (aside, across)]
    ring = radius * np.stack([units[0], units[1], -units[0], -units[1]], axis=1)
    return _solid(np.concatenate([segments[:, :1] + ring, segments[:, 1:] + ring], axis=1), _PRISM)
