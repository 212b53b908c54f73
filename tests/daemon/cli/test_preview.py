"""`linedrawd preview`: one file, and nothing else."""

from __future__ import annotations

from pathlib import Path

import pytest

from daemon.cli.__main__ import main

HOUSE = Path(__file__).parents[2] / "drawings" / "house.png"


def test_a_preview_is_one_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "look.html"
    assert main(["preview", str(HOUSE), "-o", str(file), "--state-dir", str(tmp_path / "state")]) == 0
    assert capsys.readouterr().out == f"{HOUSE} -> {file}\n"
    html = file.read_text(encoding="utf-8")
    assert "<title>house.png</title>" in html
    assert "linedrawd approve" not in html
    assert [path.name for path in tmp_path.iterdir()] == ["look.html"]


@pytest.mark.parametrize(("picture", "words"), [("none.png", "there is no file"), (__file__, "is no picture")])
def test_what_cannot_be_shown_is_refused(picture: str, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["preview", picture, "-o", "/nonexistent/look.html"]) == 1
    assert words in capsys.readouterr().err


def test_a_file_that_cannot_be_written_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["preview", str(HOUSE), "-o", "/nonexistent/look.html"]) != 0
    assert "/nonexistent/look.html cannot be written" in capsys.readouterr().err
