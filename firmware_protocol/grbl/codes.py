"""What the error and alarm numbers of GRBL 1.1 mean, and what a person can do about each.

Numbers as in the Grbl 1.1 interface document, meanings as provoked on Grbl 1.1h.20190825.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Code:
    """One number: what it means, and what to do."""

    meaning: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.meaning}: {self.remedy}"


_REPORT = "report this program line as a fault of linedrawd"
_DIALECT = "use a program dialect that GRBL knows"
_WAIT = "wait until the machine stands still and try again"
_POWER = "look what blocks the machine, then switch the controller off and on, or home it"
_CABLE = "shorten or shield the cable and keep it away from the motors, then draw again"

ERRORS = {
    1: Code("a word does not begin with a letter GRBL knows", _CABLE),
    2: Code("a number is missing or badly written", _CABLE),
    3: Code("GRBL does not know this $ command", _DIALECT),
    4: Code("a value is negative that must not be", _REPORT),
    5: Code("homing is switched off", 'fit limit switches and set $22=1, or set origin = "here"'),
    6: Code("the step pulse is shorter than 3 us", "set $0 to 3 or more"),
    7: Code("the stored settings were damaged and have been reset", "write the machine's settings again"),
    8: Code("this $ command is only taken while the machine stands still", _WAIT),
    9: Code("G-code is locked out by an alarm or a jog", _POWER),
    10: Code("soft limits need homing", "set $22=1 first, or $20=0"),
    11: Code("the line is longer than 79 characters", _REPORT),
    12: Code("a setting asks for more steps a second than the controller can make", "lower $100-$102 or $110-$112"),
    13: Code("the safety door is open", "close the door"),
    14: Code("a stored line is too long", "shorten the build info or start-up line"),
    15: Code("a jog leaves the travel of the machine", "stay within $130-$132"),
    16: Code("a jog without = or with a forbidden word", _REPORT),
    17: Code("laser mode needs a PWM output", "set $32=0"),
    20: Code("GRBL does not know this command", _DIALECT),
    21: Code("two commands of one modal group stand in a line", _CABLE),
    22: Code("no feed rate has been set", _REPORT),
    23: Code("a command needs a whole number", _DIALECT),
    24: Code("two commands in a line want the axis words", _CABLE),
    25: Code("a word stands twice in the line", _CABLE),
    26: Code("a command misses its axis words", _CABLE),
    27: Code("the line number is out of range", _REPORT),
    28: Code("a command misses its P or L value", _REPORT),
    29: Code("there is no such work coordinate system", "use G54 to G59"),
    30: Code("G53 goes with G0 and G1 only", _REPORT),
    31: Code("axis words that nothing uses", _CABLE),
    32: Code("an arc misses its axis words", _CABLE),
    33: Code("the end of the arc does not lie on its circle", _CABLE),
    34: Code("the radius of the arc is too small", _CABLE),
    35: Code("an arc misses I, J or K", _CABLE),
    36: Code("words that nothing uses", _CABLE),
    37: Code("the tool length goes to another axis than the configured one", _DIALECT),
    38: Code("the tool number is too big", "use T0 to T255"),
}

ALARMS = {
    1: Code("a limit switch was hit, the position is lost", _POWER),
    2: Code("the target lies outside the travel of the machine", "scale the page, move its origin or check $130-$132"),
    3: Code("a reset during motion, steps may be lost", _POWER),
    4: Code("the probe was not in the state it should start from", "check the probe"),
    5: Code("the probe found no contact", "check the probe"),
    6: Code("homing was cut short by a reset", "home the machine again"),
    7: Code("the safety door was opened during homing", "close the door and home again"),
    8: Code("the limit switch did not open when homing backed off", "raise $27 or check the switch"),
    9: Code("homing found no limit switch", "check the switches, $23 and $130-$132"),
    10: Code("homing found only one switch of a doubled axis", "check the second switch"),
}

POSITION_KEPT = frozenset({2, 4, 5})
"""Alarms after which the controller still knows where it stands."""


def error(code: int) -> Code:
    """The meaning of `error:code`."""
    return ERRORS.get(code, Code("this controller's own error", "look it up in the controller's manual"))


def alarm(code: int) -> Code:
    """The meaning of `ALARM:code`."""
    return ALARMS.get(code, Code("this controller's own alarm", "look it up in the controller's manual"))
