"""Windows on running worlds: the command `redman view`, with worlds of its own or with those of a pool of this process."""
from __future__ import annotations

import atexit
import json
import os
import queue
import subprocess
import tempfile
import threading
import time
import warnings
import weakref
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from ._abi import ShieldKind
from ._demonstrations import Demonstrations
from ._discovery import TaskName, task_name
from ._error import ArgumentError, Error, StateError, UnsupportedError, UsageError
from ._feed import Feed, follow
from ._files import MOST_JSON, read_bytes
from ._lead import Lead
from ._names import Hinted, keywords
from ._options import Options
from ._options import shown as option_text
from ._paths import is_file, named_options
from ._play import singly
from ._policy import Policy, policy_of
from ._pool import Pool
from ._rows import Array
from ._run import Run
from ._shield import Shield
from ._tool import tool_path

MOST_WORLDS = 64
FilePath = Union[str, "os.PathLike[str]"]
_PATIENCE = 60.0  # s for the tool to say its address
_open_ones: weakref.WeakSet[Window] = weakref.WeakSet()


@dataclass(frozen=True)
class Page:
    """How a window opens, and what its button records."""

    browser: bool = True  # opens by itself
    port: int = 0
    paused: bool = False
    record: Optional[FilePath] = None
    shield: Optional[Shield] = None  # of a pool


class Window(Hinted):
    """A page in a browser on running worlds, at window.address, until close() or the end of this process.

    With worlds of a pool: what is done on the page waits for the next step of the pool. windows: how many browsers look now.
    """

    _hints = {"url": "address", "show": "address, which a browser opens; update() sends the worlds as they are now"}

    address: str

    def __init__(self, arguments: Sequence[str], *, fed: bool, page: Page, keep: Any = None) -> None:
        tool = tool_path()
        if tool is None:
            raise UnsupportedError("view: a window needs the command redman, which was not found: it is not in this package, it is not on PATH, "
                                   "and REDMAN_TOOL is not set")
        words = [tool, "view", *(["--feed"] if fed else []), *arguments, "--port", str(page.port), *(["--open"] if page.browser else []),
                 *(["--paused"] if page.paused else [])]
        if page.record is not None and not fed:
            words += ["--record", os.fspath(page.record)]
        self._keep = keep  # files that it reads
        self._stop: list[Any] = []
        self._state: dict[str, Any] = {"windows": 0, "plays": True, "speed": 1.0, "steps": 0, "watched": 0, "contacts": False,
                                       "push": None, "lead": None, "action": None, "record": False, "shield": False}
        self._changed = threading.Condition()
        self._process = subprocess.Popen(words, stdin=subprocess.PIPE if fed else subprocess.DEVNULL, stdout=subprocess.PIPE,
                                         stderr=subprocess.PIPE, start_new_session=True)
        said: queue.Queue[str] = queue.Queue()
        for stream in (self._process.stdout, self._process.stderr):
            threading.Thread(target=self._listen, args=(stream, said), daemon=True).start()
        _open_ones.add(self)
        self.address = self._address(said)
        print(f"a window on {self.address}")

    def _address(self, said: queue.Queue[str]) -> str:
        """The address, which it says first; else what it says is the error."""
        last, until = "", time.monotonic() + _PATIENCE
        while time.monotonic() < until:
            try:
                line = said.get(timeout=0.1)
            except queue.Empty:
                if self._process.poll() is not None and said.empty():
                    break
                continue
            if line.startswith("http://127.0.0.1:"):
                return line
            last = line or last
        self.close()
        raise ArgumentError(f"view: {last.removeprefix('redman: ') or 'the command redman said nothing'}")

    def _listen(self, stream: Any, said: queue.Queue[str]) -> None:
        """Reads what the tool says: lines of JSON about what is done on the page, and words."""
        with stream:
            for raw in stream:
                line = raw.decode(errors="replace").strip()
                if not line.startswith("{"):
                    said.put(line)
                    continue
                try:
                    told = json.loads(line)
                except ValueError:
                    continue
                if "windows" in told:
                    with self._changed:
                        self._state = told
                        self._changed.notify_all()
        with self._changed:
            self._changed.notify_all()

    @property
    def closed(self) -> bool:
        """Whether it has ended."""
        return self._process.poll() is not None

    @property
    def windows(self) -> int:
        """How many browsers look at worlds of this process now; 0 for worlds of the tool's own."""
        return 0 if self.closed else int(self._state["windows"])

    def update(self) -> None:
        """Sends the worlds of a pool as they are now; step() and reset() do that while a browser looks."""
        raise StateError("update: these worlds run in the command redman")

    def close(self) -> None:
        """Ends it; a second call does nothing."""
        stops, self._stop = self._stop, []
        for stop in stops:
            stop()
        _open_ones.discard(self)
        if self._keep is not None:
            self._keep.cleanup()
        process = self._process
        if process.stdin is not None:
            try:
                process.stdin.close()  # the tool ends when nothing more can come
            except OSError:
                pass
        if process.poll() is None:
            process.terminate()
            try:
                process.wait(5)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        with self._changed:
            self._changed.notify_all()

    def __enter__(self) -> Window:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _repr_html_(self) -> str:
        """A link, for a notebook."""
        return f'<a href="{self.address}" target="_blank">a window on running worlds</a>' if not self.closed else "<p>a window that was closed</p>"

    def __repr__(self) -> str:
        return f"<Window {'closed' if self.closed else self.address}>"


class PoolWindow(Window):
    """A window that follows a pool."""

    def __init__(self, pool: Pool, env: int, count: int, actor: str, *, page: Page,
                 limits: Optional[Mapping[str, Optional[float]]] = None) -> None:
        self._pool, self._env, self._record = weakref.ref(pool), env, page.record
        self._shield, self._stepped_in, self._decided = page.shield, np.zeros(pool.num_envs, bool), pool.action.copy()
        self._holds = np.zeros(pool.num_envs, bool)  # worlds that hold a decision of the shield
        self._lead: Optional[Lead] = None
        self._led: Optional[Array] = None  # the action that leads
        self._feed: Any = Feed(weakref.proxy(pool), env, count, actor=actor, limits=limits,
                               record="" if page.record is None else os.fspath(page.record), leads=True, shields=page.shield is not None)
        self._take: Optional[Demonstrations] = None
        self._scene_sent = self._refused = False
        self._used, self._due = 0, 0.0
        self._seconds = float(pool.control_dt) * pool.spec.action_repeat
        super().__init__([], fed=True, page=page)
        self._stop += [follow(pool, self._before, self._after), self._end_take]
        if pool._begun:
            self.update()

    def update(self) -> None:
        """Sends the worlds as they are now."""
        watched = self._env + int(self._state["watched"])
        data = b"" if self._scene_sent else self._feed.scene()
        data += self._feed.frame(watched, contacts=self._state["contacts"], take=None if self._take is None else self._take.told(),
                                 stepped_in=self._stepped_in[self._feed.worlds.start:self._feed.worlds.stop])
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(data)
            self._process.stdin.flush()
            self._scene_sent = True
        except (OSError, ValueError):  # it was closed from outside
            self.close()

    def _before(self) -> None:
        """Waits as long as the page is paused, and for the clock; does what the page asks for."""
        with self._changed:
            while self._looked_at() and not self._state["plays"] and self._state["steps"] <= self._used:
                self._switch_take()
                self._changed.wait(0.5)
            state = self._state
        self._switch_take()
        if not self._looked_at():
            self._guard()
            self._record_step()
            return
        if state["plays"]:
            self._used = state["steps"]
            now = time.monotonic()
            if now - self._due > 0.1:  # what was too slow is not made up for
                self._due = now
            if self._due > now:
                time.sleep(self._due - now)
            self._due += self._seconds / state["speed"]
        else:
            self._used += 1
        pool = self._pool()
        if pool is None:
            return
        state = self._state
        self._act(pool, state)
        if state["push"] is not None:
            world, shape, *force = state["push"]
            try:
                pool.push(self._env + world, shape, force)
            except Error as error:  # the page does not know what can be pulled
                if not self._refused:
                    warnings.warn(f"view: {error}", RuntimeWarning, stacklevel=4)
                self._refused = True
            else:
                if self._take is not None and world == state["watched"]:
                    self._take.pulled = True
        self._guard()
        self._record_step()

    def _act(self, pool: Pool, state: Mapping[str, Any]) -> None:
        """Replaces the action of the watched world by that of the page's sliders, or by the one that leads a point."""
        if state["lead"] is None:
            self._led = None
            if state["action"] is not None:
                pool.action[self._env + state["watched"]] = state["action"]
            return
        world, shape, *numbers = state["lead"]
        env = self._env + world
        if self._lead is None:
            self._lead = Lead(pool)
        start = pool.action[env] if self._led is None else self._led
        led = self._lead.bring(env, shape, numbers[:3], numbers[3:], start)
        if led is None and not self._refused:
            warnings.warn(f"view: {pool.shapes[shape].name}: no entry of the action moves it; pull it instead", RuntimeWarning, stacklevel=5)
            self._refused = True
        self._led = start.copy() if led is None else led
        pool.action[env] = self._led

    def _guard(self) -> None:
        """Puts the actions through the shield, where the page has it on: a decision of each world, held as long as those of the shield are."""
        pool = self._pool()
        self._stepped_in[:] = False
        if pool is None or self._shield is None or not self._state["shield"]:
            self._holds[:] = False
            return
        decides = pool.episode_step % self._shield.steps == 0
        self._stepped_in[:] = self._shield.guard(decides) != ShieldKind.OWN
        self._decided[decides] = pool.action[decides]
        self._holds |= decides  # a decision that began before the shield was on goes on to its end
        pool.action[self._holds] = self._decided[self._holds]

    def _switch_take(self) -> None:
        """Begins or ends a recording, as the page says."""
        pool = self._pool()
        if self._record is None or pool is None or bool(self._state["record"]) == (self._take is not None):
            return
        if self._take is None:
            self._take = Demonstrations(pool, self._record)
        else:
            self._end_take()
        self.update()

    def _end_take(self) -> None:
        take, self._take = self._take, None
        if take is not None:
            take.save()

    def _record_step(self) -> None:
        pool = self._pool()
        if self._take is not None and pool is not None:
            self._take.before(pool, self._env + int(self._state["watched"]))

    def _looked_at(self) -> bool:
        return self.windows > 0

    def _after(self, reset: bool) -> None:
        pool = self._pool()
        if self._take is not None and pool is not None and not reset:
            self._take.after(pool)
        if self.closed:
            self.close()
        elif self._looked_at() or not self._scene_sent:
            self.update()


class Playing:
    """Plays a policy, or a baseline, in a pool of its own, in a thread, while somebody looks; the policy may be replaced."""

    def __init__(self, player: Union[Policy, str], pool: Pool, *, actor: str, page: Page,
                 limits: Optional[Mapping[str, Optional[float]]] = None) -> None:
        self._pool, self._baseline = pool, player if isinstance(player, str) else ""
        self._actor = None if isinstance(player, str) else player.actor(pool)
        self._ends = False
        pool.reset()
        self.window = PoolWindow(pool, 0, pool.num_envs, actor, page=page, limits=limits)
        self.window._stop.insert(0, self.stop)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def show(self, policy: Policy) -> None:
        """The policy that plays from the next step on."""
        self._actor = policy.actor(self._pool)

    def stop(self) -> None:
        """Ends the thread."""
        self._ends = True

    def _run(self) -> None:
        pool = self._pool
        while not self._ends and not self.window.closed:
            if self.window.windows == 0:
                time.sleep(0.05)
                continue
            actor, ended = self._actor, pool.terminated | pool.truncated
            if ended.any():
                pool.reset(mask=ended)
                if actor is not None:
                    actor.reset(ended)
            pool.step(pool.baseline(self._baseline) if actor is None else actor())


def _worlds(pool: Pool, env: int, num_envs: Optional[int]) -> int:
    count = min(MOST_WORLDS, pool.num_envs - env) if num_envs is None else num_envs
    if not 0 <= env < pool.num_envs or not 1 <= count <= min(MOST_WORLDS, pool.num_envs - env):
        raise ArgumentError(f"view: worlds {env} to {env + count - 1} of {pool.num_envs}; a window shows at most {MOST_WORLDS}")
    return count


@keywords(aliases={"envs": "num_envs", "n_envs": "num_envs"}, options=True)
def view(shown: Any, *, policy: Union[None, Policy, str, os.PathLike[str]] = None, num_envs: Optional[int] = None, env: int = 0, seed: int = 0,
         options: Optional[Options] = None, browser: bool = True, port: int = 0, paused: bool = False,
         record: Optional[FilePath] = None, shield: Optional[Shield] = None) -> Window:
    """Opens a page in the browser on running worlds, and returns the Window, whose address it prints.

        window = redman.view(pool)                    # follows pool.step(): look, pause, step, pull, lead, act by hand
        redman.view(policy)                           # or a run, a run folder, "grasp", "press.task", a redman.Task
        redman.train("grasp", view=True)              # the policy as it is after each epoch

    A pool runs at its own pace until a browser looks; then in real time, and it waits in step() while the page is paused. Nothing
    changes in worlds that nobody touches. A policy, a run or a task is shown by worlds of the command `redman view`, with all that
    its page can do: go back, options, the shield, demonstrations. For a task or costs in Python, this process plays it.

    policy: what acts in the task, "trained" for the bundled one. seed: of the worlds that are made. port: of the page; 0: a free one.
    paused: whether it begins paused. num_envs: worlds side by side, at most 64; of a pool, from env on.
    record: the .npz file that the page's button *record* writes: whole episodes of the watched world as somebody played them,
    which train(from_=...) takes. Without it worlds of the command write demonstration.npz, and a pool's page has no such button.
    shield: of a pool, a redman.Shield of it: the page has a button that puts the program's actions, and those by hand, through it.
    browser: whether to open the browser of the desktop. The page is at 127.0.0.1 alone, behind a random address; see the manual,
    A window on running worlds.
    """
    page = Page(browser, port, paused, record, shield)
    if shield is not None and (not isinstance(shown, Pool) or shield.pool is not shown):
        raise ArgumentError("shield: it is not a shield of this pool; worlds of the command redman have one of their own")
    if isinstance(shown, Pool):
        if policy is not None or options:
            raise UsageError("view: policy and options cannot be given with a pool, which has its own")
        return PoolWindow(shown, env, _worlds(shown, env, num_envs), "python", page=page)
    if isinstance(shown, Run):
        shown = shown.policy
    if isinstance(shown, (str, os.PathLike)) and not is_file("task", shown) and Path(shown).exists():
        shown = Policy.load(shown)
    task: Optional[TaskName] = None
    if not isinstance(shown, Policy):
        task = wanted = shown
        if policy is None or isinstance(policy, str) and policy in ("zero", "hold", "random", "demo"):
            return _of_tool(wanted, [policy or "hold"], num_envs, seed, options, page)
        shown = policy_of(policy, wanted)
    elif policy is not None:
        raise UsageError("view: give the task first and the policy as policy=")
    return _of_policy(shown, task, num_envs, seed, options, page)


def _flags(num_envs: Optional[int], seed: int, options: Optional[Mapping[str, Any]]) -> list[str]:
    words = ["--envs", str(num_envs or 1), "--seed", str(seed)]
    for key, value in named_options(options or {}).items():
        words += ["--set", f"{key}={option_text(key, value)}"]
    return words


def _knows(task: str) -> bool:
    """Whether the tool has a task of that name, which this process may have registered for itself."""
    tool = tool_path()
    return tool is None or subprocess.run([tool, "tasks", task], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                          stdin=subprocess.DEVNULL, check=False).returncode == 0


def _of_tool(task: TaskName, policies: Sequence[str], num_envs: Optional[int], seed: int, options: Optional[Options],
             page: Page) -> Window:
    if isinstance(task, (str, os.PathLike)) and is_file("task", task):
        word = os.fspath(task)
    else:
        word = task_name(task)
        if not _knows(word):
            return _hold(task, num_envs, seed, options, page)
    words = [part for each in policies for part in ("--policy", each)]
    return Window(["--task", word, *words, *_flags(num_envs, seed, options)], fed=False, page=page)


def _hold(task: TaskName, num_envs: Optional[int], seed: int, options: Optional[Options], page: Page) -> Window:
    """Worlds of a task in Python, with the hold action."""
    pool = Pool(task, num_envs or 1, seed, autoreset="off", options=options)
    return Playing("hold", pool, actor="hold", page=page).window


def _of_policy(policy: Policy, task: Optional[TaskName], num_envs: Optional[int], seed: int, options: Optional[Options],
               page: Page) -> Window:
    origin = policy.origin
    name = task_name(task) if task is not None else policy.info.task or (origin.task if origin else "")
    if not name:
        raise ArgumentError("view: the task is missing: redman.view(task, policy=policy)")
    if task is None and origin is not None and origin.folder is not None and origin.own is None and _same(policy, origin.folder):
        return Window(["--policy", origin.folder, *_flags(num_envs, seed, options)], fed=False, page=page)
    laid: dict[str, Any] = dict(origin.options) if origin is not None and origin.task == name else {}
    laid.update(options or {})
    if (origin is None or origin.own is None) and _knows(name):
        keep = tempfile.TemporaryDirectory()
        file = Path(keep.name, "policy.rdm")
        policy.save(file)
        word = "trained" if policy._word == "trained" else str(file)
        return Window(["--task", name, "--policy", word, *_flags(num_envs, seed, laid)], fed=False, keep=keep, page=page)
    pool = Pool(task or name, num_envs or 1, seed, autoreset="off", options=singly(laid))
    limits = None if origin is None else origin.cost_limits
    return Playing(policy, pool, actor=policy._word, limits=limits, page=page).window


def _same(policy: Policy, folder: str) -> bool:
    """Whether a folder still holds the policy, and the tool can make its task."""
    try:
        config = json.loads(read_bytes(Path(folder, "config.json"), MOST_JSON))
        return Path(folder, "policy.rdm").read_bytes() == bytes(policy) and "task_class" not in config
    except (OSError, ValueError, Error):
        return False


@atexit.register
def _close_all() -> None:
    for window in list(_open_ones):
        window.close()
