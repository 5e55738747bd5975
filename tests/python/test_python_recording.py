"""Recording: rows of pools, arrays and files; what agents and pools take of them: cloning, the imitation term, starts, a policy
to begin with, values."""
import copy
import os
import pickle
import tempfile
import unittest

import numpy as np

import redman
from memory import grown
from same import same

TASK = "ball_run"


def recorded(steps=60, n=3, label=None):
    pool = redman.Pool(TASK, n, seed=2)
    pool.reset()
    recording = redman.Recording(pool)
    rows = []
    for _ in range(steps):
        pool.baseline("random")
        before = pool.obs.copy(), pool.action.copy()
        with recording.step(pool, label):
            pool.step()
        rows.append((*before, pool.reward.copy(), pool.cost.copy()))
    return pool, recording, rows


class Rows(unittest.TestCase):
    def test_they_are_what_the_worlds_saw_did_and_got(self):
        pool, recording, rows = recorded()
        self.assertEqual((len(recording), recording.info.episodes, recording.task), (180, 3, TASK))
        for name, k in (("obs", 0), ("action", 1), ("reward", 2), ("cost", 3)):
            self.assertTrue(same(getattr(recording, name), np.concatenate([row[k] for row in rows])), name)
        self.assertTrue(same(recording.label, recording.action))
        self.assertEqual(recording.terminated.dtype, np.bool_)
        self.assertEqual(recording.episode.max(), 2)

    def test_a_label_and_a_mask(self):
        pool = redman.Pool(TASK, 2)
        pool.reset()
        recording = redman.Recording(pool)
        meant = np.full((2, pool.action_dim), 0.5)
        with recording.step(pool, meant, mask=[True, False]):
            pool.step(np.zeros((2, pool.action_dim)))
        self.assertEqual(len(recording), 1)
        self.assertTrue((recording.label == 0.5).all() and (recording.action == 0).all())

    def test_arrays_are_copies_that_outlive_it(self):
        _, recording, _ = recorded(5)
        obs = recording.obs
        kept = obs.copy()
        recording.clear()
        self.assertTrue(same(obs, kept))
        self.assertEqual((len(recording), recording.obs.shape, bool(recording)), (0, (0, 7), True))
        self.assertNotIn("points", recording.arrays())

    def test_a_file_is_numpys_and_reads_back(self):
        _, recording, _ = recorded()
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "r.npz")
            recording.save(path)
            with np.load(path) as file:
                self.assertTrue(same(file["obs"], recording.obs))
            for again in (redman.Recording.load(path), redman.load(path)):
                self.assertEqual(again.info, recording.info)
                self.assertTrue(same(again.arrays(), recording.arrays()))
            with np.load(path) as file:
                np.savez(os.path.join(folder, "r.npz"), **file)
            self.assertTrue(same(redman.Recording.load(path).arrays(), recording.arrays()))
            with self.assertRaisesRegex(redman.MissingFileError, "nearest is r.npz"):
                redman.Recording.load(os.path.join(folder, "s.npz"))

    def test_pickles_and_copies_are_the_same_rows(self):
        _, recording, _ = recorded(12)
        for again in (pickle.loads(pickle.dumps(recording)), copy.deepcopy(recording)):
            self.assertEqual(again.info, recording.info)
            self.assertTrue(same(again.arrays(), recording.arrays()))

    def test_rows_of_ones_own(self):
        recording = redman.Recording(obs_dim=3, action_dim=1, cost_dim=2, task="mine")
        cost = np.array([[0, 0], [3, 0], [0, 0], [0, 9], [0, 0]])
        recording.append(obs=np.zeros((5, 3)), action=np.ones((5, 1)), reward=range(5), cost=cost, truncated=[0, 0, 1, 0, 1],
                         success=[0, 1, 0, 0, 0])
        self.assertEqual(recording.episode.tolist(), [0, 0, 0, 1, 1])
        recording.append(recording.__class__(obs_dim=3, action_dim=1, cost_dim=2, task="mine"))
        other = copy.deepcopy(recording)
        self.assertEqual((recording.filter(success=True), len(recording)), (1, 3))
        self.assertEqual((other.filter(max_cost=[None, 5]), other.reward.tolist()), (1, [0, 1, 2]))
        other.append(recording)
        self.assertEqual((len(other), other.info.episodes), (6, 2))

    def test_errors_say_what_may_be(self):
        pool, recording, _ = recorded(2)
        for call, words in (
                (lambda: redman.Recording(), "give a pool, or obs_dim and action_dim"),
                (lambda: redman.Recording(pool, obs_dim=3), "give either a pool"),
                (lambda: redman.Recording("r.npz"), r"Recording\.load"),
                (lambda: recording.append(obs=np.zeros((2, 7))), "obs and action"),
                (lambda: recording.append(obs=np.zeros((2, 6)), action=np.zeros((2, 2))), r"is \(2, 6\), but it must be \(2, 7\)"),
                (lambda: recording.append(obs=np.full((2, 7), np.nan), action=np.zeros((2, 2))), "finite"),
                (lambda: recording.append(np.zeros(3)), "other: it must be a redman.Recording"),
                (lambda: recording.filter(max_cost=[1, 2]), "it has 2 limits, but there are 3 costs"),
                (lambda: recording.observations, "Recording.observations: obs")):
            with self.assertRaisesRegex((redman.Error, AttributeError), words):
                call()
        self.assertEqual(len(recording), 6)

    def test_memory_does_not_grow_where_it_has_room(self):
        pool = redman.Pool(TASK)
        pool.reset()
        recording = redman.Recording(pool, capacity=4096)

        def act():
            with recording.step(pool):
                pool.step()
        self.assertLess(grown(act), 8000)  # the smallest object a step would be 16,000


class Learning(unittest.TestCase):
    def test_a_clone_does_what_was_meant(self):
        meant = np.full((3, 2), 0.5)
        pool, recording, _ = recorded(100, label=meant)
        agent = redman.Agent(pool)
        report = agent.clone(recording, epochs=40, learning_rate=3e-3)
        self.assertLess(report.validation_loss, 1e-2)
        self.assertEqual(len(report.train_losses), report.epochs)
        self.assertEqual(report.validation_losses[report.best_epoch - 1], report.validation_loss)
        self.assertLess(np.abs(agent.act(pool.obs, "mean") - 0.5).max(), 0.1)
        with self.assertRaisesRegex(redman.UsageError, r"redman\.Recording\.load"):
            agent.clone("r.npz")
        with self.assertRaisesRegex(redman.RangeError, "validation"):
            agent.clone(recording, validation=2)

    def test_an_agent_is_held_near_a_recording_and_keeps_it(self):
        pool, recording, _ = recorded(40)
        other, held = (redman.Agent(pool, options={"horizon": 32, "imitation": 1.0}) for _ in range(2))
        with self.assertRaisesRegex(redman.StateError, "agent.recording = recording"):
            held.rollout(pool)
        other.recording, held.recording = recorded(40, label=np.full((3, 2), 0.9))[1], recording
        worlds = [redman.Pool(TASK, 3, seed=4) for _ in range(3)]
        for pool in worlds:
            pool.reset()
        again = pickle.loads(pickle.dumps(held))
        self.assertEqual(again.recording.info, recording.info)
        for agent, pool in zip((other, held, again), worlds):
            agent.rollout(pool)
        states = [agent.save() for agent in (other, held, again)]
        self.assertNotEqual(states[0], states[1])
        self.assertEqual(states[1], states[2])
        held.recording = None
        self.assertIsNone(held.recording)

    def test_a_warm_start_is_the_policy(self):
        pool, _, _ = recorded(1)
        policy = redman.Policy.trained(TASK)
        agent = redman.Agent(pool)
        agent.warm_start("trained")
        self.assertLess(np.abs(np.clip(agent.act(pool.obs, "mean"), -1, 1) - policy.act(pool.obs)).max(), 1e-5)
        with self.assertRaisesRegex(redman.ArgumentError, "hidden"):
            redman.Agent(pool, options={"hidden": [8, 8]}).warm_start(policy)

    def test_values_are_the_critics(self):
        pool, _, _ = recorded(1)
        agent = redman.Agent(pool, options={"normalize_reward": False, "normalize_cost": False})
        value, cost = agent.values(pool.obs)
        self.assertEqual((value.shape, cost.shape), ((3,), (3, 3)))
        one, column = agent.values(pool.obs[1])
        self.assertEqual(one, value[1])
        self.assertTrue(np.array_equal(column, cost[1]))
        with self.assertRaisesRegex(redman.ArgumentError, r"obs: its shape is \(3, 6\), but"):
            agent.values(np.zeros((3, 6)))
        with self.assertRaises(redman.UnsupportedError):
            redman.Agent(pool, options={"normalize_reward": True}).values(pool.obs)

    def test_episodes_begin_at_recorded_states(self):
        _, recording, _ = recorded(60)
        pool = redman.Pool(TASK, 16, seed=9)
        pool.set_starts(recording, 1.0)
        pool.reset()
        again = pickle.loads(pickle.dumps(pool))
        self.assertTrue(same(again.obs, pool.obs))
        starts = recording.obs[recording.arrays()["state_row"]]
        gap = np.abs(pool.obs[:, None] - starts[None]).max(axis=2).min(axis=1)
        self.assertLess(gap.max(), 1e-3)
        for worlds in (pool, again):
            for _ in range(pool.max_steps + 2):
                worlds.step(worlds.baseline("zero"))
        self.assertTrue(same(again.obs, pool.obs))
        plain = redman.Pool(TASK, 16, seed=9)
        plain.reset()
        self.assertGreater(np.abs(plain.obs[:, None] - starts[None]).max(axis=2).min(axis=1).max(), 1e-3)
        pool.set_starts(None, 0.0)
        with self.assertRaisesRegex(redman.UsageError, "recording: it must be a redman.Recording"):
            pool.set_starts("r.npz", 1.0)

    def test_an_encoder_learns_to_tell_points_apart(self):
        options = {"encoder": "8,8", "encoder_points": 16, "encoder_classes": 0}
        agent = redman.Agent(obs_dim=3, action_dim=1, num_envs=2, options=options)
        points = np.random.default_rng(0).uniform(-0.2, 0.2, (24, 16, 3))
        report = agent.pretrain(points, points[:, :, 2] > 0, 2, epochs=30, learning_rate=1e-2)
        self.assertGreater(report.accuracy, report.most_common)
        with self.assertRaises(redman.StateError):
            redman.Agent(obs_dim=3, action_dim=1).pretrain(points, points[:, :, 2] > 0, 2)


class Policies(unittest.TestCase):
    def test_samples_are_what_put_takes(self):
        pool, _, _ = recorded(1)
        policy = redman.Agent(pool).policy()
        action, mean = policy.sample(pool.obs, np.zeros((3, 2)))
        self.assertTrue(same(action, mean))
        drawn, _ = policy.sample(pool.obs, np.ones((3, 2)))
        self.assertTrue((drawn > mean).all())
        self.assertFalse(same(policy.sample(pool.obs)[0], mean))
        with self.assertRaisesRegex(redman.ArgumentError, "noise"):
            policy.sample(pool.obs, np.ones((2, 2)))

    def test_it_names_the_parts_of_a_row(self):
        pool, _, _ = recorded(1)
        policy = redman.Agent(pool).policy()
        self.assertEqual({name: field.slice for name, field in policy.fields.items()},
                         {name: field.slice for name, field in pool.fields.items()})

    @unittest.skipUnless(os.environ.get("REDMAN_TOOL"), "no tool in this build")
    def test_it_is_exported_by_the_ending_of_a_path(self):
        policy = redman.Policy.trained(TASK)
        with tempfile.TemporaryDirectory() as folder:
            for ending in ("onnx", "c", "safetensors", "rdm"):
                path = os.path.join(folder, f"p.{ending}")
                policy.export(path)
                self.assertGreater(os.path.getsize(path), 1000)
            self.assertIn("safe_", open_text(policy, folder, name="safe"))
            self.assertEqual(redman.load(path).info, policy.info)
            with self.assertRaisesRegex(redman.ArgumentError, "nearest is .onnx"):
                policy.export(os.path.join(folder, "p.onx"))
            with self.assertRaisesRegex(redman.ArgumentError, "only be given for a .c file"):
                policy.export(os.path.join(folder, "p.onnx"), int8=True)


def open_text(policy, folder, **arguments):
    path = os.path.join(folder, "named.c")
    policy.export(path, **arguments)
    with open(path, encoding="utf-8") as file:
        return file.read()


if __name__ == "__main__":
    unittest.main()
