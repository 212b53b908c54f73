"""What `linedrawd usb` says of what is plugged in, from a tree of files as Linux writes it."""

from __future__ import annotations

import grp
import os
from pathlib import Path

import pytest

from daemon.cli import usb as command
from daemon.cli.__main__ import main
from daemon.cli.usb import kind_of, tell
from daemon.usb import UsbDevice, UsbInventory
from daemon.usb_tree import Branch, Node, branch

CH340 = UsbDevice(0x1A86, 0x7523, "1-1.4", frozenset({(0xFF, 0), (0xFF, 1)}))
CANON = UsbDevice(0x04A9, 0x1909, "1-1.2", frozenset({(0, 0), (6, 1)}))
KEYBOARD = UsbDevice(0x046D, 0xC31C, "1-1.1", frozenset({(0, 0), (3, 1)}))
TTY = Node("/dev/ttyUSB0", "dialout", True)


def bare(place: str = "1-1.4", drivers: tuple[str, ...] = (), *ports: Node, usb: Node | None = None) -> Branch:
    return Branch(place, "", drivers, usb, ports)


def test_an_adapter_that_works_is_one_line() -> None:
    (line,) = tell(CH340, Branch("1-1.4", "QinHeng USB Serial", ("ch341",), None, (TTY,)), brltty=True)
    assert line == "USB 1-1.4  1A86:7523  serial adapter  QinHeng USB Serial  driver: ch341  /dev/ttyUSB0"


@pytest.mark.parametrize(
    ("device", "found", "brltty", "sentence"),
    [
        (CH340, bare("1-1.4", ("ch341",), Node("/dev/ttyUSB0", "dialout", False)), False, "sudo adduser USER dialout"),
        (CH340, bare("1-1.4", ("usbfs",)), False, "remove the package brltty"),
        (CH340, bare(), True, "remove the package brltty"),
        (CH340, bare(), False, "no driver took it: load one"),
        (CH340, bare("1-1.4", ("ch341",)), True, "has a driver, but no serial port: unplug it"),
        (CANON, bare("1-1.2", usb=Node("/dev/bus/usb/001/005", "scanner", False)), False, "sudo adduser USER scanner"),
        (CANON, bare("1-1.2", usb=Node("/dev/bus/usb/001/005", "root", False)), False, "belongs to no group"),
    ],
)
def test_what_is_wrong_is_said_with_its_remedy(device: UsbDevice, found: Branch, brltty: bool, sentence: str) -> None:
    _, wrong = tell(device, found, brltty=brltty)
    assert sentence in wrong


@pytest.mark.parametrize(
    ("device", "kind"),
    [
        (CH340, "serial adapter"),
        (UsbDevice(0xCAFE, 1, "1-1", frozenset({(2, 2)})), "serial adapter"),
        (CANON, "scanner or camera"),
        (UsbDevice(0x04B8, 1, "1-1", frozenset({(0xFF, 0xFF)})), "Epson scanner, perhaps"),
        (UsbDevice(0x03F0, 1, "1-1", frozenset({(7, 1)})), "printer, perhaps with a scanner"),
        (UsbDevice(0xCAFE, 1, "1-1", frozenset({(0xFF, 0xFF)})), ""),
        (KEYBOARD, ""),
    ],
)
def test_adapters_and_scanners_are_told_from_the_rest(device: UsbDevice, kind: str) -> None:
    assert kind_of(device) == kind


def tree(root: Path, *, driver: str = "ch341", port: str = "ttyUSB0") -> tuple[Path, Path]:
    """(sysfs, /dev) with one adapter at 1-1.4."""
    sysfs, dev = root / "devices", root / "dev"
    device, interface = sysfs / "1-1.4", sysfs / "1-1.4:1.0"
    device.mkdir(parents=True)
    for name, text in {"busnum": "1", "devnum": "7", "manufacturer": "QinHeng", "product": "USB Serial"}.items():
        (device / name).write_text(text + "\n")
    (interface / port / "tty" / port).mkdir(parents=True)
    (root / "drivers" / driver).mkdir(parents=True)
    (interface / "driver").symlink_to(root / "drivers" / driver)
    (dev / "bus" / "usb" / "001").mkdir(parents=True)
    (dev / "bus" / "usb" / "001" / "007").touch()
    (dev / port).touch()
    return sysfs, dev


def test_a_device_is_read_from_the_tree(tmp_path: Path) -> None:
    sysfs, dev = tree(tmp_path)
    group = grp.getgrgid(os.getgid()).gr_name
    assert branch("1-1.4", sysfs=sysfs, dev=dev, may=lambda path: path.name == "007") == Branch(
        "1-1.4",
        "QinHeng USB Serial",
        ("ch341",),
        Node(str(dev / "bus/usb/001/007"), group, True),
        (Node(str(dev / "ttyUSB0"), group, False),),
    )


def test_a_device_that_is_gone_is_empty(tmp_path: Path) -> None:
    assert branch("9-9", sysfs=tmp_path, dev=tmp_path) == Branch("9-9", "", (), None, ())


def test_the_command_lists_only_what_concerns_us(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(command, "inventory", lambda: UsbInventory((KEYBOARD, CH340)))
    monkeypatch.setattr(command, "branch", lambda place: bare(place, ("ch341",), TTY))
    assert main(["usb"]) == 0
    assert capsys.readouterr().out == "USB 1-1.4  1A86:7523  serial adapter  driver: ch341  /dev/ttyUSB0\n"


def test_the_command_says_when_it_cannot_look(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(command, "inventory", lambda: UsbInventory((), "install libusb-1.0-0"))
    assert main(["usb"]) == 1
    assert capsys.readouterr().out == "install libusb-1.0-0\n"
