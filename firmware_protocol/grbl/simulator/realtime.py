"""What the simulated controller does between lines: real-time flags, holds, alarms (`protocol.c` of GRBL 1.1h).

The firmware waits in loops; here each such place yields: a time until which the chip is busy, or None for "until
something happens".
"""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeAlias

from firmware_protocol.grbl.simulator import status
from firmware_protocol.grbl.simulator.chip import Chip, Signal, State, Suspend

Wait: TypeAlias = float | None
Routine: TypeAlias = Generator[Wait, None, None]

ALARM_DELAY_S = 0.5
REPORT_S = 0.003
REPORT_IN_MOTION_S = 0.001
"""Measured by the lines that a stream loses: 1 % at 10 reports a second, 11 % at 100."""
OVERRIDE_S = 0.00025
SPINDLE_RESTART_S = 4.0
COOLANT_RESTART_S = 1.0

_HOLDS = Signal.HOLD | Signal.CANCEL | Signal.DOOR | Signal.SLEEP


def execute_realtime(chip: Chip) -> Routine:
    """`protocol_execute_realtime`: look at the flags, and stay here while suspended."""
    yield from _look(chip)
    while chip.suspend is not Suspend.NONE and not chip.abort:
        if Suspend.HOLD_COMPLETE in chip.suspend and chip.state in (State.DOOR, State.SLEEP):
            yield from _parked(chip)
            if chip.abort:
                return
        if not (chip.signals or chip.alarm or chip.overrides):
            yield None
        yield from _look(chip)


def synchronize(chip: Chip) -> Routine:
    """`protocol_buffer_synchronize`: until all motion has ended."""
    start_cycle(chip)
    while True:
        if chip.attention:
            yield from execute_realtime(chip)
        if chip.abort or not (chip.lookahead.blocks or chip.stepper.moving or chip.state is State.RUN):
            return
        yield None


def start_cycle(chip: Chip) -> None:
    """`protocol_auto_cycle_start`: what is planned begins to move."""
    if chip.lookahead.blocks and chip.state is State.IDLE:
        chip.signals |= Signal.START


def _look(chip: Chip) -> Routine:
    if chip.swallows_alarm and chip.alarm in (1, 3):
        chip.swallows_alarm, chip.alarm = False, 0
    if chip.alarm:
        yield from _alarm(chip)
    if Signal.RESET in chip.signals:
        chip.abort = True
        return
    if Signal.STATUS in chip.signals:
        yield chip.now + (REPORT_IN_MOTION_S if chip.stepper.moving else REPORT_S)
        chip.signals &= ~Signal.STATUS
        chip.say(status.report(chip))
    signals = chip.signals
    if signals & _HOLDS:
        _hold(chip, signals)
    if Signal.START in signals:
        _start(chip, signals)
    if Signal.STOPPED in signals:
        _stopped(chip)
    if chip.overrides:
        yield chip.now + OVERRIDE_S
        _override(chip)


def _alarm(chip: Chip) -> Routine:
    chip.state = State.ALARM
    chip.say(f"ALARM:{chip.alarm}\r\n")
    critical = chip.alarm in (1, 2)
    yield chip.now + ALARM_DELAY_S
    if critical:
        chip.say("[MSG:Reset to continue]\r\n")
        chip.signals &= ~Signal.RESET
        while Signal.RESET not in chip.signals:
            yield None
    chip.alarm = 0


def _hold(chip: Chip, signals: Signal) -> None:
    chip.signals &= ~_HOLDS
    if chip.state not in (State.ALARM, State.CHECK):
        _begin_hold(chip, signals)
        if Signal.CANCEL in signals and chip.state is not State.JOG:
            chip.suspend |= Suspend.CANCELLED
        if Signal.HOLD in signals and chip.state not in (State.DOOR, State.JOG, State.SLEEP):
            chip.state = State.HOLD
        if Signal.DOOR in signals:
            chip.say("[MSG:Check Door]\r\n")
            if Suspend.JOG_CANCELLED not in chip.suspend and chip.state is not State.SLEEP:
                chip.state = State.DOOR
            chip.suspend |= Suspend.DOOR_AJAR
    if Signal.SLEEP in signals:
        if chip.state is State.ALARM:
            chip.suspend |= Suspend.RETRACTED | Suspend.HOLD_COMPLETE
        chip.state = State.SLEEP


def _begin_hold(chip: Chip, signals: Signal) -> None:
    if chip.state in (State.RUN, State.JOG):
        if not chip.suspend & (Suspend.CANCELLED | Suspend.JOG_CANCELLED):
            chip.stepper.hold(chip.now)
            chip.holding = True
            if chip.state is State.JOG and Signal.SLEEP not in signals:
                chip.suspend |= Suspend.JOG_CANCELLED
    elif chip.state is State.IDLE:
        chip.suspend = Suspend.HOLD_COMPLETE


def _start(chip: Chip, signals: Signal) -> None:
    chip.signals &= ~Signal.START
    if signals & (Signal.HOLD | Signal.CANCEL | Signal.DOOR):
        return
    if chip.state is State.DOOR and Suspend.DOOR_AJAR not in chip.suspend:
        if Suspend.RESTORED in chip.suspend:
            chip.state = State.IDLE
        elif Suspend.RETRACTED in chip.suspend:
            chip.suspend |= Suspend.RESTORING
    held = chip.state is State.HOLD and Suspend.HOLD_COMPLETE in chip.suspend
    if held and chip.spindle_stopped:
        _stop_or_restore_spindle(chip)
    if chip.state is State.IDLE or held:
        goes_on = bool(chip.lookahead.blocks) and Suspend.CANCELLED not in chip.suspend
        chip.holding, chip.suspend = False, Suspend.NONE
        chip.state = State.RUN if goes_on else State.IDLE
        if goes_on:
            chip.stepper.start(chip.now)


def _stopped(chip: Chip) -> None:
    chip.signals &= ~Signal.STOPPED
    held = chip.state in (State.HOLD, State.DOOR, State.SLEEP)
    if held and not chip.soft_limit and Suspend.JOG_CANCELLED not in chip.suspend:
        chip.lookahead.replan()
        if chip.holding:
            chip.suspend |= Suspend.HOLD_COMPLETE
        chip.holding = False
        if chip.spindle_stop_asked:
            _stop_or_restore_spindle(chip)
        return
    if Suspend.JOG_CANCELLED in chip.suspend:
        chip.holding = False
        chip.stop_motors()
        chip.interpreter.modal.position_mm = chip.stepper.position_mm
    chip.state = State.DOOR if Suspend.DOOR_AJAR in chip.suspend else State.IDLE
    chip.suspend = Suspend.HOLD_COMPLETE if chip.state is State.DOOR else Suspend.NONE


def _parked(chip: Chip) -> Routine:
    """Door and sleep: the spindle goes off, and comes back before the motion does."""
    if Suspend.RETRACTED not in chip.suspend:
        chip.set_spindle(5, 0.0)
        chip.flood = False
        chip.suspend |= Suspend.RETRACTED
    if chip.state is State.SLEEP:
        chip.say("[MSG:Sleeping]\r\n")
        chip.drivers_off()
        while not chip.abort:
            yield None
            yield from _look(chip)
        return
    chip.suspend &= ~Suspend.DOOR_AJAR
    if Suspend.RESTORING in chip.suspend:
        yield from _restore(chip)
        chip.suspend = (chip.suspend | Suspend.RESTORED) & ~Suspend.RESTORING
        chip.signals |= Signal.START


def _restore(chip: Chip) -> Routine:
    modal = chip.interpreter.modal
    if modal.spindle != 5:
        chip.set_spindle(modal.spindle, modal.speed)
        yield from _pass(chip, SPINDLE_RESTART_S)
    if modal.flood and not chip.abort:
        chip.flood = True
        yield from _pass(chip, COOLANT_RESTART_S)


def _pass(chip: Chip, seconds: float) -> Routine:
    end = chip.now + seconds
    while chip.now < end and not chip.abort:
        yield from _look(chip)
        if not chip.abort:
            yield min(end, chip.now + 0.05)


def _override(chip: Chip) -> None:
    asked, chip.overrides = chip.overrides, set()
    feed = _percent(chip.feed_percent, asked, 0x90)
    rapid = next((value for byte, value in ((0x97, 25), (0x96, 50), (0x95, 100)) if byte in asked), chip.rapid_percent)
    if (feed, rapid) != (chip.feed_percent, chip.rapid_percent):
        set_overrides(chip, feed, rapid)
        chip.reports_to_overrides = 0
    spindle = _percent(chip.spindle_percent, asked, 0x99)
    if spindle != chip.spindle_percent:
        chip.spindle_percent, chip.reports_to_overrides = spindle, 0
        if chip.spindle_direction != 5:
            chip.set_spindle(chip.spindle_direction, chip.interpreter.modal.speed)
    if 0x9E in asked and chip.state is State.HOLD:
        chip.spindle_stop_asked = True
        if Suspend.HOLD_COMPLETE in chip.suspend:
            _stop_or_restore_spindle(chip)
    if 0xA0 in asked and chip.state in (State.IDLE, State.RUN, State.HOLD):
        chip.interpreter.modal.flood = not chip.flood
        chip.set_coolant(flood=not chip.flood)


def _stop_or_restore_spindle(chip: Chip) -> None:
    chip.spindle_stop_asked = False
    modal = chip.interpreter.modal
    if modal.spindle == 5:
        return
    if chip.spindle_stopped:
        chip.say("[MSG:Restoring spindle]\r\n")
        chip.set_spindle(modal.spindle, modal.speed)
    else:
        chip.set_spindle(5, 0.0)
    chip.spindle_stopped = not chip.spindle_stopped


def set_overrides(chip: Chip, feed: int, rapid: int) -> None:
    """Execute at these percentages from now on."""
    chip.feed_percent, chip.rapid_percent = feed, rapid
    chip.lookahead.override(feed=feed / 100, rapid=rapid / 100)
    chip.stepper.planned()


def _percent(value: int, asked: set[int], base: int) -> int:
    """100 %, +10, -10, +1, -1 are five bytes from `base` on."""
    value = 100 if base in asked else value
    for byte, change in enumerate((10, -10, 1, -1), base + 1):
        value += change if byte in asked else 0
    return max(10, min(200, value))
