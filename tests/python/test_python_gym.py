"""redman.gym: the rules of Gymnasium's checker, resets of all kinds against single worlds, seeds, copies; and the same classes
under Gymnasium's own checker, wrappers and SyncVectorEnv where it is installed or REDMAN_PEERS has copies (peers.py)."""
import copy
import inspect
import pickle
import re
import subprocess
import sys
import tempfile
import types
import unittest
import warnings
from pathlib import Path
from unittest import mock

import numpy as np

import peers

peers.stand_in()

import redman
from redman import gym
from same import same, shaped

MODES = ("NextStep", "SameStep", "Disabled")
TASKS = ("hand_over_safe_finger", "grasp", "bandit", "two_state", "point_goal1")
SHORT = {"hand_over_safe_finger": 90, "bandit": 6, "lqr_line": 45}  # steps in which episodes end more than once


class Rules(unittest.TestCase):
    """What Gymnasium's env_checker asks, line by line, of our classes with or without it."""

    def test_spaces(self):
        for task in TASKS:
            with self.subTest(task), gym.Env(task, seed=1) as env:
                for space, width in ((env.observation_space, env.pool.obs_dim), (env.action_space, env.pool.action_dim)):
                    self.assertEqual((space.shape, space.dtype), ((width,), np.float32))
                    self.assertEqual((space.low.shape, space.high.shape), ((width,), (width,)))
                    self.assertTrue(np.all(space.low < space.high))
                np.testing.assert_array_equal(env.action_space.low, -1)
                np.testing.assert_array_equal(env.action_space.high, 1)
                self.assertIn(env.action_space.sample(), env.action_space)

    def test_reset_takes_a_seed_and_options_by_name(self):
        for kind in (gym.Env, gym.VectorEnv):
            parameters = inspect.signature(kind.reset).parameters
            for name in ("seed", "options"):
                self.assertIs(parameters[name].kind, inspect.Parameter.KEYWORD_ONLY)
                self.assertIsNone(parameters[name].default)
            self.assertNotIn("return_info", parameters)
            self.assertFalse(hasattr(kind, "seed"))  # a method of that name is long out of use

    def test_reset_gives_an_observation_and_a_dict(self):
        for task in TASKS:
            with self.subTest(task), gym.Env(task, seed=1) as env:
                result = env.reset()
                self.assertIs(type(result), tuple)
                obs, info = result
                self.assertIn(obs, env.observation_space)
                self.assertIs(type(info), dict)
                env.reset(options={})

    def test_a_seed_names_the_episode_and_those_after_it(self):
        for task in TASKS:
            with self.subTest(task), gym.Env(task, seed=1) as env:
                first, _ = env.reset(seed=123)
                stream = copy.deepcopy(env.np_random.bit_generator.state)
                after, _ = env.reset()
                again, _ = env.reset(seed=123)
                self.assertTrue(same(first, again))
                self.assertEqual(stream, env.np_random.bit_generator.state)
                self.assertTrue(same(after, env.reset()[0]))
                env.reset(seed=456)
                self.assertNotEqual(stream, env.np_random.bit_generator.state)
                if task == "hand_over_safe_finger":
                    self.assertFalse(same(first, after))
                    self.assertFalse(same(first, env.reset(seed=456)[0]))

    def test_a_step_gives_five_values_of_the_right_types(self):
        for task in TASKS:
            with self.subTest(task), gym.Env(task, seed=1) as env:
                env.reset(seed=1)
                result = env.step(env.action_space.sample())
                self.assertIs(type(result), tuple)
                obs, reward, terminated, truncated, info = result
                self.assertIn(obs, env.observation_space)
                self.assertEqual(list(map(type, (reward, terminated, truncated, info))), [float, bool, bool, dict])
                self.assertTrue(np.isfinite(reward))

    def test_a_step_is_deterministic(self):
        for task in TASKS:
            with self.subTest(task), gym.Env(task, seed=1) as env:
                env.action_space.seed(5)
                action = env.action_space.sample()
                env.reset(seed=123)
                one = env.step(action)
                env.reset(seed=123)
                self.assertTrue(same(one, env.step(action)))

    def test_infos_of_a_reset_have_the_keys_of_a_step(self):
        with gym.Env("hand_over_safe_finger") as env:
            began = env.reset(seed=1)[1]
            stepped = env.step(np.ones(40, np.float32))[-1]
            self.assertEqual(shaped(began), shaped(stepped))
            while not any(env.step(np.ones(40, np.float32))[2:4]):
                pass
            again = env.reset()[1]
            self.assertEqual(shaped(again), shaped(stepped))
            self.assertFalse(any(np.any(value) for value in (*began.values(), *again.values())))
        for mode in MODES:
            with self.subTest(mode), gym.VectorEnv("hand_over_safe_finger", 3, autoreset_mode=mode) as envs:
                began = envs.reset(seed=1)[1]
                self.assertEqual(shaped(began), shaped(envs.step(np.ones((3, 40), np.float32))[-1]))

    def test_an_option_that_a_reset_does_not_read_is_refused(self):
        with gym.Env("hand_over_safe_finger") as env, gym.VectorEnv("hand_over_safe_finger", 2) as envs:
            for options, words in (({"foo": 1}, "'foo' is not used"),
                                   ({"object": "egg"}, "given when the environment is made: options={'object': ...}"),
                                   ({"obejct": "egg"}, "options={'object': ...}")):
                for each in (env, envs):
                    with self.assertRaisesRegex(redman.ArgumentError, re.escape(words)):
                        each.reset(options=options)
            with self.assertRaisesRegex(redman.ArgumentError, "nearest is reset_mask"):
                envs.reset(options={"reset_mas": np.ones(2, bool)})
            for options in (None, {}):
                env.reset(options=options)
                envs.reset(options=options)

    def test_steps_of_an_episode(self):
        for arguments, steps in (({}, 75), ({"action_repeat": "task"}, 19), ({"options": {"max_steps": 10}}, 10)):
            with gym.Env("hand_over_safe_finger", **arguments) as env:
                self.assertEqual(env.max_episode_steps, steps)
        gym.VectorEnv("hand_over_safe_finger", 2, max_episode_steps=75).close()
        with self.assertRaisesRegex(redman.ArgumentError, "max_episode_steps: 20, but an episode has 75.*max_steps"):
            gym.VectorEnv("hand_over_safe_finger", 2, max_episode_steps=20)

    def test_what_was_given_stays(self):
        with gym.Env("hand_over_safe_finger") as env:
            obs, _ = env.reset(seed=1)
            kept = obs.copy()
            stepped = env.step(np.ones(40, np.float32))
            kept_costs = stepped[4]["costs"].copy()
            env.step(-np.ones(40, np.float32))
            self.assertTrue(same(obs, kept))
            self.assertTrue(same(stepped[4]["costs"], kept_costs))

    def test_pictures_since_the_last_call(self):
        for mode, what in (("rgb_array_list", "rgb"), ("depth_array_list", "depth")):
            with gym.Env("ball_run", render_mode=mode, width=32, height=24) as env:
                env.reset(seed=1)
                seen = [env.pool.render(0, None, 32, 24, what)]
                for _ in range(3):
                    env.step(np.ones(2, np.float32))
                    seen.append(env.pool.render(0, None, 32, 24, what))
                self.assertTrue(same(env.render(), seen))
                self.assertEqual(env.render(), [])
                env.step(np.ones(2, np.float32))
                self.assertEqual(len(env.render()), 1)
        with gym.VectorEnv("ball_run", 2, render_mode="rgb_array_list", width=32, height=24, autoreset_mode="Disabled") as env:
            env.reset(seed=1)
            env.step(np.ones((2, 2), np.float32))
            env.reset(options={"reset_mask": np.array([True, False])})
            self.assertEqual([len(pictures) for pictures in env.render()], [3, 2])
            self.assertEqual([len(pictures) for pictures in env.render()], [0, 0])

    def test_observe_is_modality_in_other_words(self):
        options = {"modality": "rgb+depth+points"}
        with gym.Env("grasp", options=options) as one, gym.Env("grasp", observe=["state", "rgb", "depth", "points"]) as other, \
                gym.Env("grasp", observe="rgb+depth") as blind, gym.Env("grasp", observe="state") as plain:
            self.assertEqual(one.observation_space, other.observation_space)
            self.assertEqual(list(blind.observation_space), ["rgb", "depth"])
            self.assertEqual(plain.observation_space.shape, (plain.pool.obs_dim,))
            first = one.reset(seed=3)[0]
            self.assertTrue(same(first, other.reset(seed=3)[0]))
            obs = blind.reset(seed=3)[0]
            self.assertEqual(list(obs), ["rgb", "depth"])
            self.assertTrue(same(obs["rgb"], first["rgb"]))
            self.assertIn(blind.step(blind.action_space.sample())[0], blind.observation_space)
        with gym.VectorEnv("grasp", 2, observe=["depth"]) as envs:
            self.assertEqual(envs.reset(seed=3)[0]["depth"].shape[0], 2)
        for wrong, words in ((["rgb", "rgb"], "differ"), ([], "differ"), ("rgbb", "rgbb")):
            with self.assertRaisesRegex(ValueError, words):
                gym.Env("grasp", observe=wrong)
        with self.assertRaisesRegex(ValueError, "say the same"):
            gym.Env("grasp", observe="rgb", options=options)

    def test_render(self):
        with gym.Env("hand_over_safe_finger", render_mode="rgb_array", width=64, height=48) as env:
            env.reset(seed=1)
            picture = env.render()
            self.assertEqual((picture.shape, picture.dtype, env.metadata["render_fps"]), ((48, 64, 3), np.uint8, 60))
            self.assertGreater(picture.std(), 0)
            self.assertIn(env.render_mode, env.metadata["render_modes"])
        with gym.Env("hand_over_safe_finger") as env:
            env.reset(seed=1)
            self.assertIsNone(env.render())
        with gym.Env("hand_over_safe_finger", render_mode="depth_array", width=64, height=48) as env:
            env.reset(seed=1)
            self.assertTrue(same(env.render(), env.pool.render(0, None, 64, 48, "depth")))
            self.assertGreater(env.render().max(), 0)
        with gym.VectorEnv("hand_over_safe_finger", 2, render_mode="rgb_array", width=64, height=48) as env:
            env.reset(seed=1)
            self.assertEqual([p.shape for p in env.render()], [(48, 64, 3)] * 2)

    def test_close_twice(self):
        for env in (gym.Env("bandit"), gym.VectorEnv("bandit", 2)):
            env.reset(seed=1)
            env.close()
            env.close()
            with self.assertRaisesRegex(redman.Error, "closed"):
                env.step(env.action_space.sample())


class Costs(unittest.TestCase):
    def test_names_limits_and_sums(self):
        with gym.Env("hand_over_safe_finger") as env:
            self.assertEqual(env.cost_names[:2], ("cost", "ff2_range"))
            self.assertEqual(env.cost_limits[0], 40)
            env.reset(seed=3)
            total, ended = np.zeros(8), False
            while not ended:
                *_, terminated, truncated, info = env.step(np.ones(40, np.float32))
                self.assertEqual(info["cost"], info["costs"][0])
                total += info["costs"]
                ended = terminated or truncated
            self.assertGreater(total[0], 0)
            np.testing.assert_array_equal(total, env.pool.episode_cost[0])

    def test_a_bad_action_is_told(self):
        with gym.Env("hand_over_safe_finger") as env:
            env.reset(seed=1)
            _, reward, terminated, truncated, info = env.step(np.full(40, np.nan, np.float32))
            self.assertEqual((reward, terminated, truncated, info["status"]), (0, False, True, 4))

    def test_named_fields(self):
        with gym.Env("hand_over_safe_finger") as flat, gym.Env("hand_over_safe_finger", named=True) as named:
            rows, entries = flat.reset(seed=1)[0], named.reset(seed=1)[0]
            self.assertEqual(list(entries), list(flat.fields))
            self.assertTrue(same(np.concatenate(list(entries.values())), rows))
            self.assertIn(entries, named.observation_space)
        with gym.VectorEnv("hand_over_safe_finger", 3, named=True) as named:
            self.assertIn(named.reset(seed=1)[0], named.observation_space)


class Senses(unittest.TestCase):
    """Option modality: pictures and clouds are observations, or are refused."""

    ALL = {"modality": "rgb+depth+segmentation+points+voxels", "image_width": 32, "image_height": 24, "points": 64,
           "voxels": 8, "point_color": True}

    def test_an_observation_has_all_that_was_asked_for(self):
        with gym.Env("grasp", options=self.ALL) as env, gym.Env("grasp") as blind:
            entries, row = env.reset(seed=1)[0], blind.reset(seed=1)[0]
            shapes = {"state": (211,), "rgb": (24, 32, 3), "depth": (24, 32), "segmentation": (24, 32),
                      "points": (64, 3), "point_class": (64,), "point_color": (64, 3), "voxels": (8, 8, 8)}
            self.assertEqual({name: value.shape for name, value in entries.items()}, shapes)
            for _ in range(3):
                self.assertIn(entries, env.observation_space)
                self.assertTrue(same(entries["state"], row))
                for name in shapes:
                    if name != "state":
                        seen = getattr(env.pool.sensors, name)[0]
                        self.assertTrue(same(entries[name], seen.reshape(shapes[name])), name)
                before = copy.deepcopy(entries)
                action = env.action_space.sample()
                after, row = env.step(action)[0], blind.step(action)[0]
                self.assertTrue(same(entries, before), "an earlier observation has changed")
                self.assertFalse(same(entries["rgb"], after["rgb"]))
                entries = after
            other = pickle.loads(pickle.dumps(env))
            self.assertTrue(same(other.step(action)[0], env.step(action)[0]))

    def test_two_cameras_and_named_fields(self):
        options = {"modality": "depth", "cameras": "front+above"}
        with gym.Env("grasp", options=options, named=True) as env:
            entries = env.reset(seed=1)[0]
            self.assertEqual(list(entries), [*env.fields, "depth"])
            self.assertEqual(entries["depth"].shape, (2, 64, 64))
            self.assertIn(entries, env.observation_space)

    def test_vectors_see_what_single_worlds_see(self):
        for mode in ("NextStep", "Disabled"):
            with gym.VectorEnv("grasp", 2, autoreset_mode=mode, options={**self.ALL, "max_steps": 3}) as envs:
                worlds = [gym.Env("grasp", options={**self.ALL, "max_steps": 3}) for _ in range(2)]
                rows = envs.reset(seed=5)[0]
                self.assertIn(rows, envs.observation_space)
                for i, env in enumerate(worlds):
                    env.reset(seed=5 + i)
                for _ in range(3):
                    actions = envs.action_space.sample()
                    rows, *_, truncated, _ = envs.step(actions)
                    for i, env in enumerate(worlds):
                        last = env.step(actions[i])[0]
                        self.assertTrue(all(same(rows[name][i], last[name]) for name in last), mode)
                self.assertTrue(truncated.all())
                if mode == "NextStep":
                    rows = envs.step(actions)[0]
                    for i, env in enumerate(worlds):
                        first = env.reset()[0]
                        self.assertTrue(all(same(rows[name][i], first[name]) for name in first))
                for env in worlds:
                    env.close()

    def test_where_they_cannot_be_they_are_refused(self):
        with self.assertRaisesRegex(redman.UnsupportedError, "modality=rgb: SameStep has no last picture"):
            gym.VectorEnv("grasp", 2, autoreset_mode="SameStep", options={"modality": "rgb"})


class Seeds(unittest.TestCase):
    def test_world_i_has_the_episode_of_seed_plus_i(self):
        for task in ("hand_over_safe_finger", "reorient", "point_goal1"):
            with self.subTest(task), gym.VectorEnv(task, 3) as envs, gym.Env(task) as env:
                rows, _ = envs.reset(seed=5)
                for i in range(3):
                    self.assertTrue(same(rows[i], env.reset(seed=5 + i)[0]))

    def test_a_list_and_none_in_it(self):
        with gym.VectorEnv("hand_over_safe_finger", 3) as envs, gym.Env("hand_over_safe_finger") as env:
            envs.reset(seed=5)
            rows, _ = envs.reset(seed=[9, None, 9])
            self.assertTrue(same(rows[0], rows[2]))
            env.reset(seed=6)
            self.assertTrue(same(rows[1], env.reset()[0]))

    def test_the_constructor_names_the_first_reset(self):
        with gym.Env("hand_over_safe_finger", seed=8) as env:
            first, second = env.reset()[0], env.reset()[0]
            self.assertTrue(same(first, env.reset(seed=8)[0]))
            self.assertTrue(same(second, env.reset()[0]))
        with gym.Env("hand_over_safe_finger") as one, gym.Env("hand_over_safe_finger") as other:
            self.assertFalse(same(one.reset()[0], other.reset()[0]))

    def test_wrong_seeds(self):
        with gym.VectorEnv("bandit", 3) as envs:
            for seed in ([1, 2], [1, -2, 3], -1, 2**64):
                with self.subTest(seed), self.assertRaisesRegex(ValueError, "seed"):
                    envs.reset(seed=seed)


class Loop:
    """Gymnasium's rules for vectors, over single worlds: what VectorEnv is held to where SyncVectorEnv is not at hand."""

    def __init__(self, task, n, mode, **kwargs):
        self.envs, self.mode, self.ended = [gym.Env(task, **kwargs) for _ in range(n)], mode, [False] * n

    def reset(self, seed, mask=None):
        for i, env in enumerate(self.envs):
            if mask is None or mask[i]:
                self.obs = getattr(self, "obs", [None] * len(self.envs))
                self.obs[i] = env.reset(seed=None if seed is None else seed + i)[0]
                self.ended[i] = False
        return np.stack(self.obs)

    def step(self, actions):
        n = len(self.envs)
        reward, terminated, truncated = np.zeros(n), np.zeros(n, bool), np.zeros(n, bool)
        cost, final = np.zeros(n), [None] * n
        for i, env in enumerate(self.envs):
            if self.mode == "NextStep" and self.ended[i]:
                self.obs[i], self.ended[i] = env.reset()[0], False
                continue
            self.obs[i], reward[i], terminated[i], truncated[i], info = env.step(actions[i])
            cost[i] = info["cost"]
            self.ended[i] = terminated[i] or truncated[i]
            if self.mode == "SameStep" and self.ended[i]:
                final[i], self.obs[i] = self.obs[i], env.reset()[0]
        return np.stack(self.obs), reward, terminated, truncated, cost, final


class Autoreset(unittest.TestCase):
    def test_every_mode_as_a_loop_over_single_worlds(self):
        for task, steps in SHORT.items():
            for mode in MODES:
                with self.subTest(task=task, mode=mode):
                    envs, loop = gym.VectorEnv(task, 4, autoreset_mode=mode), Loop(task, 4, mode)
                    self.assertTrue(same(envs.reset(seed=5)[0], loop.reset(5)))
                    envs.action_space.seed(1)
                    ends = 0
                    for _ in range(steps):
                        actions = envs.action_space.sample()
                        obs, reward, terminated, truncated, info = envs.step(actions)
                        other = loop.step(actions)
                        self.assertTrue(same((obs, reward, terminated, truncated), other[:4]))
                        self.assertTrue(same(envs.cost.astype(np.float64), other[4]))
                        ended = terminated | truncated
                        ends += ended.sum()
                        if mode == "SameStep" and ended.any():
                            final = info["final_observation" if gym._OLD else "final_obs"]
                            self.assertTrue(all(same(a, b) for a, b in zip(final, other[5])))
                        if mode == "Disabled" and ended.any():
                            self.assertTrue(same(envs.reset(options={"reset_mask": ended})[0], loop.reset(None, ended)))
                    self.assertGreaterEqual(ends, 4)

    def test_disabled_refuses_a_step_of_an_ended_world(self):
        with gym.VectorEnv("bandit", 2, autoreset_mode="Disabled") as envs:
            envs.reset(seed=1)
            envs.step(envs.action_space.sample())
            with self.assertRaises(RuntimeError):
                envs.step(envs.action_space.sample())

    def test_same_step_costs_are_where_gymnasium_puts_them(self):
        with gym.VectorEnv("bandit", 2, autoreset_mode="SameStep") as envs:
            envs.reset(seed=1)
            *_, info = envs.step(np.ones((2, 1), np.float32))
            self.assertEqual(info["cost"].tolist(), [0, 0])  # of the resets
            final = [row["cost"] for row in info["final_info"]] if gym._OLD else info["final_info"]["cost"]
            np.testing.assert_array_equal(final, envs.cost)
            self.assertGreater(envs.cost.min(), 0)

    def test_copies_or_views(self):
        for copied in (True, False):
            with gym.VectorEnv("hand_over_safe_finger", 2, copy=copied) as envs:
                obs, _ = envs.reset(seed=1)
                kept = obs.copy()
                envs.step(envs.action_space.sample())
                self.assertIs(same(obs, kept), copied)

    def test_threads_change_nothing(self):
        rows = []
        for threads in (0, 2):
            with gym.VectorEnv("hand_over_safe_finger", 5, threads=threads) as envs:
                envs.reset(seed=1)
                envs.action_space.seed(1)
                rows.append([envs.step(envs.action_space.sample()) for _ in range(20)])
        self.assertTrue(same(*rows))


class Decisions(unittest.TestCase):
    def test_action_repeat_is_a_loop_that_stops_at_the_end(self):
        with gym.Env("hand_over_safe_finger") as fine, gym.Env("hand_over_safe_finger", action_repeat="task") as coarse:
            self.assertEqual(coarse.metadata["render_fps"], 15)
            fine.reset(seed=2)
            coarse.reset(seed=2)
            fine.action_space.seed(1)
            ended = False
            while not ended:
                action = fine.action_space.sample()
                reward, costs = np.float32(0), np.zeros(8, np.float32)
                for _ in range(4):
                    obs, r, terminated, truncated, info = fine.step(action)
                    reward, costs = reward + np.float32(r), costs + info["costs"]
                    if terminated or truncated:
                        break
                step = coarse.step(action)
                ended = terminated or truncated
                self.assertTrue(same((obs, float(reward), terminated, truncated), step[:4]))
                self.assertTrue(same(costs, step[4]["costs"]))

    def test_center(self):
        with gym.Env("hand_over_safe_finger") as plain, gym.Env("hand_over_safe_finger", center="initial") as about:
            pose = about.worlds.center
            self.assertGreater(np.abs(pose).max(), 0.1)
            np.testing.assert_array_equal(about.action_space.low, -about.action_space.high)
            self.assertGreaterEqual((about.action_space.high + pose).min(), 1 - 1e-6)  # the whole range is in reach
            self.assertLessEqual((about.action_space.low + pose).max(), -1 + 1e-6)
            plain.reset(seed=1)
            about.reset(seed=1)
            self.assertTrue(same(plain.step(pose), about.step(np.zeros_like(pose))))
        with gym.Env("bandit", center=[0.25]) as about, gym.Env("bandit") as plain:
            plain.reset(seed=1)
            about.reset(seed=1)
            self.assertTrue(same(plain.step(np.float32([0.75])), about.step(np.float32([0.5]))))

    def test_a_zero_repeat_of_the_task(self):
        with gym.Env("bandit", action_repeat="task") as env:
            self.assertEqual(env.worlds.seconds, env.pool.control_dt)


class Copies(unittest.TestCase):
    def test_pickle_and_deepcopy_go_on_alike(self):
        for make in (lambda: gym.Env("hand_over_safe_finger", center="initial"),
                     lambda: gym.VectorEnv("hand_over_safe_finger", 3, autoreset_mode="SameStep")):
            env = make()
            env.reset(seed=4)
            action = env.action_space.sample()
            env.step(action)
            others = [pickle.loads(pickle.dumps(env)), copy.deepcopy(env)]
            expected = [env.step(action) for _ in range(80 if env.pool.num_envs > 1 else 5)]
            for other in others:
                self.assertTrue(same([other.step(action) for _ in expected], expected))


class Wrong(unittest.TestCase):
    def test_what_is_not_installed_is_told(self):
        for module, name in (("sb3", "stable_baselines3"), ("omnisafe", "omnisafe")):
            run = subprocess.run([sys.executable, "-c", f"import sys; sys.modules['{name}'] = None; import redman.{module}"],
                                 capture_output=True, text=True)
            self.assertRegex(run.stderr.strip().splitlines()[-1], f"^ImportError: redman.{module} needs ")
        blocked = "import sys; sys.modules['gymnasium'] = sys.modules['safety_gymnasium'] = None; import redman.safety as s"
        for call in ("s.gym.register()", "print(s.unregistered); s.register()"):
            run = subprocess.run([sys.executable, "-c", f"{blocked}; s.Env('bandit'); s.VectorEnv('bandit', 2); {call}"],
                                 capture_output=True, text=True)
            self.assertRegex(run.stderr.strip().splitlines()[-1], "Error: .*gymnasium|Gymnasium")

    def test_arguments(self):
        cases = (
            (lambda: gym.Env("hand_over_safe_fingr"), LookupError, "hand_over_safe_finger"),
            (lambda: gym.Env("bandit", options={"nonsense": 1}), LookupError, "nonsense"),
            (lambda: gym.Env("bandit", render_mode="human"), ValueError, "rgb_array"),
            (lambda: gym.Env("bandit", center="start"), ValueError, "initial"),
            (lambda: gym.Env("bandit", center=[0, 0]), ValueError, r"\[1\] numbers"),
            (lambda: gym.Env("bandit", center=[2.0]), ValueError, r"\[-1, 1\]"),
            (lambda: gym.VectorEnv("bandit", 2, autoreset_mode="Sometimes"), ValueError, "NextStep"),
            (lambda: gym.VectorEnv("bandit", 0), ValueError, "num_envs"),
        )
        for make, kind, text in cases:
            with self.subTest(text), self.assertRaisesRegex(kind, text):
                make()

    def test_actions_and_masks(self):
        with gym.Env("hand_over_safe_finger") as env:
            env.reset(seed=1)
            for action in (0.5, np.zeros(39), np.zeros((1, 40))):
                with self.assertRaisesRegex(ValueError, "action: its shape"):
                    env.step(action)
        with gym.VectorEnv("bandit", 2) as envs:
            envs.reset(seed=1)
            with self.assertRaisesRegex(ValueError, "action: its shape"):
                envs.step(np.zeros((3, 1)))
            for mask in ([True, False], np.zeros(2, bool), np.ones(3, bool), np.ones(2)):
                with self.assertRaisesRegex(ValueError, "reset_mask"):
                    envs.reset(options={"reset_mask": mask})

    def test_a_step_before_the_first_reset(self):
        with gym.Env("bandit") as env, self.assertRaises(RuntimeError):
            env.step(np.zeros(1, np.float32))


@peers.needs("gymnasium")
class WithGymnasium(unittest.TestCase):
    """The same classes in Gymnasium's own hands."""

    def test_the_checker_is_silent(self):
        import gymnasium
        from gymnasium.utils.env_checker import check_env
        for task in TASKS:
            with self.subTest(task), warnings.catch_warnings(record=True) as said:
                warnings.simplefilter("always")
                env = gymnasium.make(gym.env_id(task), render_mode="rgb_array", width=64, height=48)
                check_env(env.unwrapped)
                env.close()
                space = env.observation_space
                unbounded = not (np.isfinite(space.low).all() and np.isfinite(space.high).all())
                rest = [str(w.message) for w in said if not (unbounded and "infinity" in str(w.message))]
                self.assertEqual([text for text in rest if "Box" in text or "env" in text.lower()], [])
        check_env(gymnasium.make(gym.env_id("hand_over_safe_joint"), options={"action_repeat": 4},
                                 shield={"noise": 0}).unwrapped, skip_render_check=True)

    def test_every_task_has_an_id(self):
        import gymnasium
        for task in redman.tasks():
            env = gymnasium.make(gym.env_id(task))
            self.assertEqual((env.unwrapped.pool.task.name, env.spec.id), (task, gym.env_id(task)))
            self.assertEqual(env.spec.max_episode_steps, redman.task(task).max_steps)
            env.close()

    def test_an_episode_is_as_long_as_its_options_say(self):
        import gymnasium
        env = gymnasium.make(gym.env_id("lqr_line"), options={"max_steps": 50})
        for again in (env, gymnasium.make(env.spec)):
            again.reset(seed=1)
            steps = 1
            while not any(again.step(again.action_space.sample())[2:4]):
                steps += 1
            self.assertEqual((again.spec.max_episode_steps, steps), (50, 50))
            again.close()

    def test_sync_vector_env_bit_for_bit(self):
        from gymnasium.vector import SyncVectorEnv
        try:
            from gymnasium.vector import AutoresetMode
            modes = [(mode, {"autoreset_mode": AutoresetMode(mode)}) for mode in MODES]
        except ImportError:
            modes = [("SameStep" if gym._OLD else "NextStep", {})]
        decisions = {"action_repeat": "task", "center": "initial", "named": True}
        shielded = {"options": {"action_repeat": 4}, "shield": {"noise": 0}}
        for task, steps, kwargs in (*((*row, {}) for row in SHORT.items()), ("hand_over_safe_joint", 30, decisions),
                                    ("hand_over_safe_joint", 45, shielded)):
            for mode, argument in modes:
                with self.subTest(task=task, mode=mode):
                    ours = gym.VectorEnv(task, 4, autoreset_mode=mode, **kwargs)
                    theirs = SyncVectorEnv([lambda: gym.Env(task, **kwargs)] * 4, **argument)
                    self.assertEqual(ours.observation_space, theirs.observation_space)
                    self.assertEqual(ours.action_space, theirs.action_space)
                    self.assertEqual(ours.metadata.get("autoreset_mode"),
                                     theirs.metadata.get("autoreset_mode", gym.AutoresetMode(mode)))
                    self.assertTrue(same(ours.reset(seed=5), theirs.reset(seed=5)))
                    ours.action_space.seed(1)
                    for _ in range(steps):
                        actions = ours.action_space.sample()
                        mine, other = ours.step(actions), theirs.step(actions)
                        self.assertTrue(same(mine, other), f"{mine}\n{other}")
                        ended = mine[2] | mine[3]
                        if mode == "Disabled" and ended.any():
                            self.assertTrue(same(ours.reset(options={"reset_mask": ended}),
                                                 theirs.reset(options={"reset_mask": ended})))
                    self.assertTrue(same(ours.reset(seed=[3, 1, 4, 1]), theirs.reset(seed=[3, 1, 4, 1])))
                    self.assertTrue(same(ours.reset(), theirs.reset()))
                    ours.close()
                    theirs.close()

    def test_videos_have_a_picture_of_every_step(self):
        """RecordVideo, over a stand-in for moviepy that keeps what it is given."""
        import gymnasium
        from gymnasium.wrappers import RecordVideo
        films = {}

        class Clip:
            def __init__(self, frames, fps):
                self.frames, self.fps = [frame.copy() for frame in frames], fps

            def write_videofile(self, path, **_):
                films[Path(path).name] = self

        module = types.ModuleType("moviepy.video.io.ImageSequenceClip")
        module.ImageSequenceClip = Clip
        names = ["moviepy", "moviepy.video", "moviepy.video.io"]
        modules = {**{name: types.ModuleType(name) for name in names}, module.__name__: module}
        made = {"width": 32, "height": 24, "options": {"max_steps": 5}}
        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(sys.modules, modules):
            for mode in ("rgb_array", "rgb_array_list"):
                films.clear()
                env = RecordVideo(gymnasium.make(gym.env_id("ball_run"), render_mode=mode, **made), folder + "/" + mode,
                                  episode_trigger=lambda _: True)
                pool = env.unwrapped.pool
                expected = []
                for seed in (1, 2):
                    env.reset(seed=seed)
                    expected.append([pool.render(width=32, height=24)])
                    for _ in range(5):
                        env.step(np.ones(2, np.float32))
                        expected[-1].append(pool.render(width=32, height=24))
                env.close()
                self.assertEqual(sorted(films), ["rl-video-episode-0.mp4", "rl-video-episode-1.mp4"])
                for (_, film), pictures in zip(sorted(films.items()), expected):
                    self.assertEqual((len(film.frames), film.fps), (6, 60))
                    self.assertTrue(same(film.frames, pictures))

    def test_dicts_go_through_its_hands(self):
        import gymnasium
        from gymnasium.spaces.utils import flatdim
        from gymnasium.utils.env_checker import check_env
        env = gymnasium.make(gym.env_id("grasp"), observe=["state", "rgb", "depth", "points"],
                             options={"image_width": 16, "image_height": 12, "points": 32})
        self.assertIsInstance(env.observation_space, gymnasium.spaces.Dict)
        self.assertGreater(flatdim(env.observation_space), env.unwrapped.pool.obs_dim)
        check_env(env.unwrapped, skip_render_check=True)
        env.close()

    def test_wrappers(self):
        import gymnasium
        envs = gym.VectorEnv("bandit", 3)
        if gym._OLD:
            from gymnasium.wrappers import RecordEpisodeStatistics
            wrapped = RecordEpisodeStatistics(gym.VectorEnv("hand_over_safe_finger", 3))
        else:
            from gymnasium.wrappers.vector import RecordEpisodeStatistics
            wrapped = RecordEpisodeStatistics(gym.VectorEnv("hand_over_safe_finger", 3))
        wrapped.reset(seed=1)
        pool, ends = wrapped.unwrapped.pool if hasattr(wrapped, "unwrapped") else wrapped.env.pool, 0
        for _ in range(90):
            *_, terminated, truncated, info = wrapped.step(np.zeros((3, 40), np.float32))
            for i in np.flatnonzero(terminated | truncated):
                ends += 1
                self.assertAlmostEqual(float(info["episode"]["r"][i]), float(pool.episode_return[i]), places=4)
                self.assertEqual(int(info["episode"]["l"][i]), int(pool.episode_step[i]))
        self.assertGreater(ends, 2)
        envs.close()
        env = gymnasium.wrappers.NormalizeObservation(gymnasium.make(gym.env_id("hand_over_safe_finger")))
        self.assertEqual(env.reset(seed=1)[0].shape, (398,))

    def test_named_entries_flatten_to_the_row(self):
        from gymnasium.spaces import flatten
        with gym.Env("grasp", named=True) as named, gym.Env("grasp") as plain:
            entries, row = named.reset(seed=1)[0], plain.reset(seed=1)[0]
            self.assertTrue(same(flatten(named.observation_space, entries), row))

    def test_make_vec(self):
        import gymnasium
        kwargs = {"vectorization_mode": "custom"} if gym._OLD else {}
        envs = gymnasium.make_vec(gym.env_id("hand_over_safe_finger"), num_envs=3, **kwargs)
        self.assertIsInstance(envs, gym.VectorEnv)
        self.assertEqual(envs.reset(seed=1)[0].shape, (3, 398))
        self.assertEqual(envs.spec.id, gym.env_id("hand_over_safe_finger"))
        self.assertEqual(envs.spec.max_episode_steps, 75)
        if not gym._OLD:
            gymnasium.make_vec(envs.spec).close()
        envs.close()

    def test_async_vector_env(self):
        from gymnasium.vector import AsyncVectorEnv
        for context in ("fork", "spawn"):
            with self.subTest(context):
                theirs = AsyncVectorEnv([_make] * 2, context=context)
                ours = gym.VectorEnv("hand_over_safe_finger", 2)
                self.assertTrue(same(ours.reset(seed=5)[0], theirs.reset(seed=5)[0]))
                for _ in range(5):
                    actions = np.full((2, 40), 0.5, np.float32)
                    self.assertTrue(same(ours.step(actions)[:4], theirs.step(actions)[:4]))
                theirs.close()
                ours.close()


def _make():
    return gym.Env("hand_over_safe_finger")


class Peers(unittest.TestCase):
    def test_with_every_copy_of_gymnasium(self):
        found = peers.copies("gymnasium-")
        if not found:
            self.skipTest("REDMAN_PEERS names no folder with gymnasium-VERSION in it")
        cases = [name for name, kind in globals().items()
                 if inspect.isclass(kind) and issubclass(kind, unittest.TestCase) and name != "Peers"]
        for path in found:
            with self.subTest(path.name):
                peers.rerun(self, "test_python_gym", cases, path)


if __name__ == "__main__":
    unittest.main()
