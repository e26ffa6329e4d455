"""Distance fields."""

from __future__ import annotations

from pathlib import Path

import canonform
import numpy as np
import pytest
from canonform import DistanceField, Surface
from canonform.datasets import Shape
from canonform.errors import FileError, MissingFileError, OptionError, PointError
from conftest import Program


@pytest.fixture(scope="module")
def surface(cat: Shape) -> Surface:
    return cat.surface()


@pytest.fixture(scope="module", params=["exact", "fast-marching"])
def field(request: pytest.FixtureRequest, surface: Surface) -> DistanceField:
    return surface.distance_field(geodesic=request.param)


def test_bounds_hold_the_exact_distances(surface: Surface, field: DistanceField) -> None:
    assert field.certified == (field.facts["method"] == "exact")
    for source in (0, 500):
        exact = surface.distances(source, geodesic="exact")
        for row in (field.row(source), field.row(source, tolerance=None)):
            assert len(row) == field.n_vertices
            assert (row.lower <= exact).all() and (exact <= row.upper).all()
            assert (row.lower <= row.distance).all() and (row.distance <= row.upper).all()
        near = exact > 0
        assert np.abs(np.asarray(field.row(source))[near] / exact[near] - 1).max() < 0.1


def test_pairs_equal_single_pairs_and_are_finished_on_demand(surface: Surface, field: DistanceField) -> None:
    pairs = np.random.default_rng(0).integers(0, field.n_vertices, (50, 2))
    plain = field.pairs(pairs, tolerance=None)
    for i, (a, b) in enumerate(pairs):
        pair = field.pair(a, b)
        assert (pair.distance, pair.lower, pair.upper) == (plain.distance[i], plain.lower[i], plain.upper[i])
    exact = field.pairs(pairs.astype(np.uint32), tolerance=0.0)
    expected = [surface.distances(int(a), geodesic="exact")[b] for a, b in pairs]
    assert exact.exact.all()
    np.testing.assert_allclose(exact.distance, expected, rtol=1e-9)
    assert len(field.pairs([])) == 0


def test_the_nearest_vertices_are_exact(surface: Surface, field: DistanceField) -> None:
    vertices, distances = field.nearest(7, 10)
    exact = surface.distances(7, geodesic="exact")
    np.testing.assert_allclose(distances, np.sort(exact)[1:11], rtol=1e-9)
    np.testing.assert_allclose(exact[vertices], distances, rtol=1e-9)


def test_a_file_is_that_of_the_command_line(program: Program, cat: Shape, tmp_path: Path) -> None:
    mesh, path = Path(canonform.datasets.write([cat], tmp_path)[0]), tmp_path / "cat.field"
    program.run("field", "build", mesh, "--landmarks", "30", "-o", path)
    field = canonform.read(mesh).distance_field(30)
    field.save(tmp_path / "same.field")
    assert path.read_bytes() == (tmp_path / "same.field").read_bytes()
    answers = program.json("field", "query", path, "--source", "17")["pairs"]
    row = DistanceField.load(path).row(17)
    np.testing.assert_array_equal([answer["distance"] for answer in answers], row.distance)
    np.testing.assert_array_equal([answer["upper"] for answer in answers], row.upper)


def test_mistakes_are_named(field: DistanceField, surface: Surface, tmp_path: Path) -> None:
    with pytest.raises(PointError, match="vertex 1000 does not exist"):
        field.pair(0, 1000)
    with pytest.raises(PointError, match="-1 is not a vertex"):
        field.row(-1)
    with pytest.raises(PointError, match="shape"):
        field.pairs([1, 2, 3])
    with pytest.raises(OptionError, match="tolerance"):
        field.row(0, tolerance=-1.0)
    with pytest.raises(MissingFileError):
        DistanceField.load(tmp_path / "none.field")
    (tmp_path / "other.field").write_text("solid")
    with pytest.raises(FileError, match="not a distance field"):
        DistanceField.load(tmp_path / "other.field")
    assert "certified" in repr(surface.distance_field(5, geodesic="exact"))
