"""Types, documentation and examples of the package itself."""

from __future__ import annotations

import ast
import doctest
import inspect
import re
import shutil
import subprocess
import sys
import textwrap
from collections.abc import Callable
from dataclasses import fields
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any, get_args

import canonform
import numpy as np
import pytest
from canonform import _canonform, _methods, _settings
from canonform.datasets import Shape
from conftest import ROOT, grid

SOURCE = ROOT / "crates" / "py" / "python" / "canonform"
MODULES = sorted(path.stem for path in SOURCE.glob("*.py") if path.stem != "__init__")


@pytest.mark.slow
def test_examples_in_docstrings_run(
    cats: list[Shape], cat_match: canonform.Match, index: canonform.Index, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    cat, other = (shape.surface() for shape in cats)
    index = canonform.Index(shutil.copy(index.path, "shapes.canonform"))
    scope = {"canonform": canonform, "np": np, "cat": cat, "other": other, "found": cat_match, "index": index}
    before = canonform.threads()
    for module in [canonform, *(import_module(f"canonform.{name}") for name in MODULES)]:
        failed, _ = doctest.testmod(module, extraglobs=scope, optionflags=doctest.ELLIPSIS)
        assert failed == 0, module
    canonform.set_threads(before)


def test_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "crates" / "py" / "README.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert blocks
    scope: dict[str, object] = {}
    for block in blocks:
        exec(compile(block, "README.md", "exec"), scope)


@pytest.mark.slow
def test_types_hold_and_wrong_names_are_found(tmp_path: Path) -> None:
    """The lines that end in "# wrong" fail, and no others, here or in the package."""
    pytest.importorskip("mypy")
    snippet = tmp_path / "snippet.py"
    snippet.write_text(WRONG_AND_RIGHT)
    command = [sys.executable, "-m", "mypy", "--config-file", ROOT / "crates" / "py" / "pyproject.toml", SOURCE, snippet]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, cwd=ROOT / "crates" / "py")
    found = {(Path(path).name, int(number)) for path, number in re.findall(r"^(.*?):(\d+): error", done.stdout, re.M)}
    expected = {("snippet.py", i + 1) for i, line in enumerate(WRONG_AND_RIGHT.splitlines()) if line.endswith("# wrong")}
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
    assert list(get_args(_settings.MeshFormat)) == _canonform.MESH_FORMATS
    shape = canonform.datasets.generate("cat", poses=1, n_vertices=1000)[0]
    index = canonform.Index.build([shape], tmp_path / "i.canonform")
    square = canonform.Surface(*grid())
    wrong: Any = "?"
    for literal, call in [
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
    assert "no option color" in _fault(color=3)
    others = {"self", "progress", "a", "b", "names", "meshes", "path", "labels", "prune", "shard", "call", "keep_meshes"}
    for call in (canonform.Surface.canonical_form, canonform.compare, canonform.Index.build):
        keywords = set(inspect.signature(call).parameters) - others
        assert {"n_landmarks", "method", "geodesic", "seed"} <= keywords
        assert not [keyword for keyword in keywords if "no option" in _fault(**{keyword: 3})]


def _public() -> dict[str, Any]:
    """Everything public by its name in the documentation."""
    found = {name: getattr(canonform, name) for name in canonform.__all__ if name != "__version__"}
    for module in (canonform.datasets, canonform.errors, canonform.distributed):
        found |= {f"{module.__name__}.{name}": getattr(module, name) for name in module.__all__}
    return found


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


PROPERTIES = (property, cached_property)


def _functions() -> dict[str, Callable[..., Any]]:
    """All public functions, and the methods that classes have of their own."""
    found = {}
    for name, public in _public().items():
        own = {f"{name}.{member}": value for member, value in vars(public).items()} if inspect.isclass(public) else {name: public}
        found |= {key: getattr(value, "__func__", value) for key, value in own.items() if not key.split(".")[-1].startswith("_")}
    return {name: value for name, value in found.items() if inspect.isfunction(value)}


def test_everything_public_is_documented() -> None:
    for name, found in _public().items():
        doc = found.__doc__ or ""
        assert len(doc) > 20 and not doc.startswith(f"{name}("), name
        if inspect.isclass(found) and not issubclass(found, Exception):
            for member in _attributes(found):
                value = inspect.getattr_static(found, member, None)
                assert value.__doc__ if isinstance(value, PROPERTIES) else _tells(doc, member), f"{name}.{member}"


def _tells(doc: str, name: str) -> bool:
    """Whether a docstring has an entry for a parameter or attribute, or speaks of it."""
    return re.search(rf"^ +(\w+, )*{name}(, \w+)*: |`{name}`", doc, re.M) is not None


def test_parameters_are_described() -> None:
    """Each in the docstring of its function, or in one that this names."""
    functions = {name: function for name, function in _functions().items() if not name.startswith("VertexValues.")}
    known = _public() | functions
    for name, function in functions.items():
        doc, own = function.__doc__ or "", name.rpartition(".")[0]
        named = re.findall(r"`([\w.]+)`", doc)
        docs = [doc, *(known[key].__doc__ or "" for other in named for key in (other, f"{own}.{other}") if key in known)]
        for parameter in inspect.signature(function).parameters.values():
            if parameter.name not in ("self", "cls") and not str(parameter.annotation).startswith("Unpack"):
                assert any(_tells(doc, parameter.name) for doc in docs), f"{name}: {parameter.name}"
        assert own or not inspect.signature(function).parameters or ">>> " in doc, name


QUICK = {
    name
    for names in (
        "Alignment.apply DistanceField.load DistanceField.save DistanceField.pair Eigenbasis.first Eigenbasis.hks Eigenbasis.project",
        "Eigenbasis.synthesize Eigenbasis.wks Form.picture Form.write Index.info Index.remove Index.shapes Index.to_pandas Index.vector",
        "Index.vectors MappedPoints.interpolate Match.picture Match.pictures Scores.to_pandas SearchResults.to_pandas Surface.divergence",
        "Surface.gradient Surface.picture Surface.view Surface.write SurfaceMap.functional",
        "SurfaceMap.then SurfaceView.write VertexValues.argmax VertexValues.argmin VertexValues.max VertexValues.min",
        "canonform.datasets.Shape.surface canonform.datasets.families canonform.datasets.write",
        "distance_methods embedding_methods figure set_threads signature_kinds",
    )
    for name in names.split()
}
"""What computes nothing, or takes less than a second on 100,000 vertices."""


def test_all_other_calls_take_limits_and_pass_them_on() -> None:
    for name, function in _functions().items():
        parameters = inspect.signature(function).parameters
        of_call = next((p.name for p in parameters.values() if p.annotation == "Unpack[Call]"), None)
        assert (of_call is not None or {"timeout", "memory"} <= set(parameters)) == (name not in QUICK), name
        body = inspect.getsource(function).partition('"""')[2].partition('"""')[2]
        assert of_call is None or re.search(r"\*\*call\b|running\(call\)|, call, ", body), name


def test_the_version_is_that_of_the_workspace() -> None:
    assert f'version = "{canonform.__version__}"' in (ROOT / "Cargo.toml").read_text()
