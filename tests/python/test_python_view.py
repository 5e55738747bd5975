"""redman.view: a window follows a pool, changes nothing unless somebody acts, and does what its page asks for. The page is played by
a client of its WebSocket; the page itself is tested by test_tool_view."""
import base64
import json
import os
import socket
import struct
import tempfile
import threading
import time
import unittest
import urllib.error
import urllib.request
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np

import redman
from redman import callbacks
from test_python_show import VIEWER, Ball


class Page:
    """What a page does, frame by frame."""

    def __init__(self, address):
        url = urlsplit(address)
        self.socket = socket.create_connection((url.hostname, url.port), timeout=30)
        self.file = self.socket.makefile("rb")
        self.socket.sendall((f"GET {url.path}live HTTP/1.1\r\nHost: {url.netloc}\r\nOrigin: http://{url.netloc}\r\nUpgrade: websocket\r\n"
                             f"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                             f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\n\r\n").encode())
        status = self.file.readline()
        assert b"101" in status, status
        while self.file.readline().strip():
            pass
        self.asked, self.scene = 0, None

    def tell(self, **what):
        data, key = json.dumps(what).encode(), os.urandom(4)
        size = bytes([0x80 | len(data)]) if len(data) < 126 else bytes([0x80 | 126]) + struct.pack(">H", len(data))
        self.socket.sendall(b"\x81" + size + key + bytes(b ^ key[i % 4] for i, b in enumerate(data)))

    def read(self):
        """The next message: a dict, of a frame its head with its numbers."""
        kind, size = self.file.read(2)
        size &= 127
        if size >= 126:
            size = struct.unpack(">H" if size == 126 else ">Q", self.file.read(2 if size == 126 else 8))[0]
        data = self.file.read(size)
        if kind & 15 == 1:
            said = json.loads(data)
            self.scene = said if said.get("say") == "scene" else self.scene
            return said
        length, = struct.unpack_from("<I", data)
        head = json.loads(data[4:4 + length])
        head["numbers"] = np.frombuffer(data, np.float32, offset=4 + length)
        self.tell(do="shown")
        return head

    def until(self, holds):
        """The first message of which something holds."""
        end = time.monotonic() + 30
        while time.monotonic() < end:
            said = self.read()
            if holds(said):
                return said
        raise AssertionError("it did not come")

    def ask(self, **what):
        self.asked += 1
        self.tell(id=self.asked, **what)
        return self.until(lambda said: said.get("id") == self.asked)

    def close(self):
        self.file.close()
        self.socket.close()


def wait(holds):
    end = time.monotonic() + 30
    while not holds():
        assert time.monotonic() < end, "it did not come"
        time.sleep(0.005)


@unittest.skipUnless(VIEWER, "no tool, or no viewer library in it (libjs-three)")
class OfAPool(unittest.TestCase):
    def open(self, *given, **named):
        window = redman.view(*given, browser=False, **named)
        self.addCleanup(window.close)
        return window

    def look(self, window):
        page = Page(window.address)
        self.addCleanup(page.close)
        wait(lambda: window.windows == 1)
        return page

    def test_it_shows_what_is_there_and_changes_nothing(self):
        pools = [redman.Pool("hand_over_safe_finger", num_envs=3) for _ in range(2)]
        for pool in pools:
            pool.reset(seeds=4)
        pool = pools[0]
        window = self.open(pool)
        page = self.look(window)
        page.tell(do="contacts", on=True)
        wait(lambda: window._state["contacts"])
        first = page.until(lambda said: "numbers" in said)
        self.assertEqual((page.scene["task"], page.scene["worlds"], page.scene["fed"]), ("hand_over_safe_finger", 3, True))
        self.assertEqual([c["limit"] for c in page.scene["costs"]][:1], [40])
        moving = page.scene["moving"]
        for step in range(1, 13):
            pool.step(pool.baseline("random"))
            pools[1].step(pools[1].baseline("random"))
            seen = page.until(lambda said: said.get("at", -1) >= first["at"] + step)
        self.assertEqual(pool.hash(), pools[1].hash())
        self.assertEqual(seen["step"], [12] * 3)
        np.testing.assert_allclose(seen["return"], pool.episode_return, rtol=1e-6)
        np.testing.assert_allclose(seen["sum"], pool.episode_cost[0], rtol=1e-6)
        np.testing.assert_allclose(seen["action"], pool.action[0], rtol=1e-6)
        rows = np.array([pool.poses(i)[moving] for i in range(3)], np.float32).reshape(-1)
        np.testing.assert_array_equal(seen["numbers"][:rows.size], rows)
        contacts = pool.contacts(0)
        self.assertEqual(seen["contacts"], len(contacts))
        np.testing.assert_array_equal(seen["numbers"][rows.size:].reshape(-1, 6)[:, 3:], contacts["force"])

    def test_it_shows_the_cloud_of_the_watched_world(self):
        pool = redman.Pool("hand_over_safe_finger", num_envs=2, options={"modality": "points", "points": 64})
        pool.reset()
        page = self.look(self.open(pool))
        page.until(lambda said: "numbers" in said)
        for world in (0, 1):
            page.ask(do="watch", world=world)
            wait(lambda: pool._followers.all[0][0].__self__._state["watched"] == world)
            pool.step(pool.baseline("random"))
            seen = page.until(lambda said: said.get("points") and said["watched"] == world and said["step"][0] == world + 1)
            cloud = seen["numbers"][-4 * seen["points"]:]
            np.testing.assert_array_equal(cloud[:-seen["points"]].reshape(-1, 3), pool.sensors.points[world])
            np.testing.assert_array_equal(cloud[-seen["points"]:], pool.sensors.point_class[world])

    def test_its_button_records_whole_episodes_that_train_takes(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = Path(folder.name, "mine.npz")
        pool = redman.Pool("hand_over_safe_finger", num_envs=2, options={"max_steps": 10})
        pool.reset()
        window = self.open(pool, env=1, record=path)
        page = self.look(window)
        page.until(lambda said: "numbers" in said)
        page.ask(do="speed", times=100)
        page.ask(do="action", entry=0, value=0.5)
        pool.step(pool.baseline("zero"))
        page.until(lambda said: page.scene is not None and said.get("step"))
        self.assertEqual(page.scene["record"], str(path))
        page.ask(do="record", on=True)
        wait(lambda: window._state["record"])
        for _ in range(29):  # the rest of an episode, which is not whole, and two that are
            pool.step(pool.baseline("zero"))
        page.until(lambda said: (said.get("take") or {}).get("episodes") == 2)
        names = [shape["name"] for shape in page.scene["shapes"]]
        page.ask(do="grab", world=0, shape=names.index("object"), local=[0, 0, 0], to=[9, 0, 9], newton=1, reach=1)
        wait(lambda: window._state["push"])
        for _ in range(10):  # one in which it is pulled
            pool.step(pool.baseline("zero"))
        page.until(lambda said: (said.get("take") or {}).get("dropped") == 1)
        page.ask(do="release")
        told = page.ask(do="record", on=False)
        self.assertEqual((told["episodes"], told["dropped"], told["steps"], told["file"]), (2, 1, 20, str(path)))
        wait(lambda: not window._state["record"])
        pool.step(pool.baseline("zero"))
        mine = redman.Recording.load(path)
        self.assertEqual((mine.info.episodes, len(mine)), (2, 20))
        np.testing.assert_array_equal(mine.action[:, 0], np.float32(0.5))
        np.testing.assert_array_equal(mine.truncated, np.arange(20) % 10 == 9)
        run = redman.train("hand_over_safe_finger", from_=path, steps=400, envs=4, max_steps=10, progress=False)
        self.assertGreaterEqual(run.env_steps, 400)

    def test_what_no_file_was_given_for_is_not_recorded(self):
        pool = redman.Pool("ball_run")
        pool.reset()
        page = self.look(self.open(pool))
        page.until(lambda said: "numbers" in said)
        self.assertIn("which gave no file", page.ask(do="record", on=True)["error"])

    def test_a_paused_page_holds_the_loop_and_steps_it(self):
        pool = redman.Pool("ball_run", options={"max_steps": 1000})
        pool.reset()
        window = self.open(pool)
        page = self.look(window)
        page.ask(do="play", on=False)
        wait(lambda: not window._state["plays"])
        steps, ends = [0], threading.Event()

        def loop():
            while not ends.is_set():
                pool.step(pool.baseline("zero"))
                steps[0] += 1

        thread = threading.Thread(target=loop)
        thread.start()
        try:
            time.sleep(0.3)
            self.assertEqual(steps[0], 0)
            for count in (1, 2):
                page.ask(do="step")
                wait(lambda count=count: steps[0] == count)
            time.sleep(0.2)
            self.assertEqual(steps[0], 2)
            page.ask(do="play", on=True)
            begin = time.monotonic()
            wait(lambda: steps[0] >= 62)
            self.assertGreater(time.monotonic() - begin, 0.85)  # 60 steps of 1/60 s
            page.ask(do="speed", times=100)
            back = page.ask(do="seek", at=1)
            self.assertNotIn("error", back)
            seen = page.until(lambda said: said.get("at") == 1)
            self.assertFalse(seen["plays"])
            self.assertGreaterEqual(seen["last"], 62)
            page.close()  # nobody looks: nobody is waited for
            before = steps[0]
            wait(lambda: steps[0] > before + 100)
        finally:
            ends.set()
            window.close()
            thread.join(30)
        self.assertNotIn("step", vars(pool))

    def test_a_hand_leads_a_finger_and_holds_it(self):
        pool = redman.Pool("hand_over_safe_finger", num_envs=2, options={"max_steps": 1000})
        pool.reset()
        window = self.open(pool, env=1)
        page = self.look(window)
        page.until(lambda said: "numbers" in said)
        self.assertEqual((page.scene["leads"], page.scene["shields"]), (True, False))
        page.ask(do="speed", times=100)
        names = [shape["name"] for shape in page.scene["shapes"]]
        tip = names.index("right_ff_distal")
        for _ in range(20):
            pool.step(pool.baseline("hold"))
        start = pool.poses(1)[tip][:3]
        to = start + [0, 0, 0.02]
        page.ask(do="grab", world=0, shape=tip, local=[0, 0, 0], to=to.tolist(), newton=3, reach=0.5, leads=True)
        wait(lambda: window._state["lead"] is not None)
        self.assertIsNone(window._state["push"])
        for _ in range(60):
            pool.step(pool.baseline("hold"))
        left = np.linalg.norm(pool.poses(1)[tip][:3] - to)
        self.assertLess(left, 0.01)  # half of the way at least: what brings the other joints back holds against it
        twin = redman.Pool("hand_over_safe_finger", num_envs=2, options={"max_steps": 1000})
        twin.reset()
        for _ in range(80):
            twin.step(twin.baseline("hold"))
        self.assertEqual(pool.hash(0), twin.hash(0))  # the world beside it is as it would have been
        page.until(lambda said: "numbers" in said and said["hand"] and said["last"] >= 80)
        page.ask(do="release")
        wait(lambda: window._state["lead"] is None and window._state["action"] is not None)
        for _ in range(30):
            pool.step(pool.baseline("hold"))
        self.assertLess(np.linalg.norm(pool.poses(1)[tip][:3] - to), 0.01)  # the hand stays where it was led
        ball = names.index("object")
        page.ask(do="grab", world=0, shape=ball, local=[0, 0, 0], to=[0, 0, 1], newton=3, reach=0.5, leads=True)
        wait(lambda: window._state["lead"] is not None)
        with self.assertWarnsRegex(RuntimeWarning, "object: no entry of the action moves it"):
            pool.step(pool.baseline("hold"))

    def test_its_button_puts_actions_through_the_shield(self):
        pools = [redman.Pool("hand_over_safe_joint", num_envs=2, autoreset="off", options={"action_repeat": 4}) for _ in range(2)]
        for pool in pools:
            pool.reset(seeds=3)
        pool, other = pools
        shields = [redman.Shield(p, options={"unproven": "least"}) for p in pools]
        window = self.open(pool, shield=shields[0])
        page = self.look(window)
        page.until(lambda said: "numbers" in said)
        self.assertTrue(page.scene["shields"])
        page.ask(do="speed", times=100)
        page.ask(do="shield", on=True)
        wait(lambda: window._state["shield"])
        stepped_in = 0
        for _ in range(8):
            pool.step(np.ones((2, pool.action_dim)))
            other.step(shields[1].act(np.ones((2, pool.action_dim), np.float32)))
            stepped_in += int(shields[1].intervened.sum())
        self.assertEqual(pool.hash(), other.hash())
        self.assertGreater(stepped_in, 0)
        page.until(lambda said: "numbers" in said and said["shield"] and any(said["stepped_in"]))
        page.ask(do="shield", on=False)
        wait(lambda: not window._state["shield"])
        before = shields[0].stats.decisions
        pool.step(np.ones((2, pool.action_dim)))
        self.assertEqual(shields[0].stats.decisions, before)
        with self.assertRaisesRegex(redman.Error, "not a shield of this pool"):
            redman.view(other, shield=shields[0])

    def test_a_hand_pulls_and_acts(self):
        pools = [redman.Pool(Ball) for _ in range(2)]
        for pool in pools:
            pool.reset(seeds=1)
        pool, other = pools
        window = self.open(pool)
        page = self.look(window)
        page.until(lambda said: "numbers" in said)
        index = page.scene["moving"][0]
        at = pool.poses(0)[index][:3]
        page.ask(do="grab", world=0, shape=index, local=[0, 0, 0], to=[float(at[0]), float(at[1]) + 1000, float(at[2])], newton=3, reach=0.5)
        wait(lambda: window._state["push"] is not None)
        np.testing.assert_allclose(window._state["push"], [0, index, 0, 3, 0], atol=1e-4)
        for _ in range(8):
            pool.step(np.zeros((1, 1)))
            other.push(0, index, [0, 3, 0])
            other.step(np.zeros((1, 1)))
        self.assertGreater(pool.poses(0)[index][1] - at[1], 0.01)
        np.testing.assert_allclose(pool.poses(0)[index], other.poses(0)[index], atol=1e-3)
        page.ask(do="release")
        page.ask(do="action", entry=0, value=-0.5)
        wait(lambda: window._state["action"] is not None)
        pool.step(np.ones((1, 1)))
        self.assertEqual(pool.action[0, 0], -0.5)
        page.ask(do="hand", on=False)
        wait(lambda: window._state["action"] is None)
        pool.step(np.ones((1, 1)))
        self.assertEqual(pool.action[0, 0], 1)
        for wrong, words in (({"do": "reset"}, "another program"), ({"do": "record", "on": True}, "another program"),
                             ({"do": "grab", "world": 0, "shape": 10**6}, "shape"), ({"do": "watch", "world": 5}, "world"),
                             ({"do": "action", "entry": 9, "value": 0}, "entry")):
            self.assertIn(words, page.ask(**wrong)["error"])

    def test_what_cannot_be_pulled_is_said_once_and_stops_no_loop(self):
        for task, words in (("ball_run", "push is not possible"), ("hand_over_safe_finger", "right_forearm never moves")):
            pool = redman.Pool(task)
            pool.reset()
            page = self.look(self.open(pool))
            page.until(lambda said: "numbers" in said)
            page.ask(do="grab", world=0, shape=page.scene["moving"][0], local=[0, 0, 0], to=[1, 1, 1], newton=3, reach=0.5)
            with self.assertWarnsRegex(RuntimeWarning, words):
                for _ in range(30):
                    pool.step(pool.baseline("zero"))

    def test_others_get_nothing(self):
        pool = redman.Pool("bandit")
        window = self.open(pool)
        root = window.address.rsplit("/", 2)[0] + "/"
        for address in (root, root + "0" * 32 + "/"):
            with self.assertRaises(urllib.error.HTTPError) as refused:
                urllib.request.urlopen(address)
            self.assertEqual((refused.exception.code, refused.exception.read()), (403, b""))
            refused.exception.close()
        with urllib.request.urlopen(window.address) as page:
            self.assertIn(b"redman", page.read())

    def test_it_ends_with_its_close(self):
        pool = redman.Pool("ball_run")
        pool.reset()
        with redman.view(pool, browser=False) as window:
            process = window._process
        self.assertTrue(window.closed)
        self.assertIsNotNone(process.returncode)
        self.assertNotIn("step", vars(pool))
        pool.step(pool.baseline("zero"))
        with redman.view(pool, browser=False) as window:
            window._process.kill()
            window._process.wait()
            pool.step()
            pool.step()
            self.assertTrue(window.closed)

    def test_what_is_refused(self):
        pool = redman.Pool("bandit", num_envs=3)
        for named, words in (({"num_envs": 4}, "worlds 0 to 3 of 3"), ({"env": 3}, "of 3"), ({"policy": "trained"}, "which has its own")):
            with self.assertRaisesRegex(redman.Error, words):
                redman.view(pool, **named)
        with self.assertRaisesRegex(redman.Error, "bal_run"):
            redman.view("bal_run", browser=False)
        with self.assertRaisesRegex(redman.Error, "2000|envs"):
            redman.view("ball_run", num_envs=2000, browser=False)


@unittest.skipUnless(VIEWER, "no tool, or no viewer library in it (libjs-three)")
class OfOthers(unittest.TestCase):
    def first_scene(self, window):
        page = Page(window.address)
        try:
            page.until(lambda said: "numbers" in said)
            return page.scene
        finally:
            page.close()

    def test_policies_runs_and_tasks_are_shown_by_the_tool(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "r")
            run = redman.train("ball_run", steps=1000, envs=4, horizon=32, max_steps=40, out=path, progress=False)
            loose = redman.train("ball_run", steps=1000, envs=4, horizon=32, max_steps=40, progress=False)
            for shown, named, actor in ((run, {}, str(path)), (path, {}, str(path)), (run.policy, {}, str(path)), (loose, {}, "policy.rdm"),
                                        ("ball_run", {}, "hold"), (redman.task("ball_run"), {"policy": "trained"}, "trained"),
                                        (redman.Policy.trained("ball_run"), {"num_envs": 2}, "trained")):
                with redman.view(shown, browser=False, paused=True, **named) as window:
                    scene = self.first_scene(window)
                    self.assertNotIn("fed", scene)
                    self.assertTrue(any(name.endswith(actor) for name in scene["actors"]), scene["actors"])
                    self.assertEqual(scene["worlds"], named.get("num_envs", 1))
                    if isinstance(shown, (redman.Run, redman.Policy)) and shown is not redman.Policy and "num_envs" not in named:
                        self.assertEqual(scene["steps"], 40)

    def test_a_task_in_python_is_shown_by_this_process(self):
        with redman.view(Ball, browser=False) as window:
            self.assertEqual((self.first_scene(window)["task"], window.closed), ("show_ball", False))
        run = redman.train(Ball, steps=500, envs=4, horizon=16, progress=False)
        with redman.view(run, browser=False, num_envs=2) as window:
            page = Page(window.address)
            seen = page.until(lambda said: "numbers" in said and said["last"] > 30)  # episodes of 12 steps, one after the other
            self.assertEqual((page.scene["worlds"], page.scene["actors"], len(seen["step"])), (2, ["ppo_lag"], 2))
            page.close()

    def test_a_training_is_shown_while_it_runs(self):
        view, seen = callbacks.View(browser=False), []

        def look(epoch, training):
            page = Page(view.window.address)
            seen.append(page.until(lambda said: "numbers" in said and said["last"] > 3))
            page.close()
            return epoch.epoch >= 2

        plain = redman.train("ball_run", steps=2000, envs=4, horizon=32, progress=False)
        run = redman.train("ball_run", steps=2000, envs=4, horizon=32, progress=False, callback=[view, look])
        self.assertGreaterEqual(len(seen), 2)
        self.assertTrue(view.window.closed)
        for name in ("Metrics/EpRet", "Loss/Loss_pi"):
            rows = min(len(run.curve.steps), len(plain.curve.steps))
            np.testing.assert_array_equal(run.curve[name][:rows], plain.curve[name][:rows])  # who looks changes nothing


if __name__ == "__main__":
    unittest.main()
