"""The examples that search an export of an index in other stores."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import pytest
from canonform import Index
from conftest import ROOT, Program

# The stores warn of their own affairs.
pytestmark = pytest.mark.filterwarnings("default")


def test_duckdb_and_lancedb_find_the_neighbors_that_the_program_finds(
    program: Program, index: Index, monkeypatch: pytest.MonkeyPatch
) -> None:
    for package in ("duckdb", "lancedb", "pyarrow"):
        pytest.importorskip(package)
    examples = ROOT / "examples" / "stores"
    monkeypatch.syspath_prepend(str(examples))
    monkeypatch.setattr(sys, "argv", ["check.py"])
    check = runpy.run_path(str(examples / "check.py"))["check"]
    assert check(index.path, str(program.path)) == len(index) == 9
