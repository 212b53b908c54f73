"""What a simulated control does with the bytes it gets: reads blocks, answers, holds the host, stops with an alarm."""

from __future__ import annotations

from typing import Protocol

from firmware_protocol.emco.blocks import Alarm
from firmware_protocol.emco.dialects import FANUC
from firmware_protocol.emco.simulator.axes import Axes
from firmware_protocol.emco.simulator.interpreter import Interpreter
from firmware_protocol.emco.simulator.receiver import Receiver
from firmware_protocol.emco.simulator.setup import Setup
from firmware_protocol.ink import PenRule

XON, XOFF = b"\x11", b"\x13"
BAD_PARITY = 0x00
"""What stands in the buffer for a byte whose parity was wrong."""
_NEVER = float("inf")


class Say(Protocol):
    def __call__(self, data: bytes, now: float) -> None:
        """The control puts something on the wire."""


class Reading:
    """One control with its buffer and its axes. alarm_in: block that raises an alarm (from 1), 0: none."""

    def __init__(self, setup: Setup, pen: PenRule, *, alarm_in: frozenset[int], say: Say) -> None:
        self._setup, self._alarm_in, self._say = setup, alarm_in, say
        self.axes = Axes(ahead=setup.ahead, acceleration_mm_s2=setup.acceleration_mm_s2, pen=pen)
        self.receiver = Receiver(
            byte_s=1 / setup.line.bytes_per_s(setup.baud),
            buffer_bytes=setup.buffer_bytes,
            after_xoff=setup.after_xoff,
            full=lambda at_s: self._say(XOFF, at_s),
        )
        self._program: Interpreter | None = None
        self._ended = self._stalled = False
        self._start_at = self._repeat_at = _NEVER
        self.blocks = 0
        self.screen = ""

    def next_s(self) -> float:
        """When the control will next do something by itself, or a byte arrives that matters to it."""
        return min(self.receiver.next_s(), self.axes.next_s(), self._start_at, self._repeat_at)

    def step(self, now: float) -> None:
        """Do what is due at `now`."""
        self.axes.advance(now)
        if now >= self._start_at:
            self._start(now)
        self.receiver.absorb(now)
        self._read(now)
        if now >= self._repeat_at:
            self._ask(now)
        if self._ended and not self.axes.moving:
            self._finish(now)
        if self._program is not None and self._program.stopped and not self.axes.moving and self._start_at == _NEVER:
            # The operator puts another pen in and presses START.
            self._start_at = now + self._setup.start_s

    def rest(self, now: float, screen: str = "", *, start_in_s: float | None = None) -> None:
        """Stop dead and forget the program; the operator presses START again in so many seconds, or never."""
        self.axes.stop(now)
        self._close(screen)
        self._start_at = _NEVER if start_in_s is None else now + start_in_s

    def stall(self, now: float) -> None:
        """Hold the host for ever."""
        self._stalled = self.receiver.quiet = True
        if not self.receiver.held:
            self._say(XOFF, now)

    def _start(self, now: float) -> None:
        self._start_at = _NEVER
        if self._program is not None:
            self._program.stopped = False
            return
        self._program = Interpreter(self._setup.dialect, room=self._setup.room, at_mm=self.axes.position_mm(now))
        self.receiver.open = True
        if self._setup.link == "xonxoff":
            self._ask(now)
        else:
            self.receiver.quiet = True

    def _ask(self, now: float) -> None:
        """XON, and again later as long as nothing comes."""
        waits = self._program is not None and not self.blocks and not self.receiver.level
        self._repeat_at = now + self._setup.repeat_xon_s if waits and self._setup.repeat_xon_s else _NEVER
        if waits:
            self._say(XON, now)

    def _read(self, now: float) -> None:
        while self._program and not (self._program.stopped or self._stalled) and self.axes.has_room:
            block = self.receiver.next_block()
            if block is None:
                break
            self._take(block, now)
        if self.receiver.drained():
            self._say(XON, now)

    def _take(self, raw: bytes, now: float) -> None:
        assert self._program is not None
        if BAD_PARITY in raw:
            return self._refuse(now)
        self.blocks += 1
        if self.blocks in self._alarm_in:
            return self._alarm(f"alarm in block {self.blocks}")
        text = raw.decode("latin-1").rstrip("\r")
        program = self._program
        try:
            moves = program.take(text)
        except Alarm as alarm:
            return self._alarm(f"block {self.blocks}: {alarm}")
        self.axes.add(moves, now)
        if self._setup.link == "blocks":
            self._answer(self._setup.ack, now)
        if program.ended and (program.dialect is not FANUC or text.strip() == "%"):
            self._ended, self._program, self.receiver.open = True, None, False
        return None

    def _refuse(self, now: float) -> None:
        if self._setup.link == "blocks":
            self._answer(self._setup.nak, now)
        else:
            self._alarm("parity error on the serial line")

    def _answer(self, answer: bytes, now: float) -> None:
        self._say(answer + (b"\r\n" if answer.isalnum() else b""), now)

    def _alarm(self, text: str) -> None:
        """What has been read before is still executed; the host is told nothing."""
        self._close(text)

    def _finish(self, now: float) -> None:
        """M30 has been executed: the next program may come when the operator presses START."""
        self._close("")
        self._start_at = now + self._setup.start_s

    def _close(self, screen: str) -> None:
        self._program, self.blocks, self.screen = None, 0, screen
        self._ended = self._stalled = False
        self._start_at = self._repeat_at = _NEVER
        self.receiver.open = False
        self.receiver.clear()
