"""What notebooks show."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

_BOX = "display:inline-block;font-family:sans-serif;font-size:13px;border:1px solid #8884;border-radius:6px;padding:10px 14px"
_CELL = "text-align:left;padding:2px 12px 2px 0;background:none;vertical-align:top"


def image(png: bytes, side: int = 220, title: str = "") -> str:
    """A picture within the page, at half its size so that it is sharp."""
    data = base64.b64encode(png).decode("ascii")
    return f'<img src="data:image/png;base64,{data}" width="{side}" height="{side}" alt="{escape(title)}" title="{escape(title)}">'


def card(title: str, rows: Iterable[tuple[str, str]], pictures: Sequence[str] = ()) -> str:
    """A title, pictures side by side, and facts below them."""
    cells = "".join(
        f'<tr style="background:none"><td style="{_CELL};opacity:.65;white-space:nowrap">{escape(name)}</td>'
        f'<td style="{_CELL};white-space:pre-line">{escape(value)}</td></tr>'
        for name, value in rows
    )
    shown = f'<div style="display:flex;gap:12px;flex-wrap:wrap;align-items:flex-end">{"".join(pictures)}</div>' if pictures else ""
    return f'<div style="{_BOX}"><b>{escape(title)}</b>{shown}<table style="border:none;margin:6px 0 0;font-size:13px">{cells}</table></div>'


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table of text."""
    top = "".join(f'<th style="{_CELL}">{escape(name)}</th>' for name in head)
    body = "".join(
        "<tr>" + "".join(f'<td style="{_CELL}">{escape(value)}</td>' for value in row) + "</tr>" for row in rows
    )
    return f'<table style="border:none;margin:6px 0 0;font-size:13px"><tr>{top}</tr>{body}</table>'


def box(title: str, content: str) -> str:
    """A title and ready-made content."""
    return f'<div style="{_BOX}"><b>{escape(title)}</b>{content}</div>'


def bars(values: NDArray[np.float64], title: str, width: int = 200, height: int = 120) -> str:
    """A small bar chart; negative values go down."""
    if not len(values):
        return ""
    high, low = max(float(values.max()), 0.0), min(float(values.min()), 0.0)
    span = (high - low) or 1.0
    step, top = width / len(values), 16
    zero = top + (height - top) * high / span
    marks = []
    for i, value in enumerate(values):
        length = (height - top) * abs(float(value)) / span
        y = zero - length if value >= 0 else zero
        color = "#2f6f8f" if value >= 0 else "#b5533c"
        marks.append(
            f'<rect x="{i * step + 1:.1f}" y="{y:.1f}" width="{step - 2:.1f}" height="{max(length, 0.5):.1f}" fill="{color}">'
            f"<title>{value:.6g}</title></rect>"
        )
    label = f'<text x="0" y="11" font-size="11" fill="currentColor" opacity=".65">{escape(title)}</text>'
    return f'<svg width="{width}" height="{height}" viewBox="0 0 {width} {height}">{label}{"".join(marks)}</svg>'
