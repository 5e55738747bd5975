#!/usr/bin/env python3
"""Gradients of every policy loss by an independent autograd framework (torch, double precision), as a C++ table.

    python3 tests/oracle/losses.py > tests/support/oracle_losses.hpp

The network, the batch and the behaviour policy come from plain integer formulas that tests/test_oracle.cpp
repeats, so that only the losses, the gradients and one Fisher-vector product need to be stored."""
import math
import torch

torch.set_default_dtype(torch.float64)
OBS, HIDDEN, ACT, ROWS = 5, 7, 3, 24
CLIP, KAPPA, KAPPA2, TEMPERATURE, ETA, NU = 0.2, 3.0, 0.5, 1.5, 0.02, 0.3


def wave(i, k):
    """In [-1, 1], exact in single precision: multiples of 1/64."""
    return float((i * (2 * k + 3) * 37 + k * 101 + i * i * 11) % 129 - 64) / 64


def block(n, k, scale=1.0):
    return torch.tensor([scale * wave(i, k) for i in range(n)])


sizes = [ACT, HIDDEN * OBS, HIDDEN, ACT * HIDDEN, ACT]  # log_std, W1, b1, W2, b2
theta = torch.cat([block(n, k, s) for n, k, s in zip(sizes, range(5), [0.5, 0.5, 0.25, 0.5, 0.25])])
theta.requires_grad_(True)
obs = block(ROWS * OBS, 5).reshape(ROWS, OBS)
action = block(ROWS * ACT, 6).reshape(ROWS, ACT)
reward, cost, cost2 = block(ROWS, 7), block(ROWS, 8), block(ROWS, 9)
old_log_std = theta.detach()[:ACT] + torch.tensor([0.0625, -0.03125, 0.015625])


def net(t):
    p = torch.split(t, sizes)
    h = torch.tanh(obs @ p[1].reshape(HIDDEN, OBS).T + p[2])
    return h @ p[3].reshape(ACT, HIDDEN).T + p[4], p[0]


def log_prob(mean, log_std):
    z = (action - mean) / log_std.exp()
    return (-0.5 * z * z - log_std - 0.5 * math.log(2 * math.pi)).sum(-1)


def kl(m0, l0, m1, l1):
    return (l1 - l0 + ((2 * l0).exp() + (m0 - m1) ** 2) / (2 * (2 * l1).exp()) - 0.5).sum(-1)


with torch.no_grad():
    old_mean = net(theta)[0] + 0.125 * block(ROWS * ACT, 10).reshape(ROWS, ACT)
    old_log_prob = log_prob(old_mean, old_log_std) + 0.25 * block(ROWS, 11)


def losses(t):
    mean, log_std = net(t)
    rho = (log_prob(mean, log_std) - old_log_prob).exp()
    cut = rho.clamp(1 - CLIP, 1 + CLIP)
    combined = (reward - NU * cost) / (1 + NU)
    clip = lambda a: -torch.min(rho * a, cut * a).mean()
    penalty = lambda c: torch.max(rho * c, cut * c).mean()
    new_old = kl(mean, log_std, old_mean, old_log_std)
    focops = ((new_old - rho * (reward - NU * cost) / TEMPERATURE) * (new_old.detach() <= ETA)).mean()
    return {
        "kPpo": clip(reward),
        "kPpoLag": clip(combined),
        "kSplit": clip(reward / (1 + NU)) + (rho * NU * cost / (1 + NU)).mean(),
        "kTrust": -(rho * reward).mean(),
        "kCost": (rho * cost).mean(),
        "kP3o": clip(reward) + KAPPA * penalty(cost) + KAPPA2 * penalty(cost2),
        "kFocops": focops,
    }


def table(name, values):
    print(f"inline constexpr double {name}[] = {{")
    for i in range(0, len(values), 5):
        print("    " + ", ".join(f"{float(v):.12g}" for v in values[i:i + 5]) + ",")
    print("};")


print("// Losses and gradients by torch %s in double: written by tests/oracle/losses.py." % torch.__version__)
print("#pragma once\nnamespace rdm::test::oracle {\n// clang-format off")
for name, loss in losses(theta).items():
    (g,) = torch.autograd.grad(loss, theta, retain_graph=True)
    table(name, [loss.item()] + g.tolist())

# The Hessian of the mean KL(old || new) at new = old, times a vector, by double differentiation.
v = block(theta.numel(), 12)
mean0, log_std0 = (x.detach() for x in net(theta))
mean, log_std = net(theta)
(g,) = torch.autograd.grad(kl(mean0, log_std0, mean, log_std).mean(), theta, create_graph=True)
(hv,) = torch.autograd.grad((g * v).sum(), theta)
table("kFisher", hv.tolist())
print("// clang-format on\n}  // namespace rdm::test::oracle")
