"""Teams: groups of tasks, policies of each group, PettingZoo's parallel environments and the names of the safe suites."""
import tempfile
import unittest
from pathlib import Path

import numpy as np

import redman
import redman.pettingzoo


class Groups(unittest.TestCase):
    def test_hands_and_fingers_share_the_action_out(self):
        for task, options in (("hand_over_safe_finger", {}), ("grasp", {"arm": "ur5e"}), ("jenga", {"pair": "paper"}),
                              ("pick_bottles", {"action_order": "legacy"}), ("grasp", {"hand": "barrett"})):
            with self.subTest(task, **options), redman.Pool(task, options=options) as pool:
                for which in (None, "fingers"):
                    entries = [i for g in redman.groups(pool, which) for i in range(g.actions.start, g.actions.stop)]
                    self.assertEqual(entries, list(range(pool.action_dim)))

    def test_a_hand_sees_all_but_the_other_hand(self):
        with redman.Pool("hand_over_safe_finger") as pool:
            right, left = redman.groups(pool, "hands")
            self.assertEqual((right.name, left.name), ("right", "left"))
            for group, other in ((right, "left."), (left, "right.")):
                hidden = set(range(pool.obs_dim)) - set(group.columns.tolist())
                named = {i for name, field in pool.fields.items() if name.startswith(other)
                         for i in range(field.slice.start, field.slice.stop)}
                self.assertEqual(hidden, named)

    def test_fingers_own_the_joints_of_their_names(self):
        with redman.Pool("hand_over_safe_finger") as pool:
            of = {i: g.name for g in redman.groups(pool, "fingers") for i in range(g.actions.start, g.actions.stop)}
            for joint in pool.joints:
                if joint.action < 0:
                    continue
                side, _, part = joint.name.partition("_")
                self.assertEqual(of[joint.action], f"{side}.{'wrist' if part.startswith('WR') else part[:2].lower()}")

    def test_what_is_no_set_is_refused_with_those_that_are(self):
        with redman.Pool("hand_over_safe_finger") as pool:
            with self.assertRaisesRegex(redman.NotFoundError, "no set 'hand'; nearest is hands"):
                redman.groups(pool, "hand")
            self.assertEqual([g.name for g in redman.groups(pool, "all")], ["all"])


class Policies(unittest.TestCase):
    def test_each_hand_has_a_policy_of_its_own(self):
        with redman.Pool("hand_over_safe_finger", num_envs=8) as pool:
            pool.reset()
            agent = redman.Agent(pool, algo="mappo_lag", options={"hidden": "16"})
            for _ in range(2):
                agent.rollout(pool)
            team = agent.policy()
            self.assertEqual(team.groups, ("right", "left"))
            obs = np.array(pool.obs)
            whole = redman.Policy.act(team, obs)
            for group in redman.groups(pool):
                own = team.group(group.name)
                self.assertEqual(own.groups, ())
                with tempfile.TemporaryDirectory() as folder:
                    own.save(Path(folder) / "own.rdm")
                    own = redman.Policy.load(Path(folder) / "own.rdm")
                np.testing.assert_allclose(own.act(obs), whole[:, group.actions], atol=1e-6)
                hidden = np.setdiff1d(np.arange(pool.obs_dim), group.columns)
                blind = obs.copy()
                blind[:, hidden] += 1
                np.testing.assert_array_equal(own.act(blind), own.act(obs))
            with self.assertRaisesRegex(redman.NotFoundError, "group lefft: unknown; nearest is left"):
                team.group("lefft")
        with self.assertRaisesRegex(redman.NotFoundError, "one network"):
            redman.Policy.trained("bandit").group("left")

    def test_tensors_are_those_of_one_network(self):
        with redman.Pool("matrix_game", num_envs=8) as pool:
            pool.reset()
            agent = redman.Agent(pool, algo="mappo", options={"hidden": "5,4", "activation": "tanh", "normalize_obs": True})
            for _ in range(2):
                agent.rollout(pool)
            team = agent.policy()
            t = {name: np.array(value) for name, value in team.tensors.items()}
            obs = np.random.default_rng(1).uniform(-1, 1, (50, 2)).astype(np.float32)
            x = np.clip((obs - t["normalizer.shift"].reshape(-1)) * t["normalizer.scale"].reshape(-1), -5, 5)
            for layer in range(3):
                x = x @ t[f"actor.{layer}.weight"].T + t[f"actor.{layer}.bias"].reshape(-1)
                x = np.tanh(x) if layer < 2 else x
            np.testing.assert_allclose(np.clip(x, -1, 1), team.act(obs), atol=2e-6)

    def test_memories_of_groups_are_one_gru(self):
        for hidden in ("5,4", ""):
            with self.subTest(hidden), redman.Pool("matrix_game", num_envs=8) as pool:
                pool.reset()
                agent = redman.Agent(pool, algo="mappo", options={"hidden": hidden, "memory": "gru:3", "activation": "tanh",
                                                                  "normalize_obs": True})
                for _ in range(2):
                    agent.rollout(pool)
                team = agent.policy()
                self.assertEqual(team.info.state_dim, 6)
                t = {name: np.array(value) for name, value in team.tensors.items()}
                bias = {name: t[name].reshape(-1) for name in t if name.endswith("bias")}
                rng = np.random.default_rng(1)
                h, state = np.zeros((50, 6)), team.start(50)
                own = {name: (team.group(name), team.group(name).start(50)) for name in team.groups}
                for _ in range(5):
                    obs = rng.uniform(-1, 1, (50, 2)).astype(np.float32)
                    x = np.clip((obs - t["normalizer.shift"].reshape(-1)) * t["normalizer.scale"].reshape(-1), -5, 5)
                    layers = len([n for n in hidden.split(",") if n])
                    for layer in range(layers):
                        x = np.tanh(x @ t[f"actor.{layer}.weight"].T + bias[f"actor.{layer}.bias"])
                    a = np.split(x @ t["memory.input.weight"].T + bias["memory.input.bias"], 3, axis=1)
                    b = np.split(h @ t["memory.state.weight"].T + bias["memory.state.bias"], 3, axis=1)
                    r, z = 1 / (1 + np.exp(-a[0] - b[0])), 1 / (1 + np.exp(-a[1] - b[1]))
                    h = z * h + (1 - z) * np.tanh(a[2] + r * b[2])
                    y = h @ t[f"actor.{layers}.weight"].T + bias[f"actor.{layers}.bias"]
                    action, state = team.act(obs, state)
                    np.testing.assert_allclose(np.clip(y, -1, 1), action, atol=2e-6)
                    np.testing.assert_allclose(h, state, atol=2e-6)
                    for i, name in enumerate(team.groups):
                        policy, kept = own[name]
                        part, kept = policy.act(obs, kept)
                        own[name] = policy, kept
                        np.testing.assert_allclose(part[:, 0], np.asarray(action)[:, i], atol=1e-6)


class PettingZoo(unittest.TestCase):
    def test_an_episode_is_that_of_the_pool(self):
        env = redman.pettingzoo.ParallelEnv("hand_over_safe_finger")
        self.addCleanup(env.close)
        self.assertEqual(env.possible_agents, ["right", "left"])
        seen, infos = env.reset(seed=11)
        with redman.Pool("hand_over_safe_finger", seed=11) as pool:
            pool.reset(seeds=[11])
            groups = redman.groups(pool)
            rng = np.random.default_rng(0)
            steps = 0
            while env.agents:
                for group in groups:
                    np.testing.assert_array_equal(seen[group.name], pool.obs[0][group.columns])
                np.testing.assert_array_equal(env.state(), pool.obs[0])
                actions = {a: rng.uniform(-1, 1, env.action_space(a).shape).astype(np.float32) for a in env.agents}
                seen, rewards, terminated, truncated, infos = env.step(actions)
                pool.step(np.concatenate([actions["right"], actions["left"]])[None])
                self.assertEqual(set(rewards.values()), {float(pool.reward[0])})
                self.assertEqual(infos["left"]["cost"], float(pool.cost[0, 0]))
                steps += 1
            self.assertTrue(all(truncated.values()) or all(terminated.values()))
            self.assertGreater(steps, 10)

    def test_the_keys_of_infos_are_the_same_after_a_reset(self):
        env = redman.pettingzoo.ParallelEnv("matrix_game", groups="players")
        self.addCleanup(env.close)
        _, began = env.reset(seed=0)
        *_, told = env.step({a: np.ones(1, np.float32) for a in env.agents})
        self.assertEqual(began["first"].keys(), told["first"].keys())

    def test_wrong_actions_are_refused_by_name(self):
        env = redman.pettingzoo.ParallelEnv("matrix_game")
        self.addCleanup(env.close)
        env.reset(seed=0)
        with self.assertRaisesRegex(redman.ArgumentError, "of first, second, not of first"):
            env.step({"first": np.ones(1, np.float32)})
        with self.assertRaisesRegex(redman.ArgumentError, r"those of second must have the shape \(1,\)"):
            env.step({"first": np.ones(1, np.float32), "second": np.ones(2, np.float32)})

    def test_the_safe_suites_names(self):
        env = redman.pettingzoo.SafeEnv("catch_underarm_safe_joint", 4)
        self.addCleanup(env.close)
        obs, share, available = env.reset(seed=3)
        self.assertIsNone(available)
        self.assertEqual(share.shape, (4, 2, env.worlds.pool.obs_dim))
        self.assertEqual(obs.shape[:2], (4, 2))
        done = np.zeros((4, 2), bool)
        for _ in range(80):
            obs, share, rewards, costs, dones, infos, _ = env.step([np.zeros((4, space.shape[0]), np.float32) for space in env.action_space])
            self.assertEqual((rewards.shape, costs.shape), ((4, 2, 1), (4, 2, 1)))
            done |= dones
        self.assertTrue(done.all())

    def test_a_shield_checks_the_actions_of_all_agents(self):
        env = redman.pettingzoo.SafeEnv("hand_over_safe_joint", 2, seed=1, shield=True, shield_policy="trained")
        alone = redman.pettingzoo.ParallelEnv("hand_over_safe_joint", seed=1, action_repeat="task", shield=True)
        self.addCleanup(env.close)
        self.addCleanup(alone.close)
        env.reset()
        _, began = alone.reset()
        for _ in range(4):
            actions = [np.array([space.sample() for _ in range(2)]) for space in env.action_space]
            infos = env.step(actions)[5]
        for i in range(2):
            for info, own in zip(infos[i], actions):
                self.assertEqual(bool(info["intervened"]), info["shield"] != "own")
                self.assertEqual(info["applied"].shape, own[i].shape)
                if not info["intervened"]:
                    np.testing.assert_array_equal(info["applied"], own[i])
        self.assertGreater(env.worlds.shield.stats.decisions, 0)
        told = alone.step({agent: alone.action_space(agent).sample() for agent in alone.agents})[4]
        self.assertEqual(told["left"].keys(), began["left"].keys())
        self.assertEqual(told["left"]["applied"].shape, alone.action_space("left").shape)

    def test_it_has_the_learning_defaults_of_its_siblings(self):
        self.assertIs(redman.pettingzoo.defaults, redman.gym.defaults)

    def test_the_optimum_of_the_game_is_reached(self):
        """A team within the limit: 10 at cost 0; one that sees both sides 12.5 at 2.5; without a limit 20 at 10."""
        with tempfile.TemporaryDirectory() as folder:
            for algo, wanted, cost in (("mappo_lag", 10, 0), ("mappo", 20, 10), ("happo", 20, 10)):
                run = redman.train("matrix_game", algo=algo, steps=3e5, envs=40, seed=1, threads=1, out=f"{folder}/{algo}")
                found = run.evaluate(episodes=50)
                self.assertAlmostEqual(found.return_mean, wanted, delta=0.2, msg=algo)
                self.assertAlmostEqual(found.cost_mean[0], cost, delta=0.2, msg=algo)


if __name__ == "__main__":
    unittest.main()
