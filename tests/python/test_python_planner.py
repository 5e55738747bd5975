"""Planner: actions of a world's copies that earn more than those of nobody, the same bytes for any threads and from a state, ends
that stop and cancel ask for, errors with what may be."""
import copy
import pickle
import unittest

import numpy as np

import redman
from memory import grown

TASK = "ball_run"
FAST = {"samples": 16, "horizon": 12}


def worlds(n=1, **arguments):
    pool = redman.Pool(TASK, n, seed=3, autoreset="off", **arguments)
    pool.reset()
    return pool


def played(planner, pool, steps=40):
    actions = []
    for _ in range(steps):
        actions.append(planner.act())
        pool.step(actions[-1])
    return np.array(actions)


class Plans(unittest.TestCase):
    def test_it_earns_more_than_holding_still(self):
        pool, still = worlds(), worlds()
        played(redman.Planner(pool, options={**FAST, "method": "cem", "costs": "ignore"}), pool)
        for _ in range(40):
            still.step(still.baseline("zero"))
        self.assertGreater(pool.episode_return[0], still.episode_return[0] + 20)

    def test_same_seed_gives_the_same_bytes_for_any_threads_and_from_a_state(self):
        a, b = worlds(), worlds()
        first, second = redman.Planner(a, options=FAST, seed=5), redman.Planner(b, options=FAST, seed=5, threads=2)
        self.assertTrue(np.array_equal(played(first, a), played(second, b)))
        again = pickle.loads(pickle.dumps(first))
        third = copy.deepcopy(first)
        for planner in (first, again, third):
            self.assertIsInstance(planner.pool, redman.Pool)
        after = [planner.act() for planner in (first, again, third)]
        self.assertTrue(np.array_equal(after[0], after[1]) and np.array_equal(after[0], after[2]))
        with self.assertRaises(redman.FormatError):
            first.set_state(first.state()[:-1])

    def test_what_was_found_is_told_by_names(self):
        pool = worlds(2)
        planner = redman.Planner(pool, options=FAST, cost_limits={"speed": 5})
        self.assertFalse(planner.info.planned)
        planner(env=1)
        info = planner.info
        self.assertTrue(info.planned)
        self.assertEqual(list(info.costs), list(pool.costs))
        self.assertEqual(info.steps, 16 * 12)
        self.assertEqual((planner.samples, planner.horizon, planner.spec.action_dim), (16, 12, pool.action_dim))
        self.assertEqual(planner.options["samples"], 16)
        self.assertIn("samples", redman.planner_options())

    def test_a_plan_is_read_and_set_and_forgotten(self):
        pool = worlds()
        planner = redman.Planner(pool, options=FAST)
        action = planner.act()
        self.assertTrue(np.array_equal(planner.plan[0], action))
        plan = np.full((12, pool.action_dim), 0.25)
        planner.plan = plan
        self.assertTrue(np.array_equal(planner.plan, plan))
        planner.reset()
        self.assertFalse(np.array_equal(planner.plan, plan))
        with self.assertRaisesRegex(redman.ArgumentError, r"plan: its shape is \(3, 2\), but it must be \(12, 2\)"):
            planner.plan = np.zeros((3, 2))

    def test_a_policy_proposes_and_a_critic_values_the_end(self):
        pool = worlds()
        agent = redman.Agent(pool)
        planner = redman.Planner(pool, policy="trained", agent=agent, options={**FAST, "terminal_cost": True})
        agent.close()  # the planner has it still
        self.assertEqual(planner.act().shape, (pool.action_dim,))

    def test_stop_and_cancel_end_a_call(self):
        pool, asked = worlds(), []
        planner = redman.Planner(pool, options=FAST, stop=lambda steps: asked.append(steps) or steps >= 48)
        planner.act()
        self.assertTrue(planner.info.cut)
        self.assertEqual(asked[0], 0)
        self.assertLess(asked[-1], 16 * 12)
        cancelled = redman.Planner(pool, options=FAST)
        cancelled.cancel()
        with self.assertRaises(redman.CancelledError):
            cancelled.act()
        cancelled.act()

    def test_what_stop_raises_is_the_cause_of_the_error(self):
        pool = worlds()
        planner = redman.Planner(pool, options=FAST, stop=lambda steps: 1 // 0)
        with self.assertRaisesRegex(redman.Error, "stop raised ZeroDivisionError") as caught:
            planner.act()
        self.assertIsInstance(caught.exception.__cause__, ZeroDivisionError)

    def test_errors_say_what_may_be(self):
        pool = worlds()
        for call, words in (
                (lambda: redman.Planner(TASK), "pool: it must be a redman.Pool"),
                (lambda: redman.Planner(pool, agent=3), "agent: it must be a redman.Agent"),
                (lambda: redman.Planner(pool, options={"sampels": 3}), "nearest is samples"),
                (lambda: redman.Planner(pool, sampels=3), "there is no such argument"),
                (lambda: redman.Planner(pool, options=FAST, cost_limits={"sped": 3}), "nearest is speed"),
                (lambda: redman.Planner(pool, options=FAST).act(7), "env"),
                (lambda: redman.Planner(pool, options=FAST).act(pool=redman.Pool("bandit")), "task|options|differ"),
                (lambda: redman.Planner(pool, options=FAST).predict(0), r"planner.act\(env\)")):
            with self.assertRaisesRegex((redman.Error, AttributeError), words):
                call()
        self.assertEqual(redman.Planner(pool, samples=16).options["samples"], 16)

    def test_memory_does_not_grow_while_it_plans(self):
        pool = worlds()
        planner = redman.Planner(pool, options={"samples": 4, "horizon": 3})
        self.assertLess(grown(planner.act), 8000)  # the smallest object a step would be 16,000


if __name__ == "__main__":
    unittest.main()
