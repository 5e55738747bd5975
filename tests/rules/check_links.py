"""check_links.py ROOT: every relative link of a page leads to a file that is there, and its #part to a heading; README.md
stays a first page (180 lines)."""
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[1]).resolve()
failed = []


def anchor(heading: str) -> str:
    """The name by which pages link to a heading."""
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading.lower())
    return re.sub(r"[^\w\- ]", "", text).strip().replace(" ", "-")


def prose(page: pathlib.Path) -> str:
    """A page without its blocks of code."""
    return re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.S | re.M)


listed = subprocess.run(["git", "-C", str(root), "ls-files", "*.md"], capture_output=True, text=True, check=False)
pages = ([root / name for name in listed.stdout.split()] if listed.returncode == 0 else
         [page for page in root.rglob("*.md") if "build" not in page.relative_to(root).parts])
for page in pages:
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, part = target.partition("#")
        there = (page.parent / path).resolve() if path else page
        said = f"{page.relative_to(root)}: link to {target}: "
        if not there.exists():
            failed.append(said + "there is no such file")
        elif part and part not in map(anchor, re.findall(r"^#+ (.*)$", prose(there), re.M)):
            failed.append(said + "the page has no such heading")
if not pages:
    failed.append("no pages were found")
lines = len((root / "README.md").read_text(encoding="utf-8").splitlines())
if lines > 180:
    failed.append(f"README.md has {lines} lines; a first page has at most 180")
print("\n".join(failed))
sys.exit(bool(failed))
