"""What is looked up band by band is what the whole page says."""

from __future__ import annotations

import numpy as np

from daemon.bands import BAND_PX
from daemon.graph.anchors import nearest, nearest_at
from daemon.graph.remains import uncovered
from daemon.graph.skeleton import skeleton_of

SHAPE = (2 * BAND_PX + 100, 60)


def test_the_nearest_vertex_may_lie_in_the_next_band() -> None:
    vertices = np.array([[30.0, BAND_PX - 2.0], [10.0, 2.0 * BAND_PX + 1.0]])
    near = nearest(vertices, SHAPE, within_px=5.0)
    vertex, away_px = near.at(np.array([BAND_PX + 2, 2 * BAND_PX - 1, 50]), np.array([30, 10, 30]))
    assert vertex.tolist() == [0, 1, 0]
    assert away_px.tolist() == [4.0, 2.0, np.inf]
    owner, distance = nearest_at(vertices, np.array([[30, BAND_PX + 2], [10, 2 * BAND_PX - 1]]), SHAPE, within_px=5.0)
    assert owner.tolist() == [0, 1]
    assert distance.tolist() == [4.0, 2.0]


def test_a_line_along_the_seam_of_two_bands_covers_the_ink_on_both_sides() -> None:
    ink = np.zeros(SHAPE, bool)
    ink[BAND_PX - 3 : BAND_PX + 3, 5:55] = True
    line = np.array([[5.0, BAND_PX - 0.5], [54.0, BAND_PX - 0.5]])
    assert not uncovered(ink, [line], width_px=6.0).any()
    assert uncovered(ink, [line - [0, 40]], width_px=6.0).sum() == ink.sum()


def test_pixels_are_linked_with_those_that_touch_them() -> None:
    mask = np.zeros((6, 7), bool)
    mask[[0, 1, 2, 2, 3, 5], [6, 5, 4, 3, 2, 0]] = True
    skeleton = skeleton_of(mask)
    for pixel, links in zip(skeleton.pixels, skeleton.links, strict=True):
        others = skeleton.pixels[links[links >= 0]]
        assert (np.abs(others - pixel).max(axis=1) == 1).all()
    assert sorted(skeleton.degrees.tolist()) == [0, 1, 1, 2, 2, 2]
