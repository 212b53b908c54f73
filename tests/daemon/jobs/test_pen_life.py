"""The metres of a pen are counted over jobs and restarts, and it is said when it is worn."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from daemon.jobs.pen_life import PenLife, drawn_m, lines_of
from daemon.program.svg import write_svg
from daemon.shapes import Stroke, Toolpath


class Pen:
    """A pen in a machine, and what is said of it."""

    def __init__(self, root: Path, life_m: float | None) -> None:
        self.said: list[str] = []
        self.shown: dict[str, Any] = {}
        self.life = PenLife(
            root / "pen.json", life_m, say=lambda words, **_: self.said.append(words), show=self.shown.update
        )


def job(folder: Path, *strokes_mm: list[tuple[float, float]]) -> Path:
    folder.mkdir(exist_ok=True)
    from_px = np.array([[1.0, 0, 0], [0, 1.0, 0]])
    toolpath = Toolpath(tuple(Stroke(np.array(line, float)) for line in strokes_mm), from_px, (0.0, 0.0))
    (folder / "drawing.svg").write_text(write_svg(toolpath, size_mm=(1000.0, 1000.0)))
    return folder


def test_the_strokes_of_a_job_are_read_as_they_are_drawn(tmp_path: Path) -> None:
    folder = job(tmp_path / "a", [(0, 1000), (500, 1000), (500, 0)], [(7, 8)])
    assert lines_of(folder) == [[(0, 0), (500, 0), (500, 1000)], [(7, 992), (7, 992)]]
    assert drawn_m(folder, 2) == pytest.approx(1.5)
    assert lines_of(tmp_path / "none") == []


def test_only_what_is_certainly_drawn_counts_and_is_remembered(tmp_path: Path) -> None:
    folder = job(tmp_path / "a", [(0, 0), (500, 0)], [(0, 0), (0, 1000)])
    pen = Pen(tmp_path, None)
    pen.life.drew(folder, 1)
    assert pen.shown["ink_m"] == 0.5
    again = Pen(tmp_path, None)
    again.life.drew(folder, 2)
    assert again.shown == {"ink_m": 2.0, "pen": ""}


def test_a_worn_pen_is_told_once_and_shown_until_there_is_a_new_one(tmp_path: Path) -> None:
    folder = job(tmp_path / "a", [(0, 0), (600, 0)])
    pen = Pen(tmp_path, 1.0)
    for _ in range(3):
        pen.life.drew(folder, 1)
    words = "the pen has drawn 1 m and lasts 1 m: change it, then put a file PEN into the inbox"
    assert pen.said == [words]
    assert pen.shown["pen"] == "the pen has drawn 2 m and lasts 1 m: change it, then put a file PEN into the inbox"
    assert Pen(tmp_path, 1.0).shown["pen"]
    pen.life.new()
    assert pen.shown == {"ink_m": 0.0, "pen": ""}


def test_a_file_that_is_no_count_begins_anew(tmp_path: Path) -> None:
    (tmp_path / "pen.json").write_text("[]")
    assert Pen(tmp_path, None).life.ink_m == 0.0
