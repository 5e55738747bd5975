"""Data sets in the forms that other libraries read: HDF5 of D4RL and DSRL, Minari, LeRobot. Experimental.

    from redman import data
    arrays = data.load("set.npz")                 # a dict of numpy arrays; also .hdf5 of DSRL, .minari and .lerobot folders, .mcap
    data.save(arrays, "set.hdf5")                 # observations, next_observations, actions, rewards, costs, terminals, timeouts
    data.convert("set.npz", "set.minari")         # what `python -m redman data convert set.npz set.minari` does
    data.hash(arrays)                             # the same that `redman data info` prints

HDF5 and Minari need h5py, LeRobot needs pyarrow. A time limit is never stored as a termination. What a form has no place for (labels, all cost columns, who
played) goes into a group or file `redman` of the same set, so that arrays come back to the byte.
"""
from __future__ import annotations

import json
import os
import tempfile
import zlib
from pathlib import Path
from typing import Any, Mapping, Union

import numpy as np
import numpy.typing as npt

from . import _lerobot
from ._error import ArgumentError, FormatError, UsageError
from ._files import must_exist
from ._optional import optional
from ._tool import run_tool

Arrays = dict[str, npt.NDArray[Any]]
FilePath = Union[str, "os.PathLike[str]"]

_FORMAT = "redman data 1"
_FLOATS = ("obs", "action", "label", "reward", "cost")
_FLAGS = ("terminated", "truncated", "success")
_HASHED = ("obs", "action", "label", "reward", "cost", "terminated", "truncated", "success")
_KEPT = ("label", "cost", "success", "final_obs", "source", "layout_hash", "task")


def _h5py() -> Any:
    return optional("h5py", "an HDF5 file", ", or apt-get install python3-h5py")


def _kind(path: FilePath) -> str:
    end = Path(path).suffix.lower()
    kind = {".npz": "npz", ".mcap": "mcap", ".hdf5": "dsrl", ".h5": "dsrl", ".minari": "minari",
            ".lerobot": "lerobot"}.get(end)
    if kind is None:
        raise ArgumentError(f"{os.fspath(path)}: its name does not end in .npz, .mcap, .hdf5, .h5, .minari or .lerobot")
    return kind


def _ends(arrays: Arrays) -> npt.NDArray[np.bool_]:
    ends: npt.NDArray[np.bool_] = arrays["terminated"].astype(bool) | arrays["truncated"].astype(bool)
    return ends


def _begins(episode: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    """The first row of each episode, and the number of rows."""
    changes = np.flatnonzero(np.diff(episode)) + 1
    return np.concatenate([[0], changes, [len(episode)]]).astype(np.int64)


def _completed(given: Arrays, what: str) -> Arrays:
    """The arrays of a set, checked, of their types, with rows in the order of their episodes."""
    if not isinstance(given, Mapping):
        raise UsageError(f"{what}: it must be a dict of arrays by name, as redman.data.load(path) returns it, not {given!r}")
    for name in ("obs", "action", "reward", "cost", "terminated", "truncated"):
        if name not in given:
            raise FormatError(f"{what}: it has no array {name}")
    arrays = dict(given)
    rows = len(arrays["obs"])
    for name in _FLOATS:
        if name in arrays:
            arrays[name] = np.ascontiguousarray(arrays[name], np.float32)
    arrays.setdefault("success", np.zeros(rows, bool))
    for name in _FLAGS:
        arrays[name] = np.ascontiguousarray(arrays[name], bool)
    if "episode" not in arrays:
        arrays["episode"] = np.concatenate([[0], np.cumsum(_ends(arrays))[:-1]]) if rows else np.zeros(0)
    arrays["episode"] = arrays["episode"].astype(np.int64)
    for name in (*_FLOATS, *_FLAGS, "episode"):
        if name in arrays and len(arrays[name]) != rows:
            raise FormatError(f"{what}: {name} has {len(arrays[name])} rows, but obs has {rows}")
    if np.any(np.diff(arrays["episode"]) < 0):
        order = np.argsort(arrays["episode"], kind="stable")
        for name in (*_FLOATS, *_FLAGS, "episode"):
            if name in arrays:
                arrays[name] = arrays[name][order]
    arrays["episode_begin"] = _begins(arrays["episode"])
    lengths = np.diff(arrays["episode_begin"])
    arrays["episode"] = np.repeat(np.arange(len(lengths)), lengths).astype(np.int64)
    for name in ("final_obs", "source"):
        if name in arrays and len(arrays[name]) != len(lengths):
            raise FormatError(f"{what}: {name} has {len(arrays[name])} rows, but there are {len(lengths)} episodes")
    return arrays


def unfinished(arrays: Arrays) -> list[int]:
    """The episodes of the arrays of a set without an end: their last row is neither terminated nor truncated."""
    return [int(e) for e in np.flatnonzero(~_ends(arrays)[arrays["episode_begin"][1:] - 1])]


def without(arrays: Arrays, episodes: list[int]) -> Arrays:
    """The arrays of a set without these episodes."""
    keep = ~np.isin(arrays["episode"], episodes)
    stay = ~np.isin(np.arange(len(arrays["episode_begin"]) - 1), episodes)
    out = dict(arrays)
    for name in (*_FLOATS, *_FLAGS, "episode"):
        if name in out:
            out[name] = out[name][keep]
    for name in ("final_obs", "source"):
        if name in out:
            out[name] = out[name][stay]
    return _completed(out, "data")


def hash(arrays: Union[Arrays, FilePath]) -> str:
    """The hash of the numbers of the arrays of a set, or of the set at a path, alone: 16 hexadecimal digits, as `redman data info`
    prints it."""
    arrays = load(arrays) if isinstance(arrays, (str, os.PathLike)) else _completed(arrays, "arrays")
    value = 14695981039346656037

    def add(data: bytes) -> None:
        nonlocal value
        for byte in data:
            value = (value ^ byte) * 1099511628211 % 2**64

    checks = {name: zlib.crc32(arrays[name].tobytes()) for name in _HASHED if name in arrays}
    checks["length"] = zlib.crc32(np.diff(arrays["episode_begin"]).astype("<u4").tobytes())
    for name, check in checks.items():
        add(name.encode() + check.to_bytes(4, "little"))
    return f"{value:016x}"


def _text(arrays: Arrays, name: str) -> str:
    value = arrays[name].item() if name in arrays else ""
    return value.decode() if isinstance(value, bytes) else str(value)


# ---- .npz -----------------------------------------------------------------------------------------------------------

def _load_npz(path: FilePath) -> Arrays:
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _save_npz(arrays: Arrays, path: FilePath) -> None:
    names = ("metadata", "task", "layout_hash", "episode_begin", "episode", *_FLOATS, *_FLAGS, "final_obs", "source")
    np.savez(path, **{name: arrays[name] for name in names if name in arrays})


# ---- D4RL and DSRL --------------------------------------------------------------------------------------------------

def _next_obs(arrays: Arrays) -> npt.NDArray[np.float32]:
    begin = arrays["episode_begin"]
    out = np.empty_like(arrays["obs"])
    out[:-1] = arrays["obs"][1:]
    last = begin[1:] - 1
    out[last] = arrays["final_obs"] if "final_obs" in arrays else arrays["obs"][last]
    return out


def _save_dsrl(arrays: Arrays, path: FilePath) -> None:
    if "final_obs" not in arrays and not np.all(arrays["terminated"][arrays["episode_begin"][1:] - 1]):
        raise ArgumentError("next_observations: the set has no final_obs, so what the last rows led to is unknown; `redman data make` and "
                            "`redman rollout --record` keep it")
    cost = arrays["cost"]
    with _h5py().File(path, "w") as file:
        file["observations"] = arrays["obs"]
        file["next_observations"] = _next_obs(arrays)
        file["actions"] = arrays["action"]
        file["rewards"] = arrays["reward"]
        file["costs"] = cost[:, 0] if cost.shape[1] else np.zeros(len(cost), np.float32)
        file["terminals"] = arrays["terminated"]
        file["timeouts"] = arrays["truncated"] & ~arrays["terminated"]
        file.attrs["format"] = _FORMAT
        file.attrs["metadata"] = _text(arrays, "metadata")
        for name in _KEPT:
            if name in arrays:
                file[f"redman/{name}"] = arrays[name]


def _load_dsrl(path: FilePath) -> Arrays:
    with _h5py().File(path, "r") as file:
        for name in ("observations", "actions", "rewards", "terminals"):
            if name not in file:
                raise FormatError(f"{os.fspath(path)}: it has no data set {name}, so it is not of D4RL's form")
        rows = len(file["observations"])
        arrays: Arrays = {"obs": file["observations"][()], "action": file["actions"][()], "reward": file["rewards"][()],
                          "terminated": file["terminals"][()].astype(bool)}
        timeouts = file["timeouts"][()].astype(bool) if "timeouts" in file else np.zeros(rows, bool)
        arrays["truncated"] = timeouts & ~arrays["terminated"]
        arrays["cost"] = file["costs"][()].reshape(rows, 1) if "costs" in file else np.zeros((rows, 0), np.float32)
        if "metadata" in file.attrs and file.attrs["metadata"]:
            arrays["metadata"] = np.array(file.attrs["metadata"])
        for name in _KEPT:
            if f"redman/{name}" in file:
                arrays[name] = np.asarray(file[f"redman/{name}"][()])
        ends = arrays["terminated"] | arrays["truncated"]
        if "final_obs" not in arrays and "next_observations" in file and rows:
            last = np.flatnonzero(ends if ends[-1] else np.append(ends[:-1], True))
            arrays["final_obs"] = np.asarray(file["next_observations"][()][last], np.float32)
    return arrays


# ---- Minari ---------------------------------------------------------------------------------------------------------

def _box(width: int, bound: float) -> str:
    return json.dumps({"type": "Box", "dtype": "float32", "shape": [width], "low": [-bound] * width, "high": [bound] * width})


def _save_minari(arrays: Arrays, path: FilePath) -> None:
    if "final_obs" not in arrays:
        raise ArgumentError("minari: the set has no final_obs, which its episodes end with")
    task = _text(arrays, "task") or "unknown"
    folder = Path(path) / "data"
    begin = arrays["episode_begin"]
    episodes = len(begin) - 1
    spec = {"dataset_id": f"redman/{task}-v0", "total_episodes": episodes, "total_steps": len(arrays["obs"]), "data_format": "hdf5",
            "minari_version": "0.5.0", "author": "redman", "algorithm_name": "mixture", "code_permalink": "",
            "observation_space": _box(arrays["obs"].shape[1], float(np.finfo(np.float32).max)), "action_space": _box(arrays["action"].shape[1], 1.0),
            "redman": {"format": _FORMAT, "metadata": _text(arrays, "metadata")}}
    h5py = _h5py()
    folder.mkdir(parents=True, exist_ok=True)
    with h5py.File(folder / "main_data.hdf5", "w") as file:
        file.attrs["total_episodes"], file.attrs["total_steps"] = episodes, len(arrays["obs"])
        for e in range(episodes):
            rows = slice(begin[e], begin[e + 1])
            group = file.create_group(f"episode_{e}")
            group.attrs["id"], group.attrs["total_steps"] = e, rows.stop - rows.start
            group["observations"] = np.concatenate([arrays["obs"][rows], arrays["final_obs"][e:e + 1]])
            group["actions"], group["rewards"] = arrays["action"][rows], arrays["reward"][rows]
            group["terminations"], group["truncations"] = arrays["terminated"][rows], arrays["truncated"][rows]
            for name in ("cost", "success", "label"):
                if name in arrays:
                    group[f"infos/{name}"] = arrays[name][rows]
            if "source" in arrays:
                group.attrs["source"] = int(arrays["source"][e])
        for name in ("layout_hash", "task"):
            if name in arrays:
                file.attrs[name] = arrays[name]
    (folder / "metadata.json").write_text(json.dumps(spec, indent=1))


def _load_minari(path: FilePath) -> Arrays:
    folder = Path(path) / "data"
    must_exist(folder / "main_data.hdf5", "minari")
    parts: dict[str, list[npt.NDArray[Any]]] = {}
    with _h5py().File(folder / "main_data.hdf5", "r") as file:
        count = int(file.attrs["total_episodes"])
        finals, sources = [], []
        for e in range(count):
            group = file[f"episode_{e}"]
            seen = group["observations"][()]
            finals.append(seen[-1])
            sources.append(group.attrs.get("source"))
            columns = {"obs": seen[:-1], "action": group["actions"][()], "reward": group["rewards"][()],
                       "terminated": group["terminations"][()], "truncated": group["truncations"][()],
                       "episode": np.full(len(seen) - 1, e)}
            infos = group["infos"] if "infos" in group else {}
            columns["cost"] = infos["cost"][()] if "cost" in infos else np.zeros((len(seen) - 1, 0), np.float32)
            if columns["cost"].ndim == 1:  # some keep the observation's place of the reset too
                columns["cost"] = columns["cost"][-(len(seen) - 1):, None]
            for name in ("success", "label"):
                if name in infos:
                    columns[name] = infos[name][()]
            for name, part in columns.items():
                parts.setdefault(name, []).append(part)
        kept = {name: np.asarray(file.attrs[name]) for name in ("layout_hash", "task") if name in file.attrs}
    arrays: Arrays = {name: np.concatenate(rows) for name, rows in parts.items()}
    arrays["final_obs"] = np.stack(finals).astype(np.float32)
    if all(s is not None for s in sources):
        arrays["source"] = np.array(sources, np.uint8)
    arrays.update(kept)
    if (folder / "metadata.json").exists():
        said = json.loads((folder / "metadata.json").read_text()).get("redman", {}).get("metadata", "")
        if said:
            arrays["metadata"] = np.array(said)
    return arrays


# ---- any ------------------------------------------------------------------------------------------------------------

def load(path: FilePath) -> Arrays:
    """The arrays of the set at path: obs, action, reward, cost [rows][costs], terminated, truncated, success, episode,
    episode_begin, and where it has them label, final_obs, source, metadata, task, layout_hash. The form follows from the
    name."""
    kind = _kind(path)
    must_exist(path, "data set")
    if kind == "mcap":
        with tempfile.TemporaryDirectory() as folder:
            run_tool("data", "convert", "--keep-unfinished", os.fspath(path), f"{folder}/set.npz", why="a data set of an MCAP file")
            return _completed(_load_npz(f"{folder}/set.npz"), os.fspath(path))
    read = {"npz": _load_npz, "dsrl": _load_dsrl, "minari": _load_minari, "lerobot": _lerobot.load}[kind]
    return _completed(read(path), os.fspath(path))


def save(arrays: Arrays, path: FilePath) -> None:
    """Writes the arrays of a set to path, in the form that follows from the name: .npz, .hdf5 or .h5 (D4RL and DSRL), .minari
    and .lerobot (folders), .mcap."""
    kind = _kind(path)
    arrays = _completed(arrays, "arrays")
    if kind == "mcap":
        with tempfile.TemporaryDirectory() as folder:
            _save_npz(arrays, f"{folder}/set.npz")
            run_tool("data", "convert", "--keep-unfinished", f"{folder}/set.npz", os.fspath(path), why="an MCAP file")
        return
    {"npz": _save_npz, "dsrl": _save_dsrl, "minari": _save_minari,
     "lerobot": _lerobot.save}[kind](arrays, path)


def convert(source: FilePath, target: FilePath, keep_unfinished: bool = False) -> dict[str, Any]:
    """Reads the set at source in its form and writes it to target in another; returns what was written. Episodes without an end
    are left out and listed in left_out, unless keep_unfinished."""
    arrays = load(source)
    left_out = [] if keep_unfinished else unfinished(arrays)
    if left_out:
        arrays = without(arrays, left_out)
    save(arrays, target)
    return {"file": os.fspath(target), "rows": len(arrays["obs"]), "episodes": len(arrays["episode_begin"]) - 1, "left_out": left_out,
            "hash": hash(arrays)}


def score(ret: float, cost: float, low: float, high: float, limit: float) -> tuple[float, float]:
    """Normalised return and cost of a policy with mean return `ret` = R: (R - low) / (high - low) by the least and largest
    return of the data set's episodes (return_min and return_max of its metadata), and C / limit, which is at most 1 for a safe
    policy."""
    if not high > low:
        raise ArgumentError(f"high: {high} is not above low, {low}")
    if not limit > 0:
        raise ArgumentError(f"limit: {limit} is not above 0")
    return (ret - low) / (high - low), cost / limit


def main(words: list[str]) -> int:
    """`python -m redman data convert FROM TO [--keep-unfinished] [--json]`, for formats that the tool does not know."""
    import argparse
    parser = argparse.ArgumentParser(prog="python -m redman data convert", description=convert.__doc__)
    parser.add_argument("source", metavar="FROM")
    parser.add_argument("target", metavar="TO")
    parser.add_argument("--keep-unfinished", action="store_true", help="also take episodes without an end")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    given = parser.parse_args(words)
    done = convert(given.source, given.target, given.keep_unfinished)
    if given.json:
        print(json.dumps(done))
    else:
        print(f"wrote {done['file']}: {done['rows']} rows in {done['episodes']} episodes, hash {done['hash']}")
        if done["left_out"]:
            print(f"left out, because they have no end: {len(done['left_out'])} episodes: {done['left_out'][:20]}")
    return 0
