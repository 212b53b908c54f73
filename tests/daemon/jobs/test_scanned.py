"""A page of the scanner is drawn in its true size, unless somebody wants otherwise."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Literal

import numpy as np
import pytest

from daemon.config import Options, load_settings
from daemon.jobs.planner import plan_picture
from tests.daemon.intake.files import tiff

WIDTH_PX, HEIGHT_PX, DPI = 240, 160, 300
RESOLUTION = {282: (5, [DPI, 1]), 283: (5, [DPI, 1]), 296: (3, [2])}
TRUE, FITTED = 25.4 / DPI, 64.0 / WIDTH_PX
"""mm a pixel."""


@pytest.mark.parametrize(
    ("name", "size", "stated", "mm_per_px"),
    [
        ("scan-20261124-125043-1.tiff", "auto", True, TRUE),
        ("cat.tiff", "auto", True, FITTED),
        ("scan-20261124-125043-1.tiff", "fit", True, FITTED),
        ("scan-20261124-125043-1.tiff", "auto", False, FITTED),
        ("cat.tiff", "true", True, TRUE),
    ],
)
def test_how_large_it_is_drawn(
    tmp_path: Path, name: str, size: Literal["auto", "fit", "true"], stated: bool, mm_per_px: float
) -> None:
    settings = load_settings(Options(device="sim"), environment={"HOME": "/nonexistent"})
    settings = settings.model_copy(update={"sheet": settings.sheet.model_copy(update={"size": size})})
    grey = np.full((HEIGHT_PX, WIDTH_PX), 255, np.uint8)
    grey[78:82, 40:200] = 0
    page = tiff(WIDTH_PX, HEIGHT_PX, grey.tobytes(), more=RESOLUTION if stated else None)  # type: ignore[arg-type]
    (tmp_path / "source.tiff").write_bytes(page)
    plan_picture(tmp_path / "source.tiff", tmp_path, settings, "plotter", name=name)
    from_px = json.loads((tmp_path / "report.json").read_text())["from_px"]
    assert from_px[0][0] == pytest.approx(mm_per_px)
