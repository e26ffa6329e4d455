"""Maps between surfaces."""

from __future__ import annotations

import canonform
import numpy as np
from canonform.datasets import Shape


def test_both_maps_of_a_symmetric_pair_are_found(cats: list[Shape]) -> None:
    a, b = (shape.surface() for shape in cats)
    found = canonform.match(a, b)
    assert [m.kind for m in found.maps] in (["direct", "mirrored"], ["mirrored", "direct"])
    for m in found.maps:
        assert m.vertices.shape == (a.n_vertices,) and m.vertices.dtype == np.int64
        assert 0 <= m.vertices.min() and m.vertices.max() < b.n_vertices
        assert 0 < m.distortion < 0.1
        assert m.confidence > 0.9 and m.alternative is None
        c = m.functional(30)
        assert c.shape == (30, 30) and np.linalg.norm(c.T @ c - np.eye(30)) / np.sqrt(30) < 0.4
        np.testing.assert_array_equal(c, m.functional()[:30, :30])
    assert found.best.kind == "direct" or found.best.distortion < found.maps[1].distortion
    assert found._repr_html_().count("<img") == 3 and "direct" in repr(found)


def test_values_are_carried_and_a_surface_matches_itself(cat: Shape) -> None:
    surface = cat.surface()
    maps = {m.kind: m for m in canonform.match(surface, surface).maps}
    np.testing.assert_array_equal(maps["direct"].vertices, np.arange(surface.n_vertices))
    np.testing.assert_array_equal(maps["direct"].carry(surface.vertices), surface.vertices)
