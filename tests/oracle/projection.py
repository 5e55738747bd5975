#!/usr/bin/env python3
"""The projection's loss of CUP and its gradient by complex steps (numpy, double), as a C++ table.

    python3 tests/oracle/projection.py > tests/support/oracle_projection.hpp

Network, batch and policies come from the integer formulas that losses.py and tests/algos/test_oracle.cpp have. The
derivative of an analytic function f is Im f(x + ih) / h, which for h = 1e-30 has no error but rounding's; so nothing here
knows a derivative."""
import numpy as np

OBS, HIDDEN, ACT, ROWS = 5, 7, 3, 24
WEIGHTS = (0.6, 0.25)


def wave(i, k):
    return float((i * (2 * k + 3) * 37 + k * 101 + i * i * 11) % 129 - 64) / 64


def block(n, k, scale=1.0):
    return np.array([scale * wave(i, k) for i in range(n)])


SIZES = [ACT, HIDDEN * OBS, HIDDEN, ACT * HIDDEN, ACT]  # log_std, W1, b1, W2, b2
theta = np.concatenate([block(n, k, s) for n, k, s in zip(SIZES, range(5), [0.5, 0.5, 0.25, 0.5, 0.25])])
obs = block(ROWS * OBS, 5).reshape(ROWS, OBS)
action = block(ROWS * ACT, 6).reshape(ROWS, ACT)
costs = np.stack([block(ROWS, 8), block(ROWS, 9)], 1)


def net(t):
    log_std, w1, b1, w2, b2 = np.split(t, np.cumsum(SIZES)[:-1])
    h = np.tanh(obs @ w1.reshape(HIDDEN, OBS).T + b1)
    return h @ w2.reshape(ACT, HIDDEN).T + b2, log_std


def log_prob(mean, log_std):
    z = (action - mean) / np.exp(log_std)
    return (-0.5 * z * z - log_std - 0.5 * np.log(2 * np.pi)).sum(-1)


def kl(m0, l0, m1, l1):
    return (l1 - l0 + (np.exp(2 * l0) + (m0 - m1) ** 2) / (2 * np.exp(2 * l1)) - 0.5).sum(-1)


mean, log_std = net(theta)
old_mean = mean + 0.125 * block(ROWS * ACT, 10).reshape(ROWS, ACT)
old_log_prob = log_prob(old_mean, log_std + [0.0625, -0.03125, 0.015625]) + 0.25 * block(ROWS, 11)
half_mean = mean + 0.25 * block(ROWS * ACT, 13).reshape(ROWS, ACT)
half_log_std = log_std + [-0.125, 0.0625, 0.03125]


def loss(t):
    m, l = net(t)
    rho = np.exp(log_prob(m, l) - old_log_prob)
    return (kl(half_mean, half_log_std, m, l) + rho * (costs @ WEIGHTS)).mean()


gradient = [loss(theta + 1e-30j * (np.arange(theta.size) == j)).imag / 1e-30 for j in range(theta.size)]
values = [loss(theta)] + gradient
print("// Loss and gradient by complex steps in double: written by tests/oracle/projection.py.")
print("#pragma once\nnamespace rdm::test::oracle {\n// clang-format off")
print("inline constexpr double kProjection[] = {")
for i in range(0, len(values), 5):
    print("    " + ", ".join("%.12g" % v for v in values[i:i + 5]) + ",")
print("};\n// clang-format on\n}  // namespace rdm::test::oracle")
