"""Latents: a student of a teacher that observes what is drawn finds its latent in what it remembers."""
import os
import tempfile
import unittest

import numpy as np

import redman

WORLDS = {"show_dynamics": True, "action_delay": "0..3"}
LATENT = {**WORLDS, "latent": 2, "latent_hidden": "16"}


class Latent(unittest.TestCase):
    # With a delay of 0 to 3 steps a gain that is right without one swings. A student whose history tells the delay acts better than one
    # that learned nothing, and far better than one whose latent is of no use.
    def test_a_student_finds_what_its_teacher_is_told(self):
        with tempfile.TemporaryDirectory() as folder:
            here = lambda name: os.path.join(folder, name)
            teacher = redman.train("lqr_line", algo="ppo", steps=1_000_000, envs=64, seed=1, out=here("teacher"), options=LATENT)
            adapt = {**LATENT, "latent_from": "history", "history": 8}
            first = redman.train("lqr_line", algo="ppo", steps=2000, envs=64, seed=1, out=here("first"), from_=here("teacher"),
                                 options={**adapt, "learning_rate": 0})
            student = redman.train("lqr_line", algo="ppo", steps=500_000, envs=64, seed=1, out=here("student"), from_=here("teacher"),
                                   options=adapt)
            score = {name: redman.evaluate(run.policy, "lqr_line", episodes=3000, seed=777, options={"action_delay": "0..3", "show_dynamics": True})
                     for name, run in (("teacher", teacher), ("first", first), ("student", student))}
            returns = {name: e.return_mean for name, e in score.items()}
            self.assertGreater(returns["teacher"], -4.3, returns)
            self.assertGreater(returns["student"], returns["first"] + 0.5, returns)
            self.assertGreater(returns["student"], returns["teacher"] - 0.4, returns)  # one standard error of either is 0.11
            loss = student.curve["Loss/Loss_pi"]
            self.assertLess(loss[-1], 0.75 * loss[0])  # at first no history tells the delay
            self.assertEqual(student.policy.info.state_dim, 7)

    def test_it_needs_a_teacher(self):
        for student in ({"latent_from": "history"}, {"latent-from": "History"}):
            with self.subTest(student), self.assertRaisesRegex(redman.UsageError, "latent_from=history makes a student.*from_="):
                redman.train("lqr_line", algo="ppo", options={**LATENT, **student, "history": 8})

    def test_its_policy_does_not_read_what_is_drawn(self):
        pool = redman.Pool("lqr_line", num_envs=4, seed=2, options=WORLDS)
        pool.reset()
        agents = {}
        for name, options in (("teacher", {}), ("student", {"latent_from": "history", "history": 3})):
            agents[name] = redman.Agent(pool, algo="ppo", seed=1, options={"latent": 2, "last_layer_scale": 1, "horizon": 20, **options})
        teacher = agents["teacher"].policy()
        agents["student"].warm_start(teacher)
        student = agents["student"].policy()
        obs = pool.obs.copy()
        changed = obs.copy()
        changed[:, 1] = -changed[:, 1] + 0.3
        self.assertFalse(np.array_equal(teacher.act(obs), teacher.act(changed)))
        one, _ = student.act(obs, student.start(4))
        other, _ = student.act(changed, student.start(4))
        np.testing.assert_array_equal(np.asarray(one), np.asarray(other))
        with self.assertRaisesRegex(redman.ArgumentError, "a student's"):
            agents["student"].warm_start(student)
        with self.assertRaisesRegex(redman.UnsupportedError, "latent_from=history"):
            shown = redman.Recording(pool)
            with shown.step(pool):
                pool.step(teacher.act(obs))
            agents["student"].clone(shown)


if __name__ == "__main__":
    unittest.main()
