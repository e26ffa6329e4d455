"""What notebooks show."""

from __future__ import annotations

import base64
import json
import os
import pickle
import re
import shutil
import subprocess
import sys
import time
import urllib.request
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import canonform
import numpy as np
import pytest
from canonform import Index, Surface, SurfaceView, _view
from canonform.datasets import Shape
from conftest import grid

PNG = re.compile(r'src="data:image/png;base64,([A-Za-z0-9+/=]+)"')


def checked(html: str) -> list[bytes]:
    """The pictures of some HTML, which must be well formed and fetch nothing."""
    closed = re.sub(r"<img ([^>]*)>", r"<img \1/>", html)
    ElementTree.fromstring(f"<div>{closed}</div>")
    assert "http" not in html and "<script" not in html
    pictures = [base64.b64decode(data) for data in PNG.findall(html)]
    assert all(picture.startswith(b"\x89PNG") for picture in pictures)
    return pictures


@pytest.mark.slow
def test_every_result_has_a_view(cats: list[Shape], index: Index) -> None:
    a, b = (shape.surface() for shape in cats)
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


def decoded(png: bytes) -> np.ndarray:
    plt = pytest.importorskip("matplotlib.image")
    import io

    pixels: np.ndarray = plt.imread(io.BytesIO(png))
    return pixels


def share_of(png: bytes, color: tuple[int, int, int]) -> float:
    """The share of the pixels of a picture that have nearly the hue of a color."""
    pixels = decoded(png)
    lit = pixels[pixels[..., 3] > 0.9][:, :3]
    units = lit / np.maximum(np.linalg.norm(lit, axis=1, keepdims=True), 1e-9)
    wanted = np.array(color) / np.linalg.norm(color)
    return float((units @ wanted > 0.99).sum() / pixels[..., 3].size)


def test_pictures_are_directed() -> None:
    # A box of 1 x 2 x 3.
    pyvista = pytest.importorskip("pyvista", exc_type=ImportError)
    box = Surface(pyvista.Cube(x_length=1, y_length=2, z_length=3).clean())
    small: Any = {"width": 60, "height": 60}

    def sides(**look: Any) -> float:
        """Width over height of what is seen."""
        seen = decoded(box.picture(**small, **look))[..., 3] > 0.5
        rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
        return float(np.ptp(columns) / np.ptp(rows))

    for look, expected in [
        ({"view": "front"}, 1 / 3),
        ({"view": "right"}, 2 / 3),
        ({"view": "top"}, 1 / 2),
        ({"view": "front", "up": "y"}, 1 / 2),
        ({"view": (90, 0), "up": "x"}, 3 / 1),
    ]:
        assert sides(**look) == pytest.approx(expected, rel=0.1), look
    assert decoded(box.picture(width=40, height=30)).shape == (30, 40, 4)
    assert decoded(box.picture(background="#102030", **small))[0, 0].tolist() == pytest.approx(np.array([16, 32, 48, 255]) / 255)


def test_pictures_have_marks_colors_ranges_and_bars(cat: Shape) -> None:
    surface = cat.surface()
    values = surface.distances(0)
    small: Any = {"width": 200, "height": 160, "view": "left"}
    path = surface.path(0, values.argmax())
    assert share_of(surface.picture(**small), (200, 30, 30)) == 0
    assert share_of(surface.picture(paths=[path, path.points], **small), (200, 30, 30)) > 0.001
    points = [0, 7, canonform.FacePoint(500), "f800", canonform.EdgePoint(*map(int, surface.edges[900]))]
    assert share_of(surface.picture(points=points, **small), (30, 60, 200)) > 0.0002
    assert share_of(surface.picture(colors=np.tile([0.0, 1, 0], (1000, 1)), **small), (0, 1, 0)) > 0.05
    # A range that ends early makes the rest the last color.
    yellow = (253, 231, 37)
    assert share_of(surface.picture(values, range=(0, 1), **small), yellow) > 2 * share_of(surface.picture(values, **small), yellow)
    looks: list[Any] = [{}, {"edges": True}, {"isolines": 9}, {"bar": True}, {"bar": "mm"}, {"colormap": "gray"}]
    assert len({surface.picture(values, **look, **small) for look in looks}) == len(looks)
    form = surface.canonical_form(20)
    assert form.picture(values, view="principal", width=80, height=80) != form.picture(view="principal", width=80, height=80)
    with pytest.raises(TypeError, match="color"):
        surface.picture(color=3)  # type: ignore[call-arg]
    green = (path, "#00ff00")
    assert share_of(surface.picture(paths=[green], **small), (0, 255, 0)) > 0.001
    # Labels are dark text beside their points, on a light margin.
    plain, named = (decoded(surface.picture(labels=labels, **small)) for labels in ({}, {0: "source", canonform.FacePoint(500): "face"}))
    changed = (plain != named).any(axis=2)
    assert 0.005 < changed.mean() < 0.2 and (named[changed][:, :3] < 0.3).all(axis=1).any()


def test_figures_are_made_of_pictures(cat: Shape) -> None:
    red, blue = (canonform.figure([cat.surface().picture(width=40, height=30)], background=color) for color in ("#ff0000", "#0000ff"))
    both = decoded(canonform.figure([red, blue, red], n_columns=2))
    assert both.shape == (60, 80, 4) and both[0, 0].tolist() == [1, 0, 0, 1] == both[30, 0].tolist()
    assert both[0, 79].tolist() == [0, 0, 1, 1] and both[59, 79].tolist() == [1, 1, 1, 1]
    titled = decoded(canonform.figure([red, blue], titles=["one", "other"]))
    assert titled.shape == (30 + 22, 80, 4) and (titled[30:, :40].min(axis=(0, 1)) < 0.5).any()
    # The second is to the right of the first, and above it.
    placed = decoded(canonform.figure([red, blue], at=[[0, 0], [1, 2]], width=200, height=100))
    rows, columns = (np.flatnonzero((placed[..., :3] == color).all(axis=2).any(axis=axis)) for color, axis in (([1, 0, 0], 1), ([0, 0, 1], 0)))
    assert placed.shape == (100, 200, 4) and rows.max() == 99 and columns.min() > 80
    for wrong in ({"titles": ["one"]}, {"at": [[0, 0]]}, {"background": "red"}, {"n_columns": 0}):
        with pytest.raises(canonform.errors.OptionError):
            canonform.figure([red, blue], **wrong)  # type: ignore[arg-type]
    for files in ([], [b"no picture"]):
        with pytest.raises(canonform.errors.OptionError):
            canonform.figure(files)


def test_a_match_is_drawn_side_by_side(cats: list[Shape]) -> None:
    match = canonform.match(*(shape.surface() for shape in cats), n_eigenfunctions=30)
    pixels = decoded(match.picture(n_lines=4, width=160, height=80))
    halves = np.array_split(pixels[..., 3] > 0.5, 2, axis=1)
    assert all(half.mean() > 0.05 for half in halves)
    assert match.picture(n_lines=4, width=160, height=80) != match.picture(width=160, height=80) and len(match.pictures(width=40, height=40)) == 1 + len(match.maps)
    with pytest.raises(canonform.errors.OptionError, match="kind='other'"):
        match.picture("other")  # type: ignore[arg-type]


def test_a_search_without_mesh_files_is_shown_all_the_same(tmp_path: Path, cats: list[Shape]) -> None:
    folder = tmp_path / "meshes"
    paths = canonform.datasets.write(cats, folder)
    index = Index.build(folder, tmp_path / "i.canonform")
    for path in paths:
        Path(path).unlink()
    assert checked(index.search("cat0")._repr_html_()) == []


# Headless, with WebGL in software.
BROWSER = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--enable-unsafe-swiftshader", "--no-first-run"]
NOWHERE = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"


class Browser:
    """Chromium, driven by WebDriver: JSON over HTTP."""

    def __init__(self, address: str) -> None:
        self.address = address

    def ask(self, command: str, body: Any = None, method: str = "POST") -> Any:
        data = None if method != "POST" else json.dumps(body or {}).encode()
        request = urllib.request.Request(self.address + command, data, {"Content-Type": "application/json"}, method=method)
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]

    def script(self, text: str) -> Any:
        return self.ask("/execute/sync", {"script": text, "args": []})

    def enter_frame(self) -> None:
        self.ask("/frame", {"id": self.ask("/element", {"using": "css selector", "value": "iframe"})})

    def state(self) -> str:
        """The state of the view, once it is drawn or has failed."""
        for _ in range(240):
            state: str | None = self.script("return document.getElementById('view')?.dataset.state")
            if state in ("ready", "failed"):
                return state
            time.sleep(0.25)
        raise AssertionError("nothing is drawn")


@contextmanager
def browsing(*arguments: str) -> Iterator[Browser]:
    chromium, driver = (shutil.which(name) for name in ("chromium", "chromedriver"))
    if chromium is None or driver is None:
        assert os.environ.get("CANONFORM_BROWSER") != "required", "chromium or chromedriver is missing"
        pytest.skip("needs chromium and chromedriver")
    process = subprocess.Popen([driver, "--port=0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        assert process.stdout is not None
        port = next(line.split()[-1].rstrip(".") for line in process.stdout if "started successfully on port" in line)
        browser = Browser(f"http://127.0.0.1:{port}/session")
        options = {"binary": chromium, "args": [*BROWSER, NOWHERE, *arguments]}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options, "goog:loggingPrefs": {"browser": "ALL"}}
        browser.address += "/" + browser.ask("", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]
        yield browser
        browser.ask("", method="DELETE")
    finally:
        process.kill()
        process.wait()
        if process.stdout is not None:
            process.stdout.close()


@pytest.fixture(scope="module")
def view(cat: Shape) -> SurfaceView:
    surface = cat.surface()
    return surface.view(surface.distances(0), name="distance <b>", height=300)


def page_with(view: SurfaceView, folder: Path) -> str:
    page = folder / "notebook.html"
    page.write_text(f"<!doctype html><body>{view._repr_html_()}</body>", encoding="utf-8")
    return page.as_uri()


def test_a_view_turns_in_a_frame_without_a_network(view: SurfaceView, tmp_path: Path) -> None:
    with browsing() as browser:
        browser.ask("/url", {"url": page_with(view, tmp_path)})
        browser.enter_frame()
        assert browser.state() == "ready"
        assert "distance <b>" in browser.script("return document.body.textContent")
        eye = "return document.querySelector('.canonform-scene').layout.scene.camera.eye.x"
        before = browser.script(eye)
        browser.script(
            "document.querySelector('.canonform-scene').dispatchEvent(new KeyboardEvent('keydown', { key: 'ArrowLeft', bubbles: true }))"
        )
        assert browser.script(eye) != before
        assert browser.script("return getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)", "it covers the picture"
        assert browser.script("return performance.getEntriesByType('resource').length") == 0
        assert [entry for entry in browser.ask("/se/log", {"type": "browser"}) if entry["level"] == "SEVERE"] == []
        written = tmp_path / "page.html"
        view.write(written)
        browser.ask("/url", {"url": written.as_uri()})
        assert browser.state() == "ready"


def run_cell(monkeypatch: pytest.MonkeyPatch, cell: str, run: str, **metadata: str) -> None:
    """What IPython says while a cell of a notebook runs."""
    parent = {"header": {"msg_id": run}, "metadata": metadata, "content": {"code": cell}}
    shell = SimpleNamespace(get_parent=lambda: parent)
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))


@pytest.mark.slow
def test_one_cell_has_the_scripts_of_all_views(view: SurfaceView, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_view, "_carrier", [])
    outputs = []
    for run, (cell, metadata) in enumerate([("a", {}), ("b", {}), ("a", {}), ("c", {"cellId": "1"}), ("edited", {"cellId": "1"})]):
        run_cell(monkeypatch, cell, f"run {run}", **metadata)
        outputs += [view._repr_html_(), view._repr_html_()]
    # The first view of the first cell, and again when that cell runs again.
    assert ["<script>" in output for output in outputs] == [i in (0, 4) for i in range(10)]
    assert len(outputs[0]) < 1_000_000 and len(outputs[1]) < 150_000
    monkeypatch.setattr(_view, "_carrier", [])
    run_cell(monkeypatch, "text", "run 1", cellId="1")
    assert "<script>" in view._repr_html_()
    run_cell(monkeypatch, "edited", "run 2", cellId="1")
    assert "<script>" in view._repr_html_()
    # In any order, and after what had the scripts has left the page.
    page = tmp_path / "notebook.html"
    page.write_text(f"<!doctype html><body>{outputs[1]}{outputs[2]}<p>{outputs[0]}</p></body>", encoding="utf-8")
    with browsing() as browser:
        browser.ask("/url", {"url": page.as_uri()})
        for frame in range(3):
            browser.ask("/frame", {"id": frame})
            assert browser.state() == "ready"
            browser.ask("/frame", {"id": None})
        browser.script("const all = document.querySelectorAll('body > *'); all[2].remove(); all[0].outerHTML = all[0].outerHTML")
        browser.enter_frame()
        assert browser.state() == "ready"
        assert [entry for entry in browser.ask("/se/log", {"type": "browser"}) if entry["level"] == "SEVERE"] == []


@pytest.mark.slow
def test_without_webgl_a_view_is_its_picture(view: SurfaceView, tmp_path: Path) -> None:
    with browsing("--disable-3d-apis") as browser:
        browser.ask("/url", {"url": page_with(view, tmp_path)})
        assert browser.script("const image = document.querySelector('img'); return [image.complete, image.naturalWidth]") == [True, 300]
        browser.enter_frame()
        assert browser.state() == "failed"
        assert browser.script("return getComputedStyle(document.body).backgroundColor") == "rgba(0, 0, 0, 0)", "the picture is seen"


def test_views_are_small_and_refuse_what_pictures_refuse(view: SurfaceView, cat: Shape) -> None:
    assert len(view.page) < 800_000 and len(view._repr_html_()) < 1_000_000
    assert pickle.loads(pickle.dumps(view)) == view and view.n_faces == len(cat.faces)
    for wrong in (np.zeros(5), np.zeros((1000, 3))):
        with pytest.raises(canonform.errors.OptionError, match=r"shape \(1000,\)"):
            cat.surface().view(wrong)


def test_large_surfaces_are_simplified_and_keep_shape_and_values() -> None:
    from canonform._view import _visible

    vertices, faces = grid(300)
    found, triangles, values = _visible(vertices, faces, vertices[:, 0])
    assert 30_000 < len(triangles) <= 100_000 < len(faces)
    a, b, c = (found[triangles[:, k]] for k in range(3))
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(1, abs=0.02)
    assert values is not None and np.allclose(values, found[:, 0])


def test_what_a_repair_dropped_is_not_shown() -> None:
    vertices, faces = grid(4)
    vertices = np.concatenate([vertices, [[np.nan, 0, 0], [1e9, 0, 0]]])
    from canonform._view import _visible

    found, triangles, values = _visible(vertices, np.concatenate([faces, [[0, 1, 16]]]), None)
    assert len(found) == 16 and len(triangles) == len(faces) and values is None
