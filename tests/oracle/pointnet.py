#!/usr/bin/env python3
"""Features of a PointNet and their gradient by an independent autograd framework (torch, double precision), as a C++
table.

    python3 tests/oracle/pointnet.py > tests/support/oracle_pointnet.hpp

Weights, points and classes come from plain integer formulas that tests/nn/test_pointnet.cpp repeats."""
import torch

torch.set_default_dtype(torch.float64)
ROWS, POINTS, CLASSES, WIDTHS = 4, 11, 2, (6, 7, 5)
RANGE = 0.25


def wave(i, k):
    """In [-1, 1], exact in single precision: multiples of 1/64."""
    return float((i * (2 * k + 3) * 37 + k * 101 + i * i * 11) % 129 - 64) / 64


def millimetres(i):
    return (i * 7919 + i * i * 13) % 601 - 300


def main():
    inputs = 3 + CLASSES
    sizes = []
    for before, width in zip((inputs,) + WIDTHS, WIDTHS):
        sizes += [width * before, width]
    params = torch.cat([torch.tensor([wave(i, k) for i in range(n)]) for k, n in enumerate(sizes)])
    points = torch.tensor([0.001 / RANGE * millimetres(i) for i in range(ROWS * POINTS * 3)]).reshape(ROWS, POINTS, 3)
    kinds = torch.tensor([(i * 5 + i // 3) % CLASSES for i in range(ROWS * POINTS)]).reshape(ROWS, POINTS)
    seen = torch.cat([points, torch.nn.functional.one_hot(kinds, CLASSES).to(points.dtype)], 2)
    slope = torch.tensor([wave(i, 9) for i in range(ROWS * WIDTHS[-1])]).reshape(ROWS, WIDTHS[-1])
    print("// Made by tests/oracle/pointnet.py (torch %s); do not edit." % torch.__version__.split("a")[0])
    print("#pragma once\n")
    for name, act in (("Tanh", torch.tanh), ("Elu", torch.nn.functional.elu), ("Relu", torch.relu)):
        theta = params.clone().requires_grad_(True)
        parts = torch.split(theta, sizes)
        h = seen
        for l, width in enumerate(WIDTHS):
            h = h @ parts[2 * l].reshape(width, -1).T + parts[2 * l + 1]
            if l + 1 < len(WIDTHS):
                h = act(h)
        features = act(h.max(1).values)
        (features * slope).sum().backward()
        for what, values in (("Features", features.detach().flatten()), ("Gradient", theta.grad)):
            print("inline constexpr double kPoint%s%s[] = {" % (what, name))
            numbers = ["%.12g" % v for v in values.tolist()]
            for i in range(0, len(numbers), 6):
                print("    " + ", ".join(numbers[i:i + 6]) + ",")
            print("};")


main()
