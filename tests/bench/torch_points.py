#!/usr/bin/env python3
"""The work of bench_points in torch: a PointNet with layers 64 and 128 over rows of 512 and 2,048 points.

    OMP_NUM_THREADS=1 python3 tests/bench/torch_points.py [--rows 64] [--threads 1]

Prints milliseconds of a row, forward alone and forward with backward, the best of some. Needs torch (Debian:
python3-torch with libopenblas0-pthread; the reference BLAS is 30 times slower).
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

        ahead, both = best(forward), best(learn)
        print(f"torch {points:5d} points  forward {1e3 * ahead / flags.rows:.4f} ms a row  "
              f"with backward {1e3 * both / flags.rows:.4f} ms")


main()
