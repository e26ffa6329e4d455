"""Docstrings in full, in the style of NumPy.

What one docstring says of a parameter holds for all parameters of its name and type that are not described otherwise. Types are those of
the signatures, and sentences and examples get the headings of their sections.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable
from functools import cached_property
from types import FunctionType
from typing import Any

_SECTION = re.compile(r"(Parameters|Returns|Attributes)\n-+\n(.*)", re.S)
_RAISES = re.compile(r"Raises ((?:`\w+`(?:, )?)+) (.*)")
_KEYWORDS = {
    "Unpack[Call]": "progress, timeout, memory, threads\n    How the call runs, see `Call`.",
    "Unpack[Shown]": "progress, threads\n    How the call runs, see `Shown`.",
    "Unpack[Look]": "look\n    Keywords of `Look`.",
}

_known: dict[tuple[str, Any], str] = {}
"""What parameters mean, by their names and types."""


def complete(public: Iterable[Any]) -> None:
    """Completes the docstrings of functions and classes, and of what these classes have."""
    found: list[Any] = []
    for item in dict.fromkeys(public):
        own = vars(item).items() if inspect.isclass(item) else ()
        found += [item, *(getattr(member, "__func__", member) for name, member in own if not name.startswith("_"))]
    found = [item for item in found if isinstance(item, (type, FunctionType, property, cached_property)) and item.__doc__]
    for item in found:
        described = _described(item.__doc__)
        types = inspect.signature(item).parameters if described else {}
        for name, text in described.items():
            _known.setdefault((name, types[name].annotation), text)
    for item in found:
        item.__doc__ = _completed(item, inspect.cleandoc(item.__doc__))


def _described(doc: str) -> dict[str, str]:
    """What a docstring says of parameters."""
    sections = (_SECTION.match(paragraph) for paragraph in inspect.cleandoc(doc).split("\n\n"))
    found: dict[str, str] = {}
    for section in sections:
        if section and section[1] == "Parameters":
            for entry in re.split(r"\n(?=\S)", section[2]):
                names, _, text = entry.partition("\n")
                found |= dict.fromkeys(re.split(r", ", names.partition(" : ")[0]), text)
    return found


def _completed(item: Any, doc: str) -> str:
    body, _, example = doc.partition("\n\n>>> ")
    texts, raises, sections = [], [], {}
    for paragraph in body.split("\n\n"):
        section = _SECTION.match(paragraph)
        if section:
            sections[section[1]] = section[2]
        elif _RAISES.match(paragraph):
            raises += [f"{names.replace('`', '')}\n    {why[0].upper()}{why[1:]}" for names, why in _RAISES.findall(paragraph)]
        else:
            texts.append(paragraph)
    if inspect.isfunction(item):
        sections |= _of_signature(item, _described(doc), sections.get("Returns", ""))
    sections |= {"Raises": "\n".join(raises)} | {"Examples": f">>> {example}" if example else ""}
    order = ("Parameters", "Attributes", "Returns", "Raises", "Examples")
    return "\n\n".join(texts + [f"{name}\n{'-' * len(name)}\n{sections[name]}" for name in order if sections.get(name)])


def _of_signature(function: Callable[..., Any], described: dict[str, str], returns: str) -> dict[str, str]:
    """The sections of parameters and results."""
    signature = inspect.signature(function)
    entries = []
    for name, parameter in signature.parameters.items():
        if parameter.annotation in _KEYWORDS:
            entries.append(_KEYWORDS[parameter.annotation])
        elif name not in ("self", "cls"):
            text = described.get(name) or _known.get((name, parameter.annotation), "")
            entries.append(f"{name} : {parameter.annotation}\n{text}".rstrip())
    result = "" if signature.return_annotation in ("None", inspect.Signature.empty) else returns or signature.return_annotation
    return {"Parameters": "\n".join(entries), "Returns": result}
