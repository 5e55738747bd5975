"""Shield: no cost comes of what it lets through, in a pool, an agent, an evaluation and an environment; it tells what it did,
goes on from a state with the same bytes, and says what is wrong."""
import copy
import json
import os
import pickle
import subprocess
import unittest

import numpy as np

import redman
from redman import gym
from same import same, shaped

TOOL = os.environ.get("REDMAN_TOOL", "")
TASK = "hand_over_safe_joint"
HELD = {"action_repeat": 4}
NOWHERE = {"start_finger": "paper", "window.ff2.low": 80, "window.ff2.high": 85}  # of safe_finger: no start is within it
FREE = {"cost": 1e9}


def worlds(n=6, options=HELD, task=TASK, **arguments):
    pool = redman.Pool(task, n, seed=3, options=options, **arguments)
    pool.reset()
    return pool


def play(pool, shield, steps):
    for _ in range(steps):
        pool.baseline("random")
        if shield:
            shield.act()
        pool.step()


class Pools(unittest.TestCase):
    def test_no_cost_comes_whatever_is_proposed(self):
        free, pool = worlds(16), worlds(16)
        play(free, None, 30)
        self.assertGreater(free.stats.violations, 0)
        shield = redman.Shield(pool, seed=5)
        play(pool, shield, 30)
        stats = shield.stats
        self.assertEqual((pool.stats.violations, stats.unproven, stats.decisions), (0, 0, 16 * 30))
        self.assertGreater(shield.interventions, 0)
        self.assertEqual(shield.interventions, stats.changed + stats.planned)
        self.assertGreater(stats.copied, stats.decisions)

    def test_it_looks_at_the_pools_actions_or_at_others(self):
        pool = worlds(4)
        shield = redman.Shield(pool)
        self.assertIs(shield.act(), pool.action)
        proposed = np.full((4, pool.action_dim), 2.0)  # all joints to their ends
        given = proposed.copy()
        for _ in range(18):
            out = shield.act(proposed)
            if shield.intervened.any():
                break
            pool.step(out)
        self.assertTrue(shield.intervened.any())
        self.assertTrue(same(proposed, given))
        self.assertEqual((out.dtype, out.shape), (np.float32, given.shape))
        changed = (out != given).any(axis=1)
        self.assertTrue(same(changed, shield.intervened))
        self.assertTrue(same(changed, shield.kinds != redman.ShieldKind.OWN))
        kinds = shield.kinds
        masked = shield.act(proposed, mask=[True, False, False, False])
        self.assertTrue(same(masked[0], out[0]))
        self.assertTrue((masked[1:] == 2).all())
        self.assertTrue(same(shield.kinds, kinds))
        one = worlds(1)
        self.assertEqual(redman.Shield(one).act(np.zeros(one.action_dim)).shape, (one.action_dim,))

    def test_a_row_says_what_would_have_come(self):
        pool = worlds(1, {})
        shield = redman.Shield(pool)
        bad = np.zeros(pool.action_dim, np.float32)
        bad[2] = 1  # FF4 to the end of its range
        out = shield.act(bad)
        while shield.row().kind == redman.ShieldKind.OWN:
            row = shield.row()
            self.assertEqual((row.column, row.cost, row.ahead), (None, None, 0))
            pool.step(out)
            out = shield.act(bad)
        row, plan = shield.row(0), shield.plan(0)
        self.assertIsInstance(row, redman.ShieldRow)
        self.assertIs(row.kind, redman.ShieldKind.CHANGED)
        self.assertEqual((row.column, row.cost), (0, "cost"))
        self.assertGreater(row.ahead, 0)
        self.assertIn(shield.backups[row.backup], ("zero", "hold"))
        self.assertEqual(plan.shape, (row.planned, pool.action_dim))
        self.assertTrue(same(plan[0], out))
        for step in range(1, row.ahead + 1):  # without the shield it comes just then
            pool.step(bad)
            self.assertEqual(pool.cost[0, 0] > 0, step == row.ahead)

    def test_budgets_are_said_as_limits_are(self):
        pool = worlds(4)
        rest = [None] * (pool.cost_dim - 1)
        for said, has in ((None, [0, *rest]), (7, [7, *rest]), ({"ff2_range": 3.0}, [0, 3, *rest[1:]]),
                          ({"cost": None, "ff2_range": 0}, [None, 0, *rest[1:]]), ([1, *rest], [1, *rest])):
            self.assertEqual(redman.Shield(pool, budgets=said).budgets, has)
        shield = redman.Shield(pool, budgets=7.0)
        most = 0
        for _ in range(18):
            pool.baseline("random")
            shield.act()
            pool.step()
            most = max(most, pool.episode_cost[:, 0].max())
        self.assertGreater(most, 0)
        self.assertLessEqual(most, 7)
        with self.assertRaisesRegex(redman.NotFoundError, "budgets: no cost costt; nearest is cost"):
            redman.Shield(pool, budgets={"costt": 1})
        with self.assertRaisesRegex(redman.ArgumentError, "no cost has a budget"):
            redman.Shield(pool, budgets={"cost": None})

    def test_options_have_help_and_are_told(self):
        rows = redman.shield_options()
        self.assertEqual(list(rows)[:2], ["block", "look"])
        self.assertTrue(all(row.help for row in rows.values()))
        shield = redman.Shield(worlds(2), options={"noise": 0.5, "hold": False, "unproven": "least"})
        self.assertEqual(list(shield.options), list(rows))
        self.assertEqual({key: value for key, value in shield.options.items() if value != rows[key].default},
                         {"noise": 0.5, "hold": False, "unproven": "least"})
        self.assertEqual(shield.backups, ["zero"])

    def test_policies_are_backups(self):
        policy = redman.Policy.trained("reorient")
        pool = worlds(3, {"action_repeat": policy.info.action_repeat}, "reorient")
        for said in (policy, "trained"):
            shield = redman.Shield(pool, said)
            self.assertEqual((shield.steps, bytes(shield.backups[0])), (1, bytes(policy)))
        shield = redman.Shield(pool)
        shield.add(policy)
        self.assertEqual(shield.backups, [policy, "zero", "hold"])
        play(pool, shield, 8)
        self.assertEqual(pool.stats.violations, 0)
        single = worlds(2, {}, "reorient")
        self.assertEqual(redman.Shield(single, policy).steps, policy.info.action_repeat)
        with self.assertRaisesRegex(redman.ArgumentError, "policy: it holds an action for"):
            redman.Shield(single, policy, steps=1)
        with self.assertRaisesRegex(redman.VersionError, "on task reorient: "):
            redman.Shield(single, redman.Policy.trained("jenga"))
        with self.assertRaisesRegex(redman.UsageError, "policy: it must be a redman.Policy"):
            shield.add(3)


class States(unittest.TestCase):
    def test_a_state_goes_on_with_the_same_bytes(self):
        pool = worlds()
        shield = redman.Shield(pool, seed=5, options={"noise": 0.5})
        play(pool, shield, 7)
        at = pool.state(), shield.state()
        play(pool, shield, 11)
        end = pool.hash(), shield.state()
        pool.set_state(at[0])
        other = redman.Shield(pool, seed=5, options={"noise": 0.5})
        other.set_state(at[1])
        play(pool, other, 11)
        self.assertEqual((pool.hash(), other.state()), end)
        with self.assertRaises(redman.FormatError):
            redman.Shield(pool).set_state(at[1])
        with self.assertRaises(redman.FormatError):
            other.set_state(at[1][:-9])
        self.assertEqual(other.state(), end[1])

    def test_pickle_and_deepcopy_go_on_alike(self):
        pool = worlds(options={"action_repeat": 3}, task="reorient")
        shield = redman.Shield(pool, "trained", seed=5)
        shield.add("trained")
        play(pool, shield, 5)
        others = [pickle.loads(pickle.dumps(shield)), copy.deepcopy(shield)]
        play(pool, shield, 5)
        for other in others:
            self.assertEqual((len(other.backups), other.steps, other.options), (4, 1, shield.options))
            play(other.pool, other, 5)
            self.assertEqual((other.pool.hash(), other.state()), (pool.hash(), shield.state()))

    def test_guards_are_kept_without_copies(self):
        options = {"cost_mode": "command"}
        free, pool = worlds(8, options, "hand_over_safe_finger"), worlds(8, options, "hand_over_safe_finger")
        self.assertEqual(worlds(1, {}, "hand_over_safe_finger").guards, [])
        guards = [guard for guard in pool.guards if guard.column == 0]
        self.assertEqual((len(guards), {guard.cost for guard in guards}), (6, {"cost"}))
        self.assertEqual([guard.normal[guard.entry] for guard in guards], [1, -1] * 3)
        shield = redman.Shield(pool, options={"predict": False})
        play(free, None, 30)
        play(pool, shield, 30)
        self.assertGreater(free.stats.violations, 0)
        self.assertEqual((pool.stats.violations, shield.stats.copied), (0, 0))
        self.assertGreater(shield.interventions, 0)
        self.assertEqual(shield.interventions, shield.stats.projected)
        row = shield.row(int(np.argmax(shield.intervened)))
        self.assertEqual((row.kind, row.cost), (redman.ShieldKind.PROJECTED, "cost"))

    def test_guards_of_ones_own_are_each_worlds(self):
        pool = worlds(3, {}, "hand_over_wall")
        shield = redman.Shield(pool, options={"predict": False})
        normal = np.linspace(-1, 1, pool.action_dim)
        self.assertEqual((shield.add_guard(normal, 0.5), shield.add_guard(-normal, 9)), (0, 1))
        shield.set_guard(2, 0, normal[::-1], 0.25)
        proposed = np.tile(np.linspace(-0.9, 0.9, pool.action_dim), (3, 1)).astype(np.float32)
        out = shield.act(proposed)
        self.assertTrue(same(out[1], redman.project([normal], [0.5], proposed[1])))
        self.assertTrue(same(out[2], proposed[2]))
        self.assertEqual((shield.row(1).kind, shield.row(1).cost), (redman.ShieldKind.PROJECTED, None))
        other = pickle.loads(pickle.dumps(shield))
        self.assertEqual(other.state(), shield.state())
        self.assertTrue(same(other.act(proposed), out))
        with self.assertRaisesRegex(redman.ArgumentError, "no action of world 1"):
            shield.set_guard(1, 0, normal, -100)
        with self.assertRaisesRegex(redman.ArgumentError, "normal: its shape"):
            shield.add_guard([1, 2], 0)
        with self.assertRaisesRegex(redman.ArgumentError, "row 0: its normal is 0"):
            redman.project([[0, 0]], [1], [0, 0])

    def test_threads_change_nothing(self):
        ends = []
        for threads in (0, 2):
            pool = worlds(5, threads=threads)
            shield = redman.Shield(pool, seed=1, threads=threads)
            play(pool, shield, 12)
            ends.append((pool.hash(), shield.state()))
        self.assertEqual(*ends)

    def test_a_plan_of_ones_own_is_tried(self):
        pool = worlds(2, {}, "hand_over_safe_joint")
        shield = redman.Shield(pool, options={"hold": False})
        plan = np.zeros((5, pool.action_dim), np.float32)
        shield.set_plan(plan, env=1)
        before = shield.plan(1)
        self.assertTrue(same(before[:5], plan))
        self.assertEqual(len(shield.plan(0)), 0)
        plan[:, 2] = 1  # FF4 to the end of its range
        with self.assertRaisesRegex(redman.StateError, "world 1: under the plan cost column 0"):
            shield.set_plan(np.repeat(plan, 4, 0), env=1)
        self.assertTrue(same(shield.plan(1), before))
        with self.assertRaisesRegex(redman.ArgumentError, r"plan: its shape is \(3,\)"):
            shield.set_plan([1, 2, 3])
        shield.act(np.zeros((2, pool.action_dim)))
        self.assertEqual(shield.kinds.tolist(), [shield.row(env).kind for env in (0, 1)])

    def test_a_reset_forgets_plans(self):
        pool = worlds(2)
        shield = redman.Shield(pool)
        shield.act()
        self.assertEqual([len(shield.plan(env)) for env in (0, 1)], [19, 19])
        shield.reset([False, True])
        self.assertEqual([len(shield.plan(env)) for env in (0, 1)], [19, 0])


class Refused(unittest.TestCase):
    def test_a_world_in_which_nothing_is_clean_is_named(self):
        pool = worlds(3, NOWHERE, "hand_over_safe_finger")
        shield = redman.Shield(pool)
        with self.assertRaisesRegex(redman.StateError, 'world 1: .*column 0, cost; .*unproven=least'):
            shield.act(mask=[0, 1, 1])
        shield = redman.Shield(pool, options={"unproven": "least"})
        shield.act()
        self.assertEqual(shield.kinds.tolist(), [redman.ShieldKind.UNPROVEN] * 3)
        self.assertEqual(shield.stats.unproven, 3)

    def test_what_is_wrong_is_said(self):
        pool = worlds(2)
        shield = redman.Shield(pool)
        for make, kind, words in (
                (lambda: redman.Shield(pool, options={"blok": 3}), redman.NotFoundError, "block"),
                (lambda: redman.Shield(pool, blok=3), redman.UsageError, "there is no such argument"),
                (lambda: redman.Shield(pool, block=3, options={"block": 4}), redman.UsageError, "option block is given twice"),
                (lambda: redman.Shield(pool, options={"noise": 3}), redman.RangeError, "noise"),
                (lambda: redman.Shield(pool, steps=2000), redman.RangeError, "steps"),
                (lambda: redman.Shield("bandit"), redman.UsageError, "shield=True"),
                (lambda: shield.act(np.zeros((3, pool.action_dim))), redman.ArgumentError, "proposed: its shape"),
                (lambda: shield.act(np.full((2, pool.action_dim), np.nan)), redman.ArgumentError, "not finite"),
                (lambda: shield.act(mask=[1, 1, 1]), redman.ArgumentError, "mask: its shape"),
                (lambda: shield.row(2), IndexError, "env"),
                (lambda: shield.settings, AttributeError, "shield.options"),
                (lambda: shield.bakups, AttributeError, "nearest is backups"),
                (lambda: redman.Shield(redman.Pool(TASK, 1)).act(), redman.StateError, "reset it first")):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                make()
        pool.close()
        with self.assertRaisesRegex(redman.StateError, "pool: it was closed"):
            shield.act()


class Agents(unittest.TestCase):
    def learner(self, **options):
        pool = worlds(8, {})
        small = {"hidden": "16", "horizon": 16, "action_repeat": 4, **options}
        return redman.Agent(pool, seed=1, options=small), pool

    def test_rollouts_go_under_it(self):
        agent, pool = self.learner()
        free = agent.rollout(pool)
        self.assertIsNone(agent.shield)
        self.assertGreater(free.violations, 0)
        self.assertEqual((free.refused, free.unproven, free.copied, free.inevitable), (None, None, None, None))
        self.assertIsNone(json.loads(json.dumps(free))["refused"])
        agent, pool = self.learner(shield_learn="end")
        agent.shield = shield = redman.Shield(pool, steps=4)
        self.assertIs(agent.shield, shield)
        epoch = agent.rollout(pool)
        self.assertEqual((epoch.violations, epoch.unproven, epoch.inevitable, pool.stats.violations), (0, 0, 0, 0))
        self.assertEqual(epoch.refused, shield.interventions)
        self.assertGreater(epoch.refused, 0)
        self.assertEqual(epoch.copied, shield.stats.copied)
        agent.shield = None
        self.assertIsNone(agent.rollout(pool).refused)

    def test_what_was_recorded_by_hand_counts_no_violations(self):
        with redman.Agent(obs_dim=1, action_dim=1, options={"horizon": 1}) as agent:
            agent.act([[0.0]])
            agent.record(1.0, [[1.0]], terminated=True)
            self.assertIsNone(agent.update([[0.0]]).violations)

    def test_a_copy_goes_on_alike(self):
        agent, pool = self.learner()
        agent.shield = redman.Shield(pool, steps=4)
        agent.rollout(pool)
        other, worlds_of_other = pickle.loads(pickle.dumps((agent, pool)))
        self.assertIs(other.shield.pool, worlds_of_other)
        self.assertEqual(repr(agent.rollout(pool)), repr(other.rollout(worlds_of_other)))
        self.assertEqual(bytes(agent.policy()), bytes(other.policy()))

    def test_what_does_not_fit_is_refused(self):
        agent, pool = self.learner()
        with self.assertRaisesRegex(redman.UsageError, "shield: it must be a redman.Shield, not"):
            agent.shield = True
        agent.shield = redman.Shield(pool)
        with self.assertRaisesRegex(redman.ArgumentError, "decisions last 1 control steps, but the agent's last 4"):
            agent.rollout(pool)
        agent.close()
        with self.assertRaisesRegex(redman.StateError, "closed"):
            agent.shield = None


class Evaluations(unittest.TestCase):
    def test_decisions_are_looked_at(self):
        said = {"episodes": 12, "num_envs": 5, "action_repeat": 4}
        free, e = redman.evaluate("random", TASK, **said), redman.evaluate("random", TASK, shield=True, **said)
        self.assertEqual(free.violating_steps, free.costs[:, 0].sum())  # each is a cost of 1 of the one cost with a limit
        self.assertGreater(free.violating_steps, 0)
        self.assertEqual((free.decisions, free.interventions, free.inevitable_steps), (None, None, None))
        self.assertEqual((e.violating_steps, e.inevitable_steps, e.cost_mean[0]), (0, 0, 0))
        self.assertEqual(e.decisions, np.ceil(e.lengths / 4).sum())
        self.assertTrue(0 < e.interventions < e.decisions)

    def test_steps_that_no_plan_avoids_are_counted(self):
        said = {"episodes": 16, "shield": True}
        e = redman.evaluate("hold", "reorient", action_repeat=3, **said)  # some episodes begin with the object outside the window
        self.assertGreater(e.inevitable_steps, 0)
        self.assertEqual(e.inevitable_steps, e.violating_steps)
        self.assertIn(f"violating steps {e.violating_steps}, of which {e.inevitable_steps} were inevitable", str(e))
        held = redman.evaluate("hold", "reorient", options={"action_repeat": 3}, **said)
        self.assertEqual((held.violating_steps, held.inevitable_steps), (e.violating_steps, e.inevitable_steps))
        free = redman.evaluate("random", TASK, episodes=12, action_repeat=4, shield={"budgets": FREE})  # within the budgets, so not inevitable
        self.assertEqual(free.inevitable_steps, 0)
        self.assertGreater(free.violating_steps, 0)

    def test_a_shield_that_has_nothing_to_do_changes_no_number(self):
        for player, more in (("trained", {}), ("trained", {"magnitudes": True}), ("random", {"action_repeat": 2})):
            free = redman.evaluate(player, TASK, episodes=6, num_envs=4, **more)
            e = redman.evaluate(player, TASK, episodes=6, num_envs=4, shield={"budgets": FREE}, **more)
            self.assertEqual(e.interventions, 0)
            for name in ("returns", "costs", "lengths", "successes"):
                self.assertTrue(same(getattr(e, name), getattr(free, name)), (player, more, name))

    def test_decisions_are_held(self):
        policy = redman.Policy.trained(TASK)
        one = redman.evaluate(policy, TASK, episodes=6, num_envs=4, shield=True)  # in single control steps
        held = redman.evaluate(policy, TASK, episodes=6, num_envs=4, options=HELD, shield=True)
        self.assertGreater(held.interventions, 0)
        self.assertEqual((one.decisions, one.interventions, one.violating_steps),
                         (held.decisions, held.interventions, held.violating_steps))
        self.assertTrue(same(one.costs, held.costs))
        self.assertTrue(same(one.lengths, held.lengths))

    @unittest.skipUnless(TOOL, "no tool")
    def test_it_has_the_figures_of_the_command(self):
        e = redman.evaluate("trained", TASK, episodes=6, shield=True)
        said = subprocess.run([TOOL, "eval", "--task", TASK, "--policy", "trained", "--shield", "predict", "--episodes", "6", "--json"],
                              check=True, capture_output=True, text=True)
        theirs = json.loads(said.stdout)
        self.assertEqual([theirs[name] for name in ("return_mean", "decisions", "interventions", "unproven", "violating_steps")],
                         [e.return_mean, e.decisions, e.interventions, 0, e.violating_steps])
        self.assertGreater(e.interventions, 0)

    def test_what_is_no_number_ends_an_episode_there_too(self):
        def play(obs):
            return np.full((len(obs), 40), np.nan)
        with self.assertWarns(RuntimeWarning):
            e = redman.evaluate(play, TASK, episodes=2, shield=True)
        self.assertEqual((e.bad_actions, e.decisions), (2, 0))

    def test_what_is_wrong_is_said(self):
        with self.assertRaisesRegex(redman.StateError, "unproven=least"):
            redman.evaluate("zero", "hand_over_safe_finger", episodes=2, options=NOWHERE, shield={"unproven": "error"})
        e = redman.evaluate("zero", "hand_over_safe_finger", episodes=2, options=NOWHERE, shield=True)
        self.assertGreater(e.violating_steps, 0)
        self.assertEqual(e.decisions, e.interventions)
        for shield, policy, words in ((None, "trained", "shield_policy: .* there is none"), (3, None, "shield: it must be True, or a dict"),
                                      ({"blok": 3}, None, "block")):
            with self.assertRaisesRegex(redman.Error, words):
                redman.evaluate("zero", TASK, episodes=1, shield=shield, shield_policy=policy)


class Environments(unittest.TestCase):
    """redman.gym; the adapters over it have a test each beside their own."""

    def test_every_step_goes_through_it(self):
        for center in (None, "initial"):
            with gym.Env(TASK, seed=1, action_repeat="task", center=center, shield=True) as env:
                env.action_space.seed(1)
                began = env.reset()[1]
                self.assertEqual((began["applied"].any(), began["intervened"], began["shield"]), (False, False, ""))
                kinds = set()
                for _ in range(120):
                    action = env.action_space.sample()
                    *_, terminated, truncated, info = env.step(action)
                    self.assertEqual(shaped(info), shaped(began))
                    self.assertIs(type(info["intervened"]), bool)
                    self.assertEqual(info["intervened"], info["shield"] != "own")
                    self.assertEqual(same(info["applied"], action), not info["intervened"])
                    ran = info["applied"] + (0 if center is None else env.worlds.center)
                    np.testing.assert_allclose(ran, env.pool.action[0], atol=1e-6)
                    self.assertEqual(info["cost"], 0)
                    kinds.add(info["shield"])
                    if terminated or truncated:
                        env.reset()
                self.assertLessEqual({"own", "changed"}, kinds)
                self.assertEqual(env.shield.stats.decisions, 120)  # one for each step of four control steps
                self.assertEqual(env.pool.stats.violations, 0)

    def test_without_one_infos_are_as_ever(self):
        with gym.Env("bandit") as env:
            self.assertIsNone(env.shield)
            self.assertEqual(list(env.reset()[1]), ["cost", "costs", "success", "status", "episode_status"])

    def test_vectors_are_loops_over_single_worlds(self):
        said = {"options": HELD, "shield": {"noise": 0}}  # noise of a shield has a stream for each of its worlds
        for mode in ("NextStep", "SameStep", "Disabled"):
            with gym.VectorEnv(TASK, 3, autoreset_mode=mode, **said) as envs:
                envs.action_space.seed(2)
                ones = [gym.Env(TASK, **said) for _ in range(3)]
                envs.reset(seed=5)
                for i, one in enumerate(ones):
                    one.reset(seed=5 + i)
                ended, refused = np.zeros(3, bool), 0
                for _ in range(45):
                    actions = envs.action_space.sample()
                    obs, *_, info = envs.step(actions)
                    self.assertEqual((info["shield"].dtype, info["intervened"].dtype, info["applied"].dtype),
                                     (object, bool, object if gym._OLD else np.float32))
                    for i, one in enumerate(ones):
                        if mode == "NextStep" and ended[i]:
                            told, ended[i] = one.reset()[1], False
                        else:
                            *_, terminated, truncated, told = one.step(actions[i])
                            ended[i] = terminated or truncated
                            refused += told["intervened"]
                        final = mode == "SameStep" and ended[i]
                        if final:
                            if not gym._OLD:
                                self.assertTrue(same(info["final_info"]["applied"][i], told["applied"]))
                                self.assertEqual(info["final_info"]["shield"][i], told["shield"])
                            else:
                                self.assertTrue(same(info["final_info"][i]["applied"], told["applied"]))
                            told = one.reset()[1]
                        self.assertTrue(same(info["applied"][i], told["applied"]))
                        self.assertEqual((info["intervened"][i], info["shield"][i]), (told["intervened"], told["shield"]))
                        self.assertTrue(info["_shield"][i] and info["_applied"][i] and info["_intervened"][i])
                    if mode == "Disabled" and ended.any():
                        began = envs.reset(options={"reset_mask": ended})[1]
                        self.assertTrue(same(began["_shield"], ended))
                        self.assertEqual(began["shield"].tolist(), ["" if end else None for end in ended])
                        for i in np.flatnonzero(ended):
                            ones[i].reset()
                self.assertGreater(refused, 0)
                self.assertEqual(envs.pool.stats.violations, 0)
                for one in ones:
                    one.close()

    def test_a_bad_action_ends_the_episode_there_too(self):
        with gym.VectorEnv(TASK, 2, options=HELD, shield=True, autoreset_mode="NextStep") as envs:
            envs.reset(seed=1)
            actions = np.zeros((2, 40), np.float32)
            actions[1, 0] = np.nan
            *_, truncated, info = envs.step(actions)
            self.assertEqual((truncated.tolist(), info["status"].tolist(), info["shield"].tolist()),
                             ([False, True], [0, 4], ["own", "own"]))
            self.assertEqual(envs.shield.stats.decisions, 1)

    def test_options_and_a_policy(self):
        said = {"budgets": {"cost": 5}, "seed": 3, "threads": 1, "unproven": "least"}
        with gym.Env(TASK, action_repeat="task", shield=said, shield_policy="trained") as env:
            self.assertEqual((env.shield.budgets[0], env.shield.options["unproven"], len(env.shield.backups)), (5, "least", 3))
        with self.assertRaisesRegex(redman.ArgumentError, "policy: it holds an action for 4 steps"):
            gym.Env(TASK, shield=True, shield_policy="trained")
        with self.assertRaisesRegex(redman.ArgumentError, "shield_policy: .* there is none"):
            gym.Env(TASK, shield_policy="trained")

    def test_pickle_and_deepcopy_go_on_alike(self):
        for make in (lambda: gym.Env(TASK, options=HELD, shield=True),
                     lambda: gym.VectorEnv(TASK, 3, options=HELD, shield=True, autoreset_mode="SameStep")):
            env = make()
            env.reset(seed=4)
            env.action_space.seed(1)
            actions = [env.action_space.sample() for _ in range(14 if env.pool.num_envs > 1 else 5)]
            env.step(actions[0])
            others = [pickle.loads(pickle.dumps(env)), copy.deepcopy(env)]
            expected = [env.step(action) for action in actions]
            for other in others:
                self.assertTrue(same([other.step(action) for action in actions], expected))

    def test_what_is_closed_says_so(self):
        env = gym.Env(TASK, options=HELD, shield=True)
        env.reset(seed=1)
        env.close()
        self.assertIsNone(env.shield)
        with self.assertRaisesRegex(redman.StateError, "closed"):
            env.step(np.zeros(40, np.float32))


if __name__ == "__main__":
    unittest.main()
