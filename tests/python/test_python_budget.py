"""Budgets of a pool: limits that are drawn, what a rollout tells an agent of them, and a policy at a limit that is set."""
import unittest

import numpy as np

import redman

OPTIONS = {"limit_range": "1..2", "max_steps": 20}
LEARNS = {"horizon": 30, "hidden": "8", "action_repeat": 1, "multiplier_optimizer": "sgd"}


class Budget(unittest.TestCase):
    def make(self):
        pool = redman.Pool("ball_run", num_envs=4, seed=3, options=OPTIONS)
        pool.reset()
        return pool, redman.Agent(pool, seed=1, options=LEARNS)

    def test_the_fields_stand_behind_the_tasks(self):
        pool, _ = self.make()
        plain = redman.Pool("ball_run", num_envs=4, seed=3, options={"max_steps": 20})
        plain.reset()
        self.assertEqual(pool.obs.shape[1], plain.obs.shape[1] + 2)
        np.testing.assert_array_equal(pool.obs[:, :-2], plain.obs)
        np.testing.assert_array_equal(pool.obs[:, -2], 1)
        self.assertTrue(((pool.obs[:, -1] >= 0.5) & (pool.obs[:, -1] < 1)).all())

    def test_a_rollout_tells_each_episodes_own_limit(self):
        pool, agent = self.make()
        other, same = self.make()
        for _ in range(4):
            epoch = agent.rollout(pool)
            for _ in range(30):
                action = same.act(other.obs)
                limit = 2 * other.obs[:, -1]  # of the episode that runs: the next may begin in this step
                other.step(action)
                same.record(other.reward, other.cost, other.terminated, other.truncated, other.final_obs,
                            success=other.success, limit=limit)
            said = same.update(other.obs)
        self.assertEqual(agent.save(), same.save())
        self.assertEqual(epoch.multiplier, said.multiplier)
        self.assertGreater(epoch.episodes, 10)

    def test_the_limit_is_set_where_a_policy_plays(self):
        pool, agent = self.make()
        policy = agent.policy()
        at = redman.Pool("ball_run", num_envs=2, options={**OPTIONS, "limit": 1.5})
        at.reset()
        np.testing.assert_array_equal(at.obs[:, -1], np.float32(0.75))
        self.assertEqual(policy.act(at.obs).shape[0], 2)
        at.set_limit(2, env=1)
        np.testing.assert_array_equal(at.obs[:, -1], np.float32([0.75, 1]))
        for limit, error, words in ((2.5, redman.RangeError, "limit_range, 1 to 2"), (float("nan"), redman.RangeError, "nan")):
            with self.assertRaisesRegex(error, words):
                at.set_limit(limit)
        with redman.Pool("ball_run") as plain:
            plain.reset()
            with self.assertRaisesRegex(redman.UnsupportedError, "limit_range"):
                plain.set_limit(3)
        with self.assertRaisesRegex(redman.ArgumentError, "limit"):
            redman.Pool("ball_run", options={"limit": 1.5})


if __name__ == "__main__":
    unittest.main()
