"""What all tests share."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import canonform
import numpy as np
import pytest
from canonform import Index, Match
from canonform.datasets import Shape

ROOT = Path(__file__).resolve().parents[3]


class Program:
    """The program `canonform`, built from the same tree."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def run(self, *arguments: Any) -> str:
        done = subprocess.run([self.path, *map(os.fspath, map(str, arguments))], capture_output=True, text=True)
        assert done.returncode in (0, 1), done.stderr
        return done.stdout

    def json(self, *arguments: Any) -> Any:
        return json.loads(self.run(*arguments, "--json"))


@pytest.fixture(scope="session")
def program() -> Program:
    target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    path = Path(os.environ.get("CANONFORM_PROGRAM", target / "debug" / "canonform"))
    if not path.exists():
        pytest.fail(f"{path} is missing: run `cargo build -p canonform-cli`, or name the program in CANONFORM_PROGRAM")
    return Program(path)


@contextmanager
def two_workers() -> Iterator[Any]:
    """A client of a cluster of two workers of one thread each."""
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster:
        with distributed.Client(cluster) as client:
            yield client


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    with two_workers() as client:
        yield client


@pytest.fixture
def own_client() -> Iterator[Any]:
    """For tests that kill workers."""
    with two_workers() as client:
        yield client


@pytest.fixture(scope="session")
def cats() -> list[Shape]:
    return canonform.datasets.generate("cat", poses=2, n_vertices=1000)


@pytest.fixture(scope="session")
def cat(cats: list[Shape]) -> Shape:
    return cats[0]


@pytest.fixture(scope="session")
def collection(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of nine meshes of three classes."""
    folder = tmp_path_factory.mktemp("meshes")
    shapes = canonform.datasets.generate(poses=3, n_vertices=1000)
    canonform.datasets.write(shapes, folder)
    return folder


@pytest.fixture(scope="session")
def index(collection: Path, tmp_path_factory: pytest.TempPathFactory) -> Index:
    """The index of these meshes, for tests that do not change it."""
    return Index.build(collection, tmp_path_factory.mktemp("index") / "shapes.canonform")


@pytest.fixture(scope="session")
def cat_match(cats: list[Shape]) -> Match:
    """The maps between two cats."""
    return canonform.match(*(shape.surface() for shape in cats))


def grid(n: int = 9, size: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """A flat square of n x n vertices."""
    x, y = np.meshgrid(np.linspace(0, size, n), np.linspace(0, size, n), indexing="ij")
    vertices = np.column_stack([x.ravel(), y.ravel(), np.zeros(n * n)])
    i = np.arange(n * n).reshape(n, n)
    a, b, c, d = i[:-1, :-1].ravel(), i[1:, :-1].ravel(), i[1:, 1:].ravel(), i[:-1, 1:].ravel()
    return vertices, np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])


@pytest.fixture
def square() -> canonform.Surface:
    return canonform.Surface(*grid())
