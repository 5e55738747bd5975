"""Policy: the frozen network."""
from __future__ import annotations

import ctypes
import json
import os
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Mapping, Optional, Union

import numpy as np

from . import _abi, _discovery
from ._actor import Actor, on_task
from ._episode import Episode, ending_of
from ._error import ArgumentError, Error, FileError, FormatError, MissingFileError, NotFoundError, UsageError, VersionError
from ._export import export
from ._files import MOST_JSON, as_path, read_bytes, read_whole, write_whole
from ._hold import decided, warn
from ._imported import thing_at
from ._library import Handle, check, filled, flag, instance, lib, policy_folders, raw, text, whole
from ._names import Hinted, nearest
from ._options import Options, Value
from ._own_costs import Own
from ._pool import Pool
from ._rows import Array, FloatArray, array_of, clouds, given, wrong_shape
from ._tensors import Tensors


if TYPE_CHECKING:
    from ._shield import Shielding

_MAGIC = b"RDMPOLIC"
_STARTS = _abi.Rows("uint8", ("rows",))


@dataclass(frozen=True)
class Origin:
    """The run that a policy comes from, by whose settings it is evaluated."""

    task: str
    options: Mapping[str, Value] = field(default_factory=dict)  # of the task
    cost_limits: Mapping[str, float] = field(default_factory=dict)  # of the costs that have one, by name
    magnitudes: bool = False  # costs are sums of cost_raw, and the limits in that unit (option cost_signal=raw)
    folder: Optional[str] = None
    own: Optional[Own] = None  # rewards and costs of your own, in the place of the task's

    @classmethod
    def of_folder(cls, folder: Path) -> Optional[Origin]:
        """The origin from a run folder's config.json; None where there is none."""
        try:
            said = json.loads(read_bytes(folder / "config.json", MOST_JSON))
            own = {member: said[member] for member in ("task", "task_file", "robot_files", "object_files") if member in said}
            functions = Own.of_config(said, f"run {folder}")
            options = dict(pair.split("=", 1) for pair in said["set"])
            limits = {str(name): float(limit) for name, limit in said["cost_limits"].items()}
            magnitudes = said["algo_cfgs"].get("cost_signal") == "raw"
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            raise FileError(f"run {folder}: config.json: {error.strerror}") from None
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise FormatError(f"run {folder}: config.json is not a run's: {error!r}") from None
        if len(own) > 1:
            from ._own_files import load_kept
            load_kept(own, f"run {folder}")
        if "task_class" in said:
            load_task_class(str(said["task"]), str(said["task_class"]), f"run {folder}")
        return cls(own["task"], options, limits, magnitudes and functions is None, str(folder), functions)


def load_task_class(name: str, path: str, where: str) -> None:
    """Registers the class of a task in Python, unless a task of its name is known. A NotFoundError names its module."""
    try:
        _discovery.task(name)
    except NotFoundError:
        kind = thing_at(path, f"{where}: its task {name}")
        if _discovery.task_name(kind) != name:
            raise ArgumentError(f"{where}: its task is {name}, and {path} is {_discovery.task_name(kind)}") from None


# A policy, its file or run folder, or "trained": the one that comes with the task.
Backup = Union["Policy", str, "os.PathLike[str]"]


class Policy(Hinted):
    """Actions for observations; immutable, any number of threads may share it.

        policy = redman.Policy.load("runs/first")          # a run folder, a file, or bytes
        actor = policy.actor(pool)                         # or of an environment
        pool.step(actor())

    A policy decides every policy.info.action_repeat control steps; an actor holds its actions in between. act, and calling
    the policy, make one decision each, and the caller must hold the action. origin is what its run folder says: task,
    options, limits; evaluate and a notebook's picture use them.

    Policy(data) takes the bytes of a file. obs and observation are [n][obs_dim], or [obs_dim] for one world.
    """

    _hints = {
        "predict": "policy.act(obs)", "forward": "policy.act(obs)", "parameters": "policy.tensors",
        "plot": "a policy draws itself in a notebook", "evaluate": "redman.evaluate(policy)",
        "state_dict": "policy.tensors", "task": "policy.info.task", "obs_dim": "policy.info.obs_dim",
        "action_dim": "policy.info.action_dim", "to_bytes": "bytes(policy)"}

    origin: Optional[Origin] = None
    info: _abi.PolicyInfo

    def __init__(self, data: bytes, origin: Optional[Origin] = None) -> None:
        self._bytes = raw(data, "data")
        if self._bytes[:len(_MAGIC)] != _MAGIC:
            raise FormatError("policy: these bytes are not a policy file of redman (.rdm)")
        self.origin = origin
        self._handle = Handle(lib.rdm_policy_read, lib.rdm_policy_destroy, self._bytes, len(self._bytes))
        self.info = _abi.PolicyInfo(filled(_abi.rdm_policy_info, lib.rdm_policy_get_info, self._handle.value))
        self._local = threading.local()
        self._word = "policy"  # what it is called where an episode of it is shown

    @classmethod
    def load(cls, source: Union[str, os.PathLike[str], bytes, bytearray, memoryview]) -> Policy:
        """Loads a source: a policy file, a run folder's policy.rdm, or the bytes of a file. For a file in a run folder, origin
        is set from the run, and the run's own task, robots and objects are loaded from the folder."""
        if isinstance(source, (bytes, bytearray, memoryview)):
            return cls(bytes(source))
        path = as_path(source, "source")
        if path.is_dir() and not (path / "policy.rdm").exists():
            raise MissingFileError(f"policy {path}: no run folder: there is no policy.rdm in it")
        data = read_whole(path / "policy.rdm" if path.is_dir() else path, "policy")
        try:
            policy = cls(data, Origin.of_folder(path if path.is_dir() else path.parent))
            policy._word = os.fspath(source)
            return policy
        except FormatError as error:
            text = str(error)
            raise FormatError(f"policy {path}{text[len('policy'):]}" if text.startswith("policy") else text) from None

    @classmethod
    def trained(cls, task: _discovery.TaskName) -> Policy:
        """The bundled policy of a task, as in `redman eval --policy trained`."""
        name = _discovery.task(task).name
        for folder in policy_folders():
            if (folder / f"{name}.rdm").is_file():
                policy = cls.load(folder / f"{name}.rdm")
                policy._word = "trained"
                return policy
        raise MissingFileError(f"policy of {name}: none in " + ", ".join(str(folder) for folder in policy_folders()))

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the policy file at path, entirely or not at all."""
        write_whole(path, self._bytes, "policy")

    def export(self, path: Union[str, os.PathLike[str]], *, name: Optional[str] = None, int8: bool = False) -> None:
        """Writes the policy for other programs, in the format of the path's ending: .onnx (normaliser, network and clipping
        in one graph), .c (a C99 function that needs no heap and no library), .safetensors, .rdm (as save). Uses the command
        `redman export`.

        name: prefix of the names in the C file; None: the task's name. int8: stores its weights in 8 bits.
        """
        export(self, path, name, int8)

    def __bytes__(self) -> bytes:
        return self._bytes

    def start(self, rows: Optional[int] = None) -> FloatArray:
        """What a policy with a memory remembers before the first decision of an episode: zeros [rows][state_dim], or
        [state_dim] for one world."""
        shape = () if rows is None else (whole(rows, "rows", 0, (1 << 31) - 1),)
        return np.zeros((*shape, self.info.state_dim), np.float32)

    @property
    def groups(self) -> tuple[str, ...]:
        """Names of the groups of a team's policy, in the order of the action; () for a policy of one network."""
        names: list[str] = []
        while (name := lib.rdm_policy_group_name(self._handle.value, len(names))) is not None:
            names.append(text(name))
        return tuple(names)

    def group(self, name: str) -> Policy:
        """The policy of one group alone, by its name in groups: it takes the same observations and gives its own entries of the
        action. Saved, it is a policy file of its own, for the machine that moves this hand."""
        names = self.groups
        if name not in names:
            raise NotFoundError(f"group {name}: unknown{nearest(name, names)}" if names else
                                f"group {name}: the policy is one network and has no groups")
        size = ctypes.c_size_t()
        check(lib.rdm_policy_write_group(self._handle.value, names.index(name), None, 0, ctypes.byref(size)))
        data = ctypes.create_string_buffer(size.value)
        check(lib.rdm_policy_write_group(self._handle.value, names.index(name), data, size.value, ctypes.byref(size)))
        return Policy(data.raw)

    def act(self, obs: Any, noise: Any = None, points: Any = None, point_class: Any = None,
            point_color: Any = None, state: Any = None) -> Any:
        """One decision: clip(mean + std noise, -1, 1) for one observation [obs_dim] or rows [n][obs_dim]; noise None: the mean.

        Hold it for info.action_repeat control steps; in a pool or an environment, actor() does that.
        pool.step(policy.act(pool.obs)) at every step makes a different policy of it, and a HoldWarning says so. A policy that
        reads points needs them too [n][num_points][3], with num_point_classes their classes (point_class [n][num_points]), and
        where it reads colours these (point_color [n][num_points][3]), 0 to 255.

        A policy with a memory (info.state_dim > 0) takes its state too and returns the next one:
        action, state = policy.act(obs, state), from policy.start(rows) on. With noise: policy.act(obs, noise, state=state).
        """
        remembers = self.info.state_dim > 0
        if remembers and state is None:
            state, noise = noise, None
        if remembers and state is None:
            raise ArgumentError("state: it is missing, and this policy has a memory: call action, state = policy.act(obs, state), beginning "
                                "with state = policy.start(rows), or use an actor")
        if not remembers and state is not None and array_of(state, "state").size:
            raise ArgumentError("state: it cannot be given, since this policy has no memory")
        rows_of = _abi.FUNCTIONS["rdm_policy_act"].rows
        observed = array_of(obs, "obs")
        if observed.ndim not in (1, 2) or observed.shape[-1] != self.info.obs_dim:
            raise wrong_shape("obs", observed.shape, f"(rows, {self.info.obs_dim})")
        lengths = {"rows": observed.shape[0] if observed.ndim == 2 else 1, "obs_dim": self.info.obs_dim,
                   "action_dim": self.info.action_dim}
        rows = lengths["rows"]
        action = np.empty((rows, self.info.action_dim), np.float32)
        if rows:
            seen = given(observed, rows_of["obs"], lengths, "obs")
            drawn = None if noise is None else given(noise, rows_of["noise"], lengths, "noise")
            size, scratch = self._scratch(rows)
            noise_at = None if drawn is None else drawn.ctypes.data
            decision = (rows, noise_at, action.ctypes.data, scratch, size)
            if remembers:
                kept = self._state(state, rows)
            if points is None:
                if remembers:
                    check(lib.rdm_policy_act_state(self._handle.value, seen.ctypes.data, kept.ctypes.data, *decision))
                else:
                    check(lib.rdm_policy_act(self._handle.value, seen.ctypes.data, *decision))
            else:
                cloud, held = clouds(points, point_class, point_color, rows)
                if remembers:
                    check(lib.rdm_policy_act_points_state(self._handle.value, seen.ctypes.data, ctypes.byref(cloud),
                                                          kept.ctypes.data, *decision))
                else:
                    check(lib.rdm_policy_act_points(self._handle.value, seen.ctypes.data, ctypes.byref(cloud),
                                                    *decision))
                del held
        done = decided(action if observed.ndim == 2 else action.reshape(-1), self.info.action_repeat)
        if not remembers:
            return done
        if not rows:
            kept = self.start(0)
        return done, kept if observed.ndim == 2 else kept.reshape(-1)

    __call__ = act

    def _state(self, state: Any, rows: int) -> FloatArray:
        """A copy of a state, which the library changes."""
        kept: FloatArray = np.array(array_of(state, "state", np.float32), order="C")
        if kept.size != rows * self.info.state_dim or kept.shape[-1] != self.info.state_dim:
            raise wrong_shape("state", kept.shape, (rows, self.info.state_dim))
        return kept.reshape(rows, self.info.state_dim)

    def sample(self, obs: Any, noise: Any = None) -> tuple[FloatArray, FloatArray]:
        """(action, mean), both [n][action_dim] for rows [n][obs_dim], not clipped, as an agent samples: mean + std noise,
        with standard normal noise [n][action_dim]; None: from numpy's global generator. Agent.put takes such actions."""
        rows_of = _abi.FUNCTIONS["rdm_policy_sample"].rows
        observed = np.atleast_2d(array_of(obs, "obs"))
        if observed.ndim != 2 or observed.shape[1] != self.info.obs_dim:
            raise wrong_shape("obs", np.shape(obs), f"(rows, {self.info.obs_dim})")
        lengths = {"rows": len(observed), "obs_dim": self.info.obs_dim, "action_dim": self.info.action_dim}
        shape = (len(observed), self.info.action_dim)
        drawn = given(np.random.standard_normal(shape) if noise is None else noise, rows_of["noise"], lengths, "noise")
        action, mean = np.empty(shape, np.float32), np.empty(shape, np.float32)
        if len(observed):
            seen = given(observed, rows_of["obs"], lengths, "obs")
            size, scratch = self._scratch(len(observed))
            check(lib.rdm_policy_sample(self._handle.value, seen.ctypes.data, len(observed), drawn.ctypes.data,
                                        action.ctypes.data, mean.ctypes.data, scratch, size))
        return action, mean

    def novelty(self, obs: Any) -> Any:
        """How far an observation [obs_dim], or rows [n][obs_dim], are from those of training: a float, or [n].

        About 1 is the most that training saw, 2 is far from it. UnsupportedError where info.novelty is 0.
        """
        observed = array_of(obs, "obs")
        if observed.ndim not in (1, 2) or observed.shape[-1] != self.info.obs_dim:
            raise wrong_shape("obs", observed.shape, f"(rows, {self.info.obs_dim})")
        rows = observed.shape[0] if observed.ndim == 2 else 1
        seen = given(observed, _abi.FUNCTIONS["rdm_policy_novelty"].rows["obs"],
                     {"rows": rows, "obs_dim": self.info.obs_dim}, "obs")
        novelty = np.empty(rows, np.float32)
        if rows:
            check(lib.rdm_policy_novelty(self._handle.value, seen.ctypes.data, rows, novelty.ctypes.data))
        return novelty if observed.ndim == 2 else float(novelty[0])

    def actor(self, where: Any = None, *, num_envs: Optional[int] = None, action_repeat: int = 1, center: Any = None,
              stochastic: bool = False, seed: int = 0) -> Actor:
        """An Actor that plays this policy in a pool, or in an environment of redman.gym, sb3, safety or omnisafe.

        where: that pool or environment. For worlds of another kind, give their number (num_envs), the control steps of one of their
        steps (action_repeat), and the center that they add to actions. stochastic: samples actions, with noise from the seed that
        is correlated as in training.
        """
        return Actor(self, where, num_envs=num_envs, action_repeat=action_repeat, center=center, stochastic=stochastic,
                     seed=seed)

    def predict(self, observation: Any, state: Any = None, episode_start: Any = None,
                deterministic: bool = True) -> tuple[FloatArray, Any]:
        """Like predict of a Stable-Baselines3 model: returns (action, state); call it once for each control step.

        state contains the actions that are held: pass the one that the last call returned. episode_start [n] says where an
        episode begins. deterministic=False samples with numpy's global generator. In an environment whose step has several
        control steps, or that has a center, use policy.actor(env).predict.
        """
        observed = array_of(observation, "observation")
        if observed.ndim not in (1, 2) or observed.shape[-1] != self.info.obs_dim:
            raise wrong_shape("observation", observed.shape, f"(rows, {self.info.obs_dim})")
        rows = observed.reshape(-1, observed.shape[-1])
        shape = (len(rows), self.info.action_dim)
        if state is None:
            if episode_start is None and self.info.action_repeat > 1:
                self._told_no_state()
            left, action, noise, fresh = np.zeros(len(rows), int), np.zeros(shape, np.float32), np.zeros(
                shape, np.float32), np.ones(len(rows), bool)
            memory = self.start(len(rows))
        else:
            try:
                left, action, noise, fresh, *remembered = (part.copy() for part in state)
            except (TypeError, ValueError, AttributeError):
                raise UsageError(f"state: it must be what the last predict returned, or None, not {state!r}") from None
            memory = remembered[0] if remembered else self.start(len(rows))
            if action.shape != shape:
                raise ArgumentError(f"state: it has {len(action)} rows, but obs has {len(rows)}")
        if episode_start is not None:
            starts = array_of(episode_start, "episode_start", bool)
            begun = given(starts, _STARTS, {"rows": len(rows)}, "episode_start", spread=True).view(bool)
            left[begun], fresh[begun], memory[begun] = 0, True, 0
        due = left == 0
        if due.any():
            drawn = None
            if not flag(deterministic, "deterministic"):
                rho = self.info.noise_correlation
                drawn = np.random.standard_normal(shape).astype(np.float32)
                drawn = np.where(fresh[:, None], drawn, np.float32(rho) * noise + np.float32(np.sqrt(1 - rho * rho)) * drawn)
                noise[due] = drawn[due]
            noise_due = None if drawn is None else drawn[due]
            if self.info.state_dim:
                decision, memory[due] = self.act(rows[due], noise_due, state=memory[due])
                action[due] = np.asarray(decision)
            else:
                action[due] = np.asarray(self.act(rows[due], noise_due))
            left[due], fresh[due] = self.info.action_repeat, False
        left -= 1
        given_back = action.copy() if observed.ndim == 2 else action[0].copy()
        return given_back, (left, action, noise, fresh) + ((memory,) if self.info.state_dim else ())

    def _told_no_state(self) -> None:
        """Warns when a second call has no state: the loop that calls drops it."""
        if getattr(self._local, "began", 0) == 1:
            warn(f"predict: no state was given back, so this policy decides at every step in place of every "
                 f"{self.info.action_repeat}. action, state = policy.predict(obs, state, episode_start)")
        self._local.began = getattr(self._local, "began", 0) + 1

    def _scratch(self, rows: int) -> tuple[int, int]:
        """Size and address of this thread's scratch memory for that many rows."""
        if getattr(self._local, "rows", None) != rows:
            size = lib.rdm_policy_scratch(self._handle.value, rows)
            self._local.memory = np.empty(size, np.uint8)
            self._local.rows, self._local.scratch = rows, (size, self._local.memory.ctypes.data)
        found: tuple[int, int] = self._local.scratch
        return found

    def check(self, pool: Pool) -> None:
        """VersionError, which says what differs, unless the policy fits the pool's task and options."""
        spec = instance(pool, Pool, "pool", "; an environment has one, env.pool")._spec
        with on_task(pool):
            check(lib.rdm_policy_check(self._open(), spec))

    @property
    def columns(self) -> Array:
        """Which entries of a row the policy reads, ascending: all, unless its agent had option actor_obs."""
        out = np.empty(self.info.obs_dim, np.int32)
        count = ctypes.c_size_t()
        check(lib.rdm_policy_get_columns(self._open(), out.ctypes.data, len(out), ctypes.byref(count)))
        return out[:count.value]

    @property
    def fields(self) -> dict[str, _discovery.Field]:
        """What each entry of an observation means, by name; empty where the file does not say."""
        return _discovery.fields_of(self._open(), "the policy", self.info.num_fields, lib.rdm_policy_field_at)

    @property
    def tensors(self) -> Tensors:
        """Weights and normaliser by name, and an example of the network's input and output."""
        return Tensors(self, lib.rdm_policy_tensor_at, lib.rdm_policy_get_tensor)

    def _open(self) -> int:
        assert self._handle.value is not None
        return self._handle.value

    def episode(self, task: Optional[_discovery.TaskName] = None, *, seed: int = 0, options: Optional[Options] = None,
                steps: Optional[int] = None, shield: Shielding = None, shield_policy: Optional[Backup] = None) -> Episode:
        """Plays an episode by the mean action, with the options of the policy's run, and returns it as a redman.Episode, which
        draws itself in a notebook. It is the episode of `redman render` with the same seed. task: another task; options
        override those of the run; steps: at most that many control steps; shield, shield_policy: as in redman.evaluate."""
        from ._play import episode_of
        return episode_of(self, task, seed=seed, options=options, steps=steps, shield=shield, shield_policy=shield_policy)

    def render(self, path: Union[str, os.PathLike[str]], *, task: Optional[_discovery.TaskName] = None, seed: int = 0,
               options: Optional[Options] = None, steps: Optional[int] = None, shield: Shielding = None,
               camera: Optional[str] = None, width: int = 640, height: int = 480, step: Optional[int] = None,
               strip: int = 6) -> None:
        """Plays an episode and writes it to the file at path: .html, .glb, .png, .mp4 or .gif.

        task, seed, options, steps, shield: as in episode. camera: name of a camera of the task; None: "close", else the first.
        width, height: pixels of a picture or film. step: for .png, the control step that is shown; None: `strip` moments of the
        episode side by side.
        """
        ending_of(path)
        self.episode(task, seed=seed, options=options, steps=steps, shield=shield).render(
            path, camera=camera, width=width, height=height, step=step, strip=strip)

    def _shown(self) -> Optional[Episode]:
        """An episode for a notebook; None where the task cannot be created or drawn."""
        if getattr(self, "_kept", None) is None:
            try:
                self._kept: Optional[Episode] = self.episode()
            except Error:
                return None
        return self._kept

    def _repr_html_(self) -> Optional[str]:
        """An episode of its task in 3D, with the options of its run, for a notebook."""
        shown = self._shown()
        return None if shown is None else shown._repr_html_()

    def _repr_png_(self) -> Optional[bytes]:
        """Six moments of that episode; None for a task of your own."""
        shown = self._shown()
        return None if shown is None else shown._repr_png_()

    def __reduce__(self) -> Any:
        return Policy, (self._bytes, self.origin)

    def __deepcopy__(self, _: Any) -> Policy:
        return self  # immutable

    def __repr__(self) -> str:
        i = self.info
        return f"<Policy {i.task or 'of your own task'}: {i.obs_dim} to {i.action_dim}, {i.num_params} parameters>"


def policy_of(policy: Backup, task: _discovery.TaskName, name: str = "policy") -> Policy:
    """A policy as it may be said. name: of the argument."""
    if isinstance(policy, Policy):
        return policy
    if isinstance(policy, str) and policy == "trained":
        return Policy.trained(task)
    if isinstance(policy, (str, os.PathLike)):
        return Policy.load(policy)
    raise UsageError(f'{name}: it must be a redman.Policy, its file or run folder, or "trained", not {policy!r}')
