"""What a failed call raises: redman.Error, by its code also the built-in exception that a caller would expect."""
from __future__ import annotations

from . import _abi


class Error(Exception):
    """A failed call: str(error) is the library's line of text, error.code the rdm_result."""

    code: int = _abi.RDM_INTERNAL


class ArgumentError(Error, ValueError):
    """Not finite, malformed, of the wrong shape."""

    code = _abi.RDM_ARGUMENT


class RangeError(Error, ValueError, IndexError):
    """Outside the documented bounds, or an index past the end."""

    code = _abi.RDM_RANGE


class StateError(Error, RuntimeError):
    """Calls in the wrong order."""

    code = _abi.RDM_STATE


class AllocationError(Error, MemoryError):
    """The allocator refused."""

    code = _abi.RDM_MEMORY


class FileError(Error, OSError):
    """The file system refused."""

    code = _abi.RDM_IO


class FormatError(Error, ValueError):
    """Truncated, corrupt or foreign bytes."""

    code = _abi.RDM_FORMAT


class VersionError(Error, ValueError):
    """A newer file or library, or a policy of another task or options."""

    code = _abi.RDM_VERSION_MISMATCH


class UnsupportedError(Error, NotImplementedError):
    """Left out of this build, or not defined for this combination."""

    code = _abi.RDM_UNSUPPORTED


class PhysicsError(Error, ArithmeticError):
    """The physics engine gave up where no world could be flagged."""

    code = _abi.RDM_PHYSICS


class NotFoundError(Error, LookupError):
    """An unknown name; the text offers the nearest."""

    code = _abi.RDM_NOT_FOUND


class MissingFileError(NotFoundError, FileNotFoundError):
    """A file that is not there."""


class CancelledError(Error, RuntimeError):
    """Agent.cancel was called; the agent is good."""

    code = _abi.RDM_CANCELLED


class InternalError(Error, RuntimeError):
    """A defect of redman."""


_CLASS_OF = {kind.code: kind for kind in (
    ArgumentError, RangeError, StateError, AllocationError, FileError, FormatError, VersionError, UnsupportedError,
    PhysicsError, NotFoundError, CancelledError, InternalError)}


def error_of(code: int, text: str) -> Error:
    """The exception of a failed call."""
    kind = _CLASS_OF.get(code)
    if kind is None:  # a code of a later library
        error: Error = InternalError(text)
        error.code = code
        return error
    return kind(text)
