"""What is plugged into the USB, seen through a backend of our own: no libusb, no device."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace as Descriptor
from typing import Any

import pytest
import usb.backend
import usb.core

from daemon import usb as door
from daemon.errors import NoMachine
from daemon.usb import UsbDevice, UsbInventory


class Bus(usb.backend.IBackend):  # type: ignore[misc]
    """Devices as (vid, pid, bus, ports, interface class, subclass); an interface class of None cannot be read."""

    def __init__(self, *devices: tuple[int, int, int, tuple[int, ...], int | None, int]) -> None:
        self._devices = devices
        self.reset = list[Any]()
        self.stuck = False

    def enumerate_devices(self) -> Iterator[Any]:
        return iter(self._devices)

    def get_device_descriptor(self, dev: Any) -> Any:
        vid, pid, bus, ports, _, _ = dev
        fields = dict.fromkeys(
            ("bLength", "bDescriptorType", "bcdUSB", "bDeviceClass", "bDeviceSubClass", "bDeviceProtocol", "bcdDevice",
             "bMaxPacketSize0", "iManufacturer", "iProduct", "iSerialNumber", "bNumConfigurations", "speed"), 0
        )  # fmt: skip
        place = {"address": 1, "bus": bus, "port_number": ports[-1] if ports else 0, "port_numbers": ports}
        return Descriptor(**(fields | {"idVendor": vid, "idProduct": pid, "bNumConfigurations": 1} | place))

    def get_configuration_descriptor(self, dev: Any, config: int) -> Any:
        if dev[4] is None:
            raise usb.core.USBError("no such device", errno=19)
        return Descriptor(bLength=9, bDescriptorType=2, wTotalLength=18, bNumInterfaces=1, bConfigurationValue=1,
                          iConfiguration=0, bmAttributes=0, bMaxPower=50, extra_descriptors=[])  # fmt: skip

    def get_interface_descriptor(self, dev: Any, intf: int, alt: int, config: int) -> Any:
        if alt or intf:
            raise IndexError
        return Descriptor(bLength=9, bDescriptorType=4, bInterfaceNumber=0, bAlternateSetting=0, bNumEndpoints=0,
                          bInterfaceClass=dev[4], bInterfaceSubClass=dev[5], bInterfaceProtocol=0, iInterface=0,
                          extra_descriptors=[])  # fmt: skip

    def open_device(self, dev: Any) -> Any:
        return dev

    def close_device(self, dev_handle: Any) -> None:
        """Nothing was opened."""

    def reset_device(self, dev_handle: Any) -> None:
        if self.stuck:
            raise usb.core.USBError("permission denied", errno=13)
        self.reset.append(dev_handle)


def test_devices_are_listed_by_place_with_their_classes() -> None:
    bus = Bus((0x1A86, 0x7523, 1, (1, 4), 0xFF, 1), (0x04A9, 0x1909, 1, (1, 2), 6, 1))
    assert door.inventory(backend=bus) == UsbInventory(
        (
            UsbDevice(0x04A9, 0x1909, "1-1.2", frozenset({(0, 0), (6, 1)})),
            UsbDevice(0x1A86, 0x7523, "1-1.4", frozenset({(0, 0), (0xFF, 1)})),
        )
    )


def test_ids_are_those_of_all_devices() -> None:
    assert door.inventory(backend=Bus((1, 2, 1, (1,), 3, 0), (4, 5, 1, (2,), 3, 0))).ids == {(1, 2), (4, 5)}


def test_a_device_that_is_just_unplugged_is_still_listed() -> None:
    assert door.inventory(backend=Bus((1, 2, 1, (), None, 0))).devices == (UsbDevice(1, 2, "1-0", frozenset({(0, 0)})),)


def test_without_libusb_the_inventory_is_empty_and_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("libusb1", "openusb", "libusb0"):
        monkeypatch.setattr(f"usb.backend.{name}.get_backend", lambda *_, **__: None)
    inventory = door.inventory()
    assert inventory.devices == ()
    assert "install libusb-1.0-0" in inventory.why_empty


def test_only_the_device_at_the_place_is_reset() -> None:
    bus = Bus((0x1A86, 0x7523, 1, (1, 4), 0xFF, 1), (0x1A86, 0x7523, 1, (1, 2), 0xFF, 1))
    door.reset("1-1.2", backend=bus)
    assert [device[3] for device in bus.reset] == [(1, 2)]


def test_a_device_that_is_not_there_or_may_not_be_reset_is_named() -> None:
    bus = Bus((0x1A86, 0x7523, 1, (1, 4), 0xFF, 1))
    with pytest.raises(NoMachine, match=r"nothing is plugged in at USB 1-1\.2"):
        door.reset("1-1.2", backend=bus)
    bus.stuck = True
    with pytest.raises(NoMachine, match=r"USB 1-1\.4 cannot be reset .*permission denied.*: unplug it"):
        door.reset("1-1.4", backend=bus)
