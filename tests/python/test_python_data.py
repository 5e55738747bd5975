"""redman.data: arrays come back to the byte from every form, a time limit is no termination, unfinished episodes are listed."""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import redman
from redman import data
from redman._tool import run_tool, tool_path

try:
    import h5py
except ImportError:
    h5py = None


@unittest.skipIf(tool_path() is None, "there is no command-line tool")
class Data(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = Path(cls.folder.name)
        for task, rows in (("two_state", 200), ("ball_run", 300), ("hand_over_safe_finger", 300)):
            run_tool("data", "make", task, "--rows", str(rows), "--out", str(cls.path / f"{task}.npz"), why="a set")

    def assert_same(self, one, two, but=()):
        for name in sorted(set(one) - set(but)):
            self.assertIn(name, two)
            self.assertEqual(one[name].dtype, two[name].dtype, name)
            self.assertEqual(one[name].tobytes(), two[name].tobytes(), name)

    def test_arrays_come_back_to_the_byte(self):
        for task in ("two_state", "ball_run", "hand_over_safe_finger"):
            one = data.load(self.path / f"{task}.npz")
            for end in ["npz", "mcap"] + (["hdf5", "minari"] if h5py else []):
                with self.subTest(task=task, end=end):
                    target = self.path / f"{task}_again.{end}"
                    done = data.convert(self.path / f"{task}.npz", target)
                    self.assert_same(one, data.load(target))
                    self.assertEqual(done["hash"], data.hash(one))
                    back = self.path / f"{task}_back.npz"
                    data.convert(target, back)
                    self.assertEqual(redman.Recording.load(back).obs.tobytes(), one["obs"].tobytes())

    def test_the_hash_is_the_tools(self):
        said = subprocess.run([tool_path(), "data", "info", "--json", str(self.path / "ball_run.npz")], stdout=subprocess.PIPE, check=True)
        self.assertEqual(json.loads(said.stdout)["hash"], data.hash(data.load(self.path / "ball_run.npz")))

    @unittest.skipIf(h5py is None, "h5py is missing")
    def test_hdf5_has_the_published_keys(self):
        data.convert(self.path / "two_state.npz", self.path / "a.hdf5")
        data.convert(self.path / "ball_run.npz", self.path / "b.hdf5")
        with h5py.File(self.path / "a.hdf5") as ended, h5py.File(self.path / "b.hdf5") as cut:
            for file in (ended, cut):
                self.assertLessEqual({"observations", "next_observations", "actions", "rewards", "costs", "terminals", "timeouts"}, set(file))
                self.assertEqual(file["observations"].dtype, np.float32)
                self.assertEqual(file["costs"].shape, file["rewards"].shape)
                self.assertFalse((file["terminals"][()] & file["timeouts"][()]).any())
                inside = ~(file["terminals"][()] | file["timeouts"][()])[:-1]
                self.assertTrue((file["next_observations"][:-1][inside] == file["observations"][1:][inside]).all())
            self.assertTrue(ended["terminals"][()].any())
            self.assertFalse(cut["terminals"][()].any())  # a time limit alone ends it
            self.assertEqual(int(cut["timeouts"][()].sum()), int(cut["timeouts"].shape[0] / 250))

    @unittest.skipIf(h5py is None, "h5py is missing")
    def test_a_file_of_another_writer(self):
        rng = np.random.default_rng(0)
        path = self.path / "theirs.hdf5"
        with h5py.File(path, "w") as file:
            file["observations"] = rng.normal(size=(7, 3))  # float64
            file["next_observations"] = rng.normal(size=(7, 3))
            file["actions"] = rng.uniform(-1, 1, size=(7, 2))
            file["rewards"], file["costs"] = rng.normal(size=7), np.ones(7)
            file["terminals"] = np.array([0, 0, 1, 0, 0, 0, 0])
            file["timeouts"] = np.array([0, 0, 1, 0, 1, 0, 0])
        arrays = data.load(path)
        self.assertEqual(list(arrays["terminated"]), [0, 0, 1, 0, 0, 0, 0])
        self.assertEqual(list(arrays["truncated"]), [0, 0, 0, 0, 1, 0, 0])
        self.assertEqual(list(arrays["episode_begin"]), [0, 3, 5, 7])
        self.assertEqual(data.unfinished(arrays), [2])
        self.assertEqual(arrays["obs"].dtype, np.float32)
        done = data.convert(path, self.path / "theirs.npz")
        self.assertEqual((done["left_out"], done["rows"]), ([2], 5))
        self.assertEqual(redman.Recording.load(self.path / "theirs.npz").info.rows, 5)
        self.assertEqual(data.convert(path, self.path / "all.npz", keep_unfinished=True)["rows"], 7)

    @unittest.skipIf(h5py is None, "h5py is missing")
    def test_minari_has_an_observation_more_than_actions(self):
        data.convert(self.path / "ball_run.npz", self.path / "m.minari")
        with h5py.File(self.path / "m.minari/data/main_data.hdf5") as file:
            self.assertEqual(file["episode_0/observations"].shape[0], file["episode_0/actions"].shape[0] + 1)
            self.assertEqual(file["episode_0/infos/cost"].shape[1], 3)
        said = json.loads((self.path / "m.minari/data/metadata.json").read_text())
        self.assertEqual(said["redman"]["format"], "redman data 1")

    def test_the_command(self):
        words = [sys.executable, "-m", "redman", "data", "convert", str(self.path / "two_state.npz"), str(self.path / "c.hdf5"), "--json"]
        done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        if h5py is None:
            self.assertIn("python3-h5py", done.stderr)
            self.assertEqual(done.returncode, 1)
        else:
            self.assertEqual(json.loads(done.stdout)["hash"], data.hash(data.load(self.path / "two_state.npz")), done.stderr)

    def test_errors_say_what_is_wrong(self):
        with self.assertRaisesRegex(redman.ArgumentError, "does not end in .npz"):
            data.load("set.pkl")
        with self.assertRaisesRegex(redman.FormatError, "no array cost"):
            data.save({k: np.zeros((2, 1), np.float32) for k in ("obs", "action", "reward", "terminated", "truncated")}, self.path / "x.npz")
        arrays = data.load(self.path / "ball_run.npz")
        if h5py:
            with self.assertRaisesRegex(redman.ArgumentError, "no final_obs"):
                data.save({k: v for k, v in arrays.items() if k != "final_obs"}, self.path / "x.hdf5")
        with self.assertRaisesRegex(redman.FormatError, "action has"):
            data.save({**arrays, "action": arrays["action"][:-1]}, self.path / "x.npz")

    def test_scores(self):
        self.assertEqual(data.score(30.0, 12.0, 10.0, 50.0, 24.0), (0.5, 0.5))
        with self.assertRaisesRegex(redman.ArgumentError, "limit"):
            data.score(1, 1, 0, 1, 0)


if __name__ == "__main__":
    unittest.main()
