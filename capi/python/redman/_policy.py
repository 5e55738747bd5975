"""Policy: the frozen network."""
from __future__ import annotations

import ctypes
import os
import threading
from pathlib import Path
from typing import Any, Optional, Union

import numpy as np

from . import _abi
from ._error import ArgumentError, FileError, MissingFileError
from ._library import Handle, check, filled, lib, policy_folders
from ._pool import Pool
from ._rows import Array, FloatArray, clouds, given
from ._tensors import Tensors


class Policy:
    """Actions for observations; immutable, any number of threads may share it.

        policy = redman.Policy.load("runs/first")          # a run folder, a file, or bytes
        action = policy.act(pool.obs)                      # the mean; noise adds a sample

    One call is one decision, to be held for policy.info.action_repeat control steps.
    """

    def __init__(self, data: bytes) -> None:
        self._bytes = bytes(data)
        self._handle = Handle(lib.rdm_policy_load, lib.rdm_policy_destroy, self._bytes, len(self._bytes))
        self.info = _abi.PolicyInfo(filled(_abi.rdm_policy_info, lib.rdm_policy_get_info, self._handle.value))
        self._local = threading.local()

    @classmethod
    def load(cls, source: Union[str, os.PathLike[str], bytes, bytearray, memoryview]) -> Policy:
        """Of a policy file, of a run folder's policy.rdm, or of the bytes of a file."""
        if isinstance(source, (bytes, bytearray, memoryview)):
            return cls(bytes(source))
        path = Path(source)
        try:
            return cls((path / "policy.rdm" if path.is_dir() else path).read_bytes())
        except FileNotFoundError:
            raise MissingFileError(f"policy {path}: there is no such file") from None
        except OSError as error:
            raise FileError(f"policy {path}: {error.strerror}") from None

    @classmethod
    def trained(cls, task: str) -> Policy:
        """Of the policies that come with redman, that of a task: the one of `redman eval --policy trained`."""
        name = task.lower().replace("-", "_")
        for folder in policy_folders():
            if (folder / f"{name}.rdm").is_file():
                return cls.load(folder / f"{name}.rdm")
        raise MissingFileError(f"policy of {task}: none in " + ", ".join(str(folder) for folder in policy_folders()))

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the policy file, whole or not at all."""
        temporary = Path(f"{os.fspath(path)}.part")
        temporary.write_bytes(self._bytes)
        os.replace(temporary, path)

    def __bytes__(self) -> bytes:
        return self._bytes

    def act(self, obs: Any, noise: Any = None, points: Any = None, point_class: Any = None,
            point_color: Any = None) -> FloatArray:
        """clip(mean + std noise, -1, 1) for one observation [obs_dim] or rows [n][obs_dim]; noise None: the mean.

        A policy that sees points takes them [n][num_points][3] too, where it has num_point_classes their classes, and
        where it sees point_color their colours [n][num_points][3], 0 to 255.
        """
        rows_of = _abi.FUNCTIONS["rdm_policy_act"].rows
        observed = np.asarray(obs)
        if observed.ndim not in (1, 2) or observed.shape[-1] != self.info.obs_dim:
            raise ArgumentError(f"obs: shape {observed.shape} does not fit (rows, {self.info.obs_dim})")
        lengths = {"rows": observed.shape[0] if observed.ndim == 2 else 1, "obs_dim": self.info.obs_dim,
                   "action_dim": self.info.action_dim}
        rows = lengths["rows"]
        action = np.empty((rows, self.info.action_dim), np.float32)
        if rows:
            seen = given(observed, rows_of["obs"], lengths, "obs")
            drawn = None if noise is None else given(noise, rows_of["noise"], lengths, "noise")
            size, scratch = self._scratch(rows)
            noise_at = None if drawn is None else drawn.ctypes.data
            if points is None:
                check(lib.rdm_policy_act(self._handle.value, seen.ctypes.data, rows, noise_at, action.ctypes.data,
                                         scratch, size))
            else:
                cloud, kept = clouds(points, point_class, point_color, rows)
                check(lib.rdm_policy_act_points(self._handle.value, seen.ctypes.data, ctypes.byref(cloud), rows,
                                                noise_at, action.ctypes.data, scratch, size))
                del kept
        return action if observed.ndim == 2 else action.reshape(-1)

    def _scratch(self, rows: int) -> tuple[int, int]:
        """Size and address of this thread's memory for so many rows."""
        if getattr(self._local, "rows", None) != rows:
            size = lib.rdm_policy_scratch(self._handle.value, rows)
            self._local.memory = np.empty(size, np.uint8)
            self._local.rows, self._local.scratch = rows, (size, self._local.memory.ctypes.data)
        found: tuple[int, int] = self._local.scratch
        return found

    def check(self, pool: Pool) -> None:
        """VersionError, which says what differs, unless the policy fits the pool's task and options."""
        check(lib.rdm_policy_check(self._open(), pool._spec))

    @property
    def columns(self) -> Array:
        """Which entries of a row the policy sees, ascending: all, but for option actor_obs of its agent."""
        out = np.empty(self.info.obs_dim, np.int32)
        count = ctypes.c_int32()
        check(lib.rdm_policy_columns(self._open(), out.ctypes.data, len(out), ctypes.byref(count)))
        return out[:count.value]

    @property
    def tensors(self) -> Tensors:
        """Weights and normaliser by name, and an example of the network's input and output."""
        return Tensors(self, lib.rdm_policy_tensor, lib.rdm_policy_tensor_read)

    def _open(self) -> int:
        assert self._handle.value is not None
        return self._handle.value

    def _repr_png_(self) -> Optional[bytes]:
        """Six moments of an episode of its task, for a notebook; None for a task of your own or other options."""
        from ._play import strip
        return strip(self)

    def __reduce__(self) -> Any:
        return Policy, (self._bytes,)

    def __deepcopy__(self, _: Any) -> Policy:
        return self  # immutable

    def __repr__(self) -> str:
        i = self.info
        return f"<Policy {i.task or 'of your own task'}: {i.obs_dim} to {i.action_dim}, {i.num_params} parameters>"
