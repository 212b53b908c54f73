"""explain.png: what was understood of a page, at one look."""

from __future__ import annotations

from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from daemon.ink import Mask, ink_mask, thin
from daemon.report import canvas
from daemon.report.canvas import Colour, Picture
from daemon.report.fidelity import within
from daemon.report.steps import with_steps
from daemon.shapes import Drawing, Grey, LineGraph, PageImage, Points, Segmentation

Level = TypeVar("Level", np.uint8, np.float32)

_TILE_PX = 720
_MARGIN_PX = 28
_HEAD_PX = 56
_WORDS_PX = 34
_MISSED_PX = 2.5
_PALE = np.asarray(184 + 71 * (np.arange(256) / np.float32(255)), np.uint8)
"""Each grey level, pale."""


def explain(
    page: PageImage, segmentation: Segmentation | None, graph: LineGraph, drawing: Drawing, *, name: str
) -> Picture:
    """Four tiles with their legends: the page, the network's channels on it, the graph, and the strokes.

    Below them what was done to the page before. segmentation: None where the network was not asked, for the file said
    itself where its lines are.

    segmentation, graph and drawing: in px of this page. name: of the picture, for the heading. Returns uint8
    (H, W, 3), about 1500 px wide.
    """
    scale = _TILE_PX / max(page.grey.shape)
    tiles = [
        ([("the page", canvas.WORDS)], _enlarged(page.grey, scale)),
        _seen(page, segmentation, scale),
        _graph(page, graph, scale),
        _strokes(page, drawing, scale),
    ]
    height, width = page.grey.shape
    size = f"{page.given_width_px} × {page.given_height_px} px, understood at {width} × {height} px"
    return with_steps(_laid_out(tiles, name, size), page.steps)


_Legend = list[tuple[str, Colour]]


def _seen(page: PageImage, segmentation: Segmentation | None, scale: float) -> tuple[_Legend, Picture]:
    if segmentation is None:
        return [("the network was not asked: these lines stand in the file", canvas.WORDS)], _faded(page.grey, scale)
    legend = [("the network sees: ", canvas.WORDS), ("lines", canvas.BLUE), ("corners", canvas.ORANGE)]
    return legend, _channels(segmentation, scale)


def _graph(page: PageImage, graph: LineGraph, scale: float) -> tuple[_Legend, Picture]:
    tile = _faded(page.grey, scale)
    for edge in graph.edges:
        canvas.line(tile, _on_tile(edge.polyline, scale), canvas.GREEN if len(edge.polyline) <= 2 else canvas.BLUE, 3)
    for vertex in _on_tile(graph.vertices, scale):
        canvas.dot(tile, vertex, 4.0, canvas.ORANGE, canvas.PAPER)
    return [(canvas.counted(len(graph.vertices), "vertex", "vertices"), canvas.ORANGE), *_kinds(graph)], tile


def _kinds(graph: LineGraph) -> _Legend:
    sizes = [len(edge.polyline) for edge in graph.edges]
    dots, straight = sizes.count(1), sizes.count(2)
    kinds = [(canvas.counted(straight, "straight edge", "straight edges"), canvas.GREEN)]
    kinds.append((canvas.counted(len(sizes) - straight - dots, "bent edge", "bent edges"), canvas.BLUE))
    return kinds + ([(canvas.counted(dots, "dot", "dots"), canvas.GREEN)] if dots else [])


def _strokes(page: PageImage, drawing: Drawing, scale: float) -> tuple[_Legend, Picture]:
    tile = _faded(page.grey, scale)
    missed = _missed(page, drawing)
    for stroke, colour in zip(drawing.strokes, canvas.many_colours(), strict=False):
        points = _on_tile(stroke.points, scale)
        canvas.line(tile, points, colour, 3)
        canvas.dot(tile, points[0], 4.5, canvas.PAPER, colour)
    for y, x in np.argwhere(missed):
        canvas.dot(tile, _on_tile(np.array([[x, y]], float), scale)[0], 2.0, canvas.RED)
    legend = [(canvas.counted(len(drawing.strokes), "stroke", "strokes") + ", begun at the ring", canvas.WORDS)]
    return legend + ([(f"{int(missed.sum())} px of ink not drawn", canvas.RED)] if missed.any() else []), tile


def _missed(page: PageImage, drawing: Drawing) -> Mask:
    """The centre line of ink that no stroke passes."""
    ink = ink_mask(page.grey)
    return thin(ink) & ~within([stroke.points for stroke in drawing.strokes], ink.shape, _MISSED_PX)


def _channels(segmentation: Segmentation, scale: float) -> Picture:
    """Large maps are made smaller before they get colours, which take six times as much memory."""
    lines, corners = segmentation.lines, segmentation.corners
    if scale < 1:
        lines, corners = (_resized(large.astype(np.float32, copy=False), scale) for large in (lines, corners))
        scale = 1.0
    lines, corners = lines[..., None], corners[..., None]
    seen = np.full((*lines.shape[:2], 3), 255, np.float32)
    seen += lines * (np.array(canvas.BLUE, np.float32) - seen)
    seen += corners * (np.array(canvas.ORANGE, np.float32) - seen)
    return _resized(np.asarray(np.rint(np.clip(seen, 0, 255)), np.uint8), scale)


def _faded(grey: Grey, scale: float) -> Picture:
    """The page, pale, so that thin lines on it can be told from it."""
    return _enlarged(_PALE[grey], scale)


def _enlarged(grey: Grey, scale: float) -> Picture:
    return np.asarray(cv2.cvtColor(_resized(grey, scale), cv2.COLOR_GRAY2BGR), np.uint8)


def _resized(image: NDArray[Level], scale: float) -> NDArray[Level]:
    """Pixels stay visible squares where a page is much enlarged, and are averaged where it is made smaller."""
    size = (max(1, round(image.shape[1] * scale)), max(1, round(image.shape[0] * scale)))
    how = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR if scale < 2 else cv2.INTER_NEAREST
    return np.asarray(cv2.resize(image, size, interpolation=how), image.dtype)


def _on_tile(points: Points, scale: float) -> Points:
    return (points + 0.5) * scale - 0.5


def _laid_out(tiles: list[tuple[_Legend, Picture]], name: str, size: str) -> Picture:
    height, width = tiles[0][1].shape[:2]
    pitch_x, pitch_y = max(width, _TILE_PX // 2) + _MARGIN_PX, height + _WORDS_PX + _MARGIN_PX
    picture = canvas.blank(2 * pitch_x + _MARGIN_PX, 2 * pitch_y + _HEAD_PX, canvas.DESK)
    right = picture.shape[1] - _MARGIN_PX
    canvas.write(picture, size, (right, 38), canvas.QUIET, align="right")
    room = right - _MARGIN_PX * 2 - canvas.words_width_px(size)
    canvas.write(
        picture, canvas.shortened(name, room, size_px=22, weight=600), (_MARGIN_PX, 38), size_px=22, weight=600
    )
    for index, (legend, tile) in enumerate(tiles):
        left, top = _MARGIN_PX + index % 2 * pitch_x, _HEAD_PX + index // 2 * pitch_y
        canvas.paste(picture, tile, left, top)
        canvas.box(picture, (left - 1, top - 1), (left + width, top + height), canvas.FRAME)
        _write_legend(picture, legend, left, top + height + 22)
    return picture


def _write_legend(picture: Picture, legend: _Legend, left: float, base: float) -> None:
    for words, colour in legend:
        canvas.write(picture, words, (left, base), colour, weight=500)
        left += canvas.words_width_px(words, weight=500) + 18
