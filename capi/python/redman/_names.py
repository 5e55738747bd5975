"""The nearest of the names that there are, as the library's own texts offer it."""
from __future__ import annotations

from typing import Iterable


def nearest_of(name: str, known: Iterable[str]) -> str:
    """That of the known names which the fewest changes lead to; "" where none is near. Case, - and _ do not count."""
    def folded(word: str) -> str:
        return word.lower().replace("-", "_")

    wanted = folded(name)
    distances = {word: _distance(wanted, folded(word)) for word in known}
    best = min(distances, key=lambda word: (distances[word], word), default="")
    return best if best and distances[best] <= max(2, len(wanted) // 3) else ""


def nearest(name: str, known: Iterable[str]) -> str:
    """'; nearest is NAME', or "" where none is near."""
    best = nearest_of(name, known)
    return f"; nearest is {best}" if best else ""


def _distance(a: str, b: str) -> int:
    """Letters to insert, to leave out, to replace or to swap."""
    rows = [list(range(len(b) + 1))]
    for i, letter in enumerate(a, 1):
        row = [i]
        for j, other in enumerate(b, 1):
            cost = min(rows[-1][j] + 1, row[-1] + 1, rows[-1][j - 1] + (letter != other))
            if i > 1 and j > 1 and letter == b[j - 2] and a[i - 2] == other:
                cost = min(cost, rows[-2][j - 2] + 1)
            row.append(cost)
        rows.append(row)
    return rows[-1][-1]
