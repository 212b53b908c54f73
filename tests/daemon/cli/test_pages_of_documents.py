"""`--page N` of draw, plan and preview: one page of a document."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from daemon.cli.__main__ import main
from tests.daemon.intake.vector.pdfs import pdf

SHORT, LONG = "10 20 m 30 20 l S", "10 20 m 60 20 l S 10 40 m 60 40 l S"


@pytest.fixture
def book(tmp_path: Path) -> Path:
    path = tmp_path / "book.pdf"
    path.write_bytes(pdf([SHORT, LONG, ""]))
    return path


def strokes_in(folder: Path) -> int:
    return len(json.loads((folder / "strokes.json").read_text())["strokes"])


def test_the_page_that_is_said_is_planned_into_a_folder_of_its_own(book: Path, tmp_path: Path) -> None:
    assert main(["plan", str(book), "--page", "2", "-o", str(tmp_path / "plans")]) == 0
    assert strokes_in(tmp_path / "plans" / "book-page-2") == 2


def test_where_none_is_said_the_first_is_taken_and_the_others_are_told_of(
    book: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["plan", str(book), "-o", str(tmp_path / "plans")]) == 0
    assert strokes_in(tmp_path / "plans" / "book") == 1
    assert f"{book} has 3 pages, the first is taken: --page N takes another" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("page", "words"),
    [
        ("4", "has 3 pages, there is no page 4"),
        ("0", "pages are counted from 1: give --page 1 or more"),
        ("3", "holds no line to draw"),
    ],
)
def test_a_page_that_is_not_there_or_empty_is_refused(
    book: Path, page: str, words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["preview", str(book), "--page", page, "-o", "/nonexistent/look.html"]) != 0
    assert words in capsys.readouterr().err


def test_the_page_that_is_said_is_drawn(book: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    state = tmp_path / "state"
    said = ["draw", str(book), "--page", "2", "--device", "sim", "--port", "sim://grbl?speed=0"]
    assert main([*said, "--state-dir", str(state), "--log-dir", str(tmp_path / "log")]) == 0
    (folder,) = (state / "jobs").iterdir()
    assert strokes_in(folder) == 2
    assert json.loads((folder / "job.json").read_text())["name"] == "book.pdf page 2"
