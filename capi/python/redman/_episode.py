"""Episode: an episode of one world as it was played, to look at."""
from __future__ import annotations

import contextlib
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Optional, Union

import numpy as np

from . import _png
from ._error import ArgumentError, Error, StateError, UnsupportedError
from ._feed import Feed, follow
from ._files import as_path
from ._film import film
from ._html import player
from ._library import instance, int32, whole
from ._names import Hinted, nearest, one_of
from ._rows import Array
from ._tool import run_tool

if TYPE_CHECKING:
    from ._own_costs import Own
    from ._pool import Pool

_PAGES, _FILMS = {".html": "--html", ".glb": "--glb"}, (".mp4", ".gif")
_ENDINGS = (*_PAGES, ".png", *_FILMS)


def ending_of(path: Union[str, os.PathLike[str]]) -> str:
    """The ending of a file that render() can write."""
    ending = as_path(path).suffix.lower()
    if ending not in _ENDINGS:
        raise ArgumentError(f"render: {as_path(path).name!r} ends in none of {', '.join(_ENDINGS)}{nearest(ending, _ENDINGS)}")
    return ending


class Episode(Hinted):
    """An episode of one world, as it was played: draws itself in a notebook as a 3D player above its reward and costs.

        episode = policy.episode(seed=7)            # plays one
        episode.render("throw.html")                # .html, .glb, .png, .mp4 or .gif

        with pool.record() as episode:              # records what you do with a pool
            for _ in range(75):
                pool.step(actor())

    frames: how many moments it has, the first one included. env: the number of the world in its pool. actor, limits, own,
    shield and seed: what the page says of the policy, the limits, functions of rewards and costs, and the shield. camera, of
    the methods: a name of cameras; None: "close", else the first. path: of the file.
    """

    _hints = {"save": 'render("throw.html")', "show": "an episode draws itself in a notebook; render(\"throw.html\") writes a page",
              "play": "an episode draws itself in a notebook"}

    task: str
    cameras: list[str]

    def __init__(self, pool: Pool, env: int = 0, *, actor: str = "python", limits: Optional[Mapping[str, Optional[float]]] = None,
                 own: Optional[Own] = None, shield: str = "", seed: Optional[int] = None) -> None:
        from ._pool import Pool
        env = whole(env, "env", 0, instance(pool, Pool, "pool").num_envs - 1)
        self._feed = Feed(pool, env, 1, actor=actor, limits=limits, own=own, shield=shield, seed=seed)
        self._env, self._config = env, dict(pool._config)
        self._seconds = float(pool.control_dt) * pool.spec.action_repeat
        self._moments = pool.max_steps
        self.task = pool.task.name
        self.cameras = list(pool.task.cameras)
        self.clear()

    def clear(self) -> None:
        """Forgets all frames; the next one begins an episode."""
        self._scene, self._frames = b"", [b""][:0]
        self._states: list[bytes] = []
        self._pages: dict[str, str] = {}

    @property
    def frames(self) -> int:
        """Number of frames, the first one included."""
        return len(self._frames)

    def add(self, stepped_in: Optional[Array] = None) -> None:
        """Adds the world as it is now. stepped_in [num_envs]: where a shield changed the decision; None: nowhere."""
        if not self._frames:
            self._scene = self._feed.scene()
        self._frames.append(self._feed.frame(self._env, cloud=False, stepped_in=stepped_in))
        self._states.append(self._feed.pool.state(self._env))
        self._pages.clear()

    def camera(self, camera: Optional[str] = None) -> str:
        """The name of a camera; None: "close" where the task has it, else its first."""
        if camera is None:
            return "close" if "close" in self.cameras else self.cameras[0] if self.cameras else ""
        return one_of(camera, dict(zip(self.cameras, self.cameras)), "camera")

    def render(self, path: Union[str, os.PathLike[str]], *, camera: Optional[str] = None, width: int = 640, height: int = 480,
               step: Optional[int] = None, strip: int = 6, look: str = "fine") -> None:
        """Writes a file of the episode, of the kind of its ending: .html, a page in 3D for a browser; .glb, an animation for 3D
        viewers; .png, `strip` moments side by side, or the moment of one control step; .mp4 or .gif, a film.

        Pages are written by the command `redman`, films by the program ffmpeg. camera: name of a camera of the task; None: "close",
        else the first. width, height: pixels of a picture or film. step: the control step that a .png shows; None: `strip` moments.
        look: "fine" as for people, "plain" as observations look."""
        ending, view = ending_of(path), self.camera(camera)
        if not self._frames:
            raise StateError("render: the episode has no frames yet")
        if ending in _PAGES:
            self._page(Path(path), view)
        elif ending in _FILMS:
            film(Path(path), self.pictures(range(self.frames), view, width, height, look), 1 / self._seconds)
        else:
            if step is not None and not 0 <= int32(step, "step") < self.frames:
                raise ArgumentError(f"step: {step} is not between 0 and {self.frames - 1}")
            moments = self.moments(strip) if step is None else [step]
            Path(path).write_bytes(_png.row(list(self.pictures(moments, view, width, height, look))))

    def moments(self, count: int) -> list[int]:
        """`count` control steps, 1 or more, at even distances from the first to the last."""
        if int32(count, "strip") < 1:
            raise ArgumentError(f"strip: {count} is less than 1")
        return sorted({round(k * (self.frames - 1) / max(1, count - 1)) for k in range(count)})

    def pictures(self, steps: Any, camera: Optional[str] = None, width: int = 640, height: int = 480,
                 look: str = "fine") -> Iterator[Array]:
        """Pictures [height][width][3] of these control steps, one after the other; look: as in render."""
        from ._pool import Pool
        view = self.camera(camera)
        own: dict[str, Any] = {**self._config, "num_envs": 1, "threads": 0, "ranks": None, "autoreset": "off"}
        with Pool(**own) as pool:
            for step in steps:
                pool.set_state(self._states[step], 0)
                yield pool.render(camera=view or None, width=width, height=height, look=look)

    def _page(self, path: Path, camera: str) -> None:
        """Has the tool write a page or an animation."""
        with tempfile.TemporaryDirectory() as folder:
            feed = Path(folder, "episode")
            feed.write_bytes(b"".join([self._scene, *self._frames]))
            run_tool("render", "--feed", str(feed), "--camera", camera, _PAGES[path.suffix.lower()], str(path),
                     why=f"a {path.suffix.lower()} file")

    def page(self, camera: Optional[str] = None) -> str:
        """The page of the episode, as render("throw.html") writes it."""
        view = self.camera(camera)
        if view not in self._pages:
            with tempfile.TemporaryDirectory() as folder:
                self._page(Path(folder, "episode.html"), view)
                self._pages[view] = Path(folder, "episode.html").read_text(encoding="utf-8")
        return self._pages[view]

    def _repr_html_(self) -> Optional[str]:
        """The player, for a notebook; pictures where there is no tool that writes it."""
        try:
            return player(self.page(), self.task)
        except (ArgumentError, UnsupportedError):
            return None

    def _repr_png_(self) -> Optional[bytes]:
        """Six moments side by side, where the player cannot be shown."""
        try:
            return _png.row(list(self.pictures(self.moments(6), None, 240, 180)))
        except Error:
            return None

    def __repr__(self) -> str:
        return f"<Episode of {self.task}: {self.frames} frames>"


@contextlib.contextmanager
def record(pool: Pool, env: int, actor: str) -> Iterator[Episode]:
    """Pool.record."""
    episode = Episode(pool, env, actor=actor)
    over = [False]

    def after(reset: bool) -> None:
        if reset:
            episode.clear()
            over[0] = False
        if over[0]:
            return
        ended = bool(pool.terminated[env] or pool.truncated[env])
        over[0] = ended
        if not (ended and pool.autoreset == "same_step"):  # else the next episode is what can be seen
            episode.add()

    end = follow(pool, lambda: None, after)
    try:
        if pool._begun:
            episode.add()
        yield episode
    finally:
        end()


def played(pool: Pool, player_: Any, *, actor: str, limits: Optional[Mapping[str, Optional[float]]], own: Optional[Own], steps: Optional[int],
           shield: Any = None) -> Episode:
    """An episode of world 0 of a pool that was just reset; the pool's autoreset is off."""
    from ._play import _Plays
    episode = Episode(pool, 0, actor=actor, limits=limits, own=own, shield="" if shield is None else "on")
    plays = _Plays(player_, pool, shield=shield)
    episode.add()
    nothing = np.zeros(pool.num_envs, np.bool_)
    while not (pool.terminated[0] or pool.truncated[0]) and (steps is None or episode.frames <= steps):
        plays.act()
        pool.step()
        if own is not None:
            reward, cost = own.look(pool)
            episode._feed.looked(reward.astype(np.float64), cost.astype(np.float64), nothing)
        episode.add(plays.stepped_in if shield is not None else None)
    return episode
