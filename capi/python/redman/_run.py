"""Run: what was learned, and how."""
from __future__ import annotations

import html
import os
from pathlib import Path
from typing import Any, Callable, Mapping, Optional, Union

from ._agent import Agent
from ._curve import Curve
from ._episode import Episode
from ._error import Error, UsageError
from ._html import number
from ._names import Hinted
from ._options import Told, Value
from ._own_costs import Own
from ._play import Evaluation, evaluate
from ._policy import Backup, Policy
from ._run_folder import FolderPath, read_progress
from ._shield import Shielding


class Run(Hinted):
    """A training run: policy (the best one within the limits), curve, agent (its last state), folder, env_steps, seconds.

        run = redman.train("ball_run", steps=1e6, out="runs/first")
        run = redman.Run.load("runs/first")             # in another process
        run = run.resume(steps=2e6)                     # continues in its folder
    """

    _draws = "run.curve and run.policy draw themselves in a notebook; run.curve.save('curve.svg') writes the curve"
    _hints = {
        "model": "run.policy, or run.agent", "history": "run.curve",
        "returns": "run.curve.returns", "costs": "run.curve.costs"}

    task: str
    algo: str
    seed: int
    options: Mapping[str, Value]
    cost_limits: dict[str, Optional[float]]  # of all costs by name, None where there is none
    folder: Optional[Path]
    env_steps: int = 0
    seconds: float = 0.0
    interrupted: bool = False  # it has fewer steps than it was to have

    def __init__(self, task: str, algo: str, seed: int, options: Mapping[str, Value], cost_limits: Mapping[str, Optional[float]],
                 policy: Policy, agent: Callable[[], Agent], folder: Optional[Path] = None, own: Optional[Own] = None,
                 settings: Mapping[str, str] = {}) -> None:
        self.task, self.algo, self.seed = task, algo, seed
        self.options, self.cost_limits = Told(options, "redman.train(task, options={...})"), dict(cost_limits)
        self.folder, self._policy = folder, policy
        self._judged: Optional[tuple[Policy, Evaluation]] = None
        self._own, self._settings = own, settings  # the latter of its curve
        self._agent: Union[Agent, Callable[[], Agent]] = agent
        self._rows: dict[str, list[float]] = {}

    def _read_progress(self, folder: Path) -> None:
        self._rows = read_progress(folder)

    @property
    def agent(self) -> Agent:
        """The learner as it is now. For a run that was loaded, it is read from the checkpoint."""
        if not isinstance(self._agent, Agent):
            self._agent = self._agent()
        return self._agent

    @property
    def name(self) -> str:
        """Task, algorithm and seed: exp_name of config.json."""
        return f"{self.task}-{self.algo}-seed-{self.seed}"

    @property
    def curve(self) -> Curve:
        """Progress of the epochs."""
        return Curve(self._rows, f"{self.task} {self.algo} seed {self.seed}", next(iter(self.cost_limits.values()), None),
                     str(self.folder or ""), f"{self.task} {self.algo}", self.seed, self._settings)

    @property
    def epochs(self) -> list[dict[str, float]]:
        """The rows of the curve, one for each epoch."""
        return [dict(zip(self._rows, row)) for row in zip(*self._rows.values())]

    @property
    def policy(self) -> Policy:
        """The policy that was kept: the best within the limits, else the one nearest to them."""
        return self._policy

    best = policy

    @property
    def config(self) -> dict[str, Any]:
        """The settings of the run: task, algo, seed, the options of the task and of the learner, limits by the names of costs,
        and the import paths of rewards and costs of your own."""
        return {"task": self.task, "algo": self.algo, "seed": self.seed, "options": dict(self.options),
                "agent_options": self.agent.options, "cost_limits": dict(self.cost_limits),
                **({} if self._own is None else self._own.config())}

    def plot(self) -> Curve:
        """The curve, which a notebook draws when it is the last line of a cell; elsewhere use run.curve.save("curve.svg")."""
        return self.curve

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the policy file at path; train(..., out="runs/first") writes a whole run folder."""
        self.policy.save(path)

    @classmethod
    def load(cls, folder: FolderPath) -> Run:
        """Reads a run folder, of redman.train or of the command `redman train`: its policy, curve and settings."""
        from ._train import loaded_run
        return loaded_run(folder)

    def resume(self, steps: Optional[float] = None, **settings: Any) -> Run:
        """Continues the run in its folder, as redman.train(resume=run.folder, steps=steps, ...)."""
        from ._train import train
        if self.folder is None:
            raise UsageError("resume: the run has no folder: train(..., out=\"runs/first\") makes one")
        resumed: Run = train(resume=self.folder, steps=steps, **settings)
        return resumed

    def evaluate(self, episodes: int = 100, num_envs: int = 16, seed: int = 0, threads: Optional[int] = None, *,
                 shield: Shielding = None, shield_policy: Optional[Backup] = None) -> Evaluation:
        """Evaluates the policy on episodes that were not used to choose it: those of `redman.evaluate(folder)` and of
        `redman eval --policy FOLDER`. The report at the end of `redman train` uses seed=run.seed + 1_000_000. num_envs: worlds that
        play side by side; threads: None uses all cores; the episodes depend on neither the latter nor the machine. shield,
        shield_policy: as in redman.evaluate."""
        return evaluate(self.policy, episodes=episodes, num_envs=num_envs, seed=seed, threads=threads, shield=shield,
                        shield_policy=shield_policy)

    def episode(self, **settings: Any) -> Episode:
        """Plays an episode of its policy: Policy.episode."""
        return self.policy.episode(**settings)

    def render(self, path: Union[str, os.PathLike[str]], **settings: Any) -> None:
        """Plays an episode of its policy and writes it to the file at path: .html, .glb, .png, .mp4 or .gif (Policy.render)."""
        self.policy.render(path, **settings)

    def judged(self) -> Evaluation:
        """evaluate() with its defaults, played once for each policy: what a notebook and redman.compare show."""
        if self._judged is None or self._judged[0] is not self.policy:
            self._judged = self.policy, self.evaluate()
        return self._judged[1]

    def _repr_svg_(self) -> str:
        return self.curve._repr_svg_()

    def _repr_html_(self) -> str:
        """An episode in 3D, the curve, and its evaluation, for a notebook."""
        limits = ", ".join(f"{name} {number(limit)}" for name, limit in self.cost_limits.items() if limit is not None)
        facts = [f"<b>{html.escape(self.task)}</b>, {html.escape(self.algo)}, seed {self.seed}", f"{self.env_steps:,} control steps in {self.seconds:.0f} s"]
        facts += [f"limits: {html.escape(limits)}"] if limits else []
        parts = [f"<p>{'; '.join(facts)}</p>", self.policy._repr_html_() or "", f"<div>{self.curve._repr_html_()}</div>"]
        try:
            parts.append(self.judged()._repr_html_())
        except Error as error:  # what it learned by is not here, as a lambda
            parts.append(f"<p>{html.escape(str(error))}</p>")
        return "".join(parts)

    def __repr__(self) -> str:
        return f"<Run {self.task} {self.algo} seed {self.seed}: {self.env_steps} steps in {self.seconds:.0f} s>"

