"""Packages of others that some functions need and this one does not."""
from __future__ import annotations

import importlib
from typing import Any

from ._error import UnsupportedError


def optional(name: str, what: str, instead: str = "") -> Any:
    """The module; where it is not installed, an error that says what needs it, how it is installed and what does without it."""
    try:
        return importlib.import_module(name)
    except ImportError:
        package = name.split(".")[0]
        raise UnsupportedError(f"{what} needs the Python package {package}: pip install {package}{instead}") from None
