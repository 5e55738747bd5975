"""Import paths: the text "module:name", by which another process imports a class or a function."""
from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any, Optional

from ._error import NotFoundError


def _main_stem() -> str:
    """The name under which the main program could be imported; "" in a notebook."""
    file = Path(getattr(sys.modules.get("__main__"), "__file__", None) or "")
    return file.stem if file.suffix == ".py" else ""


def path_of(thing: Any) -> Optional[str]:
    """The import path of a class or function; None where it has none, as a lambda."""
    module, name = getattr(thing, "__module__", None), getattr(thing, "__qualname__", None)
    if not module or not name or "<" in name:
        return None
    try:
        if _within(sys.modules[module], name) is not thing:
            return None
    except (KeyError, AttributeError):
        return None
    return f"{(_main_stem() or module) if module == '__main__' else module}:{name}"


def thing_at(path: str, what: str) -> Any:
    """Imports a path. A NotFoundError names the module; what: the subject of its text."""
    module, _, name = path.partition(":")
    try:
        found = sys.modules["__main__"] if module in ("__main__", _main_stem()) else importlib.import_module(module)
        return _within(found, name)
    except AttributeError:
        raise NotFoundError(f"{what} is {name} of module {module}, which has no such name") from None
    except Exception as error:
        raise NotFoundError(f"{what} is {name} of module {module}, which cannot be imported here ({type(error).__name__}: "
                            f"{error}): put its folder on sys.path or PYTHONPATH") from error


def _within(found: Any, name: str) -> Any:
    for part in name.split("."):
        found = getattr(found, part)
    return found
