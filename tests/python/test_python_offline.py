"""Agent.learn_from: a policy from recorded rows alone, what it reports, and what it refuses."""
import copy
import json
import tempfile
import unittest
from pathlib import Path

import numpy as np
import redman


def recorded(episodes=40, seed=0):
    """A line: the observation is where one is, the reward is that the action is 0.5 there, a positive action costs its size."""
    rng = np.random.default_rng(seed)
    rows = 5 * episodes
    obs = rng.uniform(-1, 1, (rows, 1)).astype(np.float32)
    action = rng.uniform(-1, 1, (rows, 1)).astype(np.float32)
    terminated = np.arange(rows) % 5 == 4
    recording = redman.Recording(obs_dim=1, action_dim=1, cost_dim=1)
    recording.append(obs=obs, action=action, reward=-((action[:, 0] - 0.5) ** 2), cost=np.maximum(action, 0), terminated=terminated)
    return recording


def learner(algo="td3_bc_lag", seed=0, threads=0, **options):
    return redman.Agent(algo=algo, seed=seed, threads=threads, obs_dim=1, action_dim=1, num_envs=1, cost_dim=1, max_steps=5,
                        options={"hidden": "16", "replay_rows": 400, **options})


class Offline(unittest.TestCase):
    def test_it_climbs_the_reward_within_the_limit(self):
        recording = recorded(80)
        far = dict(learning_rate=3e-3, bc_alpha=100.0, batch_rows=64, discount=0.5)
        free, held = learner(cost_limit=100.0, **far), learner(cost_limit=1.0, multiplier_lr=0.05, multiplier_gain=0.5, **far)
        at = np.linspace(-0.8, 0.8, 9, dtype=np.float32)[:, None]
        actions = []
        for agent in (free, held):
            report = agent.learn_from(recording, 4000)
            self.assertEqual((report.steps, report.rows, report.skipped_gradients), (4000, 400, 0))
            actions.append(np.concatenate([agent.act(x[None], "mean") for x in at]))
        self.assertTrue((abs(actions[0] - 0.5) < 0.15).all(), actions[0].T)
        # five decisions of an episode have 1 together: 0.2 each
        self.assertLess(abs(actions[1].mean() - 0.2), 0.1, actions[1].T)
        self.assertLess(abs(report.cost[0] - 1), 0.4)
        self.assertGreater(report.multiplier[0], 0.2)

    def test_same_bytes_however_it_is_cut(self):
        recording, one, two = recorded(), learner(seed=3), learner(seed=3, threads=2)
        one.learn_from(recording, 120)
        for steps in (70, 0, 50):
            two.learn_from(recording, steps)
        self.assertEqual(one.save(), two.save())

    def test_worlds_go_on_from_it(self):
        agent = learner("td3_lag", start_steps=100, horizon=10)
        agent.learn_from(recorded(), 0)
        for _ in range(10):
            agent.act(np.zeros((1, 1), np.float32))
            agent.record(reward=np.zeros(1, np.float32), cost=np.zeros((1, 1), np.float32))
        self.assertGreater(agent.update(np.zeros((1, 1), np.float32)).passes, 0)  # not without the recording: start_steps

    def test_decisions_of_another_length_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "set.npz"
            recorded().save(path)
            with np.load(path) as file:
                np.savez(path, metadata=np.array(json.dumps({"action_repeat": 4})), **file)
            recording = redman.load(path)
        with self.assertRaisesRegex(redman.ArgumentError, "a decision of 4 control steps, but one of the agent has 2.*'action_repeat': 4"):
            learner(action_repeat=2).learn_from(recording, 1)
        whole = redman.Recording(obs_dim=1, action_dim=1, cost_dim=1)
        whole.append(copy.deepcopy(recording))
        with self.assertRaisesRegex(redman.ArgumentError, "a decision of 4"):
            learner().learn_from(whole, 1)
        learner(action_repeat=4).learn_from(recording, 1)
        learner(action_repeat=2).learn_from(recorded(), 1)  # rows of arrays do not say it

    def test_refusals(self):
        agent = learner()
        with self.assertRaisesRegex(redman.UnsupportedError, "ppo_lag learns from its own decisions alone"):
            redman.Agent(algo="ppo_lag", obs_dim=1, action_dim=1, num_envs=1, cost_dim=1).learn_from(recorded(), 1)
        with self.assertRaisesRegex(redman.ArgumentError, "2 observations"):
            wide = redman.Recording(obs_dim=2, action_dim=1, cost_dim=1)
            wide.append(obs=np.zeros((3, 2), np.float32), action=np.zeros((3, 1), np.float32))
            agent.learn_from(wide, 1)
        with self.assertRaisesRegex(redman.RangeError, "steps"):
            agent.learn_from(recorded(), -1)
        with self.assertRaisesRegex(TypeError, "Recording"):
            agent.learn_from("set.npz", 1)


class Printed(unittest.TestCase):
    def test_reports_are_a_few_lines(self):
        recording = recorded()
        agent = learner()
        lines = str(agent.learn_from(recording, 10)).splitlines()
        self.assertRegex(lines[0], r"^10 gradient steps on \d+ rows")
        self.assertNotIn("nan", "".join(lines))
        report = agent.learn_from(recording, 10)
        self.assertEqual((len(report.cost), len(report.multiplier), len(report.cost_names)), (1, 1, 1))
        clone = redman.Agent(algo="ppo", obs_dim=1, action_dim=1, num_envs=1, cost_dim=1).clone(recording, epochs=3)
        lines = str(clone).splitlines()
        self.assertRegex(lines[0], r"^3 epochs on \d+ rows, \d+ held back for validation; the weights of epoch \d were kept$")
        self.assertRegex(lines[1], "^mean squared error of an entry of the action: .*, of the rows held back ")

    def test_a_memory_that_is_too_small_is_told_its_size(self):
        recording = recorded()
        with self.assertRaisesRegex(redman.RangeError, r"options=\{'replay_rows': (\d+)\}") as said:
            learner(replay_rows=30).learn_from(recording, 1)
        rows = int(str(said.exception).split("'replay_rows': ")[1].split("}")[0])
        learner(replay_rows=rows).learn_from(recording, 1)


if __name__ == "__main__":
    unittest.main()
