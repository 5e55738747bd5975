"""The generated types are what the headers, the layout file and the symbol lists say."""
import ctypes
import importlib.util
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import redman
from redman import _abi, _import_abi
from redman._library import lib

TREE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(TREE / "capi" / "python"))
import generate_abi  # noqa: E402


class Abi(unittest.TestCase):
    def test_generating_again_gives_the_committed_file(self):
        again = generate_abi.generate(generate_abi.headers())
        self.assertEqual(again, generate_abi.OUTPUT.read_text(encoding="utf-8"), "run capi/python/generate_abi.py")
        again = generate_abi.generate_import(generate_abi.import_header(), generate_abi.headers())
        self.assertEqual(again, generate_abi.IMPORT_OUTPUT.read_text(encoding="utf-8"), "run capi/python/generate_abi.py")

    def test_structs_have_the_recorded_layout(self):
        recorded = (TREE / "capi/layout.golden").read_text().split("\n")
        gone = set(re.findall(r"^} (rdm_\w+);", (TREE / "include/redman/deprecated.h").read_text(), re.MULTILINE))  # not bound
        self.assertTrue(gone)
        ours = []
        for name, struct in {**_abi.STRUCTS, **_import_abi.STRUCTS}.items():
            for field, _ in struct._fields_:
                place = getattr(struct, field)
                ours.append(f"{name}.{field} {place.offset} {place.size}")
            ours.append(f"{name} {ctypes.sizeof(struct)}")
        wanted = [line for line in recorded if line and re.split(r"[. ]", line)[0] not in gone]
        self.assertEqual(sorted(wanted), sorted(ours))

    def test_every_exported_function_has_a_signature_and_words(self):
        for parts, experimental in ((("redman", "redman_1.0"), False), (("redman_experimental",), True)):
            listed = [name for part in parts for name in (TREE / f"capi/{part}.symbols").read_text().split()]
            ours = [name for name, f in _abi.FUNCTIONS.items() if f.experimental == experimental]
            self.assertEqual(sorted(listed), sorted(ours))
        listed = (TREE / "capi/import/redman_import.symbols").read_text().split()
        self.assertEqual(sorted(set(listed) & set(_import_abi.FUNCTIONS)), sorted(_import_abi.FUNCTIONS))
        self.assertTrue(all(function.doc for function in _import_abi.FUNCTIONS.values()))
        for name, function in _abi.FUNCTIONS.items():
            self.assertTrue(function.doc, name)
            self.assertEqual(getattr(lib, name).argtypes, list(function.arguments.values()), name)

    def test_a_function_or_member_that_is_added_to_the_header_arrives(self):
        header = generate_abi.headers()
        header = header.replace("} rdm_camera_info;", "  float more[2]; /* [2] rad */\n} rdm_camera_info;")
        header = header.replace("RDM_API uint32_t rdm_features(void);",
                                "/* Adds row [n] to out [n][2]. */\n"
                                "RDM_API rdm_result rdm_new(const double *row, int32_t n, float *out);\n"
                                "RDM_API uint32_t rdm_features(void);")
        scope = {"__name__": "redman._abi", "__package__": "redman"}
        exec(compile(generate_abi.generate(header), "new", "exec"), scope)
        self.assertEqual(ctypes.sizeof(scope["rdm_camera_info"]), ctypes.sizeof(_abi.rdm_camera_info) + 8)
        new = scope["FUNCTIONS"]["rdm_new"]
        self.assertEqual({name: (rows.dtype, rows.shape) for name, rows in new.rows.items()},
                         {"row": ("float64", ("n",)), "out": ("float32", ("n", "2"))})
        self.assertEqual(new.doc, "Adds row [n] to out [n][2].")
        with self.assertRaisesRegex(SystemExit, "not a declaration"):
            generate_abi.generate(header.replace("RDM_API uint32_t rdm_version(void);", "RDM_API what is this;"))

    def test_every_row_of_the_header_has_a_shape(self):
        for struct in ("rdm_buffers", "rdm_transition", "rdm_sensors"):
            pointers = [name for name, kind in _abi.STRUCTS[struct]._fields_
                        if kind is ctypes.c_void_p and name != "reserved_pointer"]
            self.assertEqual(sorted(pointers), sorted(_abi.ROWS[struct]), struct)

    def test_records_hold_what_the_structs_hold(self):
        build = redman.build()
        self.assertEqual(build.version, redman.version)
        self.assertEqual(build.abi, _abi.RDM_ABI)
        with self.assertRaises(AttributeError):
            build.abi = 2
        camera = _abi.rdm_camera_info(name=b"top", eye=(1, 2, 3))
        self.assertEqual(redman.Camera(camera).eye, (1.0, 2.0, 3.0))
        self.assertEqual(redman.Camera(camera), redman.Camera(camera))


class Types(unittest.TestCase):
    @unittest.skipUnless(importlib.util.find_spec("mypy"), "no mypy (apt-get install mypy)")
    def test_mypy_has_nothing_to_say_of_the_package_and_of_a_user(self):
        with tempfile.TemporaryDirectory() as folder:
            user = Path(folder, "user.py")
            user.write_text("import redman\n"
                            "pool = redman.Pool('bandit', options={'points': 3})\n"
                            "pool.step(pool.reset(seeds=[1])[:, :1])\n"
                            "epoch = redman.Agent(pool, cost_limits={'cost': 1.0}).rollout(pool)\n"
                            "x: float = epoch.ret\n"
                            "y: bool = redman.train('bandit', callback=lambda e: e.epoch > 3).evaluate().feasible\n"
                            "run = redman.train('bandit', learning_rate=1e-3, seed=1, time_budget=2, from_='trained', hidden=[8])\n"
                            "runs: list[redman.Run] = redman.train(['bandit', 'grasp'], seed=range(2), steps=1e3)\n"
                            "runs = redman.train('bandit', ['ppo', 'cpo']) + redman.train('bandit', seed=[0, 1])\n"
                            "def far(rows: redman.Rows) -> object:\n    return rows.field('position')[:, 0] > 1\n"
                            "again: redman.Run = redman.train(resume=run.folder, costs={'far': far, 'cost': 'cost'}, reward=far)\n"
                            "def slow(epoch: redman.Epoch, training: redman.Training) -> bool:\n"
                            "    training.set(learning_rate=epoch.learning_rate / 2)\n    return training.progress > 0.5\n"
                            "lessons = redman.callbacks.Curriculum({'max_steps': [5, 9], 'learning_rate': (1e-3, 1e-4)})\n"
                            "redman.train('bandit', callback=[slow, lessons, redman.callbacks.TensorBoard('board')])\n"
                            "first: float = redman.evaluate(run, cost_limits={'far': 3.0}, costs=[far]).cost_mean[0]\n"
                            "shield = redman.Shield(pool, budgets={'cost': 1.0})\n"
                            "shield.act(pool.action, mask=[True])\n"
                            "kind: redman.ShieldKind = shield.row(0).kind\n"
                            "steps: int = redman.evaluate('zero', 'bandit', shield={'noise': 0.1}).violating_steps\n"
                            "planner = redman.Planner(pool, policy='trained', stop=lambda steps: steps > 3)\n"
                            "share: float = planner.info.costs['cost'] + planner.act()[0]\n"
                            "recording = redman.Recording(pool)\n"
                            "with recording.step(pool, label=pool.action):\n    pool.step()\n"
                            "agent = redman.Agent(pool, ranks=redman.Ranks(0, 1, lambda message: [message]))\n"
                            "losses: tuple[float, ...] = agent.clone(recording, epochs=3).train_losses\n"
                            "value, cost = agent.values(pool.obs)\n"
                            "robot: redman.Robot = redman.load_robot('my.urdf', tips=['a', 'b'])\n"
                            "line: int = robot.notes[0].line + robot.poses().tips.shape[0]\n"
                            "thing: redman.Object = redman.objects()['egg']\n"
                            "redman.Pool(redman.load_task('x.task'), options={'hand': 'my.urdf', 'object': thing})\n"
                            "agent.policy().export('p.onnx')\n"
                            "low, high = redman.stats.interval({'a': [1.0, 2.0]})\n"
                            "z: str = redman.tasks()['bandit'].options['points'].help\n")
            run = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", folder, "redman",
                                  "generate_abi.py", user], cwd=TREE / "capi/python", capture_output=True, text=True)
        self.assertEqual(run.returncode, 0, run.stdout)


class Library(unittest.TestCase):
    def imported(self, **environment):
        return subprocess.run([sys.executable, "-c", "import redman"], env={**os.environ, **environment},
                              capture_output=True, text=True)

    def test_a_library_that_is_not_there_is_a_clear_import_error(self):
        run = self.imported(REDMAN_LIBRARY="/nowhere/libredman.so")
        self.assertEqual(run.returncode, 1)
        last = run.stderr.strip().splitlines()[-1]
        self.assertRegex(last, "^ImportError: redman: no shared library: /nowhere/libredman.so.*REDMAN_LIBRARY")

    def test_another_library_is_refused(self):
        run = self.imported(REDMAN_LIBRARY="libc.so.6")
        self.assertRegex(run.stderr, "ImportError: redman: .*libc.so.6: older than this package")


if __name__ == "__main__":
    unittest.main()
