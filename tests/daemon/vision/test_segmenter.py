"""The shipped network on pages of our own."""

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from daemon.errors import SettingsError
from daemon.shapes import Grey, PageImage, Segmentation
from daemon.vision.segmenter import Segmenter, checked_file, cut, load_manifest, soft_edged
from daemon.vision.tiles import Tile


@pytest.fixture(scope="module")
def segmenter() -> Segmenter:
    return Segmenter()


def page(width: int, height: int, *lines: tuple[int, int, int, int]) -> PageImage:
    grey = np.full((height, width), 255, np.uint8)
    for x0, y0, x1, y1 in lines:
        cv2.line(grey, (x0, y0), (x1, y1), 0, 2, cv2.LINE_AA)
    return page_of(grey)


def page_of(grey: Grey) -> PageImage:
    return PageImage(grey, np.eye(3), grey.shape[1], grey.shape[0], "")


def corners(found: Segmentation) -> list[tuple[int, int]]:
    said = np.argmax(np.stack([found.background, found.lines, found.corners]), axis=0) == 2
    _, _, _, centres = cv2.connectedComponentsWithStats(said.astype(np.uint8), connectivity=8)
    return sorted((round(x), round(y)) for x, y in centres[1:])


def near(found: list[tuple[int, int]], expected: list[tuple[int, int]]) -> bool:
    return len(found) == len(expected) and all(
        min(np.hypot(x - a, y - b) for a, b in expected) <= 2.0 for x, y in found
    )


def test_a_cross_is_five_corners_and_four_lines(segmenter: Segmenter) -> None:
    found = segmenter.segment(page(221, 221, (40, 60, 180, 150), (60, 160, 170, 50)))
    assert near(corners(found), [(40, 60), (180, 150), (60, 160), (170, 50), (113, 107)])
    assert found.lines[80, 71] > 0.5


@pytest.mark.parametrize(("width", "height"), [(30, 20), (221, 221), (256, 256), (300, 120), (700, 500)])
def test_the_maps_have_the_pages_shape_and_sum_to_one(segmenter: Segmenter, width: int, height: int) -> None:
    found = segmenter.segment(page(width, height, (5, 5, width - 6, height - 6)))
    assert found.lines.shape == (height, width)
    assert np.allclose(found.background + found.lines + found.corners, 1.0, atol=1e-4)


def test_blank_paper_is_background_and_nothing_else(segmenter: Segmenter) -> None:
    found = segmenter.segment(page(600, 500))
    assert (found.background == 1.0).all()


def test_a_line_through_many_windows_has_no_corner_at_their_seams(segmenter: Segmenter) -> None:
    found = segmenter.segment(page(900, 300, (40, 100, 860, 180)))
    assert near(corners(found), [(40, 100), (860, 180)])


def test_a_circle_of_hard_pixels_is_no_corner(segmenter: Segmenter) -> None:
    """Without soft edges the network strings corners along every curve of a bare raster."""
    grey = np.full((221, 221), 255, np.uint8)
    cv2.circle(grey, (110, 110), 70, 0, 3, cv2.LINE_8)
    assert (segmenter.segment(page_of(grey)).corners > 0.5).sum() == 0


def test_soft_edges_are_left_as_they_are() -> None:
    grey = np.full((60, 60), 255, np.uint8)
    cv2.circle(grey, (30, 30), 20, 0, 2, cv2.LINE_AA)
    assert soft_edged(grey) is grey
    assert soft_edged(np.where(grey < 128, 0, 255).astype(np.uint8)).std() > 0


def test_a_window_beyond_the_page_sees_white_paper() -> None:
    grey = np.zeros((10, 10), np.uint8)
    seen = cut(grey, Tile(-5, -5, 0, 0, 10, 10), 20)
    assert seen.sum() == 100.0
    assert seen[5:15, 5:15].all()


def test_the_manifest_speaks_of_the_file_beside_it() -> None:
    manifest = load_manifest()
    assert checked_file(manifest).name == manifest.file
    with pytest.raises(SettingsError, match="damaged"):
        checked_file(replace(manifest, sha256="0" * 64))


def test_an_unknown_network_names_the_known_ones() -> None:
    with pytest.raises(SettingsError, match="linedrawd"):
        load_manifest("nobody")


def test_loading_the_network_leaves_no_file_behind(tmp_path: Path) -> None:
    """onnxruntime would write an identifier below the home folder as soon as it is imported."""
    environment = {k: v for k, v in os.environ.items() if k != "ORT_DISABLE_TELEMETRY"}
    environment |= {"HOME": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path / "cache")}
    code = "from daemon.vision.segmenter import Segmenter; Segmenter()"
    subprocess.run([sys.executable, "-c", code], check=True, env=environment, cwd=tmp_path)
    assert list(tmp_path.rglob("*")) == []


def test_the_manifest_states_labels_in_the_order_of_the_logits() -> None:
    values = json.loads((checked_file(load_manifest()).parent / "linedrawd.json").read_text())
    assert values["labels"] == ["background", "lines", "corners"]
