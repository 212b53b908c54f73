"""The pictures of the threshold study: histograms, the grid of tau0 and lambda, and our own drawings drawn again."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

import cv2
import matplotlib as mpl
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from daemon.graph.feedback import Adaptation
from daemon.ink import ink_mask
from daemon.intake.decode import decode
from daemon.page.prepare import prepare
from daemon.report.fidelity import within
from daemon.shapes import PageImage, Points, Segmentation
from daemon.vision.segmenter import Segmenter
from training.render import LINE_PX
from training.thresholds_measure import FIXED, ROUNDS, Alone, Mode, graph

mpl.use("Agg")
from matplotlib import pyplot as plt

DRAWINGS = Path("tests/drawings")
SHOWN = ("house.png", "star.png", "face.png", "crossing_grid.png")
BOTH: tuple[Mode, ...] = ("alone", "repaired")
_DPI = 110
_INK, _FALSE, _LOST = (40, 40, 40), (214, 39, 40), (255, 160, 40)
_BESIDE_PX = 1.0

Picture = NDArray[np.uint8]


def draw(found: dict[str, Any], folder: Path) -> None:
    """thresholds_tau.png, thresholds_grid.png, thresholds_fixed.png, thresholds_rounds.png."""
    _draw_histograms(found, folder / "thresholds_tau.png")
    if found["grid"]:
        _draw_grid(found, folder / "thresholds_grid.png")
    segmenter = Segmenter(threads=1)
    pages = [prepare(decode(DRAWINGS / name)) for name in SHOWN]
    seen = [(page, segmenter.segment(page)) for page in pages]
    figures = {(each["beta_px"], each["tau0"], each["rounds"]): each for each in found["settings"]}
    for name, settings in (("fixed", FIXED), ("rounds", ROUNDS)):
        _draw_rows(seen, settings, figures, folder / f"thresholds_{name}.png")


def _draw_histograms(found: dict[str, Any], file: Path) -> None:
    """Above tau-hat, below tau-hat minus the mean eta; one column a beta; the network's own corners as an outline."""
    bins = np.array(found["bins"])
    thresholds = found["thresholds"]
    _, axes = plt.subplots(2, len(thresholds), figsize=(10, 4.6), sharex=True, sharey=True, layout="constrained")
    for column, (beta, each) in enumerate(thresholds.items()):
        for row, (name, words) in enumerate((("tau", "tau-hat"), ("margin", "tau-hat - mean eta"))):
            at, known, seen = axes[row][column], each["known"][name], each["seen"][name]
            at.stairs(known["counts"], bins, fill=True, color="C0", alpha=0.6, label="vertices of the rendering")
            at.stairs(seen["counts"], bins, color="C3", label="the network's corners")
            at.axvline(known["mean"], color="C0")
            at.set_title(f"{words}, beta {beta}: {known['mean']:.3f}, sd {known['sd']:.3f}", fontsize=9)
            at.grid(alpha=0.3)
    axes[0][0].legend(fontsize=7)
    axes[0][0].set_ylabel("sketches")
    axes[1][0].set_ylabel("sketches")
    _save(file)


def _draw_grid(found: dict[str, Any], file: Path) -> None:
    """Precision, recall and edges per line over tau0 and lambda; above the equations alone, below repaired."""
    tau0s, rates = (sorted({each[name] for each in found["grid"]}) for name in ("tau0", "rate"))
    cells = {(each["tau0"], each["rate"]): each for each in found["grid"]}
    shown = (("precision", "ink precision, %"), ("recall", "ink recall, %"), ("edges", "edges per line"))
    _, axes = plt.subplots(len(BOTH), len(shown), figsize=(10, 5.4), sharex=True, sharey=True, layout="constrained")
    for column, (figure, words) in enumerate(shown):
        values = np.array([[[cells[t, r][mode][figure] for r in rates] for t in tau0s] for mode in BOTH])
        for row, mode in enumerate(BOTH):
            at = axes[row][column]
            at.imshow(values[row], cmap="viridis", vmin=values.min(), vmax=values.max(), aspect="auto")
            at.set_title(f"{words}, {'equations alone' if mode == 'alone' else mode}", fontsize=9)
            _label(at, values[row], float(values.min() + values.max()) / 2)
            at.set_xticks(range(len(rates)), [f"{rate:g}" for rate in rates])
            at.set_yticks(range(len(tau0s)), [f"{tau0:g}" for tau0 in tau0s])
    for at in axes[-1]:
        at.set_xlabel("lambda")
    for row in axes:
        row[0].set_ylabel("tau0")
    _save(file)


def _label(at: Any, values: NDArray[np.float64], middle: float) -> None:
    for (y, x), value in np.ndenumerate(values):
        text = f"{value:.1f}" if value >= 10 else f"{value:.2f}"
        at.text(x, y, text, ha="center", va="center", fontsize=7, color="black" if value > middle else "white")


def _draw_rows(
    seen: Sequence[tuple[PageImage, Segmentation]],
    settings: Sequence[Adaptation],
    figures: dict[tuple[float, float, int], dict[str, Any]],
    file: Path,
) -> None:
    """A row a setting, below the inputs; a column a drawing, left by the equations alone, right repaired."""
    columns, rows = len(BOTH) * len(seen), 1 + len(settings)
    _, axes = plt.subplots(rows, columns, figsize=(1.5 * columns + 0.6, 1.75 * rows), layout="constrained")
    ways = [Alone(page, maps) for page, maps in seen]
    for column in range(columns):
        mode, (page, maps) = BOTH[column // len(seen)], seen[column % len(seen)]
        axes[0][column].imshow(page.grey, cmap="gray", vmin=0, vmax=255)
        axes[0][column].set_title("equations alone" if mode == "alone" else mode, fontsize=9)
        for row, adaptation in enumerate(settings, start=1):
            strokes = graph(page, maps, ways[column % len(seen)], mode, adaptation)
            axes[row][column].imshow(compared(page, strokes))
            axes[row][column].set_xlabel(f"{len(strokes)} edges", fontsize=7, labelpad=1)
    for row, adaptation in enumerate(settings, start=1):
        for column, mode in ((0, "alone"), (len(seen), "repaired")):
            axes[row][column].set_ylabel(_words(adaptation, mode, figures), fontsize=7)
    for at in axes.flat:
        at.set(xticks=[], yticks=[])
    _save(file)


def _words(adaptation: Adaptation, mode: str, figures: dict[tuple[float, float, int], dict[str, Any]]) -> str:
    """The setting, and what it gives on the test sketches."""
    found = figures[adaptation.beta_px, adaptation.tau0, adaptation.rounds][mode]
    said = f"beta {adaptation.beta_px:g}, tau {adaptation.tau0:g}, N {adaptation.rounds}"
    return f"{said}\nsketches: precision {found['precision']:.1f}\nrecall {found['recall']:.1f}"


def _save(file: Path) -> None:
    """As PNG of 256 colours, a third of the size of all."""
    drawn = BytesIO()
    plt.savefig(drawn, dpi=_DPI)
    plt.close()
    Image.open(drawn).convert("RGB").quantize(256).save(file, optimize=True)


def compared(page: PageImage, strokes: Sequence[Points]) -> Picture:
    """What was drawn: dark on ink, red where there is none; ink that was not drawn in orange. uint8 (H, W, 3)."""
    ink, width_px = ink_mask(page.grey), page.line_width_px or float(LINE_PX)
    drawn = within(strokes, ink.shape, width_px / 2) if strokes else np.zeros(ink.shape, bool)
    out = np.full((*ink.shape, 3), 255, np.uint8)
    out[ink & ~_grown(drawn)] = _LOST
    out[drawn] = _INK
    out[drawn & ~_grown(ink)] = _FALSE
    return out


def _grown(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    size = 2 * int(_BESIDE_PX) + 1
    return np.asarray(cv2.dilate(mask.astype(np.uint8), np.ones((size, size), np.uint8)) > 0)
