"""A simulated Dobot Magician, moved only by the clock that is handed in."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from firmware_protocol.dobot.kinematics import Flat
from firmware_protocol.dobot.packet import Packet, PacketReader
from firmware_protocol.dobot.simulator.answers import Answers
from firmware_protocol.dobot.simulator.arm import Arm, Build
from firmware_protocol.dobot.simulator.faults import (
    ClosePort,
    CorruptReply,
    CorruptRequest,
    DelayReply,
    DropReply,
    Fault,
    Hang,
    PowerCut,
    RaiseAlarm,
    StopQueue,
    StrayByte,
    Timed,
)
from firmware_protocol.dobot.simulator.wire import Line
from firmware_protocol.ink import PenRule, Polyline, Vector

_NEVER = float("inf")
BOOT_S = 1.5
"""For so long an arm that restarts hears nothing."""
_EVENTS: Mapping[str, type[ClosePort | PowerCut | Hang | StopQueue]] = {
    "unplug": ClosePort,
    "power cut": PowerCut,
    "hang": Hang,
    "stop queue": StopQueue,
}
_TIMED = (ClosePort, PowerCut, Hang, StopQueue, RaiseAlarm)


class DobotSimulator:
    """Bytes and the time come in, bytes and ink come out.

    Junk is skipped; a wrong checksum, an unknown id, parameters that are too short and a full queue get no reply; a
    target out of reach gets its index, and stops the queue with an alarm when its turn comes. Not modelled: arcs and
    circles, the rail, the laser's power, inputs and outputs (they take their place in the queue and do nothing), the
    blending of CP segments and of PTP moves into each other, the limits of j4. CP runs at its speed without ramps.

    depth, first_index, build: see `Build`. left_bytes: width of the answer to 247. alarms: what stands at first. pen:
    when it is on the sheet. place: of the tool at first. sheet_origin_mm: subtracted from the ink, so that it is in
    the coordinates of the sheet. Opening the port changes nothing in the arm: faults count from there.
    """

    def __init__(
        self,
        *,
        build: Build | None = None,
        left_bytes: int = 4,
        alarms: Sequence[int] = (),
        faults: Sequence[Fault] = (),
        pen: PenRule | None = None,
        place: Vector = (200.0, 0.0, 50.0),
        sheet_origin_mm: Flat = (0.0, 0.0),
    ) -> None:
        self.arm = Arm(build or Build(), pen or PenRule(), place=place, sheet_origin_mm=sheet_origin_mm)
        self.arm.alarms.update(alarms)
        self._faults = tuple(faults)
        self._answers = Answers(self.arm, left_bytes=left_bytes)
        self._reader = PacketReader()
        self._in, self._out = Line(), Line()
        self._late: list[tuple[float, bytes]] = []
        self._timed: list[tuple[float, Timed]] = []
        self._requests = self._acks = self._others = 0
        self._deaf_until_s = 0.0
        self.dead = False
        """It hangs: neither a word nor a step any more."""
        self.unplugged = False

    @property
    def now(self) -> float:
        """The latest time that it has been told."""
        return self.arm.now

    @property
    def ink(self) -> list[Polyline]:
        """What is on the sheet now: polylines of (x, y) in mm."""
        return self.arm.ink

    def clear_sheet(self) -> None:
        """A new sheet lies under the pen: `ink` begins anew."""
        self.arm.clear_sheet()

    @property
    def acks(self) -> int:
        """Commands for the queue acknowledged since the port was opened, those included whose reply was lost."""
        return self._acks

    def open(self, now: float) -> None:
        """The host opens the port; a Magician goes on with what it does."""
        self._run_until(now)
        self.unplugged = False
        self._requests = self._acks = self._others = 0
        self._timed = [(now + f.at_s, f) for f in self._faults if isinstance(f, _TIMED) and f.at_s is not None]
        self._reader = PacketReader()
        self._in.cut(now)
        self._out.cut(now)
        self._late.clear()

    def receive(self, data: bytes, now: float) -> None:
        """Bytes leave the host at `now` and arrive together, when the last of them has passed the wire."""
        self._run_until(now)
        if data and not self.unplugged:
            self._in.send(data, self.now)

    def advance(self, now: float) -> bytes:
        """Let the time pass up to `now`. Returns what has reached the host and was not returned before."""
        self._run_until(now)
        return b"" if self.unplugged else self._out.arrived(self.now)

    def next_time(self) -> float | None:
        """When something will next change or be said; None: nothing more until something is received."""
        soonest = min(self._next_event(), _NEVER if self.unplugged else self._out.next_s())
        return None if soonest == _NEVER else soonest

    def happen(self, sentence: str, now: float) -> None:
        """See `Eventful.happen`; "plug in" ends "unplug"."""
        self._run_until(now)
        what = sentence.strip().lower()
        if (code := re.fullmatch(r"alarm (?:0x)?([0-7][0-9a-f])", what)) is not None:
            self._happen(RaiseAlarm(at_s=now, code=int(code[1], 16)))
        elif what in _EVENTS:
            self._happen(_EVENTS[what](at_s=now))
        elif what == "plug in":
            self.unplugged = False
        else:
            raise ValueError(f"{sentence!r} does not happen to an arm: {', '.join(_EVENTS)}, plug in, alarm 50 do")

    def _run_until(self, now: float) -> None:
        while (event := self._next_event()) <= now:
            self._step(max(event, self.now))
        self._step(max(now, self.now))

    def _next_event(self) -> float:
        times = [self.arm.next_s(), self._in.next_s()]
        times += [at for at, _ in self._late] + [at for at, _ in self._timed]
        return min(times)

    def _step(self, now: float) -> None:
        self.arm.advance(now)
        for at, data in [late for late in self._late if late[0] <= now]:
            self._late.remove((at, data))
            self._out.send(data, now)
        for at, fault in [timed for timed in self._timed if timed[0] <= now]:
            self._timed.remove((at, fault))
            self._happen(fault)
        data = self._in.arrived(now)
        if data and not self.dead and now >= self._deaf_until_s:
            for packet in self._reader.feed(data):
                self._hear(packet)

    def _hear(self, packet: Packet) -> None:
        if self.dead or self.now < self._deaf_until_s:
            return
        if packet.write and packet.queued:
            self._requests += 1
            if CorruptRequest(self._requests - 1) in self._faults:
                return
        reply = self._answers.reply(packet)
        if reply is not None:
            self._say(reply)

    def _say(self, reply: Packet) -> None:
        ack = reply.write and reply.queued
        number = self._acks if ack else self._others
        self._acks, self._others = self._acks + ack, self._others + (not ack)
        data, late_s = reply.encode(), 0.0
        for fault in self._faults:
            match fault:
                case DropReply(index, answers) if (index, answers) == (number, not ack):
                    data = b""
                case DelayReply(index, answers, by_s) if (index, answers) == (number, not ack):
                    late_s = by_s
                case CorruptReply(index, answers, bits) if data and (index, answers) == (number, not ack):
                    data = data[:-2] + bytes([data[-2] ^ bits]) + data[-1:]
                case StrayByte(index, answers) if (index, answers) == (number, not ack):
                    data = b"\xaa" + data
        if data and late_s:
            self._late.append((self.now + late_s, data))
        elif data:
            self._out.send(data, self.now)
        if ack:
            for timed in [f for f in self._faults if isinstance(f, _TIMED) and f.after_acks == self._acks]:
                self._happen(timed)

    def _happen(self, fault: Timed) -> None:
        match fault:
            case ClosePort():
                self.unplugged = True
                self._in.cut(self.now)
            case PowerCut():
                self.arm.restart()
                self._out.cut(self.now)
                self._deaf_until_s = self.now + BOOT_S
            case Hang():
                self.arm.freeze()
                self.dead = True
            case StopQueue():
                self.arm.stop(force=False)
            case RaiseAlarm(code=code):
                self.arm.raise_alarm(code)
