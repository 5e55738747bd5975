"""Limits and budgets: a number for each cost, from the forms in which they may be given."""
from __future__ import annotations

import math
from typing import Iterable, Mapping, Optional, Sequence, Union

import numpy as np

from ._error import ArgumentError, NotFoundError, UsageError
from ._names import nearest

CostLimits = Union[None, float, Sequence[Optional[float]], Mapping[str, Optional[float]]]


def each_cost(wanted: CostLimits, usual: Optional[Iterable[float]], columns: Sequence[str],
              name: str) -> Optional[list[float]]:
    """A limit for each column, below 0 for none; what is given overrides the usual ones. None where there are neither. name:
    of the argument."""
    def number(limit: Optional[float]) -> float:
        if limit is None:
            return -1.0
        try:
            return -1.0 if math.isnan(limit) else float(limit)
        except TypeError:
            raise UsageError(f"{name}: a limit must be a number or None, not {limit!r}") from None

    limits = None if usual is None else [float(limit) for limit in usual]
    if wanted is None:
        return limits
    if isinstance(wanted, Mapping):
        limits = limits or [-1.0] * len(columns)
        for cost, limit in wanted.items():
            if cost not in columns:
                raise NotFoundError(f"{name}: no cost {cost}{nearest(str(cost), columns)}; there are "
                                    f"{', '.join(columns)}")
            limits[columns.index(cost)] = number(limit)
        return limits
    if isinstance(wanted, (int, float, np.number)):
        limits = limits or [-1.0] * len(columns)
        if not limits:
            raise ArgumentError(f"{name}: it cannot be given, since there are no costs")
        limits[0] = number(float(wanted))
        return limits
    if isinstance(wanted, (str, bytes, type)) or not hasattr(wanted, "__iter__"):
        raise UsageError(f"{name}: it must be a number, a list with one for each cost, or a dict by name, not {wanted!r}")
    listed = [number(limit) for limit in wanted]
    if len(listed) != len(columns):
        raise ArgumentError(f"{name}: it has {len(listed)} limits, but there are {len(columns)} costs")
    return listed
