"""redman.sb3: its VecEnv against single worlds, always; Stable-Baselines3's own checks and PPO where it is at hand."""
import sys
import unittest
import warnings

import numpy as np

import peers
import stubs

peers.stand_in()
stubs.sb3()

import redman
from redman import gym, sb3
from same import same


class Contract(unittest.TestCase):
    def test_steps_are_those_of_single_worlds(self):
        vec = sb3.VecEnv("hand_over_safe_finger", 3)
        worlds = [gym.Env("hand_over_safe_finger") for _ in range(3)]
        vec.seed(5)
        rows = vec.reset()
        self.assertTrue(same(rows, np.stack([env.reset(seed=5 + i)[0] for i, env in enumerate(worlds)])))
        vec.action_space.seed(1)
        ends = 0
        for _ in range(90):
            actions = np.stack([vec.action_space.sample() for _ in worlds])
            obs, reward, done, infos = vec.step(actions)
            self.assertEqual((obs.dtype, reward.dtype, done.dtype), (np.float32, np.float32, bool))
            for i, env in enumerate(worlds):
                last, r, terminated, truncated, info = env.step(actions[i])
                self.assertEqual((reward[i], done[i]), (np.float32(r), terminated or truncated))
                self.assertTrue(all(same(infos[i][key], value) for key, value in info.items()))
                self.assertIs(infos[i]["TimeLimit.truncated"], truncated and not terminated)
                self.assertEqual("terminal_observation" in infos[i], bool(done[i]))
                if done[i]:
                    ends += 1
                    self.assertTrue(same(infos[i]["terminal_observation"], last))
                    last, _ = env.reset()
                self.assertTrue(same(obs[i], last))
        self.assertGreaterEqual(ends, 3)

    def test_seeds_hold_for_one_reset(self):
        vec = sb3.VecEnv("hand_over_safe_finger", 2)
        vec.seed(5)
        first, second = vec.reset(), vec.reset()
        self.assertFalse(same(first, second))
        vec.seed(5)
        self.assertTrue(same(first, vec.reset()))

    def test_penalty(self):
        plain, fined = sb3.VecEnv("bandit", 2, seed=1), sb3.VecEnv("bandit", 2, seed=1, penalty=0.5)
        plain.reset(), fined.reset()
        actions = np.float32([[0.5], [-0.5]])
        (_, reward, _, infos), (_, less, _, _) = plain.step(actions), fined.step(actions)
        np.testing.assert_allclose(less, reward - 0.5 * np.array([info["cost"] for info in infos]), rtol=1e-6)
        self.assertLess(less[0], reward[0])
        self.assertEqual(less[1], reward[1])

    def test_attributes_and_methods_of_worlds(self):
        vec = sb3.VecEnv("hand_over_safe_finger", 3, render_mode="rgb_array", width=32, height=24, seed=1)
        vec.reset()
        self.assertEqual(vec.get_attr("cost_names", [0, 2]), [vec.cost_names] * 2)
        self.assertEqual([picture.shape for picture in vec.get_images()], [(24, 32, 3)] * 3)
        self.assertEqual([p.shape for p in vec.env_method("render", indices=1)], [(24, 32, 3)])
        self.assertEqual(vec.env_method("hash"), [vec.pool.hash(i) for i in range(3)])
        vec.set_attr("penalty", 2.0)
        self.assertEqual(vec.penalty, 2)
        with self.assertRaisesRegex(ValueError, "share"):
            vec.set_attr("penalty", 1.0, indices=[0])
        with self.assertRaises(AttributeError):
            vec.get_attr("nonsense")
        with self.assertRaisesRegex(AttributeError, "nonsense"):
            vec.env_method("nonsense")
        self.assertEqual(vec.env_is_wrapped(object), [False] * 3)
        self.assertEqual(vec.env_is_wrapped(sys.modules["stable_baselines3.common.monitor"].Monitor), [True] * 3)
        vec.close()

    def test_an_ended_episode_tells_what_monitor_tells(self):
        vec = sb3.VecEnv("hand_over_safe_finger", 3, seed=1, action_repeat=2, penalty=0.5)
        vec.reset()
        self.assertEqual(set(vec.reset_infos[0]), {"cost", "costs", "success", "status", "episode_status", "TimeLimit.truncated"})
        vec.action_space.seed(1)
        total, length, costs, success = np.zeros(3), np.zeros(3, int), np.zeros((3, 8)), np.zeros(3, bool)
        ends = 0
        for _ in range(120):
            _, reward, done, infos = vec.step(np.stack([vec.action_space.sample() for _ in range(3)]))
            total, length = total + reward, length + 1
            costs, success = costs + [info["costs"] for info in infos], success | [info["success"] for info in infos]
            for i, info in enumerate(infos):
                self.assertEqual("episode" in info, bool(done[i]))
                if not done[i]:
                    continue
                ends += 1
                self.assertAlmostEqual(info["episode"]["r"], total[i], places=4)
                self.assertEqual((info["episode"]["l"], info["is_success"]), (length[i], success[i]))
                self.assertGreater(info["episode"]["t"], 0)
                self.assertEqual(list(info["episode_cost"]), list(vec.cost_names))
                np.testing.assert_allclose(list(info["episode_cost"].values()), costs[i], rtol=1e-6)
                total[i] = length[i] = costs[i] = success[i] = 0
        self.assertGreaterEqual(ends, 3)

    def test_what_cannot_be_given_is_refused(self):
        with self.assertRaisesRegex(redman.UnsupportedError, "modality=rgb: .*DummyVecEnv"):
            sb3.VecEnv("grasp", 2, options={"modality": "rgb"})
        vec = sb3.VecEnv("bandit", 2)
        vec._options = [{"points": 3}] * 2
        with self.assertRaisesRegex(redman.ArgumentError, "points"):
            vec.reset()

    def test_a_shield_is_that_of_the_gym(self):
        said = {"options": {"action_repeat": 4}, "shield": {"noise": 0}}
        vec = sb3.VecEnv("hand_over_safe_joint", 3, **said)
        worlds = [gym.Env("hand_over_safe_joint", **said) for _ in range(3)]
        vec.seed(5)
        vec.reset()
        self.assertEqual([vec.reset_infos[0][key] for key in ("intervened", "shield")], [False, ""])
        for i, env in enumerate(worlds):
            env.reset(seed=5 + i)
        vec.action_space.seed(1)
        refused = 0
        for _ in range(30):
            actions = np.stack([vec.action_space.sample() for _ in worlds])
            *_, done, infos = vec.step(actions)
            for i, env in enumerate(worlds):
                told = env.step(actions[i])[-1]
                refused += told["intervened"]
                self.assertTrue(all(same(infos[i][key], value) for key, value in told.items()))
                if done[i]:
                    again = env.reset()[1]
                    self.assertTrue(all(same(vec.reset_infos[i][key], again[key]) for key in ("applied", "intervened", "shield")))
        self.assertGreater(refused, 0)
        self.assertEqual((vec.pool.stats.violations, vec.shield.stats.decisions), (0, 90))
        vec.close()

    def test_wrong_actions(self):
        vec = sb3.VecEnv("bandit", 2)
        vec.reset()
        with self.assertRaisesRegex(ValueError, "action: its shape"):
            vec.step(np.zeros((2, 3)))


class Defaults(unittest.TestCase):
    def test_what_a_task_says(self):
        d, said = sb3.defaults("hand_over_safe_finger"), redman.tasks()["hand_over_safe_finger"].defaults
        self.assertEqual(d.action_repeat, int(said["action_repeat"]))
        self.assertAlmostEqual(d.discount, float(said["discount"])**d.action_repeat)
        self.assertEqual((d.init_std, d.cost_limit, d.hidden), (float(said["init_std"]), 40, (128, 128)))
        self.assertEqual(d.episode, 19)  # 75 control steps, 4 at a time
        self.assertAlmostEqual(d.multiplier_lr, float(said["multiplier_lr"]) / 40)
        self.assertEqual(d.center.shape, (40,))
        self.assertGreater(np.abs(d.center).max(), 0)

    def test_every_task_has_them(self):
        for task in redman.tasks():
            with self.subTest(task):
                d = sb3.defaults(task)
                self.assertTrue(0 < d.discount <= 1 and d.init_std > 0 and d.action_repeat >= 1 and d.episode >= 1)
                self.assertTrue(np.all(np.abs(d.center) <= 1))


@peers.needs("stable_baselines3", "torch")
class WithStableBaselines3(unittest.TestCase):
    def test_check_env(self):
        from stable_baselines3.common.env_checker import check_env
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for task in ("hand_over_safe_finger", "bandit"):
                check_env(gym.Env(task))

    def test_ppo_with_what_the_task_knows(self):
        from stable_baselines3 import PPO
        from stable_baselines3.common.vec_env import VecMonitor, VecNormalize
        vec = VecMonitor(sb3.VecEnv("hand_over_safe_finger", 16, seed=1, action_repeat="task", center="initial"))
        env = VecNormalize(vec, norm_reward=False, clip_obs=5)
        kwargs = sb3.ppo_kwargs("hand_over_safe_finger", num_envs=16)
        model = PPO("MlpPolicy", env, seed=1, device="cpu", **kwargs)
        self.assertAlmostEqual(float(model.policy.log_std.exp().mean()), 0.4, places=5)
        model.learn(4 * 16 * kwargs["n_steps"])
        self.assertEqual(model.num_timesteps, 4 * 16 * kwargs["n_steps"])
        self.assertGreater(len(model.ep_info_buffer), 10)
        action, _ = model.predict(env.reset(), deterministic=True)
        self.assertEqual(action.shape, (16, 40))

    def test_the_log_has_returns_lengths_successes_and_costs(self):
        from stable_baselines3 import PPO
        from stable_baselines3.common.evaluation import evaluate_policy
        from stable_baselines3.common.logger import configure
        env = sb3.VecEnv("hand_over_safe_finger", 8, seed=1, action_repeat="task", center="initial")
        model = PPO("MlpPolicy", env, n_steps=32, batch_size=64, device="cpu")
        logger = configure(None, [])
        seen = {}
        dump = logger.dump
        logger.dump = lambda step: (seen.update(logger.name_to_value), dump(step))
        model.set_logger(logger)
        model.learn(2 * 8 * 32, callback=sb3.CostCallback())
        for key in ("ep_rew_mean", "ep_len_mean", "success_rate", "ep_cost_mean/cost", "ep_cost_mean/ff2_range"):
            self.assertIn("rollout/" + key, seen)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            evaluate_policy(model, sb3.VecEnv("hand_over_safe_finger", 2, seed=1), 2)

    def test_pictures_reach_a_multi_input_policy(self):
        from stable_baselines3 import PPO
        from stable_baselines3.common.vec_env import DummyVecEnv
        options = {"modality": "rgb+points", "points": 32, "max_steps": 4}
        env = DummyVecEnv([lambda: gym.Env("grasp", options=options)] * 2)
        PPO("MultiInputPolicy", env, n_steps=4, batch_size=8, n_epochs=1, device="cpu").learn(8)

    def test_dummy_vec_env_bit_for_bit(self):
        from stable_baselines3.common.vec_env import DummyVecEnv
        theirs, ours = DummyVecEnv([lambda: gym.Env("hand_over_safe_finger")] * 3), sb3.VecEnv("hand_over_safe_finger", 3)
        theirs.seed(5), ours.seed(5)
        self.assertTrue(same(ours.reset(), theirs.reset()))
        ours.action_space.seed(1)
        for _ in range(90):
            actions = np.stack([ours.action_space.sample() for _ in range(3)])
            mine, other = ours.step(actions), theirs.step(actions)
            for info in mine[3]:
                for key in ("episode", "is_success", "episode_cost"):  # a Monitor would give
                    info.pop(key, None)
            self.assertTrue(same(mine, other))


class Peers(unittest.TestCase):
    def test_with_every_copy(self):
        found, gyms = peers.copies("sb3-"), peers.copies("gymnasium-")
        if not found or not gyms:
            self.skipTest("REDMAN_PEERS names no folder with sb3-VERSION and gymnasium-VERSION in it")
        for path in found:
            with self.subTest(path.name):  # 2.3 wants Gymnasium 0.28 or 0.29, later ones take 1.x
                peers.rerun(self, "test_python_sb3", ("Contract", "Defaults", "WithStableBaselines3"), path,
                            gyms[0 if path.name.startswith("sb3-2.3") else -1])


if __name__ == "__main__":
    unittest.main()
