"""Other tracers on a folder of pictures: `python trace.py TOOL FOLDER` prints {name: {strokes, cpu_ms}} as JSON.

Runs in the peers' virtual environment and knows nothing of linedrawd. Strokes are in px, pixel centres at integers.
"""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np

Strokes = list[list[list[float]]]
_PAGE_MM = 200.0


def plotline(grey: np.ndarray) -> Strokes:
    """Its ink style, one line down the middle, with the page, pen and resolution that came closest of those tried."""
    from plotline import Canvas, Pen, Session  # noqa: PLC0415

    px_per_mm = grey.shape[0] / _PAGE_MM
    session = Session()
    session.set_style("ink")
    session.set_canvas(Canvas(width_mm=_PAGE_MM, height_mm=_PAGE_MM, margin_mm=0.0))
    session.set_pens([Pen("Pen", 0.3, "#000000")])
    session.set_image(grey)
    session.update("ink", mode="centreline")
    session.update("tone", resolution=2 * grey.shape[0])
    layers = session.run_blocking().layers
    return [(np.asarray(path) * px_per_mm - 0.5).tolist() for layer in layers for path in layer.paths]


def autotrace(grey: np.ndarray) -> Strokes:
    """Its centre line of the picture in black and white; cubic splines at eight points each."""
    from autotrace import Bitmap  # noqa: PLC0415

    vector = Bitmap(np.repeat(_black_and_white(grey)[:, :, None], 3, axis=2)).trace(centerline=True)
    traced = [_flat(path.splines, grey.shape[0]) for path in vector.paths]
    return [path for path in traced if path]


def sknw(grey: np.ndarray) -> Strokes:
    """scikit-image's skeleton as sknw's graph, each edge reduced by 1 px (Douglas and Peucker 1973)."""
    import sknw as graphs  # noqa: PLC0415
    from skimage.measure import approximate_polygon  # noqa: PLC0415
    from skimage.morphology import skeletonize  # noqa: PLC0415

    graph = graphs.build_sknw(skeletonize(_black_and_white(grey) == 0), multi=True)
    found = []
    for start, end, edge in graph.edges(data=True):
        line = np.concatenate([[graph.nodes[start]["o"]], edge["pts"], [graph.nodes[end]["o"]]])
        found.append(approximate_polygon(line, 1.0)[:, ::-1].tolist())
    return found


TOOLS: dict[str, Callable[[np.ndarray], Strokes]] = {"plotline": plotline, "autotrace": autotrace, "sknw": sknw}


def main(tool: str, folder: Path) -> None:
    pictures = sorted(folder.glob("*.png"))
    trace, traced = TOOLS[tool], {}
    trace(cv2.imread(str(pictures[0]), cv2.IMREAD_GRAYSCALE))  # Warms what is slow once.
    for picture in pictures:
        began = time.process_time()
        strokes = trace(cv2.imread(str(picture), cv2.IMREAD_GRAYSCALE))
        traced[picture.stem] = {"strokes": strokes, "cpu_ms": (time.process_time() - began) * 1000}
    json.dump(traced, sys.stdout)


def _black_and_white(grey: np.ndarray) -> np.ndarray:
    return cv2.threshold(grey, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)[1]


def _flat(splines: list, side_px: int) -> list[list[float]]:
    """The points of a path of splines; its y runs upwards."""
    line: list[list[float]] = []
    for spline in splines:
        control = np.array([(p.x, p.y) for p in spline.points])
        t = np.linspace(0, 1, 9)[:, None] if spline.degree.value > 1 else np.array([[0.0], [1.0]])
        a, b, c, d = control if len(control) == 4 else (control[0], control[0], control[-1], control[-1])
        points = a * (1 - t) ** 3 + 3 * b * (1 - t) ** 2 * t + 3 * c * (1 - t) * t**2 + d * t**3
        line += [[float(x), float(side_px - 1 - y)] for x, y in points]
    return [line[0], *(q for p, q in pairwise(line) if p != q)] if line else []


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
