"""The ink on a simulated sheet."""

from __future__ import annotations

from firmware_protocol.ink import Ink, PenRule


def test_a_new_sheet_under_a_lowered_pen_gets_the_rest_of_the_line() -> None:
    ink = Ink(PenRule())
    ink.travel((0.0, 0.0, 0.0), (1.0, 0.0, 0.0))
    ink.clear()
    assert ink.polylines == []
    ink.travel((1.0, 0.0, 0.0), (2.0, 0.0, 0.0))
    assert ink.polylines == [[(1.0, 0.0), (2.0, 0.0)]]
