"""Alignment and comparison."""

from __future__ import annotations

import canonform
import numpy as np
import pytest
from canonform import Surface
from canonform.datasets import Shape


def test_poses_are_one_shape_and_families_are_not(cats: list[Shape]) -> None:
    a, b = (shape.surface() for shape in cats)
    found = canonform.compare(a, b)
    assert found.relation["because"]["same_class"] > 0.9 and found.residuals.shape == (1000,)
    david = canonform.datasets.generate("david", poses=1, n_vertices=1000)[0].surface()
    other = canonform.compare(a, david)
    assert other.match == "different" and other.distance > found.distance
    assert "cat0" in str(found) and "'different'" in repr(other)


def test_a_copy_in_other_units_is_recognized(cat: Shape) -> None:
    inches = Surface(cat.vertices / 25.4, cat.faces)
    found = canonform.compare(inches, cat.surface(), names=("inch.stl", "mm.stl"))
    assert found.match == "scaled" and found.scale == pytest.approx(25.4)
    assert str(found).startswith("mm.stl is inch.stl scaled by 25.4 (inches to millimetres)")


def test_alignment_takes_one_form_onto_the_other(cats: list[Shape]) -> None:
    forms = [shape.surface().canonical_form(n_landmarks=60) for shape in cats]
    found = canonform.align(*forms)
    np.testing.assert_allclose(found.rotation @ found.rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(found.rotation) == pytest.approx(-1 if found.reflected else 1)
    moved = found.apply(forms[0].points)
    nearest = np.linalg.norm(moved[:, None] - forms[1].points[None], axis=2).min(axis=1)
    spread = np.linalg.norm(forms[1].points, axis=1).mean()
    assert nearest.mean() < 0.1 * spread
    same = canonform.align(forms[0], forms[0])
    assert same.rms < 1e-9 * spread and not same.reflected
    assert not canonform.align(*forms, reflections=False).reflected


def test_sides_are_described_once(cats: list[Shape]) -> None:
    a, b = (Surface(shape.vertices, shape.faces) for shape in cats)
    stages: list[str] = []
    first = canonform.compare(a, b, progress=lambda stage, *_: stages.append(stage)).report
    again = canonform.compare(a, b, progress=lambda *_: pytest.fail("nothing is measured again")).report
    assert again == first
