"""Episodes of one world of a pool while somebody acts in it, for a file that train(from_=...) takes."""
from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from ._pool import Pool
from ._recording import Recording

if TYPE_CHECKING:
    import numpy.typing as npt


class Demonstrations:
    """Whole episodes of the watched world, from the next one that begins. An episode in which something was pulled is no
    demonstration, since the pull is not in its actions: it is dropped."""

    def __init__(self, pool: Pool, path: Union[str, os.PathLike[str]]) -> None:
        self.path = path
        self.episodes = self.dropped = self.steps = 0
        self.pulled = False  # in the episode that runs
        self._whole, self._one = Recording(pool), Recording(pool)
        self._world, self._runs, self._stepping = -1, False, False
        self._mask: npt.NDArray[np.uint8] = np.zeros(pool.num_envs, np.uint8)

    def before(self, pool: Pool, world: int) -> None:
        """Ahead of a step."""
        if world != self._world:
            self._mask[:] = 0
            self._mask[world] = 1
            self._world, self._runs = world, False
        # a pool that resets in the same step still tells of the episode that is over
        if pool.episode_step[world] == 0 or pool.terminated[world] or pool.truncated[world]:
            self._one.clear()
            self._runs, self.pulled = True, False
        if self._runs:
            self._one.begin_step(pool, mask=self._mask)
            self._stepping = True

    def after(self, pool: Pool) -> None:
        """Behind it."""
        if not self._stepping:
            return
        self._one.end_step(pool, mask=self._mask)
        self._stepping = False
        if not (pool.terminated[self._world] or pool.truncated[self._world]):
            return
        if self.pulled:
            self.dropped += 1
        else:
            self.steps += len(self._one)
            self.episodes += 1
            self._whole.append(self._one)
        self._one.clear()
        self._runs = False

    def told(self) -> dict[str, Any]:
        """What the page shows of it."""
        return {"episodes": self.episodes, "dropped": self.dropped, "steps": self.steps, "pushed": self.pulled and self._runs}

    def save(self) -> None:
        """Writes what is whole, if something is."""
        if self.episodes:
            self._whole.save(self.path)
