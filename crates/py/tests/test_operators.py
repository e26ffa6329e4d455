"""What surfaces are computed with: Laplacians, eigenfunctions, kernels, normals, gradients, nearest points."""

from __future__ import annotations

from pathlib import Path

import canonform
import numpy as np
import pytest
from canonform import EdgePoint, FacePoint, Surface
from canonform.datasets import Shape
from canonform.errors import OptionError, PointError
from conftest import grid

scipy = pytest.importorskip("scipy")


def ball(n: int = 3000) -> Surface:
    """A round surface of radius 2."""
    from scipy.spatial import ConvexHull

    i = np.arange(n) + 0.5
    height, turn = 1 - 2 * i / n, i * np.pi * (1 + 5**0.5)
    radius = np.sqrt(1 - height**2)
    points = 2 * np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])
    faces = ConvexHull(points).simplices
    a, b, c = points[faces].transpose(1, 0, 2)
    inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Surface(points, faces)


def test_matrices_are_those_of_linear_elements(cat: Shape) -> None:
    surface = cat.surface()
    stiffness, mass = surface.laplacian(), surface.mass()
    assert stiffness.shape == mass.shape == (1000, 1000) and stiffness.nnz < 10_000
    assert abs(stiffness - stiffness.T).max() < 1e-12
    assert np.abs(stiffness @ np.ones(1000)).max() < 1e-9 * stiffness.diagonal().max()
    assert mass.diagonal().sum() == pytest.approx(surface.area)


def test_no_intrinsic_weight_is_negative() -> None:
    vertices, faces = grid(9)
    surface = Surface(vertices @ np.array([[1, 0, 0], [2.7, 1, 0], [0, 0, 1.0]]), faces)
    stiffness = {"intrinsic": surface.laplacian(), "faces": -surface.divergence() @ surface.gradient()}
    entries = {name: (-matrix).tocoo() for name, matrix in stiffness.items()}
    negative = {name: max(0.0, -entry.data[entry.row != entry.col].min()) for name, entry in entries.items()}
    assert negative["intrinsic"] < 1e-12 < negative["faces"]


def test_a_flat_function_has_the_energy_of_its_slope() -> None:
    surface = Surface(*grid(12, 3.0))
    x = surface.vertices @ [3.0, -4.0, 0.0]
    for stiffness in (surface.laplacian(), -surface.divergence() @ surface.gradient()):
        assert x @ (stiffness @ x) == pytest.approx(25 * surface.area)
    np.testing.assert_allclose(surface.gradient(x), np.tile([3.0, -4.0, 0.0], (surface.n_faces, 1)), atol=1e-9)


def test_the_eigenbasis_of_a_ball_is_known() -> None:
    surface = ball()
    basis = surface.eigenbasis(9)
    # l (l + 1) / r^2, with multiplicity 2 l + 1.
    np.testing.assert_allclose(basis.values, np.repeat([0, 0.5, 1.5], [1, 3, 5]), atol=0.01)
    gram = basis.functions.T @ (surface.mass() @ basis.functions)
    np.testing.assert_allclose(gram, np.eye(9), atol=1e-8)
    residual = surface.laplacian() @ basis.functions - (surface.mass() @ basis.functions) * basis.values
    assert np.abs(residual).max() < 1e-6
    x = surface.vertices
    np.testing.assert_allclose(basis.synthesize(basis.project(x)), x, atol=0.02)
    with pytest.raises(OptionError, match=r"\(3000,\)"):
        basis.project(np.zeros(5))
    with pytest.raises(OptionError, match="n_eigenfunctions=0"):
        surface.eigenbasis(0)


def test_kernels_are_constant_on_a_ball_and_follow_poses(cats: list[Shape]) -> None:
    basis = ball().eigenbasis(36)
    for kernel in (basis.hks(n_times=5), basis.wks(n_energies=5, sigma=0.1)):
        assert kernel.shape == (3000, 5) and np.isfinite(kernel).all()
    # Up to the times at which only whole multiplets count.
    late = basis.hks(n_times=5)[:, 2:]
    assert (late.std(axis=0) < 0.02 * late.mean(axis=0)).all()
    a, b = (shape.surface() for shape in cats)
    for kernel, count in (("hks", {"n_times": 6}), ("wks", {"n_energies": 6, "sigma": 0.2})):
        given = {**count, "n_eigenfunctions": 60}
        ours, theirs = (np.sort(np.log(getattr(surface, kernel)(**given)), axis=0) for surface in (a, b))
        assert np.abs(ours - theirs).mean() < 0.2, kernel
    assert a.hks([1.0, 100.0], n_eigenfunctions=20).shape == (1000, 2)
    assert a.hks(np.geomspace(1, 10, 3), n_eigenfunctions=20).min() > 0


def test_dropped_and_merged_vertices_keep_their_places() -> None:
    vertices, faces = grid()
    surface = Surface(np.concatenate([vertices, [[9.0, 9.0, 0.0]]]), faces)
    assert surface.laplacian().shape == (82, 82) and surface.mass().diagonal()[81] == 1
    basis = surface.eigenbasis(5)
    assert np.isnan(basis.functions[81]).all() and np.isfinite(basis.functions[:81]).all()
    assert np.isfinite(basis.project(np.ones(82))).all()


def test_normals_areas_and_edges(square: Surface, cat: Shape) -> None:
    np.testing.assert_array_equal(square.normals, np.tile([0.0, 0.0, 1.0], (81, 1)))
    np.testing.assert_array_equal(square.face_normals, np.tile([0.0, 0.0, 1.0], (128, 1)))
    assert square.areas.sum() == pytest.approx(1.0) and square.edges.shape == (81 + 128 - 1, 2)
    round_one = ball()
    assert np.abs(round_one.normals - round_one.vertices / 2).max() < 0.05
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.Trimesh(cat.vertices, cat.faces, process=False)
    np.testing.assert_allclose(cat.surface().areas, mesh.area_faces)
    np.testing.assert_array_equal(cat.surface().edges, np.unique(np.sort(mesh.edges_unique, axis=1), axis=0))


def test_the_closest_point_is_the_nearest_of_all_faces(cat: Shape) -> None:
    surface = cat.surface()
    # Beside the middles of faces, along their normals.
    chosen = np.arange(0, surface.n_faces, 97)
    middles = surface.vertices[surface.faces[chosen]].mean(axis=1)
    found = surface.closest_point(middles + 1e-6 * surface.face_normals[chosen])
    np.testing.assert_array_equal(found.faces, chosen)
    np.testing.assert_allclose(np.asarray(found), middles, atol=1e-9)
    np.testing.assert_allclose(found.distances, 1e-6, rtol=1e-3)
    corners = surface.vertices[surface.faces[found.faces]]
    np.testing.assert_allclose(np.einsum("ij,ijk->ik", found.weights, corners), found.points, atol=1e-9)
    point = found.at[0]
    assert isinstance(point, FacePoint) and surface.distances(point).argmin() in surface.faces[point.face]
    for wrong in ([[0, 0]], "x", [[np.nan, 0, 0]]):
        with pytest.raises(PointError):
            surface.closest_point(wrong)


def test_points_are_objects(square: Surface) -> None:
    on_edge, in_face = EdgePoint(3, 4, 0.25), FacePoint(8, (2, 1, 1))
    np.testing.assert_array_equal(square.distances(on_edge), square.distances("3-4@0.25"))
    np.testing.assert_array_equal(square.distances([on_edge, in_face]), square.distances(["3-4@0.25", "f8@2:1:1"]))
    path = square.path(on_edge, in_face)
    assert (path.at[0], path.at[-1]) == (on_edge, in_face)
    assert {type(point) for point in path.at[1:-1]} <= {EdgePoint, int}
    form = square.canonical_form(n_landmarks=20)
    np.testing.assert_array_equal(form.place([on_edge]), form.place(["3-4@0.25"]))


def test_surfaces_are_written_exactly(cat: Shape, tmp_path: Path) -> None:
    cat.surface().write(tmp_path / "cat.ply")
    again = canonform.read(tmp_path / "cat.ply")
    np.testing.assert_array_equal(again.vertices, cat.vertices)
    np.testing.assert_array_equal(again.faces, cat.faces)


def test_the_logarithmic_map_of_a_plane_is_the_plane() -> None:
    vertices, faces = grid(12, 3.0)
    turned = vertices @ np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]]).T + 5
    surface = Surface(turned, faces)
    # Vertex v is at (v // 12, v % 12), and its neighbor with the lowest number one row before, diagonally.
    source = 65
    along = vertices[source - 13] - vertices[source]
    x, y = along[:2] / np.linalg.norm(along)
    expected = (vertices - vertices[source])[:, :2] @ np.array([[x, -y], [y, x]])
    np.testing.assert_allclose(surface.log_map(source), expected, atol=1e-12)
    # In a face, from the first corner to the second.
    corners = vertices[faces[40]]
    x, y = (corners[1] - corners[0])[:2] / np.linalg.norm(corners[1] - corners[0])
    expected = (vertices - corners.mean(axis=0))[:, :2] @ np.array([[x, -y], [y, x]])
    np.testing.assert_allclose(surface.log_map(FacePoint(40)), expected, atol=1e-12)


def test_the_logarithmic_map_of_a_ball_is_azimuthal_equidistant() -> None:
    surface = ball()
    points, pole = surface.vertices / 2, 1000
    found = surface.log_map(pole)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), surface.distances(pole, geodesic="exact"), atol=1e-12)
    angles = np.arccos(np.clip(points @ points[pole], -1, 1))
    tangent = points - (points @ points[pole])[:, None] * points[pole]
    lowest = min(surface.edges[(surface.edges == pole).any(axis=1)].ravel())
    x = tangent[lowest] / np.linalg.norm(tangent[lowest])
    y = np.cross(points[pole], x)
    flat = 2 * angles[:, None] * np.column_stack([tangent @ x, tangent @ y])
    expected = flat / np.maximum(np.linalg.norm(tangent, axis=1), 1e-9)[:, None]
    # Near the other pole, all directions lead there.
    near = angles < 2
    assert np.linalg.norm(found - expected, axis=1)[near].max() < 0.1
    assert np.linalg.norm(found - expected, axis=1)[near].mean() < 0.02


def test_the_logarithmic_map_is_about_one_point(square: Surface) -> None:
    assert square.log_map(3).shape == (81, 2) and (square.log_map(3)[3] == 0).all()
    np.testing.assert_allclose(np.linalg.norm(square.log_map(EdgePoint(3, 4)), axis=1), square.distances(EdgePoint(3, 4), geodesic="exact"))
    for wrong in ([0, 1], 81, None, []):
        with pytest.raises(PointError):
            square.log_map(wrong)
    vertices, faces = grid()
    with_loose = Surface(np.concatenate([vertices, [[9.0, 9.0, 0.0]]]), faces)
    assert np.isnan(with_loose.log_map(0)[81]).all()
    whole, near = square.log_map(3), square.log_map(3, max_distance=0.5)
    is_near = np.linalg.norm(whole, axis=1) <= 0.5
    assert is_near.any() and not is_near.all()
    np.testing.assert_array_equal(near[is_near], whole[is_near])
    assert np.isnan(near[~is_near]).all()


def test_kernels_are_those_of_pyfm_with_equal_parameters(cat: Shape) -> None:
    kernels = pytest.importorskip("pyFM.signatures")
    basis = cat.surface().eigenbasis(60)
    values, functions = basis.values, np.asarray(basis.functions)
    assert np.abs(basis.wks() - kernels.auto_WKS(values, functions, 100)).max() < 1e-6 * basis.wks().max()
    at, sigma = np.linspace(-6, -3, 7), 0.3
    for scaled in (False, True):
        for ours, theirs in [
            (basis.wks(at, sigma=sigma, scaled=scaled), kernels.WKS(values, functions, at, sigma, scaled=scaled)),
            (basis.hks([1, 50.0], scaled=scaled), kernels.HKS(values, functions, [1, 50.0], scaled=scaled)),
        ]:
            np.testing.assert_allclose(ours, theirs, rtol=1e-6, atol=1e-12)


def test_gradient_and_divergence_are_matrices(cat: Shape) -> None:
    surface = cat.surface()
    gradient, divergence = surface.gradient(), surface.divergence()
    values = np.sin(surface.vertices[:, 0])
    np.testing.assert_allclose((gradient @ values).reshape(-1, 3), surface.gradient(values), atol=1e-12)
    np.testing.assert_allclose(divergence @ (gradient @ values), surface.divergence(surface.gradient(values)))
    # Faces with angles of at most 90 degrees around each edge are their own intrinsic Delaunay triangulation.
    flat = Surface(*grid(9))
    stiffness = flat.laplacian()
    assert abs(flat.divergence() @ flat.gradient() + stiffness).max() < 1e-9 * abs(stiffness).max()
    with pytest.raises(OptionError, match="vectors must be an array of numbers of shape"):
        surface.divergence(values)


def test_what_was_computed_is_kept_and_grows(cat: Shape, monkeypatch: pytest.MonkeyPatch) -> None:
    surface = Surface(cat.vertices, cat.faces)
    asked: list[int] = []
    from canonform import _canonform

    found = _canonform.eigenbasis
    monkeypatch.setattr(_canonform, "eigenbasis", lambda surface, k: (asked.append(k), found(surface, k))[1])
    basis = surface.eigenbasis(30)
    np.testing.assert_array_equal(surface.hks(n_eigenfunctions=30), basis.hks())
    assert surface.wks(n_eigenfunctions=20).shape == (1000, 100)
    assert surface.eigenbasis(30) is basis and asked == [30]
    np.testing.assert_array_equal(surface.eigenbasis(12).functions, basis.functions[:, :12])
    assert len(surface.eigenbasis(40)) == 40 and asked == [30, 40]
    # Matrices are copies, and arrays are not writable: who changes them does not change what is kept.
    surface.laplacian().data[:] = 0
    assert abs(surface.laplacian()).max() > 0
    for kept in (basis.functions, surface.hks(n_eigenfunctions=30)):
        with pytest.raises(ValueError, match="read-only"):
            kept[0] = 1
