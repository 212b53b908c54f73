"""The real way of a picture through all rooms: what lies in its folder afterwards, and what a bad one leaves."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from daemon.config import Options, Settings, load_settings
from daemon.errors import NothingToDraw
from daemon.jobs.planner import measure_ink, plan_picture
from daemon.toolpath.place import place

MARKER = Path(__file__).parents[2] / "drawings" / "thick_marker.jpg"
"""So thick that the page is another size than the picture."""


@pytest.fixture(scope="module")
def settings() -> Settings:
    return load_settings(Options(device="sim"), environment={"HOME": "/nonexistent"})


@pytest.fixture(scope="module")
def planned(settings: Settings, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("planned")
    (folder / "source.jpg").write_bytes(MARKER.read_bytes())
    plan_picture(folder / "source.jpg", folder, settings, "plotter")
    return folder


def read(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text())
    return found


def test_a_planned_folder_is_complete(planned: Path) -> None:
    assert {path.name for path in planned.iterdir()} >= {
        "source.jpg", "strokes.json", "drawing.svg", "program.gcode", "preview.png", "preview.html", "explain.png",
        "report.json",
    }  # fmt: skip


def test_the_strokes_run_on_the_ink_of_the_given_picture(planned: Path) -> None:
    drawn = read(planned / "strokes.json")
    ink = np.asarray(cv2.imread(str(MARKER), cv2.IMREAD_GRAYSCALE)) < 128
    assert set(drawn) == {"width_px", "height_px", "px_per_mm", "strokes"}
    assert (drawn["height_px"], drawn["width_px"]) == ink.shape
    away_px = cv2.distanceTransform((~ink).astype(np.uint8), cv2.DIST_L2, 5)
    x, y = np.round(np.concatenate(drawn["strokes"])).astype(int).T
    assert away_px[y, x].max() < 2.0


@pytest.mark.parametrize(("shift_mm", "least", "most"), [(0.0, 0.98, 1.0), (3.0, 0.0, 0.5)])
def test_executed_ink_is_compared_with_the_given_picture(
    planned: Path, settings: Settings, shift_mm: float, least: float, most: float
) -> None:
    from_px = np.array(read(planned / "report.json")["from_px"])
    ink = [place(np.array(stroke), from_px) + shift_mm for stroke in read(planned / "strokes.json")["strokes"]]
    (planned / "ink.json").write_text(json.dumps({"strokes": [line.tolist() for line in ink]}))
    measure_ink(planned, settings, "plotter")
    report = read(planned / "report.json")
    assert report["fidelity_of"] == "executed"
    assert least <= report["fidelity"]["f1"] <= most


@pytest.mark.parametrize("level", [0, 255])
def test_a_page_that_is_black_or_white_all_over_fails_with_a_sentence_and_leaves_no_program(
    settings: Settings, tmp_path: Path, level: int
) -> None:
    cv2.imwrite(str(tmp_path / "source.png"), np.full((400, 300), level, np.uint8))
    with pytest.raises(NothingToDraw, match="300 x 400 px holds no line to draw: give a drawing"):
        plan_picture(tmp_path / "source.png", tmp_path, settings, "plotter")
    assert [path.name for path in tmp_path.iterdir()] == ["source.png"]


def test_a_hatch_is_as_fine_on_paper_as_the_settings_say(settings: Settings, tmp_path: Path) -> None:
    """A filled disc in a frame, 600 px on 60 mm."""
    grey = np.full((600, 600), 255, np.uint8)
    cv2.rectangle(grey, (10, 10), (590, 590), 0, 7)
    cv2.circle(grey, (300, 300), 180, 0, -1)
    cv2.imwrite(str(tmp_path / "source.png"), grey)
    hatch = {"fill": "hatch", "hatch_spacing_mm": 2.0, "hatch_angle_deg": 0.0}
    sheet = {"box_mm": (60.0, 60.0)}
    asked = {"planning": settings.planning.model_copy(update=hatch), "sheet": settings.sheet.model_copy(update=sheet)}
    plan_picture(tmp_path / "source.png", tmp_path, settings.model_copy(update=asked), "plotter")
    assert "1 filled area is hatched" in read(tmp_path / "report.json")["page_steps"]
    lines = [np.array(stroke) for stroke in read(tmp_path / "strokes.json")["strokes"]]
    (hatched,) = [line for line in lines if 10 < len(line) < 100 and np.abs(line - 300).max() < 180]
    rows = np.unique(hatched[:, 1].round(1))
    assert np.diff(rows) / 10 == pytest.approx(2.0, abs=0.05)


@pytest.mark.parametrize("graph", ["repaired", "paper"])
def test_a_blot_is_inked_full_whatever_becomes_of_areas(settings: Settings, tmp_path: Path, graph: str) -> None:
    """A filled disc of 8 line widths in a frame; areas are skipped, and there is none."""
    grey = np.full((300, 300), 255, np.uint8)
    cv2.rectangle(grey, (10, 10), (290, 290), 0, 5)
    cv2.circle(grey, (150, 150), 20, 0, -1)
    cv2.imwrite(str(tmp_path / "source.png"), grey)
    planning = settings.planning.model_copy(update={"fill": "skip", "graph": graph})
    plan_picture(tmp_path / "source.png", tmp_path, settings.model_copy(update={"planning": planning}), "plotter")
    strokes = read(tmp_path / "strokes.json")["strokes"]
    drawn = np.full((300, 300), 255, np.uint8)
    cv2.polylines(drawn, [np.rint(stroke).astype(np.int32) for stroke in strokes], False, 0, 5)
    assert (drawn[135:166, 140:161] < 128).mean() > 0.9
