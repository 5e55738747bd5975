"""The recordings of test_tool_record.sh as numpy sees them."""
import csv
import json
import zipfile

import numpy as np

for name in "random hold demo trained falls".split():
    assert zipfile.ZipFile(f"{name}.npz").testzip() is None, name
    with np.load(f"{name}.npz", allow_pickle=False) as file:
        a = dict(file)
    meta = json.loads(a["metadata"].item())
    steps, episodes, costs = meta["steps"], meta["episodes"], len(meta["costs"])
    obs_dim = meta["fields"][-1]["offset"] + meta["fields"][-1]["count"]
    assert a["obs"].shape == (steps, obs_dim) and a["obs"].dtype == np.float32, name
    assert a["action"].dtype == np.float32 and len(a["action"]) == steps, name
    assert a["final_obs"].shape == (episodes, obs_dim), name
    assert a["cost"].shape == a["cost_raw"].shape == (steps, costs), name
    for key in "terminated truncated success".split():
        assert a[key].dtype == bool and a[key].shape == (steps,), (name, key)
    for key in "episode step env".split():
        assert a[key].dtype == np.int32 and a[key].shape == (steps,), (name, key)
    assert a["seed"] == meta["seed"] and a["seed"].dtype == np.uint64, name
    assert set(meta["arrays"]) == set(a) - {"metadata", "seed"}, (name, set(a) ^ set(meta["arrays"]))
    begin = a["episode_begin"]
    assert begin[0] == 0 and begin[-1] == steps and len(begin) == episodes + 1, name
    assert len(a["state"]) == episodes and a["state"].dtype == np.uint8, name
    assert ("states" in a) == (name == "hold"), name
    for e in range(episodes):
        rows = slice(begin[e], begin[e + 1])
        n = begin[e + 1] - begin[e]
        assert (a["episode"][rows] == e).all() and (a["env"][rows] == e % meta["envs"]).all(), (name, e)
        assert (a["step"][rows] == np.arange(n)).all(), (name, e)
        ends = a["terminated"][rows] | a["truncated"][rows]
        assert ends[-1] and not ends[:-1].any(), (name, e)
        assert abs(a["reward"][rows].astype(float).sum() - a["episode_return"][e]) < 1e-3 * n, (name, e)
        assert np.abs(a["cost"][rows].astype(float).sum(0) - a["episode_cost"][e]).max() < 1e-3 * n, (name, e)
        if "states" in a:
            assert (a["states"][begin[e]] == a["state"][e]).all(), (name, e)
    assert np.abs(a["obs"]).max() > 0 and np.ptp(a["obs"], axis=0).max() > 0, name
    assert meta["control_dt"] > 0 and meta["fields"][0]["unit"], name

meta = json.loads(np.load("hull.npz")["metadata"].item())
assert len(meta["options"]["hull"]) > 64 and "hull=" + meta["options"]["hull"] in meta["set"], meta["options"]
assert meta["options"]["max_steps"] == "5"

# what an action did is in the next observation: the hands' observations hold the last action
a = dict(np.load("random.npz"))
meta = json.loads(a["metadata"].item())
field = next(f for f in meta["fields"] if f["name"] == "right.action")
seen = a["obs"][1:, field["offset"] : field["offset"] + field["count"]]
inside = a["episode"][1:] == a["episode"][:-1]
assert (seen[inside] == a["action"][:-1][inside][:, : field["count"]]).all()
assert a["action"].min() < -0.9 and a["action"].max() > 0.9

# the text has the same numbers
with open("random.csv", newline="") as file:
    rows = list(csv.reader(file))
head, body = rows[0], np.array(rows[1:], dtype=float)
first = head.index("env") + 1
assert (body[:, first : first + a["obs"].shape[1]].astype(np.float32) == a["obs"]).all()
at = head.index("action[0]")
assert (body[:, at : at + a["action"].shape[1]].astype(np.float32) == a["action"]).all()
assert (body[:, head.index("episode")] == a["episode"]).all()
assert np.allclose(np.diff(body[:, 0]), meta["control_dt"], rtol=1e-4)
