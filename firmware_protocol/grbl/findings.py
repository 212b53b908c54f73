"""What a controller's settings would do to a drawing, and the command that mends it.

Settings as the Grbl 1.1 interface document numbers them, effects as observed on Grbl 1.1h.20190825.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from firmware_protocol.grbl.path import Path, extent_mm
from firmware_protocol.grbl.replies import Triple
from firmware_protocol.session import Finding

ORIGIN: Triple = (0.0, 0.0, 0.0)

REPORTS = 3
"""$10: machine position and the free room of planner and buffer, by which a lost answer is noticed at once."""
ALWAYS_ON_MS = 255


@dataclass(frozen=True, slots=True)
class Needs:
    """What a program asks of the controller.

    extent_mm: lowest and highest place in the coordinates of the program; None when it does not move.
    speeds: its S values, 0 left out. travel: see `Travel`; None leaves the travel unchecked.
    """

    extent_mm: tuple[Triple, Triple] | None = None
    speeds: frozenset[float] = frozenset()
    offset_mm: Triple = ORIGIN
    firmware: str = "Grbl 1.1h"
    letters: str = ""


def needs_of(path: Path, *, offset_mm: Triple = ORIGIN, firmware: str = "Grbl 1.1h", letters: str = "") -> Needs:
    """What the program of `path` needs.

    offset_mm: machine coordinates of X0 Y0 Z0 (WCO). firmware: as in the banner. letters: of `[OPT:`.
    """
    speeds = frozenset(step.after.speed for step in path.steps if step.after.spindle != 5) - {0.0}
    return Needs(extent_mm(path), speeds, offset_mm, firmware, letters)


def findings(settings: Mapping[int, float], needs: Needs) -> list[Finding]:
    """Everything that deviates, the settings in their order; a setting that the controller does not have is no finding.

    settings: `$` numbers to values, as `$$` lists them.
    """
    return [
        *_firmware(needs.firmware),
        *_idle_delay(settings),
        *_reports(settings),
        *_limits(settings, needs),
        *_servo(settings, needs.speeds),
    ]


def _firmware(firmware: str) -> Iterator[Finding]:
    name, _, version = firmware.partition(" ")
    if name != "Grbl":
        yield Finding("firmware", f"{firmware} speaks like GRBL 1.1, but its limits and codes may differ")
    elif not version.startswith("1.1"):
        yield Finding("firmware", f"{firmware} is not the GRBL 1.1 that this program was tried with: flash GRBL 1.1h")


def _idle_delay(settings: Mapping[int, float]) -> Iterator[Finding]:
    delay_ms = settings.get(1, ALWAYS_ON_MS)
    if delay_ms != ALWAYS_ON_MS:
        why = f"$1={delay_ms:g} switches the motors off {delay_ms:g} ms after each stop, so also while the pen waits"
        yield Finding("$1", f"{why}: keep them on with $1=255", "$1=255")


def _reports(settings: Mapping[int, float]) -> Iterator[Finding]:
    mask = int(settings.get(10, REPORTS))
    if not mask & 2:
        why = f"$10={mask} leaves the room in the buffer out of the reports, so a lost answer is noticed late"
        yield Finding("$10", f"{why}: report it with $10=3", "$10=3")
    if settings.get(13, 0.0) != 0:
        yield Finding("$13", "$13=1 makes the reports inches: they are read, but mm are finer: $13=0", "$13=0")


def _servo(settings: Mapping[int, float], speeds: frozenset[float]) -> Iterator[Finding]:
    if not speeds:
        return
    highest, lowest = settings.get(30, 1000.0), settings.get(31, 0.0)
    if lowest >= highest:
        why = f"$31={lowest:g} is not below $30={highest:g}, so every S means full: the pen would not move"
        yield Finding("$31", f"{why}: set $31=0", "$31=0", blocks=True)
    elif min(speeds) < lowest:
        why = f"the pen wants S{min(speeds):g} and $31={lowest:g} is the least that the servo gets"
        yield Finding("$31", f"{why}: set $31=0", "$31=0", blocks=True)
    if max(speeds) > highest:
        why = f"the pen wants S{max(speeds):g} and $30={highest:g} is the most that the servo gets"
        yield Finding("$30", f"{why}: set $30={max(speeds):g} or smaller S values", f"$30={max(speeds):g}", blocks=True)
    if settings.get(32, 0.0) != 0:
        why = "$32=1 is laser mode, which switches a servo off whenever the pen travels"
        yield Finding("$32", f"{why}: set $32=0", "$32=0", blocks=True)


def _limits(settings: Mapping[int, float], needs: Needs) -> Iterator[Finding]:
    if needs.extent_mm is None:
        return
    homes, soft = settings.get(22, 0.0) != 0, settings.get(20, 0.0) != 0
    for axis, letter in enumerate("XYZ"):
        travel_mm = settings.get(130 + axis)
        if travel_mm is None:
            continue
        low, high = (end[axis] for end in needs.extent_mm)
        if homes:
            yield from _beyond(settings, needs, axis, soft=soft)
        elif axis < 2 and high - low > travel_mm:
            why = f"the drawing is {high - low:g} mm long in {letter} and ${130 + axis}={travel_mm:g} is the travel"
            yield Finding(f"${130 + axis}", f"{why}: scale the page, or state the true travel")


def _beyond(settings: Mapping[int, float], needs: Needs, axis: int, *, soft: bool) -> Iterator[Finding]:
    """A homed axis knows where its ends are. Heights only count where the controller itself watches them."""
    if needs.extent_mm is None or (axis == 2 and not soft):
        return
    travel_mm, offset_mm, letter = settings[130 + axis], needs.offset_mm[axis], "XYZ"[axis]
    low, high = (end[axis] + offset_mm for end in needs.extent_mm)
    least, most = _range_mm(settings, needs.letters, axis)
    if low >= least - _SLACK_MM and high <= most + _SLACK_MM:
        return
    why = (
        f"the drawing reaches from {low:g} to {high:g} mm in machine {letter} and the machine "
        f"from {least:g} to {most:g} mm (${130 + axis}={travel_mm:g}, work offset {offset_mm:g})"
    )
    command = f"G10 L2 P1 {letter}{least:g}" if high - low <= travel_mm and not needs.extent_mm[0][axis] < 0 else ""
    remedy = f"put its origin there with `{command}`" if command else "scale the page or move its origin"
    yield Finding(f"travel {letter}", f"{why}: {remedy}", command, blocks=True)


_SLACK_MM = 0.002
"""A report's last digit and a motor step."""


def _range_mm(settings: Mapping[int, float], letters: str, axis: int) -> tuple[float, float]:
    """Machine coordinates count below zero from the switch; a build with Z in `[OPT:` may count above it."""
    travel_mm, towards_low = settings[130 + axis], int(settings.get(23, 0.0)) >> axis & 1
    return (0.0, travel_mm) if "Z" in letters and towards_low else (-travel_mm, 0.0)
