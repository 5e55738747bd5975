"""10: the shield: each decision is tried in a copy of the world before it runs, so that no step costs anything.

    python3 10_shield.py [steps]

The bundled policy throws the object from hand to hand. Noise on its actions makes it break the window of the first finger;
under the shield it does not. The manual's page on safety says when this is a proof and when it is an estimate.
"""
import sys

import numpy as np

import redman

steps, task = int(sys.argv[1]) if len(sys.argv) > 1 else 80, "hand_over_safe_joint"
policy = redman.Policy.trained(task)
hold = policy.info.action_repeat                    # control steps that a decision lasts


def play(shielded):
    """Sum of costs and of rewards over some decisions, and how many the shield changed."""
    pool = redman.Pool(task, num_envs=4, seed=2, action_repeat=hold)    # one step of this pool is one decision
    pool.reset()
    shield = redman.Shield(pool, policy) if shielded else None          # the policy is also the first backup
    actor, noise, sums, changed = policy.actor(pool), np.random.default_rng(0), np.zeros(2), 0
    for _ in range(steps // hold):
        action = np.clip(actor() + noise.normal(0, 0.5, pool.action.shape), -1, 1)
        if shield:
            action = shield.act(action)
            changed += int(shield.intervened.sum())
        pool.step(action)
        sums += pool.cost[:, 0].sum(), pool.reward.sum()
    if shield:
        print(f"world 0: {shield.row(0)}")
    return sums, changed


(bare, ret), _ = play(False)
print(f"without: {bare:.0f} steps that cost, sum of rewards {ret:.1f}")
(safe, ret), changed = play(True)
print(f"shield:  {safe:.0f} steps that cost, sum of rewards {ret:.1f}; {changed} decisions of {4 * (steps // hold)} were changed")
