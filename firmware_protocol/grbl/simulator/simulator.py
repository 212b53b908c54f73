"""A simulated plotter with GRBL 1.1h on a 328P, moved only by the clock that is handed in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from firmware_protocol.crooked import Crooked, CrookedInk
from firmware_protocol.grbl.simulator import firmware
from firmware_protocol.grbl.simulator.chip import Chip, Signal, State
from firmware_protocol.grbl.simulator.events import AllOpen, HardwareReset, Pin, PlugIn, Touch, read_event
from firmware_protocol.grbl.simulator.faults import (
    BrownOut,
    DropByte,
    Fault,
    FlipByte,
    Hang,
    HardLimit,
    LoseOk,
    SlowUsb,
    Timed,
    Unplug,
    UnsaidAlarm,
)
from firmware_protocol.grbl.simulator.inputs import Inputs, Switch
from firmware_protocol.grbl.simulator.lookahead import Vector
from firmware_protocol.grbl.simulator.modal import HERE, Memory
from firmware_protocol.grbl.simulator.realtime import Routine, Wait
from firmware_protocol.grbl.simulator.settings import Settings
from firmware_protocol.grbl.simulator.wire import Outbound
from firmware_protocol.ink import Ink, PenRule, Polyline

_NEVER = float("inf")
_FEEL_S = 0.001
"""How often inputs that depend on the place are looked at while the machine moves."""


class GrblSimulator:
    """Bytes and the time come in, bytes and ink come out.

    Not modelled: laser mode ($32), single steps and lost steps, mist coolant (a build of its own), and `$N2=` and
    `$N3=`, which here do nothing.

    settings: `$` numbers to values that differ from the generic defaults. pen: when it touches the sheet.
    boot_s: how long the boot loader is deaf after `open`. switches_mm: where the homing switches lie, from the place
    where the machine was switched on, each at the end that $23 seeks; without it `$H` ends in ALARM:9.
    crooked: in which way its axes are not what it believes.
    Raises ValueError for an unknown setting.
    """

    def __init__(
        self,
        *,
        settings: Mapping[int, float] | None = None,
        faults: Sequence[Fault] = (),
        pen: PenRule | None = None,
        boot_s: float = 0.0,
        switches_mm: Vector | None = None,
        crooked: Crooked | None = None,
    ) -> None:
        self._faults = tuple(faults)
        self._timed_faults = [f for f in faults if isinstance(f, Hang | BrownOut | HardLimit | Unplug)]
        self._boot_s = boot_s
        self._outbound = Outbound()
        ink = CrookedInk(pen or PenRule(), crooked) if crooked else Ink(pen or PenRule())
        self._chip = Chip(Memory(Settings(settings)), ink, self._say)
        self._chip.inputs = _homing_switches(self._chip.settings, switches_mm)
        self._origin_mm = HERE
        self._asked: list[Fault] = []
        self._main: Routine | None = None
        self._due: Wait = None
        self._polling = False
        self._timed: list[tuple[float, Timed]] = []
        self._sent = self._oks = 0
        self.unplugged = False
        self.stood_on_sheet = 0
        """How often a pen that Z moves has come to rest on the sheet: its planner ran dry."""

    @property
    def now(self) -> float:
        """The latest time that it has been told."""
        return self._chip.now

    @property
    def ink(self) -> list[Polyline]:
        """What is on the sheet now: polylines of (x, y) in mm from the place where the machine was switched on."""
        return self._chip.ink_now().polylines

    def clear_sheet(self) -> None:
        """A new sheet lies under the pen: `ink` begins anew."""
        self._chip.ink.clear()

    @property
    def position_mm(self) -> Vector:
        """Where the pen is on the sheet, whatever the controller believes."""
        return self._chip.on_sheet(self._chip.stepper.now_at()[0])

    @property
    def overflows(self) -> int:
        """Bytes that found the receive ring full and vanished."""
        return self._chip.inbound.overflows

    @property
    def lost_bytes(self) -> int:
        """Bytes that came while the chip was writing to its memory or booting and vanished."""
        return self._chip.inbound.lost

    @property
    def oks(self) -> int:
        """Lines acknowledged since the port was opened, those included whose `ok` was lost."""
        return self._oks

    def open(self, now: float) -> None:
        """The host opens the port: DTR resets the chip, the position is forgotten, faults are counted from now on."""
        self._run_until(now)
        self.unplugged = False
        self._sent = self._oks = 0
        self._asked = []
        self._set_latency(next((fault.latency_s for fault in self._faults if isinstance(fault, SlowUsb)), 0.0))
        self._chip.swallows_alarm = UnsaidAlarm() in self._faults
        self._timed = [(now + f.at_s, f) for f in self._timed_faults if f.at_s is not None]
        self._timed.sort(key=_moment)
        self._outbound.unplug(now)
        self._chip.inbound.unplug(now)
        self._power_on(self._boot_s)

    def receive(self, data: bytes, now: float) -> None:
        """Bytes leave the host at `now`; they arrive one by one, at 11,520 a second."""
        self._run_until(now)
        if self._main is None:
            return
        self._chip.inbound.send(self._damaged(data), now)

    def advance(self, now: float) -> bytes:
        """Let the time pass up to `now`. Returns what has reached the host and was not returned before."""
        self._run_until(now)
        return b"" if self.unplugged else self._outbound.arrived(now)

    def happen(self, sentence: str, now: float) -> None:
        """Something happens to the machine: one of `events.SENTENCES`.

        Raises ValueError for any other, and for a reset of a machine without power.
        """
        event = read_event(sentence)
        if self.unplugged and isinstance(event, HardwareReset | BrownOut):
            raise ValueError("the machine has no power: plug it in first")
        self._run_until(now)
        match event:
            case HardwareReset(deaf_s):
                self._power_on(deaf_s)
            case PlugIn():
                self.unplugged = False
            case UnsaidAlarm():
                self._chip.swallows_alarm = True
            case SlowUsb(latency_s):
                self._set_latency(latency_s)
            case DropByte(index) | FlipByte(index):
                self._asked.append(replace(event, index=self._sent + index))
            case LoseOk(index):
                self._asked.append(replace(event, index=self._oks + index))
            case Hang() | BrownOut() | Unplug():
                self._happen(event)
            case _:
                self._touch(event)

    def next_time(self) -> float | None:
        """When something will next change or be said; None: nothing more until something is received."""
        soonest = min(self._next_event(), self._outbound.next_s())
        return None if soonest == _NEVER else soonest

    # -- the clock --

    def _run_until(self, now: float) -> None:
        while (event := self._next_event()) <= now:
            self._step(max(event, self._chip.now))
        self._step(max(now, self._chip.now))

    def _next_event(self) -> float:
        fault = self._timed[0][0] if self._timed else _NEVER
        if self._main is None:
            return fault
        chip = self._chip
        due = _NEVER if self._due is None else max(self._due, chip.stall_until_s)
        if chip.feels:
            due = min(due, chip.now + _FEEL_S)
        return min(due, chip.inbound.next_s(), chip.stepper.next_s(), fault)

    def _step(self, now: float) -> None:
        chip = self._chip
        chip.now = now
        if self._main is not None:
            was_moving = chip.stepper.moving
            happened = chip.stepper.advance(now)
            if was_moving and not chip.stepper.moving:
                chip.signals |= Signal.STOPPED
                chip.drivers_off()
                self.stood_on_sheet += chip.state is State.RUN and self._pen_touches()
            if chip.inputs.depend_on_place:
                happened |= chip.feel()
            happened |= chip.inbound.absorb(now)
            if happened and self._polling:
                self._due = now
        while self._timed and self._timed[0][0] <= now:
            self._happen(self._timed.pop(0)[1])
        while self._main is not None and self._due is not None and max(self._due, chip.stall_until_s) <= now:
            self._due = next(self._main)
            self._polling = self._due is None

    def _pen_touches(self) -> bool:
        at_mm = self.position_mm
        return self._chip.ink.rule.part(at_mm, at_mm, 0.0) is not None

    def _power_on(self, deaf_s: float = 0.0) -> None:
        chip = self._chip
        chip.lose_position()
        chip.state = State.ALARM if chip.settings[22] else State.IDLE
        chip.stall_until_s = chip.now + deaf_s
        chip.inbound.deaf_until_s = chip.stall_until_s if deaf_s else 0.0
        chip.inbound.reading = False
        chip.restart()
        self._main = firmware.run(chip)
        self._due, self._polling = chip.now, False

    def _say(self, text: str) -> None:
        if text == "ok\r\n":
            self._oks += 1
            if LoseOk(self._oks - 1) in (*self._faults, *self._asked):
                return
        ready_s = self._outbound.send(text.encode("latin-1"), self._chip.now)
        self._chip.stall_until_s = max(self._chip.stall_until_s, ready_s)
        if text == "ok\r\n":
            self._timed += [(self._chip.now, f) for f in self._timed_faults if f.after_acks == self._oks]
            self._timed.sort(key=_moment)

    # -- faults --

    def _damaged(self, data: bytes) -> bytes:
        first, self._sent = self._sent, self._sent + len(data)
        damages = [f for f in (*self._faults, *self._asked) if isinstance(f, DropByte | FlipByte)]
        for fault in sorted(damages, key=lambda f: -f.index):
            at = fault.index - first
            if 0 <= at < len(data):
                flipped = bytes([data[at] ^ fault.bits]) if isinstance(fault, FlipByte) else b""
                data = data[:at] + flipped + data[at + 1 :]
        return data

    def _set_latency(self, seconds: float) -> None:
        self._outbound.usb_s = self._chip.inbound.usb_s = seconds

    def _touch(self, event: Touch) -> None:
        chip = self._chip
        if isinstance(event, AllOpen):
            self._origin_mm = chip.here
        chip.inputs = chip.inputs.after(event, self._origin_mm)
        if self._main is None:
            return
        if isinstance(event, Pin) and event.low:
            chip.press(event.name)
        chip.feel()
        if self._polling:
            self._due = chip.now

    def _happen(self, fault: Timed) -> None:
        chip = self._chip
        if isinstance(fault, HardLimit):
            chip.hard_limit()
            if self._polling:
                self._due = chip.now
        elif isinstance(fault, BrownOut):
            self._power_on()
        else:
            chip.stepper.stop(chip.now)
            self._main = None
            self.unplugged = isinstance(fault, Unplug)


def _moment(pair: tuple[float, Timed]) -> float:
    return pair[0]


def _homing_switches(settings: Settings, places_mm: Vector | None) -> Inputs:
    downwards = int(settings[23])
    places = enumerate(places_mm or ())
    return Inputs(switches={axis: Switch(place, upwards=not downwards >> axis & 1) for axis, place in places})
