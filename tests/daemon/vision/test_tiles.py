"""Windows over a page: every pixel is answered for once, by a window that sees beyond it."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from daemon.vision.tiles import spans, tiles

SIZE, MARGIN = 221, 16


@given(st.integers(1, 3000))
def test_cores_cover_a_side_exactly_once(length: int) -> None:
    found = spans(length, SIZE, MARGIN)
    assert [a for _, a, _ in found] == [0, *(b for _, _, b in found[:-1])]
    assert found[-1][2] == length


@given(st.integers(SIZE + 1, 3000))
def test_a_window_sees_the_margin_around_its_core(length: int) -> None:
    for first, a, b in spans(length, SIZE, MARGIN):
        assert first <= a - MARGIN
        assert b + MARGIN <= first + SIZE


@given(st.integers(1, SIZE))
def test_a_side_that_fits_is_one_window_in_the_middle(length: int) -> None:
    ((first, a, b),) = spans(length, SIZE, MARGIN)
    assert (a, b) == (0, length)
    assert abs((first + SIZE) - length + first) <= 1


def test_a_page_is_covered_once() -> None:
    count = np.zeros((400, 700), int)
    for tile in tiles(700, 400, size_px=SIZE, margin_px=MARGIN):
        count[tile.core_top : tile.core_bottom, tile.core_left : tile.core_right] += 1
    assert (count == 1).all()
