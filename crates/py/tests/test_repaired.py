"""A mesh that needs repair, through every method: numbers where there is a surface, and NaN elsewhere."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import canonform
import numpy as np
import pytest
from canonform import FacePoint, Surface
from canonform.datasets import Shape
from canonform.errors import OptionError, PointError, SurfaceLossWarning
from numpy.typing import NDArray

sparse = pytest.importorskip("scipy.sparse")

STRAYS = [0, 1001]
TWIN = 1002
FAR = [1003, 1004, 1005]


@pytest.fixture(scope="module")
def damaged(cat: Shape) -> Surface:
    """A cat after a stray vertex, and before another, a twin of a vertex, for one of its faces, and a small triangle far away."""
    vertices, faces = cat.vertices, cat.faces + 1
    twin = int(faces[50, 0])
    faces[50, 0] = TWIN
    size = np.ptp(vertices, axis=0).max()
    far = vertices[0] + size * np.array([[3.0, 0, 0], [3.01, 0, 0], [3, 0.01, 0]])
    every = np.concatenate([[[9 * size, 0, 0]], vertices, [[np.pi, 9 * size, 0]], vertices[[twin - 1]], far])
    return Surface(every, np.concatenate([faces, [FAR]]))


def on_vertices(name: str, found: NDArray[np.float64], surface: Surface, axis: int = 0) -> None:
    """Finite on the surface, NaN elsewhere."""
    rows = np.moveaxis(np.asarray(found), axis, 0).reshape(surface.n_vertices, -1)
    assert np.isfinite(rows[surface.kept]).all(), name
    assert np.isnan(rows[~surface.kept]).all(), name
    np.testing.assert_array_equal(found.valid, surface.kept, err_msg=name)


def through_every_method(surface: Surface, source: int, other: Surface) -> None:
    kept = surface.kept
    form = surface.canonical_form(30)
    field = surface.distance_field(20)
    per_vertex: dict[str, Any] = {
        "distances": surface.distances(source),
        "exact": surface.distances([source], geodesic="exact"),
        "form": form.points,
        "bent": form.bent_surface(),
        "functions": surface.eigenbasis(20).functions,
        "hks": surface.hks(n_eigenfunctions=20),
        "wks": surface.wks(n_eigenfunctions=20),
        "log map": surface.log_map(source),
        "residuals": canonform.compare(surface, other, n_landmarks=30).residuals,
    }
    for name, found in per_vertex.items():
        on_vertices(name, found, surface)
    on_vertices("rows", surface.distances_many([source, "f3"]), surface, axis=1)
    on_vertices("landmarks", form.distances, surface, axis=1)
    np.testing.assert_array_equal(form.valid, kept)
    distances = surface.distances(source)
    path = surface.path(source, distances.argmax())
    assert np.isfinite(path.points).all() and path.length == pytest.approx(distances.max(), rel=0.05)
    assert kept[surface.farthest_points(20)].all()
    row = field.row(source)
    for values in (row.distance, row.lower, row.upper):
        np.testing.assert_array_equal(np.isnan(values), ~kept)
    np.testing.assert_array_equal(row.valid, kept)
    assert kept[field.nearest(source, 30)[0]].all()
    assert np.isfinite(surface.signature()).all() and np.isfinite(surface.area)
    # Normals and gradients are of the input; stray vertices and faces without area have none.
    for found in (surface.normals, surface.face_normals, surface.gradient(surface.vertices[:, 0])):
        assert np.isfinite(np.asarray(found)[found.valid]).all() and found.valid.mean() > 0.9
    near = surface.closest_point(surface.vertices[:5] + 0.01)
    assert np.isfinite(near.points).all() and np.isfinite(surface.distances(near.at)[kept]).all()
    match = canonform.match(surface, other, n_eigenfunctions=30).best
    np.testing.assert_array_equal(match.valid, kept)
    np.testing.assert_array_equal(match.points().valid, kept)
    assert (other.kept[match.vertices[kept]]).all()
    assert surface.picture(distances, width=60, height=60) and surface.view(distances).n_faces


def test_every_method_has_numbers_where_there_is_a_surface(damaged: Surface, cats: list[Shape]) -> None:
    assert np.flatnonzero(~damaged.kept).tolist() == [*STRAYS, *FAR]
    through_every_method(damaged, 5, cats[1].surface())


def test_the_repaired_mesh_is_given_with_maps_both_ways(damaged: Surface, cat: Shape, tmp_path: Path) -> None:
    repaired = damaged.repaired
    np.testing.assert_array_equal(repaired.vertices, cat.vertices)
    np.testing.assert_array_equal(damaged.vertices[repaired.to_input], repaired.vertices)
    np.testing.assert_array_equal(repaired.from_input[repaired.to_input], np.arange(1000))
    np.testing.assert_array_equal(repaired.from_input >= 0, damaged.kept)
    assert repaired.from_input[TWIN] == cat.faces[50, 0] and len(repaired.faces) == len(cat.faces)
    damaged.write(tmp_path / "cat.ply", repaired=True)
    again = canonform.read(tmp_path / "cat.ply")
    np.testing.assert_array_equal(again.vertices, repaired.vertices)
    np.testing.assert_array_equal(again.faces, repaired.faces)
    assert again.kept.all() and not again.repair_report.lines
    np.testing.assert_array_equal(Surface(repaired).distances(4), damaged.distances(5)[repaired.to_input])


def test_operators_are_not_singular(damaged: Surface, cat: Shape) -> None:
    from scipy.sparse.linalg import eigsh

    stiffness, mass = damaged.laplacian(), damaged.mass()
    own = damaged.repaired.to_input
    assert (mass.diagonal() > 0).all() and (np.delete(mass.diagonal(), own) == 1).all()
    largest = eigsh(stiffness, k=3, M=mass, return_eigenvectors=False)
    expected = eigsh(cat.surface().laplacian(), k=3, M=cat.surface().mass(), return_eigenvectors=False)
    np.testing.assert_allclose(largest, expected)
    rows = stiffness[own][:, own]
    assert abs(rows - cat.surface().laplacian()).max() < 1e-9 * abs(rows).max()


def test_what_is_returned_goes_into_other_packages(damaged: Surface) -> None:
    from scipy.spatial import cKDTree

    cluster = pytest.importorskip("sklearn.cluster")
    kernels, form = damaged.hks(n_eigenfunctions=20), damaged.canonical_form(20)
    assert len(set(cluster.KMeans(3, n_init=1, random_state=0).fit_predict(kernels[kernels.valid]))) == 3
    distances = damaged.distances(5)
    assert np.histogram(distances[distances.valid], 10)[0].sum() == damaged.kept.sum()
    assert cKDTree(form.points[form.valid]).query(form.points[5])[0] == 0


def test_extremes_are_those_of_finite_numbers(damaged: Surface) -> None:
    distances = damaged.distances(5, max_distance=10.0)
    assert np.isinf(distances).any() and np.isnan(distances).any()
    assert (distances.argmin(), distances.min()) == (5, 0) and 0 < distances.max() <= 10
    assert distances[np.argmax(distances)] == np.max(distances) == distances.max()
    assert {type(found) for found in (distances[5], distances.mean(), np.nanmean(distances), (distances > 1).any())} == {np.float64, np.bool_}
    assert type(2 * distances) is type(distances) and (2 * distances).max() == 2 * distances.max()


def test_dropped_vertices_are_no_points(damaged: Surface) -> None:
    for vertex in (*STRAYS, *FAR):
        with pytest.raises(PointError):
            damaged.distances(vertex)
    with pytest.raises(PointError):
        damaged.distances(FacePoint(damaged.n_faces - 1))
    with pytest.raises(OptionError, match="masked"):
        damaged.gradient(np.ma.masked_invalid(damaged.distances(5)))


@pytest.mark.filterwarnings("ignore::canonform.errors.SurfaceLossWarning")
def test_the_bunny() -> None:
    folder = Path(os.environ.get("CANONFORM_DATA", "/nowhere")) / "single"
    found = sorted(folder.glob("*bunny*"))
    if not found:
        pytest.skip("needs the Stanford bunny in CANONFORM_DATA")
    bunny = Surface(found[0])
    assert SurfaceLossWarning and not bunny.kept.all()
    distances = bunny.distances(0)
    np.testing.assert_array_equal(distances.valid, bunny.kept)
    assert np.isfinite(bunny.path(0, distances.argmax()).points).all()
    assert (bunny.mass().diagonal() > 0).all()
