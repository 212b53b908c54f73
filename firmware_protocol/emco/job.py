"""One program on its way to a control that does not say what it has drawn: what it has, and what follows from that."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Callable, Sequence
from itertools import accumulate, pairwise
from typing import TypeAlias

from firmware_protocol.errors import LocalProtocolError, ProtocolError
from firmware_protocol.pens import is_pen_change
from firmware_protocol.session import Ended, JobLine, Verdict
from firmware_protocol.strokes import strokes_before, strokes_touched

Times: TypeAlias = Callable[[Sequence[str]], Sequence[float]]
"""When each line of a program will have been drawn, in s from its start; `motion.line_times_s` is one."""

FASTEST = 4.0
"""A control is at most this many times as fast as the time model: no stops at bends, a feed override."""

_PLAIN = re.compile(r"[ -~]*")


class Job:
    """lines: with strokes that never fall. Raises LocalProtocolError for a line that is no plain text, or that the
    time model cannot read.
    """

    def __init__(self, lines: Sequence[JobLine], *, times: Times, line_end: bytes) -> None:
        texts = [line.text for line in lines]
        self._seconds = _seconds(texts, times)
        self._strokes = [line.stroke for line in lines]
        self._line_end = line_end
        self.blocks = [text.encode("ascii") + line_end for text in texts]
        self._ends = list(accumulate(map(len, self.blocks)))
        self._rest = b""
        self._earliest: list[float] = []
        self._cut = len(texts)
        self._stops = [number for number, text in enumerate(texts, 1) if is_pen_change(text)]
        """Behind so many blocks nothing is sent before the pen has been changed."""
        self.begun = 0
        """Blocks of which at least a byte has been handed over."""
        self.handed = 0
        """Whole blocks handed over."""
        self.proven = 0
        """Blocks that the control has certainly executed."""
        self.sent_bytes = 0
        self.drawn_at = float("-inf")
        """When all that has been handed over will have been drawn, by the time model."""

    def __len__(self) -> int:
        """Blocks of the program that will have been handed over, those behind a cut not counted."""
        return self._cut

    @property
    def empty(self) -> bool:
        """Nothing is left to hand over."""
        return self.begun == len(self.blocks) and not self._rest

    @property
    def changes(self) -> bool:
        """The pen is changed before anything more is handed over."""
        return bool(self._stops) and self.begun == self._stops[0] and not self._rest

    @property
    def next_stroke(self) -> int | None:
        """The stroke that the next block belongs to."""
        return self._strokes[self.begun]

    def go_on(self) -> None:
        """The pen has been changed."""
        del self._stops[0]

    def text(self, block: int) -> str:
        return self.blocks[block].decode("ascii").rstrip()

    def seconds(self, block: int) -> float:
        """How long the control moves for this block."""
        return self._seconds[block] if block < self._cut else 0.0

    @property
    def certain(self) -> int:
        """The first n strokes are certainly drawn."""
        return strokes_before(self._strokes, min(self.proven, self._cut))

    def touched(self, *, most: int) -> int:
        """No stroke from this number on was taken, nor will be with the next `most` bytes."""
        block, left = self.begun, most - len(self._rest)
        while left > 0 and block < (self._stops or [len(self.blocks)])[0]:
            left -= len(self.blocks[block])
            block += 1
        return strokes_touched(self._strokes, min(block, self._cut))

    def take(self, most: int) -> bytes:
        """The next `most` bytes at most, to be written now."""
        taken = b""
        while len(taken) < most and not (self.empty or self.changes):
            if not self._rest:
                self._rest = self.blocks[self.begun]
                self.begun += 1
            part = self._rest[: most - len(taken)]
            self._rest = self._rest[len(part) :]
            taken += part
        self.sent_bytes += len(taken)
        return taken

    def arrived(self, at: float) -> None:
        """All that has been taken has reached the control at the time `at`."""
        for block in range(self.handed, self.begun - bool(self._rest)):
            before = self._earliest[-1] if self._earliest else at
            self._earliest.append(max(before, at) + self.seconds(block) / FASTEST)
            self.drawn_at = max(self.drawn_at, at) + self.seconds(block)
            self.handed += 1

    def held_by_control(self, now: float) -> int:
        """Bytes that a control which works must still hold, however fast it is."""
        drawn = bisect_right(self._earliest, now)
        return self.sent_bytes - (self._ends[drawn - 1] if drawn else 0)

    def prove(self, *, bytes_held: int) -> None:
        """The control lives: all but the last `bytes_held` bytes must have been executed."""
        self.proven = max(self.proven, bisect_right(self._ends, self.sent_bytes - bytes_held))

    def close(self, texts: Sequence[str]) -> None:
        """What has not begun is replaced by these lines, of which none is a stroke's."""
        self._cut, self._stops = self.begun, []
        self.blocks[self.begun :] = [text.encode("ascii") + self._line_end for text in texts]
        self._ends = list(accumulate(map(len, self.blocks)))

    def ended(self, verdict: Verdict, why: str, *, estimated: bool = False) -> Ended:
        """Certain is what has been proven. estimated: by the time model all that was handed over is drawn."""
        possible = strokes_touched(self._strokes, min(self.begun, self._cut))
        return Ended(
            verdict, min(self.certain, possible), possible,
            position_known=estimated, pen_lifted=estimated, why=why, estimated=estimated,
        )  # fmt: skip

    def untouched(self, why: str) -> Ended:
        """Stopped before a byte was handed over."""
        none = strokes_touched(self._strokes, 0)
        return Ended(Verdict.STOPPED, none, none, position_known=True, pen_lifted=False, why=why)


def check_plain(texts: Sequence[str]) -> None:
    """Raises LocalProtocolError for a line with anything but printable ASCII: control characters steer the link."""
    for number, text in enumerate(texts, 1):
        if not _PLAIN.fullmatch(text):
            raise LocalProtocolError(f"line {number} ({text[:60]!r}) is no plain text: remove what is not ASCII")


def _seconds(texts: Sequence[str], times: Times) -> list[float]:
    check_plain(texts)
    try:
        ends = list(times(texts))
    except ProtocolError as error:
        raise LocalProtocolError(f"the program is none for an EMCO control: {error}") from error
    if len(ends) != len(texts):
        raise LocalProtocolError(f"the time model knows {len(ends)} of {len(texts)} lines: plan the drawing again")
    return [after - before for before, after in pairwise([0.0, *ends])]
