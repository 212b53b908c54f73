"""How far a drawing has come and what the machine says meanwhile, for people."""

from __future__ import annotations

import logging
from bisect import bisect_right
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from daemon.jobs.states import ink_in_words
from daemon.shapes import Program
from firmware_protocol.pens import is_pen_change
from firmware_protocol.session import Accepted, Ended, Event, Found, Paused, Resumed, Sent, Verdict, Waiting

AHEAD = 18
"""So many lines a controller acknowledges before it has drawn them: those that its planner holds."""
NOTHING_DRAWN: Mapping[str, Any] = {
    "job": "",
    "picture": "",
    "strokes_done": 0,
    "strokes_total": 0,
    "percent": 0.0,
    "seconds_left": None,
    "feed_percent": 100,
    "pen_in": "",
}
"""What the status says between two drawings."""


class Progress:
    """How far a program has come: by the clock, between what has been acknowledged and what must have been drawn.

    now: seconds on the machine's clock. Whatever is heard shows how far it is; the time of a pause is not counted.
    """

    def __init__(
        self, show: Callable[..., None], program: Program, line_times_s: Sequence[float], *, now: Callable[[], float]
    ) -> None:
        self._show, self._times_s, self._now = show, line_times_s, now
        self._line, self._begun_s, self._done_s = -1, 0.0, 0.0
        self._paused = False
        last_line = {
            line.stroke: number
            for number, line in enumerate(program.lines)
            if line.stroke is not None and not is_pen_change(line.text)
        }
        self._last_lines = [last_line[stroke] for stroke in sorted(last_line)]
        self._stroke_ends_s = [self._time_s(line) for line in self._last_lines]
        self._lines = len(program.lines)

    def hear(self, event: Event) -> None:
        if isinstance(event, Accepted):
            if self._line < 0:
                self._begun_s = self._now()
            self._line = event.line
            if not self._paused:
                # What a machine that stands takes into its buffer is no progress.
                self._show(state="drawing", words="", **self._figures(at_least=self._line - AHEAD))
        elif isinstance(event, Resumed):
            self._begun_s, self._paused = self._now() - self._done_s, False
        elif not self._paused:
            if self._line >= 0:
                whole = isinstance(event, Paused) and event.at_mm is None
                self._show(**self._figures(at_least=self._line if whole else self._line - AHEAD))
            self._paused = isinstance(event, Paused) or (isinstance(event, Waiting) and bool(event.cause))

    def _figures(self, *, at_least: int) -> dict[str, Any]:
        """at_least: the line up to which everything must have been drawn."""
        all_s, now = self._times_s[-1] if self._times_s else 0.0, self._now()
        at_least_s = self._time_s(at_least) if at_least >= 0 else 0.0
        self._done_s = min(max(now - self._begun_s, at_least_s), self._time_s(self._line))
        self._begun_s = now - self._done_s
        drawn = (self._stroke_ends_s, self._done_s) if all_s else (self._last_lines, self._line)
        return {
            "strokes_done": bisect_right(*drawn),
            "percent": round(100 * (self._done_s / all_s if all_s else (self._line + 1) / self._lines), 1),
            "seconds_left": round(all_s - self._done_s, 1),
        }

    def _time_s(self, line: int) -> float:
        """When this line will have been drawn; the end where the time model does not reach so far."""
        return self._times_s[line] if line < len(self._times_s) else (self._times_s[-1] if self._times_s else 0.0)


def tell(event: Event, *, say: Callable[..., None], show: Callable[..., None]) -> None:
    """What a person should know of at once."""
    match event:
        case Found(finding=finding, mended=mended):
            say(f"{finding.why}{' (corrected)' if mended else ''}", level=logging.WARNING, about=finding.about)
        case Waiting(why=why):
            say(why, level=logging.WARNING)
            show(state="waiting", words=why)
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
    return f"{ended.why} ({ink_in_words(strokes, ended.strokes_certain, ended.strokes_possible)}; {pen})"
