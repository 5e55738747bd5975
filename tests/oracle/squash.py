#!/usr/bin/env python3
"""Log probabilities of squashed normals and their slopes by torch's own distributions (double), as a C++ table.

    python3 tests/oracle/squash.py > tests/support/oracle_squash.hpp

A row: mean, logarithm of the deviation, noise z; then log p(tanh(u)) of u = mean + std z, and its derivatives along the
mean and the logarithm while z stays."""
import torch
from torch.distributions import Normal, TransformedDistribution
from torch.distributions.transforms import TanhTransform

torch.set_default_dtype(torch.float64)
print("// Squashed normals by torch: written by tests/oracle/squash.py.")
print("#pragma once\nnamespace rdm::test::oracle {\n// clang-format off")
print("// mean, log std, z, log p, d log p / d mean, d log p / d log std")
print("inline constexpr double kSquash[][6] = {")
for mean in (-6.0, -1.25, 0.0, 0.5, 3.0):
    for log_std in (-3.0, -0.5, 0.75):
        for z in (-2.0, 0.25, 1.5):
            m = torch.tensor(mean, requires_grad=True)
            l = torch.tensor(log_std, requires_grad=True)
            u = m + l.exp() * z
            # The cache gives the transform its u back: no atanh of a number that is 1 to the last digit.
            transform = TanhTransform(cache_size=1)
            p = TransformedDistribution(Normal(m, l.exp()), [transform]).log_prob(transform(u))
            slopes = torch.autograd.grad(p, (m, l))
            print("    {" + ", ".join(f"{float(x):.12g}" for x in (mean, log_std, z, p, *slopes)) + "},")
print("};\n// clang-format on\n}  // namespace rdm::test::oracle")
