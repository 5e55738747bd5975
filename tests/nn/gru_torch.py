#!/usr/bin/env python3
"""Writes gru_torch.txt: what torch.nn.GRU makes of random numbers, and its gradients. Needs torch; no test runs this.

    python3 tests/nn/gru_torch.py > tests/nn/gru_torch.txt
"""
import torch

IN, UNITS, STEPS, ROWS = 3, 5, 6, 2


def main():
    torch.manual_seed(0)
    gru = torch.nn.GRU(IN, UNITS)
    x = torch.randn(STEPS, ROWS, IN, requires_grad=True)
    h0, dh = torch.randn(1, ROWS, UNITS) * 0.5, torch.randn(STEPS, ROWS, UNITS)
    h, _ = gru(x, h0)
    (h * dh).sum().backward()
    order = [gru.weight_ih_l0, gru.bias_ih_l0, gru.weight_hh_l0, gru.bias_hh_l0]
    print(f"# torch {torch.__version__}: in, units, steps, rows; parameters, x, h0, dh; h, gradients, dx")
    print(IN, UNITS, STEPS, ROWS)
    parts = [*order, x, h0, dh, h, *(p.grad for p in order), x.grad]
    for part in parts:
        print(*(f"{v:.9g}" for v in part.detach().flatten().tolist()))


if __name__ == "__main__":
    main()
