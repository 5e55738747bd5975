"""What a user of other libraries writes first works here, or the error says what to write: a list of such lines."""
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import redman

TASK = "ball_run"
WORKS = None  # in the place of the words of an error


class World:
    """What the lines may use: a pool, an agent, a short run with its folder."""

    def __init__(self, folder):
        self.pool = redman.Pool(TASK, 4)
        self.pool.reset()
        self.agent = redman.Agent(self.pool, options={"horizon": 32})
        self.folder = os.path.join(folder, "run")
        self.run = redman.train(TASK, steps=2000, envs=8, options={"horizon": 32}, out=self.folder, progress=False)
        self.path = os.path.join(folder, "x.rdm")
        self.run.policy.save(self.path)
        self.policy = redman.Policy.trained(TASK)

    def short(self, task=TASK, **arguments):
        return redman.train(task, **{"steps": 200, "envs": 2, "progress": False, "options": {"horizon": 32}, **arguments})


def unpacked(pool, count):
    """As the habit has it, for pools of as many worlds as values, too."""
    with redman.Pool(TASK, count) as same:
        same.reset()
        for each in (same, pool):
            try:
                if count == 2:
                    obs, info = each.reset()
                elif count == 5:
                    obs, reward, terminated, truncated, info = each.step()
                else:
                    obs, reward, cost, terminated, truncated, info = each.step()
            except redman.UsageError as error:
                said = error
            else:
                return
        raise said


class Install(unittest.TestCase):
    def test_without_numpy_the_error_says_how_to_get_it(self):
        said = subprocess.run([sys.executable, "-c", "import sys; sys.modules['numpy'] = None; import redman"], capture_output=True, text=True)
        self.assertEqual(said.stderr.splitlines()[-1], "ImportError: redman needs numpy: apt-get install python3-numpy, or pip install numpy")


class Ids(unittest.TestCase):
    def test_every_task_is_found_by_its_ids(self):
        for task in redman.tasks():
            camel = redman.gym.camel(task)
            for name in (task, camel, f"{camel}-v0", redman.gym.env_id(task), f"Redman{camel}-v0", f"SafetyRedman{camel}-v0", f"Safety{camel}-v0"):
                self.assertEqual(redman.task(name).name, task)

    def test_they_are_names_wherever_a_task_is_named(self):
        for name in ("TwoState", "redman/TwoState-v0", "RedmanTwoState-v0", "SafetyRedmanTwoState-v0"):
            self.assertEqual(redman.Pool(name).task.name, "two_state")
            redman.make(name).close()
            self.assertEqual(redman.evaluate("zero", name, episodes=1).episodes, 1)
            self.assertEqual(redman.spec(name).obs_dim, redman.spec("two_state").obs_dim)
            self.assertEqual(redman.train(name, steps=32, envs=2, horizon=16, progress=False).task, "two_state")

    def test_other_words_are_refused(self):
        for word, said in (("redman/TwoStaet-v0", "nearest is two_state"), ("SafetyNothing-v0", "Nothing: unknown"), ("Nothing", "Nothing: unknown")):
            with self.assertRaisesRegex(redman.NotFoundError, said):
                redman.Pool(word)


PANDAS = WORKS if importlib.util.find_spec("pandas") else "pip install pandas"
# What the line is, the line, and what comes of it: it works, or the words of its error.
HABITS = (
    # Gymnasium
    ("make an environment", lambda w: redman.make(TASK).reset(seed=1)[1]["cost"], WORKS),
    ("make a vector of them", lambda w: redman.make_vec(TASK, 3).reset(seed=1)[0], WORKS),
    ("the module of environments", lambda w: redman.gym.VectorEnv, WORKS),
    ("a seed of a reset", lambda w: w.pool.reset(seed=3), WORKS),
    ("options of a reset", lambda w: w.pool.reset(options={}), r"Pool\(task, options="),
    ("Gymnasium's values of a reset", lambda w: unpacked(w.pool, 2), r"redman\.make_vec\(task, num_envs\)\.reset\(\)"),
    ("Gymnasium's values of a step", lambda w: unpacked(w.pool, 5), r"pool\.reward, pool\.cost, .*make_vec"),
    ("Safety-Gymnasium's values of a step", lambda w: unpacked(w.pool, 6), r"pool\.reward, pool\.cost"),
    ("worlds one by one", lambda w: [row.shape for row in w.pool.reset()][3], WORKS),
    ("draw actions", lambda w: w.pool.step(w.pool.action_space.sample()), WORKS),
    ("bounds of observations", lambda w: w.pool.observation_space.shape == w.pool.obs.shape or 1 / 0, WORKS),
    ("the space of one world", lambda w: w.pool.single_action_space.contains(w.pool.action[0]) or 1 / 0, WORKS),
    ("an id in the place of a task", lambda w: redman.Pool("redman/BallRun-v0"), WORKS),
    ("a name in capitals", lambda w: redman.Pool("BallRun"), WORKS),
    ("a task as an object", lambda w: redman.Pool(redman.task(TASK)), WORKS),
    ("rewards, plural", lambda w: w.pool.rewards, "reward"),
    ("done", lambda w: w.pool.done, r"terminated \| truncated"),
    ("infos", lambda w: w.pool.infos, "cost, success, status"),
    ("names of costs", lambda w: w.pool.cost_names.index("speed"), WORKS),
    ("seed of a pool", lambda w: w.pool.seed, WORKS),
    ("copy a world", lambda w: w.pool.copy(0, 1), WORKS),
    ("number of worlds, short", lambda w: redman.Pool(TASK, envs=2), WORKS),
    ("an option as a keyword", lambda w: redman.Pool(TASK, max_steps=20), WORKS),
    ("an option that is none", lambda w: redman.Pool(TASK, max_stepz=20), "there is no such argument"),
    ("render an environment by name", lambda w: redman.render, "Pool.render"),
    # Stable-Baselines3
    ("predict with a policy", lambda w: w.policy.predict(w.pool.obs)[0], WORKS),
    ("predict with an agent", lambda w: w.agent.predict(w.pool.obs), r"act\(obs, 'mean'\)"),
    ("learn so many steps", lambda w: w.agent.learn(total_timesteps=100), WORKS),
    ("an agent's train", lambda w: w.agent.train(100), r"agent\.learn\(steps\)"),
    ("save an agent", lambda w: w.agent.save(w.path + ".agent"), WORKS),
    ("load an agent", lambda w: w.agent.load(w.path + ".agent"), WORKS),
    ("the algorithm as a class", lambda w: redman.PPO, "algo='ppo'"),
    ("total steps", lambda w: redman.train(TASK, total_timesteps=200, envs=2, progress=False, horizon=32), WORKS),
    ("parameters of a network", lambda w: w.policy.parameters, "policy.tensors"),
    # PyTorch
    ("call a policy", lambda w: w.policy(w.pool.obs), WORKS),
    ("state_dict", lambda w: w.agent.state_dict, "agent.tensors"),
    # OmniSafe, CleanRL, Spinning Up
    ("a limit of the cost", lambda w: w.short(cost_limit=10), WORKS),
    ("a learning rate", lambda w: w.short(learning_rate=1e-3), WORKS),
    ("its short name", lambda w: w.short(lr=1e-3), WORKS),
    ("a rate twice", lambda w: w.short(lr=1e-3, options={"learning_rate": 1e-3}), "given twice"),
    ("widths of layers", lambda w: w.short(hidden=[16, 16]), WORKS),
    ("a learning rate, misspelt", lambda w: w.short(learning_rat=1e-3), "nearest is learning_rate"),
    ("the cost of an evaluation", lambda w: redman.evaluate("zero", TASK, episodes=1).cost, "cost_mean"),
    ("a field that is none", lambda w: w.pool.fields["speed"], "field speed: ball_run has none"),
    ("a cost that is none", lambda w: w.pool.costs["sped"], "nearest is speed"),
    ("a field of rows", lambda w: redman.Rows(w.pool).velocity, r"rows\.field\('velocity'\)"),
    ("a picture in a file", lambda w: w.pool.render("x.png"), r"episode\.render\(path\)"),
    ("make of the module of environments", lambda w: redman.gym.make(TASK), r"redman\.make\(task\)"),
    ("one action for all worlds", lambda w: w.pool.step(np.zeros(2)), WORKS),
    ("one number for all actions", lambda w: w.pool.step(0.5), WORKS),
    ("an id to train on", lambda w: w.short("redman/BallRun-v0"), WORKS),
    ("several seeds", lambda w: w.short(seed=[0, 1])[1].policy, WORKS),
    ("a run of a folder", lambda w: redman.Run.load(w.folder).curve, WORKS),
    ("save a run", lambda w: w.run.save(w.path), WORKS),
    ("draw a run", lambda w: w.run.plot()._repr_svg_(), WORKS),
    ("draw its curve", lambda w: w.run.curve.plot().save(w.path + ".svg"), WORKS),
    ("rows of a run", lambda w: w.run.epochs[-1]["Metrics/EpRet"], WORKS),
    ("its settings", lambda w: w.run.config["cost_limits"]["cost"], WORKS),
    ("its best policy", lambda w: w.run.best.act(np.zeros(7)), WORKS),
    ("its model", lambda w: w.run.model, "run.policy"),
    ("a table of its curve", lambda w: w.run.curve.to_pandas().shape, PANDAS),
    # whatever there is
    ("load a policy", lambda w: redman.load(w.path).act(np.zeros(7)), WORKS),
    ("load a run's folder", lambda w: redman.load(w.folder).info, WORKS),
    ("load what is not there", lambda w: redman.load(w.path + "m"), "there is no such file; nearest is x.rdm"),
    ("evaluate a run", lambda w: redman.evaluate(w.run, episodes=2).return_mean, WORKS),
    ("evaluate with an option", lambda w: redman.evaluate(w.run, n_eval_episodes=2, max_steps=20).lengths.max() == 20 or 1 / 0, WORKS),
    ("evaluate a folder", lambda w: redman.evaluate(w.folder, episodes=2).costs, WORKS),
    ("evaluate an agent", lambda w: redman.evaluate(w.agent, TASK, episodes=2).returns, WORKS),
    ("evaluate nothing that plays", lambda w: redman.evaluate(3, TASK), "give a policy"),
    ("a task with a slip", lambda w: redman.Pool("bal_run"), "nearest"),
)


class Habits(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.world = World(cls.folder.name)

    @classmethod
    def tearDownClass(cls):
        del cls.world
        cls.folder.cleanup()

    def test_each_line_works_or_says_what_to_write(self):
        for name, line, words in HABITS:
            with self.subTest(name):
                if words is WORKS:
                    line(self.world)
                    continue
                with self.assertRaisesRegex((redman.Error, AttributeError, TypeError), words):
                    line(self.world)

    def test_most_of_them_work(self):
        self.assertGreaterEqual(sum(words is WORKS for _, _, words in HABITS), 30)

    def test_errors_are_printed_by_the_names_that_users_catch(self):
        for kind in (redman.NotFoundError, redman.ArgumentError, redman.UsageError, redman.StateError):
            self.assertEqual(f"{kind.__module__}.{kind.__qualname__}", f"redman.{kind.__name__}")
        self.assertEqual(redman.PolicyInfo.__module__, "redman")


if __name__ == "__main__":
    unittest.main()
