"""One line from a GRBL controller is one typed reply; what is not understood is `Unknown`, never an exception."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

Triple: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Ok:
    """The oldest unanswered line has been taken: parsed and planned, or done."""


@dataclass(frozen=True, slots=True)
class Error:
    """The oldest unanswered line has been refused whole; see `codes.ERRORS`."""

    code: int


@dataclass(frozen=True, slots=True)
class Alarm:
    """Motion has been stopped; see `codes.ALARMS`."""

    code: int


@dataclass(frozen=True, slots=True)
class Banner:
    """The controller has just started: `firmware` as in "Grbl 1.1h"."""

    firmware: str


@dataclass(frozen=True, slots=True)
class StatusReport:
    """The answer to `?`. Positions in the controller's report units: mm, or inch where setting 13 is 1.

    state: the word before the colon (Idle, Run, Hold, ...); detail: the digit behind it (Hold:0 stands, Hold:1 slows
    down). Of machine and work position a report carries one; offset = machine - work, now and then. line_number: the N
    of the line that is executed, where the build has it. feed_percent: the feed override, now and then.
    """

    state: str
    detail: int | None = None
    machine: Triple | None = None
    work: Triple | None = None
    offset: Triple | None = None
    free_blocks: int | None = None
    free_bytes: int | None = None
    line_number: int | None = None
    feed_percent: int | None = None

    @property
    def word(self) -> str:
        """State and detail as the controller writes them."""
        return self.state if self.detail is None else f"{self.state}:{self.detail}"


@dataclass(frozen=True, slots=True)
class Setting:
    """One line of `$$`."""

    number: int
    value: float


@dataclass(frozen=True, slots=True)
class Version:
    """`[VER:...]` of `$I`."""

    version: str


@dataclass(frozen=True, slots=True)
class Options:
    """`[OPT:...]` of `$I`: letters, blocks of the planner, bytes of the receive buffer."""

    letters: str
    planner_blocks: int
    buffer_bytes: int


@dataclass(frozen=True, slots=True)
class Message:
    """`[MSG:...]`."""

    text: str

    @property
    def locked(self) -> bool:
        """An alarm or the homing lock is active: G-code is refused."""
        return "to unlock" in self.text


@dataclass(frozen=True, slots=True)
class Feedback:
    """Any other bracketed line: `[GC:...]`, `[PRB:...]`, `[G54:...]`, `[echo:...]`."""

    kind: str
    text: str


@dataclass(frozen=True, slots=True)
class StartupLine:
    """`>LINE:ok` or `>LINE:error:N`: a stored line that ran at start; it answers nothing that we sent."""

    text: str


@dataclass(frozen=True, slots=True)
class Unknown:
    """A line that GRBL 1.1 does not say: noise, or another device."""

    text: str


Reply: TypeAlias = (
    Ok
    | Error
    | Alarm
    | Banner
    | StatusReport
    | Setting
    | Version
    | Options
    | Message
    | Feedback
    | StartupLine
    | Unknown
)

OK = Ok()

_NUMBER = r"[-+]?\d{1,12}(?:\.\d{1,12})?"
_FORMS = (
    re.compile(r"<(?P<report>[A-Z][a-z]{1,15})(?::(?P<detail>\d))?(?P<fields>(?:\|[^<>|]*)*)>"),
    re.compile(r"error:(?P<error>\d{1,4})"),
    re.compile(r"ALARM:(?P<alarm>\d{1,4})"),
    re.compile(r"(?P<banner>(?:Grbl|GrblHAL|grblHAL) \d[^ ]{0,20})(?: .*)?"),
    re.compile(rf"\$(?P<setting>\d{{1,4}})=(?P<value>{_NUMBER})(?: .*)?"),
    re.compile(r"\[(?P<bracket>[^\[\]]*)\]"),
    re.compile(r">(?P<startup>.*)"),
)
_TRIPLE = re.compile(rf"({_NUMBER}),({_NUMBER}),({_NUMBER})(?:,{_NUMBER})*")
_PAIR = re.compile(r"(\d{1,6}),(\d{1,6})")
_LINE_NUMBER = re.compile(r"(\d{1,8})")
_OVERRIDES = re.compile(r"(\d{1,3}),\d{1,3},\d{1,3}")
_OPTIONS = re.compile(r"([^,]*),(\d{1,6}),(\d{1,6})(?:,.*)?")


def parse(line: str) -> Reply:
    """The reply that `line` (without its end) is."""
    if line == "ok":
        return OK
    for form in _FORMS:
        if found := form.fullmatch(line):
            kind = next(iter(found.groupdict()))
            return _READERS[kind](found, line)
    return Unknown(line)


def _report(found: re.Match[str], line: str) -> Reply:
    try:
        known = dict(pair for field in found["fields"].split("|") for pair in _field(field))
    except ValueError:
        return Unknown(line)
    detail = None if found["detail"] is None else int(found["detail"])
    return StatusReport(found["report"], detail, **known)  # type: ignore[arg-type]


def _field(field: str) -> Iterator[tuple[str, Triple | int]]:
    """Named values of one `Name:values` field; none for a field that nobody here asks for."""
    name, _, values = field.partition(":")
    if name in _POSITIONS:
        yield _POSITIONS[name], _triple(values)
    elif name == "Bf":
        blocks, free = _numbers(_PAIR, values)
        yield "free_blocks", int(blocks)
        yield "free_bytes", int(free)
    elif name == "Ln":
        yield "line_number", int(_numbers(_LINE_NUMBER, values)[0])
    elif name == "Ov":
        yield "feed_percent", int(_numbers(_OVERRIDES, values)[0])


_POSITIONS = {"MPos": "machine", "WPos": "work", "WCO": "offset"}


def _triple(values: str) -> Triple:
    x, y, z = (float(number) for number in _numbers(_TRIPLE, values))
    return x, y, z


def _numbers(form: re.Pattern[str], values: str) -> tuple[str, ...]:
    found = form.fullmatch(values)
    if found is None:
        raise ValueError(values)
    return found.groups()


def _bracket(found: re.Match[str], line: str) -> Reply:
    kind, _, text = found["bracket"].partition(":")
    if kind == "MSG":
        return Message(text)
    if kind == "VER":
        return Version(text.partition(":")[0])
    if kind == "OPT" and (options := _OPTIONS.fullmatch(text)):
        return Options(options[1], int(options[2]), int(options[3]))
    return Feedback(kind, text)


_READERS: dict[str, Callable[[re.Match[str], str], Reply]] = {
    "report": _report,
    "error": lambda found, _: Error(int(found["error"])),
    "alarm": lambda found, _: Alarm(int(found["alarm"])),
    "banner": lambda found, _: Banner(found["banner"]),
    "setting": lambda found, _: Setting(int(found["setting"]), float(found["value"])),
    "bracket": _bracket,
    "startup": lambda found, _: StartupLine(found["startup"]),
}
