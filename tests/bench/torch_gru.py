#!/usr/bin/env python3
"""The work of an update of `redman train --algo ppo --set memory=gru:64` in torch, for the manual's page on memory.

    OMP_NUM_THREADS=1 python3 tests/bench/torch_gru.py [--hidden 64,64] [--units 64] [--samples 8192] [--minibatch 1024]

An actor with tanh layers, torch.nn.GRU over chunks of --chunk steps and a linear layer, a critic with tanh layers, a clipped
surrogate, Adam and clipped gradients, five passes. Prints samples times passes per second, the median of some updates.
"""
import statistics
import time

import torch
from torch import nn

from torch_parts import PASSES, network, read_flags


def main():
    flags, hidden = read_flags(__doc__, units=64, chunk=16)
    trunk = nn.Sequential(*network(flags.obs, hidden, 1)[:-1])
    gru, head, critic = nn.GRU(hidden[-1], flags.units), nn.Linear(flags.units, flags.act), network(flags.obs, hidden, 1)
    log_std = nn.Parameter(torch.zeros(flags.act))
    actor = [*trunk.parameters(), *gru.parameters(), *head.parameters(), log_std]
    steps = [torch.optim.Adam(actor, 3e-4), torch.optim.Adam(critic.parameters(), 3e-4)]
    chunks = flags.samples // flags.chunk
    shape = (flags.chunk, chunks)
    obs, action = torch.randn(*shape, flags.obs), torch.randn(*shape, flags.act)
    old, gain, target = torch.randn(shape), torch.randn(shape), torch.randn(shape)
    state = torch.randn(1, chunks, flags.units)
    rates = []
    for _ in range(flags.updates):
        begin = time.perf_counter()
        for _ in range(PASSES):
            order = torch.randperm(chunks)
            for first in range(0, chunks, flags.minibatch // flags.chunk):
                rows = order[first:first + flags.minibatch // flags.chunk]
                x = obs[:, rows]
                out, _ = gru(trunk(x), state[:, rows])
                log_prob = torch.distributions.Normal(head(out), log_std.exp()).log_prob(action[:, rows]).sum(-1)
                ratio = (log_prob - old[:, rows]).clamp(max=20).exp()
                a = gain[:, rows]
                loss = -torch.min(ratio * a, ratio.clamp(0.8, 1.2) * a).mean()
                loss = loss + (critic(x).squeeze(-1) - target[:, rows]).square().mean()
                for optimiser in steps:
                    optimiser.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(actor, 1)
                nn.utils.clip_grad_norm_(critic.parameters(), 1)
                for optimiser in steps:
                    optimiser.step()
        rates.append(PASSES * flags.samples / (time.perf_counter() - begin))
    print(f"{statistics.median(rates):.0f} samples/s")


if __name__ == "__main__":
    main()
