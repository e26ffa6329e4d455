"""Maps between surfaces."""

from __future__ import annotations

import pickle

import canonform
import numpy as np
import pytest
from canonform.datasets import Shape
from canonform.errors import OptionError, PointError


def test_both_maps_of_a_symmetric_pair_are_found(cats: list[Shape], cat_match: canonform.Match) -> None:
    a, b = (shape.surface() for shape in cats)
    found = cat_match
    assert [m.kind for m in found.maps] in (["direct", "mirrored"], ["mirrored", "direct"])
    for m in found.maps:
        assert m.vertices.shape == (a.n_vertices,) and m.vertices.dtype == np.int64
        assert 0 <= m.vertices.min() and m.vertices.max() < b.n_vertices
        assert m.vertex_confidence.shape == (a.n_vertices,) and np.median(m.vertex_confidence) > 0.5
        assert 0 < m.distortion < 0.1
        assert m.confidence > 0.9 and m.alternative is None
        c = m.functional(30)
        assert c.shape == (30, 30) and np.linalg.norm(c.T @ c - np.eye(30)) / np.sqrt(30) < 0.4
        np.testing.assert_array_equal(c, m.functional()[:30, :30])
    assert found.best.kind == "direct" or found.best.distortion < found.maps[1].distortion
    assert found._repr_html_().count("<img") == 3 and "direct" in repr(found)


def test_values_labels_and_points_are_carried_both_ways(cats: list[Shape], cat_match: canonform.Match) -> None:
    a, b = (shape.surface() for shape in cats)
    m = next(m for m in cat_match.maps if m.kind == "direct")
    np.testing.assert_allclose(m.transfer(np.full(a.n_vertices, 2.5)), 2.5)
    there = m.transfer(a.vertices)
    back = m.transfer(there, to="a")
    size = np.sqrt(a.area)
    assert np.linalg.norm(back - a.vertices, axis=1).mean() < 0.01 * size
    assert np.linalg.norm(there[m.vertices] - a.vertices, axis=1).mean() < 0.03 * size
    names = np.where(a.vertices[:, 2] > 40, "upper", "lower")
    assert (m.transfer(names)[m.vertices] == names).mean() > 0.95
    assert m.transfer(names).dtype.kind == "U"
    points = m.points()
    assert points.weights.shape == (a.n_vertices, 3) and len(points.at) == a.n_vertices
    np.testing.assert_allclose(points.weights.sum(axis=1), 1)
    np.testing.assert_array_equal(points.corners, b.faces[points.faces])
    np.testing.assert_allclose(points.interpolate(b.vertices), m.transfer(b.vertices, to="a"))
    assert b.path(points.at[0], 5).length > 0
    corners = a.vertices[a.faces]
    gaps = np.linalg.norm(m.transfer(corners) - there[b.faces], axis=2)
    assert gaps.mean() < 0.002 * size and (gaps < 0.05 * size).mean() > 0.99
    again = pickle.loads(pickle.dumps(m))
    np.testing.assert_array_equal(again.transfer(names), m.transfer(names))
    with pytest.raises(OptionError, match="3 rows"):
        m.transfer([1.0, 2.0, 3.0])
    with pytest.raises(OptionError, match="to="):
        m.transfer(names, to="c")  # type: ignore[arg-type]


def test_the_functional_map_takes_coefficients_to_each_other(cats: list[Shape], cat_match: canonform.Match) -> None:
    a, b = (shape.surface() for shape in cats)
    m = cat_match.best
    k = 40
    phi, psi = m.bases(k)
    assert phi.functions.shape == (a.n_vertices, k)
    np.testing.assert_allclose(phi.masses.sum(), 1)
    np.testing.assert_allclose(psi.functions.T @ (psi.masses[:, None] * psi.functions), np.eye(k), atol=1e-6)
    # A smooth function of b, pulled back by the matrix and by the points.
    smooth = psi.functions[:, :10] @ np.linspace(1, 2, 10)
    by_matrix = phi.synthesize(m.functional(k) @ psi.project(smooth))
    by_points = m.transfer(smooth, to="a")
    assert np.linalg.norm(by_matrix - by_points) < 0.1 * np.linalg.norm(by_points)
    with pytest.raises(OptionError, match="n_eigenfunctions=1000"):
        m.bases(1000)


@pytest.mark.slow
def test_landmarks_initial_maps_and_descriptors(cats: list[Shape]) -> None:
    a, b = (shape.surface() for shape in cats)
    few = {"n_eigenfunctions": 30}
    direct, mirrored = sorted(canonform.match(a, b, **few).maps, key=lambda m: m.kind)
    # Where the maps are farthest apart.
    far = int(np.linalg.norm(b.vertices[direct.vertices] - b.vertices[mirrored.vertices], axis=1).argmax())
    found = canonform.match(a, b, landmarks=[(far, mirrored.vertices[far])], **few)
    assert [m.kind for m in found.maps] == ["mirrored"]
    assert found.best.vertices[far] == mirrored.vertices[far]
    bases = a.eigenbasis(60), b.eigenbasis(60)
    functional = mirrored.functional(bases=bases)
    assert canonform.match(a, b, initial=(functional, *bases), **few).best.kind == "mirrored"
    scored = canonform.match(a, b, initial=direct.vertices, refine=False, **few)
    assert [m.kind for m in scored.maps] == ["direct"] and scored.best.confidence >= 0.7
    np.testing.assert_array_equal(scored.best.vertices, direct.vertices)
    with pytest.raises(OptionError, match="initial="):
        canonform.match(a, b, refine=False, **few)
    with pytest.raises(OptionError, match="shape"):
        canonform.match(a, b, initial=(functional[:, :, None], *bases), **few)
    side = np.sin(a.vertices[:, 1] / 10)
    there = direct.transfer(side)
    assert "direct" in [m.kind for m in canonform.match(a, b, descriptors=(side, there), **few).maps]
    with pytest.raises(PointError, match="5000"):
        canonform.match(a, b, landmarks=[(0, 5000)], **few)
    with pytest.raises(OptionError, match="3,1 and 3,900 contradict each other: they give one vertex two partners"):
        canonform.match(a, b, landmarks=[(3, 1), (3, 900)], **few)
    with pytest.raises(OptionError, match=r"\(k, 2\)"):
        canonform.match(a, b, landmarks=[1, 2, 3], **few)
    with pytest.raises(OptionError, match="3 rows"):
        canonform.match(a, b, initial=[1, 2, 3], **few)
    with pytest.raises(OptionError, match="1 and 2"):
        canonform.match(a, b, descriptors=(side, np.c_[there, there]), **few)


@pytest.mark.slow
def test_a_map_has_an_inverse_and_maps_follow_each_other(cats: list[Shape], cat_match: canonform.Match) -> None:
    a, b = (shape.surface() for shape in cats)
    forth = next(m for m in cat_match.maps if m.kind == "direct")
    back = forth.inverse()
    assert back.vertices.shape == back.vertex_confidence.shape == (b.n_vertices,)
    round_trip = forth.then(back)
    assert round_trip.kind == "direct" and round_trip.confidence == pytest.approx(forth.confidence**2)
    size = np.sqrt(a.area)
    assert np.linalg.norm(a.vertices[round_trip.vertices] - a.vertices, axis=1).mean() < 0.03 * size
    again = back.inverse()
    assert np.linalg.norm(b.vertices[again.vertices] - b.vertices[forth.vertices], axis=1).mean() < 0.03 * size
    np.testing.assert_array_equal(again.functional(), forth.functional())
    other = next(m for m in canonform.match(b, a, n_eigenfunctions=60).maps if m.kind == "mirrored")
    chain = forth.then(other)
    assert chain.kind == "mirrored"
    np.testing.assert_array_equal(chain.vertices, other.vertices[forth.vertices])
