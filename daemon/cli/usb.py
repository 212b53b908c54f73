"""`linedrawd usb`: which adapters and scanners are plugged in, and what keeps each of them from working."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from daemon.machine.ports import DOBOT_IDS, GRBL_IDS
from daemon.usb import UsbDevice, UsbInventory, inventory
from daemon.usb_tree import Branch, Node, branch

EXAMPLE = """example:
  linedrawd usb                 # then: linedrawd --device grbl --port usb://1-1.4
The place is where a device is plugged in. It stays when the device is unplugged and comes back, its /dev/tty* may not.
"""
_STILL_IMAGE, _IPP, _VENDOR, _SERIAL = (6, 1), (7, 1), 0xFF, 2
_SCANNER_MAKERS = {
    0x04A9: "Canon", 0x04B8: "Epson", 0x04C5: "Fujitsu", 0x03F0: "HP", 0x04F9: "Brother", 0x055F: "Mustek",
    0x05DA: "Microtek", 0x07B3: "Plustek", 0x04E8: "Samsung", 0x043D: "Lexmark", 0x1083: "Canon",
    0x0638: "Avision", 0x04DA: "Panasonic", 0x0A17: "Pentax", 0x0482: "Kyocera", 0x05CA: "Ricoh",
}  # fmt: skip
"""Makers whose devices with a vendor's own class may be scanners; many of these do other things as well."""
_BRLTTY = Path("/usr/bin/brltty")


def add_parser(subparsers: Any) -> None:
    parser = subparsers.add_parser(
        "usb",
        help="which adapters and scanners are plugged in",
        description="Which serial adapters and scanners are plugged in: what, where, with which driver, and what keeps "
        "each from working. Nothing is opened.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """0 when all that is plugged in can be used, 1 when something cannot, or the USB cannot be looked at."""
    found = inventory()
    told = look(found)
    for lines in told:
        print("\n".join(lines))
    if not told:
        print(_nothing(found))
    return 1 if found.why_empty or any(len(lines) > 1 for lines in told) else 0


def look(found: UsbInventory | None = None) -> list[list[str]]:
    """What `tell` says of each device that matters."""
    brltty = _BRLTTY.exists()
    devices = (found or inventory()).devices
    return [tell(device, branch(device.place), brltty=brltty) for device in devices if kind_of(device)]


def _nothing(found: UsbInventory) -> str:
    return found.why_empty or "neither a serial adapter nor a scanner is plugged in"


def kind_of(device: UsbDevice) -> str:
    """What it is to us, "" for a keyboard and the like."""
    ids = (device.vid, device.pid)
    if ids in GRBL_IDS | DOBOT_IDS or any(of == _SERIAL for of, _ in device.classes):
        return "serial adapter"
    if _STILL_IMAGE in device.classes:
        return "scanner or camera"
    if _IPP in device.classes:
        return "printer, perhaps with a scanner"
    if device.vid in _SCANNER_MAKERS and any(of == _VENDOR for of, _ in device.classes):
        return f"{_SCANNER_MAKERS[device.vid]} scanner, perhaps"
    return ""


def tell(device: UsbDevice, found: Branch, *, brltty: bool) -> list[str]:
    """A line that says what and where it is, and one for each thing that is wrong. brltty: the package is installed."""
    driver = ", ".join(found.drivers) or "none"
    ports = "".join(f"  {node.path}" for node in found.ports)
    name = f"  {found.name}" if found.name else ""
    what = f"USB {device.place}  {device.vid:04X}:{device.pid:04X}  {kind_of(device)}{name}  driver: {driver}{ports}"
    return [what, *(f"  {words}" for words in _wrong(device, found, brltty=brltty))]


def _wrong(device: UsbDevice, found: Branch, *, brltty: bool) -> Iterator[str]:
    if kind_of(device) == "serial adapter":
        yield from _wrong_adapter(found, brltty=brltty)
    elif found.usb and not found.usb.usable:
        yield _not_ours(found.usb)


def _wrong_adapter(found: Branch, *, brltty: bool) -> Iterator[str]:
    yield from (_not_ours(node) for node in found.ports if not node.usable)
    if found.ports:
        return
    if "usbfs" in found.drivers or (brltty and not found.drivers):
        yield "it has no serial port, because brltty holds it, a driver of Braille displays: remove the package brltty"
    elif found.drivers:
        yield "it has a driver, but no serial port: unplug it and plug it in again"
    else:
        yield "it has no serial port, because no driver took it: load one, as with `sudo modprobe ch341` (or cp210x)"


def _not_ours(node: Node) -> str:
    if node.group == "root":
        return f"{node.path} may not be opened, and belongs to no group: add a udev rule, or install sane-utils"
    return f"{node.path} may not be opened: `sudo adduser USER {node.group}`, then log in again"
