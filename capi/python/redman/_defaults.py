"""A task's settings for learning, in the terms of learners other than redman's own."""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Optional

from ._discovery import algos
from ._pool import Pool
from ._rows import FloatArray


@dataclass(frozen=True)
class Defaults:
    """Settings with which redman's own PPO-Lagrangian learns a task; a learner steps at its rate of decisions.

        d = redman.gym.defaults("ball_run")
        print(d.action_repeat, d.discount, d.hidden, d.cost_limit)

    task: its name. action_repeat: control steps of a decision. center: [action_dim] in [-1, 1], the pose that a new policy
    commands. init_std: standard deviation of a new policy's actions about it. discount: of a decision, in [0, 1]. gae_lambda: in
    [0, 1]. cost_limit: on the sum of "cost" over an episode, None without one; cost_limits: of every cost that has one, by
    name. normalize_obs: by running mean and deviation; obs_clip: the bound on them then. hidden: widths of the networks' hidden
    layers. activation: "tanh", "elu" or "relu". num_envs: worlds. horizon: decisions of each world from one update to the next.
    episode: decisions of a whole episode. passes: over the data of an update; minibatches: of each pass. learning_rate: of both
    networks. kl_target: of an update, nats. clip: of the probability ratio. max_grad_norm: largest norm of a gradient. trust_kl: of a step
    that a trust region bounds, nats. multiplier_lr: of the Lagrange multiplier, per update and unit of cost over the limit.
    """

    task: str
    action_repeat: int  # control steps of a decision
    center: FloatArray  # [action_dim] the pose that a new policy commands
    init_std: float  # of a new policy's actions about it
    discount: float  # of a decision: the task's per control step, to the power of action_repeat
    gae_lambda: float
    cost_limit: Optional[float]  # on the sum of "cost" over an episode
    cost_limits: Mapping[str, float]  # of every cost that has one
    normalize_obs: bool  # by running mean and deviation
    obs_clip: float  # bound on them then
    hidden: tuple[int, ...]  # widths of the networks' hidden layers
    activation: str  # "tanh", "elu" or "relu"
    num_envs: int
    horizon: int  # decisions of each world from one update to the next
    episode: int  # decisions of a whole episode
    passes: int  # over the data of an update
    minibatches: int  # of each pass
    learning_rate: float
    kl_target: float  # of an update
    clip: float  # of the probability ratio
    max_grad_norm: float
    trust_kl: float  # of a step that a trust region bounds
    multiplier_lr: float  # of the Lagrange multiplier, per update and unit of cost over the limit


def defaults(task: str, options: Optional[Mapping[str, Any]] = None) -> Defaults:
    """The settings for learning of a task, a Defaults.

        d = redman.gym.defaults("ball_run", {"max_steps": 100})

    task: its name. options: of the task, a dict; None: its defaults. NotFoundError for a task or an option that does not exist.
    """
    with Pool(task, options=options) as pool:
        own = pool.task.defaults
        options_of = {**algos()["trpo_lag"].options, **algos()["ppo_lag"].options}
        known = {key: own.get(f"ppo_lag:{key}", own.get(key, option.default)) for key, option in options_of.items()}
        limits = {name: cost.limit for name, cost in pool.costs.items() if cost.limit is not None}
        center, steps = pool.initial_mean, pool.max_steps
    repeat = int(known["action_repeat"])
    limit = limits.get("cost")
    scale = limit if _flag(known["multiplier_normalized"]) and limit else 1.0
    return Defaults(
        task=task, action_repeat=repeat, center=center, init_std=float(known["init_std"]),
        discount=float(known["discount"]) ** repeat, gae_lambda=float(known["lambda"]), cost_limit=limit,
        cost_limits=limits, normalize_obs=_flag(known["normalize_obs"]), obs_clip=float(known["obs_clip"]),
        hidden=tuple(int(width) for width in str(known["hidden"]).split(",") if width), activation=str(known["activation"]),
        num_envs=64, horizon=int(known["horizon"]), episode=-(-steps // repeat), passes=int(known["passes"]),
        minibatches=int(known["minibatches"]), learning_rate=float(known["learning_rate"]),
        kl_target=float(known["kl_target"]), clip=float(known["clip"]), max_grad_norm=float(known["max_grad_norm"]),
        trust_kl=float(known["trust_kl"]), multiplier_lr=float(known["multiplier_lr"]) / scale)


def _flag(value: Any) -> bool:
    return value if isinstance(value, bool) else str(value) in ("1", "true", "on", "yes", "1.0")
