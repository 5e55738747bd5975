"""Tasks of one's own in Python: their worlds, errors, options, states, other processes, learning."""
import concurrent.futures
import json
import multiprocessing
import sys
import tempfile
import threading
import traceback
import unittest
from pathlib import Path

import numpy as np

import redman

sys.modules.setdefault("test_python_own_task", sys.modules[__name__])  # workers import it under its own name


class PushBall(redman.Task):
    """Push a ball to the origin.

    More is not in the summary."""

    max_steps, action_dim = 30, 2
    fields = {"position": (2, "m"), "velocity": (2, "m/s", -50, 50), "mass": 1}
    costs = {"right": (5, "x above 0.5 m"), "speed": None}
    options = {"mass": 0.2, "start": (0.2, 1.0), "kind": "plain", "bounce": False, "count": 3}
    state = {"start": 2}
    defaults = {"hidden": (16, 16), "horizon": 30}
    hold = (0.5, 0)
    obs_limit = 100

    def scene(self, s):
        self.ball = s.sphere("ball", 0.05, mass=s.option("mass"), color=(200, 30, 30))
        self.mass = s.option("mass")
        self.start = s.option("start")
        self.said = s.options
        s.plane()
        self.ground = s.touch("ball", "ground")

    def reset(self, w):
        w.state["start"] = w.uniform(*self.start, 2) * np.sign(w.uniform(-1, 1, 2))
        w.set_body(self.ball, p=np.c_[w.state["start"], np.full(w.n, 0.05)])

    def control(self, w, action):
        w.push(self.ball, force=np.c_[action, np.zeros(w.n)])

    def judge(self, w):
        x, v = w.position(self.ball), w.velocity(self.ball)
        distance = np.linalg.norm(x[:, :2], axis=1)
        return redman.Verdict(-distance, {"right": x[:, 0] > 0.5, "speed": np.linalg.norm(v, axis=1)},
                              raw={"right": x[:, 0]}, terminated=distance > 3, success=distance < 0.1)

    def observe(self, w):
        return w.position(self.ball)[:, :2], w.velocity(self.ball)[:, :2], np.full(w.n, self.mass)


class Reach(redman.Task):
    """A finger of a Shadow Hand goes to where a goal is."""

    action_dim = 20
    fields = {"joints": 24, "goal": (3, "m")}
    costs = ("bent",)
    state = {"goal": 3}

    def scene(self, s):
        self.hand = s.robot("shadow_hand", "hand", pose=[0, 0, 0.3])
        s.plane()
        self.tip = s.find("link", "hand_ff_distal")
        self.names = s.joints()

    def reset(self, w):
        w.set_joints(self.hand, np.tile(w.uniform(0, 0.1)[:, None], 24))
        w.state["goal"] = w.normal(3) * 0.01 + [0, -0.4, 0.3]

    def control(self, w, action):
        w.command(self.hand, action)

    def judge(self, w):
        gap = np.linalg.norm(w.link(self.tip)[:, :3] - w.state["goal"], axis=1)
        return redman.Verdict(-gap, {"bent": np.abs(w.q).max(axis=1) > 1.5}, success=gap < 0.02)

    def observe(self, w):
        return {"joints": w.q, "goal": w.state["goal"]}


class Cart(redman.RowTask):
    """A cart on a line, without bodies."""

    action_dim, fields, costs = 1, {"position": 1, "velocity": 1}, {"fast": (1, "faster than 0.3 m/s")}
    state = {"position": 1, "velocity": 1}

    def reset(self, w):
        w.state["position"] = w.uniform(-1, 1, 1)

    def step(self, w, action):
        s = w.state
        s["velocity"] += 0.05 * action
        s["position"] += 0.05 * s["velocity"]
        return redman.Verdict(-s["position"][:, 0] ** 2, {"fast": np.abs(s["velocity"][:, 0]) > 0.3})

    def observe(self, w):
        return w.state["position"], w.state["velocity"]


class Gust(PushBall):
    """A wind that is drawn in each step."""

    draws = True

    def control(self, w, action):
        w.push(self.ball, force=np.c_[0.3 * w.normal(2), w.overlap(self.ball)])


class Broken(PushBall):
    """Fails where it is told to."""

    name = "broken_ball"
    fault = ""

    def judge(self, w):
        if Broken.fault == "raises":
            raise ValueError("no such thing")
        if Broken.fault == "name":
            return redman.Verdict(0.0, {"rihgt": 1})
        if Broken.fault == "some":
            w.fail(w.number == 1)
        if Broken.fault == "rows":
            return redman.Verdict(-float(w.n))
        return super().judge(w)

    def observe(self, w):
        if Broken.fault == "shape":
            return w.position(self.ball), w.velocity(self.ball)[:, :2], np.zeros(w.n)
        if Broken.fault == "fields":
            return {"position": w.position(self.ball)[:, :2], "velocity": w.velocity(self.ball)[:, :2], "weight": np.zeros(w.n)}
        if Broken.fault == "sets":
            w.set_body(self.ball, p=[0, 0, 1])
        return super().observe(w)


def stepped(pool, steps=40):
    pool.reset()
    for _ in range(steps):
        pool.step(pool.baseline("random"))
    return pool.hash()


def hash_elsewhere(pool):
    return stepped(pool)


class OwnTask(unittest.TestCase):
    def setUp(self):
        Broken.fault = ""

    def test_it_is_a_task_like_others(self):
        pool = redman.Pool(PushBall, num_envs=5, seed=3)
        info = redman.task(PushBall)
        self.assertEqual((info.name, info.summary), ("push_ball", "Push a ball to the origin."))
        self.assertEqual(list(info.costs), ["right", "speed"])
        self.assertEqual((info.costs["right"].limit, info.costs["right"].help, info.costs["speed"].limit),
                         (5, "x above 0.5 m", None))
        self.assertEqual((info.fields["velocity"].unit, info.fields["velocity"].low), ("m/s", -50))
        self.assertEqual(info.defaults["hidden"], "16,16")
        self.assertIs(redman.task("push_ball"), info)
        self.assertEqual((pool.max_steps, pool.action_dim, pool.obs_dim), (30, 2, 5))
        pool.reset()
        np.testing.assert_array_equal(pool.baseline("hold")[0], [0.5, 0])
        pool.step()
        self.assertTrue((pool.obs[:, pool.fields["mass"].slice] == np.float32(0.2)).all())
        self.assertTrue((np.abs(pool.obs[:, :2]) > 0.1).all())

    def test_a_scene_has_a_robot_of_its_own(self):
        cap = {"name": "cap", "joint": "spring", "parent": "root", "kind": "prismatic", "axis": [0, 0, 1], "lower": -0.01,
               "kp": 100, "kd": 2, "effort": 2, "mass": 0.02, "moment": [1e-5, 1e-5, 1e-5, 0, 0, 0]}

        class Button(PushBall):
            name, button = "button", {"links": [cap], "shapes": [{"name": "top", "link": "cap", "kind": "sphere", "size": 0.01}]}

            def scene(self, s):
                s.robot(self.button, "first", pose=[1, 0, 0.3])
                s.robot(self.button, "second", pose=[0, 1, 0.3])
                super().scene(s)
                self.springs = s.joints()

        known = list(redman.robots())
        pool = redman.Pool(Button)
        self.assertEqual([joint.name for joint in pool.joints], ["first_spring", "second_spring"])
        self.assertEqual(list(redman.robots()), known)  # it is none of the list
        Button.unregister()
        Button.name, Button.button = "button_wrong", {"links": [{**cap, "parent": "rooot"}]}
        with self.assertRaisesRegex(redman.Error, r"Button\.scene raised .*robot first: links.*parent: 'rooot' is none of root"):
            redman.Pool(Button)
        Button.unregister()

    def test_what_it_promises_holds(self):
        redman.check_task(PushBall)
        redman.check_task(Gust)
        redman.check_task(Reach)

    def test_same_bytes_for_any_threads_and_from_a_state(self):
        hashes = {stepped(redman.Pool(PushBall, num_envs=9, seed=1, threads=threads)) for threads in (0, 2, 3)}
        self.assertEqual(len(hashes), 1)
        a, b = (redman.Pool(Reach, num_envs=3, seed=2) for _ in range(2))
        stepped(a, 11)
        b.reset()
        for i in range(3):
            b.set_state(a.state(i), i)
        for _ in range(20):
            a.step(a.baseline("random"))
            b.step(np.array(a.action))
        np.testing.assert_array_equal(a.obs, b.obs)
        np.testing.assert_array_equal(a.reward, b.reward)

    def test_rewards_and_costs_are_what_judge_says(self):
        pool = redman.Pool(PushBall, num_envs=50, seed=4)
        pool.reset()
        pool.step(pool.baseline("random"))
        place = pool.final_obs[:, :2]
        np.testing.assert_allclose(pool.reward, -np.linalg.norm(place, axis=1), rtol=1e-6)
        np.testing.assert_array_equal(pool.cost[:, 0], place[:, 0] > 0.5)
        np.testing.assert_allclose(pool.cost_raw[:, 0], place[:, 0], rtol=1e-6)
        np.testing.assert_allclose(pool.cost[:, 1], pool.cost_raw[:, 1])

    def test_options_of_a_pool_reach_the_scene(self):
        pool = redman.Pool(PushBall, options={"mass": 0.5, "kind": "odd", "bounce": True, "count": 7, "start": (0.3, 0.4)})
        pool.reset()
        self.assertEqual(pool.obs[0, 4], 0.5)
        self.assertTrue((np.abs(pool.obs[0, :2]) < 0.41).all())
        self.assertEqual(pool.options["kind"], "odd")
        with self.assertRaisesRegex(redman.NotFoundError, "mass"):
            redman.Pool(PushBall, options={"mas": 1})
        other = redman.Pool(PushBall)
        other.reset()
        self.assertEqual(other.obs[0, 4], np.float32(0.2))

    def test_a_range_is_the_default_of_an_option(self):
        pool = redman.Pool(PushBall, num_envs=50, seed=1)
        starts = abs(pool.reset()[:, :2])
        self.assertTrue((starts > 0.2).all() and (starts < 1).all() and starts.std() > 0.1)
        self.assertEqual((pool.options["start"], redman.task(PushBall).options["start"].default), ("0.2..1", "0.2..1"))
        again = redman.Pool(PushBall, num_envs=50, seed=1, options={"start": (0.2, 1.0)})
        np.testing.assert_array_equal(again.reset(seeds=1), pool.reset(seeds=1))
        for key in ("start", "START"):
            alone = redman.Pool(PushBall, num_envs=5, options={key: 0.6})
            np.testing.assert_allclose(abs(alone.reset()[:, :2]), 0.6, rtol=1e-6)
            self.assertEqual(alone.options["start"], 0.6)
        with tempfile.TemporaryDirectory() as folder:
            redman.train(PushBall, steps=60, envs=2, progress=False, out=f"{folder}/run")
            self.assertEqual(json.loads(Path(folder, "run", "config.json").read_text())["env_cfgs"]["start"], "0.2..1")
        redman.check_task(PushBall)
        with self.assertRaisesRegex(redman.RangeError, "start: the range 1..0.2"):
            redman.Pool(type("Turned", (PushBall,), {"options": {**PushBall.options, "start": (1.0, 0.2)}}))

    def test_each_function_raises_the_same_kind_of_error(self):
        class Fails(Cart):
            fault = ""

            def at(self, name):
                if Fails.fault == name:
                    raise KeyError("no such thing")

            def scene(self, s):
                self.at("scene")
                super().scene(s)

            def reset(self, w):
                self.at("reset")
                super().reset(w)

            def control(self, w, action):
                self.at("control")
                super().control(w, action)

            def judge(self, w):
                self.at("judge")
                return super().judge(w)

            def observe(self, w):
                self.at("observe")
                return super().observe(w)

        pool = redman.Pool(Fails)
        for name in ("scene", "reset", "control", "judge", "observe"):
            Fails.fault = ""
            pool.reset()
            Fails.fault = name
            with self.subTest(name), self.assertRaisesRegex(redman.ArgumentError, f"Fails.{name} raised KeyError") as caught:
                redman.Pool(Fails, options={"frequency": 20}).reset() if name == "scene" else pool.reset() if name == "reset" else pool.step(0.0)
            self.assertIsInstance(caught.exception.__cause__, KeyError)
            self.assertEqual(caught.exception.code, redman.ResultCode.ARGUMENT)
        Fails.unregister()

    def test_what_a_function_raises_comes_out_of_no_other_call(self):
        class NoScene(PushBall):
            def scene(self, s):
                raise ValueError("no scene")

        self.addCleanup(NoScene.unregister)
        with self.assertRaisesRegex(redman.ArgumentError, "NoScene.scene raised ValueError"):
            redman.Pool(NoScene)
        self.assertNotIn("no_scene", redman.tasks())
        other = redman.Pool("recall", 2)
        other.reset()
        told = []

        def step_other():
            try:
                other.step(other.baseline("hold"))
            except redman.Error as error:
                told.append(error)

        class Nested(Broken):
            name = "nested_ball"

            def reset(self, w):
                if Broken.fault:  # judge of the same step has raised
                    step_other()
                    thread = threading.Thread(target=step_other)
                    thread.start()
                    thread.join()
                super().reset(w)

        pool = redman.Pool(Nested)
        pool.reset()
        shield = redman.Shield(pool)
        Broken.fault = "raises"
        with self.assertRaisesRegex(redman.ArgumentError, "Nested.judge raised ValueError: no such thing"):
            pool.step(pool.baseline("hold"))
        self.assertEqual(told, [])
        with self.assertRaisesRegex(redman.Error, "Nested.judge raised ValueError: no such thing"):
            shield.act(pool.baseline("hold"))
        other.step(other.baseline("hold"))

    def test_what_a_function_raises_comes_out_of_step(self):
        pool = redman.Pool(Broken, num_envs=2)
        pool.reset()
        Broken.fault = "raises"
        with self.assertRaisesRegex(redman.Error, "Broken.judge raised ValueError: no such thing") as caught:
            pool.step(pool.baseline("hold"))
        self.assertIn("raise ValueError", "".join(traceback.format_exception(caught.exception)))
        self.assertTrue((pool.truncated == 1).all())
        Broken.fault = ""
        pool.step(pool.baseline("hold"))  # they began anew
        self.assertTrue((pool.status == 0).all())

    def test_mistakes_are_named(self):
        for fault, said in (("name", "the task has no cost 'rihgt'.*right"), ("shape", r"field 'position' has shape \(2, 3\), not \(2, 2\)"),
                            ("fields", "'mass', 'weight'"), ("sets", "it cannot be changed in observe")):
            Broken.fault = ""
            pool = redman.Pool(Broken, num_envs=2)
            pool.reset()
            Broken.fault = fault
            with self.subTest(fault), self.assertRaisesRegex(redman.Error, said):
                pool.step(pool.baseline("hold"))
        Broken.fault = "rows"
        with self.assertRaisesRegex(redman.ArgumentError, "computed together with other worlds"):
            redman.check_task(Broken)

    def test_one_world_fails_alone(self):
        pool = redman.Pool(Broken, num_envs=3)
        pool.reset()
        Broken.fault = "some"
        pool.step(pool.baseline("hold"))
        self.assertEqual([bool(status & redman.Status.TASK) for status in pool.status], [False, True, False])

    def test_classes_that_cannot_be_are_told(self):
        for members, said in (({"action_dim": 0}, "action_dim"), ({"fields": {}}, "fields"), ({"costs": {}}, "costs"),
                              ({"fields": {"x": "3"}}, r"fields\['x'\]"), ({"options": {"a": None}}, r"options\['a'\]"),
                              ({"hold": (1, 2, 3)}, "hold"), ({"name": "bad name"}, "bad name"), ({"name": "grasp"}, "grasp")):
            kind = type("Odd", (PushBall,), {"name": "odd", **members})
            with self.subTest(members), self.assertRaisesRegex(redman.Error, said):
                redman.Pool(kind)

    def test_a_class_that_changed_is_registered_anew(self):
        first = type("Again", (PushBall,), {"max_steps": 7})
        second = type("Again", (PushBall,), {"max_steps": 8})
        kept = redman.Pool(first)
        with self.assertRaisesRegex(redman.ArgumentError, "again"):
            redman.Pool(second)
        first.unregister()
        self.assertEqual(redman.Pool(second).max_steps, 8)
        kept.reset()
        kept.step(kept.baseline("hold"))
        second.unregister()

    def test_other_processes_import_it(self):
        sys.path.insert(0, str(Path(__file__).parent))
        import test_python_own_task as module
        pool = redman.Pool(module.PushBall, num_envs=4, seed=6)
        with concurrent.futures.ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as workers:
            self.assertEqual(workers.submit(module.hash_elsewhere, pool).result(), stepped(pool))

    def test_it_is_learned_and_found_again(self):
        with tempfile.TemporaryDirectory() as folder:
            run = redman.train(PushBall, steps=3000, envs=8, progress=False, out=f"{folder}/run")
            self.assertEqual(json.loads(Path(folder, "run/config.json").read_text())["task"], "push_ball")
            told = redman.evaluate(run.policy, PushBall, episodes=8)
            self.assertEqual(told.task_failed, 0)
            self.assertEqual(redman.evaluate(redman.Policy.load(f"{folder}/run"), episodes=8).return_mean, told.return_mean)
        pool = redman.Pool(PushBall, num_envs=2)
        pool.reset()
        self.assertEqual(pool.render(width=64, height=48).shape[:2], (48, 64))
        planner = redman.Planner(pool, options={"samples": 4, "horizon": 3})
        self.assertEqual(planner.act(0).shape, (2,))

    def test_a_world_of_numbers_alone(self):
        redman.check_task(Cart)
        pool = redman.Pool(Cart, num_envs=3, seed=5)
        x, v = pool.reset()[:, :1].astype(np.float64), np.zeros((3, 1))
        for _ in range(30):
            action = pool.baseline("random").copy()
            pool.step()
            v += 0.05 * action
            x += 0.05 * v
            np.testing.assert_allclose(pool.obs, np.hstack([x, v]), rtol=1e-5, atol=1e-6)
            np.testing.assert_array_equal(pool.cost[:, 0], np.abs(v[:, 0]) > 0.3)
        agent = redman.Agent(pool)
        self.assertGreater(agent.rollout(pool).env_steps, 0)

    def test_draws_within_an_episode(self):
        pool = redman.Pool(Gust, num_envs=40, seed=1)
        pool.reset()
        before = pool.obs[:, 2:4].copy()
        pool.step(pool.baseline("zero"))
        first = pool.obs[:, 2:4] - before
        pool.step(pool.baseline("zero"))
        self.assertGreater(first.std(), 1e-3)
        self.assertLess(abs(np.corrcoef(first.ravel(), (pool.obs[:, 2:4] - before - first).ravel())[0, 1]), 0.5)
        with self.assertRaisesRegex(redman.Error, "draws = True"):
            class Dry(Gust):
                draws = False
            redman.check_task(Dry)

    def test_parts_of_a_world(self):
        pool = redman.Pool(Reach, num_envs=4, seed=1)
        pool.reset()
        self.assertAlmostEqual(float(pool.obs[0, 0]), float(pool.obs[0, 5]), places=5)
        self.assertFalse((pool.obs[0] == pool.obs[1]).all())
        before = pool.obs.copy()
        for _ in range(5):
            pool.step(np.ones((4, 20), np.float32))
        self.assertGreater(np.abs(pool.obs[:, :24] - before[:, :24]).max(), 0.05)
        np.testing.assert_array_equal(pool.obs[:, 24:], before[:, 24:])  # the state stays


if __name__ == "__main__":
    unittest.main()
