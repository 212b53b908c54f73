"""What is plugged into the USB; the only door to pyusb."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import usb.core

from daemon.errors import NoMachine


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


def reset(place: str, *, backend: Any = None) -> None:
    """Have the device at this place begin anew, as if it had been unplugged; its serial port goes and comes back.

    place: as in `UsbDevice`. backend: as for `inventory`. Raises NoMachine when it is not there or may not be reset.
    """
    try:
        devices = usb.core.find(find_all=True, backend=backend)
        device = next((device for device in devices if _device(device).place == place), None)
        if device is None:
            raise NoMachine(f"nothing is plugged in at USB {place}: `linedrawd usb` lists what is")
        device.reset()
    except usb.core.NoBackendError:
        raise NoMachine("nothing on the USB can be reset without libusb: install libusb-1.0-0") from None
    except usb.core.USBError as fault:
        raise NoMachine(
            f"the device at USB {place} cannot be reset ({fault}): unplug it and plug it in again"
        ) from None
