"""redman.hub: cards say what is measured, and what is pushed is what is pulled; with a hub that is a folder."""
import json
import shutil
import sys
import tempfile
import types
import unittest
from pathlib import Path
from unittest import mock

import redman
from redman import hub

try:
    import yaml
except ImportError:
    yaml = None


class Hub(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = Path(cls.folder.name)
        cls.run_ = redman.train("ball_run", steps=3000, envs=8, max_steps=50, cost_limits=20, out=cls.path / "run", progress=False)

    def client(self):
        """A module huggingface_hub whose repositories are folders."""
        root, module = self.path / "hub", types.ModuleType("huggingface_hub")

        class HfApi:
            def __init__(self, token=None):
                assert token in (None, "secret")

            def create_repo(self, name, repo_type, private, exist_ok):
                assert repo_type == "model" and exist_ok
                (root / name).mkdir(parents=True, exist_ok=True)
                return f"https://a.hub/{name}"

            def upload_folder(self, repo_id, folder_path, commit_message):
                assert commit_message
                shutil.copytree(folder_path, root / repo_id, dirs_exist_ok=True)

        def snapshot_download(name, revision, token, allow_patterns):
            assert "checkpoint.rdm" not in allow_patterns
            return str(root / name)

        module.HfApi, module.snapshot_download = HfApi, snapshot_download
        return mock.patch.dict(sys.modules, huggingface_hub=module)

    def test_a_run_comes_back(self):
        with self.client():
            self.assertEqual(hub.push(self.path / "run", "anna/ball", token="secret"), "https://a.hub/anna/ball")
            files = sorted(path.name for path in (self.path / "hub/anna/ball").iterdir())
            self.assertEqual(files, ["README.md", "config.json", "policy.rdm", "progress.csv"])
            policy = hub.pull("anna/ball")
        self.assertIn('hub.pull("anna/ball")', (self.path / "hub/anna/ball/README.md").read_text(encoding="utf-8"))
        self.assertEqual(bytes(policy), bytes(self.run_.policy))
        self.assertEqual((policy.origin.task, dict(policy.origin.cost_limits)), ("ball_run", {"cost": 20.0}))
        again = redman.evaluate(policy)
        self.assertEqual((again.return_mean, again.cost_mean), (self.run_.judged().return_mean, self.run_.judged().cost_mean))

    def test_a_card_says_what_was_measured(self):
        judged = self.run_.judged()
        text = hub.card(self.run_)
        self.assertIn(f"| return | {judged.return_mean:.4g} +- {judged.return_stderr:.2g} |", text)
        self.assertIn(f"| cost `cost` | {judged.cost_mean[0]:.4g} +- {judged.cost_stderr[0]:.2g} | 20 |", text)
        self.assertIn("`ppo_lag`, seed 0, in", text)
        self.assertIn("| `max_steps` | `50` |", text)
        other = self.run_.evaluate(episodes=5, seed=3)
        self.assertIn("5 episodes by its mean action", hub.card(self.run_, other))
        # a bundled policy has no run
        bundled = hub.card(redman.Policy.trained("bandit"))
        self.assertIn("# bandit\n", bundled)
        self.assertIn("and decides every control step.", bundled)

    @unittest.skipUnless(yaml, "no yaml (apt-get install python3-yaml)")
    def test_the_head_is_yaml(self):
        head = yaml.safe_load(hub.card(self.run_).split("---\n")[1])
        self.assertEqual((head["library_name"], head["pipeline_tag"]), ("redman", "reinforcement-learning"))
        result, = head["model-index"][0]["results"]
        self.assertEqual(result["dataset"]["type"], "ball_run")
        self.assertEqual([metric["type"] for metric in result["metrics"]], ["mean_reward", *["mean_cost"] * 3, "success_rate"])

    def test_refusals_lose_nothing(self):
        with self.assertRaisesRegex(redman.StateError, "is there already"):
            hub.save(self.run_, self.path / "run")
        for name in ("ball", "anna/", "/ball", "a/b/c"):
            with self.assertRaisesRegex(redman.ArgumentError, "user/name"):
                hub.pull(name)
        with mock.patch.dict(sys.modules, huggingface_hub=None), self.assertRaisesRegex(redman.UnsupportedError, "pip install huggingface_hub"):
            hub.pull("anna/ball")
        with self.client():
            (self.path / "hub/anna/empty").mkdir(parents=True)
            with self.assertRaisesRegex(redman.FormatError, "no policy.rdm"):
                hub.pull("anna/empty")

    def test_code_is_imported_only_when_trusted(self):
        with self.client():
            hub.push(self.run_, "eve/ball")
            path = self.path / "hub/eve/ball/config.json"
            config = json.loads(path.read_text(encoding="utf-8"))
            path.write_text(json.dumps({**config, "own_reward": "antigravity:fly"}), encoding="utf-8")
            with self.assertRaisesRegex(redman.StateError, "own_reward.*imports=True"):
                hub.pull("eve/ball")
            self.assertNotIn("antigravity", sys.modules)
            path.write_text("[", encoding="utf-8")
            with self.assertRaises(redman.FormatError):
                hub.pull("eve/ball")


if __name__ == "__main__":
    unittest.main()
