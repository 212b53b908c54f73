"""What `linedrawd watch` shows: the machine, the job, how far it has come, and the last messages."""

from __future__ import annotations

import calendar
import time
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from daemon.cli.braille import DIM, PLAIN, Line, braille

BOLD, RED = "\x1b[1m", "\x1b[31m"
MESSAGES = 5
_BLOCKS = " ▏▎▍▌▋▊▉█"
_BAR_COLUMNS = 24
_LEVELS = {"WARNING": BOLD, "ERROR": RED}


@dataclass(frozen=True, slots=True)
class Size:
    """Of the terminal, in letters. colour: it understands styles."""

    columns: int
    rows: int
    colour: bool = True


def of_machine(said: dict[str, Any], machine: str) -> dict[str, Any]:
    """What status.json holds, of this one machine; as it stands where it holds no such machine."""
    return {**said, **(said.get("machines") or {}).get(machine, {})}


def shown(said: dict[str, Any]) -> str:
    """The machine whose drawing is shown where nobody has named one: the first that has a job, or the first."""
    machines = said.get("machines") or {}
    return next((name for name, each in machines.items() if each.get("job")), next(iter(machines), ""))


def view(
    said: dict[str, Any],
    lines: Sequence[Line],
    messages: Sequence[str],
    size: Size,
    *,
    wall_s: float,
    runs: bool,
    machine: str = "",
) -> list[str]:
    """The rows of the view, each no wider than the terminal and none too many.

    said: what status.json holds. lines: the strokes of the job in drawing order, y down. messages: lines of the log.
    wall_s: seconds since 1970. runs: whether the daemon does. machine: the one whose drawing is shown, and of which
    the lines are; the others have a row or two each.
    """
    others = [of_machine(said, name) | {"machine": name} for name in said.get("machines") or {} if name != machine]
    said = of_machine(said, machine) | ({"machine": machine} if machine else {})
    head = [row for other in others for row in _other(other, size, wall_s, runs=runs)]
    head += [_machine(said, size, runs=runs), *_job(said, size, wall_s)]
    worn = [_styled(str(said["pen"]), RED, size)] if said.get("pen") else []
    foot = [*worn, _styled(_queue(said), "", size), *(_message(line, size) for line in messages[-MESSAGES:])]
    room = size.rows - len(head) - len(foot) - 2
    done = int(said.get("strokes_done") or 0)
    picture = braille(lines, done, columns=size.columns, rows=room, colour=size.colour) if said.get("job") else []
    rows = [*head, "", *picture, "", *foot] if picture else [*head, "", *foot]
    return rows[: size.rows]


def progress_in_words(said: dict[str, Any], wall_s: float) -> str:
    """How far the job has come, in one line; "" where none is drawn."""
    if not said.get("job"):
        return ""
    percent, done, total = (said.get(key) or 0 for key in ("percent", "strokes_done", "strokes_total"))
    words = [f"{percent:5.1f} %", f"{done} of {total} strokes"]
    left_s = seconds_left(said, wall_s)
    return "   ".join([*words, f"{in_words(left_s)} left"] if left_s is not None else words)


def seconds_left(said: dict[str, Any], wall_s: float) -> float | None:
    """As it was said, less what has passed since then while it draws. None where nobody knows."""
    left_s = said.get("seconds_left")
    if left_s is None:
        return None
    passed_s = wall_s - _seconds(str(said.get("changed", ""))) if said.get("state") == "drawing" else 0.0
    return max(0.0, float(left_s) - max(0.0, passed_s))


def in_words(seconds: float) -> str:
    """A time as people say it: 2 h 05 min, 4 min 12 s, 9 s."""
    whole = round(seconds)
    hours, minutes = divmod(whole // 60, 60)
    if hours:
        return f"{hours} h {minutes:02d} min"
    return f"{minutes} min {whole % 60:02d} s" if minutes else f"{whole} s"


def printable(text: str) -> str:
    """Without what would move the cursor or change the terminal."""
    return "".join(letter if letter.isprintable() else "·" for letter in text)


def _seconds(clock: str) -> float:
    try:
        return float(calendar.timegm(time.strptime(clock, "%Y-%m-%dT%H:%M:%SZ")))
    except ValueError:
        return float("inf")


def _machine(said: dict[str, Any], size: Size, *, runs: bool) -> str:
    if not runs:
        return _styled("no daemon runs; this is what the last one said", RED, size)
    state = ", ".join(str(said[key]) for key in ("state", "reason") if said.get(key)) or "?"
    parts = [f"{said.get('machine') or 'no machine'}: {state}", said.get("port"), said.get("firmware")]
    return _styled("   ".join(str(part) for part in parts if part), BOLD, size)


def _other(said: dict[str, Any], size: Size, wall_s: float, *, runs: bool) -> list[str]:
    rows = [_machine(said, size, runs=True)] if runs else []
    if said.get("job"):
        rows.append(_styled(f"{said['job']}   {said.get('picture', '')}   {progress_in_words(said, wall_s)}", "", size))
    elif said.get("words"):
        rows.append(_styled(str(said["words"]), RED if said.get("held") else "", size))
    return rows


def _job(said: dict[str, Any], size: Size, wall_s: float) -> list[str]:
    rows = [_styled(str(said["words"]), RED if said.get("held") else "", size)] if said.get("words") else []
    if said.get("job"):
        rows.append(_styled(f"{said['job']}   {said.get('picture', '')}", "", size))
        rows.append(_styled(f"{_bar(float(said.get('percent') or 0))}  {progress_in_words(said, wall_s)}", "", size))
    return rows


def _bar(percent: float) -> str:
    eighths = round(min(max(percent, 0.0), 100.0) / 100 * _BAR_COLUMNS * 8)
    full, part = divmod(eighths, 8)
    return ("█" * full + (_BLOCKS[part] if part else "")).ljust(_BAR_COLUMNS, "░")


def _queue(said: dict[str, Any]) -> str:
    parts = [f"{said.get('jobs_queued') or 0} queued, {said.get('jobs_waiting') or 0} planned and waiting"]
    if said.get("jobs_to_approve"):
        parts.append(f"{said['jobs_to_approve']} to approve")
    if said.get("planning"):
        parts.append(f"planning {said['planning']} ({said.get('stage') or 'begins'})")
    if said.get("ink_m"):
        parts.append(f"the pen has drawn {said['ink_m']:g} m")
    return "   ".join(parts)


def _message(line: str, size: Size) -> str:
    """A line of the log: its time of day, its job, its words; loud ones stand out."""
    at, level, job, words = [*line.split(" ", 3), "", "", ""][:4]
    of_day = at[11:19] if len(at) == 20 else at
    return _styled(f"{of_day}  {'' if job == '-' else job + '  '}{words}", _LEVELS.get(level, DIM), size)


def _styled(text: str, style: str, size: Size) -> str:
    cut = _cut(printable(text), size.columns)
    return f"{style}{cut}{PLAIN}" if style and size.colour else cut


def _cut(text: str, columns: int) -> str:
    """What fits, with … for the rest; wide letters take two columns, combining ones none."""
    if sum(map(_columns, text)) <= columns:
        return text
    room, kept = columns - 1, []
    for letter in text:
        room -= _columns(letter)
        if room < 0:
            break
        kept.append(letter)
    return "".join(kept) + "…"


def _columns(letter: str) -> int:
    if unicodedata.combining(letter):
        return 0
    return 2 if unicodedata.east_asian_width(letter) in "WF" else 1
