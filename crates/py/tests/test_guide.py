"""The snippets of the user guide run, those of a chapter one after the other."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT

GUIDE = ROOT / "docs" / "guide"
SNIPPET = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def chapters() -> list[Path]:
    return [page for page in sorted(GUIDE.rglob("*.md")) if SNIPPET.search(page.read_text(encoding="utf-8"))]


def test_the_guide_has_snippets() -> None:
    assert [page.name for page in chapters()] == ["clusters.md", "correspondence.md", "points.md", "python.md"]


# Dask and Lance warn of their own affairs.
@pytest.mark.filterwarnings("default")
@pytest.mark.parametrize(
    "page",
    # The laws of clusters are in test_distributed.py and test_search_in_shards.py.
    [pytest.param(page, marks=[pytest.mark.slow] if page.stem == "clusters" else []) for page in chapters()],
    ids=lambda page: page.stem,
)
def test_a_chapter_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for package in {"clusters": ["distributed", "lance"], "python": ["sklearn", "pandas"]}.get(page.stem, []):
        pytest.importorskip(package)
    monkeypatch.chdir(tmp_path)
    text = page.read_text(encoding="utf-8")
    names: dict[str, Any] = {}
    for snippet in SNIPPET.finditer(text):
        # Blank lines in front, so that a traceback names the line of the page.
        line = text.count("\n", 0, snippet.start(1))
        exec(compile("\n" * line + snippet.group(1), str(page), "exec"), names)
