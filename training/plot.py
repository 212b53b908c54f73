"""Pictures of training runs: validation IoU and loss over images."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

import matplotlib as mpl

mpl.use("Agg")
from matplotlib import pyplot as plt

History: TypeAlias = Sequence[Mapping[str, float]]
"""What a run has measured, in order: images, and for each set its mean, its classes and its loss."""

_DPI = 110


def draw_run(history: History, path: Path) -> None:
    """One run: mean IoU and corners of every validation set to the left, unweighted cross-entropy to the right."""
    figure, (iou, loss) = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    images = [row["images"] for row in history]
    names = sorted(key.removesuffix("_mean") for key in history[0] if key.endswith("_mean"))
    for number, name in enumerate(names):
        for what, style in (("mean", "-"), ("corners", ":")):
            values = [row[f"{name}_{what}"] for row in history]
            iou.plot(images, values, style, color=f"C{number}", marker=".", label=f"{name}, {what}")
        loss.plot(images, [row[f"{name}_loss"] for row in history], color=f"C{number}", marker=".", label=name)
    iou.set(xlabel="images", ylabel="validation IoU, %")
    loss.set(xlabel="images", ylabel="validation cross-entropy", yscale="log")
    for axes in (iou, loss):
        axes.legend(fontsize=8)
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=_DPI)
    plt.close(figure)


def draw_table(runs: Mapping[str, History], folder: Path) -> None:
    """iou.png and loss.png of many runs side by side: those whose name ends in BatchNorm are dashed."""
    colours = {name: f"C{k}" for k, name in enumerate(dict.fromkeys(map(_plain, runs)))}
    for key, label in (("mean", "validation mean IoU, %"), ("loss", "validation cross-entropy")):
        figure, axes = plt.subplots(figsize=(7, 4.2), layout="constrained")
        for name, history in runs.items():
            style = "-" if name == _plain(name) else "--"
            values = [row[f"paper_{key}"] for row in history]
            axes.plot([row["images"] for row in history], values, style, color=colours[_plain(name)], label=name)
        axes.set(xlabel="images", ylabel=label, yscale="log" if key == "loss" else "linear")
        axes.legend(fontsize=7)
        axes.grid(alpha=0.3)
        figure.savefig(folder / f"{'iou' if key == 'mean' else 'loss'}.png", dpi=_DPI)
        plt.close(figure)


def _plain(name: str) -> str:
    return name.removesuffix(" BatchNorm")
