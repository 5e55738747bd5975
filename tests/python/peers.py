"""Copies of other projects that the adapters are tested with, where REDMAN_PEERS=DIR names a folder of them:

    DIR/gymnasium-VERSION/gymnasium       DIR/sb3-VERSION/stable_baselines3
    DIR/omnisafe/omnisafe                 DIR/safety-gymnasium/safety_gymnasium

each as its project publishes it. Nothing of theirs is kept here. What they import and these tests do not call may be
missing: `stand_in` puts an empty module in its place. OmniSafe and Stable-Baselines3 also need torch.
"""
import importlib.machinery
import importlib.util
import os
import subprocess
import sys
import types
import unittest
from pathlib import Path

UNUSED = ("farama_notifications", "gdown", "glfw", "moviepy", "mujoco", "pygame", "pytorch_lightning", "tensorboard",
          "wandb", "xmltodict")
# Where what is there cannot be imported: writers of a log that is not installed; tasks of another simulator.
REPLACED = ("torch.utils.tensorboard", "safety_gymnasium.tasks")


class _Empty(types.ModuleType):
    """A module in which every name is an empty class."""

    __path__ = []

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return type(name, (), {})


class _Finder:
    def __init__(self, names):
        self.names = names

    def find_spec(self, name, path=None, target=None):
        if any(name == stem or name.startswith(stem + ".") for stem in self.names):
            return importlib.machinery.ModuleSpec(name, self, is_package=True)
        return None

    def create_module(self, spec):
        module = _Empty(spec.name)
        if spec.name == "farama_notifications":
            module.notifications = {}
        return module

    def exec_module(self, module):
        pass


def stand_in():
    """Empty modules for what is not installed and not called."""
    if not any(isinstance(finder, _Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Finder(REPLACED))
        sys.meta_path.append(_Finder(UNUSED))


def copies(stem):
    """Folders of a project's copies, the newest version last."""
    root = os.environ.get("REDMAN_PEERS")
    found = [path for path in Path(root).glob(stem + "*") if path.is_dir()] if root else []
    return sorted(found, key=lambda path: [int(part) if part.isdigit() else 0 for part in
                                           path.name.rpartition("-")[2].split(".")])


def rerun(test, module, cases, *paths):
    """Runs test cases of a module in a process of its own that sees these folders."""
    here = Path(__file__).parent
    env = {**os.environ, "REDMAN_PEERS_INSIDE": "1",
           "PYTHONPATH": os.pathsep.join([*map(str, paths), str(here), *sys.path])}
    env.pop("REDMAN_PEERS", None)
    run = subprocess.run([sys.executable, "-m", "unittest", *(f"{module}.{case}" for case in cases)], env=env,
                         cwd=here, capture_output=True, text=True)
    test.assertEqual(run.returncode, 0, f"with {', '.join(p.name for p in paths)}:\n{run.stdout}{run.stderr}")
    test.assertRegex(run.stderr, r"Ran [1-9]")
    test.assertNotIn("skipped", run.stderr)


def installed(name):
    """Whether a module is there, and is no stub (stubs.py)."""
    spec = sys.modules[name].__spec__ if name in sys.modules else importlib.util.find_spec(name)
    return spec is not None


def needs(*names):
    """Skips a test where a module is not installed."""
    missing = [name for name in names if not installed(name)]
    return unittest.skipIf(missing, f"{', '.join(missing)}: not installed")
