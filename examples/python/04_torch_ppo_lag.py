"""04: PPO-Lagrangian in plain torch on the rows of a pool.

    python3 04_torch_ppo_lag.py [steps]             needs torch (pip install torch)

`torch.from_numpy(pool.obs)` is the library's memory itself: no row is copied on its way to the network.
"""
import sys

import numpy as np

try:
    import torch
    from torch import nn
except ModuleNotFoundError as missing:
    print(f"This example needs torch: pip install torch ({missing})")
    sys.exit(77)

import redman

steps, N, T = float(sys.argv[1]) if len(sys.argv) > 1 else 60_000, 16, 250
torch.manual_seed(0)
pool = redman.Pool("ball_run", num_envs=N, seed=0)
pool.reset()
limit, D, A = pool.costs["cost"].limit, pool.obs_dim, pool.action_dim
views = pool.obs, pool.final_obs, pool.action, pool.reward, pool.cost, pool.terminated, pool.truncated
obs, final, action, reward, cost, terminated, truncated = map(torch.from_numpy, views)
actor, critic = (nn.Sequential(nn.Linear(D, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, n)) for n in (A, 2))
log_std, multiplier, episodes = nn.Parameter(torch.full((A,), -0.7)), 1.0, []
adam = torch.optim.Adam([*actor.parameters(), *critic.parameters(), log_std], 1e-3)

for _ in range(max(1, round(steps / (N * T)))):
    rows = []
    for _ in range(T):
        with torch.no_grad():
            seen, normal = obs.clone(), torch.distributions.Normal(actor(obs), log_std.exp())
            drawn = normal.sample()
            action.copy_(drawn.clamp(-1, 1))        # writes pool.action
            pool.step()
            gained, ended = torch.stack([0.1 * reward, cost[:, 0]], 1), (terminated | truncated)[:, None]
            target = gained + 0.99 * critic(final) * ~terminated[:, None]   # a truncated episode has a value beyond its end
            rows.append((seen, drawn, normal.log_prob(drawn).sum(1), target - critic(seen), ~ended, critic(seen)))
        episodes += np.c_[pool.episode_return, pool.episode_cost[:, 0]][ended[:, 0].numpy()].tolist()
    seen, drawn, log_prob, advantage, goes_on, value = map(torch.stack, zip(*rows))
    for t in reversed(range(T - 1)):
        advantage[t] += 0.99 * 0.95 * goes_on[t] * advantage[t + 1]
    ret, spent = np.mean(episodes[-N:], axis=0)
    multiplier = max(0.0, multiplier + 0.2 * (spent - limit) / limit)
    of_reward, of_cost = (advantage - advantage.mean((0, 1))).unbind(-1)
    gain = (of_reward / of_reward.std() - multiplier * of_cost) / (1 + multiplier)
    flat = [x.flatten(0, 1) for x in (seen, drawn, log_prob, gain, advantage + value)]
    for _ in range(10):
        for part in torch.randperm(N * T).split(125):
            o, a, old, g, wanted = (x[part] for x in flat)
            ratio = (torch.distributions.Normal(actor(o), log_std.exp()).log_prob(a).sum(1) - old).exp()
            loss = -torch.min(ratio * g, ratio.clamp(0.8, 1.2) * g).mean() + (critic(o) - wanted).pow(2).mean()
            adam.zero_grad(), loss.backward(), adam.step()
print(f"learning: return {ret:.1f}, cost {spent:.1f} of {limit}, multiplier {multiplier:.2f}")
played = redman.evaluate(lambda o: actor(torch.from_numpy(o)).detach().numpy().clip(-1, 1), "ball_run", episodes=16)
print(f"without noise: return {played.return_mean:.1f}, cost {played.cost_mean[0]:.1f}")
