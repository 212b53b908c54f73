"""What somebody answers when a machine is set up, as settings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from daemon.errors import SettingsError

MARGIN_MM = 15.0
"""Kept free at the edges of a sheet: clips hold it there, and the pen's holder needs room."""


@dataclass(frozen=True, slots=True)
class Answers:
    """name: of the machine's section. sheet_mm: as it lies under the pen; None for an arm, which has a box of its own.

    shares: there are other machines, so the box stands in its own section, not in [sheet].
    reach_mm, origin: None where the device does not ask for them. origin_mm: of a homed machine. pen_up, pen_down: mm
    of a pen on Z, S words of a servo.
    """

    name: str
    device: Literal["grbl", "emco", "dobot"]
    url: str
    pen: Literal["z", "servo"]
    pen_up: float
    pen_down: float
    sheet_mm: tuple[float, float] | None = None
    reach_mm: tuple[float, float] | None = None
    origin: Literal["here", "homed"] | None = None
    origin_mm: tuple[float, float] = (0.0, 0.0)
    shares: bool = False


def settings_from(answers: Answers) -> dict[str, dict[str, Any]]:
    """By section and key. Raises SettingsError where sheet and reach leave no box."""
    machine: dict[str, Any] = {"device": answers.device, "url": answers.url}
    if answers.reach_mm:
        machine["reach_mm"] = list(answers.reach_mm)
    if answers.origin:
        machine |= {"origin": answers.origin, "home": "start" if answers.origin == "homed" else "never"}
    if answers.origin == "homed":
        machine["origin_mm"] = list(answers.origin_mm)
    ends = ("up_mm", "down_mm") if answers.pen == "z" else ("up_s", "down_s")
    pen = {"kind": answers.pen, ends[0]: answers.pen_up, ends[1]: answers.pen_down}
    sections = {f"machines.{answers.name}": machine, f"machines.{answers.name}.pen": pen}
    if answers.sheet_mm:
        box_mm = list(_box_mm(answers.sheet_mm, answers.reach_mm))
        box = {"box_mm": box_mm, "box_origin_mm": [MARGIN_MM, MARGIN_MM]}
        sections[f"machines.{answers.name}" if answers.shares else "sheet"] = (machine if answers.shares else {}) | box
    return sections


def _box_mm(sheet_mm: tuple[float, float], reach_mm: tuple[float, float] | None) -> tuple[float, float]:
    """All of the sheet inside its margin that the machine reaches."""
    reached = reach_mm or sheet_mm
    width, height = (min(side - 2 * MARGIN_MM, far - MARGIN_MM) for side, far in zip(sheet_mm, reached, strict=True))
    if min(width, height) <= 0:
        raise SettingsError(
            f"a sheet of {sheet_mm[0]:g} x {sheet_mm[1]:g} mm leaves no room inside its margin of {MARGIN_MM:g} mm "
            "that the machine reaches: say a larger --paper or --reach"
        )
    return width, height
