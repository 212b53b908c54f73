"""When each line of a program will have been executed by an arm, as the simulated one moves."""

from __future__ import annotations

from collections.abc import Sequence

from firmware_protocol.dobot.commands import Command, parse
from firmware_protocol.dobot.simulator import moves
from firmware_protocol.dobot.simulator.motion import Move
from firmware_protocol.ink import Vector

_PTP, _CP, _CPLE, _WAIT = 84, 91, 92, 110


def line_times_s(lines: Sequence[str]) -> list[float]:
    """The time in s from the start at which each line has been executed; the arm begins where it is homed to.

    Lines are commands as text. Homing takes no time: nobody knows from where it begins. Raises LocalProtocolError for
    a line that is no command, ValueError for a target that is out of reach.
    """
    settings = dict(moves.DEFAULTS)
    x, y, z, _ = map(float, settings[moves.HOME_PARAMS])
    at, now, times = (x, y, z), 0.0, []
    for number, line in enumerate(lines, 1):
        asked = parse(line)
        if asked.kind.id in settings:
            settings[asked.kind.id] = asked.values
        try:
            way = _way(asked, at, settings)
        except moves.OutOfReach as error:
            raise ValueError(f"line {number} ({line!r}) is out of reach, alarm {error.code:#04x}") from error
        now += sum(move.seconds for move in way)
        now += float(asked.values[0]) / 1000 if asked.kind.id == _WAIT else 0.0
        at = way[-1].way[-1] if way else at
        times.append(now)
    return times


def _way(asked: Command, at: Vector, settings: moves.Settings) -> list[Move]:
    if asked.kind.id == _PTP:
        return moves.ptp(asked, at, settings)
    return moves.cp(asked, at, settings) if asked.kind.id in {_CP, _CPLE} else []
