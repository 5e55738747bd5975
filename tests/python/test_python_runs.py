"""train is `redman train`: one kind of run folder, of Python and of the command, each continued by the other; teachers, budgets,
callbacks, several runs."""
import importlib.util
import json
import os
import shutil
import subprocess
import sys
import tempfile
import threading
import types
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

import redman
from redman import callbacks

TOOL = os.environ.get("REDMAN_TOOL")
NEEDS_TOOL = unittest.skipUnless(TOOL, "the command-line tool was not built")
TASK = "ball_run"
# 2000 control steps an epoch, evaluated after each second one
SMALL = {"steps": 12000, "seed": 3, "envs": 16, "eval_every": 2, "checkpoint_every": 3, "threads": 0, "progress": False,
         "options": {"horizon": 125}}
WORDS = ("--steps", 12000, "--seed", 3, "--envs", 16, "--eval-every", 2, "--checkpoint-every", 3, "--set", "horizon=125")


def tool(*words):
    return subprocess.run([TOOL, *map(str, words)], capture_output=True, text=True)


def told(*words):
    done = tool(*words)
    if done.returncode:
        raise AssertionError(done.stderr)
    return done


def rows(folder):
    """progress.csv without times."""
    lines = Path(folder, "progress.csv").read_text().splitlines()
    names = lines[0].split(",")
    keep = [i for i, name in enumerate(names) if not name.startswith("Time/")]
    return lines[0], [[line.split(",")[i] for i in keep] for line in lines[1:]]


def events(folder):
    """How many events, and how their files are called, without the second."""
    files = sorted(Path(folder).glob("events*"))
    count, data = 0, b"".join(file.read_bytes() for file in files)
    while data:
        data = data[16 + int.from_bytes(data[:8], "little"):]
        count += 1
    return count, ["".join(letter for letter in file.name if not letter.isdigit()) for file in files]


class Checkpoint:
    """What a checkpoint holds, without times."""

    def __init__(self, folder):
        config = json.loads(Path(folder, "config.json").read_text())
        pool = redman.Pool(config["task"], config["train_cfgs"]["vector_env_nums"], config["seed"],
                           options=dict(pair.split("=", 1) for pair in config["set"]))
        limits = dict({name: None for name in pool.costs}, **config["cost_limits"])
        agent = redman.Agent(pool, config["algo"], config["seed"], cost_limits=limits,
                             options=dict(pair.split("=", 1) for pair in config["set_algo"]))
        note = agent.read_checkpoint(Path(folder, "checkpoint.rdm"), pool)
        line, _, self.rest = note.partition(b"\n")
        said = json.loads(line)
        self.note = [(key, value) for key, value in said.items() if key not in ("seconds", "progress_bytes")]
        self.keys, self.agent, self.pool = list(said), agent.save(), pool.state()


class Folders(unittest.TestCase):
    def setUp(self):
        self.root = tempfile.TemporaryDirectory()
        self.addCleanup(self.root.cleanup)

    def path(self, name):
        return Path(self.root.name, name)

    def assert_same(self, a, b):
        """All files of two run folders, to the byte but for what a clock said."""
        self.assertEqual(Path(a, "config.json").read_text(), Path(b, "config.json").read_text())
        self.assertEqual(rows(a), rows(b))
        self.assertEqual(events(a), events(b))
        self.assertEqual(Path(a, "policy.rdm").read_bytes(), Path(b, "policy.rdm").read_bytes())
        self.assertEqual(vars(Checkpoint(a)), vars(Checkpoint(b)))
        self.assertEqual(sorted(os.listdir(a) if not events(a)[0] else [file.name for file in Path(a).glob("[!e]*")]),
                         sorted(os.listdir(b) if not events(b)[0] else [file.name for file in Path(b).glob("[!e]*")]))


@NEEDS_TOOL
class AsTheTool(Folders):
    def test_the_same_arguments_write_the_same_folder(self):
        cases = {
            "plain": ({}, ()),
            "limits": ({"cost_limits": {"cost": 10, "speed": 4.5}, "algo": "cpo", "several_costs": "worst"},
                       ("--cost-limit", "cost=10", "--cost-limit", "speed=4.5", "--algo", "cpo", "--set", "several_costs=worst")),
            "options": ({"options": {"horizon": 125, "max_steps": 100, "action_repeat": 5, "learning_rate": 0.001,
                                     "hidden": [32, 16]}, "cost_limit": 7},
                        ("--set", "max_steps=100", "--set", "action_repeat=5", "--set", "learning_rate=0.001", "--set",
                         "hidden=32,16", "--cost-limit", 7)),
            "no events": ({"tensorboard": False, "algo": "ppo"}, ("--no-tensorboard", "--algo", "ppo")),
            "raw": ({"cost_signal": "raw", "cost_limits": 30}, ("--set", "cost_signal=raw", "--cost-limit", 30)),
            "trained": ({"from_": "trained"}, ("--from", "trained")),
            "ranks": ({"ranks": redman.Ranks(0, 1)}, ("--ranks", 1)),
        }
        for name, (ours, theirs) in cases.items():
            with self.subTest(name):
                a, b = self.path(f"{name} a"), self.path(f"{name} b")
                redman.train(TASK, **{**SMALL, **ours}, out=a)
                told("train", "--task", TASK, *WORDS, *theirs, "--out", b)
                self.assert_same(a, b)

    def test_an_encoder_of_points_too(self):
        a, b = self.path("a"), self.path("b")
        settings = {"steps": 2000, "envs": 4, "threads": 0, "eval_every": 2, "progress": False}
        redman.train("grasp", **settings, encoder="16,16", encoder_points=64, horizon=32, out=a)
        told("train", "--task", "grasp", "--steps", 2000, "--envs", 4, "--eval-every", 2, "--set", "encoder=16,16", "--set",
             "encoder_points=64", "--set", "horizon=32", "--out", b)
        self.assertEqual(Path(a, "config.json").read_text(), Path(b, "config.json").read_text())
        self.assertEqual((rows(a), Path(a, "policy.rdm").read_bytes()), (rows(b), Path(b, "policy.rdm").read_bytes()))
        # rewards of your own see what the network sees
        own = redman.train("grasp", **settings, encoder="16,16", encoder_points=64, horizon=32, reward=lambda rows: rows.reward)
        self.assertEqual(own.agent.save(), redman.Run.load(a).agent.save())

    def test_a_shield_too(self):
        task, a, b = "hand_over_safe_joint", self.path("a"), self.path("b")
        redman.train(task, steps=3000, envs=8, seed=1, eval_every=2, threads=0, shield={"noise": 0.3}, progress=False, out=a)
        told("train", "--task", task, "--steps", 3000, "--envs", 8, "--seed", 1, "--eval-every", 2, "--shield",
             "predict:noise=0.3", "--out", b)
        self.assertEqual(Path(a, "config.json").read_text(), Path(b, "config.json").read_text())
        self.assertEqual(rows(a), rows(b))
        self.assertEqual(Path(a, "policy.rdm").read_bytes(), Path(b, "policy.rdm").read_bytes())
        self.assertIn('"shield_bytes"', Path(a, "checkpoint.rdm").read_bytes().decode("latin1"))
        for each in (a, b):  # the state of the shield is in both
            redman.train(resume=each, steps=5000, progress=False)
        self.assertEqual(rows(a), rows(b))

    def test_another_version_is_told(self):
        run = self.path("run")
        redman.train(TASK, **SMALL, out=run)
        config = Path(run, "config.json")
        config.write_text(config.read_text().replace(f'"version": "{redman.version}"', '"version": "0.9.7"'))
        with self.assertWarnsRegex(RuntimeWarning, "trained with version 0.9.7, here is version"):
            redman.train(resume=run, progress=False)

    def test_a_recording_teaches_the_same(self):
        demo = self.path("demo.npz")
        with redman.Pool(TASK, 8, seed=1) as pool:
            pool.reset()
            recording, actor = redman.Recording(pool, state_stride=4), redman.Policy.trained(TASK).actor(pool)
            for _ in range(100):
                pool.action = actor()
                with recording.step(pool):
                    pool.step()
            recording.save(demo)
        a, b = self.path("a"), self.path("b")
        more = {"options": {"horizon": 125, "imitation": 0.5}}
        redman.train(TASK, **{**SMALL, **more}, from_=demo, teach={"clone_epochs": 3, "start_share": (0.5, 0.1)}, out=a)
        told("train", "--task", TASK, *WORDS, "--set", "imitation=0.5", "--from", demo, "--clone-epochs", 3, "--start-share",
             "0.5..0.1", "--out", b)
        self.assertEqual(Path(a, "config.json").read_text(), Path(b, "config.json").read_text())
        self.assertEqual((rows(a), events(a)), (rows(b), events(b)))
        self.assertEqual(Path(a, "policy.rdm").read_bytes(), Path(b, "policy.rdm").read_bytes())
        redman.train(resume=b, steps=20000, progress=False)
        told("train", "--resume", a, "--steps", 20000)
        self.assertEqual(rows(a), rows(b))

    @NEEDS_TOOL
    def test_teachers_that_act_are_the_commands(self):
        small = {**SMALL, "steps": 4000, "options": {"horizon": 20, "imitation": 0.5, "action_repeat": 5}}
        words = ("--steps", 4000, *WORDS[2:-2], "--set", "horizon=20", "--set", "imitation=0.5", "--set", "action_repeat=5")
        teach = {"decisions": 16, "clone_epochs": 2, "start_share": (0.5, 0.1), "noise": 0.02}
        flags = ("--demo-decisions", 16, "--clone-epochs", 2, "--start-share", "0.5..0.1", "--noise", 0.02)
        a, b = self.path("a"), self.path("b")
        redman.train("grasp", **small, from_="demo", teach=teach, out=a)
        told("train", "--task", "grasp", *words, "--from", "demo", *flags, "--out", b)
        self.assertEqual(Path(a, "config.json").read_text(), Path(b, "config.json").read_text())
        self.assertEqual((rows(a), events(a)), (rows(b), events(b)))
        self.assertEqual(Path(a, "policy.rdm").read_bytes(), Path(b, "policy.rdm").read_bytes())

        folder = self.path("teacher")  # DAgger from a policy of its own, without a run folder
        redman.train(TASK, **SMALL, out=folder)
        run = redman.train(TASK, **SMALL, from_=folder, teach={"dagger": 1, "decisions": 16, "clone_epochs": 2})
        told("train", "--task", TASK, *WORDS, "--from", folder, "--dagger", 1, "--demo-decisions", 16, "--clone-epochs", 2,
             "--out", self.path("d"))
        self.assertEqual(bytes(run.policy), Path(self.path("d"), "policy.rdm").read_bytes())
        self.assertIsNone(run.folder)
        with self.assertRaisesRegex(redman.Error, "my.demo"):
            redman.train("grasp", **small, from_="my.demo")

    def test_each_continues_what_the_other_began(self):
        whole, ours, theirs, third = (self.path(name) for name in ("whole", "ours", "theirs", "third"))
        redman.train(TASK, **{**SMALL, "steps": 24000}, out=whole)
        redman.train(TASK, **{**SMALL, "steps": 24000}, out=ours, callback=lambda epoch: epoch.epoch == 4)
        shutil.copytree(ours, third)
        told("train", "--task", TASK, *WORDS, "--out", theirs)
        told("train", "--resume", ours)
        run = redman.train(resume=theirs, steps=24000, progress=False)
        redman.train(resume=third, progress=False)
        self.assertEqual(rows(whole), rows(ours))
        self.assert_same(whole, ours)
        self.assert_same(whole, third)
        self.assertEqual((run.env_steps, run.interrupted, len(run.curve.steps)), (24000, False, 12))
        self.assertEqual(bytes(run.policy), Path(theirs, "policy.rdm").read_bytes())
        # a rate that falls over the run is that of its steps, which were other ones at first: only the settings agree
        self.assertEqual(json.loads(Path(theirs, "config.json").read_text()), json.loads(Path(whole, "config.json").read_text()))

    def test_the_tool_says_who_continues_what_it_does_not_know(self):
        own, lessons = self.path("own"), self.path("lessons")
        redman.train(TASK, **SMALL, costs={"fast": lambda rows: rows.speed("velocity") > 2}, cost_limits=20, out=own)
        redman.train(TASK, **SMALL, callback=callbacks.Curriculum({"max_steps": [100, 250]}), out=lessons)
        for folder in (own, lessons):
            done = tool("train", "--resume", folder)
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr, r"redman\.train\(resume=")
        done = told("eval", "--policy", own, "--episodes", 4)
        self.assertIn("functions in Python", done.stderr)
        told("plot", own, "--out", self.path("plot.svg"))


class Going(Folders):
    def test_a_run_that_was_interrupted_is_the_same(self):
        whole, parts = self.path("whole"), self.path("parts")
        redman.train(TASK, **SMALL, out=whole)
        for last in (1, 2, 5):
            settings = {"resume": parts, "progress": False} if parts.exists() else {"task": TASK, **SMALL, "out": parts}
            run = redman.train(**settings, callback=lambda epoch: epoch.epoch == last)
            self.assertEqual((run.interrupted, len(run.curve.steps), run.epochs[-1]["Train/Epoch"]), (True, last, last))
        run = redman.train(resume=parts, progress=False)
        self.assertFalse(run.interrupted)
        self.assert_same(whole, parts)

    def test_a_run_that_was_killed_goes_on_from_its_checkpoint(self):
        whole, killed = self.path("whole"), self.path("killed")
        redman.train(TASK, **SMALL, out=whole)

        class Kill(Exception):
            pass

        def kill(epoch):
            if epoch.epoch == 5:
                raise Kill

        with self.assertRaises(Kill):
            redman.train(TASK, **SMALL, out=killed, callback=kill)
        self.assertEqual(len(rows(killed)[1]), 5)  # two more than the checkpoint knows
        redman.train(resume=killed, progress=False)
        self.assert_same(whole, killed)

    def test_a_run_without_a_checkpoint_begins_again(self):
        whole, killed = self.path("whole"), self.path("killed")
        for folder in (whole, killed):
            redman.train(TASK, **SMALL, out=folder)
        Path(killed, "checkpoint.rdm").unlink()
        redman.train(resume=killed, progress=False)
        self.assert_same(whole, killed)

    def test_a_folder_is_a_run_again(self):
        folder = self.path("run")
        run = redman.train(TASK, **SMALL, out=folder)
        again = redman.Run.load(folder)
        self.assertEqual(bytes(again.policy), bytes(run.policy))
        self.assertEqual((again.task, again.algo, again.seed, again.env_steps, again.cost_limits, again.config),
                         (run.task, run.algo, run.seed, run.env_steps, run.cost_limits, {**run.config, "options": again.options}))
        self.assertEqual(again.agent.save(), run.agent.save())
        np.testing.assert_allclose(again.curve.returns, run.curve.returns, rtol=1e-8)
        more = again.resume(16000, progress=False)
        self.assertEqual((more.env_steps, again.evaluate(episodes=4)), (16000, run.evaluate(episodes=4)))

    def test_what_a_folder_decides_is_refused(self):
        folder = self.path("run")
        redman.train(TASK, **SMALL, out=folder)
        for wrong, words in (({"algo": "ppo"}, "algo"), ({"envs": 8}, "envs"), ({"options": {"horizon": 5}}, "options"),
                             ({"costs": {"fast": len}}, "task's own")):
            with self.assertRaisesRegex(redman.UsageError, words):
                redman.train(resume=folder, progress=False, **wrong)
        with self.assertRaisesRegex(redman.MissingFileError, "no such folder"):
            redman.train(resume=self.path("nothing"))
        Path(folder, "progress.csv").write_text("Train/Epoch,Train/TotalSteps,TotalEnvSteps,\n")
        with self.assertRaisesRegex(redman.StateError, "shorter than the checkpoint"):
            redman.train(resume=folder, steps=16000, progress=False)

    def test_the_clock_ends_a_run_after_an_epoch(self):
        folder = self.path("run")
        run = redman.train(TASK, **{**SMALL, "steps": 10**9}, time_budget=0.5, out=folder)
        self.assertTrue(run.interrupted)
        self.assertGreater(run.seconds, 0.3)
        self.assertLess(run.seconds, 60)
        self.assertEqual(run.env_steps, 2000 * len(run.curve.steps))
        self.assertTrue(Path(folder, "checkpoint.rdm").exists())
        with self.assertRaisesRegex(redman.ArgumentError, "time_budget"):
            redman.train(TASK, time_budget=0)

    def test_all_cores_give_the_bytes_of_one(self):
        one, all_of_them = redman.train(TASK, **SMALL), redman.train(TASK, **{**SMALL, "threads": None})
        self.assertEqual(bytes(one.policy), bytes(all_of_them.policy))
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
        folder = self.path("run")
        redman.train(TASK, **{**SMALL, "threads": None}, out=folder)
        self.assertEqual(json.loads(Path(folder, "config.json").read_text())["train_cfgs"]["threads"], min(cores, SMALL["envs"]))

    def test_teachers(self):
        trained = redman.Policy.trained(TASK)
        run = redman.train(TASK, **SMALL, from_=trained)
        self.assertGreater(run.evaluate(episodes=8).return_mean, 350)  # 415 of the bundled policy, -100 of none
        self.assertGreater(redman.train(TASK, **SMALL, from_=run).evaluate(episodes=8).return_mean, 350)
        recording = redman.Recording(obs_dim=7, action_dim=2, capacity=16)
        for wrong, words in (({"from_": "random"}, "this is no teacher"), ({"teach": {"clone_epochs": 3}}, "needs a teacher: give from_"),
                             ({"from_": trained, "teach": {"dagger": 2}}, "a word or a path"),
                             ({"from_": trained, "teach": {"noise": 0.1}}, "needs a teacher that acts"),
                             ({"from_": "demo", "teach": {"beta": 2}}, "not between 0 and 1"),
                             ({"from_": "demo", "reward": lambda rows: rows.reward}, "does not know reward="),
                             ({"from_": trained, "teach": {"clone_epoch": 2}}, "nearest is clone_epochs"),
                             ({"from_": trained, "teach": {"start_share": 0.5}}, "need a recording"),
                             ({"from_": recording}, "recording"), ({"from_": self.path("no.npz")}, "no such file")):
            with self.assertRaisesRegex(redman.Error, words):
                redman.train(TASK, **{**SMALL, **wrong})

    @unittest.skipUnless(importlib.util.find_spec("fcntl"), "no locks here")
    def test_a_folder_that_is_written_is_left_alone(self):
        folder, said = self.path("run"), []

        def meanwhile(epoch):
            for arguments in ({"task": TASK, "out": folder, "overwrite": True}, {"resume": folder}):
                try:
                    redman.train(progress=False, **arguments)
                except redman.StateError as error:
                    said.append(str(error))
            return True

        redman.train(TASK, **SMALL, out=folder, callback=meanwhile)
        self.assertEqual(["another process" in text for text in said], [True, True])

        def remove(epoch):
            shutil.rmtree(folder)

        with self.assertRaisesRegex(redman.StateError, "was removed"):
            redman.train(TASK, **SMALL, out=folder, overwrite=True, callback=remove)


class Several(Folders):
    def test_lists_are_a_run_of_each(self):
        runs = redman.train([TASK, "bandit"], ["ppo_lag", "ppo"], steps=200, seed=range(2), envs=4, progress=False, horizon=8,
                            out=self.path("runs"))
        self.assertEqual([(run.task, run.algo, run.seed) for run in runs],
                         [(task, algo, seed) for task in (TASK, "bandit") for algo in ("ppo_lag", "ppo") for seed in (0, 1)])
        self.assertEqual(runs[3].folder, self.path("runs") / "ppo-{ball_run}" / "seed-001")
        self.assertEqual(len(list(self.path("runs").rglob("policy.rdm"))), 8)
        alone = redman.train("bandit", "ppo", steps=200, seed=1, envs=4, progress=False, horizon=8)
        self.assertEqual(bytes(alone.policy), bytes(runs[-1].policy))
        more = redman.train(resume=[run.folder for run in runs[:2]], steps=400, progress=False)
        self.assertEqual([run.env_steps >= 400 for run in more], [True, True])

    def test_what_is_given_twice_is_no_second_sample(self):
        for wrong, words in (({"seed": [0, 1, 0]}, r"train: seed \[0, 1, 0\]: one of them is given twice"),
                             ({"algo": ["ppo", "PPO"]}, "algo .*: one of them is given twice")):
            with self.assertRaisesRegex(redman.UsageError, words):
                redman.train(**{"task": TASK, "steps": 200, **wrong})

    def test_an_empty_list_trains_nothing(self):
        with self.assertRaisesRegex(redman.ArgumentError, "empty"):
            redman.train([], steps=100)


class Exchange:
    """Messages between threads, as comm.allgather of mpi4py between processes."""

    def __init__(self, ranks):
        self.barrier, self.all = threading.Barrier(ranks, timeout=60), [b""] * ranks

    def gather(self, rank):
        def hook(message):
            self.all[rank] = message
            self.barrier.wait()
            out = list(self.all)
            self.barrier.wait()
            return out
        return hook


class Ranks(Folders):
    def test_ranks_write_the_folder_of_one(self):
        alone, together, exchange, runs = self.path("alone"), self.path("together"), Exchange(2), {}
        redman.train(TASK, **SMALL, ranks=redman.Ranks(0, 1), out=alone)

        def learn(rank):
            runs[rank] = redman.train(TASK, **SMALL, ranks=redman.Ranks(rank, 2, exchange.gather(rank)), out=together)

        threads = [threading.Thread(target=learn, args=(rank,)) for rank in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(set(runs), {0, 1})
        self.assertEqual(rows(alone), rows(together))
        self.assertEqual(Path(alone, "policy.rdm").read_bytes(), Path(together, "policy.rdm").read_bytes())
        self.assertEqual(bytes(runs[1].agent.policy()), bytes(runs[0].agent.policy()))

    def test_the_tool_starts_processes(self):
        with self.assertRaisesRegex(redman.UnsupportedError, "redman train --ranks 4"):
            redman.train(TASK, ranks=4)


class Hands(Folders):
    def test_a_callback_has_agent_pool_and_run(self):
        seen = []

        class Look(callbacks.Callback):
            def on_begin(self, training):
                seen.append(("begin", training.run.env_steps, training.pool.num_envs))

            def on_epoch(self, epoch, training):
                seen.append((epoch.epoch, training.run.env_steps, len(training.run.curve.steps)))
                training.set(learning_rate=1e-4)
                self.rate = training.agent.options["learning_rate"]
                if epoch.epoch == 2:
                    training.stop()

            def on_end(self, training):
                seen.append("end")

        look = Look()
        run = redman.train(TASK, **SMALL, callback=[look, lambda epoch: None])
        self.assertEqual(seen, [("begin", 0, 16), (1, 2000, 1), (2, 4000, 2), "end"])
        self.assertEqual((look.rate, run.interrupted), (1e-4, True))
        self.assertLess(run.curve["Train/LR"][1], run.curve["Train/LR"][0])

    def test_functions_of_two_get_the_training(self):
        got = []
        redman.train(TASK, **SMALL, callback=lambda epoch, training: got.append(training.progress) or epoch.epoch == 2)
        self.assertEqual(got, [2000 / 12000, 4000 / 12000])
        for wrong, words in ((callbacks.Callback, "not the class"), (3, "a function of the epoch")):
            with self.assertRaisesRegex(redman.UsageError, words):
                redman.train(TASK, **SMALL, callback=wrong)

    def test_the_end_is_told_though_something_was_raised(self):
        ended = []

        class Fails(callbacks.Callback):
            def on_epoch(self, epoch, training):
                raise ZeroDivisionError

            def on_end(self, training):
                ended.append(True)

        with self.assertRaises(ZeroDivisionError):
            redman.train(TASK, **SMALL, callback=Fails())
        self.assertEqual(ended, [True])

    def test_worlds_change_over_a_run_and_where_it_goes_on(self):
        whole, parts, lengths = self.path("whole"), self.path("parts"), []
        lessons = {"max_steps": [50, 100, 250], "learning_rate": (1e-3, 1e-4)}

        def note(epoch, training):
            lengths.append((training.pool.options["max_steps"], round(training.agent.options["learning_rate"], 5)))

        redman.train(TASK, **SMALL, callback=[note, callbacks.Curriculum(lessons, until=0.8)], out=whole)
        self.assertEqual([length for length, _ in lengths], [50, 50, 50, 100, 100, 250])
        self.assertEqual(lengths[0][1], 1e-3)
        self.assertLess(lengths[-1][1], 2e-4)
        for end in (3, 4):
            settings = {"resume": parts, "progress": False} if parts.exists() else {"task": TASK, **SMALL, "out": parts}
            redman.train(**settings, callback=[callbacks.Curriculum(lessons, until=0.8), lambda epoch: epoch.epoch == end])
        redman.train(resume=parts, progress=False, callback=callbacks.Curriculum(lessons, until=0.8))
        self.assertEqual(rows(whole), rows(parts))
        self.assertEqual(Path(whole, "policy.rdm").read_bytes(), Path(parts, "policy.rdm").read_bytes())
        self.assertEqual(Path(whole, "config.json").read_text(), Path(parts, "config.json").read_text())

    def test_what_would_change_the_observation_is_refused(self):
        for option, kind, words in (("extended_obs", redman.ArgumentError, "would change what the worlds show"),
                                    ("extended_abs", redman.NotFoundError, "nearest is extended_obs"),
                                    ("hidden", redman.StateError, "hidden")):
            with self.assertRaisesRegex(kind, words):
                redman.train("jenga", steps=500, envs=2, progress=False, horizon=16,
                             callback=lambda epoch, training: training.set(**{option: "true"}))

    def test_a_curriculum_says_what_it_takes(self):
        for wrong in ({"max_steps": ()}, {"max_steps": "250"}, {"max_steps": (1, 2, 3)}):
            with self.assertRaises(redman.ArgumentError):
                callbacks.Curriculum(wrong)
        with self.assertRaisesRegex(redman.ArgumentError, "until"):
            callbacks.Curriculum({"max_steps": (1, 2)}, until=0)
        stages = callbacks.Curriculum({"x": (0.0, 9.0)}, until=0.9)
        self.assertEqual([stages.at(k / 10)["x"] for k in range(11)], [*map(float, range(10)), 9.0])

    def test_curves_go_to_other_programs(self):
        run = {"config": None, "rows": [], "ended": False}
        wandb = types.ModuleType("wandb")
        wandb.run = None
        wandb.init = lambda **settings: run.update(config=settings)
        wandb.log = lambda row, step: run["rows"].append((step, row))
        wandb.finish = lambda: run.update(ended=True)
        with mock.patch.dict(sys.modules, wandb=wandb):
            redman.train(TASK, **SMALL, callback=callbacks.WandB(project="safe", tags=["a"]))
        config = run["config"]
        self.assertEqual((config["project"], config["tags"], config["config"]["task"]), ("safe", ["a"], TASK))
        self.assertEqual([step for step, _ in run["rows"]], list(range(2000, 12001, 2000)))
        self.assertTrue(run["ended"] and all(np.isfinite(list(row.values())).all() for _, row in run["rows"]))

        logged = {"params": None, "rows": [], "ended": False}
        mlflow = types.ModuleType("mlflow")
        mlflow.set_experiment = lambda name: logged.update(experiment=name)
        mlflow.active_run = lambda: None
        mlflow.start_run = lambda **settings: logged.update(settings)
        mlflow.log_params = lambda params: logged.update(params=params)
        mlflow.log_metrics = lambda row, step: logged["rows"].append(step)
        mlflow.end_run = lambda: logged.update(ended=True)
        with mock.patch.dict(sys.modules, mlflow=mlflow):
            redman.train(TASK, **SMALL, callback=callbacks.MLflow("safe"))
        self.assertEqual((logged["experiment"], logged["run_name"], logged["params"]["cost_limits.cost"]),
                         ("safe", "ball_run-ppo_lag-seed-3", redman.task(TASK).costs["cost"].limit))
        self.assertEqual((len(logged["rows"]), logged["ended"]), (6, True))

        folder, written = self.path("board"), []
        redman.train(TASK, **SMALL, callback=callbacks.TensorBoard(folder))
        self.assertEqual(events(folder), (7, ["events.out.tfevents..redman"]))
        writer = types.SimpleNamespace(add_scalar=lambda *cell: written.append(cell), flush=lambda: written.append("flushed"))
        redman.train(TASK, **SMALL, callback=callbacks.TensorBoard(writer))
        self.assertEqual((written[0][0], written[0][2], written[-1]), ("Train/Epoch", 2000, "flushed"))

    def test_what_is_not_installed_is_said(self):
        for name, make in (("wandb", callbacks.WandB), ("mlflow", callbacks.MLflow)):
            with mock.patch.dict(sys.modules, {name: None}):
                with self.assertRaisesRegex(redman.UnsupportedError, f"pip install {name}"):
                    make()


if __name__ == "__main__":
    unittest.main()
