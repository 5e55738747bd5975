"""check_words.py ROOT [COUNT]: public text says what the field says. Pages, comments of the public headers, texts of the
library and the tool, and Python's docstrings and messages have none of the words below, which are private to this project
or not what a reader from outside expects; examples/manual/glossary.md has the words to use. COUNT: hits of each word alone.

A word between backquotes is code and may be anything: option keys, names of functions and fields, members of structs."""
import ast
import collections
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[1]).resolve()

# What is refused, and what to say instead. A hit is refused unless the text around it matches the third entry.
WORDS = [
    (r"eyes?", "point-cloud encoder, camera", r"eye and target|from eye|eye, target"),
    (r"sees", "observes, reads", None),
    (r"blind", "without visual input", None),
    (r"turning", "rotation, angular velocity", None),
    (r"rates qd|joint rates|their rates|rates of (joints|a substep)", "joint velocities", None),
    (r"taught|lessons?|teaches", "demonstrated, learned by imitation", None),
    (r"courses?", "trajectory", r"of course"),
    (r"carves?|carved|carving", "allocate", None),
    (r"lends?|lent|lending", "non-owning view", None),
    (r"retires?|retired|blames?|blamed", "free, flag", None),
    (r"room (for|to|in)|(most|more|no|have|has|had) room", "headroom, clearance", None),
    (r"(come|comes|came|coming) with (redman|the tool|the library|it)|shipped|ships|that ship", "bundled", None),
    (r"with (its|their) noise", "stochastic", None),
    (r"things?", "object, body, obstacle", None),
    (r"cores? of (its|their) own", "a dedicated core", None),
    (r"half-solved", "multiplied by L^-1", None),
    (r"shims?", "ABI layer", None),
    (r"stands? in (a|its|the) (capsule|box|sphere)", "is bounded by", None),
    (r"stands? in(?= \[)|stands? in (the (manual|tables?|way)|one place)", "is in", None),
    (r"plainly", "(leave it out)", None),
    (r"by feed-forward", "with gravity compensation", None),
    (r"half again|thrice|tens", "1.5 times, three times, 10 to 99", None),
    (r"for who|who may not|whoever|who (has|sees|chooses|proposes|calls|finds|knows) ", "for those who, programs that, what",
     r"(those|readers|users|people|everyone|anyone|one) who"),
    (r"unless said|said otherwise|says otherwise", "unless noted, overrides", None),
    (r"to turn,", "to rotate", None),
    (r"mends?|mended|mending", "repairs, avoids", r"--mend-inertia"),
    (r"in the place of|takes? the place of", "instead of, replaces", None),
    (r"stands? over|laid over|lays? over|stands? on (those|this|all|everything)", "overrides, depends on", None),
    (r"stands? still|stands? twice|is there twice", "is fixed, is at rest, occurs twice", None),
    (r"what is no|cannot be one|of no use|aright", "anything but, is invalid, is useless, correctly", None),
    (r"(goes|go|went) for", "target of a drive", None),
    (r"spoils?|spoiled|spoilt", "corrupts", None),
    (r"triangle rule", "triangle inequality", None),
    (r"(simulation|learning) half|halves of the library", "a build without simulation, without learning", None),
    (r"out of files|forth and back|nobody learned|gives way to", "from files, forward and backward, baseline", None),
    (r"the handle is good|no error of the call", "the handle can still be used, the call does not fail", None),
    (r"hears?|hastens?", "notices, speeds up", None),
]


def files(*patterns: str) -> list[pathlib.Path]:
    listed = subprocess.run(["git", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard", *patterns],
                            capture_output=True, text=True, check=False)
    if listed.returncode == 0:
        return [root / name for name in listed.stdout.splitlines() if (root / name).is_file()]
    return sorted(page for pattern in patterns for page in root.rglob(pattern.split("/")[-1]) if "build" not in page.relative_to(root).parts)


def blank(match: re.Match[str]) -> str:
    """As many lines and no words: numbers of lines stay."""
    return re.sub(r"[^\n]", " ", match.group())


def page_text(path: pathlib.Path) -> str:
    """A page without code, links' targets and generated tables."""
    text = path.read_text(encoding="utf-8")
    if path.name == "CHANGELOG.md":
        text = text[: text.index("\n## [0.1.0]")]
    text = re.sub(r"^```.*?^```$", blank, text, flags=re.S | re.M)
    text = re.sub(r"^<!-- (\w+) -->$.*?^<!-- end[^\n]*-->$", blank, text, flags=re.S | re.M)
    return re.sub(r"`[^`\n]*`|\]\([^)\n]*\)|^    .*$", blank, text, flags=re.M)


def comments(path: pathlib.Path) -> str:
    """The comments of a C or C++ header, without code in them."""
    text = path.read_text(encoding="utf-8")
    kept = [" "] * len(text)
    for match in re.finditer(r"/\*.*?\*/|//[^\n]*", text, flags=re.S):
        kept[match.start() : match.end()] = match.group()
    for place, character in enumerate(text):
        if character == "\n":
            kept[place] = "\n"
    return re.sub(r"`[^`\n]*`|\"[^\"\n]*\"", blank, "".join(kept))


def literals(path: pathlib.Path) -> str:
    """The string literals of a C++ source that are sentences."""
    text = path.read_text(encoding="utf-8")
    text = re.sub(r"^\s*(#|//)[^\n]*|(?<=[;{},)] ) *//[^\n]*", blank, text, flags=re.M)
    out = [" " if c != "\n" else c for c in text]
    for match in re.finditer(r'"((?:[^"\\\n]|\\.)*)"', text):
        if " " in match.group(1).strip():
            out[match.start() : match.end()] = match.group()
    return re.sub(r"`[^`\n]*`", blank, "".join(out))


def docstrings(path: pathlib.Path) -> str:
    """Docstrings and messages of a Python module, each at its line."""
    lines = [""] * (len(path.read_text(encoding="utf-8").splitlines()) + 2)
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and " " in node.value:
            for offset, line in enumerate(node.value.split("\n")):
                at = min(node.lineno - 1 + offset, len(lines) - 1)
                lines[at] += " " + line
    return re.sub(r"`[^`\n]*`", blank, "\n".join(lines))


texts: list[tuple[pathlib.Path, str]] = []
texts += [(p, page_text(p)) for p in files("*.md") if "examples/results/" not in str(p) and "tests/old" not in str(p)]
texts += [(p, comments(p)) for p in files("include/redman/*")]
texts += [(p, literals(p)) for p in files("examples/redman/*.cpp", "examples/redman/*.hpp", "lib/*.cpp", "lib/*.hpp", "lib/*.inl",
                                          "tasks/*.cpp", "tasks/*.hpp", "algos/*.cpp", "algos/*.hpp", "capi/*.cpp", "capi/*.hpp")]
texts += [(p, docstrings(p)) for p in files("capi/python/redman/*.py") if not p.name.endswith("_abi.py")]

hits: list[str] = []
count: collections.Counter[str] = collections.Counter()
for path, text in texts:
    for words, instead, allowed in WORDS:
        for match in re.finditer(rf"(?<![\w.-])(?:{words})(?![\w-])", text, flags=re.I):
            start = text.rfind("\n", 0, match.start()) + 1
            end = text.find("\n", match.end())
            line = text[start : end if end >= 0 else None]
            if allowed and re.search(allowed, line, flags=re.I):
                continue
            where = text.count("\n", 0, match.start()) + 1
            hits.append(f"{path.relative_to(root)}:{where}: {match.group()!r}: say {instead}: {' '.join(line.split())[:110]}")
            count[words] += 1
if not texts:
    hits.append("no text was found")
if len(sys.argv) > 2:
    print("\n".join(f"{n:5} {words}" for words, n in count.most_common()), f"\n{len(hits):5} in all")
else:
    print("\n".join(hits))
sys.exit(bool(hits))
