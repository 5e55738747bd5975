"""One line of progress on stderr: rewritten on a terminal and in a notebook, else one every ten seconds."""
from __future__ import annotations

import math
import sys
import time
from typing import TYPE_CHECKING

from ._agent import Epoch

if TYPE_CHECKING:
    from ._run import Run


def _short(value: float) -> str:
    """As the command writes counts: 38.1k, 2.5M."""
    size, unit = (1e6, "M") if value >= 1e6 else (1e3, "k") if value >= 1e3 else (1, "")
    return f"{value / size:.3g}{unit}"


class Meter:
    """The line of one run. done: steps that the run had before."""

    def __init__(self, done: int, goal: int, per_epoch: int) -> None:
        self._first, self._goal, self._begin, self._shown = done, goal, time.monotonic(), 0.0
        self._width = 0  # of the line that stands there
        self._live = sys.stderr.isatty() or "ipykernel" in sys.modules
        left = max(0, goal - done)
        if left % per_epoch:
            self._say(f"steps={goal}: a run ends after a whole epoch of up to {per_epoch} steps, so it takes up to "
                      f"{done + math.ceil(left / per_epoch) * per_epoch} steps\n")

    def show(self, e: Epoch) -> None:
        now = time.monotonic()
        last = e.env_steps >= self._goal
        if not last and now - self._shown < (0.2 if self._live else 10):
            return
        self._shown = now
        rate = (e.env_steps - self._first) / max(now - self._begin, 1e-9)
        left = int(max(self._goal - e.env_steps, 0) / max(rate, 1e-9))
        ended = (f"return {e.ret:.2f}  cost {e.cost[0]:.2f}  length {e.length:.0f}  falls {100 * e.fall_rate:.0f}%"
                 if e.episodes > 0 else f"no episode has ended  cost per step {e.cost_per_step:.3g}")
        line = (f"{min(100, 100 * e.env_steps / self._goal):3.0f}%  {_short(e.env_steps)} steps  {ended}  {_short(rate)} steps/s  "
                f"{left // 60}:{left % 60:02d} left")
        self._say(f"\r{line:<{self._width}}" if self._live else f"{line}\n")
        self._width = len(line) if self._live else 0

    def end(self, run: Run) -> None:
        """Ends the line, and says so when the run is not over."""
        self._say("\n" if self._width else "")
        if run.interrupted:
            further = f"; continue with redman.train(resume={str(run.folder)!r})" if run.folder else ""
            self._say(f"stopped at {run.env_steps} of {self._goal} steps{further}\n")

    @staticmethod
    def _say(text: str) -> None:
        sys.stderr.write(text)
        sys.stderr.flush()
