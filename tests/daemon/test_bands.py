"""Bands of a page."""

from __future__ import annotations

import numpy as np
import pytest

from daemon.bands import BAND_PX, bands


@pytest.mark.parametrize("height_px", [0, 1, BAND_PX, BAND_PX + 1, 3 * BAND_PX - 7])
def test_every_row_belongs_to_one_band_that_sees_its_halo(height_px: int) -> None:
    page, told = np.arange(height_px), []
    for band in bands(height_px, halo_px=4.2):
        seen = page[band.seen]
        told += seen[band.own_of_seen].tolist()
        assert np.array_equal(page[band.own], seen[band.own_of_seen])
        assert seen[0] == max(0, page[band.own][0] - 5)
        assert seen[-1] == min(height_px - 1, page[band.own][-1] + 5)
    assert told == page.tolist()
