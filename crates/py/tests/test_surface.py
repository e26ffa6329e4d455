"""Distances, paths, samples, forms and signatures of a surface."""

from __future__ import annotations

import canonform
import numpy as np
import pytest
from canonform import FastMarching, Landmark, Nystrom, Spectral, Surface
from canonform.datasets import Shape
from canonform.errors import EmbeddingError, MeshError, MissingFileError, OptionError, PointError, TimeLimitError
from conftest import grid
from numpy.typing import NDArray


def test_distances_in_the_plane_are_euclidean(square: Surface) -> None:
    vertices, _ = grid()
    for method in ("fast-marching", "exact"):
        expected = np.linalg.norm(vertices - vertices[0], axis=1)
        np.testing.assert_allclose(square.distances(0, geodesic=method), expected, atol=1e-12)


def test_several_sources_give_the_nearest_or_one_row_each(square: Surface) -> None:
    rows = square.distances_many([0, 80, "3-4@0.25"])
    assert rows.shape == (3, 81)
    for row, source in zip(rows, [0, 80, "3-4@0.25"], strict=True):
        np.testing.assert_array_equal(row, square.distances(source))
    np.testing.assert_allclose(square.distances([0, 80], geodesic="exact"), np.minimum(*square.distances_many([0, 80], geodesic="exact")))
    assert square.distances_many([]).shape == (0, 81)


def test_distances_end_at_the_limit(square: Surface) -> None:
    near = square.distances(0, max_distance=0.5)
    whole = square.distances(0)
    np.testing.assert_array_equal(near, np.where(whole <= 0.5, whole, np.inf))


@pytest.mark.parametrize("vertex_type", [np.float64, np.float32, np.float16, np.int32])
@pytest.mark.parametrize("face_type", [np.int64, np.int32, np.uint32, np.uint8, np.float64])
def test_arrays_of_any_type_are_taken(vertex_type: type, face_type: type) -> None:
    vertices, faces = grid(5, 4.0)
    expected = Surface(vertices, faces).distances(0)
    np.testing.assert_array_equal(Surface(vertices.astype(vertex_type), faces.astype(face_type)).distances(0), expected)


def test_arrays_of_any_layout_are_taken(cat: Shape) -> None:
    expected = Surface(cat.vertices, cat.faces).distances(7)
    wide = np.zeros((2 * len(cat.vertices), 7), dtype=np.float64)
    wide[::2, 1:7:2] = cat.vertices
    backwards = np.ascontiguousarray(cat.faces[::-1])[::-1]
    for vertices, faces in [
        (np.asfortranarray(cat.vertices), np.asfortranarray(cat.faces)),
        (wide[::2, 1:7:2], backwards),
        (cat.vertices.astype(">f8"), cat.faces.astype(">i4")),
        (cat.vertices.tolist(), cat.faces.tolist()),
    ]:
        np.testing.assert_array_equal(Surface(vertices, faces).distances(7), expected)


def test_the_mesh_is_not_changed_with_the_arrays(cat: Shape) -> None:
    vertices, faces = cat.vertices.copy(), cat.faces.copy()
    surface = Surface(vertices, faces)
    vertices[:], faces[:] = 0, 0
    np.testing.assert_array_equal(surface.vertices, cat.vertices)
    np.testing.assert_array_equal(surface.faces, cat.faces)
    with pytest.raises(ValueError, match="read-only"):
        surface.vertices[0] = 1


def ball(n: int) -> NDArray[np.float64]:
    """Points spread evenly over the unit sphere."""
    i = np.arange(n) + 0.5
    height, turn = 1 - 2 * i / n, i * np.pi * (1 + 5**0.5)
    radius = np.sqrt(1 - height**2)
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])


@pytest.mark.slow
def test_points_without_faces_are_a_surface(tmp_path) -> None:
    points = ball(2000)
    surface = Surface(np.concatenate([points, points[:5], [[0, 0, 50]]]))
    assert (surface.n_vertices, surface.n_faces) == (2006, 3996)
    report = surface.repair_report["points"]
    assert (report["n_points"], report["replaced_points"], report["outliers"]) == (2006, 5, 1)
    distances = surface.distances(0, geodesic="exact")
    assert np.isnan(distances[2005]) and distances[2000] == 0 and not surface.kept[2005]
    straight = np.linalg.norm(points - points[0], axis=1)
    np.testing.assert_allclose(distances[:2000], 2 * np.arcsin(straight / 2), rtol=0.001)
    np.savetxt(tmp_path / "ball.xyz", points)
    read = canonform.read(tmp_path / "ball.xyz")
    np.testing.assert_allclose(read.distances(0, geodesic="exact"), distances[:2000])
    assert len(read.canonical_form(n_landmarks=20).points) == 2000


def test_results_are_in_the_order_of_the_input() -> None:
    vertices, faces = grid()
    # An unused vertex first, and a far triangle that is dropped.
    far = [[9.0, 9, 9], [9.1, 9, 9], [9, 9.1, 9]]
    mixed = np.concatenate([[[5.0, 5, 5]], vertices, far])
    surface = Surface(mixed, np.concatenate([faces + 1, [[82, 83, 84]]]))
    expected = np.concatenate([[np.nan], Surface(vertices, faces).distances(3), [np.nan] * 3])
    np.testing.assert_array_equal(surface.distances(4), expected)
    np.testing.assert_array_equal(surface.distances_many([4])[0], expected)
    form = surface.canonical_form(n_landmarks=20)
    assert np.isnan(form.points).all(axis=1).nonzero()[0].tolist() == [0, 82, 83, 84]
    assert surface.repair_report["dropped_components"] == 1
    assert "component" in str(surface.repair_report)
    assert set(surface.farthest_points(5)) <= set(range(1, 82))
    with pytest.raises(PointError, match='components="bridge"'):
        surface.distances(83)


def test_paths_lead_from_start_to_end(cat: Shape) -> None:
    surface = cat.surface()
    path = surface.path(3, 700)
    np.testing.assert_array_equal(path.points[[0, -1]], cat.vertices[[3, 700]])
    assert (path.at[0], path.at[-1]) == (3, 700)
    steps = np.linalg.norm(np.diff(path.points, axis=0), axis=1)
    np.testing.assert_allclose(np.cumsum(steps), path.along[1:], rtol=1e-9)
    np.testing.assert_allclose(path.length, surface.distances(3, geodesic="exact")[700], rtol=0.01)
    several = surface.path(3, [700, "10-11"] if _has_edge(cat, 10, 11) else [700, 5])
    assert len(several) == 2
    np.testing.assert_array_equal(several[0].points, path.points)
    np.testing.assert_array_equal(np.asarray(path), path.points)


def _has_edge(shape: Shape, a: int, b: int) -> bool:
    return bool(((shape.faces == a).any(axis=1) & (shape.faces == b).any(axis=1)).any())


def test_a_form_of_a_folded_sheet_is_the_flat_sheet() -> None:
    vertices, faces = grid(21)
    folded = vertices.copy()
    half = folded[:, 0] > 0.5
    folded[half, 2], folded[half, 0] = folded[half, 0] - 0.5, 0.5
    form = Surface(folded, faces).canonical_form(n_landmarks=50, geodesic="exact")
    flat = np.linalg.norm(vertices[:, None] - vertices[None], axis=2)
    embedded = np.linalg.norm(form.points[:, None] - form.points[None], axis=2)
    np.testing.assert_allclose(embedded, flat, atol=0.01)
    assert form.normalized_stress is not None and form.normalized_stress < 0.005
    assert form.report["n_samples"] == 50 and form.landmarks.shape == (50,)
    np.testing.assert_allclose(form.distances[3], Surface(folded, faces).distances(form.landmarks[3], geodesic="exact"))


def test_every_embedding_makes_a_form(square: Surface) -> None:
    for method in canonform.embedding_methods():
        chosen = Spectral(n_eigenfunctions=30) if method == "spectral" else method
        form = square.canonical_form(n_landmarks=20, method=chosen, n_components=2)
        assert form.points.shape == (81, 2) and np.isfinite(form.points).all(), method
        assert form.report["method"] == method


def test_a_surface_bent_into_its_form_is_its_surface(cat: Shape) -> None:
    surface = cat.surface()
    form = surface.canonical_form(50)
    bent = canonform.Surface(form.bent_surface(), surface.faces)
    assert abs(bent.area / surface.area - 1) < 0.05
    assert abs(canonform.Surface(form.points, surface.faces).area / surface.area - 1) > 0.1
    with pytest.raises(EmbeddingError):
        surface.canonical_form(50, n_components=2).bent_surface()


def test_a_form_is_written_as_a_mesh(cat: Shape, tmp_path) -> None:
    form = cat.surface().canonical_form(n_landmarks=30)
    form.write(tmp_path / "form.ply")
    again = canonform.read(tmp_path / "form.ply")
    np.testing.assert_allclose(again.vertices, form.points, rtol=1e-6, atol=1e-6 * np.abs(form.points).max())
    np.testing.assert_array_equal(again.faces, cat.faces)
    with pytest.raises(EmbeddingError, match="n_components="):
        cat.surface().canonical_form(n_landmarks=30, n_components=2).write(tmp_path / "flat.ply")


@pytest.mark.slow
def test_signatures_do_not_depend_on_pose_and_size(cats: list[Shape]) -> None:
    a, b = (shape.surface().signature() for shape in cats)
    dog = canonform.datasets.generate("david", poses=1, n_vertices=1000)[0]
    assert a.dtype == np.float32 and a.ndim == 1
    assert np.linalg.norm(a - b) < 0.5 * np.linalg.norm(a - dog.surface().signature())
    larger = Surface(10 * cats[0].vertices, cats[0].faces)
    np.testing.assert_allclose(larger.signature(), a, atol=1e-4)
    assert np.linalg.norm(larger.signature(size=True)[: len(a)] - cats[0].surface().signature(size=True)[: len(a)]) < 100
    assert cats[0].surface().signature("shape-dna").dtype == np.float64


def test_settings_reach_the_library(cat: Shape) -> None:
    surface = cat.surface()
    usual = surface.canonical_form(n_landmarks=30)
    method, geodesic = Nystrom(rank=7, sampling="random"), FastMarching(update="planar")
    other = surface.canonical_form(n_landmarks=30, method=method, geodesic=geodesic, seed=3)
    assert other.report["rank"] == 7 and other.report["sampling"] == "random"
    assert not np.array_equal(usual.points, other.points)
    np.testing.assert_array_equal(surface.canonical_form(n_landmarks=np.int64(30)).points, usual.points)
    assert surface.canonical_form(n_landmarks=40, method=Spectral(mu=np.inf)).report["method"] == "spectral"


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda s: s.distances(0, geodesic="fastest"), OptionError, 'geodesic="fastest" is not possible: use "fast-marching"'),
        (lambda s: FastMarching(update="magic"), OptionError, 'update="magic" is not possible'),
        (lambda s: s.distances(0, geodesic=Nystrom()), OptionError, "geodesic=Nystrom() is not possible"),
        (lambda s: s.distances(0, method="exact"), TypeError, "unexpected keyword argument 'method'"),
        (lambda s: s.distances([]), PointError, "no sources"),
        (lambda s: s.distances(np.zeros(81, dtype=bool)), PointError, "no sources"),
        (lambda s: s.distances(np.ma.array([1, 2], mask=[True, False])), OptionError, "masked"),
        (lambda s: s.distances(0, max_distance=-1), OptionError, "max_distance=-1 is not possible: give a number, 0 or more"),
        (lambda s: s.distances_many([0], max_distance=np.nan), OptionError, "max_distance=nan"),
        (lambda s: s.distances(0, max_distance=True), OptionError, "max_distance=True"),
        (lambda s: s.hks(times=[-1]), OptionError, "times=[-1] is not possible: give finite numbers larger than 0"),
        (lambda s: s.hks(times=0), OptionError, "larger than 0"),
        (lambda s: s.hks(times=[1, np.nan]), OptionError, "finite"),
        (lambda s: s.hks(times=[np.inf]), OptionError, "finite"),
        (lambda s: s.hks(times=[]), OptionError, "times=[]"),
        (lambda s: s.wks(energies=[np.nan]), OptionError, "energies"),
        (lambda s: s.wks(n_energies=2.5), OptionError, "n_energies=2.5"),
        (lambda s: s.wks(n_energies=28), OptionError, "n_energies=28 makes bands that are wider than the spectrum; give 29"),
        (lambda s: s.wks(sigma=0), OptionError, "sigma=0"),
        (lambda s: s.distances(0, timeout=1e-9), TimeLimitError, "raise timeout="),
        (lambda s: s.distances(0, memory=100), canonform.errors.MemoryLimitError, "raise memory="),
        (lambda s: s.hks(timeout="soon"), OptionError, "timeout='soon'"),
        (lambda s: s.hks(threads=-1), OptionError, "threads=-1"),
        (lambda s: s.eigenbasis(True), OptionError, "n_eigenfunctions=True"),
        (lambda s: s.canonical_form(2.5), OptionError, "n_landmarks=2.5"),
        (lambda s: s.canonical_form(True), OptionError, "n_landmarks="),
        (lambda s: s.canonical_form(seed=1.5), OptionError, "seed=1.5"),
        (lambda s: s.distances(81), PointError, "vertex 81 does not exist; the mesh has 128 faces and 81 vertices"),
        (lambda s: s.distances("x"), PointError, "write 17 for a vertex"),
        (lambda s: s.path(0, "0-80"), PointError, "edge 0-80 does not exist"),
        (lambda s: s.distances(1.5), PointError, "1.5 is not a point"),
        (lambda s: s.canonical_form(method="umap"), OptionError, 'use "nmds"'),
        (lambda s: Nystrom(rank=5, regularization="none"), OptionError, 'or use regularization="low-rank" or "cur"'),
        (lambda s: Spectral(n_eigenfunctions=-1), OptionError, "n_eigenfunctions=-1 is not possible"),
        (lambda s: Landmark(first=-1), OptionError, "first=-1 is not possible"),
        (lambda s: s.canonical_form(n_landmarks=0), OptionError, "n_landmarks=0 is not possible"),
        (lambda s: s.canonical_form(n_landmarks=3, n_components=30), EmbeddingError, "30 dimensions"),
        (lambda s: s.canonical_form(timeout=0), OptionError, "positive number of seconds"),
        (lambda s: s.canonical_form(timeout=1e-9), TimeLimitError, "raise timeout="),
        (lambda s: s.canonical_form(memory="1K"), canonform.errors.MemoryLimitError, "raise memory="),
        (lambda s: s.canonical_form(memory="much"), OptionError, '"2G"'),
        (lambda s: s.canonical_form(method=Landmark(first=500)), PointError, "vertex 500"),
        (lambda s: s.signature("magic"), OptionError, '"fused", "form-spectrum"'),
        (lambda s: canonform.read(__file__), MeshError, "unknown mesh format"),
        (lambda s: Surface(grid()[0], grid()[1], components="all"), OptionError, "components="),
        (lambda s: Surface(grid()[0], grid()[1], weld=-1), OptionError, "weld=-1"),
        (lambda s: Surface(np.full((3, 3), np.nan), [[0, 1, 2]]), MeshError, "not finite"),
        (lambda s: Surface("cat.off"), MissingFileError, "cat.off"),
        (lambda s: Surface(b"OFF"), MeshError, 'format="ply"'),
        (lambda s: Surface(grid()[0][:11]), MeshError, "at least 12 points"),
        (lambda s: canonform.align(s.canonical_form(n_landmarks=20, n_components=2), s), EmbeddingError, "n_components="),
        (lambda s: canonform.datasets.generate("whale"), OptionError, "'cat'"),
        (lambda s: canonform.datasets.generate("cat", n_vertices=10), OptionError, "1000"),
        (lambda s: canonform.datasets.generate("cat", poses=[9]), OptionError, "0 to 8"),
    ],
)
def test_errors_say_what_to_do(square: Surface, call, kind: type[Exception], words: str) -> None:
    with pytest.raises(kind) as raised:
        call(square)
    assert words in str(raised.value), str(raised.value)
    assert "--" not in str(raised.value), "flags belong to the command line"


def test_exceptions_are_also_the_built_in_ones() -> None:
    from canonform import errors

    for kind, built_in in [
        (errors.MeshError, ValueError),
        (errors.OptionError, ValueError),
        (errors.PointError, IndexError),
        (errors.MissingFileError, FileNotFoundError),
        (errors.TimeLimitError, TimeoutError),
        (errors.MemoryLimitError, MemoryError),
        (errors.NoSuchShapeError, LookupError),
    ]:
        assert issubclass(kind, built_in) and issubclass(kind, errors.CanonformError)


def test_samples_are_taken_until_they_are_enough(cat: Shape) -> None:
    surface = cat.surface()
    form = surface.canonical_form(n_landmarks="auto")
    auto = form.report["auto"]
    assert auto["stop"] == "settled" and 2 * auto["sufficient"] <= len(form.landmarks)


def test_unaligned_arrays_are_read(square: Surface) -> None:
    def unaligned(array: np.ndarray) -> np.ndarray:
        found = np.frombuffer(b"x" + array.tobytes(), dtype=array.dtype, offset=1).reshape(array.shape)
        assert not found.flags.aligned
        return found

    surface = Surface(*map(unaligned, grid()))
    np.testing.assert_array_equal(surface.distances(0), square.distances(0))
    assert surface.picture(unaligned(surface.distances(0))) == square.picture(square.distances(0))
