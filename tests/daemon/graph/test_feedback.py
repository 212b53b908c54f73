"""The threshold of a pair falls where ink is missing and rises where there is too much."""

from __future__ import annotations

import numpy as np

from daemon.graph.feedback import Adaptation, blobs, rendering, select

VERTICES = np.array([[10, 10], [50, 10], [10, 30], [50, 30]], float)
PAIRS = np.array([[0, 1], [2, 3]])
INK = rendering(VERTICES, PAIRS[:1], (40, 60), width_px=2)


def chosen(eta: list[float], *, rounds: int) -> list[bool]:
    adaptation = Adaptation(rounds=rounds)
    return [bool(c) for c in select(VERTICES, PAIRS, np.array(eta), INK, adaptation, width_px=2.0)]


def test_without_feedback_the_threshold_decides() -> None:
    assert chosen([0.36, 0.34], rounds=0) == [True, False]


def test_a_pair_on_absent_ink_is_let_in() -> None:
    assert chosen([0.3, 0.0], rounds=0) == [False, False]
    assert chosen([0.3, 0.0], rounds=10) == [True, False]


def test_a_pair_is_let_in_only_when_enough_rounds_lower_its_threshold() -> None:
    # 0.35 x 0.95^3 = 0.3001, 0.35 x 0.95^4 = 0.285
    assert chosen([0.3, 0.0], rounds=3) == [False, False]
    assert chosen([0.3, 0.0], rounds=4) == [True, False]


def test_a_superfluous_pair_is_taken_back() -> None:
    assert chosen([1.0, 0.4], rounds=0) == [True, True]
    assert chosen([1.0, 0.4], rounds=10) == [True, False]


def test_blobs_come_as_boxes_with_a_margin_largest_first() -> None:
    difference = np.zeros((40, 60), bool)
    difference[5:7, 5:7] = difference[20:24, 30:40] = True
    difference[35, 50] = True
    assert blobs(difference).tolist() == [[27, 17, 42, 26], [2, 2, 9, 9]]
