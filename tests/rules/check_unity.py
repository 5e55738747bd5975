"""check_unity.py ROOT: no two files that a build compiles as one give the same name to something of their own. Which files
share a unit moves with each file that comes or goes, and a release puts more of them together than a build for work does;
so a clash may show in a release alone, long after it was written."""
import collections
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1]).resolve()
layers = (root / "cmake/layers.cmake").read_text()
alone = set(re.search(r"set\(RDM_ALONE ([^)]*)\)", layers)[1].split()) | {"posix_windows.cpp", "algo_registry.cpp", "file_windows.cpp"}
# What is compiled together: the folders of a library.
LIBRARIES = ["lib/base", "lib/record", "lib/env", "lib/plan", "algos", "capi", "examples/redman"]
OPENS = re.compile(r"^namespace( [\w:]+)? \{")
OWN = [
    re.compile(r"^(?:struct|class|enum(?: class)?|union) (\w+)"),
    re.compile(r"^using (\w+) ="),
    re.compile(r"^(?:\[\[\w+\]\] )?(?:(?:constexpr|constinit|const|inline|static|thread_local|template <[^>]*>) )*"
               r"[\w:][\w:<>,*& ]*?[ *&](\w+)(?:\(| =|;|\{|\[)"),
]


def own_names(path):
    """(name, line, what it is: text up to the name) of what the file has in anonymous namespaces or as static."""
    spaces = []  # (name, line) of the namespaces that are open
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if opened := OPENS.match(line):
            if "}" not in line:
                spaces.append((opened[1], number))
            continue
        # one of a single line ends without a comment
        if spaces and (re.match(r"\}\s*// namespace", line) or line == "}" and number == spaces[-1][1] + 2):
            spaces.pop()
            continue
        if None not in [name for name, _ in spaces] and not line.startswith("static "):
            continue
        for kind in OWN:
            if (found := kind.match(line)) and not line.startswith("namespace "):
                yield found[1], number, line
                break


failed = False
for library in LIBRARIES:
    where = collections.defaultdict(dict)
    for path in sorted((root / library).rglob("*.cpp")):
        if path.name in alone or "capi/import" in str(path) or path == root / "examples/redman/main.cpp":
            continue
        for name, number, line in own_names(path):
            where[name].setdefault(path, number)  # overloads within a file are its own affair
    for name, files in sorted(where.items()):
        if len(files) > 1:
            failed = True
            print(f"'{name}' is defined in " + " and ".join(f"{p.relative_to(root)}:{n}" for p, n in files.items()))
sys.exit(failed)
