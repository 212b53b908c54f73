"""A program is drawn before the pictures of its plan are made; what goes wrong with these fails no job."""

from __future__ import annotations

import json
from pathlib import Path
from threading import Thread

import pytest

from tests.daemon.jobs.bench import Bench


def test_a_job_is_planned_before_the_pictures_of_its_plan_are_made(bench: Bench, tmp_path: Path) -> None:
    folder, missing = bench.desk.folders.path(bench.drop()), []
    end = bench.allotment.end

    def ended(job_id: str, *, failed: str = "") -> None:
        end(job_id, failed=failed)
        missing.append(not (folder / "whole").exists())
        (folder / "go on").touch()

    bench.allotment.end = ended  # type: ignore[method-assign]
    (folder / "source.png").write_text("waits at rest")
    bench.planning.turn()
    assert missing == [True]
    assert bench.states() == ["planned"]
    assert (folder / "whole").exists()


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("crash at rest", "the planning process was killed by SIGSEGV"),
        ("eat at rest", "planning needs more than 256 MB"),
        ("fill at rest", "No space left on device"),
    ],
)
def test_what_goes_wrong_at_rest_is_told_and_fails_no_job(bench: Bench, text: str, sentence: str) -> None:
    bench.drop(text=text)
    bench.planning.turn()
    assert bench.states() == ["planned"]
    assert "its program is whole, the pictures of its plan are not: " in bench.shown["last_error"]
    assert sentence in bench.shown["last_error"]
    bench.drawing.turn()
    bench.planned("next.png")
    assert bench.states() == ["done", "planned"]


def test_a_drawing_that_is_over_sooner_waits_with_its_report_for_the_pictures(bench: Bench) -> None:
    folder = bench.desk.folders.path(bench.drop(text="waits at rest"))
    planning = Thread(target=bench.planning.turn)
    planning.start()
    bench.wait_for(lambda: bench.states() == ["planned"])
    bench.machine.while_drawing = (folder / "go on").touch
    bench.drawing.turn()
    assert (folder / "whole").exists()
    assert json.loads((folder / "report.json").read_text())["real_s"] is not None
    planning.join()
    assert bench.states() == ["done"]
