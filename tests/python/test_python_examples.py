"""Programs of examples/python: each runs with few steps and without a warning, is as short and as public as its page says, and
ends with 77 and a sentence where its library is not installed."""
import ast
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

FOLDER = Path(__file__).resolve().parents[2] / "examples" / "python"
STEPS = {"01": 20, "02": 3000, "03": 6400, "04": 4096, "05": 4000, "06": 4000, "07": 20, "08": 10000, "09": 5, "10": 16,
         "11": 2000, "12": 3}
NEEDS = {"04": "torch", "05": "Stable-Baselines3", "06": "OmniSafe", "07": "Gymnasium"}


class Examples(unittest.TestCase):
    def test_each_runs(self):
        skipped = []
        for path in sorted(FOLDER.glob("*.py")):
            number = path.name[:2]
            with self.subTest(path.name):
                with tempfile.TemporaryDirectory() as folder:
                    run = subprocess.run([sys.executable, path.name, str(STEPS[number])], cwd=FOLDER, capture_output=True,
                                         text=True, timeout=300, env={**os.environ, "TMPDIR": folder})
                if run.returncode == 77 and number in NEEDS:
                    self.assertRegex(run.stdout, f"^This example needs {NEEDS[number]}: pip install ")
                    skipped.append(f"{path.name} ({NEEDS[number]})")
                    continue
                self.assertEqual(run.returncode, 0, run.stdout + run.stderr)
                self.assertNotIn("HoldWarning", run.stderr)
                self.assertGreaterEqual(len(run.stdout.splitlines()), 2)
        if skipped:
            print("not installed:", ", ".join(skipped))

    def test_what_a_reader_may_expect(self):
        page = (FOLDER / "README.md").read_text(encoding="utf-8")
        names = sorted(path.name for path in FOLDER.glob("*.py"))
        self.assertEqual(sorted(STEPS), [name[:2] for name in names])
        self.assertEqual(sorted(set(re.findall(r"\]\((\d\d_\w+\.py)\)", page))), names)
        for name in names:
            text = (FOLDER / name).read_text(encoding="utf-8")
            with self.subTest(name):
                self.assertLess(len(text.splitlines()), 60)
                self.assertLessEqual(max(map(len, text.splitlines())), 130)
                self.assertIn(f"python3 {name} [steps]", ast.get_docstring(ast.parse(text)) or "")
                private = [node.attr for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Attribute)
                           and node.attr.startswith("_")]
                self.assertEqual(private, [])


class OwnTask(unittest.TestCase):
    def test_the_task_in_python_is_learned_as_the_one_in_c(self):
        """08_own_task.py prints the lines of 07_own_task, which is built beside the tool."""
        program = Path(os.environ.get("REDMAN_TOOL") or "none").with_name("07_own_task")
        if not program.exists():
            self.skipTest("07_own_task is not built")
        lines = [subprocess.run(command, cwd=FOLDER, capture_output=True, text=True, check=True).stdout for command in
                 ([sys.executable, "08_own_task.py", "20000"], [str(program), "3"])]
        self.assertEqual(*lines)
        self.assertEqual(len(lines[0].splitlines()), 3)


if __name__ == "__main__":
    unittest.main()
