"""Lines counted into the controller's receive buffer, one answer a line, and what the answers say about the paper."""

from __future__ import annotations

import re
from collections.abc import Sequence

from firmware_protocol.errors import LocalProtocolError

BARRIER = "G4 P0.01"
"""A dwell is answered only after every motion before it has ended."""

LONGEST_LINE = 79
"""From 80 characters on GRBL answers error:11."""

SEGMENT_LINES = 6
"""Moves whose steps may still wait behind the planner (its segment buffer), one of them answered by a reset."""

_ALONE = re.compile(r"(?:N\d+)?(?:\$|G0*10(?!\d)|G(?:28|30)\.1)")
"""A `$` command wants the controller idle, and storing a value makes it deaf for some ms: nothing is sent behind it."""
_BARRIERS = re.compile(r"G0*4(?![\d.])|M0*[02](?!\d)|M30(?!\d)")
_DWELL = re.compile(r"G0*4P(\d+(?:\.\d*)?)")
_FORBIDDEN = re.compile(r"[^ -~]|[?!~();]")
"""Real-time characters act in the middle of a line and inside comments, so neither is ever sent."""


class Flow:
    """The lines of one task on their way; never more bytes unanswered than the controller can hold.

    room_bytes: the controller's receive buffer; None sends the next line only after the answer to the one before.
    """

    def __init__(self, texts: Sequence[str], *, room_bytes: int | None) -> None:
        self._lines: list[bytes] = []
        self._room_bytes = room_bytes
        self._alone: set[int] = set()
        self._barriers: set[int] = set()
        self._owed_bytes = 0
        self.synced = 0
        """Up to this line answers and lines are known to belong together: all was answered, or `prove` has shown it."""
        self.sent = 0
        self.answered = 0
        self.drawn = 0
        """All lines before this one have been executed, not only planned: a barrier behind them has been passed."""
        self.replace_from(0, texts)

    @property
    def done(self) -> bool:
        """Every line has been answered."""
        return self.answered == len(self._lines)

    @property
    def owed(self) -> int:
        """Lines sent and not answered."""
        return self.sent - self.answered

    @property
    def homing(self) -> bool:
        """The controller is busy with `$H`, in which it answers nothing, not even `?`."""
        return self.owed > 0 and self._lines[self.answered].startswith(b"$H")

    @property
    def dwell_s(self) -> float:
        """Seconds that the unanswered lines ask the controller to wait."""
        owed = b"".join(self._lines[self.answered : self.sent]).decode("ascii").replace(" ", "").upper()
        return sum(float(seconds) for seconds in _DWELL.findall(owed))

    @property
    def reach(self) -> int:
        """The line before which the next `take` ends."""
        line, owed_bytes = self.sent, self._owed_bytes
        while line < len(self._lines) and self._fits(line, owed_bytes):
            owed_bytes += len(self._lines[line])
            line += 1
        return line

    def text(self, line: int) -> str:
        """The line as it is sent."""
        return self._lines[line].decode("ascii").rstrip()

    def take(self) -> bytes:
        """The next lines that fit, to be written now."""
        taken = b"".join(self._lines[self.sent : self.reach])
        self.sent, self._owed_bytes = self.reach, self._owed_bytes + len(taken)
        return taken

    def answer(self) -> int | None:
        """The number of the line that an answer belongs to; None when no answer is owed."""
        if not self.owed:
            return None
        line = self.answered
        self._owed_bytes -= len(self._lines[line])
        self.answered += 1
        # A reset in a dwell answers the dwell without executing it; an answer to the line behind is proof.
        if line - 1 in self._barriers:
            self.drawn = line
        if not self.owed:
            self.synced = self.answered
        return line

    def prove(self, ring_bytes: int) -> None:
        """A report made while the planner was full counts so many bytes in the receive buffer.

        The controller then holds the oldest unanswered line in hand and the others in the buffer: where that adds up,
        no answer and no line end has been lost so far.
        """
        if self.owed > 1 and ring_bytes == self._owed_bytes - len(self._lines[self.answered]):
            self.synced = self.answered

    def replace_from(self, line: int, texts: Sequence[str]) -> None:
        """From `line` on, which has not been sent, other lines follow."""
        del self._lines[line:]
        self._alone = {index for index in self._alone if index < line}
        self._barriers = {index for index in self._barriers if index < line}
        for index, text in enumerate(texts, line):
            plain = text.replace(" ", "").upper()
            self._lines.append(text.encode("ascii") + b"\n")
            if _ALONE.match(plain):
                self._alone.add(index)
            if _BARRIERS.search(plain):
                self._barriers.add(index)

    def _fits(self, line: int, owed_bytes: int) -> bool:
        if line == self.answered:
            return True
        if self._room_bytes is None or line in self._alone or line - 1 in self._alone:
            return False
        return owed_bytes + len(self._lines[line]) <= self._room_bytes


def check(texts: Sequence[str], *, buffer_bytes: int) -> None:
    """Raises LocalProtocolError for a line that this controller cannot take as it stands."""
    moved = False
    for number, text in enumerate(texts, 1):
        if fault := _fault(text, min(LONGEST_LINE, buffer_bytes - 1)):
            raise LocalProtocolError(f"line {number} ({text[:60]!r}) {fault}")
        if moved and text.lstrip().startswith("$"):
            raise LocalProtocolError(
                f"line {number} ({text!r}) is refused by a moving machine: put it before the G-code"
            )
        moved = moved or not text.lstrip().startswith("$")


def _fault(text: str, longest: int) -> str:
    if _FORBIDDEN.search(text):
        return "holds a comment, a control or a real-time character: remove it"
    if len(text) > longest:
        return f"is longer than the {longest} characters that the controller takes: shorten it"
    return ""
