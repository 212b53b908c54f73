"""The gallery shows its inputs, and its page is the one that the last run has written."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from daemon.report.contact_sheet import Row
from tests.gallery import sheets
from tests.gallery.__main__ import page
from tests.gallery.inputs import Input, kinds

DOCS = Path(__file__).parents[2] / "docs"
EVERY = [each for inputs in kinds().values() for each in inputs]


def told(row: Row, given: Input, *warnings: str) -> str:
    """The line of the page on which one input is told."""
    others = {each.file: Row(each.file, row.given, [], []) for each in EVERY}
    text = page(others | {given.file: row}, dict.fromkeys(others, ()) | {given.file: warnings})
    (line,) = (line for line in text.splitlines() if line.startswith(f"| `{given.file}`"))
    return line


def test_thirty_inputs_of_ten_kinds_are_told_apart() -> None:
    assert len({each.file for each in EVERY}) == len(EVERY) >= 30
    assert len(kinds()) >= 10


def test_the_page_in_the_documentation_shows_every_input_and_every_sheet() -> None:
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    told = [line.split("`")[1] for line in text.splitlines() if line.startswith("| `")]
    shown = [part.split(")")[0] for part in text.split("](gallery/")[1:]]
    assert told == [each.file for each in EVERY]
    assert sorted(shown) == sorted(path.name for path in (DOCS / "gallery").iterdir())


def test_what_is_refused_and_what_is_warned_of_stand_beside_what_it_is() -> None:
    picture = np.zeros((4, 4, 3), np.uint8)
    refused = told(Row("a", picture, [], [], trouble="it is black: give another"), EVERY[0])
    warned = told(Row("a", picture, [np.zeros((1, 2))], [], f1=0.98765, seconds=61.0), EVERY[0], "it is grey")
    assert refused == f"| `{EVERY[0].file}` | {EVERY[0].words} **Refused:** it is black: give another. | – | – | – |"
    assert warned == f"| `{EVERY[0].file}` | {EVERY[0].words} *Warned: it is grey.* | 1 | 0.988 | 1 min 01 s |"


@pytest.mark.parametrize("made", [sheets.colours, sheets.hills, sheets.music, sheets.furry])
def test_a_sheet_that_is_made_is_the_same_each_time(made: Callable[[], NDArray[np.uint8]]) -> None:
    assert (made() == made()).all()
