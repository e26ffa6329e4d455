"""The same numbers as the command line, bit for bit."""

from __future__ import annotations

import json
from pathlib import Path

import canonform
import numpy as np
import pytest
from canonform import FastMarching, Index, KernelPca, Landmark, Nystrom, Smacof, Spectral
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


@pytest.mark.parametrize("method", list(canonform.distance_methods()))
def test_distances(program: Program, meshes: list[Path], tmp_path: Path, method: str) -> None:
    out = tmp_path / "rows.npy"
    program.run("geodesic", meshes[0], "--source", "0,17,f3@1:2:1", "--method", method, "-o", out)
    surface = canonform.read(meshes[0])
    rows = np.load(out)
    np.testing.assert_array_equal(surface.distances_many([0, 17, "f3@1:2:1"], geodesic=method), rows)
    np.testing.assert_array_equal(surface.distances(17, geodesic=method), rows[1])
    program.run("geodesic", meshes[0], "--source", "0,17", "--nearest", "--method", method, "-o", out)
    np.testing.assert_array_equal(surface.distances([0, 17], geodesic=method), np.load(out)[0])


@pytest.mark.parametrize("update", ["virtual-source", "planar"])
def test_variants_of_fast_marching(program: Program, meshes: list[Path], tmp_path: Path, update: str) -> None:
    out = tmp_path / "rows.npy"
    program.run("geodesic", meshes[0], "--source", "5", "--update", update, "--obtuse", "unfold", "-o", out)
    rows = canonform.read(meshes[0]).distances_many([5], geodesic=FastMarching(update=update, obtuse="unfold"))
    np.testing.assert_array_equal(rows, np.load(out))


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
            ["-n", "40", "--rank", "9", "--geodesic", "heat"],
            {"n_landmarks": 40, "method": Nystrom(rank=9), "geodesic": "heat"},
        ),
        (["-n", "auto", "--seed", "2"], {"n_landmarks": "auto", "seed": 2}),
        (["-n", "30", "--method", "smacof", "--iterations", "5"], {"n_landmarks": 30, "method": Smacof(max_iterations=5)}),
        (["--method", "spectral", "-n", "30", "--mu", "inf"], {"method": Spectral(mu=float("inf")), "n_landmarks": 30}),
        (["--method", "kpca", "-n", "30", "--sigma", "median"], {"method": KernelPca(sigma="median"), "n_landmarks": 30}),
        (
            ["--regularization", "rpi", "--alpha", "1e-9", "--sampling", "random", "--seed", "4", "--dim", "5"],
            {"method": Nystrom(regularization="rpi", alpha=1e-9, sampling="random"), "seed": 4, "n_components": 5},
        ),
        (["--first-sample", "8", "--stress", "exact"], {"method": Nystrom(first=8), "stress": "exact"}),
        (["--method", "landmark", "--sampling", "max-variance"], {"method": Landmark(sampling="max-variance")}),
        (["--method", "landmark", "--update", "planar"], {"method": Landmark(), "geodesic": FastMarching(update="planar")}),
    ],
)
def test_forms(program: Program, meshes: list[Path], tmp_path: Path, flags: list[str], arguments: dict) -> None:
    out = tmp_path / "form.npy"
    report = program.json("embed", meshes[0], "-o", out, *flags)
    form = canonform.read(meshes[0]).canonical_form(**arguments)
    np.testing.assert_array_equal(form.points, np.load(out))
    assert timeless(form.report) == timeless(report)


def test_points_and_finer_meshes(program: Program, meshes: list[Path], tmp_path: Path) -> None:
    out = tmp_path / "form.npy"
    report = program.json("embed", meshes[0], "-o", out, "--at", "17,f3@1:2:1,0")
    form = canonform.read(meshes[0]).canonical_form()
    expected = [point["coordinates"] for point in report["points"]]
    np.testing.assert_array_equal(form.place(["17", "f3@1:2:1", 0]), expected)
    np.testing.assert_allclose(form.place(17)[0], form.points[17], atol=1e-9)
    # A mesh is the coarsest of its own levels.
    program.json("embed", meshes[0], "--extend", meshes[0], "-o", out)
    surface = canonform.read(meshes[0])
    np.testing.assert_array_equal(surface.canonical_form().finer(surface).points, np.load(out))


def test_repairs(program: Program, tmp_path: Path, cats: list[Shape]) -> None:
    # Two components: one is dropped, or both are bridged.
    a, b = cats
    vertices = np.concatenate([a.vertices, b.vertices + 1000])
    path = tmp_path / "two.off"
    canonform.datasets.write([Shape("two", "", vertices, np.concatenate([a.faces, b.faces + len(a.vertices)]))], tmp_path)
    for components in ("largest", "bridge"):
        out = tmp_path / "rows.npy"
        source = "0" if components == "bridge" else "1500"
        report = program.json("geodesic", path, "--source", source, "--components", components, "-o", out)
        surface = canonform.read(path, components=components)
        if components == "largest" and report["unreached"] and 1500 in report["unreached"]:
            continue
        # Files have infinite distances where Python has NaN.
        expected = np.where(surface.kept, np.load(out), np.nan)
        np.testing.assert_array_equal(surface.distances_many([int(source)]), expected)
        assert dict(surface.repair_report) == report["repair"]


def test_comparisons(program: Program, meshes: list[Path]) -> None:
    for flags, arguments in [([], {}), (["-n", "40", "--method", "landmark"], {"n_landmarks": 40, "method": "landmark"})]:
        report = program.json("compare", *meshes, *flags)
        a, b = map(canonform.read, meshes)
        found = canonform.compare(a, b, **arguments)
        for key in ("a", "b", "residual", "threshold", "failed"):
            largest = report.pop(key)["max"] if key == "residual" else report.pop(key)
            if key == "residual":
                assert np.max(found.residuals) == largest
        assert found.report == report
        assert found.relation["because"]["same_class"] > 0.9


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


def test_indexes_with_other_forms(program: Program, meshes: list[Path], tmp_path: Path) -> None:
    folder = meshes[0].parent
    flags = ["-n", "40", "--rank", "9", "--update", "planar", "--points", "300", "--size"]
    program.run("index", "build", folder, "-o", tmp_path / "theirs.canonform", *flags)
    options = {"method": Nystrom(rank=9), "geodesic": FastMarching(update="planar")}
    index = Index.build(folder, tmp_path / "ours.canonform", n_landmarks=40, n_points=300, size=True, **options)
    index.export(tmp_path / "ours.jsonl")
    assert program.run("index", "export", tmp_path / "theirs.canonform") == (tmp_path / "ours.jsonl").read_text()


def test_generated_shapes_are_those_of_the_library(collection: Path, cat: Shape) -> None:
    np.testing.assert_array_equal(canonform.read(collection / "cat0.off").faces, cat.faces)
