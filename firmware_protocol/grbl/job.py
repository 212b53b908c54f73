"""One job on its way to a GRBL controller: what of it has been accepted, and how it will have ended."""

from __future__ import annotations

from collections.abc import Sequence

from firmware_protocol.grbl import flow, sentences
from firmware_protocol.grbl.controller import Controller
from firmware_protocol.grbl.flow import BARRIER
from firmware_protocol.grbl.leg import Leg
from firmware_protocol.grbl.path import NOWHERE, Modal
from firmware_protocol.grbl.rest import Part
from firmware_protocol.session import Ended, JobLine, Paused, Verdict
from firmware_protocol.strokes import strokes_touched


class Job:
    """The lines of a job; each pause cuts them into another leg.

    lines: with strokes that never fall. Raises LocalProtocolError for a line that the controller cannot take.
    """

    def __init__(
        self, lines: Sequence[JobLine], *, lift: Sequence[str], controller: Controller, counting: bool
    ) -> None:
        parts = [Part(line.text, line.stroke, number) for number, line in enumerate(lines)]
        self.texts = [part.text for part in parts]
        flow.check([*self.texts, *lift, BARRIER], buffer_bytes=controller.buffer_bytes)
        start = Modal(place=controller.place_mm or NOWHERE)
        self.leg = Leg(parts, start, lift=lift, controller=controller, counting=counting)
        """The lines that are on their way now."""
        self.pausing = False
        """It is being brought to a stand, to go on later."""
        self.verdict = Verdict.FINISHED
        self.position_known = True
        self._next: Leg | None = None
        strokes = [part.stroke for part in parts]
        self._strokes = strokes_touched(strokes, len(parts))
        self._why, self._accepted = sentences.FINISHED, 0
        # A job that goes on with a drawing begins with a later stroke, maybe after a leg that has none.
        self._certain = self._possible = strokes_touched(strokes, 0)

    def accepted(self, line: int) -> int | None:
        """The job's line that the flow's `line` is, where that is acknowledged for the first time."""
        number = self.leg.named(line).number
        if number is None or number < self._accepted:
            return None
        self._accepted = number + 1
        return number

    def named(self, line: int) -> tuple[int, str]:
        """The number (from 1) and the text of the flow's `line`."""
        part = self.leg.named(line)
        return (line if part.number is None else part.number) + 1, part.text

    def doom(self, verdict: Verdict, why: str, *, position_known: bool) -> None:
        """The job will end with `verdict`; what doomed it before is still told, and a restart outlasts everything."""
        self._why = why if self.verdict is Verdict.FINISHED else f"{why}; before that: {self._why}"
        self.verdict = self.verdict if self.verdict is Verdict.RESTARTED else verdict
        self.position_known = position_known
        self.pausing = False

    def ended(self, *, lifted: bool) -> Ended:
        """The last word about this job."""
        certain, possible = self._on_paper()
        if self.verdict is Verdict.FINISHED:
            certain = possible = self._strokes
        return Ended(self.verdict, certain, possible, self.position_known, lifted, self._why)

    @property
    def certain(self) -> int:
        """The first n strokes are certainly drawn."""
        return self._on_paper()[0]

    def touched(self, *, next_too: bool) -> int:
        """No stroke from this number on was sent. next_too: nor will be by the next lines that are taken."""
        flow = self.leg.flow
        return max(self._possible, self.leg.touched(flow.reach if next_too else flow.sent))

    def pause_after_stroke(self) -> bool:
        """Let the lines end behind the running stroke; False when none is left behind it."""
        self.pausing = self.leg.end_after_stroke()
        return self.pausing

    def stands(self) -> Paused | None:
        """The pen is up; None where it is not known where the line was cut, so that the job cannot go on."""
        self._next = self.leg.next_leg()
        if self._next is None:
            return None
        self._certain, self._possible = self._on_paper()
        if not self.leg.held:
            drawn = strokes_touched([part.stroke for part in self.leg.parts], len(self.leg.parts))
            self._certain, self._possible = max(self._certain, drawn), max(self._possible, drawn)
        stroke = next((part.stroke for part in self._next.parts if part.stroke is not None), None)
        return Paused(stroke, self.leg.held_at[:2] if self.leg.held_at else None, self.leg.changes)

    def go_on(self) -> None:
        """Take up the lines that the pause has left."""
        assert self._next is not None
        self.leg, self._next, self.pausing = self._next, None, False

    def _on_paper(self) -> tuple[int, int]:
        certain, possible = self.leg.on_paper()
        return max(self._certain, certain), max(self._possible, possible)
