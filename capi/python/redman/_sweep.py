"""sweep: tasks x algorithms x seeds x options, each a run of its own, by the command-line tool."""
from __future__ import annotations

import json
import os
import subprocess
from typing import Any, Iterable, Mapping, Optional, Sequence, Union

from ._error import ArgumentError, UnsupportedError, UsageError
from ._library import encoded, int32, real
from ._options import as_dict
from ._tool import tool_path

Words = Union[str, Iterable[str]]
Plain = Union[str, float, bool]


def _joined(words: Union[str, Iterable[Any]], name: str) -> str:
    if not hasattr(words, "__iter__") or isinstance(words, (bytes, type)):
        raise UsageError(f"{name}: it must be a word or a list of words, not {words!r}")
    return words if isinstance(words, str) else ",".join(str(w) for w in words)


def _text(value: Plain) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def sweep(tasks: Words, algos: Words = "ppo_lag", seeds: Union[str, int, Iterable[int]] = 5, *, steps: float, out: Union[str, "os.PathLike[str]"],
          options: Optional[Mapping[str, Plain]] = None, vary: Optional[Mapping[str, Sequence[Plain]]] = None,
          cost_limit: Optional[float] = None, envs: int = 64, jobs: int = 0, minutes: float = 0) -> dict[str, Any]:
    """Trains tasks x algorithms x seeds x the values of vary, and returns the results of the runs.

        done = redman.sweep(["ball_run", "car_run"], ["ppo_lag", "cpo"], seeds=5, steps=1e6, out="runs/sweep")
        done["rows"][0]["return_iqm"], done["rows"][0]["return_interval"]

    seeds: their number, or a list of seeds. algos: algorithms, each on every task. steps: control steps of each run. envs: worlds of
    a run. cost_limit: the limit on the first cost; None: the task's. options: options of task and algorithm for all runs. vary: {key: values}, a
    configuration for each value. jobs: number of runs at a time; 0: one per core. minutes: time after which runs are stopped. The
    same call continues runs that were stopped, for any reason, and does not repeat complete ones. A wrong setting raises
    ArgumentError before anything starts. The folder contains run folders as the tool writes them, and a table in sweep.md.
    """
    tool = tool_path()
    if tool is None:
        raise UnsupportedError("a sweep needs the command redman, which was not found: it is not in this package, it is not on PATH, and "
                               "REDMAN_TOOL is not set")
    listed = f"0..{seeds - 1}" if isinstance(seeds, int) else _joined(seeds, "seeds")
    words = ["sweep", "--json", "--tasks", _joined(tasks, "tasks"), "--algos", _joined(algos, "algos"), "--seeds", listed,
             "--steps", repr(real(steps, "steps")), "--out", os.fsdecode(encoded(out, "out")), "--envs", str(int32(envs, "envs")),
             "--jobs", str(int32(jobs, "jobs")), "--minutes", repr(real(minutes, "minutes"))]
    for key, value in as_dict(options).items():
        words += ["--set", f"{key}={_text(value)}"]
    for key, values in as_dict(vary, "vary").items():
        if isinstance(values, str) or not hasattr(values, "__iter__"):
            raise UsageError(f"vary: {key} must be a list of values, not {values!r}")
        words += ["--vary", f"{key}={_joined(map(_text, values), 'vary')}"]
    if cost_limit is not None:
        words += ["--cost-limit", repr(real(cost_limit, "cost_limit"))]
    done = subprocess.run([tool, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL)
    if done.returncode:
        said = done.stderr.strip() or done.stdout.strip() or f"redman sweep ended with {done.returncode}"
        raise ArgumentError(said.split("redman: ")[-1])
    return dict(json.loads(done.stdout))
