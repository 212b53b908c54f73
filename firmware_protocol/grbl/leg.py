"""The lines between two pauses of a job: how far the controller is with them, and where it can be cut."""

from __future__ import annotations

import math
from collections.abc import Sequence

from firmware_protocol.grbl.controller import ARC_TOLERANCE, Controller
from firmware_protocol.grbl.flow import BARRIER, LONGEST_LINE, SEGMENT_LINES, Flow
from firmware_protocol.grbl.path import NOWHERE, Modal, Path, Spot
from firmware_protocol.grbl.replies import Triple
from firmware_protocol.grbl.rest import Part, from_line, from_spot
from firmware_protocol.pens import is_pen_change
from firmware_protocol.strokes import strokes_before, strokes_touched


class Leg:
    """Parts of a job, followed by the lines that raise the pen and a dwell that waits for the last motion.

    start: the controller's state before the first part. counting: see `Flow`.
    """

    def __init__(
        self, parts: Sequence[Part], start: Modal, *, lift: Sequence[str], controller: Controller, counting: bool
    ) -> None:
        self.parts = list(parts)
        self._touched = _touched_by(self.parts)
        self.tail = [Part(text) for text in (*lift, BARRIER)]
        self.held_at: Triple | None = None
        self.held = False
        """The motion was stopped by a feed hold: what has not been answered is not drawn."""
        self._controller, self._lift, self._counting = controller, tuple(lift), counting
        self._numbered = "N" in controller.letters
        texts = [part.text for part in (*self.parts, *self.tail)]
        self.path = Path(texts, start, steps_mm=controller.steps_mm)
        self.flow = Flow(self._wire(texts, 0), room_bytes=controller.buffer_bytes if counting else None)
        self._later: list[Part] = []
        self._change: list[Part] = []
        """Behind its last line, and before what comes later, the pen is changed."""
        self._spots: list[Spot] = []
        self._doubted: int | None = None
        self._seen = self._sound = 0

    def named(self, line: int) -> Part:
        """The part that is sent as the flow's `line`."""
        return self.parts[line] if line < len(self.parts) else self.tail[line - len(self.parts)]

    # -- what reports tell --

    def executing(self, number: int | None) -> None:
        """A report names the line (its N) that is being executed: all before it are done."""
        if number and self._numbered:
            self._seen = max(self._seen, min(number - 1, self.flow.answered))

    def on_path(self, place: Triple) -> bool:
        """Whether a report's place lies on the lines that may be executed now."""
        first = self._done_before()
        spots = self.path.spots(place, first, self.flow.answered + 3, within_mm=self._tolerance_mm)
        if spots:
            self._sound = first
        return spots is None or bool(spots)

    def at_end(self, place: Triple) -> bool:
        """Whether the pen has come to the end of the last line, as far as anybody can know."""
        end = self.path.end.at
        return end is None or math.dist(place, end) <= self._tolerance_mm

    def hold_at(self, place: Triple | None, number: int | None) -> None:
        """The machine stands in a feed hold. number: the N of the line that it executes, where the build has it."""
        self.held, self.held_at = True, place
        self.executing(number)
        if place is not None:
            first, behind = self._done_before(), self._begun_before()
            if number and self._numbered:
                first, behind = number - 1, number
            self._spots = self.path.spots(place, first, behind, within_mm=self._tolerance_mm) or []

    # -- what is on the paper --

    def doubt_from(self, line: int) -> None:
        """What was sent from the flow's `line` on may not have been executed as it was written, or not at all."""
        self._doubted = line if self._doubted is None else min(self._doubted, line)

    def doubt_path(self) -> None:
        """The pen was off the path: only what was done at the last report on the path is beyond doubt."""
        self.doubt_from(self._sound)

    def on_paper(self) -> tuple[int, int]:
        """Strokes that are certainly drawn, and the number from which on none has been touched."""
        done, begun = self._done_before(), self._begun_before()
        if self._spots:
            done, begun = max(done, self._spots[0].line), min(begun, self._spots[-1].line + 1)
        if self._doubted is not None:
            done = min(done, self._doubted)
        strokes = [part.stroke for part in self.parts]
        return strokes_before(strokes, done), strokes_touched(strokes, begun)

    def touched(self, lines: int) -> int:
        """No stroke from this number on has a part among the first `lines` of the flow."""
        return self._touched[min(lines, len(self.parts))]

    # -- how it is cut --

    @property
    def changes(self) -> bool:
        """The pen is changed where it ends."""
        return bool(self._change) and not self.held

    def end_before_change(self) -> None:
        """Let it end where the pen is changed, if it is."""
        end = next((number for number, part in enumerate(self.parts) if is_pen_change(part.text)), None)
        if end is not None:
            change = self.parts[end]
            self._end_before(end, behind=end + 1)
            self._change = [change]

    def end_after_stroke(self) -> bool:
        """Let it end behind the last stroke of which a line was sent; False when nothing is left behind that."""
        sent = self.flow.sent
        stroke = self.parts[sent - 1].stroke if 0 < sent <= len(self.parts) else None
        ends = (n for n in range(sent, len(self.parts)) if stroke is None or self.parts[n].stroke != stroke)
        end = next(ends, None)
        if end is None:
            return False
        self._end_before(end, behind=end)
        return True

    def _end_before(self, end: int, *, behind: int) -> None:
        """behind: the part with which what comes later begins."""
        texts = [part.text for part in self.tail]
        lifted = self._state_after(texts, self.path.steps[end].before)
        rest = from_line(self.parts, self.path, behind, lifted=lifted)
        self._later, self._change = [*rest, *self._change, *self._later], []
        del self.parts[end:]
        self.path.replace_from(end, texts)
        self.flow.replace_from(end, self._wire(texts, end))

    def next_leg(self) -> Leg | None:
        """What is left of the job, now that the pen is up; None where the place of a cut is not known."""
        if not self.held:
            return self._leg(self._later, self.path.end)
        lifted = self._state_after(self._lift, Modal(place=self.held_at or NOWHERE))
        if not self._spots and self.flow.sent:
            return None
        if not self.flow.sent:
            left = from_line(self.parts, self.path, 0, lifted=lifted)
        elif self._spots[0].line < len(self.parts):
            left = from_spot(self.parts, self.path, self._spots[0], lifted=lifted)
        else:
            return self._leg([*self._change, *self._later], lifted)
        return self._leg([*left, *(self.tail if self._later else []), *self._change, *self._later], lifted)

    def _leg(self, parts: Sequence[Part], start: Modal) -> Leg:
        return Leg(parts, start, lift=self._lift, controller=self._controller, counting=self._counting)

    def _state_after(self, texts: Sequence[str], start: Modal) -> Modal:
        return Path(texts, start, steps_mm=self._controller.steps_mm).end

    def _wire(self, texts: Sequence[str], first: int) -> list[str]:
        """The lines with their numbers, where the controller reports which one it executes."""
        if not self._numbered:
            return list(texts)
        numbered = [(text, f"N{number}{text}") for number, text in enumerate(texts, first + 1)]
        return [text if text.startswith("$") or len(long) > LONGEST_LINE else long for text, long in numbered]

    @property
    def _tolerance_mm(self) -> float:
        """Reports are exact to a motor step; the rest is rounding, and the chords of arcs."""
        return 0.02 + 1.5 / min(self._controller.steps_mm) + self._controller.settings.get(ARC_TOLERANCE, 0.002)

    def _done_before(self) -> int:
        """All lines before this one have been executed, if all came as they were sent."""
        waiting = self._controller.planner_blocks + SEGMENT_LINES
        return max(self.flow.drawn, self._seen, self.path.back_from(self.flow.answered, waiting))

    def _begun_before(self) -> int:
        """No line from this one on has been begun.

        The line after the last answered one may be an arc of which the first segments have been planned.
        """
        if not self.held or self._doubted is not None:
            return self.flow.sent
        return min(self.flow.answered + 1, self.flow.sent)


def _touched_by(parts: Sequence[Part]) -> list[int]:
    """For each number of parts, from none on: the stroke from which on none of them belongs to any."""
    before = [next((part.stroke for part in parts if part.stroke is not None), 0)]
    for part in parts:
        before.append(before[-1] if part.stroke is None else part.stroke + 1)
    return before
