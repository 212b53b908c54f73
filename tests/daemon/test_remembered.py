"""A look at a page is taken once, and forgotten with the page."""

from __future__ import annotations

import numpy as np

from daemon.remembered import remembered
from daemon.shapes import Grey


def test_each_page_is_looked_at_once() -> None:
    looked: list[int] = []

    @remembered
    def darkest(grey: Grey) -> int:
        looked.append(int(grey.min()))
        return looked[-1]

    one, other = np.full((2, 2), 7, np.uint8), np.full((2, 2), 9, np.uint8)
    assert [darkest(one), darkest(other), darkest(one)] == [7, 9, 7]
    assert looked == [7, 9]
    for level in range(100):
        assert darkest(np.full((2, 2), level, np.uint8)) == level
