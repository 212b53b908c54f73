"""A page looked at from afar."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.page.tones import tones
from tests.daemon.page.pages import drawn, grain


def test_ink_and_paper_are_told_apart() -> None:
    found = tones(grain(drawn(ink=60, paper=200, width_px=6), 4))
    assert found is not None
    assert found.full_ink == pytest.approx(60, abs=6)
    assert found.paper == pytest.approx(200, abs=2)
    assert found.grain == pytest.approx(4, abs=1)


@pytest.mark.parametrize("across", [True, False])
def test_a_single_line_on_a_large_page_is_not_overlooked(across: bool) -> None:
    grey = np.full((2048, 2048), 255, np.uint8)
    grey[(slice(1001, 1003), slice(None)) if across else (slice(None), slice(1001, 1003))] = 0
    found = tones(grey)
    assert found is not None
    assert found.full_ink == 0


def test_a_page_of_one_tone_has_no_two() -> None:
    assert tones(np.full((40, 50), 200, np.uint8)) is None
