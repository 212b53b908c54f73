"""The network on a page. The only door to onnxruntime.

Input of the network: float32 (N, 1, H, W), ink 1 and paper 0; output: logits (N, 3, H, W) in the order background,
lines, corners (Raghav et al. 2020, Sec. 3.1; see the manifest beside the model).
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.errors import SettingsError
from daemon.shapes import Grey, Map, PageImage, Segmentation
from daemon.vision.tiles import Tile, tiles

# onnxruntime's Linux wheels write an identifier to disk and mean to report home as soon as they are imported.
os.environ["ORT_DISABLE_TELEMETRY"] = "1"
import onnxruntime

MODELS = Path(__file__).parent.parent / "models"
MARGIN_PX = 16
"""How far from its border a window's answer is not to be trusted."""
WHOLE_PX = 285
"""Pages up to this side are read whole."""
_HALVED_PX = 1 << 22
"""Of pages with more pixels than this the maps are kept to three digits, in half the memory."""
_BLANK = 64
"""Of 255: a pixel must be this much darker than white, or it is blank paper."""


_DARK, _SOFT_SHARE, _SOFT_PX = 20, 0.25, 0.8
"""Fewer pixels between black and white than this share of the ink's outline: hard edges, softened by this sigma."""


@dataclass(frozen=True, slots=True)
class Manifest:
    """What the file beside the model says of it."""

    file: str
    sha256: str
    tile_px: int
    """Side of the windows that large pages are read through."""
    legal_sizes_px: tuple[int, ...]
    """Sides for which the network's answer has the size of its input."""

    def window_px(self, side_px: int) -> int:
        """The whole page in one window where that is a size the network was trained with, else tiles."""
        whole = next((size for size in self.legal_sizes_px if size >= side_px), WHOLE_PX + 1)
        return whole if whole <= WHOLE_PX else self.tile_px


def load_manifest(name: str = "linedrawd") -> Manifest:
    """Raises SettingsError when there is no such model."""
    path = MODELS / f"{name}.json"
    if not path.is_file():
        known = ", ".join(sorted(p.stem for p in MODELS.glob("*.json")))
        raise SettingsError(f"there is no network called {name!r} in {MODELS}: choose one of {known}")
    values = json.loads(path.read_text())
    return Manifest(values["file"], values["sha256"], values["tile_px"], tuple(values["legal_sizes_px"]))


class Segmenter:
    """A loaded network; one page at a time."""

    def __init__(self, name: str = "linedrawd", *, threads: int = 1) -> None:
        self._manifest = load_manifest(name)
        self._session = open_model(checked_file(self._manifest), threads=threads)

    def segment(self, page: PageImage) -> Segmentation:
        """Three maps of the page's shape in 0..1 that sum to 1; float32, of pages above 4 megapixels float16."""
        return through_windows(page, self._manifest, lambda ink, last: softmax(self.logits(ink, last=last)))

    def logits(self, ink: NDArray[np.float32], *, last: bool = True) -> NDArray[np.float32]:
        """ink float32 (N, H, W) in 0..1, H and W legal sizes -> float32 (N, 3, H, W).

        last: the network gives the memory of its layers back, some 50 MB, which the rest of the page needs.
        """
        options = onnxruntime.RunOptions()
        if last:
            options.add_run_config_entry("memory.enable_memory_arena_shrinkage", "cpu:0")
        answer: NDArray[np.float32] = self._session.run(None, {"ink": ink[:, None]}, options)[0]
        return answer


def through_windows(
    page: PageImage, manifest: Manifest, shares_of: Callable[[NDArray[np.float32], bool], NDArray[np.float32]]
) -> Segmentation:
    """A page read window by window. shares_of: ink (N, S, S) and whether it is the page's last, to (N, 3, S, S)."""
    height, width = page.grey.shape
    grey = soft_edged(page.grey)
    maps = np.zeros((3, height, width), np.float16 if grey.size > _HALVED_PX else np.float32)
    maps[0] = 1.0
    size_px = manifest.window_px(max(width, height))
    inked = list(tiles(grey < 255 - _BLANK, size_px=size_px, margin_px=MARGIN_PX))
    # One at a time: several at once take several times the memory of the layers and no less time.
    for number, tile in enumerate(inked, start=1):
        paste(maps, tile, shares_of(cut(grey, tile, size_px)[None], number == len(inked))[0])
    return Segmentation(*maps)


def checked_file(manifest: Manifest) -> Path:
    """The model's file. Raises SettingsError when it is not the one that the manifest speaks of."""
    path = MODELS / manifest.file
    if not path.is_file() or hashlib.sha256(path.read_bytes()).hexdigest() != manifest.sha256:
        raise SettingsError(f"{path} is missing or damaged: install linedrawd again")
    return path


def open_model(path: Path, *, threads: int) -> onnxruntime.InferenceSession:
    """The number of threads is always said: left alone, onnxruntime pins its workers, which a service may not."""
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    options.inter_op_num_threads = 1
    options.log_severity_level = 3
    return onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])


def soft_edged(grey: Grey) -> Grey:
    """The page itself, or, where ink ends in steps from black to white, a page with the soft edges of a scan.

    The network has learned from antialiased ink; each step of a bare raster looks like a small corner to it.
    """
    ink = (grey < 128).astype(np.uint8)
    outline = np.count_nonzero(ink) - np.count_nonzero(cv2.erode(ink, np.ones((3, 3), np.uint8)))
    between = np.count_nonzero((grey > _DARK) & (grey < 255 - _DARK))
    if between >= _SOFT_SHARE * outline:
        return grey
    return np.asarray(cv2.GaussianBlur(grey, (0, 0), _SOFT_PX), np.uint8)


def cut(grey: Grey, tile: Tile, size_px: int) -> Map:
    """The window as the network wants it, white paper beyond the page."""
    height, width = grey.shape
    out = np.zeros((size_px, size_px), np.float32)
    top, left = max(tile.top, 0), max(tile.left, 0)
    bottom, right = min(tile.top + size_px, height), min(tile.left + size_px, width)
    seen = grey[top:bottom, left:right]
    out[top - tile.top : bottom - tile.top, left - tile.left : right - tile.left] = (255 - seen) / np.float32(255)
    return out


def paste(maps: NDArray[np.floating[Any]], tile: Tile, answer: NDArray[np.float32]) -> None:
    rows = slice(tile.core_top - tile.top, tile.core_bottom - tile.top)
    columns = slice(tile.core_left - tile.left, tile.core_right - tile.left)
    maps[:, tile.core_top : tile.core_bottom, tile.core_left : tile.core_right] = answer[:, rows, columns]


def softmax(logits: NDArray[np.float32]) -> NDArray[np.float32]:
    """Over axis 1."""
    powers = np.exp(logits - logits.max(axis=1, keepdims=True))
    shares: NDArray[np.float32] = powers / powers.sum(axis=1, keepdims=True)
    return shares
