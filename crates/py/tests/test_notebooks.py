"""The notebooks run from start to end, and hold what they show.

`make notebooks` (or CANONFORM_WRITE_DOCS=1) stores their outputs again.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import pytest
from conftest import ROOT

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")

NOTEBOOKS = sorted((ROOT / "crates" / "py" / "notebooks").glob("*.ipynb"))
NUMBER = re.compile(r"-?\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?")
# Numbers may differ by this share between processors, whose vector units round in another order: far above what that
# changes, and below what a reader would call another result. Cells tagged "varies" show times.
TOLERANCE = 0.02
MOST_BYTES = 3_000_000

# The packages of Jupyter warn of their own affairs.
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("default")]


def code_of(notebook: Any) -> list[Any]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def shown(cell: Any) -> list[tuple[str, ...]]:
    """The kinds of what a cell shows, in order."""
    return [(output.name,) if output.output_type == "stream" else tuple(sorted(output.data)) for output in cell.outputs]


def text(cell: Any) -> str:
    """What a cell says. Where things are and what they are called differ from run to run."""
    parts = [output.text if output.output_type == "stream" else output.data.get("text/plain", "") for output in cell.outputs]
    return re.sub(r"0x[0-9a-f]+|(?<![\w.])/[\w./-]+", "", "\n".join(parts))


def assert_alike(stored: Any, found: Any) -> None:
    assert shown(stored) == shown(found), found.source
    before, after = text(stored), text(found)
    assert NUMBER.sub("#", before).split() == NUMBER.sub("#", after).split(), found.source
    if "varies" not in found.metadata.get("tags", []):
        pairs = zip(NUMBER.findall(before), NUMBER.findall(after), strict=True)
        for a, b in ((float(a.replace(",", "")), float(b.replace(",", ""))) for a, b in pairs):
            # The last digits of small numbers are noise.
            assert a == pytest.approx(b, rel=TOLERANCE, abs=0.002), found.source


def clean(notebook: Any) -> None:
    """Removes what changes with every run."""
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        if "picture" in cell.metadata.get("tags", []):
            cell.outputs = []
    notebook.metadata = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }


def test_there_are_notebooks_and_they_are_small() -> None:
    assert len(NOTEBOOKS) == 8
    assert sum(path.stat().st_size for path in NOTEBOOKS) < MOST_BYTES
    for path in NOTEBOOKS:
        # Nothing of the machine that ran them.
        assert not re.search(r"[\s\"'>]/(tmp|home|root|work|Users)/", path.read_text()), path


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_holds_what_it_shows(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Nothing of the user's own settings.
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    stored, notebook = (nbformat.read(path, as_version=4) for _ in range(2))
    nbclient.NotebookClient(notebook, timeout=600, coalesce_streams=True, resources={"metadata": {"path": tmp_path}}).execute()
    outputs = [output for cell in code_of(notebook) for output in cell.outputs]
    assert outputs and not [output for output in outputs if output.output_type == "stream" and output.name == "stderr"]
    if "CANONFORM_WRITE_DOCS" in os.environ:
        clean(notebook)
        nbformat.write(notebook, path)
    else:
        clean(notebook)
        for before, after in zip(code_of(stored), code_of(notebook), strict=True):
            assert_alike(before, after)
