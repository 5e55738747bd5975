#!/usr/bin/env python3
"""Writes redman/_abi.py from the public headers: constants, enums, structs, functions, shapes of rows, docstrings; and
redman/_import_abi.py from redman/import.h, which another library has.

    python3 generate_abi.py            writes both
    python3 generate_abi.py --check    ends with 1 and a word when a file is not what the headers say

It needs no compiler, for the headers are regular: one declaration is `RDM_API type rdm_name(...);`,
`typedef struct rdm_name { ... } rdm_name;` or `enum rdm_name { ... };`; a comment stands behind what it tells of, or
above a run of declarations; `[num_envs][obs_dim]` in it is the shape of a row, of a field or of an argument
that is named before it. What does not parse is an error here, not a function that is left out.
"""
from __future__ import annotations

import json
import re
import subprocess
import sys
import textwrap
from pathlib import Path
from typing import Iterator, NamedTuple

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
OUTPUT = HERE / "redman" / "_abi.py"
IMPORT_OUTPUT = HERE / "redman" / "_import_abi.py"

POSE = "rdm_pose"  # arrays of poses are rows of 7 doubles
SCALARS = {
    "float": "c_float", "double": "c_double", "size_t": "c_size_t", "rdm_result": "c_int32",
    **{f"{sign}int{bits}_t": f"c_{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}
DTYPES = {"float": "float32", "double": "float64", POSE: "float64", **{name: name[:-2] for name in SCALARS if name.endswith("_t")}}


class Declared(NamedTuple):
    """One declaration with the comment that tells of it."""

    kind: str  # constant, enum, struct, handle, callback, function
    name: str
    body: str  # value, list of members, fields, or parameters
    result: str  # type of a function's result
    doc: str
    experimental: bool
    above: str  # the comment above its run, which may tell of its arguments too


class Variable(NamedTuple):
    """A field or a parameter."""

    name: str
    type: str  # "const float *"
    length: str  # "3" of `float eye[3]`, else ""
    doc: str = ""

    @property
    def pointer(self) -> bool:
        return self.type.endswith("*")

    @property
    def base(self) -> str:
        return self.type.replace("const ", "").rstrip("* ")


COMMENT = r"/\*.*?\*/"
STATEMENT = re.compile(
    r"(?P<comment>" + COMMENT + r")"
    r"|^\#define[ ](?P<constant>RDM_\w+)[ ]+(?P<value>[^\n/]*)"
    r"|^(?P<directive>\#[^\n]*)"
    r"|(?:typedef[ ])?enum[ ]*(?P<enum>rdm_\w+)?[ ]*\{(?P<members>.*?)\}[^;{]*;"
    r"|typedef[ ]struct[ ](?P<struct>rdm_\w+)[ ]\{(?P<fields>.*?)^\}[ ]\w+;"
    r"|typedef[ ]struct[ ](?P<handle>rdm_\w+)[ ]\w+;"
    r"|typedef[ ](?P<returned>[\w ]+?[ *]+)\(\*(?P<callback>rdm_\w+)\)\((?P<given>[^)]*)\);"
    r"|typedef[ ]int32_t[ ]rdm_\w+;"
    r"|RDM_API[ ](?P<result>[\w ]+?[ *]+)(?P<function>rdm_\w+)\((?P<parameters>[^)]*)\);"
    r"|(?P<blank>\n[ \t]*(?=\n))|extern[ ]\"C\"[ ]\{|\}|\s+", re.S | re.M | re.X)


# kind: the groups of name, body and result
KINDS = {"constant": ("constant", "value", "blank"), "enum": ("enum", "members", "blank"),
         "struct": ("struct", "fields", "blank"), "handle": ("handle", "handle", "blank"),
         "callback": ("callback", "given", "returned"), "function": ("function", "parameters", "result")}


def text_of(comment: str) -> str:
    """The words of a C comment; "" for a heading or a rule of dashes."""
    body = re.sub(r"^/\*+<?|\*+/$", "", comment)
    if re.match(r"\s*(----|====)", body):
        return ""
    return "\n".join(re.sub(r"^\s*\*? ?", "", line).rstrip() for line in body.splitlines()).strip()


def declarations(text: str) -> Iterator[Declared]:
    """All declarations of a header in their order."""
    first_experimental = re.search(r"^/\* redman/\w+\.h: [^\n]* Experimental\.", text, re.M)
    experimental_from = first_experimental.start() if first_experimental else -1
    pending: Declared | None = None
    above = ""  # the comment above the run of declarations
    covering = covered = ""  # the same while it is what tells of them, and the kind of what it has told of
    at = end_of_last = 0
    while at < len(text):
        match = STATEMENT.match(text, at)
        if not match or match.end() == at:
            line = text.count("\n", 0, at) + 1
            raise SystemExit(f"headers, line {line}: not a declaration that this script knows: {text[at:at + 60]!r}")
        at = match.end()
        found = match.groupdict()
        if found["comment"]:
            behind = pending is not None and "\n" not in text[end_of_last:match.start()]
            if behind:
                assert pending is not None
                pending = pending._replace(doc=text_of(found["comment"]))
                covering = ""
            else:
                if pending:
                    yield pending
                    pending = None
                above = covering = text_of(found["comment"])
                covered = ""
            continue
        if match.lastgroup is None:
            continue
        if pending:
            yield pending
            pending = None
        if found["blank"] is not None or found["directive"]:
            above = covering = ""
            continue
        about = next((kind for kind, (_, body, _) in KINDS.items() if found[body] is not None), "")
        if not about:  # typedef int32_t rdm_result
            continue
        if covered not in ("", about):
            covering = ""  # it was of another kind of thing
        covered = about if covering else ""
        name, body, result = (found[part] or "" for part in KINDS[about])
        pending = Declared(about, name, body, result.strip(), covering,
                           0 <= experimental_from < match.start(), above)
        end_of_last = match.end()
    if pending:
        yield pending


def variables(text: str) -> list[Variable]:
    """Of `const char *a, *b` or `float size[3]`."""
    parts = [part.strip() for part in text.split(",")]
    first = re.match(r"((?:const )?\w+) ", parts[0])
    if not first:
        raise SystemExit(f"headers: not a declaration that this script knows: {text!r}")
    out = []
    for part in parts:
        part = part if part is parts[0] else f"{first.group(1)} {part}"
        match = re.fullmatch(r"((?:const )?\w+) ?(\**)(\w+)(?:\[(\w+)\])?", " ".join(part.split()))
        if not match:
            raise SystemExit(f"headers: not a declaration that this script knows: {part!r}")
        kind, stars, name, length = match.groups()
        out.append(Variable(name, f"{kind} {stars}".strip(), length or ""))
    return out


def parameters(text: str) -> list[Variable]:
    if text.strip() == "void":
        return []
    return [variables(part)[0] for part in text.split(",")]


FIELD = re.compile(r"(?P<comment>" + COMMENT + r")|(?P<field>[^;/]+);|\s+", re.S)


def fields(struct: Declared) -> list[tuple[Variable, str]]:
    """Each field with the prototype of a callback, "" for all others."""
    out: list[tuple[Variable, str]] = []
    fresh = 0  # fields that a comment behind tells of
    covering = ""
    end = 0
    for match in FIELD.finditer(struct.body):
        if match["comment"]:
            doc = text_of(match["comment"])
            if fresh and "\n" not in struct.body[end:match.start()]:
                out[-fresh:] = [(variable._replace(doc=doc), proto) for variable, proto in out[-fresh:]]
            else:
                covering = doc
            fresh = 0
        elif match["field"]:
            line = " ".join(match["field"].split())
            hook = re.fullmatch(r"(\w+ \*?)\(\*(\w+)\)\((.*)\)", line)
            if hook:
                new = [(Variable(hook[2], "", "", covering), f"{hook[1].strip()}({hook[3]})")]
            else:
                new = [(variable._replace(doc=covering), "") for variable in variables(line)]
            out += new
            fresh, end, covering = len(new), match.end(), ""
    return out


SHAPE = r"((?:\[[\w* +]+\])+)"


def shape(brackets: str) -> tuple[str, ...]:
    return tuple(re.findall(r"\[([^\]]*)\]", brackets))


def shape_of_field(variable: Variable) -> tuple[str, ...]:
    match = re.match(SHAPE, variable.doc)
    return shape(match[1]) if match else ()


def shape_of_argument(variable: Variable, doc: str) -> tuple[str, ...]:
    if variable.length:
        return (variable.length,)
    match = re.search(rf"\b{variable.name}\s?{SHAPE}", doc)
    dims = shape(match[1]) if match else ()
    return (*dims, "7") if variable.base == POSE else dims


def camel(name: str) -> str:
    """ "PoolStats" of rdm_pool_stats."""
    return "".join(word.capitalize() for word in name.removeprefix("rdm_").split("_"))


def members(declared: Declared) -> list[tuple[str, int, str]]:
    """(name, value, comment) of an enum."""
    out = []
    value = -1
    body = re.sub(r"^\s*" + COMMENT, "", declared.body, flags=re.S)
    for match in re.finditer(r"(RDM_\w+)(?: = (-?\w+))?(?:,|\s)*(" + COMMENT + ")?", body, re.S):
        value = int(match[2], 0) if match[2] else value + 1
        out.append((match[1], value, " ".join(text_of(match[3] or "").split())))
    return out


def prefix_of(names: list[str]) -> str:
    """What all names of an enum share, to an underscore."""
    shared = names[0]
    for name in names:
        while not name.startswith(shared):
            shared = shared[:-1]
    return shared[:shared.rindex("_") + 1]


def ctype(variable: Variable, structs: set[str], callbacks: set[str]) -> str:
    base, stars = variable.base, variable.type.count("*") + bool(variable.length)
    if base in callbacks:
        return base
    if stars == 0:
        return base if base in structs else SCALARS[base]
    if base == "char":
        return {1: "c_char_p" if variable.type.startswith("const") else "c_void_p", 2: "POINTER(c_char_p)"}[stars]
    if base in structs and base != POSE:
        return f"POINTER({base})" if stars == 1 else "c_void_p"
    return "c_void_p" if stars == 1 else "POINTER(c_void_p)"


def prototype(proto: str, structs: set[str], callbacks: set[str]) -> str:
    result, given = re.fullmatch(r"(.*?)\((.*)\)", proto).groups()  # type: ignore[union-attr]
    types = [ctype(v, structs, callbacks) for v in parameters(given)]
    return f"CFUNCTYPE({', '.join([result_type(result), *types])})"


def result_type(c: str) -> str:
    if c == "void":
        return "None"
    if c.endswith("*"):
        return "c_char_p" if "char" in c else "c_void_p"
    return SCALARS[c]


def wrapped(name: str, doc: str) -> list[str]:
    """The lines of a docstring for a member."""
    return textwrap.wrap(f"{name}: {' '.join(doc.split())}".rstrip(": "), 108, subsequent_indent="    ")


HINTS = {"c_float": "float", "c_double": "float", "c_char_p": "bytes | None", "c_void_p": "int | None"}


def quoted(text: str, indent: str) -> str:
    """A docstring."""
    text = text.replace("\\", "\\\\").replace('"""', "'''")
    lines = text.splitlines() or [""]
    body = f"\n{indent}".join(lines).replace(f"\n{indent}\n", "\n\n")
    return f'"""{body}{chr(10) + indent if len(lines) > 1 else ""}"""'


def rows_text(rows: dict[str, tuple[str, tuple[str, ...]]]) -> str:
    return "{" + ", ".join(f'"{name}": {row_text(*row)}' for name, row in rows.items()) + "}"


def row_text(dtype: str, dims: tuple[str, ...]) -> str:
    return f'Rows("{dtype}", ({", ".join(map(json.dumps, dims))}{"," if len(dims) == 1 else ""}))'


HEADER = '''\
"""The C ABI for ctypes. Written by generate_abi.py from include/redman: change the headers, not this file."""
from __future__ import annotations

import enum
from ctypes import (CDLL, CFUNCTYPE, POINTER, Structure, c_char_p, c_double, c_float, c_int8, c_int32, c_int64,
                    c_size_t, c_uint8, c_uint32, c_uint64, c_void_p)
from typing import Any, NamedTuple

from ._record import Members, Record


class Rows(NamedTuple):
    """What a pointer points at: the numpy type and the shape, its lengths by name."""

    dtype: str
    shape: tuple[str, ...]


class Function(NamedTuple):
    """A function of the library; rows are the arguments that are arrays."""

    result: Any
    arguments: dict[str, Any]
    rows: dict[str, Rows]
    experimental: bool
    doc: str


'''


IMPORT_HEADER = '''\
"""The importer's C ABI for ctypes. Written by generate_abi.py from redman/import.h: change the header, not this file."""
from __future__ import annotations

import enum
from ctypes import (CDLL, POINTER, Structure, c_char_p, c_double, c_int32, c_size_t, c_uint32, c_void_p)

from ._abi import Function, Rows, rdm_object_def, rdm_robot_def
from ._record import Members, Record


'''


def import_header() -> str:
    """The text of the header of libredman_import."""
    return (ROOT / "include" / "redman" / "import.h").read_text(encoding="utf-8")


def headers() -> str:
    """The text of the public headers of libredman, as redman.h includes them: the stable ones first."""
    command = ["sh", str(ROOT / "cmake" / "headers.sh"), str(ROOT / "include")]
    listed = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    return "\n".join(Path(name).read_text(encoding="utf-8") for name in listed.split("\n")[:-1])


def generate(text: str) -> str:
    """The module for the text of the headers."""
    found = list(declarations(text))
    out = [HEADER]
    for d in found:
        if d.kind == "constant" and d.body.strip().isdecimal():
            out.append(f"{d.name} = {d.body.strip()}{'  # ' + ' '.join(d.doc.split()) if d.doc else ''}\n")
    numbers = [next(d.body for d in found if d.name == f"RDM_VERSION_{part}") for part in ("MAJOR", "MINOR", "PATCH")]
    out.append("RDM_VERSION = RDM_VERSION_MAJOR * 1000000 + RDM_VERSION_MINOR * 1000 + RDM_VERSION_PATCH\n"
               f'VERSION = "{".".join(number.strip() for number in numbers)}"  # that these types are of\n\n\n')
    return "".join(out) + types_text(found, found)


def generate_import(text: str, base: str) -> str:
    """The module for the text of the importer's header, whose types are also those of the base headers."""
    found = list(declarations(text))
    return IMPORT_HEADER + types_text(found, [*declarations(base), *found])


# What the texts of records and enums, which users of Python read, call the functions and structs of C.
WORDS = {
    "rdm_pool_step": "Pool.step", "rdm_pool_field_at": "Pool.fields", "rdm_pool_shape_at": "Pool.shapes",
    "rdm_task_at and the like": "Task.number", "rdm_task_field_at": "Task.fields", "rdm_task_option_at": "Task.options",
    "rdm_task_camera_at": "Task.cameras", "rdm_task_default_at": "Task.defaults", "rdm_algo_option_at": "Algo.options",
    "rdm_policy_act_points": "Policy.act", "rdm_policy_act_points_state": "Policy.act", "rdm_policy_act_state": "Policy.act",
    "rdm_policy_novelty": "Policy.novelty", "rdm_policy_field_at": "Policy.fields",
    "rdm_agent_pretrain": "Agent.pretrain", "rdm_agent_clone": "Agent.clone", "rdm_agent_learn": "Agent.learn_from", "rdm_agent_rollout": "Agent.rollout",
    "rdm_agent_set_option": "Agent.set", "rdm_planner_act": "Planner.act", "rdm_import_check": "load_robot(check=True)",
    "rdm_object_create": "Object.create", "rdm_shape_info": "Shape", "rdm_buffers.status": "Pool.status",
    "rdm_result": "Error.code", "RDM_ABI of": "the number of the ABI of"}


def python_words(found: list[Declared]) -> dict[str, str]:
    """The same, and of each enumerator."""
    out = dict(WORDS)
    for d in found:
        if d.kind == "enum":
            names = [name for name, _, _ in members(d)]
            prefix = prefix_of(names)
            out[f"{prefix}*"] = camel(d.name)
            out.update((name, f"{camel(d.name)}.{name.removeprefix(prefix)}") for name in names)
    return out


def told(text: str, words: dict[str, str]) -> str:
    """A text in the words of Python."""
    longest = sorted(words, key=len, reverse=True)
    return re.sub("|".join(rf"(?<!\w){re.escape(word)}(?!\w)" for word in longest), lambda found: words[found[0]], text)


def types_text(found: list[Declared], known: list[Declared]) -> str:
    """Enums, structs and functions that were found; known: whose types they may have."""
    structs = {d.name for d in known if d.kind == "struct"}
    callbacks = {d.name for d in known if d.kind == "callback"}
    words = python_words(known)
    out = []
    for d in found:
        if d.kind != "enum":
            continue
        if not d.name:
            raise SystemExit(f"headers: an enum without a name: {d.body[:60]!r}")
        rows = members(d)
        prefix = prefix_of([name for name, _, _ in rows])
        if d.name == "rdm_result_code":  # RDM_OK is none of RDM_ERROR_*
            rows = [(name.replace("RDM_ERROR_", prefix), value, doc) for name, value, doc in rows]
        flags = len(rows) > 1 and all(value > 0 and value & (value - 1) == 0 for _, value, _ in rows)
        about = text_of(match[0].strip()) if (match := re.match(r"\s*" + COMMENT, d.body, re.S)) else d.doc
        lines = [told(about, words) or d.name, ""]
        for name, value, doc in rows:
            lines += wrapped(f"{name.removeprefix(prefix)} = {value}", told(doc, words))
        out.append(f"class {camel(d.name)}(enum.{'IntFlag' if flags else 'IntEnum'}, metaclass=Members):\n"
                   f"    {quoted(chr(10).join(lines), '    ')}\n\n")
        out += [f"    {name.removeprefix(prefix)} = {value}\n" for name, value, _ in rows]
        out.append("\n\n")
    for d in found:
        if d.kind == "callback":
            out.append(f"{d.name} = {prototype(f'{d.result}({d.body})', structs, callbacks)}\n\n\n")
        elif d.kind == "struct":
            out.append(struct_text(d, structs, callbacks, words))
    out.append("STRUCTS: dict[str, type[Structure]] = {\n")
    out += [f'    "{d.name}": {d.name},\n' for d in found if d.kind == "struct"]
    out.append("}\n\n# The rows that fields of structs point at.\nROWS: dict[str, dict[str, Rows]] = {\n")
    for d in found:
        if d.kind == "struct":
            rows_of = {v.name: (DTYPES[v.base], shape_of_field(v)) for v, proto in fields(d)
                       if not proto and v.pointer and shape_of_field(v) and v.base in DTYPES}
            if rows_of:
                inner = ",\n        ".join(f'"{name}": {row_text(*row)}' for name, row in rows_of.items())
                out.append(f'    "{d.name}": {{\n        {inner},\n    }},\n')
    out.append("}\n\nFUNCTIONS: dict[str, Function] = {\n")
    for d in found:
        if d.kind != "function":
            continue
        given = parameters(d.body)
        arguments = ", ".join(f'"{v.name}": {ctype(v, structs, callbacks)}' for v in given)
        said = f"{d.doc}\n{d.above}"
        shaped = {v.name: (DTYPES[v.base], shape_of_argument(v, said)) for v in given
                  if (v.pointer or v.length) and v.base in DTYPES and shape_of_argument(v, said)}
        out.append(f'    "{d.name}": Function(\n        {result_type(d.result)}, {{{arguments}}},\n'
                   f'        {rows_text(shaped)}, {d.experimental},\n        {quoted(d.doc, " " * 8)}),\n')
    out.append('''}


def declare(library: CDLL) -> None:
    """Gives each function of the loaded library its types."""
    for name, function in FUNCTIONS.items():
        symbol = getattr(library, name)
        symbol.restype = function.result
        symbol.argtypes = list(function.arguments.values())
''')
    return "".join(out)


def about_struct(d: Declared) -> str:
    """What is said behind the brace of a struct, or above it."""
    inside = re.match(r"[ \t]*(" + COMMENT + ")", d.body, re.S)
    return text_of(inside[1]) if inside else d.doc


def struct_text(d: Declared, structs: set[str], callbacks: set[str], words: dict[str, str]) -> str:
    listed, hints = [], []
    about = [about_struct(d), ""] if about_struct(d) else []
    for variable, proto in fields(d):
        if proto:
            kind, hint = prototype(proto, structs, callbacks), "Any"
        elif variable.length:
            element = SCALARS[variable.base]
            kind = f"{element} * {variable.length}"
            hint = "Any"
        else:
            kind = ctype(variable, structs, callbacks)
            hint = HINTS.get(kind, kind if kind in structs else "Any" if kind.startswith("POINTER") or kind in callbacks else "int")
        listed.append(f'        ("{variable.name}", {kind}),\n')
        hints.append(f"    {variable.name}: {hint}\n")
        about += wrapped(variable.name, variable.doc)
    doc = quoted("\n".join(about), "    ")
    return (f"{record_text(d, words)}class {d.name}(Structure):\n    {doc}\n\n{''.join(hints)}"
            f"    _fields_ = [\n{''.join(listed)}    ]\n\n\n")


RECORD_HINTS = {"c_float": "float", "c_double": "float"}


def record_text(d: Declared, words: dict[str, str]) -> str:
    """The Record of a struct that holds values alone, "" for one with pointers or structs in it."""
    lines = []
    about = [told(about_struct(d), words) or f"The values of {d.name}.", ""]
    for variable, proto in fields(d):
        if proto or (variable.pointer and variable.type != "const char *") or variable.base not in (*SCALARS, "char"):
            return ""
        if variable.name == "struct_size" or variable.name.startswith("reserved"):
            continue
        hint = "str" if variable.base == "char" else RECORD_HINTS.get(SCALARS[variable.base], "int")
        hint = f"tuple[{hint}, ...]" if variable.length else hint
        hint += " | None" if "NULL" in variable.doc and hint == "str" else ""
        about += wrapped(variable.name, told(variable.doc, words))
        lines.append(f"    {variable.name}: {hint}\n")
    doc = quoted("\n".join(about), "    ")
    return f"class {camel(d.name)}(Record):\n    {doc}\n\n{''.join(lines)}\n\n"


def main() -> int:
    texts = {OUTPUT: generate(headers()), IMPORT_OUTPUT: generate_import(import_header(), headers())}
    if "--check" in sys.argv[1:]:
        old = [path for path, text in texts.items() if not path.exists() or path.read_text(encoding="utf-8") != text]
        for path in old:
            print(f"{path.name} is not what the headers say: run {Path(__file__).name}", file=sys.stderr)
        return 1 if old else 0
    for path, text in texts.items():
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
