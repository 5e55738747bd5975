"""What the yardsticks in torch (torch_update.py, torch_gru.py) have in common: flags, networks, passes."""
import argparse

import torch
from torch import nn

PASSES = 5


def network(inputs, hidden, outputs):
    """Linear layers with tanh between them."""
    layers = []
    for width in hidden:
        layers += [nn.Linear(inputs, width), nn.Tanh()]
        inputs = width
    return nn.Sequential(*layers, nn.Linear(inputs, outputs))


def read_flags(doc, **more):
    """The flags of a yardstick, more: whole numbers that it alone has, by their defaults; and the widths of its layers."""
    parser = argparse.ArgumentParser(description=doc.splitlines()[0])
    parser.add_argument("--hidden", default="64,64")
    for name, default in {"obs": 398, "act": 40, "samples": 8192, "minibatch": 1024, "threads": 1, "updates": 5, **more}.items():
        parser.add_argument("--" + name, type=int, default=default)
    flags = parser.parse_args()
    torch.set_num_threads(flags.threads)
    torch.manual_seed(0)
    return flags, [int(width) for width in flags.hidden.split(",")]
