"""Detects decisions that are mistaken for steps: an action of `Policy.act` is written to worlds that step faster than the
policy decides.

Such a use cannot be refused, since a policy may be called at every step on purpose. A warning is given once for each pool,
when arrays that `act` returned are written in two steps of one decision.
"""
from __future__ import annotations

import sys
import warnings
import weakref
from typing import Any, Optional

from ._rows import Array


class HoldWarning(UserWarning):
    """Actions of a policy are not held as long as its decisions last, or do not refer to the center of the worlds."""


def warn(text: str) -> None:
    """Warns at the line that called this package."""
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
    """For one pool: the step at which it received the last decision that came directly from a policy."""

    def __init__(self) -> None:
        self._at, self._number = -1, 0
        self._said = False

    def look(self, array: Any, step: int, length: int, centered: bool = False) -> None:
        """Called before control step `step` of world 0's episode (-1: unknown), in worlds whose step has `length` control
        steps."""
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
