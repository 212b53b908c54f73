"""XENT and MWX against a hand-computed page of 3 x 3 pixels."""

import math
from collections.abc import Callable
from typing import TypeAlias

import pytest
import torch

from training.loss import mwx, omega, plain, xent

pytestmark = pytest.mark.training

Loss: TypeAlias = Callable[[torch.Tensor, torch.Tensor, torch.Tensor], torch.Tensor]
WEIGHTS = torch.tensor([1.0, 4.0, 16.0, 0.0])
LABEL = torch.tensor([[[0, 0, 1], [0, 1, 2], [0, 0, 1]]])


def logits_saying(said: list[list[int]]) -> "torch.Tensor":
    """log 8 for the class that is said, 0 for the others: p = 0.8 for it, 0.1 for each other."""
    out = torch.zeros(1, 3, 3, 3)
    for y, row in enumerate(said):
        for x, c in enumerate(row):
            out[0, c, y, x] = math.log(8.0)
    return out


SURE, UNSURE = -math.log(0.8), -math.log(0.1)


def test_xent_of_a_right_answer_is_the_mean_surprise() -> None:
    assert xent(logits_saying(LABEL[0].tolist()), LABEL, WEIGHTS).item() == pytest.approx(SURE)


def test_xent_weighs_by_the_true_label_alone() -> None:
    said = [[2, 0, 1], [0, 1, 2], [0, 0, 1]]  # a corner painted on background
    every = 5 * 1 + 3 * 4 + 16
    assert xent(logits_saying(said), LABEL, WEIGHTS).item() == pytest.approx((1 * UNSURE + (every - 1) * SURE) / every)


def test_mwx_weighs_a_falsely_painted_corner_like_a_corner() -> None:
    said = [[2, 0, 1], [0, 1, 2], [0, 0, 1]]
    every = 4 * 1 + 3 * 4 + 16 + 16
    expected = (16 * UNSURE + (every - 16) * SURE) / every
    assert mwx(logits_saying(said), LABEL, WEIGHTS).item() == pytest.approx(expected)
    assert mwx(logits_saying(said), LABEL, WEIGHTS) > xent(logits_saying(said), LABEL, WEIGHTS)


def test_mwx_weighs_a_missed_corner_like_a_corner() -> None:
    said = [[0, 0, 1], [0, 1, 0], [0, 0, 1]]
    every = 5 * 1 + 3 * 4 + 16
    assert mwx(logits_saying(said), LABEL, WEIGHTS).item() == pytest.approx((16 * UNSURE + (every - 16) * SURE) / every)


@pytest.mark.parametrize("loss", [xent, mwx, plain])
def test_what_is_unsure_teaches_nothing(loss: Loss) -> None:
    unsure = LABEL.clone()
    unsure[0, 0, 0] = 3
    right, wrong = logits_saying(LABEL[0].tolist()), logits_saying([[2, 0, 1], [0, 1, 2], [0, 0, 1]])
    assert loss(right, unsure, WEIGHTS).item() == pytest.approx(loss(wrong, unsure, WEIGHTS).item())
    wrong.requires_grad_()
    loss(wrong, unsure, WEIGHTS).backward()
    assert wrong.grad is not None
    assert not wrong.grad[0, :, 0, 0].any()


def test_omega_with_exponent_one_is_inverse_frequency() -> None:
    weights = omega(1.0, (0.9, 0.09, 0.01))
    assert torch.allclose(weights, torch.tensor([1.0, 10.0, 90.0, 0.0]))
