"""Learning curves: the columns of progress.csv, drawn as SVG without any other library."""
from __future__ import annotations

import html
import json
import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, Iterable, Mapping, Optional, Sequence, Union

import numpy as np

from ._error import FormatError, MissingFileError
from ._html import image
from ._files import MOST_JSON, MOST_TEXT, as_path, read_bytes
from ._names import Hinted
from ._optional import optional

if TYPE_CHECKING:
    import numpy.typing as npt
    Column = npt.NDArray[np.float64]
else:
    Column = np.ndarray
# Okabe and Ito's colours, told apart by most eyes.
_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555")
_WIDTH, _HEIGHT, _LEFT, _TOP, _RIGHT, _BOTTOM = 300, 190, 56, 30, 20, 54  # of a panel, and around it


class _Drawn:
    """Draws itself in a notebook, as an image too, since exports to HTML drop the lines of an SVG."""

    def _repr_svg_(self) -> str:
        raise NotImplementedError

    def _repr_html_(self) -> Optional[str]:
        return image("svg+xml", self._repr_svg_().encode())

    def plot(self) -> _Drawn:
        """Returns the curve itself, which a notebook draws when it is the last line of a cell; elsewhere use save."""
        return self

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the picture as an SVG file at path."""
        as_path(path).write_text(self._repr_svg_(), encoding="utf-8")


_DRAWS = "it draws itself in a notebook; save('curve.svg') writes the picture"


class Curve(_Drawn, Hinted, Dict[str, Column]):
    """Columns by name ("TotalEnvSteps", "Metrics/EpRet", ...), a row for each epoch; draws itself in a notebook. It is a
    dict, so pandas.DataFrame(curve) also has a row for each epoch, like to_pandas().

    columns: arrays by name. label: of its line; limit: of the first cost, None for none; folder: where it was read; kind, seed
    and settings: curves of one kind and settings with different seeds share a line.
    """

    _hints = {"show": _DRAWS, "draw": _DRAWS, "df": "to_pandas()", "to_df": "to_pandas()",
              "columns": "list(curve) has the names of the columns", "epochs": "curve['Train/Epoch']"}

    label: str = ""
    limit: Optional[float] = None  # of the first cost
    folder: str  # where it was read, "" for none
    kind: str  # task and algorithm
    seed: Optional[int]
    settings: dict[str, str]  # all others: curves of one kind and settings with different seeds share a line

    def __init__(self, columns: Mapping[str, Any] = {}, label: str = "", limit: Optional[float] = None,
                 folder: str = "", kind: str = "", seed: Optional[int] = None, settings: Mapping[str, str] = {}) -> None:
        super().__init__((name, np.asarray(values, np.float64)) for name, values in columns.items())
        self.label, self.limit, self.folder = label, limit, folder
        self.kind, self.seed, self.settings = kind, seed, dict(settings)

    @property
    def steps(self) -> Column:
        """Control steps so far, all worlds."""
        return self["TotalEnvSteps"]

    @property
    def returns(self) -> Column:
        """Mean return of the last episodes."""
        return self["Metrics/EpRet"]

    @property
    def costs(self) -> Column:
        """Mean cost of the last episodes, column 0."""
        return self["Metrics/EpCost"]

    def to_pandas(self) -> Any:
        """A pandas.DataFrame, a row for each epoch; needs pandas."""
        return optional("pandas", "to_pandas", "; dict(curve) has arrays by name").DataFrame(dict(self))

    def _repr_svg_(self) -> str:
        return draw([self])

    def __repr__(self) -> str:
        return f"<Curve {self.label}: {len(self.steps)} epochs>"


class Curves(_Drawn, Hinted, Sequence[Curve]):
    """Several runs in one picture. Runs that differ in their seeds alone are drawn as their mean in a band of one standard
    deviation on each side, as `redman plot` does. curves: a Curve of each; each=True draws a line for each run."""

    _hints = {"show": _DRAWS, "draw": _DRAWS}
    each: bool = False  # whether every run has a line of its own

    def __init__(self, curves: Iterable[Curve], each: bool = False) -> None:
        self._curves, self.each = list(curves), each

    def __getitem__(self, i: Any) -> Any:
        return self._curves[i]

    def __len__(self) -> int:
        return len(self._curves)

    def _repr_svg_(self) -> str:
        return draw(self._curves, self.each)


def read(folder: Union[str, os.PathLike[str]]) -> Curve:
    """The curve of one run folder. An incomplete last row of a killed run is left out."""
    path = Path(folder)
    try:
        lines = read_bytes(path / "progress.csv", MOST_TEXT).decode(errors="replace").splitlines()
    except OSError as error:
        raise MissingFileError(f"{path} is no run folder: progress.csv: {error.strerror}") from None
    names = lines[0].split(",") if lines else []
    if "TotalEnvSteps" not in names:
        raise FormatError(f"{path}/progress.csv: it has no column TotalEnvSteps")
    rows = [cells for cells in (line.split(",") for line in lines[1:]) if len(cells) == len(names)]
    try:
        table = np.array(rows, dtype=np.float64).reshape(len(rows), len(names))
    except ValueError as error:
        raise FormatError(f"{path}/progress.csv: {error}") from None
    label, limit, kind, seed, settings = path.name, None, "", None, {}
    try:
        config = json.loads(read_bytes(path / "config.json", MOST_JSON))
        label = f"{config['task']} {config['algo']} seed {config['seed']}"
        limit = config["cost_limits"].get("cost")
        kind, seed, settings = f"{config['task']} {config['algo']}", int(config["seed"]), settings_of(config)
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        pass  # the columns alone are a curve too
    return Curve({name: table[:, i] for i, name in enumerate(names)}, label, limit, str(path), kind, seed, settings)


def settings_of(config: Mapping[str, Any]) -> dict[str, str]:
    """What two runs of a config.json's task and algorithm may differ in, as `redman plot` and `report` see it: "clip" by its
    value. What is the run's seed, or does not change what it learns, is not among them."""
    parts = ("train_cfgs", "algo_cfgs", "env_cfgs", "teach_cfgs")
    out = {key: str(value) for part in parts for key, value in config.get(part, {}).items()}
    out.update({"limit" if name == "cost" else f"{name} limit": f"{limit:g}" for name, limit in config.get("cost_limits", {}).items()})
    for name in ("threads", "tensorboard", "cost_limit"):
        out.pop(name, None)
    out.update({name: str(config[name]) for name in ("task_file", "own_costs", "own_reward") if name in config})
    return out


def curve(*folders: Union[str, os.PathLike[str]], each: bool = False) -> Union[Curve, Curves]:
    """The curve of a run folder, a Curve, or those of several in one picture, Curves.

    Runs that differ in their seeds alone are a mean with a band, or, with each=True, a line for each. A folder that is given twice,
    also by another path, is drawn once.

        redman.curve("runs/first").save("curve.svg")
        redman.curve("runs/seed-0", "runs/seed-1")

    folders: paths of run folders, which contain a progress.csv; MissingFileError for one that does not, FormatError for one whose
    file cannot be read."""
    once: dict[Path, Union[str, os.PathLike[str]]] = {}
    for folder in folders:
        once.setdefault(Path(folder).resolve(), folder)
    curves = [read(folder) for folder in once.values()]
    return curves[0] if len(folders) == 1 else Curves(curves, each)


class _Line:
    """What is drawn in one colour: a curve, or the mean of several with a band."""

    def __init__(self, curves: Sequence[Curve], label: str) -> None:
        self.curves, self.label = curves, label

    def points(self, column: str) -> tuple[Column, Column, Column]:
        """Steps, values, and half the width of the band, 0 for a single run."""
        found = [one for one in self.curves if column in one]
        if len(self.curves) == 1:
            steps, values = (found[0].steps, found[0][column]) if found else (np.zeros(0), np.zeros(0))
            return steps, values, np.zeros(len(values))
        steps = np.arange(1, _POINTS + 1) / _POINTS * min((one.steps[-1] for one in self.curves if len(one.steps)), default=0.0)
        rows = np.array([_on(one.steps, one[column], steps) for one in found]).reshape(len(found), _POINTS)
        good = np.isfinite(rows)
        count = good.sum(axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            mean = np.where(good, rows, 0).sum(axis=0) / count
            off = np.where(good, rows - mean, 0)
            deviation = np.sqrt((off * off).sum(axis=0) / (count - 1))
        return steps, mean, np.where(count > 1, deviation, 0)


_POINTS = 120  # of a mean


def _on(steps: Column, values: Column, at: Column) -> Column:
    """Values at other steps, on the lines between points; NaN outside of them."""
    if not len(steps):
        return np.full(len(at), np.nan)
    return np.interp(at, steps, values, left=np.nan, right=np.nan)


_MOST_NAMED, _LONGEST = 3, 40  # settings in a label, characters of one


def differences(settings: Mapping[str, str], rivals: Sequence[Mapping[str, str]]) -> str:
    """How a label says what distinguishes settings from others: ": shield predict"; "" for nothing."""
    keys = sorted(key for key in settings if len({other.get(key) for other in rivals}) > 1)
    texts = [f"{key} {settings[key]}" for key in keys[:_MOST_NAMED]]
    shown = [text if len(text) <= _LONGEST else text[:_LONGEST] + "..." for text in texts]
    return (": " if keys else "") + ", ".join(shown + ["..."] * (len(keys) > _MOST_NAMED))


def lines_of(curves: Sequence[Curve], each: bool) -> list[_Line]:
    """Curves that share a line: those of one kind and the same settings, whose seeds all differ."""
    groups: dict[Any, list[Curve]] = {}
    for number, one in enumerate(curves):
        alone = each or not one.kind or one.seed is None
        groups.setdefault(number if alone else (one.kind, one.limit, *sorted(one.settings.items())), []).append(one)
    lines = []
    for group in groups.values():
        if len({one.seed for one in group}) == len(group) > 1:
            rivals = [one.settings for one in curves if one.kind == group[0].kind]
            lines.append(_Line(group, f"{group[0].kind}{differences(group[0].settings, rivals)} ({len(group)} seeds)"))
        else:
            lines += [_Line([one], "") for one in group]
    single = [line for line in lines if not line.label]
    for line, label in zip(single, _legends([line.curves[0] for line in single])):
        line.label = label
    return lines


def _ticks(low: float, high: float) -> list[float]:
    """About five round numbers that span low to high."""
    if not high > low:
        low, high = low - 0.5, high + 0.5
    raw = (high - low) / 5
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1, 2, 5, 10) if raw <= factor * power)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return [i * step for i in range(first, last + 1)]


def _number(value: float) -> str:
    for size, unit in ((1e9, " G"), (1e6, " M"), (1e3, " k")):
        if abs(value) >= size:
            return f"{value / size:g}{unit}"
    return f"{value:g}"


def _panel(title: str, column: str, lines: Sequence[_Line], limit: Optional[float], at: float) -> str:
    drawn = []
    for number, line in enumerate(lines):
        line_x, line_y, half = line.points(column)
        good = np.isfinite(line_x) & np.isfinite(line_y)
        drawn.append((number, line_x[good], line_y[good], half[good]))
    values = np.concatenate([end for _, _, y, half in drawn for end in (y - half, y + half)] +
                            [np.array([limit] if limit is not None else [])])
    steps = np.concatenate([x for _, x, _, _ in drawn] + [np.zeros(1)])
    ticks = _ticks(float(values.min()), float(values.max())) if len(values) else [0.0, 1.0]
    most = max(float(steps.max()), 1.0)
    across = [x for x in _ticks(0.0, most) if x <= most]

    def x_of(x: Any) -> Any:
        return at + _LEFT + x / most * _WIDTH

    def y_of(y: Any) -> Any:
        return _TOP + _HEIGHT - (y - ticks[0]) / (ticks[-1] - ticks[0]) * _HEIGHT

    left, right, bottom = at + _LEFT, at + _LEFT + _WIDTH, _TOP + _HEIGHT
    out = [f'<text x="{left}" y="{_TOP - 10}" font-weight="bold">{html.escape(title)}</text>']
    for y in ticks:
        out.append(f'<path d="M{left} {y_of(y):.1f}H{right}" stroke="#ddd"/>'
                   f'<text x="{left - 6}" y="{y_of(y) + 4:.1f}" text-anchor="end">{_number(y)}</text>')
    for x in across:
        out.append(f'<text x="{x_of(x):.1f}" y="{bottom + 16}" text-anchor="middle">{_number(x)}</text>')
    out.append(f'<text x="{left + _WIDTH / 2}" y="{bottom + 32}" text-anchor="middle">control steps</text>')
    if limit is not None:
        out.append(f'<path d="M{left} {y_of(limit):.1f}H{right}" stroke="#555" stroke-dasharray="5 4"/>')
    for number, xs, ys, half in drawn:
        color = _COLORS[number % len(_COLORS)]
        if half.any():
            edge = [*zip(x_of(xs), y_of(ys + half)), *reversed([*zip(x_of(xs), y_of(ys - half))])]
            out.append(f'<polygon points="{" ".join(f"{x:.1f},{y:.1f}" for x, y in edge)}" fill="{color}" fill-opacity="0.2"/>')
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(x_of(xs), y_of(ys)))
        out.append(f'<polyline points="{points}" fill="none" stroke="{color}" stroke-width="1.5"/>')
    return "".join(out)


def _legends(curves: Sequence[Curve]) -> list[str]:
    """A text for each curve, all different: its label, and for curves of the same label the end of the folder's path that
    distinguishes them, or a number."""
    labels = {(one.label, one.folder): one.label for one in curves}
    most = max(len(Path(folder).parts) for _, folder in labels) if labels else 0
    for depth in range(1, most + 1):
        texts = list(labels.values())
        for (label, folder), text in list(labels.items()):
            if folder and texts.count(text) > 1:
                labels[label, folder] = f"{label} ({Path(*Path(folder).parts[-depth:])})"
    texts = [labels[one.label, one.folder] for one in curves]
    return [f"{text} #{texts[:i].count(text) + 1}" if texts.count(text) > 1 else text for i, text in enumerate(texts)]


def draw(curves: Sequence[Curve], each: bool = False) -> str:
    """Return and cost over control steps as an SVG; the dashed line is the limit."""
    lines = lines_of(curves, each)
    limits = {one.limit for one in curves}
    limit = limits.pop() if len(limits) == 1 else None
    width = _LEFT + _WIDTH + _RIGHT
    height = _TOP + _HEIGHT + _BOTTOM + 18 * len(lines)
    legend = ""
    for i, line in enumerate(lines):
        y = _TOP + _HEIGHT + _BOTTOM + 18 * i
        legend += (f'<path d="M{_LEFT} {y}h24" stroke="{_COLORS[i % len(_COLORS)]}" stroke-width="2"/>'
                   f'<text x="{_LEFT + 32}" y="{y + 4}">{html.escape(line.label)}</text>')
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{2 * width}" height="{height}" '
            f'font-family="sans-serif" font-size="11" fill="#222"><rect width="100%" height="100%" fill="#fff"/>'
            + _panel("return", "Metrics/EpRet", lines, None, 0)
            + _panel("cost", "Metrics/EpCost", lines, limit, width) + legend + "</svg>")
