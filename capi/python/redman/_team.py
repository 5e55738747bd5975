"""Groups of a team: which entries of observations and actions belong to each group."""
from __future__ import annotations

import ctypes
from ctypes import byref
from dataclasses import dataclass
from typing import Any, Optional

import numpy as np

from . import _abi
from ._abi import RDM_TEXT_SIZE, ResultCode
from ._library import check, encoded, instance, lib, sized, text
from ._pool import Pool
from ._rows import Array


@dataclass(frozen=True)
class Group:
    """One agent of a team."""

    name: str
    actions: slice  # of an action row, its own entries
    columns: Array  # of an observation row, the entries that it observes, ascending


def groups(pool: Pool, which: Optional[str] = None) -> list[Group]:
    """The groups of a pool's task, as the option groups of a team algorithm selects them.

    which: a set that the task defines, such as "hands" or "fingers"; a list "NAME:FIELDS:FIRST-LAST;..."; "all" for one group;
    None for the first set of the task, or one group if the task defines none.
    """
    config = sized(_abi.rdm_agent_config)
    check(lib.rdm_agent_config_init(byref(config), ctypes.sizeof(config)))
    check(lib.rdm_agent_config_for_pool(byref(config), instance(pool, Pool, "pool")._open()))
    wanted: Any = None if which is None else encoded(which, "which")
    columns = np.empty(config.obs_dim, np.int32)
    name = ctypes.create_string_buffer(RDM_TEXT_SIZE)
    found: list[Group] = []
    while True:
        told = sized(_abi.rdm_group)
        code = lib.rdm_agent_group_at(byref(config), wanted, len(found), byref(told), name, columns.ctypes.data, len(columns))
        if found and code == ResultCode.RANGE:
            return found
        check(code)
        found.append(Group(text(name.value), slice(told.first, told.first + told.count), columns[:told.num_columns].copy()))
