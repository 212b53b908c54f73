"""How far a drawing has come and what the machine says meanwhile, for people."""

from __future__ import annotations

import logging
from bisect import bisect_right
from collections.abc import Callable, Sequence

from daemon.shapes import Program
from firmware_protocol.session import Ended, Event, Found, Paused, Sent, Verdict, Waiting

AHEAD = 18
"""So many lines a controller acknowledges before it has drawn them: those that its planner holds."""


class Progress:
    """How far a program has come: by the clock, between what has been acknowledged and what must have been drawn.

    now: seconds on the machine's clock. A pause is time in which nothing was acknowledged, so it is not counted.
    """

    def __init__(
        self, show: Callable[..., None], program: Program, line_times_s: Sequence[float], *, now: Callable[[], float]
    ) -> None:
        self._show, self._times_s, self._now = show, line_times_s, now
        self._begun_s: float | None = None
        last_line = {line.stroke: number for number, line in enumerate(program.lines) if line.stroke is not None}
        self._last_lines = [last_line[stroke] for stroke in sorted(last_line)]
        self._lines = len(program.lines)

    def accepted(self, line: int) -> None:
        all_s = self._times_s[-1] if self._times_s else 0.0
        done_s = self._done_s(line, all_s)
        self._show(
            state="drawing",
            words="",
            strokes_done=bisect_right(self._last_lines, line),
            percent=round(100 * (done_s / all_s if all_s else (line + 1) / self._lines), 1),
            seconds_left=round(all_s - done_s, 1),
        )

    def _done_s(self, line: int, all_s: float) -> float:
        now = self._now()
        if self._begun_s is None:
            self._begun_s = now
        at_most_s = self._times_s[line] if line < len(self._times_s) else all_s
        at_least_s = self._times_s[line - AHEAD] if 0 <= line - AHEAD < len(self._times_s) else 0.0
        done_s = min(max(now - self._begun_s, at_least_s), at_most_s)
        self._begun_s = now - done_s
        return done_s


def tell(event: Event, *, say: Callable[..., None], show: Callable[..., None]) -> None:
    """What a person should know of at once."""
    match event:
        case Found(finding=finding, mended=mended):
            say(f"{finding.why}{' (corrected)' if mended else ''}", level=logging.WARNING, about=finding.about)
        case Waiting(why=why):
            say(why, level=logging.WARNING)
            show(state="waiting", words=why)
        case Paused(stroke=stroke):
            say("paused, the pen is up", stroke=stroke)
            show(state="paused", words="`linedrawd resume` goes on, `linedrawd stop` ends it")
        case Sent(drawn_in_s=seconds):
            say("everything has been sent", drawn_in_s=seconds)
            show(words="everything has been sent, when it is drawn is an estimate", seconds_left=round(seconds, 1))


def end_in_words(ended: Ended, strokes: int) -> str:
    """The last word about a job."""
    if ended.verdict is Verdict.FINISHED:
        if ended.estimated:
            return f"all {strokes} strokes were sent and, by the time model, are drawn: the machine does not say so"
        return f"all {strokes} strokes are drawn"
    pen = "the pen is up" if ended.pen_lifted else "the pen may be down"
    return (
        f"{ended.why} (of {strokes} strokes {ended.strokes_certain} are certainly drawn, none after the first "
        f"{ended.strokes_possible} is touched; {pen})"
    )
