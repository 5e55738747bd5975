"""Every function of the headers is called by a name that a user of the Python package has, or there is a reason why not; and
every public name says what it is.

    python3 test_python_coverage.py --table     the functions, and the name that calls each
"""
import ast
import contextlib
import dataclasses
import enum
import fnmatch
import importlib
import inspect
import io
import operator
import pydoc
import re
import sys
import textwrap
import unittest
from collections import defaultdict, deque
from pathlib import Path

import numpy as np

import peers
import redman
import stubs
from redman import _abi, _import_abi
from redman._record import Record

PACKAGE = Path(redman.__file__).parent
ADAPTERS = ("data", "gym", "omnisafe", "pettingzoo", "safety", "sb3", "stats")
FUNCTIONS = {*_abi.FUNCTIONS, *_import_abi.FUNCTIONS}

MANY = "Worlds has it for many worlds at once"
HOST = "memory and threads of a host without a heap or with its own; Python has neither"
HANDLE_TEXT = "the exception of the call has the text"
# A name or a pattern: why no name of Python calls it. A row that nothing needs is a failure.
REASONS = {
    "rdm_*_error": HANDLE_TEXT, "rdm_result_string": "exceptions have classes, and redman.ResultCode names codes",
    "rdm_init": HOST, "rdm_shutdown": HOST, "rdm_pool_create_in": HOST, "rdm_policy_read_in": HOST, "rdm_policy_read_memory": HOST,
    "rdm_actor_config_memory": HOST, "rdm_version": "redman.version", "rdm_policy_update_from":
    "a Policy of Python is immutable and shared by threads: agent.policy() is a new one",
    "rdm_policy_read_file": "Policy.load reads the file itself", "rdm_agent_write_policy_file": "agent.policy().save(path)",
    "rdm_pool_get_buffers": "rows are arrays of numpy, which the pool is given (rdm_pool_set_buffers)",
    "rdm_pool_render": "Pool.render, by rdm_pool_draw",
    "rdm_pool_setting_at": "pool.options has all, by rdm_pool_get_settings",
    "rdm_agent_setting_at": "agent.options has all, by rdm_agent_get_settings",
    "rdm_fail": "a function of redman.Task raises", "rdm_random_bits": "Worlds.uniform draws", "rdm_random_split": "Task.draws", "rdm_scene_get_[rt]*": "SceneBuilder.option", "rdm_rotation": "numpy turns",
    "rdm_scene_set_actions": "the class has action_dim, hold and mean", "rdm_scene_user": "self is the task's own",
    "rdm_world_user": "self is the task's own", "rdm_world_get_[blst]*": MANY, "rdm_world_push_*": MANY, "rdm_world_set_[bcjt]*": MANY,
    "rdm_world_set_feedforward": MANY,
}


class Definition:
    """A function, a method, a value of a module, or what a module does when it is imported: the functions of C that it calls,
    and the names that it uses."""

    def __init__(self, module, owner=""):
        self.module, self.owner = module, owner  # owner: its class
        self.calls, self.names, self.own, self.attributes = set(), set(), set(), set()


class Package:
    """The definitions of modules, given as {name: source}, and who uses whom."""

    def __init__(self, code, functions):
        self.functions = functions
        self.definitions = {}  # (module, "function" or "Class.method")
        self.imported = defaultdict(dict)  # of a module: local name -> (module, name)
        self.bases = defaultdict(list)  # (module, class) -> names
        self.methods = defaultdict(list)  # by name, of all classes
        for module, source in code.items():
            self._read(module, ast.parse(source))

    def _read(self, module, tree):
        top = self.definitions[module, "<import>"] = Definition(module)
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.level > 0:  # of this package; others may have its modules' names
                for alias in node.names:
                    self.imported[module][alias.asname or alias.name] = (node.module or alias.name, alias.name)
        for node in tree.body:
            if isinstance(node, ast.ClassDef):
                self.bases[module, node.name] = [ast.unparse(base) for base in node.bases]
                for part in node.body:
                    if isinstance(part, ast.FunctionDef):
                        own = self.definitions.setdefault((module, f"{node.name}.{part.name}"), Definition(module, node.name))
                        self.methods[part.name].append(own)
                        self._use(part, own)
            elif isinstance(node, ast.FunctionDef):
                self._use(node, self.definitions.setdefault((module, node.name), Definition(module)))
            elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                self._use(node.value, self.definitions.setdefault((module, node.targets[0].id), Definition(module)))
                self._use(node.value, top)
            else:
                self._use(node, top)

    def _use(self, tree, inside):
        for node in ast.walk(tree):
            if isinstance(node, ast.Attribute):
                owner = node.value.id if isinstance(node.value, ast.Name) else ""
                if node.attr in self.functions and owner not in ("_abi", "_import_abi"):
                    inside.calls.add(node.attr)
                (inside.own if owner in ("self", "cls") else inside.attributes).add(node.attr)
            elif isinstance(node, ast.Name):
                inside.names.add(node.id)
            elif isinstance(node, ast.Subscript) and ast.unparse(node.value) == "lib" and isinstance(node.slice, ast.Constant):
                inside.calls.add(node.slice.value)
            elif isinstance(node, ast.Call) and ast.unparse(node.func) == "_read" and isinstance(node.args[0], ast.Constant):
                inside.calls.add(node.args[0].value)

    def members(self, module, owner):
        """The methods of a class by name, and of those that it is made of."""
        out = {}
        for base in self.bases.get((module, owner), ()):
            out.update(self.members(*self.imported[module].get(base, (module, base))))
        prefix = f"{owner}."
        out.update((name[len(prefix):], own) for (where, name), own in self.definitions.items()
                   if where == module and name.startswith(prefix))
        return out

    def _used(self, definition):
        module = definition.module
        for name in definition.names:
            where, own = self.imported[module].get(name, (module, name))
            if (where, own) in self.definitions:
                yield self.definitions[where, own]
            if (where, own) in self.bases:  # of an object that it makes, what a user may call
                yield from (of for part, of in self.members(where, own).items() if is_public(part))
        if definition.owner:
            known = self._kin(module, definition.owner)
            for name in definition.own:
                yield from known.get(name, ())
        for name in definition.attributes:
            yield from self.methods[name]
            for where, own in self.imported[module].values():  # _discovery.task_at
                if (own, name) in self.definitions:
                    yield self.definitions[own, name]

    def _kin(self, module, owner):
        """The methods that self.name may be: of the class, and of those that are made of it."""
        out = defaultdict(list)
        for (where, name) in [(module, owner), *(k for k in self.bases if owner in self.bases[k])]:
            for part, of in self.members(where, name).items():
                out[part].append(of)
        return out

    def reached(self, public):
        """Function of C -> the public name by the shortest way; public: {name: definition}."""
        out, seen = {}, set()
        queue = deque(public.items())
        while queue:
            name, definition = queue.popleft()
            if id(definition) not in seen:
                seen.add(id(definition))
                for call in sorted(definition.calls):
                    out.setdefault(call, name)
                queue.extend((name, other) for other in self._used(definition))
        return out


def is_public(name):
    return not name.startswith("_") or name.startswith("__")


def public_of(package, names, modules):
    """The definitions that a user can name: functions, methods and properties, and what an import does."""
    out = {}
    for module, name in [*package.definitions, *package.bases]:
        shown = f"redman.{name}" if name in names else f"redman.{module}.{name}" if module in modules else ""
        if not shown or not is_public(name) or "." in name:
            continue
        if (module, name) in package.bases:
            out.update((f"{shown}.{part}".replace(".__init__", ""), own)
                       for part, own in package.members(module, name).items() if is_public(part))
        else:
            out[shown] = package.definitions[module, name]
    out["import redman"] = package.definitions["_library", "<import>"]
    return out


def sources():
    return {path.stem: path.read_text() for path in sorted(PACKAGE.glob("*.py")) if not path.stem.endswith("_abi")}


def covered(code, functions=FUNCTIONS, names=redman.__all__):
    package = Package(code, functions)
    return package.reached(public_of(package, names, ADAPTERS))


def reason_of(function):
    return next((reason for pattern, reason in REASONS.items() if fnmatch.fnmatch(function, pattern)), None)


class Coverage(unittest.TestCase):
    def test_every_function_has_a_name_or_a_reason(self):
        names = covered(sources())
        self.assertEqual([f for f in sorted(FUNCTIONS) if f not in names and reason_of(f) is None], [])

    def test_no_reason_is_left_of_what_has_a_name(self):
        names = covered(sources())
        idle = [pattern for pattern in REASONS if all(f in names for f in FUNCTIONS if fnmatch.fnmatch(f, pattern))]
        self.assertEqual(idle, [], "these have names now: take their reasons out")

    def test_a_function_that_nobody_or_only_dead_code_calls_is_found(self):
        code = {"_library": "", "_a": "def f():\n    _g()\n\ndef _g():\n    lib.rdm_called()\n\ndef _dead():\n    lib.rdm_dead()\n"
                                      "class P:\n    def act(self):\n        self._own()\n    def _own(self):\n        lib['rdm_own']()\n"
                                      "    def _lost(self):\n        lib.rdm_lost()\n"}
        names = covered(code, {"rdm_called", "rdm_dead", "rdm_own", "rdm_lost"}, ["f", "P"])
        self.assertEqual(names, {"rdm_called": "redman.f", "rdm_own": "redman.P.act"})

    def test_every_name_that_is_said_to_call_one_is_there(self):
        for name in set(covered(sources()).values()) - {"import redman"}:
            thing = redman
            for part in name.split(".")[1:]:
                thing = getattr(thing, part)


MADE_FOR_USERS = ("Run", "SceneBuilder", "Sensors", "Window", "Worlds")  # users do not call these


def untold_of(name, function, of_class=""):
    """The arguments that no text has a word of."""
    text = f"{inspect.getdoc(function) or ''} {of_class}"
    return [f"{name}: {argument.name}" for argument in inspect.signature(function).parameters.values()
            if argument.name != "self" and argument.name[0] != "_" and argument.kind not in (argument.VAR_KEYWORD, argument.VAR_POSITIONAL)
            and not re.search(rf"\b{argument.name}\b", text)]


class Manual(unittest.TestCase):
    def test_the_overview_has_every_public_name_and_no_other(self):
        text = redman.__doc__.split("of them.\n")[1].split("\nArrays")[0]
        listed = re.findall(r"(?<![\w.])[A-Za-z_]\w*(?:\.\w+)?", re.sub(r"^    (?:what exists|your own|the library|\w+)  +", "", text, flags=re.M))
        known = {name for name in redman.__all__ if name != "__version__"}
        self.assertEqual(sorted(known - set(listed)), [])
        odd = {name for name in listed if re.match(r"[A-Z]\w+$", name)} - known
        self.assertEqual(odd, set())

    def test_help_begins_with_the_groups(self):
        text = pydoc.plain(pydoc.render_doc(redman))
        self.assertLess(text.index("These are the public names"), text.index("PACKAGE CONTENTS"))
        self.assertNotIn("redman._", text.split("PACKAGE CONTENTS")[0])

    def test_every_public_name_says_what_it_is(self):
        bare = []
        for name in redman.__all__:
            thing = getattr(redman, name)
            if not isinstance(thing, type) and not inspect.isfunction(thing):
                continue
            if not (thing.__doc__ or "").strip() or thing.__doc__.startswith(f"{name}("):
                bare.append(name)
            if isinstance(thing, type) and not issubclass(thing, (enum.Enum, Exception)):
                for part, member in vars(thing).items():
                    told = getattr(member, "__doc__", None)
                    if not part.startswith("_") and (callable(member) or isinstance(member, property)) and not told:
                        bare.append(f"{name}.{part}")
        self.assertEqual(bare, [])

    def test_every_argument_has_a_word_in_the_text_of_its_function_or_class(self):
        untold = []
        for name in (*redman.__all__, *(f"stats.{own}" for own in redman.stats.__all__)):
            thing = operator.attrgetter(name)(redman)
            if inspect.isfunction(thing):
                untold += untold_of(name, thing)
            elif isinstance(thing, type) and not issubclass(thing, (enum.Enum, Exception, tuple)) and not dataclasses.is_dataclass(thing):
                of_class = " ".join(kind.__doc__ or "" for kind in thing.__mro__ if kind.__module__.startswith("redman"))
                for part, member in inspect.getmembers(thing):
                    if inspect.isroutine(member) and str(getattr(member, "__module__", "")).startswith("redman") and \
                            (part[0] != "_" or part == "__init__" and name not in MADE_FOR_USERS and not issubclass(thing, Record)):
                        untold += untold_of(f"{name}.{part}", member, of_class)
        self.assertEqual(untold, [])

    def test_they_say_it_in_the_words_of_python(self):
        for name in redman.__all__:
            thing = getattr(redman, name)
            members = vars(thing).values() if isinstance(thing, type) and not issubclass(thing, enum.Enum) else ()
            for told in (thing, *members):
                text = re.sub(r"rdm_(robot|object|task)_def\b", "", str(getattr(told, "__doc__", None)))  # the keywords of create
                self.assertNotRegex(text, r"(?i)\brdm_", name)

    def test_records_tell_their_members(self):
        for kind in (redman.Spec, redman.PolicyInfo, redman.RecordingInfo, redman.PoolStats, redman.ShieldStats):
            for member in kind.__annotations__:
                self.assertRegex(kind.__doc__, rf"(?m)^ *{member}\b", kind)

    def test_public_things_are_of_the_package(self):
        for name in redman.__all__:
            module = getattr(getattr(redman, name), "__module__", "redman")
            self.assertIn(module, ("redman", "typing"), name)


class Adapters(unittest.TestCase):
    """The adapters' texts: a stranger learns every argument from them, and what they show works, with stubs of the peers too."""

    @classmethod
    def setUpClass(cls):
        cls.modules = {name: importlib.import_module(f"redman.{name}") for name in ("gym", "pettingzoo")}  # work without peers
        peers.stand_in()
        stubs.safety(), stubs.sb3(), stubs.omnisafe()
        cls.modules.update((name, importlib.import_module(f"redman.{name}")) for name in ("safety", "sb3", "omnisafe"))

    def things(self):
        """Public classes and functions by their names."""
        for module, names in self.modules.items():
            for name in names.__all__:
                if callable(getattr(names, name)):
                    yield f"{module}.{name}", getattr(names, name)

    def test_every_argument_has_a_word(self):
        untold = []
        for name, thing in self.things():
            if inspect.isfunction(thing):
                untold += untold_of(name, thing)
                continue
            untold += untold_of(f"{name}()", thing)
            for part, member in vars(thing).items():
                if part[0] != "_" and (inspect.isfunction(member) or isinstance(member, (property, staticmethod))):
                    self.assertTrue(inspect.getdoc(member), f"{name}.{part}")
                    untold += untold_of(f"{name}.{part}", member) if inspect.isfunction(member) else []
        self.assertEqual(untold, [])

    def test_each_has_an_example_that_works(self):
        for name, thing in self.things():
            shown = re.findall(r"(?m)^\n((?:    .*\n)+)", inspect.getdoc(thing) + "\n")
            with self.subTest(name):
                self.assertTrue(shown, "there is none")
                for lines in map(textwrap.dedent, shown):
                    code = compile(lines, name, "exec")
                    missing = "register" in name and not peers.installed("gymnasium") or "ppo_kwargs" in name and not peers.installed("torch")
                    if not missing:
                        with contextlib.redirect_stdout(io.StringIO()):
                            exec(code, {"redman": redman, "np": np, "torch": sys.modules.get("torch")})


def table():
    names = covered(sources())
    for function in sorted(FUNCTIONS):
        print(f"{function:36} {names.get(function) or '- ' + str(reason_of(function))}")
    print(f"{len(FUNCTIONS)} functions: {len(names)} have a name, {len(FUNCTIONS) - len(names)} not, "
          f"{sum(f not in names and reason_of(f) is None for f in FUNCTIONS)} of these without a reason")


if __name__ == "__main__":
    if "--table" in sys.argv[1:]:
        table()
    else:
        unittest.main()
