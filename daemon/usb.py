"""What is plugged into the USB; the only door to pyusb."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import usb.core


@dataclass(frozen=True, slots=True)
class UsbDevice:
    """One device: who made it, and where it is plugged in. classes: its own and its interfaces' (class, subclass)."""

    vid: int
    pid: int
    place: str
    """As Linux writes it: bus, then the ports from the root, "1-1.4"."""
    classes: frozenset[tuple[int, int]]


@dataclass(frozen=True, slots=True)
class UsbInventory:
    """All devices, or none and `why_empty`: a sentence that says what keeps us from looking."""

    devices: tuple[UsbDevice, ...]
    why_empty: str = ""

    @property
    def ids(self) -> frozenset[tuple[int, int]]:
        """(VID, PID) of all devices."""
        return frozenset((device.vid, device.pid) for device in self.devices)


def inventory(*, backend: Any = None) -> UsbInventory:
    """Look at the USB without opening a device. backend: a pyusb backend; None takes the libusb of the system."""
    try:
        found = list(usb.core.find(find_all=True, backend=backend))
    except usb.core.NoBackendError:
        return UsbInventory((), "the USB cannot be looked at without libusb: install libusb-1.0-0")
    except usb.core.USBError as fault:
        return UsbInventory((), f"the USB cannot be looked at ({fault}): check the permissions of /dev/bus/usb")
    return UsbInventory(tuple(sorted(map(_device, found), key=lambda device: device.place)))


def _device(device: Any) -> UsbDevice:
    ports = ".".join(map(str, device.port_numbers or ())) or "0"
    return UsbDevice(device.idVendor, device.idProduct, f"{device.bus}-{ports}", frozenset(_classes(device)))


def _classes(device: Any) -> set[tuple[int, int]]:
    own = {(device.bDeviceClass, device.bDeviceSubClass)}
    try:
        return own | {(side.bInterfaceClass, side.bInterfaceSubClass) for setup in device for side in setup}
    except usb.core.USBError:
        # A device that has just been unplugged still stands in the list.
        return own
