"""Mistakes in calls: misspelt attributes, options that were read and are changed in vain, arguments of wrong types."""
import copy
import enum
import json
import os
import pathlib
import pickle
import re
import tempfile
import unittest
from unittest import mock

import numpy as np

import redman

TASK = "ball_run"
OPEN = (redman.Callback, redman.Task)  # users derive their own classes from these


def made():
    """Objects that a user has, by what they are called."""
    pool = redman.Pool(TASK, 2)
    pool.reset()
    agent = redman.Agent(pool, options={"horizon": 32})
    policy = agent.policy()
    with pool.record() as episode:
        pool.step()
    return {"pool": pool, "agent": agent, "shield": redman.Shield(pool), "planner": redman.Planner(pool), "recording": redman.Recording(pool),
            "policy": policy, "actor": policy.actor(pool), "map": redman.Map(), "sensors": pool.sensors, "ranks": redman.Ranks(0, 1),
            "rows": redman.Rows(pool), "episode": episode, "curve": redman.Curve({"TotalEnvSteps": [1]}), "task": pool.task,
            "curves": redman.Curves([]), "comparison": redman.Comparison({}, {}), "epoch": agent.rollout(pool), "tensors": policy.tensors}


class Attributes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = made()

    @classmethod
    def tearDownClass(cls):
        del cls.made

    def test_a_name_that_an_object_does_not_have_is_not_set(self):
        for name, thing in self.made.items():
            with self.subTest(name), self.assertRaises(AttributeError):
                thing.no_such_name = 3

    def test_every_public_class_has_such_objects(self):
        for name in redman.__all__:
            kind = getattr(redman, name)
            if isinstance(kind, type) and not issubclass(kind, (BaseException, enum.Enum, tuple, *OPEN)) and "__slots__" not in vars(kind):
                self.assertIsNot(kind.__setattr__, object.__setattr__, name)

    def test_the_error_offers_the_right_word(self):
        for name, attribute, words in (
                ("pool", "optoins", r"Pool\.optoins: .*nearest is options"), ("pool", "num_env", "nearest is num_envs"),
                ("agent", "lerning_rate", "nearest is learning_rate"), ("agent", "lr", r"agent\.set\(learning_rate=\.\.\.\)"),
                ("agent", "recordin", "nearest is recording"), ("pool", "max_step", "nearest is max_steps"),
                ("shield", "copys", "nearest is copies"), ("planner", "sample", "nearest is samples"), ("planner", "method", r"Planner\(pool, method="),
                ("recording", "actions", "action"), ("policy", "task", r"policy\.info\.task")):
            with self.subTest(attribute), self.assertRaisesRegex(AttributeError, words):
                setattr(self.made[name], attribute, 1)

    def test_what_an_object_was_made_with_stays(self):
        for name, attribute in (("pool", "num_envs"), ("pool", "reward"), ("agent", "obs_dim"), ("planner", "horizon"), ("recording", "task"),
                                ("actor", "stochastic"), ("policy", "info"), ("ranks", "rank")):
            with self.subTest(f"{name}.{attribute}"), self.assertRaises(AttributeError):
                setattr(self.made[name], attribute, 1)

    def test_what_can_be_set_can_still_be_set(self):
        pool, agent = self.made["pool"], self.made["agent"]
        pool.action = 0.5
        self.assertTrue((pool.action == 0.5).all())
        agent.recording = agent.shield = None
        self.made["curve"].label = "mine"
        self.made["map"].dropped = 0

    def test_classes_of_users_have_attributes_of_their_own(self):
        class Worlds(redman.Pool):
            def __init__(self):
                super().__init__(TASK)
                self.seen = 0

        class Count(redman.Callback):
            def __init__(self):
                self.epochs = 0

        Worlds().seen += 1
        Count().epochs += 1
        env = redman.make(TASK)
        env.note = "mine"
        env.close()


class Options(unittest.TestCase):
    def test_options_that_were_read_cannot_be_changed(self):
        for name, thing in made().items():
            if name not in ("pool", "agent", "shield", "planner"):
                continue
            for change in (lambda o: o.update(seed=1), lambda o: o.pop("seed"), lambda o: o.__setitem__("horizon", 1), lambda o: o.clear(),
                           lambda o: o.__delitem__("horizon"), lambda o: o.setdefault("seed", 1), lambda o: o.__ior__({})):
                with self.subTest(name), self.assertRaisesRegex(TypeError, r"^options: .*(agent\.set\(|options=\{)"):
                    change(thing.options)

    def test_they_are_read_and_copied_like_a_dict(self):
        options = redman.Pool(TASK, options={"max_steps": 20}).options
        self.assertEqual(json.loads(json.dumps(options))["max_steps"], 20)
        for same in (dict(options), {**options}, options | {}, options.copy(), copy.copy(options), copy.deepcopy(options),
                     pickle.loads(pickle.dumps(options))):
            self.assertEqual(same, options)
            same["max_steps"] = 30
        self.assertEqual(redman.Pool(TASK, options=options).options, options)


# Values that are right for few arguments: each is put in the place of each argument of a call that is right.
ODD = ("x", None, [1, 2], ["a", "b"], [[1], [1, 2]], pathlib.Path("x"), object(), 3, 1.5, b"x", {"a": 1}, {1: 2}, float("nan"), -1, 1 << 70, 1j, True,
       np.zeros((3, 3)), np.array([None, 1], object), dict, len)


def calls(thing, folder):
    """Calls that are right, as (what is called, its arguments)."""
    pool, agent, shield, planner, policy = (thing[name] for name in ("pool", "agent", "shield", "planner", "policy"))
    obs, action, mask = pool.obs.copy(), pool.action.copy(), [True, False]
    recording, actor, occupied = thing["recording"], thing["actor"], thing["map"]
    robot, clone = redman.robot("franka_panda"), {"epochs": 1, "batch_rows": 4, "validation": 0.0, "learning_rate": 1e-3, "seed": 0}
    free = redman.Agent(obs_dim=3, action_dim=1, num_envs=2, options={"horizon": 4})
    for _ in range(3):
        with recording.step(pool):
            pool.step()
    return (
        (redman.Pool, {"task": TASK, "num_envs": 2, "seed": 1, "threads": 0, "autoreset": "off", "options": {}, "ranks": None}),
        (redman.memory, {"task": TASK, "num_envs": 1, "options": None}), (redman.task, {"name": TASK}), (redman.algo, {"name": "ppo"}),
        (pool.reset, {"seeds": 1, "mask": mask}), (pool.step, {"action": action, "mask": mask}), (pool.baseline, {"kind": "hold"}),
        (pool.set_state, {"state": pool.state(0), "env": 0}), (pool.set_starts, {"recording": recording, "share": 0.5}),
        (pool.render, {"env": 0, "width": 16, "height": 16, "what": "rgb", "look": "plain", "num_envs": 1}), (pool.record, {"env": 0}),
        (pool.raycast, {"env": 0, "origin": [0, 0, 1], "direction": [0, 0, -1], "range": 2.0}), (pool.copy, {"src": 0, "dst": 1, "other": pool}),
        (redman.Agent, {"pool": pool, "algo": "ppo", "seed": 0, "options": {}, "cost_limits": None, "ranks": None}),
        (redman.Agent, {"obs_dim": 3, "action_dim": 1, "num_envs": 2, "costs": ["a"], "control_dt": 0.1, "max_steps": 3, "layout_hash": 0,
                        "initial_mean": [0.0], "fields": {"a": (0, 1)}, "task": "mine"}),
        (free.act, {"obs": np.zeros((2, 3)), "mode": "mean", "out": np.zeros((2, 1), np.float32)}), (free.forget, {"mode": "mean", "mask": mask}),
        (free.put, {"obs": np.zeros((2, 3)), "action": np.zeros((2, 1)), "reward": [0, 0], "cost": [0, 0], "steps": [1, 1], "generation": 0}),
        (free.update_slice, {"units": 1}), (agent.rollout, {"pool": pool}), (agent.load, {"state": agent.save()}), (agent.values, {"obs": obs}),
        (agent.write_checkpoint, {"path": f"{folder}/c", "pool": pool, "note": b"n"}), (agent.clone, {"recording": recording, **clone}),
        (agent.warm_start, {"policy": policy, "samples": 100.0}),
        (policy.act, {"obs": obs, "noise": action}), (policy.predict, {"observation": obs, "episode_start": mask}), (policy.check, {"pool": pool}),
        (policy.actor, {"where": pool, "stochastic": False, "seed": 0}), (policy.start, {"rows": 2}), (redman.Policy.load, {"source": bytes(policy)}),
        (policy.episode, {"task": TASK, "seed": 0, "options": {}, "steps": 2, "shield": None}), (policy.save, {"path": f"{folder}/p.rdm"}),
        (policy.export, {"path": f"{folder}/p.rdm"}), (actor.reset, {"mask": mask}), (actor.set_state, {"state": actor.state()}),
        (recording.begin_step, {"pool": pool, "label": action, "mask": mask}), (recording.filter, {"success": False, "max_cost": None}),
        (recording.append, {"obs": obs, "action": action, "reward": [0, 0], "truncated": mask}), (recording.save, {"path": f"{folder}/r.npz"}),
        (redman.Shield, {"pool": pool, "policy": policy, "seed": 0, "threads": 0, "steps": None, "budgets": None, "options": {}}),
        (shield.add_guard, {"normal": [1, 0], "bound": 2.0}), (shield.act, {"proposed": action, "mask": mask}), (shield.guard, {"mask": mask}),
        (shield.set_state, {"state": shield.state()}), (redman.project, {"normals": [[1, 0]], "bounds": [1], "action": [0, 0]}),
        (redman.Planner, {"pool": pool, "policy": None, "agent": None, "noise": 0.1, "cost_limits": None, "options": {}, "stop": None}),
        (planner.act, {"env": 0, "pool": pool}), (planner.set_state, {"state": planner.state()}),
        (occupied.insert, {"origin": [0, 0, 0], "points": [[1, 0, 0]]}), (occupied.distance, {"points": [[1, 0, 0]], "most": 1.0}),
        (occupied.raycast, {"origin": [0, 0, 0], "direction": [1, 0, 0], "range": 1.0, "through_unknown": False}),
        (occupied.save, {"format": "ot"}), (occupied.load, {"data": occupied.save()}),
        (robot.reach, {"flange": [0.3, 0, 0.3], "q": robot.home}), (robot.poses, {"q": robot.home}),
        (redman.Object.check, {"name": "bx", "mass": 0.2, "shapes": [{"kind": "box", "size": [0.02, 0.03, 0.06]}]}),
        (redman.Ranks, {"rank": 0, "ranks": 1, "gather": None, "swap": None}), (redman.Rows(pool).field, {"name": "position"}),
        (redman.Episode, {"pool": pool, "env": 0}), (redman.load, {"path": f"{folder}/p.rdm"}), (redman.groups, {"pool": pool, "which": None}),
        (redman.gym.Env, {"task": TASK, "seed": 0, "options": {}, "action_repeat": 1, "center": None, "observe": None, "width": 320}),
        (redman.make_vec, {"task": TASK, "num_envs": 2, "threads": 0, "autoreset_mode": None}), (redman.make(TASK).reset, {"seed": 1, "options": None}),
        (lambda **more: redman.evaluate("zero", **more), {"task": TASK, "episodes": 1, "num_envs": 1, "seed": 0, "options": {}, "cost_limits": None}),
        (lambda **more: redman.train("two_state", steps=8, envs=2, horizon=4, progress=False, **more),
         {"algo": "ppo", "seed": 0, "threads": 1, "options": {}, "cost_limits": None, "out": None, "callback": None, "eval_every": 10,
          "overwrite": True, "task_file": None, "checkpoint_every": 10, "tensorboard": False, "from_": None, "teach": None, "time_budget": None,
          "shield": None, "ranks": None}),
        (lambda **more: redman.train(**more), {"resume": f"{folder}/none"}),
        (redman.stats.interval, {"scores_by_task": {"a": [1.0, 2.0]}, "level": 0.9}),
    )


class Types(unittest.TestCase):
    def test_an_argument_of_a_wrong_type_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            self.addCleanup(os.chdir, os.getcwd())
            os.chdir(folder)  # "x" is the name of a file, too
            made_ones = made()
            made_ones["policy"].save(f"{folder}/p.rdm")
            for call, right in calls(made_ones, folder):
                for argument in right:
                    for value in ODD:
                        with self.subTest(f"{call.__qualname__}({argument}={value!r})"):
                            self.refuse(call, {**right, argument: value}, argument)

    def test_arguments_of_runs_are_named(self):
        with self.assertRaisesRegex(redman.UsageError, r"teach: it must be a dict .*from_='demo'"):
            redman.train("jenga", teach="demo")
        for teach in ({"success_only": "yes"}, {"clone_rate": "x"}, {"start_share": (0, 1, 2)}, {"beta": None}, ["dagger"]):
            with self.subTest(teach), self.assertRaisesRegex(redman.ArgumentError, "^teach: "):
                redman.train("jenga", from_="demo", teach=teach)
        for wrong in ({"options": "x"}, {"vary": {"a": 1}}, {"tasks": 3}, {"steps": "x"}, {"envs": 1.5}, {"out": 3}):
            with self.subTest(wrong), mock.patch("redman._sweep.tool_path", return_value="none"):
                with self.assertRaisesRegex(redman.UsageError, f"^{next(iter(wrong))}"):
                    redman.sweep(**{"tasks": "bandit", "steps": 8, "out": "x", **wrong})
        for wrong in ({"reward": "x"}, {"options": {"cost_limit": "x"}}, {"options": ["lr"], "lr": 1}):
            with self.subTest(wrong), self.assertRaisesRegex(redman.UsageError, "^(reward|cost_limit|options): it must be"):
                redman.train("bandit", **wrong)

    def refuse(self, call, arguments, name):
        """A wrong argument may be one that is right here; else the error is redman's and has its name."""
        try:
            call(**arguments)
        except redman.UsageError as error:
            self.assertIsInstance(error, TypeError)
            self.assertRegex(str(error), re.escape(name.split("_")[0]))
        except redman.Error:
            pass


if __name__ == "__main__":
    unittest.main()
