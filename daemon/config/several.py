"""What several machines must not have in common: the way to them, and the folders of their pictures."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path

from daemon.config.machine import Machine

_BY_CABLE = ("serial://", "usb://")


def check_ways(machines: Mapping[str, Machine]) -> None:
    """Raises ValueError where two machines have the same url, or one that is looked for could be the other."""
    first: dict[str, str] = {}
    for name, machine in machines.items():
        if machine.simulated:
            continue
        way = _way(machine.url)
        if way in first:
            raise ValueError(f"{first[way]} and {name} have the same url = '{machine.url}': give each its own")
        first[way] = name
    looked_for = [name for name, machine in machines.items() if machine.url == "auto"]
    by_cable = [name for name, machine in machines.items() if machine.url.startswith(_BY_CABLE)]
    if looked_for and by_cable:
        raise ValueError(
            f"{looked_for[0]} has url = 'auto' and could be found at the port of {by_cable[0]}: say its url"
        )


def check_inboxes(inboxes: Mapping[str, Path]) -> None:
    """Raises ValueError where two are the same folder, or one lies in another, where it is no picture."""
    for (name, folder), (other, below) in _pairs(inboxes):
        if below == folder or folder in below.parents or below in folder.parents:
            raise ValueError(
                f"{below}, the inbox of {other}, and {folder}, {_whose(name)}, are or hold each other: "
                "give it another folder"
            )


def _pairs(inboxes: Mapping[str, Path]) -> Iterator[tuple[tuple[str, Path], tuple[str, Path]]]:
    plain = {name: Path(os.path.normpath(folder)) for name, folder in inboxes.items()}
    return ((one, two) for one in plain.items() for two in plain.items() if two[0] and one[0] != two[0])


def _whose(name: str) -> str:
    return f"the inbox of {name}" if name else "the inbox of all"


def _way(url: str) -> str:
    """The same for two names of one port."""
    scheme, _, path = url.partition("://")
    return f"serial://{os.path.realpath(path)}" if scheme == "serial" else url
