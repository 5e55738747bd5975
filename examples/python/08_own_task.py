"""08: a task of your own in Python: the one of examples/07_own_task.c, the same scene, reward and cost.

    python3 08_own_task.py [steps]

A Shadow Hand presses a button with its first finger; touching the cup beside it costs 1 per step. The functions see all worlds
of a pool at once: each array has a row for each world.
"""
import sys

import numpy as np

import redman

BUTTON = {  # a tree of one link: a cap on a spring; m, kg, N/m
    "links": [{"name": "cap", "joint": "spring", "parent": "root", "kind": "prismatic", "axis": [0, 0, 1], "lower": -0.01,
               "kp": 100, "kd": 2, "effort": 2, "mass": 0.02, "moment": [1e-5, 1e-5, 1e-5, 0, 0, 0]}],
    "shapes": [{"link": "cap", "name": "top", "kind": "cylinder", "size": [0.012, 0.006]}]}


class Press(redman.Task):
    """Press a button; cost: touching the cup beside it."""

    name, max_steps, action_dim, obs_limit = "press", 60, 20, 5
    fields = {"joints": (25, "rad"), "rates": (25, "10 rad/s"), "cup": (3, "m")}
    costs = {"touch": (5, "the hand touches the cup; raw: contact force, N")}

    def scene(self, s):
        self.hand = s.robot("shadow_hand", "hand", pose=[0, 0, 0.1, 0, 1, 0, 0])
        s.robot(BUTTON, "button", pose=[-0.033, -0.43, 0.03])
        self.cup = s.cylinder("cup", 0.02, 0.025, mass=0.1, pose=[0.01, -0.43, 0.025])
        s.plane("ground")
        self.spring, self.tip = s.find("joint", "button_spring"), s.find("link", "hand_ff_distal")
        self.touch = s.touch("hand", "cup")

    def reset(self, w):
        w.set_joints(self.hand, w.uniform(0, 0.1, 24))

    def control(self, w, action):
        w.command(self.hand, action)

    def judge(self, w):
        pressed = w.joint(self.spring) / -0.01
        away = np.abs(w.link(self.tip)[:, 1:3] - w.link(self.spring)[:, 1:3]).sum(axis=1)
        return redman.Verdict(pressed - 5 * away, {"touch": w.touching(self.touch)}, raw={"touch": w.touch_force(self.touch)},
                              success=pressed > 0.8)

    def observe(self, w):
        return w.q, 0.1 * w.qd, w.position(self.cup)


if __name__ == "__main__":
    steps = float(sys.argv[1]) if len(sys.argv) > 1 else 30_000
    redman.check_task(Press)                                # tries what a task promises
    pool = redman.Pool(Press, num_envs=64)
    redman.Agent(pool).learn(steps, pool, callback=lambda e: print(
        f"epoch {e.epoch:2}: return {e.ret:6.2f}, cost {e.cost[0]:5.2f}, success {e.success_rate:.2f}"))
