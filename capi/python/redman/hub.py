"""Policies and runs on the Hugging Face Hub, each with a card that says what it does. Experimental.

    from redman import hub
    hub.save("runs/first", "share/first")             # the files that would be uploaded, with the card; needs no network
    hub.push("runs/first", "anna/redman-hand-over")   # uploads them; returns the page's address
    policy = hub.pull("anna/redman-hand-over")        # downloads and loads the policy, with its task, options and limits

push and pull need the Python package huggingface_hub, and an account for push. Nothing else of redman opens a connection.
"""
from __future__ import annotations

import json
import os
import shutil
import tempfile
from pathlib import Path
from typing import Any, Mapping, Optional, Union

from ._discovery import build, task
from ._error import ArgumentError, FormatError, StateError
from ._files import MOST_JSON, read_bytes, write_whole
from ._html import number
from ._optional import optional
from ._play import Evaluation, evaluate
from ._policy import Policy
from ._run import Run

Shown = Union[Policy, Run, str, "os.PathLike[str]"]

# What of a run folder is shared: a checkpoint is large and of use for training on alone.
_SHARED = ("policy.rdm", "config.json", "progress.csv")


def _client() -> Any:
    return optional("huggingface_hub", "hub.push and hub.pull", "; hub.save writes the same files without it")


def _shown(given: Shown) -> Union[Policy, Run]:
    if isinstance(given, (Policy, Run)):
        return given
    path = Path(given)
    return Run.load(path) if path.is_dir() and (path / "config.json").exists() and (path / "progress.csv").exists() else Policy.load(path)


def card(given: Shown, evaluation: Optional[Evaluation] = None, repository: str = "USER/NAME") -> str:
    """The card of a run or a policy, in Markdown: what it was learned on and how, an evaluation with its commands, its options
    and limits, and how to play it.

    evaluation: what redman.evaluate has measured; else 100 episodes are played.
    """
    shown = _shown(given)
    options: Mapping[str, Any]
    if isinstance(shown, Run):
        policy, result = shown.policy, evaluation or shown.judged()
        name, algo, options = shown.task, shown.algo, shown.options
        learned = [f"`redman train` learned it with `{algo}`, seed {shown.seed}, in {shown.env_steps:,} control steps."]
    else:
        policy, result, origin = shown, evaluation or evaluate(shown), shown.origin
        name, algo, options = (origin.task, "", origin.options) if origin else (policy.info.task, "", {})
        learned = []
    return "\n".join([
        *_front_matter(name, algo, result), "", f"# {name}" + (f", {algo}" if algo else ""), "",
        f"A policy for the task `{name}` of redman: {_summary(name)}", "", *learned,
        f"It reads {policy.info.obs_dim} numbers, gives {policy.info.action_dim}, and decides every {_steps(policy.info.action_repeat)}.",
        "", "## Evaluation", "",
        f"{result.episodes} episodes by its mean action, with standard errors; redman {build().version}.", "",
        *_table(result), "",
        *(["## Options of the task", "", "| option | value |", "|---|---|", *(f"| `{key}` | `{value}` |" for key, value in options.items()), ""]
          if options else []),
        "## Use", "", "```python", "import redman", "from redman import hub", "", f"policy = hub.pull({json.dumps(repository)})",
        "print(redman.evaluate(policy))", "```", "",
        "The file `policy.rdm` is all that `redman eval --policy policy.rdm --task " + name + "`, a C program and a browser need.", ""])


def _steps(count: int) -> str:
    return "control step" if count == 1 else f"{count} control steps"


def _summary(name: str) -> str:
    try:
        return task(name).summary.rstrip(".") + "."
    except LookupError:  # a task that is not here
        return "a task of its owner's."


def _front_matter(name: str, algo: str, result: Evaluation) -> list[str]:
    """The head that the hub reads; each string in JSON's form, which is YAML too."""
    def metric(kind: str, label: str, mean: float, error: float) -> list[str]:
        return [f"          - type: {kind}", f"            value: {json.dumps(f'{mean:.4g} +/- {error:.2g}')}", f"            name: {json.dumps(label)}"]

    rows = metric("mean_reward", "mean return", result.return_mean, result.return_stderr)
    for label, mean, error in zip(result.cost_names, result.cost_mean, result.cost_stderr):
        rows += metric("mean_cost", f"mean {label}", mean, error)
    rows += metric("success_rate", "share of episodes with success", result.success_rate, result.success_stderr)
    tags = ["reinforcement-learning", "safe-reinforcement-learning", "redman", name, *([algo] if algo else [])]
    return ["---", "library_name: redman", "pipeline_tag: reinforcement-learning", "tags:", *(f"  - {json.dumps(tag)}" for tag in tags),
            "model-index:", f"  - name: {json.dumps(algo or 'policy')}", "    results:", "      - task:",
            "          type: reinforcement-learning", "          name: reinforcement-learning", "        dataset:",
            f"          name: {json.dumps(name)}", f"          type: {json.dumps(name)}", "        metrics:", *rows, "---"]


def _table(result: Evaluation) -> list[str]:
    rows = ["| | mean | limit |", "|---|---|---|", f"| return | {result.return_mean:.4g} +- {result.return_stderr:.2g} | |"]
    for label, mean, error, limit in zip(result.cost_names, result.cost_mean, result.cost_stderr, result.cost_limits):
        rows.append(f"| cost `{label}` | {mean:.4g} +- {error:.2g} | {'none' if limit is None else number(limit)} |")
    for label, value in (("success", result.success_rate), ("a cost over its limit", result.violation_rate), ("a fall", result.fall_rate)):
        rows.append(f"| episodes with {label} | {100 * value:.0f} % | |")
    return [*rows, f"| length, control steps | {result.length_mean:.4g} | |"]


def save(given: Shown, folder: Union[str, os.PathLike[str]], evaluation: Optional[Evaluation] = None,
         repository: str = "USER/NAME") -> Path:
    """Writes what push would upload into a new folder: README.md (the card), policy.rdm and, of a run, config.json and
    progress.csv. Returns the folder. given: a run, its folder, or a policy; evaluation: that the card shows, None: a new one;
    repository: the "user/name" that it names. Paths of this machine that config.json holds go with it: read it first."""
    shown, path = _shown(given), Path(folder)
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise StateError(f"hub.save: {path} is there already: give the name of a new folder")
    text = card(shown, evaluation, repository)
    path.mkdir(parents=True, exist_ok=True)
    if isinstance(shown, Run) and shown.folder is not None:
        for name in _SHARED:
            shutil.copyfile(shown.folder / name, path / name)
    else:
        write_whole(path / "policy.rdm", bytes(shown.policy if isinstance(shown, Run) else shown), "hub.save")
    write_whole(path / "README.md", text.encode(), "hub.save")
    return path


def push(given: Shown, repository: str, *, evaluation: Optional[Evaluation] = None, private: bool = False, token: Optional[str] = None,
         message: str = "redman: a policy with its card") -> str:
    """Uploads a run or a policy to "user/name", which is made if it does not exist, and returns the address of its page.

    given, evaluation: as in save. repository: "user/name". private: for the account alone. message: of the upload. token: of
    the account; else the one that `huggingface-cli login` has kept.
    """
    _named(repository)
    client = _client()
    with tempfile.TemporaryDirectory() as folder:
        save(given, folder, evaluation, repository)
        api = client.HfApi(token=token)
        page = api.create_repo(repository, repo_type="model", private=private, exist_ok=True)
        api.upload_folder(repo_id=repository, folder_path=folder, commit_message=message)
    return str(page)


def pull(repository: str, *, revision: Optional[str] = None, token: Optional[str] = None, imports: bool = False) -> Policy:
    """Downloads a policy of "user/name" and loads it. policy.origin has the task, its options and its limits where a run was
    pushed; files of its own task, robots and objects are part of it.

    revision: a branch, a tag or a commit. token: of the account, for a private one. imports: whether modules of this machine
    may be imported by the names that the repository gives for rewards, costs and tasks in Python; without it, such a repository
    is refused.
    """
    _named(repository)
    folder = Path(_client().snapshot_download(repository, revision=revision, token=token, allow_patterns=list(_SHARED)))
    if not (folder / "policy.rdm").is_file():
        raise FormatError(f"hub.pull: {repository} has no policy.rdm: it is not a policy of redman")
    named = [] if imports else _imported(folder / "config.json")
    if named:
        raise StateError(f"hub.pull: {repository} names code in Python ({', '.join(named)}): give imports=True if you trust it")
    return Policy.load(folder)


def _named(repository: str) -> None:
    user, _, name = repository.partition("/")
    if not user or not name or "/" in name:
        raise ArgumentError(f'hub: a repository is "user/name", not {repository!r}')


def _imported(path: Path) -> list[str]:
    """The members of a config.json that name code."""
    try:
        config: Mapping[str, Any] = json.loads(read_bytes(path, MOST_JSON))
        return [member for member in ("task_class", "own_reward", "own_costs") if config.get(member)]
    except FileNotFoundError:
        return []
    except (ValueError, AttributeError) as error:
        raise FormatError(f"hub.pull: config.json is not a run's: {error!r}") from None
