"""The pieces of a mask that is labelled in bands are those of the mask as a whole, to the last bit."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from daemon import components as room
from daemon.components import components


@pytest.mark.parametrize("share", [0.02, 0.3, 0.41, 0.6])
def test_bands_find_what_the_whole_mask_holds(share: float, monkeypatch: pytest.MonkeyPatch) -> None:
    mask = np.random.default_rng(3).random((93, 61)) < share
    count, labels, stats, centres = cv2.connectedComponentsWithStats(mask.view(np.uint8), connectivity=8)
    monkeypatch.setattr(room, "_AT_ONCE_PX", 61 * 8)
    found = components(mask)
    assert (found.stats[1:] == stats[1:]).all()
    assert (found.centres[1:] == centres[1:]).all()
    assert (found.mapped(np.arange(count)) == labels).all()
    y, x = np.nonzero(mask)
    assert (found.at(y, x) == labels[y, x]).all()


def test_a_piece_is_cut_out_of_what_lies_in_its_box() -> None:
    mask = np.zeros((9, 9), bool)
    mask[0, :] = mask[:, 0] = mask[4:6, 4:6] = True
    found = components(mask)
    ring, block = found.piece(1), found.piece(2)
    assert (ring == np.pad(np.zeros((8, 8), bool), ((1, 0), (1, 0)), constant_values=True)).all()
    assert (block == np.ones((2, 2), bool)).all()


def test_nothing_has_no_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(room, "_AT_ONCE_PX", 16)
    found = components(np.zeros((20, 5), bool))
    assert len(found.stats) == 1
    assert not found.mapped(np.array([False])).any()
