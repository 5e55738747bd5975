"""redman.safety: six values, and Safety-Gymnasium's own make, checker and vectors where a copy is at hand."""
import unittest

import numpy as np

import peers
import stubs

peers.stand_in()
stubs.safety()

import redman
from redman import gym, safety
from same import same, shaped


class Contract(unittest.TestCase):
    def test_six_values_are_those_of_the_gym(self):
        with safety.Env("hand_over_safe_finger") as env, gym.Env("hand_over_safe_finger") as other:
            self.assertTrue(same(env.reset(seed=3)[0], other.reset(seed=3)[0]))
            for _ in range(20):
                action = np.full(40, 0.5, np.float32)
                obs, reward, cost, terminated, truncated, info = env.step(action)
                theirs = other.step(action)
                self.assertTrue(same((obs, reward, terminated, truncated), theirs[:4]))
                self.assertIs(type(cost), float)
                self.assertEqual((cost, info["cost_sum"]), (theirs[4]["cost"],) * 2)
                for name, value in zip(env.cost_names[1:], theirs[4]["costs"][1:]):
                    self.assertEqual(info["cost_" + name], value)

    def test_vectors_end_as_safety_gymnasium_has_it(self):
        with safety.VectorEnv("hand_over_safe_finger", 3) as envs:
            worlds = [safety.Env("hand_over_safe_finger") for _ in range(3)]
            rows, _ = envs.reset(seed=5)
            self.assertTrue(same(rows, np.stack([env.reset(seed=5 + i)[0] for i, env in enumerate(worlds)])))
            envs.action_space.seed(1)
            ends = 0
            for _ in range(90):
                actions = envs.action_space.sample()
                obs, reward, cost, terminated, truncated, info = envs.step(actions)
                for i, env in enumerate(worlds):
                    last, *values, told = env.step(actions[i])
                    self.assertEqual([reward[i], cost[i], terminated[i], truncated[i]], values)
                    if terminated[i] or truncated[i]:
                        ends += 1
                        self.assertTrue(same(info["final_observation"][i], last))
                        self.assertTrue(same(info["final_info"][i], told))
                        self.assertEqual(info["cost_sum"][i], 0)  # of the reset
                        last, _ = env.reset()
                    else:
                        self.assertEqual(info["cost_sum"][i], told["cost_sum"])
                    self.assertTrue(same(obs[i], last))
            self.assertGreaterEqual(ends, 3)

    def test_a_shield_is_that_of_the_gym(self):
        said = {"options": {"action_repeat": 4}, "shield": {"noise": 0}}
        with safety.VectorEnv("hand_over_safe_joint", 3, **said) as envs:
            ones = [gym.Env("hand_over_safe_joint", **said) for _ in range(3)]
            envs.reset(seed=5)
            for i, one in enumerate(ones):
                one.reset(seed=5 + i)
            envs.action_space.seed(1)
            refused = 0
            for _ in range(30):
                actions = envs.action_space.sample()
                *_, cost, terminated, truncated, info = envs.step(actions)
                for i, one in enumerate(ones):
                    told = one.step(actions[i])[-1]
                    refused += told["intervened"]
                    mine = {key: info[key][i] for key in ("applied", "intervened", "shield")}
                    if terminated[i] or truncated[i]:
                        self.assertEqual((mine["intervened"], mine["shield"]), (False, ""))
                        mine = info["final_info"][i]
                        one.reset()
                    self.assertTrue(same(mine["applied"], told["applied"]))
                    self.assertEqual((mine["intervened"], mine["shield"]), (told["intervened"], told["shield"]))
            self.assertGreater(refused, 0)
            self.assertEqual(envs.pool.stats.violations, 0)
        with safety.Env("hand_over_safe_joint", **said) as env:
            self.assertEqual(shaped(env.reset(seed=1)[1]), shaped(env.step(env.action_space.sample())[-1]))

    def test_every_task_has_an_id(self):
        from gymnasium.envs.registration import registry
        self.assertIsNone(safety.unregistered)
        self.assertEqual(safety.env_id("hand_over_safe_finger"), "SafetyRedmanHandOverSafeFinger-v0")
        for task in redman.tasks():
            self.assertIn(safety.env_id(task), registry)
            self.assertIn("Safety" + gym.camel(task) + "-v0", registry)  # ours, or that of a namesake

    def test_infos_of_a_reset_have_the_keys_of_a_step(self):
        with safety.Env("hand_over_safe_finger") as env:
            began = env.reset(seed=1)[1]
            stepped = env.step(np.ones(40, np.float32))[-1]
            self.assertEqual(shaped(began), shaped(stepped))
            self.assertFalse(any(began.values()))
        with safety.VectorEnv("hand_over_safe_finger", 2) as envs:
            began = envs.reset(seed=1)[1]
            self.assertEqual(shaped(began), shaped(envs.step(np.ones((2, 40), np.float32))[-1]))

    def test_what_worlds_see(self):
        with safety.Env("grasp", options={"modality": "depth"}) as env:
            self.assertEqual(list(env.reset(seed=1)[0]), ["state", "depth"])
        with self.assertRaisesRegex(redman.UnsupportedError, "modality=points"):
            safety.VectorEnv("grasp", 2, options={"modality": "points"})


@peers.needs("safety_gymnasium", "gymnasium")
class WithSafetyGymnasium(unittest.TestCase):
    def test_an_id_of_ours_is_our_environment(self):
        import safety_gymnasium
        from gymnasium.envs.registration import registry
        self.assertIsNone(safety.unregistered)
        for task in redman.tasks():
            made = safety_gymnasium.make(safety.env_id(task)).unwrapped
            self.assertEqual((type(made), made.pool.task.name), (safety.Env, task))
            made.close()
        # its namesakes stay its own
        self.assertNotEqual(registry["SafetyPointGoal1-v0"].entry_point, "redman.safety:Env")
        self.assertEqual(registry["SafetyHandOverSafeFinger-v0"].entry_point, "redman.safety:Env")

    def test_make_with_its_checker(self):
        import safety_gymnasium
        for task in ("hand_over_safe_finger", "grasp", "bandit"):
            env = safety_gymnasium.make(safety.env_id(task), render_mode="rgb_array")
            self.assertIn("SafePassiveEnvChecker", str(env))
            obs, _ = env.reset(seed=1)
            self.assertIn(obs, env.observation_space)
            self.assertEqual(len(env.step(env.action_space.sample())), 6)
            self.assertEqual(env.render().shape, (240, 320, 3))
            env.close()

    def test_vectors_sync_and_async_bit_for_bit(self):
        import safety_gymnasium
        for asynchronous in (False, True):
            with self.subTest(asynchronous=asynchronous):
                theirs = safety_gymnasium.vector.make(safety.env_id("hand_over_safe_finger"), 3, asynchronous)
                ours = safety.VectorEnv("hand_over_safe_finger", 3)
                self.assertTrue(same(ours.reset(seed=5), theirs.reset(seed=5)))
                ours.action_space.seed(1)
                for _ in range(90):
                    actions = ours.action_space.sample()
                    mine, other = ours.step(actions), theirs.step(actions)
                    self.assertTrue(same(mine, other), f"{mine}\n{other}")
                theirs.close()
                ours.close()

    def test_its_wrappers(self):
        import safety_gymnasium
        from safety_gymnasium.wrappers import SafeAutoResetWrapper, SafeNormalizeObservation, SafeTimeLimit, SafeUnsqueeze
        env = safety_gymnasium.make(safety.env_id("hand_over_safe_finger"))
        env = SafeUnsqueeze(SafeNormalizeObservation(SafeAutoResetWrapper(SafeTimeLimit(env, 5))))
        env.reset(seed=1)
        for t in range(5):
            obs, reward, cost, terminated, truncated, info = env.step(env.action_space.sample())
        self.assertEqual((obs.shape, cost.shape, bool(truncated[0])), ((1, 398), (1,), True))
        self.assertIn("final_observation", info)


class Peers(unittest.TestCase):
    def test_with_the_copy(self):
        found, gyms = peers.copies("safety-gymnasium"), peers.copies("gymnasium-0.28")
        if not found or not gyms:
            self.skipTest("REDMAN_PEERS names no folder with safety-gymnasium and gymnasium-0.28.1 in it")
        peers.rerun(self, "test_python_safety", ("Contract", "WithSafetyGymnasium"), found[-1], gyms[-1])


if __name__ == "__main__":
    unittest.main()
