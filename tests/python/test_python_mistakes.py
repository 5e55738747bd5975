"""Mistakes in calls: a misspelt attribute is refused, and options that were read cannot be changed in vain."""
import copy
import enum
import json
import pickle
import unittest

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


if __name__ == "__main__":
    unittest.main()
