"""Pool: the same worlds as C's, rows without copies, memory that outlives it, states, pictures, errors."""
import copy
import gc
import json
import os
import pickle
import struct
import subprocess
import threading
import tracemalloc
import unittest
import weakref
import zlib

import numpy as np

import redman

TASK = "hand_over_safe_finger"


def played(**arguments):
    pool = redman.Pool(TASK, **{"num_envs": 4, "seed": 7, **arguments})
    pool.reset()
    for _ in range(30):
        pool.baseline("random")
        pool.step()
    return pool


class SameWorlds(unittest.TestCase):
    @unittest.skipUnless(os.environ.get("REDMAN_TOOL"), "the command-line tool was not built")
    def test_hashes_are_those_that_the_tool_prints(self):
        for task, options in ((TASK, {}), ("grasp", {"object_mass": 0.0712345678901234}), ("jenga", {}),
                              ("point_goal1", {}), ("hand_over_wall", {"object": "tennis_ball"})):
            sets = [word for key, value in options.items() for word in ("--set", f"{key}={value}")]
            said = json.loads(subprocess.run(
                [os.environ["REDMAN_TOOL"], "rollout", "--task", task, "--policy", "random", "--episodes", "3",
                 "--envs", "3", "--seed", "7", "--json", *sets], check=True, capture_output=True).stdout)
            with redman.Pool(task, 3, seed=7, autoreset="off", options=options) as pool:
                pool.reset()
                playing = np.ones(3, bool)
                returns = []
                while playing.any():
                    pool.baseline("random")
                    pool.step(mask=playing)
                    ended = (pool.terminated | pool.truncated) & playing
                    returns += pool.episode_return[ended].tolist()
                    playing &= ~ended
                self.assertEqual(pool.hash(), said["hash"], task)
                self.assertAlmostEqual(np.mean(returns), said["return_mean"], 5)

    def test_threads_do_not_change_a_bit(self):
        self.assertEqual(len({played(threads=threads).hash() for threads in (0, 1, 2, 4)}), 1)

    def test_an_explicit_seed_names_an_episode(self):
        pool = redman.Pool("grasp", 3)
        first = pool.reset(seeds=11).copy()
        pool.baseline("random"), pool.step()
        self.assertTrue((pool.reset(seeds=[11, 12, 13]) == first).all())
        self.assertTrue((redman.Pool("grasp", 1, seed=12).reset()[0] == first[1]).all())  # in any world of any pool
        self.assertFalse((pool.reset() == first).all())


class Rows(unittest.TestCase):
    def test_rows_are_the_memory_that_the_library_writes(self):
        pool = played()
        buffers = redman._library.filled(redman._abi.rdm_buffers, redman._library.lib.rdm_pool_get_buffers, pool._p)
        for name, rows in redman._abi.ROWS["rdm_buffers"].items():
            array = getattr(pool, name)
            self.assertEqual(array.ctypes.data, getattr(buffers, name), name)
            self.assertEqual(array.ctypes.data % 64, 0, name)
            self.assertEqual(array.shape[0], 4, name)
        self.assertEqual(pool.terminated.dtype, np.bool_)
        before = pool.obs
        self.assertTrue(np.shares_memory(pool.step(), before))

    def test_stepping_makes_nothing(self):
        pool = played()
        pool.step(pool.action)
        tracemalloc.start()
        try:
            begin = tracemalloc.get_traced_memory()[0]
            for _ in range(100):
                pool.step(pool.action)
            self.assertLess(tracemalloc.get_traced_memory()[0] - begin, 2000)
        finally:
            tracemalloc.stop()

    def test_rows_outlive_the_pool(self):
        pool = played()
        obs, ended, expected = pool.obs, pool.terminated, pool.obs.copy()
        pool.close()
        pool.close()
        del pool
        gc.collect()
        np.testing.assert_array_equal(obs, expected)
        self.assertEqual(ended.shape, (4,))

    def test_actions_of_any_kind_are_taken(self):
        for action in (np.zeros((4, 40)), np.zeros(40, np.float32), [[0] * 40] * 4, 0, np.zeros((4, 40), np.int64)):
            pool = played()
            pool.step(action)
            self.assertTrue((pool.action == 0).all())
        pool.action = np.full((4, 40), 0.5)
        self.assertEqual(pool.action[3, 39], 0.5)
        for wrong in (np.zeros((3, 40)), np.zeros(41), "stand still", None, np.zeros((4, 40), complex)):
            if wrong is not None:
                with self.assertRaises(redman.ArgumentError):
                    pool.step(wrong)

    def test_an_action_may_be_repeated(self):
        once, twice = played(), played(options={"action_repeat": 2})
        self.assertEqual(twice.spec.action_repeat, 2)
        for pool in (once, twice):
            pool.reset(seeds=5)
        once.step(0), (first := once.reward.copy()), once.step(0), twice.step(0)
        np.testing.assert_array_equal(once.obs, twice.obs)
        np.testing.assert_allclose(first + once.reward, twice.reward, rtol=1e-6)

    def test_masked_steps_leave_the_others(self):
        pool = played()
        before = pool.obs.copy()
        pool.step(mask=[True, False, True, False])
        changed = (pool.obs != before).any(axis=1)
        self.assertEqual(changed.tolist(), [True, False, True, False])

    def test_autoreset_by_every_spelling(self):
        class Mode:  # as Gymnasium's enum
            value = "NextStep"
        for spelling, name in (("same_step", "same_step"), ("SameStep", "same_step"), ("next-step", "next_step"),
                               ("Disabled", "off"), ("off", "off"), (Mode(), "next_step")):
            self.assertEqual(redman.Pool("bandit", autoreset=spelling).autoreset, name)
        with self.assertRaisesRegex(redman.ArgumentError, "same_step, next_step, off"):
            redman.Pool("bandit", autoreset="sometimes")


class States(unittest.TestCase):
    def test_state_goes_on_with_the_same_bytes(self):
        pool = played()
        saved, one = pool.state(), pool.state(2)
        pool.baseline("zero"), pool.step()
        hashed = pool.hash()
        pool.set_state(saved)
        pool.baseline("zero"), pool.step()
        self.assertEqual(pool.hash(), hashed)
        pool.set_state(one, 2)
        with self.assertRaises(redman.FormatError):
            pool.set_state(saved[:-1])
        with self.assertRaises(redman.FormatError):
            pool.set_state(b"")

    def test_pickle_and_deepcopy_go_on_alike(self):
        pool = played(options={"object": "tennis_ball"}, autoreset="next_step", threads=2)
        for again in (lambda pool: pickle.loads(pickle.dumps(pool)), copy.deepcopy):
            twin = again(pool)
            for name in redman._abi.ROWS["rdm_buffers"]:
                np.testing.assert_array_equal(getattr(twin, name), getattr(pool, name))
            self.assertEqual(twin.hash(), pool.hash())
            self.assertFalse(np.shares_memory(twin.obs, pool.obs))
            for _ in range(80):  # through the ends of episodes
                pool.baseline("random"), pool.step()
                twin.baseline("random"), twin.step()
            self.assertEqual(twin.hash(), pool.hash())
        fresh = pickle.loads(pickle.dumps(redman.Pool("bandit", seed=3)))  # not reset yet
        with self.assertRaises(redman.StateError):
            fresh.step()


class Shown(unittest.TestCase):
    def test_pictures(self):
        pool = played()
        rgb = pool.render(1, width=64, height=48)
        self.assertEqual((rgb.shape, rgb.dtype), ((48, 64, 3), np.uint8))
        self.assertGreater(len(np.unique(rgb)), 10)
        depth = pool.render(what="depth", camera=list(pool.cameras)[-1])
        self.assertEqual((depth.shape, depth.dtype), ((240, 320), np.float32))
        seen = pool.render(what="segmentation")
        self.assertTrue(set(np.unique(seen)) <= set(range(-1, len(pool.shapes))))
        with self.assertRaises(redman.RangeError):
            pool.render(width=0)
        with self.assertRaises(redman.NotFoundError):
            pool.render(camera="nowhere")
        with self.assertRaises(redman.RangeError):
            pool.render(env=4)
        with self.assertRaises(redman.ArgumentError):
            pool.render(what="smell")

    def test_looks_and_several_worlds(self):
        pool = played()
        fine, plain = pool.render(1, width=64, height=48), pool.render(1, width=64, height=48, look="plain")
        self.assertFalse(np.array_equal(fine, plain))
        self.assertTrue(np.array_equal(fine, pool.render(1, width=64, height=48)))
        shapes = len(pool.shapes)
        seen = pool.render(1, width=96, height=72, what="segmentation", num_envs=3)
        self.assertEqual(set(np.unique(seen[seen >= 0] // shapes)), {0, 1, 2})
        with self.assertRaises(redman.RangeError):
            pool.render(2, num_envs=3)
        with self.assertRaises(redman.ArgumentError):
            pool.render(look="pretty")

    def test_a_notebook_gets_a_png(self):
        png = played()._repr_png_()
        self.assertEqual(png[:8], b"\x89PNG\r\n\x1a\n")
        width, height = struct.unpack(">II", png[16:24])
        self.assertEqual((width, height), (640, 400))
        size = struct.unpack(">I", png[33:37])[0]
        self.assertEqual(len(zlib.decompress(png[41:41 + size])), height * (3 * width + 1))

    def test_sensors_err_and_actions_are_late(self):
        options = {"noise.*_tip_*": (0.01, 0.02), "delay.right.joint_position": 2, "action_delay": (0, 3)}
        pool = played(options=options)
        said = {key: pool.options[key] for key in options}
        self.assertEqual(said, {"noise.*_tip_*": "0.01..0.02", "delay.right.joint_position": 2, "action_delay": "0..3"})
        self.assertEqual(played(options=pool.options).hash(), pool.hash())
        self.assertNotEqual(played().hash(), pool.hash())
        with self.assertRaisesRegex(redman.NotFoundError, "nearest is right.joint_position"):
            redman.Pool(TASK, options={"noise.right.joint_positon": 0.1})
        with self.assertRaises(redman.RangeError):
            redman.Pool(TASK, options={"action_delay": (3, 1)})

    def test_what_it_is(self):
        pool = played(options={"object": "egg", "object_mass": 0.05})
        self.assertEqual(sum(field.count for field in pool.fields.values()), pool.obs_dim)
        low, high = pool.bounds
        self.assertTrue(((low <= pool.obs) & (pool.obs <= high)).all())
        self.assertTrue(np.isfinite(low).any())
        self.assertEqual(pool.initial_mean.shape, (40,))
        self.assertGreater(redman.memory(TASK, 2)[0], redman.memory(TASK, 1)[0])
        self.assertEqual(len(pool.costs), pool.cost_dim)
        self.assertEqual(pool.options["object"], "egg")
        self.assertEqual(pool.options["object_mass"], 0.05)
        self.assertEqual(pool.stats.steps, 4 * 30)
        self.assertEqual(pool.poses(3).shape, (len(pool.shapes), 7))
        np.testing.assert_allclose(np.linalg.norm(pool.poses(0)[:, 3:], axis=1), 1, rtol=1e-5)
        self.assertEqual(pool.spec.max_steps, pool.task.max_steps)
        before = pool.hash()
        pool.push(0, [shape.name for shape in pool.shapes if not shape.fixed][-1], (0, 0, 5))
        pool.step(0)
        self.assertNotEqual(pool.hash(), before)
        with self.assertRaises(redman.ArgumentError):
            pool.push(0, "nothing", (0, 0, 5))

    def test_joints_are_seen_and_set(self):
        pool = played()
        names = [joint.name for joint in pool.joints]
        self.assertEqual(len(set(names)), pool.spec.num_joints)
        self.assertEqual({joint.kind for joint in pool.joints}, {redman.JointKind.REVOLUTE})
        q, qd = pool.joint_positions(1), pool.joint_velocities(1)
        self.assertEqual(q.shape, (48,))
        self.assertGreater(np.abs(qd).max(), 0)
        pool.set_joints(0, q, qd)
        np.testing.assert_array_equal(pool.joint_positions(0), q)
        np.testing.assert_array_equal(pool.joint_velocities(0), qd)
        before = pool.obs[0].copy()
        q[3] = pool.joints[3].upper
        pool.set_joints(0, q)
        self.assertTrue((pool.obs[0] != before).any())
        np.testing.assert_array_equal(pool.joint_velocities(0), qd)
        q[3] = 9
        with self.assertRaisesRegex(redman.RangeError, pool.joints[3].name):
            pool.set_joints(0, q)
        with self.assertRaises(redman.ArgumentError):
            pool.set_joints(0, q[:5])

    def test_rays_meet_what_is_there(self):
        pool = played()
        hit = pool.raycast(0, (0, 0, 50), (0, 0, -2))
        self.assertLess(hit.shape, len(pool.shapes))
        self.assertAlmostEqual(hit.point[2], 50 - hit.distance)
        self.assertGreater(hit.normal[2], 0)
        self.assertIsNone(pool.raycast(0, (0, 0, 50), (0, 0, 1)))
        self.assertIsNone(pool.raycast(0, (0, 0, 50), (0, 0, -1), 10))
        with self.assertRaises(redman.ArgumentError):
            pool.raycast(0, (0, 0, 50), (0, 0, 0))
        with self.assertRaises(redman.RangeError):
            pool.raycast(0, (0, 0, 50), (0, 0, 1), 0)

    def test_contacts_name_shapes(self):
        pool = redman.Pool("grasp", 1)
        pool.reset()
        for _ in range(40):
            pool.step(0)
        contacts = pool.contacts(0)
        self.assertGreater(len(contacts), 0)
        self.assertLess(contacts["shape_a"].max(), len(pool.shapes))
        np.testing.assert_allclose(np.linalg.norm(contacts["normal"], axis=1), 1, rtol=1e-4)

    def test_hulls_have_corners(self):
        pool = redman.Pool("grasp", options={"object": "hull"})
        hulls = [i for i, shape in enumerate(pool.shapes) if shape.kind == redman.ShapeKind.HULL]
        corners = pool.hull(hulls[0])
        self.assertGreater(len(corners), 3)
        np.testing.assert_allclose(np.ptp(corners, axis=0) / 2, pool.shapes[hulls[0]].size, rtol=1e-4)
        with self.assertRaises(redman.Error):
            pool.hull(0 if 0 not in hulls else 1)

    def test_sensors_keep_their_memory(self):
        pool = redman.Pool("grasp", 2, options={"modality": "points+rgb+depth+segmentation+voxels", "points": 64})
        pool.reset()
        sensors = pool.sensors
        self.assertEqual(sensors.points.shape, (2, 64, 3))
        self.assertEqual(sensors.rgb.shape[:2], (2, len(sensors.cameras)))
        self.assertEqual(sensors.segmentation.shape, sensors.depth.shape)
        self.assertEqual(sensors.voxels.ndim, 4)
        self.assertFalse(sensors.points.flags.writeable)
        expected = sensors.points.copy()
        points = sensors.points[1:]
        handle = weakref.ref(pool._handle)
        pool.close()
        del pool, sensors
        gc.collect()
        np.testing.assert_array_equal(points, expected[1:])
        self.assertIsNotNone(handle())  # the array has it
        del points
        gc.collect()
        self.assertIsNone(handle())
        self.assertIsNone(redman.Pool("grasp").sensors.points)


    def test_spaces_are_those_of_its_rows(self):
        pool = redman.Pool(TASK, 3)
        self.assertEqual(pool.observation_space.shape, (3, pool.obs_dim))
        self.assertEqual(pool.single_observation_space.shape, (pool.obs_dim,))
        self.assertIn(pool.reset(), pool.observation_space)
        action = pool.action_space.sample()
        self.assertEqual((action.shape, action.dtype), (pool.action.shape, np.float32))
        pool.step(action)
        self.assertTrue(np.array_equal(pool.action, action))
        self.assertIn(action[0], pool.single_action_space)

    def test_a_spec_is_known_before_a_pool(self):
        options = {"action_repeat": 4}
        self.assertEqual(redman.spec(TASK, options), redman.Pool(TASK, 5, options=options).spec)
        with self.assertRaisesRegex(redman.NotFoundError, "nearest is action_repeat"):
            redman.spec(TASK, {"action_repea": 4})

    def test_nothing_failed_in_the_librarys_own_worlds(self):
        pool = redman.Pool(TASK, 2)
        self.assertEqual([pool.world_error(env) for env in (0, 1)], ["", ""])


class Refused(unittest.TestCase):
    def test_errors_say_what_and_are_what_python_expects(self):
        cases = [
            (lambda: redman.Pool("hand_over_safe_fingr"), redman.NotFoundError, LookupError,
             "nearest is hand_over_safe_finger"),
            (lambda: redman.Pool("bandit", num_envs=0), redman.RangeError, ValueError, "num_envs"),
            (lambda: redman.Pool("bandit", options={"nope": 1}), redman.NotFoundError, LookupError, "nope"),
            (lambda: redman.Pool("bandit", options={"points": None}), TypeError, TypeError, "points"),
            (lambda: redman.Pool("grasp", options={"object_mass": 1e9}), redman.RangeError, ValueError, "object_mass"),
            (lambda: redman.Pool("bandit").step(), redman.StateError, RuntimeError, "reset"),
            (lambda: redman.Pool("bandit").reset(seeds=-1), redman.ArgumentError, ValueError, "seeds"),
            (lambda: redman.Pool("bandit").reset(seeds=[1, 2]), redman.ArgumentError, ValueError, "seeds"),
            (lambda: redman.Pool("bandit").baseline("dance"), redman.ArgumentError, ValueError, "zero, hold, random"),
            (lambda: redman.task("nothing_like_it"), redman.NotFoundError, LookupError, "nothing_like_it"),
        ]
        for call, kind, builtin, words in cases:
            with self.assertRaisesRegex(kind, words) as caught:
                call()
            self.assertIsInstance(caught.exception, builtin)
            if isinstance(caught.exception, redman.Error):
                self.assertLess(caught.exception.code, 0)
                self.assertNotIn("\n", str(caught.exception))
                self.assertEqual(pickle.loads(pickle.dumps(caught.exception)).code, caught.exception.code)

    def test_numbers_that_the_abi_would_cut_are_refused(self):
        pool = redman.Pool("bandit", np.int64(2), seed=np.uint64(3))
        pool.reset()
        for call in (lambda: redman.Pool("bandit", num_envs=(1 << 32) + 1), lambda: redman.Pool("bandit", seed=-1),
                     lambda: redman.Pool("bandit", seed=1 << 64), lambda: redman.Pool("bandit", threads=1 << 40),
                     lambda: pool.state(1 << 32), lambda: pool.hash(1 << 32), lambda: pool.poses(1 << 32),
                     lambda: pool.render(0, width=(1 << 32) + 8), lambda: pool.push(1 << 32, 0, (0, 0, 0)),
                     lambda: redman.Agent(obs_dim=(1 << 32) + 1, action_dim=1),
                     lambda: redman.Map(0.1, memory=1 << 70)):
            with self.assertRaises(redman.RangeError):
                call()
        with self.assertRaises(TypeError):
            redman.Pool("bandit", num_envs=1.5)

    def test_options_cannot_smuggle_lines(self):
        for options in ({"modality": "none\npoints=3"}, {"points=3\nvoxels": 2}):
            with self.assertRaises(redman.Error):
                redman.Pool("bandit", options=options)

    def test_a_closed_pool_says_so(self):
        pool = played()
        with pool:
            pass
        for call in (pool.step, pool.reset, pool.hash, pool.state, pool.render, pool.baseline, pool.poses,
                     pool.joint_positions, lambda: pool.joints, lambda: pool.set_joints(0),
                     lambda: pool.raycast(0, (0, 0, 1), (0, 0, 1)), lambda: pool.stats, lambda: pool.fields, lambda: pool.options, lambda: pool.sensors,
                     lambda: pool.shapes, lambda: pickle.dumps(pool)):
            with self.assertRaisesRegex(redman.StateError, "closed"):
                call()
        self.assertIn("closed", repr(pool))


class ThreadsAndProcesses(unittest.TestCase):
    def test_a_child_process_steps_on_or_says_that_it_cannot(self):
        alone, workers = played(), played(threads=2)
        expected = copy.deepcopy(alone)
        expected.baseline("zero"), expected.step()
        child = os.fork()
        if child == 0:
            good = False
            try:
                alone.baseline("zero"), alone.step()
                try:
                    workers.step()
                except redman.StateError:
                    good = alone.hash() == expected.hash()
            finally:
                os._exit(0 if good else 1)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)

    def test_threads_that_share_a_pool_wait_for_each_other(self):
        pool = redman.Pool(TASK, 2, seed=1)
        pool.reset()
        pool.baseline("zero")
        threads = [threading.Thread(target=lambda: [pool.step() for _ in range(50)]) for _ in range(4)]
        [thread.start() for thread in threads]
        [thread.join() for thread in threads]
        twin = redman.Pool(TASK, 2, seed=1)
        twin.reset()
        twin.baseline("zero")
        [twin.step() for _ in range(200)]
        self.assertEqual(pool.hash(), twin.hash())

    def test_the_interpreter_runs_while_worlds_step(self):
        pool = redman.Pool(TASK, 512)
        pool.reset()
        busy, counted = threading.Event(), [0]
        done = threading.Event()

        def work():
            busy.set()
            for _ in range(5):
                pool.step()
            done.set()

        thread = threading.Thread(target=work)
        thread.start()
        busy.wait()
        while not done.is_set():
            counted[0] += 1
        thread.join()
        self.assertGreater(counted[0], 1000)  # a held lock would let this loop run between calls alone


class Discovery(unittest.TestCase):
    def test_tasks_say_all(self):
        tasks = redman.tasks()
        self.assertIn(TASK, tasks)
        for name, task in tasks.items():
            self.assertEqual((len(task.fields), len(task.costs), len(task.options), len(task.cameras)),
                             (task.num_fields, task.cost_dim, task.num_options, task.num_cameras))
            with redman.Pool(name) as pool:
                said = {key: option.default for key, option in task.options.items() if not key.endswith(".FIELD")
                        and not key.startswith(("joint.", "link."))}  # these only where they were set
                self.assertEqual(said, pool.options, name)
        task = redman.task("Hand-Over-Safe-Finger")
        self.assertEqual(task.name, TASK)
        self.assertEqual(next(iter(task.costs)), "cost")
        self.assertEqual(task.defaults["action_repeat"], 4)
        self.assertEqual(redman.task("jenga").defaults["action_repeat"], 8)  # the last of two rows

    def test_a_field_says_what_an_entry_of_1_is(self):
        scales = {field.unit: field.scale for task in redman.tasks().values() for field in task.fields.values()}
        for unit, scale in {"5 m/s": 5, "10 rad/s": 10, "0.1 N m": 0.1, "m": 1, "1": 1}.items():
            self.assertEqual(scales.pop(unit), scale)
        self.assertEqual([unit for unit, scale in scales.items() if np.isnan(scale)], ["2, 20 rad/s"])
        pool = redman.Pool("ball_run")
        pool.reset()
        pool.step(np.ones((1, 2)))
        velocity = pool.fields["velocity"]
        speed = velocity.scale * np.linalg.norm(pool.obs[0, velocity.slice])
        self.assertAlmostEqual(speed, pool.cost_raw[0, pool.cost_names.index("speed")], places=5)

    def test_algos_robots_objects(self):
        self.assertIn("clip", redman.algo("ppo_lag").options)
        egg = redman.objects()["egg"]
        self.assertEqual((egg.kind, egg.num_shapes, egg.own, egg.mass), (redman.ShapeKind.CAPSULE, 1, 0, 0.0754))
        self.assertEqual(egg.high, (0.03, 0.03, 0.04))
        for robot in redman.robots().values():
            self.assertEqual(len(robot.joints), robot.num_joints)


if __name__ == "__main__":
    unittest.main()
