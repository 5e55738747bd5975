"""What the adapters take from Stable-Baselines3, OmniSafe and Safety-Gymnasium, and pyarrow, as small as their contracts allow, for
where none of them is installed. Each function does nothing where the real one is."""
import sys
import types

import numpy as np

import peers
from redman import _spaces


def _missing(name):
    return name not in sys.modules and not peers.installed(name)


def _module(name, **names):
    parent, _, leaf = name.rpartition(".")
    module = sys.modules[name] = types.ModuleType(name)
    module.__path__ = []
    vars(module).update(names)
    if parent:
        if parent not in sys.modules:
            _module(parent)
        setattr(sys.modules[parent], leaf, module)


def gymnasium():
    """Spaces and a registry."""
    if _missing("gymnasium"):
        _module("gymnasium.spaces", Box=_spaces.Box, Dict=_spaces.Dict)
        _module("gymnasium.envs.registration", registry={})


def sb3():
    """The base of vectorised environments."""
    if not _missing("stable_baselines3"):
        return
    gymnasium()

    class VecEnv:
        def __init__(self, num_envs, observation_space, action_space):
            self.num_envs, self.observation_space, self.action_space = num_envs, observation_space, action_space
            self.metadata = {"render_modes": []}
            self._reset_seeds()
            self._reset_options()

        def _reset_seeds(self):
            self._seeds = [None] * self.num_envs

        def _reset_options(self):
            self._options = [{}] * self.num_envs

        def seed(self, seed):
            self._seeds = [seed + i for i in range(self.num_envs)]

        def step(self, actions):
            self.step_async(actions)
            return self.step_wait()

        def _get_indices(self, indices):
            return range(self.num_envs) if indices is None else [indices] if isinstance(indices, int) else indices

    class BaseCallback:
        pass

    _module("stable_baselines3.common.vec_env", VecEnv=VecEnv)
    _module("stable_baselines3.common.callbacks", BaseCallback=BaseCallback)
    _module("stable_baselines3.common.monitor", Monitor=type("Monitor", (), {}))


def safety():
    """A place to register."""
    if _missing("safety_gymnasium"):
        gymnasium()
        _module("safety_gymnasium", register=lambda **row: sys.modules["gymnasium.envs.registration"].registry.update(
            {row["id"]: row}))


class Tensor(np.ndarray):
    """A tensor is an array."""

    detach = cpu = lambda self: self

    def numpy(self):
        return self.view(np.ndarray)


def omnisafe():
    """CMDP, the registry of its classes, and tables of settings."""
    if _missing("torch"):
        _module("torch", device=str, float32=np.float32, from_numpy=lambda x: x.view(Tensor), zeros=lambda *shape: np.zeros(shape, np.float32).view(Tensor),
                tensor=lambda x, dtype=None, device=None: np.array(x, dtype).view(Tensor))
    if not _missing("omnisafe"):
        return
    gymnasium()

    class CMDP:
        need_evaluation = True

        def __init__(self, env_id):
            assert env_id in self._support_envs

        observation_space = property(lambda self: self._observation_space)
        action_space = property(lambda self: self._action_space)
        metadata = property(lambda self: self._metadata)
        num_envs = property(lambda self: self._num_envs)

    class Registry(list):
        register, unregister = list.append, lambda self, kind: self.remove(kind)

    class NaturalPG:
        pass

    class Settings(dict):
        def todict(self):
            return self

    isaac = type("SafetyIsaacGymEnv", (CMDP,), {})
    on_policy = {
        "train_cfgs": {"vector_env_nums": 1, "total_steps": 1}, "env_cfgs": {},
        "algo_cfgs": dict.fromkeys(("steps_per_epoch", "update_iters", "batch_size", "target_kl", "gamma", "cost_gamma",
                                    "lam", "lam_c", "clip", "max_grad_norm", "obs_normalize", "steps_per_epoch")),
        "model_cfgs": {"exploration_noise_anneal": False, "std_range": [0.5, 0.1],
                       "actor": dict.fromkeys(("hidden_sizes", "activation", "lr")),
                       "critic": dict.fromkeys(("hidden_sizes", "activation", "lr"))},
        "lagrange_cfgs": dict.fromkeys(("cost_limit", "lambda_lr", "lambda_optimizer"))}
    _module("omnisafe.algorithms", ALGORITHM2TYPE={"PPOLag": "on-policy"},
            registry=types.SimpleNamespace(get={"PPOLag": object}.get))
    _module("omnisafe.algorithms.on_policy", NaturalPG=NaturalPG)
    _module("omnisafe.envs.core", CMDP=CMDP, ENV_REGISTRY=Registry([isaac]))
    _module("omnisafe.envs.safety_isaac_gym_env", SafetyIsaacGymEnv=isaac)
    _module("omnisafe.utils.config", get_default_kwargs_yaml=lambda algo, env_id, kind: Settings(on_policy))


def pyarrow():
    """Tables of numbers, texts and lists of fixed length, in files of numpy's that a real reader of Parquet could not read."""
    if not _missing("pyarrow"):
        return

    class Array:
        def __init__(self, rows):
            self.rows = rows

        def combine_chunks(self):
            return self

        def flatten(self):
            assert self.rows.ndim == 2, "flatten() of a column without lists"
            return Array(self.rows.reshape(-1))

        def to_numpy(self, zero_copy_only=True):
            assert self.rows.ndim == 1, "to_numpy() of lists gives objects"
            return self.rows

    class FixedSizeListArray(Array):
        @classmethod
        def from_arrays(cls, values, list_size):
            return cls(values.rows.reshape(-1, list_size))

    class Table:
        def __init__(self, columns, metadata=None):
            self.columns, self.schema, self.metadata = columns, list(columns), metadata

        column_names = property(lambda self: self.schema)

        def column(self, name):
            return self.columns[name]

        def slice(self, offset, length):
            return Table({name: Array(c.rows[offset:offset + length]) for name, c in self.columns.items()})

        def replace_schema_metadata(self, metadata):
            return Table(self.columns, metadata)

    class ParquetWriter:
        def __init__(self, where, schema):
            self.where, self.schema, self.parts = where, schema, []

        def __enter__(self):
            return self

        def write_table(self, table):
            assert table.schema == self.schema
            self.parts.append(table)

        def __exit__(self, *_):
            rows = {name: np.concatenate([t.columns[name].rows for t in self.parts]) for name in self.schema}
            with open(self.where, "wb") as file:
                np.savez(file, **{str(i): rows[name] for i, name in enumerate(self.schema)}, names=self.schema, groups=len(self.parts))

    def write_table(table, where):
        with ParquetWriter(where, table.schema) as writer:
            writer.write_table(table)

    def read_table(where):
        with np.load(where) as file:
            return Table({name: Array(file[str(i)]) for i, name in enumerate(file["names"].tolist())})

    def array(values):
        rows = np.array(values)
        assert rows.ndim == 1 or isinstance(values, list), "array() of a matrix"
        return Array(rows)

    _module("pyarrow.parquet", ParquetWriter=ParquetWriter, write_table=write_table, read_table=read_table)
    vars(sys.modules["pyarrow"]).update(array=array, table=lambda columns: Table(dict(columns)), FixedSizeListArray=FixedSizeListArray)

