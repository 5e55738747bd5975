"""Makes examples/python/tour.ipynb: runs the cells of this file and stores what they print and draw. Needs numpy and the tool, no Jupyter.

    python3 examples/python/tour/make.py [tour.ipynb]

A cell is a text between the lines "# %%" (code) or "# %% text" (Markdown) of cells.py. As in a notebook, the value of a last
expression draws itself: its text, and what its _repr_html_ and _repr_png_ give. Without an argument the notebook beside this
folder is written anew.
"""
import ast
import base64
import contextlib
import hashlib
import io
import json
import os
import re
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent


def cells():
    """(kind, text) of each cell."""
    source = (HERE / "cells.py").read_text(encoding="utf-8")
    for kind, text in re.findall(r"^# %%( text)?\n(.*?)(?=^# %%|\Z)", source, re.M | re.S):
        text = text.strip("\n")
        yield ("markdown", re.sub(r"^# ?", "", text, flags=re.M)) if kind else ("code", text)


def lines(text):
    """A text as notebooks store it."""
    return text.splitlines(keepends=True)


def shown(value, count):
    """The output of a cell's last expression: its text and its richest form."""
    data = {"text/plain": lines(repr(value))}
    for name, kind in (("_repr_html_", "text/html"), ("_repr_png_", "image/png")):
        drawn = getattr(value, name, lambda: None)()
        if drawn:
            data[kind] = lines(drawn) if isinstance(drawn, str) else base64.b64encode(drawn).decode()
            break
    return {"output_type": "execute_result", "execution_count": count, "metadata": {}, "data": data}


def run(text, names, count):
    """Runs a cell; returns its outputs."""
    tree, outputs = ast.parse(text), []
    last = ast.Expression(tree.body.pop().value) if tree.body and isinstance(tree.body[-1], ast.Expr) else None
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(compile(tree, f"cell {count}", "exec"), names)
        value = None if last is None else eval(compile(last, f"cell {count}", "eval"), names)
    if said.getvalue():
        outputs.append({"output_type": "stream", "name": "stdout", "text": lines(said.getvalue())})
    if value is not None:
        outputs.append(shown(value, count))
    return outputs


def notebook():
    """The whole notebook, executed."""
    names, count, made = {"__name__": "__main__"}, 0, []
    for kind, text in cells():
        cell = {"cell_type": kind, "id": hashlib.sha256(text.encode()).hexdigest()[:8], "metadata": {}, "source": lines(text)}
        if kind == "code":
            count += 1
            cell.update(execution_count=count, outputs=run(text, names, count))
        made.append(cell)
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return {"cells": made, "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}}, "nbformat": 4, "nbformat_minor": 5}


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else HERE.parent / "tour.ipynb").resolve()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # runs are written there
        text = json.dumps(notebook(), indent=1, ensure_ascii=False) + "\n"
        os.chdir(target.parent)
    target.write_text(text, encoding="utf-8")
    print(f"wrote {target.name}: {len(text.encode()) / 1e6:.2f} MB")
