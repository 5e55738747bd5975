"""Data sets as folders of LeRobot, version 3.0: Parquet files of rows, of episodes and of tasks, beside two JSON files.

    meta/info.json                            features, frames a second, counts, names of files
    meta/stats.json                           mean, std, min, max and count of each feature
    meta/tasks.parquet                        task_index of each task's text
    meta/episodes/chunk-000/file-000.parquet  length, first and last row, file of each episode
    data/chunk-000/file-000.parquet           the rows, one row group for each episode
    meta/redman.json                          format, metadata, task: what redman puts beside

    observation.state, action                 obs, action
    next.reward, next.cost, next.success      of the decision in this row
    next.done                                 terminated or truncated
    next.terminated, next.truncated, redman.label; of episodes redman/final_obs and redman/source: so that arrays come back to
    the byte
"""
from __future__ import annotations

import json
import os
import warnings
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._error import ArgumentError, FormatError
from ._files import must_exist
from ._optional import optional

Arrays = dict[str, npt.NDArray[Any]]
FilePath = Union[str, "os.PathLike[str]"]

_VERSION = "v3.0"
_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_FILE_MB, _CHUNK_FILES = 100, 1000  # the form's own defaults
_OURS = {"action": "action", "next.reward": "reward", "next.cost": "cost", "next.success": "success", "next.terminated": "terminated",
         "next.truncated": "truncated", "redman.label": "label"}
_INDICES = ("timestamp", "frame_index", "episode_index", "index", "task_index", "next.done")


def _pyarrow() -> tuple[Any, Any]:
    what = "a folder of LeRobot"
    return optional("pyarrow", what), optional("pyarrow.parquet", what)


def _column(pa: Any, values: npt.NDArray[Any]) -> Any:
    """A number for each row, or a list of fixed length; of length 1 it is the number, as the form has it."""
    if values.ndim == 2 and values.shape[1] != 1:
        return pa.FixedSizeListArray.from_arrays(pa.array(np.ascontiguousarray(values).reshape(-1)), values.shape[1])
    return pa.array(values.reshape(-1))


def _statistics(values: npt.NDArray[Any]) -> dict[str, list[float]]:
    x = values.reshape(len(values), -1).astype(np.float64)
    return {"min": x.min(0).tolist(), "max": x.max(0).tolist(), "mean": x.mean(0).tolist(), "std": x.std(0).tolist(), "count": [len(x)]}


def _names(feature: str, width: int, said: dict[str, Any]) -> list[str] | None:
    """Of the numbers of a feature, where the set says them: position_0, position_1, ..."""
    if feature == "observation.state":
        fields = said.get("fields") or []
        names = [f"{f['name']}_{i}" if f["count"] > 1 else f["name"] for f in fields for i in range(f["count"])]
    elif feature == "next.cost":
        names = [c["name"] for c in said.get("costs") or []]
    else:
        names = [f"{feature}_{i}" for i in range(width)]
    return names if len(names) == width else None


def save(arrays: Arrays, target: FilePath) -> None:
    path = Path(target)
    pa, pq = _pyarrow()
    text = str(arrays["metadata"].item()) if "metadata" in arrays else ""
    said = json.loads(text) if text else {}
    task = arrays["task"].item() if "task" in arrays else said.get("task", "unknown")
    task = task.decode() if isinstance(task, bytes) else str(task)
    period = float(said.get("control_dt", 0)) * int(said.get("action_repeat", 1))
    fps = max(1, round(1 / period)) if period > 0 else 1
    begin, rows = arrays["episode_begin"], len(arrays["obs"])
    if rows == 0:
        raise ArgumentError("lerobot: the set has no rows")
    lengths = np.diff(begin)
    frame = np.arange(rows) - np.repeat(begin[:-1], lengths)
    columns = {"observation.state": arrays["obs"], **{name: arrays[ours] for name, ours in _OURS.items() if ours in arrays},
               "next.done": arrays["terminated"] | arrays["truncated"], "timestamp": (frame / fps).astype(np.float32),
               "frame_index": frame.astype(np.int64), "episode_index": arrays["episode"], "index": np.arange(rows, dtype=np.int64),
               "task_index": np.zeros(rows, np.int64)}
    if columns["next.cost"].shape[1] == 0:
        del columns["next.cost"]
    features = {}
    for name, values in columns.items():
        width = values.shape[1] if values.ndim == 2 else 1
        features[name] = {"dtype": str(values.dtype), "shape": [width], "names": None if name in _INDICES else _names(name, width, said)}

    # Whole episodes go into a file until it is full.
    row_bytes = sum(v.itemsize * (v.shape[1] if v.ndim == 2 else 1) for v in columns.values())
    files, filled = np.zeros(len(lengths), np.int64), 0
    for e, length in enumerate(lengths):
        if filled and filled + length * row_bytes > _FILE_MB * 2**20:
            files[e:] += 1
            filled = 0
        filled += length * row_bytes
    for number in range(int(files[-1]) + 1):
        of_file = np.flatnonzero(files == number)
        file = path / "data" / _FILE.format(chunk_index=number // _CHUNK_FILES, file_index=number % _CHUNK_FILES)
        file.parent.mkdir(parents=True, exist_ok=True)
        part = slice(begin[of_file[0]], begin[of_file[-1] + 1])
        table = pa.table({name: _column(pa, values[part]) for name, values in columns.items()})
        with pq.ParquetWriter(str(file), table.schema) as writer:
            for e in of_file:
                writer.write_table(table.slice(int(begin[e] - part.start), int(lengths[e])))

    zero = np.zeros(len(lengths), np.int64)
    episodes: dict[str, Any] = {"episode_index": np.arange(len(lengths), dtype=np.int64), "tasks": [[task]] * len(lengths), "length": lengths.astype(np.int64),
                "data/chunk_index": files // _CHUNK_FILES, "data/file_index": files % _CHUNK_FILES,
                "dataset_from_index": begin[:-1], "dataset_to_index": begin[1:],
                "meta/episodes/chunk_index": zero, "meta/episodes/file_index": zero}
    if "final_obs" in arrays:
        episodes["redman/final_obs"] = arrays["final_obs"]
    if "source" in arrays:
        episodes["redman/source"] = arrays["source"]
    file = path / "meta/episodes" / _FILE.format(chunk_index=0, file_index=0)
    file.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(pa.table({name: pa.array(v) if isinstance(v, list) else _column(pa, v) for name, v in episodes.items()}), str(file))

    # Readers take the text as the index of a data frame, which Parquet files say in their schema.
    index = {"index_columns": ["task"], "column_indexes": [], "pandas_version": "1.5.3", "columns": [
        {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64", "metadata": None},
        {"name": "task", "field_name": "task", "pandas_type": "unicode", "numpy_type": "object", "metadata": None}]}
    tasks = pa.table({"task_index": pa.array([0]), "task": pa.array([task])}).replace_schema_metadata({"pandas": json.dumps(index)})
    pq.write_table(tasks, str(path / "meta/tasks.parquet"))

    info = {"codebase_version": _VERSION, "robot_type": None, "total_episodes": len(lengths), "total_frames": rows, "total_tasks": 1,
            "chunks_size": _CHUNK_FILES, "data_files_size_in_mb": _FILE_MB, "video_files_size_in_mb": 200, "fps": fps,
            "splits": {"train": f"0:{len(lengths)}"}, "data_path": f"data/{_FILE}", "video_path": None, "features": features}
    ours = {"format": "redman data 1", "task": task, "metadata": text, "seconds_a_row": period or None,
            "layout_hash": int(arrays["layout_hash"].item()) if "layout_hash" in arrays else None}
    stats = {name: _statistics(values) for name, values in columns.items()}
    for name, content in (("info", info), ("stats", stats), ("redman", ours)):
        (path / f"meta/{name}.json").write_text(json.dumps(content, indent=1))


def _values(column: Any, width: int) -> npt.NDArray[Any]:
    whole = column.combine_chunks()
    flat = whole.flatten() if width != 1 else whole
    values: npt.NDArray[Any] = flat.to_numpy(zero_copy_only=False)
    return values.reshape(-1, width) if width != 1 else values


def load(source: FilePath) -> Arrays:
    path = Path(source)
    must_exist(path / "meta/info.json", "lerobot")
    info = json.loads((path / "meta/info.json").read_text())
    version = info.get("codebase_version", "none")
    if not str(version).startswith("v3"):
        raise FormatError(f"{path}: its version is {version}, but only {_VERSION} can be read; lerobot's scripts convert older versions")
    _, pq = _pyarrow()
    widths = {name: int(np.prod(f["shape"])) for name, f in info["features"].items() if f["dtype"] not in ("image", "video", "string")}
    observed = [name for name in widths if name.startswith("observation.")]
    for name in ("action", "episode_index"):
        if name not in widths:
            raise FormatError(f"{path}: it has no feature {name}")
    if not observed:
        raise FormatError(f"{path}: it has no feature observation.state, nor another observation of numbers")
    known = {*observed, *_OURS, *_INDICES}
    dropped = [name for name in info["features"] if name not in known]
    if dropped:
        warnings.warn(f"{path}: these features have no place in a recording and are left out: {', '.join(dropped)}", stacklevel=3)
    parts: dict[str, list[npt.NDArray[Any]]] = {}
    for file in sorted((path / "data").glob("*/*.parquet")):
        table = pq.read_table(str(file))
        for name in widths:
            if name in known:
                if name not in table.column_names:
                    raise FormatError(f"{file}: it has no column {name}")
                parts.setdefault(name, []).append(_values(table.column(name), widths[name]))
    if not parts:
        raise FormatError(f"{path}: there is no file in data")
    read = {name: np.concatenate(part) for name, part in parts.items()}
    rows = len(read["action"])
    arrays: Arrays = {"obs": np.concatenate([read[name].reshape(rows, -1) for name in observed], axis=1).astype(np.float32),
                      "action": read["action"].reshape(rows, -1), "episode": read["episode_index"].astype(np.int64)}
    for name, ours in _OURS.items():
        if name in read and ours != "action":
            arrays[ours] = read[name].reshape(rows, -1) if ours in ("cost", "label") else read[name]
    arrays.setdefault("cost", np.zeros((rows, 0), np.float32))
    if "reward" not in arrays:
        warnings.warn(f"{path}: it has no next.reward: rewards are NaN, which only cloning can do without", stacklevel=3)
        arrays["reward"] = np.full(rows, np.nan, np.float32)
    done = read["next.done"].astype(bool) if "next.done" in read else np.zeros(rows, bool)
    arrays.setdefault("truncated", np.zeros(rows, bool))
    arrays.setdefault("terminated", done & ~arrays["truncated"].astype(bool))

    episodes = [pq.read_table(str(file)) for file in sorted((path / "meta/episodes").glob("*/*.parquet"))]
    for name, width in (("final_obs", arrays["obs"].shape[1]), ("source", 1)):
        if episodes and all(f"redman/{name}" in table.column_names for table in episodes):
            values = np.concatenate([_values(table.column(f"redman/{name}"), width) for table in episodes])
            arrays[name] = values.reshape(len(values), -1) if name == "final_obs" else values
    if (path / "meta/redman.json").exists():
        said = json.loads((path / "meta/redman.json").read_text())
        if said.get("metadata"):
            arrays["metadata"] = np.array(said["metadata"])
        if said.get("task"):
            arrays["task"] = np.array(said["task"].encode())
        if said.get("layout_hash") is not None:
            arrays["layout_hash"] = np.array(said["layout_hash"], np.uint64)
    return arrays
