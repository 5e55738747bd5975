"""Policies that remember: act takes a state and gives the next one, actors and predict keep it, agents forget; shields and
planners keep it too."""
import unittest

import numpy as np

import redman

SETTINGS = {"history": {"history": 4, "hidden": 8}, "gru": {"memory": "gru:6", "hidden": 8}}


def agent_of(settings, envs=3):
    pool = redman.Pool("recall", num_envs=envs, seed=2)
    pool.reset()
    agent = redman.Agent(pool, algo="ppo", seed=1, options={**settings, "horizon": 20})
    agent.rollout(pool)
    return pool, agent


class Memory(unittest.TestCase):
    def test_a_state_goes_in_and_comes_out(self):
        for name, settings in SETTINGS.items():
            with self.subTest(name):
                _, agent = agent_of(settings)
                policy = agent.policy()
                self.assertGreater(policy.info.state_dim, 0)
                rng = np.random.default_rng(0)
                state, alone = policy.start(3), policy.start()
                self.assertEqual(state.shape, (3, policy.info.state_dim))
                for _ in range(6):
                    obs = rng.standard_normal((3, 2)).astype(np.float32)
                    before = state.copy()
                    action, following = policy.act(obs, state)
                    np.testing.assert_array_equal(state, before)
                    one, alone = policy.act(obs[0], alone)
                    np.testing.assert_array_equal(np.asarray(one), np.asarray(action)[0])
                    state = following
                np.testing.assert_array_equal(state[0], alone)
                with self.assertRaisesRegex(redman.ArgumentError, "policy.start"):
                    policy.act(obs)
                with self.assertRaisesRegex(redman.ArgumentError, "but it must be"):
                    policy.act(obs, state[:2])
                with self.assertRaisesRegex(redman.StateError, r"policy.sample\(\) cannot run it; call policy.act\(obs, state\)"):
                    policy.sample(obs)

    def test_actors_and_predict_keep_it(self):
        for name, settings in SETTINGS.items():
            with self.subTest(name):
                _, agent = agent_of(settings)
                policy = agent.policy()
                pool = redman.Pool("recall", num_envs=3, seed=5)
                pool.reset()
                actor, kept, state = policy.actor(pool), None, policy.start(3)
                begun = np.ones(3, bool)
                for _ in range(50):
                    obs = pool.obs.copy()
                    state[begun] = 0
                    wanted, state = policy.act(obs, state)
                    predicted, kept = policy.predict(obs, kept, begun)
                    action = actor()
                    np.testing.assert_array_equal(np.asarray(wanted), np.asarray(action))
                    np.testing.assert_array_equal(np.asarray(wanted), np.asarray(predicted))
                    pool.step(action)
                    begun = np.asarray(pool.terminated | pool.truncated, bool)

    def test_an_agent_forgets(self):
        _, agent = agent_of(SETTINGS["gru"])
        obs = np.ones((3, 2), np.float32)
        agent.forget("mean")
        first = agent.act(obs, "mean").copy()
        self.assertFalse(np.array_equal(agent.act(obs, "mean"), first))
        agent.forget("mean", [True, False, True])
        again = agent.act(obs, "mean")
        np.testing.assert_array_equal(again[[0, 2]], first[[0, 2]])
        self.assertFalse(np.array_equal(again[1], first[1]))
        with self.assertRaisesRegex(redman.ArgumentError, "mask"):
            agent.forget("mean", [True])

    def test_shields_and_planners_keep_it(self):
        for name, settings in SETTINGS.items():
            with self.subTest(name):
                line = redman.Pool("lqr_line", num_envs=3, seed=5)
                line.reset()
                agent = redman.Agent(line, algo="ppo", seed=1, options={**settings, "horizon": 20})
                agent.shield = redman.Shield(line, budgets=0.05, options={"unproven": "least"})  # it learns under one
                self.assertGreater(agent.rollout(line).refused, 0)
                agent.shield = None
                for _ in range(3):
                    agent.rollout(line)
                policy = agent.policy()
                self.assertGreater(policy.info.state_dim, 0)

                # who plays by the policy has the shield's state of it: what its plans go on by is what is proposed
                pool = redman.Pool("lqr_line", num_envs=3, seed=6)
                pool.reset()
                shield, actor = redman.Shield(pool, policy, budgets=1e9, options={"zero": False, "hold": False}), policy.actor(pool)
                for _ in range(60):  # three episodes
                    pool.step(shield.act(actor()))
                self.assertEqual((shield.stats.inquiries, shield.interventions), (3 * 3, 0))

                # without noise a planner plays as the policy that proposes
                single = redman.Pool("lqr_line", num_envs=1, seed=7)
                single.reset()
                planner, alone = redman.Planner(single, policy=policy, options={"samples": 1, "horizon": 2}), policy.actor(single)
                for _ in range(45):
                    wanted = np.array(alone())
                    np.testing.assert_array_equal(np.ravel(planner.act()), np.ravel(wanted))
                    single.step(wanted)

                # an evaluation under a shield
                free, kept = (redman.evaluate(policy, "lqr_line", episodes=8, num_envs=4, seed=3, shield=said)
                              for said in (None, {"unproven": "least", "budgets": 0.01}))
                self.assertGreater(free.costs[:, 0].max(), 0.02)
                self.assertLessEqual(kept.costs[:, 0].max(), 0.0101)
                self.assertGreater(kept.interventions, 0)

    def test_it_is_cloned_from_a_recording(self):
        pool = redman.Pool("recall", num_envs=32, seed=3)
        pool.reset()
        shown, cue = redman.Recording(pool), np.zeros(32, np.float32)
        for _ in range(200):
            cue = np.where(pool.obs[:, 0] != 0, pool.obs[:, 0], cue)
            action = (pool.obs[:, 1] * cue)[:, None]
            with shown.step(pool, label=action):
                pool.step(action)
        options = {"memory": "gru:16", "hidden": 16}
        agent = redman.Agent(pool, algo="ppo", seed=1, options=options)
        report = agent.clone(shown, epochs=60, patience=0, learning_rate=1e-2, learning_rate_end=1e-4)
        self.assertLess(report.validation_loss, 0.01)
        run = redman.train("recall", algo="ppo", steps=2000, envs=4, from_=shown, options={**options, "horizon": 20, "imitation": 0.1},
                           teach={"clone_epochs": 60, "clone_rate": 1e-2})
        for policy in (agent.policy(), run.policy):
            pool.reset()
            actor, right = policy.actor(pool), 0.0
            for _ in range(200):
                pool.step(actor())
                right += float(pool.reward.sum())
            self.assertGreaterEqual(right / 320, 0.99)


if __name__ == "__main__":
    unittest.main()
