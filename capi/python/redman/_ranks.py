"""Ranks: learning in several processes together. Experimental, like redman/ranks.h."""
from __future__ import annotations

import ctypes
from typing import Any, Callable, Optional, Sequence

from . import _abi
from ._callbacks import c_function
from ._error import ArgumentError, UsageError
from ._library import assign, int32, sized
from ._names import Hinted

Gather = Callable[[bytes], Sequence[bytes]]
Swap = Callable[[int, bytes], bytes]


class Ranks(Hinted):
    """Which of several processes this one is, and how they exchange messages. Together they are one learner, which learns
    the same bytes as one process with all worlds and the same option blocks.

        ranks = redman.Ranks(comm.rank, comm.size, comm.allgather)          # comm: of mpi4py
        pool = redman.Pool(task, 16, ranks=ranks)                           # 16 of 16 * comm.size worlds
        agent = redman.Agent(pool, options={"blocks": 16}, ranks=ranks)
        pool.reset()
        while True:
            epoch = agent.rollout(pool)                                     # the same on each rank

    gather(message) returns the messages of all ranks, in order; messages are bytes of equal length, and it blocks until all
    ranks have called it. swap(partner, message), which is optional, sends a message to one rank and returns that rank's. An
    exception in either ends the call with CancelledError. All ranks must make the same calls of rollout, act, record, update
    and save.
    """

    rank: int
    ranks: int

    def __init__(self, rank: int, ranks: int, gather: Optional[Gather] = None, swap: Optional[Swap] = None) -> None:
        rank, ranks = int32(rank, "rank"), int32(ranks, "ranks")
        if not 0 <= rank < ranks:
            raise ArgumentError(f"rank: {rank} is not between 0 and {ranks - 1}")
        for name, call in (("gather", gather), ("swap", swap)):
            if call is not None and not callable(call):
                raise UsageError(f"{name}: it must be a function, not {call!r}")
        if gather is None and ranks > 1:
            raise UsageError("gather: it is missing: give the function that exchanges the messages of several ranks, such as "
                             "comm.allgather of mpi4py")
        self.rank, self.ranks = rank, ranks
        self._messages = gather
        self._struct = sized(_abi.rdm_ranks)
        assign(self._struct, {"rank": rank, "ranks": ranks})
        if gather is not None:
            self._gather = self._struct.gather = c_function("rdm_ranks.gather", _gathering(gather, ranks))
        if swap is not None:
            self._swap = self._struct.swap = c_function("rdm_ranks.swap", _swapping(swap))

    def _any(self, mine: bool) -> bool:
        """Whether it holds on any rank."""
        return mine if self._messages is None else any(b"\1" == said for said in self._messages(b"\1" if mine else b"\0"))

    def __reduce__(self) -> Any:
        raise UsageError("redman.Ranks belong to one process: make them in each")

    def __repr__(self) -> str:
        return f"<Ranks: {self.rank} of {self.ranks}>"


def _gathering(gather: Gather, ranks: int) -> Callable[..., int]:
    def hook(_: Any, mine: int, size: int, every: int) -> int:
        messages = gather(ctypes.string_at(mine, size))
        lengths = [len(message) for message in messages]
        if lengths != [size] * ranks:
            raise ArgumentError(f"gather: it returned messages of {lengths} bytes, but must return {ranks} of {size} bytes")
        ctypes.memmove(every, b"".join(messages), size * ranks)
        return 0
    return hook


def _swapping(swap: Swap) -> Callable[..., int]:
    def hook(_: Any, partner: int, mine: int, size: int, theirs: int) -> int:
        message = swap(partner, ctypes.string_at(mine, size))
        if len(message) != size:
            raise ArgumentError(f"swap: it returned a message of {len(message)} bytes, but must return {size} bytes")
        ctypes.memmove(theirs, bytes(message), size)
        return 0
    return hook
