"""What would go unnoticed unless it is an error or a warning."""

from __future__ import annotations

from pathlib import Path

import canonform
import numpy as np
import pytest
from canonform import Index, Surface
from canonform.errors import MeshError, OptionError, PointError, SkippedMeshWarning, SurfaceLossWarning
from conftest import grid


def _ring(scale: float = 1.0) -> Surface:
    u, v = np.meshgrid(np.arange(24) * np.pi / 12, np.arange(12) * np.pi / 6, indexing="ij")
    points = np.stack([(2 + 0.7 * np.cos(v)) * np.cos(u), (2 + 0.7 * np.cos(v)) * np.sin(u), 0.7 * np.sin(v)], axis=-1)
    i, j = np.meshgrid(np.arange(24), np.arange(12), indexing="ij")
    at = lambda a, b: (a % 24) * 12 + b % 12  # noqa: E731
    first = np.stack([at(i, j), at(i + 1, j), at(i + 1, j + 1)], axis=-1).reshape(-1, 3)
    second = np.stack([at(i, j), at(i + 1, j + 1), at(i, j + 1)], axis=-1).reshape(-1, 3)
    return Surface(scale * points.reshape(-1, 3), np.concatenate([first, second]))


def _write(path: Path, surface: Surface) -> None:
    lines = [f"OFF\n{surface.n_vertices} {surface.n_faces} 0"]
    lines += [" ".join(map(repr, map(float, p))) for p in surface.vertices]
    lines += ["3 " + " ".join(map(str, face)) for face in surface.faces]
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture(scope="module")
def index(tmp_path_factory: pytest.TempPathFactory) -> Index:
    folder = tmp_path_factory.mktemp("shapes")
    _write(folder / "ring.off", _ring())
    _write(folder / "large.off", _ring(25.4))
    (folder / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n")
    with pytest.warns(SkippedMeshWarning, match=r"1 of the meshes.*broken\.off") as warned:
        index = Index.build(folder, folder / "all.canonform")
    assert warned[0].filename == __file__
    return index


def test_exports_have_the_format_of_their_name(index: Index, tmp_path: Path) -> None:
    starts = {"jsonl": b"{", "parquet": b"PAR1", "npz": b"PK", "csv": b"id,"}
    for extension, start in starts.items():
        index.export(tmp_path / f"out.{extension}")
        assert (tmp_path / f"out.{extension}").read_bytes().startswith(start), extension
    with pytest.raises(OptionError, match="xlsx.*parquet"):
        index.export(tmp_path / "out.xlsx")


def test_duplicates_are_groups_with_their_relation(index: Index) -> None:
    [group] = index.duplicates()
    [member] = group["members"]
    assert {group["keeper"]["id"], member["id"]} == {"ring", "large"}
    assert member["relation"]["kind"] == "scaled"
    assert index.duplicates(kinds=["identical-file"]) == []
    with pytest.raises(OptionError, match="equal"):
        index.duplicates(kinds=["equal"])


def test_a_mask_of_sources_stands_for_its_vertices(square: Surface) -> None:
    mask = np.zeros(square.n_vertices, dtype=bool)
    mask[[5, 40]] = True
    np.testing.assert_array_equal(square.distances(mask), square.distances([5, 40]))
    np.testing.assert_array_equal(square.distances(mask.tolist()), square.distances([5, 40]))
    with pytest.raises(PointError, match="one value for each of the 81 vertices"):
        square.distances(mask[:10])
    for wrong in (True, 1.0):
        with pytest.raises(PointError, match="not a point"):
            square.distances(wrong)


def test_a_lost_surface_is_a_warning() -> None:
    vertices, faces = grid()
    two = np.concatenate([vertices, vertices + [50.0, 0.0, 0.0]])
    with pytest.warns(SurfaceLossWarning, match='50 % of the surface.*components="bridge"'):
        Surface(two, np.concatenate([faces, faces + len(vertices)]))


def test_impossible_faces_are_named() -> None:
    vertices, faces = grid()
    with pytest.raises(MeshError, match="there are no faces"):
        Surface(vertices, np.empty((0, 3), dtype=int))
    faces = faces.copy()
    faces[7, 1] = -1
    with pytest.raises(MeshError, match="face 7 has the vertex number -1"):
        Surface(vertices, faces)


def test_pictures_need_a_value_for_every_vertex(square: Surface) -> None:
    with pytest.raises(OptionError, match=r"shape \(81,\)"):
        square.picture(np.zeros(5))


def test_asymmetric_distances_are_refused() -> None:
    pytest.importorskip("sklearn")
    from canonform.learn import NystromMDS

    points = np.random.default_rng(0).normal(size=(30, 3))
    matrix = np.linalg.norm(points[:, None] - points, axis=-1)
    NystromMDS(n_landmarks=12, metric="precomputed").fit(matrix)
    matrix[3, 4] += 1
    with pytest.raises(ValueError, match=r"symmetric.*X\[3, 4\]"):
        NystromMDS(n_landmarks=12, metric="precomputed").fit(matrix)


def test_all_warnings_are_public() -> None:
    assert issubclass(canonform.errors.SurfaceLossWarning, UserWarning)
