"""One job on its way to a GRBL controller: how far it is, and how it will have ended."""

from __future__ import annotations

from collections.abc import Sequence

from firmware_protocol.grbl import flow, sentences
from firmware_protocol.grbl.flow import BARRIER, Flow
from firmware_protocol.session import Ended, JobLine, Verdict
from firmware_protocol.strokes import strokes_before, strokes_touched


class Job:
    """The lines of a job, followed by the lines that raise the pen and a dwell that waits for the last motion.

    lines: with strokes that never fall. Raises LocalProtocolError for a line that the controller cannot take.
    """

    def __init__(self, lines: Sequence[JobLine], *, lift: Sequence[str], buffer_bytes: int, counting: bool) -> None:
        self.texts = (*(line.text for line in lines), *lift, BARRIER)
        flow.check(self.texts, buffer_bytes=buffer_bytes)
        self.flow = Flow(self.texts, room_bytes=buffer_bytes if counting else None)
        self.verdict = Verdict.FINISHED
        self.position_known = True
        self.held = False
        """The motion was stopped by a feed hold: what has not been answered is not drawn."""
        self._why = sentences.FINISHED
        self._strokes = [line.stroke for line in lines]

    def __len__(self) -> int:
        return len(self._strokes)

    def doom(self, verdict: Verdict, why: str, *, position_known: bool) -> None:
        """The job will end with `verdict`; what doomed it before is still told, and a restart outlasts everything."""
        self._why = why if self.verdict is Verdict.FINISHED else f"{why}; before that: {self._why}"
        self.verdict = self.verdict if self.verdict is Verdict.RESTARTED else verdict
        self.position_known = position_known

    def ended(self, *, planner_blocks: int, lifted: bool) -> Ended:
        """The last word about this job."""
        certain, possible = self._on_paper(planner_blocks)
        return Ended(self.verdict, certain, possible, self.position_known, lifted, self._why)

    def _on_paper(self, planner_blocks: int) -> tuple[int, int]:
        if self.verdict is Verdict.FINISHED:
            return (strokes_touched(self._strokes, len(self)),) * 2
        # The line after the last answered one may be an arc of which the first segments have been planned.
        begun = self.flow.answered + 1 if self.held else self.flow.sent
        drawn = self.flow.certainly_drawn(planner_blocks=planner_blocks)
        return strokes_before(self._strokes, drawn), strokes_touched(self._strokes, begun)
