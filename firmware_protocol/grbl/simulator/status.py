"""What the simulated controller prints about itself: `report.c` of GRBL 1.1h."""

from __future__ import annotations

from firmware_protocol.grbl.simulator.chip import Chip, State, Suspend
from firmware_protocol.grbl.simulator.lookahead import BLOCKS, Vector
from firmware_protocol.grbl.simulator.modal import MM_PER_INCH
from firmware_protocol.grbl.simulator.settings import fixed

BANNER = "\r\nGrbl 1.1h ['$' for help]\r\n"
HELP = "[HLP:$$ $# $G $I $N $x=val $Nx=line $J=line $SLP $C $X $H ~ ! ? ctrl-x]\r\n"

_BUSY = (State.HOMING, State.RUN, State.HOLD, State.JOG, State.DOOR)


def report(chip: Chip) -> str:
    """The answer to `?`; counts the reports until WCO and Ov are due again."""
    position, _ = chip.stepper.now_at()
    position = chip.lookahead.millimetres(chip.lookahead.steps(position))
    mask, offset = int(chip.settings[10]), chip.interpreter.modal.offset_mm
    fields = [_state(chip)]
    if mask & 1:
        fields.append(f"MPos:{_place(chip, position)}")
    else:
        x, y, z = (p - o for p, o in zip(position, offset, strict=True))
        fields.append(f"WPos:{_place(chip, (x, y, z))}")
    if mask & 2:
        fields.append(f"Bf:{BLOCKS - len(chip.lookahead.blocks)},{chip.inbound.free}")
    fields.append(f"FS:{_feed(chip)},{fixed(chip.spindle_rpm, 0)}")
    fields += _pins(chip) + _in_turn(chip, offset)
    return f"<{'|'.join(fields)}>\r\n"


def parameters(chip: Chip) -> str:
    """What `$#` prints."""
    modal, names = chip.interpreter.modal, ("G54", "G55", "G56", "G57", "G58", "G59", "G28", "G30")
    lines = [f"[{name}:{_place(chip, place)}]" for name, place in zip(names, chip.memory.places, strict=True)]
    lines.append(f"[G92:{_place(chip, modal.shift_mm)}]")
    lines.append(f"[TLO:{_length(chip, modal.tool_length_mm)}]")
    return "".join(line + "\r\n" for line in lines) + probe(chip)


def probe(chip: Chip) -> str:
    """Where the probe touched, and whether it did."""
    return f"[PRB:{_place(chip, chip.probe_mm)}:{int(chip.probed)}]\r\n"


def modal_state(chip: Chip) -> str:
    """What `$G` prints."""
    return chip.interpreter.modal.line(report_inches=bool(chip.settings[13])) + "\r\n"


def build(chip: Chip) -> str:
    """What `$I` prints."""
    return f"[VER:1.1h.20190825:{chip.memory.build}]\r\n[OPT:V,15,128]\r\n"


def _state(chip: Chip) -> str:
    suspend, word = chip.suspend, chip.state.value
    if chip.state is State.HOLD:
        if Suspend.JOG_CANCELLED in suspend:
            return State.JOG.value
        return f"{word}:{0 if Suspend.HOLD_COMPLETE in suspend else 1}"
    if chip.state is State.DOOR:
        if Suspend.RESTORING in suspend:
            return f"{word}:3"
        if Suspend.RETRACTED in suspend:
            return f"{word}:{1 if Suspend.DOOR_AJAR in suspend else 0}"
        return f"{word}:2"
    return word


def _feed(chip: Chip) -> str:
    mm_min = chip.stepper.speed_mm_s * 60 if chip.state in _BUSY else 0.0
    return fixed(mm_min / MM_PER_INCH, 1) if chip.settings[13] else fixed(mm_min, 0)


def _pins(chip: Chip) -> list[str]:
    letters = "P" if chip.contact else ""
    letters += "".join("XYZ"[axis] for axis in sorted(chip.limits))
    letters += "".join(pin[0].upper() for pin in ("reset", "hold", "start") if pin in chip.inputs.pins)
    return [f"Pn:{letters}"] if letters else []


def _in_turn(chip: Chip, offset: Vector) -> list[str]:
    busy, fields = chip.state in _BUSY, []
    if chip.reports_to_wco > 0:
        chip.reports_to_wco -= 1
    else:
        chip.reports_to_wco = 29 if busy else 9
        chip.reports_to_overrides = chip.reports_to_overrides or 1
        fields.append(f"WCO:{_place(chip, offset)}")
    if chip.reports_to_overrides > 0:
        chip.reports_to_overrides -= 1
    else:
        chip.reports_to_overrides = 19 if busy else 9
        fields += [f"Ov:{chip.feed_percent},{chip.rapid_percent},{chip.spindle_percent}", *_accessories(chip)]
    return fields


def _accessories(chip: Chip) -> list[str]:
    spindle = {3: "S", 4: "C"}.get(chip.spindle_direction, "") if chip.spindle_rpm else ""
    letters = spindle + ("F" if chip.flood else "")
    return [f"A:{letters}"] if letters else []


def _place(chip: Chip, place: Vector) -> str:
    return ",".join(_length(chip, value) for value in place)


def _length(chip: Chip, value_mm: float) -> str:
    return fixed(value_mm / MM_PER_INCH, 4) if chip.settings[13] else fixed(value_mm, 3)
