"""The demo reads the daemon's own files."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from daemon.config import Options, Settings, load_settings
from daemon.jobs.journal import Journal
from daemon.jobs.states import State
from daemon.report.fidelity import Fidelity
from daemon.report.report import executed_report, planned_report, to_json
from daemon.shapes import LineGraph, PageImage, Stroke, Toolpath
from daemon.toolpath.place import Layout, placement
from tests.demo import DRAWINGS, Seen, drop, line_of, main, row_of, seen_jobs

LINE = np.array([[10.0, 20.0], [110.0, 20.0]])
TO_GIVEN = np.array([[2.0, 0, 5], [0, 2, 7], [0, 0, 1]])
"""The page lies twice as large in the given picture, and not in its corner."""


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return load_settings(Options(device="sim", state_dir=tmp_path), environment={"HOME": str(tmp_path)})


def drawn_job(settings: Settings) -> Seen:
    """A job's folder as the daemon leaves it: a page of 128 x 64 px, half a millimetre a pixel in the usual box.

    The page is a part of the given picture.
    """
    folder = settings.paths.jobs / "000001-line"
    folder.mkdir(parents=True)
    grey = np.full((64, 128), 255, np.uint8)
    cv2.imwrite(str(folder / "source.png"), np.full((160, 300), 255, np.uint8))
    (folder / "strokes.json").write_text(
        json.dumps({"width_px": 300, "height_px": 160, "px_per_mm": None, "strokes": [(2 * LINE + [5, 7]).tolist()]})
    )
    # The box is 64 mm wide at (25, 25); the page fills its middle, its upper edge 16 mm below the box's.
    ink_mm = [[25 + 0.5 * 10.5, 89 - 16 - 0.5 * 20.5], [25 + 0.5 * 110.5, 89 - 16 - 0.5 * 20.5]]
    (folder / "ink.json").write_text(json.dumps({"strokes": [ink_mm]}))
    page = PageImage(grey, TO_GIVEN, 300, 160, "")
    from_px = placement(128, 64, Layout(settings.sheet.box_mm, settings.sheet.box_origin_mm))
    toolpath = Toolpath((Stroke(LINE),), from_px)
    figures = Fidelity(1.0, 0.9, 0.947, 0.8)
    planned = planned_report(
        (page, page),
        LineGraph(LINE, ()),
        toolpath,
        figures,
        line_width_px=2.0,
        estimated_s=9.0,
        stage_s={},
        peak_memory_mb=1.0,
    )
    (folder / "report.json").write_text(to_json(executed_report(planned, figures, real_s=83.0)))
    return Seen(folder.name, "line.png", State.DONE, "")


def test_jobs_are_read_while_the_journal_is_open(tmp_path: Path) -> None:
    path = tmp_path / "journal.sqlite"
    assert seen_jobs(path) == []
    journal = Journal(path)
    journal.add("000001-a", "a.png")
    journal.add("000002-b", "b.png")
    journal.step("000001-a", State.FAILED, "no line on it")
    assert seen_jobs(path) == [
        Seen("000001-a", "a.png", State.FAILED, "no line on it"),
        Seen("000002-b", "b.png", State.QUEUED, "b.png"),
    ]
    journal.close()


def test_ink_comes_back_to_the_pixels_of_the_given_picture_that_it_was_planned_from(settings: Settings) -> None:
    row = row_of(settings, drawn_job(settings))
    np.testing.assert_allclose(row.drawn[0], row.understood[0], atol=1e-9)
    assert (row.f1, row.seconds, row.line_width_px) == (0.947, 83.0, 2.0)


def test_the_line_of_a_job_tells_its_f1_and_its_time(settings: Settings) -> None:
    line = line_of(settings, drawn_job(settings))
    assert "executed f1 0.947" in line
    assert "1 min 23 s" in line


def test_a_picture_that_failed_still_has_its_row(settings: Settings) -> None:
    folder = settings.paths.jobs / "000002-text"
    folder.mkdir(parents=True)
    (folder / "source.png").write_text("no picture")
    row = row_of(settings, Seen(folder.name, "text.png", State.FAILED, "text.png is no picture: give another"))
    assert row.trouble == "text.png is no picture: give another"
    assert row.given.size > 0


def test_a_picture_is_dropped_whole(tmp_path: Path) -> None:
    picture = tmp_path / "a.png"
    picture.write_bytes(b"x" * 1000)
    drop([picture], tmp_path / "inbox")
    assert {path.name: path.stat().st_size for path in (tmp_path / "inbox").iterdir()} == {"a.png": 1000}


def test_the_daemon_draws_what_is_dropped_and_says_what_it_could_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = tmp_path / "text.png"
    bad.write_text("no picture")
    assert main([str(tmp_path / "demo"), str(DRAWINGS / "star.png"), str(bad)]) == 1
    said = capsys.readouterr().out.splitlines()
    assert sorted(line.split()[0] for line in said[:2]) == ["done", "failed"]
    assert said[-1].startswith("1 of 2 pictures drawn")
    assert cv2.imread(str(tmp_path / "demo" / "contact_sheet.png")) is not None
