"""The `$` commands of the simulated controller (`system.c` of GRBL 1.1h)."""

from __future__ import annotations

from collections.abc import Generator
from typing import TypeAlias

from firmware_protocol.gcode import GcodeError, read_number
from firmware_protocol.grbl.simulator import status
from firmware_protocol.grbl.simulator.chip import Chip, Signal, State
from firmware_protocol.grbl.simulator.homing import home
from firmware_protocol.grbl.simulator.motion import beyond_travel, move, perform
from firmware_protocol.grbl.simulator.realtime import Wait, synchronize

Answer: TypeAlias = Generator[Wait, None, int]
"""A routine that ends with the N of `error:N`, 0 for `ok`."""

INVALID_STATEMENT = 3
HOMING_IS_OFF = 5
NOT_IDLE = 8
BEYOND_TRAVEL = 15


def run_gcode(chip: Chip, line: str) -> Answer:
    """`gc_execute_line`."""
    try:
        actions = chip.interpreter.run(line)
    except GcodeError as error:
        return error.code
    for action in actions:
        yield from perform(chip, action)
        if chip.abort:
            return 0
    if chip.interpreter.offsets_changed:
        chip.interpreter.offsets_changed = False
        chip.reports_to_wco = 0
    return 0


def run_command(chip: Chip, line: str) -> Answer:
    """`system_execute_line`: a cleaned line that begins with `$`."""
    try:
        if line == "$":
            chip.say(status.HELP)
        elif line[1] == "J":
            return (yield from _jog(chip, line))
        elif line[1] in "$GCX":
            _at_any_time(chip, line)
        else:
            return (yield from _at_rest(chip, line))
    except GcodeError as error:
        return error.code
    return 0


def _jog(chip: Chip, line: str) -> Answer:
    if chip.state not in (State.IDLE, State.JOG):
        return NOT_IDLE
    if line[2:3] != "=":
        return INVALID_STATEMENT
    wanted = chip.interpreter.jog(line[3:])
    if chip.settings[20] and beyond_travel(chip, wanted.target_mm):
        return BEYOND_TRAVEL
    yield from move(chip, wanted)
    chip.interpreter.modal.position_mm = wanted.target_mm
    if chip.state is State.IDLE and chip.lookahead.blocks:
        chip.state = State.JOG
        chip.stepper.start(chip.now)
    return 0


def _at_any_time(chip: Chip, line: str) -> None:
    if len(line) > 2:
        raise GcodeError(INVALID_STATEMENT)
    if line == "$$":
        if chip.state in (State.RUN, State.HOLD):
            raise GcodeError(NOT_IDLE)
        for text in chip.settings.listing():
            chip.say(text + "\r\n")
    elif line == "$G":
        chip.say(status.modal_state(chip))
    elif line == "$C":
        _check_mode(chip)
    elif chip.state is State.ALARM:
        chip.say("[MSG:Caution: Unlocked]\r\n")
        chip.state = State.IDLE


def _check_mode(chip: Chip) -> None:
    if chip.state is State.CHECK:
        chip.reset()
        chip.say("[MSG:Disabled]\r\n")
        return
    if chip.state is not State.IDLE:
        raise GcodeError(NOT_IDLE)
    chip.state = State.CHECK
    chip.say("[MSG:Enabled]\r\n")


def _at_rest(chip: Chip, line: str) -> Answer:
    if chip.state not in (State.IDLE, State.ALARM):
        return NOT_IDLE
    if line[1] == "H":
        return (yield from _home(chip, line))
    if line[1] == "N" and line != "$N":
        return (yield from _store_startup(chip, line))
    if line[1] == "R":
        _restore(chip, line)
    elif line == "$N":
        for index, text in enumerate(chip.memory.startup):
            chip.say(f"$N{index}={text}\r\n")
    elif line[1] in "#SI":
        _plain(chip, line)
    else:
        _store_setting(chip, line)
    return 0


def _plain(chip: Chip, line: str) -> None:
    if line == "$#":
        chip.say(status.parameters(chip))
    elif line == "$SLP":
        chip.signals |= Signal.SLEEP
    elif line == "$I":
        chip.say(status.build(chip))
    elif line.startswith("$I="):
        chip.write_memory(len(line) - 2)
        chip.memory.build = line[3:]
    else:
        raise GcodeError(INVALID_STATEMENT)


def _home(chip: Chip, line: str) -> Answer:
    if not chip.settings[22]:
        return HOMING_IS_OFF
    if line != "$H":
        return INVALID_STATEMENT
    yield from home(chip)
    if not chip.abort:
        yield from run_startup(chip)
    return 0


def run_startup(chip: Chip) -> Generator[Wait, None, None]:
    """The lines $N0 and $N1, behind the banner and after homing."""
    for text in chip.memory.startup:
        if text:
            code = yield from run_gcode(chip, text)
            chip.say(f">{text}:{f'error:{code}' if code else 'ok'}\r\n")


def _store_startup(chip: Chip, line: str) -> Answer:
    if chip.state is not State.IDLE:
        return NOT_IDLE
    number, at = read_number(line, 2)
    if line[at : at + 1] != "=":
        return INVALID_STATEMENT
    text, index = line[at + 1 :], int(number)
    code = yield from run_gcode(chip, text)
    if code:
        return code
    yield from synchronize(chip)
    if not chip.abort and 0 <= index < len(chip.memory.startup):
        if text != chip.memory.startup[index]:
            chip.write_memory(max(len(text), len(chip.memory.startup[index])) + 1)
        chip.memory.startup[index] = text
    return 0


def _restore(chip: Chip, line: str) -> None:
    if line not in ("$RST=$", "$RST=#", "$RST=*"):
        raise GcodeError(INVALID_STATEMENT)
    if line[-1] in "$*":
        chip.settings.restore()
    if line[-1] in "#*":
        chip.memory.restore_places()
    if line[-1] == "*":
        chip.memory.startup, chip.memory.build = ["", ""], ""
    chip.say("[MSG:Restoring defaults]\r\n")
    chip.reset()


def _store_setting(chip: Chip, line: str) -> None:
    number, at = read_number(line, 1)
    if line[at : at + 1] != "=":
        raise GcodeError(INVALID_STATEMENT)
    value, end = read_number(line, at + 1)
    if end != len(line) or number > 255:
        raise GcodeError(INVALID_STATEMENT)
    chip.write_memory(chip.settings.store(int(number), value))
    chip.lookahead.load_settings()
    if int(number) == 13:
        chip.reports_to_wco = 0
