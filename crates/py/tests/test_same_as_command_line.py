"""The same numbers as the command line, bit for bit."""

from __future__ import annotations

import json
from pathlib import Path

import canonform
import numpy as np
import pytest
from canonform import FastMarching, Index, Landmark, Nystrom
from canonform.datasets import Shape
from conftest import Program

SECONDS = {"seconds", "load_seconds", "repair_seconds"}


def timeless(record):
    """A record without its times and the names of outputs."""
    if isinstance(record, dict):
        return {key: timeless(value) for key, value in record.items() if key not in SECONDS | {"output", "path"}}
    return [timeless(item) for item in record] if isinstance(record, list) else record


@pytest.fixture(scope="module")
def meshes(tmp_path_factory: pytest.TempPathFactory, cats: list[Shape]) -> list[Path]:
    folder = tmp_path_factory.mktemp("cats")
    return [Path(path) for path in canonform.datasets.write(cats, folder)]


@pytest.mark.parametrize("method", ["fast-marching", "heat"])
def test_distances(program: Program, meshes: list[Path], tmp_path: Path, method: str) -> None:
    out = tmp_path / "rows.npy"
    program.run("geodesic", meshes[0], "--source", "0,17,f3@1:2:1", "--method", method, "-o", out)
    surface = canonform.read(meshes[0])
    rows = np.load(out)
    np.testing.assert_array_equal(surface.distances_many([0, 17, "f3@1:2:1"], geodesic=method), rows)
    np.testing.assert_array_equal(surface.distances(17, geodesic=method), rows[1])
    program.run("geodesic", meshes[0], "--source", "0,17", "--nearest", "--method", method, "-o", out)
    np.testing.assert_array_equal(surface.distances([0, 17], geodesic=method), np.load(out)[0])


def test_paths(program: Program, meshes: list[Path], tmp_path: Path) -> None:
    out = tmp_path / "paths.json"
    program.run("geodesic", meshes[0], "--source", "3", "--path-to", "700,12", "-o", out)
    written = json.loads(out.read_text())["paths"]
    for path, expected in zip(canonform.read(meshes[0]).path(3, [700, 12]), written, strict=True):
        assert path.length == expected["length"]
        np.testing.assert_array_equal(path.points, [point["position"] for point in expected["points"]])
        assert list(map(str, path.at)) == [str(point["at"]) for point in expected["points"]]


@pytest.mark.parametrize(
    ("flags", "arguments"),
    [
        ([], {}),
        (
            ["--regularization", "rpi", "--alpha", "1e-9", "--sampling", "random", "--seed", "4", "--dim", "5"],
            {"method": Nystrom(regularization="rpi", alpha=1e-9, sampling="random"), "seed": 4, "n_components": 5},
        ),
        (["--method", "landmark", "--update", "planar"], {"method": Landmark(), "geodesic": FastMarching(update="planar")}),
    ],
)
def test_forms(program: Program, meshes: list[Path], tmp_path: Path, flags: list[str], arguments: dict) -> None:
    out = tmp_path / "form.npy"
    report = program.json("embed", meshes[0], "-o", out, *flags)
    form = canonform.read(meshes[0]).canonical_form(**arguments)
    np.testing.assert_array_equal(form.points, np.load(out))
    assert timeless(form.report) == timeless(report)


def test_comparisons(program: Program, meshes: list[Path]) -> None:
    report = program.json("compare", *meshes, "-n", "40", "--method", "landmark")
    found = canonform.compare(*map(canonform.read, meshes), n_landmarks=40, method="landmark")
    assert np.max(found.residuals) == report["residual"]["max"]
    for key in ("a", "b", "residual", "threshold", "failed"):
        report.pop(key)
    assert found.report == report


@pytest.mark.slow
def test_indexes(program: Program, index: Index, collection: Path, tmp_path: Path) -> None:
    theirs = tmp_path / "theirs.canonform"
    report = program.json("index", "build", collection, "-o", theirs)
    assert index.build_report is not None
    expected = {key: value for key, value in report.items() if key != "index"}
    assert timeless(index.build_report) == timeless(expected)
    exported = [tmp_path / "ours.jsonl", tmp_path / "theirs.jsonl"]
    index.export(exported[0])
    program.run("index", "export", theirs, "-o", exported[1])
    assert exported[0].read_bytes() == exported[1].read_bytes()

    query = collection / "cat1.off"
    for flags, arguments in [
        (["-k", "4", "--explain"], {"k": 4, "explain": True}),
        (["-k", "3", "--rank", "graph"], {"k": 3, "rank": "graph"}),
    ]:
        answer = timeless(program.json("search", theirs, query, *flags)["queries"][0])
        answer.pop("query")
        assert timeless(index.search(query, **arguments).report) == answer, flags
    assert program.json("search", theirs, "--id", "david2")["queries"][0]["predicted"] == index.search("david2").predicted

    for flags, arguments in [(["--by", "shape-dna", "-k", "3"], {"by": "shape-dna", "k": 3}), (["--rank", "graph"], {"rank": "graph"})]:
        assert program.json("evaluate", theirs, *flags) == index.evaluate(**arguments)
