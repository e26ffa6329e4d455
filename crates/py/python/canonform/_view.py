"""Surfaces to turn and zoom, in notebooks and as pages."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import dataclass
from html import escape
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _canonform, _html
from ._arrays import Floats, Ints, straight
from ._look import drawn
from ._stored import ByValue

_MOST_FACES = 100_000
"""Surfaces of more faces are simplified: a safety limit, at which a view has about 2.5 MB and turns smoothly."""


@dataclass(frozen=True, repr=False, eq=False)
class SurfaceView(ByValue):
    """A surface to turn with the mouse and zoom with the wheel, made by `Surface.view`.

    A notebook shows it in a frame that needs no network. The first cell with a view stores the scripts, 0.7 MB, for all others: where
    it, scripts or WebGL are missing, a picture is seen instead.

    Attributes:
        page: A page of HTML that shows the surface and fetches nothing: 0.75 MB, and about 18 bytes for each face.
        picture: A picture of the surface: the bytes of a PNG file.
        title: What is shown.
        height: Height of the frame, in pixels.
        n_faces: Faces that are shown: surfaces of more than 100,000 are simplified by merging vertices in cells of a grid.
    """

    page: str
    picture: bytes
    title: str
    height: int
    n_faces: int

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the page to the file `path`, to open in a browser."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(self.page)

    def __repr__(self) -> str:
        return f"SurfaceView({self.title!r}, {self.n_faces} faces)"

    def _repr_html_(self) -> str:
        # The frame is transparent until the surface is drawn, so the picture is seen without it, too.
        layer = "position:absolute;top:0;left:0;width:100%;height:100%;border:0"
        image = _html.image(self.picture, self.height, self.title)
        scripts = _canonform.scene_scripts()
        return (
            f'<div style="position:relative;width:100%;max-width:{self.height * 4 // 3}px;height:{self.height}px">{image}'
            f'<iframe title="{escape(self.title)}" style="{layer}" sandbox="allow-scripts" '
            f'srcdoc="{escape(self.page.replace(scripts, ""))}"></iframe></div>' + (_answers(scripts) if _carries() else "")
        )


def _answers(scripts: str) -> str:
    """What hands the scripts to all frames of a page that ask for them. Their policy lets nothing else run."""
    text = json.dumps(scripts).replace("<", "\\u003c")
    return (
        f"<script>if (!window.canonformScripts) {{ window.canonformScripts = {text};\n"
        "window.addEventListener('message', ({ data, source }) => { if (data?.canonform === 'scripts') "
        "source.postMessage({ canonform: window.canonformScripts }, '*'); }); }</script>"
    )


_carrier: list[str] = []
"""The cell of the notebook whose output has the scripts for all others, the first that showed a view, and its last run."""


def _carries() -> bool:
    """Whether the output that is made now has the scripts: that of the carrier, each time that it runs."""
    shell: Any = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    try:
        message = shell.get_parent()
        now = [message["metadata"].get("cellId") or message["content"]["code"], message["header"]["msg_id"]]
    except (AttributeError, KeyError, TypeError):
        # No notebook.
        return True
    # Outputs of Colab do not see each other.
    if _carrier and (now[0] != _carrier[0] or now == _carrier):
        return "google.colab" in sys.modules
    _carrier[:] = now
    return True


def scene(
    vertices: Floats, faces: Ints, values: Floats | None, title: str, values_name: str, height: int, up: Literal["x", "y", "z"]
) -> SurfaceView:
    """A view of a mesh, colored by values at its vertices."""
    picture = drawn(vertices, faces, values, {"width": height, "height": height, "up": up})
    # The viewer has z up, and the axis after that to the right.
    vertices = np.roll(vertices, {"x": 2, "y": 1, "z": 0}[up], axis=1)
    vertices, faces, values = _visible(vertices, faces, values)
    page = _canonform.scene_page(straight(vertices), straight(faces), None if values is None else straight(values), title, values_name)
    return SurfaceView(page, picture, title, height, len(faces))


def _visible(vertices: Floats, faces: Ints, values: Floats | None) -> tuple[Floats, Ints, Floats | None]:
    """The faces with finite corners and their vertices, simplified if there are too many."""
    faces = faces[np.isfinite(vertices[faces]).all(axis=(1, 2))]
    used, corners = np.unique(faces, return_inverse=True)
    vertices, faces = vertices[used], corners.reshape(-1, 3)
    values = None if values is None else values[used]
    side = float(np.ptp(vertices, axis=0).max()) / 500 if len(vertices) else 0.0
    n_faces = len(faces)
    fine = vertices, faces, values
    while n_faces > _MOST_FACES and side > 0:
        vertices, faces, values = _merged(*fine, side)
        n_faces, side = len(faces), 1.25 * side
    return vertices, faces, values


def _merged(vertices: Floats, faces: Ints, values: Floats | None, side: float) -> tuple[Floats, Ints, Floats | None]:
    """The mesh with the vertices in every cell of a grid merged into their mean."""
    cells = np.floor((vertices - vertices.min(axis=0)) / side).astype(np.int64)
    _, cell, sizes = np.unique(cells @ np.array([1, 1 << 21, 1 << 42]), return_inverse=True, return_counts=True)

    def means(numbers: Floats) -> Floats:
        return np.bincount(cell, numbers) / sizes

    corners = cell[faces]
    a, b, c = corners.T
    kept = corners[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(np.sort(kept, axis=1), axis=0, return_index=True)
    merged: NDArray[np.int64] = kept[np.sort(first)]
    places = np.column_stack([means(vertices[:, axis]) for axis in range(3)])
    return places, merged, None if values is None else means(values)
