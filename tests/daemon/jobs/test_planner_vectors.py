"""A vector file on its way through the rooms: true size, no network, every line of it, nothing twice."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from daemon.config import Options, Settings, load_settings
from daemon.errors import NothingToDraw, OutOfReach
from daemon.jobs import planner
from daemon.jobs.arrival import ARRIVAL_NAME, Arrival
from daemon.jobs.planner import measure_ink, plan_picture
from tests.daemon.intake.vector.pdfs import pdf

SHAPES = Path(__file__).parents[2] / "drawings" / "shapes.svg"


@pytest.fixture(scope="module")
def settings() -> Settings:
    return load_settings(Options(device="sim"), environment={"HOME": "/nonexistent"})


@pytest.fixture(scope="module")
def planned(settings: Settings, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("planned")
    (folder / "source.svg").write_bytes(SHAPES.read_bytes())
    stages: list[str] = []
    plan_picture(folder / "source.svg", folder, settings, "plotter", progress=stages.append)
    assert stages == ["decode", "toolpath", "program", "report"]
    return folder


def read(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text())
    return found


def test_a_folder_of_a_vector_file_is_complete(planned: Path) -> None:
    assert {path.name for path in planned.iterdir()} >= {
        "strokes.json", "drawing.svg", "program.gcode", "preview.png", "explain.png", "report.json",
    }  # fmt: skip


def test_all_lines_of_the_file_are_drawn_and_none_besides(planned: Path) -> None:
    report = read(planned / "report.json")
    assert report["fidelity"]["f1"] > 0.995
    assert report["fidelity"]["iou"] > 0.9
    assert report["warnings"] == ["1 white shape is left out"]


def test_it_is_drawn_as_large_as_it_says(planned: Path) -> None:
    report, drawn = read(planned / "report.json"), read(planned / "strokes.json")
    mm_per_px = report["from_px"][0][0]
    assert mm_per_px * drawn["px_per_mm"] == pytest.approx(1)
    assert (report["page_width_px"] * mm_per_px, report["page_height_px"] * mm_per_px) == pytest.approx(
        (60, 50), abs=0.1
    )


def test_sides_that_two_rectangles_share_are_drawn_once(planned: Path) -> None:
    drawn = read(planned / "strokes.json")
    sides = [side for stroke in drawn["strokes"] for side in pairwise(np.array(stroke) / drawn["px_per_mm"])]
    shared = [(a, b) for a, b in sides if np.allclose([a[0], b[0]], 35, atol=0.1) and abs(a[1] - b[1]) > 9]
    assert len(shared) == 1


def test_the_ink_of_a_simulated_machine_is_compared_with_the_lines_of_the_file(
    planned: Path, settings: Settings
) -> None:
    report = read(planned / "report.json")
    from_px = np.array(report["from_px"])
    strokes = [np.array(stroke) for stroke in read(planned / "strokes.json")["strokes"]]
    (planned / "ink.json").write_text(
        json.dumps({"strokes": [planner.place(stroke, from_px).tolist() for stroke in strokes]})
    )
    measure_ink(planned, settings, "plotter")
    assert read(planned / "report.json")["fidelity_of"] == "executed"
    assert read(planned / "report.json")["fidelity"]["f1"] > 0.99


def test_a_file_that_says_no_size_fills_the_box(settings: Settings, tmp_path: Path) -> None:
    (tmp_path / "source.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><path stroke="red" d="M0 0L9 9"/></svg>'
    )
    plan_picture(tmp_path / "source.svg", tmp_path, settings, "plotter")
    report = read(tmp_path / "report.json")
    assert report["page_width_px"] * report["from_px"][0][0] == pytest.approx(settings.sheet.box_mm[0])


def test_what_is_too_large_for_the_machine_or_empty_fails_with_a_sentence(settings: Settings, tmp_path: Path) -> None:
    head = '<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="2000mm">'
    (tmp_path / "source.svg").write_text(head + '<path stroke="red" d="M0 0h7000"/></svg>')
    with pytest.raises(OutOfReach):
        plan_picture(tmp_path / "source.svg", tmp_path, settings, "plotter")
    (tmp_path / "source.svg").write_text(head + "</svg>")
    with pytest.raises(NothingToDraw, match="holds no line to draw"):
        plan_picture(tmp_path / "source.svg", tmp_path, settings, "plotter")
    assert not (tmp_path / "program.gcode").exists()


def test_the_page_of_the_job_is_planned_and_measured(settings: Settings, tmp_path: Path) -> None:
    book = pdf(["10 20 m 60 20 l S", "10 20 m 60 120 l S"])
    (tmp_path / "source.pdf").write_bytes(book)
    (tmp_path / ARRIVAL_NAME).write_bytes(Arrival("a.pdf", "", 1, pages=2, page=2).encoded())
    plan_picture(tmp_path / "source.pdf", tmp_path, settings, "plotter", name="a.pdf page 2")
    report, drawn = read(tmp_path / "report.json"), read(tmp_path / "strokes.json")
    ends = np.array(sorted(drawn["strokes"][0])) / drawn["px_per_mm"] * 72 / 25.4
    assert ends.round().tolist() == [[10, 124], [60, 24]]
    assert report["fidelity"]["f1"] > 0.99
    from_px = np.array(report["from_px"])
    strokes = [planner.place(np.array(stroke), from_px).tolist() for stroke in drawn["strokes"]]
    (tmp_path / "ink.json").write_text(json.dumps({"strokes": strokes}))
    measure_ink(tmp_path, settings, "plotter")
    assert read(tmp_path / "report.json")["fidelity"]["f1"] > 0.99
