"""What notebooks show."""

from __future__ import annotations

import base64
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import canonform
import numpy as np
from canonform import Index, Surface
from canonform.datasets import Shape

PNG = re.compile(r'src="data:image/png;base64,([A-Za-z0-9+/=]+)"')


def checked(html: str) -> list[bytes]:
    """The pictures of some HTML, which must be well formed and fetch nothing."""
    closed = re.sub(r"<img ([^>]*)>", r"<img \1/>", html)
    ElementTree.fromstring(f"<div>{closed}</div>")
    assert "http" not in html and "<script" not in html
    pictures = [base64.b64decode(data) for data in PNG.findall(html)]
    assert all(picture.startswith(b"\x89PNG") for picture in pictures)
    return pictures


def test_every_result_has_a_view(cats: list[Shape], collection: Path, tmp_path: Path) -> None:
    a, b = (shape.surface() for shape in cats)
    index = Index.build(collection, tmp_path / "i.canonform")
    for shown, n_pictures in [
        (cats[0], 1),
        (a, 1),
        (a.canonical_form(n_landmarks=30), 1),
        (a.canonical_form(n_landmarks=30, n_components=2), 1),
        (canonform.compare(a, b), 2),
        (index, 0),
        (index.search(a, k=3), 4),
        (index.search("cat0", k=2, explain=True), 3),
    ]:
        assert len(checked(shown._repr_html_())) == n_pictures, shown
        assert len(repr(shown)) < 1000


def test_views_escape_names(cat: Shape) -> None:
    surface = Surface(cat.vertices, cat.faces)
    surface._name = "<b>cat</b>"
    assert "<b>cat" not in surface._repr_html_()
    checked(surface._repr_html_())


def test_pictures_show_the_values(cat: Shape) -> None:
    surface = cat.surface()
    plain = surface.picture(width=80, height=60)
    colored = surface.picture(surface.distances(0), width=80, height=60)
    assert plain != colored and plain == surface.picture(width=80, height=60)
    dropped = np.where(np.arange(1000) < 10, np.inf, 1.0)
    assert surface.picture(dropped, width=80, height=60).startswith(b"\x89PNG")


def test_a_search_without_mesh_files_is_shown_all_the_same(tmp_path: Path, cats: list[Shape]) -> None:
    folder = tmp_path / "meshes"
    paths = canonform.datasets.write(cats, folder)
    index = Index.build(folder, tmp_path / "i.canonform")
    for path in paths:
        Path(path).unlink()
    assert checked(index.search("cat0")._repr_html_()) == []
