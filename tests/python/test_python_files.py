"""Robots, objects and tasks of one's own: made of dicts, read of files, written to files that read back the same; a file stands where
a name does; a run folder keeps what it was made with."""
import os
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

import redman

TREE = Path(__file__).resolve().parents[2]
TRIPOD = TREE / "examples/robots/tripod.urdf"
PRESS = TREE / "examples/scenes/press.task"
LEAF = {"name": "leaf", "joint": "hinge", "parent": "root", "kind": "revolute", "axis": [0, 0, 1], "lower": 0, "upper": 1.6, "kp": 1,
        "kd": 0.1, "effort": 5, "mass": 8, "moment": [0.5, 0.5, 0.9, 0, 0, 0]}
BOX = {"name": "my_box", "mass": 0.2, "shapes": [{"kind": "box", "size": [0.02, 0.03, 0.06]}]}
try:
    redman.load_task(b"")
except redman.UnsupportedError:
    IMPORTER = False
except redman.Error:
    IMPORTER = True
needs_importer = unittest.skipUnless(IMPORTER, "no libredman_import in this build")


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def removed(self, thing):
        self.addCleanup(lambda: gone(thing))
        return thing


def gone(thing):
    try:
        thing.remove()
    except redman.NotFoundError:  # another took its place
        pass


class Robots(Folder):
    def test_a_robot_is_made_of_a_dict(self):
        door = self.removed(redman.Robot.create(name="my_door", num_commands=-1, links=[LEAF]))
        self.assertEqual((list(door.joints), door.num_actuated), (["hinge"], 0))
        self.assertEqual(door.joints["hinge"].upper, 1.6)
        self.assertIn("my_door", redman.robots())
        link = door.definition["links"][0]
        self.assertEqual({key: link[key] for key in ("kind", "parent", "mass", "axis")},
                         {"kind": "revolute", "parent": -1, "mass": 8, "axis": [0, 0, 1]})
        door.remove()
        self.assertNotIn("my_door", redman.robots())
        with self.assertRaises(redman.NotFoundError):
            redman.robot("my_door")

    def test_what_a_robot_is_makes_it_again(self):
        for name in ("shadow_hand", "allegro", "ur5e", "barrett"):
            said = redman.robot(name).definition
            again = self.removed(redman.Robot.create(**{**said, "name": "again", "alias": None}))
            self.assertEqual({**again.definition, "name": said["name"]}, {key: said[key] for key in said if key != "alias"})
            again.remove()

    def test_names_and_aliases_find_it(self):
        self.assertIs(redman.robots()["shadow"], redman.robot("shadow_hand"))
        self.assertIs(redman.robot(redman.robot("ur5e")), redman.robot("ur5e"))
        with self.assertRaisesRegex(redman.NotFoundError, "nearest is shadow"):
            redman.robots()["shadw"]

    def test_frames_and_reach(self):
        arm = redman.robot("ur5e")
        poses = arm.poses()
        self.assertEqual((poses.links.shape, poses.tips.shape, poses.palm), ((6, 7), (0, 3), None))
        q = arm.reach(poses.flange, arm.home + 0.1)
        self.assertLess(np.abs(arm.poses(q).flange - poses.flange).max(), 1e-4)
        self.assertIsNone(arm.reach([9, 9, 9, 0, 0, 0, 1]))
        hand = redman.robot("shadow_hand").poses()
        self.assertEqual((hand.tips.shape, hand.palm.shape), ((5, 3), (7,)))
        with self.assertRaises(redman.UnsupportedError):
            redman.robot("shadow_hand").reach(poses.flange)

    def test_a_hand_is_mounted_on_an_arm(self):
        both = self.removed(redman.robot("ur5e").mounted("shadow_hand", "arm_and_hand", yaw=0.5, adapter=0.02))
        self.assertEqual(both.num_joints, 6 + 24)

    def test_errors_name_the_row_and_what_may_be(self):
        for links, words in (([{**LEAF, "parnt": 0}], r"links\[0\]: there is no 'parnt'; nearest is parent"),
                             ([{**LEAF, "parent": "rot"}], r"links\[0\]: parent: 'rot' is none of root.*nearest is root"),
                             ([{**LEAF, "kind": "hinge"}], "'hinge' is none of revolute, prismatic"),
                             ([{**LEAF, "axis": [0, 1]}], "axis"),
                             ([{**LEAF, "mass": "heavy"}], "mass: it must be a number, not 'heavy'"),
                             ([{**LEAF, "lower": 2}], "leaf|lower|range")):
            with self.assertRaisesRegex(redman.Error, words):
                redman.Robot.create(name="bad", links=links)
        self.assertNotIn("bad", redman.robots())


class Objects(Folder):
    def test_an_object_is_made_of_a_dict_and_handled(self):
        box = self.removed(redman.Object.create(**BOX))
        self.assertEqual((box.name, box.kind, box.mass, box.own), ("my_box", redman.ShapeKind.BOX, 0.2, 1))
        self.assertEqual(box.definition["shapes"][0]["size"], [0.02, 0.03, 0.06])
        pool = redman.Pool("grasp", options={"object": box})
        self.assertEqual(pool.options["object"], "my_box")
        redman.Object.check(**{**BOX, "name": "mug"})
        with self.assertRaisesRegex(redman.ArgumentError, "already used"):
            redman.Object.create(**BOX)
        with self.assertRaisesRegex(redman.UsageError, "nearest is mass"):
            redman.Object.check(**{**BOX, "mas": 1})
        with self.assertRaisesRegex(redman.RangeError, "mass"):
            redman.Object.check(**{**BOX, "mass": -1})

    def test_an_alias_finds_it(self):
        alias = next(thing for thing in redman.objects().values() if thing.alias)
        self.assertEqual(redman.objects()[alias.alias], alias)

    def test_corners_of_a_hull(self):
        points = [[0.03, 0, 0], [-0.03, 0, 0], [0, 0.03, 0], [0, -0.03, 0], [0, 0, 0.03], [0, 0, -0.03]]
        gem = self.removed(redman.Object.create(name="gem", mass=0.1, shapes=[{"kind": "hull", "points": points}]))
        self.assertLess(np.abs(np.array(gem.definition["shapes"][0]["points"]) - points).max(), 1e-12)

    @needs_importer
    def test_a_file_reads_back_the_same(self):
        box = self.removed(redman.Object.create(**BOX))
        said = box.definition
        box.save(self.folder / "my_box.object")
        box.remove()
        again = self.removed(redman.load(self.folder / "my_box.object"))
        self.assertEqual(again.definition, said)
        again.remove()
        self.removed(redman.load_object((self.folder / "my_box.object").read_bytes()))


class Written(Folder):
    @unittest.skipIf(os.name == "nt", "modes and links of POSIX")
    def test_a_replaced_file_keeps_its_permissions(self):
        path, link = self.folder / "p.rdm", self.folder / "link.rdm"
        link.symlink_to(path)
        policy = redman.Policy.trained("two_state")
        policy.save(path)
        for name in (path, link):
            path.chmod(0o600)
            path.write_bytes(b"old")
            policy.save(name)
            self.assertEqual((path.stat().st_mode & 0o777, path.read_bytes()), (0o600, bytes(policy)))
        self.assertTrue(link.is_symlink())
        with self.assertRaisesRegex(redman.FileError, "not a regular file"):
            policy.save("/dev/null")


@needs_importer
class Files(Folder):
    def test_a_robot_of_a_file_tells_what_was_guessed(self):
        robot = self.removed(redman.load_robot(TRIPOD, check=True))
        self.assertEqual(robot.name, "tripod")
        kinds = {note.kind for note in robot.notes}
        self.assertIn(redman.NoteKind.GUESSED, kinds)
        self.assertTrue(all(note.text and note.line >= 0 for note in robot.notes))
        self.assertIs(redman.load_robot(TRIPOD, check=True), robot)
        self.assertEqual(redman.robot("ur5e").notes, ())

    def test_a_file_that_changed_takes_the_place_of_what_it_was(self):
        path = self.folder / "mine.urdf"
        shutil.copy(TRIPOD, path)
        first = redman.load_robot(path, name="mine")
        path.write_text(path.read_text().replace('effort="', 'effort="1', 1))
        os.utime(path, ns=(time.time_ns(), time.time_ns() + 1_000_000))
        second = self.removed(redman.load_robot(path, name="mine"))
        self.assertNotEqual(first.number, second.number)
        self.assertNotEqual(first.joints, second.joints)
        self.assertEqual(redman.robots()["mine"], second)

    def test_a_robot_file_reads_back_to_the_last_bit(self):
        robot = self.removed(redman.load_robot(TRIPOD))
        robot.save(self.folder / "other.robot")
        text = (self.folder / "other.robot").read_bytes()
        with self.assertRaisesRegex(redman.ArgumentError, "other.robot: .*already used"):
            redman.load(self.folder / "other.robot")
        again = self.removed(redman.load_robot(text, name="other"))
        self.assertEqual({**again.definition, "name": "tripod"}, robot.definition)

    def test_files_stand_where_names_do(self):
        box = redman.Object.create(**BOX)
        box.save(self.folder / "my_box.object")
        box.remove()
        options = {"hand": str(TRIPOD), "object": self.folder / "my_box.object"}
        pool = redman.Pool("grasp", options=options)
        self.removed(redman.robot("tripod"))
        self.removed(redman.objects()["my_box"])
        self.assertEqual((pool.options["hand"], pool.options["object"]), ("tripod", "my_box"))
        self.assertEqual(redman.spec("grasp", options).action_dim, pool.action_dim)
        press = redman.Pool(PRESS, 2)
        self.removed(press.task)
        self.assertEqual(press.task.name, "press_button")
        for task in (redman.load(PRESS), redman.task(PRESS)):
            self.assertIs(task, press.task)
        redman.check_task(PRESS)
        self.assertEqual(redman.evaluate("zero", str(PRESS), episodes=1).episodes, 1)
        with self.assertRaisesRegex(redman.MissingFileError, "nearest is press.task"):
            redman.Pool(str(PRESS.with_name("pres.task")))
        with self.assertRaises(redman.MissingFileError):
            redman.Pool("grasp", options={"hand": "/nowhere/my.urdf"})

    def test_errors_have_file_and_line(self):
        path = self.folder / "bad.urdf"
        path.write_text(TRIPOD.read_text().replace("<limit", "<limt", 1))
        with self.assertRaisesRegex(redman.Error, r"bad\.urdf.*line \d+.*limt"):
            redman.load_robot(path)
        with self.assertRaisesRegex(redman.ArgumentError, "kind: 'hnd' is none of other, hand, arm"):
            redman.load_robot(TRIPOD, kind="hnd")
        with self.assertRaisesRegex(redman.FormatError, "ends in none of"):
            redman.load(__file__)

    def test_a_run_folder_is_whole_in_another_process(self):
        redman.Object.create(**BOX)
        run = redman.train("grasp", steps=600, envs=4, options={"horizon": 32, "hand": str(TRIPOD), "object": "my_box"},
                           out=self.folder / "hand", progress=False)
        press = redman.train(PRESS, steps=600, envs=4, options={"horizon": 32}, out=self.folder / "press", progress=False)
        numbers = [redman.evaluate(r, episodes=2).return_mean for r in (run, press)]
        for thing in (redman.objects()["my_box"], redman.robot("tripod"), redman.task("press_button")):
            self.removed(thing)
        code = ("import redman, sys\n"
                "print([redman.evaluate(folder, episodes=2).return_mean for folder in sys.argv[1:]])\n"
                "redman.objects()['my_box'].remove()\n"
                "redman.Object.create(name='my_box', mass=0.4, shapes=[{'kind': 'box', 'size': [0.02, 0.03, 0.06]}])\n"
                "try:\n    redman.load(sys.argv[1])\nexcept redman.ArgumentError as error:\n    print(error)\n")
        folders = [str(self.folder / "hand"), str(self.folder / "press")]
        said = subprocess.run([sys.executable, "-c", code, *folders], check=True, capture_output=True, text=True).stdout
        self.assertEqual(said.splitlines()[0], str(numbers))
        self.assertIn("its object my_box differs", said)
        if os.environ.get("REDMAN_TOOL"):
            for folder, number in zip(folders, numbers):
                told = subprocess.run([os.environ["REDMAN_TOOL"], "eval", "--policy", folder, "--episodes", "2", "--json"],
                                      check=True, capture_output=True, text=True).stdout
                self.assertIn(f'"return_mean":{number!r},', told)

    def test_a_pool_of_files_is_made_again_by_another_process(self):
        pool = redman.Pool(PRESS, 2, seed=5)
        self.removed(pool.task)
        pool.reset()
        import pickle
        (self.folder / "pool").write_bytes(pickle.dumps(pool))
        code = "import pickle, sys; print(pickle.load(open(sys.argv[1], 'rb')).hash())"
        said = subprocess.run([sys.executable, "-W", "ignore", "-c", code, self.folder / "pool"], check=True, capture_output=True,
                              text=True).stdout
        self.assertEqual(said.strip(), pool.hash())


class Kinds(Folder):
    def test_load_gives_what_a_file_holds(self):
        agent = redman.Agent(obs_dim=3, action_dim=1)
        agent.policy().save(self.folder / "p.rdm")
        agent.save(self.folder / "a.rdm")
        agent.write_checkpoint(self.folder / "c.rdm")
        room = redman.Map()
        room.insert([0, 0, 0], [[1, 0, 0]])
        room.save_file(self.folder / "room.ot")
        rows = redman.Recording(obs_dim=3, action_dim=1)
        rows.append(obs=np.zeros((2, 3)), action=np.zeros((2, 1)))
        rows.save(self.folder / "rows.npz")
        redman.train("bandit", steps=500, envs=4, out=self.folder / "run", progress=False)
        for name, kind in (("p.rdm", redman.Policy), ("room.ot", redman.Map), ("rows.npz", redman.Recording),
                           ("run", redman.Policy), ("run/progress.csv", redman.Curve)):
            self.assertIs(type(redman.load(self.folder / name)), kind, name)
        self.assertEqual(redman.load(self.folder / "room.ot").save(), room.save())
        for name in ("a.rdm", "c.rdm"):
            with self.assertRaisesRegex(redman.FormatError, r"agent\.load\(path\), or agent\.read_checkpoint"):
                redman.load(self.folder / name)
        with self.assertRaisesRegex(redman.MissingFileError, "no policy.rdm in it"):
            redman.load(self.folder)


class Importer(unittest.TestCase):
    def test_without_it_the_error_says_what_to_do(self):
        code = f"import redman\ntry:\n    redman.load_task({str(PRESS)!r})\nexcept redman.UnsupportedError as e:\n    print(e)"
        said = subprocess.run([sys.executable, "-c", code], env={**os.environ, "REDMAN_IMPORT_LIBRARY": "/nowhere.so"}, check=True,
                              capture_output=True, text=True).stdout
        self.assertRegex(said, "libredman_import.*/nowhere.so.*Set REDMAN_IMPORT_LIBRARY")


class Tables(unittest.TestCase):
    def test_what_exists_is_read_once(self):
        self.assertIs(redman.tasks()["bandit"], redman.task("bandit"))
        self.assertIs(redman.robots()["ur5e"], redman.robots()["ur5e"])
        pool = redman.Pool("grasp")
        for name in ("fields", "shapes", "joints", "cameras"):
            first, second = getattr(pool, name), getattr(pool, name)
            self.assertEqual(first, second)
            self.assertIsNot(first, second)  # a user's changes are not the pool's
            rows = (list(table.values()) if isinstance(table, dict) else table for table in (first, second))
            self.assertTrue(all(a is b for a, b in zip(*rows)), name)

    def test_cameras_are_all_that_a_pool_can_look_by(self):
        pool = redman.Pool("grasp")
        self.assertLessEqual(set(pool.task.cameras), set(pool.cameras))
        self.assertIn("right_palm", pool.cameras)
        pool.reset()
        self.assertEqual(pool.render(camera="right_palm", width=8, height=8).shape, (8, 8, 3))

    def test_halves_of_the_library(self):
        self.assertIn(redman.Feature.POLICY, redman.features())


if __name__ == "__main__":
    unittest.main()
