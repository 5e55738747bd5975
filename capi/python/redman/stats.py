"""Statistics over several runs, to compare algorithms that were trained with a few seeds each.

    from redman import stats
    score = lambda run, task: stats.normalised(run.evaluate().return_mean, low[task], high[task])
    ours = {task: [score(redman.train(task, seed=s), task) for s in range(10)] for task in tasks}
    stats.iqm(ours), stats.interval(ours), stats.improvement(ours, theirs), stats.ranks({"ours": ours, "theirs": theirs})

A score is a number for one run, the greater the better: negate a cost. Scores by task are a dict {task: scores of its runs},
or rows [tasks][runs], which may differ in length; a plain list of numbers is the runs of one task. Scores of several tasks
are pooled, so they must be on the same scale: normalised() does that. A score that is not finite is refused: leave the run
out, or give it the score of a failure, and report which you did.

Agarwal, Schwarzer, Castro, Courville, Bellemare: Deep Reinforcement Learning at the Edge of the Statistical Precipice,
NeurIPS 2021, is the source of iqm, interval and improvement. Intervals are of the percentile bootstrap (Efron, Tibshirani: An
Introduction to the Bootstrap, 1993, chapter 13) with 10,000 resamples of a fixed seed: the same scores give the same interval.
"""
from __future__ import annotations

from typing import Any, Callable, Hashable, Mapping, NamedTuple, Sequence, Union

import numpy as np

from ._error import ArgumentError, UsageError
from ._library import real
from ._rows import Array, array_of

__all__ = ["Improvement", "difference", "improvement", "interval", "iqm", "letters", "normalised", "ranks"]

Scores = Union[Mapping[Any, Any], Sequence[Any], Array]
Samples = Sequence[Array]  # numbers of rows that were drawn, [resamples][rows] of each stratum
_RESAMPLES, _SEED = 10_000, 0
_AT_ONCE = 1 << 17  # rows that are drawn together, for memory


class Improvement(NamedTuple):
    """Probability that a run of one algorithm is better than one of another, and its interval."""

    probability: float
    low: float
    high: float


def iqm(scores: Scores) -> float:
    """The interquartile mean of all scores of all tasks: of the n scores in order, the mean of those between the floor(n / 4)
    lowest and as many highest.

        IQM = 1 / (n - 2 c)  sum x_(i), i = c + 1 ... n - c,  c = floor(n / 4)

    Unlike the mean, it is not affected by a few outliers, and it uses half of the scores, where a median uses one or two
    (Agarwal et al. 2021, section 4.3). scores: a list of runs' scores, or {task: list}; ArgumentError for one that is not finite.
    """
    return float(iqm_of(np.concatenate(list(_by_task(scores).values()))[None])[0])


def interval(scores_by_task: Scores, level: float = 0.95) -> tuple[float, float]:
    """The interval of iqm() of scores_by_task: runs are drawn with replacement within each task, as many as it has, and the
    quantiles (1 - level) / 2 and (1 + level) / 2 of the resamples' interquartile means are its ends (stratified bootstrap,
    Agarwal et al. 2021, section 4.1).

    Each task needs 2 runs or more. With fewer than about 5 runs of few tasks the interval is too narrow. scores_by_task: as scores of
    iqm(). level: the share of such intervals that contain the true value, between 0 and 1.
    """
    tasks = _of_several(scores_by_task, "scores_by_task")

    def statistic(drawn: Samples) -> Array:
        return iqm_of(np.concatenate([runs[rows] for runs, rows in zip(tasks.values(), drawn)], axis=1))

    low, high = bootstrap([len(runs) for runs in tasks.values()], statistic, level)
    return float(low), float(high)


def improvement(a: Scores, b: Scores, level: float = 0.95) -> Improvement:
    """The probability that a run of algorithm a is better than a run of b on a task drawn at random, and its interval by the
    bootstrap of interval() over the runs of both.

        P(A > B) = 1 / M  sum over tasks m of  1 / (N K)  sum over runs i, j of  S(a_mi, b_mj)
        S(x, y) = 1 where x > y, 1/2 where x = y, 0 where x < y

    with M tasks, N and K runs: the Mann-Whitney statistic of each task (Mann, Whitney: Ann. Math. Statist. 18, 1947; Agarwal et
    al. 2021, section 4.3). It says how often a is better, not by how much. If the interval is above 1/2, a is better. level: as
    in interval().
    """
    ours, theirs = _of_several(a, "a"), _of_several(b, "b")
    _need_same(ours, theirs, "a", "b")
    won = [(np.sign(ours[task][:, None] - theirs[task]) + 1) / 2 for task in ours]

    def statistic(drawn: Samples) -> Array:
        shares = []
        for s, of_a, of_b in zip(won, drawn, drawn[len(won):]):
            shares.append((_counts(of_a, len(s)) @ s * _counts(of_b, s.shape[1])).sum(axis=1) / s.size)
        of_all: Array = np.mean(shares, axis=0)
        return of_all

    sizes = [len(runs) for runs in (*ours.values(), *(theirs[task] for task in ours))]
    low, high = bootstrap(sizes, statistic, level)
    return Improvement(float(np.mean([s.mean() for s in won])), float(low), float(high))


def difference(a: Scores, b: Scores, level: float = 0.95) -> tuple[float, float]:
    """The interval of iqm(a) - iqm(b), by the bootstrap of interval() over the runs of both. If it does not contain 0, the two
    differ: that tests more sharply than two intervals that must not overlap. level: as in interval()."""
    ours, theirs = _of_several(a, "a"), _of_several(b, "b")
    _need_same(ours, theirs, "a", "b")
    rows = [*ours.values(), *(theirs[task] for task in ours)]

    def statistic(drawn: Samples) -> Array:
        picked = [runs[at] for runs, at in zip(rows, drawn)]
        both = [iqm_of(np.concatenate(half, axis=1)) for half in (picked[:len(ours)], picked[len(ours):])]
        of_both: Array = both[0] - both[1]
        return of_both

    low, high = bootstrap([len(runs) for runs in rows], statistic, level)
    return float(low), float(high)


def letters(scores: Mapping[str, Scores], level: float = 0.95) -> dict[str, str]:
    """The groups of algorithms, {algorithm: scores by task}, as letters, the best group "a": two without a common letter
    differ, because the interval of difference() does not contain 0, as in `redman compare` and `redman report`. An algorithm
    with a single run of a task has none. level: as in interval() (Piepho: An Algorithm for a Letter-Based Representation of
    All-Pairwise Comparisons, J. of Computational and Graphical Statistics 13, 2004)."""
    if not isinstance(scores, Mapping):
        raise UsageError(f"scores: it must be a dict {{algorithm: scores by task}}, not {scores!r}")
    tasks = {name: _by_task(rows, name) for name, rows in scores.items()}
    names = sorted((name for name in tasks if all(len(runs) > 1 for runs in tasks[name].values())), key=lambda name: -iqm(scores[name]))
    groups: list[list[str]] = [names] if names else []
    for i, one in enumerate(names):
        for other in names[i + 1:]:
            low, high = difference(scores[one], scores[other], level)
            if low <= 0 <= high:
                continue
            kept = [group for group in groups if one not in group or other not in group]
            split = [[name for name in group if name != left] for group in groups if one in group and other in group
                     for left in (other, one)]
            for group in sorted(split, key=len, reverse=True):
                if not any(set(group) <= set(whole) for whole in kept):
                    kept.append(group)
            groups = kept
    groups.sort(key=lambda group: [names.index(name) for name in group])
    return {name: "".join(chr(ord("a") + k) for k, group in enumerate(groups[:26]) if name in group) for name in tasks}


def normalised(value: Any, low: Any, high: Any) -> Any:
    """(value - low) / (high - low): 0 is as good as low, a policy that learns nothing, and 1 as good as high, a reference.
    Numbers, or arrays that numpy spreads over each other; low above high where less is better (Bellemare et al.: The Arcade
    Learning Environment, JAIR 47, 2013)."""
    x, zero, one = (array_of(number, name, np.float64) for name, number in (("value", value), ("low", low), ("high", high)))
    if np.any(zero == one):
        raise ArgumentError(f"normalised: low and high are the same, {low}")
    out = (x - zero) / (one - zero)
    return float(out) if out.ndim == 0 else out


def ranks(scores: Mapping[str, Scores], level: float = 0.95) -> list[list[str]]:
    """Groups of algorithms, {algorithm: scores by task}, whose intervals of iqm() all overlap, the best group first and the
    best of a group first. level: as in interval(). An algorithm is in two groups where it overlaps with both, as in a diagram
    of critical differences (Demsar: Statistical Comparisons of Classifiers over Multiple Data Sets, JMLR 7, 2006).

    Algorithms that share no group differ. Those that share one may still differ: improvement() is the sharper test
    (Schenker, Gentleman: On Judging the Significance of Differences by Examining the Overlap Between Confidence Intervals,
    The American Statistician 55, 2001).
    """
    if not isinstance(scores, Mapping) or not scores:
        raise UsageError("scores: a dict {algorithm: scores by task}")
    names = list(scores)
    tasks = {name: _by_task(scores[name]) for name in names}
    for name in names[1:]:
        _need_same(tasks[names[0]], tasks[name], names[0], name)
    ends = {name: interval(scores[name], level) for name in names}
    best_first = sorted(names, key=lambda name: -iqm(scores[name]))
    # intervals that overlap in pairs have a point in common, and the lowest end of one is such a point
    groups = [[name for name in best_first if ends[name][0] <= low <= ends[name][1]]
              for low in sorted({low for low, _ in ends.values()}, reverse=True)]
    return [group for group in groups if not any(set(group) < set(other) for other in groups)]


def iqm_of(samples: Array) -> Array:
    """iqm() of each row, [resamples][scores]."""
    cut = samples.shape[1] // 4
    middle: Array = np.sort(samples, axis=1)[:, cut:samples.shape[1] - cut].mean(axis=1)
    return middle


def bootstrap(sizes: Sequence[int], statistic: Callable[[Samples], Array], level: float) -> Array:
    """The lower and upper end of a percentile bootstrap's interval of statistic(), which is called with rows drawn with
    replacement from strata of these sizes; with an extra axis where the statistic has columns."""
    if not 0 < real(level, "level") < 1:
        raise ArgumentError(f"level: {level} is not between 0 and 1")
    random = np.random.RandomState(_SEED)  # its stream is the same in all versions of numpy
    at_once = max(1, min(_RESAMPLES, _AT_ONCE // sum(sizes)))
    found = []
    for first in range(0, _RESAMPLES, at_once):
        count = min(at_once, _RESAMPLES - first)
        found.append(statistic([random.randint(size, size=(count, size), dtype=np.int64) for size in sizes]))
    ends: Array = np.quantile(np.concatenate(found), [(1 - level) / 2, (1 + level) / 2], axis=0)
    return ends


def _counts(rows: Array, size: int) -> Array:
    """[resamples][size] how often each row was drawn."""
    at = rows + size * np.arange(len(rows))[:, None]
    return np.bincount(at.ravel(), minlength=len(rows) * size).reshape(len(rows), size)


def _by_task(scores: Any, name: str = "scores") -> dict[Hashable, Array]:
    """Scores of each task's runs."""
    if isinstance(scores, Mapping):
        named = dict(scores)
    elif isinstance(scores, (str, bytes)) or not hasattr(scores, "__len__") or isinstance(scores, type):
        raise UsageError(f"{name}: it must be scores by task, a dict or rows, or a list of numbers, not {scores!r}")
    elif len(scores) and np.ndim(scores[0]):
        named = dict(enumerate(scores))
    else:
        named = {0: scores}
    out: dict[Hashable, Array] = {}
    for task, runs in named.items():
        row = np.atleast_1d(array_of(runs, f"{name}: task {task}", np.float64))
        if row.ndim != 1 or not len(row) or not np.isfinite(row).all():
            raise ArgumentError(f"{name}: task {task}: one finite number for each run, not {runs!r}")
        out[task] = row
    if not out:
        raise ArgumentError(f"{name}: there are no tasks")
    return out


def _of_several(scores: Any, name: str) -> dict[Hashable, Array]:
    """The same, for tasks that have two runs or more each."""
    tasks = _by_task(scores, name)
    for task, runs in tasks.items():
        if len(runs) < 2:
            raise ArgumentError(f"{name}: task {task}: one run says nothing of others; 2 or more")
    return tasks


def _need_same(a: Mapping[Hashable, Any], b: Mapping[Hashable, Any], of_a: str, of_b: str) -> None:
    if a.keys() != b.keys():
        odd = ", ".join(map(str, [task for task in (*a, *b) if (task in a) != (task in b)]))
        raise ArgumentError(f"{of_a} and {of_b} are of different tasks: {odd} of one alone")
