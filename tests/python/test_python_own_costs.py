"""Rewards and costs of your own in train and evaluate: learned from, judged by, kept in the folder; tasks that are classes are
found again."""
import json
import os
import pickle
import subprocess
import sys
import tempfile
import textwrap
import unittest
from pathlib import Path

import numpy as np

import redman

TASK = "ball_run"
SMALL = {"steps": 8000, "seed": 2, "envs": 16, "eval_every": 2, "progress": False, "threads": 0, "horizon": 125}


def fast(rows):
    """The ball is faster than 2 m/s."""
    return rows.speed("velocity") > 2


def gentle(rows):
    return rows.reward - 0.1 * np.square(rows.action).sum(axis=1)


class Named(redman.RowTask):
    """A point that is pushed to the origin."""

    name, max_steps, action_dim = "named_point", 20, 1
    fields, costs, state = {"position": 1}, {"far": (5, "further than 1")}, {"position": 1}

    def reset(self, w):
        w.state["position"] = w.uniform(-2, 2, 1)

    def step(self, w, action):
        w.state["position"] += 0.2 * action
        x = w.state["position"][:, 0]
        return redman.Verdict(-x * x, {"far": np.abs(x) > 1})

    def observe(self, w):
        return w.state["position"]


class Learned(unittest.TestCase):
    def test_the_task_s_own_as_functions_are_the_run_without(self):
        for task, more in ((TASK, {}), ("hand_over_safe_finger", {"steps": 4000, "envs": 8, "horizon": 32}),
                           ("hand_over_safe_finger", {"steps": 4000, "envs": 8, "horizon": 32, "action_repeat": 4})):
            plain = redman.train(task, **{**SMALL, **more})
            names = list(redman.task(task).costs)
            own = redman.train(task, **{**SMALL, **more}, reward=lambda rows: rows.reward, cost_limits=plain.cost_limits,
                               costs={name: (lambda rows, k=name: rows.costs[k]) for name in names})
            by_name = redman.train(task, **{**SMALL, **more}, costs={name: name for name in names}, cost_limits=plain.cost_limits)
            for run in (own, by_name):
                self.assertEqual(run.agent.save(), plain.agent.save(), task)
                self.assertEqual(list(run.curve), list(plain.curve))
                for column in run.curve:
                    if not column.startswith(("Time/", "Metrics/Violations", "Metrics/Test")):
                        np.testing.assert_array_equal(run.curve[column], plain.curve[column], column)
                np.testing.assert_allclose(run.curve["Metrics/TestEpRet"], plain.curve["Metrics/TestEpRet"], rtol=1e-5)
                np.testing.assert_array_equal(run.curve["Metrics/TestEpCost"], plain.curve["Metrics/TestEpCost"])

    def test_a_limit_on_a_cost_of_ones_own_holds(self):
        settings = {**SMALL, "steps": 160_000, "eval_every": 10}
        free = redman.train(TASK, "ppo", **settings, costs={"fast": fast})
        held = redman.train(TASK, **settings, costs={"fast": fast}, cost_limits=30)
        e = held.evaluate(episodes=20)
        self.assertEqual((e.cost_names, e.cost_limits, e.feasible), (("fast",), [30], True))
        self.assertGreater(free.evaluate(episodes=20).cost_mean[0], 100)  # of 250 steps
        self.assertGreater(held.curve["Metrics/LagrangeMultiplier"].max(), 0)

    def test_a_reward_of_ones_own_is_learned_and_judged(self):
        run = redman.train(TASK, "ppo", **SMALL, reward=gentle)
        plain = redman.train(TASK, "ppo", **SMALL)
        self.assertNotEqual(bytes(run.policy), bytes(plain.policy))
        self.assertEqual(run.evaluate(episodes=4).cost_names, redman.Pool(TASK).cost_names)  # the task's costs stay
        ours, theirs = (redman.evaluate(run.policy, TASK, episodes=4, reward=function)
                        for function in (gentle, lambda rows: rows.reward))
        self.assertLess(ours.return_mean, theirs.return_mean)
        self.assertEqual(run.evaluate(episodes=4).return_mean, ours.return_mean)

    def test_names_and_limits_are_those_of_the_columns(self):
        run = redman.train(TASK, **SMALL, costs={"fast": fast, "own": "cost"}, cost_limits={"own": 25})
        self.assertEqual(run.cost_limits, {"fast": None, "own": 25})
        self.assertLessEqual({"Metrics/EpCost", "Metrics/EpCost/own", "Metrics/LagrangeMultiplier/own"}, set(run.curve))
        for costs in ([fast], fast):  # by their own names
            self.assertEqual(redman.train(TASK, **SMALL, costs=costs, cost_limits=25).cost_limits, {"fast": 25})
            self.assertEqual(redman.evaluate("zero", TASK, episodes=1, costs=costs).cost_names, ("fast",))

    def test_what_is_wrong_is_said(self):
        for wrong, words in (
                ({"costs": {}}, "give at least one cost"), ({"costs": "fast"}, "a dict of functions by name"),
                ({"costs": [lambda r: r.n]}, "needs a name"), ({"costs": lambda r: r.n}, "needs a name"),
                ({"costs": {"a=b": fast}}, "is not a name"), ({"costs": {"fast": 3}}, "a function of redman.Rows"),
                ({"costs": {"fast": "sped"}}, "has no cost sped; nearest is speed"),
                ({"costs": {"fast": fast}, "cost_limits": {"fats": 3}}, "nearest is fast"),
                ({"costs": {"fast": fast}}, r"give cost_limits=\{'fast': \.\.\.\}, or algo='ppo'"),
                ({"costs": {"fast": lambda: 1}}, r"costs\['fast'\]: it is called with one argument, a redman\.Rows"),
                ({"reward": lambda: 1}, "reward: it is called with one argument"),
                ({"costs": {"fast": lambda r: True}, "cost_limits": 3}, r"costs\['fast'\]: .*one number for each of 16 worlds"),
                ({"reward": lambda r: 2.0}, "reward: .*one number for each of 16 worlds"),
                ({"reward": 3}, "reward: it must be a function"), ({"costs": {"fast": fast}, "cost_limits": 3, "shield": True}, "shield"),
                ({"costs": {"fast": lambda r: np.full(r.n, -16)}, "cost_limits": 3}, "it returned -16, but a cost must not be below 0"),
                ({"costs": {"fast": lambda r: r.obs}, "cost_limits": 3}, r"costs\['fast'\]: it returned float32 of shape \(16, 7\)"),
                ({"reward": lambda r: r.obs[:, 0] * np.nan}, "reward: it returned nan in world 0"),
                ({"reward": lambda r: r["velocoty"][:, 0]}, "nearest is velocity")):
            with self.assertRaisesRegex(redman.Error, words):
                redman.train(TASK, **{**SMALL, **wrong})

    def test_an_exception_of_a_function_comes_out_as_it_is(self):
        with self.assertRaises(ZeroDivisionError):
            redman.train(TASK, **SMALL, reward=lambda rows: 1 / 0)


class Judged(unittest.TestCase):
    def test_evaluate_counts_them_at_each_control_step(self):
        seen = []

        def count(rows):
            seen.append(rows.step.copy())
            return np.ones(rows.n)

        for task in (TASK, "hand_over_safe_finger"):
            e = redman.evaluate("zero", task, episodes=5, costs={"steps": count}, reward=lambda rows: np.full(rows.n, 2.0))
            self.assertEqual(e.cost_mean, [e.length_mean])
            self.assertEqual(e.return_mean, 2 * e.length_mean)
            self.assertEqual((e.cost_names, e.violating_steps), (("steps",), int(5 * e.length_mean)))
        self.assertEqual(int(seen[0][0]), 1)

    def test_those_of_the_task_are_those_of_the_task(self):
        for task in (TASK, "hand_over_safe_finger"):
            plain = redman.evaluate("random", task, episodes=8)
            own = redman.evaluate("random", task, episodes=8, costs={name: name for name in redman.task(task).costs})
            self.assertEqual((own.cost_mean, own.length_mean), (plain.cost_mean, plain.length_mean))
            np.testing.assert_allclose(own.returns, plain.returns, rtol=1e-5)

    def test_limits(self):
        def e(**settings):
            return redman.evaluate("zero", TASK, episodes=2, **settings)
        own = [cost.limit for cost in redman.task(TASK).costs.values()]
        self.assertEqual(e().cost_limits, own)
        self.assertEqual(e(cost_limits=3).cost_limits, [3, *own[1:]])
        self.assertEqual(e(cost_limits={"speed": 4}).cost_limits, [own[0], 4, own[2]])
        self.assertEqual(e(cost_limits=[None, 1, 2]).cost_limits, [None, 1, 2])
        self.assertEqual(e(costs={"one": fast}, cost_limits=1).cost_limits, [1])
        self.assertEqual(e(costs={"one": fast}).cost_limits, [None])
        with self.assertRaisesRegex(redman.NotFoundError, "nearest is speed"):
            e(cost_limits={"sped": 4})

    def test_rows_are_in_si_units(self):
        said = {}

        def look(rows):
            said.update(raw=rows.obs[:, rows.pool.fields["velocity"].slice].copy(), si=rows.field("velocity").copy(),
                        speed=rows.speed("velocity"), costs=set(rows.costs), again=rows["velocity"].copy())
            return np.zeros(rows.n)

        redman.evaluate("random", TASK, episodes=4, reward=look)
        field = redman.Pool(TASK).fields["velocity"]
        np.testing.assert_allclose(said["si"], said["raw"] * field.scale)
        np.testing.assert_allclose(said["speed"], np.linalg.norm(said["si"], axis=1))
        np.testing.assert_array_equal(said["again"], said["si"])
        self.assertEqual(said["costs"], set(redman.task(TASK).costs))


class Elsewhere(unittest.TestCase):
    """Another process, which has the folder alone, or the module too."""

    def setUp(self):
        self.root = tempfile.TemporaryDirectory()
        self.addCleanup(self.root.cleanup)
        self.folder = Path(self.root.name, "run")

    def said(self, program, path=None, ok=True):
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join([os.environ.get("PYTHONPATH", ""), *([path] if path else [])])}
        run = subprocess.run([sys.executable, "-c", "import redman\n" + textwrap.dedent(program)], env=environment,
                             capture_output=True, text=True, cwd=self.root.name)
        self.assertEqual(run.returncode == 0, ok, run.stderr)
        return (run.stdout if ok else run.stderr).strip()

    def test_a_folder_says_what_it_was_trained_on(self):
        run = redman.train(TASK, **SMALL, costs={"fast": fast, "own": "cost", "odd": lambda rows: np.zeros(rows.n)}, reward=gentle,
                           cost_limits={"fast": 30}, out=self.folder)
        config = json.loads(Path(self.folder, "config.json").read_text())
        module = Path(__file__).stem
        self.assertEqual(config["own_costs"], {"fast": f"{module}:fast", "own": "cost", "odd": None})
        self.assertEqual(config["own_reward"], f"{module}:gentle")
        self.assertEqual((config["cost_limits"], config["set_cost_limit"]), ({"fast": 30.0}, ["fast=30"]))
        self.assertEqual(run.config["own_costs"], config["own_costs"])

    def test_functions_of_a_module_are_found_again(self):
        run = redman.train(TASK, **SMALL, costs={"fast": fast}, cost_limits=30, out=self.folder)
        here, module = str(Path(__file__).parent), Path(__file__).stem
        program = f"e = redman.evaluate({str(self.folder)!r}, episodes=4)\nprint(e.cost_mean, e.cost_limits)"
        e = redman.evaluate(self.folder, episodes=4)
        self.assertEqual(self.said(program, here), f"{e.cost_mean} {e.cost_limits}")
        self.assertEqual(run.evaluate(episodes=4), e)
        self.assertIn(f"fast is fast of module {module}, which cannot be imported here", self.said(program, ok=False))
        given = program.replace("episodes=4", "episodes=4, costs={'fast': lambda rows: rows.speed('velocity') > 2}")
        self.assertEqual(self.said(given), f"{e.cost_mean} {e.cost_limits}")
        program = f"print(redman.train(resume={str(self.folder)!r}, steps=12000, progress=False).env_steps)"
        self.assertEqual(self.said(program, here), "12000")

    def test_a_run_with_functions_is_continued_as_if_it_had_not_been_interrupted(self):
        whole = redman.train(TASK, **SMALL, costs={"fast": fast}, cost_limits=30)
        redman.train(TASK, **SMALL, costs={"fast": fast}, cost_limits=30, out=self.folder,
                     callback=lambda epoch: epoch.epoch == 3)
        again = redman.train(resume=self.folder, progress=False)
        self.assertEqual(again.agent.save(), whole.agent.save())
        self.assertEqual(bytes(again.policy), bytes(whole.policy))

    def test_a_lambda_has_to_be_given_again(self):
        redman.train(TASK, **SMALL, costs={"fast": lambda rows: rows.speed("velocity") > 2}, cost_limits=30, out=self.folder)
        for call in (lambda **own: redman.evaluate(self.folder, episodes=2, **own),
                     lambda **own: redman.train(resume=self.folder, steps=10000, progress=False, **own)):
            said = r"its cost fast was a function that cannot be imported, .*costs=\{'fast': function"
            with self.assertRaisesRegex(redman.UsageError, said):
                call()
            call(costs={"fast": fast})
        with self.assertRaisesRegex(redman.NotFoundError, "has no cost slow"):
            redman.train(resume=self.folder, costs={"slow": fast}, progress=False)

    def test_a_program_is_found_by_its_name_and_a_notebook_is_not(self):
        program = Path(self.root.name, "my_program.py")
        program.write_text(textwrap.dedent(f"""
            import redman
            def fast(rows):
                return rows.speed("velocity") > 2
            if __name__ == "__main__":
                redman.train("{TASK}", **{SMALL!r}, costs=[fast], cost_limits=30, out="run", overwrite=True)
                print(redman.evaluate("run", episodes=2).cost_mean)
            """))
        for command, path in (([program.name], "my_program:fast"), (["-c", program.read_text()], "__main__:fast")):
            run = subprocess.run([sys.executable, *command], cwd=self.root.name, capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertEqual(json.loads(Path(self.folder, "config.json").read_text())["own_costs"], {"fast": path})
            again = f"print(redman.evaluate({str(self.folder)!r}, episodes=2).cost_mean)"
            if path.startswith("my"):
                self.assertEqual(self.said(again, self.root.name), run.stdout.strip())
            else:
                self.assertIn("fast is fast of module __main__, which has no such name", self.said(again, ok=False))

    def test_policies_with_functions_are_sent_to_other_processes(self):
        policy = redman.train(TASK, **SMALL, costs={"fast": fast}, cost_limits=30).policy
        again = pickle.loads(pickle.dumps(policy))
        self.assertEqual(redman.evaluate(again, episodes=2), redman.evaluate(policy, episodes=2))

    def test_a_task_that_is_a_class_is_made_again(self):
        run = redman.train(Named, steps=2000, envs=8, progress=False, horizon=20, out=self.folder)
        here, module = str(Path(__file__).parent), Path(__file__).stem
        self.assertEqual(json.loads(Path(self.folder, "config.json").read_text())["task_class"], f"{module}:Named")
        e = run.evaluate(episodes=4)
        program = f"print(redman.evaluate(redman.load({str(self.folder)!r}), episodes=4).return_mean)"
        self.assertEqual(self.said(program, here), str(e.return_mean))
        self.assertIn(f"its task named_point is Named of module {module}, which cannot be imported here",
                      self.said(program, ok=False))
        program = f"print(redman.train(resume={str(self.folder)!r}, steps=4000, progress=False).env_steps)"
        self.assertEqual(self.said(program, here), "4000")
        tool = os.environ.get("REDMAN_TOOL")
        if tool:
            done = subprocess.run([tool, "train", "--resume", self.folder], capture_output=True, text=True)
            self.assertRegex(done.stderr, f"is a class in Python, {module}:Named")


class Lines(unittest.TestCase):
    """How much a newcomer writes; the programs run as they are."""

    CONSTRAINT = """
        import redman
        run = redman.train("ball_run", steps=8e3, horizon=125, envs=16, cost_limits=20,
                           costs={"fast": lambda rows: rows.speed("velocity") > 2})
        print(run.evaluate(episodes=4).cost_mean)
        """
    TASK = """
        import numpy as np, redman

        class Push(redman.RowTask):
            "Push a point to the origin, slowly."
            max_steps, action_dim = 50, 2
            fields = state = {"position": 2, "velocity": 2}
            costs = {"fast": (5, "faster than 1 m/s")}

            def reset(self, w):
                w.state["position"] = w.uniform(-1, 1, 2)

            def step(self, w, action):
                s = w.state
                s["velocity"] += 0.1 * action
                s["position"] += 0.1 * s["velocity"]
                return redman.Verdict(-np.linalg.norm(s["position"], axis=1), {"fast": np.linalg.norm(s["velocity"], axis=1) > 1})

            def observe(self, w):
                return w.state["position"], w.state["velocity"]

        print(redman.train(Push, steps=4e3, envs=16, horizon=50).evaluate(episodes=4))
        """

    def test_a_constraint_in_under_ten_lines_and_a_task_in_under_thirty(self):
        for program, most in ((self.CONSTRAINT, 10), (self.TASK, 30)):
            program = textwrap.dedent(program).strip()
            self.assertLess(len([line for line in program.splitlines() if line.strip()]), most)
            run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
            self.assertEqual(run.returncode, 0, run.stderr)


if __name__ == "__main__":
    unittest.main()
