"""The main loop of the simulated controller: banner, lines in, answers out (`main.c`, `protocol.c` of GRBL 1.1h)."""

from __future__ import annotations

from firmware_protocol.gcode import GcodeError, clean_line
from firmware_protocol.grbl.simulator import status
from firmware_protocol.grbl.simulator.chip import Chip, State
from firmware_protocol.grbl.simulator.commands import Answer, run_command, run_gcode, run_startup
from firmware_protocol.grbl.simulator.motion import slowed
from firmware_protocol.grbl.simulator.realtime import Routine, execute_realtime, start_cycle

LOCKED = 9
LINE_S = 0.0002
CHARACTER_S = 0.000065
GCODE_S = 0.00036
"""Checks of a line of G-code. Measured: 612 lines a second in check mode, 243 when each answer is waited for."""
_BOOT_S = 0.001


def run(chip: Chip) -> Routine:
    """From the reset vector on, for ever."""
    while True:
        chip.restart()
        chip.drivers_off()
        yield chip.now + _BOOT_S
        chip.say(status.BANNER)
        yield from _greet(chip)
        yield from _serve(chip)


def _greet(chip: Chip) -> Routine:
    if chip.settings[21] and chip.limits:
        chip.state = State.ALARM
        chip.say("[MSG:Check Limits]\r\n")
    if chip.state in (State.ALARM, State.SLEEP):
        chip.state = State.ALARM
        chip.say("[MSG:'$H'|'$X' to unlock]\r\n")
    else:
        chip.state = State.IDLE
        yield from run_startup(chip)


def _serve(chip: Chip) -> Routine:
    while not chip.abort:
        line = chip.inbound.next_line()
        if line is None:
            start_cycle(chip)
        if chip.attention:
            yield from execute_realtime(chip)
        elif line is None:
            chip.inbound.reading = True
            yield None
            chip.inbound.reading = False
        if line is not None and not chip.abort:
            code = yield from _execute(chip, line)
            if chip.stall_until_s > chip.now:
                yield chip.stall_until_s
            chip.say(f"error:{code}\r\n" if code else "ok\r\n")


def _execute(chip: Chip, raw: bytes) -> Answer:
    try:
        line = clean_line(raw)
    except GcodeError as error:
        return error.code
    gcode_s = GCODE_S if line and line[0] != "$" else 0.0
    yield chip.now + slowed(chip, LINE_S + CHARACTER_S * len(line) + gcode_s)
    if not line:
        return 0
    if line[0] == "$":
        return (yield from run_command(chip, line))
    if chip.state in (State.ALARM, State.JOG):
        return LOCKED
    return (yield from run_gcode(chip, line))
