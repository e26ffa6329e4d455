"""The Rust half of the package. Use `canonform` instead. What it takes and returns is in `crates/py/src`."""

from typing import Any

__version__: str

def threads() -> int:
    """The number of worker threads."""

def __getattr__(name: str) -> Any: ...
