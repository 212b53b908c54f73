"""What the network is taught by: cross-entropy weighted by class frequency (XENT) or by max weights (MWX).

Raghav et al. 2020, Sec. 3.2. Labels are ordered background < lines < corners, so that a pixel falsely painted as a
corner weighs as much as a corner missed: w(x) = omega(max(label(x), predicted(x))). Eq. 1 lacks its minus sign; ours
has it. The paper does not state omega beyond "inversely proportional to class frequencies"; ours has an exponent
(1 = inverse).
"""

from __future__ import annotations

import torch
from torch import Tensor
from torch.nn import functional

from training.render import UNSURE

FREQUENCY = (0.9240, 0.0610, 0.0150)
"""Share of background, lines and corners of training canvases."""


def omega(exponent: float, frequency: tuple[float, ...] = FREQUENCY) -> Tensor:
    """Weight of each class, 1 for the background, and 0 for what is unsure: float32 (4,)."""
    share = torch.tensor(frequency)
    return torch.cat([(share[0] / share) ** exponent, torch.zeros(1)])


def xent(logits: Tensor, label: Tensor, weights: Tensor) -> Tensor:
    """Mean of w(x) * -log p_label(x), w(x) = omega(label(x)). logits (N, 3, H, W), label (N, H, W) int64 of 0..3."""
    return _weighted(logits, label, weights[label])


def mwx(logits: Tensor, label: Tensor, weights: Tensor) -> Tensor:
    """The same with w(x) = omega(max(label(x), predicted(x)))."""
    return _weighted(logits, label, weights[torch.maximum(label, logits.detach().argmax(dim=1))])


def plain(logits: Tensor, label: Tensor, weights: Tensor) -> Tensor:
    """Unweighted cross-entropy; takes the weights only to be called like the others."""
    return functional.cross_entropy(logits, label, ignore_index=UNSURE)


def _weighted(logits: Tensor, label: Tensor, weight: Tensor) -> Tensor:
    return (
        weight * functional.cross_entropy(logits, label, reduction="none", ignore_index=UNSURE)
    ).sum() / weight.sum()


LOSSES = {"xent": xent, "mwx": mwx, "plain": plain}
