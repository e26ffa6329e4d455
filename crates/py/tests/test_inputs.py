"""What a surface is made of: meshes and points of other packages, arrays, files."""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import canonform
import numpy as np
import pytest
from canonform import Surface
from canonform.errors import CanonformError, MeshError, MissingFileError, OptionError
from conftest import ROOT, grid
from numpy.typing import NDArray

meshio = pytest.importorskip("meshio")
pyvista = pytest.importorskip("pyvista", exc_type=ImportError)
trimesh = pytest.importorskip("trimesh")


def ball(n: int = 300) -> NDArray[np.float64]:
    i = np.arange(n) + 0.5
    height, turn = 1 - 2 * i / n, i * np.pi * (1 + 5**0.5)
    radius = np.sqrt(1 - height**2)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])


class Tensor:
    """As tensors of PyTorch with a gradient: they refuse to be arrays until they are detached."""

    def __init__(self, values: Any, detached: bool = False) -> None:
        self.values, self.detached = np.asarray(values), detached
        self.shape = self.values.shape

    def detach(self) -> Tensor:
        return Tensor(self.values, True)

    def cpu(self) -> Tensor:
        return self

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if not self.detached:
            raise RuntimeError("Can't call numpy() on Tensor that requires grad. Use tensor.detach().numpy() instead.")
        return self.values.astype(dtype or self.values.dtype)


V, F = grid(7)
QUADS = np.array([[7 * i + j, 7 * i + j + 7, 7 * i + j + 8, 7 * i + j + 1] for i in range(6) for j in range(6)])
OFF = "OFF\n49 72 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in V.tolist()) + "".join(f"3 {a} {b} {c}\n" for a, b, c in F.tolist())
MASKED = np.ma.masked_greater(V, 0.9)


def _trimesh(**more: Any) -> Any:
    return trimesh.Trimesh(V, F, process=False, **more)


MESHES: dict[str, Callable[[Path], Any]] = {
    "vertices and faces": lambda folder: (V, F),
    "lists": lambda folder: (V.tolist(), F.tolist()),
    "of 32 bits": lambda folder: (V.astype(np.float32), F.astype(np.uint32)),
    "whole floats as faces": lambda folder: (V, F.astype(float)),
    "tensors": lambda folder: (Tensor(V), Tensor(F)),
    "masked arrays without a mask": lambda folder: (np.ma.array(V), np.ma.array(F)),
    "quads": lambda folder: (V, QUADS),
    "quads and triangles": lambda folder: (V, [*QUADS[1:].tolist(), [0, 7, 8], [0, 8, 1]]),
    "trimesh": lambda folder: _trimesh(),
    "a scene of trimesh": lambda folder: trimesh.Scene(_trimesh()),
    "meshio": lambda folder: meshio.Mesh(V, [("triangle", F)]),
    "meshio with quads": lambda folder: meshio.Mesh(V, [("quad", QUADS[1:]), ("triangle", np.array([[0, 7, 8], [0, 8, 1]]))]),
    "meshio with lines": lambda folder: meshio.Mesh(V, [("line", F[:, :2]), ("triangle", F)]),
    "pyvista": lambda folder: pyvista.PolyData.from_regular_faces(V, F),
    "pyvista with quads": lambda folder: pyvista.PolyData.from_regular_faces(V, QUADS),
    "a surface": lambda folder: Surface(V, F),
    "the repaired mesh": lambda folder: Surface(V, F).repaired,
    "a path": lambda folder: _written(folder / "square.off"),
    "a path as text": lambda folder: str(_written(folder / "square.off")),
    "an open file": lambda folder: open(_written(folder / "square.off"), "rb"),  # noqa: SIM115
    "a file open as text": lambda folder: open(_written(folder / "square.off")),  # noqa: SIM115
}

POINTS: dict[str, Callable[[], Any]] = {
    "an array": ball,
    "lists": lambda: ball().tolist(),
    "a tensor": lambda: Tensor(ball()),
    "a point cloud of trimesh": lambda: trimesh.PointCloud(ball()),
    "points of pyvista": lambda: pyvista.PolyData(ball()),
    "points of meshio": lambda: meshio.Mesh(ball(), []),
    "vertices of meshio": lambda: meshio.Mesh(ball(), [("vertex", np.arange(300)[:, None])]),
}

REFUSED: dict[str, tuple[Callable[[], Any], type[CanonformError], str]] = {
    "counted from 1": (lambda: Surface(V, F + 1), MeshError, "counted from 1: pass faces - 1"),
    "out of range": (lambda: Surface((V, F + 2)), MeshError, "vertex number 49; the 49 vertices are counted from 0"),
    "negative": (lambda: Surface(V, F - 1), MeshError, "vertex number -1"),
    "five corners": (lambda: Surface(V, F[:1].tolist() + [[0, 1, 2, 3, 4]]), MeshError, "5 corners"),
    "fractions as faces": (lambda: Surface(V, F + 0.5), MeshError, "whole numbers"),
    "no faces": (lambda: Surface(V, np.empty((0, 3), int)), MeshError, "leave out `faces`"),
    "two coordinates": (lambda: Surface(V[:, :2], F), MeshError, "shape (n, 3)"),
    "ragged": (lambda: Surface([[0, 0, 0], [1, 2]], F), MeshError, "shape (n, 3)"),
    "masked vertices": (lambda: Surface(MASKED, F), MeshError, "masked"),
    "masked faces": (lambda: Surface(V, np.ma.masked_equal(F, 3)), MeshError, "masked"),
    "masked points": (lambda: Surface(np.ma.masked_greater(ball(), 0.9)), MeshError, "masked"),
    "a masked mask": (lambda: Surface(V, F).distances(np.ma.masked_equal(np.arange(49), 3) > 2), OptionError, "masked"),
    "masked values": (lambda: Surface(V, F).gradient(MASKED[:, 0]), OptionError, "masked"),
    "masked queries": (lambda: Surface(V, F).closest_point(MASKED), canonform.errors.PointError, "masked"),
    "an empty scene": (lambda: Surface(trimesh.Scene()), MeshError, "empty"),
    "a solid": (lambda: Surface(meshio.Mesh(V, [("tetra", F[:, [0, 1, 2, 0]])])), MeshError, "tetra"),
    "a grid": (lambda: Surface(pyvista.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()), MeshError, "extract_surface"),
    "bytes": (lambda: Surface(OFF.encode()), MeshError, 'format="ply"'),
    "an unknown format": (lambda: Surface(OFF.encode(), format="docx"), MeshError, "mesh.docx"),
    "no file": (lambda: Surface("nowhere.off"), MissingFileError, "nowhere.off"),
    "no mesh": (lambda: Surface(object()), MeshError, "object is not a mesh"),
    "nothing": (lambda: Surface(None), MeshError, "NoneType is not a mesh"),
}


def _written(path: Path) -> Path:
    path.write_text(OFF)
    return path


@pytest.mark.parametrize("name", MESHES)
def test_meshes(name: str, tmp_path: Path) -> None:
    given = MESHES[name](tmp_path)
    surface = Surface(given)
    getattr(given, "close", lambda: None)()
    np.testing.assert_allclose(surface.vertices, V, atol=1e-7)
    # In a flat square both diagonals of a quad are as long, and the faces may come in another order.
    assert surface.area == pytest.approx(1) and surface.n_faces == 72
    np.testing.assert_allclose(surface.distances(0, geodesic="exact"), np.linalg.norm(V - V[0], axis=1), atol=1e-6)
    assert ("split" in str(surface.repair_report)) == ("quads" in name)


@pytest.mark.parametrize("content", [OFF.encode(), io.BytesIO(OFF.encode()), io.StringIO(OFF), bytearray(OFF.encode())])
def test_files_in_memory(content: Any) -> None:
    surface = Surface(content, format="off")
    np.testing.assert_array_equal(surface.faces, F)


@pytest.mark.parametrize("name", POINTS)
def test_points(name: str) -> None:
    surface = Surface(POINTS[name]())
    assert surface.kept.all() and surface.area == pytest.approx(4 * np.pi, rel=0.05)


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused_is_told(name: str) -> None:
    make, kind, words = REFUSED[name]
    with pytest.raises(kind) as raised:
        make()
    assert words in str(raised.value)


def test_meshes_that_the_command_line_refuses_are_refused_in_its_words() -> None:
    contracts = ROOT / "tests" / "contracts"
    rows = [row.split("\t") for row in (contracts / "broken-meshes.tsv").read_text().splitlines()]
    refused = [(name, words) for name, _, words, _, exit_codes, _ in rows if exit_codes == "2, 2"]
    assert len(refused) > 30
    for name, words in refused:
        with pytest.raises(CanonformError) as raised:
            Surface(contracts / "meshes" / name)
        assert words.split("; ")[0] in str(raised.value), name


def test_quads_are_split_as_in_files(tmp_path: Path) -> None:
    # Bent quads, one whose first diagonal would fold a half over, and a dart.
    points = np.array([[0, 0, 0], [2, 0, 0.3], [2, 1, 0], [0, 1, 0.2], [4, 0, 0], [2.2, 0.5, 0], [4, 2, 0]])
    quads = np.array([[0, 1, 2, 3], [1, 4, 5, 2], [4, 6, 2, 5]])
    lines = [f"OFF\n{len(points)} {len(quads)} 0", *(" ".join(map(str, p)) for p in points), *(f"4 {a} {b} {c} {d}" for a, b, c, d in quads)]
    (tmp_path / "quads.off").write_text("\n".join(lines))
    np.testing.assert_array_equal(Surface(points, quads).faces, Surface(tmp_path / "quads.off").faces)
