"""redman.sweep: small runs, gone on with, and a wrong setting before anything starts."""
import tempfile
import unittest
from pathlib import Path

import redman
from redman._tool import tool_path


@unittest.skipIf(tool_path() is None, "there is no command-line tool")
class Sweep(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = Path(folder.name) / "sweep"

    def test_each_value_is_a_configuration_with_its_runs(self):
        def run():
            return redman.sweep("bandit", ["ppo_lag", "crpo"], seeds=2, steps=2000, out=self.out, envs=8, jobs=2,
                                options={"horizon": 16, "normalize_obs": False}, vary={"hidden": ["8", "16"]})
        done = run()
        self.assertEqual((done["runs"], done["done"], done["stopped"], done["failed"]), (8, 8, False, []))
        self.assertEqual([row["configuration"] for row in done["rows"]],
                         ["ppo_lag hidden=8", "ppo_lag hidden=16", "crpo hidden=8", "crpo hidden=16"])
        self.assertTrue(all(row["runs"] == 2 for row in done["rows"]))
        policy = next(self.out.rglob("policy.rdm"))
        before = policy.stat().st_mtime_ns
        self.assertEqual(run()["rows"], done["rows"])
        self.assertEqual(policy.stat().st_mtime_ns, before)

    def test_a_wrong_setting_is_told_before_anything_starts(self):
        with self.assertRaisesRegex(redman.ArgumentError, "clip"):
            redman.sweep("bandit", steps=2000, out=self.out, options={"clip": -1})
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    unittest.main()
