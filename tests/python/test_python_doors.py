"""One policy, one number: every door by which a policy can be played gives the same episodes, to the bit, whatever a step of
the worlds is, whatever the options, whatever center actions are about, and wherever the policy comes from."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import numpy as np

import redman
import stubs
from redman import gym, safety

stubs.sb3()
stubs.omnisafe()
from redman import omnisafe, sb3  # noqa: E402

TREE = Path(__file__).resolve().parents[2]
TOOL = os.environ.get("REDMAN_TOOL")
COMPILER = shutil.which("cc")
TASK = "hand_over_safe_finger"
SEED, EPISODES = 11, 3
REPEATS = (1, 2, 4)
OPTIONS = ({}, {"object": "tennis_ball", "reward_scale": 2}, {"object_mass": (0.03, 0.09), "object_scale": (0.95, 1.05)})
CENTERS = (None, "initial")


def texts(options):
    """As the tool and C take options."""
    from redman._options import shown
    return [f"{key}={shown(key, value)}" for key, value in options.items()]


class Episode:
    """What a door says of an episode: return, costs, control steps, and the last observation where it shows it."""

    def __init__(self, ret, cost, length, last=None):
        self.ret, self.cost, self.length, self.last = float(ret), [float(c) for c in cost], int(length), last

    def numbers(self):
        return [self.ret, *self.cost, self.length]


def of_pool(pool, i, last):
    return Episode(pool.episode_return[i], pool.episode_cost[i], pool.episode_step[i], last[i].copy())


# ---- the doors: policy, options, where the policy stands (a word for the tool) -> one Episode for each seed ----------

def by_tool(policy, options, word):
    out = []
    for s in range(SEED, SEED + EPISODES):
        sets = [part for text in texts(options) for part in ("--set", text)]
        said = json.loads(subprocess.run([TOOL, "eval", "--policy", word, "--task", TASK, "--episodes", "1", "--envs", "1",
                                          "--seed", str(s), "--json", *sets], check=True, capture_output=True).stdout)
        out.append(Episode(said["return_mean"], said["cost_mean"], said["length_mean"]))
    return out


def by_evaluate(policy, options, word):
    player = policy if word.endswith(".rdm") else word
    out = []
    for s in range(SEED, SEED + EPISODES):
        e = redman.evaluate(player, episodes=1, num_envs=1, seed=s, options=options)
        out.append(Episode(e.return_mean, e.cost_mean, e.length_mean))
    return out


def by_pool(policy, options, word, autoreset="off"):
    with redman.Pool(TASK, EPISODES, autoreset=autoreset, options=options) as pool:
        pool.reset(seeds=SEED)
        actor = policy.actor(pool)
        out = [None] * EPISODES
        while None in out:
            live = np.array([e is None for e in out])
            pool.step(actor(pool.obs), mask=live if autoreset == "off" else None)
            for i in np.flatnonzero((pool.terminated | pool.truncated) & live):
                out[i] = of_pool(pool, i, pool.final_obs)
        return out


def by_env(policy, options, word, center=None, kind=gym.Env):
    out = []
    env = kind(TASK, options=options, center=center)
    actor = policy.actor(env)
    for s in range(SEED, SEED + EPISODES):
        obs, _ = env.reset(seed=s)
        ended, cost = False, 0.0
        while not ended:
            obs, *told, terminated, truncated, info = env.step(actor(obs))
            ended = terminated or truncated
            cost += info["cost_sum"] if kind is safety.Env else info["costs"]
        out.append(of_pool(env.pool, 0, env.worlds.obs))
        told = np.atleast_1d(cost)  # what the door itself said
        assert told.tolist() == out[-1].cost[:len(told)], (told, out[-1].cost)
    env.close()
    return out


def by_vector(policy, options, word, center=None, mode="NextStep", kind=gym.VectorEnv):
    more = {} if kind is safety.VectorEnv else {"autoreset_mode": mode}
    env = kind(TASK, EPISODES, options=options, center=center, **more)
    obs, _ = env.reset(seed=SEED)
    actor = policy.actor(env)
    out = [None] * EPISODES
    while None in out:
        obs, *_, terminated, truncated, info = env.step(actor(obs))
        for i in np.flatnonzero(terminated | truncated):
            out[i] = out[i] or of_pool(env.pool, i, env.pool.final_obs)
        if mode == "Disabled" and (terminated | truncated).any():
            obs, _ = env.reset(options={"reset_mask": terminated | truncated})
    env.close()
    return out


def by_sb3(policy, options, word, center=None):
    env = sb3.VecEnv(TASK, EPISODES, options=options, center=center)
    env.seed(SEED)
    obs = env.reset()
    actor = policy.actor(env)
    out, cost = [None] * EPISODES, np.zeros((EPISODES, env.pool.cost_dim))
    while None in out:
        obs, _, ended, infos = env.step(actor(obs))
        for i, info in enumerate(infos):
            cost[i] += info["costs"]
        for i in np.flatnonzero(ended):
            if out[i] is None:
                out[i] = of_pool(env.pool, i, env.pool.final_obs)
                assert cost[i].tolist() == out[i].cost
    env.close()
    return out


def by_sb3_predict(policy, options, word):
    """As evaluate_policy calls a model."""
    env = sb3.VecEnv(TASK, EPISODES, options={**options, "action_repeat": 1})
    env.seed(SEED)
    obs, states, starts = env.reset(), None, np.ones(EPISODES, bool)
    out = [None] * EPISODES
    while None in out:
        actions, states = policy.predict(obs, state=states, episode_start=starts, deterministic=True)
        obs, _, starts, _ = env.step(actions)
        for i in np.flatnonzero(starts):
            out[i] = out[i] or of_pool(env.pool, i, env.pool.final_obs)
    env.close()
    return out


def by_omnisafe(policy, options, word, center=None):
    env = omnisafe.Redman(omnisafe.env_id(TASK), EPISODES, options=options, action_repeat=1, center=center)
    env.set_seed(SEED)
    obs, _ = env.reset()
    actor = policy.actor(env)
    pool = env._worlds.pool
    out = [None] * EPISODES
    while None in out:
        obs, _, _, terminated, truncated, _ = env.step(actor(obs))
        for i in np.flatnonzero(np.asarray(terminated) + np.asarray(truncated) > 0):
            out[i] = out[i] or of_pool(pool, i, pool.final_obs)
    env.close()
    return out


def by_c(policy, options, word):
    file = word if word.endswith(".rdm") else os.path.join(word, "policy.rdm")
    lines = subprocess.run([DOORS.host, file, TASK, str(SEED), str(EPISODES), "\n".join(texts(options))], check=True,
                           capture_output=True, text=True).stdout.splitlines()
    rows = [line.split() for line in lines]
    return [Episode(float.fromhex(row[0]), map(float.fromhex, row[2:]), row[1]) for row in rows]


def doors():
    yield "pool", by_pool
    for mode in ("same_step", "next_step"):
        yield f"pool {mode}", lambda *a, mode=mode: by_pool(*a, autoreset=mode)
    yield "evaluate", by_evaluate
    if TOOL:
        yield "tool", by_tool
    if DOORS.host:
        yield "c", by_c
    yield "predict", by_sb3_predict
    for center in CENTERS:
        about = "" if center is None else " about " + center
        yield f"gym.Env{about}", lambda *a, c=center: by_env(*a, center=c)
        yield f"safety.Env{about}", lambda *a, c=center: by_env(*a, center=c, kind=safety.Env)
        for mode in ("NextStep", "SameStep", "Disabled"):
            yield f"gym.VectorEnv {mode}{about}", lambda *a, c=center, m=mode: by_vector(*a, center=c, mode=m)
        yield f"safety.VectorEnv{about}", lambda *a, c=center: by_vector(*a, center=c, mode="", kind=safety.VectorEnv)
        yield f"sb3.VecEnv{about}", lambda *a, c=center: by_sb3(*a, center=c)
        yield f"omnisafe{about}", lambda *a, c=center: by_omnisafe(*a, center=c)


class DOORS:
    """What the tests share: the host in C, and runs with each set of options."""

    folder = host = None


def setUpModule():
    warnings.simplefilter("error", redman.HoldWarning)
    DOORS.folder = Path(tempfile.mkdtemp())
    library = os.environ.get("REDMAN_LIBRARY")
    if COMPILER and library:
        DOORS.host = str(DOORS.folder / "host")
        subprocess.run([COMPILER, "-std=c11", f"-I{TREE}/include", f"{TREE}/tests/python/actor_host.c", library,
                        f"-Wl,-rpath,{Path(library).parent}", "-o", DOORS.host], check=True)
    for k, options in enumerate(OPTIONS):
        redman.train(TASK, steps=4096, envs=8, seed=k, eval_every=100, options={**options, "horizon": 16}, progress=False,
                     out=DOORS.folder / f"run{k}")


def tearDownModule():
    shutil.rmtree(DOORS.folder)


class Doors(unittest.TestCase):
    def test_all_doors_play_the_same_episodes(self):
        compared, largest, differ = 0, 0.0, []
        shipped = redman.Policy.trained(TASK)
        file = next(f / f"{TASK}.rdm" for f in redman._library.policy_folders() if (f / f"{TASK}.rdm").is_file())
        self.assertEqual(shipped.info.action_repeat, 4)
        for k, options in enumerate(OPTIONS):
            folder = str(DOORS.folder / f"run{k}")
            # of a file, which knows no options, and of a run folder, which does
            for policy, word in ((shipped, str(file)), (redman.Policy.load(folder), folder)):
                first = None
                for repeat in REPEATS:
                    said = {**options, "action_repeat": repeat}
                    for name, door in doors():
                        # doors that read a folder are told the step alone
                        knows = word == folder and name in ("tool", "evaluate")
                        episodes = door(policy, {"action_repeat": repeat} if knows else said, word)
                        if first is None:
                            first = episodes
                        for one, other in zip(first, episodes):
                            a, b = np.array(one.numbers()), np.array(other.numbers())
                            difference = np.abs(a - b).max() if a.shape == b.shape else np.inf
                            if one.last is not None and other.last is not None:
                                difference = max(difference, np.abs(one.last - other.last).max())
                            compared, largest = compared + 1, max(largest, difference)
                            if difference != 0:
                                differ.append((name, repeat, k, word, difference))
        print(f"doors: {len(list(doors()))}, comparisons of episodes: {compared}, largest difference: {largest}",
              file=sys.stderr)
        self.assertEqual(differ, [])

    @unittest.skipUnless(TOOL, "the command-line tool was not built")
    def test_a_folder_has_one_number(self):
        for k in range(len(OPTIONS)):
            folder = DOORS.folder / f"run{k}"
            said = json.loads(subprocess.run([TOOL, "eval", "--policy", folder, "--episodes", "20", "--json"], check=True,
                                             capture_output=True).stdout)
            for player in (folder, str(folder), folder / "policy.rdm", redman.Policy.load(folder)):
                e = redman.evaluate(player, episodes=20)
                self.assertEqual((e.return_mean, e.cost_mean, e.length_mean, e.violation_rate, e.feasible),
                                 (said["return_mean"], said["cost_mean"], said["length_mean"], said["violation_rate"],
                                  said["feasible"]))
                self.assertEqual([-1 if limit is None else limit for limit in e.cost_limits], said["cost_limits"])

    @unittest.skipUnless(TOOL, "the command-line tool was not built")
    def test_a_run_whose_pool_steps_faster_is_the_tools(self):
        for task, more in ((TASK, {"object": "tennis_ball"}), ("ball_run", {"cost_signal": "raw"}), ("jenga", {"preset": "real"})):
            with tempfile.TemporaryDirectory() as folder:
                ours, theirs = Path(folder, "a"), Path(folder, "b")
                options = {"action_repeat": 2, "horizon": 16, **more}
                run = redman.train(task, steps=6000, envs=8, seed=4, eval_every=5, options=options, cost_limits=20,
                                   progress=False, out=ours)
                sets = [part for text in texts(options) for part in ("--set", text)]
                said = json.loads(subprocess.run(
                    [TOOL, "train", "--task", task, "--steps", "6000", "--envs", "8", "--seed", "4", "--eval-every", "5",
                     "--checkpoint-every", "5", "--cost-limit", "20", "--out", theirs, "--json", *sets], check=True,
                    capture_output=True).stdout)
                self.assertEqual(Path(ours, "policy.rdm").read_bytes(), Path(theirs, "policy.rdm").read_bytes())
                report = run.evaluate(seed=4 + 1_000_000)
                self.assertEqual((report.return_mean, report.cost_mean[0]), (said["return"], said["cost"]))
                here = run.evaluate()
                for each in (ours, theirs):
                    self.assertEqual(redman.evaluate(each), here)
                    there = json.loads(subprocess.run([TOOL, "eval", "--policy", each, "--json"], check=True,
                                                      capture_output=True).stdout)
                    self.assertEqual((there["return_mean"], there["cost_mean"]), (here.return_mean, here.cost_mean))
                # the costs of a run are the same sums whatever a step is
                self.assertEqual(redman.evaluate(ours, options={"action_repeat": 1}), here)

    def test_what_does_not_divide_is_refused_with_both_numbers(self):
        policy = redman.Policy.trained(TASK)
        for repeat in (3, 8):
            with redman.Pool(TASK, options={"action_repeat": repeat}) as pool:
                with self.assertRaisesRegex(redman.ArgumentError, f"every 4 control steps, which is not a multiple of a step of {repeat}"):
                    policy.actor(pool)
                with self.assertRaisesRegex(redman.ArgumentError, "every 4"):
                    redman.evaluate(policy, options={"action_repeat": repeat})


class Linear:
    """A model of another library: actions about the center of its environment, from what its environment shows."""

    def __init__(self, env, dim, wide):
        self.env, self.calls = env, 0
        rng = np.random.default_rng(5)
        self.weight = rng.normal(0, 0.05, (wide, dim)).astype(np.float32)

    def get_env(self):
        return self.env

    def predict(self, obs, state=None, episode_start=None, deterministic=False):
        self.calls += 1
        assert deterministic
        return np.clip(np.asarray(obs) @ self.weight, -1, 1), state


class Models(unittest.TestCase):
    def by_hand(self, env, model):
        obs = env.reset()
        out = [None] * env.num_envs
        while None in out:
            obs, _, ended, _ = env.step(model.predict(obs, deterministic=True)[0])
            for i in np.flatnonzero(ended):
                out[i] = out[i] or float(env.pool.episode_return[i])
        return out

    def test_a_model_is_judged_in_the_units_that_it_learned_in(self):
        options = {"object": "tennis_ball"}
        env = sb3.VecEnv(TASK, 4, seed=2, options=options, action_repeat="task", center="initial")
        model = Linear(env, env.pool.action_dim, env.pool.obs_dim)
        returns = []
        for s in range(3):
            env.seed(s)
            returns.append(self.by_hand(sb3_alone(env, s, options), model)[0])
        # it knows by its environment; a function is told
        known = [redman.evaluate(model, episodes=1, num_envs=1, seed=s).return_mean for s in range(3)]
        told = [redman.evaluate(lambda obs: model.predict(obs, deterministic=True)[0], TASK, 1, 1, s, options=options,
                                action_repeat="task", center="initial").return_mean for s in range(3)]
        plain = [redman.evaluate(lambda obs: model.predict(obs, deterministic=True)[0], TASK, 1, 1, s,
                                 options=options).return_mean for s in range(3)]
        self.assertEqual(known, returns)
        self.assertEqual(told, returns)
        self.assertNotEqual(plain, returns)
        env.close()

    def test_words_that_stand_for_nobody_are_refused(self):
        for word, text in (("hodl", "nearest is hold"), ("/no/such/run", "no file or folder"), (3, "give a policy, .*not 3")):
            with self.assertRaisesRegex(redman.Error, text):
                redman.evaluate(word, TASK)
        with self.assertRaisesRegex(redman.ArgumentError, "center"):
            redman.evaluate("trained", TASK, center="initial")


def sb3_alone(env, seed, options):
    one = sb3.VecEnv(TASK, 1, seed=seed, options=options, action_repeat="task", center="initial")
    return one


class Loops(unittest.TestCase):
    """The loop that everybody writes first."""

    def setUp(self):
        self.policy = redman.Policy.trained(TASK)

    def heard(self, play):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            play()
        return [w for w in said if issubclass(w.category, redman.HoldWarning)]

    def test_a_decision_at_every_step_is_warned_of_once(self):
        pool = redman.Pool(TASK, 2)
        pool.reset()
        said = self.heard(lambda: [pool.step(self.policy.act(pool.obs)) for _ in range(9)])
        self.assertEqual(len(said), 1)
        self.assertRegex(str(said[0].message), "held 4 control steps.*policy.actor")
        self.assertEqual(said[0].filename, __file__)

        env = gym.Env(TASK)
        obs, _ = env.reset(seed=1)
        self.assertEqual(len(self.heard(lambda: [env.step(self.policy(env.worlds.obs[0])) for _ in range(9)])), 1)
        about = gym.VectorEnv(TASK, 2, action_repeat="task", center="initial")
        obs, _ = about.reset(seed=1)
        said = self.heard(lambda: about.step(self.policy.act(obs)))
        self.assertRegex(str(said[0].message), "center")

    def test_what_is_held_is_not_warned_of(self):
        def by_hand(pool, steps, every):
            pool.reset()
            for t in range(steps):
                if t % every == 0:
                    action = self.policy.act(pool.obs)
                pool.step(action)
        for autoreset in ("same_step", "next_step"):
            self.assertEqual(self.heard(lambda: by_hand(redman.Pool(TASK, 2, autoreset=autoreset), 70, 4)), [])
        self.assertEqual(self.heard(lambda: by_hand(redman.Pool(TASK, 2, options={"action_repeat": 4}), 60, 1)), [])
        pool = redman.Pool(TASK, 2)
        pool.reset()
        actor = self.policy.actor(pool)
        self.assertEqual(self.heard(lambda: [pool.step(actor()) for _ in range(90)]), [])

    def test_predict_without_its_state_is_warned_of(self):
        obs = np.zeros((2, self.policy.info.obs_dim), np.float32)
        self.assertEqual(self.heard(lambda: self.policy.predict(obs)), [])
        self.assertEqual(len(self.heard(lambda: [self.policy.predict(obs) for _ in range(3)])), 1)
        state, held = None, []
        for _ in range(8):
            action, state = self.policy.predict(obs, state, None if state else np.ones(2, bool))
            held.append(action)
            obs = obs + np.float32(0.1)
        self.assertEqual([np.array_equal(held[t], held[t - 1]) for t in range(1, 8)], [True] * 3 + [False] + [True] * 3)

    def test_an_actor_refuses_what_a_wrapper_changed(self):
        env = gym.Env(TASK)
        obs, _ = env.reset(seed=1)
        actor = self.policy.actor(env)
        with self.assertRaisesRegex(redman.ArgumentError, "wrapper"):
            actor(obs * 2)
        alone = self.policy.actor(num_envs=1)
        np.testing.assert_array_equal(actor(obs), alone(obs))
        with self.assertRaisesRegex(redman.ArgumentError, "num_envs"):
            self.policy.actor(object())
        with self.assertRaisesRegex(redman.ArgumentError, "either a pool or environment, or num_envs"):
            self.policy.actor()

    def test_named_and_pictured_observations_are_taken(self):
        for more in ({"named": True}, {"options": {"modality": "depth", "image_width": 8, "image_height": 8}}):
            env = gym.Env(TASK, **more)
            obs, _ = env.reset(seed=1)
            plain = gym.Env(TASK)
            row, _ = plain.reset(seed=1)
            np.testing.assert_array_equal(self.policy.actor(env)(obs), self.policy.actor(plain)(row))

    def test_a_state_goes_on_with_the_same_bytes(self):
        pool = redman.Pool(TASK, 3)
        pool.reset()
        actor = self.policy.actor(pool, stochastic=True, seed=3)
        for _ in range(6):
            pool.step(actor())
        other = self.policy.actor(pool, stochastic=True, seed=9)
        other.set_state(actor.state())
        for _ in range(9):
            np.testing.assert_array_equal(actor(), other())
            pool.step(actor.policy.act(pool.obs) * 0)


if __name__ == "__main__":
    unittest.main()
