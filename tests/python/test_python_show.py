"""What draws itself, and files of episodes: pages with the tool's own bytes, pictures, films, tables, comparisons."""
import base64
import csv
import gzip
import html
import importlib.util
import json
import os
import pickle
import re
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree
from pathlib import Path
from unittest import mock

import numpy as np

import redman

TOOL = os.environ.get("REDMAN_TOOL", "")
TASK = "hand_over_safe_finger"
# It counts the bytes of the pictures and writes that to its last argument, file:PATH.
FFMPEG = f"#!{sys.executable}\n" + """import sys
pictures = sys.stdin.buffer.read()
open(sys.argv[-1][len("file:"):], "w").write(" ".join([str(len(pictures)), *sys.argv[1:]]))
"""


def has_viewer():
    """Whether the tool writes pages."""
    if not TOOL:
        return False
    with tempfile.TemporaryDirectory() as folder:
        return subprocess.run([TOOL, "render", "--task", "bandit", "--html", "a.html"], cwd=folder, capture_output=True).returncode == 0


VIEWER = has_viewer()
needs_viewer = unittest.skipUnless(VIEWER, "no tool, or no viewer library in it (libjs-three)")


def tags(text):
    return re.findall(r"<(\w+)[ >]", text)


def pages_in(text):
    """The pages that are packed into frames."""
    found = re.findall(r'srcdoc="([^"]*)"', text)
    packed = [re.search(r'atob\("([^"]+)"\)', html.unescape(page))[1] for page in found]
    return [gzip.decompress(base64.b64decode(part)).decode() for part in packed]


class Ball(redman.Task):
    """A ball on the ground, pushed sideways."""

    name, max_steps, action_dim = "show_ball", 12, 1
    fields = {"p": (3, "m")}
    costs = {"right": (5, "x is above 0.05")}

    def scene(self, s):
        self.ball = s.sphere("ball", 0.05, mass=0.2, pose=[0, 0, 0.05])
        s.plane("ground")

    def reset(self, w):
        pass

    def control(self, w, action):
        w.push(self.ball, np.concatenate([4 * action, np.zeros((w.n, 2))], axis=1))

    def judge(self, w):
        x = w.position(self.ball)[:, 0]
        return redman.Verdict(x, {"right": x > 0.05})

    def observe(self, w):
        return (w.position(self.ball),)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    @needs_viewer
    def test_a_page_has_the_bytes_of_the_tools(self):
        policy = redman.Policy.trained(TASK)
        for ending in ("html", "glb"):
            for extra, told in (({}, []), ({"seed": 3, "options": {"object": "ball"}}, ["--seed", "3", "--set", "object=ball"])):
                ours, theirs = (self.folder / f"{who}.{ending}" for who in ("ours", "theirs"))
                policy.render(ours, camera="front", **extra)
                subprocess.run([TOOL, "render", "--task", TASK, "--policy", "trained", f"--{ending}", theirs, *told], check=True,
                               capture_output=True)
                self.assertEqual(ours.read_bytes(), theirs.read_bytes(), (ending, extra))

    @needs_viewer
    def test_a_run_is_shown_with_its_options_limits_and_costs(self):
        run = redman.train("ball_run", steps=2000, envs=8, options={"max_steps": 30}, costs={"fast": lambda rows: rows.speed("velocity") > 0.1},
                           cost_limits={"fast": 7}, progress=False, horizon=64)
        run.render(self.folder / "run.html", camera="top")
        text = (self.folder / "run.html").read_text(encoding="utf-8")
        episode = json.loads(re.search(r'id="episode">(.*?)</script>', text, re.S)[1])
        self.assertEqual((episode["frames"], episode["camera"]), (31, "top"))
        self.assertEqual([(c["name"], c["limit"]) for c in episode["curves"]], [("return", None), ("fast", 7)])
        sums = np.frombuffer(base64.b64decode(episode["curves"][1]["sum"]), np.float32)
        steps = np.frombuffer(base64.b64decode(episode["curves"][1]["step"]), np.float32)
        np.testing.assert_array_equal(np.cumsum(steps), sums)
        own = run.evaluate(episodes=1, num_envs=1)
        self.assertEqual(float(sums[-1]), own.cost_mean[0])

    @needs_viewer
    def test_a_task_in_python_has_a_page(self):
        pool = redman.Pool(Ball, num_envs=3, autoreset="off")
        pool.reset()
        with pool.record(1, actor="a push") as episode:
            for _ in range(12):
                pool.step(np.full((3, 1), 0.5))
        self.assertEqual(episode.frames, 13)
        episode.render(self.folder / "ball.html")
        text = (self.folder / "ball.html").read_text(encoding="utf-8")
        self.assertIn("policy a push", text)
        told = json.loads(re.search(r'id="episode">(.*?)</script>', text, re.S)[1])
        self.assertEqual(told["shapes"], 2)
        reward = np.frombuffer(base64.b64decode(told["curves"][0]["sum"]), np.float32)
        self.assertEqual(float(reward[-1]), float(pool.episode_return[1]))

    def test_pictures_are_the_librarys(self):
        pool = redman.Pool(TASK, seed=4, autoreset="off")
        pool.reset()
        with pool.record() as episode:
            for _ in range(4):
                pool.step(pool.baseline("random"))
        again, = episode.pictures([4], "front", 64, 48)
        np.testing.assert_array_equal(again, pool.render(camera="front", width=64, height=48))
        for extra, width in (({"strip": 3}, 3 * 64 + 2 * 2), ({"step": 2}, 64)):
            episode.render(self.folder / "a.png", width=64, height=48, **extra)
            data = (self.folder / "a.png").read_bytes()
            self.assertEqual((data[:4], int.from_bytes(data[16:20], "big")), (b"\x89PNG", width))
        with self.assertRaisesRegex(redman.ArgumentError, "step: 5 is not between 0 and 4"):
            episode.render(self.folder / "a.png", step=5)
        with self.assertRaisesRegex(redman.ArgumentError, "camera: 'frnt' is none of .*nearest is front"):
            episode.render(self.folder / "a.png", camera="frnt")

    def test_films_are_made_of_all_frames(self):
        episode = redman.Policy.trained(TASK).episode(steps=5)
        program = self.folder / "ffmpeg"
        program.write_text(FFMPEG, encoding="utf-8")
        program.chmod(0o755)
        with mock.patch.dict(os.environ, {"PATH": str(self.folder)}):
            for ending, word in ((".mp4", "libx264"), (".gif", "palettegen")):
                path = self.folder / f"film{ending}"
                episode.render(path, width=32, height=24)
                words = path.read_text(encoding="utf-8").split()
                self.assertEqual(words[0], str(6 * 32 * 24 * 3))
                self.assertEqual(words[words.index("-r") + 1], "60")
                self.assertIn(word, " ".join(words))
            program.write_text(f"#!{sys.executable}\nraise SystemExit('it broke')\n", encoding="utf-8")
            with self.assertRaisesRegex(redman.FileError, "ffmpeg: it broke"):
                episode.render(self.folder / "film.mp4", width=640, height=480)
            program.unlink()
            with self.assertRaisesRegex(redman.UnsupportedError, "a .mp4 file needs the program ffmpeg"):
                episode.render(self.folder / "film.mp4")

    def test_errors_say_what_can_be_written(self):
        policy = redman.Policy.trained("ball_run")
        for name in ("throw.avi", "throw", "throw.htm"):
            with self.assertRaisesRegex(redman.ArgumentError, rf"{name!r} ends in none of \.html, \.glb, \.png, \.mp4, \.gif"):
                policy.render(name)
        with redman.Pool("ball_run") as pool, pool.record() as episode:
            with self.assertRaisesRegex(redman.StateError, "no frames"):
                episode.render(self.folder / "a.png")

    @needs_viewer
    def test_the_tool_refuses_what_is_no_episode(self):
        episode = redman.Policy.trained(TASK).episode(steps=3)
        whole = b"".join([episode._scene, *episode._frames])
        feed = self.folder / "feed"
        for data, word in ((whole[:-5], "cut short"), (whole[:len(episode._scene)], "no frame"), (b"", "no scene"),
                           (episode._frames[0], "task: it is missing"), (b"\xff" * 64, "a message of 4294967295 bytes"),
                           (episode._scene + episode._frames[0][:4] + bytes([episode._frames[0][4] + 1]) + episode._frames[0][5:],
                            "with a text of"),
                           (whole.replace(b'"contacts": 0', b'"contacts": 9', 1), "does not fit its scene"),
                           (whole.replace(b'"dt": ', b'"dt":-', 1), "dt: it is outside")):
            feed.write_bytes(data)
            done = subprocess.run([TOOL, "render", "--feed", feed, "--html", self.folder / "a.html"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 1)
            self.assertIn(word, done.stderr)
        for words in (["--glb", "a.glb", "--task", "grasp"], []):
            done = subprocess.run([TOOL, "render", "--feed", feed, *words], capture_output=True, text=True, cwd=self.folder)
            self.assertEqual(done.returncode, 2, done.stderr)


class Recorded(unittest.TestCase):
    def test_a_pool_that_is_recorded_is_the_same_pool(self):
        pools = [redman.Pool(TASK, num_envs=2, seed=1) for _ in range(2)]
        for pool in pools:
            pool.reset(seeds=5)
        with pools[0].record() as first, pools[0].record(1) as second:
            for _ in range(3):
                pools[0].step(pools[0].baseline("random"))
            pickle.loads(pickle.dumps(pools[0])).step()
            pools[0].reset(seed=9, mask=[True, False])
        for _ in range(3):
            pools[1].step(pools[1].baseline("random"))
        pools[1].reset(seeds=9, mask=[True, False])
        self.assertEqual(pools[0].hash(), pools[1].hash())
        self.assertEqual((first.frames, second.frames), (1, 1))  # begun anew by the reset
        self.assertNotIn("step", vars(pools[0]))
        self.assertIs(pools[0].step.__func__, redman.Pool.step)

    def test_with_same_step_the_next_episode_is_not_in_it(self):
        pool = redman.Pool("ball_run", options={"max_steps": 5})
        pool.reset()
        with pool.record() as episode:
            for _ in range(8):
                pool.step(pool.baseline("zero"))
        self.assertEqual(episode.frames, 5)


class Drawn(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.runs = redman.train("ball_run", ["ppo", "ppo_lag"], steps=6000, seed=[0, 1], envs=8, horizon=64, progress=False)

    @needs_viewer
    def test_a_policy_is_a_player(self):
        policy = redman.Policy.trained(TASK)
        page, = pages_in(policy._repr_html_())
        self.assertEqual(page, policy.episode().page())
        self.assertLess(len(policy._repr_html_()), 700_000)
        self.assertIn('sandbox="allow-scripts allow-downloads"', policy._repr_html_())

    @needs_viewer
    def test_a_run_is_a_player_its_curves_and_its_evaluation(self):
        run = self.runs[2]
        drawn = run._repr_html_()
        self.assertEqual(len(pages_in(drawn)), 1)
        self.assertIn(run.curve._repr_html_(), drawn)
        self.assertIn(run.judged()._repr_html_(), drawn)
        self.assertIn("limits: cost 25", drawn)

    def test_without_a_tool_pictures_are_left(self):
        with mock.patch("redman._tool.tool_path", return_value=None):
            policy = redman.Policy.trained(TASK)
            self.assertIsNone(policy._repr_html_())
            self.assertEqual(policy._repr_png_()[:4], b"\x89PNG")
            with self.assertRaisesRegex(redman.UnsupportedError, "a .html file needs the command redman"):
                policy.render("a.html")
            self.assertIn("<table>", self.runs[0]._repr_html_())

    def test_an_evaluation_is_a_table_with_intervals(self):
        e = self.runs[2].judged()
        text = e._repr_html_()
        root = xml.etree.ElementTree.fromstring(text)
        cells = [["".join(cell.itertext()) for cell in row] for row in root.iter("tr")]
        self.assertEqual(cells[0], ["", "mean", "95 % interval", "limit", "within"])
        self.assertEqual([row[0] for row in cells[1:4]], ["return", "cost", "cost, worst tenth"])
        low, high = map(float, cells[1][2].split(" to "))
        self.assertLessEqual(low, float(cells[1][1]))
        self.assertLessEqual(float(cells[1][1]), high)
        self.assertEqual(cells[2][3:], ["25", "yes" if e.cost_mean[0] <= 25 else "no"])

    def test_a_pool_is_a_picture_and_a_table(self):
        pool = redman.Pool("ball_run", num_envs=20)
        self.assertIsNone(pool._repr_html_())
        pool.reset()
        pool.step(pool.baseline("random"))
        text = pool._repr_html_()
        self.assertEqual(text.count('src="data:image/png;base64,'), 1)
        self.assertEqual(tags(text).count("tr"), 17)
        self.assertIn("20 worlds, the first 16", text)
        self.assertIn("limit 25", text)
        self.assertNotIn("<img", redman.Pool("two_state", num_envs=1)._repr_html_() or "")

    def test_seeds_are_a_line_in_a_band(self):
        curves = [run.curve for run in self.runs]
        self.assertEqual([curve.seed for curve in curves], [0, 1, 0, 1])

        def count(drawn, tag):
            return sum(node.tag.endswith(tag) for node in xml.etree.ElementTree.fromstring(drawn._repr_svg_()).iter())

        self.assertEqual((count(redman.Curves(curves), "polyline"), count(redman.Curves(curves), "polygon")), (4, 4))
        self.assertEqual((count(redman.Curves(curves, each=True), "polyline"), count(redman.Curves(curves, each=True), "polygon")), (8, 0))
        self.assertEqual(count(redman.Curves([curves[0], curves[0]]), "polyline"), 4)  # one seed twice is no sample of seeds

    def test_runs_of_other_settings_have_a_line_and_a_row_of_their_own(self):
        made = [redman.train("ball_run", "ppo", steps=600, envs=2, seed=seed, progress=False, horizon=50, shield=shield)
                for seed, shield in ((0, None), (1, None), (2, "predict"), (3, "predict"))]
        names = ["ppo", "ppo: shield predict"]
        from redman._curve import lines_of
        self.assertEqual([line.label for line in lines_of([run.curve for run in made], False)],
                         [f"ball_run {name} (2 seeds)" for name in names])
        self.assertEqual({name: len(runs) for name, runs in redman.compare(made, episodes=2).runs.items()}, dict.fromkeys(names, 2))
        with tempfile.TemporaryDirectory() as folder:
            paths = [Path(folder, str(clip)) for clip in (0.1, 0.2)]
            for path, clip in zip(paths, (0.1, 0.2)):
                redman.train("bandit", "ppo", steps=500, envs=4, seed=int(10 * clip), progress=False, out=path, clip=clip)
            self.assertEqual(list(redman.compare(folder, episodes=2).runs), ["ppo: clip 0.1", "ppo: clip 0.2"])
            self.assertEqual(len(lines_of(list(redman.curve(*paths)), False)), 2)

    def test_a_band_is_the_mean_and_the_deviation_at_common_steps(self):
        from redman._curve import lines_of
        made = [redman.Curve({"TotalEnvSteps": [0, last], "Metrics/EpRet": [first, first + slope * last]}, "x", None, "", "k", seed)
                for seed, (first, slope, last) in enumerate(((0, 1, 100), (10, 1, 50), (20, 1, 200)))]
        line, = lines_of(made, False)
        steps, mean, half = line.points("Metrics/EpRet")
        self.assertEqual((steps[-1], len(steps)), (50, 120))
        np.testing.assert_allclose(mean, steps + 10)
        np.testing.assert_allclose(half, 10)

    def test_a_comparison_has_a_row_for_each_name(self):
        both = redman.compare(self.runs, episodes=10)
        self.assertEqual(sorted((row.name, row.runs) for row in both.rows), [("ppo", 2), ("ppo_lag", 2)])
        for row in both.rows:
            scores = [e.return_mean for e in both.evaluations[row.name]]
            self.assertEqual((row.return_iqm, row.return_interval), (redman.stats.iqm(scores), redman.stats.interval(scores)))
            self.assertEqual(row.within, sum(e.feasible for e in both.evaluations[row.name]))
            self.assertIn(row.name, str(both))
        drawn = both._repr_html_()
        self.assertEqual((drawn.count("<table>"), drawn.count("data:image/svg+xml")), (1, 1))
        self.assertIn("10 new episodes", drawn)
        named = redman.compare({"one": self.runs[0], "rest": self.runs[1:]}, episodes=4)
        self.assertEqual({row.name: row.group for row in named.rows}["one"], "")  # one run says nothing of others
        self.assertAlmostEqual(both.improvement("ppo", "ppo_lag").probability + both.improvement("ppo_lag", "ppo").probability, 1)
        for wrong in ((), (3,), ([],)):
            with self.assertRaises(redman.UsageError):
                redman.compare(*wrong)

    def test_folders_are_compared(self):
        with tempfile.TemporaryDirectory() as folder:
            redman.train("bandit", ["ppo", "ppo_lag"], steps=500, seed=range(2), envs=4, progress=False, out=Path(folder, "all"))
            self.assertEqual({name: len(runs) for name, runs in redman.compare(Path(folder, "all"), episodes=2).runs.items()},
                             {"ppo": 2, "ppo_lag": 2})
        with tempfile.TemporaryDirectory() as folder:
            for seed in (0, 1):
                redman.train("bandit", steps=500, seed=seed, envs=4, progress=False, out=Path(folder, f"r{seed}"))
            self.assertEqual(redman.compare(folder, episodes=4).rows[0].runs, 2)
            r0, r1 = Path(folder, "r0"), Path(folder, "r1")
            self.assertEqual(redman.compare(r0, r1, episodes=4).rows[0].runs, 2)
            again = Path(folder, "all", "link")  # one run is one seed, however it is called
            again.parent.mkdir()
            again.symlink_to(r0)
            for given in ((r0, r0, f"{folder}/r1/../r0", again, r1), ({"one": [r0, again, redman.Run.load(r0), r1]},)):
                self.assertEqual([run.seed for run in next(iter(redman.compare(*given, episodes=4).runs.values()))], [0, 1])
            self.assertEqual([one.seed for one in redman.curve(r0, again, f"{folder}/r1/../r0", r1)], [0, 1])
            self.assertEqual(len(redman.curve(r0, r0)), 1)

    @unittest.skipUnless(TOOL, "no tool")
    def test_groups_are_those_of_the_tool(self):
        random = np.random.default_rng(3)
        scores = {name: list(random.normal(mean, 1, 6)) for name, mean in
                  (("far", 9), ("a", 5), ("b", 4.2), ("c", 3.4), ("d", 2.8), ("low", -4))}
        with tempfile.TemporaryDirectory() as folder:
            with open(Path(folder, "s.csv"), "w", newline="", encoding="utf-8") as file:
                rows = csv.writer(file)
                rows.writerow(["algorithm", "return"])
                for name, runs in scores.items():
                    rows.writerows([name, repr(score)] for score in runs)
            told = json.loads(subprocess.run([TOOL, "compare", "s.csv", "--json"], cwd=folder, check=True, capture_output=True).stdout)
        self.assertEqual(redman.stats.letters(scores), {row["name"]: row["group"] for row in told["rows"]})
        self.assertGreater(len(set(redman.stats.letters(scores).values())), 2)
        for each in told["pairs"]:
            ours = redman.stats.difference(scores[each["better"]], scores[each["than"]])
            np.testing.assert_allclose(ours, each["difference_interval"], rtol=1e-9)

    @unittest.skipUnless(importlib.util.find_spec("nbconvert"), "no nbconvert (apt-get install python3-nbconvert)")
    def test_an_exported_notebook_shows_all(self):
        from nbconvert import HTMLExporter
        from nbformat.v4 import new_code_cell, new_notebook, new_output
        shown = [self.runs[0], self.runs[0].judged(), redman.compare(self.runs, episodes=2)]
        outputs = [new_output("display_data", {"text/html": each._repr_html_()}) for each in shown]
        page, _ = HTMLExporter().from_notebook_node(new_notebook(cells=[new_code_cell("x", outputs=outputs)]))
        for each in shown:
            self.assertIn(each._repr_html_(), page)


if __name__ == "__main__":
    unittest.main()
