"""Tasks as parallel environments of PettingZoo: a team, one agent for each group of the action.

    import redman.pettingzoo
    env = redman.pettingzoo.ParallelEnv("hand_over_safe_finger")            # agents: right, left
    observations, infos = env.reset(seed=7)
    while env.agents:
        actions = {agent: env.action_space(agent).sample() for agent in env.agents}
        observations, rewards, terminations, truncations, infos = env.step(actions)

All agents get the team's reward. infos[agent] has "cost", the task's own, "costs" [cost_dim] in the order of env.cost_names,
and "success"; with a shield also "applied" (the agent's part of the action that ran), "intervened" and "shield". state() is the
whole observation, which central critics read. An agent observes the fields of its group, in the row's order.

SafeEnv has the same worlds under the names of the multi-agent safe suites: step(actions) gives (observations, share_obs,
rewards, costs, dones, infos, available_actions), lists or arrays with an entry for each agent.

Without PettingZoo ParallelEnv has the same methods over spaces of its own.
"""
from __future__ import annotations

from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from ._defaults import Defaults, defaults
from ._error import ArgumentError
from ._policy import Backup
from ._rows import Array, FloatArray
from ._shield import Shielding
from ._team import Group, groups
from ._worlds import Center, Worlds
from .gym import shielded_of

try:
    from pettingzoo import ParallelEnv as _ParallelEnv
    from gymnasium.spaces import Box
except ImportError as error:
    if getattr(error, "name", None) not in ("pettingzoo", "gymnasium"):  # it is there, and something that it needs is not
        raise
    _ParallelEnv = object
    from ._spaces import Box

__all__ = ["Defaults", "ParallelEnv", "SafeEnv", "defaults"]

Info = dict[str, Any]


class _Team:
    """The worlds of a team, and what each agent observes and does in them."""

    def __init__(self, task: str, groups_of: Optional[str], num_envs: int, autoreset: str, **given: Any) -> None:
        self.worlds = Worlds(task, num_envs, autoreset=autoreset, **given)
        self.groups = groups(self.worlds.pool, groups_of)
        self.named: dict[str, Group] = {group.name: group for group in self.groups}

    def spaces(self, group: Group) -> tuple[Any, Any]:
        """Of observations and of actions."""
        w = self.worlds
        return (Box(w.obs_low[group.columns], w.obs_high[group.columns], dtype=np.float32),
                Box(w.action_low[group.actions], w.action_high[group.actions], dtype=np.float32))

    def shielded(self, i: int, group: Group) -> Info:
        """The entries of infos about the shield in one world: "applied" are the agent's own entries of the action that ran."""
        told = shielded_of(self.worlds, i)
        return {**told, "applied": told["applied"][group.actions]} if told else told

    def row(self, actions: Mapping[str, Any]) -> FloatArray:
        """The actions of all agents of one world as one row."""
        if actions.keys() != self.named.keys():
            raise ArgumentError(f"actions: they must be those of {', '.join(self.named)}, not of {', '.join(actions) or 'nobody'}")
        row = np.empty(self.worlds.pool.action_dim, np.float32)
        for name, group in self.named.items():
            own = np.asarray(actions[name], np.float32)
            wanted = group.actions.stop - group.actions.start
            if own.shape != (wanted,):
                raise ArgumentError(f"actions: those of {name} must have the shape ({wanted},), not {own.shape}")
            row[group.actions] = own
        return row


class ParallelEnv(_ParallelEnv):  # type: ignore[misc,valid-type]
    """One world of a task, with an agent for each group.

        env = redman.pettingzoo.ParallelEnv("hand_over_safe_finger", groups="hands", action_repeat="task")
        observations, infos = env.reset(seed=7)
        while env.agents:
            actions = {agent: env.action_space(agent).sample() for agent in env.agents}
            observations, rewards, terminations, truncations, infos = env.step(actions)
        env.close()

    groups: a set that the task has ("hands", "fingers"), a list "NAME:FIELDS:FIRST-LAST;..." (redman.groups), "all" for one
    agent, or None for the task's first set. render_mode: None or "rgb_array". task, seed, options, action_repeat, center, camera,
    width, height, shield, shield_policy: as those of redman.gym.Env, with its errors; ArgumentError or NotFoundError for a
    set that the task does not have.

    observation_space(agent) and action_space(agent) tell the shapes: [entries of its group] float32 each.
    """

    metadata: dict[str, Any] = {"name": "redman", "render_modes": ["rgb_array"]}

    def __init__(self, task: str, *, groups: Optional[str] = None, seed: Optional[int] = None,
                 options: Optional[Mapping[str, Any]] = None, render_mode: Optional[str] = None, camera: Optional[str] = None,
                 width: int = 320, height: int = 240, action_repeat: Union[int, str] = 1, center: Center = None,
                 shield: Shielding = None, shield_policy: Optional[Backup] = None) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ArgumentError(f"render_mode: it must be None or 'rgb_array', not {render_mode!r}")
        self._team = _Team(task, groups, 1, "off", seed=seed, options=options, action_repeat=action_repeat, center=center,
                           camera=camera, width=width, height=height, shield=shield, shield_policy=shield_policy)
        self.render_mode = render_mode
        self.metadata = {"name": task, "render_modes": ["rgb_array"], "render_fps": max(1, round(1 / self.worlds.seconds))}
        self.possible_agents = [group.name for group in self._team.groups]
        self.agents: list[str] = []
        self._spaces = {group.name: self._team.spaces(group) for group in self._team.groups}
        self.observation_spaces = {name: obs for name, (obs, _) in self._spaces.items()}
        self.action_spaces = {name: action for name, (_, action) in self._spaces.items()}
        self.state_space = Box(self.worlds.obs_low, self.worlds.obs_high, dtype=np.float32)

    @property
    def worlds(self) -> Worlds:
        """The world as redman's pool has it."""
        return self._team.worlds

    @property
    def cost_names(self) -> Sequence[str]:
        """The names of the entries of "costs" in infos; the first is "cost", the task's own."""
        return self.worlds.cost_names

    def observation_space(self, agent: str) -> Any:
        """The space of an agent's observations, a Box. agent: its name, of possible_agents; KeyError for others."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Any:
        """The space of an agent's actions, a Box. agent: its name, of possible_agents; KeyError for others."""
        return self.action_spaces[agent]

    def state(self) -> FloatArray:
        """The whole observation [obs_dim] float32, which central critics read."""
        return np.array(self.worlds.obs[0], np.float32)

    def reset(self, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None) -> tuple[dict[str, Any], dict[str, Info]]:
        """Begins a new episode and returns (observations, infos), dicts with an entry for each agent.

        seed: 0 to 2^64 - 1, the episode of this seed; None: the next of the world's own stream. options: None or an empty
        dict; ArgumentError for others."""
        self.worlds.no_options(options)
        self.worlds.reset(seed if seed is None else [seed])
        self.agents = list(self.possible_agents)
        return self._seen(), {agent: {key: np.zeros_like(value) if isinstance(value, np.ndarray) else type(value)()
                                      for key, value in told.items()} for agent, told in self._told().items()}

    def step(self, actions: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, float], dict[str, bool], dict[str, bool],
                                                        dict[str, Info]]:
        """Makes a step and returns observations, rewards, terminations, truncations and infos, dicts with an entry for each agent;
        the reward, the same for all, is summed over the control steps. After an end env.agents is empty.

        actions: a dict with the action of each agent, [entries of its group] in [-1, 1]; ArgumentError if one is missing or
        has another shape."""
        w = self.worlds
        w.act_alone(self._team.row(actions))
        w.pool.step()
        agents = self.agents
        told, terminated, truncated = self._told(), w.terminated.item(0), w.truncated.item(0)
        if terminated or truncated:
            self.agents = []
        return (self._seen(), dict.fromkeys(agents, w.reward.item(0)), dict.fromkeys(agents, terminated),
                dict.fromkeys(agents, truncated), {agent: told[agent] for agent in agents})

    def render(self) -> Optional[Array]:
        """A picture [height][width][3] uint8; None without a render_mode."""
        return self.worlds.render(0, "rgb") if self.render_mode else None

    def close(self) -> None:
        """Destroys the world; nothing else may be called afterwards."""
        self.worlds.close()

    def _seen(self) -> dict[str, FloatArray]:
        row = self.worlds.obs[0]
        return {name: row[group.columns] for name, group in self._team.named.items()}

    def _told(self) -> dict[str, Info]:
        w = self.worlds
        return {name: {"cost": w.cost.item(0, 0), "costs": w.cost[0].copy(), "success": w.success.item(0), **self._team.shielded(0, group)}
                for name, group in self._team.named.items()}


class SafeEnv:
    """num_envs worlds of a task as the multi-agent safe suites see them: agents by number, arrays [num_envs][agents][...].

        env = redman.pettingzoo.SafeEnv("hand_over_safe_finger", 4, seed=7)
        obs, share_obs, _ = env.reset()
        for _ in range(20):
            actions = [np.array([space.sample() for _ in range(4)]) for space in env.action_space]      # of each agent [4][its entries]
            obs, share_obs, rewards, costs, dones, infos, _ = env.step(actions)
        env.close()

    task, groups: as those of ParallelEnv. num_envs: worlds, 1 or more. threads: that step them; 0: as many as there are cores.
    seed: 0 to 2^64 - 1, of the first reset, seed + i for world i. options: of the task. action_repeat, center: as those of
    redman.gym.Env, but here the defaults are those of the task's own learner. shield, shield_policy: as those of redman.gym.Env.
    Errors are those of ParallelEnv.
    An agent that observes less than another has zeros behind its entries, so that all rows of obs have one width. Worlds restart by
    themselves: the observation after an end is that of the next episode.
    """

    def __init__(self, task: str, num_envs: int = 1, *, groups: Optional[str] = None, seed: Optional[int] = None,
                 options: Optional[Mapping[str, Any]] = None, threads: int = 0, action_repeat: Union[int, str] = "task",
                 center: Center = "initial", shield: Shielding = None, shield_policy: Optional[Backup] = None) -> None:
        self._team = _Team(task, groups, num_envs, "same_step", seed=seed, options=options, threads=threads,
                           action_repeat=action_repeat, center=center, shield=shield, shield_policy=shield_policy)
        w, team = self._team.worlds, self._team.groups
        self.num_envs, self.num_agents, self.n_agents = num_envs, len(team), len(team)
        self._width = max(len(group.columns) for group in team)
        self._most = max(group.actions.stop - group.actions.start for group in team)
        spaces = [self._team.spaces(group) for group in team]
        padded = np.full(self._width, np.inf, np.float32)
        self.observation_space = [Box(-padded, padded, dtype=np.float32) for _ in team]
        self.share_observation_space = [Box(w.obs_low, w.obs_high, dtype=np.float32) for _ in team]
        self.action_space = [action for _, action in spaces]

    @property
    def worlds(self) -> Worlds:
        """The worlds as redman's pool has them."""
        return self._team.worlds

    def reset(self, seed: Optional[int] = None) -> tuple[FloatArray, FloatArray, None]:
        """Begins new episodes everywhere and returns obs [num_envs][agents][width], share_obs [num_envs][agents][obs_dim], and None:
        every action is available. width: of the widest agent's observation. seed: 0 to 2^64 - 1, seed + i for world i; None:
        the next of the worlds' own streams."""
        self.worlds.reset(seed)
        return (*self._looked(), None)

    def step(self, actions: Sequence[Any]) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, Array, list[list[Info]], None]:
        """Makes a step and returns obs and share_obs as reset does, rewards and costs [num_envs][agents][1], the same for all agents and
        summed over the control steps, dones [num_envs][agents], infos [num_envs][agents] and None.

        actions: for each agent an array [num_envs][its entries] in [-1, 1]; ArgumentError for another number or shape. A cost
        is the task's own, column 0; infos have all of them, "costs" [cost_dim], and with a shield what it did."""
        w, team = self.worlds, self._team.groups
        if len(actions) != len(team):
            raise ArgumentError(f"actions: give those of {len(team)} agents, not of {len(actions)}")
        rows = np.empty((self.num_envs, w.pool.action_dim), np.float32)
        for group, own in zip(team, actions):
            wanted = (self.num_envs, group.actions.stop - group.actions.start)
            if np.shape(own) != wanted:
                raise ArgumentError(f"actions: those of {group.name} must have the shape {wanted}, not {np.shape(own)}")
            rows[:, group.actions] = own
        w.act(rows)
        w.pool.step()

        def each(column: Array) -> FloatArray:
            return np.repeat(column.astype(np.float32).reshape(-1, 1, 1), len(team), axis=1)

        ended = w.terminated | w.truncated
        infos = [[{"success": bool(w.success[i]), "truncated": bool(w.truncated[i]), "costs": w.cost[i].copy(),
                   **self._team.shielded(i, group)} for group in team] for i in range(self.num_envs)]
        return (*self._looked(), each(w.reward), each(w.cost[:, 0]), np.repeat(ended.reshape(-1, 1), len(team), axis=1), infos,
                None)

    def close(self) -> None:
        """Destroys the worlds; nothing else may be called afterwards."""
        self.worlds.close()

    def _looked(self) -> tuple[FloatArray, FloatArray]:
        rows, team = self.worlds.obs, self._team.groups
        obs = np.zeros((self.num_envs, len(team), self._width), np.float32)
        for i, group in enumerate(team):
            obs[:, i, :len(group.columns)] = rows[:, group.columns]
        return obs, np.repeat(rows[:, None, :], len(team), axis=1)
