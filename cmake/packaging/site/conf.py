"""The site: manual, pages of the tree and Python's reference, by Sphinx; cmake/packaging/site/site.sh calls it."""
import ast
import os
import re
import textwrap
from itertools import takewhile
from pathlib import Path

stage = Path(os.environ["RDM_STAGE"])
project = "redman"
author = "redman's authors"
copyright = "redman's authors, Apache-2.0"
version = release = os.environ["RDM_VERSION"]
extensions = ["myst_parser", "sphinx.ext.autodoc"]
root_doc = "README"
# Pages for users; those of the tests' data and of packages' scripts are read where they are.
include_patterns = ["*.md", "examples/**.md", "tasks/*.md", "algos/*.md", "lib/**.md", "capi/**.md", "cmake/**.md", "include/**.md", "tests/*.md", "tests/hard/*.md"]
exclude_patterns = ["tests/old", "**/node_modules", "examples/results/short.md"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # a page may begin with its table
highlight_language = "none"  # a block without a name is a formula or a text
html_theme = "furo"
html_search_scorer = str(stage / "cmake/packaging/site/scorer.js")
html_title = f"redman {version}"
html_static_path = [str(stage / "cmake/packaging/site/site.css")]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"footer_icons": [], "source_repository": ""}
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_default_options = {"members": True}


def chapters():
    """Pages by section, in the order in which the manual's first page names them."""
    section, out, seen = "Manual", {}, {root_doc}
    for line in (stage / "examples/manual/README.md").read_text(encoding="utf-8").splitlines():
        if line.startswith("## "):
            section = line[3:]
        for target in re.findall(r"\]\(([^)#]*)\.md[^)]*\)", line) if line.startswith("|") else []:
            name = os.path.normpath(os.path.join("examples/manual", target))
            if name not in seen and (stage / f"{name}.md").exists():
                seen.add(name)
                out.setdefault(section, []).append(name)
    return out


def contents(pages, caption=None):
    lines = ["", "```{toctree}", ":hidden:", ":maxdepth: 1"] + ([f":caption: {caption}"] if caption else [])
    return "\n".join(lines + [""] + pages + ["```", ""])


def add_contents(app, name, source):
    """The side bar. It names every page, those behind the manual's by folders."""
    if name == root_doc:
        tree = chapters()
        next(iter(tree.values())).insert(0, "examples/manual/README")
        tree.setdefault("Look up", [])[:0] = ["c-reference", "python-reference"]
        named = {page for pages in tree.values() for page in pages} | {root_doc}
        rest = sorted(page for page in app.env.found_docs - named if not page.startswith(BEHIND))
        for section, pages in (("Examples", "examples/"), ("Source", r"(?!examples/).*/"), ("Project", "[^/]*$")):
            tree[section] = [TITLES.get(page, page) for page in rest if re.match(pages, page)]
        source[0] += "".join(contents(pages, section) for section, pages in tree.items())
    elif (folder := name.removesuffix("README")) in BEHIND:
        pages = {page.removeprefix(folder) for page in app.env.found_docs if page.startswith(folder)}
        source[0] += contents(sorted(page for page in pages if page != "README" and "/" not in page))


# Folders whose pages stand behind their first one.
BEHIND = ("examples/results/", "examples/manual/tasks/", "examples/manual/algorithms/")
# What the side bar calls a page whose own title is for readers of its folder.
TITLES = {"capi/python/README": "Source of the Python package <capi/python/README>"}


def plain_links(app, name, source):
    """Links to folders and to files that are no pages lead to the words alone: a page stands for itself, without the tree. Links to
    headers lead to Doxygen's pages of them."""
    folder = (stage / name).parent
    headers = "include/redman/"

    def kept(match):
        target = match[2].split("#")[0]
        path = folder / target
        inside = os.path.normpath(os.path.join(os.path.dirname(name), target))
        if inside.startswith(headers) and inside.endswith(".h") and path.name != "deprecated.h":  # it has no page
            page = "index" if path.name == "redman.h" else f"{path.stem}_8h"
            return f'<a href="{os.path.relpath("c", os.path.dirname(name) or ".")}/{page}.html">{match[1]}</a>'
        gone = target and not re.match(r"[a-z]+:", target) and (path.is_dir() or Path(target).name.startswith("."))
        return match[1] if gone else match[0]

    source[0] = re.sub(r"\[([^][\n]*)\]\(([^)\s]*)\)", kept, source[0])


def colours(block):
    """Python, where the block parses as such; a table or a formula has no colours."""
    try:
        ast.parse(textwrap.dedent("\n".join(block)))
    except SyntaxError:
        return "none"
    return "python"


def code_in_docstrings(app, what, name, obj, options, lines):
    """Docstrings are plain text with code set in, as a terminal shows them: what is set in is code, and no more is markup."""
    if what == "module":  # stands at the margin, where Sphinx takes the code's for the text's
        lines[:] = (obj.__doc__ or "").splitlines()
    out, code = [], False
    for number, line in enumerate(lines):
        inner = line.startswith("    ") and line.strip()
        if inner and not code:
            block = takewhile(lambda one: one.startswith("    ") or not one.strip(), lines[number:])
            out += ["", f".. code-block:: {colours(block)}", ""]
        if code and line.strip() and not inner:
            out += [""]
        code = bool(inner) or (code and not line.strip())
        out.append(line if inner else re.sub(r"([*_`|\\\"])", r"\\\1", line))
    lines[:] = out


def setup(app):
    app.connect("source-read", plain_links)
    app.connect("source-read", add_contents)
    app.connect("autodoc-process-docstring", code_in_docstrings)
