"""compare: runs of several algorithms or settings beside each other, over seeds."""
from __future__ import annotations

import html
import math
import os
from pathlib import Path
from typing import Any, Iterable, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np

from . import stats
from ._curve import Curve, Curves, differences
from ._error import ArgumentError, UsageError
from ._html import number, pair, share, table
from ._names import Hinted, keywords
from ._play import Evaluation
from ._run import Run

Compared = Union[Run, str, "os.PathLike[str]"]


class ComparisonRow(NamedTuple):
    """What is known of the runs of one name on one task."""

    task: str
    name: str
    runs: int
    return_iqm: float  # interquartile mean over the runs of their mean returns
    return_interval: tuple[float, float]  # of it, by a bootstrap over runs; NaN for a single run
    cost_mean: float  # mean over the runs of their mean cost, column 0
    cost_interval: tuple[float, float]  # of its interquartile mean
    limit: Optional[float]
    within: int  # runs whose policy is within all limits
    success: float  # mean success rate
    group: str  # letters: two rows of a task without a common letter differ (redman.stats.letters)


class Comparison(Hinted):
    """A comparison of runs: curves with bands over seeds, and a table with intervals and groups. Draws itself in a notebook; as a
    text it is the table.

    rows: a record for each name on each task, the best return within the limits first. runs: {name: runs}.
    evaluations: {name: an Evaluation of each run}.
    """

    _hints = {"plot": "curves", "table": "rows; print(comparison) writes the table", "show": "it draws itself in a notebook"}

    runs: dict[str, list[Run]]
    evaluations: dict[str, list[Evaluation]]
    rows: list[ComparisonRow]

    def __init__(self, runs: Mapping[str, Sequence[Run]], evaluations: Mapping[str, Sequence[Evaluation]]) -> None:
        self.runs = {name: list(these) for name, these in runs.items()}
        self.evaluations = {name: list(these) for name, these in evaluations.items()}
        self.rows = [row for task in self.tasks for row in self._rows_of(task)]

    @property
    def tasks(self) -> list[str]:
        """The tasks of the runs."""
        return list(dict.fromkeys(run.task for runs in self.runs.values() for run in runs))

    def _rows_of(self, task: str) -> list[ComparisonRow]:
        judged = {name: [(run, e) for run, e in zip(self.runs[name], self.evaluations[name]) if run.task == task]
                  for name in self.runs}
        judged = {name: each for name, each in judged.items() if each}
        returns = {name: [e.return_mean for _, e in each if math.isfinite(e.return_mean)] for name, each in judged.items()}
        letters = stats.letters({name: scores for name, scores in returns.items() if scores})
        rows = []
        for name, each in judged.items():
            costs = [e.cost_mean[0] for _, e in each if e.cost_mean and math.isfinite(e.cost_mean[0])]
            limits = {e.cost_limits[0] if e.cost_limits else None for _, e in each}
            rows.append(ComparisonRow(task, name, len(each), stats.iqm(returns[name]) if returns[name] else math.nan, _interval(returns[name]),
                            float(np.mean(costs)) if costs else math.nan, _interval(costs), limits.pop() if len(limits) == 1 else None,
                            sum(e.feasible for _, e in each), float(np.mean([e.success_rate for _, e in each])),
                            letters.get(name, "")))
        return sorted(rows, key=lambda row: (-row.within / row.runs, -row.return_iqm if math.isfinite(row.return_iqm) else math.inf))

    @property
    def curves(self) -> dict[str, Curves]:
        """The curves of each task, seeds of one name as a band."""
        out = {}
        for task in self.tasks:
            drawn = []
            for name, runs in self.runs.items():
                for number_, run in enumerate(run for run in runs if run.task == task):
                    curve = run.curve
                    drawn.append(Curve(curve, f"{name} seed {run.seed}", curve.limit, curve.folder, name, number_))
            out[task] = Curves(drawn)
        return out

    def improvement(self, name: str, than: str, task: Optional[str] = None) -> stats.Improvement:
        """The probability that a run of one name has a higher return than a run of the other (redman.stats.improvement). task:
        on this one alone; None: on all."""
        scores = []
        for one in (name, than):
            if one not in self.runs:
                raise ArgumentError(f"improvement: {one!r} is none of {', '.join(self.runs)}")
            by_task: dict[str, list[float]] = {}
            for run, e in zip(self.runs[one], self.evaluations[one]):
                if task is None or run.task == task:
                    by_task.setdefault(run.task, []).append(e.return_mean)
            scores.append(by_task)
        return stats.improvement(scores[0], scores[1])

    def _texts(self, task: str) -> tuple[list[str], list[list[str]]]:
        heads = ["", "runs", "return (IQM)", "95 % interval", "cost", "95 % interval", "limit", "within limits", "success", "group"]
        rows = [[row.name, str(row.runs), number(row.return_iqm), pair(row.return_interval), number(row.cost_mean),
                 pair(row.cost_interval), number(row.limit), f"{row.within} of {row.runs}", share(row.success), row.group]
                for row in self.rows if row.task == task]
        return heads, rows

    def _repr_html_(self) -> str:
        """Curves and table of each task, for a notebook."""
        fewest = min((row.runs for row in self.rows), default=0)
        parts = []
        for task, curves in self.curves.items():
            parts.append(f"<h4>{html.escape(task)}</h4><div>{curves._repr_html_()}</div>" + table(*self._texts(task)))
        episodes = max((e.episodes for these in self.evaluations.values() for e in these), default=0)
        parts.append(f"<p>Each run's policy played {episodes} new episodes. Intervals are over runs"
                     + (", and too narrow for fewer than 5" if fewest < 5 else "") +
                     ". Two rows without a common letter differ.</p>")
        return "".join(parts)

    def __str__(self) -> str:
        out = []
        for task in self.tasks:
            heads, rows = self._texts(task)
            lines = [[task, *heads[1:]], *rows]
            widths = [max(len(line[k]) for line in lines) for k in range(len(heads))]
            out += ["  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines] + [""]
        return "\n".join(out).rstrip()

    def __repr__(self) -> str:
        return f"<Comparison of {', '.join(self.runs)} on {', '.join(self.tasks)}>"


def _interval(scores: Sequence[float]) -> tuple[float, float]:
    return stats.interval(list(scores)) if len(scores) > 1 else (math.nan, math.nan)


def _runs(given: Any) -> Iterable[Run]:
    """The runs of a run, a run folder, a folder that holds some, or a list of these."""
    if isinstance(given, Run):
        yield given
    elif isinstance(given, (str, os.PathLike)):
        path = Path(given)
        inside = sorted(found.parent for found in path.rglob("config.json") if (found.parent / "progress.csv").exists())
        if (path / "progress.csv").exists() or not inside:
            yield Run.load(path)
        else:
            yield from map(Run.load, inside)
    elif isinstance(given, (list, tuple)):
        for each in given:
            yield from _runs(each)
    else:
        raise UsageError(f"compare: it must be a run, a run folder or a list of these, not a {type(given).__name__}")


def _once(runs: Iterable[Run]) -> list[Run]:
    """The runs without those that were given before, also by another path of the folder: a run is no second seed."""
    once: dict[Any, Run] = {}
    for run in runs:
        once.setdefault(id(run) if run.folder is None else run.folder.resolve(), run)
    return list(once.values())


@keywords(aliases={"num_episodes": "episodes", "n_episodes": "episodes", "n_eval_episodes": "episodes"})
def compare(*runs: Any, episodes: Optional[int] = None) -> Comparison:
    """Compares runs over seeds: curves with bands, and a table of returns, costs and groups with intervals.

        redman.compare("runs")                                             # a folder of run folders, by algorithm
        redman.compare(redman.train("ball_run", ["ppo", "ppo_lag"], steps=1e6, seed=range(5)))
        redman.compare({"small": ["runs/a0", "runs/a1"], "large": ["runs/b0", "runs/b1"]})

    Runs that differ in their seeds alone are a row, named after their algorithm and, where it has several rows, what distinguishes
    them ("ppo: shield predict"); a dict gives the rows names of your own. A run that is given twice counts once. The tool's
    `redman report` makes a page of run folders, with all algorithms and tasks.

    runs: each a redman.Run, a run folder, a folder that contains some, a list of these, or a dict of these by name. episodes: how
    many new episodes the policy of each run plays, 1 or more; None: 100. Returns a Comparison. UsageError for anything else and
    where there is no run, MissingFileError for a folder that is not there.
    """
    named: dict[str, list[Run]] = {}
    loose: list[Run] = []  # without a name of the caller's
    for given in runs:
        if isinstance(given, Mapping):
            for name, these in given.items():
                named.setdefault(str(name), []).extend(_runs(these))
        else:
            loose += _runs(given)
    for run in loose:
        rivals = [other._settings for other in loose if (other.task, other.algo) == (run.task, run.algo)]
        named.setdefault(run.algo + differences(run._settings, rivals), []).append(run)
    named = {name: _once(these) for name, these in named.items() if these}
    if not named:
        raise UsageError("compare: give runs, run folders, or a dict of them by name")
    judged = {name: [run.judged() if episodes is None else run.evaluate(episodes=episodes) for run in these]
              for name, these in named.items()}
    return Comparison(named, judged)
