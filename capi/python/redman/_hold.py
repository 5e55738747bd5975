"""Decisions that are taken for steps: one of `Policy.act` is written to worlds that step faster than the policy decides.

What is handed on as an array cannot be refused, for a policy may be asked at every step on purpose; but it is said, once
for each pool, where the same array that `act` returned is written in two steps of one decision.
"""
from __future__ import annotations

import sys
import warnings
import weakref
from typing import Any, Optional

from ._rows import Array


class HoldWarning(UserWarning):
    """Actions of a policy are not held as long as it decides, or are not about the center of the worlds."""


def warn(text: str) -> None:
    """Where this package was called from."""
    level, frame = 1, sys._getframe(0)
    while frame.f_back is not None and frame.f_globals.get("__name__", "").split(".")[0] == __package__:
        level, frame = level + 1, frame.f_back
    warnings.warn(text, HoldWarning, stacklevel=level)


class _Decision:
    """The last array that a policy returned."""

    def __init__(self) -> None:
        self.array: Optional[weakref.ref[Array]] = None  # None: no policy has decided yet
        self.steps = 1  # control steps that it is to be held
        self.number = 0  # of decisions so far


LAST = _Decision()


class Watch:
    """Of one pool: when it took the last decision that came straight from a policy."""

    def __init__(self) -> None:
        self._at, self._number = -1, 0
        self._said = False

    def look(self, array: Any, step: int, length: int, centered: bool = False) -> None:
        """Before control step `step` of world 0's episode (-1: unknown), in worlds whose step has `length` control steps."""
        if LAST.array is None or self._said or LAST.array() is not array:
            return
        if LAST.number == self._number:  # held
            return
        self._number = LAST.number
        if centered:
            self._say("these worlds add their center to every action, and an action of Policy.act is not about it: take "
                      "that of policy.actor(env)")
        elif LAST.steps > length and self._at >= 0 and 0 < step - self._at < LAST.steps:
            self._say(f"a decision of this policy is to be held {LAST.steps} control steps, and a new one is taken every "
                      f"{length}: the return is another policy's. policy.actor(pool) or policy.actor(env) holds it")
        self._at = step

    def _say(self, text: str) -> None:
        self._said = True
        warn(text)


def decided(array: Array, steps: int) -> Array:
    """Remembers what a policy returns."""
    LAST.array, LAST.steps, LAST.number = weakref.ref(array), steps, LAST.number + 1
    return array
