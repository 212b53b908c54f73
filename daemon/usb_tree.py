"""What Linux makes of a device on the USB: its driver, its files, and whether we may open them."""

from __future__ import annotations

import grp
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

SYSFS = Path("/sys/bus/usb/devices")
DEV = Path("/dev")


@dataclass(frozen=True, slots=True)
class Node:
    """A device file. group: who may open it besides root. usable: whether we may read and write it."""

    path: str
    group: str
    usable: bool


@dataclass(frozen=True, slots=True)
class Branch:
    """One device. drivers: of its interfaces, without those that have none. usb: its own file; ports: serial ones."""

    place: str
    name: str
    drivers: tuple[str, ...]
    usb: Node | None
    ports: tuple[Node, ...]


def branch(
    place: str,
    *,
    sysfs: Path = SYSFS,
    dev: Path = DEV,
    may: Callable[[Path], bool] = lambda path: os.access(path, os.R_OK | os.W_OK),
) -> Branch:
    """What is known of the device at this place ("1-1.4"); what is unknown is empty. Nothing is opened."""
    root = sysfs / place
    interfaces = sorted(sysfs.glob(f"{place}:*"))
    bus, number = _text(root / "busnum"), _text(root / "devnum")
    own = dev / "bus" / "usb" / f"{int(bus):03d}" / f"{int(number):03d}" if bus and number else None
    names = [part for part in (_text(root / "manufacturer"), _text(root / "product")) if part]
    ports = [tty.name for interface in interfaces for tty in sorted(interface.glob("**/tty*")) if _is_port(tty)]
    return Branch(
        place,
        " ".join(names),
        tuple(dict.fromkeys(driver for driver in map(_driver, interfaces) if driver)),
        _node(own, may) if own else None,
        tuple(node for name in dict.fromkeys(ports) if (node := _node(dev / name, may))),
    )


def _is_port(tty: Path) -> bool:
    return tty.name != "tty" and tty.is_dir()


def _driver(interface: Path) -> str:
    link = interface / "driver"
    return os.path.basename(os.readlink(link)) if link.is_symlink() else ""


def _node(path: Path, may: Callable[[Path], bool]) -> Node | None:
    try:
        number = path.stat().st_gid
    except OSError:
        return None
    try:
        group = grp.getgrgid(number).gr_name
    except KeyError:
        group = str(number)
    return Node(str(path), group, may(path))


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace").strip()
    except OSError:
        return ""
