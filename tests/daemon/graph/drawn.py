"""Pages drawn from known lines, with the channels that a perfect network would give, and measures of what came back."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np

from daemon.graph.vertices import DISC
from daemon.page.line_width import line_width_px
from daemon.shapes import Drawing, Edge, LineGraph, PageImage, Points, Segmentation

Lines = list[list[tuple[float, float]]]


def page(lines: Lines, *, size: int = 128, width_px: int = 2) -> PageImage:
    """Dark lines on white paper, at sub-pixel positions."""
    grey = np.full((size, size), 255, np.uint8)
    for line in lines:
        points = np.rint(np.array(line) * 256).astype(np.int32)
        cv2.polylines(grey, [points], False, 0, width_px, cv2.LINE_AA, 8)
    return PageImage(grey, np.eye(3), size, size, "", line_width_px=line_width_px(grey))


def channels(drawn: PageImage, corners: Sequence[tuple[float, float]]) -> Segmentation:
    """Discs of 13 px on the corners, lines where there is other ink."""
    is_corner = np.zeros(drawn.grey.shape, bool)
    for x, y in corners:
        is_corner[round(y) + DISC[:, 1], round(x) + DISC[:, 0]] = True
    is_line = (drawn.grey < 128) & ~is_corner
    maps = (~is_corner & ~is_line, is_line, is_corner)
    return Segmentation(*(values.astype(np.float32) for values in maps))


def silent(drawn: PageImage) -> Segmentation:
    """What a network says that has seen nothing."""
    nothing = np.zeros(drawn.grey.shape, np.float32)
    return Segmentation(1 - nothing, nothing, nothing)


def circle(x: float, y: float, radius: float, *, turns: float = 1.0, growth: float = 0.0) -> list[tuple[float, float]]:
    """A circle, or with growth px a turn a spiral."""
    angles = np.linspace(0, 2 * np.pi * turns, round(120 * turns) + 1)
    radii = radius + growth * angles / (2 * np.pi)
    return list(zip(x + radii * np.cos(angles), y + radii * np.sin(angles), strict=True))


def distances(lines: list[Points], others: list[Points]) -> Points:
    """How far points half a px apart along the lines are from the nearest of the other lines."""
    points = np.concatenate([_dense(line) for line in lines])
    starts = np.concatenate([line[:-1] for line in others])
    along = np.concatenate([np.diff(line, axis=0) for line in others])
    offset = points[:, None] - starts
    share = np.clip((offset * along).sum(2) / np.maximum((along**2).sum(1), 1e-12), 0, 1)
    return np.asarray(np.hypot(*(offset - share[:, :, None] * along).transpose(2, 0, 1)).min(axis=1))


def length_px(lines: list[Points]) -> float:
    return float(sum(np.hypot(*np.diff(line, axis=0).T).sum() for line in lines))


def arrays(lines: Lines) -> list[Points]:
    return [np.array(line, float) for line in lines]


def polylines(graph: LineGraph) -> list[Points]:
    return [edge.polyline for edge in graph.edges]


def degrees(graph: LineGraph) -> list[int]:
    ends = [vertex for edge in graph.edges for vertex in (edge.start, edge.end)]
    return sorted(np.bincount(np.array(ends, int), minlength=len(graph.vertices)).tolist())


def of_points(drawing: Drawing) -> list[list[tuple[float, float]]]:
    return [[(float(x), float(y)) for x, y in stroke.points] for stroke in drawing.strokes]


def graph_of(vertices: list[tuple[float, float]], pairs: list[tuple[int, int]]) -> LineGraph:
    """A graph of straight edges."""
    points = np.array(vertices, float)
    return LineGraph(points, tuple(Edge(p, q, points[[p, q]], 1.0) for p, q in pairs))


def _dense(line: Points) -> Points:
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    at = np.arange(0.0, along[-1], 0.5)
    return np.stack([np.interp(at, along, line[:, axis]) for axis in (0, 1)], axis=1)
