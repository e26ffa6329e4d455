"""Meshes of other packages, and results in them."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import canonform
import numpy as np
import pytest
from canonform import Surface
from canonform.datasets import Shape
from canonform.errors import MeshError

trimesh = pytest.importorskip("trimesh")
meshio = pytest.importorskip("meshio")


def same(surface: Surface, shape: Shape) -> None:
    np.testing.assert_array_equal(surface.vertices, shape.vertices)
    np.testing.assert_array_equal(surface.faces, shape.faces)


def test_trimesh(cat: Shape) -> None:
    mesh = trimesh.Trimesh(cat.vertices, cat.faces, process=False)
    surface = Surface(mesh)
    same(surface, cat)
    form = trimesh.Trimesh(surface.canonical_form(n_landmarks=30).points, surface.faces, process=False)
    assert form.is_watertight == mesh.is_watertight


def test_meshio(cat: Shape, tmp_path: Path) -> None:
    mesh = meshio.Mesh(cat.vertices, [("triangle", cat.faces[:100]), ("triangle", cat.faces[100:])])
    surface = Surface(mesh)
    same(surface, cat)
    out = meshio.Mesh(surface.vertices, {"triangle": surface.faces}, point_data={"distance": surface.distances(0)})
    out.write(tmp_path / "cat.vtu")
    np.testing.assert_array_equal(meshio.read(tmp_path / "cat.vtu").point_data["distance"], surface.distances(0))
    with pytest.raises(MeshError, match="tetra"):
        Surface(meshio.Mesh(cat.vertices, [("tetra", np.array([[0, 1, 2, 3]]))]))


def test_pyvista(cat: Shape) -> None:
    pyvista = pytest.importorskip("pyvista", exc_type=ImportError)
    mesh = pyvista.PolyData.from_regular_faces(cat.vertices, cat.faces)
    surface = Surface(mesh)
    same(surface, cat)
    mesh["distance"] = surface.distances(0)
    assert mesh["distance"].max() == surface.distances(0).max()
    assert Surface(pyvista.Sphere()).n_vertices == pyvista.Sphere().n_points


def test_matplotlib(cat: Shape, tmp_path: Path) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    form = cat.surface().canonical_form(n_landmarks=30)
    figure = plt.figure()
    axes = figure.add_subplot(projection="3d")
    axes.plot_trisurf(*form.points.T, triangles=form.faces)
    axes.plot(*cat.surface().path(0, 500).points.T)
    figure.savefig(tmp_path / "form.png", dpi=30)
    plt.close(figure)
    assert (tmp_path / "form.png").stat().st_size > 1000


def test_polyscope(cat: Shape, tmp_path: Path) -> None:
    # Drawing needs a display or EGL; the mock backend needs neither. In its own process, since it cannot be
    # shut down.
    pytest.importorskip("polyscope", exc_type=ImportError)
    canonform.datasets.write([cat], tmp_path)
    code = """
        import sys, canonform, polyscope
        polyscope.init("openGL_mock")
        surface = canonform.read(sys.argv[1])
        form = surface.canonical_form(n_landmarks=30)
        mesh = polyscope.register_surface_mesh("form", form.points, form.faces)
        mesh.add_scalar_quantity("distance", surface.distances(0))
        path = surface.path(0, 500)
        polyscope.register_curve_network("path", path.points, "line")
        assert mesh.n_vertices() == 1000
    """
    environment = {**os.environ, "PYTHONWARNINGS": "ignore"}
    command = [sys.executable, "-c", textwrap.dedent(code), tmp_path / "cat0.off"]
    subprocess.run(command, check=True, timeout=120, env=environment, cwd=tmp_path)


def test_pandas(cats: list[Shape]) -> None:
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({shape.name: shape.surface().signature() for shape in cats})
    assert frame.shape[1] == 2
    report = pandas.json_normalize(cats[0].surface().canonical_form(n_landmarks=30).report)
    assert report.loc[0, "n_samples"] == 30
