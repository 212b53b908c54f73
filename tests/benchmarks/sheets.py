"""Peak memory and time of planning whole sheets: A4 with 20 m of line, from 1 to 100 megapixels, and A3 at 300 dpi."""

from __future__ import annotations

import json
import math
import os
import tempfile
import time
from pathlib import Path

import cv2
import numpy as np

from daemon.config import Options, load_settings
from daemon.config.load import Settings
from daemon.jobs.pool import Pool
from daemon.shapes import Grey
from tests.benchmarks.memory import children, cpu_s, peak_mb
from tests.benchmarks.pages import sketch

MEGAPIXELS = (1, 4, 16, 35, 100)
PENS_MM = (0.35, 0.1)
A4_MM, A3_MM = (210.0, 297.0), (297.0, 420.0)
_A3_MEGAPIXELS = 297 * 420 * (300 / 25.4) ** 2 / 1e6
_TILE_MM = 18.5
"""A sketch in each square of this side: 20 m of line on an A4 sheet."""


def show() -> None:
    """Print a line for each size and pen, each in a worker of its own: its peak and its seconds."""
    lengths_m = " and ".join(f"{length_m(size_mm):.0f}" for size_mm in (A4_MM, A3_MM))
    print(f"sheets planned in a worker of their own; {lengths_m} m of line on A4 and A3")
    print(f"{'':10}{'pen':>9}{'px':>14}{'peak MB':>9}{'CPU s':>8}{'wall s':>8}{'f1':>9}   stages, s")
    for megapixels in MEGAPIXELS:
        for pen_mm in PENS_MM:
            print(f"A4{megapixels:>5} MP{pen_mm:>6g} mm{planned(megapixels, pen_mm)}", flush=True)
    print(f"A3 300 dpi{PENS_MM[0]:>6g} mm{planned(_A3_MEGAPIXELS, PENS_MM[0], size_mm=A3_MM)}", flush=True)


def planned(megapixels: float, pen_mm: float, *, size_mm: tuple[float, float] = A4_MM) -> str:
    """The figures of one sheet, in words."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        grey = sheet(megapixels, pen_mm, size_mm=size_mm)
        size = f"{grey.shape[1]} x {grey.shape[0]}"
        picture, job = folder / "sheet.png", folder / "job"
        job.mkdir()
        cv2.imwrite(str(picture), grey, [cv2.IMWRITE_PNG_COMPRESSION, 1])
        del grey
        settings = load_settings(Options(device="sim", state_dir=folder / "state"))
        worker, wall_s = asked(settings, picture, job)
        report = json.loads((job / "report.json").read_text())
        stages = " ".join(f"{stage} {took_s:.1f}" for stage, took_s in report["stage_s"].items())
        return f"{size:>14}{worker[0]:>9.0f}{worker[1]:>8.1f}{wall_s:>8.1f}{report['fidelity']['f1']:>9.4f}   {stages}"


def asked(settings: Settings, picture: Path, job: Path) -> tuple[tuple[float, float], float]:
    """The worker's peak in MB and its CPU seconds, and the seconds on the wall, of one picture planned."""
    pool = Pool(settings)
    before, began_s = set(children(os.getpid())), time.monotonic()
    try:
        pool.plan(picture, job, next(iter(settings.machines)), progress=lambda stage: None)
        took_s = time.monotonic() - began_s
        (worker,) = set(children(os.getpid())) - before
        return (peak_mb(worker), cpu_s(worker)), took_s
    finally:
        pool.close()


def sheet(megapixels: float, pen_mm: float, *, size_mm: tuple[float, float] = A4_MM) -> Grey:
    """The sheet as a scanner gives it: black lines on white paper, smooth at their edges. uint8."""
    width_mm, height_mm = size_mm
    px_per_mm = math.sqrt(megapixels * 1e6 / (width_mm * height_mm))
    grey = np.full((round(height_mm * px_per_mm), round(width_mm * px_per_mm)), 255, np.uint8)
    scale = _TILE_MM * px_per_mm / 256
    thickness = max(1, round(pen_mm * px_per_mm) - 1)
    for top in np.arange(0.0, height_mm - _TILE_MM + 1, _TILE_MM):
        for left in np.arange(0.0, width_mm - _TILE_MM + 1, _TILE_MM):
            corner = np.array([left, top]) * px_per_mm
            lines = [np.rint((stroke * scale + corner) * 16).astype(np.int32) for stroke in sketch()]
            cv2.polylines(grey, lines, False, 0, thickness, cv2.LINE_AA, 4)
    return grey


def length_m(size_mm: tuple[float, float]) -> float:
    tiles = round(size_mm[0] // _TILE_MM) * round(size_mm[1] // _TILE_MM)
    px = sum(float(np.hypot(*np.diff(stroke, axis=0).T).sum()) for stroke in sketch())
    return tiles * px * _TILE_MM / 256 / 1000
