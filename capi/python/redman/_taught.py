"""Runs whose teacher acts: scripts of demonstrations, rounds of DAgger, clouds that an encoder first learns from. The command
plays the teacher and learns one epoch; train goes on from its run folder, as from any other."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO, Any, Iterator, Mapping

from ._error import ArgumentError, UnsupportedError, UsageError
from ._options import Value, shown
from ._paths import is_file
from ._tool import tool_path

_WAIT = 0.02  # s between two looks at the folder


def words(given: Mapping[str, Any], task: str, algo: str, options: Mapping[str, Value], limits: list[str], shield: str,
          teach: Mapping[str, Any]) -> Iterator[str]:
    """The arguments of `redman train` for those of train. options: by names, of the task and the algorithm; teach: a word or
    path in "from", and its settings."""
    yield from ("--task", task, "--algo", algo, "--steps", str(int(given["steps"] or 1e6)), "--seed", str(given["seed"]))
    yield from ("--envs", str(given["envs"]), "--threads", str(given["threads"]))
    yield from ("--eval-every", str(given["eval_every"]), "--checkpoint-every", str(given["checkpoint_every"]))
    for value in (given["options"] or {}).values():
        for kind in ("robot", "object"):
            if is_file(kind, value):
                yield from (f"--{kind}", os.fspath(value))
    for key, value in options.items():
        yield from ("--set", f"{key}={shown(key, value)}")
    for limit in limits:
        yield from ("--cost-limit", limit)
    yield from ("--shield", shield)
    yield from (flag for flag, on in (("--no-tensorboard", not given["tensorboard"]), ("--overwrite", given["overwrite"])) if on)
    first, last = teach["start_share"], teach["start_share_end"]
    for key, value in teach.items():
        flag = "--" + {"decisions": "demo-decisions"}.get(key, key).replace("_", "-")
        if key == "success_only":
            yield from [flag] * value
        elif key == "start_share":
            yield from (flag, f"{first}..{last}" if first != last else str(first))
        elif key != "start_share_end":
            yield from (flag, str(value))


def begin(arguments: Iterator[str], folder: Path, told: bool) -> None:
    """Runs `redman train` with the arguments until its first epoch is over, which leaves a run folder with a checkpoint. told:
    what it says of the teacher goes to stderr."""
    tool = tool_path()
    if tool is None:
        raise UnsupportedError("from_: this teacher needs the command redman, which was not found: it is not in this package, it is not on "
                               "PATH, and REDMAN_TOOL is not set")
    if os.name != "posix":
        raise UnsupportedError("from_: this teacher acts in the command redman, which cannot be started from here: use redman train --from")
    said: list[str] = []
    # Ctrl-C is for this process, which ends the other one
    with subprocess.Popen([tool, "train", *arguments, "--out", os.fspath(folder)], stdin=subprocess.DEVNULL,
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace",
                          start_new_session=True) as run:
        assert run.stderr is not None
        reader = threading.Thread(target=_tell, args=(run.stderr, said, told), daemon=True)
        reader.start()
        try:
            while not _has_epoch(folder / "progress.csv"):
                try:
                    run.wait(_WAIT)
                    break
                except subprocess.TimeoutExpired:
                    pass
            run.send_signal(signal.SIGINT)  # it ends after its epoch, with a checkpoint; nothing if it has ended
            run.wait()
        except BaseException:
            run.kill()
            raise
        reader.join()
    if run.returncode not in (0, 130, -signal.SIGINT):
        raise ArgumentError(said[-1].removeprefix("redman: ") if said else f"redman train ended with {run.returncode}")


def _tell(lines: IO[str], said: list[str], told: bool) -> None:
    """Keeps the lines; shows those of the teacher, and no errors, which are raised."""
    for line in lines:
        if not line.strip():
            continue
        said.append(line.rstrip())
        told = told and not line.startswith("training in ")  # what follows is the run's, which train tells
        if told and not line.startswith("redman: "):
            print(line, end="", file=sys.stderr, flush=True)


def _has_epoch(path: Path) -> bool:
    try:
        return path.read_bytes().count(b"\n") >= 2
    except OSError:
        return False


def need_command(given: Mapping[str, Any], task_class: Any) -> None:
    """UnsupportedError for what a teacher of the command does not know."""
    for name in ("costs", "reward", "ranks"):
        if given[name] is not None:
            raise UnsupportedError(f"from_: this teacher acts in the command, which does not know {name}=; a recording or a policy "
                                   "goes with it")
    if task_class is not None:
        raise UnsupportedError("from_: this teacher acts in the command, which does not know a task in Python; a recording or a "
                               "policy goes with it")
    if not isinstance(given["from_"], (str, os.PathLike, type(None))):
        raise UsageError("from_: a teacher that acts is a word or a path, \"demo\", \"my.demo\", \"trained\", a policy file or a run "
                         "folder")
