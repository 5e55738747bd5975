"""train, evaluate, curve: what the command-line tool does, to the byte."""
import base64
import contextlib
import importlib.util
import io
import json
import os
import pickle
import re
import signal
import subprocess
import sys
import tempfile
import threading
import unittest
import xml.etree.ElementTree
from pathlib import Path

import numpy as np

import redman

TREE = Path(__file__).resolve().parents[2]
TOOL = os.environ.get("REDMAN_TOOL")
SMALL = {"task": "hand_over_safe_finger", "steps": 16000, "seed": 3, "envs": 16, "eval_every": 5, "checkpoint_every": 5, "progress": False}


def tool(*words):
    return json.loads(subprocess.run([TOOL, *map(str, words), "--json"], check=True, capture_output=True).stdout)


class AsTheTool(unittest.TestCase):
    @unittest.skipUnless(TOOL, "the command-line tool was not built")
    def test_the_same_run_gives_the_same_policy(self):
        with tempfile.TemporaryDirectory() as folder:
            ours, theirs = Path(folder, "a"), Path(folder, "b")
            run = redman.train(**SMALL, out=ours, options={"object": "tennis_ball", "hidden": "32,32"}, cost_limits=20)
            said = tool("train", "--task", SMALL["task"], "--steps", SMALL["steps"], "--seed", 3, "--envs", 16,
                        "--eval-every", 5, "--checkpoint-every", 5, "--set", "object=tennis_ball",
                        "--set", "hidden=32,32", "--cost-limit", 20, "--out", theirs)
            self.assertEqual(Path(ours, "policy.rdm").read_bytes(), Path(theirs, "policy.rdm").read_bytes())
            self.assertEqual(bytes(run.policy), Path(theirs, "policy.rdm").read_bytes())
            self.assertEqual(run.env_steps, said["env_steps"])
            mine, other = redman.curve(ours), redman.curve(theirs)
            self.assertEqual(list(mine), list(other))
            for name in mine:
                if not name.startswith("Time/"):
                    np.testing.assert_array_equal(mine[name], other[name], name)
            report = run.evaluate(seed=run.seed + 1_000_000)
            self.assertEqual((report.return_mean, report.cost_mean[0], report.feasible),
                             (said["return"], said["cost"], said["feasible"]))
            # the tool evaluates, goes on with and draws the folder
            self.assertEqual(tool("eval", "--policy", ours, "--episodes", 8)["return_mean"],
                             redman.evaluate(run.policy, episodes=8, options=run.options).return_mean)
            for each in (ours, theirs):
                tool("train", "--resume", each, "--steps", 24000)
            self.assertEqual(Path(ours, "policy.rdm").read_bytes(), Path(theirs, "policy.rdm").read_bytes())
            tool("plot", ours, "--out", Path(folder, "plot.svg"))

    @unittest.skipUnless(TOOL, "the command-line tool was not built")
    def test_an_algorithm_that_only_records_costs_is_not_judged_by_them(self):
        with tempfile.TemporaryDirectory() as folder:
            run = redman.train(**SMALL, algo="ppo")
            tool("train", "--task", SMALL["task"], "--algo", "ppo", "--steps", SMALL["steps"], "--seed", 3,
                 "--envs", 16, "--eval-every", 5, "--out", folder)
            self.assertEqual(bytes(run.policy), Path(folder, "policy.rdm").read_bytes())

    def test_a_run_without_a_folder_leaves_nothing(self):
        before = set(os.listdir())
        run = redman.train("bandit", steps=3000, envs=8, eval_every=2, progress=False)
        self.assertEqual(set(os.listdir()), before)
        self.assertGreaterEqual(run.env_steps, 3000)
        self.assertEqual(len(run.curve.steps), run.curve["Train/Epoch"][-1])
        self.assertIsNone(run.folder)

    def test_a_callback_ends_it(self):
        seen = []
        run = redman.train(**SMALL, callback=lambda epoch: seen.append(epoch) or len(seen) == 2)
        self.assertEqual([epoch.epoch for epoch in seen], [1, 2])
        self.assertTrue(run.interrupted)
        self.assertEqual(run.env_steps, seen[-1].env_steps)

    def test_ctrl_c_returns_what_was_learned(self):
        with tempfile.TemporaryDirectory() as folder:
            run = redman.train(**{**SMALL, "steps": 10**8}, out=folder,
                               callback=lambda epoch: os.kill(os.getpid(), signal.SIGINT) if epoch.epoch == 3 else None)
            self.assertTrue(run.interrupted)
            self.assertLessEqual(len(run.curve.steps), 4)
            self.assertEqual(bytes(redman.Policy.load(folder)), bytes(run.policy))
            self.assertTrue(Path(folder, "checkpoint.rdm").exists())
        self.assertIs(signal.getsignal(signal.SIGINT), signal.default_int_handler)

    def test_progress_goes_to_stderr(self):
        heard = io.StringIO()
        with contextlib.redirect_stderr(heard):
            redman.train("bandit", steps=500, envs=4)
            redman.train("bandit", steps=1e9, envs=4, callback=lambda epoch: True)
        lines = heard.getvalue().splitlines()
        self.assertRegex(lines[-3], "^100%  [0-9]+ steps  return .* 0:00 left$")
        self.assertRegex(lines[-1], "^stopped at [0-9]+ of 1000000000 steps$")

    def test_other_threads_train_too(self):
        runs = []
        thread = threading.Thread(target=lambda: runs.append(redman.train("bandit", steps=500, envs=4, progress=False)))
        thread.start()
        thread.join()
        self.assertEqual(len(runs), 1)

    def test_what_is_wrong_is_said_before_there_is_a_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "run")
            for arguments, words in (
                    ({"task": "bandid"}, "bandit"), ({"algo": "pppo"}, "ppo"), ({"steps": 0.5}, "steps"),
                    ({"options": {"obejct": "egg"}}, "obejct"), ({"options": {"object": "eggs"}}, "eggs"),
                    ({"cost_limits": [1]}, "cost_limits")):
                with self.assertRaisesRegex(redman.Error, words):
                    redman.train(**{**SMALL, **arguments}, out=path)
                self.assertFalse(path.exists())
            redman.train("bandit", steps=100, envs=4, progress=False, out=path)
            with self.assertRaisesRegex(redman.StateError, "overwrite"):
                redman.train("bandit", steps=100, envs=4, progress=False, out=path)
            redman.train("bandit", steps=100, envs=4, progress=False, out=path, overwrite=True)


class Limits(unittest.TestCase):
    def test_the_limit_of_a_step_is_that_of_an_episode(self):
        run = redman.train("ball_run", "ppo_lag", steps=400, envs=4, progress=False, max_steps=20, cost_limit_per_step=0.1)
        self.assertAlmostEqual(run.cost_limits["cost"], 2)
        self.assertAlmostEqual(run.evaluate(2).cost_limits[0], 2)
        with self.assertRaisesRegex(redman.UsageError, "both are limits on the first cost"):
            redman.train("ball_run", "ppo_lag", steps=400, envs=4, progress=False, cost_limit_per_step=0.1, cost_limits=3)


class Curves(unittest.TestCase):
    def test_a_torn_row_is_left_out(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "progress.csv")
            path.write_text("TotalEnvSteps,Metrics/EpRet,Metrics/EpCost\n10,nan,nan\n20,1.5,3\n30,2")
            curve = redman.curve(folder)
            self.assertEqual(curve.steps.tolist(), [10, 20])
            xml.etree.ElementTree.fromstring(curve._repr_svg_())
            xml.etree.ElementTree.fromstring(redman.curve(folder, folder)._repr_svg_())
            curve.save(Path(folder, "c.svg"))
            path.write_text("a,b\n1,2\n")
            with self.assertRaisesRegex(redman.FormatError, "TotalEnvSteps"):
                redman.curve(folder)
        with self.assertRaises(redman.MissingFileError):
            redman.curve("/nowhere")

    def test_a_page_holds_the_picture_as_an_image(self):
        run = redman.train("bandit", steps=500, envs=4, progress=False)
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "progress.csv").write_text("TotalEnvSteps,Metrics/EpRet,Metrics/EpCost\n10,1,2\n")
            for drawn in (run.curve, redman.curve(folder), redman.curve(folder, folder)):
                found = re.fullmatch('<img src="data:image/svg[+]xml;base64,([A-Za-z0-9+/=]+)">', drawn._repr_html_())
                self.assertEqual(base64.b64decode(found[1]).decode(), drawn._repr_svg_())

    @unittest.skipUnless(importlib.util.find_spec("nbconvert"), "no nbconvert (apt-get install python3-nbconvert)")
    def test_an_exported_notebook_shows_it(self):
        from nbconvert import HTMLExporter
        from nbformat.v4 import new_code_cell, new_notebook, new_output
        curve = redman.train("bandit", steps=500, envs=4, progress=False).curve
        output = new_output("display_data", {"image/svg+xml": curve._repr_svg_(), "text/html": curve._repr_html_()})
        page, _ = HTMLExporter().from_notebook_node(new_notebook(cells=[new_code_cell("curve", outputs=[output])]))
        self.assertIn(base64.b64encode(curve._repr_svg_().encode()).decode(), page)

    def test_runs_of_one_name_have_legends_of_their_own(self):
        row = "TotalEnvSteps,Metrics/EpRet,Metrics/EpCost\n10,1,2\n"
        config = json.dumps({"task": "grasp", "algo": "ppo", "seed": 3, "cost_limits": {}})

        def texts(curves):
            nodes = xml.etree.ElementTree.fromstring(curves._repr_svg_()).iter()
            return [node.text for node in nodes if node.tag.endswith("text") and "grasp" in node.text]

        with tempfile.TemporaryDirectory() as root:
            folders = [Path(root, *parts) for parts in (("a", "run"), ("b", "run"), ("b", "other"))]
            for folder in folders:
                folder.mkdir(parents=True)
                Path(folder, "progress.csv").write_text(row)
                Path(folder, "config.json").write_text(config)
            name = "grasp ppo seed 3"
            self.assertEqual(texts(redman.curve(folders[0])), [name])
            self.assertEqual(texts(redman.curve(*folders)),
                             [f"{name} (a/run)", f"{name} (b/run)", f"{name} (other)"])
            self.assertEqual(texts(redman.curve(folders[0], folders[0])), [name])  # a run is drawn once
            self.assertEqual(texts(redman.Curves([redman.Curve(redman.curve(folders[0]), name)] * 2)),
                             [f"{name} #1", f"{name} #2"])

    @unittest.skipUnless(hasattr(os, "mkfifo"), "no FIFO here")
    def test_what_is_no_regular_file_is_not_waited_for(self):
        with tempfile.TemporaryDirectory() as folder:
            pipe, huge = Path(folder, "policy.rdm"), Path(folder, "huge")
            os.mkfifo(pipe)
            huge.touch()
            os.truncate(huge, 100 << 30)
            for path in (pipe, folder, "/dev/zero", huge):
                with self.assertRaises(redman.Error):
                    redman.Policy.load(path)
            Path(folder, "progress.csv").symlink_to(huge)
            Path(folder, "config.json").symlink_to(pipe)
            with self.assertRaises(redman.Error):
                redman.curve(folder)

    def test_a_curve_is_a_dict(self):
        curve = redman.train("bandit", steps=3000, envs=8, progress=False).curve
        self.assertIsInstance(curve, dict)
        self.assertEqual(set(map(len, curve.values())), {len(curve.steps)})
        again = pickle.loads(pickle.dumps(curve))
        self.assertEqual((again.label, again.limit, list(again)), (curve.label, curve.limit, list(curve)))

    @unittest.skipUnless(importlib.util.find_spec("pandas"), "no pandas (apt-get install python3-pandas)")
    def test_a_table_has_a_row_for_each_epoch(self):
        import pandas
        curve = redman.train("bandit", steps=3000, envs=8, progress=False).curve
        for table in (pandas.DataFrame(curve), curve.to_pandas()):
            self.assertEqual((table.shape, list(table.columns)), ((len(curve.steps), len(curve)), list(curve)))
            np.testing.assert_array_equal(table["TotalEnvSteps"], curve.steps)

    def test_a_run_draws_itself(self):
        run = redman.train("bandit", steps=500, envs=4, progress=False)
        tree = xml.etree.ElementTree.fromstring(run._repr_svg_())
        lines = [node for node in tree.iter() if node.tag.endswith("polyline")]
        self.assertEqual(len(lines), 2)


class Progress(unittest.TestCase):
    def test_whole_epochs_and_rates_are_said_as_the_tool_says_them(self):
        with contextlib.redirect_stderr(io.StringIO()) as said:
            redman.train("bandit", steps=5000, envs=64, horizon=32, threads=0)
        self.assertIn("steps=5000: a run ends after a whole epoch of up to 2048 steps, so it takes up to 6144 steps\n", said.getvalue())
        self.assertRegex(said.getvalue(), r"100%  6\.14k steps  .*  \d[\d.]*[kM]? steps/s  0:00 left")


class Algorithms(unittest.TestCase):
    def test_each_trains(self):
        for algo in redman.algos():
            with self.subTest(algo):
                run = redman.train("bandit", algo, steps=32, envs=2, threads=0, horizon=16, progress=False)
                self.assertEqual((run.algo, run.env_steps), (algo, 32))

    @unittest.skipUnless(TOOL, "the command-line tool was not built")
    def test_one_with_a_replay_memory_is_the_tool_s(self):
        with tempfile.TemporaryDirectory() as folder:
            ours, theirs = Path(folder, "a"), Path(folder, "b")
            redman.train("bandit", "td3_lag", steps=2000, envs=4, seed=1, horizon=64, progress=False, out=ours, threads=0)
            tool("train", "--task", "bandit", "--algo", "td3_lag", "--steps", 2000, "--envs", 4, "--seed", 1, "--set", "horizon=64",
                 "--out", theirs)
            for name in ("config.json", "policy.rdm"):
                self.assertEqual(Path(ours, name).read_bytes(), Path(theirs, name).read_bytes(), name)

    def test_what_one_cannot_do_is_said(self):
        for wrong, words in (({"algo": "td3", "from_": redman.Policy.trained("bandit")},
                              "from_: td3 cannot begin with a teacher; .* such as algo=\"ppo_lag\". Agent.learn_from"),
                             ({"algo": "td3", "imitation": 1}, "algorithm ppo has"), ({"algo": "td3", "encoder": "16"}, "option encoder")):
            with self.assertRaisesRegex(redman.Error, words):
                redman.train("bandit", steps=32, envs=2, horizon=16, progress=False, **wrong)


class Pages(unittest.TestCase):
    def test_what_the_pages_show_runs(self):
        manual = sorted(str(page.relative_to(TREE)) for page in (TREE / "examples/manual").glob("*.md")
                        if "```python" in page.read_text(encoding="utf-8"))
        self.assertIn("examples/manual/python.md", manual)
        for page in ("README.md", "capi/python/README.md", *manual):
            blocks = re.findall(r"```python\n(.*?)```", (TREE / page).read_text(encoding="utf-8"), re.S)
            self.assertTrue(blocks, page)
            with tempfile.TemporaryDirectory() as folder:
                (Path(folder) / "examples").symlink_to(TREE / "examples")  # pages are read at the top of the tree
                for block in blocks:
                    if "import gymnasium" in block and importlib.util.find_spec("gymnasium") is None:
                        continue  # the tests of the adapters run it where a copy is
                    run = subprocess.run([sys.executable, "-c", re.sub("[1-9]e[5-8]", "4e3", block)], cwd=folder,
                                         capture_output=True, text=True)
                    self.assertEqual(run.returncode, 0, run.stderr)


class Evaluations(unittest.TestCase):
    @unittest.skipUnless(TOOL, "the command-line tool was not built")
    def test_baselines_are_the_tools(self):
        for kind in ("zero", "hold", "random"):
            said = tool("eval", "--task", "hand_over_safe_finger", "--policy", kind, "--episodes", 40)
            ours = redman.evaluate(kind, "hand_over_safe_finger", episodes=40)
            for key in ("return_mean", "return_std", "cost_mean", "cost_std", "length_mean", "success_rate",
                        "fall_rate", "violation_rate", "feasible"):
                np.testing.assert_allclose(getattr(ours, key), said[key], rtol=1e-12, err_msg=key)

    @unittest.skipUnless(TOOL, "the command-line tool was not built")
    def test_it_is_printed_as_the_tool_prints_it(self):
        for kind, episodes in (("random", 8), ("trained", 4), ("zero", 1)):
            words = map(str, ("eval", "--task", "hand_over_safe_finger", "--policy", kind, "--episodes", episodes))
            said = subprocess.run([TOOL, *words], check=True, capture_output=True, text=True).stdout.splitlines()
            lines = str(redman.evaluate(kind, "hand_over_safe_finger", episodes=episodes)).splitlines()
            self.assertEqual(lines[:2], [said[0].replace(" of hand_over_safe_finger", ""), said[1]])
            self.assertIn("effort ", lines[2])
            self.assertRegex(lines[3], "^length .* control steps, falls ")
            self.assertLess(max(map(len, lines)), 250)

    def test_a_function_of_rows_plays(self):
        e = redman.evaluate(lambda obs: np.full((len(obs), 1), 0.5), "bandit", episodes=10)
        # an action of 0.5 is a choice of 2.5: reward -(2.5 - 2)^2, cost 2.5
        self.assertEqual((e.episodes, e.length_mean, e.return_mean, e.cost_mean), (10, 1, -0.25, [2.5]))


if __name__ == "__main__":
    unittest.main()
