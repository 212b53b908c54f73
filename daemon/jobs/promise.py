"""The promise: which strokes may come onto the sheet is durable before they can, by few writes to the disk."""

from __future__ import annotations

import time
from bisect import bisect_right
from collections.abc import Callable, Sequence

from daemon.shapes import Program

AHEAD_S = 1.0
"""One promise covers all strokes that begin within this time, so that there is about one a second at most."""
_SOON_S, _LATE_S = 0.75, 3.0
"""Promises that follow each other faster or slower than this cover more or fewer strokes: no time model is perfect."""


class Ahead:
    """Called by the link when strokes are about to be touched; promises these and some more of the same pen.

    write: makes `certain, possible` durable, or raises LinedrawError. line_times_s: when each line of the program will
    have been drawn, in s from its start; empty where nobody knows. now: a clock that only goes forward.
    """

    def __init__(
        self,
        write: Callable[[int, int], None],
        program: Program,
        line_times_s: Sequence[float],
        *,
        now: Callable[[], float] = time.monotonic,
    ) -> None:
        self._write, self._now = write, now
        self._ends = sorted({*program.passes, program.strokes})
        self._starts_s = _starts_s(program, line_times_s)
        self._more, self._at_s = 0, float("-inf")

    def __call__(self, touched: int, certain: int) -> int:
        """How many strokes are promised from now on."""
        now = self._now()
        if now - self._at_s < _SOON_S:
            self._more = 4 * self._more + 3
        elif now - self._at_s > _LATE_S:
            self._more //= 2
        # Where the pen is changed it stands for hours maybe, and nobody shall doubt what comes behind that.
        end = next((each for each in self._ends if each >= touched), touched)
        possible = min(end, max(touched + self._more, self._soon(touched)))
        self._write(certain, possible)
        self._at_s = now
        return possible

    def _soon(self, touched: int) -> int:
        """The strokes that begin within `AHEAD_S` after the last of the touched ones."""
        if not 0 < touched <= len(self._starts_s):
            return touched
        return bisect_right(self._starts_s, self._starts_s[touched - 1] + AHEAD_S)


def _starts_s(program: Program, line_times_s: Sequence[float]) -> list[float]:
    starts_s: list[float] = []
    before_s = 0.0
    for line, end_s in zip(program.lines, line_times_s, strict=False):
        if line.stroke is not None and line.stroke >= len(starts_s):
            starts_s += [before_s] * (line.stroke + 1 - len(starts_s))
        before_s = end_s
    return starts_s
