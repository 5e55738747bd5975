#!/usr/bin/env python3
"""The public headers say of every pointer what it is, in the form that generators of bindings read.

Arguments: the project's root. Prints what is missing; the exit status is 0 when nothing is.
The rules are those of "How to read the declarations" at the top of redman.h.
"""
import pathlib
import re
import subprocess
import sys

HANDLES = {"rdm_pool", "rdm_agent", "rdm_policy", "rdm_actor", "rdm_recording", "rdm_planner", "rdm_shield", "rdm_map", "rdm_scene", "rdm_world"}
INTEGERS = {"int32_t", "uint32_t", "int64_t", "uint64_t", "size_t"}
LENGTHS = {"capacity", "scratch_bytes", "note_size", "num_skip", "wanted", "error_size"}  # arguments that say how long another is
NOT_COUNTED = {"rows", "w", "h"}  # lengths that are int32_t: of rows and pictures
WIDTH = 100  # columns of the headers
SHAPE = r"((?:\[[^\]\[]+\])+)"
WORD = re.compile(r"[A-Za-z_]\w*")


def flat(comment):
    """A comment's words in one line."""
    return " ".join(" ".join(re.sub(r"^\s*\*", " ", line) for line in comment.splitlines()).split())


class Header:
    def __init__(self, text):
        text = text.replace("\r", "")
        self.macros = set(re.findall(r"^#define (RDM_\w+)", text, re.M))
        self.enums = re.findall(r"\benum\s*(\w*)\s*\{(.*?)\}", re.sub(r"/\*.*?\*/", "", text, flags=re.S), re.S)
        self.structs = {}  # name: [(declaration, comment)]
        for name, body in re.findall(r"^typedef struct (rdm_\w+) \{(.*?)^\} \1;", text, re.M | re.S):
            self.structs[name] = self.members(body)
        self.member_names = {self.name_of(d) for members in self.structs.values() for d, _ in members}
        self.functions = self.find_functions(text)

    @staticmethod
    def members(body):
        """Declarations with the comment behind each; one above belongs to none."""
        out = []
        for line in re.finditer(r"^ +([^/\n*][^;\n]*);[ ]*(?:/\*(.*?)\*/)?", body, re.M | re.S):
            out.append((line.group(1).strip(), flat(line.group(2) or "")))
        return out

    @staticmethod
    def name_of(declaration):
        pointer = re.search(r"\(\*(\w+)\)", declaration)
        return pointer.group(1) if pointer else re.findall(r"\w+", re.sub(r"\[.*", "", declaration))[-1]

    @staticmethod
    def find_functions(text):
        """(name, arguments, comment) in order: own comments, then the one above the run."""
        out, above = [], ""
        token = re.compile(r"^/\*(?P<above>.*?)\*/[ ]*$|^RDM_API (?P<function>[^;]*;[^\n]*)|^(?P<other>[^\n]*)$", re.M | re.S)
        at = 0
        while at < len(text):
            m = token.match(text, at)
            if m.group("above") is not None:
                above = flat(m.group("above"))
            elif m.group("function"):
                end = m.end()
                own = m.group("function")
                while own.count("/*") > own.count("*/"):  # a comment that goes on
                    stop = text.index("*/", end) + 2
                    own, end = own + text[end:stop], stop
                declared = re.sub(r"/\*.*?\*/", " ", own, flags=re.S)
                name, arguments = re.match(r".*?\b(rdm_\w+)\((.*)\)\s*;", " ".join(declared.split())).groups()
                comments = " ".join(flat(c) for c in re.findall(r"/\*(.*?)\*/", own, re.S))
                args = [] if arguments == "void" else [a.strip() for a in arguments.split(",")]
                out.append((name, args, comments + " " + above))
                at = text.find("\n", end) + 1 or len(text)
                continue
            else:
                above = ""
            at = m.end() + 1
        return out


def split(declaration):
    """(type, stars, name, dimensions) of an argument or member."""
    m = re.match(r"((?:const )?(?:struct )?\w+)\s*([*]*)\s*(?:const )?(\w+)\s*((?:\[[^\]]*\])*)$", declaration)
    return m.groups() if m else (declaration, "", Header.name_of(declaration), "")


def main(root):
    folder = pathlib.Path(root)
    listed = ["sh", folder / "cmake/headers.sh", folder / "include"]
    names = subprocess.run(listed, check=True, capture_output=True, text=True).stdout.split("\n")[:-1]
    texts = [pathlib.Path(name).read_text() for name in names]
    header = Header("\n".join(texts))
    wrong = [f"{name}: a line of {len(line)} columns, of {WIDTH}: {line}"
             for name, text in zip(names, texts) for line in text.split("\n") if len(line) > WIDTH]
    counts = {}

    def words(where, shape, names):
        for word in WORD.findall(shape):
            bare = word.rstrip("0123456789")  # n0 is the first number of the argument n
            if word not in names and word not in header.macros and bare not in names:
                wrong.append(f"{where}: {word} in its shape {shape} is no argument, member or macro")

    def classify(where, declaration, shape, comment, names, member):
        kind, stars, name, dimensions = split(declaration)
        const, base = kind.startswith("const "), kind.split()[-1]
        if "(" in declaration or (not stars and not dimensions):
            return "value"
        if dimensions:
            words(where, dimensions, names)
            return "array"
        if base in HANDLES:
            return "handle" if stars == "*" else "new handle"
        if base == "char" and const:
            return "text" if stars == "*" else "text out"
        if shape:
            words(where, shape, names)
            return "array"
        if base == "void" and (member or name == "user"):
            return "passed through"
        if base in header.structs and not (member and base == "rdm_option"):
            return "struct in" if const else "struct out"
        if not const and not member and (base in INTEGERS or f"*{name}" in comment):
            return "one value"
        wrong.append(f"{where}: `{declaration}` has no shape `{'' if member else name + ' '}[...]` in its comment")
        return "unknown"

    for struct, members in header.structs.items():
        for declaration, comment in members:
            for part in re.split(r",\s*(?![^(]*\))", declaration) if "(" not in declaration else [declaration]:
                shape = re.match(SHAPE, comment)
                where = f"{struct}.{Header.name_of(part)}"
                if part is not declaration and not re.match(r".*\w\s+\*?\w", part):
                    continue  # a further name of the same plain type
                kind = classify(where, part, shape and shape.group(1), comment, header.member_names, True)
                counts[kind] = counts.get(kind, 0) + 1
    for function, arguments, comment in header.functions:
        names, sized = {Header.name_of(a) for a in arguments} | header.member_names, set()
        for argument in arguments:
            name = Header.name_of(argument)
            shape = re.search(rf"(?<![\w*]){name} {SHAPE}", comment)
            kind = classify(f"{function}: {name}", argument, shape and shape.group(1), comment, names, False)
            counts[kind] = counts.get(kind, 0) + 1
            sized.update(WORD.findall(shape.group(1)) if shape else [])
        plain = {Header.name_of(a) for a in arguments if "*" not in a}
        for name in sorted(plain & LENGTHS - sized):
            wrong.append(f"{function}: no array has the shape [{name}]")
        for argument in arguments:
            name = Header.name_of(argument)
            if name in plain & (LENGTHS | sized) - NOT_COUNTED and split(argument)[0] != "size_t":
                wrong.append(f"{function}: `{argument}` is no size_t")
    for name, body in header.enums:
        if not name:
            wrong.append(f"an enum has no name: {' '.join(body.split())[:60]}")
        for constant in (c.strip() for c in body.split(",")):
            if constant and "=" not in constant:
                wrong.append(f"enum {name}: {constant} has no value written")
    listed = {line for part in ("redman", "redman_1.0", "redman_experimental")
              for line in (folder / f"capi/{part}.symbols").read_text().split() if line.startswith("rdm_")}
    found = [name for name, _, _ in header.functions]
    for name in sorted(listed.symmetric_difference(found)):
        wrong.append(f"{name}: listed in capi/*.symbols or declared, not both")
    if wrong:
        print("\n".join(wrong))
        return 1
    print(f"{len(found)} functions, {len(header.structs)} structs:", ", ".join(f"{n} {k}" for k, n in sorted(counts.items())))
    return 0


sys.exit(main(sys.argv[1]))
