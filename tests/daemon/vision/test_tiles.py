"""Windows over a page: every inked pixel is answered for once, by a window that sees beyond it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from daemon.vision.tiles import spans, tiles

SIZE, MARGIN = 221, 16


@given(st.integers(0, 500), st.integers(1, 3000))
def test_cores_cover_a_side_exactly_once(begin: int, length: int) -> None:
    found = spans(begin, begin + length, size_px=SIZE, margin_px=MARGIN)
    assert [a for _, a, _ in found] == [begin, *(b for _, _, b in found[:-1])]
    assert found[-1][2] == begin + length


@given(st.integers(0, 500), st.integers(1, 3000))
def test_a_window_sees_the_margin_around_its_core(begin: int, length: int) -> None:
    for first, a, b in spans(begin, begin + length, size_px=SIZE, margin_px=MARGIN):
        assert first <= a - MARGIN
        assert b + MARGIN <= first + SIZE


@pytest.mark.parametrize(("width", "height"), [(SIZE, SIZE), (30, 20), (1, 221)])
def test_a_page_that_fits_is_one_window_in_the_middle(width: int, height: int) -> None:
    (tile,) = tiles(np.ones((height, width), bool), size_px=SIZE, margin_px=MARGIN)
    assert (tile.core_left, tile.core_top, tile.core_right, tile.core_bottom) == (0, 0, width, height)
    assert abs(2 * tile.left + SIZE - width) <= 1
    assert abs(2 * tile.top + SIZE - height) <= 1


@given(
    width=st.integers(1, 900), height=st.integers(1, 900),
    spots=st.lists(st.tuples(st.floats(0, 0.999), st.floats(0, 0.999)), max_size=8),
)  # fmt: skip
def test_ink_is_covered_once(width: int, height: int, spots: list[tuple[float, float]]) -> None:
    inked = np.zeros((height, width), bool)
    for x, y in ((int(x * width), int(y * height)) for x, y in spots):
        inked[y, x] = True
    count = np.zeros((height, width), int)
    for tile in tiles(inked, size_px=SIZE, margin_px=MARGIN):
        count[tile.core_top : tile.core_bottom, tile.core_left : tile.core_right] += 1
    assert count.max() <= 1
    assert count[inked].all()
    assert count.any() == inked.any()


def test_blank_paper_around_and_beside_the_ink_is_left_out() -> None:
    """A page of 1,024 px cut into squares takes 36 windows; two bars far apart, two wide each, take a few."""
    inked = np.zeros((1024, 1024), bool)
    inked[100:160, 300:600] = True
    inked[800:900, 500:800] = True
    assert len(list(tiles(inked, size_px=SIZE, margin_px=MARGIN))) == 4
