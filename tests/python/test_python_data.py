"""redman.data: arrays come back to the byte from every form, a time limit is no termination, unfinished episodes are listed."""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import redman
import stubs
from redman import data
from redman._tool import run_tool, tool_path

stubs.pyarrow()
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
            for end in ["npz", "mcap", "lerobot"] + (["hdf5", "minari"] if h5py else []):
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
        self.assertEqual(data.hash(self.path / "ball_run.npz"), data.hash(data.load(self.path / "ball_run.npz")))
        for wrong in (lambda: data.hash(3), lambda: data.save(str(self.path / "ball_run.npz"), self.path / "other.npz")):
            with self.assertRaisesRegex(redman.UsageError, "arrays: it must be a dict of arrays"):
                wrong()

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

    def test_lerobot_has_the_published_layout(self):
        data.convert(self.path / "hand_over_safe_finger.npz", self.path / "l.lerobot")
        arrays, folder = data.load(self.path / "hand_over_safe_finger.npz"), self.path / "l.lerobot"
        info = json.loads((folder / "meta/info.json").read_text())
        self.assertEqual((info["codebase_version"], info["fps"]), ("v3.0", 15))  # 4 control steps of 1/60 s
        self.assertEqual((info["total_frames"], info["total_episodes"]), (len(arrays["obs"]), len(arrays["episode_begin"]) - 1))
        widths = {name: f["shape"] for name, f in info["features"].items()}
        self.assertEqual(widths["observation.state"], [arrays["obs"].shape[1]])
        self.assertEqual(widths["next.reward"], [1])
        for name in ("timestamp", "frame_index", "episode_index", "index", "task_index"):
            self.assertEqual(widths[name], [1])
        for name, f in info["features"].items():
            self.assertTrue(f["names"] is None or len(f["names"]) == f["shape"][0], name)
        import pyarrow.parquet as pq
        rows = pq.read_table(str(folder / info["data_path"].format(chunk_index=0, file_index=0)))
        self.assertEqual(sorted(rows.column_names), sorted(widths))
        episodes = pq.read_table(str(folder / "meta/episodes/chunk-000/file-000.parquet"))
        ends = episodes.column("dataset_to_index").combine_chunks().to_numpy(zero_copy_only=False)
        self.assertEqual(list(ends), list(arrays["episode_begin"][1:]))
        times = rows.column("timestamp").combine_chunks().to_numpy(zero_copy_only=False)
        self.assertEqual(times[int(ends[0])], 0)  # each episode begins anew
        self.assertAlmostEqual(float(times[1]), 1 / 15, places=6)
        self.assertEqual(json.loads((folder / "meta/stats.json").read_text())["action"]["count"], [len(arrays["obs"])])

    def test_lerobot_files_are_filled_with_whole_episodes(self):
        from redman import _lerobot
        arrays, kept = data.load(self.path / "two_state.npz"), _lerobot._FILE_MB
        _lerobot._FILE_MB = 1e-3
        try:
            data.save(arrays, self.path / "many.lerobot")
        finally:
            _lerobot._FILE_MB = kept
        self.assertGreater(len(list((self.path / "many.lerobot/data/chunk-000").iterdir())), 3)
        self.assert_same(arrays, data.load(self.path / "many.lerobot"))

    def test_a_lerobot_folder_of_another_writer(self):
        import pyarrow as pa
        import pyarrow.parquet as pq
        folder = self.path / "theirs.lerobot"
        rng = np.random.default_rng(0)
        features = {"observation.state": (2, "float32"), "observation.effort": (1, "float64"), "action": (1, "float32"), "next.done": (1, "bool"),
                    "episode_index": (1, "int64"), "frame_index": (1, "int64")}
        info = {"codebase_version": "v3.0", "fps": 30, "features": {n: {"dtype": d, "shape": [w], "names": None} for n, (w, d) in features.items()}}
        info["features"]["observation.images.wrist"] = {"dtype": "video", "shape": [64, 64, 3], "names": None}
        (folder / "meta").mkdir(parents=True)
        (folder / "data/chunk-000").mkdir(parents=True)
        (folder / "meta/info.json").write_text(json.dumps(info))
        state = rng.normal(size=(5, 2)).astype(np.float32)
        columns = {"observation.state": pa.FixedSizeListArray.from_arrays(pa.array(state.reshape(-1)), 2), "observation.effort": pa.array(np.arange(5.0)),
                   "action": pa.array(np.zeros(5, np.float32)), "next.done": pa.array(np.array([0, 0, 1, 0, 0], bool)),
                   "episode_index": pa.array(np.array([0, 0, 0, 1, 1])), "frame_index": pa.array(np.array([0, 1, 2, 0, 1]))}
        pq.write_table(pa.table(columns), str(folder / "data/chunk-000/file-000.parquet"))
        with self.assertWarnsRegex(UserWarning, "observation.images.wrist|no next.reward") as caught:
            arrays = data.load(folder)
        self.assertEqual(len(caught.warnings), 2)
        self.assertEqual(arrays["obs"].tolist(), [[*map(float, s), float(i)] for i, s in enumerate(state)])
        self.assertTrue(np.isnan(arrays["reward"]).all())
        self.assertEqual(list(arrays["terminated"]), [0, 0, 1, 0, 0])
        self.assertEqual(data.unfinished(arrays), [1])
        info["codebase_version"] = "v2.1"
        (folder / "meta/info.json").write_text(json.dumps(info))
        with self.assertRaisesRegex(redman.FormatError, "version is v2.1"):
            data.load(folder)

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
