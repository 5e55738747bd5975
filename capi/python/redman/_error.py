"""What a failed call raises: redman.Error, which is also the built-in exception that a caller would expect for its code."""
from __future__ import annotations

from ._abi import ResultCode


class Error(Exception):
    """A failed call: str(error) is the library's line of text, error.code the redman.ResultCode."""

    code: int = ResultCode.INTERNAL


class ArgumentError(Error, ValueError):
    """A value is not finite, malformed, or of the wrong shape."""

    code = ResultCode.ARGUMENT


class UsageError(ArgumentError, TypeError):
    """An argument that a function does not have, or of a type that it does not take."""


class RangeError(Error, ValueError, IndexError):
    """A value is outside of its documented bounds, or an index is past the end."""

    code = ResultCode.RANGE


class StateError(Error, RuntimeError):
    """Calls were made in the wrong order, such as a step before the first reset."""

    code = ResultCode.STATE


class AllocationError(Error, MemoryError):
    """There is not enough memory: take fewer worlds, or smaller networks."""

    code = ResultCode.MEMORY


class FileError(Error, OSError):
    """The operating system could not open, read or write a file."""

    code = ResultCode.IO


class FormatError(Error, ValueError):
    """A file or bytes are incomplete, corrupt, or in another format."""

    code = ResultCode.FORMAT


class VersionError(Error, ValueError):
    """A file or library is too new, or a policy is of another task or other options."""

    code = ResultCode.VERSION_MISMATCH


class UnsupportedError(Error, NotImplementedError):
    """Something was left out of this build, or is not defined for this combination of arguments."""

    code = ResultCode.UNSUPPORTED


class PhysicsError(Error, ArithmeticError):
    """The physics engine failed, and no single world could be flagged."""

    code = ResultCode.PHYSICS


class NotFoundError(Error, LookupError):
    """A name is unknown; the text offers the nearest known one."""

    code = ResultCode.NOT_FOUND


class MissingFileError(NotFoundError, FileNotFoundError):
    """A file or folder does not exist."""


class CancelledError(Error, RuntimeError):
    """Agent.cancel was called; the agent can still be used."""

    code = ResultCode.CANCELLED


class InternalError(Error, RuntimeError):
    """A bug in redman: please report it, with what was called."""


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
