"""One job on its way to an arm: which lines were sent, taken and executed, and how it will have ended."""

from __future__ import annotations

from collections.abc import Sequence

from firmware_protocol.dobot import sentences
from firmware_protocol.dobot.commands import Command, parse
from firmware_protocol.errors import LocalProtocolError
from firmware_protocol.pens import is_pen_change
from firmware_protocol.session import Ended, JobLine, Verdict
from firmware_protocol.strokes import strokes_before, strokes_touched


class Job:
    """lines: commands as text, with strokes that never fall.

    Raises LocalProtocolError for a line that is no command for the queue.
    """

    def __init__(self, lines: Sequence[JobLine]) -> None:
        self.commands = [_command(number, line.text) for number, line in enumerate(lines, 1)]
        self._texts = [line.text for line in lines]
        # A pen change belongs to no stroke: the one before it is whole without.
        self._strokes = [None if is_pen_change(line.text) else line.stroke for line in lines]
        self.taken = 0
        """Lines in the arm's queue or behind it."""
        self.in_flight = False
        """The next line has been sent and not been acknowledged."""
        self.executed = 0
        self.begun = 0
        """No line from this number on has ever been begun."""
        self.stop_before: int | None = None
        """The line before which the arm is to stand still."""
        self._verdict, self._why = Verdict.FINISHED, sentences.FINISHED
        self._position_known = True

    def __len__(self) -> int:
        return len(self.commands)

    @property
    def fed(self) -> bool:
        """Nothing more is to be sent before something else happens."""
        return self.taken == len(self) or self.taken == self.stop_before

    def text(self, line: int) -> str:
        """The line as it was given."""
        return self._texts[line]

    def stroke(self, line: int) -> int | None:
        """The stroke that is drawn from this line on; None where none is left."""
        return next((stroke for stroke in self._strokes[line:] if stroke is not None), None)

    def stop_at_stroke_end(self) -> None:
        """Stand still where the stroke ends that has been fed last."""
        line = self.taken + self.in_flight
        while 0 < line < len(self) and self._strokes[line] == self._strokes[line - 1]:
            line += 1
        self.stop_before = line if self.stop_before is None else min(line, self.stop_before)

    def stop_at_pen_change(self) -> None:
        """Stand still before the next line that wants another pen, behind the one at which it stands."""
        rest = range(self.taken + 1, len(self))
        self.stop_before = next((line for line in rest if is_pen_change(self._texts[line])), None)

    @property
    def changes(self) -> bool:
        """The pen is changed before the next line."""
        return self.taken < len(self) and is_pen_change(self._texts[self.taken])

    def executes(self, lines: int) -> None:
        """So many lines are executed."""
        self.executed = max(self.executed, min(lines, self.taken))

    def sends(self) -> None:
        """The next line goes out; from now on it may be drawn."""
        self.in_flight = True
        self.begun = max(self.begun, self.taken + 1)

    def takes(self) -> None:
        """The line that was sent is in the queue."""
        self.taken, self.in_flight = self.taken + 1, False

    def rewind(self, line: int) -> None:
        """The arm's queue was emptied: everything from `line` on is sent again."""
        self.executed = min(self.executed, line)
        self.taken, self.in_flight, self.stop_before = line, False, None

    def stopped_behind(self, line: int) -> None:
        """Nothing from `line` on was begun: the queue was emptied before."""
        self.begun = min(self.begun, line)

    def doom(self, verdict: Verdict, why: str, *, position_known: bool) -> None:
        """The job will end with `verdict`; what doomed it before is still told."""
        first = self._verdict is Verdict.FINISHED
        self._why = why if first else f"{why}; before that: {self._why}"
        self._verdict, self._position_known = verdict, position_known

    @property
    def certain(self) -> int:
        """The first n strokes are certainly drawn."""
        return strokes_before(self._strokes, self.executed)

    @property
    def touched(self) -> int:
        """No stroke from this number on has been begun."""
        return strokes_touched(self._strokes, self.begun)

    @property
    def verdict(self) -> Verdict:
        """How it will have ended."""
        return self._verdict

    def ended(self, *, lifted: bool) -> Ended:
        """The last word about this job."""
        if self._verdict is Verdict.FINISHED:
            certain = possible = strokes_touched(self._strokes, len(self))
        else:
            certain, possible = self.certain, max(self.certain, self.touched)
        return Ended(self._verdict, certain, possible, self._position_known, lifted, self._why)


def _command(number: int, text: str) -> Command:
    try:
        command = parse(text)
    except LocalProtocolError as fault:
        raise LocalProtocolError(f"line {number}: {fault}") from fault
    if not command.kind.queued:
        raise LocalProtocolError(f"line {number} ({text!r}) does not go into the arm's queue: leave it out")
    return command
