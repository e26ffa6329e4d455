"""Types, documentation and examples of the package itself."""

from __future__ import annotations

import ast
import doctest
import inspect
import pydoc
import re
import subprocess
import sys
import textwrap
from collections.abc import Callable
from dataclasses import fields
from functools import cached_property
from pathlib import Path
from typing import Any, get_args

import canonform
import pytest
from canonform import _canonform, _methods, _settings
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
    done = _mypy(SOURCE)
    assert done.returncode == 0, done.stdout + done.stderr


def _mypy(*arguments: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "mypy", "--config-file", ROOT / "crates" / "py" / "pyproject.toml", *arguments]
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, cwd=ROOT / "crates" / "py")


def test_mypy_finds_wrong_names(tmp_path: Path) -> None:
    """The lines that end in "# wrong" fail, and no others."""
    pytest.importorskip("mypy")
    snippet = tmp_path / "snippet.py"
    snippet.write_text(WRONG_AND_RIGHT)
    done = _mypy("--cache-dir", tmp_path / "cache", snippet)
    found = {int(number) for number in re.findall(r"^.*snippet\.py:(\d+): error", done.stdout, re.M)}
    expected = {i + 1 for i, line in enumerate(WRONG_AND_RIGHT.splitlines()) if line.endswith("# wrong")}
    assert found == expected, done.stdout + done.stderr


WRONG_AND_RIGHT = """
import canonform
from canonform import FastMarching, KernelPca, NystromMDS, Nystrom, Smacof, Spectral

shape = canonform.datasets.generate("person", poses=1)[0]
canonform.datasets.generate("parson")  # wrong
canonform.datasets.write([shape], "folder", format="stl")
canonform.datasets.write([shape], "folder", format="step")  # wrong
cat = canonform.read("cat.off", components="bridge", weld=0.1)
canonform.read("cat.off", components="all")  # wrong
cat.distances(0, geodesic="exact")
cat.distances(0, geodesic="fmm")  # wrong
cat.distances(0, geodesic=FastMarching(update="planar", obtuse="unfold"))
cat.distances(0, geodesic=FastMarching(update="plane"))  # wrong
cat.path(0, 5, geodesic=Nystrom())  # wrong
cat.canonical_form(200, method="smacof", stress="skip")
cat.canonical_form("auto", method=Smacof(tolerance=1e-5, sampling="random"))
cat.canonical_form("many")  # wrong
cat.canonical_form(method="fmm")  # wrong
cat.canonical_form(method=FastMarching())  # wrong
cat.canonical_form(method=Nystrom(regularization="svd"))  # wrong
cat.canonical_form(method=Nystrom(sigma="mean"))  # wrong
cat.canonical_form(method=KernelPca(sigma="mode"))  # wrong
cat.canonical_form(method=Spectral(mu="inf"))  # wrong
cat.canonical_form(stress="none")  # wrong
cat.canonical_form(rank=30)  # wrong
cat.signature("shape-dna")
cat.signature("shapedna")  # wrong
cat.laplacian(kind="cotangents")  # wrong
cat.mass(kind="lumped")  # wrong
canonform.match(cat, cat, geodesic="fmm")  # wrong
canonform.match(cat, cat).best.transfer([1.0], to="c")  # wrong
index = canonform.Index.build("meshes", "i.canonform", method="landmark")
canonform.Index.build("meshes", "i.canonform", method="pca")  # wrong
index.search(cat, rank="graph")
index.search(cat, rank="best")  # wrong
index.evaluate(by="shape-dna")
index.evaluate(by="moment")  # wrong
index.evaluate(by=index.distances(kind="combined"))
cat.distances(0, timeout=3, memory="2G", threads=2, progress=True)
cat.distances(0, time=3)  # wrong
cat.picture(up="y", view=(30, 12), bar="mm")
cat.picture(up="w")  # wrong
index.distances(kind="forms")  # wrong
index.duplicates(kinds=["scaled"])
index.duplicates(kinds=["equal"])  # wrong
"""


def _possible(call: Callable[[], object]) -> set[str]:
    """What an error says is possible."""
    with pytest.raises(canonform.errors.CanonformError) as raised:
        call()
    said = re.split(r"use |one of ", str(raised.value))[-1]
    return set(re.findall(r'["`]([^"`?]+)["`]', said))


def test_literals_are_what_rust_reports(tmp_path: Path) -> None:
    for keyword, literal in {
        "method": _settings.EmbeddingName,
        "geodesic": _settings.DistanceName,
        "update": _settings.Update,
        "obtuse": _settings.Obtuse,
        "sampling": _settings.Sampling,
        "regularization": _settings.Regularization,
        "stress": _settings.StressChoice,
        "components": _settings.Components,
    }.items():
        assert _possible(lambda keyword=keyword: _canonform.check_options({keyword: "?"})) == set(get_args(literal)), keyword
    assert list(get_args(_settings.SignatureKind)) == ["fused", *canonform.signature_kinds()]
    assert list(get_args(_settings.Family)) == list(canonform.datasets.families())
    assert list(get_args(_settings.MeshFormat)) == _canonform.mesh_formats()
    shape = canonform.datasets.generate("cat", poses=1, n_vertices=1000)[0]
    index = canonform.Index.build([shape], tmp_path / "i.canonform")
    square = canonform.Surface(*grid())
    wrong: Any = "?"
    for literal, call in [
        (_settings.LaplacianKind, lambda: square.laplacian(kind=wrong)),
        (_settings.Ranking, lambda: index.search(square, rank=wrong)),
        (_settings.IndexDistance, lambda: index.distances(kind=wrong)),
        (_settings.RelationKind, lambda: index.duplicates(kinds=[wrong])),
        (_settings.SignatureKind, lambda: square.signature(wrong)),
    ]:
        assert _possible(call) == set(get_args(literal)), literal


def _fault(**settings: Any) -> str:
    """What is wrong with options, if anything is."""
    try:
        _canonform.check_options(settings)
    except canonform.errors.OptionError as fault:
        return str(fault)
    return ""


def test_methods_have_the_options_that_rust_uses() -> None:
    kinds = [getattr(canonform, name) for name in canonform.__all__ if isinstance(getattr(canonform, name), type)]
    methods = {kind._name: kind for kind in kinds if issubclass(kind, _methods.Options)}
    defaults = {field.name: field.default for kind in methods.values() for field in fields(kind)}
    values = defaults | {"rank": 5, "first": 7, "alpha": "paper"}
    for keyword, names in {"method": _settings.EmbeddingName, "geodesic": _settings.DistanceName}.items():
        options = {field.name for kind in methods.values() if kind._of == keyword for field in fields(kind)}
        for name in get_args(names):
            beside = {option: {"regularization": "rpi"} if option == "alpha" else {} for option in options}
            used = {option for option in options if not _fault(**{keyword: name, option: values[option]}, **beside[option])}
            assert used == {field.name for field in fields(methods[name])} if name in methods else not used, name
    # What is stated as a default is one.
    for kind in methods.values():
        assert _canonform.check_options(kind().settings()) == _canonform.check_options({kind._of: kind._name}), kind


def test_keywords_are_the_options_of_the_library() -> None:
    assert "no option colour" in _fault(colour=3)
    others = {"self", "reuse", "progress", "a", "b", "names", "meshes", "path", "labels", "prune", "shard", "call", "keep_meshes"}
    for call in (canonform.Surface.canonical_form, canonform.compare, canonform.Index.build):
        keywords = set(inspect.signature(call).parameters) - others
        assert {"n_landmarks", "method", "geodesic", "seed"} <= keywords
        assert not [keyword for keyword in keywords if "no option" in _fault(**{keyword: 3})]


def test_stubs_name_what_the_module_has() -> None:
    stub = ast.parse((SOURCE / "_canonform.pyi").read_text())
    public = {name for name in dir(_canonform) if not name.startswith("_")}
    stated = {node.name for node in stub.body if isinstance(node, (ast.FunctionDef, ast.ClassDef))}
    assert stated == public
    for node in stub.body:
        if isinstance(node, ast.ClassDef):
            methods = {item.name for item in node.body if isinstance(item, ast.FunctionDef)} - {"__new__"}
            assert methods == {name for name in vars(getattr(_canonform, node.name)) if not name.startswith("_")}, node.name


def _public() -> dict[str, Any]:
    """Everything public by its name in the documentation."""
    found = {name: getattr(canonform, name) for name in canonform.__all__ if name != "__version__"}
    for module in (canonform.datasets, canonform.errors, canonform.distributed):
        found |= {f"{module.__name__}.{name}": getattr(module, name) for name in module.__all__}
    return found


def test_everything_public_is_documented() -> None:
    for name, found in _public().items():
        assert inspect.getdoc(found), name
        if inspect.isclass(found) and found.__module__.startswith("canonform"):
            own = [member for kind in found.__mro__ if kind.__module__.startswith("canonform") for member in vars(kind)]
            members = {member for member in own if not member.startswith("_")}
            # Fields of data classes are in the documentation of the class.
            stated = set(re.findall(r"\w+", found.__doc__ or ""))
            for member in members - (stated & _attributes(found)):
                value = inspect.getattr_static(found, member)
                documented = getattr(value, "__func__", value)
                assert inspect.getdoc(documented), f"{name}.{member}"


def _attributes(found: type) -> set[str]:
    """The attributes that a class declares, or stores in its methods."""
    names: set[str] = set()
    for kind in found.__mro__:
        if not kind.__module__.startswith("canonform"):
            continue
        source = ast.parse(textwrap.dedent(inspect.getsource(kind))).body[0]
        assert isinstance(source, ast.ClassDef)
        names |= {n.target.id for n in source.body if isinstance(n, ast.AnnAssign) and isinstance(n.target, ast.Name)}
        stored = [n for n in ast.walk(source) if isinstance(n, ast.Attribute) and isinstance(n.ctx, ast.Store)]
        names |= {n.attr for n in stored if isinstance(n.value, ast.Name) and n.value.id == "self"}
    return {name for name in names if not name.startswith("_")}


def test_help_names_every_attribute() -> None:
    for name, found in _public().items():
        if inspect.isclass(found):
            properties = {member for member in dir(found) if isinstance(inspect.getattr_static(found, member), PROPERTIES)}
            for attribute in _attributes(found) - properties:
                section = (found.__doc__ or "").partition("Attributes\n")[2] + (found.__doc__ or "").partition("Parameters\n")[2]
                assert re.search(rf"^ *(\w+, )*{attribute}\b", section, re.M), f"{name}.{attribute}"
            for attribute in properties:
                if not attribute.startswith("_"):
                    assert attribute in pydoc.render_doc(found, renderer=pydoc.plaintext), f"{name}.{attribute}"


PROPERTIES = (property, cached_property)


def test_the_version_is_that_of_the_workspace() -> None:
    assert f'version = "{canonform.__version__}"' in (ROOT / "Cargo.toml").read_text()
