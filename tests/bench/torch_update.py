#!/usr/bin/env python3
"""The work of `redman bench update --algo ppo_lag` in torch, for examples/results/speed.md.

    OMP_NUM_THREADS=1 python3 tests/bench/torch_update.py [--hidden 64,64] [--samples 8192] [--minibatch 1024]

Actor, reward critic and cost critic with tanh layers, a clipped surrogate, Adam and clipped gradients, five passes
over the samples. Prints samples times passes per second, the median of some updates. Needs torch (Debian:
python3-torch with libopenblas0-pthread; the reference BLAS is 30 times slower).
"""
import statistics
import time

import torch
from torch import nn

from torch_parts import PASSES, network, read_flags


def main():
    flags, hidden = read_flags(__doc__)
    rows = flags.samples

    actor = network(flags.obs, hidden, flags.act)
    log_std = nn.Parameter(torch.full((flags.act,), -0.5))
    critics = [network(flags.obs, hidden, 1) for _ in range(2)]
    groups = [[*actor.parameters(), log_std], *([*critic.parameters()] for critic in critics)]
    optimisers = [torch.optim.Adam(group, 3e-4) for group in groups]

    obs, action = torch.randn(rows, flags.obs), torch.randn(rows, flags.act)
    advantage, targets = torch.randn(rows), [torch.randn(rows) for _ in critics]

    def log_probability(o, a):
        return torch.distributions.Normal(actor(o), log_std.exp()).log_prob(a).sum(-1)

    with torch.no_grad():
        before = log_probability(obs, action)

    def update():
        for _ in range(PASSES):
            order = torch.randperm(rows)
            for first in range(0, rows, flags.minibatch):
                i = order[first:first + flags.minibatch]
                o = obs[i]
                ratio = (log_probability(o, action[i]) - before[i]).exp()
                gain = torch.min(ratio * advantage[i], ratio.clamp(0.8, 1.2) * advantage[i])
                losses = [-gain.mean()]
                losses += [((critic(o).squeeze(-1) - target[i]) ** 2).mean() for critic, target in zip(critics, targets)]
                for loss, optimiser, group in zip(losses, optimisers, groups):
                    optimiser.zero_grad(set_to_none=True)
                    loss.backward()
                    nn.utils.clip_grad_norm_(group, 1.0)
                    optimiser.step()

    update()
    rates = []
    for _ in range(flags.updates):
        start = time.perf_counter()
        update()
        rates.append(rows * PASSES / (time.perf_counter() - start))
    print(f"torch {torch.__version__}, hidden {flags.hidden}: {statistics.median(rates):.0f} samples/s")


main()
