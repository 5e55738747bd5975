"""Agent, Policy and Map: learning on worlds of one's own, Ctrl-C, copies, parameters, files."""
import _thread
import copy
import json
import os
import pickle
import signal
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import redman

TASK = "hand_over_safe_finger"


def trained(epochs=1, **arguments):
    pool = redman.Pool(TASK, 8, seed=1)
    pool.reset()
    agent = redman.Agent(pool, seed=1, options={"horizon": 8}, **arguments)
    epoch = [agent.rollout(pool) for _ in range(epochs)][-1]
    return agent, pool, epoch


class Pendulum:
    """Sixteen pendulums that are to be swung up and held: Gymnasium's Pendulum-v1 written for rows, 100 steps."""

    def __init__(self, n=16, seed=0):
        self.random = np.random.default_rng(seed)
        self.angle, self.speed, self.age = np.zeros(n), np.zeros(n), np.zeros(n, int)
        self.restart(np.ones(n, bool))

    def restart(self, rows):
        self.angle[rows] = self.random.uniform(-np.pi, np.pi, rows.sum())
        self.speed[rows] = self.random.uniform(-1, 1, rows.sum())
        self.age[rows] = 0

    def obs(self):
        return np.stack([np.cos(self.angle), np.sin(self.angle), self.speed / 8], axis=1)

    def step(self, action):
        torque = 2 * np.clip(action[:, 0], -1, 1)
        error = (self.angle + np.pi) % (2 * np.pi) - np.pi
        reward = -(error ** 2 + 0.1 * self.speed ** 2 + 0.001 * torque ** 2)
        self.speed = np.clip(self.speed + 0.05 * (15 * np.sin(self.angle) + 3 * torque), -8, 8)
        self.angle += 0.05 * self.speed
        self.age += 1
        return reward, np.abs(torque) > 1.5, self.age == 100


class Rows(unittest.TestCase):
    def test_an_epoch_names_its_costs_and_is_json(self):
        pool = redman.Pool("hand_over_safe_finger", 8)
        pool.reset()
        with redman.Agent(pool, options={"horizon": 16}) as agent:
            epoch = agent.rollout(pool)
            self.assertEqual(epoch.costs, dict(zip(pool.costs, epoch.cost)))
            self.assertEqual(epoch.multipliers, dict(zip(pool.costs, epoch.multiplier)))
            told = json.loads(json.dumps(epoch))
            self.assertEqual(told["epoch"], 1)
            self.assertEqual(list(told["costs"]), list(pool.costs))
            self.assertEqual(dict(epoch), vars(epoch))
            again = pickle.loads(pickle.dumps(epoch))
            self.assertEqual((repr(again), type(again), dict(again).keys()), (repr(epoch), redman.Epoch, epoch.keys()))
        with redman.Agent(obs_dim=1, action_dim=1, cost_dim=2, options={"horizon": 1}) as agent:
            agent.act([[0.0]])
            agent.record(1.0, [[1.0, 2.0]], terminated=True)
            self.assertEqual(list(agent.update([[0.0]]).costs), ["cost 0", "cost 1"])


class PartsOfARow(unittest.TestCase):
    def test_an_agent_with_eyes_takes_points(self):
        draw = np.random.default_rng(1)
        options = {"encoder": "8,12", "encoder_points": 16, "encoder_classes": 2, "horizon": 4}
        with redman.Agent(obs_dim=3, action_dim=2, num_envs=4, options=options) as agent:
            for _ in range(4):
                seen = {"points": draw.normal(size=(4, 16, 3)), "point_class": draw.integers(0, 2, (4, 16))}
                agent.act(draw.normal(size=(4, 3)), **seen)
                agent.record(reward=np.ones(4), cost=np.zeros(4))
            obs = draw.normal(size=(4, 3)).astype(np.float32)
            agent.update(obs)
            mean = agent.act(obs, "mean", **seen)
            with self.assertRaisesRegex(redman.StateError, "needs points"):
                agent.act(obs, "mean")
            with self.assertRaisesRegex(redman.ArgumentError, r"points: its shape is \(4, 16, 2\), but it must be \(4, n, 3\)"):
                agent.act(obs, "mean", points=np.zeros((4, 16, 2)))
            policy = agent.policy()
        self.assertEqual(policy.info.num_points, 16)
        np.testing.assert_array_equal(policy.act(obs, **seen), np.clip(mean, -1, 1))
        one = policy.act(obs[0], points=seen["points"][0], point_class=seen["point_class"][:1])
        np.testing.assert_array_equal(one, np.clip(mean[0], -1, 1))

    def test_eyes_beside_a_history(self):
        draw = np.random.default_rng(1)
        options = {"encoder": "8,12", "encoder_points": 16, "horizon": 4, "history": 3}
        with redman.Agent(obs_dim=3, action_dim=2, num_envs=4, options=options) as agent:
            policy = agent.policy()
            state = policy.start(4)
            for _ in range(4):
                obs, points = draw.normal(size=(4, 3)).astype(np.float32), draw.normal(size=(4, 16, 3))
                mean = agent.act(obs, "mean", points=points)
                action, state = policy.act(obs, points=points, state=state)
                np.testing.assert_array_equal(action, np.clip(mean, -1, 1))
            with self.assertRaisesRegex(redman.StateError, r"policy.act\(obs, points=points, state=state\)"):
                policy.act(obs, state)

    def test_an_actor_that_sees_a_part(self):
        with redman.Pool("grasp", 4) as pool:
            pool.reset()
            agent = redman.Agent(pool, options={"horizon": 8, "actor_obs": "proprioception", "critic_obs": "*"})
            agent.rollout(pool)
            policy = agent.policy()
            seen = [i for name, f in pool.fields.items() if name.startswith("right.")
                    and not name.endswith(("tip_force", "tip_torque")) for i in range(f.offset, f.offset + f.count)]
            self.assertEqual(policy.columns.tolist(), seen)
            obs = np.array(pool.obs)
            shown = policy.act(obs)
            obs[:, [i for i in range(pool.obs_dim) if i not in seen]] += 1
            np.testing.assert_array_equal(policy.act(obs), shown)
            twin = pickle.loads(pickle.dumps(agent))
            self.assertEqual(bytes(twin.policy()), bytes(policy))

    def test_rows_of_ones_own(self):
        fields = {"angle": (0, 2), "speed": (2, 1)}
        agent = redman.Agent(obs_dim=3, action_dim=1, num_envs=4, fields=fields, options={"actor_obs": "speed"})
        self.assertEqual(agent.policy().columns.tolist(), [2])
        with self.assertRaises(redman.NotFoundError):
            redman.Agent(obs_dim=3, action_dim=1, num_envs=4, fields=fields, options={"actor_obs": "sped"})

    def test_slices_are_one_update(self):
        def make():
            return redman.Agent(obs_dim=3, action_dim=2, num_envs=4, cost_limits=1, seed=3,
                                options={"hidden": "8", "horizon": 6, "passes": 2, "minibatches": 2})

        def collect(*agents):
            for _ in range(6):
                obs, reward, cost = rng.normal(size=(4, 3)), rng.normal(size=4), rng.random((4, 1))
                for agent in agents:
                    agent.act(obs)
                    agent.record(reward, cost)
            return obs

        rng, one, other = np.random.default_rng(1), make(), make()
        for _ in range(2):
            obs = collect(one, other)
            whole = one.update(obs)
            before = other.act(obs, "mean")
            other.update_begin(obs)
            slices = 1
            while (epoch := other.update_slice(2)) is None:
                slices += 1
                np.testing.assert_array_equal(other.act(obs, "mean"), before)
                with self.assertRaises(redman.StateError):
                    other.save()
            self.assertGreater(slices, 3)
            np.testing.assert_equal(dict(epoch), dict(whole))
        self.assertEqual(other.save(), one.save())
        obs = collect(other)
        policy = bytes(other.policy())
        other.update_begin(obs)
        other.update_slice(5)
        other.discard()
        self.assertEqual(bytes(other.policy()), policy)
        other.save()

    def test_rows_of_elsewhere_are_learned_from_as_own_ones(self):
        def make(**more):
            return redman.Agent(obs_dim=3, action_dim=2, num_envs=4, cost_limits=1, seed=3,
                                options={"hidden": "8", "horizon": 6, "passes": 2, "minibatches": 2, **more})

        rng, actor, fed = np.random.default_rng(1), make(), make()
        for _ in range(2):
            generation = actor.policy().info.generation
            for _ in range(6):
                obs, reward, cost = rng.normal(size=(4, 3)), rng.normal(size=4), rng.random((4, 1))
                action = actor.act(obs)
                actor.record(reward, cost)
                with self.assertRaises(redman.StateError) as stale:
                    fed.put(obs, action, reward, cost, generation=generation ^ 1)
                self.assertIn("generation", str(stale.exception))
                fed.put(obs, action, reward, cost, generation=generation)
            np.testing.assert_equal(dict(fed.update(obs)), dict(actor.update(obs)))
        self.assertEqual(bytes(fed.policy()), bytes(actor.policy()))
        with self.assertRaises(redman.ArgumentError) as bad:
            fed.put(obs, action, reward)
        self.assertIn("put: cost is missing", str(bad.exception))
        with self.assertRaises(redman.UnsupportedError):
            make(average=0.5).put(obs, action, reward, cost, generation=generation)

    def test_a_policy_tells_what_it_never_saw(self):
        agent = redman.Agent(algo="ppo", obs_dim=3, action_dim=2, num_envs=40, cost_dim=0,
                             options={"hidden": "8", "horizon": 30})
        with self.assertRaises(redman.UnsupportedError):
            agent.policy().novelty(np.zeros(3))
        rng = np.random.default_rng(1)
        for _ in range(30):
            obs = rng.uniform(-1, 1, size=(40, 3))
            agent.act(obs)
            agent.record(rng.normal(size=40))
        agent.update(obs)
        policy = agent.policy()
        self.assertEqual(policy.info.novelty, 1)
        rows = policy.novelty(obs)
        self.assertEqual(rows.shape, (40,))
        self.assertLess(rows.max(), 1.2)
        self.assertEqual(policy.novelty(obs[7]), rows[7])
        self.assertGreater(policy.novelty([0, 1e6, 0]), 1e4)
        with self.assertRaises(redman.ArgumentError):
            policy.novelty(np.zeros(4))

    def test_costs_that_are_magnitudes(self):
        said = {}
        for signal in ("flag", "raw"):
            with redman.Pool("ball_circle", 4, options={"max_steps": 20}) as pool:
                pool.reset()
                agent = redman.Agent(pool, options={"horizon": 40, "cost_signal": signal}, cost_limits=3)
                epoch = agent.rollout(pool)
                said[signal] = (epoch.cost_signal, epoch.cost[0])
        self.assertEqual([said[s][0] for s in ("flag", "raw")], [0, 1])
        self.assertGreater(said["raw"][1], said["flag"][1])


class OwnWorld(unittest.TestCase):
    def test_a_pendulum_is_learned(self):
        world = Pendulum()
        agent = redman.Agent(obs_dim=3, action_dim=1, num_envs=16, cost_limits=1000, seed=1, max_steps=100,
                             options={"horizon": 100, "discount": 0.9, "learning_rate": 3e-3, "hidden": "32,32"})
        epochs = []
        for _ in range(60):
            for _ in range(100):
                action = agent.act(world.obs())
                reward, cost, truncated = world.step(action)
                final = world.obs()
                world.restart(truncated)
                agent.record(reward, cost, truncated=truncated, final_obs=final)
            epochs.append(agent.update(world.obs()))
        self.assertEqual(epochs[-1].epoch, 60)
        self.assertEqual(epochs[-1].env_steps, 60 * 100 * 16)
        self.assertLess(epochs[1].ret, -500)  # it hangs
        self.assertGreater(epochs[-1].ret, -400)
        # the frozen policy is the agent's mean
        policy = agent.policy()
        obs = np.float32(world.obs())
        np.testing.assert_array_equal(policy.act(obs), np.clip(agent.act(obs, "mean"), -1, 1))
        self.assertEqual((policy.info.task, policy.info.obs_dim), ("", 3))
        self.assertIsNone(policy._repr_png_())

    def test_rows_of_another_shape_or_order_are_refused(self):
        agent = redman.Agent(obs_dim=3, action_dim=2, num_envs=4, cost_limits=1, options={"horizon": 2})
        with self.assertRaisesRegex(redman.ArgumentError, r"obs: its shape is \(4, 2\)"):
            agent.act(np.zeros((4, 2)))
        with self.assertRaisesRegex(redman.StateError, "act"):
            agent.record(np.zeros(4), np.zeros((4, 1)))
        with self.assertRaises(redman.ArgumentError):
            agent.act(np.full((4, 3), np.nan))
        with self.assertRaisesRegex(redman.ArgumentError, "sample, mean"):
            agent.act(np.zeros((4, 3)), "best")
        agent.act(np.zeros((4, 3)))
        with self.assertRaisesRegex(redman.ArgumentError, "cost"):
            agent.record(np.zeros(4))
        with self.assertRaises(redman.StateError):
            agent.update(np.zeros((4, 3)))
        with self.assertRaises(redman.ArgumentError):
            redman.Agent()
        with self.assertRaises(redman.NotFoundError):
            redman.Agent(obs_dim=1, action_dim=1, algo="pppo")

    def test_act_writes_where_it_is_told(self):
        agent, pool, _ = trained()
        self.assertIs(agent.act(pool.obs, "mean", out=pool.action), pool.action)
        wide = np.zeros((8, 80), np.float32)
        agent.act(pool.obs, "mean", out=wide[:, ::2])
        np.testing.assert_array_equal(wide[:, ::2], pool.action)
        self.assertTrue((wide[:, 1::2] == 0).all())


class OfAPool(unittest.TestCase):
    def test_the_pool_brings_what_its_task_knows(self):
        agent, pool, epoch = trained()
        task = pool.task
        self.assertEqual(agent.cost_limits[0], task.costs["cost"].limit)
        self.assertEqual(agent.options["action_repeat"], task.defaults["action_repeat"])
        self.assertEqual(agent.policy().info.task, TASK)
        self.assertEqual(len(epoch.cost), pool.cost_dim)
        for limits, expected in ((5, [5.0] + [None] * 7), ({"drop": 2}, [40.0] + [None] * 6 + [2.0]),
                                 (None, [40.0] + [None] * 7),
                                 ([None, 1, None, None, None, None, None, 3], [None, 1.0] + [None] * 5 + [3.0])):
            self.assertEqual(redman.Agent(pool, cost_limits=limits).cost_limits, expected)
        with self.assertRaisesRegex(redman.NotFoundError, "drop"):
            redman.Agent(pool, cost_limits={"dropped": 2})
        with self.assertRaises(redman.ArgumentError):
            redman.Agent(pool, cost_limits=[1, 2])
        with self.assertRaises(redman.ArgumentError):
            redman.Agent(redman.Pool("grasp", 8)).rollout(pool)

    def test_it_learns_so_many_steps(self):
        pool, other = (redman.Pool("ball_run", 4, seed=1) for _ in range(2))
        agent, by_hand = (redman.Agent(worlds, options={"horizon": 16}) for worlds in (pool, other))
        heard = []
        epoch = agent.learn(3 * 64 - 10, callback=lambda e: heard.append(e.epoch))  # epochs of 64 steps; it resets the pool
        other.reset()
        for _ in range(3):
            by_hand.rollout(other)
        self.assertEqual((epoch.epoch, heard, agent.save()), (3, [1, 2, 3], by_hand.save()))
        self.assertEqual(agent.learn(1000, callback=lambda e: True).epoch, 4)
        with self.assertRaisesRegex(redman.UsageError, r"agent\.learn\(steps, pool\)"):
            redman.Agent(obs_dim=3, action_dim=1).learn(100)
        with self.assertRaisesRegex(redman.ArgumentError, "steps: 0 is not above 0"):
            agent.learn(0)

    def test_costs_of_its_own_take_the_place_of_the_pools(self):
        pool = redman.Pool(TASK, 8, seed=1, options={"action_repeat": 0})
        at = pool.fields["right.joint_velocity"].slice
        with redman.Agent(pool, seed=1, options={"horizon": 40}, costs=["fast", "late"], cost_limits={"fast": 0.5}) as agent:
            self.assertEqual((agent.cost_dim, agent.cost_limits), (2, [0.5, None]))
            self.assertEqual(agent.options["action_repeat"], pool.spec.action_repeat)  # one step of the pool a decision
            pool.reset()
            ended, total = [], np.zeros(8)
            for _ in range(40):
                pool.step(agent.act(pool.obs))
                fast = (np.abs(pool.final_obs[:, at]) > 0.6).any(axis=1)
                total += fast
                done = pool.terminated | pool.truncated
                ended.extend(total[done > 0])
                total[done > 0] = 0
                with self.assertRaisesRegex(redman.ArgumentError, r"cost: its shape is \(8,\), but it must be \(8, 2\), which is \[num_envs\]\[cost_dim\]"):
                    agent.record(pool.reward, fast, pool.terminated, pool.truncated, pool.final_obs)
                agent.record(pool.reward, np.stack([fast, 0 * fast], 1), pool.terminated, pool.truncated, pool.final_obs)
            epoch = agent.update(pool.obs)
            self.assertGreater(np.mean(ended), 0.5)
            self.assertAlmostEqual(epoch.costs["fast"], np.mean(ended), places=5)
            self.assertEqual((list(epoch.costs), epoch.costs["late"]), (["fast", "late"], 0))
            self.assertGreater(epoch.multipliers["fast"], 0)
            self.assertEqual(copy.deepcopy(agent).cost_limits, agent.cost_limits)
            with self.assertRaises(redman.ArgumentError):
                agent.rollout(pool)  # whose costs are others
            self.assertEqual(redman.evaluate(agent.policy(), episodes=2, num_envs=2).episodes, 2)
        self.assertEqual(redman.Agent(obs_dim=1, action_dim=1, costs=["a", "b"]).cost_dim, 2)
        for said, told in (({"cost_dim": 2}, "cost_dim: .*costs="), ({"num_envs": 8}, "num_envs: a pool brings its own"),
                           ({"costs": ["a"], "cost_dim": 2}, "cost_dim: it is 2, but costs has 1 names")):
            with self.assertRaisesRegex(redman.ArgumentError, told):
                redman.Agent(pool, **said)
        with self.assertRaisesRegex(redman.UsageError, "a list of names"):
            redman.Agent(pool, costs="fast")

    def test_options_that_are_live_change(self):
        agent, _, _ = trained()
        agent.set(learning_rate=1e-5)
        self.assertEqual(agent.options["learning_rate"], 1e-5)
        agent.set(cost_limit=7)
        self.assertEqual(agent.cost_limits[0], 7)
        self.assertEqual(copy.deepcopy(agent).cost_limits[0], 7)
        with self.assertRaises(redman.StateError):
            agent.set(horizon=9)
        with self.assertRaises(redman.NotFoundError):
            agent.set(learning_speed=1)

    def test_copies_learn_alike(self):
        agent, pool, _ = trained(2)
        for again in (lambda x: pickle.loads(pickle.dumps(x)), copy.deepcopy):
            twin, worlds = again(agent), again(pool)
            self.assertEqual(twin.save(), agent.save())
            same, other = copy.deepcopy(agent), copy.deepcopy(pool)
            self.assertEqual(twin.rollout(worlds), same.rollout(other))
            self.assertEqual(twin.save(), same.save())
        half = redman.Agent(obs_dim=1, action_dim=1, cost_limits=1)
        half.act([[0.0]])
        with self.assertRaises(redman.StateError):
            pickle.dumps(half)

    def test_checkpoints_go_on_with_the_same_bytes(self):
        agent, pool, _ = trained()
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "a.rdm")
            agent.write_checkpoint(path, pool, b"a note" * 1000)
            expected = agent.rollout(pool), pool.hash()
            self.assertEqual(agent.read_checkpoint(path, pool), b"a note" * 1000)
            self.assertEqual((agent.rollout(pool), pool.hash()), expected)
            with self.assertRaises(redman.NotFoundError):
                agent.read_checkpoint(Path(folder, "b.rdm"))

    def test_parameters_are_read_and_written(self):
        agent, pool, _ = trained()
        tensors = agent.tensors
        self.assertEqual((tensors["actor.0.weight"].shape[1], pool.obs_dim), (150, 398))  # a throw sees these of all
        before = agent.policy().act(pool.obs)
        bias = f"actor.{sum(name.startswith('actor.') and name.endswith('.bias') for name in tensors) - 1}.bias"
        tensors[bias] = tensors[bias] + 0.125
        moved = agent.policy().act(pool.obs) - before
        free = np.abs(before) < 0.8
        np.testing.assert_allclose(moved[free], 0.125, atol=1e-5)
        with self.assertRaises(KeyError):
            tensors["actor.9.bias"]
        with self.assertRaises(redman.Error):
            tensors[bias] = np.zeros(3)
        self.assertEqual(agent.policy().tensors[bias].shape, tensors[bias].shape)


class Interrupted(unittest.TestCase):
    def interrupted(self, after):
        pool = redman.Pool(TASK, 64, seed=1)
        pool.reset()
        agent = redman.Agent(pool, options={"horizon": 4096})
        timer = threading.Timer(after, os.kill, (os.getpid(), signal.SIGINT))
        begin = time.monotonic()
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            agent.rollout(pool)
        timer.join()
        return agent, pool, time.monotonic() - begin

    def test_ctrl_c_ends_a_rollout_and_leaves_all_good(self):
        agent, pool, seconds = self.interrupted(0.3)
        self.assertLess(seconds, 20)  # a whole one takes minutes
        pool.baseline("hold"), pool.step()
        before = agent.save()
        short = redman.Agent(pool, options={"horizon": 2})
        short.rollout(pool)
        self.assertEqual(agent.save(), before)
        agent.act(pool.obs)  # the horizon begins anew

    def test_signals_at_any_moment(self):
        threads = _thread._count()
        pool = redman.Pool("bandit", 4)
        pool.reset()
        agent = redman.Agent(pool, options={"horizon": 1})
        armed, over = [], threading.Event()

        def hear(*_):
            if armed:
                armed.clear()
                raise KeyboardInterrupt

        def pester():
            random = np.random.default_rng(1)
            while not over.wait(random.uniform(0, 0.01)):
                os.kill(os.getpid(), signal.SIGINT)

        before = signal.signal(signal.SIGINT, hear)
        thread = threading.Thread(target=pester)
        thread.start()
        heard = 0
        end = time.monotonic() + 3
        while time.monotonic() < end:
            try:
                armed.append(True)
                while time.monotonic() < end:
                    agent.rollout(pool)
                armed.clear()  # here, where the interrupt that still comes is caught
            except KeyboardInterrupt:
                heard += 1
        over.set()
        thread.join()
        signal.signal(signal.SIGINT, before)
        epochs = agent.rollout(pool).epoch
        self.assertGreater(heard, 20)
        self.assertGreater(epochs, heard // 10)
        end = time.monotonic() + 60  # a thread ends a moment after its call
        while _thread._count() > threads and time.monotonic() < end:
            time.sleep(0.001)
        self.assertEqual(_thread._count(), threads)  # nothing waits for ever

    def test_a_cancel_that_comes_too_late_is_forgotten(self):
        agent, pool, _ = trained()
        agent.cancel()
        agent._renew()
        self.assertEqual(agent.rollout(pool).epoch, 2)

    def test_cancel_from_another_thread(self):
        agent, pool, _ = trained()
        agent.cancel()
        with self.assertRaises(redman.CancelledError):
            agent.rollout(pool)
        self.assertEqual(agent.rollout(pool).epoch, 2)

    def test_errors_of_the_working_thread_arrive_with_their_text(self):
        agent, _, _ = trained()
        with self.assertRaisesRegex(redman.StateError, "reset"):
            agent.rollout(redman.Pool(TASK, 8))


class Frozen(unittest.TestCase):
    def test_files_bytes_and_folders(self):
        agent, pool, _ = trained()
        policy = agent.policy()
        with tempfile.TemporaryDirectory() as folder:
            policy.save(Path(folder, "policy.rdm"))
            for source in (folder, Path(folder, "policy.rdm"), bytes(policy), memoryview(bytes(policy))):
                np.testing.assert_array_equal(redman.Policy.load(source).act(pool.obs), policy.act(pool.obs))
            self.assertEqual(os.listdir(folder), ["policy.rdm"])
            with self.assertRaises(FileNotFoundError) as caught:
                redman.Policy.load(Path(folder, "none"))
            self.assertIsInstance(caught.exception, redman.NotFoundError)
        with self.assertRaises(redman.FormatError):
            redman.Policy(b"not a policy")

    def test_one_row_or_many(self):
        agent, pool, _ = trained()
        policy = agent.policy()
        many = policy.act(pool.obs)
        np.testing.assert_allclose(policy.act(pool.obs[2]), many[2], atol=1e-6)
        self.assertEqual(policy.act(np.zeros((0, 398))).shape, (0, 40))
        noisy = policy.act(pool.obs, noise=np.ones((8, 40)))
        self.assertFalse((noisy == many).all())
        for wrong in (np.zeros(397), np.zeros((1, 1, 398)), 3.0):
            with self.assertRaises(redman.ArgumentError):
                policy.act(wrong)
        with self.assertRaises(redman.ArgumentError):
            policy.act(np.full(398, np.inf))

    def test_many_threads_share_one(self):
        agent, pool, _ = trained()
        policy = copy.deepcopy(agent.policy())
        expected = policy.act(pool.obs)
        wrong = []

        def work():
            for _ in range(50):
                if not (policy.act(pool.obs) == expected).all():
                    wrong.append(1)

        threads = [threading.Thread(target=work) for _ in range(4)]
        [thread.start() for thread in threads]
        [thread.join() for thread in threads]
        self.assertEqual(wrong, [])

    def test_it_says_where_it_does_not_fit(self):
        agent, pool, _ = trained()
        policy = pickle.loads(pickle.dumps(agent.policy()))
        policy.check(pool)
        with self.assertRaises(redman.VersionError):
            policy.check(redman.Pool("grasp"))
        self.assertEqual(policy._repr_png_()[:4], b"\x89PNG")


class Maps(unittest.TestCase):
    def test_a_look_is_what_the_camera_sees(self):
        pool = redman.Pool("grasp")
        pool.reset()
        with redman.Map(resolution=0.02) as m:
            self.assertEqual(m.scan(pool, 0, width=64, height=64), 0)
            voxels = m.box((-1, -1, -1), (1, 1, 1))
            self.assertGreater(len(voxels), 10)
            one = voxels["centre"][0]
            self.assertGreater(m.query([one])[0], 0.5)
            self.assertEqual(m.query([(50, 50, 50)])[0], -1)
            self.assertTrue(m.meets([*one, 0, 0, 0, 1], (0.05, 0.05, 0.05)))
            self.assertLess(m.distance([one], 1.0)[0], 0.02)
            hit = m.raycast(one + (0, 0, 0.5), (0, 0, -1), 1.0, through_unknown=True)
            self.assertIsNotNone(hit)
            self.assertEqual(m.grid([*one, 0, 0, 0, 1], (3, 4, 5), 0.02).shape, (3, 4, 5))
            twin = copy.deepcopy(m)
            self.assertEqual(twin.save(), m.save())
            other = redman.Map()
            other.load(m.save("bt"))
            self.assertEqual(len(other.box((-1, -1, -1), (1, 1, 1))), len(voxels))
            m.clear()
            self.assertEqual(len(m.box((-1, -1, -1), (1, 1, 1))), 0)
        with self.assertRaises(redman.StateError):
            m.clear()

    def test_points_of_ones_own(self):
        m = redman.Map(0.1)
        m.insert((0, 0, 0), [(1, 0, 0), (np.nan, 0, 0)])
        self.assertEqual(m.raycast((0, 0, 0), (1, 0, 0), 5).shape, (3,))
        for wrong in ([1, 2, 3], np.zeros((2, 2))):
            with self.assertRaises(redman.ArgumentError):
                m.query(wrong)
        with self.assertRaises(redman.RangeError):
            redman.Map(-1)
        with self.assertRaises(TypeError):
            redman.Map(0.1, width=3)

    def test_the_furthest_points_are_the_corners(self):
        cube = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)] + [(0.5, 0.5, 0.5)])
        self.assertEqual(set(redman.sample_furthest(cube, 8)), set(range(8)))


if __name__ == "__main__":
    unittest.main()
