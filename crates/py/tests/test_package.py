"""Types, documentation and examples of the package itself."""

from __future__ import annotations

import ast
import doctest
import importlib.util
import inspect
import re
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import get_args

import canonform
import pytest
from canonform import _canonform, _settings
from conftest import ROOT, grid

SOURCE = ROOT / "crates" / "py" / "python" / "canonform"
MODULES = sorted(path.stem for path in SOURCE.glob("*.py") if path.stem != "__init__")


def test_examples_in_docstrings_run() -> None:
    for module in [canonform, *(sys.modules[f"canonform.{name}"] for name in MODULES if f"canonform.{name}" in sys.modules)]:
        failed, _ = doctest.testmod(module)
        assert failed == 0, module


def test_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "crates" / "py" / "README.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert blocks
    scope: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "README.md", "exec"), scope)


def test_types_hold() -> None:
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--config-file", ROOT / "crates" / "py" / "pyproject.toml", SOURCE]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT / "crates" / "py")
    assert done.returncode == 0, done.stdout + done.stderr


def test_types_name_what_is_possible() -> None:
    square = canonform.Surface(*grid())
    assert get_args(_settings.DistanceMethod) == tuple(canonform.distance_methods())
    assert get_args(_settings.EmbeddingMethod) == tuple(canonform.embedding_methods())
    others = {
        "update": _settings.Update,
        "obtuse": _settings.Obtuse,
        "sampling": _settings.Sampling,
        "regularization": _settings.Regularization,
        "stress": _settings.Stress,
    }
    for option, named in others.items():
        with pytest.raises(canonform.errors.OptionError) as raised:
            square.canonical_form(**{option: "?"})
        assert set(re.findall('"([^"?]+)"', str(raised.value).split("use ")[1])) == set(get_args(named)), option


def test_stubs_name_what_the_module_has() -> None:
    stub = ast.parse((SOURCE / "_canonform.pyi").read_text())
    public = {name for name in dir(_canonform) if not name.startswith("_")}
    stated = {node.name for node in stub.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    assert stated == public
    for node in stub.body:
        if isinstance(node, ast.ClassDef):
            methods = {item.name for item in node.body if isinstance(item, ast.FunctionDef)} - {"__new__"}
            assert methods == {name for name in vars(getattr(_canonform, node.name)) if not name.startswith("_")}, node.name


def test_everything_public_is_documented() -> None:
    for name in canonform.__all__:
        if name in ("NystromMDS", "distributed") and importlib.util.find_spec("sklearn") is None:
            continue
        found = getattr(canonform, name)
        if name == "__version__":
            continue
        assert inspect.getdoc(found), name
        if inspect.isclass(found):
            for member, value in vars(found).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, (property, classmethod))):
                    assert inspect.getdoc(getattr(found, member)), f"{name}.{member}"


def test_every_attribute_is_documented() -> None:
    classes = [getattr(canonform, name) for name in canonform.__all__ if inspect.isclass(getattr(canonform, name))]
    for found in [*classes, canonform.datasets.Shape]:
        source = ast.parse(textwrap.dedent(inspect.getsource(found))).body[0]
        assert isinstance(source, ast.ClassDef)
        fields = [n.target.id for n in source.body if isinstance(n, ast.AnnAssign) and isinstance(n.target, ast.Name)]
        stored = [n for n in ast.walk(source) if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store)]
        stores = [n.attr for n in stored if isinstance(n.value, ast.Name) and n.value.id == "self"]
        words = set(re.findall(r"\w+", inspect.getdoc(found) or ""))
        missing = {name for name in fields + stores if not name.startswith("_") and not name.endswith("_")} - words
        assert not missing, (found, missing)


def test_the_version_is_that_of_the_workspace() -> None:
    assert f'version = "{canonform.__version__}"' in (ROOT / "Cargo.toml").read_text()
