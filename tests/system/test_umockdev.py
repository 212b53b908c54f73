"""A CH340 as the real libusb, pyusb and pyserial see it: a mocked /sys and /dev. Needs the package umockdev."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.system

ROOT = Path(__file__).parents[2]
PLACE = "1-4"
ABOVE = "/devices/pci0000:00/0000:00:14.0/usb1"
_DEVICE = bytes([18, 1, 0x10, 1, 0xFF, 0, 0, 8, 0x86, 0x1A, 0x23, 0x75, 0x63, 2, 0, 2, 0, 1])
_INTERFACE = bytes([9, 4, 0, 0, 3, 0xFF, 1, 2, 0])
_ENDPOINTS = bytes([7, 5, 0x82, 2, 32, 0, 0, 7, 5, 0x02, 2, 32, 0, 0, 7, 5, 0x81, 3, 8, 0, 1])
_CONFIGURATION = bytes([9, 2, 9 + len(_INTERFACE + _ENDPOINTS), 0, 1, 1, 0, 0x80, 48])
"""Descriptors as a CH340 gives them (USB 2.0, 9.6): one interface of the vendor's own class."""
ADAPTER = f"""P: {ABOVE}/{PLACE}
N: bus/usb/001/007
E: DEVNAME=/dev/bus/usb/001/007
E: DEVTYPE=usb_device
E: SUBSYSTEM=usb
E: BUSNUM=001
E: DEVNUM=007
A: idVendor=1a86
A: idProduct=7523
A: busnum=1
A: devnum=7
A: speed=12
A: bConfigurationValue=1
A: bNumInterfaces= 1
A: product=USB Serial
H: descriptors={(_DEVICE + _CONFIGURATION + _INTERFACE + _ENDPOINTS).hex().upper()}

P: {ABOVE}/{PLACE}/{PLACE}:1.0
E: DEVTYPE=usb_interface
E: SUBSYSTEM=usb
A: bInterfaceClass=ff
A: bInterfaceSubClass=01
"""
DRIVEN = """L: driver=../../../../../../bus/usb/drivers/{driver}
"""
PORT = f"""
P: {ABOVE}/{PLACE}/{PLACE}:1.0/ttyUSB0
E: SUBSYSTEM=usb-serial
L: driver=../../../../../../../bus/usb-serial/drivers/ch341-uart

P: {ABOVE}/{PLACE}/{PLACE}:1.0/ttyUSB0/tty/ttyUSB0
N: ttyUSB0
E: DEVNAME=/dev/ttyUSB0
E: SUBSYSTEM=tty
L: device=../../../ttyUSB0
"""
PLUGGED_IN = ADAPTER + DRIVEN.format(driver="ch341") + PORT


def seen(folder: Path, devices: str, *command: str) -> subprocess.CompletedProcess[str]:
    """Run a command of ours where these devices are plugged in, and no others."""
    assert shutil.which("umockdev-run"), "umockdev is not installed: apt-get install umockdev"
    (folder / "devices.umockdev").write_text(devices)
    mocked = ["umockdev-run", "-d", str(folder / "devices.umockdev"), "--", sys.executable, *command]
    return subprocess.run(mocked, cwd=ROOT, capture_output=True, text=True, check=False, timeout=60)


def test_an_adapter_that_works_is_told_with_its_place_and_port(tmp_path: Path) -> None:
    found = seen(tmp_path, PLUGGED_IN, "-m", "daemon.cli", "usb")
    assert (found.stdout, found.returncode) == (
        "USB 1-4  1A86:7523  serial adapter  USB Serial  driver: ch341  /dev/ttyUSB0\n", 0,
    )  # fmt: skip


def test_its_port_is_found_by_its_ids_and_by_its_place(tmp_path: Path) -> None:
    code = (
        "from daemon.machine.ports import find_dobot, find_grbl, named\n"
        "from daemon.machine.serial_port import adapters\n"
        "print(find_grbl(adapters()), find_dobot(adapters()), named('usb://1-4', adapters))"
    )
    assert seen(tmp_path, PLUGGED_IN, "-c", code).stdout == "/dev/ttyUSB0 /dev/ttyUSB0 /dev/ttyUSB0\n"


def test_an_adapter_is_reset_through_libusb(tmp_path: Path) -> None:
    code = "from daemon import usb\nusb.reset('1-4')\nprint('reset')\nusb.reset('1-5')"
    found = seen(tmp_path, PLUGGED_IN, "-c", code)
    assert found.stdout == "reset\n"
    assert "nothing is plugged in at USB 1-5" in found.stderr


@pytest.mark.parametrize(
    ("devices", "remedy"),
    [
        (ADAPTER, "it has no serial port, because no driver took it"),
        (ADAPTER + DRIVEN.format(driver="usbfs"), "because brltty holds it, a driver of Braille displays: remove"),
        (ADAPTER + DRIVEN.format(driver="ch341"), "it has a driver, but no serial port: unplug it"),
    ],
)
def test_an_adapter_without_a_port_is_explained(tmp_path: Path, devices: str, remedy: str) -> None:
    found = seen(tmp_path, devices, "-m", "daemon.cli", "usb")
    assert found.returncode == 1
    assert remedy in found.stdout


def test_the_doctor_finds_it_too(tmp_path: Path) -> None:
    command = ["-m", "daemon.cli", "doctor", "--device", "grbl", "--state-dir", str(tmp_path / "state")]
    found = seen(tmp_path, ADAPTER + DRIVEN.format(driver="usbfs"), *command)
    assert found.returncode == 1
    assert "WRONG  usb" in found.stdout
    assert "remove the package brltty" in found.stdout
