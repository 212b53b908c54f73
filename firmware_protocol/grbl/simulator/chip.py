"""State of the simulated controller that its main loop, its interrupts and its reports share."""

from __future__ import annotations

from collections.abc import Callable
from enum import Enum, Flag, auto

from firmware_protocol.grbl.simulator.inputs import Inputs
from firmware_protocol.grbl.simulator.interpreter import Interpreter
from firmware_protocol.grbl.simulator.lookahead import Block, Lookahead, Vector
from firmware_protocol.grbl.simulator.modal import HERE, Memory
from firmware_protocol.grbl.simulator.stepper import Stepper
from firmware_protocol.grbl.simulator.wire import Inbound
from firmware_protocol.ink import Ink

EEPROM_BYTE_S = 0.0034


class State(Enum):
    """`sys.state`, by the word of the status report."""

    IDLE = "Idle"
    RUN = "Run"
    HOLD = "Hold"
    JOG = "Jog"
    ALARM = "Alarm"
    CHECK = "Check"
    HOMING = "Home"
    DOOR = "Door"
    SLEEP = "Sleep"


class Signal(Flag):
    """`sys_rt_exec_state`: flags, not a queue."""

    NONE = 0
    STATUS = auto()
    START = auto()
    STOPPED = auto()
    HOLD = auto()
    CANCEL = auto()
    DOOR = auto()
    SLEEP = auto()
    RESET = auto()


class Suspend(Flag):
    """`sys.suspend`: while any is set the main loop does nothing else."""

    NONE = 0
    HOLD_COMPLETE = auto()
    CANCELLED = auto()
    JOG_CANCELLED = auto()
    DOOR_AJAR = auto()
    RETRACTED = auto()
    RESTORING = auto()
    RESTORED = auto()


_SIGNALS = {0x3F: Signal.STATUS, 0x21: Signal.HOLD, 0x7E: Signal.START, 0x84: Signal.DOOR}
_OVERRIDES = {*range(0x90, 0x98), *range(0x99, 0x9F), 0xA0}
_MOVING = (State.RUN, State.HOMING, State.JOG)


class Chip:
    """Everything that a running Grbl keeps; the chip's memory and the place of the pen outlive a reset."""

    def __init__(self, memory: Memory, ink: Ink, say: Callable[[str], None]) -> None:
        self.memory, self.ink, self.say = memory, ink, say
        self.settings = memory.settings
        self.now = 0.0
        self.stall_until_s = 0.0
        self.lookahead = Lookahead(self.settings)
        self.stepper = Stepper(self.lookahead, self._finished, self._cut)
        self.interpreter = Interpreter(memory)
        self.inbound = Inbound(self.signal)
        self.sheet_mm: Vector = HERE
        """Where machine zero lies on the sheet: moves when the position is lost or set anew."""
        self.inputs, self._felt = Inputs(), frozenset[int]()
        self.swallows_alarm = False
        """The main loop looks for an alarm just before an interrupt sets it, and then finds a reset only."""
        self.state = State.IDLE
        self.probe_mm, self.probed = HERE, False
        self.restart()

    def restart(self) -> None:
        """What any reset sets back; state and position stay."""
        self.signals, self.suspend = Signal.NONE, Suspend.NONE
        self.alarm = 0
        self.abort = self.holding = self.soft_limit = False
        self.overrides: set[int] = set()
        self.feed_percent = self.rapid_percent = self.spindle_percent = 100
        self.flood = self.spindle_stopped = self.spindle_stop_asked = False
        self.reports_to_wco = self.reports_to_overrides = 0
        self.inbound.clear()
        self.lookahead.load_settings()
        self.lookahead.feed_override = self.lookahead.rapid_override = 1.0
        self.stepper.stop(self.now)
        self.interpreter.reset(self.stepper.position_mm)
        self.probe_mm, self.probed = HERE, False
        self.probe_for: bool | None = None
        self.set_spindle(5, 0.0)

    @property
    def attention(self) -> bool:
        """Whether the main loop has anything to do besides lines."""
        return bool(self.alarm or self.overrides) or self.signals is not Signal.NONE or self.suspend is not Suspend.NONE

    def signal(self, byte: int) -> None:
        """A real-time byte has arrived: what the receive interrupt does."""
        if byte == 0x18:
            self.reset()
        elif byte in _SIGNALS:
            self.signals |= _SIGNALS[byte]
        elif byte == 0x85:
            if self.state is State.JOG:
                self.signals |= Signal.CANCEL
        elif byte in _OVERRIDES:
            self.overrides.add(byte)

    def reset(self) -> None:
        """`mc_reset`: stop everything now; the main loop does the rest."""
        if Signal.RESET in self.signals:
            return
        self.signals |= Signal.RESET
        if self.state in _MOVING or self.holding:
            if self.state is State.HOMING:
                self.alarm = self.alarm or 6
            else:
                self.alarm = 3
            self.stop_motors(always=True)
        else:
            self.stepper.stop(self.now)
        # Only now: what has been drawn so far was drawn with the servo where it was.
        self.set_spindle(5, 0.0)
        self.flood = False

    @property
    def limits(self) -> frozenset[int]:
        """The axes whose limit switch counts as closed: with $5=1 those whose switch is open."""
        closed = self.inputs.limits(self.here)
        return frozenset(range(3)) - closed if self.settings[5] else closed

    @property
    def contact(self) -> bool:
        """Whether the probe counts as touching: with $6=1 when it does not."""
        return self.inputs.contact(self.here) != bool(self.settings[6])

    @property
    def feels(self) -> bool:
        """Whether the motion under way can change an input that matters now."""
        matters = bool(self.settings[21]) or self.probe_for is not None
        return matters and self.stepper.moving and self.inputs.depend_on_place

    def feel(self) -> bool:
        """Look at the inputs, as the interrupts do. Returns True when the main loop is concerned."""
        closed = self.inputs.limits(self.here)
        edge, self._felt = closed != self._felt, closed
        if edge and self.settings[21] and self.state is not State.HOMING:
            self.hard_limit()
        if self.probe_for is not None and self.contact == self.probe_for:
            steps = self.lookahead.steps(self.stepper.now_at()[0])
            self.probe_mm, self.probed, self.probe_for = self.lookahead.millimetres(steps), True, None
            self.signals |= Signal.CANCEL
            return True
        return edge

    def press(self, pin: str) -> None:
        """A pin goes low: what its interrupt does."""
        if pin == "reset":
            self.reset()
        else:
            self.signals |= Signal.HOLD if pin == "hold" else Signal.START

    def hard_limit(self) -> None:
        """A limit switch has tripped."""
        if self.state is not State.ALARM and not self.alarm:
            self.reset()
            self.alarm = 1

    def stop_motors(self, *, always: bool = False) -> None:
        """Stop dead; the drivers stay on for $1 ms, in which the chip does nothing (255: they stay on for ever)."""
        self.stepper.stop(self.now)
        self.drivers_off(always=always)

    def drivers_off(self, *, always: bool = False) -> None:
        """The delay of `st_go_idle`."""
        delay_ms = self.settings[1]
        if (delay_ms != 255 or always or self.state is State.SLEEP) and self.state is not State.HOMING:
            self.stall_until_s = max(self.stall_until_s, self.now + delay_ms / 1000)

    def set_spindle(self, direction: int, speed: float) -> None:
        """Switch the spindle, on many plotters the pen's servo, with the override and the limits $30 and $31."""
        fastest, slowest = self.settings[30], self.settings[31]
        speed *= self.spindle_percent / 100
        if direction == 5 or speed == 0:
            rpm = 0.0
        elif slowest >= fastest or speed >= fastest:
            rpm = fastest
        else:
            rpm = max(speed, slowest)
        self.spindle_direction, self.spindle_rpm = direction, rpm
        self.reports_to_overrides = 0
        self.ink.servo(rpm, self.here)

    def set_coolant(self, *, flood: bool) -> None:
        """Switch the coolant."""
        self.flood = flood
        self.reports_to_overrides = 0

    def write_memory(self, changed: int) -> None:
        """Each further changed byte waits for the one before it with interrupts off: what arrives then is lost."""
        if changed > 1:
            self.inbound.deaf_until_s = self.now + (changed - 1) * EEPROM_BYTE_S
            self.stall_until_s = max(self.stall_until_s, self.inbound.deaf_until_s)

    def lose_position(self) -> None:
        """The chip forgets where it is; the pen stays where it is."""
        self.stepper.stop(self.now)
        self.set_position(HERE)

    def set_position(self, position_mm: Vector) -> None:
        """Call the present place `position_mm`."""
        at = self.on_sheet(self.stepper.position_mm)
        self.sheet_mm = (at[0] - position_mm[0], at[1] - position_mm[1], at[2] - position_mm[2])
        self.stepper.place(position_mm)
        self.interpreter.modal.position_mm = position_mm

    @property
    def here(self) -> Vector:
        """Where the pen is on the sheet."""
        return self.on_sheet(self.stepper.now_at()[0])

    def on_sheet(self, position_mm: Vector) -> Vector:
        (x, y, z), (sx, sy, sz) = position_mm, self.sheet_mm
        return x + sx, y + sy, z + sz

    def ink_now(self) -> Ink:
        """The ink so far, the part of the present move included."""
        ink, (_, half_done) = self.ink.copy(), self.stepper.now_at()
        if half_done is not None:
            block, done = half_done
            ink.travel(self.on_sheet(block.start_mm), self.on_sheet(block.at(done)))
        return ink

    def _finished(self, _: float, block: Block) -> None:
        self.ink.travel(self.on_sheet(block.start_mm), self.on_sheet(block.end_mm))

    def _cut(self, block: Block, done_mm: float) -> None:
        self.ink.travel(self.on_sheet(block.start_mm), self.on_sheet(block.at(done_mm)))
        self.ink.cut()
