"""Which port a machine is on: by the place of its adapter, by USB ids, by its banner where several fit."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from daemon.errors import MachineFault, NoMachine
from daemon.machine.link import Link
from daemon.machine.serial_port import Adapter, open_serial
from daemon.machine.transport import Transport
from firmware_protocol.grbl.session import GrblSession

GRBL_IDS = frozenset(
    {
        (0x1A86, 0x7523),  # CH340
        (0x1A86, 0x5523),  # CH341
        (0x1A86, 0x55D4),  # CH9102
        (0x10C4, 0xEA60),  # CP210x
        (0x10C4, 0xEA70),  # CP2105
        (0x0403, 0x6001),  # FT232
        (0x0403, 0x6015),  # FT-X
        (0x2341, 0x0043),  # Arduino Uno
        (0x2341, 0x0001),
        (0x2341, 0x0042),  # Arduino Mega
        (0x2341, 0x0010),
        (0x067B, 0x2303),  # PL2303
        (0x067B, 0x23A3),
        (0x2E8A, 0x000A),  # RP2040
        (0x303A, 0x1001),  # ESP32-S3
    }
)
"""Serial adapters of GRBL boards (systemd hwdb 20-usb-vendor-model and the vendors' sources). Other machines use some
of them too, so an id makes a candidate, never a machine."""


DOBOT_IDS = frozenset({(0x10C4, 0xEA60), (0x1A86, 0x7523), (0x1A86, 0x55D4)})
"""CP210x, CH340 and CH9102, as the drivers of the Dobot Magician look for them."""


RESETTABLE_IDS = frozenset({(0x1A86, 0x7523), (0x1A86, 0x5523), (0x1A86, 0x55D4), (0x10C4, 0xEA60), (0x10C4, 0xEA70)})
"""CH340, CH341, CH9102, CP210x and CP2105: they can wedge, and a reset of the USB frees them."""

USB_URL = "usb://"
"""A port by the place where its adapter is plugged in, `usb://1-1.4`; its path may be another one tomorrow."""


def named(url: str, ports: Callable[[], Sequence[Adapter]]) -> str:
    """The port that a url names: for usb://PLACE the path it has now, any other as it is. Raises NoMachine."""
    if not url.startswith(USB_URL):
        return url
    place = url.removeprefix(USB_URL)
    path = next((port.path for port in ports() if port.place.partition(":")[0] == place), None)
    if path is None:
        raise NoMachine(
            f"no serial adapter is plugged in at USB {place}: plug it in there; `linedrawd usb` tells places"
        )
    return path


def candidates(ports: Sequence[Adapter]) -> tuple[Adapter, ...]:
    """The adapters that may belong to a GRBL controller."""
    return tuple(port for port in ports if (port.vid, port.pid) in GRBL_IDS)


def find_grbl(
    ports: Sequence[Adapter],
    *,
    on_usb: Collection[tuple[int, int]] = (),
    open_port: Callable[[str], Transport] = open_serial,
) -> str:
    """The path of the one port that a GRBL controller may be on; only where several fit they are opened and asked.

    ports: the inventory (`serial_port.adapters`). on_usb: (VID, PID) of everything on the USB, to explain an adapter
    without a port. Raises NoMachine when there is none, or more than one.
    """
    found = candidates(ports)
    if not found:
        raise NoMachine(_none_found(on_usb))
    if len(found) == 1:
        return found[0].path
    answering = [port for port in found if _answers(port.path, open_port)]
    if len(answering) == 1:
        return answering[0].path
    raise NoMachine(_which(found, answering))


def find_dobot(ports: Sequence[Adapter]) -> str:
    """The path of the one port that a Dobot may be on; none is opened to ask. Raises NoMachine."""
    found = [port for port in ports if (port.vid, port.pid) in DOBOT_IDS]
    if len(found) == 1:
        return found[0].path
    if not found:
        raise NoMachine("no serial adapter of a Dobot is plugged in: plug it in, or name its port")
    listed = ", ".join(f"{port.path} (USB {port.place})" for port in found)
    raise NoMachine(f"a Dobot may be on any of {listed}: name the port to use")


def is_grbl(transport: Transport) -> bool:
    """Whether a GRBL controller answers, be it ready or locked. Closes the transport.

    Many boards are reset by the opening itself; one that is not is asked `?` and reset only when nothing moves.
    """
    session = GrblSession(now=transport.now())
    link = Link(transport, session, heard=lambda event: None)
    try:
        link.connect()
    except (NoMachine, MachineFault):
        pass
    finally:
        link.close()
    return session.firmware is not None


def _answers(path: str, open_port: Callable[[str], Transport]) -> bool:
    try:
        return is_grbl(open_port(path))
    except NoMachine:
        return False


def _none_found(on_usb: Collection[tuple[int, int]]) -> str:
    hidden = sorted(GRBL_IDS & frozenset(on_usb))
    if not hidden:
        return "no serial adapter of a GRBL controller is plugged in: plug it in, or name its port"
    names = ", ".join(f"{vid:04X}:{pid:04X}" for vid, pid in hidden)
    return f"the USB shows {names}, but no serial port belongs to it: load its driver, or remove the package brltty"


def _which(found: Sequence[Adapter], answering: Sequence[Adapter]) -> str:
    listed = ", ".join(f"{port.path} (USB {port.place}, {port.vid:04X}:{port.pid:04X})" for port in answering or found)
    if answering:
        return f"{len(answering)} GRBL controllers answer, on {listed}: name the port to use"
    return f"no GRBL controller answers on {listed}: switch it on, or name its port"
