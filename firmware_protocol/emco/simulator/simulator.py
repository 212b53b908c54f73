"""A simulated EMCO mill with a pen: a control that reads a serial line, moved only by the clock that is handed in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from firmware_protocol.emco.line_format import lower_seven, parity_is_even, with_even_parity
from firmware_protocol.emco.simulator.faults import (
    AlarmInBlock,
    Fault,
    FlipBit,
    LoseAck,
    LoseXon,
    PowerCut,
    Reset,
    Stall,
    Timed,
    Unplug,
)
from firmware_protocol.emco.simulator.reading import BAD_PARITY, XOFF, XON, Reading
from firmware_protocol.emco.simulator.setup import Setup, setup_from
from firmware_protocol.ink import PenRule, Polyline, Vector

_NEVER = float("inf")


class EmcoSimulator:
    """`firmware_protocol.simulator.Simulator`: a control that executes a program while it reads it (drip feed).

    Opening the port does nothing to the machine itself; that somebody has pressed RESET, and presses START
    `Setup.start_s` later, is taken for granted. Not modelled: the time that reading a block takes, acceleration within
    a move (each has an even speed), tools, block skip switched on, feed overrides, a program that is stored before it
    is executed, and whatever a control keeps from one program to the next.
    """

    def __init__(self, setup: Setup | None = None, *, faults: Sequence[Fault] = (), pen: PenRule | None = None) -> None:
        self.setup = setup or Setup()
        self._faults = frozenset(faults)
        self._timed: list[tuple[float, Timed]] | None = None
        alarms = frozenset(fault.block for fault in faults if isinstance(fault, AlarmInBlock))
        self._reading = Reading(self.setup, pen or PenRule(), alarm_in=alarms, say=self._say)
        self._going: list[tuple[float, bytes]] = []
        self._received = self._xons = self._answers = 0
        self._wire_free_s = 0.0
        self._now = 0.0
        self.unplugged = False

    @property
    def now(self) -> float:
        """The latest time that it has been told."""
        return self._now

    @property
    def ink(self) -> list[Polyline]:
        """What is on the sheet now: polylines of (x, y) in mm, in the coordinates of the program."""
        return self._reading.axes.ink(self._now).polylines

    def clear_sheet(self) -> None:
        """A new sheet lies under the pen: `ink` begins anew."""
        self._reading.axes.clear_sheet()

    @property
    def path(self) -> Sequence[tuple[float, Vector]]:
        """The executed path: when the end of each move was reached, and where it is."""
        return self._reading.axes.path

    @property
    def position_mm(self) -> Vector:
        return self._reading.axes.position_mm(self._now)

    @property
    def moving(self) -> bool:
        return self._reading.axes.moving

    @property
    def screen(self) -> str:
        """What stands on the control's screen, where only the operator sees it."""
        return self._reading.screen

    @property
    def blocks(self) -> int:
        """Blocks of the running program that have been read."""
        return self._reading.blocks

    @property
    def xons(self) -> int:
        """How often XON has been said, a lost one included."""
        return self._xons

    @property
    def overruns(self) -> int:
        """Bytes that found no room and vanished."""
        return self._reading.receiver.overruns

    @property
    def unread(self) -> int:
        """Bytes that came while the control was not reading, and vanished."""
        return self._reading.receiver.unread

    @property
    def peak(self) -> int:
        """The most bytes that have ever been in the buffer."""
        return self._reading.receiver.peak

    def open(self, now: float) -> None:
        """The host opens the port; the faults with a time are counted from the first time on."""
        self._run_until(now)
        if self._timed is None:
            timed = [fault for fault in self._faults if isinstance(fault, Stall | Reset | PowerCut | Unplug)]
            self._timed = sorted(((now + fault.at_s, fault) for fault in timed), key=lambda pair: pair[0])
        self.unplugged = False
        self._reading.rest(now, start_in_s=self.setup.start_s)

    def receive(self, data: bytes, now: float) -> None:
        """Bytes leave the host at `now`; they arrive one by one, at the speed of the line."""
        self._run_until(now)
        if not self.unplugged:
            self._reading.receiver.send(self._as_arrived(data), now)

    def advance(self, now: float) -> bytes:
        """Let the time pass up to `now`. Returns what has reached the host and was not returned before."""
        self._run_until(now)
        arrived = b"".join(data for at_s, data in self._going if at_s <= now)
        self._going = [(at_s, data) for at_s, data in self._going if at_s > now]
        return b"" if self.unplugged else arrived

    def next_time(self) -> float | None:
        """When something will next change or be said; None: nothing more until something is received."""
        soonest = min([self._next_event(), *(at_s for at_s, _ in self._going)])
        return None if soonest == _NEVER else soonest

    def _run_until(self, now: float) -> None:
        while (event := self._next_event()) <= now:
            self._step(max(event, self._now))
        self._step(max(now, self._now))

    def _next_event(self) -> float:
        fault = self._timed[0][0] if self._timed else _NEVER
        return min(fault, self._reading.next_s())

    def _step(self, now: float) -> None:
        self._now = now
        self._reading.step(now)
        while self._timed and self._timed[0][0] <= now:
            self._happen(self._timed.pop(0)[1])

    def _happen(self, fault: Timed) -> None:
        match fault:
            case Stall():
                self._reading.stall(self._now)
            case Reset():
                self._reading.rest(self._now, "RESET")
            case PowerCut():
                self._reading.rest(self._now)
            case Unplug():
                self.unplugged = True

    def _as_arrived(self, data: bytes) -> bytes:
        """The bytes as the control sees them: parity removed, with the marks of wrong parity and the flipped bits."""
        arrived = bytearray(data)
        flips = [fault.index - self._received for fault in self._faults if isinstance(fault, FlipBit)]
        self._received += len(data)
        wrong = [at for at in flips if 0 <= at < len(data)]
        for at in wrong:
            arrived[at] ^= 0x01
        if self.setup.software_parity:
            wrong = [at for at, byte in enumerate(arrived) if not parity_is_even(byte)]
        if self.setup.line.parity == "none" and not self.setup.software_parity:
            return bytes(arrived)
        for at in wrong:
            arrived[at] = BAD_PARITY
        return lower_seven(bytes(arrived))

    def _say(self, data: bytes, now: float) -> None:
        if self._lost(data):
            return
        start_s = max(now, self._wire_free_s)
        byte_s = 1 / self.setup.line.bytes_per_s(self.setup.baud)
        self._wire_free_s = start_s + len(data) * byte_s
        self._going.append((self._wire_free_s, with_even_parity(data) if self.setup.software_parity else data))

    def _lost(self, data: bytes) -> bool:
        if data == XON:
            self._xons += 1
            return LoseXon(self._xons - 1) in self._faults
        if data == XOFF:
            return False
        self._answers += 1
        return LoseAck(self._answers - 1) in self._faults


def simulator_from(options: Mapping[str, str], *, pen: PenRule | None = None) -> EmcoSimulator:
    """The simulator that the options of a URL describe, such as dialect=fanuc, baud=9600, buffer=256, alarm_block=40.

    pen: when it touches the sheet, where the options do not say `pen_z`. `setup.py` holds all options. Raises
    ValueError for an option that there is not or that makes no sense.
    """
    setup, faults, said_pen = setup_from(options)
    return EmcoSimulator(setup, faults=faults, pen=said_pen or pen)
