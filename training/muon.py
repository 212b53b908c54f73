"""Muon: momentum whose update is made orthogonal before it is applied (Jordan et al. 2024), for convolution kernels.

PyTorch's own Muon takes matrices only; here a kernel counts as the matrix (first axis) x (all others). Everything that
is no kernel (scales, biases) is taken by AdamW inside the same optimiser.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import torch
from torch import Tensor

_COEFFICIENTS = (3.4445, -4.7750, 2.0315)
_ITERATIONS = 5


def orthogonal(matrix: Tensor) -> Tensor:
    """Nearly the closest semi-orthogonal matrix, by five Newton-Schulz steps."""
    a, b, c = _COEFFICIENTS
    wide = matrix.size(0) <= matrix.size(1)
    x = matrix if wide else matrix.T
    x = x / (x.norm() + 1e-7)
    for _ in range(_ITERATIONS):
        gram = x @ x.T
        x = a * x + (b * gram + c * gram @ gram) @ x
    return x if wide else x.T


class Muon(torch.optim.Optimizer):
    """lr: of the kernels, about 0.02; the others learn at lr * other_scale by AdamW."""

    def __init__(
        self,
        params: Iterable[Tensor],
        lr: float,
        *,
        momentum: float = 0.95,
        weight_decay: float = 0.0,
        other_scale: float = 0.2,
    ) -> None:
        super().__init__(params, {"lr": lr, "momentum": momentum, "weight_decay": weight_decay, "other": other_scale})

    @torch.no_grad()
    def step(self, closure: Any = None) -> None:  # type: ignore[override]
        for group in self.param_groups:
            for parameter in group["params"]:
                if parameter.grad is not None:
                    (self._kernel if parameter.ndim == 4 else self._other)(parameter, group)

    def _kernel(self, p: Tensor, group: dict[str, Any]) -> None:
        state = self.state[p]
        if not state:
            state["momentum"] = torch.zeros_like(p)
        average = state["momentum"].lerp_(p.grad, 1 - group["momentum"])
        update = orthogonal(p.grad.lerp(average, group["momentum"]).reshape(p.size(0), -1))
        rows, columns = update.shape
        p.mul_(1 - group["lr"] * group["weight_decay"])
        p.add_(update.view_as(p), alpha=-group["lr"] * max(1.0, rows / columns) ** 0.5)

    def _other(self, p: Tensor, group: dict[str, Any], betas: tuple[float, float] = (0.9, 0.99)) -> None:
        state = self.state[p]
        if not state:
            state |= {"steps": 0, "first": torch.zeros_like(p), "second": torch.zeros_like(p)}
        state["steps"] += 1
        state["first"].lerp_(p.grad, 1 - betas[0])
        state["second"].lerp_(p.grad.square(), 1 - betas[1])
        first, second = (state[k] / (1 - b ** state["steps"]) for k, b in zip(("first", "second"), betas, strict=True))
        p.add_(first / (second.sqrt() + 1e-8), alpha=-group["lr"] * group["other"])
