"""report.json."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from daemon.report.fidelity import Fidelity
from daemon.report.places import Place
from daemon.report.report import Report, executed_report, from_json, planned_report, to_json
from daemon.shapes import Edge, LineGraph, PageImage, Stroke, Toolpath

PLANNED = Fidelity(precision=1.0, recall=0.98, f1=0.99, iou=0.9, not_drawn=(Place(3, 4, 12, 1, 9),))


def example(*, estimated_s: float = 61.25) -> Report:
    page = PageImage(np.full((120, 160), 255, np.uint8), np.eye(3), 320, 240, "ab12")
    corners = np.array([[0.0, 0.0], [30.0, 40.0]])
    graph = LineGraph(corners, (Edge(0, 1, corners, 1.0),), specks=7)
    toolpath = Toolpath((Stroke(corners),), np.eye(2, 3), park_mm=(30.0, 0.0))
    return planned_report(
        (page, page),
        graph,
        toolpath,
        PLANNED,
        line_width_px=2.5,
        estimated_s=estimated_s,
        stage_s={"decode": 0.001234567, "vision": 0.2},
        peak_memory_mb=180.5,
    )


def test_a_planned_report_counts_what_it_was_given() -> None:
    told = json.loads(to_json(example()))
    assert (told["given_width_px"], told["given_height_px"]) == (320, 240)
    assert (told["page_width_px"], told["page_height_px"]) == (160, 120)
    assert (told["vertices"], told["edges"], told["strokes"], told["specks"]) == (2, 1, 1, 7)
    assert (told["drawn_mm"], told["travelled_mm"]) == (50.0, 40.0)
    assert told["stage_s"] == {"decode": 0.0012, "vision": 0.2}


def test_the_way_to_the_machine_is_kept_to_the_last_decimal() -> None:
    from_px = [[1 / 3, 0.0, 25 + 1 / 7], [0.0, -1 / 3, 89 - 1 / 7]]
    assert from_json(to_json(replace(example(), from_px=from_px))).from_px == from_px


def test_until_it_is_drawn_fidelity_is_that_of_the_plan() -> None:
    report = example()
    assert (report.fidelity_of, report.fidelity, report.real_s) == ("planned", PLANNED, None)


def test_once_it_is_drawn_fidelity_is_that_of_the_ink() -> None:
    inked = Fidelity(0.9, 0.9, 0.9, 0.8)
    report = executed_report(example(), inked, real_s=62.0)
    assert (report.fidelity_of, report.fidelity, report.real_s) == ("executed", inked, 62.0)
    assert report.estimated_s == example().estimated_s


def test_what_is_written_is_read_back() -> None:
    report = from_json(to_json(example()))
    assert to_json(report) == to_json(example())
    assert report.fidelity == PLANNED


@pytest.mark.parametrize("text", ["[]", '{"strokes": 1}', "not json"])
def test_a_file_that_is_no_report_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"report|Expecting"):
        from_json(text)


def test_a_figure_that_is_no_number_is_never_written() -> None:
    with pytest.raises(ValueError, match="JSON"):
        to_json(example(estimated_s=math.nan))
