#!/usr/bin/env python3
"""The work of bench_points in torch: a PointNet with layers 64 and 128 over rows of 512 and 2,048 points, and
the update of an agent that sees by it.

    OMP_NUM_THREADS=1 python3 tests/bench/torch_points.py [--rows 64] [--threads 1]

Prints milliseconds of a row, forward alone and forward with backward, and samples times passes per second of the
update, the best of some. Needs torch (Debian: python3-torch with libopenblas0-pthread; the reference BLAS is 30 times
slower).
"""
import argparse
import time

import torch
from torch import nn


def best(work, times=7):
    least = 1e9
    for _ in range(times):
        begin = time.process_time()
        work()
        least = min(least, time.process_time() - begin)
    return least


def network(inputs, outputs):
    return nn.Sequential(nn.Linear(inputs, 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, outputs))


def update(points, first, last, obs=381, act=40, samples=1024, minibatches=4):
    """One pass of an actor with eyes and two critics: a clipped surrogate, Adam behind a bound on each gradient."""
    trunk, critics, log_std = network(obs + 128, act), [network(obs, 1) for _ in range(2)], torch.zeros(act)
    log_std.requires_grad_(True)
    parts = [[log_std, *first.parameters(), *last.parameters(), *trunk.parameters()],
             *(list(critic.parameters()) for critic in critics)]
    adams = [torch.optim.Adam(part, 3e-4) for part in parts]
    rows, clouds = torch.randn(samples, obs), torch.randn(samples, points, 3)
    action, old, gain, target = (torch.randn(samples, act), torch.full((samples,), -57.0), torch.randn(samples),
                                 torch.randn(samples))

    def work():
        for some in torch.randperm(samples).chunk(minibatches):
            seen = torch.relu(last(torch.relu(first(clouds[some]))).max(1).values)
            mean = trunk(torch.cat([rows[some], seen], 1))
            log_prob = torch.distributions.Normal(mean, log_std.exp()).log_prob(action[some]).sum(1)
            ratio = (log_prob - old[some]).clamp(max=20).exp()
            clipped = ratio.clamp(0.8, 1.2) * gain[some]
            losses = [-torch.min(ratio * gain[some], clipped).mean()]
            losses += [((critic(rows[some]).squeeze(1) - target[some]) ** 2).mean() for critic in critics]
            for loss, adam, part in zip(losses, adams, parts):
                adam.zero_grad()
                loss.backward()
                nn.utils.clip_grad_norm_(part, 1)
                adam.step()

    print(f"torch {points:5d} points  update {samples / best(work, 3):.0f} samples times passes/s")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, default=64)
    parser.add_argument("--threads", type=int, default=1)
    flags = parser.parse_args()
    torch.set_num_threads(flags.threads)
    torch.manual_seed(0)
    first, last = nn.Linear(3, 64), nn.Linear(64, 128)
    for points in (512, 2048):
        cloud = torch.randn(flags.rows, points, 3)
        slope = torch.randn(flags.rows, 128)

        def features():
            return torch.relu(last(torch.relu(first(cloud))).max(1).values)

        def forward():
            with torch.no_grad():
                features()

        def learn():
            (features() * slope).sum().backward()

        update(points, first, last)
        ahead, both = best(forward), best(learn)
        print(f"torch {points:5d} points  forward {1e3 * ahead / flags.rows:.4f} ms a row  "
              f"with backward {1e3 * both / flags.rows:.4f} ms")


main()
