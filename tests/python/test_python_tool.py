"""The commands `redman` and `python -m redman`: which tool they become, and how. That of a wheel is in packages/wheel.sh."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from redman._library import lib

SCRIPT = f"#!{sys.executable}\nfrom redman._tool import main\nmain()\n"  # as pip writes it
TOOL = "#!/bin/sh\necho \"tool $*\"\nexit 7\n"


class Command(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.library = self.folder / "lib" / Path(lib._name).name
        self.library.parent.mkdir()
        self.library.symlink_to(Path(lib._name).absolute())

    def put(self, place, text):
        path = self.folder / place / "redman"
        path.parent.mkdir(parents=True)
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)
        return path

    def run_it(self, *arguments, command=(sys.executable, "-m", "redman"), **environment):
        path = os.pathsep.join(str(self.folder / place) for place in ("scripts", "programs"))
        told = {**os.environ, "REDMAN_LIBRARY": str(self.library), "PATH": path, **environment}
        return subprocess.run([*command, *arguments], env=told, capture_output=True, text=True, timeout=60)

    def test_it_has_the_words_and_the_status_of_the_tool_beside_the_library(self):
        self.put("lib/bin", TOOL)
        self.put("programs", "#!/bin/sh\nexit 3\n")
        done = self.run_it("eval", "a b", "--json")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (7, "tool eval a b --json\n", ""))

    def test_its_script_on_path_is_not_the_tool(self):
        script = self.put("scripts", SCRIPT)
        done = self.run_it("x", command=[str(script)], REDMAN_TOOL=str(script))
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, "^redman: there is no command-line tool")
        self.put("programs", TOOL)
        done = self.run_it("x", command=[str(script)], REDMAN_TOOL=str(script))
        self.assertEqual((done.returncode, done.stdout), (7, "tool x\n"))

    def test_what_needs_the_tool_says_so(self):
        self.put("scripts", SCRIPT)
        done = self.run_it(command=[sys.executable, "-c", "import redman\nredman.Policy.trained('bandit').export('p.onnx')"],
                           REDMAN_TOOL="")
        self.assertRegex(done.stderr, "UnsupportedError: a .onnx file needs the command redman, which was not found")

    def test_a_variable_that_names_no_program_is_told(self):
        calls = ("redman.Policy.trained('bandit').export('p.onnx')", "redman.sweep('bandit', steps=8, out='x')", "redman.view('bandit')",
                 "redman.Policy.trained('bandit').episode('bandit')._repr_html_()", "redman.train('jenga', steps=8, from_='demo')")
        for named, said in ((self.folder / "gone", "MissingFileError REDMAN_TOOL: .*gone: there is no such file"),
                            (Path(__file__), "FileError REDMAN_TOOL: .*test_python_tool.py: it is not a program")):
            lines = "".join(f"try: {call}\nexcept redman.Error as error: print(type(error).__name__, error)\n" for call in calls)
            done = self.run_it(command=[sys.executable, "-c", f"import redman\n{lines}"], REDMAN_TOOL=str(named))
            self.assertRegex(done.stdout, f"^({said}.*\n){{{len(calls)}}}$", done.stderr)


if __name__ == "__main__":
    unittest.main()
