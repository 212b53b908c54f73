"""`linedrawd status` and `jobs`: what it does now and what it has done, read from files only."""

from __future__ import annotations

import argparse
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from daemon.cli.options import add_places, settings_of
from daemon.errors import LinedrawError
from daemon.jobs.record import read_record
from daemon.jobs.states import Reason, State, meaning_of
from daemon.status import JOB_LOG_NAME

_LINE = re.compile(
    r"(?P<time>\S+) \w+ \S+ (?P<words>.*?) state=(?P<state>\w+)"
    r'(?: reason=(?:"(?P<quoted>[^"\\]*)"|(?P<reason>[^\s"]+)))?'
)
_FIGURES = ("strokes", "drawn_mm", "travelled_mm", "estimated_s", "real_s", "warnings")
_NAME = re.compile(r' name=("(?:[^"\\]|\\.)*"|\S+)')


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "status",
        help="what the daemon does now",
        description="What the daemon does now, or did last. The exit code is 1 when none runs.",
        epilog="example:\n  linedrawd status --state-dir try",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_places(parser)
    parser.set_defaults(run=status)
    parser = subparsers.add_parser(
        "jobs",
        help="what it has done",
        description="Every job: its id, its state and why, since when, its picture's name, and what was said of it.",
        epilog="example:\n  linedrawd jobs | grep -w failed\n  linedrawd jobs --json | jq '.[].name'",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "--json", action="store_true", help="as one JSON list, with what to do and the figures of reports"
    )
    add_places(parser)
    parser.set_defaults(run=jobs)


def status(args: argparse.Namespace) -> int:
    """0 when a daemon runs, 1 when none does; its last status is printed all the same."""
    path = settings_of(args).paths.status
    try:
        said = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise LinedrawError(
            f"no daemon has left a status at {path} ({error}): start it or give its --state-dir"
        ) from None
    runs = bool(said["pid"]) and Path(f"/proc/{said['pid']}").exists()
    if not runs:
        print("no daemon runs; this is its last status:")
    machines = said.pop("machines", {})
    _print_fields(said if len(machines) < 2 else {**said, "state": "", "words": ""})
    if len(machines) > 1:
        for name, machine in machines.items():
            print(f"\n{name}")
            _print_fields(machine, name)
    return 0 if runs else 1


def _print_fields(said: dict[str, Any], machine: str = "") -> None:
    """machine: the one that is told of, where there are several."""
    for key, value in said.items():
        if value not in ("", None, 0, 0.0) and (key, value) != ("feed_percent", 100):
            print(f"{key.replace('_', ' '):14} {value}")
    if said.get("jobs_to_approve"):
        print(f"{'to approve':14} {meaning_of(State.WAITING, Reason.APPROVAL).remedy}")
    if said.get("reason") and (remedy := _remedy(str(said["state"]), str(said["reason"]), machine)):
        print(f"{'what to do':14} {remedy}")


def jobs(args: argparse.Namespace) -> int:
    settings = settings_of(args)
    root, several = settings.paths.jobs, len(settings.machines) > 1
    folders = sorted(os.listdir(root)) if root.is_dir() else []
    found = (job for folder in folders for job in _job(root / folder, several=several))
    if args.json:
        print(json.dumps([job | _figures(root / job["id"]) for job in found], indent=1, ensure_ascii=False))
        return 0
    for job in found:
        name = job["name"] if set(job["name"]).isdisjoint(' "=\\') else json.dumps(job["name"], ensure_ascii=False)
        machine = f"  {job['machine'] or '-':12}" if several else ""
        state = f"{job['state']}, {job['reason']}" if job["reason"] else job["state"]
        print(f"{job['id']:32} {state:12} {job['changed']}{machine}  {name}  {job['words']}")
    return 0


def _job(folder: Path, *, several: bool) -> Iterator[dict[str, str]]:
    """What its log tells of a job, nothing for a folder that is no job or whose log cannot be read.

    several: there are several machines.
    """
    try:
        log = (folder / JOB_LOG_NAME).read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return
    steps = [found for found in map(_LINE.match, log) if found]
    if steps:
        named = _NAME.search(log[0])
        name = json.loads(named[1]) if named and named[1].startswith('"') else named[1] if named else folder.name
        last = steps[-1]
        reason, machine = last["quoted"] or last["reason"] or "", _machine_of(folder)
        yield {
            "id": folder.name,
            "name": name,
            "state": last["state"],
            "reason": reason,
            "remedy": _remedy(last["state"], reason, machine if several else ""),
            "changed": last["time"],
            "words": last["words"],
            "machine": machine,
            "folder": str(folder),
        }


def _machine_of(folder: Path) -> str:
    """The one that draws or has drawn it, or that it is for; "" where any may."""
    record = read_record(folder)
    return record.machine or record.bound_to if record else ""


def _remedy(state: str, reason: str, machine: str) -> str:
    """What a person does about it; "" for what another version has written."""
    try:
        meaning = meaning_of(State(state), Reason(reason))
    except ValueError:
        return ""
    return meaning.remedy_at(machine) if machine else meaning.remedy


def _figures(folder: Path) -> dict[str, Any]:
    """Those of the report that people ask for; none where it has not been planned."""
    try:
        report = json.loads((folder / "report.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return {key: report[key] for key in _FIGURES if key in report}
