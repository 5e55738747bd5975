"""redman.omnisafe: its CMDP against single worlds and its settings, always; PPOLag and others of OmniSafe where a copy is at
hand."""
import tempfile
import unittest
from pathlib import Path

import numpy as np

import peers
import stubs

peers.stand_in()
stubs.omnisafe()

import torch

import redman
from redman import gym, omnisafe
from same import same

GPU_IDS = ("ShadowHandOverSafeFinger", "ShadowHandOverSafeJoint", "ShadowHandCatchOver2UnderarmSafeFinger",
           "ShadowHandCatchOver2UnderarmSafeJoint")


class Contract(unittest.TestCase):
    def test_steps_are_those_of_single_worlds(self):
        for n in (1, 3):
            env = omnisafe.Redman("RedmanHandOverSafeFinger-v0", num_envs=n)
            worlds = [gym.Env("hand_over_safe_finger", action_repeat=4, center="initial") for _ in range(n)]
            rows, _ = env.reset(seed=5)
            self.assertEqual(tuple(rows.shape), (398,) if n == 1 else (3, 398))
            first = np.stack([world.reset(seed=5 + i)[0] for i, world in enumerate(worlds)])
            self.assertTrue(same(rows.numpy().reshape(n, -1), first))
            random, ends, kept = np.random.default_rng(1), 0, rows
            for _ in range(24):
                actions = random.uniform(-1, 1, (n, 40)).astype(np.float32)
                obs, reward, cost, terminated, truncated, info = env.step(
                    torch.tensor(actions[0] if n == 1 else actions, dtype=torch.float32))
                told = [x.numpy().reshape(n) for x in (reward, cost, terminated, truncated)]
                for i, world in enumerate(worlds):
                    last, r, end, cut, step = world.step(actions[i])
                    self.assertEqual([x[i] for x in told], [np.float32(r), step["cost"], end, cut])
                    if end or cut:
                        ends += 1
                        self.assertTrue(info["_final_observation"].numpy().reshape(n)[i])
                        self.assertTrue(same(info["final_observation"].numpy().reshape(n, -1)[i], last))
                        last, _ = world.reset()
                    self.assertTrue(same(obs.numpy().reshape(n, -1)[i], last))
            self.assertGreaterEqual(ends, n)
            self.assertTrue(same(kept.numpy().reshape(n, -1), first))  # earlier tensors stay
            env.close()

    def test_a_shield_is_that_of_the_gym(self):
        said = {"shield": {"noise": 0}}
        name = omnisafe.register("RedmanShielded-v0", "hand_over_safe_joint", **said)
        for n in (1, 3):
            env = omnisafe.Redman(name, num_envs=n)
            worlds = [gym.Env("hand_over_safe_joint", action_repeat="task", center="initial", **said) for _ in range(n)]
            began = env.reset(seed=5)[1]
            self.assertEqual((bool(began["applied"].numpy().any()), bool(began["intervened"].numpy().any()), began["shield"]),
                             (False, False, [""] * n))
            for i, world in enumerate(worlds):
                world.reset(seed=5 + i)
            random, refused = np.random.default_rng(1), 0
            for _ in range(30):
                actions = random.uniform(-1, 1, (n, 40)).astype(np.float32)
                info = env.step(torch.tensor(actions[0] if n == 1 else actions, dtype=torch.float32))[-1]
                for i, world in enumerate(worlds):
                    *_, terminated, truncated, told = world.step(actions[i])
                    refused += told["intervened"]
                    self.assertTrue(same(np.asarray(info["applied"].numpy().reshape(n, -1)[i]), told["applied"]))
                    self.assertEqual((info["intervened"].numpy().reshape(n)[i], info["shield"][i]),
                                     (told["intervened"], told["shield"]))
                    if terminated or truncated:
                        world.reset()
            self.assertGreater(refused, 0)
            self.assertEqual(env._worlds.pool.stats.violations, 0)
            env.close()

    def test_seeds(self):
        env = omnisafe.Redman("RedmanHandOverSafeFinger-v0", num_envs=2)
        env.set_seed(7)
        first = env.reset()[0].numpy()
        second = env.reset()[0].numpy()
        self.assertFalse(same(first, second))
        self.assertTrue(same(first, env.reset(seed=7)[0].numpy()))

    def test_what_is_not_read_is_refused(self):
        with self.assertRaisesRegex(redman.UnsupportedError, "modality=rgb: observations of OmniSafe are vectors"):
            omnisafe.Redman("RedmanGrasp-v0", options={"modality": "rgb"})
        env = omnisafe.Redman("RedmanBandit-v0")
        self.assertEqual(env.reset(seed=1, options={})[1].keys(), env.reset(options=None)[1].keys())
        with self.assertRaisesRegex(redman.ArgumentError, "foo"):
            env.reset(options={"foo": 1})
        with self.assertRaisesRegex(redman.NotFoundError, "PPOLagg.*nearest is PPOLag"):
            omnisafe.configs("bandit", "PPOLagg")

    def test_ids(self):
        ids = omnisafe.Redman.support_envs() if hasattr(omnisafe.Redman, "support_envs") else omnisafe.Redman._support_envs
        for name in (*GPU_IDS, *map(omnisafe.env_id, redman.tasks())):
            self.assertIn(name, ids)
            self.assertNotIn("/", name)
        for name in GPU_IDS:
            env = omnisafe.Redman(name, num_envs=2)
            self.assertEqual(env._worlds.pool.spec.action_repeat, 1)  # as its published settings want it
            self.assertIsNone(env._worlds.center)
            self.assertIn(env._worlds.pool.task.name.replace("_", ""), name.lower().replace("shadow", "").replace(
                "catchover2", "catch").replace("handcatch", "catch"))

    def test_what_the_evaluator_gives(self):
        env = omnisafe.Redman("RedmanHandOverSafeFinger-v0", num_envs=1, render_mode="rgb_array", camera_name="track",
                              camera_id=None, width=32, height=24)
        env.reset()
        self.assertEqual((env.render().shape, env.metadata["render_fps"]), ((24, 32, 3), 15))
        named = omnisafe.Redman("RedmanHandOverSafeFinger-v0", camera_name="top")
        named.reset()
        self.assertEqual(named.render().shape, (256, 256, 3))
        with self.assertRaisesRegex(ValueError, "rgb_array"):
            omnisafe.Redman("RedmanBandit-v0", render_mode="human")

    def test_settings_are_what_the_task_knows(self):
        d, c = omnisafe.defaults("hand_over_safe_finger"), omnisafe.configs("hand_over_safe_finger", steps=2e6)
        algo, rows = c["algo_cfgs"], c["algo_cfgs"]["steps_per_epoch"]
        self.assertEqual((algo["gamma"], algo["cost_gamma"], algo["obs_normalize"]), (d.discount, d.discount, True))
        self.assertEqual((c["lagrange_cfgs"]["cost_limit"], c["model_cfgs"]["std_range"][0]), (40, 0.4))
        self.assertEqual((rows % (64 * 19), c["train_cfgs"]["total_steps"] % rows), (0, 0))
        self.assertLess(abs(c["train_cfgs"]["total_steps"] * 4 - 2e6), 2 * rows)
        self.assertNotIn("cost_limit", algo)  # PPOLag has none there
        self.assertEqual(omnisafe.configs("hand_over_safe_finger", options={"object": "ball"})["env_cfgs"],
                         {"options": {"object": "ball"}})

    def test_an_id_with_options(self):
        name = omnisafe.register("RedmanBall-v0", "hand_over_safe_finger", options={"object": "ball"}, action_repeat=2)
        env = omnisafe.Redman(name)
        self.assertEqual((env._worlds.pool.options["object"], env._worlds.pool.spec.action_repeat), ("ball", 2))
        self.assertEqual(env.max_episode_steps, 38)
        for taken in (name, "a/b"):
            with self.assertRaisesRegex(ValueError, "id"):
                omnisafe.register(taken, "bandit")
        with self.assertRaises(TypeError):
            omnisafe.Redman(name, nonsense=1)

    def test_every_task_has_settings(self):
        for task in redman.tasks():
            with self.subTest(task):
                c = omnisafe.configs(task, num_envs=16)
                self.assertEqual(c["algo_cfgs"]["steps_per_epoch"] % 16, 0)
                self.assertGreaterEqual(c["algo_cfgs"]["batch_size"], 1)


@peers.needs("omnisafe", "torch")
class WithOmniSafe(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.quiet = {"use_tensorboard": False, "use_wandb": False, "log_dir": folder.name}

    def short(self, algo, task):
        """Settings that end within seconds."""
        c = omnisafe.configs(task, algo, steps=omnisafe.defaults(task).action_repeat * 8 * 38 * 2, num_envs=8)
        c["logger_cfgs"] = self.quiet
        c["train_cfgs"]["torch_threads"] = 1
        return c

    def test_ppo_lag_learns_and_plays(self):
        import omnisafe as peer
        c = self.short("PPOLag", "hand_over_safe_finger")
        agent = peer.Agent("PPOLag", "RedmanHandOverSafeFinger-v0", custom_cfgs=c)
        ret, cost, length = agent.learn()
        self.assertTrue(1 <= length <= 19 and 0 <= cost <= 75 and ret > 0)
        folder = Path(agent.agent.logger.log_dir)
        self.assertTrue((folder / "progress.csv").is_file())
        if int(torch.__version__.split(".")[0]) >= 2:  # its evaluator wants load_state_dict(assign=)
            agent.evaluate(num_episodes=1)

    def test_evaluator_without_a_normaliser(self):
        import omnisafe as peer
        c = self.short("PPOLag", "hand_over_safe_finger")
        c["algo_cfgs"]["obs_normalize"] = False
        agent = peer.Agent("PPOLag", "RedmanHandOverSafeFinger-v0", custom_cfgs=c)
        agent.learn()
        folder = Path(agent.agent.logger.log_dir)
        evaluator = peer.Evaluator(render_mode="rgb_array")
        model = sorted((folder / "torch_save").glob("*.pt"))[-1].name
        evaluator.load_saved(save_dir=str(folder), model_name=model, camera_name="track", width=64, height=64)
        returns, costs = evaluator.evaluate(num_episodes=2)
        self.assertEqual((len(returns), len(costs)), (2, 2))

    def test_other_algorithms_take_the_settings(self):
        import omnisafe as peer
        for algo in ("TRPOLag", "CPO", "FOCOPS", "CPPOPID", "P3O"):
            with self.subTest(algo):
                agent = peer.Agent(algo, "RedmanBandit-v0" if algo == "CPO" else "RedmanHandOverSafeFinger-v0",
                                   custom_cfgs=self.short(algo, "bandit" if algo == "CPO" else "hand_over_safe_finger"))
                self.assertTrue(np.isfinite(agent.learn()).all())

    def test_an_off_policy_one(self):
        import omnisafe as peer
        c = omnisafe.configs("hand_over_safe_finger", "DDPGLag", steps=4 * 400, num_envs=1)
        c["train_cfgs"].update(torch_threads=1, total_steps=400)
        c["algo_cfgs"].update(steps_per_epoch=200, start_learning_steps=100, update_iters=1)
        c["logger_cfgs"] = self.quiet
        agent = peer.Agent("DDPGLag", "RedmanHandOverSafeFinger-v0", custom_cfgs=c)
        self.assertTrue(np.isfinite(agent.learn()).all())

    def test_the_gpu_ids_take_their_published_settings(self):
        import omnisafe as peer
        c = {"train_cfgs": {"total_steps": 8 * 75, "vector_env_nums": 8, "torch_threads": 1},
             "algo_cfgs": {"steps_per_epoch": 8 * 75, "batch_size": 300},
             "logger_cfgs": self.quiet}
        agent = peer.Agent("PPOLag", "ShadowHandOverSafeFinger", custom_cfgs=c)
        self.assertEqual(list(agent.cfgs.model_cfgs.actor.hidden_sizes), [1024, 1024, 512])
        self.assertTrue(np.isfinite(agent.learn()).all())


class Peers(unittest.TestCase):
    def test_with_the_copy(self):
        found, gyms = peers.copies("omnisafe"), peers.copies("gymnasium-0.28")
        safety = peers.copies("safety-gymnasium")
        if not found or not gyms or not safety:
            self.skipTest("REDMAN_PEERS names no folder with omnisafe, safety-gymnasium and gymnasium-0.28.1 in it")
        peers.rerun(self, "test_python_omnisafe", ("Contract", "WithOmniSafe"), found[-1], gyms[-1], safety[-1])


if __name__ == "__main__":
    unittest.main()
