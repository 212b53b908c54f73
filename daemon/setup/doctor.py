"""What may stand between a picture and its drawing on this computer: one finding each, with its remedy."""

from __future__ import annotations

import grp
import hashlib
import json
import os
import re
import stat
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

PointMm: TypeAlias = tuple[float, float]
State: TypeAlias = Literal["ok", "better", "wrong"]

PLANNING_MB = 300.0
"""What the worker takes for a page of ten megapixels, and some air."""
FIRST_YEAR = 2025
"""No clock that is right shows an earlier one."""
_FIRMWARE_SETTING = re.compile(r"\$(\d+)=(-?[\d.]+)")
_TRAVEL = {0: 130, 1: 131}
"""GRBL's settings of how far X and Y go, in mm."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at. words: what is so and, where it is not well, behind the last colon what to do.

    "better": it draws like this, and would draw better otherwise.
    """

    name: str
    state: State
    words: str


def folder_finding(name: str, folder: Path, *, group: bool = False) -> Finding:
    """Whether this user may write there; a folder that is missing is made by the daemon where its parent allows it.

    group: others of its group drop files there, so the group is told.
    """
    there = folder
    while not there.exists() and there != there.parent:
        there = there.parent
    if not os.access(there, os.W_OK | os.X_OK) or not there.is_dir():
        owner = _owner(there)
        return Finding(name, "wrong", f"{folder} may not be written by this user: it belongs to {owner}; run this as "
                                    "that user or with sudo, or correct its rights")  # fmt: skip
    if there != folder:
        return Finding(name, "ok", f"{folder} will be made")
    status = folder.stat()
    shared = f", and by the group {_group(status.st_gid)}" if group and status.st_mode & stat.S_IWGRP else ""
    return Finding(name, "ok", f"{folder} can be written{shared}")


def disk_finding(folder: Path, *, free_mb: float) -> Finding:
    """Room on the disk of the jobs. free_mb: with less no picture is taken any more."""
    there = folder
    while not there.exists() and there != there.parent:
        there = there.parent
    disk = os.statvfs(there)
    left_mb, nodes = disk.f_bavail * disk.f_frsize / 1e6, disk.f_favail
    if left_mb < free_mb:
        return Finding("disk", "wrong", f"{left_mb:.0f} MB are free at {there}, and below {free_mb:g} MB no picture is "
                                      "taken: free some, or lower free_mb in [keep]")  # fmt: skip
    if disk.f_files and nodes < 1000:
        return Finding("disk", "wrong", f"only {nodes} more files find room at {there}: remove some")
    return Finding("disk", "ok", f"{left_mb:.0f} MB are free at {there}")


def memory_finding(meminfo: str) -> Finding:
    """meminfo: /proc/meminfo."""
    known = dict(re.findall(r"^(\w+):\s+(\d+) kB", meminfo, re.MULTILINE))
    left_mb = (int(known.get("MemAvailable", 0)) + int(known.get("SwapFree", 0))) / 1024
    if left_mb < PLANNING_MB:
        return Finding("memory", "wrong", f"{left_mb:.0f} MB are left and a large page takes {PLANNING_MB:.0f} MB: end "
                                        "other programs, or add swap")  # fmt: skip
    return Finding("memory", "ok", f"{left_mb:.0f} MB are left")


def clock_finding(now_s: float, *, newest_s: float = 0.0) -> Finding:
    """now_s: seconds since 1970. newest_s: when something was last written here."""
    said = time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime(now_s))
    if time.gmtime(now_s).tm_year < FIRST_YEAR or newest_s > now_s + 86400:
        return Finding("clock", "wrong", f"it shows {said}, which was long ago: connect the network until the time is "
                                       "set (`timedatectl`), or set it with `sudo date -s`")  # fmt: skip
    return Finding("clock", "ok", said)


def network_finding(models: Path) -> Finding:
    """The networks that read pages: there, and those that were shipped. models: the folder of their manifests."""
    sound = []
    for manifest in sorted(models.glob("*.json")):
        told = json.loads(manifest.read_text(encoding="utf-8"))
        file = models / told["file"]
        if not file.is_file() or hashlib.sha256(file.read_bytes()).hexdigest() != told["sha256"]:
            return Finding("network", "wrong", f"{file} is not the one that was shipped: install linedrawd again")
        sound.append(f"{file.name}, {file.stat().st_size / 1e6:.1f} MB")
    if sound:
        return Finding("network", "ok", "; ".join(sound))
    return Finding("network", "wrong", f"{models} holds no network: install linedrawd again")


def port_finding(name: str, path: str) -> Finding:
    """Whether this user may open a port that is there. name: of the machine."""
    try:
        group = _group(os.stat(path).st_gid)
    except OSError:
        return Finding(f"{name} port", "wrong", f"there is no port {path}: plug the machine in, `linedrawd usb` tells "
                                              "what is plugged in")  # fmt: skip
    if not os.access(path, os.R_OK | os.W_OK):
        return Finding(f"{name} port", "wrong", f"{path} may not be opened: `sudo adduser USER {group}`, then log in "
                                              "again")  # fmt: skip
    return Finding(f"{name} port", "ok", f"{path}, group {group}")


def usb_findings(told: Iterable[Sequence[str]]) -> Iterator[Finding]:
    """told: of each device that matters a line, and one for each thing that is wrong with it."""
    for what, *wrong in told:
        yield from (Finding("usb", "wrong", f"{' '.join(what.split())}: {words.strip()}") for words in wrong)


def answer_findings(name: str, lines: Sequence[str]) -> Iterator[Finding]:
    """What a machine said of itself, as `linedrawd machine check` tells it."""
    told = dict(line.split(": ", 1) for line in lines if ": " in line and not line.startswith("$"))
    who = told.get("firmware") or told.get("link") or "it is there"
    yield Finding(f"{name} answers", "ok", f"{who}, pen at {told.get('pen at', 'a place it does not say')}")
    wanted = "wanted otherwise: "
    yield from (
        Finding(f"{name} firmware", "better", line.removeprefix(wanted)) for line in lines if line.startswith(wanted)
    )


def limit_findings(
    name: str, lines: Sequence[str], *, reach_mm: PointMm, needed_mm: Sequence[PointMm]
) -> Iterator[Finding]:
    """Whether the machine's own limits leave room for the box of the sheet. needed_mm: the corners of that box.

    A controller that says nothing of its limits is taken by the settings' reach_mm alone.
    """
    known = dict(_FIRMWARE_SETTING.findall("\n".join(lines)))
    for axis, letter in enumerate("XY"):
        reached = [abs(corner[axis]) for corner in needed_mm]
        own = float(known[str(_TRAVEL[axis])]) if str(_TRAVEL[axis]) in known else None
        if own is not None and own < max(reached):
            words = (
                f"{letter} goes {own:g} mm by its ${_TRAVEL[axis]} and the sheet's box needs {max(reached):g} mm: make "
                f"box_mm smaller, or correct ${_TRAVEL[axis]}"
            )
            yield Finding(f"{name} limits", "wrong", words)
        elif own is not None and own < reach_mm[axis]:
            words = (
                f"{letter} goes {own:g} mm by its ${_TRAVEL[axis]}: set reach_mm to that, it says {reach_mm[axis]:g}"
            )
            yield Finding(f"{name} limits", "better", words)


def as_json(findings: Sequence[Finding]) -> str:
    """A list, in the order in which things were looked at."""
    told: list[Mapping[str, object]] = [
        {"name": each.name, "state": each.state, "words": each.words} for each in findings
    ]
    return json.dumps(told, indent=1, ensure_ascii=False)


def _group(number: int) -> str:
    try:
        return grp.getgrgid(number).gr_name
    except KeyError:
        return str(number)


def _owner(path: Path) -> str:
    try:
        return path.owner()
    except (KeyError, OSError):
        return "somebody else"
