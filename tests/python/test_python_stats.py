"""redman.stats, and what an Evaluation says of its episodes: each number on cases that can be worked out by hand,
and the same of the tool."""
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import redman
from redman import stats
from redman._play import summary

TOOL = os.environ.get("REDMAN_TOOL")


def evaluation(returns, costs, limits=(4,), successes=None, status=None):
    """Of episodes with these numbers; costs are rows, or numbers of one column."""
    n = len(returns)
    rows = np.array(costs, float).reshape(n, -1)
    flags = dict.fromkeys(("contacts_left_out", "unconverged", "slowed"), 0)
    return summary([{"return": float(returns[i]), "cost": rows[i], "length": 10 + i, "fall": False,
                     "success": bool(successes and successes[i]), "status": status[i] if status else 0, **flags}
                    for i in range(n)], list(limits), 0)


class Runs(unittest.TestCase):
    def test_the_middle_half(self):
        self.assertEqual(stats.iqm([8, 1, 6, 3, 5, 4, 7, 2]), 4.5)  # of 3, 4, 5, 6
        self.assertEqual(stats.iqm([0, 1, 5, 1000]), 3)
        self.assertEqual(stats.iqm([1, 2, 6]), 3)  # floor(3 / 4) are left out
        self.assertEqual(stats.iqm({"a": [0, 1], "b": [5, 1000]}), 3)  # of all tasks together
        self.assertEqual(stats.iqm(np.array([[0, 1], [5, 1000]])), 3)
        self.assertEqual(stats.iqm([2.5]), 2.5)

    def test_an_interval_draws_runs_within_tasks(self):
        # of task a {0, 1} and b {10, 10} a quarter of the draws is {0, 0, 10, 10}: 5, the others leave out a lowest: 5.5
        scores = {"a": [0, 1], "b": [10, 10]}
        self.assertEqual(stats.interval(scores), (5, 5.5))
        self.assertEqual(stats.interval(scores, level=0.4), (5.5, 5.5))
        # of {0, 1} alone 0, 1/2 and 1 with 1/4, 1/2 and 1/4
        self.assertEqual(stats.interval([0, 1]), (0, 1))
        self.assertEqual(stats.interval([[0, 1]], 0.4), (0.5, 0.5))
        self.assertEqual(stats.interval({"a": [3, 3, 3], "b": [3, 3]}), (3, 3))

    def test_an_interval_is_that_of_the_normal_law_for_many_runs(self):
        # 1000 runs: the middle half's mean of a normal law has deviation 1.0945 / sqrt(n) (Huber's trimmed mean at 1/4)
        runs = np.random.RandomState(1).standard_normal(1000)
        low, high = stats.interval(runs)
        self.assertAlmostEqual((high - low) / 2, 1.96 * math.sqrt(1.1980 / 1000), delta=0.006)
        self.assertTrue(low < stats.iqm(runs) < high)
        self.assertEqual(stats.interval(runs), (low, high))  # the same draws each time

    def test_improvement_counts_pairs(self):
        # 1 = 1, 1 < 3, 2 > 1, 2 < 3: a half and a whole of four
        self.assertEqual(stats.improvement([1, 2], [1, 3]).probability, 0.375)
        both = stats.improvement({"x": [1, 2], "y": [5, 5]}, {"x": [1, 3], "y": [0, 0, 0]})
        self.assertEqual(both.probability, (0.375 + 1) / 2)
        self.assertEqual(stats.improvement([1, 2, 3], [0, 0]), (1, 1, 1))
        self.assertEqual(stats.improvement([0, 0], [1, 2, 3]), (0, 0, 0))
        # a draw of a is {0, 0}, {0, 1}, {1, 1} with 1/4, 1/2, 1/4
        one = stats.improvement([0, 1], [0.5, 0.5])
        self.assertEqual((one.probability, one.low, one.high), (0.5, 0, 1))
        self.assertEqual(stats.improvement([0, 1], [0.5, 0.5], 0.4), (0.5, 0.5, 0.5))
        # one of b alone: {1, 1}, {1, 3}, {3, 3} against {2, 2}
        self.assertEqual(stats.improvement([2, 2], [1, 3], 0.4), (0.5, 0.5, 0.5))
        self.assertEqual(stats.improvement([2, 2], [1, 3]), (0.5, 0, 1))
        # tasks by name, in any order
        self.assertEqual(stats.improvement({"x": [1, 2], "y": [5, 5]}, {"y": [0, 0, 0], "x": [1, 3]}), both)

    def test_improvement_is_a_mean_of_one_minus_the_other(self):
        draw = np.random.RandomState(2)
        a, b = ([draw.randint(0, 5, 7) for _ in range(3)] for _ in range(2))
        one, other = stats.improvement(a, b), stats.improvement(b, a)
        self.assertAlmostEqual(one.probability + other.probability, 1)
        self.assertTrue(0 <= one.low <= one.probability <= one.high <= 1)

    def test_normalised(self):
        self.assertEqual(stats.normalised(7, 2, 12), 0.5)
        self.assertEqual(stats.normalised(4, 8, 0), 0.5)  # less is better
        np.testing.assert_array_equal(stats.normalised([2, 12, 22], 2, 12), [0, 1, 2])
        with self.assertRaisesRegex(redman.ArgumentError, "low and high are the same"):
            stats.normalised(1, 2, 2)

    def test_ranks_are_groups_that_overlap(self):
        self.assertEqual(stats.ranks({"b": [5, 5], "a": [10, 10], "c": [5, 5]}), [["a"], ["b", "c"]])
        # intervals of two runs are from one to the other: (3, 5), (1, 4), (0, 2)
        self.assertEqual(stats.ranks({"c": [0, 2], "a": [3, 5], "b": [1, 4]}), [["a", "b"], ["b", "c"]])
        self.assertEqual(stats.ranks({"c": [0, 9], "a": [3, 5], "b": [1, 4]}), [["c", "a", "b"]])
        self.assertEqual(stats.ranks({"a": {"x": [1, 1], "y": [2, 2]}, "b": {"x": [0, 0], "y": [0, 0]}}), [["a"], ["b"]])

    def test_what_is_no_score_is_refused(self):
        for call, words in ((lambda: stats.iqm([]), "one finite number for each run"),
                            (lambda: stats.iqm([1, math.nan]), "one finite number for each run"),
                            (lambda: stats.iqm({}), "no tasks"),
                            (lambda: stats.interval({"x": [1]}), "scores_by_task: task x: one run"),
                            (lambda: stats.interval([0, 1], 95), "level: 95 is not between 0 and 1"),
                            (lambda: stats.improvement({"x": [1, 2]}, {"y": [1, 2]}), "a and b are of different tasks: x, y"),
                            (lambda: stats.ranks({"a": {"x": [1, 2]}, "b": {"y": [1, 2]}}), "a and b are of different tasks"),
                            (lambda: stats.ranks([1, 2]), "a dict")):
            with self.subTest(words), self.assertRaisesRegex(redman.ArgumentError, words):
                call()


class Episodes(unittest.TestCase):
    def test_standard_errors(self):
        e = evaluation([1, 2, 3, 6], [[0, 1], [2, 1], [2, 1], [4, 1]], (4, None), [True, False, False, False])
        # squares about 3: 4, 1, 0, 9; about 2: 4, 0, 0, 4
        self.assertAlmostEqual(e.return_stderr, math.sqrt(14 / 3 / 4))
        np.testing.assert_allclose(e.cost_stderr, [math.sqrt(8 / 3 / 4), 0])
        self.assertAlmostEqual(e.success_stderr, math.sqrt(0.25 * 0.75 / 3))
        self.assertEqual(e.return_iqm, 2.5)
        for name, values in (("returns", [1, 2, 3, 6]), ("lengths", [10, 11, 12, 13]),
                             ("successes", [True, False, False, False])):
            self.assertEqual(getattr(e, name).tolist(), values)
            with self.assertRaises(ValueError):  # as the rest, it cannot be changed
                getattr(e, name)[0] = 0
        self.assertEqual((e.costs.shape, e.costs[:, 0].tolist()), ((4, 2), [0, 2, 2, 4]))

    def test_tails_of_costs(self):
        twenty = evaluation(range(20), [[i, -i] for i in range(20)], (4, None))
        self.assertEqual(twenty.cost_cvar, [18.5, -0.5])
        fifteen = evaluation(range(15), range(15))
        self.assertAlmostEqual(fifteen.cost_cvar[0], (14 + 0.5 * 13) / 1.5)
        self.assertEqual(evaluation(range(7), range(7)).cost_cvar, [6])
        eleven = evaluation(range(11), [10 - i for i in range(11)])
        self.assertEqual(list(eleven.cost_quantiles), [0.5, 0.9, 0.99])
        np.testing.assert_allclose([q[0] for q in eleven.cost_quantiles.values()], [5, 9, 9.9])

    def test_intervals(self):
        e = evaluation([0, 1], [[0, 3], [10, 3]], (4, None), [True, True])
        # resamples are {0, 0}, {0, 1} twice, {1, 1}
        self.assertEqual(e.interval("return_mean"), (0, 1))
        self.assertEqual(e.interval("return_mean", 0.4), (0.5, 0.5))
        self.assertEqual(e.interval("return_iqm", 0.4), (0.5, 0.5))
        self.assertEqual(e.interval("cost_mean"), [(0, 10), (3, 3)])
        self.assertEqual(e.interval("cost_cvar", 0.4), [(10, 10), (3, 3)])  # three of four have the 10
        self.assertEqual(e.interval("length_mean"), (10, 11))
        self.assertEqual(e.interval("success_rate"), (1, 1))
        self.assertEqual(e.interval("violation_rate"), (0, 1))
        with self.assertRaisesRegex(redman.ArgumentError, "'return_meen' is none of .*nearest is return_mean"):
            e.interval("return_meen")
        with self.assertRaisesRegex(redman.ArgumentError, "level"):
            e.interval("return_mean", 0)

    def test_an_interval_is_that_of_the_normal_law_for_many_episodes(self):
        e = evaluation(np.random.RandomState(1).standard_normal(1000), np.zeros(1000))
        low, high = e.interval("return_mean")
        self.assertAlmostEqual((high - low) / 2, 1.96 * e.return_stderr, delta=0.004)
        self.assertEqual(e.interval("return_mean"), (low, high))

    def test_an_episode_that_went_wrong_is_no_measurement(self):
        with self.assertWarns(RuntimeWarning):
            e = evaluation([1, 99, 3], [0, 99, 2], successes=[True, True, False], status=[0, 2, 0])
        self.assertTrue(np.isnan(e.returns[1]) and np.isnan(e.costs[1, 0]) and np.isnan(e.lengths[1]))
        self.assertEqual(e.successes.tolist(), [True, False, False])
        self.assertEqual((e.return_mean, e.return_iqm, e.cost_cvar, e.cost_quantiles[0.5]), (2, 2, [2], [1]))
        self.assertEqual((np.nanmean(e.returns), e.successes.mean()), (e.return_mean, e.success_rate))
        self.assertEqual(e.interval("cost_mean"), [(0, 2)])
        low, high = e.interval("violation_rate")
        self.assertTrue(low < e.violation_rate < high)
        with self.assertWarns(RuntimeWarning):
            none = evaluation([99], [99], status=[2])
        for value in (none.return_stderr, none.cost_stderr[0], none.return_iqm, none.cost_cvar[0], none.cost_quantiles[0.9][0],
                      none.success_stderr, *none.interval("return_mean"), *none.interval("cost_mean")[0]):
            self.assertTrue(math.isnan(value))

    def test_they_are_those_of_the_episodes_that_were_played(self):
        # an action of a is a choice of 5 a: reward -(5 a - 2)^2, cost 5 a, of one step
        e = redman.evaluate(lambda obs: np.linspace(0, 1, len(obs))[:, None], "bandit", episodes=5, num_envs=5)
        choice = 5 * np.linspace(0, 1, 5)
        np.testing.assert_allclose(e.returns, -(choice - 2) ** 2, rtol=1e-6)
        np.testing.assert_allclose(e.costs[:, 0], choice, rtol=1e-6)
        self.assertEqual(e.lengths.tolist(), [1] * 5)
        self.assertEqual(e.violating_steps, 4)
        self.assertEqual((e.episodes, e.decisions, e.interventions), (5, None, None))
        self.assertNotIn("array", repr(e))


@unittest.skipUnless(TOOL, "the command-line tool was not built")
class Tool(unittest.TestCase):
    """`redman compare` and `redman eval` say the same numbers."""

    def test_numbers_of_runs(self):
        draw = np.random.RandomState(3)
        scores = {name: {task: (10 * draw.standard_normal(runs) + mean).tolist() for task, runs in (("x", 3), ("y", 5))}
                  for name, mean in (("a", 10), ("b", 4), ("c", 0))}
        with tempfile.TemporaryDirectory() as folder:
            rows = Path(folder, "rows.csv")
            rows.write_text("algorithm,task,return\n" + "".join(
                f"{name},{task},{score!r}\n" for name, tasks in scores.items() for task, of in tasks.items() for score in of))
            said = json.loads(subprocess.run([TOOL, "compare", rows, "--over", "task", "--json"], check=True,
                                             capture_output=True).stdout)
        self.assertEqual(len(said["rows"]), 3)
        for row in said["rows"]:
            of = scores[row["name"]]
            self.assertEqual(row["runs"], 8)
            self.assertAlmostEqual(row["iqm"], stats.iqm(of), places=12)
            np.testing.assert_allclose(row["interval"], stats.interval(of), rtol=1e-12)
            self.assertAlmostEqual(row["sd"], np.std(of["x"] + of["y"], ddof=1), places=12)
        self.assertEqual(len(said["pairs"]), 3)
        for pair in said["pairs"]:
            of, other = scores[pair["better"]], scores[pair["than"]]
            np.testing.assert_allclose([pair["probability"], *pair["interval"]], stats.improvement(of, other), rtol=1e-12)

            def difference(drawn):
                one, less = (np.concatenate([np.array(runs)[rows] for runs, rows in zip(tasks.values(), half)], axis=1)
                             for tasks, half in ((of, drawn[:2]), (other, drawn[2:])))
                return stats.iqm_of(one) - stats.iqm_of(less)

            ends = stats.bootstrap([3, 5, 3, 5], difference, 0.95)
            np.testing.assert_allclose(pair["difference_interval"], ends, rtol=1e-10)
            letters = [set(row["group"]) for row in said["rows"] if row["name"] in (pair["better"], pair["than"])]
            self.assertEqual(letters[0].isdisjoint(letters[1]), not ends[0] <= 0 <= ends[1])

    def test_numbers_of_episodes(self):
        said = json.loads(subprocess.run([TOOL, "eval", "--task", "point_goal1", "--policy", "trained", "--episodes", "40",
                                          "--seed", "5", "--json"], check=True, capture_output=True).stdout)
        e = redman.evaluate("trained", "point_goal1", episodes=40, seed=5)
        for name in ("return_mean", "return_stderr", "cost_mean", "cost_stderr", "success_stderr", "return_iqm", "cost_cvar",
                     "violation_rate"):
            np.testing.assert_allclose(said[name], getattr(e, name), rtol=1e-12, err_msg=name)
        for q, costs in e.cost_quantiles.items():
            np.testing.assert_allclose(said["cost_quantiles"][str(q)], costs, rtol=1e-12)
        np.testing.assert_allclose(said["interval"], e.interval("return_mean"), rtol=1e-12)
        np.testing.assert_allclose(said["cost_interval"], e.interval("cost_mean"), rtol=1e-12)
        np.testing.assert_allclose(said["return_quantiles"]["0.1"], np.quantile(e.returns, 0.1), rtol=1e-12)


if __name__ == "__main__":
    unittest.main()
